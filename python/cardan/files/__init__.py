"""Tables of numbers as files: recordings read, columns written, Parquet in chunks, whole files."""

from collections.abc import Callable

from cardan.files.tables import map_parquet

__all__ = ["Progress", "map_parquet"]

Progress = Callable[[int, int], None]
"""How long work reports how far it is: takes the number of rows done and of all rows."""

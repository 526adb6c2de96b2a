"""Tables of numbers as files: recordings read, columns written, Parquet in chunks, whole files."""

from cardan.app.files.columns import map_parquet

__all__ = ["map_parquet"]

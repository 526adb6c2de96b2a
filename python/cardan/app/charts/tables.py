"""Tables of the page."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple


class Table(NamedTuple):
    """What the macro ``table`` takes; the first cell of a row is its heading.

    Attributes:
        caption: what it is about.
        head: heading of each column.
        rows: the cells.
        prose: whether the last column has sentences, which break.
    """

    caption: str
    head: Sequence[str]
    rows: Sequence[Sequence[str]]
    prose: bool = False

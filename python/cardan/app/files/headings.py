"""The headings of a table's columns: which is wanted, and which was meant."""

from __future__ import annotations

import difflib
from collections.abc import Sequence

_MOST = 300


def place_of_column(name: str, columns: Sequence[str]) -> int:
    """Return the place of a column.

    A ``ValueError`` names the nearest of a name that is missing or not the only one.
    """
    if name not in columns:
        raise ValueError(f"no column {name!r}{_meant(name, columns)}; {_listed(name, columns)}")
    if columns.count(name) > 1:
        raise ValueError(f"column {name!r} appears {columns.count(name)} times")
    return columns.index(name)


def _meant(name: str, columns: Sequence[str]) -> str:
    if name.lower() in map(str.lower, columns):
        close = [column for column in columns if column.lower() == name.lower()]
    else:
        close = difflib.get_close_matches(name, columns, n=1)
    return f"; did you mean {close[0]!r}?" if close else ""


def _listed(name: str, columns: Sequence[str]) -> str:
    if not columns:
        return "the file has none"
    listed = f"the columns are {', '.join(columns)}"
    if len(listed) <= _MOST:
        return short(listed)
    # Of a logger's thousands the first say nothing.
    nearest = difflib.get_close_matches(name, columns, n=5, cutoff=0.0)
    return short(f"the nearest of {len(columns)} columns are {', '.join(nearest)}")


def short(text: str) -> str:
    """Return a text on one line and not long."""
    # A quoted heading may go over several lines.
    text = " ".join(text.splitlines())
    return text if len(text) <= _MOST else f"{text[: _MOST - 3]}..."

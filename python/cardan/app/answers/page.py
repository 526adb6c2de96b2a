"""A part of an answer as a section of the page, from its rows."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from cardan.app.answers.printed import lines_of, table_of
from cardan.app.answers.rows import Judged, rows_of, worst_of
from cardan.app.charts.tables import Table

if TYPE_CHECKING:
    from cardan.app.answers.table import Part

CLASSES = {"within": "good", "tolerable": "fair", "beyond": "bad", "not judged": "open"}
"""The class of the page by which a verdict has its colour."""


def section_of(part: Part, found: Any) -> dict[str, Any]:  # noqa: ANN401 - any part
    """Return sentences and tables of a part as plain data for the macro ``answered``."""
    judged = (entry.value for entry in part.entries(found) if isinstance(entry.value, Judged))
    return {
        "class": CLASSES[worst_of(value.verdict for value in judged)],
        "sentences": part.sentences(found),
        "tables": tables_of(part.heading(found), found),
    }


def tables_of(caption: str, found: Any) -> list[Table]:  # noqa: ANN401 - any part
    """Return the figures of a part as tables, one for the items of each of its parts."""
    if isinstance(found, tuple):
        return [Table(caption, *table_of(found))]
    tables = [Table(caption, ("Figure", "Value"), list(lines_of(found)))]
    for name, row, _ in rows_of(type(found)):
        value = getattr(found, name)
        if row.kind == "parts" and value:
            tables += tables_of(row.label, value if isinstance(value, tuple) else (value,))
    return tables

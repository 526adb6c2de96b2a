"""A part of an answer as a section of the page, from its rows."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from cardan.app.answers.charts import Table
from cardan.app.answers.printed import (
    given,
    is_nested,
    judged_text,
    lines_of,
    place_of,
    quantity,
    table_of,
)
from cardan.app.answers.rows import Entry, Judged, rows_of, worst_of

if TYPE_CHECKING:
    from cardan.app.answers.answer import JudgedFigure
    from cardan.app.answers.table import Part

CLASSES = {"within": "good", "tolerable": "fair", "beyond": "bad", "not judged": "open"}
"""The class of the page by which a verdict has its colour."""

_SIGNS = {"within": "✓", "tolerable": "!", "beyond": "✗", "not judged": "-"}


def section_of(part: Part, found: Any) -> dict[str, Any]:  # noqa: ANN401 - any part
    """Return sentences and tables of a part as plain data for the macro ``answered``."""
    judged = (entry.value for entry in part.entries(found) if isinstance(entry.value, Judged))
    return {
        "class": CLASSES[worst_of(value.verdict for value in judged)],
        "sentences": part.sentences(found),
        "tables": tables_of(part.heading(found), found),
    }


def judged_lines(entries: Iterable[Entry]) -> list[dict[str, str]]:
    """Return the judged of some figures as plain data for the macro ``judged``, a line each."""
    lines = []
    for entry in entries:
        value, row = entry.value, entry.row
        if isinstance(value, Judged):
            words = f"{row.label}: {judged_text(value, row)}"
            lines.append(
                {
                    "class": CLASSES[value.verdict],
                    "sign": _SIGNS[value.verdict],
                    "words": words,
                }
            )
    return lines


def judged_table(figures: Iterable[JudgedFigure]) -> Table:
    """Return figures beside their limits, with the sources of these."""
    rows = []
    for each in figures:
        value, unit = each.value, each.entry.row.unit
        bounds = (value.limit, value.maximum)
        rows.append(
            (
                each.name,
                value.why if value.value is None else quantity(value.value, unit) + place_of(value),
                value.verdict,
                *("" if bound is None else given(bound, unit) for bound in bounds),
                "no limit given" if value.limit is None else value.source,
            )
        )
    head = ("Figure", "Value", "Verdict", "Limit", "Maximum", "Source of the limit")
    return Table("Limits", head, rows, prose=True)


def tables_of(caption: str, found: Any) -> list[Table]:  # noqa: ANN401 - any part
    """Return the figures of a part as tables, one for the items of each of its parts."""
    if isinstance(found, tuple):
        return [Table(caption, *table_of(found))]
    lines = list(lines_of(found))
    tables = [Table(caption, ("Figure", "Value"), lines)] if lines else []
    for name, row, _ in rows_of(type(found)):
        if is_nested(row) and (value := getattr(found, name)):
            tables += tables_of(row.label, value)
    return tables

"""Tables, curves, maps and bars of the page as plain data, which ``charts.js`` draws there."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cardan.app.answers.printed import (
    curves_text,
    given,
    is_nested,
    judged_text,
    lines_of,
    place_of,
    quantity,
    table_of,
)
from cardan.app.answers.rounding import is_steady
from cardan.app.answers.rows import Entry, Judged, rows_of, worst_of
from cardan.app.scene.language.units import as_shown
from cardan.arrays import FloatArray

if TYPE_CHECKING:
    from cardan.app.answers.answer import JudgedFigure
    from cardan.app.answers.table import Part


@dataclass(frozen=True, eq=False)
class Curve:
    """One line of a chart: what it is of and its values, ``(samples,)``; NaN where it has none."""

    label: str
    values: FloatArray


@dataclass(frozen=True, eq=False)
class Panel:
    """One chart."""

    heading: str  # the quantity
    unit: str  # of its values as axes have it, "" for a ratio; the chart has that of the answer
    curves: tuple[Curve, ...]  # the lines
    scale: float = 1.0  # a size beside which a billionth is rounding
    left_out: int = 0  # the number of smaller curves that are not drawn

    @property
    def is_steady(self) -> bool:
        """Whether its line of text says as much as the chart."""
        return all(is_steady(curve.values, self.scale) for curve in self.curves)

    @property
    def line(self) -> str:
        """The curves as text: ``"torque of shaft 0: 1500 N m"``."""
        curves = [(curve.label, curve.values) for curve in self.curves]
        between = " of " if len(curves) > 1 else f" of {self.curves[0].label}: "
        return f"{self.heading}{between}{curves_text(curves, self.unit, self.scale)}"


class Table(NamedTuple):
    """Argument of the macro ``table``; the first cell of a row is its heading."""

    caption: str  # what it is about
    head: Sequence[str]  # heading of each column
    rows: Sequence[Sequence[str]]  # the cells
    prose: bool = False  # whether the last column has sentences, which break


def chart(
    panel: Panel, x: FloatArray, over: str, named: tuple[str, Sequence[str]] | None = None
) -> dict[str, Any]:
    """Return a panel over an abscissa, ``(samples,)``, as plain data for the macro ``drawing``.

    ``named`` says what the samples are and the name of each; names replace ``x`` and what it is
    where they fit below the chart, and the samples are then as far from each other.
    """
    curves = [(curve.label, as_shown(curve.values, panel.unit)[0]) for curve in panel.curves]
    scale, unit = as_shown(np.array(panel.scale), panel.unit)
    values = np.concatenate([curve for _, curve in curves])
    named_over, names = named or ("", ())
    return {
        "kind": "chart",
        "heading": panel.heading,
        "unit": unit,
        "over": over,
        "left_out": panel.left_out,
        "x": plain(x, x, digits=7),
        "curves": [
            {"label": label, "values": plain(curve, values, float(scale))}
            for label, curve in curves
        ],
        "scale": float(scale),
        "names": list(names),
        "named": named_over,
    }


def bars(heading: str, items: Sequence[tuple[str, float, str]]) -> dict[str, Any]:
    """Return bars for the macro ``drawing``, of their labels, sizes and texts."""
    return {"kind": "bars", "heading": heading, "items": [list(each) for each in items]}


def plain(
    values: FloatArray, beside: FloatArray, scale: float = 0.0, digits: int = 5
) -> list[float | None]:
    """Return values as plain data, rounded to a fraction of the range of all values in the chart.

    What is not a number is ``None``.
    """
    low, high = float(np.nanmin(beside)), float(np.nanmax(beside))
    size = max(abs(low), abs(high), 1e-300)
    varied = high - low if high - low > 1e-9 * max(size, scale) else size
    rounded = np.round(values, min(15, digits - 1 - math.floor(math.log10(varied)))).tolist()
    return [None if math.isnan(value) else value for value in rounded]


def some(count: int, most: int) -> NDArray[np.intp]:
    """Places from the first to the last of ``count``, evenly spread, at most ``most``."""
    return np.unique(np.linspace(0, count - 1, min(count, most)).astype(np.intp))


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
    return [
        {
            "class": CLASSES[value.verdict],
            "sign": _SIGNS[value.verdict],
            "words": f"{entry.row.label}: {judged_text(value, entry.row)}",
        }
        for entry in entries
        if isinstance(value := entry.value, Judged)
    ]


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

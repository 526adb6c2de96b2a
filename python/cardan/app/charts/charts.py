"""Charts as data for SVG: axes with units, curves that dashes alone tell apart; tables."""

from __future__ import annotations

import math
import unicodedata
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from cardan.app.answers.printed import curves_text, kind_of_symbol, range_ends
from cardan.app.answers.rounding import is_steady
from cardan.arrays import FloatArray


@dataclass(frozen=True, eq=False)
class Curve:
    """One line of a chart: what it is of and its values, ``(samples,)``; NaN where it has none."""

    label: str
    values: FloatArray


@dataclass(frozen=True, eq=False)
class Panel:
    """One chart."""

    heading: str  # the quantity
    unit: str  # of its values, "" for a ratio
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
    """What the macro ``table`` takes; the first cell of a row is its heading."""

    caption: str  # what it is about
    head: Sequence[str]  # heading of each column
    rows: Sequence[Sequence[str]]  # the cells
    prose: bool = False  # whether the last column has sentences, which break


class _Frame(NamedTuple):
    width: int = 360
    height: int = 180
    left: int = 56
    right: int = 344
    top: int = 8
    bottom: int = 142


FRAME = _Frame()
"""Of every chart and map, in units of its drawing."""

_DEGREES = (1, 2, 5, 10, 15, 30, 45, 90, 180, 360)

# A curve that varies less than this beside its panel's scale or its own size is flat: it would
# fill the chart with rounding.
_FLAT = 1e-9


def chart(
    panel: Panel,
    x: FloatArray,
    x_label: str,
    first: int | None = None,
    named: tuple[str, Sequence[str]] | None = None,
) -> dict[str, Any]:
    """Return heading, ticks, curves and legend as plain data for the macro ``chart``.

    The abscissa ``x`` is ``(samples,)``, ``first`` the number of the first curve, by which the
    script finds it to set its cursor; without one there is no cursor. ``named`` says what the
    samples are and the name of each; names replace ``x`` and its label where they fit, and the
    samples are then as far from each other.
    """
    low, high, flat = _extent(panel)
    y_ticks = ticks(low, high)
    low, high = min(low, y_ticks[0]), max(high, y_ticks[-1])
    start, stop = float(np.min(x)), float(np.max(x))
    stop = stop if stop > start else start + 1.0
    names = _names(named[1]) if named else None
    if names:
        x, start, stop = np.arange(float(len(names.texts))), -0.5, len(names.texts) - 0.5

    across = scaled(start, stop, FRAME.left, FRAME.right)
    up = scaled(low, high, FRAME.bottom, FRAME.top)
    if names:
        x_label = named[0] if named else x_label
        marks = list(zip(x.tolist(), names.texts, strict=True))
    else:
        marks = [(mark, number(mark)) for mark in ticks_of(x_label, start, stop)]
    lines = []
    for i, curve in enumerate(panel.curves, first or 0):
        # A gap stays a gap.
        values = 0.0 * curve.values + np.nanmean(curve.values) if flat else curve.values
        points = [f"{a:.1f},{b:.1f}" for a, b in zip(across(x), up(values), strict=True)]
        pieces = [" ".join(points[piece]) for piece in _pieces(values)]
        lines.append({"number": i, "label": curve.label, "pieces": pieces})
    heading = f"{panel.heading} [{panel.unit}]" if panel.unit else panel.heading
    spoken = " to ".join(range_ends(low, high, kind_of_symbol(panel.unit)))
    return {
        "frame": FRAME._replace(height=FRAME.height + round(names.room)) if names else FRAME,
        "moves": first is not None,
        "heading": heading,
        "spoken": f"{heading} over {x_label}, from {spoken}",
        "x_label": x_label,
        "x_ticks": [(f"{across(mark):.1f}", text) for mark, text in marks],
        "tilt": names.tilt if names else 0,
        "y_ticks": [(f"{up(t):.1f}", f"{up(t) + 4:.1f}", number(t)) for t in y_ticks],
        "lines": lines,
        "unit": panel.unit,
        "left_out": panel.left_out,
    }


def bars(heading: str, items: Sequence[tuple[str, float, str]]) -> dict[str, Any]:
    """Return bars for the macro ``bars``, of their labels, sizes and texts."""
    most = max((size for _, size, _ in items), default=0.0) or 1.0
    widths = [f"{100.0 * size / most:.2f}" for _, size, _ in items]
    shown = [
        {"label": label, "text": text, "width": width}
        for (label, _, text), width in zip(items, widths, strict=True)
    ]
    return {"heading": heading, "items": shown}


def decimals(panel: Panel) -> int:
    """Return how many decimals show a panel's values to about four digits of their variation."""
    low, high, flat = _extent(panel)
    size = max(abs(low), abs(high))
    digits = 3 - math.floor(math.log10(size if flat else min(size, high - low)))
    return min(9, max(0, digits))


def number(value: float) -> str:
    """Write a round number with a true minus sign."""
    return f"{value:.10g}".replace("-", "\N{MINUS SIGN}")


def some(count: int, most: int) -> NDArray[np.intp]:
    """Places from the first to the last of ``count``, evenly spread, at most ``most``."""
    return np.unique(np.linspace(0, count - 1, min(count, most)).astype(np.intp))


def _pieces(values: FloatArray) -> list[slice]:
    """The runs of values that are numbers."""
    gaps = np.flatnonzero(np.diff(np.isnan(values), prepend=True, append=True))
    return [slice(*ends) for ends in gaps.reshape(-1, 2).tolist()]


def _extent(panel: Panel) -> tuple[float, float, bool]:
    values = np.concatenate([curve.values for curve in panel.curves])
    return scale_of(values[~np.isnan(values)], panel.scale)


def scale_of(values: FloatArray, scale: float) -> tuple[float, float, bool]:
    """Least and largest value with some room if they are the same but for rounding, and whether."""
    low, high = float(np.min(values)), float(np.max(values))
    noise = _FLAT * max(scale, abs(low), abs(high))
    if high - low > noise:
        return low, high, False
    middle = (low + high) / 2.0
    room = 0.05 * abs(middle) if abs(middle) > noise else scale or 1.0
    return middle - room, middle + room, True


def scaled(low: float, high: float, start: float, stop: float) -> Any:  # noqa: ANN401
    """Return what turns numbers or arrays from low to high into places from start to stop."""
    return lambda value: start + (stop - start) * (value - low) / (high - low)


def ticks(low: float, high: float, about: float = 4.0) -> Sequence[float]:
    """Round numbers from at or below ``low`` to at or above ``high``, some ``about`` steps."""
    rough = (high - low) / about
    power = 10.0 ** math.floor(math.log10(rough))
    step = next(part * power for part in (1.0, 2.0, 2.5, 5.0, 10.0) if part * power >= rough)
    return [step * i for i in range(math.floor(low / step), math.ceil(high / step) + 1)]


def ticks_of(label: str, low: float, high: float) -> Sequence[float]:
    """Round numbers within an axis: of an angle parts of the turn, of a count whole numbers."""
    marks = _degree_ticks(low, high) if "deg" in label and high - low > 2.0 else ticks(low, high)
    counted = label.endswith("counted from 0")
    return [mark for mark in marks if low <= mark <= high and not (counted and mark % 1.0)]


def _degree_ticks(low: float, high: float) -> Sequence[float]:
    span = high - low
    step = next((step for step in _DEGREES if span <= 5 * step), 360 * math.ceil(span / 1800.0))
    return [float(step * i) for i in range(math.ceil(low / step), math.floor(high / step) + 1)]


# --- names below a chart: level where they fit, else aslant, none where they are many ------------

# Pixels: the font of the page's charts, what a line takes of it, and the least gap between names.
_FONT, _LINE, _GAP = 11.0, 13.0, 7.0

# Degrees by which names are tilted, the least that suffices.
_TILTS = (0, 30, 45, 60, 90)

# Letters of a name; the tables of the report have all of it.
_LETTERS = 24


class _NameAxis(NamedTuple):
    """The names of an axis."""

    # The names, cut if they are long. A level one has its middle at its place, a tilted one its
    # end.
    texts: list[str]
    tilt: int  # degrees by which the names rise to the right
    room: float  # pixels that they need more than level names


def _names(names: Sequence[str]) -> _NameAxis | None:
    """The names below the frame, each in the middle of its share of the axis, if they fit."""
    edges = np.linspace(FRAME.left, FRAME.right, len(names) + 1)
    places = ((edges[:-1] + edges[1:]) / 2.0).tolist()
    names = [name if len(name) <= _LETTERS else f"{name[: _LETTERS - 1]}…" for name in names]
    wide = [_text_width(name) for name in names]
    step = min((b - a for a, b in pairwise(places)), default=math.inf)
    for tilt in _TILTS:
        cosine, sine = math.cos(math.radians(tilt)), math.sin(math.radians(tilt))
        if tilt:
            fits = step * sine >= _LINE
            fits &= all(x - own * cosine >= 0.0 for x, own in zip(places, wide, strict=True))
            fits &= places[-1] + _FONT * sine <= FRAME.width
            room = max(wide) * sine
        else:
            ends = [(x - own / 2.0, x + own / 2.0) for x, own in zip(places, wide, strict=True)]
            fits = all(left[1] + _GAP <= right[0] for left, right in pairwise(ends))
            fits &= ends[0][0] >= 0.0 and ends[-1][1] <= FRAME.width
            room = 0.0
        if fits:
            return _NameAxis(names, tilt, room)
    return None


def _text_width(name: str) -> float:
    """Pixels that a name takes at most in the fonts of browsers."""
    return _FONT * sum(1.0 if unicodedata.east_asian_width(c) in "WF" else 0.62 for c in name)

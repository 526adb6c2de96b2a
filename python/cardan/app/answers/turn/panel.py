"""Curves of a quantity over the drive angle, and what else a scene is drawn over."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from cardan.app.answers.printed import number_text
from cardan.app.answers.rounding import flat_limits
from cardan.app.answers.turn.extremes import period_of
from cardan.app.answers.turn.orders import Bands, orders
from cardan.app.pictures.style import MARKERS, degree_ticks, line_style, value_ticks
from cardan.app.scene.language.units import as_shown
from cardan.app.scene.scene import Scene
from cardan.arrays import FloatArray
from cardan.arrays.errors import ArgumentTypeError, ArgumentValueError
from cardan.driveline import Driveline
from cardan.evaluation.outputs import Output
from cardan.evaluation.sweep import Sweep

if TYPE_CHECKING:
    from matplotlib.axes import Axes

TURN = Sweep.revolutions(721 / 720, 720)
"""A turn in steps of half a degree, both ends included."""

_PER_DEGREE = 2
MARKS = np.arange(0, 180, 30) * _PER_DEGREE
"""Samples of half a turn whose drive angles a path of vectors names."""


def period(line: Driveline) -> tuple[FloatArray, Sweep]:
    """Return the drive angles after which magnitudes repeat, in degrees and as a sweep."""
    per_turn = 360 * _PER_DEGREE
    count = round(period_of(line) / math.tau * per_turn) + 1
    return np.arange(count) / _PER_DEGREE, Sweep.revolutions(count / per_turn, per_turn)


def in_unit(output: Output, values: FloatArray) -> tuple[FloatArray, str]:
    """Return values of an output as they are shown, and the unit in brackets."""
    converted, unit = as_shown(values, output.unit)
    return converted, unit and f" [{unit}]"


def draw(
    axes: Axes,
    angle_deg: FloatArray,
    curves: Iterable[tuple[str, FloatArray]],
    scale: float = 1.0,
) -> None:
    """Draw curves by their labels, after those already drawn.

    Recorded angles need not rise, and NaN leaves a gap. ``scale`` is what values that are all 0
    would be measured in.
    """
    for place, (label, curve) in enumerate(curves, len(axes.get_lines())):
        axes.plot(angle_deg, curve, label=label, **line_style(place))
    first, last = float(np.nanmin(angle_deg)), float(np.nanmax(angle_deg))
    degree_ticks(axes.xaxis, first, last)
    drawn = np.concatenate([line.get_ydata() for line in axes.get_lines()])
    _frame(axes, first, last, drawn, scale)


def draw_stems(
    axes: Axes, orders: FloatArray, curves: Sequence[tuple[str, FloatArray]], width: float
) -> None:
    """Draw amplitudes by order as stems, those of one order side by side; none where they are 0.

    The stems of one order together have a width in orders.
    """
    apart = width / len(curves)
    for place, (label, sizes) in enumerate(curves):
        there = sizes > 0.0
        at = orders[there] + (place - (len(curves) - 1) / 2.0) * apart
        colour = line_style(place)["color"]
        axes.vlines(at, 0.0, sizes[there], color=colour)
        marker = MARKERS[place % len(MARKERS)]
        axes.plot(at, sizes[there], marker, color=colour, markersize=4.0, label=label)


def draw_bands(
    axes: Axes, bands: Bands, curves: Iterable[tuple[str, FloatArray]], scale: float = 1.0
) -> None:
    """Draw curves of many turns: bands of the extremes of each part, a line of its mean."""
    from matplotlib.colors import to_rgb
    from matplotlib.patches import StepPatch

    edges, drawn = bands.edges, []
    for place, (label, curve) in enumerate(curves):
        least, largest, mean = bands.extremes(curve)
        style = line_style(place)
        colour = to_rgb(style["color"])
        look: dict[str, Any] = {
            "baseline": least,
            "facecolor": (*colour, 0.22),
            "edgecolor": colour,
            "linewidth": 0.4,
            "fill": True,
        }
        axes.add_artist(StepPatch(largest, edges, **look))
        axes.plot((edges[:-1] + edges[1:]) / 2.0, mean, label=label, **style)
        drawn += [least, largest]
    value_ticks(axes.xaxis)
    _frame(axes, float(edges[0]), float(edges[-1]), np.concatenate(drawn), scale)


def _frame(axes: Axes, first: float, last: float, drawn: FloatArray, scale: float) -> None:
    """Set grid, ticks of the values and both limits."""
    axes.grid(visible=True)
    if last > first:
        axes.set_xlim(first, last)
    value_ticks(axes.yaxis)
    frame_values(axes, drawn, scale)


def frame_values(axes: Axes, drawn: FloatArray, scale: float) -> None:
    """Set the limits of the values; those missing, NaN, do not count."""
    low, high = float(np.nanmin(drawn)), float(np.nanmax(drawn))
    room = 0.05 * (high - low)
    axes.set_ylim(flat_limits(low, high, scale) or (low - room, high + room))


def names(
    line: Driveline, labels: Sequence[str] | None, components: Sequence[str] | None = None
) -> list[str]:
    """Return what to call the curves of a driveline or a batch, which must be as many."""
    if 0 in line.shape:
        raise ArgumentValueError("line", f"has shape {line.shape}; a picture needs a driveline")
    if components is not None:
        known = list(components)
    elif not line.shape:
        known = [""]
    elif line.n_joints == 1:
        known = [
            f"bend {number_text(bend, 'given')}°" for bend in np.degrees(line.bends[:, 0]).tolist()
        ]
    else:
        known = [f"driveline {i}" for i in range(line.shape[0])]
    return checked_labels(labels, known)


def checked_labels(labels: Sequence[str] | None, known: list[str]) -> list[str]:
    """Return labels of curves, by default the known ones, of which there are as many."""
    if labels is None:
        return known
    if isinstance(labels, str) or not isinstance(labels, Sequence):
        raise ArgumentTypeError("labels", f"is {labels!r}; it must be a list of texts")
    for i, label in enumerate(labels):
        if not isinstance(label, str):
            raise ArgumentTypeError("labels", f"is {label!r}; it must be a text", (i,))
    if len(labels) != len(known):
        raise ArgumentValueError(
            "labels", f"has {len(labels)} entries; there are {len(known)} curves"
        )
    return list(labels)


# --- what is along the panels of a scene's page: drive angles, turns, time or orders --------------

Over = Literal["turns", "time", "orders"]
"""Abscissa of a scene's curves."""

# Orders in steps of a quarter or less have a curve; between coarser ones nothing is known.
_FEWEST_OF_CURVES = 4

_Curves = Sequence[tuple[str, FloatArray]]


@dataclass(frozen=True, eq=False)
class Abscissa:
    """Abscissa of the panels, with a note on how to read them."""

    label: str
    note: str
    # Draws ``curves`` by their labels on axes; ``scale`` is what values that are all 0 would be
    # measured in.
    draw: Callable[..., None]
    is_of_samples: bool = True


def abscissa(scene: Scene, over: Over | None = None) -> Abscissa:
    """Return what to draw the curves of a scene over, by default as of ``plot_scene``.

    Up to three turns are drawn over the drive angle, or over the driven angle if the scene gives
    that, unless the time is asked for.
    """
    degrees = scene.drive_angle_deg
    if over == "time" and scene.time is None:
        raise ArgumentValueError("over", "is 'time'; the scene has no time_column_s")
    if over == "orders":
        return _orders(scene)
    if scene.time is not None and over != "turns":
        bands = Bands.of_time(scene.time, degrees)
    else:
        bands = Bands.of_turns(degrees)
    if bands is None and scene.time is not None and over == "time":
        return Abscissa("time [s]", "", partial(_over_time, time=scene.time))
    if bands is None:
        driven = scene.driven_angle_deg
        label = f"{'drive' if driven is None else 'driven'} angle [deg]"
        return Abscissa(label, "", partial(draw, angle_deg=degrees if driven is None else driven))
    note = f"Bands: from the least to the largest sample of each {bands.each}; lines: the mean."
    return Abscissa(bands.label, note, partial(draw_bands, bands=bands))


def _over_time(axes: Axes, curves: _Curves, scale: float, *, time: FloatArray) -> None:
    draw(axes, time, curves, scale)
    value_ticks(axes.xaxis)


def _orders(scene: Scene) -> Abscissa:
    angle = scene.drive_angle
    try:
        found = orders(angle, angle[np.newaxis])
    except ValueError as error:
        raise ArgumentValueError("over", f"is 'orders'; {error}") from None
    turns = f"{found.turns} turn{'s' if found.turns > 1 else ''}"
    note = (
        f"Amplitudes by order, from samples at equal steps of the drive angle over {turns}, less "
        "their linear trend"
    )
    if found.segments > 1:
        note += f"; root mean squares of {found.segments} such segments"
    draws = partial(_by_order, angle=angle)
    return Abscissa("order of the drive's rotation", f"{note}.", draws, is_of_samples=False)


def _by_order(axes: Axes, curves: _Curves, scale: float, *, angle: FloatArray) -> None:
    """Draw amplitudes by order, without that of order 0, the mean."""
    from matplotlib.ticker import MaxNLocator

    found = orders(angle, np.stack([values for _, values in curves]))
    # Below a billionth of the unit there is rounding only.
    sizes = np.where(found.amplitudes > 1e-9 * scale, found.amplitudes, 0.0)[:, 1:]
    drawn = [(label, row) for (label, _), row in zip(curves, sizes, strict=True)]
    if found.turns < _FEWEST_OF_CURVES:
        draw_stems(axes, found.orders[1:], drawn, 0.5 / found.turns)
    else:
        for place, (label, row) in enumerate(drawn):
            axes.plot(found.orders[1:], row, label=label, **line_style(place))
    axes.grid(visible=True)
    axes.set_xlim(0.0, float(found.orders[-1]) + 0.5 / found.turns)
    axes.xaxis.set_major_locator(MaxNLocator(12, integer=True))
    value_ticks(axes.yaxis)
    largest = float(np.max(sizes))
    axes.set_ylim(0.0, 1.05 * largest or scale)
    if not largest:
        axes.text(
            0.5, 0.5, "constant", transform=axes.transAxes, ha="center", va="center", color="0.35"
        )

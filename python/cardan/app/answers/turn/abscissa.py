"""What is along the panels of a scene's page: drive angles, turns, time or orders."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING, Literal

import numpy as np

import cardan.app.answers.turn.panel as panel
from cardan.app.answers.turn.orders import Bands, orders
from cardan.app.pictures.style import line_style, value_ticks
from cardan.app.scene.scene import Scene
from cardan.arrays import FloatArray
from cardan.arrays.errors import ArgumentValueError

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Over = Literal["turns", "time", "orders"]
"""What a scene's curves are drawn over."""

# Orders in steps of a quarter or less have a curve; between coarser ones nothing is known.
_FEWEST_OF_CURVES = 4

_Curves = Sequence[tuple[str, FloatArray]]


@dataclass(frozen=True, eq=False)
class Abscissa:
    """What is along the panels, and what must be known to read them."""

    label: str
    note: str
    # Draws ``curves`` by their labels on axes; ``scale`` is what values that are all 0 would be
    # measured in.
    draw: Callable[..., None]


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
        draw = partial(panel.draw, angle_deg=degrees if driven is None else driven)
        return Abscissa(f"{'drive' if driven is None else 'driven'} angle [deg]", "", draw)
    note = f"Bands: from the least to the largest sample of each {bands.each}; lines: the mean."
    return Abscissa(bands.label, note, partial(panel.draw_bands, bands=bands))


def _over_time(axes: Axes, curves: _Curves, scale: float, *, time: FloatArray) -> None:
    panel.draw(axes, time, curves, scale)
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
    return Abscissa("order of the drive's rotation", f"{note}.", partial(_by_order, angle=angle))


def _by_order(axes: Axes, curves: _Curves, scale: float, *, angle: FloatArray) -> None:
    """Draw amplitudes by order, without that of order 0, the mean."""
    from matplotlib.ticker import MaxNLocator

    found = orders(angle, np.stack([values for _, values in curves]))
    # Below a billionth of the unit there is rounding only.
    sizes = np.where(found.amplitudes > 1e-9 * scale, found.amplitudes, 0.0)[:, 1:]
    drawn = [(label, row) for (label, _), row in zip(curves, sizes, strict=True)]
    if found.turns < _FEWEST_OF_CURVES:
        panel.draw_stems(axes, found.orders[1:], drawn, 0.5 / found.turns)
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

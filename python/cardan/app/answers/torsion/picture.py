"""Torsional vibration: response over speed, Campbell diagram, stability over speed and bend."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

import cardan.app.pictures.style as style
from cardan.app.answers.answer import Answer
from cardan.app.answers.page import Curve, Panel, chart
from cardan.app.answers.printed import quantity, with_unit
from cardan.app.answers.rows import UNITS
from cardan.app.answers.torsion.figures import CriticalSpeed, TorsionFigures, motions_of
from cardan.app.scene.language.units import RPM, shown_unit
from cardan.arrays.errors import ArgumentValueError
from cardan.torsion.analyses import harmonic_orders, has_kinks

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_SPEED = "drive speed [rpm]"
_PANEL, _AROUND = 42.0, 16.0  # mm
_BAND, _UNSTABLE, _MISSING = "#BFD9EA", "#D55E00", "0.6"
_CRITICAL: Mapping[str, Any] = {**style.THIN, "linestyle": (0, (4, 1.5))}
_OF_TORQUES = (0, (3, 1))
_DRIVE = (0, "input")
# Speeds around those with several motions that are searched for each of them, and how far away.
_SEARCHED, _BESIDE = 9, 0.04
# Points of a map; more would not be seen at 80 mm.
_SPEEDS, _BENDS = 121, 41
# The map goes up to this bend in degrees, or to twice the bend of the scene.
_LEAST_TOP, _MOST_TOP = 40.0, 85.0


def drawn(_: Answer, found: TorsionFigures) -> dict[str, Any]:
    """Return the torques of each compliant shaft over the speed as charts of the page."""
    classes = {"unstable": "bad", "clear": "good"}
    known, charts = found.steady.found, []
    # Speeds without a periodic motion are left out.
    for place, shaft in enumerate(found.steady.compliant if np.count_nonzero(known) > 1 else ()):
        curves = tuple(
            Curve(label, getattr(found.steady, f"torque_{name}")[place][known])
            for label, name in (("largest", "max"), ("mean", "mean"), ("least", "min"))
        )
        scale = float(max(np.max(np.abs(curve.values)) for curve in curves))
        panel = Panel(f"Torque of shaft {shaft} over a turn", "N m", curves, scale)
        charts.append(chart(panel, found.speed[known] / RPM, "drive speed [rpm]"))
    return {"class": classes.get(found.verdict, "fair"), "charts": charts}


def plot_torsion(found: TorsionFigures, title: str = "") -> Figure:
    """Return a figure 80 mm wide with the torques of each compliant shaft over the drive speed.

    Args:
        found: the figures of a scene, from ``cardan.app.answers.torsion.figures.torsion_figures``.
        title: over the picture, or "".
    """
    style.check_kind("found", found, TorsionFigures)
    shafts = found.steady.compliant
    with style.page(style.WIDTH, _AROUND + _PANEL * len(shafts), title) as figure:
        panels = figure.subplots(len(shafts), squeeze=False, sharex=True)[:, 0]
        for axes, shaft in zip(panels, shafts, strict=True):
            plot_torsion_response(found, shaft, ax=axes)
            axes.label_outer()
            if shaft != shafts[0]:
                axes.get_legend().remove()
    return figure


def plot_torsion_response(
    found: TorsionFigures, shaft: int | None = None, *, ax: Axes | None = None
) -> Axes:
    """Draw least, mean and largest torque of a shaft over the drive speed, resonances marked.

    Of an engine the amplitude of the largest order of the drive is drawn as well. Where a search
    found several motions, each of them is marked around there.

    Args:
        found: the figures of a scene, from ``cardan.app.answers.torsion.figures.torsion_figures``.
        shaft: a compliant shaft; by default the first.

    Raises:
        ValueError: a shaft that is not compliant.
    """
    style.check_kind("found", found, TorsionFigures)
    compliant = found.steady.compliant
    chosen = compliant[0] if shaft is None else shaft
    if chosen not in compliant:
        known = ", ".join(map(str, compliant))
        raise ArgumentValueError("shaft", f"is {chosen}; compliant shafts: {known}")
    place = compliant.index(chosen)
    least, mean, most = (
        UNITS[shown_unit("Nm")].factor * getattr(found.steady, f"torque_{name}")[place]
        for name in ("min", "mean", "max")
    )
    rpm = found.speed / RPM
    with style.drawing(ax, height_mm=_AROUND + _PANEL) as axes:
        axes.fill_between(rpm, least, most, color=_BAND, linewidth=0.0, label="over a turn")
        axes.plot(rpm, most, **{**style.LINES[0], "linewidth": 0.8})
        axes.plot(rpm, least, **{**style.LINES[0], "linewidth": 0.8})
        axes.plot(rpm, mean, label="mean", **style.LINES[1])
        axes.axhline(0.0, **{**style.THIN, "linewidth": 0.5})
        _draw_order(axes, found, place)
        _draw_motions(axes, found, chosen)
        _mark_ranges(axes, found)
        _mark_critical(axes, found)
        torque = with_unit(f"torque of shaft {chosen}", "Nm")
        style.finish(axes, _SPEED, torque, (rpm[0], rpm[-1]))
        axes.set_axisbelow(True)
    return axes


def _draw_order(axes: Axes, found: TorsionFigures, place: int) -> None:
    """Draw the amplitude of the largest order of the torques on the drive, if there are any."""
    own = [each for each in found.torsion.system.harmonics if (each.shaft, each.end) == _DRIVE]
    if not own:
        return
    order = max(own, key=lambda each: each.amplitude).order
    column = found.steady.orders.tolist().index(order)
    size = UNITS[shown_unit("Nm")].factor * np.abs(found.steady.torque_orders[place, :, column])
    axes.plot(found.speed / RPM, size, label=f"order {order:g}", **style.LINES[2])


def _draw_motions(axes: Axes, found: TorsionFigures, shaft: int) -> None:
    """Mark the largest torque in each motion where there are several, hollow if unstable."""
    factor, known = UNITS[shown_unit("Nm")].factor, found.motions
    several = [motions.speed for motions in known if motions.number > 1]
    if several and not has_kinks(found.torsion.system):
        near = np.outer(several, 1.0 + _BESIDE * np.linspace(-1.0, 1.0, _SEARCHED)).ravel()
        inside = near[(near >= found.speed[0]) & (near <= found.speed[-1])]
        known = tuple(map(motions_of, found.torsion.system.side_by_side(inside)))
    for stable, face, label in ((True, "k", "stable motion"), (False, "w", "unstable motion")):
        points = [
            (motions.speed / RPM, factor * each.size)
            for motions in known
            if motions.number > 1 and motions.shaft == shaft
            for each in motions.each
            if each.stable == stable
        ]
        if points:
            look: dict[str, Any] = {"markersize": 2.5, "markerfacecolor": face, "color": "k"}
            look |= {"marker": "o", "linestyle": "none", "markeredgewidth": 0.6}
            axes.plot(*np.array(points).T, label=label, **look)


def _mark_ranges(axes: Axes, found: TorsionFigures) -> None:
    """Mark speeds at which the motion is unstable, or not known."""
    known = (("unstable", _UNSTABLE, "////"), ("not known", _MISSING, "...."))
    for (label, colour, hatch), parts in zip(known, (found.unstable, found.missing), strict=True):
        look: dict[str, Any] = {"facecolor": "none", "edgecolor": colour, "hatch": hatch}
        for number, part in enumerate(parts):
            name = label if number == 0 else None
            axes.axvspan(part.start / RPM, part.stop / RPM, linewidth=0.0, label=name, **look)


def _mark_critical(axes: Axes, found: TorsionFigures) -> None:
    """Draw a line at each critical speed that the joints excite; its order at the top."""
    across = axes.get_xaxis_transform()
    written: list[float] = []
    span = (found.speed[-1] - found.speed[0]) / RPM
    for number, critical in enumerate(_excited(found)):
        speed = critical.speed / RPM
        label = "critical, with order" if number == 0 else None
        axes.axvline(speed, label=label, **_CRITICAL)
        # Labels of lines that lie close to each other would cover each other.
        if all(abs(speed - other) > 0.04 * span for other in written):
            axes.annotate(
                f"{critical.order:g}",
                (speed, 1.0),
                xycoords=across,
                xytext=(1.5, -1.5),
                textcoords="offset points",
                va="top",
            )
            written.append(speed)


def _excited(found: TorsionFigures) -> list[CriticalSpeed]:
    """The critical speeds of even orders in the range, those with larger torques first."""
    return sorted(
        found.resonances, key=lambda part: np.inf if part.amplitude is None else part.amplitude
    )[::-1]


def plot_campbell(found: TorsionFigures, *, ax: Axes | None = None) -> Axes:
    """Draw natural frequencies and the frequencies of the orders over the drive speed.

    Where a line of an order crosses a natural frequency there is a critical speed. Orders of
    harmonic torques are dashed. The speed range of the scene is shaded.
    ``found`` is as for ``plot_torsion_response``.
    """
    style.check_kind("found", found, TorsionFigures)
    low, high = float(found.speed[0]) / RPM, float(found.speed[-1]) / RPM
    right = 1.05 * high
    if not _excited(found):
        # Up to the next critical speed, unless it is far away.
        above = [part.speed / RPM for part in found.critical_speeds if part.speed / RPM > high]
        right = min([1.1 * speed for speed in above if speed < 2.0 * high], default=right)
    with style.drawing(ax, height_mm=_AROUND + _PANEL) as axes:
        axes.axvspan(low, high, color="0.93", linewidth=0.0, label="speed range")
        frequencies = [mode.frequency / (2.0 * np.pi) for mode in found.modes]
        for number, frequency in enumerate(frequencies):
            axes.axhline(frequency, label="natural frequency" if number == 0 else None, **_CRITICAL)
        _draw_orders(axes, found, right, 1.25 * max(frequencies))
        crossings = [
            (part.speed / RPM, found.modes[part.mode].frequency / (2.0 * np.pi))
            for part in found.critical_speeds
        ]
        points = np.array(crossings).reshape(-1, 2)
        axes.plot(*points.T, "ko", markersize=3.0, linestyle="none", clip_on=True)
        style.finish(axes, _SPEED, "frequency [Hz]", (0.0, right), (0.0, 1.25 * max(frequencies)))
        axes.set_axisbelow(True)
        _name_modes(axes, found)
    return axes


def _draw_orders(axes: Axes, found: TorsionFigures, right: float, top: float) -> None:
    """Draw the frequency of each order. The names of many orders stand at their lines."""
    orders, of_torques = found.torsion.orders, harmonic_orders(found.torsion.system)
    many = len(orders) > len(style.LINES)
    for number, order in enumerate(orders):
        dashes = _OF_TORQUES if order in of_torques else "-"
        look = {**style.LINES[number % len(style.LINES)], "linestyle": dashes}
        label = None if many else f"order {order:g}"
        axes.plot([0.0, right], [0.0, order * right / 60.0], label=label, **look)
        if many:
            end = min(right, 60.0 * top / order)
            # Below a flat line, and to the right of a steep one.
            side = 1.0 if end < 0.9 * right else -1.0
            name: dict[str, Any] = {"xytext": (2.0 * side, -2.0), "textcoords": "offset points"}
            name |= {"ha": "left" if side > 0.0 else "right", "va": "top"}
            axes.annotate(f"{order:g}", (end, order * end / 60.0), **name)
    if many:
        axes.plot([], [], label="order", **style.THIN)
    if of_torques:
        axes.plot([], [], label="of torques", **{**style.THIN, "linestyle": _OF_TORQUES})


def _name_modes(axes: Axes, found: TorsionFigures) -> None:
    """Write frequency and shaft of each mode beside the axes, where no line crosses them."""
    top, names = axes.get_ylim()[1], found.torsion.names
    # Two lines each, and as far from each other as they need.
    height = _PANEL - _AROUND / 2.0
    apart = 2.2 * 25.4 / 72.0 * 7.0 / height * top
    below = -math.inf
    for mode in sorted(found.modes, key=lambda mode: mode.frequency):
        frequency = mode.frequency / math.tau
        below = max(frequency, below + apart)
        name = names[mode.shaft] if names else f"shaft {mode.shaft}"
        axes.annotate(
            f"{quantity(mode.frequency, 'Hz')}\n{name}",
            (1.0, below),
            xycoords=axes.get_yaxis_transform(),
            xytext=(3.0, 0.0),
            textcoords="offset points",
            va="center",
            linespacing=1.0,
            annotation_clip=False,
        )


def plot_stability(
    found: TorsionFigures, joint: int | None = None, *, ax: Axes | None = None
) -> Axes:
    """Draw where the motion is unstable, over drive speed and the bend of one joint.

    The bends go from 0 to 40°, or to twice the bend of the scene if that is more, up to 85°. The
    other joints have the bends of the scene.

    Args:
        found: the figures of a scene, from ``cardan.app.answers.torsion.figures.torsion_figures``.
        joint: which joint; by default the one with the largest bend.

    Raises:
        ValueError: a joint that does not exist.
    """
    style.check_kind("found", found, TorsionFigures)
    bends = np.degrees(found.torsion.system.line.bends)
    top = min(_MOST_TOP, max(_LEAST_TOP, 2.0 * float(np.max(bends))))
    speed = np.linspace(found.speed[0], found.speed[-1], _SPEEDS)
    bend = np.radians(np.linspace(0.0, top, _BENDS))
    grid = found.torsion.system.stability_map(speed, bend, joint)
    rpm, degrees = grid.speed / RPM, np.degrees(grid.bend)
    with style.drawing(ax, height_mm=_AROUND + _PANEL) as axes:
        from matplotlib.patches import Patch

        shown = (
            ("unstable", _UNSTABLE, np.where(grid.found, grid.largest, 1.0), 1.0 + 1e-9),
            ("not known", _MISSING, np.where(grid.found, 0.0, 1.0), 0.5),
        )
        handles: list[Any] = []
        for label, colour, values, edge in shown:
            if np.any(values > edge):
                axes.contourf(rpm, degrees, values, levels=[edge, np.inf], colors=[colour])
                handles.append(Patch(facecolor=colour, label=label))
        handles.append(axes.axhline(bends[grid.joint], label="bend of the scene", **_CRITICAL))
        if np.all(grid.stable):
            axes.annotate("stable", (0.5, 0.5), xycoords="axes fraction", ha="center")
        axes.set_xlabel(_SPEED)
        axes.set_ylabel(f"bend of joint {grid.joint} [deg]")
        style.value_ticks(axes.xaxis)
        style.degree_ticks(axes.yaxis, 0.0, float(degrees[-1]))
        style.legend_above(axes, handles=handles)
    return axes


def _needed(answer: Answer) -> TorsionFigures:
    found = answer.needed("torsion")
    assert isinstance(found, TorsionFigures)
    return found


def _response(answer: Answer) -> Figure:
    """Torques of compliant shafts over the drive speed."""
    return plot_torsion(_needed(answer), answer.of.title)


def _campbell(answer: Answer) -> Figure:
    """Natural frequencies and orders over the drive speed."""
    return _alone(plot_campbell, answer)


def _stability(answer: Answer) -> Figure:
    """Where the motion is unstable, over drive speed and bend."""
    return _alone(plot_stability, answer)


def _alone(draw: Callable[..., Axes], answer: Answer) -> Figure:
    found = _needed(answer)
    return style.stacked([(_AROUND + _PANEL, lambda axes: draw(found, ax=axes))], answer.of.title)


PICTURES = {"torsion": _response, "campbell": _campbell, "stability": _stability}

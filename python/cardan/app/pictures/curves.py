"""Quantities over the turn and by order, of drivelines or a result; double joints over the bend."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

import cardan.app.answers.turn.panel as panel
import cardan.app.pictures.style as style
from cardan.arrays import as_float64, one_number
from cardan.arrays.errors import ArgumentValueError, check_shape
from cardan.arrays.indices import item_index
from cardan.driveline import Driveline
from cardan.evaluation.load import Load
from cardan.evaluation.outputs import OUTPUTS, Output, checked
from cardan.evaluation.result import Result
from cardan.evaluation.sweep import Sweep

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def plot_curves(
    line: Driveline,
    output: str = "angle_error",
    *,
    shaft: int = -1,
    joint: int = 0,
    bearing: int = 0,
    load: Load | None = None,
    angle: ArrayLike | Sweep | None = None,
    labels: Sequence[str] | None = None,
    ax: Axes | None = None,
) -> Axes:
    """Draw a quantity over the drive angle.

    A batch ``(m,)`` gives one curve per driveline, a vector one per component (``x``, ``y``, ``z``
    of the driveline's own axes). Further calls with the same ``ax`` add to its curves.

    Args:
        line: one driveline, or for a quantity that is no vector a batch of one dimension.
        output: name from ``cardan.OUTPUTS``.
        shaft: of which shaft, if it is a quantity of shafts.
        joint: of which joint, if it is a quantity of joints.
        bearing: of which bearing, if it is a quantity of bearings.
        load: the load, for the outputs that need one.
        angle: drive angles in rad, ``(samples,)``, or a ``Sweep``; by default a turn in
            steps of half a degree.
        labels: what to call the curves; by default components, bends of single joints or numbers.

    Returns:
        the axes, with angles in degrees.

    Raises:
        IndexError: a shaft, joint or bearing that does not exist.
        ValueError: an unknown output, a load that is missing, a batch of more dimensions or of
            vectors, labels that do not fit, more curves than can be told apart.
    """
    style.check_kind("line", line, Driveline)
    style.check_kind("output", output, str)
    what = OUTPUTS[checked(output)[0]]
    if len(line.shape) > (0 if what.vector else 1):
        fits = "one driveline" if what.vector else "one driveline or a batch of one dimension"
        raise ArgumentValueError(
            "line", f"has shape {line.shape}; a picture of {output} shows {fits}"
        )
    turn = panel.TURN if angle is None else angle
    turn = turn if isinstance(turn, Sweep) else as_float64("angle", turn)
    right = len(turn.shape) == 1 and turn.shape != (0,)
    check_shape("angle", turn, right, "a curve needs (samples,)")
    asked, count = {
        "shaft": (shaft, line.n_joints + 1),
        "joint": (joint, line.n_joints),
        "bearing": (bearing, line.n_bearings),
    }[what.per]
    batch = line[:, np.newaxis] if line.shape else line
    found = batch.evaluate(turn, (output,), shafts=shaft, joints=joint, load=load)[output]
    item = item_index(what.per, asked, count)
    found = found[item] if what.per == "bearing" else found
    values, unit = panel.in_unit(what, found)
    rows = values.T if what.vector else np.atleast_2d(values)
    names = panel.names(line, labels, "xyz" if what.vector else None)
    with style.drawing(ax) as axes:
        panel.draw(axes, np.degrees(turn), zip(names, rows, strict=True))
        style.finish(axes, "drive angle [deg]", f"{what.label}\n{what.per} {item}{unit}")
    return axes


def plot_harmonics(
    line: Driveline,
    quantity: Literal["angle_error", "speed_ratio"] = "angle_error",
    *,
    orders: ArrayLike = (2, 4, 6, 8),
    shaft: int = -1,
    labels: Sequence[str] | None = None,
    ax: Axes | None = None,
) -> Axes:
    """Draw the amplitudes of a shaft's motion over the order, on a logarithmic scale.

    A batch ``(m,)`` is drawn side by side. Amplitudes of 0 stay out.

    Args:
        line: one driveline or a batch of one dimension.
        quantity: which motion.
        orders: multiples of the drive's speed; odd ones have no amplitude.
        shaft: index of the shaft, by default the last.
        labels: what to call the drivelines of a batch.

    Raises:
        IndexError: a shaft that does not exist.
        ValueError: an unknown quantity, an order below 1, a batch of more dimensions or more than
            can be told apart, labels that do not fit.
    """
    style.check_kind("line", line, Driveline)
    if quantity not in ("angle_error", "speed_ratio"):
        raise ArgumentValueError("quantity", f"is {quantity!r}; known are angle_error, speed_ratio")
    if len(line.shape) > 1:
        raise ArgumentValueError(
            "line", f"has shape {line.shape}; a picture shows a batch of one dimension"
        )
    item = item_index("shaft", shaft, line.n_joints + 1)
    found = line.harmonics(orders, shaft)
    amplitudes, unit = panel.in_unit(OUTPUTS[quantity], np.atleast_2d(getattr(found, quantity)))
    names = panel.names(line, labels)
    with style.drawing(ax, height_mm=45.0) as axes:
        curves = list(zip(names, amplitudes, strict=True))
        width = 0.8 * float(np.min(np.diff(np.unique(found.orders)), initial=2))
        panel.draw_stems(axes, np.asarray(found.orders, np.float64), curves, width)
        if np.any(amplitudes > 0.0):
            least = float(np.min(amplitudes[amplitudes > 0.0]))
            axes.set_yscale("log")
            axes.set_ylim(10.0 ** math.floor(math.log10(least) - 0.1), None)
        axes.set_xticks(found.orders)
        axes.set_xlabel("order of the drive's rotation")
        axes.set_ylabel(f"{quantity.replace('_', ' ')}\nshaft {item}{unit}")
        axes.grid(visible=True, axis="y")
        if any(names):
            style.legend_above(axes)
    return axes


_PANEL, _FRAME = 32.0 * style.MM, 10.0 * style.MM


def plot_result(result: Result) -> Figure:
    """Draw every output of a result over the drive angle, one panel per output.

    A panel has one curve per shaft, joint or bearing, driveline and component.

    Args:
        result: one that ``Driveline.evaluate`` has returned, over a row of angles.

    Returns:
        a figure of pyplot, 80 mm wide, with angles in degrees.

    Raises:
        ValueError: a result without a row of drive angles, more curves than can be told apart.
    """
    style.check_kind("result", result, Result)
    result = result.compute()
    angle = np.asarray(result.drive_angle)
    assert result._labels is not None  # drive_angle has raised without labels
    if angle.ndim != 1 or result._labels[3] is not None:
        raise ArgumentValueError(
            "result", "is not over a row of drive angles; a curve needs (samples,) of them"
        )
    if result.units["drive_angle"] == "rad":
        angle = np.degrees(angle)
    curves = {name: _curves(result, OUTPUTS[name], len(angle)) for name in result}
    with style.matplotlib().rc_context(style.STYLE):
        from matplotlib import pyplot

        height = _FRAME + _PANEL * len(curves)
        figure, rows = pyplot.subplots(
            len(curves),
            figsize=(style.WIDTH * style.MM, height),
            layout="constrained",
            sharex=True,
            squeeze=False,
        )
        for axes, (name, (labels, values)) in zip(rows[:, 0], curves.items(), strict=True):
            output, unit = OUTPUTS[name], result.units[name]
            if unit == "rad":
                values, unit = np.degrees(values), "deg"
            panel.draw(axes, angle, zip(labels, values, strict=True))
            axes.set_ylabel(output.label + ("" if unit == "1" else f"\n[{unit}]"))
            if len(labels) > 1:
                style.legend_above(axes)
        rows[-1, 0].set_xlabel("drive angle [deg]")
    return figure


def _curves(result: Result, output: Output, samples: int) -> tuple[list[str], NDArray[Any]]:
    """Labels and values of the curves of one output, ``(curves, samples)``."""
    assert result._labels is not None
    shafts, joints, *_ = result._labels
    items = {"shaft": shafts, "joint": joints, "bearing": result._bearings}[output.per]
    array = np.asarray(result[output.name])
    parts = [f"{output.per} {item}" for item in np.atleast_1d(items)]
    components = ["x", "y", "z"] if output.vector else [""]
    per_item = array.reshape(len(parts), -1, samples, len(components))
    lines = [f"driveline {i}" for i in range(per_item.shape[1])]
    lines = lines if len(lines) > 1 else [""]
    labels = [
        ", ".join(filter(None, (part, line, component)))
        for part in parts
        for line in lines
        for component in components
    ]
    if len(labels) > len(style.LINES):
        # The bearings are evaluated all or not at all.
        fewer = (
            "draw each bearing with cardan.plots.plot_curves"
            if output.per == "bearing"
            else "evaluate fewer shafts, joints or drivelines"
        )
        raise ArgumentValueError(
            "result",
            f"has {len(labels)} curves of {output.name}; a picture shows at most "
            f"{len(style.LINES)} that can be told apart, so {fewer}",
        )
    return labels, np.moveaxis(per_item, 3, 2).reshape(len(labels), samples)


_STEPS = 400


def plot_double_joint(
    length: float,
    synchronous_deg: float,
    *,
    wear: float = 0.0,
    largest_deg: float = 50.0,
    ax: Axes | None = None,
) -> Axes:
    """Draw the equivalent bend of a centred double joint over its total bend.

    Args:
        length: distance between the joint centres.
        synchronous_deg: total bend in degrees at which the double joint is synchronous.
        wear: by how much a worn pivot is off along the driving shaft, in the unit of the length;
            0 for the joint without wear alone, else both directions are drawn as well.
        largest_deg: total bend in degrees up to which it is drawn.

    Raises:
        ValueError: as for ``Driveline.from_double_joint``.
    """
    length, wear = one_number("length", length), one_number("wear", wear)
    synchronous_deg = one_number("synchronous_deg", synchronous_deg)
    largest_deg = one_number("largest_deg", largest_deg)
    total = np.linspace(0.0, largest_deg, _STEPS + 1)
    place = 0.5 * length / np.cos(0.5 * np.radians(synchronous_deg))
    pivots = [("as drawn", place)]
    if wear:
        away, near = "pivot %g farther", "pivot %g nearer"
        pivots += [(away % abs(wear), place + abs(wear)), (near % abs(wear), place - abs(wear))]
    with style.drawing(ax) as axes:
        for i, (label, pivot) in enumerate(pivots):
            # Where both bends are equal the curve has a corner, which samples would miss.
            corner = 2.0 * np.degrees(np.arccos(min(1.0, 0.5 * length / pivot)))
            drawn = np.sort(np.append(total, min(corner, largest_deg)))
            line = Driveline.from_double_joint(drawn, length, pivot, degrees=True)
            bend = np.degrees(line.equivalent().bend)
            axes.plot(drawn, bend, label=label, **style.line_style(i))
        ends = (0.0, largest_deg), (0.0, None)
        style.finish(axes, "total bend [deg]", "equivalent bend [deg]", *ends)
    return axes

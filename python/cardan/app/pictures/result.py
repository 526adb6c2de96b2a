"""The outputs of an evaluation over its drive angles."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

import cardan.app.answers.turn.panel as panel
from cardan.app.pictures.style import LINES, MM, STYLE, WIDTH, legend_above, matplotlib
from cardan.arrays.errors import ArgumentValueError
from cardan.evaluation.outputs import OUTPUTS, Output
from cardan.evaluation.result import Result

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_PANEL, _FRAME = 32.0 * MM, 10.0 * MM


def plot_result(result: Result) -> Figure:
    """Draw every output of a result over the drive angle, one panel per output.

    A panel has one curve per shaft, joint or bearing, driveline and component.

    Args:
        result: one that ``Driveline.evaluate`` has returned, over a row of angles.

    Returns:
        a figure of pyplot, 80 mm wide, with angles in degrees.

    Raises:
        ImportError: matplotlib is missing.
        ValueError: a result without a row of drive angles, more curves than can be told apart.
    """
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
    with matplotlib().rc_context(STYLE):
        from matplotlib import pyplot

        height = _FRAME + _PANEL * len(curves)
        figure, rows = pyplot.subplots(
            len(curves),
            figsize=(WIDTH * MM, height),
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
                legend_above(axes)
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
    if len(labels) > len(LINES):
        # The bearings are evaluated all or not at all.
        fewer = (
            "draw each bearing with cardan.plots.plot_curves"
            if output.per == "bearing"
            else "evaluate fewer shafts, joints or drivelines"
        )
        raise ArgumentValueError(
            "result",
            f"has {len(labels)} curves of {output.name}; a picture shows at most {len(LINES)} "
            f"that can be told apart, so {fewer}",
        )
    return labels, np.moveaxis(per_item, 3, 2).reshape(len(labels), samples)

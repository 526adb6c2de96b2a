"""One quantity over the turn, of a driveline or of several to compare."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

import cardan.app.answers.turn.panel as panel
from cardan.app.pictures.style import drawing, legend_above
from cardan.arrays import as_float64
from cardan.arrays.errors import ArgumentValueError
from cardan.arrays.indices import item_index
from cardan.driveline import Driveline
from cardan.evaluation.load import Load
from cardan.evaluation.outputs import OUTPUTS, checked
from cardan.evaluation.sweep import Sweep

if TYPE_CHECKING:
    from matplotlib.axes import Axes


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
        ax: where to draw; by default on a new figure of pyplot, 80 mm wide.

    Returns:
        the axes, with angles in degrees.

    Raises:
        ImportError: matplotlib is missing.
        IndexError: a shaft, joint or bearing that does not exist.
        ValueError: an unknown output, a load that is missing, a batch of more dimensions or of
            vectors, labels that do not fit, more curves than can be told apart.
    """
    what = OUTPUTS[checked(output)[0]]
    if len(line.shape) > (0 if what.vector else 1):
        fits = "one driveline" if what.vector else "one driveline or a batch of one dimension"
        raise ArgumentValueError(
            "line", f"has shape {line.shape}; a picture of {output} shows {fits}"
        )
    turn = panel.TURN if angle is None else angle
    turn = turn if isinstance(turn, Sweep) else as_float64("angle", turn)
    if len(turn.shape) != 1:
        raise ArgumentValueError("angle", f"has shape {turn.shape}; a curve needs (samples,)")
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
    with drawing(ax) as axes:
        panel.draw(axes, np.degrees(turn), zip(names, rows, strict=True))
        axes.set_xlabel("drive angle [deg]")
        axes.set_ylabel(f"{what.label}\n{what.per} {item}{unit}")
        if axes.get_legend_handles_labels()[1]:
            legend_above(axes)
    return axes

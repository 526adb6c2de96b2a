"""The speed of a drive of finite inertia over the turn."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

import cardan.app.answers.turn.panel as panel
from cardan.app.answers.answer import Answer
from cardan.app.answers.printed import given
from cardan.app.pictures.style import check_single, drawing, finish, stacked
from cardan.arrays import finite
from cardan.arrays.errors import check_shape
from cardan.driveline import Driveline

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def plot_drive_speed(
    line: Driveline,
    inertias: ArrayLike,
    *,
    labels: Sequence[str] | None = None,
    ax: Axes | None = None,
) -> Axes:
    """Draw the speed of the freely running drive over its mean, for one or several inertias.

    Args:
        line: one driveline.
        inertias: moment of inertia of each shaft in kg m², ``(n + 1,)``, or several such rows.
        labels: what to call the rows; by default the inertia of shaft 0.
        ax: where to draw; by default on a new figure of pyplot, 80 mm wide.

    Raises:
        ValueError: labels that are not one per row, more rows than can be told apart, and as for
            ``Driveline.free_running``.
    """
    check_single(line)
    rows = np.atleast_2d(finite("inertias", inertias))
    check_shape("inertias", rows, rows.ndim == 2 and rows.size > 0, "it must be (rows, n + 1)")
    known = [given(float(row[0]), "kgm2") for row in rows]
    names = panel.checked_labels(labels, known)
    turn = np.asarray(panel.TURN)
    free = line.free_running(rows)
    curves = np.moveaxis(np.asarray(free.speed_ratio(turn[:, np.newaxis])), -1, 0)
    with drawing(ax) as axes:
        drawn = list(zip(names, 100.0 * (curves - 1.0), strict=True))
        panel.draw(axes, np.degrees(turn), drawn)
        finish(axes, "drive angle [deg]", "drive speed, off its mean [%]")
    return axes


def _whole(answer: Answer) -> Figure:
    """Speed of the freely running drive over the turn."""
    scene, found = answer.scene, answer["drive_speed"]
    if found is None or found.verdict == "no drive inertia":
        raise ValueError(
            f"{scene.name}: the speed of the drive varies with a speed and inertias of shaft 0 and "
            "of a shaft behind a joint in [load], and fixed bends"
        )
    if scene.states:
        scene = scene.in_state(scene.states.names.index(found.state))
    line, load = scene.line, scene.load_case
    inertias = None if load is None else load.inertias
    assert inertias is not None
    return stacked([(50.0, lambda axes: plot_drive_speed(line, inertias, ax=axes))], scene.title)


PICTURES = {"drive_speed": _whole}
"""The pictures of the part by name."""

"""Whether a constant speed of the drive is a fair assumption, as a check reports it.

The loads of a scene assume a constant drive speed, or a given acceleration. A drive of finite
inertia gives way. The rule is this program's own: the assumption is fair while the drive, running
freely, varies by no more than a tenth of the variation of the shaft whose kinetic energy varies
most. For one joint that ratio is close to the driven inertia over the whole inertia, and inertia
torques are overestimated by about this share. D. Thoma (1920) asks for so large a drive without a
figure; ten times the driven inertia is just within the rule.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import ArrayLike

import cardan.app.answers.turn.panel as panel
from cardan.app.answers.answer import Answer
from cardan.app.answers.printed import given, quantity
from cardan.app.answers.rounding import is_cancelled
from cardan.app.answers.rows import count, figure, word
from cardan.app.pictures.style import check_single, drawing, finish, stacked
from cardan.app.scene.scene import Scene
from cardan.arrays import finite
from cardan.arrays.errors import check_shape
from cardan.driveline import Driveline

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


SHARE = 0.1
"""The largest share that is fair."""

SOURCE = "rule of this program"
"""Source of the share."""

SpeedVerdict = Literal["fair", "not fair", "no drive inertia"]


@dataclass(frozen=True)
class DriveSpeed:
    """How constant the speed of a drive is; variations are from peak to peak."""

    verdict: SpeedVerdict = word("constant speed", "whether that is a fair assumption")
    state: str = word("in the state", "the one that needs the largest inertia")
    variation: float = figure(
        "variation of the drive", "percent", "of its speed over the mean speed, running freely"
    )
    shaft: int = count("shaft that varies most", "in kinetic energy, at constant drive speed")
    shaft_variation: float = figure(
        "variation of that shaft", "percent", "of its speed, at constant drive speed"
    )
    share: float = figure(
        "share of the drive",
        "percent",
        "variation of the drive over that of the shaft",
        source=f"{SOURCE}: fair up to 10 %",
    )
    inertia: float = figure("inertia of shaft 0", "kgm2", digits="given")
    needed: float = figure(
        "needed inertia of shaft 0",
        "kgm2",
        "least that makes the assumption fair",
        rounds="up",
    )


def find(answer: Answer) -> DriveSpeed | None:
    """Return how constant the speed of a scene's drive is, in the worst of its states.

    ``None`` where nothing depends on it: no speed, no inertia behind a joint, no variation, and
    for recorded bends or speeds; a measured drive shows how it gives way.
    """
    scene = answer.scene
    if scene.states is None:
        return _of(scene)
    each = {name: _of(scene.in_state(i)) for i, name in enumerate(scene.states.names)}
    known = [replace(found, state=name) for name, found in each.items() if found]
    return max(known, key=lambda found: found.needed, default=None)


def _of(scene: Scene) -> DriveSpeed | None:
    load, line = scene.load_case, scene.line
    if load is None or load.inertias is None or line.shape or not scene.speed:
        return None
    if scene.speed_recorded:
        return None
    inertias = np.asarray(load.inertias, dtype=np.float64)
    varying = {}
    for shaft in range(1, line.n_joints + 1):
        joint = line.equivalent(shaft)
        if inertias[shaft] > 0.0 and not is_cancelled(line, joint):
            varying[shaft] = float(joint.non_uniformity)
    if not any(varying.values()):
        return None
    shaft = max(varying, key=lambda shaft: inertias[shaft] * varying[shaft])
    shaft_variation = varying[shaft]
    free = line.free_running(inertias)
    needed = float(free.drive_inertia_for(SHARE * shaft_variation))
    verdict: SpeedVerdict = "no drive inertia"
    if inertias[0] > 0.0:
        verdict = "fair" if free.variation <= SHARE * shaft_variation else "not fair"
    variation = float(free.variation)
    return DriveSpeed(
        verdict,
        "",
        variation,
        shaft,
        shaft_variation,
        variation / shaft_variation,
        float(inertias[0]),
        needed,
    )


_HEADINGS = {
    "fair": "a fair assumption",
    "not fair": "not a fair assumption",
    "no drive inertia": "not checked",
}


def heading(found: DriveSpeed) -> str:
    """Return the verdict."""
    state = f", judged in {found.state}" if found.state else ""
    return f"Constant drive speed: {_HEADINGS[found.verdict]}{state}"


def sentences(found: DriveSpeed) -> Iterator[str]:
    """Say how far the drive varies, by whose rule that is judged and what to change."""
    limit = given(SHARE, "percent")
    needed = quantity(found.needed, "kgm2", rounds="up")
    if found.verdict == "no drive inertia":
        inertia = f"at least {needed}" if found.needed > 0.0 else "any inertia"
        yield (
            "The scene gives shaft 0 no inertia, so its speed counts as constant. This is a "
            f"reasonable assumption if shaft 0 has {inertia} (motor, pulley, flywheel): without "
            f"torque, its speed then varies at most {limit} as much as that of shaft {found.shaft} "
            f"({SOURCE})."
        )
        return
    yield (
        f"Without torque, the speed of the drive varies by {quantity(found.variation, 'percent')} "
        f"from peak to peak. Shaft {found.shaft} varies by "
        f"{quantity(found.shaft_variation, 'percent')}, so the share is "
        f"{quantity(found.share, 'percent', bounds=[SHARE])}; the limit is {limit} ({SOURCE})."
    )
    if found.verdict == "not fair":
        yield (
            "Inertia torques of a freely running drive are smaller than computed, by about that "
            f"share. A fair assumption needs {needed} of shaft 0, which has "
            f"{given(found.inertia, 'kgm2')}."
        )


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

"""The paths of the force vectors of joints and bearings over the turn, and their pictures."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Literal

import numpy as np

import cardan.app.answers.turn.panel as panel
import cardan.app.pictures.style as style
from cardan.app.answers.answer import Answer
from cardan.app.answers.forces.figures import FORCES, ForceSource, force_source, unknown
from cardan.app.answers.printed import quantity, with_unit
from cardan.app.answers.rounding import first_peak
from cardan.app.answers.rows import UNITS
from cardan.app.answers.turn.figures import noise
from cardan.app.scene.language.units import shown_unit
from cardan.app.scene.scene import Scene
from cardan.arrays import FloatArray
from cardan.arrays.errors import ArgumentValueError
from cardan.arrays.indices import item_index
from cardan.driveline import Driveline
from cardan.evaluation.load import Load

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


@dataclass(frozen=True, eq=False)
class ForcePath:
    """The force of one joint or bearing over the period after which it repeats.

    That is half a turn, and with deviations of the joints a whole one.

    It is seen along a shaft, looking from the drive towards the output. The force of a joint is
    seen along the shaft that the joint supports: it has no part along that shaft.
    """

    per: ForceSource  # what it is a force of
    item: int  # number of the joint or bearing
    shaft: int  # the shaft along which it is seen
    # The axis that points up in the view, as near as the shaft allows: ``"y"``, or ``"z"`` for a
    # shaft that runs along y.
    up: Literal["y", "z"]
    angle_deg: FloatArray  # drive angles in degrees from 0 to the period, ``(samples,)``
    across: FloatArray  # part of the force to the right in N, ``(samples,)``
    upwards: FloatArray  # part of the force upwards in N, ``(samples,)``
    state: str = ""  # over states, the name of the one in which the force is largest

    @property
    def largest(self) -> int:
        """Index of the first sample at which the force is largest, except for rounding."""
        return first_peak(np.hypot(self.across, self.upwards))[0]

    @property
    def size(self) -> float:
        """The largest force of its samples in N."""
        return float(np.hypot(self.across[self.largest], self.upwards[self.largest]))


def force_path(line: Driveline, per: ForceSource, item: int, load: Load) -> ForcePath:
    """Return the path of one force of one driveline at a constant load.

    A ``ValueError`` says that the force is not determinate, or that lengths are missing.
    """
    name, (angle_deg, period) = f"{per}_force", panel.period(line)
    force = line.evaluate(period, name, load=load)[name][item]
    if per == "bearing":
        shaft = line.bearings[item][0]
    else:
        driving, driven = (
            float(np.max(np.abs(force @ line.directions[item + side]))) for side in (0, 1)
        )
        shaft = item + (driven <= driving)
    along = line.directions[shaft]
    up, across, upwards = _axes_across(along)
    return ForcePath(per, item, shaft, up, angle_deg, force @ across, force @ upwards)


def force_paths(line: Driveline, load: Load, outputs: Iterable[str] = FORCES) -> list[ForcePath]:
    """Return the paths of the forces of every joint, then of every bearing.

    Takes the arguments of ``force_figures`` and raises its errors.
    """
    paths = []
    for name in outputs:
        per = force_source(name)
        count = line.n_joints if per == "joint" else line.n_bearings
        paths += [force_path(line, per, item, load) for item in range(count)]
    return paths


def _axes_across(along: FloatArray) -> tuple[Literal["y", "z"], FloatArray, FloatArray]:
    """The axis that points up, and unit vectors to the right and upwards, across a shaft."""
    up: Literal["y", "z"] = "z" if abs(along[1]) > 0.9 else "y"
    across = np.cross(along, np.eye(3)["xyz".index(up)])
    across /= np.linalg.norm(across)
    return up, across, np.cross(across, along)


def scene_force_paths(scene: Scene) -> list[ForcePath]:
    """Return the paths of the forces of a scene's joints and bearings that are determinate.

    Those that bear no force have none. Over states, each is that of the state in which the force is
    largest. If there are none, a ``ValueError`` says why.
    """
    if scene.states:
        return _largest_paths(scene, scene.states.names)
    line, load = scene.line_as_built, scene.load_case
    if reason := unknown(scene):
        raise ValueError(f"{scene.name}: forces have no path over a turn: {reason}")
    assert load is not None
    found: list[ForcePath] = []
    problems = []
    for name in FORCES[: 1 + (line.n_bearings > 0)]:
        try:
            paths = force_paths(line, load, [name])
        except ArgumentValueError as error:
            problems.append(error.problem.partition("; ")[2])
        else:
            least = noise(scene, "N")
            found += [path for path in paths if path.size > least]
    if not found:
        reason = f"not determinate: {problems[0]}" if problems else "all 0"
        raise ValueError(f"{scene.name}: forces are {reason}")
    return found


def _largest_paths(scene: Scene, names: Sequence[str]) -> list[ForcePath]:
    found: dict[tuple[str, int], ForcePath] = {}
    reason: ValueError | None = None
    for i, name in enumerate(names):
        try:
            paths = scene_force_paths(scene.in_state(i))
        except ValueError as error:
            reason = error
            continue
        for path in paths:
            key = (path.per, path.item)
            if key not in found or path.size > found[key].size:
                found[key] = replace(path, state=name)
    if not found and reason:
        raise reason
    return list(found.values())


# --- pictures ------------------------------------------------------------------------------------

_COLUMNS, _PANEL = 3, (56.0, 58.0)  # mm
# A path that is smaller than this share of its distance from 0 has no room for drive angles.
_SMALL = 0.15
# Points from a mark to its drive angle, and beside an axis if the angle would lie on it.
_AWAY, _ASIDE, _ON_AXIS = 10.0, 6.0, 0.2


def plot_force_hodograph(
    line: Driveline,
    per: Literal["joint", "bearing"] = "bearing",
    item: int = 0,
    *,
    load: Load,
    ax: Axes | None = None,
) -> Axes:
    """Draw the path of the force of a joint or bearing over the turn, seen along a shaft.

    The view is from the drive towards the output, with y upwards (z, along y). The arrow is the
    largest force; drive angles of half a turn are marked. The path is closed. It is passed twice in
    a turn, and once if the joints have deviations. The force of a bearing is the one on its shaft,
    and has no part along it. That of a joint is the one on its driven shaft, seen along the shaft
    that the joint supports: it has no part along that.

    Args:
        line: one driveline.
        per: ``"joint"`` or ``"bearing"``.
        item: index of the joint or bearing.
        load: a constant load.

    Raises:
        IndexError: a joint or bearing that does not exist.
        ValueError: a batch, forces that are not determinate, lengths that are missing.
    """
    style.check_single(line)
    if per not in ("joint", "bearing"):
        raise ArgumentValueError("per", f"is {per!r}; it must be 'joint' or 'bearing'")
    count = line.n_joints if per == "joint" else line.n_bearings
    path = force_path(line, per, item_index("item", item, count), load)
    with style.drawing(ax, height_mm=76.0) as axes:
        draw_path(axes, path)
    return axes


def plot_forces(paths: Sequence[ForcePath], title: str = "") -> Figure:
    """Return a page with the path of every force, each on its own scale.

    Args:
        paths: what to draw.
        title: heading.
    """
    style.check_kind("paths", paths, list, tuple)
    if not paths:
        raise ArgumentValueError("paths", "is empty; there must be at least one")
    for path in paths:
        style.check_kind("paths", path, ForcePath)
    columns = min(_COLUMNS, len(paths))
    rows = -(-len(paths) // columns)
    width, height = _PANEL
    with style.page(columns * width, rows * height + 6.0, title, 30 * columns) as figure:
        for number, path in enumerate(paths, 1):
            draw_path(figure.add_subplot(rows, columns, number), path)
    return figure


def _whole(answer: Answer) -> Figure:
    """Paths of the force vectors of joints and bearings over a turn."""
    return plot_forces(scene_force_paths(answer.scene), answer.of.title)


PICTURES = {"forces": _whole}


def draw_path(axes: Axes, path: ForcePath) -> None:
    """Draw one path, with the vector of the largest force from 0."""
    factor = UNITS[shown_unit("N")].factor
    x, y = factor * path.across, factor * path.upwards
    curve = style.LINES[0]
    axes.axhline(0.0, zorder=1.0, **style.THIN)
    axes.axvline(0.0, zorder=1.0, **style.THIN)
    axes.plot(x, y, **curve)
    size = factor * path.size
    if size > 0.0:
        head = "-|>,head_width=0.18,head_length=0.4"
        style.arrow(axes, (0.0, 0.0), (x[path.largest], y[path.largest]), head, "0.1", 0.9)
    span = max(float(np.ptp(x)), float(np.ptp(y)))
    if span > _SMALL * size:
        axes.plot(x[panel.MARKS], y[panel.MARKS], "o", color=curve["color"])
        _name_angles(axes, path, np.stack([x, y], axis=-1))
    axes.set_aspect("equal", adjustable="datalim")
    # Room around the path for the angles.
    axes.margins(0.32)
    across, upwards = (
        with_unit(label, "N")
        for label in ("force to the right", f"force upwards, towards {path.up}")
    )
    style.finish(axes, across, upwards)
    style.value_ticks(axes.xaxis, 4)
    style.value_ticks(axes.yaxis, 4)
    heading = f"{path.per.capitalize()} {path.item}, up to {quantity(path.size, 'N')}"
    state = textwrap.shorten(f"in {path.state}", 34, placeholder=" …") + "\n" if path.state else ""
    text = f"{heading}\n{state}seen along shaft {path.shaft}"
    axes.set_title(text, loc="left", parse_math=False)


def _name_angles(axes: Axes, path: ForcePath, points: FloatArray) -> None:
    """Write drive angles outside the path, beside their marks."""
    middle = (np.min(points, axis=0) + np.max(points, axis=0)) / 2.0
    for mark in panel.MARKS:
        outwards = points[mark] - middle
        outwards /= max(float(np.linalg.norm(outwards)), 1e-300)
        # Above the horizontal axis and the arrow, beside the vertical one.
        aside = np.where(np.abs(outwards) < _ON_AXIS, _ASIDE, 0.0)
        style.write_angle(axes, path.angle_deg[mark], points[mark], _AWAY * outwards + aside)

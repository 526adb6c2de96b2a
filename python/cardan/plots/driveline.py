"""A driveline in space, with its yokes and bend planes."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from cardan.arrays import FloatArray, as_float64
from cardan.driveline import Driveline
from cardan.errors import ArgumentValueError
from cardan.plots.style import LINES, MARKERS, drawing, legend_above

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_HEIGHT = 48.0  # mm
_STEPS = 48
_PINS = ("driving pin", "driven pin")
_DEPTH = 1.3  # of a yoke, over its half span
_PLANE = {"facecolor": "0.75", "edgecolor": "0.5", "alpha": 0.25, "linewidth": 0.5}
_SHAFT = {"color": "0.65", "linewidth": 2.2, "solid_capstyle": "round"}


def yoke_pins(line: Driveline, angle: float = 0.0) -> FloatArray:
    """Return the direction of every pin at a drive angle.

    Args:
        line: one driveline.
        angle: drive angle in rad.

    Returns:
        unit vectors ``(n, 2, 3)``: for each joint the pin of its driving and of its driven yoke.

    Raises:
        ValueError: a batch.
    """
    _single(line)
    first = line.normals[0]
    pin = math.cos(angle) * np.cross(first, line.directions[0]) + math.sin(angle) * first
    pins = []
    for along, phase in zip(line.directions[1:], (*line.phases, 0.0), strict=True):
        # The cross keeps the pins perpendicular, and the driven one is so to its shaft.
        driven = np.cross(along, pin)
        driven /= np.linalg.norm(driven)
        pins.append((pin, driven))
        pin = math.cos(phase) * driven + math.sin(phase) * np.cross(along, driven)
    return np.array(pins)


def plot_driveline(
    line: Driveline,
    angle: float = 0.0,
    *,
    points: ArrayLike | None = None,
    ax: Axes | None = None,
) -> Axes:
    """Draw a driveline in space with its yokes at a drive angle, and its bend planes as discs.

    x points to the right, y up and z towards the reader, as ``Driveline.from_points`` has them.

    Args:
        line: one driveline.
        angle: drive angle in rad.
        points: its ends and joint centres, ``(n + 2, 3)``; by default all shafts are as long.
        ax: axes in three dimensions; by default on a new figure of pyplot, 80 mm wide.

    Raises:
        ImportError: matplotlib is missing.
        ValueError: a batch, points that do not lie along the shafts, axes of another projection.
    """
    _single(line)
    places = _places(line, points)
    lengths = np.linalg.norm(np.diff(places, axis=0), axis=-1)
    size = _yoke_size(lengths)
    crowded = np.min(lengths[1:-1], initial=np.inf) < 0.15 * np.sum(lengths)
    up = np.array([0.0, 1.0, 0.0])
    with drawing(ax, "3d", height_mm=_HEIGHT) as axes:
        from mpl_toolkits.mplot3d.art3d import Poly3DCollection

        space: Any = axes
        if ax is None:
            # Axes in three dimensions are square; these are as wide as the figure.
            space.set_position([0.0, 0.5 - 40.0 / _HEIGHT, 1.0, 80.0 / _HEIGHT])
        drawn = [places]
        for shaft, along in enumerate(line.directions):
            ends = places[shaft : shaft + 2].copy()
            # A shaft ends where its yokes begin.
            ends[0] += (shaft > 0) * _DEPTH * size * along
            ends[1] -= (shaft < line.n_joints) * _DEPTH * size * along
            space.plot(*ends.T, clip_on=False, **_SHAFT)
        for joint, (centre, pins) in enumerate(
            zip(places[1:-1], yoke_pins(line, angle), strict=True)
        ):
            before, after = line.directions[joint : joint + 2]
            disc = centre + 2.0 * size * _round(before, np.cross(line.normals[joint], before))
            plane = Poly3DCollection([disc], label="bend plane", clip_on=False, **_PLANE)
            space.add_collection3d(plane)
            for i, (pin, towards) in enumerate(zip(pins, (-before, after), strict=True)):
                yoke = centre + size * _round(pin, _DEPTH * towards)[: _STEPS // 2 + 1]
                space.plot(*yoke.T, color=LINES[i]["color"], linewidth=1.6, clip_on=False)
                ends = centre + size * np.array([pin, -pin])
                drawn += [disc, ends]
                space.plot(*ends.T, marker=MARKERS[i], label=_PINS[i], clip_on=False, **LINES[i])
            if joint == 0:
                legend_above(axes, loc="lower center", bbox_to_anchor=(0.5, 0.22))
            label = f"joint {joint}\n{np.degrees(line.bends[joint]):.3g}°"
            side, towards = (-1.0, "top") if crowded and joint % 2 else (1.0, "bottom")
            space.text(*(centre + 2.4 * size * side * up), label, ha="center", va=towards)
        space.text(*(places[0] - 0.4 * size * line.directions[0]), "drive", ha="right", va="center")
        _look(space, np.concatenate(drawn))
    return axes


def _look(space: Any, drawn: FloatArray) -> None:  # noqa: ANN401 - has no types
    """Look from the side and a little from above and behind, so near that all is just seen."""
    from mpl_toolkits.mplot3d.proj3d import proj_transform

    low, high = drawn.min(axis=0), drawn.max(axis=0)
    space.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), zlim=(low[2], high[2]))
    space.set_proj_type("ortho")
    space.view_init(elev=20.0, azim=-25.0, vertical_axis="y")
    space.set_box_aspect(high - low)
    x, y, _ = np.abs(proj_transform(*drawn.T, space.get_proj()))
    wide, tall = space.viewLim.width / 2.0, space.viewLim.height / 2.0 * _HEIGHT / 80.0
    space.set_box_aspect(high - low, zoom=min(0.8 * wide / x.max(), 0.55 * tall / y.max()))
    space.set_axis_off()


def _yoke_size(lengths: FloatArray) -> float:
    """Half the span of a yoke that leaves some of every shaft to be seen."""
    between = float(np.min(lengths[1:-1], initial=np.inf))
    ends = float(min(lengths[0], lengths[-1]))
    return min(0.07 * float(np.sum(lengths)), 0.3 * between, 0.6 * ends)


def _places(line: Driveline, points: ArrayLike | None) -> FloatArray:
    if points is None:
        return np.concatenate([np.zeros((1, 3)), np.cumsum(line.directions, axis=0)])
    places = as_float64("points", points)
    if places.shape != (line.n_joints + 2, 3):
        raise ArgumentValueError(
            "points", f"has shape {places.shape}; it must be ({line.n_joints + 2}, 3)"
        )
    steps = np.diff(places, axis=0)
    off = np.linalg.norm(np.cross(steps, line.directions), axis=-1)
    wrong = ~(off <= 1e-6 * np.linalg.norm(steps, axis=-1))
    wrong |= ~(np.sum(steps * line.directions, axis=-1) > 0.0)
    if wrong.any():
        shaft = int(np.argmax(wrong))
        raise ArgumentValueError(
            "points", f"and [{shaft + 1}] do not lie along shaft {shaft}", (shaft,)
        )
    return places


def _round(first: FloatArray, second: FloatArray) -> FloatArray:
    """A round from one radius over the other, which may make it an ellipse."""
    turn = np.linspace(0.0, 2.0 * math.pi, _STEPS + 1)[:, np.newaxis]
    return np.cos(turn) * first + np.sin(turn) * second


def _single(line: Driveline) -> None:
    if line.shape:
        raise ArgumentValueError(
            "line", f"has shape {line.shape}; this picture shows one driveline"
        )

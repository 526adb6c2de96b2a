"""The paths of the forces of joints and bearings, as data for SVG."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from cardan.app.answers.answer import Answer
from cardan.app.answers.forces.figures import SceneForces, scene_force_paths
from cardan.app.answers.forces.paths import PER_DEGREE, ForcePath
from cardan.app.answers.printed import figure_text
from cardan.app.charts.charts import number, ticks

# Units of a drawing; the views have one scale both ways.
_WIDTH, _HEIGHT = 360.0, 300.0
_LEFT, _RIGHT, _TOP, _BOTTOM = 56.0, 344.0, 8.0, 258.0
_ROOM = 30.0  # around a path, for the drive angles
_AWAY = 15.0  # from a mark to its drive angle
_SMALL = 0.15  # a path smaller than this share of its force has no drive angles
_MARKS = range(0, 180 * PER_DEGREE, 30 * PER_DEGREE)


def section(answer: Answer, found: SceneForces) -> dict[str, Any]:
    """Return a view of the force of each joint and bearing; none without forces over a turn."""
    if not any(force.figures.largest > 0.0 for force in found.forces):
        return {"views": []}
    return {"views": [_view(path) for path in scene_force_paths(answer.scene)]}


def _view(path: ForcePath) -> dict[str, Any]:
    """Ticks, path, the largest force as an arrow from 0 and drive angles."""
    forces = np.stack([path.across, path.upwards], axis=-1)
    low, high = np.minimum(forces.min(axis=0), 0.0), np.maximum(forces.max(axis=0), 0.0)
    middle, spans = (low + high) / 2.0, high - low
    room = np.array([_RIGHT - _LEFT, _BOTTOM - _TOP]) - 2.0 * _ROOM
    scale = float(np.min(room / np.maximum(spans, 1e-300)))
    centre = np.array([(_LEFT + _RIGHT) / 2.0, (_TOP + _BOTTOM) / 2.0])

    def at(points: Any) -> Any:  # noqa: ANN401 - one point or several
        return centre + scale * (points - middle) * (1.0, -1.0)

    places = at(forces)
    size = path.size
    largest = places[path.largest]
    span = float(np.max(np.ptp(forces, axis=0)))
    of = path.label[0].upper() + path.label[1:]
    heading = f"{of}, up to {figure_text(size)} N, seen along shaft {path.shaft}"
    ends = (np.array([[_LEFT, _BOTTOM], [_RIGHT, _TOP]]) - centre) / scale * (1.0, -1.0) + middle
    return {
        "width": _WIDTH,
        "height": _HEIGHT,
        "left": _LEFT,
        "right": _RIGHT,
        "top": _TOP,
        "bottom": _BOTTOM,
        "heading": heading,
        "once": path.part_of_turn == "a turn",
        "spoken": f"{heading}: path of the force vector over {path.part_of_turn}",
        "x_label": "force to the right [N]",
        "y_label": f"force upwards, towards {path.up} [N]",
        "x_ticks": [(_text(at((t, 0.0))[0]), number(t)) for t in _within(*ends[:, 0])],
        "y_ticks": [
            (_text(y), _text(y + 4.0), number(t))
            for t in _within(*ends[:, 1])
            for y in (at((0.0, t))[1],)
        ],
        "zero": [_text(value) for value in at(np.zeros(2))],
        "path": " ".join(f"{x:.1f},{y:.1f}" for x, y in places),
        "arrow": _arrow(at(np.zeros(2)), largest),
        "marks": list(_marks(path, places)) if span > _SMALL * size else [],
    }


def _within(low: float, high: float) -> Sequence[float]:
    return [tick for tick in ticks(low, high) if low <= tick <= high]


def _arrow(foot: np.ndarray, head: np.ndarray) -> str:
    along = (head - foot) / max(float(np.linalg.norm(head - foot)), 1e-9)
    aside = 0.4 * np.array([-along[1], along[0]])
    barbs = [head + 9.0 * (side * aside - along) for side in (1.0, -1.0)]
    points = (foot, head, barbs[0], head, barbs[1])
    return "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in points)


def _marks(path: ForcePath, places: np.ndarray) -> Any:  # noqa: ANN401 - an iterator of rows
    """Marks at drive angles, each with the place of its text outside the path."""
    middle = (places.min(axis=0) + places.max(axis=0)) / 2.0
    for mark in _MARKS:
        outwards = places[mark] - middle
        outwards = outwards / max(float(np.linalg.norm(outwards)), 1e-9)
        # Above the horizontal axis and the arrow, beside the vertical one.
        aside = np.where(np.abs(outwards) < 0.2, (9.0, -9.0), 0.0)
        x, y = places[mark] + _AWAY * outwards + aside
        yield (*map(_text, places[mark]), _text(x), _text(y + 4.0), f"{path.angle_deg[mark]:g}°")


def _text(value: float) -> str:
    return f"{value:.1f}"

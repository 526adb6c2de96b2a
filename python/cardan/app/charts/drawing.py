"""The driveline as drawn: views of its shafts, yokes and crosses, as data for the script."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import pairwise
from typing import Any

import numpy as np

from cardan.app.answers.printed import plain_text
from cardan.app.charts.samples import Samples
from cardan.app.pictures.space import aslant, length_text, right_and_up
from cardan.app.scene.scene import Scene
from cardan.arrays import FloatArray

# Pixels; numbers of shafts need the margin above, the axes the strip below.
_WIDTH, _SIDE, _ABOVE, _STRIP = 1000, 16.0, 40.0, 184.0

# Pixels of the rows of bends above a view and of lengths below it, and where their middles lie.
_BENDS, _LENGTHS, _ROW, _LINE = 44.0, 84.0, 26.0, 24.0

# Lengths beside a shaft between two joints, which is 1; scenes need not give any.
_END, _PIN, _YOKE = 0.75, 0.19, 0.22

# Pixels that such a shaft takes at most, so that a single joint does not fill the page.
_MOST = 320.0

# Pixels of an axis, of its head and from there to its name, of the arrow of view and to its words.
_AXIS, _HEAD, _NAME, _FLOW, _WORDS = 50.0, 13.0, 20.0, 240.0, 18.0

# Pixels from those words to the edge.
_MARGIN = 6.0

# Pixels: the font of the views, and what a letter of it takes at most.
_FONT = 34.0
_LETTER = 0.64 * _FONT

# Pixels between texts, of the head of a dimension line, of its ends, and from the line to the
# middle of its text.
_GAP, _POINT, _TICK, _BELOW = 14.0, 12.0, 16.0, 28.0

_DIGITS = 4


def drawing(samples: Samples) -> dict[str, Any]:
    """Return views, joint centres and pins as plain data.

    A view is a matrix whose rows point to the right, down and to the viewer, with an offset and
    a size in pixels; side view and top view have dimensions, unless the bends were recorded.
    ``points`` are the ends and joint centres, of one sample or of all; ``bearings`` are pairs of a
    shaft and a share of its length.
    """
    directions, pins = samples.directions(), samples.pins()
    lengths = np.ones(directions.shape[-2])
    lengths[[0, -1]] = _END
    steps = directions * lengths[:, np.newaxis]
    points = np.concatenate([np.zeros_like(steps[:, :1]), np.cumsum(steps, axis=1)], axis=1)
    return {
        "views": [
            _view(name, axes, points, samples.result.scene if " view: " in name else None)
            for name, axes in views(directions).items()
        ],
        "points": np.round(points, _DIGITS).tolist(),
        "pins": np.round(pins, _DIGITS).tolist(),
        "bearings": _bearings(samples),
        "pin": _PIN,
        "yoke": _YOKE,
    }


def _bearings(samples: Samples) -> list[tuple[int, float]]:
    """The shaft of every bearing, and its position as a share of the length of that shaft.

    A recording has several drivelines, with the same bearings.
    """
    line = samples.result.scene.line
    if not line.n_bearings:
        return []
    lengths = line.lengths().each.reshape(-1, line.n_joints + 1)[0]
    return [
        (shaft, round(float(position.flat[0] / lengths[shaft]), _DIGITS))
        for shaft, position in line.bearings
    ]


def views(directions: FloatArray) -> dict[str, FloatArray]:
    """Directions to the right, down and to the viewer for each view, by its name.

    In all of them the drive is on the left, and none is a mirror image; the last one is the side
    view with depth aslant. The directions are those of the shafts, ``(samples, n + 1, 3)``.
    """
    right, up = right_and_up(np.mean(directions, axis=(0, 1)))
    side = np.cross(right, up)
    names = [
        f"{'-' if axis.sum() < 0 else ''}{'xyz'[int(np.argmax(np.abs(axis)))]}"
        for axis in (right, up, side)
    ]
    return {
        f"Side view: {names[0]} to the right, {names[1]} up": np.stack([right, -up, side]),
        f"Top view: {names[0]} to the right, {names[2]} down": np.stack([right, side, up]),
        "From behind the drive, its right and above, looking from the drive towards the output": (
            aslant(right, up) * [[1.0], [-1.0], [1.0]]
        ),
    }


def _view(
    name: str, axes: FloatArray, points: FloatArray, scene: Scene | None = None
) -> dict[str, Any]:
    """A view of the points of one or more drivelines, with the dimensions of a scene."""
    flat = points.reshape(-1, 3) @ axes[:2].T
    low, high = flat.min(axis=0) - 1.2 * _PIN, flat.max(axis=0) + 1.2 * _PIN
    scale = min(_MOST, (_WIDTH - 2.0 * _SIDE) / float(high[0] - low[0]))
    height = float(high[1] - low[1]) * scale + 2.0 * _ABOVE
    rows = _rows(scene, len(points))
    height += rows[0] + rows[1]
    middle = scale * (low + high) / 2.0
    offset = np.array([_WIDTH, height + rows[0] - rows[1]]) / 2.0 - middle
    joints = scale * points[0, 1:-1] @ axes[:2].T + offset
    along = np.mean(points[:, -1] - points[:, 0], axis=0) @ axes[:2].T
    return {
        "name": name,
        "spoken": f"The driveline. {name}.",
        "axes": np.round(scale * axes, _DIGITS).tolist(),
        "offset": np.round(offset, 1).tolist(),
        "size": [_WIDTH, round(height + _STRIP)],
        "arrows": [
            *_triad(axes, height + _STRIP / 2.0),
            _flow(along, height + _STRIP / 2.0),
            *(_dimensions(scene, axes, joints, height, rows) if scene else ()),
        ],
    }


def _rows(scene: Scene | None, count: int) -> tuple[float, float]:
    """Pixels for bends above and for lengths below a view of so many drivelines."""
    if scene is None or count > 1:
        return 0.0, 0.0
    known = scene.line.n_joints > 1 and scene.line._geometry.lengths.size
    return _BENDS, _LENGTHS if known else 0.0


def _dimensions(
    scene: Scene, axes: FloatArray, joints: FloatArray, height: float, rows: tuple[float, float]
) -> list[dict[str, Any]]:
    """Bends as the view shows them, and the lengths of the shafts."""
    made = []
    if rows[0]:
        flat = scene.line.directions.reshape(-1, 3) @ axes[:2].T
        slopes = np.arctan2(flat[:, 1], flat[:, 0])
        bends = [
            f"{plain_text(bend, 'deg')}°"
            for bend in np.degrees(np.abs(np.diff(np.unwrap(slopes)))).tolist()
        ]
        made += _bend_texts(joints, bends, _ROW)
    if rows[1]:
        each = scene.line.lengths().each.ravel()[1:-1]
        texts = [length_text(length, scene.length_unit) for length in each.tolist()]
        made += _length_lines(joints, texts, height - rows[1] + _LINE)
    return made


def _bend_texts(joints: FloatArray, texts: list[str], y: float) -> list[dict[str, Any]]:
    """The bends of the joints ``(n, 2)`` in a row above a view; none if one of them has no room."""
    places = sorted(zip(joints[:, 0].tolist(), texts, strict=True))
    ends = [(x - _half(text), x + _half(text)) for x, text in places]
    if any(left[1] + _GAP > right[0] for left, right in pairwise(ends)):
        return []
    return [_dimension("", x, y, text) for x, text in places]


def _length_lines(joints: FloatArray, texts: list[str], y: float) -> Iterator[dict[str, Any]]:
    """A dimension line with its text for each shaft between two joints that has room for it."""
    for (start, end), text in zip(pairwise(joints[:, 0].tolist()), texts, strict=True):
        left, right = min(start, end), max(start, end)
        if right - left < 2.0 * _half(text) + _GAP:
            continue
        path = "".join(f"M{x:.1f} {y - _TICK:.1f}V{y + _TICK:.1f}" for x in (left, right))
        path += f"M{left:.1f} {y:.1f}H{right:.1f}"
        over, under = y - _POINT / 3.0, y + _POINT / 3.0
        for x, back in ((left, left + _POINT), (right, right - _POINT)):
            path += f"M{back:.1f} {over:.1f}L{x:.1f} {y:.1f}L{back:.1f} {under:.1f}"
        yield _dimension(path, (left + right) / 2.0, y + _BELOW, text)


def _dimension(path: str, x: float, y: float, words: str) -> dict[str, Any]:
    text = _text(words, np.array([x, y]), "middle")
    return {"class": "dimension", "path": path, "texts": [text]}


def _half(text: str) -> float:
    return 0.5 * _LETTER * len(text)


def _triad(axes: FloatArray, middle: float) -> list[dict[str, Any]]:
    """The axes of the scene as they point in a view; one that points at the viewer is left out."""
    foot = np.array([2.0 * _AXIS, middle])
    arrows = []
    for name, way in zip("xyz", axes[:2].T, strict=True):
        length = float(np.linalg.norm(way))
        if length > 0.1:
            head = foot + _AXIS * way
            at = head + _NAME * way / length
            arrows.append(_arrow("axis", foot, head, [_text(name, at, "middle")]))
    return arrows


def _flow(along: FloatArray, middle: float) -> dict[str, Any]:
    """The arrow of view, from the drive towards the output."""
    along = along / np.linalg.norm(along)
    # The words at its ends stay within the strip.
    way = along * min(_FLOW, (_STRIP - _FONT - 2.0 * _MARGIN) / max(abs(along[1]), 1e-9))
    centre = np.array([_WIDTH / 2.0, middle])
    foot, head = centre - way / 2.0, centre + way / 2.0
    aside = np.array([_WORDS, 0.0])
    words = [_text("drive", foot - aside, "end"), _text("output", head + aside, "start")]
    return _arrow("flow", foot, head, words)


def _arrow(kind: str, foot: FloatArray, head: FloatArray, texts: list[Any]) -> dict[str, Any]:
    way = (head - foot) / np.linalg.norm(head - foot)
    aside = 0.5 * np.array([-way[1], way[0]])
    barbs = [head + _HEAD * (side * aside - way) for side in (1.0, -1.0)]
    path = f"M{_at(foot)}L{_at(head)}M{_at(barbs[0])}L{_at(head)}L{_at(barbs[1])}"
    return {"class": kind, "path": path, "texts": texts}


def _text(words: str, at: FloatArray, anchor: str) -> dict[str, Any]:
    return {"words": words, "x": f"{at[0]:.1f}", "y": f"{at[1]:.1f}", "class": anchor}


def _at(point: FloatArray) -> str:
    return f"{point[0]:.1f} {point[1]:.1f}"

"""The driveline as drawn: views of its shafts, yokes and crosses, as data for the script."""

from __future__ import annotations

from typing import Any

import numpy as np

from cardan.arrays import FloatArray
from cardan.report.samples import Samples

# Pixels; numbers of shafts stand in the margin above.
_WIDTH, _SIDE, _ABOVE = 1000, 16.0, 40.0

# Lengths beside a shaft between two joints, which is 1; scenes need not give any.
_END, _PIN, _YOKE = 0.75, 0.19, 0.22

# Pixels that such a shaft takes at most, so that a single joint does not fill the page.
_MOST = 320.0

_DIGITS = 4


def drawing(samples: Samples) -> dict[str, Any]:
    """Return views, joint centres and pins as plain data.

    A view is a matrix whose rows point to the right, down and to the viewer, with an offset and
    a size in pixels; ``points`` are the ends and joint centres, of one sample or of all.
    """
    directions, pins = samples.directions(), samples.pins()
    lengths = np.ones(directions.shape[-2])
    lengths[[0, -1]] = _END
    steps = directions * lengths[:, np.newaxis]
    points = np.concatenate([np.zeros_like(steps[:, :1]), np.cumsum(steps, axis=1)], axis=1)
    return {
        "views": [_view(name, axes, points) for name, axes in _axes(directions).items()],
        "points": np.round(points, _DIGITS).tolist(),
        "pins": np.round(pins, _DIGITS).tolist(),
        "pin": _PIN,
        "yoke": _YOKE,
    }


def _axes(directions: FloatArray) -> dict[str, FloatArray]:
    """Directions to the right, down and to the viewer for each view, by its name."""
    mean = np.mean(directions, axis=(0, 1))
    place = int(np.argmax(np.abs(mean)))
    right = np.zeros(3)
    right[place] = np.copysign(1.0, mean[place])
    up = np.eye(3)[1 if place != 1 else 2]
    side = np.cross(right, up)
    viewer = -0.55 * right + 0.5 * up + side
    viewer /= np.linalg.norm(viewer)
    across = np.cross(up, viewer)
    across /= np.linalg.norm(across)
    names = [
        f"{'-' if axis.sum() < 0 else ''}{'xyz'[int(np.argmax(np.abs(axis)))]}"
        for axis in (right, up, side)
    ]
    return {
        "From behind, to the right and above": np.stack([across, np.cross(across, viewer), viewer]),
        f"Side view: {names[0]} to the right, {names[1]} up": np.stack([right, -up, side]),
        f"Top view: {names[0]} to the right, {names[2]} down": np.stack([right, side, up]),
    }


def _view(name: str, axes: FloatArray, points: FloatArray) -> dict[str, Any]:
    flat = points.reshape(-1, 3) @ axes[:2].T
    low, high = flat.min(axis=0) - 1.2 * _PIN, flat.max(axis=0) + 1.2 * _PIN
    scale = min(_MOST, (_WIDTH - 2.0 * _SIDE) / float(high[0] - low[0]))
    height = float(high[1] - low[1]) * scale + 2.0 * _ABOVE
    middle = scale * (low + high) / 2.0
    offset = np.array([_WIDTH, height]) / 2.0 - middle
    return {
        "name": name,
        "axes": np.round(scale * axes, _DIGITS).tolist(),
        "offset": np.round(offset, 1).tolist(),
        "size": [_WIDTH, round(height)],
    }

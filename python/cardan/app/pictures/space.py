"""The driveline in space as points to draw: places, a view, tubes, yokes and wedges of bend."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from cardan.app.answers.printed import plain_text
from cardan.app.answers.rows import UNITS
from cardan.app.scene.language.units import LengthUnit, shown_unit
from cardan.arrays import FloatArray
from cardan.driveline import Driveline

_STEPS = 24
DEPTH = 1.3
"""Depth of a yoke over half its span."""

_LITTLE = 0.3
_ASLANT = 0.42, 0.28  # to the right and downwards, of a unit towards the viewer
_TUBE = 0.34  # radius over half the span of a yoke


def shaft_lengths(line: Driveline) -> FloatArray:
    """Return the length of every shaft of one driveline, ``(n + 1,)``; all are 1 if not known."""
    lengths = line._geometry.lengths
    return lengths if lengths.shape[-1] else np.ones(line.n_joints + 1)


def length_text(length: float, unit: LengthUnit) -> str:
    """Return a length in m as a drawing gives it, to a tenth of a millimetre, or in US units.

    >>> length_text(1.3, "mm"), length_text(1.30019, "mm"), length_text(12.34567, "m")
    ('1300 mm', '1300.2 mm', '12.3457 m')
    """
    shown = shown_unit(unit)
    return f"{plain_text(UNITS[shown].factor * length, shown)} {shown}"


def bearing_places(line: Driveline, points: FloatArray) -> FloatArray:
    """Return the bearings of a driveline that is drawn at these points, ``(..., b, 3)``.

    A bearing keeps its share of the length of its shaft. Ends and joint centres are ``(..., n + 2,
    3)``, in any unit.
    """
    lengths = shaft_lengths(line)
    places = np.empty((*points.shape[:-2], line.n_bearings, 3))
    for bearing, (shaft, position) in enumerate(line.bearings):
        first, last = points[..., shaft, :], points[..., shaft + 1, :]
        places[..., bearing, :] = first + position / lengths[shaft] * (last - first)
    return places


def pins(line: Driveline, angle: FloatArray) -> FloatArray:
    """Return unit vectors along the driving and the driven pin of every joint.

    They follow from the geometry alone: a cross keeps its pins at right angles, a shaft carries
    its output-side pin at its phase from its input-side one. Drive angles are in rad,
    ``(samples,)``, of one driveline or of one per angle; the pins are ``(samples, n, 2, 3)``.
    """
    normal = line.normals[..., 0, :]
    in_plane = np.cross(normal, line.directions[..., 0, :])
    cosine, sine = np.cos(angle)[:, np.newaxis], np.sin(angle)[:, np.newaxis]
    driving = cosine * in_plane + sine * normal
    found = []
    for joint in range(line.n_joints):
        along = line.directions[..., joint + 1, :]
        driven = np.cross(along, driving)
        driven = driven / np.linalg.norm(driven, axis=-1, keepdims=True)
        found.append(np.stack([driving, driven], axis=1))
        if joint < line.n_joints - 1:
            phase = line.phases[..., joint, np.newaxis]
            driving = np.cos(phase) * driven + np.sin(phase) * np.cross(along, driven)
    return np.stack(found, axis=1)


def right_and_up(mean: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Return the axis that shafts follow most, and upwards: y, if it is not that axis."""
    place = int(np.argmax(np.abs(mean)))
    right = np.zeros(3)
    right[place] = math.copysign(1.0, mean[place])
    return right, np.eye(3)[1 if place != 1 else 2]


def aslant(right: FloatArray, up: FloatArray) -> FloatArray:
    """Return the rows of an oblique projection: to the right, up and to the viewer, ``(3, 3)``.

    It shows the plane of two unit vectors as the side view does, so that a shaft that falls there
    falls in the picture, and what comes out of that plane to the right and downwards.
    """
    out = np.cross(right, up)
    viewer = out - _ASLANT[0] * right + _ASLANT[1] * up
    return np.stack(
        [right + _ASLANT[0] * out, up - _ASLANT[1] * out, viewer / np.linalg.norm(viewer)]
    )


@dataclass(frozen=True)
class View:
    """A parallel projection: everything has one scale, whatever its depth."""

    axes: FloatArray  # rows of ``aslant``
    plane: FloatArray  # unit vectors that are drawn to the right and upwards, ``(2, 3)``

    @classmethod
    def of(cls, directions: FloatArray) -> View:
        """Look at shafts from the side, aslant from above and from the drive's end.

        The axis that the shafts follow most points to the right; y points up, if it is not y.
        """
        mean = np.mean(directions, axis=0)
        # Shafts that turn back on themselves have no direction in the mean.
        mean = mean if np.linalg.norm(mean) > _LITTLE else directions[0]
        right, up = right_and_up(mean)
        return cls(aslant(right, up), np.stack([right, up]))

    def flat(self, points: FloatArray) -> FloatArray:
        """Return where points are drawn, ``(..., 2)``."""
        flat: FloatArray = points @ self.axes[:2].T
        return flat

    def depth(self, points: FloatArray) -> float:
        """Return how near to the viewer points are in the mean."""
        return float(np.mean(points @ self.axes[2]))


def yoke(centre: FloatArray, pin: FloatArray, towards: FloatArray, size: float) -> FloatArray:
    """Return a yoke as a line, ``(points, 3)``: from one end of its pin round to the other.

    ``towards`` leads from the joint to the shaft of the yoke; the size is half its span.
    """
    # A superellipse: straight arms, and a base across the shaft.
    turn = np.linspace(0.0, math.pi, 2 * _STEPS + 1)[:, np.newaxis]
    cosine, sine = np.cos(turn), np.abs(np.sin(turn))
    sine[[0, -1]] = cosine[_STEPS] = 0.0
    arms = np.copysign(np.sqrt(np.abs(cosine)), cosine) * pin
    line: FloatArray = centre + size * (arms + DEPTH * np.sqrt(sine) * towards)
    return line


def tube(
    start: FloatArray, end: FloatArray, size: float, view: View, radius: float = _TUBE
) -> tuple[FloatArray, ...]:
    """Return the outline of a shaft and its end that the viewer sees, each ``(points, 3)``.

    The axis goes from ``start`` to ``end``; the size is half the span of a yoke, and the radius
    over it.
    """
    along = (end - start) / np.linalg.norm(end - start)
    across = np.cross(along, view.axes[2])
    # A shaft that points at the viewer is a circle, whichever way it is cut.
    across = across if np.linalg.norm(across) > 1e-9 else view.axes[0]
    across /= np.linalg.norm(across)
    beyond = np.cross(across, along)
    if view.flat(beyond) @ view.flat(along) < 0.0:
        beyond = -beyond
    radius *= size
    half = np.linspace(0.0, math.pi, _STEPS)[:, np.newaxis]
    first = start + radius * (np.cos(half) * across - np.sin(half) * beyond)
    last = end + radius * (np.sin(half) * beyond - np.cos(half) * across)
    seen = start if along @ view.axes[2] < 0.0 else end
    rim = seen + radius * (np.cos(2 * half) * across + np.sin(2 * half) * beyond)
    return np.concatenate([first, last]), rim


def wedge(centre: FloatArray, before: FloatArray, after: FloatArray, reach: float) -> FloatArray:
    """Return the bend at a joint as an area, ``(points, 3)``: its centre and an arc.

    The arc begins on the input shaft's line, continued, and ends on the output shaft.
    """
    share = np.linspace(0.0, 1.0, _STEPS)[:, np.newaxis]
    bend = math.atan2(float(np.linalg.norm(np.cross(before, after))), float(before @ after))
    if bend < 1e-9:
        arc = before + share * (after - before)
    else:
        weights = np.sin((1.0 - share) * bend), np.sin(share * bend)
        arc = (weights[0] * before + weights[1] * after) / math.sin(bend)
    return np.concatenate([centre[np.newaxis], centre + reach * arc])

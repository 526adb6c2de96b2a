"""The worst driveline within a box of tolerances: linear, and searched over the box itself."""

from __future__ import annotations

from collections.abc import Callable
from itertools import product
from typing import TypeAlias

import numpy as np

from cardan.arrays import ComplexArray, FloatArray

Value: TypeAlias = Callable[[FloatArray], FloatArray]
"""From deviations in units of the tolerances, ``(parameters, samples)``, to a figure."""

# So many parameters have all their corners compared; fewer also the middles of edges and faces.
MOST_CORNERS = 16
_MOST_MIDDLES = 8

_STARTS = 12
_ROUNDS = 60
_STEPS = np.linspace(-1.0, 1.0, 9)
_ZOOMS = 14


def zonotope_radius(centre: complex, generators: ComplexArray) -> float:
    """Return the largest ``|centre + sum of ± generators|``.

    The sums fill a polygon with two parallel edges per generator. Its vertices follow each other
    when the generators, all pointing upwards, are sorted by their direction; one of the vertices
    is farthest.
    """
    below = (generators.imag < 0.0) | ((generators.imag == 0.0) & (generators.real < 0.0))
    upwards = np.where(below, -generators, generators)
    steps = 2.0 * np.cumsum(upwards[np.argsort(np.angle(upwards))])
    half = np.sum(upwards)
    vertices = np.concatenate(
        [[centre - half, centre + half], centre - half + steps, centre + half - steps]
    )
    return float(np.max(np.abs(vertices)))


def largest_in_box(value: Value, parameters: int) -> tuple[float, FloatArray]:
    """Return the largest value that is found in a box, and where.

    All corners are compared, with few parameters also all middles of edges and faces. From the
    best of them one parameter after another moves to its best value until none improves. The
    result is the maximum over the box, unless that is inside and apart from all these starts.
    """
    levels = (-1.0, 0.0, 1.0) if parameters <= _MOST_MIDDLES else (-1.0, 1.0)
    grid = np.array(list(product(levels, repeat=parameters)), dtype=float).T
    grid = np.concatenate([grid, np.zeros((parameters, 1))], axis=1)
    values = value(grid)
    best = np.argsort(-values, kind="stable")[:_STARTS]
    at, found = grid[:, best].copy(), values[best]
    for _ in range(_ROUNDS):
        before = found.copy()
        for row in range(parameters):
            found = _along(value, at, found, row)
        if np.all(found - before <= 1e-13 * np.abs(before)):
            break
    top = int(np.argmax(found))
    return float(found[top]), at[:, top]


def largest_of_corners(value: Value, corner: FloatArray) -> tuple[float, FloatArray]:
    """Return the largest value of corners, and the corner.

    They are reached from one by turning one parameter at a time.
    """
    at, best = corner[:, np.newaxis], float(value(corner[:, np.newaxis])[0])
    turned = 1.0 - 2.0 * np.eye(len(corner))
    for _ in range(_ROUNDS):
        values = value(at * turned)
        top = int(np.argmax(values))
        if values[top] <= best:
            break
        at, best = at * turned[:, [top]], float(values[top])
    return best, at[:, 0]


def _along(value: Value, at: FloatArray, found: FloatArray, row: int) -> FloatArray:
    """Move one parameter of every start to where the value is largest; changes ``at``."""
    width = 1.0
    starts = at.shape[1]
    for zoom in range(_ZOOMS):
        centre = at[row] if zoom else np.zeros(starts)
        trials = np.clip(centre + width * _STEPS[:, np.newaxis], -1.0, 1.0)
        moved = np.repeat(at[:, np.newaxis], len(_STEPS), axis=1)
        moved[row] = trials
        values = value(moved.reshape(len(at), -1)).reshape(len(_STEPS), starts)
        top = np.argmax(values, axis=0)
        better = values[top, range(starts)] > found
        at[row] = np.where(better, trials[top, range(starts)], at[row])
        found = np.where(better, values[top, range(starts)], found)
        if zoom and not better.any() and np.all(np.abs(at[row]) == 1.0):
            break
        width *= 0.3
    return found

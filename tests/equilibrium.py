"""Forces of bearings and joints from the equilibrium of all shafts at once.

Every bearing and every joint has an unknown force. Each shaft that is supported is in balance
across its axis: its forces, and their moments together with those of its joints. The equations of
all shafts make one linear system, which a solver answers; no formula for a force appears. A bearing
gives no thrust, a joint no force along the shaft that it supports, and a joint that supports no
shaft gives none at all.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

Rows: TypeAlias = list[list[Any]]
BearingPlace: TypeAlias = tuple[int, Any]
Doubles: TypeAlias = NDArray[np.float64]


def assignments(joints: int, counts: Sequence[int]) -> Iterator[tuple[int | None, ...]]:
    """Yield every way in which joints can support shafts, of which each has two supports at most.

    Args:
        joints: number of joints.
        counts: number of bearings of each shaft.
    """
    ends = (0, joints)
    for way in itertools.product(*((None, j, j + 1) for j in range(joints))):
        supports = [count + way.count(shaft) for shaft, count in enumerate(counts)]
        held = [
            way.count(shaft) == 0
            if count >= 2 or (shaft in ends and count == 0)
            else supports[shaft] == 2
            for shaft, count in enumerate(counts)
        ]
        if all(held):
            yield way


def system(
    directions: Sequence[Sequence[Any]],
    lengths: Sequence[Any],
    moments: Sequence[Sequence[Any]],
    bearings: Sequence[BearingPlace],
    supported: Sequence[int | None],
) -> tuple[Rows, list[Any]]:
    """Return the equations ``rows @ x = right`` for the forces of the bearings, then of the joints.

    Args:
        directions: unit vector along each shaft.
        lengths: of each shaft.
        moments: of each joint on its driven shaft.
        bearings: shaft and position of each.
        supported: which shaft each joint supports.
    """
    n = len(moments)
    zero = 0 * lengths[0]
    size = 3 * (len(bearings) + n)
    rows: Rows = []
    right: list[Any] = []

    def equation(terms: Sequence[tuple[int, Any]], value: Any) -> None:  # noqa: ANN401 - of any arithmetic
        row = [zero] * size
        for place, factor in terms:
            row[place] += factor
        rows.append(row)
        right.append(value)

    def along(first: int, u: Sequence[Any]) -> list[tuple[int, Any]]:
        return [(first + i, u[i]) for i in range(3)]

    for b, (shaft, _) in enumerate(bearings):
        equation(along(3 * b, directions[shaft]), zero)
    for j, held in enumerate(supported):
        first = 3 * (len(bearings) + j)
        if held is None:
            for i in range(3):
                equation([(first + i, 1 + zero)], zero)
        else:
            equation(along(first, directions[held]), zero)
    for shaft, (u, length) in enumerate(zip(directions, lengths, strict=True)):
        own = [(3 * b, at, 1) for b, (s, at) in enumerate(bearings) if s == shaft]
        if not own and shaft in (0, n):
            continue
        if shaft > 0:
            own.append((3 * (len(bearings) + shaft - 1), zero, 1))
        if shaft < n:
            own.append((3 * (len(bearings) + shaft), length, -1))
        for v, w in _across(u):
            equation([(i, s * x) for f, _, s in own for i, x in along(f, v)], zero)
            # The moment of a force at u * at has the part at * (force . w) along v = w x u.
            left = sum(
                (
                    sign * sum(m * x for m, x in zip(moments[joint], v, strict=True))
                    for joint, sign in ((shaft - 1, 1), (shaft, -1))
                    if 0 <= joint < n
                ),
                zero,
            )
            equation([(i, s * at * x) for f, at, s in own for i, x in along(f, w)], -left)
    return rows, right


def solved(rows: Rows, right: Sequence[Any]) -> list[Any]:
    """Return the solution of a square system by elimination, in which zeros cost nothing."""
    left = [
        ({place: x for place, x in enumerate(row) if x}, value)
        for row, value in zip(rows, right, strict=True)
    ]
    done = []
    for column in range(len(rows)):
        largest = max(range(len(left)), key=lambda i: abs(left[i][0].get(column, 0)))
        pivot, of_pivot = left.pop(largest)
        for i, (row, value) in enumerate(left):
            if column in row:
                factor = row.pop(column) / pivot[column]
                for place, x in pivot.items():
                    if place != column:
                        row[place] = row.get(place, 0) - factor * x
                left[i] = row, value - factor * of_pivot
        done.append((pivot, of_pivot))
    found = [right[0]] * len(rows)
    for column, (row, value) in reversed([*enumerate(done)]):
        known = sum(x * found[place] for place, x in row.items() if place > column)
        found[column] = (value - known) / row[column]
    return found


def _across(u: Sequence[Any]) -> list[tuple[list[Any], list[Any]]]:
    """Two pairs of vectors ``v, w`` across the unit vector ``u`` with ``v . (u x f) = w . f``."""
    smallest = min(range(3), key=lambda i: abs(u[i]))
    axis = [0 * u[0] + (i == smallest) for i in range(3)]
    v = _cross(u, axis)
    other = _cross(u, v)
    return [(p, _cross(p, u)) for p in (v, other)]


def _cross(a: Sequence[Any], b: Sequence[Any]) -> list[Any]:
    return [a[i - 2] * b[i - 1] - a[i - 1] * b[i - 2] for i in range(3)]


def forces(
    directions: Doubles,
    lengths: Doubles,
    moments: Doubles,
    bearings: Sequence[BearingPlace],
    supported: Sequence[int | None],
) -> tuple[Doubles, Doubles]:
    """Return the forces of the bearings and of the joints in doubles, each ``(items, 3)``."""
    rows, right = system(
        directions.tolist(), lengths.tolist(), moments.tolist(), bearings, supported
    )
    found, _, rank, _ = np.linalg.lstsq(np.array(rows), np.array(right))
    assert rank == len(rows[0])
    scale = np.abs(right).max() + np.abs(found).max() * max(lengths)
    assert np.abs(np.array(rows) @ found - right).max() <= 1e-12 * scale
    both = found.reshape(-1, 3)
    return both[: len(bearings)], both[len(bearings) :]

"""Forces of joints and bearings again, in pure Python: the balance of one shaft after the other.

The moments are those of ``cardan.reference``. A shaft is balanced when the forces of its supports,
and those of the joints that support its neighbours, cancel across it and give it the moment that
it needs. It is slow and takes one driveline and one angle at a time; all values are in SI units.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from cardan.arrays.errors import ArgumentValueError
from cardan.reference import Loads, Shafts, Vector, _across, _cross, _plus, _scaled

_ZERO: Vector = (0.0, 0.0, 0.0)


@dataclass(frozen=True)
class Forces:
    """Forces in a driveline at one drive angle, all in N.

    Attributes:
        joint_force: per joint, the vector that it exerts on its driven shaft (reversed: on the
            driving one).
        bearing_force: per bearing, the vector that it exerts on its shaft.
    """

    joint_force: tuple[Vector, ...]
    bearing_force: tuple[Vector, ...]


def forces(
    shafts: Shafts,
    loads: Loads,
    lengths: Sequence[float],
    bearings: Sequence[tuple[int, float]] = (),
) -> Forces:
    """Return the forces that go with the moments of a driveline.

    Args:
        shafts: the driveline.
        loads: its moments at a drive angle.
        lengths: of each shaft [m].
        bearings: shaft of each, and its distance from the upstream end of the shaft [m].

    Errors: rounding, times the ratio of the longest lever arm to the shortest for each shaft that
    loads the next.

    Source: equilibrium of every shaft (documentation, Theory, Forces).

    Raises:
        ValueError: not one length per shaft; supports that are too many or too few for statics.
    """
    count = len(shafts.directions)
    if len(lengths) != count:
        raise ArgumentValueError("lengths", f"has {len(lengths)} values; there are {count} shafts")
    supported = _supported(count, [shaft for shaft, _ in bearings])
    joint_force: dict[int, Vector] = {j: _ZERO for j, held in enumerate(supported) if held is None}
    bearing_force: dict[int, Vector] = {}
    waiting = [shaft for shaft in range(count) if _needed(shaft, count, bearings)]
    while waiting:
        for shaft in waiting:
            ends = [j for j in (shaft - 1, shaft) if 0 <= j < count - 1]
            own = [j for j in ends if supported[j] == shaft]
            others = [j for j in ends if supported[j] != shaft]
            # The joints that support its neighbours must be known.
            if not all(j in joint_force for j in others):
                continue
            along = shafts.directions[shaft]
            at = {j: 0.0 if j < shaft else lengths[shaft] for j in ends}
            sign = {j: 1.0 if j < shaft else -1.0 for j in ends}
            acting = [(at[j], _across(_scaled(sign[j], joint_force[j]), along)) for j in others]
            held = [i for i, (place, _) in enumerate(bearings) if place == shaft]
            places = [bearings[i][1] for i in held] + [at[j] for j in own]
            first, second = _balance(along, loads.support_moment[shaft], places, acting)
            found = dict(
                zip(
                    [("bearing", i) for i in held] + [("joint", j) for j in own],
                    (first, second),
                    strict=True,
                )
            )
            for (what, number), force in found.items():
                if what == "bearing":
                    bearing_force[number] = force
                else:
                    joint_force[number] = _scaled(sign[number], force)
            waiting.remove(shaft)
            break
    return Forces(
        tuple(joint_force[j] for j in range(count - 1)),
        tuple(bearing_force[i] for i in range(len(bearings))),
    )


def _balance(
    along: Vector, moment: Vector, places: Sequence[float], acting: Sequence[tuple[float, Vector]]
) -> tuple[Vector, Vector]:
    """The forces at two places that give a shaft a moment, beside forces that act on it.

    Moments about the first place: ``u x ((x2 - x1) F2 + sum (x - x1) R)`` is the moment, and its
    cross product with ``u`` is the bracket.
    """
    first, second = places
    bracket = _cross(moment, along)
    total = _ZERO
    for place, force in acting:
        bracket = _plus(bracket, _scaled(first - place, force))
        total = _plus(total, force)
    there = _scaled(1.0 / (second - first), bracket)
    return _scaled(-1.0, _plus(there, total)), there


def _needed(shaft: int, count: int, bearings: Sequence[tuple[int, float]]) -> bool:
    """Whether a shaft must be balanced; an end without bearings is part of a machine."""
    return 0 < shaft < count - 1 or any(own == shaft for own, _ in bearings)


def _supported(count: int, bearings: Sequence[int]) -> list[int | None]:
    """The shaft that each joint supports, if it supports one."""
    supported: list[int | None] = [None] * (count - 1)
    missing = {}
    for shaft in range(count):
        own = bearings.count(shaft)
        if own > 2:
            raise ArgumentValueError(
                "bearings", f"are {own} on shaft {shaft}; forces are determinate with two"
            )
        if own or 0 < shaft < count - 1:
            missing[shaft] = 2 - own
    while any(missing.values()):
        before = dict(missing)
        for shaft, lacking in before.items():
            free = [j for j in (shaft - 1, shaft) if 0 <= j < count - 1 and supported[j] is None]
            if lacking and lacking == len(free):
                for j in free:
                    supported[j] = shaft
                missing[shaft] = 0
            elif lacking > len(free):
                raise ArgumentValueError("bearings", f"leave shaft {shaft} without two supports")
        if missing == before:
            shaft = next(shaft for shaft, lacking in missing.items() if lacking)
            raise ArgumentValueError("bearings", f"leave shaft {shaft} with three supports")
    return supported

"""What helps against order 2 at a bearing: heights, slopes, yokes and other stiffnesses."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import NamedTuple

import numpy as np

from cardan.app.answers.lateral.vibration import Complex, Met, Vibration, length, static_forces
from cardan.app.answers.printed import listed, quantity
from cardan.app.answers.rows import count, figure, item
from cardan.arrays import FloatArray
from cardan.driveline import Driveline

# Joints move by at most this share of the shorter shaft beside them, and end shafts turn so far.
_REACH, _SLOPE = 0.08, math.radians(10.0)
# A single change that leaves more than this share is not listed, and a pair must end it.
_HELPS, _ENDS = 0.7, 0.1
_STEPS, _SMALL = 4, 1e-4
_ROUNDING = 1e-9
_AROUND = np.linspace(0.9, 1.1, 161)
# A driveline whose first shaft is steeper than this along y has z upwards.
_STEEP = 0.9
# The joint of 3 degrees that catalogues permit, by which the evenness of the output is measured.
_EVEN = math.tan(math.radians(1.5)) ** 2


@dataclass(frozen=True)
class Remedy:
    """One change, and what order 2 then does at the bearing that bears most of it."""

    change: str = item("change")
    bearing: int = count("bearing", is_detail=True)
    stiffness: float = figure(
        "times the stiffness", meaning="of the bearing, 1 where the layout changes", is_detail=True
    )
    static: float | None = figure("slowly", "N", "order 2 of the force of the bearing by statics")
    resonance: float = figure("resonance", "rpm", "drive speed at which order 2 is largest")
    peak: float | None = figure(
        "there", "N", "order 2 in resonance; none where its damping is not known"
    )
    moved: float | None = figure(
        "displacement", "mm", "of the shaft in the bearing there", digits="small", is_detail=True
    )
    left: float | None = figure("left", "percent", "share of the force without the change")
    bend: float = figure(
        "equivalent bend", "deg", "of the driveline: how unevenly the last shaft turns"
    )


def remedies(found: Vibration, met: Met, bearing: int) -> Iterator[Remedy]:
    """Yield changes that reduce order 2 at a bearing, with what is computed after each of them.

    Args:
        found: the vibration of the driveline as it is.
        met: the resonance of order 2 that matters.
        bearing: the elastic bearing that bears most of it.
    """
    for words, line in _layouts(found, met, bearing):
        after = _after(found, met, bearing, words, line)
        if after.left is not None and after.left <= _HELPS:
            yield after
    for words, factor in (("half the stiffness", 0.5), ("twice the stiffness", 2.0)):
        yield _after(found, met, bearing, words, found.line, factor)


def _after(
    found: Vibration,
    met: Met,
    bearing: int,
    change: str,
    line: Driveline,
    stiffer: float = 1.0,
) -> Remedy:
    """Return what order 2 does after a change, at its resonance then."""
    number = found.case.elastic[bearing]
    changed = Vibration(found.case.stiffened(number, stiffer), line, found.load)
    # The stiffness moves the resonance by its share in the energy of the shape.
    wanted = met.speed * stiffer ** (0.5 * float(met.group.shares[bearing]))
    near = [each for each in changed.met if each.order == met.order]
    own = min(near, key=lambda each: abs(math.log(each.speed / wanted)))
    slow, present = (
        None if static is None else length(static[number])
        for static in (changed.statics, found.statics)
    )
    if not own.is_known:
        left = slow / present if slow is not None and present else None
        bend = float(line.equivalent().bend)
        return Remedy(change, number, stiffer, slow, own.speed, None, None, left, bend)
    speed = own.speed * _AROUND
    assert found.load
    response = changed.system.response(speed, found.load, orders=(met.order,))
    forces = response.of_order("bearing_force")[bearing, :, 0]
    moved = response.of_order("bearing_displacement")[bearing, :, 0]
    at, peak = int(np.argmax(forces)), found.peak(met) if met.is_known else None
    left = None if peak is None else float(forces[at]) / peak[2]
    is_none = left is not None and left < _ROUNDING
    return Remedy(
        change,
        number,
        stiffer,
        slow,
        own.speed if at in (0, len(speed) - 1) else float(speed[at]),
        0.0 if is_none else float(forces[at]),
        0.0 if is_none else float(moved[at]),
        0.0 if is_none else left,
        float(line.equivalent().bend),
    )


class _Move(NamedTuple):
    """A joint that moves up or down, or an end shaft that turns up or down."""

    point: int
    up: FloatArray
    reach: float  # in m

    def made(self, line: Driveline, by: float) -> Driveline:
        """Return the driveline with the point moved, its yokes and bearings as they are."""
        steps = line.directions * line.lengths().each[:, np.newaxis]
        points = np.concatenate([np.zeros((1, 3)), np.cumsum(steps, axis=0)])
        points[self.point] += by * self.up
        bearings = [(shaft, float(position)) for shaft, position in line.bearings]
        return Driveline.from_points(points, line.phases).with_bearings(bearings)

    def words(self, line: Driveline, by: float) -> str:
        """Say how far it is: ``"joint 1 lower by 91.6 mm"``."""
        if 0 < self.point <= line.n_joints:
            way = "higher" if by > 0.0 else "lower"
            return f"joint {self.point - 1} {way} by {quantity(abs(by), 'mm')}"
        shaft = min(self.point, line.n_joints)
        one, other = line.directions[shaft], self.made(line, by).directions[shaft]
        turn = math.atan2(float(np.linalg.norm(np.cross(one, other))), float(one @ other))
        end, way = "input" if self.point == 0 else "output", "up" if by > 0.0 else "down"
        return f"{end} end of shaft {shaft} {way} by {quantity(turn, 'deg')}"


def _moves(line: Driveline) -> Iterator[_Move]:
    up = np.eye(3)[1 if abs(line.directions[0, 1]) < _STEEP else 2]
    lengths = line.lengths().each
    yield _Move(0, up, _SLOPE * float(lengths[0]))
    for joint in range(line.n_joints):
        yield _Move(joint + 1, up, _REACH * float(min(lengths[joint], lengths[joint + 1])))
    yield _Move(line.n_joints + 1, up, _SLOPE * float(lengths[-1]))


def _layouts(found: Vibration, met: Met, bearing: int) -> Iterator[tuple[str, Driveline]]:
    """Yield layouts in which order 2 of a bearing may be smaller, in words.

    It is that in resonance where the damping is known, otherwise that of statics. Of pairs of
    moves the one within the least reach is listed that also leaves no equivalent bend.
    """
    line, load, number = found.line, found.load, found.case.elastic[bearing]
    assert load
    peak = found.peak(met) if met.is_known else None
    speed = np.array([met.speed if peak is None else peak[1]])

    def force(changed: Driveline) -> Complex:
        if met.is_known:
            response = found.case.on(changed).response(speed, load, orders=(met.order,))
            return np.asarray(response.bearing_force[bearing, 0, 0])
        static = static_forces(changed, load)
        return np.zeros(3, dtype=np.complex128) if static is None else np.asarray(static[number])

    present = length(force(line))
    if not present:
        return

    def uneven(changed: Driveline) -> Complex:
        q = np.atleast_1d(changed.transmission().q) / _EVEN
        return np.concatenate([force(changed) / present, q])

    moves = list(_moves(line))
    for move in moves:
        by = _least(line, [move], force)
        for share in (1.0, 0.5):
            if by is not None:
                own = share * float(by[0])
                yield move.words(line, own), move.made(line, own)
    yield _nearer(line, number)
    turned = [("", line)]
    for shaft in range(1, line.n_joints):
        phases = np.array(line.phases)
        phases[shaft - 1] += 0.5 * math.pi
        words = f"yokes of shaft {shaft} turned by {quantity(0.5 * math.pi, 'deg', digits='given')}"
        turned.append((words, line.with_phases(phases)))
        yield turned[-1]
    best: tuple[float, str, Driveline] | None = None
    for words, base in turned:
        for pair in combinations(moves, 2):
            by = _least(base, pair, uneven)
            if by is None:
                continue
            layout = _all_made(base, pair, by)
            used = float(np.max(np.abs(by) / [move.reach for move in pair]))
            if np.max(np.abs(uneven(layout))) <= _ENDS and (best is None or used < best[0]):
                said = [move.words(base, float(x)) for move, x in zip(pair, by, strict=True)]
                best = used, listed([*said, *filter(None, [words])]), layout
    if best is not None:
        yield best[1:]


def _nearer(line: Driveline, bearing: int) -> tuple[str, Driveline]:
    """Return the driveline with a bearing half as far from the nearest end of its shaft."""
    shaft, position = line.bearings[bearing]
    rest = float(line.lengths().each[shaft] - position)
    is_upstream = shaft > 0 and (float(position) < rest or shaft == line.n_joints)
    by = 0.5 * (-float(position) if is_upstream else rest)
    moved = [(own, float(at) + by * (i == bearing)) for i, (own, at) in enumerate(line.bearings)]
    joint = shaft - 1 if is_upstream else shaft
    words = f"bearing {bearing} nearer to joint {joint} by {quantity(abs(by), 'mm')}"
    return words, line.with_bearings(moved, line.lengths().each)


def _all_made(line: Driveline, moves: Sequence[_Move], by: FloatArray) -> Driveline:
    """Return the driveline after several moves."""
    for move, x in zip(moves, by, strict=True):
        line = move.made(line, float(x))
    return line


def _least(
    line: Driveline, moves: Sequence[_Move], wanted: Callable[[Driveline], Complex]
) -> FloatArray | None:
    """Return the moves that make something least, by Gauss and Newton; ``None`` if out of reach.

    Forces are nearly linear in the moves, so few steps suffice.
    """
    reach = np.array([move.reach for move in moves])
    by = np.zeros(len(moves))
    for _ in range(_STEPS):
        here = wanted(_all_made(line, moves, by))
        slopes = [
            (wanted(_all_made(line, moves, by + _SMALL * reach * unit)) - here) / _SMALL
            for unit in np.eye(len(moves))
        ]
        matrix = np.concatenate([np.real(slopes), np.imag(slopes)], axis=1).T
        step = np.linalg.lstsq(matrix, -np.concatenate([here.real, here.imag]), rcond=1e-9)[0]
        by = by + reach * step
        if np.any(np.abs(by) > reach):
            return None
    return by

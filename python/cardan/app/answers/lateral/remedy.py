"""Remedies for order 2 at a bearing: heights, slopes, yokes and other stiffnesses."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import partial
from itertools import combinations
from typing import NamedTuple, TypeAlias

import numpy as np

from cardan.app.answers.forces.figures import length
from cardan.app.answers.lateral.vibration import Complex, Met, Vibration
from cardan.app.answers.printed import listed, quantity
from cardan.app.answers.rows import count, figure, item
from cardan.arrays import FloatArray
from cardan.driveline import Driveline

# A joint moves by at most this share of the shorter shaft beside it. An end shaft turns by at most
# this angle.
_REACH, _SLOPE = 0.08, math.radians(10.0)
# A single change that leaves more than this share is not listed, and a pair must end it.
_HELPS, _ENDS = 0.7, 0.1
_STEPS, _SMALL = 4, 1e-4
_ROUNDING = 1e-9
_AROUND = np.linspace(0.9, 1.1, 161)
_ORDER, _MODES = 2, 12
# Resonances count up to so far beyond the speeds.
_TOP = 1.5
# Natural frequencies of one shape in two directions differ by less.
_ALIKE = 0.04
# The loss factor by which changes are compared where the damping is not known.
_NOMINAL = 0.1
# A bearing holds a shape in which it has so much of the elastic energy, of the most in any shape.
_HELD = 0.3
# A driveline whose first shaft is steeper than this along y has z upwards.
_STEEP = 0.9
# The joint of 3 degrees that catalogues permit, by which the evenness of the output is measured.
_EVEN = math.tan(math.radians(1.5)) ** 2


_Change: TypeAlias = Callable[[Driveline], Driveline]


@dataclass(frozen=True)
class Remedy:
    """One change, and what order 2 then does at the bearing that bears most of it.

    Attributes:
        made: makes the changed driveline.
    """

    made: _Change = field(repr=False)
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
    left: float = figure(
        "left", "percent", "share of the largest force without the change, of bearings and states"
    )
    elsewhere: float | None = figure(
        "elsewhere",
        "percent",
        "share of order 2 in other resonances, at equal damping",
        is_detail=True,
    )
    bend: float = figure(
        "equivalent bend", "deg", "of the driveline: how unevenly the last shaft turns"
    )


def remedies(
    every: Sequence[Vibration], one: Vibration, met: Met, bearing: int
) -> Iterator[Remedy]:
    """Yield changes that reduce order 2 at bearings, with what is computed after each of them.

    Where the damping of the resonance is not known, its share that is left is that of a known
    damping, on which it hardly depends.

    Args:
        every: the vibration in each state.
        one: that in the worst state.
        met: its resonance of order 2 that matters.
        bearing: the elastic bearing that bears most of it.
    """
    place = every.index(one)
    if not met.is_known:
        every = [each.damped(_NOMINAL) for each in every]
    one, before = every[place], [_peak(each, met.speed) for each in every]
    most = max(float(np.max(peak.forces)) for peak in before)
    if not most:
        return
    others, number = _elsewhere(every, met), one.case.elastic[bearing]
    tried: list[tuple[str, float, _Change]] = [
        *((words, 1.0, change) for words, change in _layouts(one, before[place], number)),
        *(("half the stiffness", 0.5, _same), ("twice the stiffness", 2.0, _same)),
    ]
    for words, stiffer, change in tried:
        is_layout = stiffer == 1.0
        after = [
            Vibration(each.case.stiffened(number, stiffer), change(each.line), each.load)
            for each in (every if is_layout else [one])
        ]
        highest = met.speed * math.sqrt(max(1.0, stiffer))
        speed = met.speed if is_layout else _own(after[0], bearing, highest)
        peaks = [_peak(each, speed) for each in after]
        worst = int(np.argmax([np.max(peak.forces) for peak in peaks]))
        statics, peak = after[worst].statics, peaks[worst]
        own = int(np.argmax(peak.forces))
        bears, left = one.case.elastic[own], float(peak.forces[own]) / most
        if is_layout and left > _HELPS:
            continue
        is_some = left >= _ROUNDING
        yield Remedy(
            change,
            words,
            bears if is_layout else number,
            stiffer,
            None if statics is None else length(statics[bears]),
            peak.speed,
            is_some * float(peak.forces[own]) if met.is_known else None,
            is_some * float(peak.moved[own]) if met.is_known else None,
            is_some * left,
            _elsewhere(after, met) / others if others and is_layout else None,
            max(float(each.line.equivalent().bend) for each in after),
        )


def left_with(found: Vibration, layout: Remedy, other: Remedy) -> float:
    """Return order 2 in N at the bearing of another stiffness, in resonance in a changed layout."""
    case = found.case.stiffened(other.bearing, other.stiffness)
    peak = _peak(Vibration(case, layout.made(found.line), found.load), other.resonance)
    return float(peak.forces[case.elastic.index(other.bearing)])


def _same(line: Driveline) -> Driveline:
    return line


class _Peak(NamedTuple):
    """Order 2 in resonance: of each elastic bearing the force, and the displacement there."""

    speed: float
    forces: FloatArray
    moved: FloatArray


def _peak(found: Vibration, wanted: float) -> _Peak:
    """Order 2 in the resonance next to a speed."""
    frequencies = _resonances(found)
    nearest = np.argmin(np.abs(np.log(frequencies / wanted)))
    return _at(found, frequencies[nearest : nearest + 1])


def _own(found: Vibration, bearing: int, highest: float) -> float:
    """Where order 2 is largest, at equal damping, of the shapes that a bearing holds.

    Twice the stiffness raises no natural frequency by more than the root of 2 (Lord Rayleigh,
    1877), so what lies above the ``highest`` speed is another resonance.
    """
    met = [each for each in found.met if each.order == _ORDER]
    speeds = np.array([each.speed for each in met])
    shares = np.array([each.group.shares[bearing] for each in met])
    shares[speeds > (1.0 + _ROUNDING) * highest] = 0.0
    return _at(found.damped(_NOMINAL), speeds[shares >= _HELD * np.max(shares)]).speed


def _at(found: Vibration, frequencies: FloatArray) -> _Peak:
    """Order 2 where it is largest around natural frequencies over its order."""
    assert found.load
    speed = np.unique(np.multiply.outer(frequencies, _AROUND))
    response = found.system.response(speed, found.load, orders=(_ORDER,))
    forces = response.of_order("bearing_force")[..., 0]
    moved = response.of_order("bearing_displacement")[..., 0]
    at = int(np.argmax(np.max(forces, axis=0)))
    return _Peak(float(speed[at]), forces[:, at], moved[:, at])


def _elsewhere(every: Sequence[Vibration], met: Met) -> float:
    """The largest force of order 2 in all other resonances, at one damping for all."""
    found = [0.0]
    for each in every:
        frequencies = _resonances(each)
        away = np.abs(np.log(frequencies / met.speed))
        others = frequencies[away > np.min(away) + _ALIKE]
        if others.size:
            found.append(float(np.max(_at(each.damped(_NOMINAL), others).forces)))
    return max(found)


def _resonances(found: Vibration) -> FloatArray:
    """The drive speeds at which order 2 meets natural frequencies."""
    frequencies = found.system.natural_frequencies(_MODES) / _ORDER
    return np.asarray(frequencies[frequencies <= _TOP * found.case.speed[-1]])


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


def _layouts(found: Vibration, peak: _Peak, number: int) -> Iterator[tuple[str, _Change]]:
    """Yield changes in which order 2 in resonance may be smaller, in words.

    Of pairs of moves the one within the least reach is listed that also leaves no equivalent bend.
    """
    line, load = found.line, found.load
    assert load
    place = int(np.argmax(peak.forces))

    def force(changed: Driveline) -> Complex:
        response = found.case.on(changed).response([peak.speed], load, orders=(_ORDER,))
        return np.asarray(response.bearing_force[place, 0, 0])

    present = length(force(line))

    def uneven(changed: Driveline) -> Complex:
        q = np.atleast_1d(changed.transmission().q) / _EVEN
        return np.concatenate([force(changed) / present, q])

    moves = list(_moves(line))
    for move in moves:
        if (by := _least(line, [move], force)) is not None:
            for own in (by, 0.5 * by):
                yield move.words(line, own[0]), partial(_moved, moves=[move], by=own)
    yield _nearer(line, number)
    turned: list[tuple[str, int | None]] = [("", None)]
    for shaft in range(1, line.n_joints):
        words = f"yokes of shaft {shaft} turned by {quantity(0.5 * math.pi, 'deg', digits='given')}"
        turned.append((words, shaft))
        yield words, partial(_moved, moves=(), by=np.empty(0), turned=shaft)
    best: tuple[float, str, _Change] | None = None
    for words, turn in turned:
        base = _moved(line, (), np.empty(0), turn)
        for pair in combinations(moves, 2):
            by = _least(base, pair, uneven)
            if by is None or np.max(np.abs(uneven(_moved(base, pair, by)))) > _ENDS:
                continue
            used = float(np.max(np.abs(by) / [move.reach for move in pair]))
            if best is None or used < best[0]:
                said = [move.words(base, x) for move, x in zip(pair, by, strict=True)]
                change = partial(_moved, moves=pair, by=by, turned=turn)
                best = used, listed([*said, *filter(None, [words])]), change
    if best is not None:
        yield best[1:]


def _moved(
    line: Driveline, moves: Sequence[_Move], by: FloatArray, turned: int | None = None
) -> Driveline:
    """The driveline after several moves, first with the yokes of a shaft at right angles to now."""
    if turned is not None:
        line = line.with_phases(
            line.phases + 0.5 * math.pi * (np.arange(1, line.n_joints) == turned)
        )
    for move, x in zip(moves, by.tolist(), strict=True):
        line = move.made(line, x)
    return line


def _nearer(line: Driveline, bearing: int) -> tuple[str, _Change]:
    """A change that puts a bearing half as far from the nearest end of its shaft."""
    shaft, position = line.bearings[bearing]
    rest = float(line.lengths().each[shaft] - position)
    is_upstream = shaft > 0 and (float(position) < rest or shaft == line.n_joints)
    by = 0.5 * (-float(position) if is_upstream else rest)

    def slid(own: Driveline) -> Driveline:
        moved = [(on, float(at) + by * (i == bearing)) for i, (on, at) in enumerate(own.bearings)]
        return own.with_bearings(moved, own.lengths().each)

    joint = shaft - 1 if is_upstream else shaft
    return f"bearing {bearing} nearer to joint {joint} by {quantity(abs(by), 'mm')}", slid


def _least(
    line: Driveline, moves: Sequence[_Move], wanted: Callable[[Driveline], Complex]
) -> FloatArray | None:
    """Return the moves that make something least, by Gauss and Newton; ``None`` if out of reach.

    Forces are nearly linear in the moves, so few steps suffice.
    """
    reach = np.array([move.reach for move in moves])
    by = np.zeros(len(moves))
    for _ in range(_STEPS):
        here = wanted(_moved(line, moves, by))
        slopes = [
            (wanted(_moved(line, moves, by + _SMALL * reach * unit)) - here) / _SMALL
            for unit in np.eye(len(moves))
        ]
        matrix = np.concatenate([np.real(slopes), np.imag(slopes)], axis=1).T
        step = np.linalg.lstsq(matrix, -np.concatenate([here.real, here.imag]), rcond=1e-9)[0]
        by = by + reach * step
        if np.any(np.abs(by) > reach):
            return None
    return by

"""One setting of the yokes for all states of a driveline, such as its ride heights.

The setting minimises the weighted sum of ``|q|**2`` over the states, where ``q = B/A`` is the one
number on which the motion of the last shaft depends. A chain makes ``A w + B conj(w)`` of ``w =
exp(i a)``: joint ``j`` has the matrix ``[[1, -k], [-k, 1]]``, ``k = tan(bend/2)**2``, a shaft
``diag(exp(i p), exp(-i p))`` with ``p = phase - twist + 90°`` (from Thoma 4). ``|A|**2 - |B|**2``
does not depend on the phases, so ``|q|**2`` has the exact derivatives of ``D |B|**2/|A|**4``.
"""

from __future__ import annotations

import operator
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cardan.arrays import FloatArray, as_float64
from cardan.batch import Batch
from cardan.errors import ArgumentTypeError, ArgumentValueError
from cardan.teeth import least_turned, teeth_of

_Complex = NDArray[np.complex128]

# Settings tried at random, and how many of the best of them are refined.
_TRIED, _REFINED = 512, 12

# Newton steps at most; a handful suffices unless the least is flat.
_STEPS = 60

# Doubles in flight: settings are evaluated so many at a time.
_BLOCK = 1 << 16

# Settings whose objectives differ by less are as good.
_ROUNDING = 1e-12


def common_phases(
    line: Batch,
    best: FloatArray,
    states: int | None,
    weights: ArrayLike | None,
    teeth: int | Sequence[int] | None,
    fixed: int | Sequence[int] | None,
) -> FloatArray:
    """Return one setting for all states; arguments and errors as of ``optimal_phases``.

    ``best`` has the best phases of each driveline alone, which the search starts from.
    """
    if states is None:
        if weights is not None:
            raise ArgumentValueError(
                "weights", "needs states, the axis of the batch that it weighs"
            )
        batch, axis = (*line.shape, 1), len(line.shape)
    else:
        batch, axis = line.shape, _axis(line, states)
    count = batch[axis]
    if not count:
        raise ArgumentValueError("states", f"is {states}; that axis of the batch is empty")
    weighing = _weights(weights, count)
    held = _held(fixed, line.n_joints)
    counts = None if teeth is None else teeth_of(teeth, line.n_joints - 1)
    rows = line.size // count
    bends, twists, present, own = (
        np.moveaxis(array.reshape(*batch, array.shape[-1]), axis, -2).reshape(rows, count, -1)
        for array in (line.bends, line.twists, line.phases, best)
    )
    shape = (*batch[:axis], *batch[axis + 1 :], line.n_joints - 1)
    _check_common(present, held, counts)
    found = np.empty((len(bends), line.n_joints - 1))
    for row, (bend, twist, now, each) in enumerate(zip(bends, twists, present, own, strict=True)):
        chains = _Chains(bend, twist, weighing)
        setting = _least(chains, now[0], each, ~held)
        if counts is not None:
            settable = np.where(held, 1, counts).tolist()
            turns = least_turned(chains.root, now[0], settable, setting)
            setting = now[0] + 2.0 * np.pi * turns / np.asarray(settable)
        found[row] = setting
    return found.reshape(shape)


class _Chains:
    """The chains of all states with the phases open; phases are ``(trials, n - 1)``."""

    def __init__(self, bends: FloatArray, twists: FloatArray, weights: FloatArray) -> None:
        self.k = np.tan(bends / 2.0) ** 2
        self.at_phase_0 = 0.5 * np.pi - twists
        self.weights = weights
        self.determinant = np.prod(1.0 - self.k**2, axis=-1)

    def root(self, phases: FloatArray) -> FloatArray:
        """The root of the objective, ``(trials,)``: a mean ``|q|``."""
        block = max(1, _BLOCK // self.k.size)
        parts = [self._value(phases[i : i + block]) for i in range(0, len(phases), block)]
        return np.sqrt(np.concatenate(parts))

    def _value(self, phases: FloatArray) -> FloatArray:
        a = np.ones((len(phases), len(self.k)), dtype=np.complex128)
        b = np.zeros_like(a)
        for joint in range(self.k.shape[-1]):
            if joint:
                turn = self._turn(phases, joint - 1)
                a, b = turn * a, turn * b
            k = self.k[:, joint]
            a, b = a - k * np.conj(b), b - k * np.conj(a)
        return np.asarray(np.sum(self.weights * np.abs(b / a) ** 2, axis=-1))

    def _turn(self, phases: FloatArray, shaft: int) -> _Complex:
        turn: _Complex = np.exp(1j * (phases[:, shaft, None] + self.at_phase_0[:, shaft]))
        return turn

    def derivatives(self, phases: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Objective ``(trials,)``, gradient ``(trials, n - 1)`` and Hessian by the phases.

        ``dB/dp_i`` puts ``i diag(1, -1)`` behind shaft ``i``; a row of the product is carried
        backwards through the chain for each shaft, which makes all second derivatives.
        """
        shafts = phases.shape[-1]
        turns = [self._turn(phases, shaft) for shaft in range(shafts)]
        # Columns (A, conj B) and (B, conj A) of the chain up to each shaft, the shaft included.
        a = np.ones_like(turns[0])
        b = np.zeros_like(a)
        before = []
        for joint in range(shafts + 1):
            if joint:
                a, b = turns[joint - 1] * a, turns[joint - 1] * b
                before.append((a, b))
            k = self.k[:, joint]
            a, b = a - k * np.conj(b), b - k * np.conj(a)
        first = np.empty((shafts, *a.shape), dtype=np.complex128)
        second = np.empty((shafts, shafts, *a.shape), dtype=np.complex128)
        for shaft in range(shafts):
            # The row (1, 0) carried back to this shaft, then turned there.
            row = self._back((np.ones_like(a), np.zeros_like(a)), shafts, shaft, turns)
            row = (1j * row[0], -1j * row[1])
            first[shaft] = row[0] * before[shaft][1] + row[1] * np.conj(before[shaft][0])
            second[shaft, shaft] = -b
            at = shaft
            while at:
                row = self._back(row, at, at - 1, turns)
                at -= 1
                mixed = 1j * (row[0] * before[at][1] - row[1] * np.conj(before[at][0]))
                second[shaft, at] = second[at, shaft] = mixed
        size, top = np.abs(a) ** 2, np.abs(b) ** 2
        slope = 2.0 * np.real(np.conj(b) * first)
        bend = 2.0 * np.real(first[:, None] * np.conj(first) + np.conj(b) * second)
        scale = self.weights * self.determinant / size**2
        value = np.sum(self.weights * top / size, axis=-1)
        gradient = np.sum(scale * slope, axis=-1)
        hessian = np.sum(scale * (bend - 2.0 * slope[:, None] * slope / size), axis=-1)
        return value, gradient.T, np.moveaxis(hessian, -1, 0)

    def _back(
        self, row: tuple[_Complex, _Complex], start: int, stop: int, turns: list[_Complex]
    ) -> tuple[_Complex, _Complex]:
        """A row times the joints and shafts behind shaft ``stop``, up to joint ``start``."""
        x, y = row
        for joint in range(start, stop, -1):
            if joint < len(turns):
                x, y = x * turns[joint], y * np.conj(turns[joint])
            k = self.k[:, joint]
            x, y = x - k * y, y - k * x
        return x, y


def _least(
    chains: _Chains, now: FloatArray, own: FloatArray, free: NDArray[np.bool_]
) -> FloatArray:
    """The setting with the least objective; of those as good the one that turns the yokes least."""
    if not np.any(free):
        return now
    random = np.random.default_rng(0)
    tried = now + free * random.uniform(-0.5 * np.pi, 0.5 * np.pi, (_TRIED, len(now)))
    tried = np.concatenate([np.where(free, own, now), tried])
    starts = tried[np.argsort(chains.root(tried), kind="stable")[:_REFINED]]
    settings = _newton(chains, np.concatenate([now[None], starts]), free)
    # A yoke looks the same after half a turn.
    settings = now + _within_half_turn(settings - now)
    root = chains.root(settings)
    good = root <= np.min(root) * (1.0 + 1e-9) + _ROUNDING
    turned = np.where(good, np.sum((settings - now) ** 2, axis=-1), np.inf)
    return np.asarray(settings[np.argmin(turned)])


def _newton(chains: _Chains, phases: FloatArray, free: NDArray[np.bool_]) -> FloatArray:
    """Refine settings, ``(trials, n - 1)``, all of them at once."""
    value, gradient, hessian = chains.derivatives(phases)
    for _ in range(_STEPS):
        own = hessian[:, free][:, :, free]
        sizes, axes = np.linalg.eigh(own)
        # Downhill along every axis; where the objective is flat there is nothing to gain.
        least = 1e-9 * np.max(np.abs(sizes), axis=-1, keepdims=True) + 1e-300
        along = np.einsum("tji,tj->ti", axes, gradient[:, free])
        step = -np.einsum("tij,tj->ti", axes, along / np.maximum(np.abs(sizes), least))
        longest = np.max(np.abs(step), axis=-1, keepdims=True)
        step *= np.minimum(1.0, 0.5 / np.maximum(longest, 1e-300))
        size = np.ones((len(phases), 1))
        for _ in range(8):
            trial = phases.copy()
            trial[:, free] += size * step
            new = chains.derivatives(trial)
            worse = new[0] > value * (1.0 + 1e-14)
            if not np.any(worse):
                break
            size[worse] /= 4.0
        better = ~worse
        phases = np.where(better[:, None], trial, phases)
        moved = np.max(np.abs(size * step)[better], initial=0.0)
        value, gradient, hessian = (
            np.where(better.reshape(-1, *(1,) * (old.ndim - 1)), fresh, old)
            for old, fresh in zip((value, gradient, hessian), new, strict=True)
        )
        if moved < 1e-14:
            break
    return phases


def _within_half_turn(angle: FloatArray) -> FloatArray:
    return np.asarray(angle - np.pi * np.round(angle / np.pi))


# --- arguments -----------------------------------------------------------------------------------


def _axis(line: Batch, states: Any) -> int:  # noqa: ANN401 - checked here
    try:
        axis = operator.index(states)
    except TypeError:
        problem = f"is {states!r}; it must be the number of an axis of the batch"
        raise ArgumentTypeError("states", problem) from None
    if not -len(line.shape) <= axis < len(line.shape):
        raise ArgumentValueError("states", f"is {axis}; the batch has shape {line.shape}")
    return axis % len(line.shape)


def _weights(weights: ArrayLike | None, count: int) -> FloatArray:
    if weights is None:
        return np.full(count, 1.0 / count)
    given = as_float64("weights", weights)
    if given.shape != (count,):
        raise ArgumentValueError(
            "weights", f"has shape {given.shape}; it must be ({count},), one per state"
        )
    for i, weight in enumerate(given):
        if not (np.isfinite(weight) and weight >= 0.0):
            problem = f"is {weight:g}; a weight must be finite and not negative"
            raise ArgumentValueError("weights", problem, (i,))
    if not np.any(given):
        raise ArgumentValueError("weights", "has only zeros; at least one state must count")
    return np.asarray(given / np.sum(given))


def _held(fixed: int | Sequence[int] | None, n_joints: int) -> NDArray[np.bool_]:
    held = np.zeros(n_joints - 1, dtype=bool)
    try:
        shafts = [] if fixed is None else [operator.index(shaft) for shaft in np.atleast_1d(fixed)]
    except TypeError:
        raise ArgumentTypeError("fixed", f"is {fixed!r}; it must list numbers of shafts") from None
    for shaft in shafts:
        if not 0 < shaft < n_joints:
            raise ArgumentValueError(
                "fixed", f"is {shaft}; shafts 1 to {n_joints - 1} have yokes at both ends"
            )
        held[shaft - 1] = True
    return held


def _check_common(
    present: FloatArray, held: NDArray[np.bool_], teeth: NDArray[np.int64] | None
) -> None:
    """Refuse present phases that differ over the states where the answer is counted from them."""
    differs = np.any(np.abs(_within_half_turn(present - present[:, :1])) > 1e-12, axis=(0, 1))
    for shaft in np.flatnonzero(differs):
        if held[shaft] or teeth is not None:
            argument = "fixed" if held[shaft] else "teeth"
            raise ArgumentValueError(
                argument,
                f"needs one present phase of shaft {shaft + 1}; it differs between the states",
            )

"""An independent search, in NumPy, for one setting of the yokes that serves all states.

A chain makes ``A w + B conj(w)`` of ``w = exp(i a)``: joint ``j`` has the matrix ``[[1, -k], [-k,
1]]``, ``k = tan(bend/2)**2``, a shaft ``diag(exp(i p), exp(-i p))`` with ``p = phase - twist +
90°`` (from Thoma 4). ``|A|**2 - |B|**2`` does not depend on the phases, so ``|q|**2`` has the exact
derivatives of ``D |B|**2/|A|**4``.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from itertools import product

import numpy as np
from numpy.typing import NDArray

from cardan.arrays import FloatArray

_Complex = NDArray[np.complex128]

# Settings tried at random, and how many of the best of them are refined.
_TRIED, _REFINED = 512, 12

# Newton steps at most; a handful suffices unless the least is flat.
_STEPS = 60

# Doubles in flight: settings are evaluated so many at a time.
_BLOCK = 1 << 16

# Settings whose objectives differ by less are as good.
_ROUNDING = 1e-12

# So many settings, and the teeth of so many neighbouring shafts, are compared at once.
_SETTINGS, _SHAFTS = 1 << 16, 12

# What is left of k by rounding where joints cancel each other.
_CANCELLED = 1e-15


class Chains:
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


def least(chains: Chains, now: FloatArray, own: FloatArray, free: NDArray[np.bool_]) -> FloatArray:
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


def _newton(chains: Chains, phases: FloatArray, free: NDArray[np.bool_]) -> FloatArray:
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


def least_turned(
    objective: Callable[[FloatArray], FloatArray],
    present: FloatArray,
    teeth: Sequence[int],
    best: FloatArray,
) -> NDArray[np.int64]:
    """Return by how many teeth to turn the output-side yokes for the least objective.

    All positions of all shafts are compared if there are not too many: three shafts of 80 teeth, or
    five of 18. Otherwise it is the positions nearest to the best phases, of twelve neighbouring
    shafts at a time until nothing improves. Of settings that differ by rounding only, the one that
    turns the yokes least is taken.

    Args:
        objective: of settings in rad, ``(trials, n - 1)``; linear in the error of a setting near
            its least, as ``k`` is.
        present: the phases from which teeth count, ``(n - 1,)``.
        teeth: of the spline of each shaft between two joints.
        best: the phases to come near to, ``(n - 1,)``.
    """
    n, pitches = len(teeth), 2.0 * np.pi / np.asarray(teeth)
    width = min(n, _SHAFTS)
    steps = [_steps(count) for count in teeth]
    if math.prod(map(len, steps)) > _SETTINGS:
        most = int(_SETTINGS ** (1.0 / width))
        for shaft, own in enumerate(steps):
            off = present[shaft] + pitches[shaft] * own - best[shaft]
            order = np.argsort(np.abs(off - np.pi * np.round(off / np.pi)))
            steps[shaft] = own[order[:most]]
    turns = np.array([own[0] for own in steps])
    groups = [slice(first, first + width) for first in range(0, n - width + 1, width // 2 or 1)]
    groups += [slice(n - width, n)] if n > width else []
    least = np.inf
    while True:
        for group in groups:
            chosen = np.array(list(product(*steps[group])))
            trials = np.tile(turns, (len(chosen), 1))
            trials[:, group] = chosen
            k = objective(present + pitches * trials)
            size = np.sum((pitches * trials) ** 2, axis=-1)
            good = k <= np.min(k) * (1.0 + 1e-9) + _CANCELLED
            taken = int(np.argmin(np.where(good, size, np.inf)))
            turns, found = trials[taken], float(k[taken])
        if len(groups) == 1 or found >= least - _CANCELLED:
            return turns
        least = found


def _steps(teeth: int) -> NDArray[np.int64]:
    """Turns in teeth that give all positions of a yoke, which looks the same every 180°.

    With an odd number of teeth half a turn is no whole number of them, so that there are twice as
    many positions as within 180° of the spline.
    """
    period = teeth if teeth % 2 else teeth // 2
    return np.arange(period) - (period - 1) // 2

"""Uncertainty of an order found in a recording whose noise has any spectrum."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from cardan.arrays import FloatArray

# Rows of waves that are held at once.
_ROWS = 1 << 14

# Orders on each side of order 2, in steps of one per recording, and the whole ones above it.
_NEAR = 12
_WHOLE = range(4, 29)
# Turns from which orders between the whole ones are told from them.
_FEWEST_TURNS = 1.9

# Below this share of the noise near order 2, a difference of estimates is their scatter.
_LEAST_SHARE = 0.7

# Multiples of an encoder's order whose lines are added up.
_LINES = range(1, 17)


class Noise(NamedTuple):
    """Variance per sample of independent noise that would scatter order 2 as much."""

    variance: float
    freedom: float


def spectral_noise(
    drive: FloatArray, rest: FloatArray, fitted: FloatArray, turns: float
) -> tuple[Noise, FloatArray]:
    """Return the noise at order 2, and the inverse normal matrix of the fit.

    The residual of the fit, ``rest`` at drive angles ``drive`` beside the columns ``fitted``, gives
    the noise near order 2 by its neighbouring orders. Noise that repeats in every turn lies at
    whole orders alone: what orders 4 to 28 have beyond the half orders between them is added. A
    recording of less than two turns cannot tell these apart: its whole orders count. The degrees of
    freedom are those of Welch and Satterthwaite.
    """
    if turns < _FEWEST_TURNS:
        (whole,), inverse = _energies(drive, rest, fitted, [_WHOLE])
        return whole, inverse
    groups = [
        beside_order_2(turns, range(1, _NEAR + 1)),
        _WHOLE,
        [order + 0.5 for order in _WHOLE],
    ]
    parts, inverse = _energies(drive, rest, fitted, groups)
    near, whole, between = parts
    least = _LEAST_SHARE * near.variance
    variance = max(near.variance + whole.variance - between.variance, least)
    scatter = sum(part.variance**2 / max(1.0, part.freedom) for part in parts)
    mean = sum(part.variance for part in parts) / 3.0
    freedom = max(variance, mean) ** 2 / scatter if scatter else math.inf
    return Noise(variance, freedom), inverse


def beside_order_2(turns: float, steps: range) -> list[float]:
    """Orders that are so many steps of one per recording from order 2, and less than one."""
    apart = [step / turns for step in steps if step < 0.99 * turns]
    return [2.0 + distance for distance in (*(-each for each in reversed(apart)), *apart)]


def noise_at(
    drive: FloatArray, rest: FloatArray, fitted: FloatArray, orders: Sequence[float]
) -> Noise:
    """Return the noise that the fit leaves at some orders; arguments are as ``spectral_noise``."""
    (found,), _ = _energies(drive, rest, fitted, [orders])
    return found


def _energies(
    drive: FloatArray, rest: FloatArray, fitted: FloatArray, groups: Sequence[Sequence[float]]
) -> tuple[list[Noise], FloatArray]:
    """Energy of the rest per degree of freedom of each group of waves beyond the fit."""
    count = fitted.shape[1]
    inverse = np.asarray(np.linalg.inv(fitted.T @ fitted), np.float64)
    found = []
    for orders in groups:
        waves = 2 * len(orders)
        normal, right = np.zeros((count + waves, waves)), np.zeros(waves)
        for begin in range(0, drive.size, _ROWS):
            rows = slice(begin, begin + _ROWS)
            columns = _waves(drive[rows], orders)
            normal[:count] += (columns @ fitted[rows]).T
            normal[count:] += columns @ columns.T
            right += columns @ rest[rows]
        sizes, axes = np.linalg.eigh(normal[count:] - normal[:count].T @ inverse @ normal[:count])
        known = sizes > 1e-6 * drive.size
        energy = (axes[:, known].T @ right) ** 2 / sizes[known]
        found.append(Noise(float(np.sum(energy)) / max(1, energy.size), float(energy.size)))
    return found, inverse


def _waves(drive: FloatArray, orders: Sequence[float]) -> FloatArray:
    """Cosines and sines of increasing orders, ``(2 orders, samples)``, each from that before."""
    waves, turned = np.empty((2, len(orders), drive.size)), {}
    wave, before = np.ones(drive.size, np.complex128), 0.0
    for place, order in enumerate(orders):
        step = round(order - before, 9)
        if step not in turned:
            turned[step] = np.exp(1j * step * drive)
        wave, before = wave * turned[step], order
        waves[:, place] = wave.real, wave.imag
    return waves.reshape(-1, drive.size)


def step_of(angles: FloatArray) -> float:
    """Return the step of the counter of which all angles in rad are multiples, or 0."""
    apart = np.diff(np.unique(angles))
    while True:
        apart = np.unique(np.round(apart[apart > 1e-7], 10))
        if not apart.size:
            return 0.0
        step = float(apart[0])
        if step < 1e-6:
            return 0.0
        apart = np.abs(apart - step * np.rint(apart / step))
        if not np.any(apart > 1e-7):
            return step


def of_steps(drive: FloatArray, driven: FloatArray, rest: FloatArray, step: float) -> float:
    """Return the amplitude of angle error that the steps of a counter may leave at order 2.

    The steps are a sawtooth of the driven angle as fitted: lines at multiples ``m`` of the counts
    per turn, of amplitude ``step/(pi m)``. Samples that meet the counter always at the same places
    turn them into low orders; noise of the angle, which is in the rest, takes them away.
    """
    noise = max(0.0, float(np.mean(rest**2)) - step**2 / 12.0)
    waves = np.exp(1j * np.multiply.outer((0.0, 2.0, -2.0, 4.0, -4.0), drive))
    total = 0.0
    for m in _LINES:
        line = np.exp(2j * math.pi * m / step * driven)
        mean, plus, minus, *fourth = np.abs(waves @ line) / drive.size
        # By chance, samples leave as much as one over the root of their number.
        size = max(1.2 * mean, plus + minus, *fourth) ** 2 - 4.0 / drive.size
        share = math.exp(-((2.0 * math.pi * m / step) ** 2) * noise)
        total += max(0.0, float(size)) * share * (step / (math.pi * m)) ** 2
    return math.sqrt(total)


Z_95 = 1.959963984540054
"""Standard deviations on each side within which 95 % of a normal distribution lie."""


def times_of(freedom: float) -> float:
    """Return within how many estimated standard deviations 95 % lie: Student's t.

    The series by Cornish and Fisher, to 1 % from 2 degrees of freedom on.
    """
    z, many = Z_95, max(2.0, freedom)
    terms = (
        (z**3 + z) / 4.0,
        (5.0 * z**5 + 16.0 * z**3 + 3.0 * z) / 96.0,
        (3.0 * z**7 + 19.0 * z**5 + 17.0 * z**3 - 15.0 * z) / 384.0,
        (79.0 * z**9 + 776.0 * z**7 + 1482.0 * z**5 - 1920.0 * z**3 - 945.0 * z) / 92160.0,
    )
    return z + sum(term / many**power for power, term in enumerate(terms, 1))


# Up to this size, in standard deviations, a wave is not told from none: all of what its interval
# leaves out lies above it.
_NONE = 1.5


def size_interval(size: float, std: float, freedom: float) -> tuple[float, float]:
    """Return the 95 % interval of the size of a wave from the size found, which noise enlarges.

    The size found has the distribution of Rice. The interval has all sizes of which it is none of
    the 5 % that are least likely: half of them on each side, and all above sizes within the noise.
    ``std`` is that of each part of the wave, from so many degrees of freedom.
    """
    scale = std * times_of(freedom) / Z_95
    if not scale > 1e-300:
        return size, size
    found = size / scale
    low = _size_of(found, 0.95)
    if low > _NONE:
        low = max(_NONE, _size_of(found, 0.975))
    return scale * low, scale * max(_NONE, _size_of(found, 0.025))


def _size_of(found: float, share: float) -> float:
    """The size of which noise leaves so large a share below the size found; 0 if none does."""
    low, high = max(0.0, found - 5.0), found + 5.0
    if _below(found, low) < share:
        return 0.0
    for _ in range(40):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if _below(found, middle) > share else (low, middle)
    return low


_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(48)


def _below(found: float, size: float) -> float:
    """The share of ``|size + x + iy|`` below ``found``, with normal ``x`` and ``y``."""
    if found < 8.0:
        y = found * np.sin(0.5 * math.pi * _NODES)
        weights = 0.5 * math.pi * found * np.cos(0.5 * math.pi * _NODES) * _WEIGHTS
    else:
        y, weights = 8.0 * _NODES, 8.0 * _WEIGHTS
    half = np.sqrt(np.maximum(0.0, 0.5 * (found**2 - y**2))).tolist()
    far = size / math.sqrt(2.0)
    within = [0.5 * (math.erf(x - far) + math.erf(x + far)) for x in half]
    return float(weights @ (np.exp(-0.5 * y**2) * within)) / math.sqrt(2.0 * math.pi)

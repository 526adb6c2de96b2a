"""A drive of finite inertia: how far its speed varies where no torque holds it.

Unevenly turning shafts take kinetic energy from the drive and give it back twice a turn. Without a
torque the energy ``J w0²/2`` with ``J = I_0 + sum I_i r_i²`` stays the same, where ``r_i`` is the
speed ratio of shaft ``i``. So the speed of the drive goes as ``1/sqrt(J)``, exactly, whatever its
mean. D. Thoma, "Das Kräftespiel im Kreuzgelenk", Schweizerische Bauzeitung 75 (1920), asks that the
drive's inertia be so large that its speed counts as constant; this says how large that is.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Protocol, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cardan.arrays import FloatArray, as_float64, common_shape, not_negative, scalar_or_array
from cardan.arrays.errors import ArgumentValueError, wrong_element
from cardan.motion.equivalent import EquivalentJoint

if TYPE_CHECKING:
    from cardan.driveline import Driveline

# Samples of half a turn: enough for the mean of a periodic analytic function to be exact to
# rounding, whose Fourier series falls like the powers of k. Bends above 89.9 degrees get fewer.
_DIGITS, _FEWEST, _MOST = 60.0, 64, 1 << 16

# Doubles at a time.
_BLOCK = 1 << 21

_ROUNDS = 3
_BISECTIONS = 80


class Turning(Protocol):
    """What a drive of finite inertia needs of a driveline."""

    @property
    def n_joints(self) -> int:
        """Number of joints."""

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the batch."""

    @property
    def size(self) -> int:
        """Number of drivelines."""

    def equivalent(self, shaft: int = -1) -> EquivalentJoint:
        """Return the joint that moves a shaft as the whole chain does."""

    def reshape(self, *shape: Any) -> Self:  # noqa: ANN401 - as NumPy takes it
        """Return the same drivelines in a batch of another shape."""

    def __getitem__(self, index: Any) -> Self:  # noqa: ANN401 - as NumPy takes it
        """Return drivelines of the batch."""


@dataclass(frozen=True, eq=False)
class FreeRunning:
    """The speed of a drive that runs freely with its driveline; see ``Driveline.free_running``.

    Speeds are relative to the mean over time, ``2 pi`` over the time of a turn.

    Attributes:
        inertias: as given, in kg m², ``(..., n + 1)``.
        min_speed_ratio: the least speed of the drive over its mean, in the shape of batch and
            inertias.
        max_speed_ratio: the largest.
        variation: the difference of the two: the peak-to-peak variation of the drive's speed.
    """

    inertias: FloatArray
    min_speed_ratio: Any
    max_speed_ratio: Any
    variation: Any
    _line: Any = field(repr=False)
    _scaled: FloatArray = field(repr=False)
    _root: FloatArray = field(repr=False)

    def speed_ratio(self, angle: ArrayLike) -> Any:  # noqa: ANN401 - a scalar or an array
        """Return the speed of the drive over its mean.

        Args:
            angle: drive angle in rad; broadcasts against batch and inertias.

        Raises:
            TypeError: angles that are not real numbers.
            ValueError: shapes that do not broadcast.
        """
        inertia, _, _ = self._inertia(angle)
        return scalar_or_array(self._root / np.sqrt(inertia))

    def acceleration_ratio(self, angle: ArrayLike) -> Any:  # noqa: ANN401
        """Return the acceleration of the drive over the square of its mean speed.

        Args:
            angle: drive angle in rad; broadcasts against batch and inertias.

        Raises:
            TypeError: angles that are not real numbers.
            ValueError: shapes that do not broadcast.
        """
        inertia, slope, _ = self._inertia(angle)
        return scalar_or_array(-0.5 * self._root**2 * slope / inertia**2)

    def time_per_turn(self, speed: ArrayLike, angle: ArrayLike = 0.0) -> Any:  # noqa: ANN401
        """Return the time of one turn in s.

        Args:
            speed: speed of the drive in rad/s at the drive angle.
            angle: drive angle in rad.

        Raises:
            TypeError: values that are not real numbers.
            ValueError: shapes that do not broadcast.
        """
        mean = as_float64("speed", speed) / self.speed_ratio(angle)
        return scalar_or_array(np.asarray(math.tau / mean))

    def drive_inertia_for(self, variation: ArrayLike) -> Any:  # noqa: ANN401
        """Return the least inertia of shaft 0 in kg m² that keeps the variation within a figure.

        The other inertias stay as they are.

        Args:
            variation: peak-to-peak variation of the drive's speed over its mean; broadcasts
                against batch and inertias.

        Raises:
            TypeError: a variation that is not a real number.
            ValueError: a variation that is not positive, shapes that do not broadcast.
        """
        wanted = as_float64("variation", variation)
        wrong = ~(wanted > 0.0)
        if wrong.any():
            raise wrong_element("variation", wanted, wrong, "; it must be positive")
        others = self.inertias.copy()
        others[..., 0] = 0.0
        others, exponents = _scaled(others)
        shape = np.broadcast_shapes(self._line.shape, others.shape[:-1])
        full = common_shape(free_running=shape, variation=wanted.shape)
        turns: list[tuple[FloatArray, float, float]] = []
        for _, turn in _turns(self._line, others):
            turns += zip(turn.inertia, turn.low.tolist(), turn.high.tolist(), strict=True)
        places = np.broadcast_to(np.arange(len(turns)).reshape(shape), full).ravel()
        each = zip(places, np.broadcast_to(wanted, full).ravel().tolist(), strict=True)
        least = [_least_inertia(*turns[place], figure) for place, figure in each]
        power = np.broadcast_to(np.broadcast_to(exponents, shape), full)
        # Beyond the largest double it is infinite.
        with np.errstate(over="ignore"):
            return scalar_or_array(np.ldexp(np.array(least).reshape(full), power))

    def _inertia(self, angle: ArrayLike) -> tuple[FloatArray, FloatArray, FloatArray]:
        angles = as_float64("angle", angle)
        common_shape(driveline=np.shape(self._root), angle=angles.shape)
        return _reduced(self._line, self._scaled, angles)


def free_running(line: Driveline, inertias: ArrayLike) -> FreeRunning:
    """Return how the speed of the drive varies where no torque holds it.

    The kinetic energy of all shafts stays the same, so the speed of the drive goes as
    ``1/sqrt(I_0 + sum I_i r_i**2)`` with the speed ratios ``r_i``. A motor or a load changes
    this only as far as its torque varies within a turn.

    Args:
        inertias: moment of inertia of each shaft about its axis in kg m², with what turns with
            it, ``(..., n + 1)``; broadcasts against the batch. Shaft 0 is the drive.

    Returns:
        speed of the drive over its mean: at any angle, least, largest and the variation.

    Raises:
        TypeError: inertias that are not real numbers.
        ValueError: not one inertia per shaft, a negative one, all of them 0, shapes that do
            not broadcast.

    >>> import cardan
    >>> rig = cardan.Driveline.from_bends([8.5], degrees=True)
    >>> round(float(rig.free_running([10.0, 1.0]).variation), 5)
    0.00201
    """
    line._geometry.check_ideal("free running is computed")
    array = not_negative("inertias", inertias)
    count = line.n_joints + 1
    if array.ndim == 0 or array.shape[-1] != count:
        raise ArgumentValueError(
            "inertias", f"has shape {array.shape}; {count} shafts need (..., {count})"
        )
    if not np.all(np.any(array > 0.0, axis=-1)):
        raise ArgumentValueError("inertias", "are all 0; at least one shaft needs an inertia")
    shape = common_shape(driveline=line.shape, inertias=array.shape[:-1])
    ends = np.empty((3, math.prod(shape)))
    scaled, _ = _scaled(array)
    for rows, turn in _turns(line, scaled):
        ends[:, rows] = turn.low, turn.high, np.mean(np.sqrt(turn.inertia), axis=-1)
    low, high, root = ends.reshape(3, *shape)
    least, largest = root / np.sqrt(high), root / np.sqrt(low)
    varies = scalar_or_array(_variation(root, low, high))
    ends_of = scalar_or_array(least), scalar_or_array(largest)
    return FreeRunning(array.copy(), *ends_of, varies, line, scaled, root)


def _scaled(inertias: FloatArray) -> tuple[FloatArray, NDArray[np.int32]]:
    """The inertias of each driveline over a power of two, so that the largest is from 0.5 to 1.

    Speeds follow from ratios of inertias; powers of inertias could leave the range of doubles.
    """
    exponents = np.frexp(np.max(inertias, axis=-1))[1]
    return np.ldexp(inertias, -exponents[..., np.newaxis]), exponents


@dataclass(frozen=True, eq=False)
class _Turn:
    """The inertia that the drive feels over half a turn: samples of equal steps, and its ends."""

    inertia: FloatArray
    low: FloatArray
    high: FloatArray


def _turns(line: Turning, inertias: FloatArray) -> Iterator[tuple[slice, _Turn]]:
    """Yield rows of the flat batch with what the drive feels there."""
    count = line.n_joints + 1
    shape = np.broadcast_shapes(line.shape, inertias.shape[:-1])
    places = np.broadcast_to(np.arange(line.size).reshape(line.shape), shape).ravel()
    spread = np.broadcast_to(inertias, (*shape, count)).reshape(-1, count)
    flat: Any = line.reshape(-1) if line.shape else line
    steepest = [np.max(line.equivalent(shaft).k, initial=0.0) for shaft in range(1, count)]
    samples = _samples(float(max(steepest)))
    angles = np.arange(samples) * math.pi / samples
    block = max(1, _BLOCK // (samples * count * 3))
    for first in range(0, len(places), block):
        rows = slice(first, min(first + block, len(places)))
        part = flat[places[rows], None] if line.shape else flat
        yield rows, _turn(part, spread[rows, None, :], angles)


def _samples(k: float) -> int:
    if k <= 0.0:
        return _FEWEST
    wanted = _DIGITS / max(-math.log(k), _DIGITS / _MOST)
    return max(_FEWEST, math.ceil(wanted))


def _turn(line: Any, inertias: FloatArray, angles: FloatArray) -> _Turn:  # noqa: ANN401
    step = math.pi / len(angles)
    inertia, slope, curvature = _reduced(line, inertias, angles)
    low, high = np.min(inertia, axis=-1), np.max(inertia, axis=-1)
    places = np.broadcast_to(angles, inertia.shape)
    for _ in range(_ROUNDS):
        # Newton's method for the zeros of the slope, from every sample at once; what lands on no
        # extreme is a sample more.
        with np.errstate(divide="ignore", invalid="ignore"):
            move = np.where(curvature != 0.0, -slope / curvature, 0.0)
        places = places + np.clip(move, -step, step)
        tried, slope, curvature = _reduced(line, inertias, places)
        low = np.minimum(low, np.min(tried, axis=-1))
        high = np.maximum(high, np.max(tried, axis=-1))
    return _Turn(inertia, low, high)


def _reduced(
    line: Any,  # noqa: ANN401 - a driveline
    inertias: FloatArray,
    angles: FloatArray,
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """The inertia ``J`` that the drive feels, and its first two derivatives by the drive angle."""
    names = ("speed_ratio", "acceleration_ratio", "jerk_ratio")
    motion = line.evaluate(angles, names, shafts=slice(None))
    ratio, first, second = (np.moveaxis(motion[name], 0, -1) for name in names)
    inertia = np.sum(inertias * ratio**2, axis=-1)
    slope = 2.0 * np.sum(inertias * ratio * first, axis=-1)
    curvature = 2.0 * np.sum(inertias * (first**2 + ratio * second), axis=-1)
    return inertia, slope, curvature


def _variation(root: Any, low: FloatArray, high: FloatArray) -> FloatArray:  # noqa: ANN401
    """``root/sqrt(low) - root/sqrt(high)`` without the difference of two quotients near 1."""
    ends = np.sqrt(low), np.sqrt(high)
    return np.asarray(root * (high - low) / (ends[0] * ends[1] * (ends[0] + ends[1])))


def _least_inertia(others: FloatArray, low: float, high: float, wanted: float) -> float:
    """The least inertia of shaft 0 for a variation, by bisection: more inertia varies less."""

    def variation(own: float) -> float:
        root = np.mean(np.sqrt(own + others))
        return float(_variation(root, np.asarray(own + low), np.asarray(own + high)))

    if high == low or (low > 0.0 and variation(0.0) <= wanted):
        return 0.0
    # The variation is at most (high - low)/(2 (own + low)).
    short, enough = 0.0, 0.5 * (high - low) / wanted
    if math.isinf(enough):
        return enough
    for _ in range(_BISECTIONS):
        middle = (short + enough) / 2.0
        if variation(middle) <= wanted:
            enough = middle
        else:
            short = middle
    return enough

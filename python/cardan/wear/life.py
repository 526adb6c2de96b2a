"""The life of joints: by the catalogue's law, and by the exact load of the pins over the turn.

Page Wear of the theory (``docs/theory/wear.md``) has the law, and how the loads and lives of the
pins in both yokes combine. Lives are those which 90 % of the joints reach (``L10``).
"""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from cardan import _core
from cardan.arrays import FloatArray, as_float64, common_shape, per_joint, positive
from cardan.arrays.errors import ArgumentValueError, check_shape, exclusive, require
from cardan.evaluation.load import Load, require_load
from cardan.wear.pin_loads import PinLoads, means_over_turn, pins_at

if TYPE_CHECKING:
    from cardan.driveline import Driveline

SMALLEST_BEND = math.radians(3.0)
"""Bends below this one count as this one; its pins swing too little for their rollers to turn."""

_EXPONENT = 10.0 / 3.0
_RPM = 30.0 / math.pi


@dataclass(frozen=True, eq=False)
class Life:
    """How long the joints of a driveline last; see ``Driveline.life``.

    Attributes:
        hours: life that 90 % of the joints reach by the exact load of the pins, in h, ``(n, ...)``.
        catalogue: the same by the catalogue's law with the mean torque that enters the joint.
        small_swing: whether the pins swing by less than 3 degrees to either side in one of the
            steps, ``(n, ...)``. Needles that hardly turn mark their races (false brinelling),
            which no law of fatigue covers.
        steps: life in each step of the duty cycle alone, ``(n, ..., steps)``; without shares the
            same as ``hours``.
    """

    hours: FloatArray
    catalogue: FloatArray
    small_swing: Any
    steps: FloatArray = field(repr=False)

    @property
    def mean_hours(self) -> FloatArray:
        """Mean life in h: 5 times that which 90 % reach, as the catalogues state it."""
        return 5.0 * self.hours

    @property
    def decisive(self) -> Any:  # noqa: ANN401 - a number or an array
        """Index of the joint that fails first, in the shape of the batch and the load."""
        return np.argmin(self.hours, axis=0)


def life(
    line: Driveline,
    load: Load,
    *,
    rating: ArrayLike,
    speed: ArrayLike | None = None,
    shares: ArrayLike | None = None,
    angle: ArrayLike | None = None,
) -> Life:
    """Return how long the joints last, by the catalogue's law and by the load of their pins.

    Args:
        load: constant over a turn, unless ``angle`` is given; broadcasts against the batch. Of
            a duty cycle the last axis are the steps.
        rating: torque in N m that gives 5000 h at a bend of 3 degrees and 100 rpm: one number,
            or one per joint ``(..., n)``.
        speed: of the drive in rad/s; by default that of the load.
        shares: of each step of the duty cycle in the time, ``(..., steps)``, with sum 1. The
            damages add up (Miner's rule).
        angle: drive angles of a run in rad, ``(samples,)`` in their order, with a load that
            varies from sample to sample: a recorded torque, or that of torsional vibration.
            The means are sums over these samples, so there must be some hundred in a turn.

    Raises:
        ValueError: a rating, speed or share that is not positive, a load without a speed,
            shares that do not fit the steps or do not add up to 1, angles that do not fit the
            load or do not change, shapes that do not broadcast.

    >>> import cardan
    >>> bends = [[5.0], [8.0], [3.0]]
    >>> load = cardan.Load(output_torque=[400, 700, 250], speed_rpm=[1500, 1000, 2500])
    >>> line = cardan.Driveline.from_bends(bends, degrees=True)
    >>> found = line.life(load, rating=1000.0, shares=[0.5, 0.3, 0.2])
    >>> found.catalogue.round(2), found.hours.round(2)
    (array([1625.98]), array([1603.01]))
    """
    require_load(load)
    n = line.n_joints
    rated = per_joint("rating", positive("rating", rating), n)
    turning = np.abs(load.speed) if speed is None else positive("speed", speed)
    require("load", np.all(turning > 0.0), "has no speed; a life in hours needs one")
    exclusive(shares=shares, angle=angle)
    if angle is not None:
        return _of_run(line, load, rated, turning, as_float64("angle", angle))
    shapes = load.shapes()
    shapes["speed"] = np.broadcast_shapes(load.speed.shape, turning.shape)
    rows = common_shape(driveline=line.shape, rating=rated.shape[:-1], **shapes)
    means = means_over_turn(line, load, rows, "fatigue")
    means = means.reshape(n, 5, *means.shape[1:])
    bends = np.moveaxis(np.broadcast_to(line.bends, (*rows, n)), -1, 0)
    rated = np.moveaxis(np.broadcast_to(rated, (*rows, n)), -1, 0)
    exact, of_law = _hours(means, bends, turning * _RPM, rated)
    small = bends < SMALLEST_BEND
    if shares is None:
        return Life(exact, of_law, small, exact)
    part = _checked_shares(shares, rows)
    return Life(_miner(exact, part), _miner(of_law, part), np.any(small, axis=-1), exact)


def _hours(
    means: FloatArray, bends: FloatArray, rpm: FloatArray, rated: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Lives in hours by the load of the pins and by the law, each ``(n, ...)``.

    The means of each joint are those of ``means_over_turn`` for fatigue, ``(n, 5, ...)``.
    """
    shape = np.broadcast_shapes(means[:, 0].shape, bends.shape, rpm.shape, rated.shape)
    spread = np.broadcast_to(np.moveaxis(means, 1, -1), (*shape, 5))
    flat = (np.broadcast_to(array, shape).ravel() for array in (bends, rpm, rated))
    exact, of_law = _core.hours(spread.ravel(), *flat)
    return exact.reshape(shape), of_law.reshape(shape)


def _of_run(
    line: Driveline, load: Load, rated: FloatArray, speed: FloatArray, angle: FloatArray
) -> Life:
    """The life under a load that varies from sample to sample, by sums over the samples.

    The bend of the law is that whose pins swing as far in a turn: four times to either side.
    """
    rows = np.broadcast_shapes(line.shape, load.torque.shape, speed.shape, rated.shape[:-1])
    if angle.ndim != 1 or len(angle) < 2 or len(rows) > 1 or rated.ndim > 1:
        rule = "of a run it is (samples,), at least two, and driveline and load, here of shape "
        rule += f"{rows}, have a value for each sample or one for all"
        check_shape("angle", angle, False, rule)
    ways = np.abs(np.diff(angle))
    turned = float(np.sum(ways))
    require("angle", 0.0 < turned < np.inf, "does not change, or is not finite")

    def mean(values: FloatArray) -> FloatArray:
        """Over the angle, by trapezoids."""
        each = np.broadcast_to(values, (*values.shape[:-1], len(angle)))
        return np.asarray((0.5 * (each[..., 1:] + each[..., :-1])) @ ways / turned)

    means = np.stack(
        [mean(_integrands(pins_at(line, load, joint, angle))) for joint in range(line.n_joints)]
    )
    bends = 0.5 * np.pi * np.mean(means[:, 3:], axis=1)
    # The turns of an hour follow from the mean of the time for an angle.
    rpm = _RPM / mean(1.0 / np.atleast_1d(speed))
    exact, of_law = _hours(means, bends, rpm, rated)
    return Life(exact, of_law, bends < SMALLEST_BEND, exact)


def _integrands(pins: PinLoads) -> FloatArray:
    """The torque, and of either yoke what wears the pins and the way that they turn."""
    weight = pins.moment**_EXPONENT
    ways = np.abs(pins.rate_driving), np.abs(pins.rate_driven)
    torque = np.broadcast_to(np.abs(pins.entering_torque), weight.shape)
    return np.stack([torque, *(weight * way for way in ways), *ways])


def _miner(hours: FloatArray, shares: FloatArray) -> FloatArray:
    """The life in a duty cycle: each step uses its share of the time over its life (Miner)."""
    with np.errstate(divide="ignore"):
        return 1.0 / np.asarray(np.sum(shares / hours, axis=-1))


def _checked_shares(shares: ArrayLike, rows: tuple[int, ...]) -> FloatArray:
    array = positive("shares", shares)
    right = array.ndim > 0 and array.shape[-1:] == rows[-1:]
    rule = "it needs one share for each step of a duty cycle; load and batch of shape "
    check_shape("shares", array, right, f"{rule}{rows} have these on their last axis")
    whole = np.sum(array, axis=-1)
    if not np.allclose(whole, 1.0, rtol=0.0, atol=1e-6):
        raise ArgumentValueError("shares", f"add up to {np.ravel(whole)[0]:.6g}; the sum must be 1")
    return array

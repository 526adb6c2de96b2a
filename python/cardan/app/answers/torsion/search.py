"""The search for periodic motions over the speeds of a scene, and the torques of couplings."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from cardan.app.scene.sections.torsion import TorsionCase
from cardan.arrays import FloatArray
from cardan.torsion import SpeedResponse, SteadyState, UnstableRange
from cardan.torsion.analyses import has_kinks

# The frequency in Hz at which couplings are rated for torques that vary.
_RATED_AT = 10.0

# Speeds at which couplings with kinks are looked at, besides critical ones: their motions take long
# to find.
_FEW = 40


@dataclass(frozen=True, eq=False)
class Search:
    """What a search over the speeds of a scene found."""

    response: SpeedResponse
    unstable: tuple[UnstableRange, ...]


def search_over(given: TorsionCase) -> Search:
    """Search for the periodic motions over the speeds of a scene."""
    system, speed, few = given.system, given.speed, has_kinks(given.system)
    if few:
        critical = system.critical_speeds(given.excited).ravel()
        inside = critical[(critical >= speed[0]) & (critical <= speed[-1])]
        speed = np.union1d(np.linspace(speed[0], speed[-1], min(_FEW, len(speed))), inside)
    response = system.speed_response(speed, given.orders, refined=not few)
    return Search(response, system.unstable_ranges(response.speed, refined=not few))


def torques_of(
    place: int,
) -> tuple[Callable[[FloatArray, SteadyState], FloatArray], ...]:
    """Mean, vibratory and largest torque of a shaft at speeds with the motion there."""

    def mean(_: FloatArray, steady: SteadyState) -> FloatArray:
        return np.asarray(np.abs(steady.torque_mean[place]))

    def vibratory(speed: FloatArray, steady: SteadyState) -> FloatArray:
        orders = steady.orders[np.argmax(np.abs(steady.torque_orders[place]), axis=-1)]
        factor = np.sqrt(np.maximum(orders * speed / (math.tau * _RATED_AT), 1.0))
        return np.asarray(0.5 * (steady.torque_max - steady.torque_min)[place] * factor)

    def largest(_: FloatArray, steady: SteadyState) -> FloatArray:
        return np.asarray(np.fmax(np.abs(steady.torque_min), np.abs(steady.torque_max))[place])

    return mean, vibratory, largest

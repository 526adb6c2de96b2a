"""The search for periodic motions over the speeds of a scene, and the torques of couplings."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from cardan.app.answers.rows import figure, item
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
    """Result of a search over the speeds of a scene."""

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


# The least share of its stiffness that is proposed: below it, it is another kind of coupling.
_LEAST = 0.3

# How often another stiffness is tried, each a little softer.
_TRIALS, _SOFTER = 4, 0.93


@dataclass(frozen=True)
class SofterCoupling:
    """A stiffness that moves the resonance of a coupling below the speeds of the scene."""

    shaft: int = item("shaft")
    stiffness: float = figure(
        "stiffness at most",
        "Nm_per_rad",
        "so that no speed of the range is to be avoided",
        rounds="down",
    )
    present: float = figure("stiffness now", "Nm_per_rad", "at the mean torque of the load")


def softer(given: TorsionCase, search: Search) -> Iterator[SofterCoupling]:
    """Yield couplings that help, each tried over the speeds.

    By Rayleigh's quotient the squared frequency goes as the stiffness to the power of the
    coupling's share in the energy of twist.
    """
    system, speed = given.system, search.response.speed
    for shaft, rated in given.ratings.items():
        own, place = system.couplings[shaft], system.compliant.index(shaft)
        vibratory = torques_of(place)[1]
        if rated.vibratory is None or own.twist is not None:
            continue
        over = speed[vibratory(speed, search.response.steady) > rated.vibratory]
        if not over.size:
            continue
        share = max(mode.shares[place] for mode in system.modes())
        factor = float((given.speed[0] / over[-1]) ** (2.0 / share))
        for _ in range(_TRIALS):
            if factor < _LEAST:
                break
            changed = system.changed(couplings={**system.couplings, shaft: own.scaled(factor)})
            response = changed.speed_response(given.speed, given.orders)
            if np.all(vibratory(response.speed, response.steady) <= rated.vibratory):
                present = own.stiffness_at(float(system.load_torque))
                yield SofterCoupling(shaft, factor * present, present)
                break
            factor *= _SOFTER

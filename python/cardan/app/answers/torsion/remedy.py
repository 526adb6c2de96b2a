"""A softer coupling, with which no speed is to be avoided for its vibratory torque."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from cardan.app.answers.rows import figure, item
from cardan.app.answers.torsion.search import Search, torques_of
from cardan.app.scene.sections.torsion import TorsionCase

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

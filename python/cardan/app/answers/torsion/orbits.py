"""Periodic motions of a scene that exist side by side at one drive speed."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np

from cardan.torsion import TorsionalSystem

# A search takes some hundred times as long as one steady state: speeds that lie closer to each
# other than this share are searched once, with a coarser tolerance.
_CLOSE, _TOLERANCE = 2e-3, 1e-6

_MOST = 8  # motions whose torques are compared


@dataclass(frozen=True)
class SideBySide:
    """The periodic motions that a search found at one drive speed.

    Attributes:
        speed: of the drive in rad/s.
        count: how many motions were found.
        stable: how many of them are stable.
        shaft: the compliant shaft with the largest torque.
        smallest: the largest magnitude of its torque in N m in the motion in which that is least;
            NaN without a motion.
        largest: the same in the motion in which it is largest.
    """

    speed: float
    count: int
    stable: int
    shaft: int
    smallest: float
    largest: float


def side_by_side(system: TorsionalSystem, speeds: Iterable[float]) -> Iterator[SideBySide]:
    """Search for the periodic motions at some drive speeds.

    The search has no proof that it finds all.

    Args:
        system: one system.
        speeds: in rad/s, in any order.
    """
    searched: list[float] = []
    for speed in sorted(speeds):
        if not searched or speed > searched[-1] * (1.0 + _CLOSE):
            searched.append(speed)
    found = system.coexisting(np.array(searched), _MOST, tolerance=_TOLERANCE)
    sizes = np.fmax(np.abs(found.torque_min), np.abs(found.torque_max))
    for place, speed in enumerate(searched):
        shafts = np.nan_to_num(sizes[:, place]).max(axis=-1)
        chosen = int(shafts.argmax())
        known = sizes[chosen, place][: int(found.count[place])]
        yield SideBySide(
            speed,
            int(found.count[place]),
            int(np.count_nonzero(found.stable[place])),
            system.compliant[chosen],
            float(known.min()) if known.size else math.nan,
            float(known.max()) if known.size else math.nan,
        )

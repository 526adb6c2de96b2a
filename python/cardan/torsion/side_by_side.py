"""Periodic motions that exist side by side at one drive speed."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from cardan.arrays import as_float64
from cardan.torsion.modes import check_single

if TYPE_CHECKING:
    from cardan.torsion.system import TorsionalSystem

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


def side_by_side(self: TorsionalSystem, speed: ArrayLike) -> tuple[SideBySide, ...]:
    """Search for the periodic motions of one system that exist beside each other.

    ``coexisting`` has all their figures; this says how far their torques differ. The search has no
    proof that it finds all. Speeds closer to each other than 0.2 % are searched once.

    Args:
        speed: drive speeds in rad/s, ``(m,)``, in any order.

    Returns:
        one entry for each speed that was searched, rising.

    Raises:
        TypeError: speeds that are not real numbers.
        ValueError: a batch of systems.

    >>> import cardan
    >>> system = cardan.TorsionalSystem(
    ...     cardan.Driveline.from_bends([20], degrees=True),
    ...     inertias=[[0, 0], [0, 0.05]],
    ...     stiffnesses=[float("inf"), 8000],
    ...     damping_ratios=0.1,
    ... )
    >>> (found,) = system.side_by_side([150.0])
    >>> found.count, found.stable
    (1, 1)
    """
    check_single(self)
    searched: list[float] = []
    for each in np.sort(as_float64("speed", speed)).tolist():
        if not searched or each > searched[-1] * (1.0 + _CLOSE):
            searched.append(each)
    found = self.coexisting(np.array(searched), _MOST, tolerance=_TOLERANCE)
    sizes = np.fmax(np.abs(found.torque_min), np.abs(found.torque_max))
    motions = []
    for place, each in enumerate(searched):
        shafts = np.nan_to_num(sizes[:, place]).max(axis=-1)
        chosen = int(shafts.argmax())
        known = sizes[chosen, place][: int(found.count[place])]
        motions.append(
            SideBySide(
                each,
                int(found.count[place]),
                int(np.count_nonzero(found.stable[place])),
                self.compliant[chosen],
                float(known.min()) if known.size else math.nan,
                float(known.max()) if known.size else math.nan,
            )
        )
    return tuple(motions)

"""Drivelines that deviate from their drawing, in blocks, for outputs over a turn."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from cardan.arrays import FloatArray
from cardan.tolerances.box import JOINT_GROUPS
from cardan.tolerances.chain import Deviations, Nominal

if TYPE_CHECKING:
    from cardan.driveline import Driveline

# Drivelines at a time: each has its geometry with directions and normals.
_BLOCK = 2048


def in_blocks(
    of: Callable[[Driveline], Any],
    line: Driveline,
    nominal: Nominal,
    deviations: Deviations,
    samples: int,
    dtype: type = np.float64,
) -> NDArray[Any]:
    """Return one number for each sample, found of batches of deviating drivelines."""
    found: NDArray[Any] = np.empty(samples, dtype)
    for first in range(0, samples, _BLOCK):
        some = slice(first, min(first + _BLOCK, samples))
        part = {place: values[some] for place, values in deviations.items()}
        found[some] = of(_deviated(line, nominal, part, some.stop - first))
    return found


def as_drawn(line: Driveline, nominal: Nominal, *, joints: bool) -> Driveline:
    """Return a batch of one driveline as drawn; from points if they have tolerances.

    With ``joints`` it has deviations, which may be 0.
    """
    made = _deviated(line, nominal, {}, 1)
    return line._of(made._geometry.as_built()) if joints else made


def _deviated(line: Driveline, nominal: Nominal, deviations: Deviations, samples: int) -> Driveline:
    """The drivelines of the samples, with the bearings of the one as drawn."""

    def deviated(group: str, array: FloatArray) -> FloatArray:
        values = np.repeat(array[np.newaxis], samples, axis=0)
        for (name, place), deviation in deviations.items():
            if name == group:
                np.moveaxis(values, 0, -1)[place] += deviation
        return values

    own, phases = line._geometry, deviated("phases", nominal.phases)
    if nominal.points is not None:
        made = line.from_points(deviated("points", nominal.points), phases)._geometry
        lengths = made.lengths
    else:
        bends, twists = deviated("bends", nominal.bends), deviated("twists", nominal.twists)
        # Beyond straight a joint bends to the other side: its plane has turned by half a turn.
        flipped = bends < 0.0
        twists += np.pi * (flipped[:, 1:].astype(float) - flipped[:, :-1])
        made = line.from_bends(np.abs(bends), twists, phases)._geometry
        lengths = np.repeat(own.lengths[np.newaxis], samples, axis=0)
    positions = np.repeat(own.positions[np.newaxis], samples, axis=0)
    joints = [place for place in deviations if place[0] in JOINT_GROUPS]
    if joints or own.is_as_built:
        built = np.repeat(own.as_built().deviations[np.newaxis], samples, axis=0)
        for group, (joint,) in joints:
            built[:, joint, JOINT_GROUPS.index(group)] += deviations[group, (joint,)]
        made = made._replace(deviations=built)
    made = made._replace(lengths=lengths, positions=positions, bearings=own.bearings)
    return line._of(made)

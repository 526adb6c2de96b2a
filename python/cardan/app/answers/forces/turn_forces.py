"""Forces of joints and bearings over a turn: largest, mean and the orders that excite vibration."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal, TypeAlias

import numpy as np

from cardan.app.answers.turn.extremes import peak
from cardan.driveline import Driveline
from cardan.evaluation.load import Load
from cardan.evaluation.outputs import OUTPUTS

FORCES = ("joint_force", "bearing_force")
"""The outputs that are forces."""

ForceSource: TypeAlias = Literal["joint", "bearing"]
"""What a force is a force of."""


def force_source(output: str) -> ForceSource:
    """Return what an output is a force of."""
    return "joint" if OUTPUTS[output].per == "joint" else "bearing"


@dataclass(frozen=True)
class ForceFigures:
    """The force of one joint or bearing over a turn, in N if lengths are in metres.

    Attributes:
        output: name of the output.
        per: what it is a force of.
        item: number of the joint or bearing.
        largest: the largest length of the force.
        places: drive angles in rad within the period of the driveline, half a turn or with
            deviations a whole one, at which it occurs, each again a period later; none if the force
            has the same length at every angle.
        mean: length of the mean force.
        order_1: largest length of the part that changes once per turn; 0 of ideal joints.
        order_2: largest length of the part that changes twice per turn.
        order_4: likewise four times.
    """

    output: str
    per: ForceSource
    item: int
    largest: float
    places: tuple[float, ...]
    mean: float
    order_1: float
    order_2: float
    order_4: float


def force_figures(
    line: Driveline, load: Load, outputs: Iterable[str] = FORCES
) -> list[ForceFigures]:
    """Return the figures of every joint and bearing of one driveline at a constant load.

    Args:
        line: one driveline.
        load: a constant load.
        outputs: which forces.

    Raises:
        ValueError: a force that is not determinate; lengths that are missing.
    """
    names = tuple(outputs)
    orders = line.harmonics((1, 2, 4), outputs=names, load=load)
    found = []
    for name in names:
        per = force_source(name)
        sums = zip(orders.mean[name], orders.complex_amplitude[name], strict=True)
        for item, (mean, amplitudes) in enumerate(sums):
            largest = peak(line, name, item, load)
            size = float(np.linalg.norm(mean))
            parts = (_length(amplitudes[:, i]) for i in range(3))
            found.append(ForceFigures(name, per, item, largest.value, largest.places, size, *parts))
    return found


def shortest_arm(line: Driveline) -> float:
    """Return the shortest distance between two joints, bearings or ends of a shaft, in m."""
    lengths = line.lengths().each
    shortest = float(np.min(lengths))
    for shaft in range(line.n_joints + 1):
        own = [position for number, position in line.bearings if number == shaft]
        marks = [np.zeros(lengths.shape[:-1]), *own, lengths[..., shaft]]
        apart = np.diff(np.sort(np.stack(marks, axis=-1), axis=-1), axis=-1)
        shortest = float(np.min(apart, where=apart > 0.0, initial=shortest))
    return shortest


def _length(amplitude: np.ndarray) -> float:
    """The largest length of ``Re(amplitude exp(i t))``: the longer half axis of an ellipse."""
    square = np.sum(np.abs(amplitude) ** 2) + np.abs(np.sum(amplitude**2))
    return math.sqrt(float(square) / 2.0)

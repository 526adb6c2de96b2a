"""Moments and forces of joints and bearings under the torques of a periodic motion.

At each instant the joints are in the position of a rigid driveline whose phases contain the twists
of the compliant shafts. The balance of torques along the shafts, from the load to the drive, gives
the torque that enters each shaft: the dynamic torque. What a shaft takes of it, its inertias
accelerate and its spring stores. The rigid driveline is evaluated under these torques, so moments
and forces are those of the same equations as without vibration.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, SupportsIndex

import numpy as np

from cardan.arrays import FloatArray
from cardan.arrays.errors import ArgumentValueError
from cardan.evaluation.load import absorbing
from cardan.evaluation.outputs import OUTPUTS, checked
from cardan.evaluation.request import Reduction
from cardan.evaluation.result import Result
from cardan.torsion.parameters import TorsionParameters
from cardan.torsion.results import Orbit

if TYPE_CHECKING:
    from cardan.torsion.system import TorsionalSystem

# The position of the crosses is that of rigid shafts with these twists; their rates are not.
_POSITIONS = ("tilt_driving", "tilt_driven", "driving_pin", "driven_pin")


def evaluated(
    system: TorsionalSystem,
    orbit: Orbit,
    outputs: str | Iterable[str],
    reduce: Reduction | None,
    workers: SupportsIndex | None,
    **items_and_axes: Any,  # noqa: ANN401 - as of Driveline.evaluate
) -> Result:
    """Return outputs at the samples of an orbit.

    Raises:
        ValueError: an output of motion, and as of ``Driveline.evaluate``.
    """
    line: Any = system.line
    names = checked(outputs)
    for i, name in enumerate(names):
        if not (OUTPUTS[name].needs_load or name in _POSITIONS):
            problem = f"is {name!r}, a motion of rigid shafts; orbit() has that of compliant shafts"
            raise ArgumentValueError("outputs", problem, (i,))
    n = line.n_joints
    found = orbit.found[..., np.newaxis]
    error = np.where(found, orbit.angle_error, 0.0)
    twists = np.moveaxis(error[1:n, 1] - error[1:n, 0], 0, -1)
    batch = line.reshape(*line.shape, 1) if line.shape else line
    rigid = batch.with_phases(batch.phases + twists)
    angle = orbit.drive_angle + error[0, 1]
    every = list(range(n + 1))
    motion = rigid.evaluate(angle, "speed_ratio", shafts=every, workers=workers)
    ratios = np.moveaxis(motion.speed_ratio, 0, -1)
    entering, absorbed = _torques(system._parameters, orbit, ratios)
    result = rigid.evaluate(
        np.where(found, angle, np.nan),
        names,
        load=absorbing(entering, absorbed, ratios),
        reduce=reduce,
        workers=workers,
        **items_and_axes,
    )
    own: Any = result._labels
    of_shafts, of_joints, *_, unit = own
    labels = (of_shafts, of_joints, found.shape if orbit.found.ndim else (), reduce, unit)
    return Result(dict(result), labels, orbit.drive_angle)


def _torques(
    parameters: TorsionParameters, orbit: Orbit, ratios: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return the torque that enters shaft 0, and what each shaft absorbs, ``(..., n + 1)``."""
    last = ratios.shape[-1] - 1
    # Dimensions of batch and samples, to which the parameters broadcast.
    inertias = parameters.inertias[..., np.newaxis, :, :]
    inertial = np.moveaxis(orbit.acceleration, (0, 1), (-2, -1)) * inertias
    of_springs = dict(zip(orbit.compliant, orbit.torque, strict=True))
    loss = parameters.load_damping[..., np.newaxis] * orbit.speed[last, 1]
    entering = leaving = parameters.load_torque[..., np.newaxis] + loss
    absorbed = np.empty(inertial.shape[:-1])
    for shaft in range(last, -1, -1):
        if shaft in of_springs:
            entering = of_springs[shaft] + inertial[..., shaft, 0]
        else:
            entering = leaving + inertial[..., shaft, :].sum(axis=-1)
        absorbed[..., shaft] = entering - leaving
        if shaft:
            leaving = entering * ratios[..., shaft] / ratios[..., shaft - 1]
    return entering, absorbed

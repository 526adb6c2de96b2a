"""Backlash and wind-up: how far a shaft is loose, and how far torque twists the crosses."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from cardan import _core
from cardan.arrays import per_joint, positive, scalar_or_array
from cardan.arrays.indices import item_index
from cardan.evaluation.load import Load
from cardan.evaluation.sweep import Sweep

if TYPE_CHECKING:
    from cardan.driveline import Driveline


def lash(
    line: Driveline, angle: ArrayLike | Sweep, radial: ArrayLike, arm: ArrayLike, shaft: int = -1
) -> Any:  # noqa: ANN401 - a scalar or an array
    """Return the angle in rad by which a shaft is loose while the drive is held.

    For one ideal joint it is ``2 asin(sin(d)/sqrt(sin**2 a + cos**2 b cos**2 a))`` with twice
    the angle ``radial / arm`` of the play for ``d`` (derived here): largest, ``1/cos b``
    times the least, where the driving pin is in the bend plane.

    Args:
        angle: drive angle in rad, any shape, or a ``Sweep``; broadcasts against the batch.
        radial: as for ``with_play``, like the following argument.
        arm: distance of the middle of a pin's bearing from the centre of the joint.
        shaft: index of the shaft, by default the last.

    Raises:
        ValueError: as for ``with_play``.
    """
    loose = line.with_play(radial, arm)
    index = item_index("shaft", shaft, line.n_joints + 1)
    samples = angle.shape if isinstance(angle, Sweep) else np.shape(angle)
    more = max(0, len(samples) - len(loose.shape) + 1)
    lines = loose.reshape(2, *(1,) * more, *loose.shape[1:])
    driven, coasting = lines.evaluate(angle, "angle_error", shafts=index).angle_error
    leads = _core.mean_leads(lines._lines, index).reshape(lines.shape)
    return scalar_or_array(coasting - driven + (leads[1] - leads[0]))


def wind_up(line: Driveline, angle: ArrayLike | Sweep, load: Load, stiffness: ArrayLike) -> Any:  # noqa: ANN401 - a scalar or an array
    """Return the angle in rad by which the last shaft lags because torque twists the crosses.

    A cross is a spring against the moment that it transmits. Under a torque ``D`` in its
    driving shaft a joint of stiffness ``c`` winds its driven shaft up by ``D/(c cos b)``, the
    same at every angle (derived here), to first order. Later joints pass it on with their ratios.

    Args:
        angle: drive angle in rad, any shape, or a ``Sweep``; broadcasts against the batch.
        load: as for ``evaluate``.
        stiffness: moment about the normal of the cross per angle between its pins, in N m/rad:
            one number, or one per joint ``(..., n)``.

    Raises:
        ValueError: a stiffness that is not positive, shapes that do not fit.

    >>> import cardan
    >>> joint = cardan.Driveline.from_bends([20.0], degrees=True)
    >>> joint.wind_up([0.0, 1.0], cardan.Load(drive_torque=500.0), 1e5).round(6)
    array([0.005321, 0.005321])
    """
    n = line.n_joints
    springs = per_joint("stiffness", positive("stiffness", stiffness), n)
    at = line.evaluate(angle, ("torque", "speed_ratio"), load=load, shafts=slice(None))
    lag: Any = 0.0
    cosines = np.cos(line.bends)
    for joint in range(n):
        # The torsion of the driving shaft at the joint, from the power behind it.
        torsion = at.torque[joint + 1] * at.speed_ratio[joint + 1] / at.speed_ratio[joint]
        own = torsion / (springs[..., joint] * cosines[..., joint])
        lag = lag + own * at.speed_ratio[n] / at.speed_ratio[joint + 1]
    return scalar_or_array(np.asarray(lag))

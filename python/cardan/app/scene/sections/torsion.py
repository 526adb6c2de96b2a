"""The shafts of a scene as torsion springs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from cardan.app.scene.language.units import RPM
from cardan.app.scene.sections.torsion_rules import TUBE
from cardan.app.scene.sections.tubes import Tubes
from cardan.arrays import FloatArray
from cardan.arrays.errors import ArgumentValueError
from cardan.driveline import Driveline
from cardan.evaluation.load import Load
from cardan.torsion import TorsionalSystem

ORDERS = (2, 4)
"""The orders of the drive's rotation that are listed by default."""

_KEYS = {
    "inertias": "inertias_kgm2",
    "stiffnesses": "stiffnesses_Nm_per_rad",
    "dampings": "dampings_Nms_per_rad",
    "damping_ratios": "damping_ratio",
    "load_torque": "load_torque_Nm",
    "load_damping": "load_damping_Nms_per_rad",
}


@dataclass(frozen=True, eq=False)
class TorsionCase:
    """The torsional system of a scene.

    Attributes:
        system: the system.
        speed: drive speeds in rad/s at which it runs, rising, ``(speeds,)``.
        orders: of the drive's rotation, rising.
        margin: least distance of a critical speed from the speeds, in shares of it, if the scene
            gives one.
    """

    system: TorsionalSystem
    speed: FloatArray
    orders: tuple[int, ...]
    margin: float | None


def torsion_of(
    values: Mapping[str, Any], line: Driveline, load: Load | None, tubes: Tubes | None
) -> TorsionCase:
    """Return the torsional system that the keys of the section describe.

    Args:
        values: values by key.
        line: the driveline of the scene.
        load: of the scene, if it has one.
        tubes: of the scene, if it has any.

    Raises:
        ValueError: recorded bends, no stiffnesses and no tubes, lists that do not fit the shafts,
            as ``TorsionalSystem`` with the key as the argument.
    """
    if line.shape:
        raise ValueError("it does not go with recorded bends, which differ by sample")
    shafts = line.n_joints + 1
    for key in ("inertias_kgm2", "stiffnesses_Nm_per_rad", "dampings_Nms_per_rad", "damping_ratio"):
        given = values.get(key)
        if isinstance(given, list) and len(given) != shafts:
            raise ArgumentValueError(
                key, f"has length {len(given)}; it needs {shafts}, one per shaft"
            )
    stiffnesses = _stiffnesses(values, shafts, tubes)
    inertias = np.array(values["inertias_kgm2"], dtype=np.float64)
    if tubes is not None:
        inertias[list(tubes.shafts)] += 0.5 * np.asarray(tubes.tube.inertia)[:, np.newaxis]
    torque = _load_torque(values, load)
    dampings = values.get("dampings_Nms_per_rad")
    ratios = values.get("damping_ratio", 0.0) if dampings is None else None
    try:
        with np.errstate(divide="ignore", invalid="ignore"):
            system = TorsionalSystem(
                line,
                inertias=inertias,
                stiffnesses=stiffnesses,
                load_torque=torque,
                load_damping=values.get("load_damping_Nms_per_rad", 0.0),
                dampings=dampings,
                damping_ratios=ratios,
            )
    except ArgumentValueError as error:
        raise ArgumentValueError(
            _KEYS.get(error.argument, error.argument), error.problem, error.place
        ) from None
    orders = tuple(sorted(values.get("orders", ORDERS)))
    if not np.all(system.natural_frequencies() > 0.0):
        raise ValueError(
            "stiffnesses and inertias differ by too many orders of magnitude; a shaft that is much "
            'stiffer than the others is "rigid"'
        )
    speed = RPM * values["speed_rpm"]
    return TorsionCase(system, speed, orders, values.get("resonance_margin"))


def _stiffnesses(values: Mapping[str, Any], shafts: int, tubes: Tubes | None) -> FloatArray:
    """Stiffness of each shaft in N m/rad, ``(shafts,)``, infinite for a rigid one."""
    key = "stiffnesses_Nm_per_rad"
    of_tubes = {}
    if tubes is not None:
        of_tubes = dict(zip(tubes.shafts, np.asarray(tubes.tube.stiffness).tolist(), strict=True))
    if key not in values and not of_tubes:
        raise ArgumentValueError(key, "is missing; give it or a section [tubes]")
    given = values.get(key, [TUBE if i in of_tubes else np.inf for i in range(shafts)])
    for i, stiffness in enumerate(given):
        if stiffness == TUBE and i not in of_tubes:
            raise ArgumentValueError(key, f"is {TUBE!r}; shaft {i} is not in [tubes]", (i,))
    return np.array([of_tubes[i] if own == TUBE else own for i, own in enumerate(given)])


def _load_torque(values: Mapping[str, Any], load: Load | None) -> float:
    if "load_torque_Nm" in values:
        return float(values["load_torque_Nm"])
    if load is None:
        return 0.0
    if np.ndim(load.torque):
        raise ArgumentValueError(
            "load_torque_Nm", "is missing; the recorded torque of [angles] varies"
        )
    # At constant drive speed the mean torques of drive and output are equal.
    return float(load.torque)

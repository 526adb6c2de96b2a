"""The section of a scene that makes its shafts torsion springs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

import cardan.scene.values as kinds
from cardan.arrays import FloatArray
from cardan.driveline import Driveline
from cardan.errors import ArgumentValueError
from cardan.load import Load
from cardan.scene.sections import Key, Section
from cardan.scene.units import RPM
from cardan.torsion import TorsionalSystem, Tube

ORDERS = (2, 4)
"""The orders of the drive's rotation that are listed by default."""

TORSION = Section(
    "torsional vibration: shafts as springs with inertias at their ends",
    {
        "inertias_kgm2": Key(
            kinds.END_INERTIAS,
            "of each shaft: a number, half of it at each end, or [input end, output end]; the "
            "inertia of a tube is added",
        ),
        "stiffnesses_Nm_per_rad": Key(
            kinds.STIFFNESSES,
            'of each shaft: a number, "rigid", or a tube {outer_diameter_mm = …, wall_mm = …, '
            "length_mm = …}, of steel unless shear_modulus_MPa and density_kg_per_m3 are given, "
            "solid without a wall",
        ),
        "damping_ratio": Key(
            kinds.DAMPING_RATIOS,
            "damping ratio of the lowest vibration: one number, or one per shaft; default 0",
        ),
        "dampings_Nms_per_rad": Key(kinds.DAMPINGS, "or: damping of each shaft"),
        "load_torque_Nm": Key(
            kinds.NUMBER, "torque that brakes the last shaft; default: the torque of [load]"
        ),
        "load_damping_Nms_per_rad": Key(
            kinds.POSITION, "viscous load on the last shaft", default=0
        ),
        "speed_rpm": Key(
            kinds.SPEEDS,
            "drive speeds at which the driveline runs: {from = …, to = …, steps = …} or a list",
        ),
        "orders": Key(
            kinds.ORDERS,
            "orders of the drive's rotation to list; joints excite even orders; default: 2 and 4",
        ),
    },
    together=(("damping_ratio", "dampings_Nms_per_rad"),),
    needed=(("inertias_kgm2",), ("stiffnesses_Nm_per_rad",), ("speed_rpm",)),
)
"""The section [torsion]."""

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
        inertias: of input end and output end of each shaft in kg m², ``(n + 1, 2)``.
        stiffnesses: of each shaft in N m/rad, ``(n + 1,)``.
        speed: drive speeds in rad/s at which it runs, rising, ``(speeds,)``.
        orders: of the drive's rotation, rising.
        load_torque: in N m.
        load_damping: in N m s/rad.
    """

    system: TorsionalSystem
    inertias: FloatArray
    stiffnesses: FloatArray
    speed: FloatArray
    orders: tuple[int, ...]
    load_torque: float
    load_damping: float

    def changed(
        self, line: Driveline | None = None, stiffnesses: ArrayLike | None = None
    ) -> TorsionalSystem:
        """Return the system with another driveline or other stiffnesses, or a batch of them.

        Dampings in N m s/rad, inertias and loads are those of the scene.
        """
        return TorsionalSystem(
            self.system.line if line is None else line,
            inertias=self.inertias,
            stiffnesses=self.stiffnesses if stiffnesses is None else stiffnesses,
            dampings=self.system.dampings,
            load_torque=self.load_torque,
            load_damping=self.load_damping,
        )


def torsion_of(values: Mapping[str, Any], line: Driveline, load: Load | None) -> TorsionCase:
    """Return the torsional system that the keys of the section describe.

    Args:
        values: values by key.
        line: the driveline of the scene.
        load: of the scene, if it has one.

    Raises:
        ValueError: recorded bends, lists that do not fit the shafts, as ``TorsionalSystem`` with
            the key as the argument.
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
    inertias = np.array(values["inertias_kgm2"], dtype=np.float64)
    stiffnesses = np.empty(shafts)
    for i, stiffness in enumerate(values["stiffnesses_Nm_per_rad"]):
        if isinstance(stiffness, Tube):
            inertias[i] += 0.5 * stiffness.inertia
            stiffness = stiffness.stiffness
        stiffnesses[i] = stiffness
    torque = _load_torque(values, load)
    load_damping = values.get("load_damping_Nms_per_rad", 0.0)
    dampings = values.get("dampings_Nms_per_rad")
    ratios = values.get("damping_ratio", 0.0) if dampings is None else None
    try:
        system = TorsionalSystem(
            line,
            inertias=inertias,
            stiffnesses=stiffnesses,
            load_torque=torque,
            load_damping=load_damping,
            dampings=dampings,
            damping_ratios=ratios,
        )
    except ArgumentValueError as error:
        raise ArgumentValueError(
            _KEYS.get(error.argument, error.argument), error.problem, error.place
        ) from None
    orders = tuple(sorted(values.get("orders", ORDERS)))
    speed = RPM * values["speed_rpm"]
    return TorsionCase(system, inertias, stiffnesses, speed, orders, torque, load_damping)


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

"""The section [torsion]: the shafts as torsion springs."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from cardan.app.scene.language.errors import Location
from cardan.app.scene.language.rules import (
    POSITIVE,
    SPREAD,
    START,
    ListOf,
    Number,
    OneOf,
    OneOrMore,
    Rule,
    Schema,
    Table,
    Whole,
    each,
    refused,
    shown,
)
from cardan.app.scene.language.section import Key, Reading, Section
from cardan.app.scene.language.units import RPM
from cardan.app.scene.sections.tubes import TUBES
from cardan.arrays import FloatArray
from cardan.arrays.errors import ArgumentValueError
from cardan.evaluation.load import Load
from cardan.torsion import TorsionalSystem

ORDERS = (2, 4)
"""The orders of the drive's rotation that are listed by default."""

_RIGID, _TUBE = "rigid", "tube"
_STIFFNESSES = "stiffnesses_Nm_per_rad"

# No shaft of a machine is beyond these ends, and within them the equations can be solved.
_INERTIA = Number(0, 1e6, what="an inertia")
_STIFFNESS = Number(1e-3, 1e12, what="a stiffness")
_DAMPING = Number(0, 1e9, what="a damping")
_SPEED = Number(1e-3, 1e6, what="a speed")

_SPREAD = Table(
    {"from": _SPEED, "to": _SPEED, "steps": Whole(2, most=100_000)}, f"{SPREAD} or a list of speeds"
)


@dataclass(frozen=True)
class ShaftStiffness(Rule):
    """The stiffness of a shaft: a number, ``"rigid"`` or ``"tube"``."""

    number: Number = _STIFFNESS
    name = "stiffness"

    def read(self, where: Location, value: object) -> float | Literal["tube"]:
        """Return the stiffness, infinite for a rigid shaft, or ``"tube"``."""
        if value == _RIGID:
            return math.inf
        if value == _TUBE:
            return "tube"
        if isinstance(value, str) or value == math.inf:
            raise refused(where, value, f'be a positive number, "{_RIGID}" or "{_TUBE}"')
        return self.number.read(where, value)

    @property
    def schema(self) -> Schema:
        """A number or one of the words."""
        return {"oneOf": [self.number.schema, {"enum": [_RIGID, _TUBE]}]}


@dataclass(frozen=True)
class SpeedValues(Rule):
    """The drive speeds at which a driveline runs: evenly spread or listed."""

    name = "speeds"

    def read(self, where: Location, value: object) -> FloatArray:
        """Return the speeds, rising, ``(speeds,)``."""
        if isinstance(value, list):
            speeds: list[float] = ListOf(_SPEED, "speeds", distinct=True).read(where, value)
            if len(speeds) < 2:
                raise where.error(f"is {shown(value)}; name at least two speeds")
            return np.array(sorted(speeds))
        spread = _SPREAD.read(where, value)
        start, stop = spread["from"], spread["to"]
        if start >= stop:
            raise where.at("to").error(f"is {stop:g}; it must be above 'from', {start:g}")
        return np.asarray(np.linspace(start, stop, spread["steps"]), dtype=np.float64)

    @property
    def schema(self) -> Schema:
        """An array of speeds or an object."""
        listed = {"type": "array", "items": _SPEED.schema, "minItems": 2, "uniqueItems": True}
        return {"oneOf": [listed, _SPREAD.schema]}


@dataclass(frozen=True, eq=False)
class TorsionCase:
    """The torsional system, drive speeds in rad/s and orders, both rising, and the least margin.

    The margin of a critical speed is its distance from the speeds in shares of it. The drive is
    held at constant speed; whether the scene says so itself is ``drive``.
    """

    system: TorsionalSystem
    speed: FloatArray
    orders: tuple[int, ...]
    margin: float | None
    drive: Literal["held", ""] = ""

    @property
    def without_effect(self) -> float:
        """The inertia in kg m² that turns with the drive at constant speed."""
        ends = self.system.inertias[..., 0, :]
        return float(np.sum(ends) if 0 not in self.system.compliant else ends[..., 0])


def _torsion(values: Mapping[str, Any], scene: Reading) -> TorsionCase:
    line, tubes = scene.line, scene[TUBES]
    TORSION.check_counts(values, line.n_joints)
    of_tubes = {}
    # A number is the inertia of a whole shaft, a pair that of its ends.
    inertias = np.array(
        [end if isinstance(end, list) else [0.5 * end] * 2 for end in values["inertias_kgm2"]]
    )
    if tubes is not None:
        of_tubes = dict(zip(tubes.shafts, np.asarray(tubes.tube.stiffness).tolist(), strict=True))
        inertias[list(tubes.shafts)] += 0.5 * np.asarray(tubes.tube.inertia)[:, np.newaxis]
    arguments = TORSION.arguments(values) | {
        "inertias": inertias,
        "stiffnesses": _stiffnesses(values, line.n_joints + 1, of_tubes),
        "load_torque": _load_torque(values, scene.load),
    }
    if "dampings" not in arguments:
        arguments.setdefault("damping_ratios", 0.0)
    with TORSION.named(TORSION.keys), np.errstate(divide="ignore", invalid="ignore"):
        system = TorsionalSystem(line, **arguments)
    if not np.all(system.natural_frequencies() > 0.0):
        raise ValueError(
            "stiffnesses and inertias differ by too many orders of magnitude; a shaft that is much "
            'stiffer than the others is "rigid"'
        )
    orders = tuple(sorted(values.get("orders", ORDERS)))
    speed, margin = RPM * values["speed_rpm"], values.get("resonance_margin")
    return TorsionCase(system, speed, orders, margin, values.get("drive", ""))


def _stiffnesses(
    values: Mapping[str, Any], shafts: int, of_tubes: Mapping[int, float]
) -> FloatArray:
    """Stiffness of each shaft in N m/rad, ``(shafts,)``, infinite for a rigid one."""
    if _STIFFNESSES not in values and not of_tubes:
        raise ArgumentValueError(_STIFFNESSES, "is missing; give it or a section [tubes]")
    given = values.get(_STIFFNESSES, [_TUBE if i in of_tubes else np.inf for i in range(shafts)])
    for i, stiffness in enumerate(given):
        if stiffness == _TUBE and i not in of_tubes:
            raise ArgumentValueError(
                _STIFFNESSES, f"is {_TUBE!r}; shaft {i} is not in [tubes]", (i,)
            )
    return np.array([of_tubes[i] if own == _TUBE else own for i, own in enumerate(given)])


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


TORSION: Section[TorsionCase | None] = Section(
    "torsion",
    "torsional vibration: shafts as springs with inertias at their ends",
    {
        "inertias_kgm2": Key(
            ListOf(each(_INERTIA, "two numbers", count=2), "inertias"),
            "of each shaft: a number, half of it at each end, or [input end, output end]; the "
            "inertia of a shaft in [tubes] is added",
            "inertias",
            per="shaft",
            kind="inertias",
        ),
        _STIFFNESSES: Key(
            ListOf(ShaftStiffness(), "stiffnesses"),
            'of each shaft: a number, "rigid", or "tube" for the stiffness by [tubes]; default: '
            "the shafts of [tubes] are springs, all others rigid",
            "stiffnesses",
            per="shaft",
            kind="stiffnesses",
        ),
        "damping_ratio": Key(
            each(Number(0, 100, what="a ratio")),
            "damping ratio of the lowest vibration: one number, or one per shaft; default 0",
            "damping_ratios",
            per="shaft",
        ),
        "dampings_Nms_per_rad": Key(
            ListOf(_DAMPING, "numbers"), "or: damping of each shaft", "dampings", per="shaft"
        ),
        "load_torque_Nm": Key(
            START, "torque that brakes the last shaft; default: the torque of [load]", "load_torque"
        ),
        "load_damping_Nms_per_rad": Key(
            _DAMPING, "viscous load on the last shaft", "load_damping", default=0
        ),
        "drive": Key(
            OneOf(("held",)),
            "what the input end of shaft 0 does: it is held at constant speed, and an inertia "
            "there has no effect; the key says that this is meant",
        ),
        "speed_rpm": Key(
            SpeedValues(),
            "drive speeds at which the driveline runs: {from = …, to = …, steps = …} or a list",
        ),
        "orders": Key(
            OneOrMore(ListOf(Whole(1, most=256), "orders", distinct=True), int),
            "orders of the drive's rotation to list; joints excite even orders; default: 2 and 4",
            kind="whole number(s)",
        ),
        "resonance_margin": Key(
            POSITIVE,
            "least distance of the critical speeds of even orders from speed_rpm, in shares of the "
            "critical speed, such as 0.15",
        ),
    },
    _torsion,
    together=(("damping_ratio", "dampings_Nms_per_rad"),),
    needed=(("inertias_kgm2",), ("speed_rpm",)),
    recorded_bends=False,
)

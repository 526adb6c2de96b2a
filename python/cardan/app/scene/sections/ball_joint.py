"""The section [ball_joint]: a ball in its seat, its load and its materials."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from cardan.app.files import columns
from cardan.app.scene.language import errors, rules, units
from cardan.app.scene.language.section import Key, Section
from cardan.arrays.errors import ArgumentValueError
from cardan.ball_joint import BallJoint, layer_compliance

_MM, _MPA = 1e-3, 1e6

_COMPLIANCE, _LAYER, _POISSON = "compliance_um_per_MPa", ("layer_mm", "modulus_MPa"), "poisson"


@dataclass(frozen=True)
class MaterialRule(rules.Table):
    """A material: a name, the allowable pressure, and the compliance or the layer that yields."""

    name = "material"

    def read(self, where: errors.Location, value: object) -> dict[str, Any]:
        found = super().read(where, value)
        given: dict[str, str] = {}
        for key in found:
            if (other := given.setdefault(units.si_key(key), key)) != key:
                raise where.at(key).error(f"and {other} are both given; give one of them")
        layer = [given[key] for key in (*_LAYER, _POISSON) if key in given]
        if _COMPLIANCE in given and layer:
            other = given[_COMPLIANCE]
            raise where.at(layer[0]).error(f"and {other} are both given; give one of them")
        for key in _LAYER:
            if layer and key not in given:
                raise where.at(layer[0]).error(f"needs {key}; {' and '.join(_LAYER)} go together")
        return {units.si_key(key): entry for key, entry in found.items()}

    @property
    def schema(self) -> rules.Schema:
        return {
            **super().schema,
            "dependentSchemas": {
                key: {"allOf": [rules.given_as(needed) for needed in _LAYER]}
                for of in (*_LAYER, _POISSON)
                for key in (of, *units.us_keys(of))
            },
            "allOf": [rules.not_both(_COMPLIANCE, _LAYER[0]), *rules.in_one_unit(self.keys)],
        }


# No material and no lining is beyond these ends, and within them no square overflows.
_KEYS = {
    "name": rules.Text(printable=True),
    "allowable_pressure_MPa": rules.Number(1e-3, 1e6),
    _COMPLIANCE: rules.Number(1e-9, 1e9),
    _LAYER[0]: rules.Number(1e-6, 1e6),
    _LAYER[1]: rules.Number(1e-3, 1e9),
    _POISSON: rules.Number(0, 0.5, below=True),
}
_IN_US_UNITS = {us: own for key in _KEYS for us, own in rules.in_us_units(key, _KEYS[key]).items()}
_MATERIAL = MaterialRule(
    _KEYS | _IN_US_UNITS, f"a table with some of {', '.join(_KEYS)}", required=False
)
_OF_MATERIAL = (
    "with name, allowable_pressure_MPa, and compliance_um_per_MPa (how far it yields per unit of "
    "pressure) or layer_mm, modulus_MPa and poisson of a layer such as a lining; poisson defaults "
    "to 0.3"
)


@dataclass(frozen=True)
class Material:
    """Material of the ball or the seat.

    Attributes:
        part: which of them.
        name: of the material, or "".
        allowable_pressure: in Pa, if the scene gives one.
        compliance: approach per pressure in m³/N; 0 for a part that does not yield, ``None`` if
            the scene gives that of neither part.
        layer: thickness in m of the layer that yields, if the scene gives one.
    """

    part: Literal["ball", "seat"]
    name: str
    allowable_pressure: float | None
    compliance: float | None
    layer: float | None = None


@dataclass(frozen=True, eq=False)
class BallJointCase:
    """A ball joint of a scene with its load and materials.

    Attributes:
        joint: the joint.
        load: in N.
        friction: coefficient of friction, if the scene gives one.
        materials: of the ball and of the seat.
        sized: whether the scene leaves the radius to the allowable pressure.
        picture_file: name of the file for the picture, if any.
    """

    joint: BallJoint
    load: float
    friction: float | None
    materials: tuple[Material, Material]
    sized: bool
    picture_file: str | None

    @property
    def allowable_pressure(self) -> float | None:
        """Pressure that both materials bear, in Pa; ``None`` if the scene gives none."""
        given = [part.allowable_pressure for part in self.materials]
        return min((pressure for pressure in given if pressure is not None), default=None)


def ball_joint_case(values: Mapping[str, Any], _: object = None) -> BallJointCase:
    """Return the case that the keys of the section describe."""
    ball, seat = (values.get(part, {}) for part in ("ball", "seat"))
    yields = [_compliance(part) for part in (ball, seat)]
    compliance = sum(own or 0.0 for own in yields) or None
    materials = (
        _material("ball", ball, yields[0], compliance),
        _material("seat", seat, yields[1], compliance),
    )
    clearance = values.get("clearance_mm", 0.0) * _MM
    if clearance and compliance is None:
        raise ArgumentValueError(
            "clearance_mm",
            "needs the compliance of ball or seat; how far they yield determines the contact angle",
        )
    fit: dict[str, Any] = {"clearance": clearance, "compliance": compliance} if clearance else {}
    half_angle = math.radians(values.get("half_angle_deg", 90.0))
    pressures = [m.allowable_pressure for m in materials if m.allowable_pressure is not None]
    if "radius_mm" in values:
        joint = BallJoint(values["radius_mm"] * _MM, half_angle)
        joint = joint.with_clearance(**fit) if fit else joint
    elif pressures:
        joint = BallJoint.sized_for(values["load_N"], min(pressures), half_angle, **fit)
    else:
        raise ArgumentValueError(
            "radius_mm",
            "is missing; or give allowable_pressure_MPa of ball or seat to size the ball",
        )
    return BallJointCase(
        joint,
        values["load_N"],
        values.get("friction"),
        materials,
        "radius_mm" not in values,
        values.get("picture"),
    )


def _compliance(values: Mapping[str, Any]) -> float | None:
    """Approach per pressure in m³/N, as given or of a layer."""
    if "compliance_um_per_MPa" in values:
        return float(values["compliance_um_per_MPa"]) * 1e-6 / _MPA
    if "layer_mm" in values:
        layer = values["layer_mm"] * _MM, values["modulus_MPa"] * _MPA
        return float(np.asarray(layer_compliance(*layer, values.get("poisson", 0.3))))
    return None


def _material(
    part: Literal["ball", "seat"], values: Mapping[str, Any], own: float | None, both: float | None
) -> Material:
    pressure = values.get("allowable_pressure_MPa")
    return Material(
        part,
        values.get("name", ""),
        None if pressure is None else pressure * _MPA,
        (own or 0.0) if both is not None else None,
        values["layer_mm"] * _MM if "layer_mm" in values else None,
    )


BALL_JOINT: Section[BallJointCase | None] = Section(
    "ball_joint",
    "a ball in its seat; alone or with a driveline",
    {
        "load_N": Key(
            rules.Number(1e-6, 1e12), "force between ball and seat; it points to the seat's middle"
        ),
        "radius_mm": Key(
            rules.SIZE,
            "radius of the ball; default: the smallest that the allowable pressure permits",
        ),
        "half_angle_deg": Key(
            rules.Number(0.1, 90, unit="deg"),
            "angle from the middle of the seat to its edge",
            default=90,
        ),
        "clearance_mm": Key(
            rules.Number(0, 1e6),
            "radius of the seat less that of the ball; needs the compliance of ball or seat",
            default=0,
        ),
        "friction": Key(rules.FRICTION, "coefficient of friction between ball and seat"),
        "ball": Key(_MATERIAL, f"table of the ball, {_OF_MATERIAL}"),
        "seat": Key(_MATERIAL, "table of the seat with the same keys"),
        "picture": Key(
            rules.FileName(columns.PICTURES),
            "file for the picture of the pressure on the seat; its name ends in "
            + " or ".join(columns.PICTURES),
            kind="picture file",
        ),
    },
    ball_joint_case,
    needed=(("load_N",),),
)

"""What a ball joint of a scene carries: its figures, its verdict, and the answer as plain data."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from cardan.app.answers.answer import Answer
from cardan.app.answers.json_schema import ANGLE, one_of, record
from cardan.app.answers.study.extremes import finite_or_none
from cardan.app.scene.ball_joint import BallJointCase, Material
from cardan.arrays import FloatArray
from cardan.ball_joint import BallJoint
from cardan.design.judged import LimitVerdict, is_within, worst_of

# A ball that is sized reaches the allowable pressure itself, and the pressure at the rim of a
# hemisphere is 0, to rounding.
_ROUNDING = 1e-12

_SMALL_CLEARANCE = 0.1

# The law of a layer holds for strains that are small beside 1.
_SMALL_STRAIN = 0.1


@dataclass(frozen=True)
class Part:
    """One of the two materials under the peak pressure.

    Attributes:
        material: the material.
        verdict: whether it bears the peak pressure.
        approach: how far it yields in line with the load, in m, if the compliance is known.
    """

    material: Material
    verdict: LimitVerdict
    approach: float | None

    @property
    def strain(self) -> float | None:
        """The approach over the thickness of its layer, if it is a layer that yields."""
        layer = self.material.layer
        return None if self.approach is None or layer is None else self.approach / layer

    @property
    def is_overstrained(self) -> bool:
        """Whether its layer is compressed by more than the model of a layer allows."""
        return self.strain is not None and self.strain > _SMALL_STRAIN


@dataclass(frozen=True)
class BallJointFigures:
    """What a ball joint carries; SI units.

    Attributes:
        peak: pressure in line with the load.
        edge: pressure at the edge of the contact.
        projected: load over the projected area of the seat, as bearing catalogues count it.
        contact_angle: from the load to the edge of the contact.
        verdict: whether both materials bear the peak pressure.
        parts: ball and seat.
        allowable: the smaller of their allowable pressures, if any is given.
        smallest_radius: of a ball whose peak pressure is just allowable, if that is given.
        allowable_load: at which the peak pressure is just allowable, if that is given.
        turning: friction moment about the line of the load, if the friction is given.
        swivelling: friction moment about a line across the load, if the friction is given.
        wide_clearance: whether the clearance is too large beside the radius for the model.
    """

    peak: float
    edge: float
    projected: float
    contact_angle: float
    verdict: LimitVerdict
    parts: tuple[Part, Part]
    allowable: float | None
    smallest_radius: float | None
    allowable_load: float | None
    turning: float | None
    swivelling: float | None
    wide_clearance: bool

    @property
    def passes(self) -> bool:
        """Whether no allowable pressure is exceeded."""
        return self.verdict != "beyond"

    @property
    def weaker(self) -> Material | None:
        """The material with the smaller allowable pressure, if any is given."""
        judged = [
            (part.material.allowable_pressure, part.material)
            for part in self.parts
            if part.material.allowable_pressure is not None
        ]
        return min(judged, key=lambda entry: entry[0])[1] if judged else None


def ball_joint_figures(case: BallJointCase) -> BallJointFigures:
    """Return what the joint of a scene carries."""
    joint, load, allowable = case.joint, case.load, case.allowable_pressure
    peak = float(joint.peak_pressure(load))
    contact_angle = float(joint.contact_angle(load))
    edge = float(joint.pressure(contact_angle, load))
    rim = float(joint.radius) * math.sin(float(joint.half_angle))
    one, other = (_part(material, peak) for material in case.materials)
    friction = case.friction
    return BallJointFigures(
        peak=peak,
        edge=edge if edge > _ROUNDING * peak else 0.0,
        projected=load / (math.pi * rim**2),
        contact_angle=contact_angle,
        verdict=worst_of((one.verdict, other.verdict)),
        parts=(one, other),
        allowable=allowable,
        smallest_radius=None if allowable is None else _smallest(case, allowable),
        allowable_load=None if allowable is None else float(joint.allowable_load(allowable)),
        turning=None if friction is None else float(joint.friction_moment(load, friction)),
        swivelling=(
            None if friction is None else float(joint.tilting_friction_moment(load, friction))
        ),
        wide_clearance=bool(joint.clearance > _SMALL_CLEARANCE * joint.radius),
    )


def _part(material: Material, peak: float) -> Part:
    verdict: LimitVerdict = "not judged"
    if material.allowable_pressure is not None:
        bears = is_within(peak, material.allowable_pressure)
        verdict = "within" if bears else "beyond"
    approach = None if material.compliance is None else material.compliance * peak
    return Part(material, verdict, approach)


def _smallest(case: BallJointCase, allowable: float) -> float:
    joint = case.joint
    loose = (
        {}
        if joint.compliance is None
        else {"clearance": joint.clearance, "compliance": joint.compliance}
    )
    return float(BallJoint.sized_for(case.load, allowable, joint.half_angle, **loose).radius)


# --- the pressure over the seat ----------------------------------------------------------------


def pressure_curve(case: BallJointCase, steps: int = 361) -> tuple[FloatArray, FloatArray]:
    """Return angles from the load, from edge to edge of the seat, in rad and pressures in Pa."""
    edge = float(case.joint.half_angle)
    theta = np.linspace(-edge, edge, steps)
    return theta, np.asarray(case.joint.pressure(theta, case.load))


def fitting_curve(case: BallJointCase, theta: FloatArray) -> FloatArray | None:
    """Return the pressures in Pa without clearance, Marcus's cosine; ``None`` if there is none."""
    if not case.joint.clearance:
        return None
    fit = BallJoint(case.joint.radius, case.joint.half_angle)
    return np.asarray(fit.pressure(theta, case.load))


def cross_section(theta: FloatArray, height: FloatArray | float) -> tuple[FloatArray, FloatArray]:
    """Return points of a section through ball and seat in ball radii, the load pointing down.

    Args:
        theta: angles from the load in rad.
        height: over the surface of the ball, in its radii.
    """
    return (1.0 + height) * np.sin(theta), -(1.0 + height) * np.cos(theta)


# --- plain data --------------------------------------------------------------------------------


def data(case: BallJointCase, *, radians: bool = False) -> dict[str, Any]:
    """Return a ball joint as plain data for JSON, as ``SCHEMA`` describes it."""
    found, joint = ball_joint_figures(case), case.joint
    unit, turned = ("rad", float) if radians else ("deg", math.degrees)
    return {
        "verdict": found.verdict,
        "load_N": case.load,
        "radius_mm": 1e3 * float(joint.radius),
        "radius": "smallest" if case.sized else "given",
        f"half_angle_{unit}": turned(float(joint.half_angle)),
        "clearance_mm": 1e3 * float(joint.clearance),
        "peak_pressure_MPa": _scaled(found.peak, 1e-6),
        "edge_pressure_MPa": _scaled(found.edge, 1e-6),
        "projected_pressure_MPa": _scaled(found.projected, 1e-6),
        f"contact_angle_{unit}": turned(found.contact_angle),
        "parts": [_part_data(part, found.peak) for part in found.parts],
        "smallest_radius_mm": _scaled(found.smallest_radius, 1e3),
        "allowable_load_N": _scaled(found.allowable_load, 1.0),
        "turning_friction_Nm": _scaled(found.turning, 1.0),
        "swivelling_friction_Nm": _scaled(found.swivelling, 1.0),
    }


def _part_data(part: Part, peak: float) -> dict[str, Any]:
    allowable = part.material.allowable_pressure
    margin = None if allowable is None else allowable - peak
    return {
        "part": part.material.part,
        "name": part.material.name,
        "verdict": part.verdict,
        "allowable_pressure_MPa": _scaled(allowable, 1e-6),
        "margin_MPa": _scaled(margin, 1e-6),
        "approach_um": _scaled(part.approach, 1e6),
    }


def _scaled(value: float | None, factor: float) -> float | None:
    return None if value is None else finite_or_none(factor * value)


_FIGURE = {"type": ["number", "null"]}
_VERDICT = {"enum": ["within", "beyond", "not judged"]}

SCHEMA: Mapping[str, Any] = one_of(
    {
        "verdict": _VERDICT,
        "load_N": {"type": "number"},
        "radius_mm": {"type": "number"},
        "radius": {
            "enum": ["given", "smallest"],
            "description": "smallest: the scene leaves it to the allowable pressure",
        },
        "clearance_mm": {"type": "number"},
        **dict.fromkeys(
            (
                "peak_pressure_MPa",
                "edge_pressure_MPa",
                "projected_pressure_MPa",
                "smallest_radius_mm",
                "allowable_load_N",
                "turning_friction_Nm",
                "swivelling_friction_Nm",
            ),
            _FIGURE,
        ),
        "parts": {
            "type": "array",
            "items": record(
                {
                    "part": {"enum": ["ball", "seat"]},
                    "name": {"type": "string"},
                    "verdict": _VERDICT,
                    **dict.fromkeys(
                        ("allowable_pressure_MPa", "margin_MPa", "approach_um"), _FIGURE
                    ),
                }
            ),
        },
    },
    *(
        {f"{name}_{angle}": {"type": "number"} for angle in ANGLE}
        for name in ("half_angle", "contact_angle")
    ),
)
"""JSON Schema of ``data``: figures that the scene has no input for are null."""


def find(answer: Answer) -> BallJointCase | None:
    """Return the figures of an answer's scene."""
    return answer.of.ball_joint


def verdicts(found: BallJointCase) -> dict[str, str]:
    """Return the verdicts on what the scene limits."""
    return {"pressure": ball_joint_figures(found).verdict}

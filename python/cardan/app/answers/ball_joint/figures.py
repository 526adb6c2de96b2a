"""What a ball joint of a scene carries, beside what its materials bear."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np

from cardan.app.answers.answer import Answer
from cardan.app.answers.printed import quantity, use_text
from cardan.app.answers.rows import Judged, figure, word
from cardan.app.scene.language.units import shown_unit
from cardan.app.scene.sections.ball_joint import BallJointCase, Material
from cardan.arrays import FloatArray
from cardan.ball_joint import BallJoint

# The pressure at the rim of a hemisphere is 0, to rounding.
_ROUNDING = 1e-12


@dataclass(frozen=True)
class BallJointFigures:
    """What a ball joint carries."""

    ball: str = word("material of the ball")
    seat: str = word("material of the seat")
    load: float = figure("load", "N", "force between ball and seat", digits="given")
    radius: float = figure("radius of the ball", "mm")
    radius_from: Literal["scene", "allowable pressure"] = word(
        "radius from", "a scene without a radius leaves it to the allowable pressure"
    )
    half_angle: float = figure(
        "half-angle of the seat", "deg", "from the load to the edge", digits="given"
    )
    clearance: float = figure(
        "clearance", "mm", "radius of the seat less that of the ball", digits="given"
    )
    ball_pressure: Judged = figure(
        "peak pressure on the ball",
        "MPa",
        "in line with the load",
        source="M. Marcus (1902): each point yields in proportion to its own pressure",
        limit="[ball_joint] ball.allowable_pressure_MPa",
    )
    seat_pressure: Judged = figure(
        "peak pressure on the seat",
        "MPa",
        "in line with the load; as large as on the ball",
        source="M. Marcus (1902): each point yields in proportion to its own pressure",
        limit="[ball_joint] seat.allowable_pressure_MPa",
    )
    edge_pressure: float = figure("pressure at the edge of contact", "MPa")
    contact_angle: float = figure(
        "edge of contact from the load", "deg", "half-angle of the contact"
    )
    projected_pressure: float = figure(
        "load over projected area", "MPa", "mean pressure as bearing catalogues count it"
    )
    allowable_load: float | None = figure(
        "largest allowable load",
        "N",
        "at which the peak pressure is just allowable",
        rounds="down",
    )
    smallest_radius: float | None = figure(
        "smallest allowable radius",
        "mm",
        "of a ball whose peak pressure is just allowable",
        rounds="up",
    )
    ball_approach: float | None = figure(
        "approach, ball", "mm", "how far it yields in line with the load", digits="small"
    )
    seat_approach: float | None = figure(
        "approach, seat", "mm", "how far it yields in line with the load", digits="small"
    )
    ball_strain: float | None = figure("compression of the layer of the ball", "percent")
    seat_strain: float | None = figure("compression of the layer of the seat", "percent")
    turning_friction: float | None = figure(
        "friction moment, turning about the load", "Nm", "about the line of the load"
    )
    swivelling_friction: float | None = figure(
        "friction moment, swivelling", "Nm", "about a line across the load"
    )

    @property
    def weaker(self) -> Literal["ball", "seat"] | None:
        """The part with the smaller allowable pressure, if any is given."""
        limits: dict[Literal["ball", "seat"], float | None] = {
            "ball": self.ball_pressure.limit,
            "seat": self.seat_pressure.limit,
        }
        given = [(limit, part) for part, limit in limits.items() if limit is not None]
        return min(given, default=(0.0, None))[1]

    @property
    def peak(self) -> float:
        """The pressure in line with the load in Pa."""
        assert self.seat_pressure.value is not None
        return self.seat_pressure.value


def find(answer: Answer) -> BallJointFigures | None:
    """Return what the ball joint of a scene carries; ``None`` without one."""
    case = answer.of.ball_joint
    return None if case is None else ball_joint_figures(case)


def ball_joint_figures(case: BallJointCase) -> BallJointFigures:
    """Return what the joint of a scene carries."""
    joint, load, allowable = case.joint, case.load, case.allowable_pressure
    peak = float(joint.peak_pressure(load))
    contact_angle = float(joint.contact_angle(load))
    edge = float(joint.pressure(contact_angle, load))
    rim = float(joint.radius) * math.sin(float(joint.half_angle))
    ball, seat = case.materials
    friction = case.friction
    return BallJointFigures(
        ball=ball.name,
        seat=seat.name,
        load=load,
        radius=float(joint.radius),
        radius_from="allowable pressure" if case.sized else "scene",
        half_angle=float(joint.half_angle),
        clearance=float(joint.clearance),
        ball_pressure=Judged(peak, ball.allowable_pressure),
        seat_pressure=Judged(peak, seat.allowable_pressure),
        edge_pressure=edge if edge > _ROUNDING * peak else 0.0,
        contact_angle=contact_angle,
        projected_pressure=load / (math.pi * rim**2),
        allowable_load=None if allowable is None else float(joint.allowable_load(allowable)),
        smallest_radius=None if allowable is None else _smallest(case, allowable),
        ball_approach=_approach(ball, peak),
        seat_approach=_approach(seat, peak),
        ball_strain=_strain(ball, peak),
        seat_strain=_strain(seat, peak),
        turning_friction=None if friction is None else float(joint.friction_moment(load, friction)),
        swivelling_friction=(
            None if friction is None else float(joint.tilting_friction_moment(load, friction))
        ),
    )


def _approach(material: Material, peak: float) -> float | None:
    return None if material.compliance is None else material.compliance * peak


def _strain(material: Material, peak: float) -> float | None:
    approach = _approach(material, peak)
    return None if approach is None or material.layer is None else approach / material.layer


def _smallest(case: BallJointCase, allowable: float) -> float:
    joint = case.joint
    loose = (
        {}
        if joint.compliance is None
        else {"clearance": joint.clearance, "compliance": joint.compliance}
    )
    return float(BallJoint.sized_for(case.load, allowable, joint.half_angle, **loose).radius)


def pressure_curve(case: BallJointCase, steps: int = 361) -> tuple[FloatArray, FloatArray]:
    """Return angles from the load, from edge to edge of the seat, in rad and pressures in Pa."""
    edge = float(case.joint.half_angle)
    theta = np.linspace(-edge, edge, steps)
    return theta, np.asarray(case.joint.pressure(theta, case.load))


# The law of a layer holds for strains that are small beside 1.
_SMALL_STRAIN = 0.1

_SMALL_CLEARANCE = 0.1


def sentences(found: BallJointFigures) -> Iterator[str]:
    """Say whether the pressure is allowable, what to change if not, and what limits the model."""
    yield _verdict(found)
    for part, strain in (("ball", found.ball_strain), ("seat", found.seat_strain)):
        if strain is None or strain <= _SMALL_STRAIN:
            continue
        if strain >= 1.0:
            yield (
                f"The approach of the {_named(found, part)} exceeds the thickness of its layer, "
                "which no layer can do. Check load, modulus_MPa and layer_mm."
            )
        else:
            yield (
                f"The {_named(found, part)} is compressed by {quantity(strain, 'percent')} of the "
                "thickness of its layer. The model assumes less than 10%; treat the pressure as a "
                "rough estimate."
            )
    if found.clearance > _SMALL_CLEARANCE * found.radius:
        yield (
            "The clearance exceeds a tenth of the radius. The model assumes a small clearance; "
            "treat the pressure as a rough estimate."
        )


def _verdict(found: BallJointFigures) -> str:
    weaker = found.weaker
    if weaker is None:
        return (
            "The pressure is not judged: the scene gives no allowable pressure of ball or seat. "
            "Take it from the supplier of the seat as a peak pressure; a limit for the load over "
            "the projected area compares with that figure."
        )
    if found.radius_from == "allowable pressure":
        return (
            f"This is the smallest ball; the {_named(found, weaker)} is at its allowable pressure. "
            f"Round the radius up and enter it as radius_{shown_unit('mm')}."
        )
    judged = found.ball_pressure if weaker == "ball" else found.seat_pressure
    assert judged.limit is not None
    if judged.verdict == "within":
        return (
            "The ball joint is within the allowable pressure: the peak uses "
            f"{use_text(found.peak / judged.limit)} of what the scene allows the "
            f"{_named(found, weaker)}."
        )
    assert found.smallest_radius is not None
    assert found.allowable_load is not None
    return (
        f"The ball joint is beyond the allowable pressure that the scene gives the "
        f"{_named(found, weaker)}. A ball of "
        f"{quantity(found.smallest_radius, 'mm', rounds='up')} radius is within it; this one "
        f"carries up to {quantity(found.allowable_load, 'N', rounds='down')}."
    )


def _named(found: BallJointFigures, part: str) -> str:
    """Ball or seat with its material."""
    name = found.ball if part == "ball" else found.seat
    return f"{part} ({name})" if name else part

"""Loads of the ball joint of a scene, beside those its materials bear."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, NamedTuple

import numpy as np

from cardan.app.answers.answer import Answer
from cardan.app.answers.page import Curve, Panel, chart
from cardan.app.answers.printed import given, quantity, use_text, with_unit
from cardan.app.answers.rows import UNITS, Judged, figure, word
from cardan.app.pictures.style import THIN, arrow, check_kind, drawing, finish, line_style, page
from cardan.app.scene.language.units import shown_unit
from cardan.app.scene.sections.ball_joint import BallJointCase, Material
from cardan.arrays import FloatArray
from cardan.ball_joint import BallJoint

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


# The pressure at the rim of a hemisphere is 0, to rounding.
_ROUNDING = 1e-12


@dataclass(frozen=True)
class BallJointFigures:
    """Loads of a ball joint."""

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
        ball, seat = self.ball_pressure.limit, self.seat_pressure.limit
        if ball is None:
            return None if seat is None else "seat"
        return "ball" if seat is None or ball <= seat else "seat"

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
    loose: dict[str, Any] = {}
    if joint.compliance is not None:
        loose = {"clearance": joint.clearance, "compliance": joint.compliance}
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
        smallest_radius=None
        if allowable is None
        else float(BallJoint.sized_for(load, allowable, joint.half_angle, **loose).radius),
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


# In ball radii: how far the peak pressure stands out, how thick the seat is drawn.
_PEAK, _SEAT = 0.5, 0.7
_ARROWS = 15

_ANGLE = "angle from the line of the load [deg]"

# Pixels of a ball radius on the page.
_SCALE = 100.0


class _Outlines(NamedTuple):
    """Ball, seat, pressure and its arrows in section, ``(points, 2)`` in ball radii."""

    ball: FloatArray
    seat: FloatArray
    pressure: FloatArray
    arrows: list[FloatArray]


def _outlines(case: BallJointCase, found: BallJointFigures) -> _Outlines:
    """The section with the load pointing down; the pressure stands on the ball."""
    theta, pressure = pressure_curve(case)
    touches = np.abs(theta) <= found.contact_angle
    arrows = zip(*pressure_curve(case, _ARROWS), strict=True)
    return _Outlines(
        _section(np.linspace(-np.pi, np.pi, 361), 0.0),
        _ring(theta, np.full_like(theta, _SEAT)),
        _ring(theta[touches], _PEAK * pressure[touches] / found.peak),
        [
            _section(np.full(2, angle), np.array([0.0, _PEAK * size / found.peak]))
            for angle, size in arrows
            if size > 0.05 * found.peak
        ],
    )


def _section(theta: FloatArray, height: FloatArray | float) -> FloatArray:
    """Points at angles from the load and heights over the surface of the ball."""
    return np.stack([(1.0 + height) * np.sin(theta), -(1.0 + height) * np.cos(theta)], axis=-1)


def _ring(theta: FloatArray, height: FloatArray) -> FloatArray:
    """The outline of what lies between the surface of the ball and a height over it."""
    return np.concatenate([_section(theta, 0.0), _section(theta[::-1], height[::-1])])


def _curves(case: BallJointCase, found: BallJointFigures) -> tuple[FloatArray, dict[str, Any]]:
    """Angles from the load in degrees, and the pressures that are compared there.

    Without clearance the pressure is Marcus's cosine.
    """
    theta, pressure = pressure_curve(case)
    curves = {"pressure on the seat": pressure}
    if case.joint.clearance:
        fit = BallJoint(case.joint.radius, case.joint.half_angle)
        curves["without clearance"] = np.asarray(fit.pressure(theta, case.load))
    if found.weaker is not None and case.allowable_pressure is not None:
        curves[f"allowable for the {found.weaker}"] = np.full_like(theta, case.allowable_pressure)
    factor = UNITS[shown_unit("MPa")].factor
    return np.degrees(theta), {label: factor * values for label, values in curves.items()}


def drawn(answer: Answer, found: BallJointFigures) -> dict[str, Any]:
    """Return the section and the curves of the pressure as plain data for ``ball_joint.html``."""
    case = answer.of.ball_joint
    assert case
    degrees, curves = _curves(case, found)
    unit = UNITS[shown_unit("MPa")].symbol
    panel = Panel("Pressure on the seat", unit, tuple(Curve(*each) for each in curves.items()))
    shapes = _outlines(case, found)
    peak = quantity(found.peak, "MPa")
    return {
        "charts": [chart(panel, degrees, _ANGLE)],
        "drawing": {
            "ball": f"{_path(shapes.ball)}Z",
            "seat": f"{_path(shapes.seat)}Z",
            "pressure": f"{_path(shapes.pressure)}Z",
            "arrows": [_path(arrow) for arrow in shapes.arrows],
            "load": given(case.load, "N"),
            "peak": peak,
            "spoken": f"Ball and seat in section: the pressure is largest in line with the load, "
            f"{peak}",
        },
    }


def _path(points: FloatArray) -> str:
    return "M" + "L".join(f"{_SCALE * x:.1f} {-_SCALE * y:.1f}" for x, y in points)


def plot_ball_joint(case: BallJointCase, title: str = "") -> Figure:
    """Return a picture of a ball joint, 170 mm wide: the pressure in section and as a curve.

    Args:
        case: the ball joint of a scene.
        title: heading.
    """
    check_kind("case", case, BallJointCase)
    with page(170.0, 78.0, title, 90) as figure:
        left, right = figure.subplots(1, 2, width_ratios=(1.0, 1.15))
        plot_seat_section(case, ax=left)
        plot_seat_pressure(case, ax=right)
    return figure


def _whole(answer: Answer) -> Figure:
    """Pressure on the seat of a ball joint: section and curve."""
    case = answer.of.ball_joint
    if case is None:
        raise ValueError(f"{answer.of.name}: section [ball_joint] is missing")
    return plot_ball_joint(case, answer.of.title)


PICTURES = {"ball_joint": _whole}


def plot_seat_section(case: BallJointCase, *, ax: Axes | None = None) -> Axes:
    """Draw ball and seat in section, with the pressure at right angles to the surface.

    The pressure is drawn outwards from the surface of the ball, where it acts on the seat; the
    longest arrow is the peak pressure.

    Args:
        case: the ball joint of a scene.
    """
    check_kind("case", case, BallJointCase)
    found = ball_joint_figures(case)
    shapes, blue = _outlines(case, found), line_style(0)["color"]
    body: dict[str, Any] = {"edgecolor": "0.35", "linewidth": 0.8}
    with drawing(ax, height_mm=78.0) as axes:
        axes.fill(*shapes.ball.T, facecolor="0.92", **body)
        axes.fill(*shapes.seat.T, facecolor="white", hatch="////", alpha=0.3, **body)
        axes.fill(*shapes.pressure.T, facecolor=blue, alpha=0.25)
        axes.plot(*shapes.pressure[len(shapes.pressure) // 2 :].T, color=blue)
        for foot, head in shapes.arrows:
            arrow(axes, tuple(foot), tuple(head), "-|>,head_length=0.25,head_width=0.12", blue, 0.7)
        for side in (-1.0, 1.0):
            edge = np.full(2, side * found.contact_angle)
            axes.plot(*_section(edge, np.array([-1.0, _SEAT])).T, **THIN)
        arrow(axes, (0.0, 0.75), (0.0, -0.15), "-|>", "black", 1.2)
        axes.text(0.07, 0.35, given(case.load, "N"), parse_math=False)
        peak = quantity(found.peak, "MPa")
        axes.text(0.0, -1.04 - _SEAT, peak, ha="center", va="top", parse_math=False)
        axes.text(0.0, 1.06, f"ball radius {quantity(float(case.joint.radius), 'mm')}", ha="center")
        axes.set_aspect("equal")
        axes.set_axis_off()
    return axes


def plot_seat_pressure(case: BallJointCase, *, ax: Axes | None = None) -> Axes:
    """Draw the pressure on the seat over the angle from the load, beside what is allowable.

    Arguments are those of ``plot_seat_section``.
    """
    check_kind("case", case, BallJointCase)
    found = ball_joint_figures(case)
    degrees, curves = _curves(case, found)
    with drawing(ax, height_mm=60.0) as axes:
        for (label, values), style in zip(curves.items(), (0, 1, 3), strict=False):
            axes.plot(degrees, values, label=label, **line_style(style))
        top = 1.05 * max(float(np.max(values)) for values in curves.values())
        ends = (degrees[0], degrees[-1]), (0.0, top)
        finish(axes, _ANGLE, with_unit("pressure", "MPa"), *ends, ncols=2)
    return axes

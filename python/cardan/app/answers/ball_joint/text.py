"""What a ball joint carries, in words."""

from __future__ import annotations

import math
from collections.abc import Iterator

from cardan.app.answers.ball_joint.figures import BallJointFigures, Part, ball_joint_figures
from cardan.app.answers.printed import aligned, figure_text
from cardan.app.scene.ball_joint import BallJointCase, Material
from cardan.design.wrapping import fill

_MPA = 1e-6


def words(case: BallJointCase, *, radians: bool = False) -> str:
    """Return the figures of a ball joint and its verdict as plain text, 79 characters wide."""
    found = ball_joint_figures(case)
    lines = ball_joint_lines(case, found, radians=radians)
    words = (fill(text, 79) for text in verdict_text(case, found))
    return "\n".join(["Ball joint", aligned(lines, indent="  "), "", *words])


def ball_joint_lines(
    case: BallJointCase, found: BallJointFigures, *, radians: bool = False
) -> list[tuple[str, str]]:
    """Return the figures as pairs of what a line is about and its figures."""
    joint = case.joint
    sized = ", the smallest allowable" if case.sized else ""
    named = [f"{m.part} {m.name}" for m in case.materials if m.name]
    lines = [("materials", ", ".join(named))] if named else []
    lines += [
        ("load", f"{figure_text(case.load)} N"),
        ("radius of the ball", f"{figure_text(1e3 * joint.radius)} mm{sized}"),
        ("half-angle of the seat", _angle(float(joint.half_angle), radians)),
    ]
    if joint.clearance:
        lines += [("clearance", f"{figure_text(1e3 * joint.clearance)} mm")]
    lines += [
        ("peak pressure", f"{_pressure(found.peak)}, in line with the load"),
        (
            "pressure at the edge of contact",
            f"{_pressure(found.edge)} at {_angle(found.contact_angle, radians)} from that line",
        ),
        ("load over projected area", _pressure(found.projected)),
    ]
    lines += [
        (f"allowable pressure, {part.material.part}", _judged(part, found.peak))
        for part in found.parts
        if part.material.allowable_pressure is not None
    ]
    if found.allowable_load is not None and not case.sized:
        lines += [("largest allowable load", f"{figure_text(found.allowable_load)} N")]
    if found.smallest_radius is not None and not case.sized:
        lines += [("smallest allowable radius", f"{figure_text(1e3 * found.smallest_radius)} mm")]
    lines += [
        (f"approach, {part.material.part}", f"{figure_text(1e6 * part.approach)} µm")
        for part in found.parts
        if part.approach
    ]
    if found.turning is not None and found.swivelling is not None:
        lines += [
            ("friction moment, turning about the load", f"{figure_text(found.turning)} N m"),
            ("friction moment, swivelling", f"{figure_text(found.swivelling)} N m"),
        ]
    return lines


def verdict_text(case: BallJointCase, found: BallJointFigures) -> Iterator[str]:
    """Say whether the pressure is allowable, what to change if not, and what limits the model."""
    weaker = found.weaker
    if weaker is None or found.allowable is None:
        yield (
            "The pressure is not judged: the scene gives no allowable pressure of ball or seat. "
            "Take it from the supplier of the seat as a peak pressure; a limit for the load over "
            "the projected area compares with that figure."
        )
    elif case.sized:
        yield (
            f"This is the smallest ball; the {part_name(weaker)} is at its allowable pressure. "
            "Round the radius up and enter it as radius_mm."
        )
    elif found.passes:
        share = 100.0 * found.peak / found.allowable
        yield (
            f"The ball joint is within the allowable pressure: the peak uses {share:.0f} % of what "
            f"the scene allows the {part_name(weaker)}."
        )
    else:
        assert found.smallest_radius is not None
        assert found.allowable_load is not None
        radius = math.ceil(1e4 * found.smallest_radius) / 10.0
        yield (
            f"The ball joint is beyond the allowable pressure that the scene gives the "
            f"{part_name(weaker)}. A ball of {radius:g} mm radius is within it; this one carries "
            f"up to {figure_text(found.allowable_load)} N."
        )
    yield from filter(None, map(_strained, found.parts))
    if found.wide_clearance:
        yield (
            "The clearance exceeds a tenth of the radius. The model assumes a small clearance; "
            "treat the pressure as a rough estimate."
        )


def _strained(part: Part) -> str:
    """What to say of a layer that is compressed by too much; "" of others."""
    strain, name = part.strain, part_name(part.material)
    if strain is None or not part.is_overstrained:
        return ""
    if strain >= 1.0:
        return (
            f"The approach of the {name} exceeds the thickness of its layer, which no layer can "
            "do. Check load, modulus_MPa and layer_mm."
        )
    return (
        f"The {name} is compressed by {figure_text(100.0 * strain)} % of the thickness of its "
        "layer. The model assumes less than 10 %; treat the pressure as a rough estimate."
    )


def part_name(material: Material) -> str:
    """Name ball or seat with its material."""
    return f"{material.part} ({material.name})" if material.name else material.part


def _judged(part: Part, peak: float) -> str:
    allowable = part.material.allowable_pressure
    assert allowable is not None
    if abs(allowable - peak) <= 1e-9 * allowable:
        return f"{_pressure(allowable)}, reached"
    apart = _pressure(abs(allowable - peak))
    how = f"margin {apart}" if part.verdict == "within" else f"exceeded by {apart}"
    return f"{_pressure(allowable)}, {how}"


def _pressure(value: float) -> str:
    return f"{figure_text(_MPA * value)} MPa"


def _angle(value: float, radians: bool) -> str:
    return f"{value:.4f} rad" if radians else f"{math.degrees(value):.2f}°"

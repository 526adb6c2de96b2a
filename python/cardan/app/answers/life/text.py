"""The life and the heat of joints, in words."""

from __future__ import annotations

import math
import textwrap
from collections.abc import Iterator, Sequence

from cardan.app.answers.life.figures import AgainstLimit, JointLife, LifeFigures, SizeLife
from cardan.app.answers.printed import aligned, figure_text, short
from cardan.design.wrapping import fill

STEP_HEADS = ("Step", "Share", "Speed [rpm]", "Torque [N m]", "Bends [deg]")
"""Headings of the table of the duty cycle."""


def words(found: LifeFigures, *, radians: bool = False) -> str:
    """Return all about the life of the joints as plain text, 79 wide."""
    parts = [_filled(life_sentences(found))]
    parts.append(f"Duty cycle\n{_table(STEP_HEADS, step_rows(found))}")
    if found.joints:
        parts += [
            f"Joint {joint.joint}\n{aligned(joint_lines(joint, found), indent='  ')}"
            for joint in found.joints
        ]
    if found.sizes:
        parts.append(f"Sizes\n{_table(SIZE_HEADS, size_rows(found))}")
    return "\n\n".join(parts)


def brief(found: LifeFigures) -> str:
    """Return what a check says of the life, 79 wide."""
    return f"Life of the joints\n{_filled(life_sentences(found))}"


def life_sentences(found: LifeFigures) -> Iterator[str]:
    """Say how long the joints last, which size would suffice, what is beyond a limit, the heat."""
    yield f"{_headline(found)}."
    for joint in found.joints:
        yield from _faults(joint)
    swinging = [joint.joint for joint in found.joints if joint.small_swing]
    if swinging:
        yield (
            f"The needles of {_joints(swinging)} swing by less than 3° in a step of the duty "
            "cycle. They may mark their races (false brinelling), which no law of life covers."
        )
    plain = [joint.joint for joint in found.joints if joint.size.bearing == "plain"]
    if plain:
        yield (
            f"The law of life is that of needle bearings. It does not apply to the plain bearings "
            f"of {_joints(plain)}."
        )
    if found.is_compliant:
        yield (
            "The torques are those of rigid shafts: the vibration of [torsion] is not in them. "
            "'cardan torsion' says how large it is."
        )
    if found.heat is not None and found.efficiency is not None:
        yield (
            f"Over the duty cycle the joints dissipate {figure_text(found.heat)} W; "
            f"the efficiency is {100.0 * found.efficiency:.2f} %."
        )


def life_remedies(found: LifeFigures) -> list[str]:
    """Say which size brings joints within their limits, if one does."""
    if found.chosen is None:
        return []
    hours = hours_text(found.chosen.hours or 0.0)
    return [f"Choose size {found.chosen.size.name} for the joints; their life is then {hours}."]


def _headline(found: LifeFigures) -> str:
    first, target, chosen = found.decisive, found.duty.target, found.chosen
    parts = []
    if first is not None and first.hours is not None:
        required = ""
        if target is not None:
            relation = "at least" if found.reaches_target else "below"
            required = f", {relation} the required {hours_text(target)}"
        parts += [f"L10h {hours_text(first.hours)}{required}", f"joint {first.joint} decides"]
    if chosen is not None:
        gives = f"size {chosen.size.name} would give {hours_text(chosen.hours or 0.0)}"
        parts.append(gives)
    elif found.sizes and target is not None and not (first and found.passes):
        none = f"no size of the table reaches {hours_text(target)} within its limits"
        parts.append(none)
    if not parts and any(joint.size.rating is not None for joint in found.joints):
        return "No life is known: the joints with a rating have plain bearings"
    text = "; ".join(parts) or "no life is known: the joints have no rating"
    return f"{text[0].upper()}{text[1:]}"


def _faults(joint: JointLife) -> Iterator[str]:
    """What is beyond a limit of the joint's type."""
    if not joint.bend.passes:
        yield (
            f"Joint {joint.joint} is bent by {joint.bend.value:.4g}°; its type permits "
            f"{joint.bend.limit:.4g}°."
        )
    if not joint.speed_bend.passes:
        yield (
            f"Speed times bend of joint {joint.joint} reach {joint.speed_bend.value:.6g} rpm °; "
            f"its type permits {joint.speed_bend.limit:.6g} rpm °."
        )


def joint_lines(joint: JointLife, found: LifeFigures) -> list[tuple[str, str]]:
    """Return the figures of a joint as pairs."""
    lines = [("size", joint.size.name)] if joint.size.name else []
    if joint.size.rating is not None:
        lines.append(("rating", f"{figure_text(joint.size.rating)} N m"))
    if joint.hours is not None and joint.catalogue is not None:
        lines += [
            ("L10h by the load of the pins", hours_text(joint.hours)),
            ("L10h by the catalogue's law", hours_text(joint.catalogue)),
        ]
        if len(joint.damage) > 1:
            worst = max(range(len(joint.damage)), key=joint.damage.__getitem__)
            share = f"{100.0 * joint.damage[worst]:.0f} % of the damage"
            lines.append(("most wear", f"{found.duty.names[worst]}, {share}"))
    lines.append(("largest bend", _against(joint.bend, "°")))
    lines.append(("largest speed times bend", _against(joint.speed_bend, " rpm °")))
    if joint.heat is not None:
        heat = f"{figure_text(joint.heat.mean)} W"
        if found.duty.count > 1:
            step = found.duty.names[joint.heat.step]
            heat += f", at most {figure_text(joint.heat.largest)} W in {step}"
        lines.append(("heat", heat))
    return lines


def step_rows(found: LifeFigures) -> list[list[str]]:
    """Return the rows of the duty cycle."""
    duty = found.duty
    return [
        [
            name,
            f"{100.0 * duty.shares[i]:.4g} %",
            f"{duty.speed_rpm[i]:.6g}",
            f"{duty.load.torque[i]:.6g} at the {duty.load.end}",
            ", ".join(f"{bend:.4g}" for bend in duty.line.bends_deg[i]),
        ]
        for i, name in enumerate(duty.names)
    ]


SIZE_HEADS = ("Size", "Rating [N m]", "L10h", "First joint", "Heat [W]", "Limits")
"""Headings of the table of sizes."""


def size_rows(found: LifeFigures) -> list[list[str]]:
    """Return the rows of the sizes, the same size at every joint."""
    return [_size_row(one) for one in found.sizes]


def _size_row(one: SizeLife) -> list[str]:
    known = one.hours is not None
    return [
        one.size.name,
        "" if one.size.rating is None else f"{one.size.rating:.6g}",
        hours_text(one.hours) if one.hours is not None else "",
        f"{one.decisive}" if known else "",
        "" if one.heat is None else figure_text(one.heat),
        "within" if one.fits else "beyond",
    ]


def hours_text(hours: float) -> str:
    """Return a life in hours, to the hour from 100 h on."""
    if not math.isfinite(hours):
        return "unlimited"
    return f"{hours:.0f} h" if hours >= 100.0 else f"{hours:.3g} h"


def _against(figure: AgainstLimit, unit: str) -> str:
    limit = "" if figure.limit is None else f"; permitted {short(figure.limit)}{unit}"
    return f"{short(figure.value)}{unit}{limit}"


def _joints(joints: Sequence[int]) -> str:
    if len(joints) == 1:
        return f"joint {joints[0]}"
    return f"joints {', '.join(map(str, joints[:-1]))} and {joints[-1]}"


def _table(heads: Sequence[str], rows: Sequence[Sequence[str]]) -> str:
    widths = [max(map(len, column)) for column in zip(heads, *rows, strict=True)]
    lines = [
        "  ".join(f"{cell:{width}}" for cell, width in zip(row, widths, strict=True)).rstrip()
        for row in (heads, *rows)
    ]
    return textwrap.indent("\n".join(lines), "  ")


def _filled(texts: Iterator[str] | Sequence[str]) -> str:
    return "\n".join(fill(text, 79, break_on_hyphens=False) for text in texts)

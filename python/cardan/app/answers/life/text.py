"""The life and the heat of joints, in words."""

from __future__ import annotations

from collections.abc import Iterator

from cardan.app.answers.life.figures import JointLife, LifeFigures, passes
from cardan.app.answers.printed import capital, given, listed, place_of, quantity


def sentences(found: LifeFigures) -> Iterator[str]:
    """Say how long the joints last, which size would suffice, what is beyond a limit, the heat."""
    yield f"{_headline(found)}."
    for joint in found.joints:
        yield from _faults(joint)
    swinging = [joint.joint for joint in found.joints if joint.small_swing]
    if swinging:
        yield (
            f"The needles of {_joints(swinging)} swing by less than 3° in a step of the duty "
            "cycle. They may mark their races (false brinelling); the life formulas do not cover "
            "this."
        )
    plain = [joint.joint for joint in found.joints if joint.bearing == "plain"]
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
    heat, efficiency = found.heat, found.efficiency
    if heat and efficiency and heat.value is not None and efficiency.value is not None:
        yield (
            f"Over the duty cycle the joints dissipate {quantity(heat.value, 'W')}"
            f"{place_of(heat)}; the efficiency is {quantity(efficiency.value, 'percent')}."
        )


def life_remedies(found: LifeFigures) -> list[str]:
    """Say which size brings joints within their limits, if they are beyond and one does."""
    if found.chosen is None or (found.joints and passes(found.joints)):
        return []
    return [f"Choose size {found.chosen} for the joints; their life is then {_chosen(found)}."]


def _headline(found: LifeFigures) -> str:
    first, target = found.first, found.target
    parts = []
    if first is not None and first.hours is not None and first.hours.value is not None:
        required = ""
        if target is not None:
            relation = "below" if first.hours.verdict == "beyond" else "at least"
            required = f", {relation} the required {_hours(target)}"
        life = f"L10 life {quantity(first.hours, 'h')}{place_of(first.hours)}{required}"
        parts += [life, f"joint {first.joint} fails first"]
    if found.chosen is not None:
        parts.append(f"size {found.chosen} would give {_chosen(found)}")
    elif found.sizes and target is not None and not (first and passes(found.joints)):
        parts.append(f"no size of the table reaches {_hours(target)} within its limits")
    if parts:
        return capital("; ".join(parts))
    whys = [joint.hours.why for joint in found.joints if joint.hours]
    if found.of_sizes:
        whys.append(found.of_sizes.why)
    if whys:
        return f"The required life of {_hours(target or 0.0)} is not judged: {whys[0]}"
    if not found.steps:
        return "No life is known: it needs a speed and a torque"
    if any(joint.rating is not None for joint in found.joints):
        return "No life is known: the joints with a rating have plain bearings"
    return "No life is known: the joints have no rating"


def _chosen(found: LifeFigures) -> str:
    hours = next(one.hours or 0.0 for one in found.sizes if one.size == found.chosen)
    return quantity(hours, "h", bounds=[] if found.target is None else [found.target])


def _faults(joint: JointLife) -> Iterator[str]:
    """Say which limits of the joint's type are exceeded, and what is not judged."""
    for judged, is_, unit in (
        (joint.bend, f"Joint {joint.joint} is bent by", "deg"),
        (joint.speed_bend, f"Speed times bend of joint {joint.joint} reach", "rpm_deg"),
        (joint.heat, f"Joint {joint.joint} has a mean heat of", "W"),
    ):
        if judged is None or judged.limit is None:
            continue
        if judged.value is not None and judged.verdict == "beyond":
            yield (
                f"{is_} {quantity(judged, unit)}{place_of(judged)}; its type permits "
                f"{given(judged.limit, unit)}."
            )
    for judged, what in ((joint.speed_bend, "speed times bend"), (joint.heat, "heat")):
        if judged and judged.why:
            yield f"The {what} of joint {joint.joint} is not judged: {judged.why}."


def _hours(hours: float) -> str:
    return given(hours, "h")


def _joints(joints: list[int]) -> str:
    return f"joint{'s' if len(joints) > 1 else ''} {listed([*map(str, joints)])}"

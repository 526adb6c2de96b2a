"""Torsional vibration of a scene in words."""

from __future__ import annotations

import math
from collections.abc import Iterator

from cardan.app.answers.printed import (
    aligned,
    figure_text,
    given,
    listed,
    quantity,
    rounded_up,
    short,
)
from cardan.app.answers.torsion.figures import (
    BendRule,
    CriticalSpeed,
    LargestTorque,
    SpeedRange,
    TorsionBasics,
    TorsionFigures,
    is_unknown,
)
from cardan.design.wrapping import fill, wrap

RESONANCE_SOURCE = "D. Thoma, 1920: joints bring new critical speeds"
RULE_SOURCE = "first region of the Whittaker-Hill equation, one compliant shaft"

# Below this share of the largest torque an amplitude is rounding.
_ROUNDING = 1e-9

# Shafts with a smaller share in the energy of twist are not named.
_SMALL = 0.1

# A region of instability belongs to the rule of a bend if it is that near to its natural frequency.
_NEAR = 0.1


def torsion_text(found: TorsionFigures) -> str:
    """Return all about torsional vibration as plain text, 79 wide."""
    tables = (
        ("Natural frequencies", mode_lines(found)),
        ("Critical speeds", critical_lines(found)),
        (f"Largest torque, {_range(found.speed_range)}", torque_lines(found)),
        ("Stability", stability_lines(found)),
    )
    parts = [f"{heading}\n{aligned(lines, indent='  ')}" for heading, lines in tables if lines]
    return "\n\n".join([*parts, _filled(torsion_sentences(found))])


def brief(found: TorsionBasics) -> str:
    """Return the advice on torsional vibration as plain text, 79 wide; "" if there is none."""
    lines = []
    for sentence in torsion_advice(found):
        lines += wrap(f"- {sentence}", 79, subsequent_indent="    ")
    return "\n".join(["Torsional vibration", *lines]) if lines else ""


def _filled(texts: Iterator[str]) -> str:
    return "\n".join(fill(text, 79, break_on_hyphens=False) for text in texts)


# --- tables ------------------------------------------------------------------------------------


def mode_lines(found: TorsionBasics) -> list[tuple[str, str]]:
    """Return the natural frequencies as pairs: the frequency, what is twisted and how damped.

    The percentages are shares in the energy of twist.
    """
    lines = []
    for mode in found.modes:
        shares = sorted(mode.shares, key=lambda each: each.share, reverse=True)
        shafts = [
            f"shaft {each.shaft} ({100.0 * each.share:.0f} %)"
            for each in shares
            if each.share >= _SMALL or each.shaft == mode.shaft
        ]
        twisted = listed(shafts) if len(shares) > 1 else f"shaft {mode.shaft}"
        damping = short(round(mode.damping_ratio, 9))
        lines.append((_hertz(mode.frequency), f"{twisted}, damping ratio {damping}"))
    return lines


def critical_lines(found: TorsionFigures) -> list[tuple[str, str]]:
    """Return the critical speeds as pairs: the speed, which order meets which frequency."""
    lines = []
    for critical in found.critical_speeds:
        frequency = found.modes[critical.mode].frequency
        text = f"order {critical.order} meets {_hertz(frequency)}: "
        text += _amplitude(found, critical)
        if not critical.inside:
            text += ", outside the speed range"
        lines.append((_rpm(critical.speed), text))
    return lines


def _amplitude(found: TorsionFigures, critical: CriticalSpeed) -> str:
    if critical.order % 2:
        return "the joints do not excite it"
    if critical.amplitude is None or is_unknown(critical):
        return "no periodic motion was found"
    sizes = [torque.size for torque in found.largest if math.isfinite(torque.size)]
    largest = max(sizes, default=0.0)
    size = critical.amplitude if critical.amplitude > _ROUNDING * largest else 0.0
    return f"{quantity(size, 'Nm')} of this order in shaft {critical.shaft}"


def torque_lines(found: TorsionFigures) -> list[tuple[str, str]]:
    """Return the largest torques as pairs: the shaft, its extremes, where and the mean."""
    lines = []
    for torque in found.largest:
        text = f"not limited at {_rpm(torque.speed)}, since nothing damps the resonance"
        if math.isfinite(torque.size):
            text = (
                f"{_torque(torque.least, torque)} to {_torque(torque.most, torque)} N m at "
                f"{_rpm(torque.speed)}, mean {_torque(torque.mean, torque)} N m"
            )
        lines.append((f"shaft {torque.shaft}", text))
    return lines


def _torque(value: float, of: LargestTorque) -> str:
    return figure_text(value if abs(value) > _ROUNDING * of.size else 0.0)


def stability_lines(found: TorsionFigures) -> list[tuple[str, str]]:
    """Return the regions of instability as pairs: speeds, and how fast deviations grow."""
    lines = [
        (
            _range(region),
            f"unstable, a deviation grows by up to {_percent(region.multiplier - 1.0)} per half "
            "turn",
        )
        for region in found.unstable
    ]
    lines += [(_range(part), f"not known, {part.reason}") for part in found.missing]
    return lines or [(_range(found.speed_range), "stable")]


# --- sentences ---------------------------------------------------------------------------------


def torsion_sentences(found: TorsionFigures) -> Iterator[str]:
    """Say what the torsional vibration means, the worst first."""
    yield from (_unstable(found, region) for region in found.unstable)
    yield from _reversing(found)
    yield _resonance(found)
    yield from _largest(found)
    if not found.unstable and not found.missing:
        yield "The motion is stable at all speeds of the range."
    yield from _side_by_side(found)
    for part in found.missing:
        yield f"{_between(part)} the torques are not known: {part.reason}."


def _side_by_side(found: TorsionFigures) -> Iterator[str]:
    several = [motions for motions in found.motions if motions.number > 1]
    for motions in several:
        yield (
            f"At {_rpm(motions.speed)} {motions.number} periodic motions were found, "
            f"{motions.stable or 'none'} of them stable: the largest torque of shaft "
            f"{motions.shaft} is {figure_text(motions.smallest)} to "
            f"{quantity(motions.largest, 'Nm')}."
        )
    if several:
        yield (
            "Tables and curves have one of these motions. Where several are stable, the past "
            "decides which of them occurs."
        )


def _unstable(found: TorsionFigures, region: SpeedRange) -> str:
    text = (
        f"{_between(region)} the motion of the tables is unstable: the smallest disturbance makes "
        "the shafts leave it."
    )
    rules = [
        rule
        for rule in found.rules
        if rule.exceeded
        and (1.0 - _NEAR) * region.start <= rule.speed <= (1.0 + _NEAR) * region.stop
    ]
    if rules:
        rule = max(rules, key=lambda rule: rule.factor - rule.damping_ratio)
        text += (
            f" To leading order a damping ratio of at least {rounded_up(rule.factor)} prevents "
            f"this, or an equivalent bend behind shaft {rule.shaft} of at most "
            f"{_permitted_bend(rule)} instead of {math.degrees(rule.bend):.4g}°."
        )
    return text


def _permitted_bend(rule: BendRule) -> str:
    degrees = math.degrees(2.0 * math.atan(math.sqrt(rule.damping_ratio)))
    return f"{math.floor(100.0 * degrees) / 100.0:g}°"


def _reversing(found: TorsionFigures) -> Iterator[str]:
    where = [
        f"in shaft {torque.shaft} {listed([_between(part) for part in torque.reversals]).lower()}"
        for torque in found.largest
        if torque.reversals
    ]
    if where:
        yield (
            f"The torque changes its sign in every turn, {listed(where)}: gears and splines "
            "change their flanks there and rattle."
        )


def _resonance(found: TorsionFigures) -> str:
    even = [critical for critical in found.critical_speeds if critical.order % 2 == 0]
    inside = [critical for critical in even if critical.inside]
    if not even:
        return "The joints excite even orders only, and none of these is listed."
    orders = [str(order) for order in sorted({critical.order for critical in even})]
    if not inside:
        nearest = min(even, key=lambda critical: _distance(found, critical.speed))
        return (
            f"No critical speed of order {' or '.join(orders)} lies in the range; the nearest one "
            f"is that of order {nearest.order} at {_rpm(nearest.speed)}, in which shaft "
            f"{nearest.shaft} is twisted most."
        )
    known = [critical for critical in inside if not is_unknown(critical)]
    worst = max(known or inside, key=lambda critical: critical.amplitude or 0.0)
    count = "one critical speed: that"
    if len(inside) > 1:
        count = f"{len(inside)} critical speeds; the worst is that"
    return (
        f"The range contains {count} of order {worst.order} at {_rpm(worst.speed)}, where "
        f"{_effect(found, worst)}."
    )


def _effect(found: TorsionFigures, critical: CriticalSpeed) -> str:
    if critical.amplitude is None or is_unknown(critical):
        return "no periodic motion was found"
    amplitude = _amplitude(found, critical).partition(" of this")[0]
    return f"this order of the torque of shaft {critical.shaft} is ±{amplitude}"


def _distance(found: TorsionFigures, speed: float) -> float:
    return max(float(found.speed[0]) - speed, speed - float(found.speed[-1]))


def _largest(found: TorsionFigures) -> Iterator[str]:
    if not found.largest:
        return
    torque = max(found.largest, key=lambda torque: torque.size)
    if math.isinf(torque.size):
        yield (
            f"Without damping no torque is limited at {_rpm(torque.speed)}; give damping_ratio or "
            "dampings_Nms_per_rad."
        )
        return
    mean = ""
    if abs(torque.mean) > _ROUNDING * torque.size:
        mean = f", {short(torque.size / abs(torque.mean))} times the mean torque there"
    yield (
        f"The largest torque is {quantity(torque.size, 'Nm')}, in shaft {torque.shaft} at "
        f"{_rpm(torque.speed)}{mean}."
    )


def torsion_advice(found: TorsionBasics) -> list[str]:
    """Return what a check says: critical speeds in the range and the rule of the bends."""
    advice = []
    inside = [each for each in found.critical_speeds if each.order % 2 == 0 and each.inside]
    if inside:
        several = [
            f"order {each.order} at {_rpm(each.speed)} (shaft {each.shaft})" for each in inside
        ]
        verb = "a critical speed lies" if len(inside) == 1 else "critical speeds lie"
        advice.append(
            f"{verb} within {_range(found.speed_range)}: {listed(several)}; 'cardan torsion' "
            f"computes the torques there ({RESONANCE_SOURCE})"
        )
    advice += [_rule(rule) for rule in found.rules if rule.exceeded]
    return advice


def _rule(rule: BendRule) -> str:
    where = "" if rule.inside else ", outside the speed range"
    return (
        f"the equivalent bend of {math.degrees(rule.bend):.4g}° behind shaft {rule.shaft} permits "
        f"unstable motion near {_rpm(rule.speed)}{where}, because tan²(bend/2) = "
        f"{short(rule.factor)} exceeds the damping ratio of "
        f"{short(round(rule.damping_ratio, 9))} ({RULE_SOURCE})"
    )


# --- pieces ------------------------------------------------------------------------------------


def _range(part: SpeedRange) -> str:
    start, stop = _rpm(part.start), _rpm(part.stop)
    return stop if start == stop else f"{start.partition(' ')[0]} to {stop}"


def _between(part: SpeedRange) -> str:
    start, stop = _rpm(part.start), _rpm(part.stop)
    return f"At {stop}" if start == stop else f"Between {start.partition(' ')[0]} and {stop}"


def _rpm(speed: float) -> str:
    return given(speed, "rpm")


def _hertz(frequency: float) -> str:
    return given(frequency, "Hz")


def _percent(part: float) -> str:
    return f"{100.0 * part:.3g} %"

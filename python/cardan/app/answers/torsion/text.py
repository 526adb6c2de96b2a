"""Torsional vibration of a scene in words."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

from cardan.app.answers.printed import (
    bullets,
    capital,
    given,
    in_unit,
    listed,
    plain_text,
    quantity,
)
from cardan.app.answers.torsion.figures import (
    NEGLIGIBLE,
    BendRule,
    CriticalSpeed,
    LargestTorque,
    Runaway,
    SpeedRange,
    TorsionBasics,
    TorsionFigures,
    largest_of,
    runaway_of,
)

_RESONANCE_SOURCE = "D. Thoma, 1920: joints bring new critical speeds"
_RULE_SOURCE = "first region of the Whittaker-Hill equation, one compliant shaft"

# A mean torque below this share of the largest is rounding.
_ROUNDING = 1e-9

# A damping ratio that steel shafts do not have.
_MUCH_DAMPED = 0.1

# A region of instability belongs to the rule of a bend if it is that near to its natural frequency.
_NEAR = 0.1


def brief(found: TorsionBasics) -> str:
    """Return the advice on torsional vibration as plain text, 79 wide; "" if there is none."""
    lines = bullets(torsion_advice(found), subsequent_indent="    ", break_on_hyphens=True)
    return "\n".join(["Torsional vibration", *lines]) if lines else ""


def torsion_advice(found: TorsionBasics) -> Iterator[str]:
    """Say which critical speeds are in the range, and where the rule of the bends is exceeded."""

    def moves(critical: CriticalSpeed) -> str:
        is_searched = found.torsion.is_searched
        return found.modes[critical.mode].shape if is_searched else f"shaft {critical.shaft}"

    inside = [each for each in found.resonances if not each.negligible]
    if inside:
        verb = "a critical speed lies" if len(inside) == 1 else "critical speeds lie"
        several = listed(
            [
                f"order {each.order:g} at {_rpm(each.speed)} ({moves(each)}){_size(each)}"
                for each in inside
            ]
        )
        unknown = any(each.amplitude is None for each in inside)
        more = "; 'cardan torsion' computes the torques there" if unknown else ""
        where = _ends(found.speed_range, "to")
        yield f"{verb} within {where}: {several}{more} ({_RESONANCE_SOURCE})"
    yield from _negligible(found)
    for rule in found.rules:
        if rule.exceeded:
            where = "" if rule.inside else ", outside the speed range"
            yield (
                f"the equivalent bend of {_bend(rule)} behind shaft {rule.shaft} "
                f"permits unstable motion near {_rpm(rule.speed)}{where}, because tan²(bend/2) = "
                f"{quantity(rule.factor, '', bounds=[rule.damping_ratio])} exceeds the damping "
                f"ratio of {given(rule.damping_ratio, '')} ({_RULE_SOURCE})"
            )
    yield from _avoided(found)
    if found.search:
        yield from _passed(found, largest_of(found.search))
        yield from _rattle(found, largest_of(found.search))
        yield from _runaway(found, runaway_of(found.search))
    yield from _running(found)
    yield from _held(found)
    yield from _damped(found)


def _negligible(found: TorsionBasics) -> Iterator[str]:
    """Say which critical speeds do not count, and why."""
    several = [
        f"order {each.order:g} at {_rpm(each.speed)}{_size(each)}"
        for each in found.resonances
        if each.negligible
    ]
    if several:
        verb, them = ("are", "them") if len(several) > 1 else ("is", "it")
        yield (
            f"{listed(several)} {verb} in resonance too, but below {given(NEGLIGIBLE, 'percent')} "
            f"of the mean torque of each shaft: the distance of the nearest critical speed leaves "
            f"{them} out"
        )


def _size(critical: CriticalSpeed) -> str:
    """Say how large the order of the torque is in resonance, where that is known."""
    if critical.amplitude is None:
        return ""
    return f" with ±{quantity(critical.amplitude, 'Nm')} in shaft {critical.shaft}"


def _avoided(found: TorsionBasics) -> Iterator[str]:
    """Say which speeds to avoid, and why."""
    for part in found.avoided:
        yield f"avoid {_ends(part, 'to')}: {part.reason}"
    for coupling in found.softer:
        stiffness = quantity(coupling.stiffness, "Nm_per_rad", rounds="down")
        present = quantity(coupling.present, "Nm_per_rad")
        yield (
            f"a coupling of at most {stiffness} at shaft {coupling.shaft}, instead of {present}, "
            "puts its resonance below these speeds: none is then to be avoided for its vibratory "
            "torque"
        )


def _passed(found: TorsionBasics, largest: Sequence[LargestTorque]) -> Iterator[str]:
    """Say which resonance below the speeds is large, although it is only passed."""
    most = max((torque.size for torque in largest), default=math.inf)

    def bound(critical: CriticalSpeed) -> tuple[float, str]:
        rated = found.torsion.ratings.get(critical.shaft)
        if rated and rated.largest and rated.largest < most:
            return rated.largest, "the largest torque that the coupling can carry"
        return most, "the largest torque in the speed range"

    large = [
        (critical.amplitude, critical)
        for critical in found.critical_speeds
        if critical.is_excited
        and critical.speed < found.speed_range.start
        and critical.amplitude is not None
        and critical.amplitude > bound(critical)[0]
    ]
    if not large:
        return
    amplitude, critical = max(large, key=lambda each: each[0])
    value, what = bound(critical)
    size = quantity(amplitude, "Nm", bounds=[value])
    yield (
        f"the drive passes {_rpm(critical.speed)} (order {critical.order:g}) whenever it starts: "
        f"in a steady state there this order of the torque of shaft {critical.shaft} is ±{size}, "
        f"above {what}, {quantity(value, 'Nm')}; a quick passage stays below that"
    )


def _rattle(found: TorsionBasics, largest: Sequence[LargestTorque]) -> Iterator[str]:
    """Say where the torque of shafts changes its sign, if that is not to be avoided."""
    if found.torsion.rattle is not None:
        return
    where = [
        f"in shaft {torque.shaft} {listed([_where(part) for part in torque.reversals])}"
        for torque in largest
        if torque.reversals
    ]
    if where:
        yield (
            f"the torque changes its sign in every turn, {listed(where)}: gears and splines "
            "change their flanks there and rattle"
        )


def _runaway(found: TorsionBasics, ranges: Sequence[Runaway]) -> Iterator[str]:
    """Say what torque keeps a drive from running away, and whether that of the scene does."""
    if not ranges:
        return
    where = listed([_where(part) for part in ranges])
    slope = max(part.needed_slope for part in ranges)
    needed = (
        f"a drive whose torque falls by more than {quantity(slope, 'Nms_per_rad', rounds='up')}"
    )
    if found.torsion.system.drive_slope:
        yield (
            f"{where} the speed runs away: the torque that is needed falls faster than that of the "
            f"drive, and holding every speed needs {needed} (A. Sommerfeld, 1902)"
        )
    else:
        yield (
            f"{where} the torque that is needed falls with the speed; a governor holds every "
            f"speed, and so does {needed} (A. Sommerfeld, 1902)"
        )


def _running(found: TorsionBasics) -> Iterator[str]:
    """Say at which speeds the motor of the scene runs."""
    if not found.torsion.motor:
        return
    stable = [_rpm(each.speed) for each in found.running if each.stable]
    others = [_rpm(each.speed) for each in found.running if not each.stable]
    if stable:
        yield f"the motor runs at {listed(stable)}"
    if others:
        yield f"at {listed(others)} its torque is what is needed too, but it does not stay there"
    if not found.running:
        yield "the motor runs at no speed of its curve: its torque is never what is needed"


def _held(found: TorsionBasics) -> Iterator[str]:
    """Say that the drive turns evenly, unless the scene says so itself."""
    if not found.torsion.drive:
        what = ""
        if found.without_effect:
            inertia = quantity(found.without_effect, "kgm2")
            what = f", so the inertia of {inertia} at the input end of shaft 0 has no effect"
        yield (
            f'the drive is held at constant speed{what}; drive = "held" in [torsion] says that '
            "this is meant"
        )


def _damped(found: TorsionBasics) -> Iterator[str]:
    """Say which modes the damping ratio of the lowest one damps much more than that one."""
    couplings = found.torsion.system.couplings
    lowest = min(mode.frequency for mode in found.modes)
    high = [
        mode
        for mode in found.modes
        if mode.damping_ratio > _MUCH_DAMPED
        and mode.frequency > lowest
        and not (mode.shaft in couplings and couplings[mode.shaft].loss_factor)
    ]
    if found.torsion.by_ratio and high:
        several = [
            f"{quantity(mode.damping_ratio, 'percent')} in mode {mode.number} at "
            f"{quantity(mode.frequency, 'Hz')}"
            for mode in high
        ]
        yield (
            f"the damping ratio is {listed(several)}: damping_ratio is that of the lowest mode, "
            "and viscous damping grows with the frequency; if this is too much, give "
            "dampings_Nms_per_rad, or relative_damping of a coupling"
        )


def sentences(found: TorsionFigures) -> Iterator[str]:
    """Say what the torsional vibration means, the worst first."""
    yield from (_unstable(found, region) for region in found.unstable)
    runaway, is_sloped = [*_runaway(found, found.runaway)], bool(found.torsion.system.drive_slope)
    for said in (
        *(runaway if is_sloped else ()),
        *_running(found),
        *_rattle(found, found.largest),
        *_avoided(found),
    ):
        yield f"{capital(said)}."
    yield _resonance(found)
    yield from (f"{capital(said)}." for said in _negligible(found))
    yield from (f"{capital(said)}." for said in _passed(found, found.largest))
    yield from _unknown(found)
    yield from _largest(found)
    shapes = [
        f"at {quantity(mode.frequency, 'Hz')} {mode.shape}"
        for mode in sorted(found.modes, key=lambda mode: mode.frequency)
    ]
    yield f"What vibrates: {listed(shapes)}."
    if not found.unstable and not found.missing:
        yield "The motion is stable at all speeds of the range."
    yield from _side_by_side(found)
    for missing in found.missing:
        yield f"{capital(_where(missing))} the torques are not known: {missing.reason}."
    for said in (*(() if is_sloped else runaway), *_held(found), *_damped(found)):
        yield f"{capital(said)}."


def _unstable(found: TorsionFigures, region: SpeedRange) -> str:
    text = (
        f"{capital(_where(region))} the motion of the tables is unstable: the smallest "
        "disturbance makes the shafts leave it."
    )
    low, high = (1.0 - _NEAR) * region.start, (1.0 + _NEAR) * region.stop
    rules = [rule for rule in found.rules if rule.exceeded and low <= rule.speed <= high]
    if not rules:
        return text
    rule = max(rules, key=lambda rule: rule.factor - rule.damping_ratio)
    permitted = 2.0 * math.atan(math.sqrt(rule.damping_ratio))
    return (
        f"{text} To leading order a damping ratio of at least "
        f"{quantity(rule.factor, '', rounds='up')} prevents this, or an equivalent bend behind "
        f"shaft {rule.shaft} of at most {quantity(permitted, 'deg', rounds='down')} instead of "
        f"{_bend(rule, math.degrees(permitted))}."
    )


def _resonance(found: TorsionFigures) -> str:
    excited = [critical for critical in found.critical_speeds if critical.is_excited]
    inside = found.resonances
    if not excited:
        return "The joints excite even orders only, and none of these is listed."
    if not inside:
        low, high = found.speed[0], found.speed[-1]
        nearest = min(excited, key=lambda each: max(low - each.speed, each.speed - high))
        orders = " or ".join(f"{each:g}" for each in sorted({one.order for one in excited}))
        return (
            f"No critical speed of order {orders} lies in the range; the nearest one is that of "
            f"order {nearest.order:g} at {_rpm(nearest.speed)}, in which shaft {nearest.shaft} is "
            "twisted most."
        )
    known = [critical for critical in inside if critical.amplitude is not None]
    worst = max(known or inside, key=lambda critical: critical.amplitude or 0.0)
    count = "one critical speed: that"
    if len(inside) > 1:
        count = f"{len(inside)} critical speeds; the worst is that"
    effect = "no periodic motion was found"
    if worst.amplitude is not None:
        size = quantity(worst.amplitude, "Nm")
        effect = f"this order of the torque of shaft {worst.shaft} is ±{size}"
    text = (
        f"The range contains {count} of order {worst.order:g} at {_rpm(worst.speed)}, where "
        f"{effect}."
    )
    unknown = [_rpm(critical.speed) for critical in inside if critical.amplitude is None]
    if known and unknown:
        text += f" At {listed(unknown)} no periodic motion was found."
    return text


def _unknown(found: TorsionFigures) -> Iterator[str]:
    """Say at which critical speeds outside the range the table has no amplitude."""
    several = [
        f"{_rpm(each.speed)} (order {each.order:g})"
        for each in found.critical_speeds
        if each.amplitude is None and not each.inside
    ]
    if several:
        yield f"At {listed(several)} no periodic motion was found, so the table has no amplitude."


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
        mean = f", {quantity(torque.size / abs(torque.mean), '')} times the mean torque there"
    yield (
        f"The largest torque is {quantity(torque.size, 'Nm')}, in shaft {torque.shaft} at "
        f"{_rpm(torque.speed)}{mean}."
    )


def _side_by_side(found: TorsionFigures) -> Iterator[str]:
    several = [motions for motions in found.motions if motions.number > 1]
    for motions in several:
        smallest = quantity(motions.smallest, "Nm").partition(" ")[0]
        yield (
            f"At {_rpm(motions.speed)} {motions.number} periodic motions were found, "
            f"{motions.stable or 'none'} of them stable: the largest torque of shaft "
            f"{motions.shaft} is {smallest} to {quantity(motions.largest, 'Nm')}."
        )
    if several:
        yield (
            "Tables and curves have one of these motions. Where several are stable, the past "
            "decides which of them occurs."
        )


def _where(part: SpeedRange) -> str:
    ends = _ends(part, "and")
    return f"between {ends}" if " and " in ends else f"at {ends}"


def _ends(part: SpeedRange, word: str) -> str:
    start, stop = _rpm(part.start), _rpm(part.stop)
    return stop if start == stop else f"{start.removesuffix(' rpm')} {word} {stop}"


def _bend(rule: BendRule, *apart_from_deg: float) -> str:
    bend = plain_text(math.degrees(rule.bend), "deg", apart_from=apart_from_deg)
    return in_unit([bend], "deg")


def _rpm(speed: float) -> str:
    return quantity(speed, "rpm")

"""Lateral vibration of a scene in words: what shakes, what helps, and how good the figures are."""

from __future__ import annotations

import math
from collections.abc import Iterator

from cardan.app.answers.forces.figures import length
from cardan.app.answers.lateral.figures import LateralFigures, Resonance
from cardan.app.answers.lateral.remedy import Remedy, left_with
from cardan.app.answers.lateral.vibration import ALL, KNOWN, NEAR
from cardan.app.answers.printed import bullets, capital, given, items_text, listed, quantity

_STILL = 1e-3  # of the couples, that is no excitation
_CANCELLED = 0.02  # of the force in resonance, below which statics is no measure of it
_MORE = 1.2  # of the force in other resonances, which a change should not raise
_ENDS = 0.1  # of the force, that is the end of a shudder
_MOST_DECIMALS = 9  # of a frequency that gives the speed shown


def brief(found: LateralFigures) -> str:
    """Return what a check says of lateral vibration as plain text, 79 wide."""
    return "\n".join(["Lateral vibration", *bullets(_said(found))])


def lateral_remedies(found: LateralFigures) -> list[str]:
    """Say which layout brings the bearings nearer to their limits, if these are not kept."""
    values = [value for each in found.bearings for value in (each.largest, each.displacement)]
    open_ = [each for each in values if each.limit is not None and each.verdict != "within"]
    return [f"{capital(said)}." for said in _layout(found)] if open_ else []


def sentences(found: LateralFigures) -> Iterator[str]:
    """Say what shakes the shafts, where, what helps, and what can be trusted."""
    yield from (f"{capital(said)}." for said in _said(found))
    yield from _changes(found)
    yield from _limits(found)


def _said(found: LateralFigures) -> Iterator[str]:
    """Yield the text common to the check and the whole answer."""
    for part in (_resonances, _running, _help, _verdicts, _excitation):
        yield from part(found)


def _excitation(found: LateralFigures) -> Iterator[str]:
    """Say by how much the joints bend the shafts and load the bearings twice per turn."""
    if found.why:
        yield f"the forces are not known: {found.why}"
        return
    state, one = _of_state(found), found.vibration
    most = max((max(each.bow, each.tilt) for each in found.couples), default=0.0)
    if not most:
        yield "no joint is bent under torque, so nothing bends the shafts twice per turn"
        return
    if one.statics is None and one.case.elastic:
        yield (
            "statics does not determine the forces of the bearings; those below follow from their "
            "stiffnesses"
        )
    if one.statics is not None:
        numbers = one.case.elastic or one.case.rigid_bearings
        forces = [f"bearing {i} with ±{quantity(length(one.statics[i]), 'N')}" for i in numbers]
        if forces:
            yield f"twice per turn the joints load {listed(forces)} by statics{state}"
    if one.redundant and one.case.elastic:
        yield (
            f"no shaft needs the support of {items_text('joint', one.redundant)}: statics takes "
            "the force there as 0, and with the stiffnesses of the bearings it is not; only the "
            "static forces are without it"
        )
    for each in found.couples:
        bow, tilt = (quantity(size, "Nm") for size in (each.bow, each.tilt))
        if each.bow <= _STILL * most:
            yield (
                f"the couples on shaft {each.shaft} tilt it with {tilt} twice per turn and do not "
                "bow it, so they do not excite half its critical speed"
            )
        elif each.tilt <= _STILL * most:
            yield (
                f"the couples on shaft {each.shaft} bow it with {bow} twice per turn, which "
                "excites half its critical speed, and load no bearing"
            )
        else:
            yield f"twice per turn, shaft {each.shaft} is bowed with {bow} and tilted with {tilt}"
    if one.case.tubes is not None and one.case.rigid_bearings:
        speeds = one.case.tubes.critical_speed(one.line)
        halves = [
            f"{quantity(0.5 * float(speeds[i]), 'rpm')} of shaft {shaft}"
            for i, shaft in enumerate(one.case.tubes.shafts)
        ]
        yield (
            f"order 2 meets half the critical speeds at {listed(halves)}, as [tubes] judges, and "
            "the resonance of the shafts on their bearings at a speed that only "
            "stiffness_N_per_mm of [[bearing]] tells"
        )


def _resonances(found: LateralFigures) -> Iterator[str]:
    """Say which resonances are in the range, the worst first, and what moves there."""
    inside = [each for each in found.resonances if each.inside and each.excited]
    for each in sorted(inside, key=lambda each: -(each.peak or 0.0)):
        if each.peak is not None and each.peak_speed is not None and each.moved is not None:
            peak = quantity(each.peak_speed, "rpm")
            at = "" if peak == quantity(each.speed, "rpm") else f" at {peak}"
            yield (
                f"{_met(found, each)}: {quantity(each.peak, 'N')} at bearing {each.bearing}{at}"
                f"{_times(found, each)}, where the shaft moves by "
                f"±{quantity(each.moved, 'mm', digits='small')}"
            )
        elif not each.known:
            yield f"{_met(found, each)}; {_stay_out(found, each)}"
        else:
            yield _met(found, each)
    for each in found.resonances:
        if each.inside and each.order == 1 and not each.excited:
            yield f"{_met(found, each)}; no [[lateral.unbalance]] is given"
    if found.modes and found.vibration.case.bending and not found.vibration.case.masses:
        yield "no mass of yokes is given ([[lateral.mass]]): resonances are lower with them"
    for each in found.resonances:
        bands = () if each.inside else found.vibration.bands
        if any(band.speed == each.speed for band in bands):
            yield f"{_met(found, each)}, outside the speed range; {_stay_out(found, each)}"
    if found.resonances and not inside:
        nearest, excited = "", [each for each in found.resonances if each.excited]
        if excited and found.speed_range:
            low, high = found.speed_range.start, found.speed_range.stop
            one = min(
                excited, key=lambda each: max(low - each.speed, each.speed - high) / each.speed
            )
            nearest = f"; the nearest is that of order {one.order} at {quantity(one.speed, 'rpm')}"
        yield f"no resonance of an excited order lies in the speed range{nearest}"
    elif found.modes and not found.resonances:
        yield "no order of 1, 2 and 4 meets a natural frequency near the speed range"


def _stay_out(found: LateralFigures, each: Resonance) -> str:
    """Say which band has no peak, and why."""
    met = next(met for met in found.vibration.met if met.speed == each.speed)
    band = f"{quantity(each.start, 'rpm')} to {quantity(each.stop, 'rpm')}"
    return f"its damping is {met.lack}, so stay out of {band}"


def _running(found: LateralFigures) -> Iterator[str]:
    """Say what the bearings bear at the speed of the load, if it is one speed in the range."""
    one = found.vibration
    if one.load is None or not one.case.elastic or one.load.speed.size != 1:
        return
    speed = abs(float(one.load.speed.flat[0]))
    if not one.case.speed[0] <= speed <= one.case.speed[-1]:
        return
    at = f"at {quantity(speed, 'rpm')}, the speed in [load]{_of_state(found)}"
    if any(abs(speed / each.speed - 1.0) < NEAR for each in one.bands):
        yield f"{at}, the forces are not known, because the damping of a resonance is not"
        return
    response = one.system.response([speed], one.load, orders=ALL)
    orders = response.of_order("bearing_force")[:, 0]
    largest = response.largest("bearing_force")[:, 0]
    for number, force, each in zip(one.case.elastic, largest, orders, strict=True):
        parts = [
            f"order {k} alone {quantity(x, 'N')}"
            for k, x in zip(ALL, each, strict=True)
            if k in one.excited
        ]
        said = f" ({listed(parts)})" if parts else ""
        yield f"{at}, bearing {number} bears up to {quantity(force, 'N')}{said}"


def _of_state(found: LateralFigures) -> str:
    return f", in {found.state}" if found.state else ""


def _met(found: LateralFigures, each: Resonance) -> str:
    """Say which order meets which natural frequency, at which speed, and what moves most.

    The frequency has as many digits as give the speed that is shown.
    """
    mode = next(mode for mode in found.modes if mode.number == each.mode)
    speed, rounded = quantity(each.speed, "rpm"), mode.frequency
    for decimals in range(1, _MOST_DECIMALS):
        rounded = math.tau * round(mode.frequency / math.tau, decimals)
        if quantity(rounded / each.order, "rpm") == speed:
            break
    return f"order {each.order} is in resonance at {speed} ({given(rounded, 'Hz')}, {mode.shape})"


def _times(found: LateralFigures, each: Resonance) -> str:
    """How many times the static force of order 2 the peak is."""
    statics = found.vibration.statics
    if each.order != 2 or statics is None or each.bearing is None or each.peak is None:
        return ""
    static = length(statics[each.bearing])
    # Where statics nearly cancels, the ratio says nothing.
    if _CANCELLED * each.peak > static:
        return ""
    return f", {quantity(each.peak / static, '')} times the static force"


def _verdicts(found: LateralFigures) -> Iterator[str]:
    """Say which limits are not judged, and what the torque does to stability."""
    for each in found.bearings:
        for name, value in (("force", each.largest), ("displacement", each.displacement)):
            if value.limit is not None and value.verdict == "not judged":
                what = f"the limit of the {name} of bearing {each.bearing}"
                yield f"{what} is not judged: {value.why}"
    margin = found.torque_margin
    if margin and margin.value is not None and margin.value < 4.0:
        yield (
            f"vibration of order 1 grows by itself from {quantity(margin, '')} times the torque of "
            "the load, because the torque acts like a stiffness that turns with the shaft: more "
            "damping in the bearings or stiffer ones prevent this"
        )


def _help(found: LateralFigures) -> Iterator[str]:
    """Say what each change leaves at the bearing."""
    yield from _layout(found)
    yield from _stiffness(found)


def _layout(found: LateralFigures) -> Iterator[str]:
    """Say which change of the layout helps most."""
    best, in_all = _best(found), " in all states" if found.state else ""
    if best is None:
        return
    left = f"{quantity(best.left, 'percent')} of order 2 at bearing {best.bearing}{_size(best)}"
    if best.left <= _ENDS:
        now = quantity(float(found.vibration.line.equivalent().bend), "deg")
        yield (
            f"{best.change}: this ends the shudder{in_all} and leaves {left}; the equivalent bend "
            f"is then {quantity(best.bend, 'deg')} in place of {now}{_still_unjudged(found)}"
        )
    else:
        yield f"{best.change}: this leaves {left}{in_all}, the least of what was tried"


def _still_unjudged(found: LateralFigures) -> str:
    """Say at which speeds no change makes the damping known, if a bearing has a limit."""
    has_limit = any(
        each.limit is not None for one in found.bearings for each in (one.largest, one.displacement)
    )
    low, high = (float(end) for end in found.vibration.case.speed[[0, -1]])
    bands = [each.band for each in found.vibration.bands]
    ends = sorted({(max(low, first), min(high, last)) for first, last in bands})
    ends = [(first, last) for first, last in ends if first < last]
    if not has_limit or not ends:
        return ""
    said = listed([f"{quantity(start, 'rpm')} to {quantity(stop, 'rpm')}" for start, stop in ends])
    return f"; from {said} the limit then stays not judged, as the damping there is not known"


def _best(found: LateralFigures) -> Remedy | None:
    """Return the change of the layout that ends the shudder most evenly, or leaves least of it."""
    layouts = [each for each in found.remedies if each.stiffness == 1.0]
    ends = [each for each in layouts if each.left <= _ENDS]
    if ends:
        return min(ends, key=lambda each: each.bend)
    return min(layouts, key=lambda each: each.left, default=None)


def _size(each: Remedy) -> str:
    """Say how large the force is that is left, and what a change makes worse."""
    size = "" if each.peak is None else f", {quantity(each.peak, 'N')}"
    if each.elsewhere is not None and each.elsewhere > _MORE:
        size += f", but {quantity(each.elsewhere, 'percent')} of it in another resonance"
    return size


def _stiffness(found: LateralFigures) -> Iterator[str]:
    """Say what half and twice the stiffness of a bearing do."""
    if not found.remedies:
        return
    softer, stiffer = _others(found)
    if (less := _peak(softer)) and (more := _peak(stiffer)):
        yield (
            f"half the stiffness of bearing {softer.bearing} moves the peak of order 2 to "
            f"{quantity(softer.resonance, 'rpm')}, with {less}, and twice the stiffness to "
            f"{quantity(stiffer.resonance, 'rpm')}, with {more}"
        )


def _others(found: LateralFigures) -> list[Remedy]:
    """Return the changes to half and to twice the stiffness, which are there if any change is."""
    return [each for each in found.remedies if each.stiffness != 1.0]


def _peak(each: Remedy) -> str:
    """Say what a bearing bears in resonance, and how far the shaft moves; "" if it is not known."""
    if each.peak is None or each.moved is None:
        return ""
    moved = quantity(each.moved, "mm", digits="small")
    return f"{quantity(each.peak, 'N')} at the bearing and ±{moved} of the shaft"


def _changes(found: LateralFigures) -> Iterator[str]:
    """Say what each other change of the layout leaves, and for what all of them hold."""
    best = _best(found)
    for each in found.remedies:
        if each.stiffness == 1.0 and each is not best:
            yield (
                f"{capital(each.change)}: {quantity(each.left, 'percent')} of order 2 left"
                f"{_size(each)}, equivalent bend {quantity(each.bend, 'deg')}."
            )
    if found.remedies:
        yield (
            "All changes hold for the stiffness and the masses given: try them with the least and "
            f"the largest stiffness that the rubber may have{_at_others(found)}."
        )


def _at_others(found: LateralFigures) -> str:
    """Say what the best layout leaves where the stiffness is another; "" if it is not known."""
    best, others = _best(found), _others(found)
    if best is None or found.state or not all(each.peak for each in others):
        return ""
    left = [
        f"{quantity(left_with(found.vibration, best, each), 'N')} in place of "
        f"{quantity(each.peak, 'N')}"
        for each in others
        if each.peak
    ]
    return f". At half the stiffness the first leaves {left[0]}, and at twice {left[1]}"


def _limits(found: LateralFigures) -> Iterator[str]:
    """Say what is exact, what is good to 10 % and what is only as good as the loss factor."""
    if not found.modes:
        return
    yield (
        "How good this is: couples, orders and static forces are exact for the drawn positions. "
        "Speeds of resonances are good to 10 % if each stiffness is the dynamic one under preload, "
        "with its bracket in series. Peaks are only as good as the loss factor. Below "
        f"{given(KNOWN, '')} there is a band of 16 % in place of a peak; where bearings have most "
        "of the elastic energy, theirs counts."
    )
    yield (
        f"Shafts that slide without friction, each in a free spline: {found.sliding}. Not "
        "included: engine, gearbox and axle moving on their mounts, play, and the friction of "
        "splines."
    )

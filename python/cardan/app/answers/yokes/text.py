"""How to set the yokes of a scene, in the words of a workshop, and what would fix the rest."""

from __future__ import annotations

import math
from collections.abc import Sequence

from cardan.app.answers.printed import in_unit, listed, number_text, plain_text, quantity, turn_text
from cardan.app.answers.yokes.figures import SHOWN, Advice, BendRange, ShaftSetting, YokeFigures
from cardan.app.scene.sections.driveline import SINGLE_PHASE
from cardan.design.wrapping import fill
from cardan.motion.workshop import ARROW, SAME_YOKE, VIEW

_WIDTH = 79

_ARRANGEMENTS = {
    "straight": "All joints are straight.",
    "single bend": "Only one joint is bent.",
    "W": "W arrangement: the bends lie in one plane, in the same direction.",
    "Z": "Z arrangement: the bends lie in one plane, in opposite directions.",
    "planar": "Planar arrangement: all bends lie in one plane.",
    "spatial": "Spatial arrangement: the bends lie in different planes.",
}

BEST_OF_STATES = (
    "The best setting has the least weighted mean over the states; single states may be worse than "
    "now."
)
"""Definition of the best setting over several states."""


def yoke_text(title: str, found: YokeFigures) -> str:
    """Say yoke settings in the words of a workshop."""
    tried = "On these teeth" if found.teeth else "With the best setting"
    passes = "does not pass the check" if found.above_limits else "passes the check"
    passes += " in every state" if found.states else ""
    if not found.above_limits and found.settable_deg > found.limit_deg:
        passes += ", as tolerable"
    paragraphs = [
        [title] if title else [],
        [arrangement_text(found)],
        [
            f"Set the output-side yoke of each shaft against its input-side yoke, {VIEW} "
            f"({ARROW}). {SAME_YOKE}.",
            *(f"- {words}" for words in yoke_lines(found)),
        ],
        tooth_lines(found),
        _states_table(found) if found.states else _table(found),
        [
            advice_text(found),
            f"{tried} the driveline {passes}{':' if found.above_limits else '.'}",
            *(f"- {words}" for words in found.above_limits),
        ],
        [_counted(found), f"In the scene: {text}"] if (text := phases_text(found)) else [],
    ]
    return "\n\n".join("\n".join(map(_wrapped, part)) for part in paragraphs if part)


def arrangement_text(found: Advice) -> str:
    """Name the arrangement, of states that of the worst at present."""
    words = _ARRANGEMENTS[found.arrangement]
    if found.states is None:
        return words
    name, colon, bends = words.rstrip(".").partition(":")
    return f"{name} (in {found.states.worst.present}){colon}{bends}."


def phases_text(found: Advice) -> str:
    """Return the setting as a line of a scene, on the teeth where these are known.

    A double joint alone has no yoke to set and no such line.
    """
    phases = [f"{round(shaft.phase_deg, 4) + 0.0:.7g}" for shaft in found.set_shafts]
    if found.is_double:
        return f"{SINGLE_PHASE} = {phases[1]}" if len(phases) > 1 else ""
    return f"phases_deg = [{', '.join(phases)}]"


def _counted(found: Advice) -> str:
    key = SINGLE_PHASE if found.is_double else "phases_deg"
    return (
        f"{key} counts clockwise from yokes in one plane, not from the best setting: a yoke 6° off "
        "has the best value plus or minus 6."
    )


def yoke_lines(found: Advice) -> list[str]:
    """Say the setting of each shaft, one line per shaft."""
    return [
        f"shaft {shaft.shaft}: {_setting(found, shaft)}; "
        + ("nothing to turn" if shaft.turn_deg < SHOWN else f"turn it {_turn_text(found, shaft)}")
        for shaft in found.shafts
    ]


def tooth_lines(found: Advice) -> list[str]:
    """Say what the teeth cost, and on which tooth to set each shaft; nothing without teeth."""
    if not found.teeth:
        return []
    lines = ["On the splines:"]
    # Over several states teeth cost something in one and gain it in another.
    if found.states is None:
        cost = quantity(math.radians(found.settable_deg - found.equivalent_bend_deg.best), "deg")
        lines = [f"On the splines, whose teeth cost {cost} of equivalent bend:"]
    for tooth in found.teeth:
        change = f"turn it {_turn_text(found, tooth)}" if tooth.turn_teeth else "nothing to turn"
        spline = "cannot be turned" if (tooth.teeth or 0) < 3 else f"{tooth.teeth} teeth"
        lines.append(f"- shaft {tooth.shaft} ({spline}): {_setting(found, tooth)}; {change}")
    return lines


def _table(found: YokeFigures) -> list[str]:
    """The equivalent bend of each setting, exactly and by the root rule, as aligned columns."""
    bends, rules = found.equivalent_bend_deg, found.catalogue
    columns = [("now", bends.present, rules.present), ("best", bends.best, rules.best)]
    if bends.on_teeth is not None and rules.on_teeth:
        columns.append(("on teeth", bends.on_teeth, rules.on_teeth))
    rows = [
        ("", *(name for name, _, _ in columns)),
        ("Equivalent bend", *(bend_text(found, bend) for _, bend, _ in columns)),
        (
            "Catalogue's root rule",
            *(bend_text(found, rule.equivalent_bend_deg) for _, _, rule in columns),
        ),
        (
            "  its fork signs",
            *(" ".join("+-"[sign < 0] for sign in rule.fork_signs) for _, _, rule in columns),
        ),
        (
            "  yokes off these by",
            *(in_unit([number_text(rule.off_deg, "phase")], "deg") for _, _, rule in columns),
        ),
    ]
    return _columns(rows)


def _states_table(found: Advice) -> list[str]:
    """The equivalent bend of each state with each setting, as aligned columns."""
    assert found.states
    bends = found.states.equivalent_bend_deg
    columns = [("now", bends.present), ("best", bends.best), ("on teeth", bends.on_teeth)]
    known = [(name, values) for name, values in columns if values]
    rows = [("Equivalent bend", *(name for name, _ in known))]
    for i, name in enumerate(found.states.names):
        rows.append((f"  {name}", *(bend_text(found, values[i]) for _, values in known)))
    return [*_columns(rows), "", BEST_OF_STATES]


def _columns(rows: Sequence[Sequence[str]]) -> list[str]:
    width = max(24, *(len(label) + 2 for label, *_ in rows))
    return [f"{label:{width}}" + "".join(f"{cell:>12}" for cell in cells) for label, *cells in rows]


def bend_text(found: Advice, bend_deg: float) -> str:
    """Write an equivalent bend, told apart from its limit."""
    bend = number_text(bend_deg, "deg", apart_from=[found.limit_deg])
    return in_unit([bend], "deg")


def _limit(found: Advice) -> str:
    return in_unit([number_text(found.limit_deg, "given")], "deg")


def _setting(found: Advice, shaft: ShaftSetting) -> str:
    if shaft.setting_deg < SHOWN:
        return "in one plane"
    return turn_text(_phase(found, shaft.setting_deg), shaft.sense)


def _phase(found: Advice, degrees: float) -> str:
    """A turn of a yoke with the decimals that the limit needs."""
    return number_text(degrees, "phase", least=found.decimals)


def _turn_text(found: Advice, shaft: ShaftSetting) -> str:
    """How to turn a yoke; the other way round too where that is not much longer."""
    turn = _phase(found, shaft.turn_deg)
    if shaft.turn_teeth:
        teeth = "tooth" if shaft.turn_teeth == 1 else "teeth"
        return f"{shaft.turn_teeth} {teeth} {shaft.turn_sense} ({turn}°)"
    if shaft.turn_deg <= 45.0:
        return f"{turn}° {shaft.turn_sense}"
    return turn_text(turn, shaft.turn_sense).replace(" = ", " or ")


def _wrapped(line: str) -> str:
    # The columns of the table are narrow, and a line of a scene stays one line.
    if line.startswith(("In the scene", " ")) or len(line) <= _WIDTH:
        return line
    indent = "  " if line.startswith("- ") else ""
    return fill(
        line, _WIDTH, subsequent_indent=indent, break_on_hyphens=False, break_long_words=False
    )


# --- what would fix the rest ---------------------------------------------------------------------


def advice_text(found: Advice) -> str:
    """Say what is left at best, on the teeth where these are known, and what would fix it."""
    limit, bends = f"the limit of {_limit(found)}", found.equivalent_bend_deg
    if found.states:
        return _states_advice_text(found, limit)
    present = bend_text(found, bends.present)
    settable = bend_text(found, found.settable_deg)
    if found.cause == "bends":
        return " ".join(remedies(found))
    if found.cause == "none" and not found.turned:
        return f"The yokes have their best setting; nothing to turn. {present} is within {limit}."
    if found.cause == "none":
        leaves = "setting leaves" if bends.on_teeth is None else "teeth leave"
        return (
            f"Nothing has to be turned: {present} is within {limit}. The best {leaves} {settable}."
        )
    cause = f"The phases are the cause: {present} is beyond {limit}."
    if found.settable_deg > found.limit_deg:
        best = bend_text(found, bends.best)
        return f"{cause} The exact setting leaves {best}, but no teeth bring it within the limit."
    which = listed([f"shaft {shaft.shaft}" for shaft in found.turned])
    return (
        f"{cause} Turn the output-side yoke of {which} as said above: {settable} is within "
        "the limit."
    )


def remedies(found: Advice) -> list[str]:
    """Say what would bring a driveline within its limit, a sentence each; nothing if it is."""
    if found.cause == "none":
        return []
    if found.states:
        return _states_remedies(found)
    settable = bend_text(found, found.settable_deg)
    best = bend_text(found, found.equivalent_bend_deg.best)
    if found.cause == "phases" and found.settable_deg > found.limit_deg:
        return [
            f"No teeth of the splines bring it within the limit of {_limit(found)}: the "
            f"best teeth leave {settable}. The exact setting would leave {best}."
        ]
    if found.cause == "phases":
        return [f"{_turns(found)}; that leaves {settable}."]
    return [_too_different(found), _of_pivot(found) if found.is_double else _changes(found)]


def improvement(found: Advice) -> str:
    """Say what the best setting makes of a driveline beyond its limit; "" if it makes no better."""
    present, left = (
        bend_text(found, bend) for bend in (found.equivalent_bend_deg.present, found.settable_deg)
    )
    no_better = found.settable_deg >= found.equivalent_bend_deg.present
    if found.cause == "none" or no_better or present == left:
        return ""
    verdict = "within" if keeps_limit(found) else "still beyond"
    return (
        f"The best setting of the yokes, as 'cardan phase' shows it, leaves an equivalent bend of "
        f"{left} in place of {present}, {verdict} the limit of {_limit(found)}."
    )


def keeps_limit(found: Advice) -> bool:
    """Whether the best setting that can be made is within the limit of the equivalent bend."""
    return found.settable_deg <= found.limit_deg


def _turns(found: Advice) -> str:
    turns = ", of ".join(
        f"shaft {shaft.shaft} by {_turn_text(found, shaft)}" for shaft in found.turned
    )
    return f"Turn the output-side yoke of {turns}, {VIEW}"


def _at_most(found: Advice) -> str:
    """Say the largest bend left over the states, and in which of them."""
    assert found.states
    worst = found.states.worst
    return f"{bend_text(found, found.settable_deg)} in {worst.on_teeth or worst.best}"


def _states_advice_text(found: Advice, limit: str) -> str:
    assert found.states
    verdict = "within" if found.cause == "none" else "beyond"
    now = f"{bend_text(found, found.equivalent_bend_deg.present)} in {found.states.worst.present}"
    now = f"The largest equivalent bend of all states is {now}, {verdict} {limit}."
    if not found.turned:
        return f"{now} The yokes have the best common setting."
    left = f"The best common setting leaves at most {_at_most(found)}"
    if verdict == "within":
        return f"{now} Nothing has to be turned. {left}."
    within = "within" if found.settable_deg <= found.limit_deg else "beyond"
    return f"{now} {left}, {within} the limit."


def _states_remedies(found: Advice) -> list[str]:
    assert found.states
    if found.settable_deg <= found.limit_deg:
        return [f"{_turns(found)}; that leaves at most {_at_most(found)}."]
    if not found.shafts:
        return ["A single joint cannot cancel its own unevenness; add a second joint."]
    states, said, where = found.states, list[str](), found.states.worst.present
    # Of a double joint alone no yoke can be set.
    can_be_set = len(found.shafts) > found.is_double
    if can_be_set and found.settable_deg <= found.equivalent_bend_deg.present:
        mean = "weighted mean" if len(set(states.weights)) > 1 else "mean"
        where = "that state"
        said = [
            f"Even the best common setting of the yokes, with the least {mean} over the states, "
            f"leaves {_at_most(found)}, beyond the limit of {_limit(found)}.",
            "Giving that state more weight in [states] improves it at the expense of the others.",
        ]
    nearer = f"Bring the bends of the joints nearer to each other in {where}."
    return [" ".join([*said, _of_pivot(found) if found.is_double else nearer])]


def _too_different(found: Advice) -> str:
    """Say why the bends do not cancel, and what the best setting leaves of them."""
    bent = _bent(found)
    if not found.shafts:
        return "A single joint cannot cancel its own unevenness."
    largest = _largest(found)
    why = (
        f"Joint {largest.joint} is bent by {_bend(largest)}, more than the other joints can cancel"
    )
    if len(bent) == 1:
        why = "One bend alone cannot cancel"
    elif len(bent) == 2:
        why = f"The bends differ ({' and '.join(map(_bend, bent))})"
    bends = found.equivalent_bend_deg
    present, best = bend_text(found, bends.present), bend_text(found, bends.best)
    left = f"the best one leaves {best} in place of {present}"
    if present == best:
        left = f"the present one is the best and leaves {best}"
    return f"{why}, so no setting of the yokes is enough: {left}."


def _of_pivot(found: Advice) -> str:
    """Say where the pivot of a double joint leaves the least."""
    sets = "The place of the pivot sets both bends of the double joint:"
    if found.pivot is None:
        return f"{sets} change synchronous_deg in the states."
    value = in_unit([number_text(found.pivot.synchronous_deg, "given")], "deg")
    left = bend_text(found, found.pivot.equivalent_bend_deg)
    most = "at most " if found.states else ""
    then = " with the yokes set anew" if len(found.shafts) > 1 else ""
    said = f"{sets} a synchronous_deg of {value} leaves {most}{left}{then}."
    rest = found.pivot.equivalent_bend_deg
    if rest > found.limit_deg and found.straight and found.straight.equivalent_bend_deg < rest:
        left = bend_text(found, found.straight.equivalent_bend_deg)
        value = in_unit([number_text(found.straight.synchronous_deg, "given")], "deg")
        said += f" With a straight single joint, {value} would leave {most}{left}."
    return said


def _changes(found: Advice) -> str:
    """Say which bends would do: either of two, of more the largest; for one alone a second one.

    Figures are rounded into the range, so that they do what they promise.
    """
    bent = _bent(found)
    straight = [joint for joint in found.bend_ranges if joint not in bent]
    changed = {1: [*bent, *straight[:1]], 2: bent}.get(len(bent), [_largest(found)])
    changes = ", or ".join(f"joint {joint.joint} a bend of {_range(joint)}" for joint in changed)
    then = "; then set the yokes anew"
    if not found.shafts:
        then = ", or add a second joint with the same bend"
    return f"To come within the limit of {_limit(found)}, give {changes}{then}."


def _bent(found: Advice) -> list[BendRange]:
    return [joint for joint in found.bend_ranges if joint.bend_deg >= SHOWN]


def _bend(joint: BendRange) -> str:
    """A bend, which mostly someone gave, without zeros at its end."""
    ends = (joint.from_deg, joint.to_deg)
    return in_unit([plain_text(joint.bend_deg, "deg", apart_from=ends)], "deg")


def _largest(found: Advice) -> BendRange:
    return max(found.bend_ranges, key=lambda joint: joint.bend_deg)


def _range(joint: BendRange) -> str:
    most = number_text(joint.to_deg, "deg", rounds="down")
    if joint.from_deg < SHOWN:
        return f"at most {in_unit([most], 'deg')}"
    return in_unit([number_text(joint.from_deg, "deg", rounds="up"), most], "deg", " to ")

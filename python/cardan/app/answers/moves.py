"""The smallest single changes that bring everything about a scene's machine within its limits."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from typing import Any, Literal

import numpy as np

from cardan.app.answers.answer import Answer, JudgedFigure
from cardan.app.answers.names import kind_name, point_name
from cardan.app.answers.printed import given, number_text, quantity, symbol_of, turn_text
from cardan.app.answers.readings import share_within
from cardan.app.answers.rows import UNITS, count, figure, optional, word
from cardan.app.scene.language.units import shown_unit
from cardan.app.scene.machine import machine_of, moving, rules_of
from cardan.app.scene.scene import Scene
from cardan.app.scene.sections.driveline import FEET, READINGS, has_lengths
from cardan.design.limits import PRESETS
from cardan.design.machine import Change, Machine
from cardan.design.quantities import MOTION_QUANTITIES

# Points, bearings and the engaged length are tried up to this share of the length of the driveline.
_REACH = 0.05

_TRIED = ("limits", "states", "forces", "spline", "steering", "backlash", "life", "tubes")
"""The parts of an answer that a machine has."""

# Their figures that it does not have: its heat is that of each step, its tubes have no half of a
# critical speed and do not vibrate.
_UNTRIED = ("heat", "of_sizes", "half", "vibrating_stress")

# How much further than needed a shaft is tilted to find what is certain, over what the gauge hides.
_FURTHER = np.arange(1, 13) / 2.0

Variable = Literal["point", "phase", "bearing", "engaged", "rating"]


@dataclass(frozen=True)
class Move:
    """One change of the machine and what it leaves; ``None`` where another variable changes."""

    variable: Variable = word("variable", "what changes")
    number: int = count("number", "of the point from upstream, of the shaft, bearing or joint")
    of: str = word("of", "the same in words")
    axis: str | None = word("axis", "of a point: x, y or z, or up of readings")
    shift: float | None = figure("by", "mm", "of a point, a bearing or the engaged length")
    turn: float | None = figure("turned by", "deg", "of the output-side yoke of a shaft")
    teeth: int | None = optional(count("teeth", "the same, where its spline has teeth"))
    tilt: float | None = figure(
        "tilted by", "deg", "of an end shaft as an inclinometer shows it, upwards to the output"
    )
    certain: float | None = figure(
        "certain from",
        "deg",
        "tilt that keeps every limit whatever the gauge may hide; null where none was found",
    )
    likeliest: float | None = figure(
        "likeliest", "deg", "tilt that keeps every limit for the largest share, if none is certain"
    )
    share: float | None = figure(
        "share within", "percent", "of what the gauge may hide, with that tilt", digits="share"
    )
    gauge: float | None = figure("gauge", "deg", "by which each reading may be off")
    rating: float | None = figure("rating", "Nm", "of a joint, in place of the one it has")
    verdict: str = word("verdict then")
    left: str | None = word("what is then worst")
    untried: str = word("not tried", "what else has a limit, which this search leaves out")
    # The same with what each of them is now, unless it is within its limit.
    left_out: str = field(kw_only=True)
    # Distance in m between the feet of what is tilted.
    feet: float | None = field(kw_only=True, default=None)


def find(answer: Answer) -> tuple[Move, ...]:
    """Return the changes, smallest first; none where everything is within its limits."""
    machine = machine_of(answer.scene, can_tilt=True)
    if machine is None:
        return ()
    scene = answer.scene
    found = machine.suggest(**search(scene))
    untried = {each.name: each for each in untried_of(answer)}
    left_out = ", ".join(map(_as_it_is, untried.values()))
    held = held_in(scene)
    moves: Iterator[Move] = (
        _move(change, scene, ", ".join(untried), left_out)
        for change in found
        if (change.variable, change.item) not in held
    )
    if scene.is_measured:
        moves = _in_workshop(moves, machine, scene)
    return tuple(moves)


def is_tried(each: JudgedFigure) -> bool:
    """Return whether the search computes a figure, so that its changes keep the limit."""
    return each.part.name in _TRIED and each.entry.path.rpartition(".")[2] not in _UNTRIED


def untried_of(answer: Answer) -> Iterator[JudgedFigure]:
    """Yield the figures with a limit that the changes of the search need not keep."""
    for each in answer.judged:
        is_kept = is_tried(each) or _is_implied(each, answer.scene)
        if each.value.limit is not None and not is_kept:
            yield each


def _as_it_is(each: JudgedFigure) -> str:
    """A figure that the search leaves out, with its verdict and where the answer says more."""
    words = {"beyond": "beyond its limit", "tolerable": "above its limit"}
    now = (words | {"not judged": "not judged"}).get(each.value.verdict)
    return f'{each.name} ({now}: see "{each.part.title}")' if now else each.name


def _is_implied(each: JudgedFigure, scene: Scene) -> bool:
    """Whether a published limit is kept where the machine keeps the strictest of its kind."""
    part, _, rest = each.entry.path.partition(".")
    if part != "presets":
        return False
    preset, last = rest.partition(".")[0], rest.rpartition(".")[2]
    kind = {"bend": "bend", "difference": "bend_difference"}.get(last)
    if kind not in rules_of(scene):
        return False
    figure = rules_of(scene)[kind][1].figure
    return any(rule.holds_always for rule in PRESETS[preset].rules if rule.figure == figure)


def search(scene: Scene) -> dict[str, Any]:
    """Return how far the search goes in a scene, the arguments of ``Machine.suggest``."""
    joints = scene.sizes
    # Its shafts then have one metre each, see machine_of.
    unknown = scene.line.n_joints + 1.0 if scene.is_measured else 0.0
    sizes = [size.rating for size in joints.table if size.rating] if joints else []
    return {
        "reach": _REACH * (float(np.sum(scene.line._geometry.lengths)) or unknown),
        "teeth": scene.teeth,
        "ratings": sorted(set(sizes)),
    }


def held_in(scene: Scene) -> set[tuple[str, int]]:
    """Return variables and items that no change of the drawing reaches.

    The states set them, or they are the yokes of the middle piece of a double joint.
    """
    # A change of the drawing turns with what a state turns.
    found = set(scene.states.turned) if scene.states else set()
    if scene.is_double:
        found.add(("phase", 1))
    if scene.states and scene.states.set_phases:
        found |= {("phase", shaft) for shaft in range(scene.line.n_joints)}
    return found


def _in_workshop(moves: Iterable[Move], machine: Machine, scene: Scene) -> Iterator[Move]:
    """Yield the moves that shims and spacers can make: none sideways or along the shaft."""
    line = machine.states[0]
    last = line.n_joints
    lengths, rises = line.lengths().each, np.arcsin(line.directions[:, 1])
    gauge = None if scene.gauge_deg is None else math.radians(scene.gauge_deg)
    feet = scene.feet_apart or (None, None)
    for move in moves:
        move = replace(move, gauge=gauge)
        if move.variable != "point" or move.shift is None:
            yield move
        elif move.axis == "y" and move.number in (0, last + 1):
            shaft = min(move.number, last)
            if feet[-1 if shaft else 0] == 0.0:
                continue
            shift = move.shift if shaft else -move.shift
            rise = lengths[shaft] * np.sin(rises[shaft]) + shift
            level = lengths[shaft] * np.cos(rises[shaft])
            tilt = float(np.arctan2(rise, level) - rises[shaft])
            if move.verdict == "within":
                tilt = _least_tilt(scene, shaft, tilt)
                move = _likeliest(move, scene, shaft, tilt)
            move = replace(move, feet=feet[-1 if shaft else 0])
            yield replace(move, of=f"shaft {shaft}", axis=None, shift=None, tilt=tilt)
        elif move.axis == "y" and has_lengths(scene.line):
            # A spacer at a joint beside an end shaft tilts what bears that shaft.
            ends = {1: feet[0], last: feet[-1]}
            if ends.get(move.number) != 0.0:
                yield replace(move, axis="up")


def _least_tilt(scene: Scene, shaft: int, near: float) -> float:
    """The least tilt that suffices; a point that moves tilts its shaft less where that slopes."""
    assert scene.layout is not None
    path, read = f"{READINGS}.{shaft}", scene.layout.driveline[READINGS][shaft]
    load = scene.states.loads(scene.load_case) if scene.states else scene.load_case

    def suffices(tilt: float) -> bool:
        lines = scene.drivelines({path: read + math.degrees(tilt)})
        judged = (one for one in moving(scene, lines, load).figures() if not np.isnan(one.limit))
        return all(one.verdict == "within" for one in judged)

    short, enough = 0.9 * near, 1.1 * near
    if scene.states and any(axis.key == path for axis in scene.states.axes):
        return near
    if not suffices(enough):
        return near
    for _ in range(40):
        middle = 0.5 * (short + enough)
        short, enough = (short, middle) if suffices(middle) else (middle, enough)
    return enough


def _likeliest(move: Move, scene: Scene, shaft: int, least: float) -> Move:
    """The move with the first of some larger tilts that is certain, or with the likeliest."""
    found = move
    if scene.gauge_deg is None:
        return found
    tilts = np.zeros(scene.line.n_joints + 1)
    for further in _FURTHER:
        tilts[shaft] = math.degrees(least) + math.copysign(further * scene.gauge_deg, least)
        try:
            share = share_within(scene, tilts)
        except ValueError:
            # The gauge would hide a shaft that stands upright.
            break
        tilt = math.radians(tilts[shaft])
        if share == 1.0:
            return replace(move, certain=tilt)
        if share > (found.share or 0.0):
            found = replace(move, likeliest=tilt, share=share)
    return found


def _move(change: Change, scene: Scene, untried: str, left_out: str) -> Move:
    by, teeth = change.change, 0
    if change.variable == "phase" and scene.teeth:
        teeth = round(abs(by) / math.tau * scene.teeth[change.item - 1])
    return Move(
        change.variable,
        change.item,
        _of(change, scene.line.n_joints),
        None if change.axis is None else "xyz"[change.axis],
        by if change.variable in ("point", "bearing", "engaged") else None,
        by if change.variable == "phase" else None,
        teeth or None,
        None,
        None,
        None,
        None,
        None,
        change.end if change.variable == "rating" else None,
        change.verdict,
        None
        if change.worst is None or change.verdict == "within"
        else kind_name(change.worst.kind.name),
        untried,
        left_out=left_out,
    )


def _of(change: Change, joints: int) -> str:
    if change.variable == "point":
        return point_name(change.item, joints)
    whose = {"phase": "shaft", "bearing": "bearing", "engaged": "the spline of shaft"}
    return f"{whose.get(change.variable, 'joint')} {change.item}"


def _shim(tilt: float, feet: float | None) -> tuple[str, str]:
    """The thickness of a shim, and the length between the feet that it is for if that is open."""
    long = shown_unit("m")
    apart = 1.0 / UNITS[long].factor if feet is None else feet
    thick = quantity(math.tan(abs(tilt)) * apart, "mm", rounds="up")
    return thick, symbol_of(long) if feet is None else ""


# More are not read.
_MOST = 5


def sentences(found: Iterable[Move]) -> Iterator[str]:
    """Say each of the smallest changes, one of a yoke among them, and what they leave."""
    moves = [*found]
    shown = moves[:_MOST]
    turns = [move for move in moves if move.turn is not None]
    if turns and turns[0] not in shown:
        shown[-1] = turns[0]
    for move in shown:
        then = f"everything {'tried ' if move.untried else ''}is then within its limits"
        if further := move.certain or move.likeliest:
            thick, per = _shim(further, move.feet)
            then += f", and with {quantity(abs(further), 'deg')}, a shim of {thick}"
            then += f" per {per}, " if per else ", "
            hidden = "what the gauge may hide"
            if move.share:
                share = quantity(move.share, "percent", digits="share")
                then += f"for {share} of {hidden}; no tilt tried is certain"
            else:
                then += hidden.replace("what", "whatever")
        if move.verdict != "within":
            then = f"this helps most; the {move.left} is then still {move.verdict}"
        yield f"{_change(move)}: {then}."
    if left_out := next((move.left_out for move in shown if move.verdict == "within"), ""):
        yield f"Not tried with {'this change' if len(shown) == 1 else 'these changes'}: {left_out}."
    if any(move.tilt is not None and move.feet is None for move in shown):
        yield (
            f"The distance between the feet, {FEET} in [driveline], gives the thickness of each "
            "shim."
        )
    if any(move.tilt is not None for move in shown):
        yield "A shim is computed for a joint that stays where it is."
    if any(move.axis == "up" for move in shown):
        yield "A spacer at a joint tilts the shafts on both sides of it."
    edges = [
        move for move in shown if move.verdict == "within" and not (move.certain or move.likeliest)
    ]
    if gauge := next((move.gauge for move in edges if move.gauge), None):
        yield (
            "A change without a second value leads just to the edge of the limits, and the gauge "
            f"may hide {given(gauge, 'deg')} of each reading: go further and read again."
        )


def several_at_once(answer: Answer) -> list[str]:
    """Say how to search for several changes that bring the motion within its limits together.

    The lines behind the sentence are a section of the scene.
    """
    scene = answer.scene
    wrong = {
        each.entry.path.rpartition(".")[2]
        for each in answer.judged
        if each.part.name == "limits" and each.value.verdict in ("beyond", "tolerable")
    }
    sought = [name for name in MOTION_QUANTITIES if name in wrong]
    if not sought or scene.layout is None or (scene.study is not None and scene.study.axes):
        return []
    if scene.optimisation is not None:
        return ["Several changes at once may suffice: 'cardan optimise' finds those of [optimise]."]
    # Its search is imported by the answers that advise one.
    from cardan.app.scene.study.optimisation import proposed

    given = scene.given.get("driveline", {})
    ranges = proposed(scene.layout, scene.states, scene.teeth, given)
    if len(ranges) < 2:
        return []
    lines = [
        f"vary.{path} = [{ends[0]:g}, {ends[1]:g}]" if ends else f'vary.{path} = "free"'
        for path, ends in ranges.items()
    ]
    # The torsional excitation is least with the equivalent bend.
    if not {"equivalent_bend", "torsional_excitation"} & wrong:
        lines.append('minimise = "inertia_excitation"')
    text = "Several changes at once may suffice: add this to the scene and run 'cardan optimise'."
    return ["\n    ".join([text, "[optimise]", *lines])]


def _change(move: Move) -> str:
    if move.turn is not None:
        sense = "clockwise" if move.turn > 0.0 else "counter-clockwise"
        turn = turn_text(number_text(abs(math.degrees(move.turn)), "phase", rounds="up"), sense)
        if move.teeth:
            turn = f"{move.teeth} {'tooth' if move.teeth == 1 else 'teeth'} ({turn})"
        return f"Turn the output-side yoke of {move.of} by {turn}"
    if move.tilt is not None:
        way = "up" if move.tilt > 0.0 else "down"
        by = quantity(abs(move.tilt), "deg", rounds="up")
        thick, per = _shim(move.tilt, move.feet)
        shim = f"a shim, {thick} thick per {per} between the feet"
        if move.feet is not None:
            side = "nearer to" if (move.tilt > 0.0) == (move.number == 0) else "farther from"
            joint = max(move.number - 2, 0)
            shim = f"shims, {thick} thick, that raise the feet {side} joint {joint}"
        return f"Tilt {move.of} {way} towards the output by {by} with {shim}"
    if move.rating is not None:
        return f"Choose a rating of {given(move.rating, 'Nm')} for {move.of}"
    assert move.shift is not None
    by = quantity(abs(move.shift), "mm", rounds="up")
    if move.axis == "up":
        way = "Raise" if move.shift > 0.0 else "Lower"
        return f"{way} {move.of} by {by} with a spacer"
    if move.axis is not None:
        sign = "+" if move.shift > 0.0 else "\N{MINUS SIGN}"
        return f"Move {move.of} by {by} along {sign}{move.axis}"
    if move.variable == "bearing":
        return f"Move {move.of} by {by} {'down' if move.shift > 0.0 else 'up'}stream"
    more = "more" if move.shift > 0.0 else "less"
    return f"Make {move.of} engage {by} {more} where it is drawn"

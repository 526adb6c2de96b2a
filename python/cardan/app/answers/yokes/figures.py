"""How to set the yokes of a scene, what that does for it, and what would fix the rest."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, NamedTuple, TypeVar, get_args

import numpy as np

from cardan.app.answers.limits import motion_of
from cardan.app.answers.over import check_states
from cardan.app.answers.printed import judged_text
from cardan.app.answers.rounding import ROUNDING, equivalent_bend_deg
from cardan.app.answers.rows import (
    DIGITS,
    Judged,
    count,
    entries,
    figure,
    item,
    numbers,
    optional,
    parts,
    word,
)
from cardan.app.scene.scene import Scene
from cardan.app.scene.sections.driveline import SINGLE_BEND, SYNCHRONOUS
from cardan.app.scene.study.states import States
from cardan.arrays import FloatArray
from cardan.design.limits import MAX_EQUIVALENT_BEND
from cardan.driveline import Driveline
from cardan.motion.phases import Arrangement
from cardan.motion.workshop import VIEW, turn

SHOWN = 0.005
"""Less than this, in degrees, is nothing to turn."""

# A synchronous bend in degrees lies below it.
_MOST_SYNCHRONOUS = 120.0

# Of a phase: no yoke is set more exactly.
_MOST_DECIMALS = 4

Sense = Literal["none", "clockwise", "counter-clockwise"]
_T = TypeVar("_T")


@dataclass(frozen=True)
class Bends:
    """The equivalent bend with each setting, over states the largest."""

    present: float = figure("now")
    best: float = figure("best")
    on_teeth: float | None = optional(figure("on teeth"))


@dataclass(frozen=True)
class BendsOfStates:
    """The equivalent bend of each state with each setting."""

    present: tuple[float, ...] = numbers("now")
    best: tuple[float, ...] = numbers("best")
    on_teeth: tuple[float, ...] = optional(numbers("on teeth"))


@dataclass(frozen=True)
class WorstStates:
    """The state in which the equivalent bend is largest with each setting."""

    present: str = word("now")
    best: str = word("best")
    on_teeth: str = optional(word("on teeth"))


@dataclass(frozen=True)
class OverStates:
    """Effect of one setting in each state."""

    names: tuple[str, ...] = word("names")
    weights: tuple[float, ...] = numbers("weights")
    equivalent_bend_deg: BendsOfStates = parts("equivalent bend")
    worst: WorstStates = parts("worst", "the states in which the equivalent bend is largest")


@dataclass(frozen=True)
class ShaftSetting:
    """How to set the output-side yoke of a shaft against its input-side yoke."""

    shaft: int = item("shaft")
    teeth: int | None = optional(count("teeth", "of its spline"))
    turn_teeth: int | None = optional(
        count("teeth to turn", "by how many to turn the yoke from where it is")
    )
    turn_deg: float = figure("turn", "", "how far to turn the yoke from where it is")
    turn_sense: Sense = word("sense of the turn")
    turn_other_sense_deg: float = figure("turn", "", "the same turn the other way round")
    phase_deg: float = figure("phase", "", "within ±90")
    setting_deg: float = figure("setting", "", "the phase without its sign")
    sense: Sense = word("sense of the setting")
    setting_other_sense_deg: float = figure("setting", "", "the same setting the other way round")


@dataclass(frozen=True)
class BendRange:
    """The bends of a joint with which the best setting is within the limit, the others as is."""

    joint: int = item("joint")
    bend_deg: float = figure("bend", "", "as it is")
    from_deg: float = figure("least bend")
    to_deg: float = figure("largest bend")


@dataclass(frozen=True)
class RootRule:
    """A setting by the catalogues' root rule."""

    fork_signs: tuple[int, ...] = word(
        "fork signs", "+1 or -1 of each joint, for Driveline.catalogue_bend"
    )
    equivalent_bend_deg: float = figure("equivalent bend")
    off_deg: float = figure(
        "off",
        "",
        "how far the yokes are at most from the position, aligned or crossed, for which the rule "
        "is meant",
    )


@dataclass(frozen=True)
class RootRules:
    """The root rule for each setting, over states in the worst of each."""

    present: RootRule = parts("now")
    best: RootRule = parts("best")
    on_teeth: RootRule | None = optional(parts("on teeth"))


class Pivot(NamedTuple):
    """A place of the pivot of a double joint, with the yokes behind it set for it."""

    equivalent_bend_deg: float  # over states the largest
    synchronous_deg: float


@dataclass(frozen=True)
class Advice:
    """Effect of setting the yokes, and the cause of the rest; angles are in degrees."""

    arrangement: Arrangement = word("arrangement", "over states that of the worst one at present")
    cause: Literal["none", "phases", "bends"] = word(
        "cause",
        "why the equivalent bend is beyond its limit: none if it is not, phases if the best "
        "setting is within it, bends if no setting is",
    )
    limit_deg: float = figure("limit", "", "of the equivalent bend")
    equivalent_bend_deg: Bends = parts("equivalent bend", "over states the largest")
    shafts: tuple[ShaftSetting, ...] = parts("best setting")
    bend_ranges: tuple[BendRange, ...] = parts("bends", "none of several states")
    states: OverStates | None = optional(parts("states"))
    teeth: tuple[ShaftSetting, ...] = parts("on teeth", "the best setting on the splines, if known")
    # Of the phases in degrees, with which the best setting keeps a limit that it can keep.
    decimals: int = field(kw_only=True)
    # Whether joints 0 and 1 are a centred double joint.
    is_double: bool = field(kw_only=True)
    # Of a double joint whose pivot no state sets; the second with a straight single joint behind.
    pivot: Pivot | None = field(kw_only=True)
    straight: Pivot | None = field(kw_only=True)

    @property
    def settable_deg(self) -> float:
        """The equivalent bend with the best setting that can be made."""
        bends = self.equivalent_bend_deg
        return bends.best if bends.on_teeth is None else bends.on_teeth

    @property
    def set_shafts(self) -> tuple[ShaftSetting, ...]:
        """The setting that can be made."""
        return self.teeth or self.shafts

    @property
    def turned(self) -> list[ShaftSetting]:
        """The shafts whose yokes are to be turned."""
        return [shaft for shaft in self.set_shafts if shaft.turn_deg >= SHOWN]


@dataclass(frozen=True)
class YokeFigures(Advice):
    """The answer of ``cardan phase``."""

    view: str = word("view", "from where senses of rotation are seen")
    catalogue: RootRules = parts("root rule", "the same settings by the rule of the catalogues")
    above_limits: tuple[str, ...] = word(
        "above limits", "what the check finds beyond its limits at the setting that can be made"
    )


def yoke_settings(scene: Scene) -> YokeFigures:
    """Return the best yoke settings of a scene; one setting for all of its states."""
    line, states = scene.line, scene.states
    if line.n_joints == 1:
        raise ValueError(f"{scene.name}: one joint has no yokes to set against each other")
    if line.shape:
        raise ValueError(f"{scene.name}: the bends were recorded; yokes are set for fixed bends")
    if states and states.set_phases:
        raise ValueError(
            f"{scene.name}: [states] gives phases_deg; one setting can serve all states only if "
            "none of them sets the yokes"
        )
    settings = _settings(line, states, scene.teeth, is_double=scene.is_double)
    found = _of_scene(scene, settings)
    lines = {key: _of_states(line, states, phases) for key, phases in settings.items()}
    # On splines, what can be set.
    set_lines = lines.get("on_teeth", lines["best"])
    if states:
        check = check_states(scene, set_lines)
    else:
        check = set_lines[0].check(scene.speed or None, scene.limits)
    rules = {
        key: root_rule(each[int(np.argmax(each.equivalent().k))]) for key, each in lines.items()
    }
    above = [
        f"{row.label}: {judged_text(value, row)} ({value.source})"
        for _, row, value, _ in entries(motion_of(scene, check), "limits")
        if isinstance(value, Judged) and value.verdict == "beyond"
    ]
    return YokeFigures(
        **vars(found), view=VIEW, catalogue=_by_setting(RootRules, rules), above_limits=tuple(above)
    )


def scene_advice(scene: Scene) -> Advice | None:
    """Return the advice for a scene; ``None`` where a study or a recording varies the bends."""
    line, states = scene.line, scene.states
    if line.shape or (states and states.set_phases):
        return None
    if not states and scene.study is not None and scene.study.axes:
        return None
    return _of_scene(scene, _settings(line, states, scene.teeth, is_double=scene.is_double))


def advice(line: Driveline, limit: float = MAX_EQUIVALENT_BEND) -> Advice:
    """Return what the yokes can do for one driveline, with a limit of the equivalent bend."""
    return _advice(line, limit, _settings(line, None, ()), None, ())


def limit_of(scene: Scene) -> float:
    """Return the limit of the equivalent bend of a scene in rad."""
    return float(np.radians(scene.limits.figures["equivalent_bend_deg"].limit))


def root_rule(line: Driveline) -> RootRule:
    """Return the root rule for one driveline with two or more joints."""
    signs, off = line.fork_signs()
    return RootRule(
        tuple(signs.tolist()),
        float(np.degrees(line.catalogue_bend(signs))),
        float(np.degrees(np.max(off))),
    )


def _settings(
    line: Driveline, states: States | None, teeth: Sequence[int], *, is_double: bool = False
) -> dict[str, FloatArray]:
    """The phases of each setting in rad; of states the setting serves all."""
    lines, common = states.drivelines() if states else line, _common(states, is_double=is_double)
    settings = {"present": line.phases, "best": lines.optimal_phases(**common)}
    if teeth:
        settings["on_teeth"] = lines.optimal_phases(**common, teeth=teeth)
    return settings


def _common(states: States | None, *, is_double: bool) -> dict[str, Any]:
    """Return what the best setting serves, and the yokes that it leaves as they are."""
    common: dict[str, Any] = {"states": 0, "weights": states.weights} if states else {}
    return common | ({"fixed": [1]} if is_double else {})


def _of_states(line: Driveline, states: States | None, phases: FloatArray) -> Driveline:
    """The driveline with a setting in every state, or as a batch of one."""
    return (states.drivelines() if states else line.reshape(1)).with_phases(phases)


def _by_setting(of: type[_T], values: Mapping[str, Any], missing: Any = None) -> _T:  # noqa: ANN401
    """Return what each setting makes, ``missing`` of teeth that are not known."""
    return of(*(values.get(key, missing) for key in ("present", "best", "on_teeth")))


def _of_scene(scene: Scene, settings: Mapping[str, FloatArray]) -> Advice:
    pivot = _best_pivot(scene) if scene.is_double else None
    straight = _best_pivot(scene, {SINGLE_BEND: 0.0}) if pivot else None
    return _advice(
        scene.line,
        limit_of(scene),
        settings,
        scene.states,
        scene.teeth,
        is_double=scene.is_double,
        pivot=pivot,
        straight=straight,
    )


def _best_pivot(scene: Scene, changes: Mapping[str, float] | None = None) -> Pivot | None:
    """Search the synchronous bend to a tenth of a degree, after some changes by key.

    It is ``None`` where a state sets one of them, or the scene gives no such key.
    """
    states, found = scene.states, list[Pivot]()
    if states and any(axis.name == SYNCHRONOUS for axis in states.axes):
        return None
    common = _common(states, is_double=True) | ({"teeth": scene.teeth} if scene.teeth else {})
    for step in (1.0, 0.1):
        tried = np.arange(0.0, _MOST_SYNCHRONOUS, step)
        if found:
            # Sharp minima lie beside the least of the coarse steps, and not of one alone.
            near = np.array([each.synchronous_deg for each in sorted(found)[:4]])
            tried = tried[np.abs(tried[:, np.newaxis] - near).min(axis=1) < 1.0]
        for synchronous in tried.round(1).tolist():
            try:
                lines = scene.drivelines({SYNCHRONOUS: synchronous, **(changes or {})})
            except ValueError:
                # The pivot would lie beyond a joint.
                continue
            # A batch of one driveline has its best setting too.
            phases = lines.optimal_phases(**({"states": 0} | common))
            bends = map(equivalent_bend_deg, lines.with_phases(phases))
            found.append(Pivot(max(bends), synchronous))
    return min(found, default=None)


def _advice(
    line: Driveline,
    limit: float,
    settings: Mapping[str, FloatArray],
    states: States | None,
    teeth: Sequence[int],
    *,
    is_double: bool = False,
    pivot: Pivot | None = None,
    straight: Pivot | None = None,
) -> Advice:
    # To and from radians, 3 would become 3.0000000000000004.
    limit_deg = round(float(np.degrees(limit)), 12)
    each = {
        key: tuple(map(equivalent_bend_deg, _of_states(line, states, phases)))
        for key, phases in settings.items()
    }
    largest = {key: max(values) for key, values in each.items()}
    within = {key: bend <= limit_deg * (1.0 + ROUNDING) for key, bend in largest.items()}
    over, ranges, drawn = None, np.degrees(line.bend_ranges(limit)), line
    if states:
        worst = {key: states.names[int(np.argmax(values))] for key, values in each.items()}
        drawn, ranges = states.driveline(states.names.index(worst["present"])), ranges[:0]
        over = OverStates(
            states.names,
            tuple(states.weights.tolist()),
            _by_setting(BendsOfStates, each, ()),
            _by_setting(WorstStates, worst, ""),
        )
    return Advice(
        drawn.arrangement(),
        "none" if within["present"] else "phases" if within["best"] else "bends",
        limit_deg,
        _by_setting(Bends, largest),
        tuple(_setting(line, i, phase) for i, phase in enumerate(settings["best"])),
        tuple(
            BendRange(i, float(line.bends_deg[i]), float(low), float(high))
            for i, (low, high) in enumerate(ranges)
        ),
        over,
        tuple(_setting(line, i, settings["on_teeth"][i], count) for i, count in enumerate(teeth)),
        decimals=_decimals(line, states, settings["best"], limit_deg),
        is_double=is_double,
        pivot=pivot,
        straight=straight,
    )


def _decimals(line: Driveline, states: States | None, best: FloatArray, limit_deg: float) -> int:
    """The fewest decimals of settings and turns with which a limit is kept, if it can be."""
    fewest = DIGITS["phase"].decimals or 0
    for decimals in range(fewest, _MOST_DECIMALS + 1):
        ways = [
            start + np.radians(np.round(np.degrees(best - start), decimals))
            for start in (0.0 * best, line.phases)
        ]
        lines = [one for phases in ways for one in _of_states(line, states, phases)]
        if max(map(equivalent_bend_deg, lines)) <= limit_deg * (1.0 + ROUNDING):
            return decimals
    return fewest


def _setting(line: Driveline, place: int, phase: float, teeth: int | None = None) -> ShaftSetting:
    """How to reach a phase in rad, on a spline by whole teeth."""
    setting, sense = _turn(phase)
    change = phase - line.phases[place]
    turn_teeth, (turned, turn_sense) = None, _turn(change)
    if teeth is not None:
        steps = round(change * teeth / (2.0 * np.pi))
        turn_teeth, turned = abs(steps), abs(steps) * 360.0 / teeth
        turn_sense = get_args(Sense)[int(np.sign(steps))]
    return ShaftSetting(
        place + 1,
        teeth,
        turn_teeth,
        turned,
        turn_sense,
        180.0 - turned,
        -setting if sense == "counter-clockwise" else setting,
        setting,
        sense,
        180.0 - setting,
    )


def _turn(angle: float) -> tuple[float, Sense]:
    """Size in degrees and sense of a turn in rad."""
    found = turn(angle)
    sense: Any = str(found.sense)
    return float(np.degrees(found.angle)), sense

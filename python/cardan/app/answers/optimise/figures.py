"""The best values of what a scene lets change, as numbers."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from cardan.app.answers.answer import Answer
from cardan.app.answers.printed import (
    bullets,
    capital,
    given,
    listed,
    number_text,
    part_text,
    quantity,
)
from cardan.app.answers.rows import UNITS, NotFound, figure, flag, item, key_of, parts, word
from cardan.app.scene.language.errors import SceneError
from cardan.app.scene.language.units import shown_unit, size_of
from cardan.app.scene.scene import Scene
from cardan.app.scene.sections.driveline import DOUBLE_JOINT, SINGLE_PHASE, SYNCHRONOUS
from cardan.app.scene.study.optimisation import Optimisation, Variable
from cardan.arrays import FloatArray
from cardan.design.quantities import label
from cardan.motion.workshop import VIEW
from cardan.optimisation import Optimum

_POINTS = 121
"""Points of a curve over one variable."""

# As near to its end, as a share of a range or of a limit, something has reached it.
_REACHED = 2e-5

_UNIT = "unit of the figures beside it"


@dataclass(frozen=True)
class Changed:
    """Change of one variable."""

    key: str = item("key")
    unit: str = word("unit", _UNIT)
    before: float = figure("before", "own", "in [driveline], of the first entry")
    after: float = figure("after", "own")
    change: float = figure("change", "own")
    least: float | None = figure("least change", "own", "null for a free phase")
    largest: float | None = figure("largest change", "own", "null for a free phase")
    teeth: float | None = figure("teeth", "", "by how many a yoke turns; null without a spline")
    at_end: Literal["low", "high", "no"] = word("at the end of its range")


@dataclass(frozen=True)
class InState:
    """A quantity in one state."""

    state: str = item("state")
    unit: str = word("unit", _UNIT, is_detail=True)
    before: float = figure("before", "own", "as the scene is", apart="limit")
    after: float = figure("after", "own", "with the values found")
    # Of what is kept.
    limit: float | None = None


@dataclass(frozen=True)
class Minimised:
    """The quantity that is minimised."""

    quantity: str = word("quantity")
    unit: str = word("unit", _UNIT)
    over: Literal["largest", "rms"] = word("over the states")
    before: float = figure("before", "own", "over all states")
    after: float = figure("after", "own", "over all states")
    states: tuple[InState, ...] = parts("States")


@dataclass(frozen=True)
class Kept:
    """A quantity that has a limit."""

    quantity: str = item("quantity")
    unit: str = word("unit", _UNIT)
    limit: float = figure("limit", "own", digits="given")
    at_limit: bool = flag("at its limit")
    states: tuple[InState, ...] = parts("States")


@dataclass(frozen=True, eq=False)
class Optimised:
    """The best values of what a scene lets change: what it asks for, the optimum, its figures."""

    scene: Scene
    asked: Optimisation
    best: Optimum
    variables: tuple[Changed, ...] = parts("Variables")
    minimised: Minimised = parts("Minimised")
    kept: tuple[Kept, ...] = parts("Kept")

    @property
    def goal_words(self) -> str:
        """Goal in words: the quantity, and how it combines the states."""
        count = len(self.asked.names)
        over = {"largest": "largest", "rms": "root mean square"}[self.asked.over]
        of = f", {over} of {count} states" if count > 1 else ""
        return f"{label(self.asked.minimise)}{of}"

    def goal(self, value: Any) -> Any:  # noqa: ANN401 - numbers or arrays
        """Return values of the quantity that is minimised, in the unit in which it is shown."""
        return UNITS[shown_unit(self.minimised.unit)].factor * value

    def over(self, number: int) -> OverVariable:
        """Return the quantity over the states at changes of one variable, with the others at best.

        A free phase is shown over half a turn.
        """
        variable = self.asked.variables[number]
        at = float(self.best.x[number])
        low, high = variable.low, variable.high
        if not np.isfinite(high - low):
            low, high = at - 90.0, at + 90.0
        changes = np.unique(np.append(np.linspace(low, high, _POINTS), at))
        points = np.tile(self.best.x, (len(changes), 1))
        points[:, number] = changes
        values, kept = self.asked.values_at(points)
        return OverVariable(variable.base + changes, self.goal(values), kept)


@dataclass(frozen=True, eq=False)
class OverVariable:
    """The quantity that is minimised over one variable."""

    x: FloatArray  # values of the variable, in the unit of its key
    values: FloatArray  # over all states, in the unit that is shown; NaN without a driveline
    kept: NDArray[np.bool_]  # where all limits are kept

    @property
    def within(self) -> FloatArray:
        """The values where all limits are kept, NaN elsewhere."""
        return np.where(self.kept, self.values, np.nan)

    @property
    def beyond(self) -> FloatArray:
        """The values where a limit is not kept, up to the next ones within; NaN elsewhere."""
        near = ~self.kept
        near[1:] |= ~self.kept[:-1]
        near[:-1] |= ~self.kept[1:]
        return np.where(near, self.values, np.nan)


def find(answer: Answer) -> Optimised | NotFound | None:
    """Return the best values; ``None`` without [optimise], the reason if there are none."""
    try:
        return optimised(answer.scene)
    except (ImportError, ValueError) as error:
        return NotFound(str(error))


def optimised(scene: Scene) -> Optimised | None:
    """Find the best values of what a scene lets change; ``None`` if it lets nothing change.

    Raises:
        ImportError: SciPy is missing.
        ValueError: a limit that cannot be kept.
    """
    asked = scene.optimisation
    if asked is None:
        return None
    try:
        best = asked.run()
    except ValueError as error:
        raise SceneError(error, scene.name, "optimise") from None
    unit = key_of(best.unit)
    states = _states(asked, unit, best.per_state_before, best.per_state)
    minimised = Minimised(asked.minimise, unit, asked.over, best.before, best.value, states)
    variables, kept = tuple(_variables(asked, best)), tuple(_kept(asked, best))
    return Optimised(scene, asked, best, variables, minimised, kept)


def _states(
    asked: Optimisation,
    unit: str,
    before: FloatArray,
    after: FloatArray,
    limit: float | None = None,
) -> tuple[InState, ...]:
    ends = zip(asked.names, before.tolist(), after.tolist(), strict=True)
    return tuple(InState(name, unit, was, is_now, limit) for name, was, is_now in ends)


def _variables(asked: Optimisation, best: Optimum) -> Iterator[Changed]:
    for variable, change in zip(asked.variables, best.x.tolist(), strict=True):
        si = 1.0 / UNITS[variable.unit].factor
        is_free = not np.isfinite(variable.high)
        room = 0.0 if is_free else _REACHED * (variable.high - variable.low)
        at_end: Literal["low", "high", "no"] = "no"
        if change <= variable.low + room:
            at_end = "low"
        elif change >= variable.high - room:
            at_end = "high"
        yield Changed(
            variable.axis.key,
            variable.unit,
            si * variable.base,
            si * (variable.base + change),
            si * change,
            None if is_free else si * variable.low,
            None if is_free else si * variable.high,
            round(change * variable.teeth / 360.0) if variable.teeth else None,
            at_end,
        )


def _kept(asked: Optimisation, best: Optimum) -> Iterator[Kept]:
    for (name, after), (key, limit) in zip(best.kept.items(), asked.keep.items(), strict=True):
        unit = key_of(asked.measure("keep", name).unit)
        bound = size_of(key) * limit / UNITS[unit].factor
        states = _states(asked, unit, best.kept_before[name], after, bound)
        is_reached = bool(np.max(after) >= (1.0 - _REACHED) * bound)
        yield Kept(name, unit, bound, is_reached, states)


# Digits that a change may have beside those of its unit.
_MOST_MORE = 4

# Smaller changes, in the unit of the key, are not worth a word.
_SHOWN = 5e-4

# In words, the plane comes before the quantity.
_QUANTITIES = {
    f"{name}_{plane}_deg": f"{plane} {name.replace('_', ' ')}"
    for name in ("slopes", "projected_bends")
    for plane in ("vertical", "horizontal")
}

# Keys of a double joint, whose lists have one entry.
_OF_DOUBLE = {
    DOUBLE_JOINT: "the total bend of the double joint",
    SYNCHRONOUS: "the synchronous bend of the double joint",
    "single_bend_deg": "the bend of the single joint",
    "single_twist_deg": "the twist of the single joint",
    SINGLE_PHASE: "the output-side yoke of shaft 2",
}


def words(found: Optimised, *, radians: bool = False) -> str:
    """Say what to change, what that brings in each state, and what limits it, 79 wide."""
    changes = [
        f"Changes (senses of rotation {VIEW}):",
        *bullets(change_lines(found), break_long_words=False),
    ]
    tables = [
        part_text(caption, states, (), radians=radians) for caption, states in by_state(found)
    ]
    limits = "\n".join(bullets(limit_lines(found), break_long_words=False))
    return "\n\n".join([_result(found), "\n".join(changes), *tables, limits])


def sentences(found: Optimised | NotFound) -> Iterator[str]:
    """Say the same in sentences, or why there is no optimum."""
    if isinstance(found, NotFound):
        yield f"{found.reason}."
        return
    yield _result(found)
    yield from (f"{capital(line)}." for line in change_lines(found))
    yield f"Senses of rotation are seen {VIEW}."
    yield from limit_lines(found)
    yield "Each curve is over one variable, with the others at their best."


def by_state(found: Optimised) -> Iterator[tuple[str, tuple[InState, ...]]]:
    """Yield the quantities with their figures in each state; none that the first line says."""
    if found.kept or len(found.asked.names) > 1:
        yield capital(label(found.minimised.quantity)), found.minimised.states
    for kept in found.kept:
        limit = given(kept.limit, kept.unit)
        yield f"{capital(label(kept.quantity))}, at most {limit}", kept.states


def _result(found: Optimised) -> str:
    before, after = (
        quantity(value, found.minimised.unit)
        for value in (found.minimised.before, found.minimised.after)
    )
    return f"{capital(found.goal_words)}: {before} before, {after} after."


def change_lines(found: Optimised) -> Iterator[str]:
    """Say what to do about each variable."""
    for variable, change, size in zip(
        found.asked.variables, found.best.x.tolist(), _sizes(found), strict=True
    ):
        # Of several entries each has its own value.
        values, stays = variable.axis.key, "they are"
        if len(_numbers(variable)) == 1:
            end = variable.base + math.copysign(float(size), change)
            ends = (number_text(end, "given") for end in (variable.base, end))
            values, stays = f"{values}: {' → '.join(ends)}{_unit(variable)}", "it is"
        if abs(change) < _SHOWN:
            yield f"leave {_what(variable)} as {stays} ({variable.axis.key})"
        else:
            yield f"{_action(variable, change, size)} ({values})"


def _sizes(found: Optimised) -> list[str]:
    """The sizes of all changes, with the fewest digits with which the limits are kept."""
    variables, changes = found.asked.variables, found.best.x
    for more in range(_MOST_MORE):
        sizes = [
            _size(variable, abs(change), more)
            for variable, change in zip(variables, changes.tolist(), strict=True)
        ]
        _, kept = found.asked.values_at(np.copysign([[*map(float, sizes)]], changes))
        if kept[0]:
            break
    return sizes


def _size(variable: Variable, size: float, more: int) -> str:
    if variable.teeth:
        return f"{size:.15g}"
    kind = "phase" if variable.is_phase else variable.unit
    text = number_text(size, kind)
    if more:
        text = number_text(size, kind, least=len(text.partition(".")[2]) + more)
    return text if variable.is_phase else number_text(float(text), "given")


def _action(variable: Variable, change: float, shown: str) -> str:
    size, what = f"{shown}{_unit(variable)}", _what(variable)
    if variable.is_phase:
        sense = "clockwise" if change > 0.0 else "counter-clockwise"
        turn = f"{number_text(float(shown), 'phase')}°"
        if not variable.teeth:
            return f"turn {what} by {turn} {sense}"
        teeth = abs(round(change * variable.teeth / 360.0))
        return f"turn {what} by {teeth} {'tooth' if teeth == 1 else 'teeth'} {sense} ({turn})"
    if variable.axis.section == "bearing":
        downstream = (change > 0.0) == variable.axis.name.startswith("position")
        return f"move {what} by {size} {'down' if downstream else 'up'}stream"
    if variable.axis.component is not None and variable.axis.name.startswith("points"):
        axis = "xyz"[variable.axis.component]
        return f"move {what} by {size} along {'+' if change > 0.0 else '-'}{axis}"
    return f"{'increase' if change > 0.0 else 'reduce'} {what} by {size}"


def _what(variable: Variable) -> str:
    """Return the owner of a variable: ``joint 1``, ``the bends of joints 0 and 1``."""
    axis, numbers = variable.axis, _numbers(variable)
    if axis.section == "bearing" and axis.place is not None:
        return f"bearing {axis.place.start}"
    if axis.name.startswith("points"):
        names = [f"joint {i - 1}" if i else "the driving end" for i in numbers]
        if variable.last_entry in numbers:
            names[-1] = "the driven end"
        return listed(names)
    if axis.name in _OF_DOUBLE:
        return _OF_DOUBLE[axis.name]
    offset = 1 if axis.name in ("phases_deg", "twists_deg") else 0
    item = "joint" if "bends" in axis.name else "shaft"
    is_one = len(numbers) == 1
    whole = axis.key == axis.name and not is_one
    of = f"all {item}s" if whole else listed([f"{item} {i + offset}" for i in numbers])
    if variable.is_phase:
        return f"the output-side {'yoke' if is_one else 'yokes'} of {of}"
    named = _QUANTITIES.get(axis.name) or axis.name.rpartition("_")[0] or axis.name
    component = "" if axis.component is None else f"{'xyz'[axis.component]} of the "
    return f"the {component}{named.removesuffix('s') if is_one else named} of {of}"


def _numbers(variable: Variable) -> range:
    """The numbers of the entries that a variable changes."""
    if variable.axis.section == "bearing":
        return range(1)
    return range(variable.last_entry + 1)[variable.axis.place or slice(None)]


def limit_lines(found: Optimised) -> list[str]:
    """Say what keeps the optimum from being better."""
    lines = []
    for active in found.best.active:
        if active.variable is not None:
            variable = found.asked.variables[active.variable]
            lines.append(
                f"{variable.axis.key} is at the {'lower' if active.kind == 'low' else 'upper'} end "
                f"of its range, a change of "
                f"{number_text(active.limit, 'given')}{_unit(variable)}."
            )
        else:
            (kept,) = (each for each in found.kept if each.quantity == active.quantity)
            where = listed([found.asked.names[state] for state in active.states])
            lines.append(
                f"{capital(label(active.quantity))} is at its limit of "
                f"{given(kept.limit, kept.unit)}{f' in {where}' if where else ''}."
            )
    if any(variable.teeth for variable in found.asked.variables):
        lines.append("Yokes are set by whole teeth of their splines.")
    return lines or ["No range and no limit keeps it from being better."]


def _unit(variable: Variable) -> str:
    symbol = UNITS[variable.unit].symbol
    return symbol if symbol in ("°", "") else f" {symbol}"

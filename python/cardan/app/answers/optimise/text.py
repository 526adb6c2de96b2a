"""What to change on a driveline, and what that brings, in sentences."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from cardan.app.answers.optimise.figures import InState, Optimised
from cardan.app.answers.printed import (
    bullets,
    capital,
    given,
    listed,
    number_text,
    part_text,
    quantity,
)
from cardan.app.answers.rows import UNITS, NotFound
from cardan.app.scene.study.optimisation import Variable
from cardan.design.quantities import label
from cardan.motion.workshop import VIEW

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
    """What a variable belongs to: ``joint 1``, ``the bends of joints 0 and 1``."""
    axis, numbers = variable.axis, _numbers(variable)
    if axis.section == "bearing" and axis.place is not None:
        return f"bearing {axis.place.start}"
    if axis.name.startswith("points"):
        names = [f"joint {i - 1}" if i else "the driving end" for i in numbers]
        if variable.last_entry in numbers:
            names[-1] = "the driven end"
        return listed(names)
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

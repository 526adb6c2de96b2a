"""What to change on a driveline, and what that brings, in sentences."""

from __future__ import annotations

from typing import Any

import numpy as np

from cardan.app.answers.optimise.figures import Optimised, unit_of
from cardan.app.answers.printed import figure_text, listed, quantity
from cardan.app.answers.rows import key_of
from cardan.app.scene.study.optimisation import Variable
from cardan.design.quantities import label
from cardan.design.wrapping import fill
from cardan.motion.workshop import VIEW

_WIDTH = 79

# Smaller changes, in the unit of the key, are not worth a word.
_SHOWN = 5e-4

# In words, the plane comes before the quantity.
_QUANTITIES = {
    f"{name}_{plane}_deg": f"{plane} {name.replace('_', ' ')}"
    for name in ("slopes", "projected_bends")
    for plane in ("vertical", "horizontal")
}


def optimise_text(found: Optimised) -> str:
    """Say what to change, what that brings in each state, and what limits it."""
    parts = [
        [found.scene.title] if found.scene.title else [],
        [result_text(found)],
        [f"Changes (senses of rotation {VIEW}):", *(f"- {words}" for words in change_lines(found))],
        _table(found),
        [f"- {words}" for words in limit_lines(found)],
    ]
    return "\n\n".join("\n".join(map(_wrapped, part)) for part in parts if part)


def result_text(found: Optimised) -> str:
    """Say the quantity that was minimised, before and after."""
    unit = key_of(found.best.unit)
    before, after = (quantity(value, unit) for value in (found.best.before, found.best.value))
    name = found.goal_words
    return f"{name[:1].upper()}{name[1:]}: {before} before, {after} after."


def change_lines(found: Optimised) -> list[str]:
    """Say what to do about each variable, one sentence each."""
    lines = []
    for number, variable in enumerate(found.asked.variables):
        change = float(found.best.x[number])
        unit = _unit(unit_of(variable))
        ends = (_number(variable.base), _number(variable.base + change))
        values = f"{variable.axis.key}: {' → '.join(ends)}{unit}"
        if not _is_one(variable):
            # Each entry has its own value.
            values = variable.axis.key
        if abs(change) < _SHOWN:
            stays = "it is" if _is_one(variable) else "they are"
            lines.append(f"leave {_what(variable)} as {stays} ({variable.axis.key})")
        else:
            lines.append(f"{_action(variable, change)} ({values})")
    return lines


def _action(variable: Variable, change: float) -> str:
    unit = _unit(unit_of(variable))
    size = _number(abs(change))
    what = _what(variable)
    if variable.is_phase:
        sense = "clockwise" if change > 0.0 else "counter-clockwise"
        if not variable.teeth:
            return f"turn {what} by {abs(change):.2f}° {sense}"
        teeth = abs(round(change * variable.teeth / 360.0))
        count = f"{teeth} {'tooth' if teeth == 1 else 'teeth'}"
        return f"turn {what} by {count} {sense} ({abs(change):.2f}°)"
    if variable.axis.component is not None and variable.axis.name.startswith("points"):
        axis = "xyz"[variable.axis.component]
        return f"move {what} by {size}{unit} along {'+' if change > 0.0 else '-'}{axis}"
    return f"{'increase' if change > 0.0 else 'reduce'} {what} by {size}{unit}"


def _what(variable: Variable) -> str:
    """What a variable belongs to: ``joint 1``, ``the bends of joints 0 and 1``."""
    axis, numbers = variable.axis, _numbers(variable)
    if axis.name.startswith("points"):
        names = [f"joint {i - 1}" if i else "the driving end" for i in numbers]
        if variable.last_entry in numbers:
            names[-1] = "the driven end"
        return listed(names)
    offset = 1 if axis.name in ("phases_deg", "twists_deg") else 0
    item = "joint" if "bends" in axis.name else "shaft"
    whole = axis.key == axis.name and len(numbers) > 1
    of = f"all {item}s" if whole else listed([f"{item} {i + offset}" for i in numbers])
    one = _is_one(variable)
    if variable.is_phase:
        return f"the output-side {'yoke' if one else 'yokes'} of {of}"
    quantity = _QUANTITIES.get(axis.name) or axis.name.rpartition("_")[0] or axis.name
    component = "" if axis.component is None else f"{'xyz'[axis.component]} of the "
    return f"the {component}{_singular(quantity) if one else quantity} of {of}"


def _singular(quantity: str) -> str:
    """``vertical slope`` of ``vertical slopes``."""
    return quantity.removesuffix("s")


def _numbers(variable: Variable) -> range:
    """The numbers of the entries that a variable changes."""
    return range(variable.last_entry + 1)[variable.axis.place or slice(None)]


def _is_one(variable: Variable) -> bool:
    return len(_numbers(variable)) == 1


def limit_lines(found: Optimised) -> list[str]:
    """Say what keeps the optimum from being better."""
    lines = []
    for active in found.best.active:
        if active.variable is not None:
            variable = found.asked.variables[active.variable]
            unit = _unit(unit_of(variable))
            end = "lower" if active.kind == "low" else "upper"
            lines.append(
                f"{variable.axis.key} is at the {end} end of its range, a change of "
                f"{_number(active.limit)}{unit}."
            )
        else:
            unit = key_of(found.asked.measure("keep", active.quantity).unit)
            where = listed([found.asked.names[state] for state in active.states])
            place = f" in {where}" if where else ""
            name = label(active.quantity)
            lines.append(
                f"{name[:1].upper()}{name[1:]} is at its limit of "
                f"{quantity(active.limit, unit)}{place}."
            )
    if any(variable.teeth for variable in found.asked.variables):
        lines.append("Yokes are set by whole teeth of their splines.")
    return lines or ["No range and no limit is reached; any further change makes it worse."]


def table_of(found: Optimised) -> tuple[list[str], list[list[str]]]:
    """Return the figures of each state, before and after, as headings and rows of texts."""
    best = found.best
    columns = [
        (found.asked.minimise, found.goal_unit, *map(found.goal, _both(best))),
        *found.kept(),
    ]
    limits = ["", *(f", at most {_number(limit)}" for limit in found.asked.keep.values())]
    headings = ["state" if found.asked.states else ""]
    for (name, unit, *_), limit in zip(columns, limits, strict=True):
        heading = f"{label(name)}{f' [{unit}]' if unit else ''}{limit}"
        headings += [f"{heading}, before", "after"]
    rows = []
    for i, state in enumerate(found.asked.names):
        row = [state]
        for _, _, before, after in columns:
            # What rounding leaves of joints that compensate each other counts as 0.
            least = 1e-8 * max(np.max(before), np.max(after))
            row += [figure_text(float(x[i]) if x[i] > least else 0.0) for x in (before, after)]
        rows.append(row)
    return headings, rows


def _both(best: Any) -> tuple[Any, Any]:  # noqa: ANN401 - an optimum and its arrays
    return best.per_state_before, best.per_state


def _table(found: Optimised) -> list[str]:
    headings, rows = table_of(found)
    if len(rows) == 1 and len(headings) == 3:
        # The first sentence says it.
        return []
    lines: list[str] = []
    first = max(len(row[0]) for row in rows)
    for column in range(1, len(headings), 2):
        quantity = headings[column].removesuffix(", before")
        width = max(first, len(quantity)) + 2
        lines += ["" for _ in lines[:1]]
        lines.append(f"{quantity:{width}}{'before':>10}{'after':>10}")
        lines += [f"{row[0]:{width}}{row[column]:>10}{row[column + 1]:>10}" for row in rows]
    return lines


def _unit(unit: str) -> str:
    return {"deg": "°", "": ""}.get(unit, f" {unit}")


def _number(value: float) -> str:
    return f"{round(value, 3) + 0.0:.10g}"


def _wrapped(line: str) -> str:
    if len(line) <= _WIDTH or not line.startswith("- "):
        return line
    return fill(
        line, _WIDTH, subsequent_indent="  ", break_on_hyphens=False, break_long_words=False
    )

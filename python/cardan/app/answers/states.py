"""A scene over its states as numbers: figures and verdict of each, and the worst of all."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Literal

from cardan.app.answers.answer import Answer
from cardan.app.answers.limits import FIGURES
from cardan.app.answers.printed import aligned, kind_of, number_text, settled, table_text
from cardan.app.answers.rounding import alike
from cardan.app.answers.rows import as_shown, figure, item, numbers, parts, taken, word, worst_of
from cardan.app.answers.study import End, Extremes, extremes
from cardan.app.scene.language.units import in_shown, shown_unit
from cardan.app.scene.study.states import STATE, StatesResult


@dataclass(frozen=True)
class StateFigures:
    """The motion of the driveline in one state; ``None`` of what is not known or has no meaning."""

    state: str = item("state")
    equivalent_bend: float | None = figure("equivalent bend", "deg", apart="limit")
    bends: tuple[float, ...] = numbers("bends", "deg", "of the joints", is_detail=False)
    bend_difference: float | None = figure("bend difference", "deg", is_detail=True)
    torsional_excitation: float | None = figure("torsional excitation", "rad_s2", is_detail=True)
    inertia_excitation_driving: float | None = figure(
        "inertia excitation, driving", "rad_s2", is_detail=True
    )
    inertia_excitation_coasting: float | None = figure(
        "inertia excitation, coasting", "rad_s2", is_detail=True
    )
    verdict: str = word("verdict", "on the motion")
    beyond: str = word("beyond", "what is beyond its limit in this state, besides the bend")
    lengths: tuple[float, ...] = numbers("lengths", "mm", "of the shafts, where they are known")
    # Of the equivalent bend.
    limit: float | None = None


def find(answer: Answer) -> tuple[StateFigures, ...]:
    """Return the motion of a scene in each of its states."""
    states = answer.scene.states
    if states is None:
        return ()
    motion, lines = answer["limits"], states.drivelines()
    lengths = lines._geometry.lengths
    found = []
    for i, name in enumerate(states.names):
        judged = {
            figure: replace(whole, value=whole.each[name])
            for figure in FIGURES
            if (whole := getattr(motion, figure)) is not None and name in whole.each
        }
        values = {figure: judged[figure].value if figure in judged else None for figure in FIGURES}
        found.append(
            StateFigures(
                name,
                **values,
                verdict=worst_of(each.verdict for each in judged.values()),
                beyond=", ".join(
                    figure.replace("_", " ")
                    for figure, each in judged.items()
                    if each.verdict == "beyond" and figure != "equivalent_bend"
                ),
                bends=tuple(lines.bends[i].tolist()),
                lengths=tuple(lengths[i].tolist()) if lengths.ndim > 1 else (),
                limit=motion.equivalent_bend.limit,
            )
        )
    return tuple(found)


def without_common(names: Sequence[str]) -> tuple[str, list[str]]:
    """Return what the names of states have in common, and the rest of each with a true minus sign.

    >>> without_common(["points_mm.3.y = 20", "points_mm.3.y = 0"])
    ('points_mm.3.y', ['20', '0'])
    >>> without_common(["state 0", "state 1"])
    ('state', ['0', '1'])
    >>> without_common(["laden", "empty"])
    ('', ['laden', 'empty'])
    """
    parts = [name.partition(" = ") for name in names]
    common = {part[0] for part in parts}
    if len(common) == 1 and all(part[1] for part in parts):
        return common.pop(), [part[2].replace("-", "\N{MINUS SIGN}") for part in parts]
    if all(name.startswith("state ") for name in names):
        return "state", [name.removeprefix("state ") for name in names]
    return "", list(names)


# --- figures of every state ---------------------------------------------------------------------


@dataclass(frozen=True)
class Varied:
    """A key that varies from state to state."""

    key: str = word("key")
    values: tuple[float, ...] = numbers("values", "", "one per state")


@dataclass(frozen=True)
class StateEnd:
    """The least or the largest value of a figure."""

    unit: str
    value: float = as_shown(figure("value", "own"))
    state: str = word("state", "empty if it is the same in all states")


@dataclass(frozen=True)
class FigureOfStates:
    """A figure in every state, in its SI unit; its column is in that shown."""

    source: Extremes
    per: Literal["shaft", "joint", "bearing"]
    unit: str
    column: str = word("column", "its heading in the table")
    quantity: str = word("quantity")
    item: int = item("own")
    statistic: str = word("statistic")
    values: tuple[float, ...] = as_shown(numbers("values", "own", "one per state"))
    least: StateEnd = parts("least")
    largest: StateEnd = parts("largest")

    def text(self, value: float) -> str:
        """Return a value of it as it is shown, without its unit."""
        shown = in_shown(value, self.unit)
        return number_text(shown, kind_of(self.quantity, shown_unit(self.unit)))


@dataclass(frozen=True)
class StatesFigures:
    """The states of a scene and their figures."""

    names: tuple[str, ...] = word("names")
    weights: tuple[float, ...] = numbers("weights")
    keys: tuple[Varied, ...] = parts("varied keys")
    figures: tuple[FigureOfStates, ...] = parts("figures")


def states_figures(table: StatesResult, *, radians: bool = False) -> StatesFigures:
    """Return the figures of a scene in every state."""
    states = table.states
    return StatesFigures(
        states.names,
        tuple(states.weights.tolist()),
        tuple(Varied(axis.key, tuple(axis.values.tolist())) for axis in states.axes),
        tuple(_of_states(table, each, radians) for each in extremes(table, radians=radians)),
    )


def _of_states(table: StatesResult, found: Extremes, radians: bool) -> FigureOfStates:
    def end(of: End) -> StateEnd:
        state = table.states.names[int(of.at[STATE])] if STATE in of.at else ""
        return StateEnd(of.unit, of.value, state)

    return taken(
        *(FigureOfStates, found),
        source=found,
        unit=found.least.unit,
        values=tuple(table.figure(found.source, radians=radians)[1].tolist()),
        least=end(found.least),
        largest=end(found.largest),
    )


OF_DRIVELINE = "Angles, motion and loads above are those of [driveline]; the states follow."
"""Sentence between the two parts of the answer of a run."""

_WIDTH = 79


def states_text(found: StatesFigures) -> str:
    """Return the figures of every state as tables of plain text, at most 79 wide, and the worst."""
    columns = [[key.key, *(f"{value:.6g}" for value in key.values)] for key in found.keys]
    columns += [[each.column, *map(each.text, each.values)] for each in found.figures]
    names = ["States", *(f"  {name}" for name in found.names)]
    parts = [table_text([*zip(names, *group, strict=True)]) for group in _groups(names, columns)]
    if worst := list(worst_lines(found)):
        parts.append(f"Largest over the states\n{aligned(worst, indent='  ')}")
    return "\n\n".join(parts)


def worst_lines(found: StatesFigures) -> Iterator[tuple[str, str]]:
    """Yield figures of which less is better: what each is, its largest value, and the state."""
    for each in found.figures:
        value = settled(each.largest.value, each.unit)
        varies = not alike(each.least.value, value)
        if each.source.less_is_better and math.isfinite(value) and varies:
            yield each.column, f"{each.text(value)} in {each.largest.state}"


def _groups(names: Sequence[str], columns: Sequence[list[str]]) -> Iterator[list[list[str]]]:
    """Columns that fit beside the names, group by group."""

    def width(column: Sequence[str]) -> int:
        return max(map(len, column)) + 2

    group: list[list[str]] = []
    left = _WIDTH - width(names)
    for column in columns:
        if group and width(column) > left:
            yield group
            group, left = [], _WIDTH - width(names)
        group.append(column)
        left -= width(column)
    yield group

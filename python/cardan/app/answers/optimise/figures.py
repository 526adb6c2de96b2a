"""The best values of what a scene lets change, as numbers."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from cardan.app.answers.answer import Answer
from cardan.app.answers.rows import UNITS, NotFound, figure, flag, item, key_of, parts, word
from cardan.app.scene.language.errors import SceneError
from cardan.app.scene.language.units import shown_unit, size_of
from cardan.app.scene.scene import Scene
from cardan.app.scene.study.optimisation import Optimisation
from cardan.arrays import FloatArray
from cardan.design.quantities import label
from cardan.optimisation import Optimum

_POINTS = 121
"""Points of a curve over one variable."""

# As near to its end, as a share of a range or of a limit, something has reached it.
_REACHED = 2e-5

_UNIT = "unit of the figures beside it"


@dataclass(frozen=True)
class Changed:
    """What changes of one variable."""

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
        """What is minimised, in words: the quantity, and what of the states."""
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

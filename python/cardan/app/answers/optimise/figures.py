"""The best values of what a scene lets change, as numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from cardan.app.answers.data import data_of, schema_of
from cardan.app.answers.json_schema import answer, answer_schema
from cardan.app.answers.rows import UNITS, figure, flag, item, key_of, parts, word
from cardan.app.scene.language.errors import SceneError
from cardan.app.scene.language.units import ENDINGS, in_degrees, split
from cardan.app.scene.scene import Scene
from cardan.app.scene.study.optimisation import Optimisation, Variable
from cardan.arrays import FloatArray
from cardan.design.quantities import label
from cardan.optimisation import Optimum

_POINTS = 121
"""Points of a curve over one variable."""


@dataclass(frozen=True, eq=False)
class OverVariable:
    """The quantity that is minimised over one variable.

    Attributes:
        changes: of the variable, in the unit of its key.
        values: over all states; NaN where there is no driveline.
        kept: where all limits are kept.
    """

    changes: FloatArray
    values: FloatArray
    kept: NDArray[np.bool_]

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


@dataclass(frozen=True, eq=False)
class Optimised:
    """A scene's optimum, with figures in the units that are shown.

    Attributes:
        scene: the scene.
        asked: what may change.
        best: what was found.
    """

    scene: Scene
    asked: Optimisation
    best: Optimum

    @property
    def goal_unit(self) -> str:
        """The unit of the quantity that is minimised, ``""`` for a ratio."""
        return in_degrees(np.zeros(0), self.best.unit)[1]

    def goal(self, value: Any) -> Any:  # noqa: ANN401 - numbers or arrays
        """Return values of the quantity that is minimised, in its unit."""
        return in_degrees(value, self.best.unit)[0]

    def kept(self) -> list[tuple[str, str, FloatArray, FloatArray]]:
        """Return quantity, unit, and values in each state before and after, of each limit."""
        found = []
        for name, values in self.best.kept.items():
            si = self.asked.measure("keep", name).unit
            after, unit = in_degrees(values, si)
            found.append((name, unit, in_degrees(self.best.kept_before[name], si)[0], after))
        return found

    def over(self, number: int) -> OverVariable:
        """Return the value over the states at changes of one variable, with the others at best.

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
        return OverVariable(changes, self.goal(values), kept)

    @property
    def goal_words(self) -> str:
        """What is minimised, in words: the quantity, and what of the states."""
        count = len(self.asked.names)
        over = {"largest": "largest", "rms": "root mean square"}[self.asked.over]
        of = f", {over} of {count} states" if count > 1 else ""
        return f"{label(self.asked.minimise)}{of}"


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
        return Optimised(scene, asked, asked.run())
    except ValueError as error:
        raise SceneError(error, scene.name, "optimise") from None


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
    at_end: Literal["low", "high", "keep", "no"] = word("at the end of its range")


@dataclass(frozen=True)
class InState:
    """A quantity in one state."""

    state: str = item("state")
    unit: str = word("unit", _UNIT)
    before: float = figure("before", "own")
    after: float = figure("after", "own")


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
    limit: float = figure("limit", "own")
    at_limit: bool = flag("at its limit")
    states: tuple[InState, ...] = parts("States")


@dataclass(frozen=True)
class OptimiseFigures:
    """The best values of what a scene lets change."""

    variables: tuple[Changed, ...] = parts("Variables")
    minimised: Minimised = parts("Minimised")
    kept: tuple[Kept, ...] = parts("Kept")


OPTIMISE_SCHEMA = answer_schema(
    "optimise",
    OptimiseFigures.__doc__ or "",
    {
        **schema_of(OptimiseFigures)["properties"],
        "files": {"type": "array", "items": {"type": "string"}},
    },
)


def optimise_data(found: Optimised, files: list[str]) -> dict[str, Any]:
    """Return an optimum as plain data.

    Args:
        found: the optimum.
        files: what was written.
    """
    best, asked = found.best, found.asked
    reached = {active.quantity for active in best.active}

    def states(unit: str, before: FloatArray, after: FloatArray) -> tuple[InState, ...]:
        return tuple(
            InState(name, unit, *ends)
            for name, *ends in zip(asked.names, before, after, strict=True)
        )

    unit = key_of(best.unit)
    kept = []
    for (name, after), limit in zip(best.kept.items(), asked.keep.values(), strict=True):
        own = key_of(asked.measure("keep", name).unit)
        values = states(own, best.kept_before[name], after)
        kept.append(Kept(name, own, limit / UNITS[own].factor, name in reached, values))
    figures = OptimiseFigures(
        tuple(changed(found, i) for i in range(len(asked.variables))),
        Minimised(
            asked.minimise,
            unit,
            asked.over,
            best.before,
            best.value,
            states(unit, best.per_state_before, best.per_state),
        ),
        tuple(kept),
    )
    return answer("optimise", found.scene.title, **data_of(figures), files=files)


def changed(found: Optimised, number: int) -> Changed:
    """Return what changes of one variable."""
    variable, change = found.asked.variables[number], float(found.best.x[number])
    ends = [active.kind for active in found.best.active if active.variable == number]
    unit = split(variable.axis.name)[1]
    si = 1.0 / UNITS[unit].factor
    is_free = not np.isfinite(variable.high)
    return Changed(
        variable.axis.key,
        unit,
        si * variable.base,
        si * (variable.base + change),
        si * change,
        None if is_free else si * variable.low,
        None if is_free else si * variable.high,
        round(change * variable.teeth / 360.0) if variable.teeth else None,
        ends[0] if ends else "no",
    )


def unit_of(variable: Variable) -> str:
    """Return the unit of a variable's values; ``""`` for a ratio."""
    ending: Mapping[str, Any] = ENDINGS
    name = split(variable.axis.name)[1]
    return str(ending[name].symbol) if name else ""

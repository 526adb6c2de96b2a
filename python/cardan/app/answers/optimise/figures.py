"""The best values of what a scene lets change, as numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cardan.app.answers.json_schema import answer, answer_schema, record
from cardan.app.scene.errors import SceneError
from cardan.app.scene.optimise import Optimisation, Variable
from cardan.app.scene.scene import Scene
from cardan.app.scene.units import ENDINGS, in_degrees, split
from cardan.arrays import FloatArray
from cardan.design.quantities import label
from cardan.optimisation import ActiveLimit, Optimum

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

    def limit(self, active: ActiveLimit) -> tuple[float, str]:
        """Return a limit that a kept quantity reaches, in its unit."""
        si = self.asked.measure("keep", active.quantity).unit
        value, unit = in_degrees(np.asarray(active.limit), si)
        return float(value), unit

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
        raise SceneError.of(error, scene.name, "optimise") from None


_NUMBER = {"type": "number"}
_TEXT = {"type": "string"}
_RANGE = {
    "description": "least and largest change; null for a free phase",
    "anyOf": [{"type": "null"}, {"type": "array", "items": _NUMBER}],
}
_STATE = record(
    {
        "state": {"description": "name of the state, empty without [states]", **_TEXT},
        "before": _NUMBER,
        "after": _NUMBER,
    }
)
_QUANTITY = {
    "quantity": _TEXT,
    "unit": {"description": "empty for a ratio", **_TEXT},
    "states": {"type": "array", "items": _STATE},
}

OPTIMISE_SCHEMA = answer_schema(
    "optimise",
    "the best values of what a scene lets change",
    {
        "variables": {
            "type": "array",
            "items": record(
                {
                    "key": {"description": "path of the key in the scene", **_TEXT},
                    "unit": {"description": "of its values", **_TEXT},
                    "before": {"description": "in [driveline], of the first entry", **_NUMBER},
                    "after": _NUMBER,
                    "change": _NUMBER,
                    "range": _RANGE,
                    "teeth": {
                        "description": "by how many teeth a yoke turns; null without a spline",
                        "anyOf": [{"type": "null"}, {"type": "integer"}],
                    },
                    "at_end": {
                        "description": "whether it is at the end of its range",
                        "enum": ["low", "high", "no"],
                    },
                }
            ),
        },
        "minimised": record(
            {
                **_QUANTITY,
                "over": {"enum": ["largest", "rms"]},
                "before": {"description": "over all states", **_NUMBER},
                "after": _NUMBER,
            }
        ),
        "kept": {
            "type": "array",
            "items": record({**_QUANTITY, "limit": _NUMBER, "at_limit": {"type": "boolean"}}),
        },
        "files": {"type": "array", "items": _TEXT},
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
    limits = dict(zip(best.kept, asked.keep.values(), strict=True))
    return answer(
        "optimise",
        found.scene.title,
        variables=[variable_data(found, i) for i in range(len(asked.variables))],
        minimised={
            "quantity": asked.minimise,
            "unit": found.goal_unit,
            "states": _states(found, best.per_state_before, best.per_state, found.goal),
            "over": asked.over,
            "before": float(found.goal(best.before)),
            "after": float(found.goal(best.value)),
        },
        kept=[
            {
                "quantity": name,
                "unit": unit,
                "states": _states(found, before, after, lambda values: values),
                "limit": limits[name],
                "at_limit": name in reached,
            }
            for name, unit, before, after in found.kept()
        ],
        files=files,
    )


def _states(
    found: Optimised,
    before: FloatArray,
    after: FloatArray,
    shown: Any,  # noqa: ANN401 - a function
) -> list[dict[str, Any]]:
    rows = zip(found.asked.names, shown(before), shown(after), strict=True)
    return [{"state": name, "before": float(a), "after": float(b)} for name, a, b in rows]


def variable_data(found: Optimised, number: int) -> dict[str, Any]:
    """Return what changes of one variable, as plain data."""
    variable, change = found.asked.variables[number], float(found.best.x[number])
    ends = [active.kind for active in found.best.active if active.variable == number]
    return {
        "key": variable.axis.key,
        "unit": unit_of(variable),
        "before": variable.base,
        "after": round(variable.base + change, 9),
        "change": change,
        "range": [variable.low, variable.high] if np.isfinite(variable.high) else None,
        "teeth": round(change * variable.teeth / 360.0) if variable.teeth else None,
        "at_end": ends[0] if ends else "no",
    }


def unit_of(variable: Variable) -> str:
    """Return the unit of a variable's values; ``""`` for a ratio."""
    ending: Mapping[str, Any] = ENDINGS
    name = split(variable.axis.name)[1]
    return str(ending[name].symbol) if name else ""

"""A toleranced driveline in all of its states: the same deviations, the worst of the states."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from cardan.arrays import FloatArray
from cardan.tolerances.box import Box
from cardan.tolerances.case import Case, Quantity


@dataclass(frozen=True, eq=False)
class Design:
    """A driveline with its tolerances, in one state or several.

    Its figures are those of the state in which they are largest. The tolerances are the same in all
    states, and so are the deviations of one driveline from its drawing.

    Attributes:
        cases: the driveline in each state.
    """

    cases: tuple[Case, ...]

    @property
    def box(self) -> Box:
        """The tolerances; the parameters as drawn are those of the first state."""
        return self.cases[0].box

    def in_state(self, state: int) -> Design:
        """Return the driveline in one state alone."""
        return Design((self.cases[state],))

    def scaled(self, group: str, factor: float) -> Design:
        """Return the design with the tolerances of one group multiplied."""
        return replace(self, cases=tuple(case.scaled(group, factor) for case in self.cases))

    def check(self) -> None:
        """Check each state as ``Box.check`` does."""
        for case in self.cases:
            case.box.check()

    def sampled(
        self,
        quantities: Mapping[str, Quantity],
        limits: Mapping[str, float],
        deviations: FloatArray,
    ) -> dict[Any, Any]:
        """Return the largest figure of all states by name, as ``Case.values``.

        By name and state there is also whether the figure is within its limit, if it has one.
        """
        found: dict[Any, Any] = {}
        for state, case in enumerate(self.cases):
            for name, values in case.values(quantities, deviations).items():
                found[name] = np.maximum(found[name], values) if state else values
                if name in limits:
                    found[name, state] = values <= limits[name]
        return found

    def searched(self, quantity: Quantity) -> bool:
        """Whether the worst case is searched over the box, not found to first order."""
        return all(case.searched(quantity) for case in self.cases)

    def largest(self, of: Callable[[Case, Any], float], quantity: Quantity) -> float:
        """Return the largest of the states of a figure: ``Case.worst`` or another method."""
        return max(of(case, quantity) for case in self.cases)

    def worst_state(self, quantity: Quantity) -> int:
        """Return the number of the state with the worst figure."""
        return int(np.argmax([case.worst(quantity) for case in self.cases]))

    def worst_at(self, quantity: Quantity) -> FloatArray:
        """Return the deviations of the worst driveline, ``(parameters,)``."""
        return self.cases[self.worst_state(quantity)].worst_at(quantity)

    def shares(self, quantity: Quantity) -> FloatArray:
        """Return the share of each parameter in the scatter in that state, ``(parameters,)``."""
        return self.cases[self.worst_state(quantity)].shares(quantity)

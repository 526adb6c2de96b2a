"""A toleranced driveline in all of its states: the same deviations, the worst of the states."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from cardan.arrays import FloatArray
from cardan.tolerances.box import Box
from cardan.tolerances.case import Case, Quantity

# Up to this factor, and until the limit is met this closely.
_MOST, _CLOSE, _ROUNDS = 1e6, 1e-11, 100
# Until the factor with which a joint blocks is met this closely, where the limit is not reached
# before. Orders of joints that nearly block need very many samples.
_CLOSE_TO_BLOCKED = 1e-3


@dataclass(frozen=True, eq=False)
class Design:
    """A driveline with its tolerances, in one state or several.

    Its figures are those of the state in which they are largest. The tolerances are the same in all
    states, and so are the deviations of one driveline from its drawing.
    """

    cases: tuple[Case, ...]  # the driveline in each state

    @property
    def box(self) -> Box:
        """The tolerances; the parameters as drawn are those of the first state."""
        return self.cases[0].box

    def scaled(self, group: str, factor: float) -> Design:
        """Return the design with the tolerances of one group multiplied."""
        return replace(self, cases=tuple(case.scaled(group, factor) for case in self.cases))

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

    def worst_case(self, quantity: Quantity) -> Case:
        """Return the driveline in that state."""
        return self.cases[self.worst_state(quantity)]


def permitted_factor(
    design: Design, quantity: Quantity, limit: float, group: str, bound: str
) -> float:
    """Return the factor of the tolerances of one group at which a bound reaches the limit.

    It is NaN if the other tolerances alone exceed the limit, infinite without a factor. If joints
    block before the limit is reached, it is the largest factor with which they turn, or up to 0.1 %
    less.
    """

    def excess(factor: float) -> float:
        scaled = design.scaled(group, factor)
        try:
            for case in scaled.cases:
                case.box.check()
        except ValueError:
            return math.inf
        return scaled.largest(getattr(Case, bound), quantity) / limit - 1.0

    return _root(excess)


def _root(excess: Callable[[float], float]) -> float:
    """The zero above 0 of a function that grows; NaN if it is positive at 0, infinite without one.

    By the Illinois form of the rule of false position, and by halves where the function is
    infinite.
    """
    low, below = 0.0, excess(0.0)
    if below > 0.0:
        return math.nan
    high, above = 1.0, excess(1.0)
    while above <= 0.0:
        low, below, high = high, above, 2.0 * high
        if high > _MOST:
            return math.inf
        above = excess(high)
    side = 0
    for _ in range(_ROUNDS):
        middle = 0.5 * (low + high)
        if math.isfinite(above) and above > below:
            middle = (low * above - high * below) / (above - below)
        if math.isinf(above) and high - low <= _CLOSE_TO_BLOCKED * high:
            return low
        value = excess(middle)
        if abs(value) <= _CLOSE or high - low <= _CLOSE * high:
            return middle
        if value > 0.0:
            high, above = middle, value
            below *= 0.5 if side > 0 else 1.0
            side = 1
        else:
            low, below = middle, value
            above *= 0.5 if side < 0 else 1.0
            side = -1
    return low

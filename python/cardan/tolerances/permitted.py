"""How far the tolerances of one group may grow until a limit is reached."""

from __future__ import annotations

import math
from collections.abc import Callable

from cardan.tolerances.case import Case, Quantity
from cardan.tolerances.design import Design

# Up to this factor, and until the limit is met this closely.
_MOST, _CLOSE, _ROUNDS = 1e6, 1e-11, 100
# Until the factor with which a joint blocks is met this closely, where the limit is not reached
# before. Orders of joints that nearly block need very many samples.
_CLOSE_TO_BLOCKED = 1e-3


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
            scaled.check()
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

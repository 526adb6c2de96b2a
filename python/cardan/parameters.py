"""The parameters of a driveline by which it is differentiated."""

from __future__ import annotations

from typing import Any, Literal, TypeAlias

from cardan.errors import ArgumentTypeError, ArgumentValueError
from cardan.outputs import nearest

Parameters: TypeAlias = Literal["bends", "twists", "phases", "points"]

PARAMETERS: tuple[Parameters, ...] = ("bends", "twists", "phases", "points")
"""The parameters of the geometry."""


def checked_parameters(line: Any, by: str) -> Parameters:  # noqa: ANN401 - a driveline
    """Return the kind of parameters, which the driveline must have."""
    if not isinstance(by, str):
        raise ArgumentTypeError("by", f'is {by!r}; it must be a name, as "bends"')
    for kind in PARAMETERS:
        if by == kind:
            break
    else:
        raise ArgumentValueError("by", f"is {by!r}; {nearest(by, PARAMETERS)}")
    if kind == "points" and not line.has_points:
        raise ArgumentValueError("by", MISSING_POINTS)
    return kind


MISSING_POINTS = (
    "is 'points'; only drivelines from points have them, with the lengths between the points"
)


def parameter_shape(kind: str, n: int) -> tuple[int, ...]:
    """Return the shape of such parameters of a driveline with ``n`` joints."""
    return {"bends": (n,), "twists": (n - 1,), "phases": (n - 1,), "points": (n + 2, 3)}[kind]

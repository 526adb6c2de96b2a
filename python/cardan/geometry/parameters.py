"""The parameters by which the outputs of a driveline are differentiated."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Literal, TypeAlias, TypeVar, get_args

from cardan.arrays.errors import ArgumentTypeError, ArgumentValueError, nearest

if TYPE_CHECKING:
    from cardan.driveline import Driveline

Parameters: TypeAlias = Literal["bends", "twists", "phases", "points"]
"""The parameters of the geometry."""

LayoutVariables: TypeAlias = Literal[Parameters, "lengths", "positions"]
"""The parameters of the geometry, and lengths and positions, on which only forces depend."""

Variables: TypeAlias = Literal[
    Parameters,
    "angle",
    "drive_torque",
    "output_torque",
    "inertias",
    "lengths",
    "positions",
    "deviations",
]
"""Everything by which an output can be differentiated."""

PARAMETERS: tuple[Parameters, ...] = get_args(Parameters)
LAYOUT_VARIABLES: tuple[LayoutVariables, ...] = get_args(LayoutVariables)
VARIABLES: tuple[Variables, ...] = get_args(Variables)

_Kind = TypeVar("_Kind", bound=str)


def checked_kind(line: Driveline, by: str, kinds: tuple[_Kind, ...]) -> _Kind:
    """Return one of some kinds of variables, which the driveline must have."""
    name = _known(line, by, kinds, ())
    return next(known for known in kinds if known == name)


def checked_variables(line: Driveline, by: str | Iterable[str]) -> tuple[str, ...]:
    """Return the names of the variables, each once, as ``checked_kind`` does."""
    listed = (by,) if isinstance(by, str) or not isinstance(by, Iterable) else tuple(by)
    for i, name in enumerate(listed):
        _known(line, name, VARIABLES, (i,))
        if listed.index(name) < i:
            raise ArgumentValueError("by", f"is {name!r} again; name each variable once", (i,))
    return listed


def _known(line: Driveline, by: str, known: tuple[str, ...], place: tuple[int, ...]) -> str:
    if not isinstance(by, str):
        raise ArgumentTypeError("by", f'is {by!r}; it must be a name, as "bends"', place)
    if by not in known:
        raise ArgumentValueError("by", f"is {by!r}; {nearest(by, known)}", place)
    if by == "points" and not line.has_points:
        rule = "only drivelines from points have them, with the lengths between them"
        raise ArgumentValueError("by", f"is 'points'; {rule}", place)
    if by == "points":
        line._geometry.check_ideal("derivatives with respect to points are", "use bends and twists")
    if by == "lengths" and not has_lengths(line):
        raise ArgumentValueError("by", "is 'lengths', which the driveline does not have", place)
    if by == "positions" and not line.n_bearings:
        raise ArgumentValueError("by", "is 'positions'; the driveline has no bearings", place)
    return by


def has_lengths(line: Driveline) -> bool:
    """Whether the lengths of the shafts are known."""
    return bool(line._geometry.lengths.shape[-1])


# How many more than joints there are of the variables of shafts and joints.
_BEYOND_JOINTS = {"bends": 0, "twists": -1, "phases": -1, "inertias": 1, "lengths": 1}


def parameter_shape(name: str, n: int, bearings: int = 0) -> tuple[int, ...]:
    """Return the shape of such variables of a driveline with ``n`` joints."""
    if name in _BEYOND_JOINTS:
        return (n + _BEYOND_JOINTS[name],)
    others = {"points": (n + 2, 3), "positions": (bearings,), "deviations": (n, 3)}
    return others.get(name, ())

"""Errors that name an argument, with fields for programs, so that no program parses the text."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Sequence
from typing import Any, Self, TypeAlias

import numpy as np
from numpy.typing import NDArray

Place: TypeAlias = tuple[int | str, ...]


class ArgumentError(Exception):
    """An argument that breaks a rule: the argument, the place in it, the value and the rule.

    Every such error is an ``ArgumentValueError`` or an ``ArgumentTypeError``, and therefore a
    ``ValueError`` or a ``TypeError``. Its text is ``argument``, ``place`` and ``problem`` in one
    sentence. It can be pickled, so it arrives complete from the workers of a cluster.

    Attributes:
        argument: the name of the argument, such as ``"bends"``.
        place: the position within the argument, outermost index first, or a name; ``()`` for the
            whole argument.
        problem: the offending value and the rule.
        value: the offending value, if the problem is one value that breaks a rule.
        unit: its unit, if it has one.
        rule: the rule.

    >>> import cardan
    >>> try:
    ...     cardan.Driveline.from_bends([10, 95], degrees=True)
    ... except cardan.ArgumentError as error:
    ...     print(error.argument, error.place, error.problem, sep=" | ")
    bends | (1,) | is 95.0 deg; a bend must lie in [0, 90) deg
    """

    argument: str
    place: Place
    problem: str
    value: float | None
    unit: str
    rule: str

    def __init__(
        self,
        argument: str,
        problem: str,
        place: Place = (),
        value: float | None = None,
        unit: str = "",
        rule: str = "",
    ) -> None:
        """Make an error of its fields."""
        super().__init__(argument, problem, place, value, unit, rule)
        self.argument, self.problem, self.place = argument, problem, place
        self.value, self.unit, self.rule = value, unit, rule

    def at(self, place: Place) -> Self:
        """Return the same error at another place."""
        return type(self)(self.argument, self.problem, place, self.value, self.unit, self.rule)

    def __str__(self) -> str:
        """Return the sentence: ``bends[1] is 95.0 deg; a bend must lie in [0, 90) deg``."""
        return f"{located(self.argument, self.place)} {self.problem}"


class ArgumentValueError(ArgumentError, ValueError):
    """An argument of the right type with a wrong value."""


class ArgumentTypeError(ArgumentError, TypeError):
    """An argument of a wrong type."""


# Users know them by these names, which tracebacks show.
for _class in (ArgumentError, ArgumentValueError, ArgumentTypeError):
    _class.__module__ = "cardan"


def located(argument: str, place: Place) -> str:
    """Return an argument with a place in it, as Python writes it: ``bends[0, 2]``."""
    return f"{argument}[{', '.join(map(repr, place))}]" if place else argument


def check_elements(
    argument: str, array: NDArray[Any], right: NDArray[np.bool_] | np.bool_, rule: str
) -> None:
    """Raise the error for the first element of an array that is not right, if there is one.

    The rule follows the value: a unit, if any, and ``"; it must be finite"``.
    """
    if np.all(right):
        return
    place = tuple(int(i) for i in np.argwhere(~np.asarray(right))[0])
    unit, _, words = rule.partition("; ")
    problem, value = f"is {array[place]!s}{rule}", float(array[place])
    raise ArgumentValueError(argument, problem, place, value, unit.strip(), words)


def check_shape(argument: str, of: Any, right: bool, rule: str, place: Place = ()) -> None:  # noqa: ANN401
    """Raise the error for an array or a batch of a wrong shape; the rule says what it must be."""
    if not right:
        raise ArgumentValueError(argument, f"has shape {of.shape}; {rule}", place)


def require(argument: str, right: object, problem: str, place: Place = ()) -> None:
    """Raise an ``ArgumentValueError`` with a problem unless the argument is right."""
    if not right:
        raise ArgumentValueError(argument, problem, place)


def exclusive(**given: object) -> None:
    """Raise an error if both of two arguments are given."""
    (one, value), (other, beside) = given.items()
    if value is not None and beside is not None:
        raise ArgumentValueError(one, f"and {other} are both given; give one of them")


def check_choice(argument: str, value: object, known: Sequence[str]) -> None:
    """Raise an ``ArgumentValueError`` unless a value is one of some words."""
    if not isinstance(value, str) or value not in known:
        *others, last = map(repr, known)
        wanted = f"{', '.join(others)} or {last}"
        raise ArgumentValueError(argument, f"is {value!r}; it must be {wanted}")


def nearest(name: str, known: Iterable[str]) -> str:
    """Say which known name is meant, or list them all."""
    known = list(known)
    close = difflib.get_close_matches(name, known, n=1)
    return f"did you mean {close[0]!r}?" if close else f"known are {', '.join(known)}"

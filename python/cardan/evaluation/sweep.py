"""Uniform sweeps of the drive."""

from __future__ import annotations

import functools
import math
from typing import Any, Self, SupportsIndex

import numpy as np

from cardan._core import Sweep as NativeSweep
from cardan.arrays import FloatArray, keep
from cardan.arrays.errors import ArgumentTypeError, ArgumentValueError
from cardan.arrays.indices import integer


class Sweep:
    """Drive angles at equal steps, in place of an array for ``evaluate`` and plans.

    ``Sweep(start, stop, num)`` runs from ``start`` to ``stop``, both included, like
    ``numpy.linspace``. ``Sweep.revolutions`` runs over whole turns. A sweep acts as an array of
    shape ``(num,)`` but is never stored. Its angles are exact: sample ``i`` is at ``start + i *
    (stop - start) / (num - 1)``, or at that part of a turn, and not at the nearest double. Turns
    that repeat are computed once.

    Attributes:
        num: number of angles.
    """

    __slots__ = ("_core", "_given", "num")
    num: int
    _core: NativeSweep
    _given: tuple[float, ...]

    def __init__(
        self, start: float, stop: float, num: SupportsIndex, *, degrees: bool = False
    ) -> None:
        """Sweep from ``start`` to ``stop``, both included.

        Args:
            start: first angle in rad or degrees.
            stop: last angle in rad or degrees.
            num: number of angles; one angle is ``start``.
            degrees: whether the ends are in degrees; each is rounded to a double in rad.

        Raises:
            TypeError: a number of angles that is not an integer, ends that are not real numbers.
            ValueError: no angles; an end that is not finite or beyond 1e12 rad.
        """
        count = _whole("num", num)
        ends = (_end("start", start), _end("stop", stop))
        given = (*ends, count, True) if degrees else (*ends, count)
        if degrees:
            ends = (math.radians(ends[0]), math.radians(ends[1]))
        keep(self, _core=NativeSweep(ends, count, 0), num=count, _given=given)

    @classmethod
    def revolutions(cls, turns: float, samples: SupportsIndex) -> Self:
        """Sweep whole turns from 0, without the end point.

        Args:
            turns: number of turns; they make a whole number of samples.
            samples: samples per turn.

        Raises:
            TypeError: a number of samples that is not an integer, turns that are not a number.
            ValueError: no samples, a part of one, or more than 2**50.
        """
        per_turn = _whole("samples", samples)
        asked = _end("turns", turns)
        count = asked * per_turn
        # A part of a turn is rounded, and so is its product: 0.7 turns of 720 samples are 504.
        if math.isfinite(count) and round(count) / per_turn == asked:
            count = float(round(count))
        if not count.is_integer() or count < 1.0:
            rule = "together that must be a whole number of at least 1"
            raise ArgumentValueError("turns", f"is {turns} of {per_turn} samples each; {rule}")
        number = _whole("turns times samples", int(count))
        self = object.__new__(cls)
        core = NativeSweep(None, number, per_turn)
        keep(self, _core=core, num=number, _given=(turns, per_turn))
        return self

    def __setattr__(self, name: str, value: object) -> None:
        """Refuse: sweeps do not change."""
        raise AttributeError(f"a sweep cannot change; {name} stays")

    @property
    def shape(self) -> tuple[int]:
        """Shape of the array that it stands for."""
        return (self.num,)

    @property
    def unit(self) -> str:
        """Unit in which it was made: ``"rad"``, ``"deg"`` or ``"turn"``."""
        return {2: "turn", 3: "rad", 4: "deg"}[len(self._given)]

    def in_degrees(self) -> FloatArray:
        """Return the angles in degrees, as an array of the nearest doubles where they were so made.

        Those of whole turns are exact where ``360 / samples`` is.
        """
        if self.unit == "rad":
            return np.degrees(np.asarray(self))
        if self.unit == "deg":
            start, stop = self._given[:2]
            return np.linspace(start, stop, self.num, dtype=np.float64)
        return np.asarray(np.arange(self.num) * 360.0 / self._given[1], np.float64)

    def __len__(self) -> int:
        """Return the number of angles."""
        return self.num

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> FloatArray:  # noqa: ANN401
        """Return the angles as an array of the nearest doubles."""
        if copy is False:
            raise ValueError("a sweep holds no array; one must be made")
        angles = np.empty(self.num)
        self._core.fill(0, angles)
        return angles if dtype is None else angles.astype(dtype)

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle as made."""
        if self.unit == "turn":
            return (Sweep.revolutions, self._given)
        start, stop, num, *degrees = self._given
        return (functools.partial(Sweep, degrees=bool(degrees)), (start, stop, num))

    def __eq__(self, other: object) -> bool:
        """Compare what the sweeps were made from."""
        return self._given == other._given if isinstance(other, Sweep) else NotImplemented

    def __hash__(self) -> int:
        """Hash what it was made from."""
        return hash(self._given)

    def __repr__(self) -> str:
        """Show how to make it."""
        given = ", ".join(map(str, self._given[:3]))
        if self.unit == "turn":
            return f"Sweep.revolutions({given})"
        return f"Sweep({given}, degrees=True)" if self.unit == "deg" else f"Sweep({given})"


def _whole(name: str, value: SupportsIndex) -> int:
    count = integer(name, value, 1)
    if count > NativeSweep.LONGEST:
        most = f"a sweep has at most {NativeSweep.LONGEST} samples"
        raise ArgumentValueError(name, f"is {count}; {most}")
    return count


def _end(name: str, value: float) -> float:
    try:
        if not isinstance(value, str | bytes):
            return float(value)
    except OverflowError:
        return math.inf
    except (TypeError, ValueError):
        pass
    raise ArgumentTypeError(name, f"is {value!r}; it must be a number")

"""The quantities that can be minimised or kept below a limit, as vectors that are smooth."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from cardan.arrays import FloatArray
from cardan.driveline import Driveline
from cardan.errors import ArgumentTypeError, ArgumentValueError
from cardan.load import Load
from cardan.outputs import OUTPUTS, Output, nearest
from cardan.request import REDUCTIONS
from cardan.sweep import Sweep

Vectors: TypeAlias = NDArray[np.float64] | NDArray[np.complex128]

Quantity: TypeAlias = str | Callable[[Driveline], Any]
"""A name, or a function of a driveline with one value for each state."""

# The motion repeats after half a turn, and so does every load.
_HALF_TURN = Sweep(0.0, math.pi, 181)


@dataclass(frozen=True, eq=False)
class Measure:
    """A quantity whose figure grows with the length of a vector that is smooth.

    The equivalent bend goes as the root of ``|q|`` and has an infinite slope at constant velocity.
    Its vector is ``q``, so that ``|q|**2`` is smooth everywhere.

    Attributes:
        name: the quantity.
        unit: SI unit of its figure; ``"1"`` for a ratio, ``""`` if unknown.
        vectors: of a batch of drivelines: ``(*batch, r)``, the largest of which counts.
        figure: from the length of a vector.
        length: of a vector, from the figure.
        of_q: whether the vector is ``q`` of the last shaft.
    """

    name: str
    unit: str
    vectors: Callable[[Driveline], Vectors]
    figure: Callable[[Any], Any]
    length: Callable[[float], float]
    of_q: bool = False

    def per_state(self, vectors: Vectors) -> FloatArray:
        """Return the figure of each state, ``(states,)``."""
        return np.asarray(self.figure(np.max(np.abs(vectors), axis=-1)))


def over_states(vectors: Vectors, weights: FloatArray | None) -> float:
    """Return the length that counts for all states.

    Args:
        vectors: of every state, ``(states, r)``.
        weights: of the states in the root mean square, with sum 1; ``None`` for the largest.
    """
    squares = np.abs(vectors) ** 2
    if weights is None:
        return float(np.sqrt(np.max(squares)))
    return float(np.sqrt(weights @ np.mean(squares, axis=-1)))


def _q(line: Driveline) -> Vectors:
    return np.asarray(line.transmission().q)[..., np.newaxis]


def _excitation(line: Driveline) -> Vectors:
    """Second-order accelerations of all intermediate shafts together, driving and coasting.

    ``-4 q exp(-2 i a)`` is the second-order acceleration of a shaft, so the amplitude of the sum
    is that of the check (``cardan.check``).
    """
    found = np.zeros((*line.shape, 2), dtype=np.complex128)
    for way, driven in enumerate((line, line.reversed())):
        for shaft in range(1, line.n_joints):
            found[..., way] += 4.0 * driven.transmission(shaft).q
    return found


def _same(value: Any) -> Any:  # noqa: ANN401 - a number or an array
    return value


_MOTION: Mapping[str, Measure] = MappingProxyType(
    {
        "equivalent_bend": Measure(
            "equivalent_bend",
            "rad",
            _q,
            lambda k: 2.0 * np.arctan(np.sqrt(k)),
            lambda bend: math.tan(bend / 2.0) ** 2,
            of_q=True,
        ),
        # U = (1 + k)/(1 - k) - (1 - k)/(1 + k), with cos(bend) = (1 - k)/(1 + k).
        "non_uniformity": Measure(
            "non_uniformity",
            "1",
            _q,
            lambda k: 4.0 * k / (1.0 - k * k),
            lambda u: u / (2.0 + math.hypot(2.0, u)),
            of_q=True,
        ),
        "max_angle_error": Measure(
            "max_angle_error", "rad", _q, np.arcsin, lambda error: math.sin(error), of_q=True
        ),
        "inertia_excitation": Measure("inertia_excitation", "1", _excitation, _same, _same),
    }
)

MOTION_QUANTITIES = tuple(_MOTION)
"""The quantities that need neither samples nor a load."""

# The end of the range of an angle: from there on the figure of a limit has no length.
_LARGEST = {"equivalent_bend": math.pi / 2.0, "max_angle_error": math.pi / 2.0}


def measure_of(argument: str, quantity: Quantity, n_joints: int, load: Load | None) -> Measure:
    """Return the measure of a quantity.

    Args:
        argument: what to call the quantity in errors.
        quantity: a name of ``MOTION_QUANTITIES``; an output, its shaft, joint or bearing and its
            reduction: ``"support_moment_1_peak"``; or a function of a driveline.
        n_joints: of the driveline.
        load: for outputs that need one.

    Raises:
        IndexError: a shaft, joint or bearing that does not exist.
        TypeError: something else.
        ValueError: an unknown name, a load that is missing.
    """
    if callable(quantity):
        return _of_function(argument, quantity)
    if not isinstance(quantity, str):
        raise ArgumentTypeError(
            argument, f"is {quantity!r}; it must be a name or a function of a driveline"
        )
    if quantity == "inertia_excitation" and n_joints == 1:
        raise ArgumentValueError(
            argument, "is 'inertia_excitation'; one joint has no shaft between two joints"
        )
    if quantity in _MOTION:
        return _MOTION[quantity]
    name, item, reduction = split(quantity)
    if not name:
        raise ArgumentValueError(
            argument,
            f"is {quantity!r}; {nearest(quantity, MOTION_QUANTITIES)}, or an output with the "
            "number of its shaft, joint or bearing and its reduction, as 'support_moment_1_peak'",
        )
    if OUTPUTS[name].needs_load and load is None:
        raise ArgumentValueError(argument, f"is {quantity!r}; it needs a load")
    return _of_output(quantity, name, item, reduction, load)


def pattern(output: Output) -> str:
    """Return the regular expression of the names of an output's reductions."""
    number = "(_[0-9]{1,9})?" if output.per == "shaft" else "_[0-9]{1,9}"
    return f"{output.name}{number}_({'|'.join(REDUCTIONS)})"


def split(quantity: str) -> tuple[str, int | None, str]:
    """Return output, item and reduction of the name of a reduced output; ``""`` if it is none.

    >>> split("support_moment_1_peak")
    ('support_moment', 1, 'peak')
    """
    for name, output in OUTPUTS.items():
        if re.fullmatch(pattern(output), quantity):
            rest, _, reduction = quantity.rpartition("_")
            number = rest.removeprefix(name)
            return name, int(number[1:]) if number else None, reduction
    return "", None, ""


def largest_limit(name: str) -> float:
    """Return what a limit of a quantity must be below."""
    return _LARGEST.get(name, math.inf)


def _of_output(
    quantity: str, name: str, item: int | None, reduction: str, load: Load | None
) -> Measure:
    per = OUTPUTS[name].per
    options: dict[str, Any] = {"reduce": reduction, "load": load}
    if per != "bearing":
        options[f"{per}s"] = -1 if item is None else item

    def vectors(line: Driveline) -> Vectors:
        angles: Any = _HALF_TURN
        values = np.asarray(line[..., np.newaxis].evaluate(angles, name, **options)[name])
        if per == "bearing":
            values = values[item]
        if OUTPUTS[name].vector and reduction != "peak":
            values = np.linalg.norm(values, axis=-1)
        return values[..., np.newaxis]

    return Measure(quantity, OUTPUTS[name].unit, vectors, _same, _same)


def _of_function(argument: str, function: Callable[[Driveline], Any]) -> Measure:
    name = getattr(function, "__name__", "function")

    def vectors(line: Driveline) -> Vectors:
        values = np.asarray(function(line), dtype=np.float64)
        if values.shape != line.shape:
            raise ArgumentValueError(
                argument,
                f"returned shape {values.shape}; it must return one value for each state, "
                f"{line.shape}",
            )
        return values[..., np.newaxis]

    return Measure(name, "", vectors, _same, _same)

"""The quantities by which a driveline is judged, toleranced and optimised, each named once.

Those of the motion grow with the magnitude of a complex number. Those of an output name it, the
shaft, joint or bearing, and the reduction of its samples: ``support_moment_1_peak``.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Literal, TypeAlias

import numpy as np

from cardan.arrays import FloatArray
from cardan.load import Load
from cardan.outputs import OUTPUTS, Output, nearest
from cardan.request import REDUCTIONS, Items, Reduction, item_index
from cardan.sweep import Sweep

Amplitude: TypeAlias = Literal["last", "driving", "coasting"]
"""``q`` of a shaft; the sum of ``q`` over the intermediate shafts, driven from either end."""


@dataclass(frozen=True)
class MotionQuantity:
    """A quantity of the motion, which grows with the magnitude of an amplitude.

    Attributes:
        name: by which to request it.
        label: what to call it in words.
        unit: its SI unit; ``"1"`` for a ratio.
        amplitudes: the complex numbers of which it is a function; the largest magnitude counts.
        ratio: the function; of an excitation at a drive speed of 1 rad/s.
        limit: the key of ``Limits.figures`` that limits it.
        largest: what it stays below.
    """

    name: str
    label: str
    unit: str
    amplitudes: tuple[Amplitude, ...]
    ratio: Callable[[Any], Any]
    limit: str
    largest: float = math.inf

    @property
    def needs_speed(self) -> bool:
        """Whether it is an acceleration, which grows with the square of the drive speed."""
        return self.unit == "rad/s²"

    @property
    def of_last(self) -> bool:
        """Whether it is a function of ``q`` of a single shaft."""
        return self.amplitudes == ("last",)

    def at(self, modulus: Any, speed: float) -> Any:  # noqa: ANN401 - a number or an array
        """Return the quantity of a magnitude, at a speed of the drive in rad/s."""
        return self.ratio(modulus) * speed**2 if self.needs_speed else self.ratio(modulus)


def modulus_of_bend(bend: Any) -> Any:  # noqa: ANN401 - a number or an array
    """Return ``|q|`` of a joint with this bend in rad."""
    return np.tan(0.5 * bend) ** 2


def _bend(k: Any) -> Any:  # noqa: ANN401
    return 2.0 * np.arctan(np.sqrt(k))


def _non_uniformity(k: Any) -> Any:  # noqa: ANN401
    """``(1 + k)/(1 - k) - (1 - k)/(1 + k)``, with ``cos(bend) = (1 - k)/(1 + k)``."""
    return 4.0 * k / ((1.0 - k) * (1.0 + k))


def _torsional(k: Any) -> Any:  # noqa: ANN401
    """Largest acceleration of a shaft: ``(1 - k²) 4 k sin x/(1 - 2 k cos x + k²)²`` at its peak."""
    square = 1.0 + k * k
    cosine = 8.0 * k / (square + np.sqrt(square * square + 32.0 * k * k))
    sine = np.sqrt(1.0 - cosine * cosine)
    return (1.0 - k * k) * 4.0 * k * sine / np.square(square - 2.0 * k * cosine)


def _second_order(k: Any) -> Any:  # noqa: ANN401
    """Second-order amplitude of the acceleration ``Re(4 i q u g²)`` of one or more shafts."""
    return 4.0 * k


_BEND, _TORSIONAL, _INERTIA = (
    "equivalent_bend_deg",
    "torsional_excitation_rad_s2",
    "inertia_excitation_rad_s2",
)

MOTION_QUANTITIES: Mapping[str, MotionQuantity] = MappingProxyType(
    {
        quantity.name: quantity
        for quantity in (
            MotionQuantity(
                "equivalent_bend", "equivalent bend", "rad", ("last",), _bend, _BEND, math.pi / 2.0
            ),
            MotionQuantity(
                "non_uniformity", "non-uniformity", "1", ("last",), _non_uniformity, _BEND
            ),
            MotionQuantity(
                "max_angle_error",
                "largest angle error",
                "rad",
                ("last",),
                np.arcsin,
                _BEND,
                math.pi / 2.0,
            ),
            MotionQuantity(
                "torsional_excitation",
                "torsional excitation",
                "rad/s²",
                ("last",),
                _torsional,
                _TORSIONAL,
            ),
            MotionQuantity(
                "inertia_excitation",
                "inertia excitation",
                "rad/s²",
                ("driving", "coasting"),
                _second_order,
                _INERTIA,
            ),
            MotionQuantity(
                "inertia_excitation_driving",
                "inertia excitation, driving",
                "rad/s²",
                ("driving",),
                _second_order,
                _INERTIA,
            ),
            MotionQuantity(
                "inertia_excitation_coasting",
                "inertia excitation, coasting",
                "rad/s²",
                ("coasting",),
                _second_order,
                _INERTIA,
            ),
        )
    }
)
"""The quantities that need neither samples nor a load, by name."""


_SAMPLES_PER_TURN = 360

# Of these a turn of the drive is the period; all else repeats after half a turn.
_PER_TURN = frozenset({"angle", "tilt_driving", "tilt_driven"})


@dataclass(frozen=True, eq=False)
class ReducedQuantity:
    """An output over a turn of the drive, reduced to one number.

    Attributes:
        output: what is evaluated.
        items: of which shafts or joints, as ``Driveline.evaluate`` takes them, or the index of a
            bearing; the largest value counts. ``None``: the last shaft, all joints or bearings.
        reduction: of the samples; of a vector, the length of what it makes of the components.
    """

    output: Output
    items: Items
    reduction: Reduction

    @property
    def unit(self) -> str:
        """SI unit; ``"1"`` for a ratio."""
        return self.output.unit

    @property
    def label(self) -> str:
        """What to call it in words: ``support moment of shaft 1, peak``."""
        of = "" if self.items is None else f" of {self.output.per} {self.items}"
        return f"{self.output.label}{of}, {self.reduction}"

    def check_item(self, line: Any) -> None:  # noqa: ANN401 - a driveline
        """Check that a driveline has the shaft, joint or bearing that the quantity names.

        Raises:
            IndexError: it has none.
        """
        per = self.output.per
        counts = {"shaft": line.n_joints + 1, "joint": line.n_joints, "bearing": line.n_bearings}
        if isinstance(self.items, int):
            item_index(f"{per} of {self.output.name}", self.items, counts[per])

    def of(self, line: Any, load: Load | None, workers: int | None = None) -> FloatArray:  # noqa: ANN401
        """Return the number of each driveline, in the shape of the batch.

        Args:
            line: the drivelines.
            load: for an output that needs one; its values broadcast to the batch.
            workers: largest number of threads, as for ``Driveline.evaluate``.

        Raises:
            IndexError: a shaft, joint or bearing that does not exist.
            ValueError: as of ``Driveline.evaluate``.
        """
        name, per = self.output.name, self.output.per
        turns = 1.0 if name in _PER_TURN else 0.5
        items = {} if per == "bearing" else {f"{per}s": self.items}
        values = np.asarray(
            line[..., np.newaxis].evaluate(
                Sweep.revolutions(turns, _SAMPLES_PER_TURN),
                name,
                reduce=self.reduction,
                load=None if load is None else load.at_any_angle(),
                workers=workers,
                **items,
            )[name]
        )
        if per == "bearing" and self.items is not None:
            values = values[self.items]
        if self.output.vector and self.reduction != "peak":
            values = np.linalg.norm(values, axis=-1)
        return np.asarray(values if values.ndim == len(line.shape) else np.max(values, axis=0))


def reduced_quantity(name: str) -> ReducedQuantity | None:
    """Return the reduced output of a name; ``None`` if it is not one.

    >>> reduced_quantity("support_moment_1_peak").items
    1
    """
    for output in OUTPUTS.values():
        if re.fullmatch(pattern(output), name):
            rest, _, last = name.rpartition("_")
            number = rest.removeprefix(output.name)
            reduction = next(known for known in REDUCTIONS if known == last)
            return ReducedQuantity(output, int(number[1:]) if number else None, reduction)
    return None


def pattern(output: Output) -> str:
    """Return the regular expression of the names of an output's reductions."""
    number = "(_[0-9]{1,9})?" if output.per == "shaft" else "_[0-9]{1,9}"
    return f"{output.name}{number}_({'|'.join(REDUCTIONS)})"


def nearest_quantity(name: str, known: Iterable[str] = MOTION_QUANTITIES) -> str:
    """Say which quantity is meant by a name, or which there are.

    Args:
        name: what was given.
        known: the names that are possible, besides those of reduced outputs.
    """
    return (
        f"{nearest(name, known)}, or an output with the number of its shaft, joint or bearing and "
        "its reduction, as 'support_moment_1_peak'"
    )


def label(name: str) -> str:
    """Return a quantity or an output in words."""
    if name in MOTION_QUANTITIES:
        return MOTION_QUANTITIES[name].label
    reduced = reduced_quantity(name)
    if reduced:
        return reduced.label
    return OUTPUTS[name].label if name in OUTPUTS else name.replace("_", " ")

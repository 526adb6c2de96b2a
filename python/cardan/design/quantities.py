"""The quantities by which a driveline is judged, toleranced and optimised, each named once.

They are those of the motion, one order of the motion of a shaft, and an output with its shaft,
joint or bearing and a reduction of its samples.

With the complex amplitude ``c`` of order ``m`` of the angle error, a part of a shaft's rotation is
``Re c exp(i m a)``. At a steady speed of the drive its acceleration has the amplitude ``(m
speed)**2 |c|``.
"""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, Literal, TypeAlias, TypeVar, get_args

import numpy as np

from cardan.arrays import ComplexArray, FloatArray
from cardan.arrays.errors import nearest
from cardan.arrays.indices import Items, item_index
from cardan.evaluation.load import Load
from cardan.evaluation.outputs import OUTPUTS, Output
from cardan.evaluation.reductions import REDUCTIONS, Reduction
from cardan.evaluation.sweep import Sweep

if TYPE_CHECKING:
    from cardan.driveline import Driveline
    from cardan.evaluation.plan import Plan

_Kind = TypeVar("_Kind", bound=str)

_SAMPLES_PER_TURN = 360

Amplitude: TypeAlias = Literal["last", "driving", "coasting"]
"""``q`` of a shaft; the sum of ``q`` over the intermediate shafts, driven from either end."""


@dataclass(frozen=True)
class MotionQuantity:
    """A quantity of the motion, which grows with the magnitude of an amplitude."""

    name: str  # by which to request it
    label: str  # what to call it in words
    unit: str  # SI; "1" for a ratio
    amplitudes: tuple[Amplitude, ...]  # of which it is a function; the largest magnitude counts
    ratio: Callable[[Any], Any]  # the function; of an excitation at a drive speed of 1 rad/s
    limit: str  # the key of ``Limits.figures`` that limits it
    largest: float = math.inf  # what it stays below

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


_BEND, _TORSIONAL = "equivalent_bend_deg", "torsional_excitation_rad_s2"
_LAST: tuple[Amplitude, ...] = ("last",)
_RIGHT_ANGLE = math.pi / 2.0


def _inertia(name: str, label: str, *amplitudes: Amplitude) -> MotionQuantity:
    limit = "inertia_excitation_rad_s2"
    return MotionQuantity(name, label, "rad/s²", amplitudes, _second_order, limit)


_EVERY = (
    MotionQuantity("equivalent_bend", "equivalent bend", "rad", _LAST, _bend, _BEND, _RIGHT_ANGLE),
    MotionQuantity("non_uniformity", "non-uniformity", "1", _LAST, _non_uniformity, _BEND),
    MotionQuantity(
        "max_angle_error", "largest angle error", "rad", _LAST, np.arcsin, _BEND, _RIGHT_ANGLE
    ),
    MotionQuantity(
        "torsional_excitation", "torsional excitation", "rad/s²", _LAST, _torsional, _TORSIONAL
    ),
    _inertia("inertia_excitation", "inertia excitation", "driving", "coasting"),
    _inertia("inertia_excitation_driving", "inertia excitation, driving", "driving"),
    _inertia("inertia_excitation_coasting", "inertia excitation, coasting", "coasting"),
)

MOTION_QUANTITIES: Mapping[str, MotionQuantity] = MappingProxyType(
    {quantity.name: quantity for quantity in _EVERY}
)
"""The quantities that need neither samples nor a load, by name."""


Ordered: TypeAlias = Literal["angle_error", "acceleration"]
ORDERED: tuple[Ordered, ...] = get_args(Ordered)
"""What has orders as quantities."""

ORDER_PATTERN = f"({'|'.join(ORDERED)})_order_([1-9][0-9]?)"
"""Regular expression of their names."""

FIRST_ORDERS = tuple(f"{of}_order_1" for of in ORDERED)
"""The names of order 1."""


@dataclass(frozen=True)
class OrderQuantity:
    """The amplitude of one order of the motion of a shaft, of angles in rad."""

    of: Ordered  # the second in rad/s² at the speed of the drive
    order: int  # of the drive's rotation

    @property
    def unit(self) -> str:
        """SI unit."""
        return "rad" if self.of == "angle_error" else "rad/s²"

    @property
    def amplitudes(self) -> tuple[int]:
        """The order whose amplitude it is a function of."""
        return (self.order,)

    @property
    def label(self) -> str:
        """What to call it in words: ``order 1 of the acceleration``."""
        return f"order {self.order} of the {self.of.replace('_', ' ')}"

    @property
    def needs_speed(self) -> bool:
        """Whether it is an acceleration, which grows with the square of the drive speed."""
        return self.of == "acceleration"

    def at(self, modulus: Any, speed: float) -> Any:  # noqa: ANN401 - a number or an array
        """Return the quantity of an amplitude of the angle error, at a drive speed in rad/s."""
        return modulus * (self.order * speed) ** 2 if self.needs_speed else modulus


def order_quantity(name: str) -> OrderQuantity | None:
    """Return the order of a name; ``None`` if it is not one.

    >>> order_quantity("acceleration_order_1").order
    1
    """
    found = re.fullmatch(ORDER_PATTERN, name)
    if found is None:
        return None
    of = next(known for known in ORDERED if known == found[1])
    return OrderQuantity(of, int(found[2]))


def order_amplitude(line: Driveline, order: int, shaft: int) -> ComplexArray:
    """Return the complex amplitude of an order of the angle error in rad, one per driveline.

    The speed ratio is 1 and the derivative of the angle error. Its samples do not need the mean
    over the turn, which takes longest of joints as built.
    """
    found = line.harmonics([order], shaft, outputs="speed_ratio")
    return np.asarray(found.complex_amplitude["speed_ratio"][..., 0] / (1j * order))


def farthest_signs(middle: complex, vectors: ComplexArray) -> FloatArray:
    """Return the signs of the vectors whose sum with the middle is farthest from zero.

    Seen from a direction, the farthest corner adds each vector with the sign of its part along the
    direction. Signs change only where a direction is at a right angle to a vector.
    """
    known = vectors[vectors != 0.0]
    if not len(known):
        return np.ones(len(vectors))
    turned = np.unique((np.angle(known) + 0.5 * np.pi) % np.pi)
    between = turned + 0.5 * (np.roll(turned, -1) - turned + np.pi * (turned == turned[-1]))
    directions = np.exp(1j * np.concatenate([between, between + np.pi]))
    signs = np.where(np.outer(directions.conj(), vectors).real < 0.0, -1.0, 1.0)
    return np.asarray(signs[np.argmax(np.abs(middle + signs @ vectors))])


@dataclass(frozen=True, eq=False)
class ReducedQuantity:
    """An output over a turn of the drive, reduced to one number.

    The items are shafts or joints as ``Driveline.evaluate`` takes them, or the index of a bearing;
    the largest value counts. ``None`` is the last shaft, all joints or bearings. Of a vector, the
    length of what the reduction makes of the components counts.
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

    def check_item(self, line: Driveline) -> None:
        """Check that a driveline has the shaft, joint or bearing that the quantity names."""
        per = self.output.per
        counts = {"shaft": line.n_joints + 1, "joint": line.n_joints, "bearing": line.n_bearings}
        if isinstance(self.items, int):
            item_index(f"{per} of {self.output.name}", self.items, counts[per])

    def of(self, line: Driveline, load: Load | None, workers: int | None = None) -> FloatArray:
        """Return the number of each driveline, in the shape of the batch.

        The values of a load broadcast to the batch.
        """
        self.check_item(line)
        values = self._plan(line, load, workers)(self._angles(line))[self.output.name]
        sizes = self._sizes(np.asarray(values))
        if self._bearing is not None:
            sizes = sizes[self._bearing]
        return np.asarray(sizes if sizes.ndim == len(line.shape) else np.max(sizes, axis=0))

    def derivatives(
        self, line: Driveline, load: Load | None, by: Iterable[_Kind]
    ) -> dict[_Kind, FloatArray]:
        """Return the derivatives of ``of`` by parameters of each driveline.

        An end of the samples changes as the sample at which it lies, and the largest of several
        items as that item. The parameters are any of ``LAYOUT_VARIABLES`` that the drivelines
        have, or the deviations of joints as built; their axes follow those of the batch.
        """
        plan, name, batch = self._plan(line, load), self.output.name, len(line.shape)
        values = np.asarray(plan(self._angles(line))[name])
        sizes, weights = self._sizes(values), np.ones_like(values)
        if sizes.ndim < values.ndim:
            # A length that vanishes has no direction to grow in.
            lengths = sizes[..., np.newaxis]
            weights = np.divide(values, lengths, out=np.zeros_like(values), where=lengths > 0.0)
        if sizes.ndim > batch:
            number = np.argmax(sizes, axis=0) if self._bearing is None else self._bearing
            chosen = np.arange(len(sizes)).reshape(-1, *(1,) * batch) == number % len(sizes)
            weights = weights * chosen.reshape(chosen.shape + (1,) * (weights.ndim - chosen.ndim))
        gradient = plan.gradient(self._angles(line), {name: weights})
        return {kind: np.squeeze(getattr(gradient, kind), axis=batch) for kind in by}

    def _sizes(self, values: FloatArray) -> FloatArray:
        """What counts of the reduced output: of a vector, except a peak, its length."""
        of_vector = self.output.vector and self.reduction != "peak"
        return np.linalg.norm(values, axis=-1) if of_vector else values

    @property
    def _bearing(self) -> int | None:
        """The only bearing that counts: a plan has all of them."""
        return self.items if self.output.per == "bearing" and isinstance(self.items, int) else None

    def _angles(self, line: Driveline) -> Sweep:
        # Joints as built repeat after a whole turn only. All else repeats after half a turn.
        whole = self.output.name == "angle" or self.output.of_cross or line.has_deviations
        return Sweep.revolutions(1.0 if whole else 0.5, _SAMPLES_PER_TURN)

    def _plan(self, line: Driveline, load: Load | None, workers: int | None = None) -> Plan:
        """The plan of the output for drivelines with an axis for the drive angles."""
        per = self.output.per
        items: dict[str, Any] = {} if per == "bearing" else {f"{per}s": self.items}
        at = None if load is None else load.at_any_angle()
        return line[..., np.newaxis].plan(
            self.output.name, load=at, reduce=self.reduction, workers=workers, **items
        )


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
    """Say which quantity is meant by a name, or which there are besides reduced outputs."""
    return (
        f"{nearest(name, known)} (an output has the number of its shaft, joint or bearing and its "
        "reduction, as 'support_moment_1_peak')"
    )


def label(name: str) -> str:
    """Return a quantity or an output in words."""
    if name in MOTION_QUANTITIES:
        return MOTION_QUANTITIES[name].label
    own = reduced_quantity(name) or order_quantity(name)
    if own:
        return own.label
    return OUTPUTS[name].label if name in OUTPUTS else name.replace("_", " ")

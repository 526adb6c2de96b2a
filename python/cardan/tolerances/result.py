"""What tolerances do to a driveline: the worst case, bounds, quantiles and shares."""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Iterable, Mapping
from functools import cached_property
from typing import Any, SupportsIndex

import numpy as np
from numpy.typing import ArrayLike

from cardan.arrays import FloatArray, as_float64, scalar_or_array
from cardan.errors import ArgumentTypeError, ArgumentValueError
from cardan.geometry import Geometry
from cardan.load import Load
from cardan.outputs import OUTPUTS, nearest
from cardan.request import Items, item_index
from cardan.tolerances.box import Box, Boxes, Toleranced, boxes
from cardan.tolerances.chain import ComplexArray
from cardan.tolerances.guaranteed import largest_modulus
from cardan.tolerances.quantities import FIGURES, Figure, amplitude
from cardan.tolerances.reduced import ReducedOutput
from cardan.tolerances.sampling import sampled
from cardan.tolerances.worst import MOST_CORNERS, largest_in_box, zonotope_radius

# Differences by this part of a tolerance, but no less than what leaves enough digits.
_STEP = 1e-5

# Every trial of a reduced output is an evaluation over a turn.
_MOST_REDUCED = 10

# The search for permitted tolerances stops at this relative width.
_BISECTIONS = 50


class Tolerances:
    """The effect of tolerances on figures of a driveline; see ``Driveline.tolerances``.

    With one figure every result is an array in the shape of the batch (a number for a single
    driveline). With several it is a mapping from their names to such arrays.

    Attributes:
        of: names of the figures.
        shape: shape of the batch.
        samples: number of random drivelines.
        seed: of their random numbers; the same seed gives the same samples again.
        distribution: ``"uniform"`` or ``"normal"``.
    """

    def __init__(
        self,
        each: Boxes,
        quantities: Mapping[str, Figure | ReducedOutput],
        *,
        several: bool,
        line_of: Callable[[Geometry], Any],
        shaft: int,
        speed: float,
        limits: Mapping[str, float],
        samples: int,
        seed: int,
        distribution: str,
        workers: int | None,
    ) -> None:
        """Take checked arguments; ``Driveline.tolerances`` makes them."""
        self._boxes, self._quantities, self._several = each, quantities, several
        self._line_of, self._shaft, self._speed = line_of, shaft, speed
        self._limits, self._workers = limits, workers
        self.of = tuple(quantities)
        self.shape = each.shape
        self.samples, self.seed, self.distribution = samples, seed, distribution

    @property
    def nominal(self) -> Any:  # noqa: ANN401 - an array, or one per name
        """The figure of the driveline as drawn."""
        return self._each(self._nominal)

    @cached_property
    def worst(self) -> Any:  # noqa: ANN401
        """The largest figure of any driveline within the tolerances; ``worst_kind`` says how.

        For a normal distribution the tolerances are three standard deviations, and samples beyond
        them can exceed this figure.
        """
        return self._each(
            lambda box, i, name: self._found(i, name)[0]
            if self._searched(box, name)
            else self._linear(box, i, name)
        )

    @property
    def worst_kind(self) -> Any:  # noqa: ANN401
        """How ``worst`` was found, one word or one per figure.

        ``"box"``: over the box of tolerances itself, from all its corners inwards; ``"linear"``:
        too many parameters for that, as ``linear`` has it.
        """
        kinds = {
            name: "box" if all(self._searched(box, name) for box in self._boxes.each) else "linear"
            for name in self.of
        }
        return kinds if self._several else kinds[self.of[0]]

    @cached_property
    def worst_at(self) -> Any:  # noqa: ANN401
        """Deviations of the worst driveline as a mapping from group to array, in rad or the unit.

        Raises:
            ValueError: ``worst_kind`` is ``"linear"``.
        """
        if any(not self._searched(box, name) for name in self.of for box in self._boxes.each):
            raise ValueError("the worst driveline is not known: worst_kind is 'linear'")
        return self._grouped(lambda box, i, name: self._found(i, name)[1] * box.sizes)

    @cached_property
    def linear(self) -> Any:  # noqa: ANN401
        """The largest figure to first order: the farthest vertex of ``q + sum of ± dq``.

        For a reduced output: its value and the sum of the magnitudes of all first-order changes.
        """
        return self._each(self._linear)

    @cached_property
    def guaranteed(self) -> Any:  # noqa: ANN401
        """A bound that no driveline within the tolerances exceeds, by the triangle inequality.

        Raises:
            ValueError: one of the figures is a reduced output, of which no bound is known.
        """
        for name in self.of:
            if isinstance(self._quantities[name], ReducedOutput):
                raise ArgumentValueError(
                    "of",
                    f"has {name!r}; a guaranteed bound is known for {', '.join(FIGURES)} only, "
                    "which depend on one complex number",
                )

        def bound(box: Box, _i: int, name: str) -> float:
            figure = self._quantities[name]
            assert isinstance(figure, Figure)
            modulus = largest_modulus(figure.amplitude, box, self._shaft)
            return float(figure.of_modulus(np.asarray(modulus), self._speed))

        return self._each(bound)

    @cached_property
    def sampled(self) -> Any:  # noqa: ANN401
        """The figure of each random driveline, ``(..., samples)``.

        All drivelines of a batch have the same random numbers, so that they can be compared.
        """
        found = {name: np.empty((len(self._boxes.each), self.samples)) for name in self.of}
        for i, box in enumerate(self._boxes.each):
            of = self._figures(i)
            for name, values in sampled(box, self.samples, self.seed, self._workers, of).items():
                found[name][i] = values
        shaped = {name: v.reshape(*self.shape, self.samples) for name, v in found.items()}
        return shaped if self._several else shaped[self.of[0]]

    def quantile(self, share: ArrayLike) -> Any:  # noqa: ANN401
        """Return the figure that this share of the random drivelines does not exceed.

        Args:
            share: within [0, 1], any shape.

        Returns:
            in the shape of the batch, followed by that of ``share``.

        Raises:
            TypeError: shares that are not real numbers.
            ValueError: a share outside [0, 1].
        """
        p = as_float64("share", share)
        if not np.all((p >= 0.0) & (p <= 1.0)):
            raise ArgumentValueError("share", f"is {share!r}; it must lie in [0, 1]")
        found = {
            name: scalar_or_array(np.asarray(self._quantiles(values, p)))
            for name, values in self._sampled_by_name().items()
        }
        return found if self._several else found[self.of[0]]

    @staticmethod
    def _quantiles(values: FloatArray, share: FloatArray) -> FloatArray:
        found = np.asarray(np.quantile(values, share.reshape(-1), axis=-1))
        return np.moveaxis(found, 0, -1).reshape((*values.shape[:-1], *share.shape))

    @cached_property
    def shares(self) -> Any:  # noqa: ANN401
        """Share of each parameter in the scatter of the figure, by group; together they are 1.

        ``|dq/dx|² sigma²`` of each parameter over the sum; for a reduced output with its own
        derivative. ``"bends"``: ``(..., n)``, ``"phases"`` and ``"twists"``: ``(..., n - 1)``,
        ``"points"``: ``(..., n + 2, 3)``.
        """

        def share(box: Box, i: int, name: str) -> FloatArray:
            parts = np.square(np.abs(self._slopes(box, i, name)) * box.sigmas)
            total = np.sum(parts)
            return np.asarray(parts / total if total > 0.0 else parts)

        return self._grouped(share)

    @property
    def passing(self) -> Any:  # noqa: ANN401
        """Share of the random drivelines that do not exceed the limit.

        With several figures, of those that have a limit.

        Raises:
            ValueError: the only figure has no limit.
        """
        found = {
            name: scalar_or_array(np.asarray(np.mean(values <= self._limits[name], axis=-1)))
            for name, values in self._sampled_by_name().items()
            if name in self._limits
        }
        if self._several:
            return found
        if not found:
            raise ArgumentValueError("limit", f"is missing; {self.of[0]!r} has no limit of its own")
        return found[self.of[0]]

    @property
    def limit(self) -> Any:  # noqa: ANN401
        """The limit of each figure in its unit; NaN without one."""
        found = {name: self._limits.get(name, math.nan) for name in self.of}
        return found if self._several else found[self.of[0]]

    def permitted(self, group: str, *, bound: str = "worst") -> Any:  # noqa: ANN401
        """Return by which factor the tolerances of one group may grow until the limit is reached.

        All other tolerances stay as they are. Below 1 they must become tighter. A single driveline
        and a single figure are judged.

        Args:
            group: ``"bends"``, ``"twists"``, ``"phases"`` or ``"points"``.
            bound: what must not exceed the limit: ``"worst"``, ``"linear"`` or ``"guaranteed"``.

        Returns:
            the factor; NaN if the others alone exceed the limit, infinite if no factor reaches it.

        Raises:
            ValueError: a group without tolerances, an unknown bound, a batch, several figures, no
                limit.
        """
        if self._several or self.shape:
            raise ValueError("permitted tolerances are found for one driveline and one figure")
        box, name = self._boxes.each[0], self.of[0]
        if name not in self._limits:
            raise ArgumentValueError("limit", f"is missing; {name!r} has no limit of its own")
        if not any(place[0] == group for place in box.places):
            raise ArgumentValueError("group", f"is {group!r}; it has no tolerances")
        if bound not in ("worst", "linear", "guaranteed"):
            raise ArgumentValueError(
                "bound", f"is {bound!r}; it must be 'worst', 'linear' or 'guaranteed'"
            )

        def within(factor: float) -> bool:
            scaled = box.scaled(group, factor)
            try:
                scaled.check()
            except ValueError:
                return False
            return bool(getattr(self._with(scaled), bound) <= self._limits[name])

        if not within(0.0):
            return math.nan
        low, high = 0.0, 1.0
        while within(high):
            low, high = high, 2.0 * high
            if high > 1e6:
                return math.inf
        for _ in range(_BISECTIONS):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if within(middle) else (low, middle)
        return low

    def _with(self, box: Box) -> Tolerances:
        return Tolerances(
            Boxes((), self._boxes.geometry, (box,)),
            self._quantities,
            several=False,
            line_of=self._line_of,
            shaft=self._shaft,
            speed=self._speed,
            limits=self._limits,
            samples=self.samples,
            seed=self.seed,
            distribution=self.distribution,
            workers=self._workers,
        )

    @property
    def nominal_deg(self) -> Any:  # noqa: ANN401
        """``nominal`` in degrees."""
        return self._degrees(self.nominal)

    @property
    def worst_deg(self) -> Any:  # noqa: ANN401
        """``worst`` in degrees."""
        return self._degrees(self.worst)

    @property
    def linear_deg(self) -> Any:  # noqa: ANN401
        """``linear`` in degrees."""
        return self._degrees(self.linear)

    @property
    def guaranteed_deg(self) -> Any:  # noqa: ANN401
        """``guaranteed`` in degrees."""
        return self._degrees(self.guaranteed)

    @property
    def sampled_deg(self) -> Any:  # noqa: ANN401
        """``sampled`` in degrees."""
        return self._degrees(self.sampled)

    @property
    def limit_deg(self) -> Any:  # noqa: ANN401
        """``limit`` in degrees."""
        return self._degrees(self.limit)

    def quantile_deg(self, share: ArrayLike) -> Any:  # noqa: ANN401
        """Return ``quantile`` in degrees."""
        return self._degrees(self.quantile(share))

    def unit(self, name: str) -> str:
        """Return the SI unit of a figure."""
        return self._quantities[name].unit

    def __repr__(self) -> str:
        """Show the figures, the number of parameters and of drivelines."""
        parameters = max((len(box.places) for box in self._boxes.each), default=0)
        batch = f" of a batch of shape {self.shape}" if self.shape else ""
        kinds = self.worst_kind if self._several else {self.of[0]: self.worst_kind}
        listed = ", ".join(f"{name} (worst: {kinds[name]})" for name in self.of)
        return f"<Tolerances of {parameters} parameters{batch}: {listed}>"

    def _degrees(self, values: Any) -> Any:  # noqa: ANN401
        for name in self.of:
            if self.unit(name) != "rad":
                raise ArgumentValueError(
                    "of", f"has {name!r} in {self.unit(name)}; only angles have degrees"
                )
        if self._several:
            return {name: np.degrees(value)[()] for name, value in values.items()}
        return np.degrees(values)[()]

    def _sampled_by_name(self) -> Mapping[str, FloatArray]:
        found: Mapping[str, FloatArray] = (
            self.sampled if self._several else {self.of[0]: self.sampled}
        )
        return found

    def _each(self, of: Callable[[Box, int, str], float]) -> Any:  # noqa: ANN401
        """One number per driveline and figure, in the shape of the batch."""
        found = {}
        for name in self.of:
            values = [of(box, i, name) for i, box in enumerate(self._boxes.each)]
            found[name] = scalar_or_array(np.array(values, dtype=float).reshape(self.shape))
        return found if self._several else found[self.of[0]]

    def _grouped(self, of: Callable[[Box, int, str], FloatArray]) -> Any:  # noqa: ANN401
        """One number per parameter as arrays by group, in the shape of the batch."""
        found: dict[str, dict[str, FloatArray]] = {}
        for name in self.of:
            parts = [box.by_group(of(box, i, name)) for i, box in enumerate(self._boxes.each)]
            groups = {group: part[group] for part in parts for group in part}
            found[name] = {
                group: np.array(
                    [part.get(group, np.zeros_like(like)) for part in parts]
                ).reshape(*self.shape, *like.shape)
                for group, like in groups.items()
            }
        return found if self._several else found[self.of[0]]

    def _figures(self, i: int) -> Callable[[FloatArray], dict[str, FloatArray]]:
        """Figures by name of deviations of the driveline, each amplitude computed once."""
        box = self._boxes.each[i]

        def of(values: FloatArray) -> dict[str, FloatArray]:
            deviations, samples = box.deviations(values), values.shape[1]
            moduli: dict[str, FloatArray] = {}
            found = {}
            for name, quantity in self._quantities.items():
                if isinstance(quantity, ReducedOutput):
                    found[name] = quantity.values(
                        self._line_of, self._geometry(i), box.nominal, deviations, samples
                    )
                    continue
                kind = quantity.amplitude
                if kind not in moduli:
                    q = amplitude(kind, box.nominal, deviations, self._shaft)
                    moduli[kind] = np.broadcast_to(np.abs(q), samples)
                found[name] = quantity.of_modulus(moduli[kind], self._speed)
            return found

        return of

    def _geometry(self, i: int) -> Geometry:
        """The geometry of one driveline of the batch."""
        own = self._boxes.geometry
        return own.reshaped((len(self._boxes.each),)).taken(i) if own.shape else own

    def _value(self, box: Box, i: int, name: str) -> Callable[[FloatArray], FloatArray]:
        """The figure of deviations in units of the tolerances."""
        only = {name: self._quantities[name]}
        one = Tolerances.__new__(Tolerances)
        one.__dict__.update(self.__dict__, _quantities=only)
        of = one._figures(i)
        return lambda units: of(units * box.sizes[:, np.newaxis])[name]

    def _nominal(self, box: Box, i: int, name: str) -> float:
        return float(self._value(box, i, name)(np.zeros((len(box.places), 1)))[0])

    def _searched(self, box: Box, name: str) -> bool:
        reduced = isinstance(self._quantities[name], ReducedOutput)
        return len(box.places) <= (_MOST_REDUCED if reduced else MOST_CORNERS)

    @cached_property
    def _searches(self) -> dict[tuple[int, str], tuple[float, FloatArray]]:
        return {}

    def _found(self, i: int, name: str) -> tuple[float, FloatArray]:
        """The worst driveline of a box: its figure, and the deviations in units of tolerances."""
        if (i, name) not in self._searches:
            box = self._boxes.each[i]
            found = largest_in_box(self._value(box, i, name), len(box.places))
            self._searches[i, name] = found
        return self._searches[i, name]

    def _slopes(self, box: Box, i: int, name: str) -> ComplexArray:
        """Derivatives by each parameter, of the amplitude or of the reduced output."""
        steps = np.diag(_STEP * np.ones(len(box.places)))
        units = np.concatenate([steps, -steps], axis=1)
        quantity = self._quantities[name]
        if isinstance(quantity, ReducedOutput):
            values = self._value(box, i, name)(units).astype(complex)
        else:
            deviations = box.deviations(units * box.sizes[:, np.newaxis])
            values = amplitude(quantity.amplitude, box.nominal, deviations, self._shaft)
            values = np.broadcast_to(values, units.shape[1])
        plus, minus = np.split(values, 2)
        return np.asarray((plus - minus) / (2.0 * _STEP * box.sizes))

    def _linear(self, box: Box, i: int, name: str) -> float:
        changes = self._slopes(box, i, name) * box.sizes
        quantity = self._quantities[name]
        if isinstance(quantity, ReducedOutput):
            return self._nominal(box, i, name) + float(np.sum(np.abs(changes)))
        centre = complex(amplitude(quantity.amplitude, box.nominal, {}, self._shaft))
        modulus = zonotope_radius(centre, changes)
        if quantity.amplitude == "last":
            # Far beyond the linear range; a joint has |q| < 1.
            modulus = min(modulus, np.nextafter(1.0, 0.0))
        return float(quantity.of_modulus(np.asarray(modulus), self._speed))


def tolerances(
    line: Toleranced,
    line_of: Callable[[Geometry], Any],
    *,
    bends: ArrayLike | None,
    twists: ArrayLike | None,
    phases: ArrayLike | None,
    points: ArrayLike | None,
    degrees: bool,
    distribution: str,
    teeth: ArrayLike | None,
    of: str | Iterable[str],
    limit: Any,  # noqa: ANN401 - a number or a mapping
    speed: float | None,
    load: Load | None,
    reduce: str,
    shaft: SupportsIndex,
    shafts: Items,
    joints: Items,
    samples: SupportsIndex,
    seed: int | None,
    workers: int | None,
) -> Tolerances:
    """Check the arguments of ``Driveline.tolerances`` and return its result."""
    names, several = _names(of)
    index = item_index("shaft", shaft, line.n_joints + 1)
    if index == 0:
        raise ArgumentValueError("shaft", "is 0; the drive shaft has no errors of its own")
    given = {"bends": bends, "twists": twists, "phases": phases, "points": points}
    each = boxes(line, given, teeth, distribution, degrees)
    quantities: dict[str, Figure | ReducedOutput] = {}
    for name in names:
        if name in FIGURES:
            quantities[name] = FIGURES[name]
            if FIGURES[name].needs_speed and speed is None:
                raise ArgumentValueError("speed", f"is missing; {name!r} needs it")
        else:
            reduced = ReducedOutput(name, reduce, load, shafts, joints, workers)
            reduced.check()
            quantities[name] = reduced
    return Tolerances(
        each,
        quantities,
        several=several,
        line_of=line_of,
        shaft=index,
        speed=0.0 if speed is None else _speed(speed),
        limits=_limits(limit, quantities, several, degrees),
        samples=_samples(samples),
        seed=_seed(seed),
        distribution=distribution,
        workers=workers,
    )


def _names(of: str | Iterable[str]) -> tuple[tuple[str, ...], bool]:
    names = (of,) if isinstance(of, str) else tuple(of)
    if not names:
        raise ArgumentValueError("of", "is empty; name at least one figure")
    for i, name in enumerate(names):
        if not isinstance(name, str):
            raise ArgumentTypeError("of", f"is {name!r}; a figure is asked for by its name", (i,))
        if name not in FIGURES and name not in OUTPUTS:
            raise ArgumentValueError("of", f"is {name!r}; {nearest(name, [*FIGURES, *OUTPUTS])}", (i,))
        if names.index(name) < i:
            raise ArgumentValueError("of", f"is {name!r} again; name each figure once", (i,))
    return names, not isinstance(of, str)


def _limits(
    limit: Any,  # noqa: ANN401
    quantities: Mapping[str, Figure | ReducedOutput],
    several: bool,
    degrees: bool,
) -> dict[str, float]:
    """The limits by figure, in the units of the figures."""
    found = {
        name: figure.default_limit
        for name, figure in quantities.items()
        if isinstance(figure, Figure) and figure.default_limit is not None
    }
    if limit is None:
        return found
    if not isinstance(limit, Mapping):
        if several:
            raise ArgumentTypeError(
                "limit", f"is {limit!r}; with several figures it must be a mapping by their names"
            )
        limit = {next(iter(quantities)): limit}
    for name, value in limit.items():
        if name not in quantities:
            raise ArgumentValueError("limit", f"names {name!r}; {nearest(str(name), quantities)}")
        number = as_float64("limit", value)
        if number.ndim or not number > 0.0:
            raise ArgumentValueError("limit", f"is {value!r}; it must be a positive number", (name,))
        in_degrees = degrees and quantities[name].unit == "rad"
        found[name] = math.radians(float(number)) if in_degrees else float(number)
    return found


def _speed(speed: float) -> float:
    value = as_float64("speed", speed)
    if value.ndim or not np.isfinite(value):
        raise ArgumentValueError("speed", f"is {speed!r}; it must be one finite number in rad/s")
    return float(value)


def _samples(samples: SupportsIndex) -> int:
    if not hasattr(samples, "__index__"):
        raise ArgumentTypeError("samples", f"is {samples!r}; it must be an integer")
    count = operator.index(samples)
    if count < 1:
        raise ArgumentValueError("samples", f"is {count}; it must be positive")
    return count


def _seed(seed: int | None) -> int:
    """The seed, a fresh one if none is given."""
    if seed is None:
        return int(np.random.SeedSequence().generate_state(1, np.uint64)[0])
    if not hasattr(seed, "__index__"):
        raise ArgumentTypeError("seed", f"is {seed!r}; it must be an integer")
    value = operator.index(seed)
    if value < 0:
        raise ArgumentValueError("seed", f"is {value}; it must not be negative")
    return value

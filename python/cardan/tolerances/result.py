"""Effect of tolerances on a driveline: the worst case, bounds, quantiles and shares.

Random drivelines are drawn in chunks on several threads. Each chunk has its own stream of random
numbers, spawned from the seed by the number of the chunk, so that the samples depend on neither the
number of threads nor their order.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Mapping, Sequence
from functools import cached_property, partial
from typing import Any, SupportsIndex

import numpy as np
from numpy.typing import ArrayLike

from cardan.arrays import FloatArray, as_float64, scalar_or_array, threads
from cardan.arrays.errors import ArgumentValueError, check_choice, require
from cardan.arrays.indices import item_index
from cardan.design.quantities import MOTION_QUANTITIES, MotionQuantity
from cardan.tolerances.box import Box
from cardan.tolerances.case import Case, Design, Quantity, permitted_factor


def _in_degrees(name: str) -> Any:  # noqa: ANN401 - a property
    """Return the property that is another one in degrees."""

    def of(self: Tolerances) -> Any:  # noqa: ANN401
        return self._degrees(getattr(self, name))

    return property(of, doc=f"``{name}`` in degrees.")


def _share_up_to(values: FloatArray, limit: float) -> FloatArray:
    """Return the share of sorted values, along the last axis, that do not exceed a limit."""
    rows = values.reshape(-1, values.shape[-1])
    counts = [np.searchsorted(row, limit, side="right") for row in rows]
    return np.asarray(np.reshape(counts, values.shape[:-1]) / values.shape[-1])


# Where a scene asks for no number, so many random drivelines are drawn, and these first. Of them so
# few within the limit, or beyond it, mean less than 0.1 % of all (99 % confidence).
_MOST, _FIRST, _SETTLED = 100_000, 16_384, 4

# Doubles of one parameter at a time: the arrays of a chunk stay in the caches of a core.
_CHUNK = 1 << 14

# Pieces of work for a thread pool below which its start costs more than it saves.
_FEWEST = 4


class Tolerances:
    """The effect of tolerances on figures of a driveline; see ``Driveline.tolerances``.

    With one figure every result is an array in the shape of the batch (a number for a single
    driveline). With several it is a mapping from their names to such arrays. With states, every
    figure is the largest of all states.

    Attributes:
        of: names of the figures.
        shape: shape of the batch, without the axis of the states.
        n_states: number of states; ``None`` without them.
        seed: of their random numbers; the same seed gives the same samples again.
        distribution: ``"uniform"`` or ``"normal"``.
    """

    def __init__(
        self,
        designs: Sequence[Design],
        shape: tuple[int, ...],
        quantities: Mapping[str, Quantity],
        *,
        several: bool,
        limits: Mapping[str, float],
        samples: int | None,
        seed: int,
        distribution: str,
        workers: int | None,
        n_states: int | None = None,
    ) -> None:
        """Take checked arguments; ``Driveline.tolerances`` makes them."""
        self.n_states = n_states
        self._in_states: dict[int, Tolerances] = {}
        self._designs, self._quantities, self._several = designs, quantities, several
        self._limits, self._workers = limits, workers
        self.of = tuple(quantities)
        self.shape = shape
        self.seed, self.distribution = seed, distribution
        self._asked = samples
        # Those that showed how many are needed.
        self._left: dict[str, FloatArray] = {}
        self._passing_each: dict[str, FloatArray] = {}

    @cached_property
    def samples(self) -> int:
        """Number of random drivelines."""
        if self._asked is not None:
            return self._asked
        first = self._left = self._drawn(_FIRST)
        for name, limit in self._limits.items():
            within = np.count_nonzero(first[name] <= limit, axis=-1)
            if np.any(np.minimum(within, _FIRST - within) > _SETTLED):
                return _MOST
        return _FIRST if self._limits else _MOST

    def in_state(self, state: SupportsIndex) -> Tolerances:
        """Return the same in one of the states alone, with the same random numbers.

        Args:
            state: number of the state, counted from 0.

        Raises:
            IndexError: a state that does not exist.
        """
        index = item_index("state", state, self.n_states or 0)
        if index not in self._in_states:
            self._in_states[index] = Tolerances(
                [Design((design.cases[index],)) for design in self._designs],
                self.shape,
                self._quantities,
                several=self._several,
                limits=self._limits,
                samples=self._asked,
                seed=self.seed,
                distribution=self.distribution,
                workers=self._workers,
            )
        return self._in_states[index]

    @cached_property
    def worst_state(self) -> Any:  # noqa: ANN401
        """Number of the state with the worst figure, counted from 0."""
        found = {}
        for name, quantity in self._quantities.items():
            states = [design.worst_state(quantity) for design in self._designs]
            found[name] = np.reshape(states, self.shape)[()]
        return self._named(found)

    @property
    def given(self) -> dict[str, FloatArray]:
        """The tolerances by group in rad or the unit of the points, without half a tooth."""
        boxes = [design.box for design in self._designs]
        return self._by_group([box.sizes - box.tooth_sizes for box in boxes])

    @property
    def half_tooth(self) -> dict[str, FloatArray]:
        """Half a tooth of each phase in rad, by group like ``given``; 0 where none is set."""
        return self._by_group([design.box.tooth_sizes for design in self._designs])

    @property
    def as_built(self) -> bool:
        """Whether the joints deviate or have tolerances; figures of ``q`` leave that out."""
        return any(case.is_as_built for design in self._designs for case in design.cases)

    @property
    def measured(self) -> bool:
        """Whether the driveline in the middle of the tolerances has deviations itself."""
        return any(case.line.has_deviations for design in self._designs for case in design.cases)

    @property
    def nominal(self) -> Any:  # noqa: ANN401 - an array, or one per name
        """The figure of the driveline as drawn, in the SI unit ``unit(name)``, shape: the batch."""
        return self._each(Case.nominal)

    @cached_property
    def worst(self) -> Any:  # noqa: ANN401
        """The largest figure of any driveline within the tolerances that a search finds.

        For a normal distribution the tolerances are three standard deviations, and samples beyond
        them can exceed this figure.
        """
        return self._each(Case.worst)

    @property
    def worst_kind(self) -> Any:  # noqa: ANN401
        """How ``worst`` was found, one word or one per figure.

        ``"box"``: over the box of tolerances, from all its corners inwards; ``"search"``: with
        too many parameters for that, from 1024 random corners and those to which first order
        points. A proof that nothing is worse is neither.
        """
        kinds = {True: "box", False: "search"}
        found = {
            name: kinds[all(design.from_all_corners(own) for design in self._designs)]
            for name, own in self._quantities.items()
        }
        return self._named(found)

    @cached_property
    def worst_at(self) -> Any:  # noqa: ANN401
        """Deviations of the worst driveline, from group to array, in rad or the unit."""
        return self._grouped(Case.worst_at)

    @cached_property
    def linear(self) -> Any:  # noqa: ANN401
        """The largest figure to first order: the farthest vertex of ``q + sum of ± dq``.

        Of an order ``q`` is its complex amplitude. For a reduced output: its value and the sum of
        the magnitudes of all first-order changes.
        """
        return self._each(Case.linear)

    @cached_property
    def guaranteed(self) -> Any:  # noqa: ANN401
        """A bound that no driveline within the tolerances exceeds, by the triangle inequality.

        With several figures, of those of which one is known.

        Raises:
            ValueError: the only figure is an order or a reduced output, of which no bound is known.
        """
        found = {
            name: self._largest(Case.guaranteed, quantity)
            for name, quantity in self._quantities.items()
            if isinstance(quantity, MotionQuantity)
        }
        if self._several or found:
            return self._named(found)
        known = f"a guaranteed bound is known for {', '.join(MOTION_QUANTITIES)} only"
        reason = "which are functions of a place in the hyperbolic plane"
        instead = "'worst' searches all combinations of tolerances"
        raise ArgumentValueError("of", f"is {self.of[0]!r}; {known}, {reason}; {instead}")

    @cached_property
    def sampled(self) -> Any:  # noqa: ANN401
        """The figure of each random driveline in the order drawn, ``(..., samples)``.

        All drivelines of a batch have the same random numbers, and so have all figures and states,
        so that they can be compared.
        """
        return self._named(self._drawn(self.samples))

    @cached_property
    def ascending(self) -> Any:  # noqa: ANN401
        """The figures of the random drivelines, sorted, ``(..., samples)``; read-only.

        Quantiles and the passing share come from this array. Only ``sampled`` needs another one, of
        8 bytes per sample and figure.
        """
        held = self.__dict__.get("sampled")
        if held is None:
            found = self._drawn(self.samples)
        else:
            found = {name: values.copy() for name, values in self._by_name(held).items()}
        for values in found.values():
            values.sort(axis=-1)
            values.flags.writeable = False
        return self._named(found)

    def quantile(self, share: ArrayLike) -> Any:  # noqa: ANN401
        """Return the figure that this share of the random drivelines does not exceed.

        Its shape is that of the batch, followed by that of ``share``.

        Args:
            share: within [0, 1], any shape. Between two drivelines the figure is interpolated.

        Raises:
            TypeError: shares that are not real numbers.
            ValueError: a share outside [0, 1].
        """
        p = as_float64("share", share)
        require("share", np.all((p >= 0.0) & (p <= 1.0)), f"is {share!r}; it must lie in [0, 1]")
        place = p * (self.samples - 1)
        below = np.floor(place).astype(np.intp)
        above = np.ceil(place).astype(np.intp)
        found = {}
        for name, values in self._by_name(self.ascending).items():
            low, high = values[..., below], values[..., above]
            found[name] = scalar_or_array(np.asarray(low + (place - below) * (high - low)))
        return self._named(found)

    @cached_property
    def shares(self) -> Any:  # noqa: ANN401
        """Share of each parameter in the scatter of the figure, by group; together they are 1.

        ``|dq/dx|² sigma²`` of each parameter over the sum; for an order with its complex amplitude
        and for a reduced output with its own derivative. With states, in the scatter of the state
        with the worst figure. ``"bends"`` and the deviations of the joints: ``(..., n)``,
        ``"phases"`` and ``"twists"``: ``(..., n - 1)``, ``"points"``: ``(..., n + 2, 3)``.
        """

        return self._grouped(Case.shares)

    @property
    def passing(self) -> Any:  # noqa: ANN401
        """Share of the random drivelines that do not exceed the limit.

        With several figures, of those that have a limit.

        Raises:
            ValueError: the only figure has no limit.
        """
        found = {
            name: scalar_or_array(_share_up_to(values, self._limits[name]))
            for name, values in self._by_name(self.ascending).items()
            if name in self._limits
        }
        if self._several:
            return found
        require("limit", found, f"is missing; {self.of[0]!r} has no default limit")
        return found[self.of[0]]

    @property
    def passing_by_state(self) -> dict[str, FloatArray]:
        """Share of the random drivelines within the limit in each state alone, by figure.

        ``(..., n_states)``, of the figures that have a limit.
        """
        _ = self.ascending
        return self._passing_each

    @property
    def limit(self) -> Any:  # noqa: ANN401
        """The limit of each figure in its unit; NaN without one."""
        return self._named({name: self._limits.get(name, math.nan) for name in self.of})

    def permitted(self, group: str, *, bound: str = "worst") -> Any:  # noqa: ANN401
        """Return by which factor the tolerances of one group may grow until the limit is reached.

        All other tolerances stay as they are. Below 1 they must become tighter. A single driveline
        and a single figure are judged.

        Args:
            group: ``"bends"``, ``"twists"``, ``"phases"``, ``"points"``, ``"driving_yoke"``,
                ``"cross"`` or ``"driven_yoke"``.
            bound: what must not exceed the limit: ``"worst"``, ``"linear"`` or ``"guaranteed"``.

        Returns:
            the factor; NaN if the others alone exceed the limit, infinite if no factor reaches it.
            If joints block before the limit is reached, it is the largest factor with which they
            turn, or up to 0.1 % less.

        Raises:
            ValueError: a group without tolerances, an unknown bound, a batch, several figures, no
                limit.
        """
        if self._several or self.shape:
            raise ValueError("permitted tolerances are found for one driveline and one figure")
        design, name = self._designs[0], self.of[0]
        quantity = self._quantities[name]
        require("limit", name in self._limits, f"is missing; {name!r} has no default limit")
        if not any(place[0] == group for place in design.box.places):
            raise ArgumentValueError("group", f"is {group!r}; it has no tolerances")
        check_choice("bound", bound, ("worst", "linear", "guaranteed"))
        return permitted_factor(design, quantity, self._limits[name], group, bound)

    nominal_deg = _in_degrees("nominal")
    """``nominal`` in degrees."""
    worst_deg = _in_degrees("worst")
    """``worst`` in degrees."""
    linear_deg = _in_degrees("linear")
    """``linear`` in degrees."""
    guaranteed_deg = _in_degrees("guaranteed")
    """``guaranteed`` in degrees."""
    sampled_deg = _in_degrees("sampled")
    """``sampled`` in degrees."""
    ascending_deg = _in_degrees("ascending")
    """``ascending`` in degrees."""
    limit_deg = _in_degrees("limit")
    """``limit`` in degrees."""

    def quantile_deg(self, share: ArrayLike) -> Any:  # noqa: ANN401
        """Return ``quantile`` in degrees; a ``ValueError`` for a figure that is not an angle."""
        return self._degrees(self.quantile(share))

    def unit(self, name: str) -> str:
        """Return the SI unit of a figure, such as ``"rad"``; ``"1"`` if it has none.

        Args:
            name: one of ``of``; another one is a ``KeyError``.
        """
        return self._quantities[name].unit

    def __repr__(self) -> str:
        """Show the figures, the number of parameters and of drivelines."""
        parameters = max((len(design.box.places) for design in self._designs), default=0)
        batch = f" of a batch of shape {self.shape}" if self.shape else ""
        batch += f" in {self.n_states} states" if self.n_states else ""
        kinds = self.worst_kind if self._several else {self.of[0]: self.worst_kind}
        listed = ", ".join(f"{name} (worst: {kinds[name]})" for name in self.of)
        return f"<Tolerances of {parameters} parameters{batch}: {listed}>"

    def _degrees(self, values: Any) -> Any:  # noqa: ANN401
        for name in self.of:
            problem = f"has {name!r} in {self.unit(name)}; only angles have degrees"
            require("of", self.unit(name) == "rad", problem)
        if self._several:
            return {name: np.degrees(value)[()] for name, value in values.items()}
        return np.degrees(values)[()]

    def _drawn(self, samples: int) -> dict[str, FloatArray]:
        """The figure of each random driveline by name; what is within in each state is counted."""
        left, self._left = self._left, {}
        if left and left[self.of[0]].shape[-1] == samples:
            return left
        states = range(self.n_states or 0)
        found = {name: np.empty((len(self._designs), samples)) for name in self.of}
        counted = {name: np.empty((len(self._designs), len(states))) for name in self._limits}
        for i, design in enumerate(self._designs):
            out: dict[Any, Any] = {name: values[i] for name, values in found.items()}
            within = {(name, j): np.empty(samples, bool) for name in counted for j in states}
            of = partial(design.sampled, self._quantities, self._limits if states else {})
            _sample(design.box, self.seed, self._workers, of, out | within)
            for (name, j), each in within.items():
                counted[name][i, j] = np.mean(each)
        self._passing_each = {
            name: values.reshape((*self.shape, len(states))) for name, values in counted.items()
        }
        return {name: values.reshape((*self.shape, samples)) for name, values in found.items()}

    def _by_name(self, results: Any) -> Mapping[str, FloatArray]:  # noqa: ANN401
        found: Mapping[str, FloatArray] = results if self._several else {self.of[0]: results}
        return found

    def _each(self, of: Callable[[Case, Any], float]) -> Any:  # noqa: ANN401
        """One number per driveline and figure, in the shape of the batch."""
        return self._named({name: self._largest(of, own) for name, own in self._quantities.items()})

    def _largest(self, of: Callable[[Case, Any], float], quantity: Quantity) -> Any:  # noqa: ANN401
        values = [design.largest(of, quantity) for design in self._designs]
        return scalar_or_array(np.array(values, dtype=float).reshape(self.shape))

    def _grouped(self, of: Callable[[Case, Any], FloatArray]) -> Any:  # noqa: ANN401
        """One number per parameter of the worst state as arrays by group, shape: the batch."""

        def rows(quantity: Quantity) -> list[FloatArray]:
            return [of(design.worst_case(quantity), quantity) for design in self._designs]

        found = {name: self._by_group(rows(own)) for name, own in self._quantities.items()}
        return self._named(found)

    def _by_group(self, rows: Sequence[FloatArray]) -> dict[str, FloatArray]:
        """Numbers per parameter of each driveline as arrays by group."""
        parts = [design.box.by_group(row) for design, row in zip(self._designs, rows, strict=True)]
        groups = {group: array.shape for part in parts for group, array in part.items()}
        return {
            group: np.array([part.get(group, np.zeros(own)) for part in parts]).reshape(
                (*self.shape, *own)
            )
            for group, own in groups.items()
        }

    def _named(self, found: Mapping[str, Any]) -> Any:  # noqa: ANN401
        """The only result, or all by name."""
        return found if self._several else found[self.of[0]]


def _sample(
    box: Box,
    seed: int,
    workers: int | None,
    of: Callable[[FloatArray], Mapping[str, FloatArray]],
    out: Mapping[str, FloatArray],
) -> None:
    """Fill arrays ``(samples,)`` with figures by name of random drivelines."""
    samples = len(next(iter(out.values())))
    firsts = range(0, samples, _CHUNK)

    def fill(number: int) -> None:
        first = firsts[number]
        count = min(_CHUNK, samples - first)
        random = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(number,)))
        for name, values in of(box.drawn(random, count)).items():
            out[name][first : first + count] = values

    limit = threads.at_most(workers)
    many = min(limit or os.cpu_count() or 1, os.cpu_count() or 1)
    if many == 1 or len(firsts) < _FEWEST:
        for number in range(len(firsts)):
            fill(number)
        return
    from concurrent.futures import ThreadPoolExecutor

    with ThreadPoolExecutor(many) as pool:
        for _ in pool.map(fill, range(len(firsts))):
            pass

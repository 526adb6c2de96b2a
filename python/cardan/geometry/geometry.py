"""The arrays that make drivelines: joined, indexed, compared, set anew, mounted in bearings."""

from __future__ import annotations

import math
import operator
from collections.abc import Callable, Iterable, Sequence
from itertools import combinations
from typing import TYPE_CHECKING, Any, NamedTuple, SupportsIndex, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cardan import _core
from cardan.arrays import FloatArray, as_float64, common_shape, finite, per_shaft
from cardan.arrays.errors import ArgumentTypeError, ArgumentValueError, Place, check_shape
from cardan.arrays.indices import item_index

if TYPE_CHECKING:
    from cardan.driveline import Driveline


def require_driveline(name: str, line: object, place: Place = ()) -> None:
    """Raise an error unless an argument is a driveline, whose class is above this one."""
    if not isinstance(getattr(line, "_geometry", None), Geometry):
        raise ArgumentTypeError(name, f"is {line!r}; it must be a driveline", place)


class Geometry(NamedTuple):
    """What makes a batch of drivelines: angles in rad and unit vectors, as of ``Driveline``."""

    bends: FloatArray
    twists: FloatArray
    phases: FloatArray
    directions: FloatArray
    normals: FloatArray
    lengths: FloatArray  # (..., n + 1), or (..., 0) if unknown
    positions: FloatArray  # of each bearing along its shaft, (..., m), in the lengths' unit
    deviations: FloatArray  # (..., n, 3), or (..., 0, 3) if all joints are ideal
    bearings: tuple[int, ...] = ()  # the shaft of each
    has_points: bool = False  # whether they were made from points, with these lengths between them

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the batch."""
        return self.bends.shape[:-1]

    @property
    def n_joints(self) -> int:
        """Number of joints of each driveline."""
        n: int = self.bends.shape[-1]
        return n

    @property
    def is_as_built(self) -> bool:
        """Whether the joints deviate from their drawing."""
        return bool(self.deviations.shape[-2])

    def as_built(self) -> Geometry:
        """Give ideal joints deviations of 0."""
        if self.is_as_built:
            return self
        return self._replace(deviations=np.zeros((*self.bends.shape, 3)))

    def check_ideal(self, what: str, instead: str = "") -> None:
        """Raise a ``ValueError`` if the joints deviate; ``what`` has its verb."""
        if self.is_as_built:
            hint = f"; {instead}" if instead else ""
            problem = f"has joints with deviations; {what} for ideal joints only{hint} "
            problem += "(with_deviations() without arguments makes them ideal)"
            raise ArgumentValueError("driveline", problem)

    @property
    def arrays(self) -> tuple[FloatArray, ...]:
        """The arrays, each with the axes of the batch first."""
        return self[:-2]

    def flat(self) -> list[FloatArray]:
        """Return each array as one run of elements, which the native module takes."""
        return [array.reshape(-1) for array in self.arrays]

    def each(self, change: Callable[[FloatArray], FloatArray]) -> Geometry:
        """Return the geometry with every array changed."""
        return Geometry._make([*map(change, self.arrays), self.bearings, self.has_points])

    def batched(self, shape: tuple[int, ...]) -> Geometry:
        """Broadcast to a batch of that shape."""
        batch = len(self.shape)
        return self.each(lambda array: spread(array, shape, array.ndim - batch))

    def reshaped(self, shape: tuple[int, ...]) -> Geometry:
        """Give the batch another shape as ``Driveline.reshape`` does."""
        batch, size = len(self.shape), math.prod(self.shape)
        try:
            # One of the sizes may be left open.
            full = np.broadcast_to(np.empty(()), size).reshape(shape).shape
        except ValueError:
            problem = f"is {shape}, which has no room for just {size} drivelines"
            raise ArgumentValueError("shape", problem) from None
        return self.each(lambda array: np.array(array).reshape(*full, *array.shape[batch:]))


def place_in(own: tuple[int, ...], shape: tuple[int, ...], place: Place) -> Place:
    """Return the place in an array with the batch ``own``, which was spread to another batch."""
    before = len(shape) - len(own)
    batch = (0 if size == 1 else i for size, i in zip(own, place[before:], strict=False))
    return (*batch, *place[len(shape) :])


def spread(array: FloatArray, shape: tuple[int, ...], own: int) -> FloatArray:
    """The array for a batch of that shape; its last ``own`` axes belong to one driveline."""
    full = (*shape, *array.shape[array.ndim - own :])
    return array if full == array.shape else np.ascontiguousarray(np.broadcast_to(array, full))


def between_joints(name: str, value: ArrayLike, n: int, degrees: bool) -> FloatArray:
    """Twists or phases as ``(..., n - 1)``; one number stands for all shafts."""
    array = as_float64(name, value)
    between = max(n - 1, 0)
    if array.ndim == 0:
        array = np.full(between, array)
    check_shape(name, array, array.shape[-1] == between, f"{n} joints need (..., {between})")
    finite(name, array)
    return np.radians(array) if degrees else array


def concatenate(
    cls: type[Driveline], lines: Iterable[Driveline], axis: SupportsIndex = 0
) -> Driveline:
    """Join drivelines along an existing axis of their batches, as ``numpy.concatenate`` does.

    A single driveline counts as a batch of one, so that a list of single ones makes a batch.

    Args:
        lines: at least one, all with the same number of joints.
        axis: the axis of the batches along which they are joined.

    Raises:
        TypeError: something that is not a driveline.
        ValueError: no drivelines, different numbers of joints, shapes that do not fit.
    """
    given = [lines] if isinstance(lines, cls) else list(lines)
    if not given:
        raise ArgumentValueError("lines", "is empty; there must be at least one driveline")
    for i, line in enumerate(given):
        require_driveline("lines", line, (i,))
        if line.n_joints != given[0].n_joints:
            problem = f"has {line.n_joints} joints and lines[0] {given[0].n_joints}"
            raise ArgumentValueError("lines", problem, (i,))
    parts = [line._geometry if line.shape else line._geometry.reshaped((1,)) for line in given]
    shape, bearings = parts[0].shape, parts[0].bearings
    along = operator.index(axis)
    if not -len(shape) <= along < len(shape):
        raise ArgumentValueError("axis", f"is {along}; the batches have {len(shape)} axes")
    along %= len(shape)
    for i, part in enumerate(parts):
        first, own = ((len(s), *s[:along], *s[along + 1 :]) for s in (shape, part.shape))
        problem = ""
        if own != first:
            problem = f"has shape {part.shape} and lines[0] {shape}; they may differ along axis "
            problem += f"{along} only"
        elif part.bearings != bearings:
            problem = f"has bearings on shafts {part.bearings} and lines[0] on {bearings}; "
            problem += "they must be the same"
        if problem:
            raise ArgumentValueError("lines", problem, (i,))
    if not all(part.lengths.shape[-1] for part in parts):
        # Lengths that some lack are of no use to all.
        parts = [part._replace(lengths=part.lengths[..., :0]) for part in parts]
    if any(part.is_as_built for part in parts):
        parts = [part.as_built() for part in parts]
    every = zip(*(part.arrays for part in parts), strict=True)
    joined = (np.concatenate(arrays, axis=along) for arrays in every)
    has_points = all(part.has_points for part in parts)
    return cls._of(Geometry._make([*joined, bearings, has_points]))


def reshape(line: Driveline, *shape: SupportsIndex | Iterable[SupportsIndex]) -> Driveline:
    """Return the same drivelines in a batch of another shape.

    Args:
        shape: the new shape, as one tuple or as several integers; one of them may be -1.

    Raises:
        TypeError: a shape that does not consist of integers.
        ValueError: a shape with room for more or fewer drivelines.
    """
    whole: Any = shape[0] if len(shape) == 1 and isinstance(shape[0], Iterable) else shape
    return line._of(line._geometry.reshaped(tuple(operator.index(size) for size in whole)))


def taken(line: Driveline, index: Any) -> Driveline:  # noqa: ANN401 - whatever NumPy takes
    """Return drivelines of the batch, by NumPy's rules over its dimensions.

    ``line[3]`` is one of a batch, ``line[:, None]`` adds a dimension to broadcast over.

    Raises:
        IndexError: an index that does not fit the batch.
        TypeError: a single driveline has nothing to index.
    """
    if not line.shape:
        raise TypeError("a single driveline has no batch to index")
    places = np.arange(line.size).reshape(line.shape)[index]

    def at_places(array: FloatArray) -> FloatArray:
        flat = array.reshape(line.size, *array.shape[line.ndim :])
        return np.asarray(flat.take(places, axis=0))

    return line._of(line._geometry.each(at_places))


def approx_equal(line: Driveline, other: Driveline, tolerance: float = 1e-9) -> bool:
    """Return whether two drivelines or batches are equal except for rounding.

    They are if they have the same number of joints and the same shape, and no angle, direction
    or normal differs by more than the tolerance. Twists count modulo 360°, phases modulo 180°,
    because a yoke looks the same after half a turn. Drivelines of equal angles that point in
    different directions are not equal. Lengths and bearings are not compared.

    Args:
        other: the driveline or batch to compare with.
        tolerance: permitted difference in rad.

    Raises:
        TypeError: something that is not a driveline.
    """
    require_driveline("other", other)
    if (line.n_joints, line.shape) != (other.n_joints, other.shape):
        return False
    turns = (0.0, 2.0 * np.pi, np.pi, 0.0, 0.0)
    for one, another, turn in zip(line._geometry[:5], other._geometry[:5], turns, strict=True):
        apart = one - another
        if turn:
            apart -= turn * np.round(apart / turn)
        if not np.all(np.abs(apart) <= tolerance):
            return False
    own, others = line._geometry.as_built(), other._geometry.as_built()
    return bool(np.all(np.abs(own.deviations - others.deviations) <= tolerance))


def with_phases(line: Driveline, phases: ArrayLike, *, degrees: bool = False) -> Driveline:
    """Return the driveline with its yokes set anew.

    Args:
        phases: phase of each intermediate shaft, ``(..., n - 1)`` or one for all; broadcasts
            against the batch.
        degrees: whether they are in degrees.

    Raises:
        ValueError: a phase that is not finite, shapes that do not fit.
    """
    own = line._geometry
    # A copy, since it may be the caller's own array.
    new = np.array(between_joints("phases", phases, own.n_joints, degrees))
    shape = common_shape(driveline=own.shape, phases=new.shape[:-1])
    return line._of(own.batched(shape)._replace(phases=spread(new, shape, 1)))


def reversed(line: Driveline) -> Driveline:
    """Return the driveline driven from its other end; reversing inverts its motion.

    Bends, twists and phases keep their values and change their order; directions and
    bend-plane normals change their sign as well.

    Its shafts point the other way, so that angles count the other way round, and from another
    yoke. If the last shaft is at ``f`` when the drive is at ``a``, then the last shaft of the
    reversed driveline is at ``c - a`` when its drive is at ``c - f``. For a single joint ``c``
    is a quarter turn, in general ``angle(-q*r)/2``, where ``q`` and ``r`` are those of
    ``transmission()`` of this driveline and of the reversed one.
    """
    own = line._geometry
    turned = Geometry(
        np.array(own.bends[..., ::-1]),
        np.array(own.twists[..., ::-1]),
        np.array(own.phases[..., ::-1]),
        -own.directions[..., ::-1, :],
        -own.normals[..., ::-1, :],
        np.array(own.lengths[..., ::-1]),
        own.lengths[..., list(own.bearings)] - own.positions,
        # What was the driven pin drives, and both shafts point the other way.
        own.deviations[..., ::-1, ::-1] * [-1.0, 1.0, -1.0],
        tuple(own.n_joints - shaft for shaft in own.bearings),
        own.has_points,
    )
    return line._of(turned)


def broadcast(
    line: Driveline, **arrays: FloatArray
) -> tuple[tuple[int, ...], NDArray[np.int64], list[FloatArray]]:
    """Return the common shape of batch and arrays, and flat the drivelines' numbers and arrays."""
    shapes = {name: array.shape for name, array in arrays.items()}
    shape = common_shape(driveline=line.shape, **shapes)
    numbers = np.arange(math.prod(line.shape)).reshape(line.shape)
    first, *flat = (np.broadcast_to(x, shape).ravel() for x in (numbers, *arrays.values()))
    return shape, first, flat


def unpickled(
    cls: type[Driveline], known: tuple[tuple[int, ...], bool], *arrays: FloatArray
) -> Driveline:
    """Make drivelines of the arrays that a pickle holds, and of what else a geometry knows."""
    # What came in a message lies anywhere in it.
    whole = (np.require(a, requirements=["C", "A"]) for a in arrays)
    return cls._of(Geometry._make([*whole, *known]))


# --- bearings along the shafts --------------------------------------------------------------------

Bearings: TypeAlias = Iterable[tuple[int, ArrayLike]]
"""Pairs of a shaft and the position of a bearing on it."""


def with_bearings(
    line: Driveline, bearings: Bearings, lengths: ArrayLike | None = None
) -> Driveline:
    """Return the driveline with bearings at these positions, in place of any others.

    A shaft needs two supports. With two bearings these are its own. With one bearing the second
    support is a joint that supports no other shaft. An intermediate shaft without bearings
    floats, supported by the joints at both its ends. A first or last shaft without bearings is
    held by the machine of which it is a part. Other arrangements are allowed; their forces are
    refused when they are asked for, if they are not determinate.

    Args:
        bearings: pairs of a shaft, counted from 0, and the position of the bearing: its
            distance from the shaft's upstream end, in the direction of power flow. That end is
            the shaft's input-side joint, for shaft 0 the driving end. Positions have the unit
            of the points, and broadcast against the batch.
        lengths: length of each shaft between its joints or ends, ``(..., n + 1)``, in the same
            unit; by default those of the points. Forces are in newtons if lengths are in metres.

    Raises:
        IndexError: a shaft that does not exist.
        TypeError: a bearing that is not a pair of a shaft and a position, values that are not
            real numbers.
        ValueError: a position that is not between the ends of the shaft or is at a joint, two
            bearings in one place, lengths that are missing or not positive and finite, shapes
            that do not fit.
    """
    return line._of(_mounted(line._geometry, list(_pairs(bearings)), lengths))


def in_metres(line: Driveline, unit: float) -> Driveline:
    """Return the driveline with its lengths and positions in metres, from a unit."""
    own = line._geometry
    lengths, positions = own.lengths * unit, own.positions * unit
    return line._of(own._replace(lengths=lengths, positions=positions))


def same_place(one: ArrayLike, other: ArrayLike, length: FloatArray) -> NDArray[np.bool_]:
    """Return whether positions on a shaft of this length differ by rounding at most."""
    # A stand-in for lengths that are not yet known is longer than any shaft.
    size = np.minimum(length, 1e3 * np.maximum(np.abs(one), np.abs(other)))
    return np.asarray(np.abs(np.subtract(one, other)) <= 1e-12 * size)


def _pairs(bearings: Bearings) -> Iterable[tuple[Any, ArrayLike]]:
    if isinstance(bearings, str) or not isinstance(bearings, Iterable):
        raise ArgumentTypeError("bearings", f"is {bearings!r}; it must be a list of pairs")
    if isinstance(bearings, np.ndarray):
        problem = f"is an array of shape {bearings.shape}; it must be a list of pairs: a shaft, "
        raise ArgumentTypeError("bearings", f"{problem}which is an integer, and a position")
    for i, pair in enumerate(bearings):
        if isinstance(pair, str) or not isinstance(pair, Sequence) or len(pair) != 2:
            problem = f"is {pair!r}; it must be a pair of a shaft and a position"
            raise ArgumentTypeError("bearings", problem, (i,))
        yield pair


def _mounted(
    own: Geometry, bearings: list[tuple[Any, ArrayLike]], lengths: ArrayLike | None
) -> Geometry:
    n = own.n_joints
    known = own.lengths
    if lengths is not None:
        known = per_shaft("lengths", as_float64("lengths", lengths), n + 1)
    if bearings and known.shape[-1] == 0:
        problem = "are missing; only drivelines from points know their lengths"
        raise ArgumentValueError("lengths", problem)
    shafts = [item_index("bearings", pair[0], n + 1, (i, 0)) for i, pair in enumerate(bearings)]
    places = [as_float64(f"bearings[{i}, 1]", pair[1]) for i, pair in enumerate(bearings)]
    shape = common_shape(
        driveline=own.shape,
        lengths=known.shape[:-1],
        **{f"bearings[{i}, 1]": place.shape for i, place in enumerate(places)},
    )
    positions = np.empty((*shape, len(places)))
    for i, place in enumerate(places):
        positions[..., i] = place
    full = np.array(np.broadcast_to(known, (*shape, known.shape[-1])))
    if known.shape[-1]:
        for i, j in combinations(range(len(shafts)), 2):
            if shafts[i] == shafts[j]:
                one, other = positions[..., i], positions[..., j]
                same = same_place(one, other, full[..., shafts[i]])
                positions[..., j] = np.where(same, one, other)
        try:
            _core.check_bearings(n, shape, shafts, full.reshape(-1), positions.reshape(-1))
        except ArgumentValueError as error:
            if error.argument == "lengths":
                raise error.at(place_in(known.shape[:-1], shape, error.place)) from None
            raise
    spread = own._replace(lengths=own.lengths[..., :0], positions=own.positions[..., :0])
    return spread.batched(shape)._replace(
        lengths=full,
        positions=positions,
        bearings=tuple(shafts),
        # Other lengths are not those between the points.
        has_points=own.has_points and lengths is None,
    )

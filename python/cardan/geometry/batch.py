"""Drivelines as an array: joining, indexing, comparing, and other settings of their yokes."""

from __future__ import annotations

import math
import operator
from collections.abc import Iterable
from typing import TYPE_CHECKING, Any, SupportsIndex

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cardan.arrays import FloatArray, common_shape
from cardan.arrays.errors import ArgumentTypeError, ArgumentValueError
from cardan.geometry.geometry import Geometry, between_joints, spread

if TYPE_CHECKING:
    from cardan.driveline import Driveline


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
        if not isinstance(line, cls):
            raise ArgumentTypeError("lines", f"is {line!r}; it must be a driveline", (i,))
        if line.n_joints != given[0].n_joints:
            raise ArgumentValueError(
                "lines", f"has {line.n_joints} joints and lines[0] {given[0].n_joints}", (i,)
            )
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
    if not isinstance(other, type(line)):
        raise ArgumentTypeError("other", f"is {other!r}; it must be a driveline")
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

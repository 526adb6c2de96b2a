"""The geometry of drivelines: their arrays, the ways to lay them out and to rearrange them."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from cardan import _core
from cardan.arrays import FloatArray, as_float64, common_shape
from cardan.errors import ArgumentValueError, Place, wrong_element


class Geometry(NamedTuple):
    """What makes a batch of drivelines: angles in rad and unit vectors, as ``Driveline`` has them.

    Attributes:
        bends: ``(..., n)``.
        twists: ``(..., n - 1)``.
        phases: ``(..., n - 1)``.
        directions: ``(..., n + 1, 3)``.
        normals: ``(..., n, 3)``.
        lengths: length of each shaft, ``(..., n + 1)``; ``(..., 0)`` if unknown.
        positions: position of each bearing along its shaft, in the unit of the lengths,
            ``(..., m)``.
        deviations: of driving yoke, cross and driven yoke of each joint, ``(..., n, 3)``;
            ``(..., 0, 3)`` if all joints are ideal.
        bearings: the shaft of each bearing, ``m`` in number.
        has_points: whether they were made from points, with these lengths between them.
    """

    bends: FloatArray
    twists: FloatArray
    phases: FloatArray
    directions: FloatArray
    normals: FloatArray
    lengths: FloatArray
    positions: FloatArray
    deviations: FloatArray
    bearings: tuple[int, ...] = ()
    has_points: bool = False

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
            raise ArgumentValueError(
                "driveline",
                f"has joints with deviations; {what} for ideal joints only{hint} "
                "(with_deviations() without arguments makes them ideal)",
            )

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
        return self.each(lambda array: _spread(array, shape, array.ndim - batch))

    def with_phases(self, phases: ArrayLike, degrees: bool) -> Geometry:
        """Set the yokes as ``Driveline.with_phases`` does."""
        # A copy, since it may be the caller's own array.
        new = np.array(_per_shaft("phases", phases, self.n_joints, degrees))
        shape = common_shape(driveline=self.shape, phases=new.shape[:-1])
        return self.batched(shape)._replace(phases=_spread(new, shape, 1))

    def reversed(self) -> Geometry:
        """Turn round as ``Driveline.reversed`` does."""
        return Geometry(
            np.array(self.bends[..., ::-1]),
            np.array(self.twists[..., ::-1]),
            np.array(self.phases[..., ::-1]),
            -self.directions[..., ::-1, :],
            -self.normals[..., ::-1, :],
            np.array(self.lengths[..., ::-1]),
            self.lengths[..., list(self.bearings)] - self.positions,
            # What was the driven pin drives, and both shafts point the other way.
            self.deviations[..., ::-1, ::-1] * [-1.0, 1.0, -1.0],
            tuple(self.n_joints - shaft for shaft in self.bearings),
            self.has_points,
        )

    def taken(self, index: Any) -> Geometry:  # noqa: ANN401 - whatever NumPy takes
        """Take drivelines of the batch as ``Driveline.__getitem__`` does."""
        if not self.shape:
            raise TypeError("a single driveline has no batch to index")
        size, batch = math.prod(self.shape), len(self.shape)
        places = np.arange(size).reshape(self.shape)[index]
        return self.each(
            lambda array: array.reshape(size, *array.shape[batch:]).take(places, axis=0)
        )

    def reshaped(self, shape: tuple[int, ...]) -> Geometry:
        """Give the batch another shape as ``Driveline.reshape`` does."""
        batch, size = len(self.shape), math.prod(self.shape)
        try:
            # One of the sizes may be left open.
            full = np.broadcast_to(np.empty(()), size).reshape(shape).shape
        except ValueError:
            raise ArgumentValueError(
                "shape", f"is {shape}, which has no room for just {size} drivelines"
            ) from None
        return self.each(lambda array: np.array(array).reshape(*full, *array.shape[batch:]))


def concatenated(parts: Sequence[Geometry], axis: int) -> Geometry:
    """Join batches as ``Driveline.concatenate`` does."""
    shapes = [part.shape for part in parts]
    batch = len(shapes[0])
    if not -batch <= axis < batch:
        raise ArgumentValueError("axis", f"is {axis}; the batches have {batch} axes")
    axis %= batch
    for i, shape in enumerate(shapes):
        others = [(*own[:axis], *own[axis + 1 :]) for own in (shapes[0], shape)]
        if len(shape) != batch or others[0] != others[1]:
            raise ArgumentValueError(
                "lines",
                f"has shape {shape} and lines[0] {shapes[0]}; "
                f"they may differ along axis {axis} only",
                (i,),
            )
        if parts[i].bearings != parts[0].bearings:
            raise ArgumentValueError(
                "lines",
                f"has bearings on shafts {parts[i].bearings} and lines[0] on {parts[0].bearings}; "
                "they must be the same",
                (i,),
            )
    if not all(part.lengths.shape[-1] for part in parts):
        # Lengths that some lack are of no use to all.
        parts = [part._replace(lengths=part.lengths[..., :0]) for part in parts]
    if any(part.is_as_built for part in parts):
        parts = [part.as_built() for part in parts]
    every = zip(*(part.arrays for part in parts), strict=True)
    joined = (np.concatenate(arrays, axis=axis) for arrays in every)
    has_points = all(part.has_points for part in parts)
    return Geometry._make([*joined, parts[0].bearings, has_points])


def from_bends(bends: ArrayLike, twists: ArrayLike, phases: ArrayLike, degrees: bool) -> Geometry:
    """Lay out as ``Driveline.from_bends`` does."""
    array = np.atleast_1d(as_float64("bends", bends))
    n = array.shape[-1]
    return _laid_out(
        functools.partial(_core.from_bends, degrees=degrees),
        n,
        bends=(np.radians(array) if degrees else array, 1),
        twists=(_per_shaft("twists", twists, n, degrees), 1),
        phases=(_per_shaft("phases", phases, n, degrees), 1),
    )


def from_directions(directions: ArrayLike, phases: ArrayLike, degrees: bool) -> Geometry:
    """Lay out as ``Driveline.from_directions`` does."""
    array = _vectors("directions", directions, 2)
    n = array.shape[-2] - 1
    turned = _per_shaft("phases", phases, n, degrees)
    return _laid_out(_core.from_directions, n, directions=(array, 2), phases=(turned, 1))


def from_points(points: ArrayLike, phases: ArrayLike, degrees: bool) -> Geometry:
    """Lay out as ``Driveline.from_points`` does."""
    array = _vectors("points", points, 3)
    n = array.shape[-2] - 2
    turned = _per_shaft("phases", phases, n, degrees)
    made = _laid_out(_core.from_points, n, points=(array, 2), phases=(turned, 1))
    return made._replace(lengths=_spread(_lengths(array), made.shape, 1), has_points=True)


def from_slopes(
    vertical: ArrayLike, horizontal: ArrayLike, phases: ArrayLike, degrees: bool
) -> Geometry:
    """Lay out as ``Driveline.from_slopes`` does."""
    up = _slopes("vertical", vertical, degrees)
    right = _slopes("horizontal", horizontal, degrees)
    return from_directions(sloping(up, right), phases, degrees)


def from_projected_bends(
    vertical: ArrayLike, horizontal: ArrayLike, phases: ArrayLike, degrees: bool, reference: str
) -> Geometry:
    """Lay out as ``Driveline.from_projected_bends`` does."""
    up = _slopes_against(reference, "vertical", vertical, degrees)
    right = _slopes_against(reference, "horizontal", horizontal, degrees)
    return from_directions(sloping(up, right), phases, degrees)


def _laid_out(
    lay_out: Callable[..., tuple[FloatArray, ...]], n: int, **arrays: tuple[FloatArray, int]
) -> Geometry:
    """Broadcast the arrays, phases last, and let a function of the native module do the rest.

    With each array comes how many axes of it belong to one driveline.
    """
    shape = common_shape(**{name: a.shape[: a.ndim - own] for name, (a, own) in arrays.items()})
    spread = [_spread(array, shape, own) for array, own in arrays.values()]
    flat = (array.reshape(-1) for array in spread)
    try:
        bends, twists, directions, normals = lay_out(n, list(shape), *flat)
    except ArgumentValueError as error:
        if error.argument not in arrays:
            raise
        array, own = arrays[error.argument]
        raise error.at(place_in(array.shape[: array.ndim - own], shape, error.place)) from None
    return Geometry(
        bends.reshape(*shape, n),
        twists.reshape(*shape, n - 1),
        # The others are new; this may be the caller's own array.
        np.array(spread[-1]),
        directions.reshape(*shape, n + 1, 3),
        normals.reshape(*shape, n, 3),
        np.empty((*shape, 0)),
        np.empty((*shape, 0)),
        np.empty((*shape, 0, 3)),
    )


def place_in(own: tuple[int, ...], shape: tuple[int, ...], place: Place) -> Place:
    """Return the place in an array with the batch ``own``, which was spread to another batch."""
    before = len(shape) - len(own)
    batch = (0 if size == 1 else i for size, i in zip(own, place[before:], strict=False))
    return (*batch, *place[len(shape) :])


def _lengths(points: FloatArray) -> FloatArray:
    """The distances between successive points, without overflow of their squares.

    They have the same bits on every machine, unlike those of ``hypot``.
    """
    x, y, z = np.moveaxis(np.diff(points, axis=-2), -1, 0)
    with np.errstate(over="ignore", under="ignore"):
        squares = x * x + y * y + z * z
    lengths: FloatArray = np.sqrt(squares)
    far = ~((squares > 1e-280) & (squares < np.inf))
    if far.any():
        steps = np.stack([x[far], y[far], z[far]])
        _, power = np.frexp(np.max(np.abs(steps), axis=0))
        x, y, z = np.ldexp(steps, -power)
        lengths[far] = np.ldexp(np.sqrt(x * x + y * y + z * z), power)
    return lengths


def _spread(array: FloatArray, shape: tuple[int, ...], own: int) -> FloatArray:
    """The array for a batch of that shape; its last ``own`` axes belong to one driveline."""
    full = (*shape, *array.shape[array.ndim - own :])
    return array if full == array.shape else np.ascontiguousarray(np.broadcast_to(array, full))


def _per_shaft(name: str, value: ArrayLike, n: int, degrees: bool) -> FloatArray:
    """Twists or phases as ``(..., n - 1)``; one number stands for all shafts."""
    array = as_float64(name, value)
    between = max(n - 1, 0)
    if array.ndim == 0:
        array = np.full(between, array)
    if array.shape[-1] != between:
        raise ArgumentValueError(name, f"has shape {array.shape}; {n} joints need (..., {between})")
    if not np.isfinite(array).all():
        raise wrong_element(name, array, ~np.isfinite(array), "; it must be finite")
    return np.radians(array) if degrees else array


def _vectors(name: str, value: ArrayLike, fewest: int) -> FloatArray:
    array = as_float64(name, value)
    if array.ndim < 2 or array.shape[-1] != 3 or array.shape[-2] < fewest:
        wanted = f"(..., {fewest} or more, 3)"
        raise ArgumentValueError(name, f"has shape {array.shape}; it must be {wanted}")
    return array


def _slopes(name: str, value: ArrayLike, degrees: bool, what: str = "slope") -> FloatArray:
    array = np.atleast_1d(as_float64(name, value))
    right_angle, unit = (90.0, "90 deg") if degrees else (np.pi / 2, "pi/2 rad")
    wrong = ~(np.abs(array) < right_angle)
    if wrong.any():
        rule = f"; a {what} must lie between -{unit} and {unit}"
        raise wrong_element(name, array, wrong, rule)
    return np.radians(array) if degrees else array


def _slopes_against(reference: str, name: str, value: ArrayLike, degrees: bool) -> FloatArray:
    """Slopes of three shafts from the two bends between them, the shaft of reference level."""
    bend = _slopes(name, value, degrees, "projected bend")
    if bend.shape[-1] != 2:
        raise ArgumentValueError(name, f"has shape {bend.shape}; two joints need (..., 2)")
    first, second = np.moveaxis(bend, -1, 0)
    level = np.zeros_like(first)
    slopes = {
        "common": (-first, level, second),
        "input": (level, first, first + second),
        "output": (-first - second, -second, level),
    }
    if reference not in slopes:
        known = ", ".join(map(repr, slopes))
        raise ArgumentValueError("reference", f"is {reference!r}; it must be one of {known}")
    view = np.stack(slopes[reference], axis=-1)
    if np.any(np.abs(view) >= np.pi / 2):
        raise ArgumentValueError(name, f"adds up to 90 deg or more against the {reference} shaft")
    return view


def sloping(vertical: FloatArray, horizontal: FloatArray) -> FloatArray:
    """Directions from the slopes in side view and top view."""
    if vertical.shape[-1] != horizontal.shape[-1]:
        raise ArgumentValueError(
            "vertical",
            f"has {vertical.shape[-1]} shafts and horizontal {horizontal.shape[-1]}; "
            "they must be the same",
        )
    common_shape(vertical=vertical.shape, horizontal=horizontal.shape)
    up, right = np.broadcast_arrays(np.tan(vertical), np.tan(horizontal))
    return np.stack([np.ones_like(up), up, right], axis=-1)

"""Drivelines as an array: shape, angles, indices, joining and comparing."""

from __future__ import annotations

import math
import operator
from collections.abc import Iterable, Iterator
from typing import Any, Self, SupportsIndex

import numpy as np
from numpy.typing import NDArray

from cardan import _core, geometry, notebook
from cardan.arrays import FloatArray, common_shape
from cardan.errors import ArgumentTypeError, ArgumentValueError
from cardan.geometry import Geometry


class Batch:
    """One or more immutable drivelines of equal length; ``Driveline`` adds what they do."""

    __slots__ = ("_geometry", "_lines", "_n_joints", "_plans", "_shape")
    _geometry: Geometry
    _lines: _core.Lines
    _n_joints: int
    _plans: dict[Any, Any]  # remembered by ``evaluate``, by its arguments
    _shape: tuple[int, ...]

    @classmethod
    def _of(cls, own: Geometry) -> Self:
        self = object.__new__(cls)
        self._geometry = own
        self._n_joints, self._shape = own.n_joints, own.shape
        for array in own.arrays:
            array.flags.writeable = False
        self._lines = _core.Lines(self._n_joints, self._shape, own.flat(), own.bearings)
        self._plans = {}
        return self

    def _twin(self) -> Self:
        """Return the same drivelines as another object, which remembers no plans."""
        twin = object.__new__(type(self))
        for name in Batch.__slots__:
            setattr(twin, name, getattr(self, name))
        twin._plans = {}
        return twin

    def _spread(
        self, **arrays: FloatArray
    ) -> tuple[tuple[int, ...], NDArray[np.int64], list[FloatArray]]:
        """Broadcast arrays against the batch.

        Returns:
            the common shape, and flat, the number of the driveline and each array.

        Raises:
            ValueError: shapes that do not broadcast.
        """
        shapes = {name: array.shape for name, array in arrays.items()}
        shape = common_shape(driveline=self._shape, **shapes)
        numbers = np.arange(math.prod(self._shape)).reshape(self._shape)
        first, *flat = (np.broadcast_to(x, shape).ravel() for x in (numbers, *arrays.values()))
        return shape, first, flat

    @classmethod
    def concatenate(cls, lines: Iterable[Self], axis: SupportsIndex = 0) -> Self:
        """Join drivelines along an existing axis of their batches, as ``numpy.concatenate`` does.

        A single driveline counts as a batch of one, so that a list of single ones makes a batch.

        Args:
            lines: at least one, all with the same number of joints.
            axis: the axis of the batches along which they are joined.

        Raises:
            TypeError: something that is not a driveline.
            ValueError: no drivelines, different numbers of joints, shapes that do not fit.
        """
        given = [lines] if isinstance(lines, Batch) else list(lines)
        for i, line in enumerate(given):
            if not isinstance(line, Batch):
                raise ArgumentTypeError("lines", f"is {line!r}; it must be a driveline", (i,))
            if line.n_joints != given[0].n_joints:
                raise ArgumentValueError(
                    "lines", f"has {line.n_joints} joints and lines[0] {given[0].n_joints}", (i,)
                )
        if not given:
            raise ArgumentValueError("lines", "is empty; there must be at least one driveline")
        parts = [line._geometry if line.shape else line._geometry.reshaped((1,)) for line in given]
        return cls._of(geometry.concatenated(parts, operator.index(axis)))

    def reshape(self, *shape: SupportsIndex | Iterable[SupportsIndex]) -> Self:
        """Return the same drivelines in a batch of another shape.

        Args:
            shape: the new shape, as one tuple or as several integers; one of them may be -1.

        Raises:
            TypeError: a shape that does not consist of integers.
            ValueError: a shape with room for more or fewer drivelines.
        """
        whole: Any = shape[0] if len(shape) == 1 and isinstance(shape[0], Iterable) else shape
        return self._of(self._geometry.reshaped(tuple(operator.index(size) for size in whole)))

    def __getitem__(self, index: Any) -> Self:  # noqa: ANN401 - whatever NumPy takes
        """Return drivelines of the batch, by NumPy's rules over its dimensions.

        ``line[3]`` is one of a batch, ``line[:, None]`` adds a dimension to broadcast over.

        Raises:
            IndexError: an index that does not fit the batch.
            TypeError: a single driveline has nothing to index.
        """
        return self._of(self._geometry.taken(index))

    def __iter__(self) -> Iterator[Self]:
        """Iterate over the batch's first axis."""
        return map(self.__getitem__, range(len(self)))

    def __len__(self) -> int:
        """Return the length of the batch's first axis.

        Raises:
            TypeError: a single driveline.
        """
        if not self._shape:
            raise TypeError("a single driveline has no length; n_joints is its number of joints")
        return self._shape[0]

    def __bool__(self) -> bool:
        """Return whether there is a driveline: only an empty batch is false."""
        return self.size > 0

    def approx_equal(self, other: Self, tolerance: float = 1e-9) -> bool:
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
        if not isinstance(other, Batch):
            raise ArgumentTypeError("other", f"is {other!r}; it must be a driveline")
        if (self.n_joints, self.shape) != (other.n_joints, other.shape):
            return False
        turns = (0.0, 2.0 * np.pi, np.pi, 0.0, 0.0)
        for one, another, turn in zip(self._geometry[:5], other._geometry[:5], turns, strict=True):
            apart = one - another
            if turn:
                apart -= turn * np.round(apart / turn)
            if not np.all(np.abs(apart) <= tolerance):
                return False
        own, others = self._geometry.as_built(), other._geometry.as_built()
        return bool(np.all(np.abs(own.deviations - others.deviations) <= tolerance))

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle as the arrays, with what else the geometry knows."""
        own = self._geometry
        return (_unpickled, (type(self), (own.bearings, own.has_points), *own.arrays))

    def __copy__(self) -> Self:
        """Return the driveline itself: it never changes."""
        return self

    def __deepcopy__(self, memo: object) -> Self:
        """Return the driveline itself: it never changes."""
        return self

    def __repr__(self) -> str:
        """Show number of joints and bends, or the shape of a batch."""
        joints = f"{self.n_joints} joint{'s' if self.n_joints > 1 else ''}"
        if self.shape:
            return f"<Driveline batch {self.shape} of {joints}>"
        bends = ", ".join(f"{bend:.6g}" for bend in self.bends_deg)
        return f"<Driveline of {joints}, bent by {bends} deg>"

    def _repr_html_(self) -> str:
        """Show the angles of one driveline, or the ranges of a batch, as a table."""
        return notebook.driveline(repr(self), self.bends_deg, self.twists_deg, self.phases_deg)

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the batch; ``()`` for one driveline."""
        return self._shape

    @property
    def ndim(self) -> int:
        """Number of dimensions of the batch; 0 for one driveline."""
        return len(self._shape)

    @property
    def size(self) -> int:
        """Number of drivelines; 1 for one driveline."""
        return int(np.prod(self._shape))

    @property
    def n_joints(self) -> int:
        """Number of joints of each driveline, ``n``."""
        return self._n_joints

    @property
    def bends(self) -> FloatArray:
        """Bend of each joint in rad, ``(..., n)``."""
        return self._geometry.bends

    @property
    def bends_deg(self) -> FloatArray:
        """Bend of each joint in degrees, ``(..., n)``."""
        return np.degrees(self._geometry.bends)

    @property
    def twists(self) -> FloatArray:
        """Twist of each intermediate shaft in rad, ``(..., n - 1)``."""
        return self._geometry.twists

    @property
    def twists_deg(self) -> FloatArray:
        """Twist of each intermediate shaft in degrees, ``(..., n - 1)``."""
        return np.degrees(self._geometry.twists)

    @property
    def phases(self) -> FloatArray:
        """Phase of each intermediate shaft in rad, ``(..., n - 1)``."""
        return self._geometry.phases

    @property
    def phases_deg(self) -> FloatArray:
        """Phase of each intermediate shaft in degrees, ``(..., n - 1)``."""
        return np.degrees(self._geometry.phases)

    @property
    def has_points(self) -> bool:
        """Whether derivatives by points exist.

        They do for drivelines from points, unless ``with_bearings`` gave them other lengths.
        """
        return self._geometry.has_points

    @property
    def directions(self) -> FloatArray:
        """Unit vector along each shaft, ``(..., n + 1, 3)``."""
        return self._geometry.directions

    @property
    def normals(self) -> FloatArray:
        """Unit normal of each joint's bend plane, ``(..., n, 3)``."""
        return self._geometry.normals


def _unpickled(cls: type[Batch], known: tuple[tuple[int, ...], bool], *arrays: FloatArray) -> Batch:
    # What came in a message lies anywhere in it.
    whole = (np.require(a, requirements=["C", "A"]) for a in arrays)
    return cls._of(Geometry._make([*whole, *known]))

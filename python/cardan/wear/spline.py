"""Shafts that change their length: travel of a spline, what is left of it, and its axial force.

Under a torque a spline slides only under an axial force, which the joints transmit to the next
shafts: ``docs/theory/moments.md``.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, SupportsIndex

import numpy as np
from numpy.typing import ArrayLike

from cardan import _core
from cardan.arrays import (
    FloatArray,
    as_float64,
    common_shape,
    not_negative,
    numbered,
    positive,
    scalar_or_array,
    threads,
)
from cardan.arrays.indices import item_index

if TYPE_CHECKING:
    from cardan.driveline import Driveline


@dataclass(frozen=True, eq=False)
class Lengths:
    """The lengths of the shafts of a batch of drivelines, in the unit of the points.

    Attributes:
        each: length of each shaft, ``(..., n + 1)``.
    """

    each: FloatArray

    @property
    def shortest(self) -> FloatArray:
        """Least length of each shaft over the batch, ``(n + 1,)``."""
        return np.asarray(np.min(self._flat, axis=0))

    @property
    def longest(self) -> FloatArray:
        """Largest length of each shaft over the batch, ``(n + 1,)``."""
        return np.asarray(np.max(self._flat, axis=0))

    @property
    def travel(self) -> FloatArray:
        """Change of length of each shaft over the batch, ``(n + 1,)``."""
        return self.longest - self.shortest

    def engagement(self, shaft: SupportsIndex, engaged: ArrayLike, length: ArrayLike) -> Any:  # noqa: ANN401
        """Return the engaged length of a shaft's spline in every driveline of the batch.

        A longer shaft has pulled its spline out by the difference. The length is negative where
        the spline has come apart, and in the unit of the points.

        Args:
            shaft: index of the shaft.
            engaged: engaged length of the spline at a known length of the shaft.
            length: that length of the shaft.

        Raises:
            ValueError: a length that is not positive, shapes that do not broadcast.
        """
        index = item_index("shaft", shaft, self.each.shape[-1])
        known, at = positive("engaged", engaged), positive("length", length)
        common_shape(driveline=self.each.shape[:-1], engaged=known.shape, length=at.shape)
        return scalar_or_array(np.asarray(known - (self.each[..., index] - at)))

    @property
    def _flat(self) -> FloatArray:
        flat: FloatArray = self.each.reshape(-1, self.each.shape[-1])
        if not len(flat):
            raise ValueError("an empty batch has no shortest or longest shaft")
        return flat


@dataclass(frozen=True, eq=False)
class SplineForce:
    """The axial force of a loaded spline while it slides, and what it does to the next shafts.

    Vectors are in the axes of the driveline and for a shaft that becomes longer; for one that
    becomes shorter they have the opposite sign.

    Attributes:
        axial: the force along the shaft in N, as a magnitude.
        upstream: force on what holds the shaft upstream in N, ``(..., 3)``.
        downstream: force on what holds it downstream, ``(..., 3)``.
        upstream_axial: part of it along the shaft that bears it upstream: the shaft before, or for
            shaft 0 the shaft itself. It loads the thrust bearing of that shaft.
        upstream_transverse: part across that shaft, in the plane of the bend. It loads the
            bearings of that shaft at its joint.
        downstream_axial: the same downstream: along the shaft behind, or the last shaft itself.
        downstream_transverse: across it.
        bearings: the shaft of each bearing of the driveline.
    """

    axial: Any
    upstream: FloatArray
    downstream: FloatArray
    upstream_axial: Any
    upstream_transverse: Any
    downstream_axial: Any
    downstream_transverse: Any
    bearings: tuple[int, ...]
    _bearing_force: FloatArray = field(repr=False)
    _refused: str = field(repr=False)

    @property
    def bearing_force(self) -> FloatArray:
        """Force that each bearing must give its shaft in N, ``(bearings, ..., 3)``.

        The parts across the shafts that hold the sliding one, in their two bearings. Bearings of
        other shafts give nothing, and those of the sliding shaft let it slide. Thrust is not part
        of it. The sense is that of a shaft that becomes longer.

        Raises:
            ValueError: no bearings, or other than two on a shaft that bears a part across.
        """
        if self._refused:
            raise ValueError(self._refused)
        return self._bearing_force


def lengths(line: Driveline) -> Lengths:
    """Return the lengths of the shafts, in the unit of the points.

    Over a batch of points, such as the positions of an axle, the travel of a shaft is what its
    spline must take up.

    Raises:
        ValueError: a driveline without lengths: one that was neither made from points nor given
            lengths by ``with_bearings``.

    >>> import cardan
    >>> heights = [[[0, 0, 0], [0.3, 0, 0], [1.5, y, 0], [1.8, y, 0]] for y in (-0.1, 0.0, 0.1)]
    >>> cardan.Driveline.from_points(heights).lengths().travel.round(5)
    array([0.     , 0.00416, 0.     ])
    """
    if not line._geometry.lengths.shape[-1]:
        problem = "the driveline has no lengths; drivelines from points have them, others get them "
        raise ValueError(f"{problem}with with_bearings")
    return Lengths(line._geometry.lengths)


def spline_force(
    line: Driveline, shaft: SupportsIndex, torque: ArrayLike, friction: ArrayLike, radius: ArrayLike
) -> SplineForce:
    """Return the axial force of a loaded spline while it slides: ``F = mu |T|/r``.

    Over a turn, the largest torque gives the largest force; a spline of which the length
    changes slowly slides whenever the force suffices. The bends turn part of it across the
    shafts next to it.

    Args:
        shaft: index of the shaft with the spline.
        torque: torque of that shaft in N m; broadcasts against the batch.
        friction: coefficient of friction in the spline.
        radius: pitch radius of the spline in m.

    Raises:
        ValueError: a negative friction, a radius that is not positive, shapes that do not
            broadcast.
    """
    index = item_index("shaft", shaft, line.n_joints + 1)
    load = as_float64("torque", torque)
    mu, arm = not_negative("friction", friction), positive("radius", radius)
    shape, numbers, loads = numbered(line.shape, torque=load, friction=mu, radius=arm)
    flat, undetermined = _core.spline_forces(
        line._lines, index, numbers, loads, threads.at_most(None)
    )
    bearings = line._geometry.bearings
    columns = flat.reshape(8 + 3 * len(bearings), *shape)
    upstream, (along, across, behind, beside) = _vectors(columns[1:4]), columns[4:8]
    own = _vectors(columns[8:].reshape(len(bearings), 3, *shape), 1)
    parts = (columns[0], upstream, -upstream, along, across, behind, beside)
    return SplineForce(*parts, bearings, own, undetermined or "")


def _vectors(columns: FloatArray, axis: int = 0) -> FloatArray:
    """Put the components of vectors last."""
    return np.ascontiguousarray(np.moveaxis(columns, axis, -1))

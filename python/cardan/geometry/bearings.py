"""Bearings along the shafts of drivelines."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from cardan import _core
from cardan.arrays import as_float64, common_shape, per_shaft
from cardan.arrays.errors import ArgumentTypeError, ArgumentValueError
from cardan.arrays.indices import item_index
from cardan.geometry.geometry import Geometry, place_in

if TYPE_CHECKING:
    from cardan.driveline import Driveline

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

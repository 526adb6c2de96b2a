"""The ways to make drivelines: from bends, directions, points, slopes and double joints."""

from __future__ import annotations

import functools
from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import ArrayLike

from cardan import _core
from cardan.arrays import FloatArray, as_float64, common_shape, deferring, positive, together
from cardan.arrays.errors import (
    ArgumentValueError,
    check_choice,
    check_elements,
    check_shape,
    exclusive,
)
from cardan.geometry.geometry import Geometry, between_joints, end_to_end, place_in

if TYPE_CHECKING:
    from cardan.driveline import Driveline


@deferring(ends=0, bends=1, twists=1, phases=1)
def from_bends(
    cls: type[Driveline],
    bends: ArrayLike,
    twists: ArrayLike = 0.0,
    phases: ArrayLike = 0.0,
    *,
    degrees: bool = False,
) -> Driveline:
    """Make drivelines from the angles at their joints.

    Shaft 0 points along +x and the first bend-plane normal along +z, so shaft 1 points along
    ``(cos b, sin b, 0)``.

    Args:
        bends: bend of each joint, ``(..., n)``; a single number is one joint.
        twists: twist of each intermediate shaft, ``(..., n - 1)`` or one for all.
        phases: phase of each intermediate shaft, ``(..., n - 1)`` or one for all.
        degrees: whether the three are in degrees.

    Raises:
        ValueError: a bend outside [0, 90°), a value that is not finite, shapes that do not fit.
    """
    array = np.atleast_1d(as_float64("bends", bends))
    n = array.shape[-1]
    own = _laid_out(
        functools.partial(_core.from_bends, degrees=degrees),
        n,
        bends=(np.radians(array) if degrees else array, 1),
        twists=(between_joints("twists", twists, n, degrees), 1),
        phases=(between_joints("phases", phases, n, degrees), 1),
    )
    return cls._of(own)


@deferring(ends=1, directions=2, phases=1)
def from_directions(
    cls: type[Driveline], directions: ArrayLike, phases: ArrayLike = 0.0, *, degrees: bool = False
) -> Driveline:
    """Make drivelines from a vector along each shaft.

    A straight joint takes the bend-plane normal of the previous joint, a straight first joint
    that of the next bent one.

    Args:
        directions: ``(..., n + 1, 3)``, of any length, in the direction of power flow, in any
            right-handed axes.
        phases: phase of each intermediate shaft, ``(..., n - 1)`` or one for all.
        degrees: whether the phases are in degrees.

    Raises:
        ValueError: a direction that is zero or not finite, a bend of 90° or more, shapes that
            do not fit.
    """
    array = _vectors("directions", directions, 2)
    n = array.shape[-2] - 1
    turned = between_joints("phases", phases, n, degrees)
    own = _laid_out(_core.from_directions, n, directions=(array, 2), phases=(turned, 1))
    return cls._of(own)


@deferring(ends=2, points=2, phases=1)
def from_points(
    cls: type[Driveline], points: ArrayLike, phases: ArrayLike = 0.0, *, degrees: bool = False
) -> Driveline:
    """Make drivelines from their ends and joint centres.

    Args:
        points: ``(..., n + 2, 3)``: the driving end, the joint centres, the driven end, in any
            unit of length and any right-handed axes. In left-handed ones the driveline would be
            mirrored, and all yoke settings would have the opposite sense.
        phases: phase of each intermediate shaft, ``(..., n - 1)`` or one for all.
        degrees: whether the phases are in degrees.

    Raises:
        ValueError: two equal successive points, a point that is not finite, a bend of 90° or
            more, shapes that do not fit.
    """
    array = _vectors("points", points, 3)
    n = array.shape[-2] - 2
    turned = between_joints("phases", phases, n, degrees)
    made = _laid_out(_core.from_points, n, points=(array, 2), phases=(turned, 1))
    return cls._of(made._replace(has_points=True))


@deferring(ends=1, vertical=1, horizontal=1, phases=1)
def from_slopes(
    cls: type[Driveline],
    vertical: ArrayLike,
    horizontal: ArrayLike,
    phases: ArrayLike = 0.0,
    *,
    degrees: bool = False,
) -> Driveline:
    """Make drivelines from the slope of each shaft in side view and in top view.

    A shaft points along ``(1, tan vertical, tan horizontal)`` in right-handed axes: x from the
    drive to the output, y up, z to the right, looking from the drive towards the output
    (catalogue, double joint, 6.3, exactly). If x points rearwards, z is the vehicle's left.

    Args:
        vertical: slope of each shaft in side view, ``(..., n + 1)``, positive upwards.
        horizontal: slope of each shaft in top view, ``(..., n + 1)``, positive towards +z.
        phases: phase of each intermediate shaft, ``(..., n - 1)`` or one for all.
        degrees: whether all three are in degrees.

    Raises:
        ValueError: a slope outside (-90°, 90°), a bend of 90° or more, shapes that do not fit.
    """
    up = _slopes("vertical", vertical, degrees)
    right = _slopes("horizontal", horizontal, degrees)
    return from_directions(cls, sloping(up, right), phases, degrees=degrees)


def from_readings(
    cls: type[Driveline],
    readings: ArrayLike,
    lengths: ArrayLike | None = None,
    offsets: ArrayLike | None = None,
    phases: ArrayLike = 0.0,
    *,
    gauge: float | None = None,
    samples: int = 1000,
    degrees: bool = False,
) -> Driveline:
    """Make drivelines from what an inclinometer shows on each shaft and a tape measure in plan.

    A gauge along a shaft shows its true angle r with the horizontal, even where the shaft goes
    aside in plan. With its length L and offsets o of its ends, it points along
    ``(sqrt(1 - sin(r)**2 - (do/L)**2), sin(r), do/L)`` in right-handed axes: x from the drive to
    the output, y up, z to the right, looking from the drive towards the output (derived here). If x
    points rearwards, z is the vehicle's left.

    Args:
        readings: what the gauge shows on each shaft, ``(..., n + 1)``, positive if the shaft rises
            in the direction of power flow.
        lengths: of each shaft in m, ``(..., n + 1)``; offsets need them. With lengths the driveline
            has lengths for forces.
        offsets: of the driving end, the joint centres and the driven end in plan, in m towards +z,
            ``(..., n + 2)``; by default all lie in one vertical plane.
        phases: phase of each intermediate shaft, ``(..., n - 1)`` or one for all.
        gauge: how far each reading may be off. The result is then a batch with a further first
            axis of ``samples`` drivelines: the one that was read, and others whose readings are off
            by up to this much, spread evenly over everything that the gauge may hide.
        samples: how many.
        degrees: whether readings, gauge and phases are in degrees.

    Raises:
        ValueError: a reading outside (-90°, 90°), offsets without lengths, ends of a shaft that
            are farther aside than it is long, a gauge that is not positive, a bend of 90° or more,
            shapes that do not fit.

    >>> import cardan
    >>> line = cardan.Driveline.from_readings([-3.0, -5.5, -3.0], degrees=True)
    >>> line.bends_deg.round(4)
    array([2.5, 2.5])
    """
    up = _slopes("readings", readings, degrees, "reading")
    if gauge is not None:
        size = positive("gauge", gauge)
        off = (np.radians(size) if degrees else size) * spread_evenly(samples, up.shape[-1])
        up = up + off.reshape(samples, *(1,) * (up.ndim - 1), up.shape[-1])
        check_elements("gauge", size, np.all(np.abs(up) < np.pi / 2), " leads past 90 deg")
    if lengths is None:
        if offsets is not None:
            raise ArgumentValueError("offsets", "need the lengths of the shafts")
        along = np.stack([np.cos(up), np.sin(up), np.zeros_like(up)], axis=-1)
        return from_directions(cls, along, phases, degrees=degrees)
    return from_points(cls, surveyed(up, lengths, offsets), phases, degrees=degrees)


def surveyed(up: FloatArray, lengths: ArrayLike, offsets: ArrayLike | None = None) -> FloatArray:
    """Return the points of ``from_readings``, ``(..., n + 2, 3)``, in the unit of the lengths."""
    size = positive("lengths", lengths)
    ends = np.zeros(up.shape[-1] + 1) if offsets is None else as_float64("offsets", offsets)
    check_shape("offsets", ends, ends.ndim > 0, "it must be (..., n + 2)")
    aside = np.diff(ends, axis=-1)
    shape = common_shape(readings=up.shape, lengths=size.shape, offsets=aside.shape)
    rise, long, apart = (np.broadcast_to(each, shape) for each in (np.sin(up), size, aside))
    forward = 1.0 - rise**2 - (apart / long) ** 2
    if np.any(forward <= 0.0):
        *place, shaft = (int(i) for i in np.argwhere(forward <= 0.0)[0])
        own = (*place, shaft)
        reach = long[own] * np.sqrt(1.0 - rise[own] ** 2)
        raise ArgumentValueError(
            "offsets",
            f"go aside by {abs(apart[own]):.6g} along shaft {shaft}, which is {long[own]:.6g} long "
            f"and at its reading goes aside by less than {reach:.6g}; measure all three again",
            tuple(place) if ends.ndim > 1 else (),
        )
    spans = np.stack([long * np.sqrt(forward), long * rise, apart], axis=-1)
    return end_to_end(spans)


def spread_evenly(samples: int, dimensions: int) -> FloatArray:
    """Return points of the cube [-1, 1] of some dimensions, the first its middle, spread evenly.

    Multiples of the powers of a root, which fill a cube more evenly than random numbers do (the
    sequence of Kronecker with the root of ``x**(d + 1) = x + 1``).
    """
    root = 1.0
    for _ in range(60):
        root = (1.0 + root) ** (1.0 / (dimensions + 1))
    steps = root ** -np.arange(1.0, dimensions + 1)
    return 2.0 * np.mod(0.5 + np.arange(samples)[:, np.newaxis] * steps, 1.0) - 1.0


@deferring(ends=0, vertical=1, horizontal=1, phases=1)
def from_projected_bends(
    cls: type[Driveline],
    vertical: ArrayLike,
    horizontal: ArrayLike,
    phases: ArrayLike = 0.0,
    *,
    degrees: bool = False,
    reference: Literal["common", "input", "output"] = "common",
) -> Driveline:
    """Make shafts with two joints from their bends as projected in side view and top view.

    This is the catalogues' form (double joint, 6.3, Bilder 17 to 19). The bends of a drawing
    add up along the shaft, so it matters from which shaft the drawing measures them: by the
    catalogue's figure from the common one, for which ``tan(bend)**2 = tan(vertical)**2 +
    tan(horizontal)**2`` holds exactly.

    Args:
        vertical: bend of both joints in side view, ``(..., 2)``, positive upwards.
        horizontal: bend of both joints in top view, ``(..., 2)``, positive to the right,
            looking from the drive towards the output: towards +z as in ``from_slopes``.
        phases: phase of the common shaft, ``(..., 1)`` or one for all.
        degrees: whether all three are in degrees.
        reference: the shaft from which they are measured: ``"common"``, ``"input"`` or
            ``"output"``.

    Raises:
        ValueError: not two joints, an unknown reference, and as for ``from_slopes``.
    """
    up = _slopes_against(reference, "vertical", vertical, degrees)
    right = _slopes_against(reference, "horizontal", horizontal, degrees)
    return from_directions(cls, sloping(up, right), phases, degrees=degrees)


def from_double_joint(
    cls: type[Driveline],
    total: ArrayLike,
    length: ArrayLike,
    pivot: ArrayLike | None = None,
    synchronous: ArrayLike | None = None,
    *,
    degrees: bool = False,
) -> Driveline:
    """Make centred double joints: two joints with yokes in line, bent in the same sense.

    Those of the steering drive of an axle, or of a wide-angle shaft, are a short distance apart,
    and a pivot between them centres the piece that connects them. The law of sines in the triangle
    of joint 0, pivot and joint 1 gives their bends. Both are equal, and the drive is synchronous,
    where ``p = length/(2 cos(total/2))``. One pivot cannot do that at every bend: one that is to be
    synchronous at a bend lies a little farther than the middle of the joints.

    The pivot is fixed to the driving shaft, at the distance ``p`` from joint 0, and slides
    along the driven one: ``sin b_1 = (p/length) sin(total)`` and ``b_0 = total - b_1`` (derived
    here). All arguments broadcast against each other; their shape is the batch.

    Args:
        total: bend between the driving and the driven shaft.
        length: distance between the joint centres, in any unit.
        pivot: distance of the pivot from the centre of joint 0, in the same unit; by default
            half the length.
        synchronous: or the total bend at which both joints have the same bend, so that the
            pivot is at ``length/(2 cos(synchronous/2))``. Give one of the two at most.
        degrees: whether the bends are in degrees.

    Raises:
        ValueError: a total bend outside [0, 180°) or one that bends a joint by 90° or more, a
            length that is not positive, a pivot that is not between the joints, both a pivot
            and a synchronous bend, shapes that do not broadcast.

    >>> import cardan
    >>> joint = cardan.Driveline.from_double_joint([20, 35], 0.06, synchronous=35, degrees=True)
    >>> joint.bends_deg.round(4)
    array([[ 9.6705, 10.3295],
           [17.5   , 17.5   ]])
    """
    exclusive(pivot=pivot, synchronous=synchronous)
    bend, apart = as_float64("total", total), positive("length", length)
    turn = 180.0 if degrees else np.pi
    unit = " deg; it must lie in [0, 180) deg" if degrees else " rad; it must lie in [0, pi) rad"
    check_elements("total", bend, (bend >= 0.0) & (bend < turn), unit)
    share = _share(apart, pivot, synchronous, degrees)
    shape = common_shape(total=bend.shape, length=apart.shape, pivot=share.shape)
    angle = np.broadcast_to(np.radians(bend) if degrees else bend, shape)
    driven = np.arcsin(share * np.sin(angle))
    bends = np.stack([angle - driven, driven], axis=-1)
    if np.any(bends >= 0.5 * np.pi):
        *place, joint = (int(i) for i in np.argwhere(bends >= 0.5 * np.pi)[0])
        given = np.broadcast_to(bend, shape)[*place]
        raise ArgumentValueError(
            "total",
            f"is {given}{' deg' if degrees else ' rad'}, which bends joint {joint} by "
            f"{np.degrees(bends[*place, joint]):.6g} deg; a bend must lie in [0, 90) deg",
            tuple(place) if bend.ndim else (),
        )
    return cls.from_bends(bends)


def _laid_out(
    lay_out: Callable[..., Sequence[FloatArray]], n: int, **arrays: tuple[FloatArray, int]
) -> Geometry:
    """Broadcast the arrays, phases last, and let a function of the native module do the rest.

    With each array comes how many axes of it belong to one driveline.
    """
    shape, full = together(arrays)
    flat = (array.ravel() for array in full)
    try:
        bends, twists, directions, normals, *lengths = lay_out(n, list(shape), *flat)
    except ArgumentValueError as error:
        if error.argument not in arrays:
            raise
        array, own = arrays[error.argument]
        raise error.at(place_in(array.shape[: array.ndim - own], shape, error.place)) from None
    return Geometry(
        bends.reshape(*shape, n),
        twists.reshape(*shape, n - 1),
        # The others are new; this may be the caller's own array.
        np.array(full[-1]),
        directions.reshape(*shape, n + 1, 3),
        normals.reshape(*shape, n, 3),
        lengths[0].reshape(*shape, n + 1) if lengths else np.empty((*shape, 0)),
        np.empty((*shape, 0)),
        np.empty((*shape, 0, 3)),
    )


def _vectors(name: str, value: ArrayLike, fewest: int) -> FloatArray:
    array = as_float64(name, value)
    right = array.ndim >= 2 and array.shape[-1] == 3 and array.shape[-2] >= fewest
    check_shape(name, array, right, f"it must be (..., {fewest} or more, 3)")
    return array


def _slopes(name: str, value: ArrayLike, degrees: bool, what: str = "slope") -> FloatArray:
    array = np.atleast_1d(as_float64(name, value))
    right_angle, unit = (90.0, "90 deg") if degrees else (np.pi / 2, "pi/2 rad")
    rule = f"; a {what} must lie between -{unit} and {unit}"
    check_elements(name, array, np.abs(array) < right_angle, rule)
    return np.radians(array) if degrees else array


def _slopes_against(reference: str, name: str, value: ArrayLike, degrees: bool) -> FloatArray:
    """Slopes of three shafts from the two bends between them, the shaft of reference level."""
    bend = _slopes(name, value, degrees, "projected bend")
    check_shape(name, bend, bend.shape[-1] == 2, "two joints need (..., 2)")
    first, second = np.moveaxis(bend, -1, 0)
    level = np.zeros_like(first)
    slopes = {
        "common": (-first, level, second),
        "input": (level, first, first + second),
        "output": (-first - second, -second, level),
    }
    check_choice("reference", reference, [*slopes])
    view = np.stack(slopes[reference], axis=-1)
    if np.any(np.abs(view) >= np.pi / 2):
        raise ArgumentValueError(name, f"adds up to 90 deg or more against the {reference} shaft")
    return view


def sloping(vertical: FloatArray, horizontal: FloatArray) -> FloatArray:
    """Directions from the slopes in side view and top view."""
    if vertical.shape[-1] != horizontal.shape[-1]:
        up, right = vertical.shape[-1], horizontal.shape[-1]
        problem = f"has {up} shafts and horizontal {right}; they must be the same"
        raise ArgumentValueError("vertical", problem)
    common_shape(vertical=vertical.shape, horizontal=horizontal.shape)
    up, right = np.broadcast_arrays(np.tan(vertical), np.tan(horizontal))
    return np.stack([np.ones_like(up), up, right], axis=-1)


def _share(
    apart: FloatArray, pivot: ArrayLike | None, synchronous: ArrayLike | None, degrees: bool
) -> FloatArray:
    """The distance of the pivot from joint 0 over that of the joints."""
    if synchronous is not None:
        bend = as_float64("synchronous", synchronous)
        most = 120.0 if degrees else 2.0 * np.pi / 3.0
        unit = "deg" if degrees else "rad"
        rule = f" {unit}; it must lie in [0, {most:.6g}) {unit}, which puts the pivot between them"
        check_elements("synchronous", bend, (bend >= 0.0) & (bend < most), rule)
        half = 0.5 * (np.radians(bend) if degrees else bend)
        return np.asarray(0.5 / np.cos(half))
    if pivot is None:
        return np.asarray(0.5)
    place = as_float64("pivot", pivot)
    common_shape(pivot=place.shape, length=apart.shape)
    share = place / apart
    right = (share > 0.0) & (share < 1.0)
    whole = np.broadcast_to(place, share.shape)
    check_elements("pivot", whole, right, "; it must lie between the joints")
    return np.asarray(share)

"""The one joint that moves a shaft as its whole chain does: closed forms, steering columns."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, NamedTuple, NoReturn

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cardan import _core
from cardan.arrays import FloatArray, as_float64, scalar_or_array, threads
from cardan.arrays.errors import ArgumentValueError
from cardan.arrays.indices import item_index
from cardan.geometry.geometry import broadcast, require_driveline
from cardan.geometry.parameters import PARAMETERS, Parameters, checked_kind, parameter_shape

if TYPE_CHECKING:
    from cardan.driveline import Driveline


@dataclass(frozen=True, eq=False)
class EquivalentJoint:
    """Closed forms of one shaft's motion; each field has the shape of the driveline batch.

    Every shaft of every chain turns exactly as the driven shaft of one joint does, whose input
    angle is the drive angle plus an offset. Near full compensation compare ``k`` or
    ``non_uniformity``, not ``bend``: a rounding of 1e-16 in ``k`` is 2e-8 rad in ``bend``.

    Source: a joint takes the pin's direction ``w = exp(i a)`` to ``w - tan(b/2)**2 conj(w)`` (from
    Thoma 4), a chain to ``A w + B conj(w)``, and ``k = |B/A|``. For one joint these are the
    catalogues' Bilder 12 (``max_angle_error``) and 13 (``non_uniformity``).

    Attributes:
        bend: equivalent bend in rad.
        angle_offset: what to add to the drive angle to get this joint's input angle, in rad,
            within (-pi/2, pi/2]; 0 where the shaft turns uniformly.
        k: ``tan(bend/2)**2``, the sine of the largest angle error.
        non_uniformity: largest less smallest speed ratio (catalogue, single joint:
            ``U = tan(bend) sin(bend)``).
        max_angle_error: in rad, at ``tan**2 = cos(bend)`` of the input angle.
        min_speed_ratio: ``cos(bend)``.
        max_speed_ratio: ``1/cos(bend)``.
        max_acceleration_ratio: largest magnitude of the acceleration ratio.
    """

    bend: NDArray[np.float64]
    angle_offset: NDArray[np.float64]
    k: NDArray[np.float64]
    non_uniformity: NDArray[np.float64]
    max_angle_error: NDArray[np.float64]
    min_speed_ratio: NDArray[np.float64]
    max_speed_ratio: NDArray[np.float64]
    max_acceleration_ratio: NDArray[np.float64]

    @property
    def max_angle_error_at(self) -> NDArray[np.float64]:
        """Drive angle in rad, within [0, pi), at which the angle error is ``max_angle_error``.

        The error repeats after half a turn. NaN where the shaft turns uniformly.

        Source: catalogue, Bild 12, at ``tan**2 = cos(bend)`` of the input angle.
        """
        place = np.mod(np.arctan(np.sqrt(self.min_speed_ratio)) - self.angle_offset, np.pi)
        return np.where(self.k > 0.0, place, np.nan)[()]

    @property
    def bend_deg(self) -> NDArray[np.float64]:
        """``bend`` in degrees."""
        return np.degrees(self.bend)

    @property
    def angle_offset_deg(self) -> NDArray[np.float64]:
        """``angle_offset`` in degrees."""
        return np.degrees(self.angle_offset)

    @property
    def max_angle_error_deg(self) -> NDArray[np.float64]:
        """``max_angle_error`` in degrees."""
        return np.degrees(self.max_angle_error)

    @property
    def max_angle_error_at_deg(self) -> NDArray[np.float64]:
        """``max_angle_error_at`` in degrees."""
        return np.degrees(self.max_angle_error_at)


class Motion(NamedTuple):
    """The motion of a shaft at drive angles, differentiated by the drive angle.

    All four have the shape of the batch, followed by that of the angles.
    """

    angle_error: Any
    """Angle of the shaft less the drive angle in rad, mean zero over a turn."""
    speed_ratio: Any
    """First derivative of the shaft's angle, without a unit, as those that follow."""
    acceleration_ratio: Any
    """Second derivative."""
    jerk_ratio: Any
    """Third derivative."""


class Transmission:
    """How one shaft follows the drive: its motion at one angle, and the derivatives by ``q``.

    Behind a chain of joints all motion of a shaft depends on the drive angle ``a`` and on one
    complex number ``q = B/A`` of the map ``w -> A w + B conj(w)``. With ``u = exp(-2 i a)`` and
    ``g = 1/(1 + q u)`` the angle error is ``arg(1 + q u)``, the speed ratio
    ``Re((1 - q u) g)``, the acceleration ratio ``Re(4 i q u g**2)`` and the jerk ratio
    ``Re(8 q u (1 - q u) g**3)`` (derived here from Thoma 4). ``abs(q)`` is ``tan(bend/2)**2`` of
    the equivalent bend. Unlike the bend, ``q`` is smooth where the driveline becomes uniform.

    ``abs2``, which is ``abs(q)**2``, is the objective for constant velocity. The equivalent bend is
    not: near constant velocity it is ``2 sqrt(abs(q))``, whose slope is infinite there.

    For many angles ``Driveline.evaluate`` is faster.
    """

    __slots__ = ("_arguments", "_core", "q")

    q: NDArray[np.complex128]
    """The complex number, in the shape of the batch."""

    def __init__(self, line: Driveline, shaft: int = -1) -> None:
        """Take one shaft of a driveline, as ``Driveline.transmission`` does."""
        line._geometry.check_ideal(
            "a transmission by q exists",
            "evaluate gives the motion and Plan.derivatives its derivatives",
        )
        index = item_index("shaft", shaft, line.n_joints + 1)
        self._arguments = (line, index)
        self._core = _core.Transmission(line._lines, index)
        self.q = self._core.q().reshape(line.shape)[()]

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle as what it was made from."""
        return (Transmission, self._arguments)

    def __repr__(self) -> str:
        """Show the shaft and the driveline."""
        line, shaft = self._arguments
        return f"<Transmission to shaft {shaft} of {line!r}>"

    def motion(self, angle: ArrayLike) -> Motion:
        """Return the motion at drive angles.

        Args:
            angle: in rad, any shape; broadcasts against the batch. NaN and infinite angles give
                NaN.

        Raises:
            ValueError: shapes that do not broadcast.
        """
        return self._columns(self._core.motion, angle)

    def gradient(self, angle: ArrayLike) -> Motion:
        """Return the complex derivatives of the motion by ``q``.

        A change ``dq`` changes each quantity by ``(derivative * dq).real``.

        Args:
            angle: as of ``motion``, like the errors.
        """
        return self._columns(self._core.gradient, angle)

    @property
    def abs2(self) -> NDArray[np.float64]:
        """``abs(q)**2``, ``tan(bend/2)**4`` of the equivalent bend, in the shape of the batch."""
        return np.asarray(self.q.real**2 + self.q.imag**2)[()]

    def dq(self, by: Parameters = "bends") -> NDArray[np.complex128]:
        """Return the derivatives of ``q`` by parameters of the driveline.

        Those by the parameters of joints behind the shaft are 0. Angles are in rad and points in
        their own unit. By bends, twists or phases everything else keeps its value; by points all
        bends and twists change.

        A joint gives ``dk/db = tan(b/2)/cos(b/2)**2`` and a shaft ``exp(i p)`` with ``p = phase -
        twist + 90°``; products of the chain's maps before and behind them do the rest (derived
        here from Thoma 4). By points the product ``k exp(2 i P)`` of a joint is differentiated, not
        ``k`` and its plane's angle ``P``. Derivatives are therefore smooth through straight joints,
        whose plane is arbitrary.

        The drive angle counts from the plane of joint 0, and ``q`` turns with it. Where joint 0 is
        straight, that plane has no derivative by points and is held. ``d_abs2`` does not depend on
        it.

        Args:
            by: ``"bends"``, by which they are ``(..., n)``; ``"twists"`` or ``"phases"``,
                ``(..., n - 1)``; or ``"points"``, ``(..., n + 2, 3)``.

        Raises:
            TypeError: a kind that is not a name.
            ValueError: an unknown kind, points of a driveline that was not made from points.
        """
        line, index = self._arguments
        kind = checked_kind(line, by, PARAMETERS)
        flat = _core.dq(line._lines, index, kind, threads.at_most(None))
        return flat.reshape(*line.shape, *parameter_shape(kind, line.n_joints))

    def d_abs2(self, by: Parameters = "bends") -> NDArray[np.float64]:
        """Return the derivatives of ``abs2`` by parameters of the driveline.

        They are ``2 Re(conj(q) dq)``, smooth everywhere and 0 at constant velocity.

        Args:
            by: as for ``dq``, like shape and errors.
        """
        derivatives = self.dq(by)
        q = np.reshape(self.q, np.shape(self.q) + (1,) * (derivatives.ndim - np.ndim(self.q)))
        return 2.0 * (q.real * derivatives.real + q.imag * derivatives.imag)

    def d_bend(self, by: Parameters = "bends") -> NoReturn:
        """Refuse to differentiate the equivalent bend.

        Args:
            by: of no effect.

        Raises:
            TypeError: always. At constant velocity, where the bend is least, its slope is infinite.
        """
        raise TypeError(
            f"the equivalent bend has no derivative by {by} at constant velocity, where its slope "
            "is infinite; use d_abs2, the derivatives of abs(q)**2, or dq"
        )

    def _columns(self, of: Callable[[Any, Any], list[NDArray[Any]]], angle: ArrayLike) -> Motion:
        line, _ = self._arguments
        shape, numbers, (angles,) = broadcast(line, angle=as_float64("angle", angle))
        return Motion(*(column.reshape(shape)[()] for column in of(numbers, angles)))


def equivalent(line: Driveline, shaft: int = -1) -> EquivalentJoint:
    """Return the one joint that moves a shaft exactly as the whole chain does.

    Args:
        shaft: index of the shaft, by default the last.
    """
    index = item_index("shaft", shaft, line.n_joints + 1)
    line._geometry.check_ideal(
        "an equivalent joint exists", "evaluate and harmonics give the motion"
    )
    bends, twists, phases, *_ = line._geometry.flat()
    columns = _core.equivalent(line.n_joints, index, bends, twists, phases)
    return EquivalentJoint(*(scalar_or_array(c.reshape(line.shape)) for c in columns))


def transmission(line: Driveline, shaft: int = -1) -> Transmission:
    """Return how a shaft follows the drive: motion at one angle, derivatives by ``q``.

    Args:
        shaft: index of the shaft, by default the last.
    """
    return Transmission(line, shaft)


@dataclass(frozen=True, eq=False)
class Steering:
    """What a steering column does about straight ahead; fields have the shape of the batch.

    The last shaft follows the column as the driven shaft of one joint. Its ratio is ``(1 -
    k**2)/(1 - 2 k cos 2 t + k**2)`` at the input angle ``t`` of that joint, which is even about
    every multiple of 90° and about no other angle (derived here from Thoma 4). So left and right
    are symmetric if and only if straight ahead is at such a multiple: at an even one the ratio is
    largest there (quick), at an odd one least (slow).

    Attributes:
        ratio: speed of the last shaft over that of the column, straight ahead.
        slope: derivative of the ratio by the angle of the column there, per rad.
        offset: angle in rad by which straight ahead is beyond the nearest symmetric position,
            within [-pi/4, pi/4].
        quick: whether that position is one of the largest ratio.
        turn_to_quick: by how much to turn the driving yoke of joint 0 on the column, in rad within
            [-pi/2, pi/2], so that the ratio is largest straight ahead; positive is clockwise,
            looking from the column towards the output.
        turn_to_slow: the same for the least ratio.
        difference: largest difference of the ratio between equal angles of the column to the left
            and to the right of straight ahead; 0 where they are symmetric.
        noticed: the offset, or 0 where the difference is less than 0.1 %, which no driver feels.
    """

    ratio: FloatArray
    slope: FloatArray
    offset: FloatArray
    quick: NDArray[np.bool_]
    turn_to_quick: FloatArray
    turn_to_slow: FloatArray
    difference: FloatArray
    noticed: FloatArray


def steering(
    line: Driveline,
    centre: ArrayLike = 0.0,
    *,
    drawn: Driveline | None = None,
    degrees: bool = False,
) -> Steering:
    """Return what the driveline does as a steering column about straight ahead.

    Args:
        centre: angle of shaft 0 straight ahead, as drive angles count; broadcasts against the
            batch.
        drawn: one other position of the column, in which the angle counts. A column that tilts
            carries its yoke along by the smallest rotation. By default the angle counts in each
            driveline of the batch.
        degrees: whether it is in degrees.

    Raises:
        TypeError: a drawn driveline that is none.
        ValueError: shapes that do not broadcast, several drawn drivelines.
    """
    line._geometry.check_ideal("steering is judged", "evaluate and harmonics give the motion")
    angle = np.radians(centre) if degrees else as_float64("centre", centre)
    shape, numbers, (angles,) = broadcast(line, centre=angle)
    if drawn is not None:
        require_driveline("drawn", drawn)
        if drawn.shape:
            raise ArgumentValueError("drawn", f"has shape {drawn.shape}; it is one driveline")
    own = None if drawn is None else drawn._lines
    flat = _core.steering(line._lines, numbers, angles, own, threads.at_most(None))
    ratio, slope, offset, quick, *others = flat.reshape(8, *shape)
    return Steering(ratio, slope, offset, np.asarray(quick != 0.0)[()], *others)

"""The ball joint of Marcus (1902): how its pressure is spread, what size it needs, its friction.

M. Marcus, "Beitrag zur Berechnung eines Kugelgelenks", Schweizerische Bauzeitung 39/40 (1902),
Heft 6; numbers in brackets are those of his equations. Where the ball touches is in contact.py.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike

from cardan.arrays import FloatArray, as_float64, common_shape, positive, scalar_or_array
from cardan.arrays.errors import ArgumentValueError, check_elements
from cardan.ball_joint.contact import Contact, elliptic, fitting, layer_compliance, loose, pressed

__all__ = ["BallJoint", "layer_compliance"]


@dataclass(frozen=True, eq=False, init=False)
class BallJoint:
    """A ball pressed into a spherical seat, or a batch of such joints.

    Everything broadcasts, as NumPy's own functions do: the values of the joint against each other
    and against loads and angles. NaN in a load, an angle or a vector gives NaN at that place alone.
    All methods refuse values that are not real numbers with a ``TypeError``; a negative load or
    friction, values out of the range that they name and shapes that do not broadcast with a
    ``ValueError``.

    Args:
        radius: radius of the ball in m.
        half_angle: angle in rad from the middle of the seat, where the load points, to its edge,
            in (0, pi/2]; by default the full hemisphere.

    Attributes:
        radius: as given.
        half_angle: as given.
        clearance: radius of the seat less that of the ball, in m; 0 unless ``with_clearance``.
        compliance: approach per peak pressure in m³/N (m per Pa), Marcus's ``alpha_1 + alpha_2``;
            None unless ``with_clearance``.

    Raises:
        TypeError: values that are not real numbers.
        ValueError: a value out of its range or not finite, shapes that do not broadcast.

    >>> joint = BallJoint(radius=0.05)
    >>> float(joint.peak_pressure(load=1e5).round())
    19098593.0
    >>> loose = joint.with_clearance(1e-4, compliance=1e-12)
    >>> float(np.degrees(loose.contact_angle(load=1e5)).round(2))
    46.57
    """

    radius: Any
    half_angle: Any
    clearance: Any
    compliance: Any

    def __init__(self, radius: ArrayLike, half_angle: ArrayLike = math.pi / 2) -> None:
        """Make joints without clearance."""
        angle = as_float64("half_angle", half_angle)
        right = (angle > 0.0) & (angle <= math.pi / 2)
        check_elements("half_angle", angle, right, " rad; a half-angle must lie in (0, pi/2]")
        self._set(positive("radius", radius), angle, np.zeros(()), None)

    def with_clearance(self, clearance: ArrayLike, *, compliance: ArrayLike) -> Self:
        """Return the joint with a seat that is wider than the ball.

        Ball and seat then touch only within ``contact_angle(load)``, where the pressure ``N_0
        (cos(theta) - c)/(1 - c)`` ends; ``c = clearance/(approach + clearance)`` is the cosine of
        that angle unless the seat ends before. All methods take this into account.

        Args:
            clearance: radius of the seat less that of the ball, in m, finite; 0 is a perfect fit.
            compliance: approach per peak pressure in m³/N, positive, Marcus's ``alpha_1 +
                alpha_2``.
        """
        gap = as_float64("clearance", clearance)
        rule = " m; a clearance must be finite and not negative"
        check_elements("clearance", gap, (gap >= 0.0) & (gap < np.inf), rule)
        yielding = positive("compliance", compliance)
        return self._of(self.radius, self.half_angle, gap, yielding)

    @classmethod
    def sized_for(
        cls,
        load: ArrayLike,
        allowable_pressure: ArrayLike,
        half_angle: ArrayLike = math.pi / 2,
        *,
        clearance: ArrayLike = 0.0,
        compliance: ArrayLike | None = None,
    ) -> Self:
        """Return the smallest joint that carries a load, by Marcus's (11).

        With clearance the approach at the allowable pressure determines the contact angle, and the
        radius follows from it in closed form.

        Args:
            load: in N, positive.
            allowable_pressure: what the peak pressure may reach, in Pa, positive; Marcus's ``K``.
            half_angle: angle from the middle of the seat to its edge in rad, in (0, pi/2].
            clearance: radius of the seat less that of the ball, in m, as of ``with_clearance``.
            compliance: approach per peak pressure in m³/N; a joint with clearance needs it.
        """
        force = positive("load", load)
        pressure = positive("allowable_pressure", allowable_pressure)
        seat = cls(1.0, half_angle)
        shapes = {"load": force, "allowable_pressure": pressure, "half_angle": seat.half_angle}
        if compliance is None:
            if np.any(as_float64("clearance", clearance) != 0.0):
                raise ArgumentValueError("clearance", "is given without a compliance; it needs one")
            common_shape(**{name: np.shape(value) for name, value in shapes.items()})
            return cls(np.sqrt(seat.peak_pressure(force) / pressure), half_angle)
        seat = seat.with_clearance(clearance, compliance=compliance)
        shapes |= {"clearance": seat.clearance, "compliance": seat.compliance}
        common_shape(**{name: np.shape(value) for name, value in shapes.items()})
        contact = seat._pressed(pressure)
        radius = np.sqrt(contact.peak(force, np.ones(())) / pressure)
        return cls(radius, half_angle).with_clearance(clearance, compliance=compliance)

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the batch; ``()`` for one joint."""
        values = (self.radius, self.half_angle, self.clearance, self.compliance)
        return np.broadcast_shapes(*(np.shape(value) for value in values))

    def contact_angle(self, load: ArrayLike) -> Any:  # noqa: ANN401 - a scalar or an array
        """Return the angle in rad from the load to the edge of the contact.

        Without clearance that is the edge of the seat. With it the cosine of the angle is
        ``clearance/(approach + clearance)``, unless the seat ends before; a load of 0 touches in a
        point.

        Args:
            load: in N, not negative.
        """
        force = self._force(load)
        return scalar_or_array(self._contact(force).angle + np.zeros(self.shape) * force)

    def peak_pressure(self, load: ArrayLike) -> Any:  # noqa: ANN401
        """Return the pressure ``N_0`` in Pa in line with the load.

        For the hemisphere without clearance it is ``3 D/(2 pi r²)``, Marcus's (10): three times
        the load over the surface of the hemisphere, 1.5 times the load over its projection, which
        is what a uniform pressure would be.

        Args:
            load: in N, not negative.
        """
        force = self._force(load)
        return scalar_or_array(self._contact(force).peak(force, self.radius))

    def allowable_load(self, allowable_pressure: ArrayLike) -> Any:  # noqa: ANN401
        """Return the load in N at which the peak pressure reaches what is allowable.

        Args:
            allowable_pressure: in Pa, positive, Marcus's ``K``.
        """
        pressure = positive("allowable_pressure", allowable_pressure)
        common_shape(joint=self.shape, allowable_pressure=pressure.shape)
        if self.compliance is None:
            contact = fitting(as_float64("half_angle", self.half_angle))
        else:
            contact = self._pressed(pressure)
        return scalar_or_array(contact.load(pressure, self.radius))

    def _pressed(self, peak: FloatArray) -> Contact:
        """The contact at a peak pressure."""
        approach = np.asarray(self.compliance * peak)
        return pressed(np.asarray(self.half_angle), approach, np.asarray(self.clearance))

    def pressure(self, theta: ArrayLike, load: ArrayLike) -> Any:  # noqa: ANN401
        """Return the pressure in Pa, Marcus's (9); outside the contact it is 0.

        Args:
            theta: angle in rad from the load, of either sign; an infinite one gives NaN.
            load: in N, not negative.
        """
        angle, force = as_float64("theta", theta), self._force(load)
        common_shape(joint=self.shape, theta=angle.shape, load=force.shape)
        contact = self._contact(force)
        return scalar_or_array(contact.peak(force, self.radius) * contact.profile(angle))

    def pressure_at(self, directions: ArrayLike, load_vector: ArrayLike) -> Any:  # noqa: ANN401
        """Return the pressure in Pa at points of the ball for a load in any direction.

        The seat is centred on the load: ``half_angle`` counts from there.

        Args:
            directions: from the centre of the ball to the points, ``(..., 3)``, of any length.
            load_vector: force of the ball on its seat in N, ``(..., 3)``, neither 0 nor infinite.
        """
        normal, _ = _unit("directions", directions)
        axis, force = _unit("load_vector", load_vector)
        common_shape(joint=self.shape, directions=normal.shape[:-1], load_vector=force.shape)
        # Of the formulas for the angle between unit vectors the only one that is good at all
        # angles (W. Kahan, "How Futile are Mindless Assessments of Roundoff", 2006, section 12).
        angle = 2.0 * np.arctan2(_length(normal - axis), _length(normal + axis))
        contact = self._contact(force)
        return scalar_or_array(contact.peak(force, self.radius) * contact.profile(angle))

    def approach(self, load: ArrayLike, compliance: ArrayLike | None = None) -> Any:  # noqa: ANN401
        """Return how far the ball sinks into its seat, Marcus's ``zeta`` in (8), in m.

        Args:
            load: in N, not negative.
            compliance: approach per peak pressure in m³/N, positive; leave it out if
                ``with_clearance`` has set it.
        """
        if (compliance is None) == (self.compliance is None):
            how = "missing" if compliance is None else "given, but with_clearance has set it"
            raise ArgumentValueError("compliance", f"is {how}; the approach needs it once")
        own = self.compliance if compliance is None else positive("compliance", compliance)
        force = self._force(load)
        common_shape(joint=self.shape, load=force.shape, compliance=own.shape)
        return scalar_or_array(own * self._contact(force).peak(force, self.radius))

    def friction_moment(self, load: ArrayLike, friction: ArrayLike) -> Any:  # noqa: ANN401
        """Return the moment in N m that turns the ball about the line of the load.

        The friction ``mu N`` acts on the arm ``r sin(theta)`` everywhere. A hemisphere without
        clearance takes ``mu D r``, a cut seat ``mu D r sin(t) (1 + c)/(1 + c + c²)`` with ``t``
        the half-angle and ``c`` its cosine. With clearance the integral is done numerically, to
        all digits: its closed form would lose them in a small contact.

        Args:
            load: in N, not negative.
            friction: coefficient of friction, not negative.
        """

        def closed(sine: FloatArray, c: FloatArray) -> FloatArray:
            return sine * (1.0 + c) / (1.0 + c + c * c)

        return self._friction(load, friction, closed, np.sin)

    def tilting_friction_moment(self, load: ArrayLike, friction: ArrayLike) -> Any:  # noqa: ANN401
        """Return the moment in N m that swivels the ball about a line across the load.

        The arm of a point is its distance from that line, on average over a circle of latitude
        ``r (2/pi) E(sin(theta))`` with the complete elliptic integral of the second kind. A
        hemisphere without clearance takes ``(4/pi) mu D r``; a small contact ``mu D r``, for there
        all points slide alike.

        The load goes through the middle of the seat; it does not follow the swivel.

        Args:
            load: in N, not negative.
            friction: coefficient of friction, not negative.
        """

        # The integral of k E(k) from 0 to s = sin(t) is s² (B(s) + E(s))/3, with Legendre's B, the
        # integral of cos² over the root in E's denominator form. Unlike the usual (1 + s²) E -
        # (1 - s²) K it has no difference in it. s² cancels against 1 - c³ as in the other moment.
        def closed(_: FloatArray, c: FloatArray) -> FloatArray:
            return 2.0 / math.pi * (1.0 + c) / (1.0 + c + c * c) * elliptic(c, 2.0, c * c)

        def arm(theta: FloatArray) -> FloatArray:
            c = np.cos(theta)
            return 2.0 / math.pi * elliptic(c, 1.0, c * c)

        return self._friction(load, friction, closed, arm)

    def _friction(
        self,
        load: ArrayLike,
        friction: ArrayLike,
        closed: Callable[[FloatArray, FloatArray], FloatArray],
        arm: Callable[[FloatArray], FloatArray],
    ) -> Any:  # noqa: ANN401
        force, mu = self._force(load), _not_negative("friction", friction)
        common_shape(joint=self.shape, load=force.shape, friction=mu.shape)
        if self.compliance is None:
            ratio = closed(np.sin(self.half_angle), np.cos(self.half_angle))
        else:
            ratio = self._contact(force).mean(arm)
        return scalar_or_array(mu * force * self.radius * ratio)

    def _contact(self, load: FloatArray) -> Contact:
        if self.compliance is None:
            return fitting(self.half_angle)
        return loose(self.radius, self.half_angle, self.clearance, self.compliance, load)

    def _force(self, load: ArrayLike) -> FloatArray:
        force = _not_negative("load", load)
        common_shape(joint=self.shape, load=force.shape)
        return force

    @classmethod
    def _of(cls, *values: Any) -> Self:  # noqa: ANN401 - of ``_set``
        joint = object.__new__(cls)
        joint._set(*values)
        return joint

    def _set(
        self, radius: ArrayLike, angle: ArrayLike, gap: ArrayLike, compliance: ArrayLike | None
    ) -> None:
        values = {"radius": radius, "half_angle": angle, "clearance": gap, "compliance": compliance}
        common_shape(**{name: np.shape(x) for name, x in values.items() if x is not None})
        for name, value in values.items():
            if value is not None:
                array = np.array(value)
                array.flags.writeable = False
                value = scalar_or_array(array)
            object.__setattr__(self, name, value)

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle as the four values, so that copies are read-only too."""
        return (self._of, (self.radius, self.half_angle, self.clearance, self.compliance))


# --- arguments -------------------------------------------------------------------------------


def _not_negative(name: str, value: ArrayLike) -> FloatArray:
    """What is evaluated, unlike what makes a joint, may be NaN."""
    array = as_float64(name, value)
    wrong = (array < 0.0) | np.isinf(array)
    check_elements(name, array, ~wrong, "; it must be finite and not negative")
    return array


def _unit(name: str, value: ArrayLike) -> tuple[FloatArray, FloatArray]:
    """Vectors made unit ones, and their lengths."""
    array = as_float64(name, value)
    if array.ndim == 0 or array.shape[-1] != 3:
        raise ArgumentValueError(name, f"has shape {array.shape}; vectors need (..., 3)")
    length = _length(array)
    wrong = (length == 0.0) | np.isinf(length)
    check_elements(f"length of {name}", length, ~wrong, "; it must be positive and finite")
    return array / length[..., None], length


def _length(vectors: FloatArray) -> FloatArray:
    # No overflow or underflow in the squares.
    x, y, z = np.moveaxis(vectors, -1, 0)
    return np.asarray(np.hypot(np.hypot(x, y), z))

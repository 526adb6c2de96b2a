"""The ball joint of Marcus (1902): how its pressure is spread, what size it needs, its friction.

M. Marcus, "Beitrag zur Berechnung eines Kugelgelenks", Schweizerische Bauzeitung 39/40 (1902),
Heft 6; numbers in brackets are those of his equations.

He takes the normal compression of ball and seat as proportional to the pressure, ``(alpha_1 +
alpha_2) N`` in his (1). A ball that sinks by the approach ``zeta`` into a seat that it fits is
compressed by ``zeta cos(theta)`` at the angle ``theta`` from the load, his (2), so that ``N = N_0
cos(theta)``, his (9). A seat that ends before the equator keeps the law and only bounds the
integral of the load, his (7), which in print has lost its ``d psi``.

With a radial clearance ``e`` the gap ``e (1 - cos(theta))`` closes first: the compression is
``(zeta + e) cos(theta) - e``, and the contact ends where that is zero. This adds one unknown, the
angle of the contact, but the model stays Marcus's: each point yields like a separate spring. It
is meant for clearances that are small beside the radius.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cardan.arrays import FloatArray, as_float64, common_shape, positive, scalar_or_array
from cardan.arrays.errors import ArgumentValueError, check_elements

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
    """Return an input of an evaluation, which may be NaN."""
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


# --- where the ball touches its seat ---------------------------------------------------------


@dataclass(frozen=True, eq=False)
class Contact:
    """Contact area of a ball, and how the pressure falls off from its peak.

    Without clearance, the pressure would be zero at a right angle, which None stands for. It is
    beyond the edge of the contact if the seat ends before.
    """

    angle: FloatArray  # from the load to the edge of the contact
    free: FloatArray | None  # from the load to where the pressure would be zero
    share: FloatArray  # 3 D/(pi r² N_0)

    def peak(self, load: FloatArray, radius: FloatArray) -> FloatArray:
        """Return the pressure in line with the load."""
        return _quotient(3.0 * load, math.pi * radius**2 * self.share)

    def load(self, peak: FloatArray, radius: FloatArray) -> FloatArray:
        """Return the load whose pressure has this peak."""
        return peak * math.pi * radius**2 * self.share / 3.0

    def profile(self, theta: FloatArray) -> FloatArray:
        """Return the pressure over its peak."""
        theta = np.where(np.isinf(theta), np.nan, theta)
        inside = np.where(np.abs(theta) <= self.angle, self._law(theta), 0.0)
        return np.where(np.isnan(theta), np.nan, inside)

    def _law(self, theta: FloatArray) -> FloatArray:
        if self.free is None:
            return np.cos(theta)
        # (cos(theta) - c)/(1 - c) with c = cos(free) as products: exact up to the edge.
        rise = np.sin((self.free + theta) / 2.0) * np.sin((self.free - theta) / 2.0)
        return _quotient(rise, np.sin(self.free / 2.0) ** 2)

    def mean(self, arm: Callable[[FloatArray], FloatArray]) -> FloatArray:
        """Return the integral of pressure times arm over the surface, per load."""
        total = np.zeros(np.shape(self.angle))
        for node, weight in _NODES:
            # Clustering the nodes towards the edge tames the logarithm in the derivatives of E at
            # the equator, where a contact may end; nothing else is less than analytic.
            theta = self.angle * (node * (2.0 - node))
            total += weight * (1.0 - node) * self._law(theta) * np.sin(theta) * arm(theta)
        return _quotient(6.0 * self.angle * total, self.share)


# Gauss's rule of 24 points: its positive nodes with their weights, each the nearest double. The
# weights of NumPy's ``leggauss`` are up to 1e-13 off.
_GAUSS = (
    (0.06405689286260563, 0.12793819534675216),
    (0.1911188674736163, 0.1258374563468283),
    (0.3150426796961634, 0.12167047292780339),
    (0.4337935076260451, 0.1155056680537256),
    (0.5454214713888396, 0.10744427011596563),
    (0.6480936519369755, 0.09761865210411388),
    (0.7401241915785544, 0.08619016153195327),
    (0.820001985973903, 0.0733464814110803),
    (0.8864155270044011, 0.05929858491543678),
    (0.9382745520027328, 0.04427743881741981),
    (0.9747285559713095, 0.028531388628933663),
    (0.9951872199970213, 0.0123412297999872),
)

# Between 0 and 1. Enough for rounding in contacts of all sizes; 16 leave 30 ulp.
_NODES = tuple(((1.0 + sign * x) / 2.0, w) for sign in (-1.0, 1.0) for x, w in _GAUSS)


def fitting(half_angle: FloatArray) -> Contact:
    """A ball that fits its seat: ``share = 2 (1 - c³)``, without cancellation."""
    c, versine = np.cos(half_angle), _versine(half_angle)
    return Contact(half_angle, None, 2.0 * versine * (1.0 + c + c * c))


def loose(
    radius: FloatArray,
    half_angle: FloatArray,
    clearance: FloatArray,
    compliance: FloatArray,
    load: FloatArray,
) -> Contact:
    """A ball in a wider seat; see the head of this file for the law.

    With ``z`` the approach over the clearance, ``c = 1/(1 + z)`` and ``q = 3 compliance load/(pi r²
    clearance)``, the load of a contact that ends freely is ``(1 - c)² (2 + c) = q c``. Where the
    seat ends before, at the cosine ``c_0``, the balance is linear in ``z``.
    """
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        q = 3.0 * compliance * load / (math.pi * radius**2 * clearance)
    # A perfect fit touches everywhere under any load.
    q = np.where(np.asarray(clearance) == 0.0, np.inf, q)
    seat_c, seat_versine = np.cos(half_angle), _versine(half_angle)
    full = q * seat_c >= seat_versine**2 * (2.0 + seat_c)

    bounded = q + seat_versine**2 * (1.0 + 2.0 * seat_c)
    bounded = bounded / (2.0 * seat_versine * (1.0 + seat_c + seat_c**2))
    return _at(half_angle, np.where(full, bounded, _sunk(np.where(full, 1.0, q))), full)


def pressed(half_angle: FloatArray, approach: FloatArray, clearance: FloatArray) -> Contact:
    """A ball in a wider seat that has sunk in by a known approach."""
    with np.errstate(divide="ignore", over="ignore"):
        z = approach / clearance
    return _at(half_angle, z, z * np.cos(half_angle) >= _versine(half_angle))


def _at(half_angle: FloatArray, z: FloatArray, full: NDArray[np.bool_]) -> Contact:
    """The contact at the approach ``z`` over the clearance, which fills the seat or does not."""
    seat_c, seat_versine = np.cos(half_angle), _versine(half_angle)
    c = 1.0 / (1.0 + z)
    versine = np.where(z > 1.0, 1.0 - c, np.minimum(z, 1.0) * c)

    free = 2.0 * np.arcsin(np.sqrt(versine / 2.0))
    edge_c, edge_versine = np.where(full, seat_c, c), np.where(full, seat_versine, versine)
    cut = np.divide(seat_versine, versine, out=np.ones_like(versine), where=full)
    share = edge_versine * (3.0 * (1.0 + edge_c) - cut * (1.0 + 2.0 * edge_c))
    return Contact(np.where(full, half_angle, np.minimum(free, half_angle)), free, share)


def _sunk(q: FloatArray) -> FloatArray:
    """Solve ``z² (2 z + 3) = q (1 + z)²`` for ``z >= 0`` with full relative accuracy.

    That is the balance of a contact that ends freely, with positive terms only. The logarithm of
    the left over the right rises with that of ``z`` at a slope from 1 to 2 everywhere, so ``z`` is
    as well conditioned as ``q``, and Newton's method in these logarithms cannot go astray. The
    start is within 30 % and exact at both ends; the error then falls to rounding in four steps.
    """
    z = np.sqrt(q) / math.sqrt(3.0) + q / 2.0
    for _ in range(4):
        c = 1.0 / (1.0 + z)
        versine = z * c
        slope = 2.0 + 2.0 * z / (2.0 * z + 3.0) - 2.0 * versine
        # Divided in turn, the smallest numbers do not underflow.
        excess = _quotient(_quotient(q, z), versine * (2.0 + c)) - 1.0
        z = z * (1.0 + excess / slope)
    return z


def layer_compliance(thickness: ArrayLike, modulus: ArrayLike, poisson: ArrayLike = 0.3) -> Any:  # noqa: ANN401 - a scalar or an array
    """Return how far a layer is compressed per unit of pressure, in m³/N (m per Pa).

    Marcus's law, a compression in proportion to the pressure of the same point, is that of an
    elastic layer on a rigid ground that is wide in comparison with its thickness, so that it cannot
    expand sideways (Winkler's foundation; K. L. Johnson, "Contact Mechanics", 1985, section 4.3).

    It is ``t (1 + nu)(1 - 2 nu)/((1 - nu) E)``: the layer is bonded to what is behind it, much
    stiffer than that, and much thinner than the contact is wide. The compliance of a ball joint
    is the sum of those of ball and seat.

    Args:
        thickness: of the layer in m.
        modulus: Young's modulus in Pa.
        poisson: Poisson's ratio, in [0, 0.5). Near 0.5 the layer hardly yields in this way, and
            the model does not describe it.

    Raises:
        TypeError: values that are not real numbers.
        ValueError: a thickness or modulus that is not positive and finite, a ratio out of its
            range, shapes that do not broadcast.

    >>> f"{layer_compliance(0.5e-3, 1e9, 0.3):.3g}"
    '3.71e-13'
    """
    thick, young = positive("thickness", thickness), positive("modulus", modulus)
    ratio = as_float64("poisson", poisson)
    right = (ratio >= 0.0) & (ratio < 0.5)
    check_elements("poisson", ratio, right, "; Poisson's ratio must lie in [0, 0.5)")
    common_shape(thickness=thick.shape, modulus=young.shape, poisson=ratio.shape)
    lateral = (1.0 + ratio) * (1.0 - 2.0 * ratio) / (1.0 - ratio)
    return scalar_or_array(thick * lateral / young)


def elliptic(c: FloatArray, a: FloatArray | float, b: FloatArray | float) -> FloatArray:
    """Return the integral of ``(a cos² + b sin²)/sqrt(cos² + c² sin²)`` from 0 to pi/2.

    Bulirsch's ``cel`` with ``p = 1`` (DLMF 19.2.11), by Gauss's arithmetic-geometric mean: with
    each step of ``m`` and ``n``, the factors of cos² and sin² in the root, ``a`` and ``b`` are
    averaged too. Sums of positive terms only, so nothing cancels; ``c`` must be positive.
    """
    m, n = np.ones_like(c), c
    for _ in range(_MEANS):
        a, b = (a + b) / 2.0, (a * n + b * m) / (m + n)
        m, n = (m + n) / 2.0, np.sqrt(m * n)
    return np.asarray(math.pi / 2.0 * a / m)


# Enough for the smallest cosine there is, that of the double pi/2.
_MEANS = 10


def _versine(angle: FloatArray) -> FloatArray:
    """``1 - cos(angle)`` without cancellation."""
    return np.asarray(2.0 * np.sin(angle / 2.0) ** 2)


def _quotient(over: FloatArray, under: FloatArray) -> FloatArray:
    """Divide, with 0/0 = 0: no load, no contact."""
    over, under = np.broadcast_arrays(over, under)
    return np.divide(over, under, out=np.zeros(under.shape), where=under != 0.0)

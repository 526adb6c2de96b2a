"""Where a ball touches its seat, how the pressure falls off from its peak, and what a layer yields.

M. Marcus, "Beitrag zur Berechnung eines Kugelgelenks", Schweizerische Bauzeitung 39/40 (1902),
Heft 6, takes the normal compression of ball and seat as proportional to the pressure, ``(alpha_1 +
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
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cardan.arrays import FloatArray, as_float64, common_shape, positive, scalar_or_array
from cardan.arrays.errors import check_elements


@dataclass(frozen=True, eq=False)
class Contact:
    """Where a ball touches, and how the pressure falls off from its peak.

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

"""What the tests hold the library against: data files, and exact numbers for exact doubles.

The data in ``tests/data`` come from a vector model with 70 digits. What they do not list is
computed here with mpmath from the inputs as the doubles that they are, with a margin of more than
40 digits. The formulas for one joint are those of Thoma (1920) and Grossmann (1939), the chain is
the map ``w -> A w + B conj(w)`` of the drive's ``w = exp(i angle)``; the data confirm both.
"""

from __future__ import annotations

import json
import math
import tomllib
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from typing import Any, TypeAlias

import mpmath
import numpy as np
from numpy.typing import NDArray

from cardan import Driveline
from cardan.evaluation.plan import Plan
from cardan.evaluation.request import Request
from cardan.reference import Shafts, Vector

DATA = Path(__file__).parent / "data"
EPS = 2.0**-52
PI = Fraction("3.14159265358979323846264338327950288419716939937510582")

Doubles: TypeAlias = NDArray[np.float64]

# mpmath carries no types; this is one of its numbers.
MpNumber: TypeAlias = Any

mp = mpmath.mp.clone()
mp.dps = 60


def plan_at(
    line: Driveline,
    names: str | Iterable[str],
    *,
    level: str | None = None,
    **options: Any,  # noqa: ANN401 - of a request
) -> Plan:
    """A plan with an instruction set that is forced."""
    return Plan(line, Request(names, **options), level)


# --- data files ------------------------------------------------------------------------------


def read(name: str) -> dict[str, Any]:
    document: dict[str, Any] = json.loads((DATA / name).read_text(encoding="utf-8"))
    return document


def distinct(rows: list[dict[str, Any]], key: str) -> list[str]:
    return list(dict.fromkeys(row[key] for row in rows))


def off(got: float, want: str | Fraction) -> float:
    """Return the distance of a double from a decimal string, without rounding the string."""
    return abs(float(Fraction(float(got)) - Fraction(want)))


def off_vectors(
    got: Sequence[Sequence[float]] | Doubles, want: Sequence[Sequence[str | Fraction]]
) -> float:
    assert len(got) == len(want)
    return max(off(g, w) for v, x in zip(got, want, strict=True) for g, w in zip(v, x, strict=True))


def off_all(got: Iterable[float], want: Iterable[str]) -> float:
    return max(off(g, w) for g, w in zip(got, want, strict=True))


def reduced(angle: Fraction) -> float:
    """Round an exact angle to a double only after taking whole turns off."""
    return float(angle - 2 * PI * round(angle / (2 * PI)))


def radians(degrees: str) -> float:
    """Round an exact number of degrees to a double in radians, whole turns taken off."""
    return reduced(Fraction(degrees) * PI / 180)


def dot(v: Sequence[float], w: Sequence[float]) -> float:
    return math.fsum(x * y for x, y in zip(v, w, strict=True))


def cosines(shafts: Shafts) -> float:
    """Return ``c``, the product of the cosines of the bends, which rules the conditioning."""
    return math.prod(map(math.cos, shafts.bends))


def start_angle(case: dict[str, Any], u: Vector, m: Vector) -> float:
    """Return our drive angle at the start of a chain, where the pin is the part of ref0 across u.

    ``u`` is the direction of shaft 0 and ``m`` the normal of the first bend plane.
    """
    e_in = (m[1] * u[2] - m[2] * u[1], m[2] * u[0] - m[0] * u[2], m[0] * u[1] - m[1] * u[0])
    x, y, z = map(float, case["ref0"])
    return math.atan2(dot((x, y, z), m), dot((x, y, z), e_in))


def angles(case: dict[str, Any], start: float) -> list[float]:
    """Return the drive angle of each step, at most a few radians, so that its rounding is small."""
    return [reduced(Fraction(start) + Fraction(step["theta0"])) for step in case["steps"]]


def thoma_to_ours(bend: float, vector: Sequence[str]) -> list[Fraction]:
    """Turn a vector from Thoma's axes into ours, as exactly as the bend's sine and cosine are.

    His right-handed triad ``(n1, e_in, m)`` is our ``(+x, +y, +z)``: a vector's components here are
    its products with these three, written in his axes.
    """
    triad = [
        (-math.sin(bend), -math.cos(bend), 0.0),
        (math.cos(bend), -math.sin(bend), 0.0),
        (0.0, 0.0, 1.0),
    ]
    v = [Fraction(x) for x in vector]
    return [
        sum((x * Fraction(y) for x, y in zip(v, axis, strict=True)), Fraction(0)) for axis in triad
    ]


# --- exact numbers beside doubles ------------------------------------------------------------


@dataclass(frozen=True)
class Exact:
    """Exact numbers as unevaluated sums of two doubles, good to 1e-32 of themselves."""

    high: Doubles
    low: Doubles

    @classmethod
    def of(cls, numbers: Iterable[MpNumber]) -> Exact:
        high, low = [], []
        for x in numbers:
            nearest = float(x)
            high.append(nearest)
            low.append(float(x - nearest))
        return cls(np.array(high), np.array(low))

    @property
    def ulp(self) -> Doubles:
        """Spacing of the doubles at the exact numbers."""
        mantissa, exponent = np.frexp(self.high)
        # Just below a power of two the nearest double already has the wider spacing.
        below = (np.abs(mantissa) == 0.5) & (np.sign(self.low) == -np.sign(self.high))
        ulp: Doubles = np.ldexp(1.0, np.maximum(exponent - below - 53, -1074))
        return np.where(self.high == 0.0, 2.0**-1074, ulp)

    def distance(self, got: Doubles) -> Doubles:
        """Return how far the doubles are from the exact numbers."""
        return np.asarray(np.abs((got - self.high) - self.low))

    def ulps(self, got: Doubles) -> Doubles:
        """Return how far the doubles are from the exact numbers, in ulp of these."""
        return self.distance(got) / self.ulp


@dataclass(frozen=True)
class ExactTurn:
    """Sine and cosine of the exact value of a double."""

    angle: MpNumber
    sine: MpNumber
    cosine: MpNumber

    @classmethod
    def by(cls, angle: float) -> ExactTurn:
        # mpmath reduces with as many digits as the double's size and nearness to a multiple of
        # pi/2 ask for.
        cosine, sine = mp.cos_sin(mp.mpf(angle))
        return cls(mp.mpf(angle), sine, cosine)


@dataclass(frozen=True)
class ExactJoint:
    """One joint with the exact value of a double for its bend."""

    bend: MpNumber
    sine: MpNumber
    cosine: MpNumber
    versine: MpNumber

    @classmethod
    def bent(cls, bend: float) -> ExactJoint:
        at = ExactTurn.by(bend)
        # 1 - cos without cancellation.
        return cls(at.angle, at.sine, at.cosine, 2 * mp.sin(at.angle / 2) ** 2)

    def denominator(self, at: ExactTurn) -> MpNumber:
        return (at.cosine * self.cosine) ** 2 + at.sine**2

    def angle_error(self, at: ExactTurn) -> MpNumber:
        s, c = at.sine, at.cosine
        return mp.atan2(self.versine * s * c, c * c * self.cosine + s * s)

    def speed_ratio(self, at: ExactTurn) -> MpNumber:
        return self.cosine / self.denominator(at)

    def acceleration_ratio(self, at: ExactTurn) -> MpNumber:
        sc = at.sine * at.cosine
        return -2 * self.cosine * self.sine**2 * sc / self.denominator(at) ** 2

    def jerk_ratio(self, at: ExactTurn) -> MpNumber:
        """Differentiate the speed ratio twice, by the rule of the quotient."""
        s, c, length = at.sine, at.cosine, self.denominator(at)
        slope = 2 * self.sine**2 * s * c / length
        curvature = 2 * self.sine**2 * (c - s) * (c + s) / length
        return self.speed_ratio(at) * (2 * slope**2 - curvature)

    def jerk_term(self, at: ExactTurn) -> MpNumber:
        """Return the larger of the two terms whose difference is the jerk ratio.

        They are those of ``sin^4 a + 3 sin^2 b sin^2 a cos^2 a - cos^2 b cos^4 a`` times what
        stands before it. Beside the zeros of the difference they set the rounding.
        """
        s2, c2 = at.sine**2, at.cosine**2
        larger = max(s2 * (s2 + 3 * self.sine**2 * c2), (self.cosine * c2) ** 2)
        return 2 * self.cosine * self.sine**2 * larger / self.denominator(at) ** 3

    def moment(self, at: ExactTurn) -> tuple[MpNumber, MpNumber, MpNumber]:
        """Return the moment per unit drive torque, shaft 0 along x, normal along z."""
        tangent = self.sine / self.cosine
        return (mp.mpf(1), tangent * at.sine**2, -tangent * at.sine * at.cosine)

    @property
    def k(self) -> MpNumber:
        return mp.tan(self.bend / 2) ** 2

    @property
    def max_acceleration_ratio(self) -> MpNumber:
        if self.bend == 0:
            return mp.mpf(0)
        with mp.extradps(60):
            p = (2 - self.sine**2) / self.sine**2
            cosine = (-p + mp.sqrt(p * p + 8)) / 2
            at = ExactTurn(None, -mp.sqrt((1 - cosine) / 2), mp.sqrt((1 + cosine) / 2))
        return self.acceleration_ratio(at)


@dataclass(frozen=True)
class Fold:
    """The map ``w -> a w + b conj(w)`` of a chain, and ``|a|**2 - |b|**2``."""

    a: MpNumber
    b: MpNumber
    complement: MpNumber

    @classmethod
    def of(cls, bends: Sequence[float], twists: Sequence[float], phases: Sequence[float]) -> Fold:
        """Fold a chain whose angles are exactly the given doubles."""
        a, b, complement = mp.mpc(1), mp.mpc(0), mp.mpf(1)
        for j, bend in enumerate(bends):
            if j > 0:
                turn = mp.expj(mp.mpf(phases[j - 1]) - mp.mpf(twists[j - 1])) * mp.mpc(0, 1)
                a, b = a * turn, b * turn
            k = ExactJoint.bent(bend).k
            a, b = a - k * mp.conj(b), b - k * mp.conj(a)
            complement *= 1 - k * k
        return cls(a, b, complement)

    @property
    def k(self) -> MpNumber:
        return abs(self.b / self.a)

    def past_shaft(self, twist: float, phase: float) -> Fold:
        """Return the map to the driving yoke of the next joint."""
        turn = mp.expj(mp.mpf(phase) - mp.mpf(twist)) * mp.mpc(0, 1)
        return Fold(self.a * turn, self.b * turn, self.complement)

    def tilts(self, bend: float, at: ExactTurn) -> tuple[MpNumber, MpNumber]:
        """Return the tilts of the cross of a joint that the map drives: Grossmann (3) and (5)."""
        joint, w = ExactJoint.bent(bend), mp.mpc(at.cosine, at.sine)
        v = self.a * w + self.b * mp.conj(w)
        v /= abs(v)
        along = mp.hypot(mp.im(v), joint.cosine * mp.re(v))
        driving = mp.atan2(joint.sine * mp.im(v), joint.cosine)
        return driving, mp.atan2(joint.sine * mp.re(v), along)

    def angle(self, at: ExactTurn) -> MpNumber:
        return at.angle + self.angle_error(at)

    def angle_error(self, at: ExactTurn) -> MpNumber:
        w = mp.mpc(at.cosine, at.sine)
        return mp.arg(1 + self.b / self.a * mp.conj(w) ** 2)

    def speed_ratio(self, at: ExactTurn) -> MpNumber:
        w = mp.mpc(at.cosine, at.sine)
        return self.complement / abs(self.a * w + self.b * mp.conj(w)) ** 2

    def acceleration_ratio(self, at: ExactTurn) -> MpNumber:
        w = mp.mpc(at.cosine, at.sine)
        v = self.a * w + self.b * mp.conj(w)
        # |v|^2 differentiated: v' = i (a w - b conj w).
        rate = 2 * mp.re(mp.conj(v) * mp.mpc(0, 1) * (self.a * w - self.b * mp.conj(w)))
        return -self.complement * rate / abs(v) ** 4

    def jerk_ratio(self, at: ExactTurn) -> MpNumber:
        w = mp.mpc(at.cosine, at.sine)
        v, rate = self.a * w + self.b * mp.conj(w), 1j * (self.a * w - self.b * mp.conj(w))
        # |v|^2 differentiated once and, as v'' = -v, twice.
        slope = 2 * mp.re(mp.conj(v) * rate) / abs(v) ** 2
        curvature = 2 * (abs(rate) ** 2 / abs(v) ** 2 - 1)
        return self.speed_ratio(at) * (2 * slope**2 - curvature)

    def jerk_term(self, at: ExactTurn) -> MpNumber:
        """Return the larger of the two terms whose difference the jerk ratio is.

        They are those of the equivalent joint, whose driving angle the product of ``a w`` and the
        conjugate of ``b conj(w)`` doubles.
        """
        w = mp.mpc(at.cosine, at.sine)
        product, k = -self.a * mp.conj(self.b) * w**2, self.k
        turned = mp.re(product) / abs(product) if product else mp.mpf(1)
        sine, cosine = mp.sqrt((1 - turned) / 2), mp.sqrt((1 + turned) / 2)
        bend = 2 * mp.atan(mp.sqrt(k))
        least = self.complement / abs(self.a) ** 2 / (1 + k) ** 2
        joint = ExactJoint(bend, 2 * mp.sqrt(k) / (1 + k), least, 2 * k / (1 + k))
        return joint.jerk_term(ExactTurn(mp.nan, sine, cosine))


LIMIT_TABLE: dict[str, Any] = tomllib.loads((DATA / "limits.toml").read_text(encoding="utf-8"))
"""The one table of the limits of errors; the file explains its columns."""

OUTPUT_LIMITS: dict[str, dict[str, Any]] = LIMIT_TABLE["output"]


def limits(column: str, table: str = "output") -> dict[str, Any]:
    """Return a column of limits, of those rows that have one."""
    return {name: row[column] for name, row in LIMIT_TABLE[table].items() if column in row}

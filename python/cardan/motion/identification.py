"""Joints found in measured angles or speeds: the equivalent bend that a recording shows."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cardan.arrays import FloatArray, as_float64
from cardan.arrays.errors import ArgumentValueError, check_shape

_ORDERS = 8
_STEPS = 20
_FEWEST_PER_TURN = 2 * _ORDERS + 2
# Standard deviations of k at which a bend counts as detected.
_DETECTED = 3.0


@dataclass(frozen=True, eq=False)
class Identification:
    """The joint that a recording shows, with its uncertainty.

    The standard deviations follow from what the fit leaves and take it for independent noise of
    each sample. A bend cannot be told from an ovality of an encoder, which has order 2 as well; a
    second recording with straight joints tells them apart. Orders 1 and 3 do not come from joints
    but from eccentric encoders or yokes that are not square.

    Source: the angle error is ``arg(1 + q exp(-2 i a))`` with the drive angle ``a`` (from Thoma 4).

    Attributes:
        q: complex number of the motion, as ``Transmission.q``.
        std_q: standard deviation of its real and of its imaginary part.
        std: standard deviation of ``bend`` in rad.
        purity: ``|order 4| / |order 2|**2`` of the speed ratio, twice that of the angle error. It
            is 1 for a chain of joints and nothing else.
        std_purity: standard deviation of ``purity``. Above a third, the noise hides order 4.
        orders: complex amplitudes of the angle error in rad or of the speed ratio at orders 0 to 8
            of the drive's rotation; the real part of ``amplitude * exp(-i order a)`` is its part.
            Order 0 is the mean.
        residual: root mean square of what remains of the recording, in the same unit.
        samples: number of samples used.
        turns: turns of the drive between the smallest and the largest drive angle.
    """

    q: complex
    std_q: float
    std: float
    purity: float
    std_purity: float
    orders: NDArray[np.complex128] = field(repr=False)
    residual: float
    samples: int
    turns: float

    @property
    def k(self) -> float:
        """``tan(bend/2)**2``, the sine of the largest angle error."""
        return abs(self.q)

    @property
    def bend(self) -> float:
        """Equivalent bend in rad."""
        return 2.0 * math.atan(math.sqrt(self.k))

    @property
    def bend_deg(self) -> float:
        """``bend`` in degrees."""
        return math.degrees(self.bend)

    @property
    def std_deg(self) -> float:
        """``std`` in degrees."""
        return math.degrees(self.std)

    @property
    def angle_offset(self) -> float:
        """What to add to the drive angle to get the joint's input angle, in (-pi/2, pi/2] rad."""
        return _wrapped(-0.5 * float(np.angle(-self.q))) if self.q else 0.0

    @property
    def angle_offset_deg(self) -> float:
        """``angle_offset`` in degrees."""
        return math.degrees(self.angle_offset)

    @property
    def detection_limit(self) -> float:
        """Smallest bend in rad that the noise permits to be told from none, at 3 sigma of ``k``."""
        return 2.0 * math.atan(math.sqrt(min(1.0, _DETECTED * self.std_q)))

    @property
    def detected(self) -> bool:
        """Whether the bend is larger than its detection limit."""
        return self.bend > self.detection_limit


@dataclass(frozen=True, eq=False)
class TwoJoints:
    """Both joints of a shaft with encoders at its three parts.

    Attributes:
        first: the joint between the drive and the intermediate shaft.
        whole: the joint equivalent to both.
        bends: bends of both joints in rad, ``(2,)``.
        std: their standard deviations in rad, ``(2,)``.
        phase_less_twist: phase of the intermediate shaft less its twist in rad, within
            (-pi/2, pi/2]. The twist follows from the drawing; a yoke looks the same after pi.
    """

    first: Identification
    whole: Identification
    bends: FloatArray
    std: FloatArray
    phase_less_twist: float

    @property
    def bends_deg(self) -> FloatArray:
        """``bends`` in degrees."""
        return np.degrees(self.bends)

    @property
    def phase_less_twist_deg(self) -> float:
        """``phase_less_twist`` in degrees."""
        return math.degrees(self.phase_less_twist)


def identify(
    drive_angle: ArrayLike,
    *,
    angle: ArrayLike | None = None,
    speed_ratio: ArrayLike | None = None,
    degrees: bool = False,
) -> Identification:
    """Find the equivalent joint of a driveline in a recording of its motion.

    The samples may lie anywhere: at unequal steps, over any part of a turn above the first, with
    gaps. Samples that are not finite are left out. A constant offset between the encoders and a
    linear drift of one against the other are fitted and do not matter.

    Args:
        drive_angle: angles of the drive, ``(samples,)``, modulo a turn or not.
        angle: angles of the driven shaft, ``(samples,)``, modulo a turn or not. They count in the
            same sense as the drive's.
        speed_ratio: or: speed of the driven shaft over that of the drive, ``(samples,)``.
        degrees: whether the angles are in degrees.

    Raises:
        TypeError: values that are not real numbers.
        ValueError: neither or both of ``angle`` and ``speed_ratio``, arrays of other shapes, less
            than a turn, too few samples, a driven shaft that turns against the drive.
    """
    drive = _column("drive_angle", drive_angle)
    given = {"angle": angle, "speed_ratio": speed_ratio}
    columns = [(name, _column(name, x)) for name, x in given.items() if x is not None]
    if len(columns) != 1:
        raise ArgumentValueError("angle", "or speed_ratio must be given, and not both")
    ((name, measured),) = columns
    if measured.shape != drive.shape:
        problem = f"has {measured.size} samples and drive_angle {drive.size}; they must be as many"
        raise ArgumentValueError(name, problem)
    known = np.isfinite(drive) & np.isfinite(measured)
    drive, measured = drive[known], measured[known]
    if degrees:
        drive, measured = np.radians(drive), np.radians(measured) if angle is not None else measured
    drive = _continuous(drive)
    turns = float(np.ptp(drive)) / math.tau if drive.size else 0.0
    if drive.size < _FEWEST_PER_TURN or turns < 1.0 - 1.5 / max(1, drive.size):
        rule = f"it takes at least one turn and {_FEWEST_PER_TURN} samples"
        problem = f"has {drive.size} finite samples over {turns:.2f} turns; {rule}"
        raise ArgumentValueError("drive_angle", problem)
    if angle is not None:
        # Whole turns aside, without steps.
        measured = np.unwrap(np.remainder(measured - drive, math.tau))
    return _fitted(drive, measured, angle is not None, turns)


def identify_two_joints(
    drive_angle: ArrayLike, intermediate: ArrayLike, driven: ArrayLike, *, degrees: bool = False
) -> TwoJoints:
    """Find both bends and the phase of a shaft with two joints from encoders at its three parts.

    Args:
        drive_angle: angles of the drive, ``(samples,)``, as of ``identify``.
        intermediate: angles of the shaft between the joints, ``(samples,)``.
        driven: angles of the last shaft, ``(samples,)``.
        degrees: whether the angles are in degrees; errors are as of ``identify``.
    """
    first = identify(drive_angle, angle=intermediate, degrees=degrees)
    whole = identify(drive_angle, angle=driven, degrees=degrees)
    # The second joint takes the intermediate shaft's motion out: z = -k exp(-2 i p) by the maps
    # w -> w - k conj(w) of both joints, with p = phase - twist + pi/2.
    inverse = 1.0 / (1.0 - whole.q * first.q.conjugate())
    z = (whole.q - first.q) * inverse
    by_whole = inverse * (1.0 + z * first.q.conjugate())
    std_k = math.hypot(abs(by_whole) * whole.std_q, abs(inverse) * first.std_q)
    second = float(abs(z))
    bends = np.array([first.bend, 2.0 * math.atan(math.sqrt(second))])
    phase = _wrapped(-0.5 * float(np.angle(z / first.q)) - math.pi / 2) if first.q else math.nan
    return TwoJoints(first, whole, bends, np.array([first.std, _std(second, std_k)]), phase)


def _column(name: str, values: ArrayLike) -> FloatArray:
    column = as_float64(name, values)
    check_shape(name, column, column.ndim == 1, "it must be (samples,)")
    return column


def _continuous(drive: FloatArray) -> FloatArray:
    """The drive angle without the steps of a counter that starts anew at each turn."""
    modulo = drive.size > 0 and np.ptp(drive) <= math.tau and np.any(np.abs(np.diff(drive)) > np.pi)
    return np.unwrap(drive) if modulo else drive


def _fitted(drive: FloatArray, values: FloatArray, of_angle: bool, turns: float) -> Identification:
    offset, drift = np.ones_like(drive), (drive - drive.mean()) / math.tau
    waves = np.exp(1j * np.multiply.outer(drive, np.arange(1, _ORDERS + 1)))
    columns = np.column_stack([offset, drift, waves.real, waves.imag])
    series, *_ = np.linalg.lstsq(columns, values, rcond=None)
    if of_angle and abs(series[1]) > 0.5 * math.tau:
        times, rule = 1.0 + series[1] / math.tau, "it must count in the drive's sense and unit"
        raise ArgumentValueError("angle", f"turns {times:.3g} times as fast as the drive; {rule}")
    q = 1j * complex(series[3], series[3 + _ORDERS]) if of_angle else _start(drive, values)
    # A step too far would leave the disc of the joints.
    q *= min(1.0, 0.99 / max(abs(q), 1e-300))
    turned = np.exp(-2j * drive)
    beside = np.column_stack([offset, drift, waves[:, [0, 2]].real, waves[:, [0, 2]].imag])

    def fit() -> tuple[FloatArray, FloatArray, FloatArray]:
        """What the motion of ``q`` leaves, the linear equations for it, and their solution."""
        model, slope = _model(q, turned, of_angle)
        matrix = np.column_stack([slope.real, -slope.imag, beside])
        return values - model, matrix, np.linalg.lstsq(matrix, values - model, rcond=None)[0]

    for _ in range(_STEPS):
        _, _, step = fit()
        change = complex(step[0], step[1])
        while abs(q + change) >= 1.0:
            change *= 0.5
        q += change
        if abs(change) <= 1e-13:
            break
    rest, matrix, step = fit()
    left = rest - matrix @ step
    freedom = max(1, left.size - matrix.shape[1])
    variance = float(left @ left) / freedom
    covariance = variance * np.linalg.pinv(matrix.T @ matrix)[:2, :2]
    std_q = math.sqrt(max(0.0, float(np.trace(covariance)) / 2.0))
    # Beside the exact series the cut of the fitted one hardly matters.
    series, *_ = np.linalg.lstsq(columns, rest, rcond=None)
    orders = _series(complex(q), of_angle)
    orders[0] += series[0]
    orders[1:] += series[2 : 2 + _ORDERS] + 1j * series[2 + _ORDERS :]
    fourth = abs(orders[4]) * (2.0 if of_angle else 1.0)
    twice = abs(orders[2]) ** 2 * (1.0 if of_angle else 0.5)
    k, purity = abs(q), float(fourth / twice) if twice else math.nan
    # The noise of both orders, which have the size of k**2 and k, to first order.
    of_fourth = std_q / k**2 * (2.0 if of_angle else 1.0) if k else math.inf
    std_purity = math.hypot(of_fourth, 2.0 * purity * std_q / k) if k else math.inf
    return Identification(
        q=complex(q),
        std_q=std_q,
        std=_std(float(abs(q)), std_q),
        purity=purity,
        std_purity=std_purity,
        orders=orders,
        residual=math.sqrt(float(left @ left) / left.size),
        samples=left.size,
        turns=turns,
    )


def _start(drive: FloatArray, ratio: FloatArray) -> complex:
    """A ``q`` for a recorded speed ratio ``r``: its reciprocal is a single wave, however steep.

    ``1/r`` is ``1 + k**2 + 2 Re q exp(-2 i a)`` over ``1 - k**2``. The weights ``r**2`` let it
    scatter as the recording does.
    """
    wave = np.column_stack([np.ones_like(drive), np.cos(2.0 * drive), np.sin(2.0 * drive)])
    (mean, *parts), *_ = np.linalg.lstsq(wave * ratio[:, np.newaxis] ** 2, ratio, rcond=None)
    if not mean > 0.0:
        return 0.0j
    size = complex(*parts) / float(mean)
    return size / (1.0 + math.sqrt(max(0.0, 1.0 - abs(size) ** 2)))


def _model(
    q: complex, turned: NDArray[np.complex128], of_angle: bool
) -> tuple[FloatArray, NDArray[np.complex128]]:
    """The exact motion, and ``s`` with the change ``(s * dq).real`` that a ``dq`` makes."""
    w = 1.0 + q * turned
    if of_angle:
        return np.angle(w), -1j * turned / w
    return ((2.0 - w) / w).real, -2.0 * turned / w**2


def _series(q: complex, of_angle: bool) -> NDArray[np.complex128]:
    """Orders of the exact motion: ``log(1 + q u)`` and ``(1 - q u)/(1 + q u)`` by powers of u."""
    n = np.arange(1, _ORDERS // 2 + 1)
    powers = (-q) ** n
    orders = np.zeros(_ORDERS + 1, np.complex128)
    orders[0] = 0.0 if of_angle else 1.0
    orders[2::2] = 1j * powers / n if of_angle else 2.0 * powers
    return orders


def _std(k: float, std_k: float) -> float:
    """Standard deviation of the bend from that of ``k``: ``std_k/(sqrt(k) (1 + k))``."""
    return std_k / (math.sqrt(k) * (1.0 + k)) if k else math.inf


def _wrapped(angle: float) -> float:
    """The angle modulo pi within (-pi/2, pi/2]."""
    return angle - math.pi * math.ceil(angle / math.pi - 0.5)

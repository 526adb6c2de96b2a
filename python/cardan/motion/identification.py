"""Joints found in measured angles or speeds: the equivalent bend that a recording shows."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cardan.arrays import FloatArray, as_float64
from cardan.arrays.errors import ArgumentValueError, check_shape, require
from cardan.motion import uncertainty
from cardan.motion.uncertainty import Z_95

_ORDERS = 8
_STEPS = 20
_FEWEST_SAMPLES = 2 * _ORDERS + 2
# Standard deviations of k at which a bend counts as detected.
_DETECTED = 3.0

# Samples must lie at so many angles of a turn, each so far from the others: beside the orders up to
# 3 and the mean they then show what else repeats in every turn.
_FEWEST_ANGLES = 12
_APART = math.radians(5.0)
# How much less certain than even samples the samples may make order 2.
_LEAST_EVEN = 10.0

# How far the mean speed ratio may be from 1: a slow drift, and no miscounted pulse of 200.
_DRIFT = 0.005

# Parts of a recording whose bends are compared, and the turns that each has at least. Noise alone
# lets them differ by this quantile of a normal distribution once in 1000 recordings.
_PARTS = 6
_TURNS_OF_PART = 4
_CHANGES = 3.3


@dataclass(frozen=True)
class Part:
    """Some turns of a recording.

    Attributes:
        speed: mean speed of the drive in them, in the unit given; NaN if none was given.
        turn: mean turn of the drive, from its smallest angle on.
        bend: their equivalent bend in rad.
        std: its standard deviation in rad.
        angle_offset: what to add to the drive angle in them, in (-pi/2, pi/2] rad.
    """

    speed: float
    turn: float
    bend: float
    std: float
    angle_offset: float


@dataclass(frozen=True, eq=False)
class Identification:
    """The joint that a recording shows, with its uncertainty.

    The standard deviations follow from what the fit leaves beside order 2 and at the whole orders
    above it, so neighbouring samples may have related errors: resonant noise, slow drift, steps of
    a counter. A recording of less than two turns cannot show such relations; its noise is taken for
    independent.

    A bend cannot be told from an ovality of an encoder, which has order 2 as well; a second
    recording with straight joints tells them apart. Torsional vibration changes order 2 too; well
    below the lowest natural frequency it does not. Orders 1 and 3 do not come from joints but from
    eccentric encoders or yokes that are not square.

    Source: the angle error is ``arg(1 + q exp(-2 i a))`` with the drive angle ``a`` (from Thoma 4).

    Attributes:
        q: complex number of the motion, as ``Transmission.q``.
        std_q: standard deviation of its real and of its imaginary part.
        std: standard deviation of ``bend`` in rad.
        freedom: degrees of freedom from which the standard deviations follow.
        interval: the least and the largest bend in rad of the 95 % interval. Near 0 it is not
            symmetric, since noise enlarges the bend that is found.
        purity: ``|order 4| / |order 2|**2`` of the speed ratio, twice that of the angle error. It
            is 1 for a chain of joints and nothing else.
        std_purity: standard deviation of ``purity``. Above a third, the noise hides order 4.
        orders: complex amplitudes of the angle error in rad or of the speed ratio at orders 0 to 8
            of the drive's rotation; the real part of ``amplitude * exp(-i order a)`` is its part.
            Order 0 is the mean.
        residual: root mean square of what remains of the recording, in the same unit.
        samples: number of samples used.
        turns: turns of the drive between the smallest and the largest drive angle.
        mean_ratio: mean speed of the driven shaft over that of the drive: 1 but for a drift.
        parts: 2 to 6 parts of a recording of at least 8 turns, in the order of the drive's speed,
            or of the turns if no speed was given.
        changes: whether ``q`` differs among the parts by more than the noise, in size or in phase.
            The standard deviations and the interval do not cover the cause: torsional vibration, or
            a drive angle that drifts.
    """

    q: complex
    std_q: float
    std: float
    freedom: float
    interval: tuple[float, float]
    purity: float
    std_purity: float
    orders: NDArray[np.complex128] = field(repr=False)
    residual: float
    samples: int
    turns: float
    mean_ratio: float
    parts: tuple[Part, ...] = field(repr=False)
    changes: bool

    @property
    def k(self) -> float:
        """``tan(bend/2)**2``, the sine of the largest angle error."""
        return abs(self.q)

    @property
    def bend(self) -> float:
        """Equivalent bend in rad."""
        return _bend(self.k)

    @property
    def bend_deg(self) -> float:
        """``bend`` in degrees."""
        return math.degrees(self.bend)

    @property
    def std_deg(self) -> float:
        """``std`` in degrees."""
        return math.degrees(self.std)

    @property
    def interval_deg(self) -> tuple[float, float]:
        """``interval`` in degrees."""
        return math.degrees(self.interval[0]), math.degrees(self.interval[1])

    @property
    def angle_offset(self) -> float:
        """What to add to the drive angle to get the joint's input angle, in (-pi/2, pi/2] rad."""
        return _angle_offset(self.q)

    @property
    def angle_offset_deg(self) -> float:
        """``angle_offset`` in degrees."""
        return math.degrees(self.angle_offset)

    @property
    def detection_limit(self) -> float:
        """Smallest bend in rad that the noise permits to be told from none, at 3 sigma of ``k``.

        Of few degrees of freedom it is larger, as Student's t is.
        """
        return _bend(_DETECTED * self.std_q * uncertainty.times_of(self.freedom) / Z_95)

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
        intervals: the least and the largest bend of their 95 % intervals in rad, ``(2, 2)``.
        phase_less_twist: phase of the intermediate shaft less its twist in rad, within
            (-pi/2, pi/2], positive in the sense in which the angles increase. The twist follows
            from the drawing; a yoke looks the same after pi.
    """

    first: Identification
    whole: Identification
    bends: FloatArray
    std: FloatArray
    intervals: FloatArray
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
    drive_speed: ArrayLike | None = None,
    degrees: bool = False,
) -> Identification:
    """Find the equivalent joint of a driveline in a recording of its motion.

    The samples may lie at unequal steps, over any part of a turn above the first, with gaps, as
    long as they are spread over the turn: at 12 or more angles of it. Samples that are not finite
    are left out. A constant offset between the encoders and a slow drift of one against the other
    are fitted and do not matter.

    Args:
        drive_angle: angles of the drive, ``(samples,)``, modulo a turn or not.
        angle: angles of the driven shaft, ``(samples,)``, modulo a turn or not. They count in the
            same sense as the drive's.
        speed_ratio: or: speed of the driven shaft over that of the drive, ``(samples,)``.
        drive_speed: speed of the drive in any unit, ``(samples,)``, for the bend over the speed.
        degrees: whether the angles are in degrees.

    Raises:
        TypeError: values that are not real numbers.
        ValueError: neither or both of ``angle`` and ``speed_ratio``, arrays of other shapes, less
            than a turn, too few samples, samples that do not determine the bend, a driven shaft
            that turns backwards, stands or does not keep the mean speed of the drive to 0.5 %.
    """
    if (angle is None) == (speed_ratio is None):
        raise ArgumentValueError("angle", "or speed_ratio must be given, and not both")
    given = {
        "drive_angle": drive_angle,
        "angle": angle,
        "speed_ratio": speed_ratio,
        "drive_speed": drive_speed,
    }
    columns = {name: _column(name, x) for name, x in given.items() if x is not None}
    count = columns["drive_angle"].size
    for of, column in columns.items():
        problem = f"has {column.size} samples and drive_angle {count}; they must be as many"
        require(of, column.size == count, problem)
    known = np.all([np.isfinite(column) for column in columns.values()], axis=0)
    drive, measured, *speeds = (column[known] for column in columns.values())
    if degrees:
        drive, measured = np.radians(drive), np.radians(measured) if angle is not None else measured
    drive = _continuous(drive)
    turns = float(np.ptp(drive)) / math.tau if drive.size else 0.0
    if drive.size < _FEWEST_SAMPLES or turns < 1.0 - 1.5 / max(1, drive.size):
        rule = f"it takes at least one turn and {_FEWEST_SAMPLES} samples"
        problem = f"has {drive.size} finite samples over {turns:.2f} turns; {rule}"
        raise ArgumentValueError("drive_angle", problem)
    _check_spread(drive)
    counter = 0.0
    if angle is not None:
        counter = uncertainty.step_of(measured)
        # Whole turns aside, without steps.
        measured = np.unwrap(np.remainder(measured - drive, math.tau))
    return _fitted(
        drive, measured, angle is not None, turns, counter, speeds[0] if speeds else None
    )


def identify_two_joints(
    drive_angle: ArrayLike,
    intermediate: ArrayLike,
    driven: ArrayLike,
    *,
    drive_speed: ArrayLike | None = None,
    degrees: bool = False,
) -> TwoJoints:
    """Find both bends and the phase of a shaft with two joints from encoders at its three parts.

    Args:
        drive_angle: angles of the drive, ``(samples,)``, as of ``identify``.
        intermediate: angles of the shaft between the joints, ``(samples,)``.
        driven: angles of the last shaft, ``(samples,)``.
        drive_speed: speed of the drive in any unit, ``(samples,)``, as of ``identify``.
        degrees: whether the angles are in degrees; errors are as of ``identify``.
    """
    first = identify(drive_angle, angle=intermediate, drive_speed=drive_speed, degrees=degrees)
    whole = identify(drive_angle, angle=driven, drive_speed=drive_speed, degrees=degrees)
    return two_joints(first, whole)


def two_joints(first: Identification, whole: Identification) -> TwoJoints:
    """Return both joints from the first and the one that is equivalent to both."""
    # The second joint takes the intermediate shaft's motion out: z = -k exp(-2 i p) by the maps
    # w -> w - k conj(w) of both joints, with p = phase - twist + pi/2.
    inverse = 1.0 / (1.0 - whole.q * first.q.conjugate())
    z = (whole.q - first.q) * inverse
    by_whole = inverse * (1.0 + z * first.q.conjugate())
    std_k = math.hypot(abs(by_whole) * whole.std_q, abs(inverse) * first.std_q)
    second = float(abs(z))
    phase = _wrapped(-0.5 * float(np.angle(z / first.q)) - math.pi / 2) if first.q else math.nan
    interval = _interval(second, std_k, min(first.freedom, whole.freedom))
    return TwoJoints(
        first,
        whole,
        np.array([first.bend, _bend(second)]),
        np.array([first.std, _std(second, std_k)]),
        np.array([first.interval, interval]),
        phase,
    )


def _column(name: str, values: ArrayLike) -> FloatArray:
    column = as_float64(name, values)
    check_shape(name, column, column.ndim == 1, "it must be (samples,)")
    return column


def _continuous(drive: FloatArray) -> FloatArray:
    """The drive angle without the steps of a counter that starts anew at each turn."""
    modulo = drive.size > 0 and np.ptp(drive) <= math.tau and np.any(np.abs(np.diff(drive)) > np.pi)
    return np.unwrap(drive) if modulo else drive


def _check_spread(drive: FloatArray) -> None:
    """Refuse angles that cannot separate order 2 from the mean and the neighbouring orders."""
    places = np.sort(np.remainder(drive - drive[0], math.tau))
    count, place = 0, 0
    # The last of them lie beside the first.
    while place < np.searchsorted(places, math.tau - _APART):
        count += 1
        place = int(np.searchsorted(places, places[place] + _APART))
    if count < _FEWEST_ANGLES:
        raise ArgumentValueError(
            "drive_angle",
            f"has samples at only {count} angles of a turn; a bend shows in samples at "
            f"{_FEWEST_ANGLES} or more, spread over the turn, such as 36 equal steps per turn",
        )
    waves = np.exp(1j * np.multiply.outer(drive, (2, 1, 3)))
    drift = (drive - drive.mean()) / float(np.ptp(drive))
    columns = np.column_stack([waves.real, waves.imag, np.ones_like(drive), drift])
    normal = columns.T @ columns / drive.size
    two, others = [0, 3], [1, 2, 4, 5, 6, 7]
    apart = (
        normal[np.ix_(two, two)]
        - normal[np.ix_(two, others)]
        @ np.linalg.pinv(normal[np.ix_(others, others)], hermitian=True)
        @ normal[np.ix_(others, two)]
    )
    if float(np.linalg.eigvalsh(apart)[0]) < 0.5 / _LEAST_EVEN**2:
        gap = math.degrees(np.max(np.diff(places, append=places[0] + math.tau)))
        raise ArgumentValueError(
            "drive_angle",
            f"has no samples in {gap:.0f}° of the turn; so the others cannot tell a bend, whose "
            "order is 2, from the orders 1 and 3; it takes samples all around the turn",
        )


def _mean_ratio_problem(times: float) -> str:
    """Say that a driven shaft does not keep the mean speed, and what looks to be the case."""
    pulses = round(1.0 / abs(times - 1.0))
    if 0.9 < times * 180.0 / math.pi < 1.1 or 0.9 < times * math.pi / 180.0 < 1.1:
        case = "one seems to be in degrees and the other one in radians"
    elif abs(times) < 0.02:
        case = "it seems to stand still, or to be another signal"
    elif times < 0.0:
        case = "it seems to count backwards; change the sign of one of the columns"
    elif abs(times - 1.0) < 0.1:
        right = pulses + 1 if times > 1.0 else pulses - 1
        case = f"an encoder of {right} pulses per turn seems to be taken for one of {pulses}"
    else:
        case = "divide it by the ratio of the gear between them, or correct its pulses per turn"
    return (
        f"belongs to a shaft that turns {round(times, 4) + 0.0:.4g} times as fast as the drive, "
        f"and joints keep the mean speed: {case}"
    )


def _fitted(
    drive: FloatArray,
    values: FloatArray,
    of_angle: bool,
    turns: float,
    counter: float,
    speed: FloatArray | None,
) -> Identification:
    # A drift of 1 is a radian over the whole recording.
    offset, drift = np.ones_like(drive), (drive - drive.mean()) / (turns * math.tau)
    name = "angle" if of_angle else "speed_ratio"
    waves = np.exp(1j * np.multiply.outer(drive, np.arange(1, _ORDERS + 1)))
    columns = np.column_stack([offset, drift, waves.real, waves.imag])
    series, *_ = np.linalg.lstsq(columns, values, rcond=None)
    # Steep joints are far from their first orders, but not that far.
    if of_angle and abs(slip := series[1] / (turns * math.tau)) > 0.5:
        raise ArgumentValueError(name, _mean_ratio_problem(1.0 + slip))
    q = 1j * complex(series[3], series[3 + _ORDERS]) if of_angle else _start(drive, values)
    # A step too far would leave the disc of the joints.
    q *= min(1.0, 0.99 / max(abs(q), 1e-300))
    turned = np.exp(-2j * drive)
    beside = np.column_stack([offset, drift, waves[:, [0, 2]].real, waves[:, [0, 2]].imag])

    def fit() -> tuple[FloatArray, FloatArray, FloatArray]:
        """Return the residual of ``q``, the linear equations for it, and their solution."""
        model, slope = _model(q, turned, of_angle)
        matrix = np.column_stack([slope.real, -slope.imag, beside])
        rest = values - model
        return rest, matrix, np.linalg.solve(matrix.T @ matrix, matrix.T @ rest)

    for _ in range(_STEPS):
        _, _, step = fit()
        change = complex(step[0], step[1])
        while abs(q + change) >= 1.0:
            change *= 0.5
        q += change
        if abs(change) <= 1e-13:
            break
    rest, matrix, remaining = fit()
    left = rest - matrix @ remaining
    noise, inverse = uncertainty.spectral_noise(drive, left, matrix, turns)
    # Angles have a slope that is the drift; speed ratios have it in their mean.
    place, scale = (3, turns * math.tau) if of_angle else (2, 1.0)
    drifts = float(remaining[place]) / scale
    unsure = math.sqrt(noise.variance * inverse[place, place]) / scale
    if abs(drifts) > _DRIFT + 4.0 * unsure:
        raise ArgumentValueError(name, _mean_ratio_problem(1.0 + drifts))
    variance = noise.variance
    if counter:
        by_steps = uncertainty.of_steps(drive, drive + values - left, left, counter) / Z_95
        variance = max(variance, 2.0 * by_steps**2 / float(np.trace(inverse[:2, :2])))
    covariance = variance * inverse[:2, :2]
    # A wrong scale of an encoder would change q as much as the mean.
    parts_q = np.array([q.real, q.imag])
    covariance += drifts**2 * np.outer(parts_q, parts_q)
    std_q = math.sqrt(max(0.0, float(np.trace(covariance)) / 2.0))
    along = parts_q / abs(q) if q else np.array([1.0, 0.0])
    std_k = math.sqrt(max(0.0, float(along @ covariance @ along)))
    parts, changes = _compared(q, drive, left, matrix, turns, speed)
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
        std=_std(float(abs(q)), std_k),
        freedom=noise.freedom,
        interval=_interval(float(abs(q)), std_k, noise.freedom),
        purity=purity,
        std_purity=std_purity,
        orders=orders,
        residual=math.sqrt(float(left @ left) / left.size),
        samples=left.size,
        turns=turns,
        mean_ratio=1.0 + drifts,
        parts=parts,
        changes=changes,
    )


def _compared(
    q: complex,
    drive: FloatArray,
    rest: FloatArray,
    matrix: FloatArray,
    turns: float,
    speed: FloatArray | None,
) -> tuple[tuple[Part, ...], bool]:
    """Compare the bends of some parts of a recording, by what the fit of the whole leaves in each.

    Whole turns belong together, in which a speed may vary with the drive angle. The noise is that
    at orders farther from order 2 than those that a change from part to part makes.
    """
    count = min(_PARTS, int(turns / _TURNS_OF_PART))
    if count < 2:
        return (), False
    turn = np.floor((drive - drive.min()) / math.tau).astype(np.intp)
    samples = np.maximum(np.bincount(turn), 1)
    order = np.arange(samples.size)
    if speed is not None:
        speeds = np.bincount(turn, speed) / samples
        order = np.argsort(speeds, kind="stable")
    far = uncertainty.beside_order_2(turns, range(count + 1, 3 * count + 7))
    variance = uncertainty.noise_at(drive, rest, matrix, far).variance
    found, changes, weights = [], [], []
    for turns_of_part in np.array_split(order, count):
        chosen = np.isin(turn, turns_of_part)
        columns = matrix[chosen]
        normal = columns.T @ columns
        # A part with too few samples has no bend.
        if np.linalg.matrix_rank(normal, hermitian=True) < normal.shape[0]:
            continue
        inverse = np.linalg.inv(normal)
        change = (inverse @ (columns.T @ rest[chosen]))[:2]
        covariance = variance * inverse[:2, :2]
        own = q + complex(*change)
        k = min(abs(own), 1.0)
        mean_speed = math.nan if speed is None else float(np.mean(speed[chosen]))
        std = _std(k, math.sqrt(float(np.trace(covariance)) / 2.0))
        mean_turn = float(np.mean(turn[chosen]))
        found.append(Part(mean_speed, mean_turn, _bend(k), std, _angle_offset(own)))
        changes.append(change)
        weights.append(np.linalg.pinv(covariance, hermitian=True))
    if len(found) < 2:
        return (), False
    mean = np.linalg.pinv(sum(weights)) @ sum(w @ d for w, d in zip(weights, changes, strict=True))
    apart = sum(float((d - mean) @ w @ (d - mean)) for w, d in zip(weights, changes, strict=True))
    freedom = 2.0 * (len(found) - 1)
    # The distribution of squares after Wilson and Hilferty.
    least = (1.0 - 2.0 / (9.0 * freedom) + _CHANGES * math.sqrt(2.0 / (9.0 * freedom))) ** 3
    return tuple(found), apart > least * freedom


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


def _bend(k: float) -> float:
    return 2.0 * math.atan(math.sqrt(min(1.0, k)))


def _interval(k: float, std_k: float, freedom: float) -> tuple[float, float]:
    low, high = uncertainty.size_interval(k, std_k, freedom)
    return _bend(low), _bend(high)


def _std(k: float, std_k: float) -> float:
    """Standard deviation of the bend from that of ``k``: ``std_k/(sqrt(k) (1 + k))``."""
    return std_k / (math.sqrt(k) * (1.0 + k)) if k else math.inf


def _angle_offset(q: complex) -> float:
    """What to add to the drive angle to get the joint's input angle, in rad."""
    return _wrapped(-0.5 * float(np.angle(-q))) if q else 0.0


def _wrapped(angle: float) -> float:
    """The angle modulo pi within (-pi/2, pi/2]."""
    return angle - math.pi * math.ceil(angle / math.pi - 0.5)

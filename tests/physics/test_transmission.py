"""How one shaft follows the drive, against 50 digits: ``q``, the motion, and its derivatives."""

from __future__ import annotations

import math

import numpy as np
import pytest

from cardan import Driveline, Motion
from oracle import EPS, ExactTurn, Fold, MpNumber, mp
from refusals import refusals

CHAINS: list[tuple[list[float], list[float], list[float]]] = [
    ([0.5], [], []),
    ([1e-5], [], []),
    ([1.5], [], []),
    ([0.3, 0.2], [0.4], [-1.1]),
    ([0.17, 0.0, 0.4, 0.3], [0.3, 2.0, -0.7], [1.0, 0.2, 0.9]),
    ([1.3, 0.9], [-0.5], [0.8]),
    # Nearly at constant velocity.
    ([0.3, 0.3], [0.4], [0.4 + 1e-6]),
]
ANGLES = [-7.3, -1.0, -1e-9, 0.0, 0.3, 0.7853, 1.5707, 2.2, 3.0, 100.0]
BATCH = Driveline.from_bends([[0.3, 0.2], [0.1, 0.9], [0.0, 0.0]], 0.4, -1.1)


def exact_q(chain: tuple[list[float], list[float], list[float]]) -> MpNumber:
    """Return ``B/A`` of the chain's map, times what takes its angle off: a joint has ``-k``."""
    fold = Fold.of(*chain)
    return fold.b / fold.a


def motion_of(q: MpNumber, angle: MpNumber) -> tuple[MpNumber, ...]:
    """Return the motion by differentiating ``arg(1 + q u)`` as often as needed, with 50 digits."""

    def error(x: MpNumber) -> MpNumber:
        return mp.im(mp.log(1 + q * mp.expj(-2 * x)))

    return (error(angle), 1 + mp.diff(error, angle), *(mp.diff(error, angle, n) for n in (2, 3)))


@pytest.mark.parametrize("chain", CHAINS, ids=str)
def test_q_is_that_of_the_chain(chain: tuple[list[float], list[float], list[float]]) -> None:
    line = Driveline.from_bends(*chain)
    want = exact_q(chain)
    got = line.transmission().q
    assert np.shape(got) == ()
    # A sum of joints is known to the roundings of its parts.
    total = sum(math.tan(bend / 2) ** 2 for bend in chain[0])
    assert abs(got - complex(want)) <= 8 * EPS * (abs(complex(want)) + 1e-3 * total)
    assert abs(got) == pytest.approx(float(line.equivalent().k), rel=4 * EPS)
    assert line.transmission().abs2 == pytest.approx(abs(got) ** 2, rel=4 * EPS, abs=0.0)


@pytest.mark.parametrize("chain", CHAINS, ids=str)
def test_motion_is_that_of_q(chain: tuple[list[float], list[float], list[float]]) -> None:
    q = exact_q(chain)
    got = Driveline.from_bends(*chain).transmission().motion(ANGLES)
    stretch = float(1 / (1 - abs(q)))
    for i, angle in enumerate(ANGLES):
        for power, (name, want) in enumerate(
            zip(Motion._fields, motion_of(q, mp.mpf(angle)), strict=True)
        ):
            known = 8 * len(chain[0]) * EPS * float(abs(q)) * (2 * stretch) ** (power + 1)
            off = abs(float(getattr(got, name)[i] - want))
            assert off <= known + 4 * EPS * float(abs(want)), (name, angle)


@pytest.mark.parametrize("chain", CHAINS, ids=str)
def test_motion_is_that_of_evaluate(chain: tuple[list[float], list[float], list[float]]) -> None:
    line = Driveline.from_bends(*chain)
    angle = np.linspace(-7, 9, 301)
    for shaft in range(line.n_joints + 1):
        got = line.transmission(shaft).motion(angle)
        want = line.evaluate(angle, Motion._fields, shafts=shaft, tolerance=0)
        q = abs(line.transmission(shaft).q)
        for power, name in enumerate(Motion._fields):
            scale = q * (2 / (1 - q)) ** (power + 1)
            close = 16 * line.n_joints * EPS * scale + 4 * EPS * np.abs(want[name])
            assert np.all(np.abs(getattr(got, name) - want[name]) <= close), (name, shaft)


@pytest.mark.parametrize("chain", CHAINS, ids=str)
def test_gradients_are_differences_by_q(
    chain: tuple[list[float], list[float], list[float]],
) -> None:
    transmission = Driveline.from_bends(*chain).transmission()
    # The value of the double: the derivative is that of the motion there.
    q = mp.mpc(complex(transmission.q))
    got = transmission.gradient(ANGLES)
    step = mp.mpf(10) ** -20
    for i, angle in enumerate(ANGLES):
        u = ExactTurn.by(angle)
        u = mp.mpc(u.cosine, -u.sine) ** 2

        def motion(q: MpNumber, u: MpNumber = u) -> tuple[MpNumber, ...]:
            z = q * u
            g = 1 / (1 + z)
            third = mp.re(8 * z * (1 - z) * g**3)
            return mp.arg(1 + z), mp.re((1 - z) * g), mp.re(4j * z * g * g), third

        for direction in (1, mp.mpc(0, 1)):
            ahead, behind = motion(q + step * direction), motion(q - step * direction)
            slopes = [(a - b) / (2 * step) for a, b in zip(ahead, behind, strict=True)]
            for power, (name, slope) in enumerate(zip(Motion._fields, slopes, strict=True)):
                derivative = complex(getattr(got, name)[i])
                found = (derivative * complex(direction)).real
                # A rounding of q is stretched once more than the derivative itself.
                stretch = float(1 / abs(1 + q * u))
                scale = abs(derivative) * stretch + float(4 * stretch) ** power
                assert abs(found - float(slope)) <= 1e-12 * scale, (name, angle)


def test_the_motion_of_joints_as_known() -> None:
    bend = 0.5
    motion = Driveline.from_bends([bend]).transmission().motion(0.0)
    assert all(np.shape(x) == () for x in motion)
    assert motion.angle_error == 0.0
    assert motion.speed_ratio == pytest.approx(1 / math.cos(bend), rel=2 * EPS)
    assert motion.acceleration_ratio == 0.0
    third = -2 * math.sin(bend) ** 2 / math.cos(bend) ** 3
    assert motion.jerk_ratio == pytest.approx(third, rel=16 * EPS)
    assert Driveline.from_bends([bend]).transmission().q == pytest.approx(
        -(math.tan(bend / 2) ** 2), rel=4 * EPS
    )


def test_the_drive_and_straight_joints_turn_with_the_drive() -> None:
    for transmission in (
        Driveline.from_bends([0.5, 0.2]).transmission(0),
        Driveline.from_bends([0.0]).transmission(),
    ):
        assert transmission.q == 0
        error, ratio, acceleration, jerk = transmission.motion(ANGLES)
        assert not error.any()
        assert np.all(ratio == 1.0)
        assert not acceleration.any()
        assert not jerk.any()
        # A first small joint would turn it by Im(u dq).
        gradient = transmission.gradient(0.3).angle_error
        u = complex(math.cos(0.6), -math.sin(0.6))
        assert gradient == pytest.approx(-1j * u, rel=4 * EPS)


def test_batches_broadcast() -> None:
    transmission = BATCH.transmission()
    assert transmission.q.shape == (3,)
    angle = np.linspace(-2.0, 2.0, 5)[:, np.newaxis]
    motion, gradient = transmission.motion(angle), transmission.gradient(angle)
    for i in range(3):
        alone = BATCH[i].transmission()
        assert alone.q == transmission.q[i]
        for j in range(5):
            for name in Motion._fields:
                one = getattr(alone.motion(angle[j, 0]), name)
                assert getattr(motion, name)[j, i] == one, name
                one = getattr(alone.gradient(angle[j, 0]), name)
                assert getattr(gradient, name)[j, i] == one, name
    assert transmission.motion(0.3).jerk_ratio.shape == (3,)
    assert BATCH[0].transmission().motion(np.empty((2, 0))).angle_error.shape == (2, 0)
    assert transmission.gradient(0.3).jerk_ratio.dtype == np.complex128
    two = Driveline.from_bends(np.full((2, 3, 1), 0.3)).transmission()
    assert two.motion(np.zeros(3)).speed_ratio.shape == (2, 3)


def test_shafts_count_from_both_ends() -> None:
    line = Driveline.from_bends([0.3, 0.2], 0.4, -1.1)
    assert line.transmission().q == line.transmission(2).q == line.transmission(-1).q
    assert line.transmission(-2).q == line.transmission(1).q != line.transmission().q


def test_angles_that_are_no_numbers_give_nan() -> None:
    transmission = Driveline.from_bends([0.3, 0.2], 0.4, -1.1).transmission()
    for columns in (transmission.motion, transmission.gradient):
        for column in columns([0.3, math.nan, math.inf, -math.inf]):
            assert np.isnan(column).tolist() == [False, True, True, True]


test_wrong_arguments = refusals(
    {
        "IndexError: shaft is 3": lambda: BATCH.transmission(3),
        "TypeError: shaft is 1.5": lambda: BATCH.transmission(1.5),  # type: ignore[arg-type]
        "TypeError: angle has dtype": lambda: BATCH.transmission().motion("a"),
        "TypeError: angle has dtype complex128": lambda: BATCH.transmission().motion(1j),
        "(3,)": lambda: BATCH.transmission().motion(np.zeros(2)),
        "(2,)": lambda: BATCH.transmission().gradient(np.zeros(2)),
    }
)

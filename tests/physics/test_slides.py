"""Slides of shafts whose axes do not meet, against closed forms and quadrature."""

from __future__ import annotations

import math
import pickle
from typing import Any, get_args

import mpmath
import numpy as np
import pytest

import cardan
from cardan.wear.axial_travel import SlideName
from refusals import refusals

OFFSETS: dict[str, Any] = {"driving_pin": 0.7, "cross": -0.4, "driven_pin": 0.3, "shafts": 0.9}


@pytest.mark.parametrize("bend", [5.0, 20.0, 45.0, 75.0, 89.0])
def test_amplitudes_have_closed_forms(bend: float) -> None:
    line = cardan.Driveline.from_bends([bend], degrees=True)
    beta = math.radians(bend)
    k = math.tan(beta / 2.0) ** 2
    of_yoke = line.slides(driving_pin=0.5)
    yoke = of_yoke.amplitudes([1, 2, 4])[0]
    assert yoke == pytest.approx([math.tan(beta / 2.0), 0.0, 0.0], rel=1e-11, abs=1e-13)
    if bend <= 45.0:
        # Farthest where the pin is normal to the bend plane: the offset then lies in that plane,
        # across the driving shaft.
        assert of_yoke.travel()[0] == pytest.approx(2.0 * 0.5 * math.sin(beta), rel=1e-12)
    apart = line.slides(shafts=0.5).amplitudes([1, 2, 4, 6])[0]
    expected = [0.0, *(k**n / math.sin(beta) for n in (1, 2, 3))]
    assert apart == pytest.approx(expected, rel=1e-11, abs=1e-13)


def test_amplitudes_are_integrals() -> None:
    """The driven yoke's and the cross's offsets make elliptic integrals of order 1, 2 and 3."""
    bend = mpmath.radians(35)
    line = cardan.Driveline.from_bends([35], degrees=True)

    def rho(a: mpmath.mpf) -> mpmath.mpf:
        return mpmath.sqrt(mpmath.sin(a) ** 2 + (mpmath.cos(bend) * mpmath.cos(a)) ** 2)

    def order(number: int, slide: Any) -> float:  # noqa: ANN401
        parts = [mpmath.pi * i / 4 for i in range(9)]
        whole = mpmath.quad(lambda a: slide(a) * mpmath.expj(-number * a), parts)
        return float(abs(whole) / mpmath.pi)

    driven = line.slides(driven_pin=1.0).amplitudes([1, 2, 3])[0]
    cross = line.slides(cross=1.0).amplitudes([1, 2, 4])[0]
    of_driven = [order(n, lambda a: mpmath.sin(bend) * mpmath.cos(a) / rho(a)) for n in (1, 2, 3)]
    assert driven == pytest.approx(of_driven, rel=1e-11, abs=1e-13)
    assert cross == pytest.approx([order(n, lambda a: 1 / rho(a)) for n in (1, 2, 4)], abs=1e-13)


def test_amplitudes_of_a_steep_joint_are_those_of_many_samples() -> None:
    found = cardan.Driveline.from_bends([89.0], degrees=True).slides(cross=0.5)
    angles = np.arange(1 << 14) * (math.tau / (1 << 14))
    for order in (2, 4):
        wanted = 2.0 * abs(np.mean(found.at(angles)[0] * np.exp(-1j * order * angles)))
        assert found.amplitudes(order)[0] == pytest.approx(wanted, rel=1e-10)


def test_offsets_add_and_chains_have_their_input_angles() -> None:
    line = cardan.Driveline.from_bends([10, 35, 20], [20, -40], [50, 10], degrees=True)
    angles = np.linspace(0.0, 6.0, 7)
    whole = line.slides(**OFFSETS)
    parts = [line.slides(**{name: value}) for name, value in OFFSETS.items()]
    for name in get_args(SlideName):
        together = sum(part.at(angles, name) for part in parts)
        assert whole.at(angles, name) == pytest.approx(together, abs=1e-13)
    # Joint 2 alone, at the angle of its pin from the plane of its shafts.
    tilt = line.evaluate(angles, "tilt_driving", joints=2).tilt_driving
    alone = cardan.Driveline.from_bends([20], degrees=True)
    own = np.arcsin(np.tan(tilt) / math.tan(math.radians(20)))
    tilted = alone.slides(driving_pin=0.7).at(np.array([own, math.pi - own]))[0]
    found = line.slides(driving_pin=[0.0, 0.0, 0.7]).at(angles)
    assert found[:2] == pytest.approx(0.0, abs=1e-15)
    assert np.min(np.abs(np.abs(tilted) - np.abs(found[2])), axis=0) == pytest.approx(
        0.0, abs=1e-12
    )


def test_shapes_travel_and_pickles() -> None:
    line = cardan.Driveline.from_bends([[10, 20], [30, 5], [0, 0]], degrees=True)
    slides = line.slides(driving_pin=[[0.5, 0.1]], shafts=0.2)
    assert slides.at(np.zeros((4, 3))).shape == (2, 4, 3)
    assert slides.amplitudes((1, 2)).shape == (2, 3, 2)
    assert slides.amplitudes(1).shape == (2, 3)
    assert slides.travel().shape == (2, 3)
    one = line[1].slides(driving_pin=[0.5, 0.1], shafts=0.2)
    assert slides.travel()[:, 1] == pytest.approx(one.travel())
    again = pickle.loads(pickle.dumps(slides))
    assert np.array_equal(again.at(0.3), slides.at(0.3))
    simple = cardan.Driveline.from_bends([30], degrees=True).slides(driving_pin=1.0)
    turn = simple.at(np.linspace(0, 2 * math.pi, 100_001))
    assert simple.travel() == pytest.approx(np.ptp(turn, axis=-1), rel=1e-4)
    # A straight joint slides nowhere along its shaft: the pins alone take up the offset.
    assert slides.amplitudes([1, 2])[:, 2] == pytest.approx(0.0, abs=1e-15)


test_what_is_refused = refusals(
    {
        "driving_pin is nan; it must be finite": {"driving_pin": math.nan},
        "cross has shape (2,); it is one number or one per joint": {"cross": [1.0, 2.0]},
        "blocked is 'shafts'; did you mean 'shaft'?": {"blocked": "shafts"},
        "blocked has 'driven_pin', but the offsets of joint 0 make it slide by": {
            "driving_pin": 0.5,
            "blocked": ("driven_pin", "shaft"),
        },
    },
    cardan.Driveline.from_bends([10], degrees=True).slides,
)


@pytest.mark.parametrize("scale", [1e-9, 1.0, 1e9])
@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_whether_a_slide_moves_does_not_depend_on_the_unit(scale: float, sign: float) -> None:
    line = cardan.Driveline.from_bends([10, 0.1], degrees=True)
    offset = 0.5 * scale * sign
    with pytest.raises(ValueError, match="the offsets of joint 1 make it slide by"):
        line.slides(driving_pin=[0.0, offset], blocked="shaft")
    # A straight joint moves along its pins alone, but for rounding.
    straight = cardan.Driveline.from_bends([10, 0], twists=20, degrees=True)
    straight.slides(shafts=[0.0, offset], driven_pin=[0.0, offset], blocked="shaft")


def test_a_blocked_slide_that_does_not_move_is_no_fault() -> None:
    line = cardan.Driveline.from_bends([10, 0], degrees=True)
    free = line.slides(driving_pin=[0.0, 0.5], blocked="shaft")
    assert free.travel() == pytest.approx([0.0, 0.0], abs=1e-14)
    with pytest.raises(ValueError, match=r"of is 'axle'"):
        free.travel("axle")  # type: ignore[arg-type]
    with pytest.raises(ValueError, match=r"orders\[1\] is 0; an order is an integer from 1"):
        free.amplitudes([1, 0])
    with pytest.raises(TypeError, match="orders has dtype float64; an order is an integer"):
        free.amplitudes([1.0])

"""Centred double joints against the points of their triangle and the motion of two joints."""

from __future__ import annotations

import math
import pickle
from typing import Any

import mpmath
import numpy as np
import pytest
from matplotlib import pyplot

import cardan
from cardan.app.plots import plot_double_joint
from refusals import refusals


def double_joint(*args: Any, **named: Any) -> cardan.Driveline:  # noqa: ANN401
    return cardan.Driveline.from_double_joint(*args, degrees=True, **named)


def triangle(total: float, length: float, pivot: float) -> tuple[float, float]:
    """Both bends in degrees from coordinates: joint 1 is where the driven shaft is reached.

    Joint 0 is at the origin, the driving shaft along x, the pivot at (pivot, 0).
    """
    with mpmath.workdps(40):
        t = mpmath.radians(mpmath.mpf(total))
        c, s = mpmath.cos(t), mpmath.sin(t)
        p, a = mpmath.mpf(pivot), mpmath.mpf(length)
        # |pivot + along (c, s)| = length, with the joint behind the pivot.
        along = -p * c + mpmath.sqrt(a**2 - (p * s) ** 2)
        first = mpmath.atan2(along * s, p + along * c)
        return float(mpmath.degrees(first)), float(mpmath.degrees(t - first))


def residual(total: float, length: float, pivot: float) -> float:
    """The equivalent bend in degrees: with yokes in line, tan a_2 = tan a cos b_1 / cos b_0."""
    first, second = (mpmath.radians(bend) for bend in triangle(total, length, pivot))
    ratio = mpmath.cos(second) / mpmath.cos(first)
    return float(mpmath.degrees(mpmath.acos(min(ratio, 1 / ratio))))


@pytest.mark.parametrize("total", [0.0, 1e-6, 7.0, 25.0, 35.0, 50.0, 80.0, 130.0])
@pytest.mark.parametrize("pivot", [0.02, 0.03, 0.0315, 0.045])
def test_bends_are_those_of_the_triangle(total: float, pivot: float) -> None:
    expected = triangle(total, 0.06, pivot)
    if max(expected) >= 90.0:
        with pytest.raises(ValueError, match="a bend must lie in"):
            double_joint(total, 0.06, pivot)
        return
    line = double_joint(total, 0.06, pivot)
    assert line.bends_deg == pytest.approx(expected, rel=1e-12, abs=1e-13)
    assert np.degrees(line.equivalent().bend) == pytest.approx(
        residual(total, 0.06, pivot), rel=1e-9, abs=1e-6
    )


def test_it_is_synchronous_where_it_should_be() -> None:
    total = np.linspace(0.0, 35.0, 3501)
    line = double_joint(total, 0.06, synchronous=35.0)
    bend = np.degrees(line.equivalent().bend)
    worst = int(np.argmax(bend))
    assert total[worst] == pytest.approx(24.92)
    assert bend[worst] == pytest.approx(3.9086, abs=5e-5)
    # A rounding of 1e-16 in k is 2e-8 rad.
    assert bend[-1] < 1e-6
    assert bend[0] == 0.0
    assert line.bends_deg[-1] == pytest.approx([17.5, 17.5])
    # The pivot: X = (a/2)(sec(x/2) - 1) beyond the middle.
    x = 0.03 * (1.0 / math.cos(math.radians(17.5)) - 1.0)
    same = double_joint(total, 0.06, 0.03 + x)
    assert same.bends == pytest.approx(line.bends, rel=1e-12)
    assert double_joint(total, 60.0, synchronous=35.0).bends == pytest.approx(line.bends)
    middle = double_joint(20.0, 0.06)
    assert middle.bends == pytest.approx(double_joint(20.0, 0.06, 0.03).bends)


def test_arguments_broadcast_and_radians_are_the_default() -> None:
    line = double_joint([[10.0], [20.0]], [0.05, 0.06, 0.07], synchronous=[30.0, 35.0, 40.0])
    assert line.shape == (2, 3)
    one = cardan.Driveline.from_double_joint(
        math.radians(20.0), 0.06, synchronous=math.radians(35.0)
    )
    assert line[1, 1].bends == pytest.approx(one.bends, rel=1e-14)
    assert line.twists.tolist() == line.phases.tolist() == np.zeros((2, 3, 1)).tolist()
    assert pickle.loads(pickle.dumps(line)).approx_equal(line)


test_what_is_refused = refusals(
    {
        "pivot and synchronous are both given": [(20.0, 0.06, 0.03), {"synchronous": 35.0}],
        "total[1] is -5.0 deg; it must lie in [0, 180) deg": [([10.0, -5.0], 0.06), {}],
        "total is 180.0 deg; it must lie in [0, 180) deg": [(180.0, 0.06), {}],
        "total is 300.0 deg; it must lie in [0, 180) deg": [(300.0, 0.06), {}],
        "length is 0.0; it must be positive and finite": [(20.0, 0.0), {}],
        "pivot is 0.06; it must lie between the joints": [(20.0, 0.06, 0.06), {}],
        "pivot[1] is -1.0; it must lie between": [(20.0, 0.06, [0.01, -1.0]), {}],
        "synchronous is 120.0 deg; it must lie in [0, 120)": [(20.0, 0.06), {"synchronous": 120.0}],
        "total[1] is 170.0 deg, which bends joint 0 by 168.34": [([20.0, 170.0], 0.06, 0.01), {}],
        "shapes do not broadcast": [([20.0, 10.0], [1.0, 2.0, 3.0]), {}],
    },
    lambda arguments, named: double_joint(*arguments, **named),
)


def test_the_picture_shows_the_residual_bend() -> None:
    axes = plot_double_joint(60.0, 35.0, wear=0.2)
    place = 30.0 / math.cos(math.radians(17.5))
    curves = axes.get_lines()
    labels = ["as drawn", "pivot 0.2 farther", "pivot 0.2 nearer"]
    assert [curve.get_label() for curve in curves] == labels
    for curve, pivot in zip(curves, (place, place + 0.2, place - 0.2), strict=True):
        total, drawn = np.asarray(curve.get_xdata()), np.asarray(curve.get_ydata())
        assert (total[0], total[-1]) == (0.0, 50.0) == pytest.approx(axes.get_xlim())
        own = [residual(at, 60.0, pivot) for at in total[1::40]]
        assert drawn[1::40] == pytest.approx(own, rel=1e-9, abs=1e-6)
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("total bend [deg]", "equivalent bend [deg]")
    assert axes.get_ylim()[0] == 0.0
    # A worn pivot may be off either way.
    other = plot_double_joint(60.0, 35.0, wear=-0.2)
    assert [curve.get_label() for curve in other.get_lines()] == labels
    for one, same in zip(curves, other.get_lines(), strict=True):
        np.testing.assert_array_equal(one.get_ydata(), same.get_ydata())
    # Where both bends are equal, the curve reaches 0.
    assert min(np.asarray(curves[0].get_ydata())) == pytest.approx(0.0, abs=1e-4)
    assert len(plot_double_joint(60.0, 35.0).get_lines()) == 1
    pyplot.close("all")

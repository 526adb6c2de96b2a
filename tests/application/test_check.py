"""Limits in words, and yoke settings in the words of a workshop."""

from __future__ import annotations

import math

import numpy as np
import pytest

from cardan import Driveline, workshop
from cardan.check import Finding

RPM = 2 * math.pi / 60


def test_a_compensated_shaft_passes_at_moderate_speed() -> None:
    found = Driveline.from_bends([5, 5], degrees=True).check(1500 * RPM)
    assert found.passes
    assert str(found).startswith("The driveline passes.\n- equivalent bend ")
    assert len(found.findings) == 5


def test_a_check_is_true_if_it_passes() -> None:
    assert Driveline.from_bends([5, 5], degrees=True).check()
    assert not Driveline.from_bends([5, 1], degrees=True).check()
    batch = Driveline.from_bends([[5, 5], [5, 1]], degrees=True).check()
    with pytest.raises(ValueError, match=r"each of 2 drivelines or speeds.*check\.passes\.all\(\)"):
        bool(batch)
    with pytest.raises(ValueError, match="each of 1 drivelines or speeds"):
        bool(Driveline.from_bends([5, 5], degrees=True).check([100.0]))


def test_without_a_speed_there_is_no_excitation() -> None:
    found = Driveline.from_bends([5, 5], degrees=True).check()
    assert [f.name for f in found.findings] == ["equivalent bend", "non-uniformity"]


def test_a_joint_has_no_shafts_between() -> None:
    found = Driveline.from_bends([5], degrees=True).check(100 * RPM)
    assert [f.name for f in found.findings][2:] == ["torsional excitation of the last shaft"]


def test_findings_in_words() -> None:
    def words(value: float | list[float], unit: str = "1") -> str:
        return str(Finding("shake", np.array(value), 2.0, 5.0, unit))

    assert words(1.5) == "shake 1.5 keeps the limit of 2"
    assert words(2.0, "deg") == "shake 2 deg keeps the limit of 2 deg"
    assert words(5.0, "deg") == "shake 5 deg is above the limit of 2 deg but below 5 deg"
    assert words(5.1) == "shake 5.1 is above the limit of 2 and the maximum of 5"
    assert words(2e-7) == "shake 0 keeps the limit of 2"
    assert words(3e-6) == "shake 3e-06 keeps the limit of 2"
    assert words([1.0, 3.0]) == (
        "shake up to 3 is above the limit of 2 but below 5; 1 of 2 keep the limit"
    )
    worst = Finding(
        "shake", np.array([1.0, 3.0]), 2.0, 5.0, "deg", {"bends_deg.0": 16.0, "rpm": 1e3}
    )
    assert str(worst).startswith("shake up to 3 deg (at bends_deg.0 = 16, rpm = 1000) is above the")
    nothing = Finding("shake", np.array([0.0, 1e-9]), 2.0, 5.0, "deg", {"bends_deg.0": 16.0})
    assert str(nothing).startswith("shake up to 0 deg keeps the")
    assert words([]) == "shake up to 0 keeps the limit of 2; 0 of 0 keep the limit"


def test_the_whole_check_in_words() -> None:
    words = str(Driveline.from_bends([4, 1], degrees=True).check(300 * RPM)).splitlines()
    assert words[0] == "The driveline does not pass."
    assert words[2].endswith("is above the limit of 0.0027")
    assert all(line.endswith("rad/s²") for line in words[3:])


def test_the_two_forms_of_the_catalogue_tolerance_agree() -> None:
    # U <= 0.0027 is where 3 degrees come from: U(3 degrees) = 0.00274.
    found = Driveline.from_bends([[2.97], [2.99], [3.01]], degrees=True).check()
    bend, uniformity = found.findings
    assert bend.passes.tolist() == [True, True, False]
    assert uniformity.passes.tolist() == [True, False, False]
    assert uniformity.value[1] == pytest.approx(0.0027, rel=0.01)


def test_four_joints_of_a_truck() -> None:
    # 5/4/3/2 degrees, first shaft crossed, the others parallel, 2500 rpm. Practice finds torsional
    # 6.00 degrees or 749, driving 9.90 or 2026, coasting 3.16 or 209 rad/s^2, from w^2 sin^2; the
    # exact figures lie above by up to 1.5 per cent.
    line = Driveline.from_bends([5, 4, 3, 2], phases=[90, 0, 0], degrees=True)
    found = {f.name: float(f.value) for f in line.check(2500 * RPM).findings}
    assert found["equivalent bend"] == pytest.approx(6.00, abs=0.005)
    torsional = found["torsional excitation of the last shaft"]
    driving = found["inertia excitation of the shafts between, driving"]
    coasting = found["inertia excitation of the shafts between, coasting"]
    assert 749 < torsional < 749 * 1.015
    assert 2026 < driving < 2026 * 1.015
    assert coasting == pytest.approx(209, rel=0.015)
    assert not line.check(2500 * RPM).passes
    assert "300 rad/s² and the maximum of 500 rad/s²" in str(line.check(2500 * RPM))


def test_the_driving_figure_is_the_sampled_one() -> None:
    line = Driveline.from_bends([12, 9, 7, 5], [20, 30, 40], [50, 10, -20], degrees=True)
    speed = 100.0
    angle = np.linspace(0, 2 * math.pi, 512, endpoint=False)
    shaken = line.evaluate(angle, "acceleration_ratio", shafts=[1, 2, 3]).acceleration_ratio
    second = 2 * abs(np.fft.rfft(shaken.sum(axis=0))[2]) / len(angle)
    found = line.check(speed).findings[3]
    assert float(found.value) == pytest.approx(speed**2 * second, rel=1e-12)


def test_coasting_is_driving_from_the_other_end() -> None:
    line = Driveline.from_bends([12, 9, 7], [20, 30], [50, 10], degrees=True)
    there, back = line.check(50.0).findings, line.reversed().check(50.0).findings
    assert float(there[3].value) == pytest.approx(float(back[4].value), rel=1e-14)
    assert float(there[4].value) == pytest.approx(float(back[3].value), rel=1e-14)


def test_a_batch_in_words() -> None:
    found = Driveline.from_bends([[1], [2], [4]], degrees=True).check()
    assert found.passes.tolist() == [True, True, False]
    assert "equivalent bend up to 4 deg" in str(found)
    assert "2 of 3 keep the limit" in str(found)
    assert str(found).startswith("2 of 3 pass.\n")


def test_joints_that_cancel_leave_nothing_to_read() -> None:
    found = Driveline.from_bends([15, 15], twists=[180], degrees=True).check(100.0)
    assert float(found.findings[0].value) > 0
    assert str(found).splitlines()[1:4] == [
        "- equivalent bend 0 deg keeps the limit of 3 deg",
        "- non-uniformity 0 keeps the limit of 0.0027",
        "- torsional excitation of the last shaft 0 rad/s² keeps the limit of 300 rad/s²",
    ]


def test_between_limit_and_maximum() -> None:
    line = Driveline.from_bends([1.0], degrees=True)
    speed = math.sqrt(400 / float(line.equivalent().max_acceleration_ratio))
    text = str(line.check(speed))
    assert "400 rad/s² is above the limit of 300 rad/s² but below 500 rad/s²" in text


def test_the_fork_of_the_catalogue_example() -> None:
    line = Driveline.from_projected_bends([15, -11.5], [7, 12], degrees=True)
    setting = workshop.turn(line.optimal_phases())
    # The smallest |q| of unequal bends is where the yokes line up with the twist.
    assert str(setting) == (
        "70.87° counter-clockwise = 109.13° clockwise, looking from the drive towards the output"
    )


@pytest.mark.parametrize(
    ("angle", "size", "sense"),
    [
        (0.3, 0.3, "clockwise"),
        (-0.3, 0.3, "counter-clockwise"),
        (math.pi - 0.3, 0.3, "counter-clockwise"),
        (math.pi + 0.3, 0.3, "clockwise"),
        (0.0, 0.0, "none"),
    ],
)
def test_turns_are_modulo_180_degrees(angle: float, size: float, sense: str) -> None:
    found = workshop.turn(angle)
    assert float(found.angle) == pytest.approx(size, abs=1e-15)
    assert str(found.sense) == sense


def test_turns_of_arrays() -> None:
    found = workshop.turn([[0.1, -0.2], [0.0, math.nan]])
    assert found.sense.tolist()[0] == ["clockwise", "counter-clockwise"]
    assert found.angle.shape == (2, 2)
    assert str(found).splitlines()[2] == "in one plane"


def test_a_line_of_speeds_is_checked_together_with_a_single_driveline() -> None:
    found = Driveline.from_bends([5, 5], degrees=True).check([100.0, 1e4])
    assert found.passes.tolist() == [True, False]
    assert str(found).startswith("1 of 2 pass.\n")


def test_speeds_that_do_not_fit_the_batch() -> None:
    with pytest.raises(ValueError, match=r"driveline \(2,\), speed \(3,\)"):
        Driveline.from_bends([[5], [6]], degrees=True).check([1.0, 2.0, 3.0])


def test_what_is_not_a_number_is_above_no_limit() -> None:
    found = Driveline.from_bends([5, 5], degrees=True).check(np.nan)
    assert not found.passes
    assert "above" not in str(found)
    assert "is not a number" in str(found)


def test_turns_that_are_not_finite_have_no_sense() -> None:
    turn = workshop.turn([np.nan, np.inf, 0.0])
    assert turn.sense.tolist() == ["unknown", "unknown", "none"]
    assert str(turn).splitlines() == ["not a number", "not a number", "in one plane"]

"""States that follow the torque: [[wind_up]]."""

from __future__ import annotations

import re

import numpy as np
import pytest

import cardan
from cardan.app.answers.answer import Answer
from cardan.app.scene.machine import machine_data

POINTS = "[[0, 0, 0], [350, -24, 0], [1650, -46, 0], [3150, -180, 45], [3450, -196, 45]]"
LINE = f"[driveline]\npoints_mm = {POINTS}\n"
LOAD = "[load]\noutput_torque_Nm = 1\n[limits]\nequivalent_bend_deg = 3\n"
STATES = "[states]\noutput_torque_Nm = [-300, 0, 1500]\n"
AXLE = """
[[wind_up]]
points = "3-4"
about_mm = [3450, -250, 45]
axis = "z"
deg_per_kNm = 1.5
"""
TORQUES = [-300.0, 0.0, 1500.0]


def parsed(rest: str = AXLE, states: str = STATES, line: str = LINE) -> cardan.Scene:
    return cardan.Scene.parse(line + LOAD + states + rest)


def test_points_turn_with_the_torque_of_each_state() -> None:
    scene = parsed(AXLE + "mm_per_kNm = [0, 2, 0]\n")
    lines = scene.drivelines()
    points = 1e-3 * np.array(eval(POINTS))
    free = cardan.Driveline.from_points(points)
    turn = np.radians(1.5) / 1e3
    about, shift = np.array([3.45, -0.25, 0.045]), np.array([0.0, 2e-6, 0.0])
    # Turns follow moves.
    for i, torque in enumerate(TORQUES):
        moved = free.wound_up(torque, [3, 4], shift=shift)
        by_hand = moved.wound_up(torque, [3, 4], turn=turn, about=about)
        np.testing.assert_allclose(lines[i].bends, by_hand.bends, rtol=1e-12)
        np.testing.assert_allclose(lines[i].lengths().each, by_hand.lengths().each, rtol=1e-12)


def test_states_without_torque_or_compliance_have_the_bits_of_the_drawing() -> None:
    drawn = parsed("", "").line
    np.testing.assert_array_equal(parsed().drivelines()[1].bends, drawn.bends)
    stiff = parsed(AXLE.replace("1.5", "0")).drivelines()
    for one in stiff:
        np.testing.assert_array_equal(one.bends, drawn.bends)
        np.testing.assert_array_equal(one.twists, drawn.twists)


def test_the_torque_of_the_load_moves_all_states_alike() -> None:
    own = '[states]\n"points_mm.2.y" = [-46, -40]\n'
    scene = parsed(states=own)
    alone = parsed("", own)
    assert np.all(scene.drivelines().bends[:, 2] != alone.drivelines().bends[:, 2])


def test_shafts_tilt_in_readings_and_slopes() -> None:
    tilt = "[[wind_up]]\nshafts = 2\ndeg_per_kNm = 2\n"
    for line in (
        '[driveline]\nreadings_deg = ["3 down", "6 down", "3 down"]\n',
        "[driveline]\nslopes_vertical_deg = [-3, -6, -3]\n",
    ):
        bends = np.degrees(parsed(tilt, line=line).drivelines().bends)
        np.testing.assert_allclose(bends[:, 0], 3.0, rtol=1e-12)
        np.testing.assert_allclose(bends[:, 1], [2.4, 3.0, 6.0], rtol=1e-12)


def test_best_values_serve_all_states() -> None:
    vary = '[optimise]\nvary = {"points_mm.4.y" = [-60, 60]}\n'
    scene = parsed(AXLE + vary)
    assert scene.optimisation is not None
    found = scene.optimisation.run()
    after = scene.drivelines({"points_mm.4.y": -196 + found.x[0]}).equivalent().bend
    before = scene.drivelines().equivalent().bend
    np.testing.assert_allclose(found.per_state, after, rtol=1e-9)
    np.testing.assert_allclose(found.per_state_before, before, rtol=1e-12)
    # Coast and launch are equally uneven at the best height.
    assert np.max(after) < np.max(before)
    np.testing.assert_allclose(after[0], after[2], rtol=1e-4)


def test_the_page_moves_what_turns() -> None:
    from cardan.app.scene.changes import given

    scene = parsed()
    turned = given(scene)["turned"]
    assert set(turned) == {3, 4}
    assert given(scene)["torque"] is None
    data = machine_data(scene)
    assert data is not None
    np.testing.assert_array_equal(data["points"][1], eval(POINTS))
    angle = np.radians(2.25)
    turn = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
    assert [len(each["turns"]) for each in turned[3]] == [1, 0, 1]
    assert turned[3][2]["before"] == [3150, -180, 45]
    found = np.array(turned[3][2]["turns"][0]["matrix"])
    np.testing.assert_allclose(found[:2, :2], turn, atol=1e-15)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('points = "3-4"', 'points = "3-5"', "[[wind_up]][0] points does not exist; there are 5"),
        ('points = "3-4"', "points = 1.5", 'points is 1.5; it must be as 2 or "2-3", counted fro'),
        ('points = "3-4"', 'shafts = "3"', "shafts need readings_deg or slopes_vertical_deg in"),
        ('axis = "z"', 'axis = "w"', 'axis is \'w\'; it is "x", "y", "z" or three numbers'),
        ('axis = "z"', "axis = [0, 0, 0]", "axis is [0, 0, 0]; an axis needs a direction"),
        ("about_mm = [3450, -250, 45]", "", "deg_per_kNm needs about_mm, a point of the axis"),
        ("deg_per_kNm = 1.5", "", "deg_per_kNm is missing; or give mm_per_kNm"),
    ],
)
def test_what_is_wrong(old: str, new: str, words: str) -> None:
    with pytest.raises(ValueError, match="wind_up") as error:
        parsed(AXLE.replace(old, new))
    assert words in str(error.value), str(error.value)


def test_torques_are_needed() -> None:
    with pytest.raises(ValueError, match=re.escape("give [states] output_torque_Nm = [-300")):
        parsed(states="")
    with pytest.raises(ValueError, match="no torque for"):
        cardan.Scene.parse(f"{LINE}[states]\nnames = ['a']\n'points_mm.2.y' = [-46]\n{AXLE}")


def test_rates_in_other_units_are_told() -> None:
    tilt = "[[wind_up]]\nshafts = 2\ndeg_per_kNm = {}\n"
    line = "[driveline]\nreadings_deg = [-3, -6, -3]\n"
    for rate, count in ((6, 0), (0.006, 1), (0, 0)):
        found = Answer(parsed(tilt.format(rate), line=line))["remarks"]
        assert len([each for each in found if each.about == "[[wind_up]]"]) == count


def test_a_point_turns_once() -> None:
    own = '[states]\n"points_mm.4" = {turn_deg = [1, 2, 3], about_mm = [0, 0, 0], axis = "z"}\n'
    with pytest.raises(ValueError, match="varies already"):
        parsed(states=own + "output_torque_Nm = [1, 2, 3]\n")

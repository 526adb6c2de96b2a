"""Sections [states] and [[wind_up]]: what they read and refuse, and drivelines they describe."""

from __future__ import annotations

import re
import tomllib

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import cardan
from cardan import Driveline
from cardan.app.answers.answer import Answer
from cardan.app.scene import Scene, SceneError
from cardan.app.scene.machine import machine_data

POINTS = np.array([[0, 0, 0], [350, -24, 0], [1650, -46, 0], [3150, -180, 45]], dtype=float)


BASE = """\
[driveline]
points_mm = [[0, 0, 0], [350, -24, 0], [1650, -46, 0], [3150, -180, 45]]
[load]
speed_rpm = 1500
"""


STATES = """\
[states]
names = ["rebound", "ride", "bump"]
weights = [1, 4, 2]
"points_mm.2.y" = [-140, -46, 40]
points_mm.3.z = {from = 45, to = 25, steps = 3}
"phases_deg.0" = [0, 10, 20]
drive_torque_Nm = [100, 300, 200]
"""


def test_each_state_is_the_driveline_that_its_values_describe() -> None:
    states = Scene.parse(BASE + STATES).states
    assert states
    assert states.names == ("rebound", "ride", "bump")
    assert states.weights.tolist() == [1.0, 4.0, 2.0]
    points = np.array([POINTS] * 3)
    points[:, 2, 1] = [-140, -46, 40]
    points[:, 3, 2] = [45, 35, 25]
    exact = Driveline.from_points(points, [[0], [10], [20]], degrees=True)
    lines = states.drivelines()
    assert lines.shape == (states.count,) == (3,)
    assert np.array_equal(lines.bends, exact.bends)
    assert np.array_equal(lines.twists, exact.twists)
    assert np.array_equal(lines.phases, exact.phases)
    np.testing.assert_allclose(
        lines.lengths().each, np.linalg.norm(np.diff(points, axis=1), axis=-1) / 1e3, rtol=1e-14
    )
    assert [float(states.load(i).torque) for i in range(3)] == [100.0, 300.0, 200.0]  # type: ignore[union-attr]
    assert np.array_equal(states.points(0), points[0])  # type: ignore[arg-type]


CHANGES = """\
[states]
names = ["low", "rest", "high"]
"points_mm.2-3.y" = {add = [-60, 0, 40]}
"points_mm.3.z" = [45, 50, 55]
"points_mm.3" = {turn_deg = [-20, 0, 35], about_mm = [1650, -46, 10], axis = [1, 2, 2]}
"phases_deg" = {add = {from = -5, to = 5, steps = 3}}
"""


def changed_points(points: np.ndarray) -> np.ndarray:
    """The points of CHANGES: values first, then what is added, then the turn by a quaternion."""
    found = np.array([points] * 3)
    found[:, 3, 2] = [45, 50, 55]
    found[:, 2:, 1] += np.array([[-60], [0], [40]])
    about = np.array([1650.0, -46.0, 10.0])
    for i, angle in enumerate(np.radians([-20.0, 0.0, 35.0])):
        turn = Rotation.from_rotvec(angle * np.array([1.0, 2.0, 2.0]) / 3.0)
        found[i, 3] = about + turn.apply(found[i, 3] - about)
    return found


def test_states_are_changes_of_the_drawing() -> None:
    scene = Scene.parse(BASE + CHANGES)
    assert scene.states
    exact = Driveline.from_points(changed_points(POINTS), [[-5], [0], [5]], degrees=True)
    lines = scene.states.drivelines()
    np.testing.assert_allclose(lines.bends, exact.bends, rtol=1e-13)
    np.testing.assert_allclose(lines.twists, exact.twists, rtol=1e-12)
    np.testing.assert_allclose(lines.phases, exact.phases, rtol=1e-14)
    assert [axis.key for axis in scene.states.axes] == [
        "points_mm.2-3.y.add",
        "points_mm.3.z",
        "points_mm.3.turn_deg",
        "phases_deg.add",
    ]
    study = """\
[study.points_mm]
2-3.y = {add = [-60, 0, 40]}
3 = {z = [45, 50, 55], turn_deg = [-20, 0, 35], about_mm = [1650, -46, 10], axis = [1, 2, 2]}
"""
    grid = Scene.parse(BASE + study).study
    assert grid
    _, lines, _ = next(grid.blocks())
    diagonal = [0, 13, 26]
    np.testing.assert_allclose(lines.bends[diagonal, 0], exact.bends, rtol=1e-13)


def test_a_change_of_the_drawing_is_made_before_the_changes_of_the_states() -> None:
    scene = Scene.parse(BASE + CHANGES)
    moved = POINTS.copy()
    moved[3, 0] += 25.0
    lines = scene.drivelines({"points_mm.3.x": 3175.0})
    exact = Driveline.from_points(changed_points(moved))
    np.testing.assert_allclose(lines.bends, exact.bends, rtol=1e-13)
    optimise = '[optimise]\nminimise = "equivalent_bend"\nvary = {"points_mm.3.x" = [-50, 50]}\n'
    found = Scene.parse(BASE + CHANGES + optimise).optimisation
    assert found
    np.testing.assert_allclose(found.drivelines(np.array([25.0])).bends, exact.bends, rtol=1e-13)
    # The derivatives are those of points that nothing turns.
    assert found._parameters is None
    assert "states.points_mm.2-3.y.add" not in found.values_after(np.array([25.0]))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "{add = [-60, 0, 40]}",
            "{add = [-60, 0, 40], by = 2}",
            "points_mm.2-3.y has an unknown key 'by'; add stands alone",
        ),
        ("add = [-60, 0, 40]", "add = []", "points_mm.2-3.y.add is []; a study needs at least one"),
        ("add = [-60, 0, 40]", "add = [-60, 40]", "has 3 values and points_mm.2-3.y.add 2"),
        ("about_mm", "about_m", "points_mm.3 has about_m; the point is in the unit of points_mm"),
        ("about_mm = [1650, -46, 10], ", "", "points_mm.3 must have turn_deg, about_mm or about_m"),
        (
            "axis = [1, 2, 2]",
            "axis = [0, 0, 0]",
            "points_mm.3.axis is [0, 0, 0]; an axis needs a dir",
        ),
        (
            "axis = [1, 2, 2]",
            'axis = "w"',
            'points_mm.3.axis is \'w\'; it is "x", "y", "z" or three',
        ),
        ("turn_deg", "turn", "points_mm.3 has no 'turn'; did you mean 'turn_deg'?"),
        (
            '"points_mm.3.z" = [45',
            '"points_mm.3.y" = {add = [1, 1, 1]}\n"points_mm.3.z" = [45',
            "varies points_mm[3], which varies already",
        ),
    ],
)
def test_changes_that_are_refused(old: str, new: str, message: str) -> None:
    assert old in CHANGES
    with pytest.raises(SceneError) as error:
        Scene.parse(BASE + CHANGES.replace(old, new))
    assert message in str(error.value)


def test_bare_and_quoted_paths_mean_the_same() -> None:
    quoted = Scene.parse(BASE + STATES).drivelines()
    bare = STATES.replace('"points_mm.2.y"', "points_mm.2.y").replace(
        '"phases_deg.0"', "phases_deg"
    )
    assert np.array_equal(Scene.parse(BASE + bare).drivelines().bends, quoted.bends)
    assert np.array_equal(Scene.parse(BASE + bare).drivelines().phases, quoted.phases)


def test_a_state_alone_has_the_bits_of_a_scene_with_its_values() -> None:
    scene = Scene.parse(BASE + STATES)
    own = tomllib.loads(BASE)["driveline"]["points_mm"]
    own[2][1], own[3][2] = 40, 25
    single = Scene.parse(
        f"[driveline]\npoints_mm = {own}\nphases_deg = 20\n"
        "[load]\nspeed_rpm = 1500\ndrive_torque_Nm = 200\n"
    )
    state = scene.in_state(2)
    assert state.states is None
    names = ("moment", "torque", "acceleration_ratio")
    found = state.line.evaluate(state.angle, names, load=state.load_case)
    exact = single.line.evaluate(single.angle, names, load=single.load_case)
    batched = scene.drivelines()[2].evaluate(state.angle, names, load=state.load_case)
    for name in names:
        assert np.array_equal(found[name], exact[name])
        assert np.array_equal(batched[name], exact[name])


def test_changes_leave_the_values_of_the_states() -> None:
    scene = Scene.parse(BASE + STATES)
    points = np.array([POINTS] * 3)
    points[:, 2, 1] = [-140, -46, 40]
    points[:, 3, 2] = [45, 35, 25]
    points[:, 1, 1] = -10
    changed = scene.drivelines({"points_mm.1.y": -10.0})
    assert np.array_equal(changed.bends, Driveline.from_points(points).bends)
    each = scene.drivelines({"points_mm.1.y": [-24, -10, -24]})
    assert each.bends[1].tolist() == changed.bends[1].tolist()
    assert each.bends[0].tolist() == scene.drivelines().bends[0].tolist()
    plain = Scene.parse(BASE)
    assert plain.states is None
    assert plain.drivelines().shape == (1,)
    assert plain.drivelines({"phases_deg.0": 30}).phases == np.radians([[30.0]])


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"points_mm.2.y": 1}, "points_mm.2.y varies from state to state; it has no value to set"),
        ({"points_mm.4.y": 1}, "points_mm.4.y does not exist; there are 4, counted from 0"),
        ({"bends_deg.0": 1}, "bends_deg.0 is not in [driveline]; what can be set is points_mm, "),
        ({"points_mm.1.x": 1e5}, "in 'rebound', at points_mm.2.y = -140, points_mm.3.z = 45, "),
    ],
)
def test_changes_that_cannot_be(changes: dict[str, float], message: str) -> None:
    with pytest.raises(ValueError) as caught:  # noqa: PT011 - the message is what is tested
        Scene.parse(BASE + STATES).drivelines(changes)
    assert str(caught.value).startswith(message)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("-140, -46, 40", "-46, 40", "line 9: [states] points_mm.3.z has 3 values and points_mm.2"),
        ("phases_deg.0", "phases_deg.1", "line 10: [states] phases_deg.1 does not exist; there "),
        ('"bump"', '"ride"', "line 6: [states] names[2] is 'ride' again; name each once"),
        (', "bump"', "", "line 6: [states] names has length 2; it needs 3, one per state"),
        ("1, 4, 2", "1, 4", "line 7: [states] weights has length 2; it needs 3, one per state"),
        ("1, 4, 2", "1, -4, 2", "line 7: [states] weights[1] is -4; a weight must not be negative"),
        ("1, 4, 2", "0, 0, 0", "line 7: [states] weights has only zeros; at least one state must "),
        ('"points_mm.2.y"', "bends_deg", "line 8: [states] bends_deg is not in [driveline]; a "),
        (
            '"points_mm.2.y"',
            '"points_mm.3.z"',
            "[states] points_mm.3.z is given twice, with quotes",
        ),
        ("points_mm.3.z", "points_mm.2", "line 9: [states] points_mm.2 has no 'from'; known are "),
        ("points_mm.2.y", "point_mm.2.y", "line 8: [states] unknown key 'point_mm'; did you mean "),
        ("-140, -46", "-140, 'a'", "line 8: [states] points_mm.2.y[1] is 'a'; it must be a number"),
        (
            "-140, -46, 40",
            "-140, -46, 4e5",
            "line 5: [states] in 'bump', at points_mm.2.y = 400000, points_mm.3.z = 25, "
            "phases_deg.0 = 20, drive_torque_Nm = 200: points_mm give joint 0 a bend of ",
        ),
    ],
)
def test_messages(old: str, new: str, message: str) -> None:
    assert (BASE + STATES).count(old) == 1
    with pytest.raises(SceneError) as caught:
        Scene.parse((BASE + STATES).replace(old, new))
    assert str(caught.value).removeprefix("scene, ").removeprefix("scene: ").startswith(message)


def test_names_that_the_scene_leaves_out() -> None:
    one = Scene.parse(BASE + '[states]\n"points_mm.2.y" = [-40, 0]\n').states
    two = Scene.parse(BASE + '[states]\n"points_mm.2.y" = [0, 0]\npoints_mm.1.y = [0, 1]\n').states
    assert one
    assert one.names == ("points_mm.2.y = -40", "points_mm.2.y = 0")
    assert two
    assert two.names == ("state 0", "state 1")


def test_no_move_is_proposed_for_a_point_that_states_turn() -> None:
    turn = '[states]\n"points_mm.2" = {turn_deg = [0, 0.1], about_mm = [0, 0, 0], axis = "z"}\n'
    moved = []
    for states in ('[states]\n"points_mm.2.y" = {add = [0, 2]}\n', turn):
        bend = np.degrees(Scene.parse(BASE + states).drivelines().equivalent().bend.max())
        limits = f"[limits]\nequivalent_bend_deg = {0.99 * bend}\n"
        moves = Answer(Scene.parse(BASE + limits + states))["moves"]
        moved.append({move.number for move in moves if move.variable == "point"})
    assert 2 in moved[0]
    assert moved[1]
    assert 2 not in moved[1]


WOUND_POINTS = "[[0, 0, 0], [350, -24, 0], [1650, -46, 0], [3150, -180, 45], [3450, -196, 45]]"


LINE = f"[driveline]\npoints_mm = {WOUND_POINTS}\n"


LOAD = "[load]\noutput_torque_Nm = 1\n[limits]\nequivalent_bend_deg = 3\n"


WOUND_STATES = "[states]\noutput_torque_Nm = [-300, 0, 1500]\n"


AXLE = """
[[wind_up]]
points = "3-4"
about_mm = [3450, -250, 45]
axis = "z"
deg_per_kNm = 1.5
"""


TORQUES = [-300.0, 0.0, 1500.0]


def parsed(rest: str = AXLE, states: str = WOUND_STATES, line: str = LINE) -> cardan.Scene:
    return cardan.Scene.parse(line + LOAD + states + rest)


def test_points_turn_with_the_torque_of_each_state() -> None:
    scene = parsed(AXLE + "mm_per_kNm = [0, 2, 0]\n")
    lines = scene.drivelines()
    points = 1e-3 * np.array(eval(WOUND_POINTS))
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
    np.testing.assert_array_equal(data["points"][1], eval(WOUND_POINTS))
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

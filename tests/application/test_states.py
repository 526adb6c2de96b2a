"""Section [states]: what it reads, what it refuses, and the drivelines that it describes."""

from __future__ import annotations

import tomllib

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from cardan import Driveline
from cardan.app.answers.answer import Answer
from cardan.app.scene import Scene, SceneError
from cardan.app.scene.study.cluster import _fingerprint

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


def test_names_alone_are_no_states() -> None:
    with pytest.raises(SceneError, match="no key varies"):
        Scene.parse(BASE + '[states]\nnames = ["ride"]\n')


def test_names_that_the_scene_leaves_out() -> None:
    one = Scene.parse(BASE + '[states]\n"points_mm.2.y" = [-40, 0]\n').states
    two = Scene.parse(BASE + '[states]\n"points_mm.2.y" = [0, 0]\npoints_mm.1.y = [0, 1]\n').states
    assert one
    assert one.names == ("points_mm.2.y = -40", "points_mm.2.y = 0")
    assert two
    assert two.names == ("state 0", "state 1")


def test_another_turn_is_another_study_on_a_cluster() -> None:
    text = """\
[study.points_mm]
3 = {turn_deg = [-20, 0], about_mm = [1650, -46, 10], axis = "x"}
"""
    prints = []
    for changed in (text, text.replace("46", "47"), text.replace('"x"', '"y"')):
        study = Scene.parse(BASE + changed).study
        assert study
        prints.append(_fingerprint(study, False))
    assert prints[0] == _fingerprint(Scene.parse(BASE + text).study, False)  # type: ignore[arg-type]
    assert prints[0] != prints[1] != prints[2] != prints[0]


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

"""Section [states]: what it reads, what it refuses, and the drivelines that it describes."""

from __future__ import annotations

import tomllib

import numpy as np
import pytest

from cardan import Driveline
from cardan.app.scene import Scene, SceneError

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

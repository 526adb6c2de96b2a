"""Joints that deviate from their drawing: motion, forces of their bearings, and play."""

from __future__ import annotations

import itertools
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib import pyplot
from matplotlib.axes import Axes
from numpy.typing import NDArray

import cardan
import scripts
from cardan import Driveline, Load
from cardan.app.answers.answer import Answer
from cardan.app.answers.as_built import ORDERS, OrderFigures
from cardan.app.answers.backlash import Backlash, backlash, drawn_backlash
from cardan.app.answers.forces.figures import BearingForce, Forces, JointForce, force_figures
from cardan.app.answers.schema import check_data
from cardan.app.answers.tolerances.figures import tolerance_figures
from cardan.app.answers.turn.figures import SummaryRow, summary
from cardan.app.plots import plot_backlash, plot_lash
from cardan.app.scene import Scene, SceneError
from cardan.app.scene.study.curves import columns
from example_scenes import ANSWERS, example, replaced

HEAD = "[driveline]\nbends_deg = [8, 8]\n[load]\nspeed_rpm = 3000\ndrive_torque_Nm = 100\n"


JOINTS = "[joints]\ndriving_yoke_deg = [0.143, 0]\ncross_deg = 0.01\n"


OUTPUT = '[output]\nquantities = ["angle_error", "torque", "tilt_driving"]\n'


TEXT = HEAD + JOINTS + OUTPUT


IDEAL = Driveline.from_bends([8.0, 8.0], degrees=True)


BUILT = IDEAL.with_deviations([0.143, 0.0], 0.01, degrees=True)


SPEED = 100.0 * np.pi


def orders(scene: Scene) -> tuple[OrderFigures, ...]:
    found: tuple[OrderFigures, ...] = Answer(scene)["as_built"]
    return found


def amplitudes(found: tuple[OrderFigures, ...], name: str) -> list[float]:
    return [getattr(each, name).value for each in found]


def test_the_curves_are_those_as_built() -> None:
    scene = Scene.parse(TEXT)
    values = scene.run().values
    wanted = BUILT.evaluate(scene.drive_angle, scene.quantities, load=scene.load_case)
    for name, array in wanted.items():
        np.testing.assert_allclose(values[name], array, rtol=0, atol=1e-12, err_msg=name)
    assert not scene.line.has_deviations
    assert "as built" in scene.explain()


def test_the_orders_are_those_of_both_drivelines() -> None:
    found = orders(Scene.parse(TEXT))
    built = BUILT.harmonics(ORDERS, outputs=("angle_error", "acceleration_ratio"))
    assert [(each.order, each.shaft) for each in found] == [(order, 2) for order in ORDERS]
    own = amplitudes(found, "angle_error")
    np.testing.assert_allclose(own, built.angle_error, rtol=1e-9, atol=1e-12)
    faster = amplitudes(found, "acceleration")
    np.testing.assert_allclose(faster, built.acceleration_ratio * SPEED**2, rtol=1e-6, atol=1e-6)
    # Both joints cancel each other on the drawing.
    assert amplitudes(found, "angle_error_drawn") == [0.0] * len(ORDERS)
    assert [each.angle_error_worst for each in found] == [None] * len(ORDERS)
    assert orders(Scene.parse(HEAD)) == ()


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (HEAD + "[joints]\ncross_deg = [1]\n", "cross_deg has length 1; it needs 2"),
        (HEAD + "[joints]\ncross_deg = 95\n", "cross_deg is 95 deg; it must lie between"),
        (HEAD + "[joints]\ncross_deg = 84\n", "the joint cannot turn"),
        (
            TEXT + '[optimise]\nvary = {"phases_deg.0" = "free"}\n',
            "driving_yoke_deg does not go with [optimise], which searches drivelines of ideal",
        ),
        (
            HEAD + "[joints]\ncross_deg = 40\n[study]\nbends_deg.0 = [0, 60]\n",
            "and the deviations in [joints]",
        ),
        (
            HEAD + JOINTS + '[output]\naxes = "shaft"\n',
            "axes is 'shaft'; joints with deviations have 'space' only",
        ),
    ],
)
def test_what_does_not_go_with_deviations_is_refused(text: str, message: str) -> None:
    with pytest.raises(SceneError, match=re.escape(message)):
        Scene.parse(text)


MM = HEAD + "[joints]\narm_mm = [40, 50]\ndriving_yoke_mm = [0.1, 0]\ncross_deg = 0.01\n"


TOLERANCED = HEAD + (
    "[tolerances]\ndriving_yoke_mm = 0.1\ndriven_yoke_deg = [0, 0.2]\narm_mm = 40\nsamples = 500\n"
)


HALVES = np.array([[0.0025, 0.0025], [0.0, 0.0], [0.0, np.radians(0.2)]])


def test_millimetres_at_an_arm_are_angles() -> None:
    scene = Scene.parse(MM)
    assert scene.deviations is not None
    want = [[0.1 / 40.0, np.radians(0.01), 0.0], [0.0, np.radians(0.01), 0.0]]
    np.testing.assert_allclose(scene.deviations, want, rtol=1e-15)
    # The arm of a size of joint serves as well, and then the joint rubs.
    sized = MM.replace("[40, 50]", "40\nfriction = 0.05\npin_radius_mm = 8")
    rubbing = Scene.parse(sized)
    assert rubbing.sizes is not None
    assert rubbing.sizes.each[1].arm == 0.04
    assert Scene.parse(MM).sizes is None
    toleranced = Scene.parse(MM + "[tolerances]\ncross_mm = 0.2\nsamples = 9\n").tolerances
    assert toleranced is not None
    np.testing.assert_allclose(toleranced.given["cross"], [0.2 / 40.0, 0.2 / 50.0], rtol=1e-15)


def test_tolerances_of_joints_are_those_of_the_library() -> None:
    scene = Scene.parse(TOLERANCED)
    found = tolerance_figures(scene)
    assert found is not None
    own = IDEAL.tolerances(
        driving_yoke=HALVES[0],
        driven_yoke=HALVES[2],
        of="acceleration_order_1",
        speed=SPEED,
        samples=500,
        seed=0,
    )
    (figure,) = found.figures
    assert figure.name == "acceleration_order_1"
    assert figure.worst.value == pytest.approx(own.worst, rel=1e-12)
    quantiles = (figure.half, figure.most, figure.nearly)
    assert quantiles == pytest.approx(own.quantile([0.5, 0.95, 0.99]), rel=1e-12)
    assert figure.guaranteed is None
    given = {each.group: each for each in found.given}
    assert (given["driving_yoke"].unit, given["driven_yoke"].unit) == ("mm", "deg")
    assert given["driving_yoke"].least == given["driving_yoke"].largest
    assert given["driving_yoke"].largest == pytest.approx(1e-4, rel=1e-12)
    assert given["driven_yoke"].largest == pytest.approx(np.radians(0.2), rel=1e-12)
    still = Scene.parse(TOLERANCED.replace("speed_rpm = 3000\n", "")).tolerances
    assert still is not None
    assert still.of == ("angle_error_order_1",)


def test_figures_of_the_layout_are_those_of_ideal_joints() -> None:
    scene = Scene.parse(TOLERANCED.replace("samples", "phases_deg = 2\nsamples") + JOINTS)
    found = tolerance_figures(scene)
    assert found is not None
    bend, order = found.figures
    alone = IDEAL.tolerances(phases=2.0, degrees=True)
    assert bend.label == "equivalent bend of ideal joints"
    assert bend.worst.value == pytest.approx(alone.worst, rel=1e-12)
    assert bend.guaranteed is not None
    assert bend.guaranteed.value == pytest.approx(alone.guaranteed, rel=1e-12)
    assert [share.label for share in found.shares if share.name == bend.name] == [
        "phase of shaft 1"
    ]
    assert (bend.measured, order.measured) == (False, True)
    first = BUILT.harmonics([1], outputs="acceleration_ratio").acceleration_ratio[0] * SPEED**2
    assert order.nominal.value == pytest.approx(first, rel=1e-9)
    # Parameters of the joints do not count among those over which its worst case is searched.
    four = HEAD.replace("[8, 8]", "[8, 8, 5, 5]") + (
        "[tolerances]\nphases_deg = 2\ncross_deg = 0.1\ndriving_yoke_deg = 0.1\n"
        "driven_yoke_deg = 0.1\nbends_deg = 0.1\nsamples = 9\nof = 'equivalent_bend'\n"
    )
    many = tolerance_figures(Scene.parse(four))
    assert many is not None
    assert many.figures[0].worst_kind == "box"
    only = TOLERANCED.replace("samples", "of = 'equivalent_bend'\nsamples")
    with pytest.raises(SceneError, match=re.escape("of is 'equivalent_bend', a figure of ideal")):
        Scene.parse(only)


def test_the_table_has_the_worst_of_each_order() -> None:
    found = orders(Scene.parse(TOLERANCED))
    assert [each.angle_error_drawn for each in found] == [None] * len(ORDERS)
    signs = np.array([*itertools.product((-1.0, 1.0), repeat=4)])
    lines = IDEAL.with_deviations(
        signs[:, :2] * HALVES[0], 0.0, signs[:, 2:] * HALVES[2]
    ).harmonics([1, 3], outputs="angle_error")
    worst = lines.angle_error.max(axis=0)
    own = amplitudes(found, "angle_error_worst")
    np.testing.assert_allclose(own[::2], worst, rtol=1e-9)
    faster = amplitudes(found, "acceleration_worst")
    np.testing.assert_allclose(faster[::2], worst * np.square([1, 3]) * SPEED**2, rtol=1e-9)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("driving_yoke_mm = 0.1\n", "driving_yoke_mm needs arm_mm"),
        ("driving_yoke_mm = 0.1\ndriving_yoke_deg = 0.1\narm_mm = 40\n", "driving_yoke_mm"),
        ("cross_mm = [0.1]\narm_mm = 40\n", "cross_mm has length 1; it needs 2, one per joint"),
        ("cross_mm = 0.1\narm_mm = [40]\n", "arm_mm has length 1; it needs 2, one per joint"),
        ("driven_yoke_deg = -1\n", "driven_yoke_deg is -1; it must not be negative"),
        ("driven_yoke_mm = 60\narm_mm = 40\n", "driven_yoke_mm and the others permit"),
    ],
)
def test_wrong_tolerances_of_joints_are_refused(text: str, message: str) -> None:
    with pytest.raises(SceneError, match=re.escape(message)):
        Scene.parse(f"{HEAD}[tolerances]\n{text}")


LINES = [Driveline.from_bends([8.0, bend], degrees=True) for bend in (5.0, 8.0, 11.0)]


VARIED = TEXT.replace('"angle_error", "torque", "tilt_driving"', '"angle_error", "torque"')


@pytest.mark.parametrize("section", ["study", "states"])
def test_studies_and_states_have_outputs_as_built(section: str, tmp_path: Path) -> None:
    path = tmp_path / "scene.toml"
    key = "bends_deg.1" if section == "study" else '"bends_deg.1"'
    path.write_text(f"{VARIED}[{section}]\n{key} = [5, 8, 11]\n")
    scene = Scene.load(path)
    table = scene.run().study
    assert table is not None
    turn = np.asarray(scene.angle)
    for i, line in enumerate(LINES):
        built = line.with_deviations([0.143, 0.0], 0.01, degrees=True)
        at = built.evaluate(turn, ("angle_error", "torque"), load=scene.load_case)
        for name, values in at.items():
            found = table.values[f"{name}_peak"][i]
            assert found == pytest.approx(np.abs(values).max(), rel=1e-12), name
        assert table.values["equivalent_bend"][i] == pytest.approx(line.equivalent().bend, abs=1e-9)
    for name in ("run", "check"):
        assert "Joints as built" in scripts.run(name, path).output
    assert scripts.run("report", path, "--output", tmp_path / "page.html").exit_code == 0
    assert "as built" in scene.explain()


def test_the_state_with_the_largest_order_1_is_told() -> None:
    text = f'{VARIED}[states]\n"bends_deg.1" = [5, 8, 11]\nnames = ["low", "mid", "high"]\n'
    scene = Scene.parse(text.replace("[0.143, 0]", "[0, 0.143]"))
    found = orders(scene)
    each = [line.with_deviations([0.0, 0.143], 0.01, degrees=True) for line in LINES]
    for i, order in enumerate(ORDERS):
        own = [line.harmonics(order, outputs="angle_error").angle_error for line in each]
        error = found[i].angle_error
        assert [*error.each.values()] == pytest.approx(own, rel=1e-9, abs=1e-12)
        assert error.value == pytest.approx(max(own), rel=1e-9, abs=1e-12)
    assert found[0].angle_error.state == "high"
    data = check_data(Answer(scene))
    ANSWERS.validate(data)
    assert data["as_built"][0]["angle_error"]["state"] == "high"


DRAWN = example("bearings.toml").read_text(encoding="utf-8")


FORCES_JOINTS = (
    "[joints]\ndriving_yoke_deg = [0.8, 0, -0.5]\ncross_deg = 0.4\ndriven_yoke_deg = [0, 0.6, 0]\n"
)


FORCES_TEXT = f"{DRAWN}{FORCES_JOINTS}"


DRAWING = Scene.parse(DRAWN).line


FORCES_BUILT = DRAWING.with_deviations([0.8, 0.0, -0.5], 0.4, [0.0, 0.6, 0.0], degrees=True)


LOAD = Load(output_torque=1200.0)


TURN = np.arange(7200) * (2.0 * np.pi / 7200)


FORCES = ("joint_force", "bearing_force")


AT = FORCES_BUILT.evaluate(TURN, FORCES, load=LOAD)


def forces(scene: Scene) -> Forces:
    found: Forces | None = Answer(scene)["forces"]
    assert found is not None
    return found


def each(found: Forces) -> list[JointForce | BearingForce]:
    return [*found.joints, *found.bearings]


def order(values: np.ndarray, number: int) -> float:
    """The largest length of the part of vectors that changes so many times per turn."""
    wave = 2.0 * (values * np.exp(-1j * number * TURN)[:, np.newaxis]).mean(axis=0)
    part = (np.exp(1j * TURN)[:, np.newaxis] * wave).real
    return float(np.linalg.norm(part, axis=-1).max())


def test_curves_and_extremes_are_those_as_built() -> None:
    scene = Scene.parse(FORCES_TEXT)
    result = scene.run()
    table = columns(result)
    wanted = FORCES_BUILT.evaluate(scene.drive_angle, FORCES, load=LOAD)
    for name in FORCES:
        for item, force in enumerate(wanted[name]):
            for i, axis in enumerate("xyz"):
                np.testing.assert_allclose(table[f"{name}_{item}_{axis}_N"], force[:, i], atol=1e-9)
    rows = [row for row in summary(result) if row.unit == "N"]
    assert len(rows) == 8
    for row in rows:
        largest = np.linalg.norm(AT[row.quantity][row.item], axis=-1).max()
        assert row.value == pytest.approx(largest, rel=1e-6)


def test_figures_are_those_of_samples_of_a_whole_turn() -> None:
    found = each(forces(Scene.parse(FORCES_TEXT)))
    drawn = force_figures(DRAWING, LOAD)
    for force, ideal in zip(found, drawn, strict=True):
        values = AT[ideal.output][force.number]
        sizes = np.linalg.norm(values, axis=-1)
        largest = force.largest.value
        assert largest == pytest.approx(sizes.max(), rel=1e-6)
        assert force.at is not None
        assert sizes[round(np.degrees(force.at) * 20) % 7200] == pytest.approx(largest, rel=1e-6)
        assert force.mean == pytest.approx(np.linalg.norm(values.mean(axis=0)), rel=1e-9)
        orders = {1: force.order_1, 2: force.order_2, 4: force.order_4}
        assert orders == pytest.approx({k: order(values, k) for k in orders}, rel=1e-5)
        assert force.order_1 is not None
        assert largest is not None
        assert force.order_1 > 0.01 * largest
        assert ideal.order_1 == 0.0
    # Some forces are largest in the second half of the turn only.
    assert any((force.at or 0.0) > np.pi for force in found)


HEIGHTS = (-260.0, -220.0, -180.0)


def lines() -> list[Driveline]:
    found = []
    for height in HEIGHTS:
        y = f"{height}, 0]"
        text = replaced(
            DRAWN, ("[3000, -220, 0]", f"[3000, {y}"), ("[3250, -210, 0]", f"[3250, {y}")
        )
        found.append(Scene.parse(text).line.with_deviations(*FORCES_BUILT.deviations.T))
    return found


def test_tolerances_of_forces_start_from_the_joints_as_measured() -> None:
    text = f"{FORCES_TEXT}[tolerances]\ndriven_yoke_deg = 0.2\nsamples = 50\n"
    text += 'of = "bearing_force_2_peak"\n'
    found = tolerance_figures(Scene.parse(text))
    assert found is not None
    (figure,) = found.figures
    peak = FORCES_BUILT.evaluate(
        TURN[::20], "bearing_force", load=LOAD, reduce="peak"
    ).bearing_force[2]
    assert figure.nominal.value == pytest.approx(peak, rel=1e-9)
    corners = [
        FORCES_BUILT.with_deviations(
            FORCES_BUILT.deviations[:, 0],
            FORCES_BUILT.deviations[:, 1],
            FORCES_BUILT.deviations[:, 2] + half,
        )
        for half in np.radians(0.2) * np.array(np.meshgrid(*[[-1, 1]] * 3)).reshape(3, -1).T
    ]
    worst = max(
        line.evaluate(TURN[::20], "bearing_force", load=LOAD, reduce="peak").bearing_force[2]
        for line in corners
    )
    assert figure.worst.value == pytest.approx(worst, rel=1e-9)


PATH = example("worn_joints.toml")


BACKLASH_TEXT = PATH.read_text(encoding="utf-8")


BEND, PLAY, STIFF, TORQUE = np.radians(30.0), 0.05 / 40.0, 1e5, 400.0


SINGLE = BACKLASH_TEXT.replace("[30, 12]", "[30]").replace("phases_deg = [0]\n", "")


def curves(axes: Axes) -> list[NDArray[np.float64]]:
    """The curves with a label, ``(2, points)`` each."""
    lines = [line for line in axes.get_lines() if not str(line.get_label()).startswith("_")]
    return [np.array([line.get_xdata(), line.get_ydata()], dtype=float) for line in lines]


def figures(text: str) -> Any:  # noqa: ANN401 - read in many ways
    found = Answer(Scene.parse(text))["backlash"]
    assert found is not None
    return found


def single() -> Backlash:
    return drawn_backlash(Scene.parse(SINGLE))


def test_the_loop_of_one_joint_is_the_closed_form() -> None:
    # 2 asin(sin(d)/rho): largest, by 1/cos(bend), where the driving pin is in the bend plane.
    axes = plot_backlash(single())
    wound = TORQUE / (STIFF * np.cos(BEND))
    for (angle, torque), rho in zip(curves(axes), (np.cos(BEND), 1.0), strict=True):
        half = np.arcsin(np.sin(2.0 * PLAY) / rho)
        want = np.degrees([-half - wound, -half, half, half + wound])
        np.testing.assert_allclose(angle, want, rtol=1e-9)
        np.testing.assert_allclose(torque, [TORQUE, 0.0, 0.0, -TORQUE])
    labels = [line.get_label() for line in axes.get_lines()][2:]
    assert [str(label).split(":")[0] for label in labels] == ["at 0°", "at 90.0°"]
    assert axes.get_ylabel() == "torque at the drive [N m]"
    assert axes.get_xlabel() == "angle of the last shaft, drive held [deg]"
    pyplot.close("all")


def test_the_lash_over_the_turn_is_the_closed_form() -> None:
    loose, wound = curves(plot_lash(single()))
    turn = np.radians(loose[0])
    rho = np.hypot(np.sin(turn), np.cos(BEND) * np.cos(turn))
    lash = 2.0 * np.arcsin(np.sin(2.0 * PLAY) / rho)
    np.testing.assert_allclose(loose[1], np.degrees(lash), rtol=1e-9)
    both = lash + 2.0 * TORQUE / (STIFF * np.cos(BEND))
    np.testing.assert_allclose(wound[1], np.degrees(both), rtol=1e-9)
    axes = pyplot.gca()
    assert axes.get_xlim() == pytest.approx((0.0, 360.0))
    assert axes.get_ylim()[0] == 0.0
    pyplot.close("all")


def test_lash_and_wind_up_are_the_closed_forms() -> None:
    """The lash where the driving pin is in the bend plane and across it; the same wind-up."""
    lash = 2.0 * np.arcsin(np.sin(2.0 * PLAY) / np.array([1.0, np.cos(BEND)]))
    found = figures(SINGLE)
    assert [found.least_lash, found.lash.value] == pytest.approx(lash.tolist(), rel=1e-9)
    wound = TORQUE / (STIFF * np.cos(BEND))
    assert [found.least_wind_up, found.wind_up.value] == pytest.approx([wound, wound], rel=1e-9)
    assert (found.torque, found.end) == (TORQUE, "drive")
    free = figures(SINGLE.replace("[load]\ndrive_torque_Nm = 400\n", ""))
    assert (free.lash.value, free.wind_up) == (found.lash.value, None)


def test_states_have_the_largest_lash() -> None:
    states = Scene.parse(BACKLASH_TEXT + '[states]\n"bends_deg.0" = [5, 35]\nnames = ["a", "b"]\n')
    found = drawn_backlash(states)
    alone = drawn_backlash(Scene.parse(BACKLASH_TEXT.replace("[30, 12]", "[35, 12]")))
    np.testing.assert_allclose(found.lash, alone.lash, rtol=1e-12)
    lash = Answer(states)["backlash"].lash
    flat = figures(BACKLASH_TEXT.replace("[30, 12]", "[5, 12]")).lash.value
    assert lash.state == "b"
    assert lash.each == pytest.approx({"a": flat, "b": alone.lash.max()})


def test_lash_is_judged_in_every_state_and_driveline_of_a_study() -> None:
    largest = float(np.degrees(figures(BACKLASH_TEXT.replace("[30, 12]", "[35, 12]")).lash.value))
    for factor, verdict in ((1.0, "within"), (0.999, "beyond")):
        limits = f"[limits]\nequivalent_bend_deg = 89\nlash_deg = {factor * largest!r}\n"
        for kind in ("states", "study"):
            answer = Answer(
                Scene.parse(f"{BACKLASH_TEXT}{limits}[{kind}]\nbends_deg.0 = [5, 35, 20]\n")
            )
            assert answer["backlash"].lash.value == pytest.approx(np.radians(largest))
            assert answer["backlash"].lash.verdict == verdict
            assert answer.verdict == verdict
    study = Scene.parse(
        f"{BACKLASH_TEXT}[study]\nbends_deg.0 = [5, 35, 20]\ndrive_torque_Nm = [100, 900]\n"
    )
    found = Answer(study)["backlash"]
    assert found.lash.at == {"bends_deg.0": 35.0}
    assert found.wind_up.at == {"bends_deg.0": 35.0, "drive_torque_Nm": 900.0}
    between = Answer(Scene.parse(f"{BACKLASH_TEXT}[limits]\nlash_deg = [0.1, 5]\n"))["backlash"]
    assert between.lash.verdict == "tolerable"


def test_a_lash_that_cannot_be_judged_says_why() -> None:
    text = "[driveline]\nbends_deg = [5, 5]\n[limits]\nlash_deg = 1\n"
    lash = figures(text).lash
    assert (lash.verdict, lash.why) == ("not judged", "[joints] gives no play_mm")


def test_play_is_that_of_joints_as_built() -> None:
    scene = Scene.parse(BACKLASH_TEXT.replace("play_mm", "driving_yoke_deg = [5, 0]\nplay_mm"))
    found = drawn_backlash(scene)
    turn = np.asarray(cardan.Sweep.revolutions(721 / 720, 720))
    line = scene.line.with_deviations([5.0, 0.0], degrees=True)
    np.testing.assert_allclose(found.lash, line.lash(turn, 0.05, 40.0), rtol=1e-12)
    assert np.max(np.abs(found.lash - scene.line.lash(turn, 0.05, 40.0))) > 1e-4


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("arm_mm = 40", "", "play_mm needs arm_mm"),
        ("play_mm = 0.05", "play_mm = [0.05]", "play_mm has length 1; it needs 2, one per joint"),
        ("play_mm = 0.05", "play_mm = -1", "play_mm is -1; it must not be negative"),
        ("play_mm = 0.05", "", "stiffness_Nm_per_rad"),
        ("= 1e5", "= [1e5]", "stiffness_Nm_per_rad has length 1; it needs 2, one per joint"),
    ],
)
def test_wrong_play_is_refused(old: str, new: str, said: str) -> None:
    with pytest.raises(SceneError, match=re.escape(said)):
        Scene.parse(BACKLASH_TEXT.replace(old, new))


def test_what_has_no_loop_is_refused() -> None:
    line = cardan.Driveline.from_bends([[0.1], [0.2]])
    with pytest.raises(ValueError, match="backlash is that of one driveline"):
        backlash(line, 0.05, 40.0, cardan.Load(drive_torque=1.0))
    with pytest.raises(ValueError, match="one torque that is not 0"):
        backlash(line[0], 0.05, 40.0, cardan.Load(speed=1.0))


def test_extremes_are_those_of_a_whole_turn_as_built() -> None:
    turn = np.linspace(0.0, 2.0 * np.pi, 20_001)
    at = BUILT.evaluate(turn, ("angle_error", "speed_ratio", "acceleration_ratio", "tilt_driving"))
    rows: dict[tuple[str, int, str], SummaryRow] = {
        (row.quantity, row.item, row.statistic): row for row in summary(Scene.parse(TEXT).run())
    }
    wanted = {
        ("angle_error", 2, "peak"): np.degrees(np.abs(at.angle_error)).max(),
        ("speed_ratio", 2, "min"): at.speed_ratio.min(),
        ("speed_ratio", 2, "max"): at.speed_ratio.max(),
        ("acceleration_at_steady_drive", 2, "peak"): (
            np.abs(at.acceleration_ratio).max() * SPEED**2
        ),
        ("tilt_driving", 1, "peak"): np.degrees(np.abs(at.tilt_driving[1])).max(),
    }
    for key, value in wanted.items():
        assert rows[key].value == pytest.approx(value, rel=1e-6), key
    place = rows["angle_error", 2, "peak"].at_drive_angle
    assert place is not None
    size = abs(BUILT.evaluate(np.radians(place), "angle_error").angle_error)
    assert np.degrees(size) == pytest.approx(wanted["angle_error", 2, "peak"], rel=1e-6)

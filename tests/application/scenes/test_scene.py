"""Scene files: every form of a driveline, units, defaults, messages; the table of a scene."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

import example_scenes
from cardan import Driveline, Limits, Load, Sweep
from cardan.app.answers.turn.figures import SummaryRow, summary
from cardan.app.answers.turn.text import summary_lines
from cardan.app.scene import Scene
from refusals import cases

EXAMPLES = Path(__file__).parents[3] / "examples"
JOINT = "[driveline]\nbends_deg = [8.5]\n"


def rows(scene: Scene) -> dict[str, SummaryRow]:
    """The table by quantity, shaft or joint, and statistic: ``torque_1_peak``."""
    return {f"{row.quantity}_{row.item}_{row.statistic}": row for row in summary(scene.run())}


# Forms, units and defaults


def same(one: Driveline, other: Driveline) -> None:
    for name in ("bends", "twists", "phases", "directions"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))


POINTS = [[0, 0, 0], [350, -24, 0], [1650, -46, 0], [3150, -180, 45]]
DIRECTIONS = [[2.0, 0.0, 0.0], [1.0, 0.1, 0.0], [1.0, 0.0, 0.1]]


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("bends_deg = [8.5]", Driveline.from_bends([8.5], degrees=True)),
        (
            "bends_deg = [10, 20]\ntwists_deg = [90]\nphases_deg = [30]",
            Driveline.from_bends([10, 20], [90], [30], degrees=True),
        ),
        (f"points_mm = {POINTS}", Driveline.from_points(POINTS)),
        (
            f"points_m = {POINTS}\nphases_deg = [15]",
            Driveline.from_points(POINTS, [15], degrees=True),
        ),
        (
            f"directions = {DIRECTIONS}\nphases_deg = [15]",
            Driveline.from_directions(DIRECTIONS, [15], degrees=True),
        ),
        (
            "slopes_vertical_deg = [0, 5, 1]\nslopes_horizontal_deg = [1, 2, 9]\nphases_deg = [15]",
            Driveline.from_slopes([0, 5, 1], [1, 2, 9], [15], degrees=True),
        ),
        (
            "projected_bends_vertical_deg = [15, -11.5]\n"
            "projected_bends_horizontal_deg = [7, 12]\nphases_deg = [-70]",
            Driveline.from_projected_bends([15, -11.5], [7, 12], [-70], degrees=True),
        ),
    ],
)
def test_every_form_is_its_constructor(text: str, line: Driveline) -> None:
    same(Scene.parse(f"[driveline]\n{text}").line, line)


def test_load_in_si_units() -> None:
    scene = Scene.parse(
        f"{JOINT}[load]\nspeed_rpm = 3000\nacceleration_rad_s2 = 5\ndrive_torque_Nm = 7\n"
        "inertias_kgm2 = [0, 0.02]"
    )
    load = scene.load_case
    assert load is not None
    assert load.end == "drive"
    assert load.inertias is not None
    assert load.speed == pytest.approx(100 * math.pi, rel=1e-15)
    assert (float(load.torque), float(load.acceleration)) == (7.0, 5.0)
    assert load.inertias.tolist() == [0.0, 0.02]
    assert (scene.speed, scene.accelerates) == (float(load.speed), True)

    other = Scene.parse(f"{JOINT}[load]\nspeed_rad_s = 12.5\noutput_torque_Nm = -3")
    assert other.load_case is not None
    assert other.load_case.end == "output"
    assert float(other.load_case.torque) == -3.0
    assert (other.speed, other.accelerates) == (12.5, False)

    assert Scene.parse(JOINT).load_case is None
    assert Scene.parse(JOINT).speed == 0.0


def test_sweep_includes_both_ends_and_keeps_round_degrees() -> None:
    angles = Scene.parse(JOINT).drive_angle_deg
    assert angles.tolist() == [i / 2 for i in range(721)]
    angles = Scene.parse(
        f"{JOINT}[sweep]\nturns = 1.5\nsamples_per_turn = 4\nstart_deg = -90"
    ).drive_angle_deg
    assert angles.tolist() == [-90, 0, 90, 180, 270, 360, 450]
    tiny = f"{JOINT}[sweep]\nturns = 0.001\nsamples_per_turn = 1"
    assert Scene.parse(tiny).drive_angle_deg.tolist() == pytest.approx([0, 0.36])


@pytest.mark.parametrize(
    ("keys", "curves", "figures"),
    [
        ("", Sweep.revolutions(721 / 720, 720), Sweep.revolutions(1, 720)),
        (
            "turns = 3\nsamples_per_turn = 7",
            Sweep.revolutions(22 / 7, 7),
            Sweep.revolutions(3, 7),
        ),
        # Less than whole turns count both ends.
        ("turns = 0.7", Sweep.revolutions(505 / 720, 720), Sweep.revolutions(505 / 720, 720)),
        ("turns = 1.2\nsamples_per_turn = 1", Sweep(0, math.radians(432), 2), None),
        (
            "start_deg = -90\nsamples_per_turn = 8",
            Sweep(-np.pi / 2, 1.5 * np.pi, 9),
            Sweep(-np.pi / 2, 1.25 * np.pi, 8),
        ),
        (
            "start_deg = 1e12\nsamples_per_turn = 4",
            Sweep(math.radians(1e12), math.radians(1e12 + 360), 5),
            Sweep(math.radians(1e12), math.radians(1e12 + 270), 4),
        ),
        (
            "turns = 1e-12\nsamples_per_turn = 1000000000000000",
            Sweep(0, math.radians(360e-12), 1001),
            None,
        ),
    ],
)
def test_uniform_angles_are_a_sweep(keys: str, curves: Sweep, figures: Sweep | None) -> None:
    """So whole turns are computed once, and curves and figures are exactly the library's."""
    scene = Scene.parse(f"{JOINT}[sweep]\n{keys}\n[output]\nreduce = 'rms'")
    assert scene.angle == curves
    assert scene.study
    assert scene.study.angle == (curves if figures is None else figures)
    assert len(scene.drive_angle_deg) == len(scene.drive_angle) == len(curves)
    np.testing.assert_allclose(
        scene.drive_angle, np.radians(scene.drive_angle_deg), rtol=1e-15, atol=1e-15
    )


def test_explain_tells_what_runs_over_the_sweep() -> None:
    scene = Scene.parse(f"{JOINT}[sweep]\nturns = 5\n[output]\nreduce = 'rms'")
    curves, study = scene.explain().split("\n\n")
    assert curves == scene.plan().explain(Sweep.revolutions(3601 / 720, 720))
    for text in (curves, study):
        assert "array of angles: a sweep needs none" in text
        assert "samples after the first 360 of a row: results repeat and are copied" in text
    assert "rms over 3600 drive angles" in study
    part = Scene.parse(f"{JOINT}[sweep]\nturns = 0.3\n").explain()
    assert "array of angles: a sweep needs none" in part
    assert "results repeat" not in part


MOTION = ("angle_error", "speed_ratio", "acceleration_ratio")


@pytest.mark.parametrize(
    ("text", "quantities"),
    [
        ("", MOTION),
        # A speed alone transmits nothing.
        ("[load]\nspeed_rpm = 100", MOTION),
        ("[load]\ndrive_torque_Nm = 1", (*MOTION, "torque", "moment")),
        ("[load]\nspeed_rpm = 0\ninertias_kgm2 = [0, 1]", (*MOTION, "torque", "moment")),
        ('[output]\nquantities = ["angle", "speed_ratio"]', ("angle", "speed_ratio")),
        ('[output]\nquantities = ["jerk_ratio"]', ("jerk_ratio",)),
    ],
)
def test_quantities(text: str, quantities: tuple[str, ...]) -> None:
    result = Scene.parse(JOINT + text).run()
    assert result.scene.quantities == quantities
    assert tuple(result.values) == quantities


def test_limits() -> None:
    assert Scene.parse(JOINT).limits == Limits()
    assert Scene.parse(section("limits") + "preset = 'truck'").limits == Limits("truck")
    own = Scene.parse(
        section("limits")
        + "preset = 'industrial'\nequivalent_bend_deg = 4\nbend_difference_deg = [2, 6]\n"
        "torsional_excitation_rad_s2 = 250\ninertia_excitation_rad_s2 = [800, 900]\n"
        "source = 'works standard 12'"
    )
    assert own.limits == Limits(
        "industrial",
        equivalent_bend_deg=4,
        bend_difference_deg=(2, 6),
        torsional_excitation_rad_s2=250,
        inertia_excitation_rad_s2=(800, 900),
        source="works standard 12",
    )


# Messages


def section(name: str) -> str:
    return f"{JOINT}[{name}]\n"


DRIVELINE = "[driveline]\n"

ERRORS = """
bend_deg = [1]
    line 2: [driveline] unknown key 'bend_deg'; did you mean 'bends_deg'?
bends_deg = [8.5]
speed_rpm = 1
    line 3: [driveline] unknown key 'speed_rpm'; it belongs in [load]

    line 1: [driveline] no shafts or joints; give one of: bends_deg; points_m; points_mm;
    directions; slopes_vertical_deg with slopes_horizontal_deg; projected_bends_vertical_deg with
    projected_bends_horizontal_deg; readings_deg; double_joint_deg with joint_distance_mm with
    synchronous_deg
bends_deg = [8.5]
points_mm = [[0, 0, 0]]
directions = [[1, 0, 0]]
    line 2: [driveline] bends_deg and points_mm are both given; describe the driveline in one way
twists_deg = [1]
points_m = [[0, 0, 0], [1, 0, 0], [2, 0, 0]]
    line 2: [driveline] twists_deg does not go with points_m, which says it already
bends_deg = '8'
    line 2: [driveline] bends_deg is '8'; it must be a list of numbers
bends_deg = true
    line 2: [driveline] bends_deg is true; it must be a list of numbers
bends_deg = [1, 'a']
    line 2: [driveline] bends_deg[1] is 'a'; it must be a number
bends_deg = [true]
    line 2: [driveline] bends_deg[0] is true; it must be a number
bends_deg = [nan]
    line 2: [driveline] bends_deg[0] is nan; it must be finite
bends_deg = [8, 95]
    line 2: [driveline] bends_deg[1] is 95 deg; a bend must lie in [0, 90) deg
bends_deg = [-1]
    line 2: [driveline] bends_deg[0] is -1 deg; a bend must lie in [0, 90) deg
bends_deg = []
    line 2: [driveline] bends_deg has length 0; one joint needs 1
bends_deg = [8.5]
phases_deg = [1]
    line 3: [driveline] phases_deg has length 1; it needs 0, one per shaft between two joints
points_mm = [[0, 0, 0], [1, 0, 0]]
    line 2: [driveline] points_mm has length 2; one joint needs 3
points_mm = [[0, 0, 0], [1, 0, 0], [1, 0, 0]]
    line 2: [driveline] points_mm[2] is (1, 0, 0) after (1, 0, 0); two successive points must
    differ by a finite distance
points_m = [[0, 0, 0], [1, 0], [1, 0, 0]]
    line 2: [driveline] points_m[1] is [1, 0]; it must be a list of three numbers
points_m = [[0, 0, 0], [1, 0, '0']]
    line 2: [driveline] points_m[1][2] is '0'; it must be a number
directions = [[0, 0, 0], [1, 0, 0]]
    line 2: [driveline] directions[0] is (0, 0, 0); a direction must be finite and not zero
slopes_vertical_deg = [0, 1]
slopes_horizontal_deg = [0]
    line 3: [driveline] slopes_horizontal_deg has length 1; it needs 2, as many as
    slopes_vertical_deg
slopes_vertical_deg = [0, 90]
slopes_horizontal_deg = [0, 0]
    line 2: [driveline] slopes_vertical_deg[1] is 90; it must lie between -90 and 90
slopes_vertical_deg = [0, 0]
slopes_horizontal_deg = [-90, 0]
    line 3: [driveline] slopes_horizontal_deg[0] is -90; it must lie between -90 and 90
slopes_vertical_deg = [0, 'a']
slopes_horizontal_deg = [0, 0]
    line 2: [driveline] slopes_vertical_deg[1] is 'a'; it must be a number
points_m = [[0, 0, 0], 1]
    line 2: [driveline] points_m[1] is 1; it must be a list of three numbers
points_m = 1
    line 2: [driveline] points_m is 1; it must be a list of vectors [x, y, z]
slopes_vertical_deg = [50, -50]
slopes_horizontal_deg = [0, 0]
    line 2: [driveline] slopes_vertical_deg and slopes_horizontal_deg give joint 0 a bend of 100
    deg between shafts 0 and 1; a bend must lie in [0, 90) deg
projected_bends_vertical_deg = [1]
projected_bends_horizontal_deg = [1]
    line 2: [driveline] projected_bends_vertical_deg has length 1; it needs 2, one per joint
[load]
speed_rpm = 1
speed_rad_s = 1
    line 4: [load] speed_rpm and speed_rad_s are both given; give one of them
[load]
drive_torque_Nm = 1
output_torque_Nm = 1
    line 4: [load] drive_torque_Nm and output_torque_Nm are both given; give one of them
[load]
inertias_kgm2 = [1]
    line 4: [load] inertias_kgm2 has length 1; it needs 2, one per shaft
[load]
inertias_kgm2 = [0, 1]
    line 4: [load] inertias_kgm2 are given without a speed or an acceleration; inertias need one
    of them
[load]
inertias_kgm2 = [0, -1]
    line 4: [load] inertias_kgm2[1] is -1; an inertia must not be negative
bends_deg = 'xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx'
    line 2: [driveline] bends_deg is 'xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx';
    it must be a list of numbers
bends_deg = 'xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx'
    line 2: [driveline] bends_deg is 'xxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxxx...;
    it must be a list of numbers
[output]
quantities = [3]
    line 4: [output] quantities[0] is 3; it must be text in quotes
[output]
curves = 3
    line 4: [output] curves is 3; it must be text in quotes
[output]
reduce = 3
    line 4: [output] reduce is 3; it must be a list of names
[sweep]
turns = 'a'
    line 4: [sweep] turns is 'a'; it must be a number
bends_deg = [1e41]
    line 2: [driveline] bends_deg[0] is 1e+41; it must lie within ±1e+40
[sweep]
turns = 0
    line 4: [sweep] turns is 0; it must be positive
[limits]
    line 3: [limits] is empty; give at least one key
[limits]
preset = 'steering'
    line 4: [limits] preset is 'steering'; limits with a known source exist for 'truck',
    'industrial', 'spicer', 'tremec', 'gm', 'meritor', 'parker', 'john_deere', 'camaro', 'hombre'
    and 'drivetrain'; for other machines give your own figures: equivalent_bend_deg,
    bend_difference_deg, torsional_excitation_rad_s2, inertia_excitation_rad_s2
[limits]
equivalent_bend_deg = 90
    line 4: [limits] equivalent_bend_deg is 90 deg; it must lie between 0 and 90 deg
[limits]
torsional_excitation_rad_s2 = [500, 300]
    line 4: [limits] torsional_excitation_rad_s2 is [500, 300]; it must have a maximum that is not
    below the limit
[limits]
inertia_excitation_rad_s2 = [1, 2, 3]
    line 4: [limits] inertia_excitation_rad_s2 is [1, 2, 3]; it must be a list of two numbers,
    limit and maximum
[limits]
torsional_excitation_rad_s2 = [0, 1]
    line 4: [limits] torsional_excitation_rad_s2[0] is 0; it must be positive
[limits]
source = "\\u001b[2J"
    line 4: [limits] source is '\\x1b[2J'; it must have printable characters only
[limits]
equivalent_bend = 4
    line 4: [limits] unknown key 'equivalent_bend'; the name includes the unit:
    equivalent_bend_deg holds degrees
[study]
equivalent_bend_deg = [3, 4]
    line 4: [study] unknown key 'equivalent_bend_deg'; [study] varies numbers of [driveline],
    [load] and [[bearing]]
[sweep]
samples_per_turn = 1.5
    line 4: [sweep] samples_per_turn is 1.5; it must be a whole number of at least 1
[sweep]
turns = 2
samples_per_turn = 1000000000
    line 5: [sweep] samples_per_turn is 1000000000 over turns = 2; a sweep takes at most 10000000
    steps
[output]
curves = 'a.ods'
    line 4: [output] curves is 'a.ods'; it must end in .csv or .npz or .parquet or .xlsx
[output]
picture = 'a.csv'
    line 4: [output] picture is 'a.csv'; it must end in .svg or .png or .pdf
[output]
curves = '../a.csv'
    line 4: [output] curves is '../a.csv'; it must be a file name without a folder
[output]
curves = 'b\\a.csv'
    line 4: [output] curves is 'b\\\\a.csv'; it must be a file name without a folder
[output]
curves = "a\\nb.csv"
    line 4: [output] curves is 'a\\nb.csv'; it must have printable characters only
[output]
quantities = ['torque']
    line 4: [output] quantities[0] is 'torque'; it needs a section [load]
[output]
quantities = ['speed']
    line 4: [output] quantities[0] is 'speed'; did you mean 'speed_ratio'?
[output]
quantities = []
    line 4: [output] quantities is []; name at least one, or leave it out
[output]
tolerance = 1.0
    line 4: [output] tolerance is 1.0; it must lie in [0, 1)
[output]
tolerance = -1e-9
    line 4: [output] tolerance is -1e-09; it must lie in [0, 1)
[output]
tolerance = 'fine'
    line 4: [output] tolerance is 'fine'; it must be a number
[output]
joints = [true]
    line 4: [output] joints[0] is true; it must be a whole number, counted from 0
[output]
joints = 0
    line 4: [output] joints is 0; it must be a list of whole numbers
[output]
dtype = 'float'
    line 4: [output] dtype is 'float'; did you mean 'float64'?
[output]
quantities = ['angle', 'angle']
    line 4: [output] quantities[1] is 'angle' again; name each once
"""


@pytest.mark.parametrize(("text", "message"), cases(ERRORS))
def test_messages(text: str, message: str) -> None:
    """Of keys of [driveline], or of another section below a joint."""
    with pytest.raises(ValueError, match=r"^shaft\.toml") as caught:
        Scene.parse((JOINT if text.startswith("[") else DRIVELINE) + text, "shaft.toml")
    assert str(caught.value) == f"shaft.toml, {message}"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", ": section [driveline] is missing; it describes the joints and shafts"),
        ("x =\n", ": not TOML: Invalid value (at line 1, column 4)"),
        ("a = " + "[" * 100_000, ": not TOML: nested too deeply"),
        ("title = 3\n" + JOINT, ", line 1: title is 3; it must be text in quotes"),
        ("titel = 'a'\n" + JOINT, ", line 1: unknown key 'titel'; did you mean 'title'?"),
        ("[drivline]\n", ", line 1: unknown section 'drivline'; did you mean 'driveline'?"),
        ("driveline = 3", ", line 1: driveline is 3; it must be a section [driveline]"),
        ("bends_deg = [1]", ", line 1: unknown key 'bends_deg'; it belongs in [driveline]"),
        (
            '"a\\nb" = 1',
            r": unknown key 'a\nb'; known are title, units, driveline, bearing, load, sweep, "
            "angles, limits, tolerances, slip, steering, joints, offsets, life, tubes, torsion, "
            "lateral, ball_joint, study, states, wind_up, optimise, output",
        ),
        (
            DRIVELINE + f"bends_deg = [1{'0' * 400}]",
            f", line 2: [driveline] bends_deg[0] is 1{'0' * 56}...; it must be finite",
        ),
        (
            DRIVELINE + f"bends_deg = [{'1, ' * 300}]",
            ", line 2: [driveline] bends_deg has 300 joints; a driveline has at most 256",
        ),
        (
            section("sweep") + f"samples_per_turn = 0x1{'0' * 5000}",
            ", line 4: [sweep] samples_per_turn is a number too large over turns = 1; "
            "a sweep takes at most 10000000 steps",
        ),
    ],
)
def test_messages_about_whole_scenes(text: str, message: str) -> None:
    with pytest.raises(ValueError, match=r"^shaft\.toml") as caught:
        Scene.parse(text, "shaft.toml")
    assert str(caught.value) == f"shaft.toml{message}"


def test_axes_of_vectors() -> None:
    text = """[driveline]
bends_deg = [20, 30]
[load]
drive_torque_Nm = 5.0
[output]
quantities = ["moment"]
axes = "shaft"
"""
    found = Scene.parse(text).run().values["moment"]
    line, load = Driveline.from_bends([20, 30], degrees=True), Load(drive_torque=5.0)
    wanted = line.evaluate(Scene.parse(text).angle, "moment", load=load, axes="shaft").moment
    assert np.array_equal(found, wanted)
    forces = text.replace('["moment"]', '["moment", "joint_force"]')
    forces = forces.replace("bends_deg = [20, 30]", "bends_deg = [20]\nlengths_mm = [300, 900]")
    for shaft, position in ((0, 100), (0, 200), (1, 600)):
        forces += f"[[bearing]]\nshaft = {shaft}\nposition_mm = {position}\n"
    scene = Scene.parse(forces)
    joint = Driveline.from_bends([20], degrees=True)
    joint = joint.with_bearings([(0, 0.1), (0, 0.2), (1, 0.6)], [0.3, 0.9])
    space, turning = (
        joint.evaluate(scene.angle, "joint_force", load=load, axes=axes).joint_force
        for axes in ("space", "shaft")
    )
    assert np.array_equal(scene.run().values["joint_force"], turning)
    assert np.max(np.abs(turning - space)) > 1.0
    with pytest.raises(ValueError, match=r"\[output\] axes is 'shafts'; did you mean 'shaft'"):
        Scene.parse(text.replace('"shaft"', '"shafts"'))


def test_tolerances_of_a_scene() -> None:
    for tolerance in (0, 0.5, 1e-9):
        scene = Scene.parse(f"{section('output')}tolerance = {tolerance}", "shaft.toml")
        want = scene.line.plan(scene.quantities, tolerance=tolerance)
        assert scene.explain() == want.explain(Sweep.revolutions(721 / 720, 720))


# Files


def test_byte_order_mark_and_line_ends(tmp_path: Path) -> None:
    path = tmp_path / "shaft.toml"
    path.write_bytes(b"\xef\xbb\xbf" + f'title = "Föppl"\n{JOINT}'.replace("\n", "\r\n").encode())
    assert Scene.load(str(path)).title == "Föppl"


def test_not_utf8(tmp_path: Path) -> None:
    path = tmp_path / "shaft.toml"
    path.write_bytes(b'title = "F\xf6ppl"\n')
    with pytest.raises(ValueError, match="not UTF-8") as caught:
        Scene.load(path)
    assert str(caught.value) == f"{path}: not UTF-8 text at byte 10"


# Recorded angles


def recording(folder: Path, suffix: str) -> None:
    table = {"turn": np.array([0.0, 0.5, 2.0]), "front": np.array([5.0, 6.0, 7.0])}
    path = folder / f"run{suffix}"
    if suffix == ".npz":
        np.savez(path, **table)  # type: ignore[arg-type]
    elif suffix == ".parquet":
        parquet = pytest.importorskip("pyarrow.parquet")
        parquet.write_table(pytest.importorskip("pyarrow").table(table), path)
    else:
        rows = zip(*table.values(), strict=True)
        lines = [",".join(table), *(",".join(map(repr, map(float, row))) for row in rows)]
        path.write_text("\n".join(lines))


@pytest.mark.parametrize("suffix", [".csv", ".npz", ".parquet"])
def test_recorded_angles(tmp_path: Path, suffix: str) -> None:
    recording(tmp_path, suffix)
    path = tmp_path / "scene.toml"
    for unit, angle in (("rad", np.array([0.0, 0.5, 2.0])), ("deg", np.radians([0.0, 0.5, 2.0]))):
        angles = f"[angles]\nfile = 'run{suffix}'\nangle_column_{unit} = 'turn'\n"
        path.write_text(JOINT + angles)
        # The file is beside the scene, wherever the reader stands.
        scene = Scene.load(path)
        np.testing.assert_array_equal(scene.drive_angle, angle)
        np.testing.assert_allclose(scene.drive_angle_deg, np.degrees(angle))
        want = Driveline.from_bends([8.5], degrees=True).evaluate(angle, "angle_error")
        np.testing.assert_array_equal(scene.run().values.angle_error, want.angle_error)

        path.write_text(f"{angles}bend_columns_deg = ['front', 'front2']")
        with pytest.raises(ValueError, match=r"line 1: \[angles\] .*no column 'front2'; did you"):
            Scene.load(path)
        path.write_text(f"{angles}bend_columns_deg = ['front']")
        scene = Scene.load(path)
        line = Driveline.from_bends([[5], [6], [7]], degrees=True)
        same(scene.line, line)
        want = line.evaluate(angle, "angle_error")
        np.testing.assert_array_equal(scene.run().values.angle_error, want.angle_error)
        table = rows(scene)
        assert table["bend_0_min"].value == pytest.approx(5)
        assert table["bend_0_max"].value == pytest.approx(7)
        errors = np.degrees(want.angle_error)
        assert table["angle_error_1_min"].value == pytest.approx(np.min(errors))
        assert table["angle_error_1_max"].value == pytest.approx(np.max(errors))
        assert {row.of for row in table.values()} == {"samples"}


def test_recorded_bends_with_twists_and_loads(tmp_path: Path) -> None:
    recording(tmp_path, ".csv")
    text = (
        "[angles]\nfile = 'run.csv'\nangle_column_rad = 'turn'\n"
        "bend_columns_deg = ['front', 'turn']\n[driveline]\ntwists_deg = [180]\n"
        "phases_deg = [10]\n[load]\noutput_torque_Nm = 5\n[output]\nquantities = ['moment']"
    )
    scene = Scene.parse(text, folder=tmp_path)
    line = Driveline.from_bends(np.array([[5, 0], [6, 0.5], [7, 2]]), 180, 10, degrees=True)
    same(scene.line, line)
    want = line.evaluate([0, 0.5, 2], "moment", load=scene.load_case).moment
    np.testing.assert_array_equal(scene.run().values.moment, want)


COLUMN = "file = 'run.csv'\nangle_column_rad = 'turn'\n"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            JOINT + "[angles]\nfile = 'run.csv'",
            "line 3: [angles] angle_column_deg is missing; or give angle_column_rad",
        ),
        (JOINT + "[angles]\nangle_column_deg = 'a'", "line 3: [angles] file is missing"),
        (
            JOINT + "[angles]\nangle_column = 'a'",
            "line 4: [angles] unknown key 'angle_column'; the name includes the unit: "
            "angle_column_deg holds degrees, angle_column_rad holds radians",
        ),
        (
            JOINT + f"[angles]\n{COLUMN}angle_column_deg = 'turn'",
            "line 6: [angles] angle_column_deg and angle_column_rad are both given",
        ),
        (
            JOINT + f"[angles]\n{COLUMN}[sweep]\nturns = 1",
            "sections [sweep] and [angles] are both given; give one of them",
        ),
        (
            JOINT + "[angles]\nfile = 'run.xls'\nangle_column_deg = 'turn'",
            "line 4: [angles] file is 'run.xls'; it must end in .csv or .npz or .parquet",
        ),
        (
            JOINT + '[angles]\nfile = "run\\u0000.csv"\nangle_column_deg = "turn"',
            r"line 4: [angles] file is 'run\x00.csv'; it must have printable characters only",
        ),
        (
            JOINT + "[angles]\nfile = 3\nangle_column_deg = 'turn'",
            "line 4: [angles] file is 3; it must be text in quotes",
        ),
        (
            JOINT + "[angles]\nfile = 'run.csv'\nangle_column_deg = 'trun'",
            "line 3: [angles] {run}: no column 'trun'; did you mean 'turn'?; "
            "the columns are turn, front",
        ),
        (
            JOINT + f"[angles]\n{COLUMN}bend_columns_deg = ['front']",
            "line 2: [driveline] bends_deg does not go with recorded bends",
        ),
        (
            f"[angles]\n{COLUMN}bend_columns_deg = ['front']\n[driveline]\ntwists_deg = [1]",
            "line 6: [driveline] twists_deg has length 1; it needs 0",
        ),
        (
            f"[angles]\n{COLUMN}bend_columns_deg = ['front']\n[study]\nphases_deg = [1]",
            "line 6: [study] phases_deg does not go with recorded bends",
        ),
        (
            f"[angles]\n{COLUMN}bend_columns_deg = ['front']\n[output]\nclosed_forms = ['k']",
            "line 6: [output] closed_forms do not go with recorded bends",
        ),
        (
            f"[angles]\n{COLUMN}bend_columns_deg = 'front'",
            "line 4: [angles] bend_columns_deg is 'front'; it must be a list of texts",
        ),
    ],
)
def test_messages_about_recordings(tmp_path: Path, text: str, message: str) -> None:
    recording(tmp_path, ".csv")
    with pytest.raises(ValueError, match=r"^scene") as caught:
        Scene.parse(text, folder=tmp_path)
    separator = ", " if message.startswith("line") else ": "
    wanted = f"scene{separator}{message.format(run=tmp_path / 'run.csv')}"
    assert str(caught.value).startswith(wanted)


def test_recorded_bends_in_radians(tmp_path: Path) -> None:
    (tmp_path / "run.csv").write_text("turn,front,rear\n0,0.1,0.2\n1,0.3,1.5\n2,0,0.5\n")
    text = f"[angles]\n{COLUMN}bend_columns_rad = ['front', 'rear']"
    scene = Scene.parse(text, folder=tmp_path)
    line = Driveline.from_bends([[0.1, 0.2], [0.3, 1.5], [0, 0.5]])
    np.testing.assert_allclose(scene.line.bends, line.bends, rtol=4e-16)
    both = text + "\nbend_columns_deg = ['front', 'rear']"
    with pytest.raises(ValueError, match="bend_columns_deg and bend_columns_rad are both given"):
        Scene.parse(both, folder=tmp_path)
    (tmp_path / "run.csv").write_text("turn,front,rear\n0,0.1,0.2\n1,0.3,1.58\n")
    with pytest.raises(ValueError, match=r"'rear' is 1.58; a bend must lie in \[0, pi/2\) rad$"):
        Scene.parse(text, folder=tmp_path)


# Shafts and joints


def test_shafts_and_joints_as_the_scene_names_them() -> None:
    text = (
        "[driveline]\nbends_deg = [10, 20]\n[load]\noutput_torque_Nm = 3\nspeed_rpm = 6\n[output]\n"
        "quantities = ['speed_ratio', 'torque', 'moment']\n"
    )
    scene = Scene.parse(f"{text}shafts = [2, 0]\njoints = [1]")
    result = scene.run()
    want = scene.line.evaluate(
        scene.angle, scene.quantities, shafts=[2, 0], joints=[1], load=scene.load_case
    )
    for name, values in want.items():
        np.testing.assert_array_equal(result.values[name], values)
    curves = [(output.name, item, values.shape) for output, item, values in result.curves()]
    assert curves == [
        ("speed_ratio", 2, (721,)),
        ("speed_ratio", 0, (721,)),
        ("torque", 2, (721,)),
        ("torque", 0, (721,)),
        ("moment", 1, (721, 3)),
    ]
    table = rows(scene)
    bends = [float(np.degrees(scene.line.equivalent(shaft).bend)) for shaft in (2, 0)]
    found = [table[f"equivalent_bend_{shaft}_value"].value for shaft in (2, 0)]
    assert found == pytest.approx(bends)
    lines = dict(summary_lines(table.values()))
    assert lines["equivalent bend, shafts 2 and 0"] == f"{bends[0]:.2f}°, 0°"
    assert "torque_0_peak" in table
    assert "moment_1_peak" in table
    assert "moment_0_peak" not in table
    # The ranges of several shafts would not be read; programs get them.
    assert not any("speed ratio" in label for label in lines)
    assert table["speed_ratio_2_max"].value > table["speed_ratio_2_min"].value
    one = rows(Scene.parse(f"{text}shafts = [1]"))
    assert one["equivalent_bend_1_value"].value == pytest.approx(10)
    assert one["speed_1_max"].value == pytest.approx(6 / math.cos(math.radians(10)))
    three = rows(Scene.parse(f"{text}shafts = [0, 1, 2]"))
    assert "equivalent bend, shafts 0 to 2" in dict(summary_lines(three.values()))


# Units and lines in messages


@pytest.mark.parametrize(
    ("section", "key", "held"),
    [
        ("driveline", "bends_rad", "bends_deg holds degrees"),
        ("driveline", "bends", "bends_deg holds degrees"),
        ("driveline", "phases_degrees", "phases_deg holds degrees"),
        ("driveline", "points_cm", "points_m holds metres, points_mm holds millimetres"),
        ("load", "speed_hz", "speed_rpm holds revolutions per minute, speed_rad_s holds rad/s"),
        ("load", "drive_torque_kNm", "drive_torque_Nm holds N m"),
        ("load", "inertias_gm2", "inertias_kgm2 holds kg m²"),
        ("load", "acceleration_rpm_s", "acceleration_rad_s2 holds rad/s²"),
        ("sweep", "start_rad", "start_deg holds degrees"),
        ("study", "phases_rad", "phases_deg holds degrees"),
    ],
)
def test_wrong_units(section: str, key: str, held: str) -> None:
    head = "[driveline]\n" if section == "driveline" else f"{JOINT}[{section}]\n"
    with pytest.raises(ValueError, match="unit") as caught:
        Scene.parse(f"{head}{key} = [1]")
    place = f"scene, line {head.count(chr(10)) + 1}: [{section}]"
    wanted = f"{place} unknown key '{key}'; the name includes the unit: {held}"
    assert str(caught.value) == wanted


@pytest.mark.parametrize(
    ("text", "place"),
    [
        ("# [driveline]\n\n[driveline]\n# bends_deg = [1]\nbends_deg = [95]", "scene, line 5:"),
        ("driveline.bends_deg = [95]", "scene, line 1:"),
        ("driveline = {bends_deg = [95]}", "scene, line 1:"),
        ("  [ driveline ]  # here\n  bends_deg   =[\n1,\n95]", "scene, line 2:"),
        ("title = '[driveline]'\n[driveline]\nbends_deg = [95]", "scene, line 3:"),
        ('title = """\nbends_deg = 3\n"""\n[driveline]\nbends_deg = [95]', "scene:"),
        ("title = '''a'''\n[driveline]\nbends_deg = [95]", "scene:"),
        ("[load]\nspeed_rpm = 1\n[driveline]\nbends_deg = [95]", "scene, line 4:"),
        # The key in quotes is not looked for; its section is certain.
        ('[driveline]\n"bends_deg" = [95]', "scene, line 2:"),
        ('["driveline"]\nbends_deg = [95]', "scene:"),
        (f"{JOINT}[study]\nbends_deg.0 = 3", "scene, line 4:"),
        (f"{JOINT}[study]\nphases_deg.0 = [1]\nbends_deg.0 = {{from = 'a'}}", "scene, line 5:"),
        (f"{JOINT}[study.bends_deg.0]\nfrom = 1\nto = 2\nsteps = 0", "scene, line 6:"),
        (f"{JOINT}[study.bends_deg]\n0 = [1]\n1 = 3", "scene, line 5:"),
        (f"{JOINT}[study]\nbends_deg.0.to = 1\nbends_deg.0.from = 2", "scene:"),
    ],
)
def test_lines_of_keys(text: str, place: str) -> None:
    with pytest.raises(ValueError, match="bends_deg") as caught:
        Scene.parse(text)
    assert str(caught.value).split(" [")[0] == place


def test_validate_finds_all_at_once(tmp_path: Path) -> None:
    path = tmp_path / "a.toml"
    path.write_text(
        "titel = 'a'\n[driveline]\nbends_deg = 'a'\n[laod]\nspeed_rpm = 1\n"
        "[sweep]\nturns = -1\nstart_deg = 'b'\n[angles]\n"
    )
    assert Scene.validate(path) == [
        f"{path}, line 1: unknown key 'titel'; did you mean 'title'?",
        f"{path}, line 4: unknown section 'laod'; did you mean 'load'?",
        f"{path}, line 3: [driveline] bends_deg is 'a'; it must be a list of numbers",
        f"{path}, line 7: [sweep] turns is -1; it must be positive",
        f"{path}, line 8: [sweep] start_deg is 'b'; it must be a number",
        f"{path}, line 9: [angles] file is missing",
        f"{path}, line 9: [angles] angle_column_deg is missing; or give angle_column_rad, "
        "speed_column_rpm or speed_column_rad_s",
    ]
    path.write_text("[driveline]\nbends_deg = [95]\n")
    assert Scene.validate(path) == [
        f"{path}, line 2: [driveline] bends_deg[0] is 95 deg; a bend must lie in [0, 90) deg"
    ]
    path.write_text("[driveline")
    assert len(Scene.validate(path)) == 1
    path.write_bytes(b"\xff")
    assert Scene.validate(path) == [f"{path}: not UTF-8 text at byte 0"]
    for example in example_scenes.EXAMPLES:
        assert Scene.validate(example) == []
    with pytest.raises(FileNotFoundError):
        Scene.validate(tmp_path / "missing.toml")


# Documentation

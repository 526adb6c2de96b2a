"""Section [optimise] and the command: what they read, say, draw, write and refuse."""

from __future__ import annotations

import json
import re
import tomllib
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import pytest
from click.testing import Result
from numpy.typing import NDArray

import scripts
from cardan.app.answers.optimise.figures import by_state, change_lines, optimised
from cardan.app.answers.schema import answers_schema
from cardan.app.plots import plot_over_variable
from cardan.app.report import write_report
from cardan.app.scene import Scene
from cardan.app.scene.language.edit import map_of, with_values
from cardan.optimisation import parameters_of
from cardan.optimisation.problem import Problem
from example_scenes import EXAMPLES, example
from pages import near

ROOT = Path(__file__).parents[3]
EXAMPLE = (ROOT / "examples" / "truck_heights.toml").read_text("utf-8")
TRUCK = """\
[driveline]
points_mm = [
    [0, 0, 0],
    [350, -24, 0],
    [1650, -46, 0], # behind the centre bearing
    [3150, -180, 45],
    [3450, -196, 45],
]
[load]
speed_rpm = 1500
[states]
points_mm.3-4.z = [35, 45, 55]
"""
Z_SHAFT = "[driveline]\nbends_deg = [10, 9]\ntwists_deg = 180\nphases_deg = [8] # as found\n"
VARY = '[optimise]\nvary = {"points_mm.2.y" = [-40, 40], "phases_deg.0" = "free"}\n'


def run(folder: Path, text: str, *options: str) -> Result:
    (folder / "a.toml").write_text(text, encoding="utf-8")
    return scripts.run("optimise", folder / "a.toml", *options)


def largest_bend(scene: Scene) -> float:
    return float(np.degrees(np.max(scene.drivelines().equivalent().bend)))


def test_the_scene_with_the_values_found_is_written_and_checked(tmp_path: Path) -> None:
    result = run(tmp_path, EXAMPLE)
    assert result.exit_code == 0, result.output
    assert (tmp_path / "a.toml").read_text("utf-8") == EXAMPLE
    written = tmp_path / "a.optimised.toml"
    assert result.output.rstrip().endswith(f"wrote {written}")
    # The values are changed in place, and nothing else.
    lines = zip(EXAMPLE.splitlines(), written.read_text("utf-8").splitlines(), strict=True)
    changed = [(one, other) for one, other in lines if one != other]
    assert [re.sub(r"-?\d+(\.\d+)?", "0", one) for one, _ in changed] == [
        re.sub(r"-?\d+(\.\d+)?", "0", other) for _, other in changed
    ]
    assert ["joint 1, behind" in changed[0][0], "phases_deg" in changed[1][0]] == [True, True]
    before, after = largest_bend(Scene.parse(EXAMPLE)), largest_bend(Scene.load(written))
    said = re.search(r"of 9 states: (\S+)° before, (\S+)° after", result.output)
    assert said
    assert [before, after] == [near(end) for end in said.groups()]
    assert after < 0.5 * before
    check = scripts.run("check", written)
    assert check.exit_code == 0, check.output


def test_one_sentence_for_each_variable() -> None:
    text = EXAMPLE.replace("[-40, 40]", "[-12.5, 40]").replace("keep", "# keep")
    found = optimised(Scene.parse(text))
    assert found
    lines = [*change_lines(found)]
    assert lines[0] == "move joint 1 by 12.5 mm along -y (points_mm.2.y: -46 → -58.5 mm)"
    assert re.match(r"turn the output-side yoke of shaft 1 by 1 tooth counter-clockwise", lines[1])
    assert len(lines) == 3


@pytest.mark.parametrize(
    ("vary", "words"),
    [
        ('"bends_deg.1" = [-2, 2]', r"increase the bend of joint 1 by 1° "),
        ('"bends_deg.0" = [-2, 2]', r"reduce the bend of joint 0 by 1° "),
        ('"twists_deg.0" = [-20, 20]', r"increase the twist of shaft 1 by 8° "),
        ("slopes_vertical_deg.1 = [-2, 2]", r"reduce the vertical slope of shaft 1 by 1° "),
        ('"phases_deg.0" = "free"', r"turn the output-side yoke of shaft 1 by 8.0° counter-clock"),
        ("bends_deg = [-1, 1]", r"reduce the bends of all joints by 1° "),
        ("phases_deg = [0, 1]", r"leave the output-side yoke of shaft 1 as it is "),
    ],
)
def test_words_of_other_keys(vary: str, words: str) -> None:
    text = Z_SHAFT.replace("[8]", "[0]") if "bends_deg.1" in vary or ".0 = [-2" in vary else Z_SHAFT
    if vary.startswith('"bends_deg'):
        text = text.replace("[8]", "[0]")
    if vary.startswith("slopes"):
        text = "[driveline]\nslopes_vertical_deg = [0, 6, 10]\n"
    found = optimised(Scene.parse(f"{text}[optimise]\nvary = {{{vary}}}\n"))
    assert found
    assert re.match(words, next(change_lines(found))), [*change_lines(found)]


QUANTITIES = (
    *("equivalent_bend", "torsional_excitation", "inertia_excitation"),
    *("support_moment_1_peak", "support_moment_2_rms", "moment_1_mean", "torque_2_max"),
    *("torque_rms", "torque_1_mean", "torque_1_min", "tilt_driven_1_peak", "speed_ratio_max"),
)
VARIED = (
    (TRUCK, '"points_mm.2.y" = [-40, 40], "points_mm.1-2.z" = [-9, 9], "phases_deg" = "free"'),
    (TRUCK, '"points_mm.3-4.z" = [-10, 40], "phases_deg.1" = "free"'),
    (
        TRUCK.replace("points_mm", "points_m"),
        '"points_m.2.y" = [-40, 40], "phases_deg.0-1" = [-3, 50]',
    ),
    (
        "[driveline]\nbends_deg = [10, 9, 4]\nphases_deg = [20, 3]\n",
        '"bends_deg.0-1" = [-4, 4], "twists_deg.1" = [-9, 9], "phases_deg.0" = "free"',
    ),
)


@pytest.mark.parametrize(
    ("text", "vary", "quantity"),
    [
        # In the short tier each quantity of one driveline.
        pytest.param(*varied, name, marks=pytest.mark.long if (i + j) % len(VARIED) else ())
        for i, varied in enumerate(VARIED)
        for j, name in enumerate(QUANTITIES)
    ],
)
def test_exact_derivatives_are_those_of_differences(text: str, vary: str, quantity: str) -> None:
    load = "[load]\noutput_torque_Nm = 80\ninertias_kgm2 = [1, 1, 2, 1]\n"
    text = text.replace("[load]\n", load) if "[load]" in text else f"{text}{load}speed_rpm = 900\n"
    asked = Scene.parse(f"{text}[optimise]\nvary = {{{vary}}}\n").optimisation
    assert asked
    x = np.linspace(1.0, 3.0, len(asked.variables))
    low, high = np.full(len(x), -9.0), np.full(len(x), 9.0)
    measure, line = asked.measure("minimise", quantity), asked.drivelines(x)
    parameters = parameters_of(asked._parameters, line, len(x))
    assert len(parameters) == len(x)
    even = np.full(len(asked.names), 1.0 / len(asked.names))
    (exact,) = Problem(
        *(asked.drivelines, low, high, high, measure, (), np.empty(0), False, even, None, True),
        parameters,
    ).derivatives(x)

    def magnitudes(x: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.asarray(np.abs(measure.vectors(asked.drivelines(x))))

    # The phase of q turns with the plane of a joint, its magnitude does not.
    vectors = measure.vectors(line)
    slopes = np.real(np.conj(vectors)[..., np.newaxis] * exact) / np.abs(vectors)[..., np.newaxis]
    for i in range(len(x)):
        step = 1e-4 * np.eye(len(x))[i]
        difference = (magnitudes(x + step) - magnitudes(x - step)) / 2e-4
        np.testing.assert_allclose(slopes[..., i], difference, atol=2e-6 * np.max(np.abs(slopes)))


def test_states_move_with_what_changes() -> None:
    """A variable adds its change to what a state sets."""
    text = TRUCK.replace("[35, 45, 55]", "{from = 35, to = 55, steps = 3} # spread")
    text += '[optimise]\nvary = {"points_mm.3-4.z" = [-60, 60]}\n'
    scene = Scene.parse(text)
    asked = scene.optimisation
    assert asked
    changed = with_values(text, asked.values_after(np.array([-5.0])))
    assert "points_mm.3-4.z = {from = 30, to = 50, steps = 3} # spread" in changed
    assert [line[2] for line in tomllib.loads(changed)["driveline"]["points_mm"]][3:] == [40, 40]
    after = Scene.parse(changed).drivelines()
    np.testing.assert_allclose(after.bends, asked.drivelines(np.array([-5.0])).bends, rtol=1e-12)


@pytest.mark.parametrize(
    ("driveline", "rest", "vary", "change", "written"),
    [
        (
            "points_mm = [[0, 0, 0], [500, -24, 0], [900, -50, 0], [1400, -50, 0]]",
            "[states]\npoints_mm.1-2.y = [-24, 9]\n",
            "points_mm.1-2.y = [-20, 3.5] # of both\nvary.phases_deg = 'free'",
            [-4.5, 3.0],
            "vary.points_mm.1-2.y = [-15.5, 8] # of both\nvary.phases_deg = 'free'\n",
        ),
        (
            "points_ft = [[0, 0, 0], [2, 0, 0], [3, -0.4, 0], [5, -0.5, 0]]\nphases_deg = 2",
            "[[bearing]]\nshaft = 0\nposition_in = 8\n[[bearing]]\nshaft = 0\nposition_in = 2\n",
            'bearing = {1.position_in = [-1.5, 2]}\nvary."phases_deg.0" = [-3, 0]',
            [2.0, -3.0],
            'vary.bearing = {1.position_in = [-3.5, 0]}\nvary."phases_deg.0" = [0, 3]\n',
        ),
        (
            "double_joint_deg = 50\njoint_distance_mm = 80\nsingle_bend_deg = 10\n"
            "synchronous_deg = 35",
            "[states]\ndouble_joint_deg = [5, 50]\n",
            "single_bend_deg = [-10, 0]\nvary.double_joint_deg = [-5, 5]",
            [-8.123456, 4.0],
            "vary.single_bend_deg = [-1.876544, 8.123456]\nvary.double_joint_deg = [-9, 1]\n",
        ),
    ],
)
def test_ranges_of_the_scene_written_end_where_they_did(
    driveline: str, rest: str, vary: str, change: list[float], written: str
) -> None:
    text = f"[driveline]\n{driveline}\n{rest}[optimise]\nvary.{vary}\n"
    asked = Scene.parse(text).optimisation
    assert asked
    changed = with_values(text, asked.values_after(np.array(change)))
    assert changed.endswith(written)
    again = Scene.parse(changed).optimisation
    assert again
    for one, other in zip(asked.variables, again.variables, strict=True):
        ends = [other.base + other.low, other.base + other.high]
        assert ends == pytest.approx([one.base + one.low, one.base + one.high])


def test_a_root_mean_square_has_the_weights_of_the_states() -> None:
    text = TRUCK.replace("[states]", "[states]\nweights = [0, 3, 0]")
    asked = Scene.parse(f'{text}{VARY}over = "rms"\n').optimisation
    assert asked
    best = asked.run()
    assert best.value == pytest.approx(best.per_state[1])
    assert best.per_state[0] > best.value


def test_inertia_excitation_is_at_the_speed(tmp_path: Path) -> None:
    options = ("--json",)
    data = json.loads(
        run(tmp_path, TRUCK + VARY + 'minimise = "inertia_excitation"', *options).stdout
    )
    assert data["minimised"]["unit"] == "rad_s2"
    scene = Scene.load(tmp_path / "a.toml")
    findings = scene.drivelines().check(scene.speed).findings
    own = [f.value for f in findings if f.figure.startswith("inertia_excitation")]
    assert data["minimised"]["before"] == pytest.approx(float(np.max(own)))


def test_outputs_with_the_load_of_each_state() -> None:
    text = TRUCK.replace("[states]", "output_torque_Nm = 1\n[states]\noutput_torque_Nm = [1, 2, 3]")
    scene = Scene.parse(f'{text}{VARY}minimise = "bending_driven_2_peak"\n')
    asked, states = scene.optimisation, scene.states
    assert asked
    assert states
    before = asked.run().per_state_before
    for i in range(3):
        line, load = states.driveline(i), states.load(i)
        angles = np.linspace(0.0, np.pi, 181)
        own = line.evaluate(angles, "bending_driven", joints=2, load=load, reduce="peak")
        assert before[i] == pytest.approx(float(own.bending_driven), rel=1e-9)


@pytest.mark.parametrize(
    ("section", "message"),
    [
        ("vary = {}", "vary is a section; it must name keys and ranges"),
        ('vary = {"points_mm.2" = [1, 2]}', "vary.points_mm.2 needs place and axis"),
        ('vary = {"points_mm.9.y" = [-1, 1]}', "points_mm.9.y does not exist; there are 5"),
        ('vary = {"points_mm.2.y" = [1, 2]}', "vary.points_mm.2.y is [1, 2]; it is the range of"),
        ('vary = {"points_mm.2.y" = [1, -2]}', "vary.points_mm.2.y is [1, -2]; the first must"),
        ('vary = {"points_mm.2.y" = "free"}', "vary.points_mm.2.y is 'free'; only phases may be"),
        ('vary = {"bends_deg.0" = [-1, 1]}', "vary.bends_deg is not in [driveline]; what can"),
        (
            'vary = {"inertias_kgm2.1" = [-1, 1]}',
            "vary.inertias_kgm2.1 is a key of [load]; what may change is the layout",
        ),
        ("vary = {speed_rpm = [-1, 1]}", "vary.speed_rpm is no path of a key that may change"),
        ('vary = {"points_mm.3.z" = [-1, 1]}', "vary.points_mm.3.z changes only a part of points"),
        ('vary = {"points_mm.2.y" = [-1, 1], points_mm.1-2.y = [-1, 1]}', "points_mm.1-2.y varies"),
        ('vary = {"points_mm.1.x" = [-360, 1e4]}', "vary.points_mm.1.x reaches "),
        (f'{VARY[11:]}minimise = "bend"', "minimise is 'bend'; "),
        (f'{VARY[11:]}minimise = "torque_9_peak"', "minimise is 'torque_9_peak'; "),
        (f'{VARY[11:]}over = "mean"', "over is 'mean'; "),
        (f"{VARY[11:]}keep = {{bend = 1}}", "keep.bend is no quantity; "),
        (f"{VARY[11:]}keep = {{non_uniformity = 0}}", "keep.non_uniformity is 0; it must be pos"),
        ("over = 'rms'", "vary is missing"),
    ],
)
def test_errors_name_place_and_rule(tmp_path: Path, section: str, message: str) -> None:
    result = run(tmp_path, f"{TRUCK}[optimise]\n{section}\n")
    assert result.exit_code == 2
    (line,) = result.stderr.splitlines()
    assert re.match(
        rf"cardan: {re.escape(str(tmp_path / 'a.toml'))}, line 1\d: \[optimise\] ", line
    )
    assert line.partition("[optimise] ")[2].startswith(message)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["a.toml"]


def test_a_limit_that_cannot_be_kept(tmp_path: Path) -> None:
    result = run(tmp_path, TRUCK + VARY + "keep = {equivalent_bend_deg = 0.1}\n")
    assert result.exit_code == 2
    said = re.search(
        r"a.toml: \[optimise\] keep.equivalent_bend_deg is 0.1; no changes within the ranges keep "
        r"it: at best it reaches (\S+), (\S+) above, "
        r"with points_mm.2.y = (\S+), phases_deg.0 = (\S+)$",
        result.stderr.strip(),
    )
    assert said, result.stderr
    least = Scene.parse(TRUCK + VARY).optimisation
    assert least
    assert float(said[1]) == pytest.approx(float(np.degrees(least.run().value)), rel=1e-2)
    assert float(said[2]) == pytest.approx(float(said[1]) - 0.1, rel=1e-2)
    assert not (tmp_path / "a.optimised.toml").exists()
    # With the values that it names the driveline is as good as it says.
    text = TRUCK.replace("[1650, -46, 0]", f"[1650, {said[3]}, 0]")
    text = text.replace("[load]", f"phases_deg = [{said[4]}, 0]\n[load]")
    assert largest_bend(Scene.parse(text)) == pytest.approx(float(said[1]), rel=1e-3)


def advice_on(path: Path) -> list[str]:
    """What would help by a check of a scene."""
    found: list[str] = json.loads(scripts.run("check", path, "--json").stdout)["advice"]
    return found


COLUMN = "points_mm = [[0, 0, 0], [480, 20, -230], [700, -60, -430], [830, -75, -560]]"
WIDE_ANGLE = "double_joint_deg = 50\njoint_distance_mm = 80\nsingle_bend_deg = 10\n"
BOTH_BENDS = "projected_bends_vertical_deg = [1, 12]\nprojected_bends_horizontal_deg = [9, 3]"


@pytest.mark.parametrize(
    ("driveline", "rest", "paths"),
    [
        (COLUMN, "", "points_mm.1.y points_mm.1.z points_mm.2.y points_mm.2.z phases_deg.0"),
        (COLUMN.replace("mm", "in"), "", "points_in.1.y points_in.1.z points_in.2.y points_in.2.z"),
        (
            "points_m = [[0, 0, 0], [1, 0, 0], [2, -0.4, 0], [3, -0.5, 0]]",
            "",
            "points_m.1.y points_m.2.y phases_deg.0",
        ),
        (COLUMN, "[states]\npoints_mm.1-2.y = [0, 9]", "points_mm.1.z points_mm.2.z phases_deg.0"),
        (COLUMN, "[states]\nphases_deg = [0, 3]", "points_mm.1.y points_mm.1.z points_mm.2.y"),
        ("bends_deg = [1, 12]", "", "bends_deg.0 bends_deg.1 phases_deg.0"),
        ("bends_deg = [1, 12, 3]\nteeth = [12, 16]", "", "bends_deg.0 bends_deg.1 bends_deg.2"),
        ("directions = [[1, 0, 0], [2, -1, 0], [1, 0, 0.6]]", "", "directions.1.y directions.1.z"),
        ("slopes_vertical_deg = [0, 12, 3]", "", "slopes_vertical_deg.1 phases_deg.0"),
        (BOTH_BENDS, "", "projected_bends_vertical_deg.0 projected_bends_vertical_deg.1"),
        # One change alone is no several, and these keys cannot change.
        ("bends_deg = [12]", "", ""),
        ("readings_deg = [0, 12, 3]", "", ""),
        ("double_joint_deg = 40\njoint_distance_mm = 90\nsynchronous_deg = 12", "", ""),
        (
            f"{WIDE_ANGLE}synchronous_deg = 35",
            "",
            "synchronous_deg single_phase_deg single_bend_deg",
        ),
        (
            f"{WIDE_ANGLE}synchronous_deg = 35",
            "[states]\nsynchronous_deg = [35, 36]\nsingle_bend_deg = [9, 12]",
            "synchronous_deg single_phase_deg",
        ),
        (COLUMN, "[study]\nphases_deg = [0, 3]", ""),
    ],
)
def test_a_check_has_the_section_that_changes_several_at_once(
    tmp_path: Path, driveline: str, rest: str, paths: str
) -> None:
    text = f"[driveline]\n{driveline}\n{rest}\n[limits]\nequivalent_bend_deg = 0.0001\n"
    (tmp_path / "a.toml").write_text(text)
    printed = scripts.run("check", tmp_path / "a.toml").stdout
    (lines,) = [
        each for each in advice_on(tmp_path / "a.toml") if each.startswith("Several changes")
    ] or [""]
    assert bool(lines) == bool(paths)
    if paths:
        section = lines.partition("\n")[2]
        assert f"\n{section}\n" in printed
        found = Scene.parse(f"{text}{section}\n").optimisation
        assert found
        own = [variable.axis.key for variable in found.variables]
        assert own[: len(paths.split())] == paths.split()
        assert len(own) < 9


@pytest.mark.parametrize(
    ("vary", "said"),
    [
        ("synchronous_deg = [-35, 30]", r"increase the synchronous bend of the double joint by "),
        ("single_bend_deg = [-5, 10]", r"reduce the bend of the single joint by 5°"),
        ("single_twist_deg = [-90, 90]", r"(increase|reduce) the twist of the single joint by "),
        ("double_joint_deg = [-20, 20]", r"reduce the total bend of the double joint by "),
        ('single_phase_deg = "free"', r"turn the output-side yoke of shaft 2 by 90"),
    ],
)
def test_keys_of_a_double_joint_can_change(tmp_path: Path, vary: str, said: str) -> None:
    text = f"[driveline]\n{WIDE_ANGLE}synchronous_deg = 35\nsingle_phase_deg = 0\n"
    text += f"single_twist_deg = 0\n[optimise]\nvary.{vary}\n"
    result = run(tmp_path, text)
    assert result.exit_code == 0, result.output
    assert re.search(rf"^- {said}", result.stdout, re.MULTILINE)
    # As it was, it is 15.45°.
    written = Scene.load(tmp_path / "a.optimised.toml")
    assert largest_bend(written) < 13.0
    # Of the range of its change both ends stay where they were.
    assert written.optimisation
    ends = [one.base + one.high for one in written.optimisation.variables]
    before = Scene.parse(text).optimisation
    assert before
    assert ends == pytest.approx([one.base + one.high for one in before.variables])


@pytest.mark.parametrize(
    ("vary", "message"),
    [
        (
            "synchronous_deg.0 = [-5, 5]",
            "vary.synchronous_deg.0 is of one value; write the key alone",
        ),
        (
            "synchronous_deg = [-36, 5]",
            "vary.synchronous_deg reaches -36, where synchronous_deg must",
        ),
        (
            "synchronous_deg = [-5, 85]",
            "vary.synchronous_deg reaches 85, where synchronous_deg must",
        ),
        (
            "joint_distance_mm = [-5, 5]",
            "vary.joint_distance_mm is no path of a key that may change",
        ),
        ('synchronous_deg = "free"', "vary.synchronous_deg is 'free'; only phases may be"),
        (
            "single_bend_deg = [-16, 5]",
            "vary.single_bend_deg reaches -16, where single_bend_deg[0] is -6.0 deg; a bend must "
            "lie in [0, 90) deg",
        ),
    ],
)
def test_keys_of_a_double_joint_that_cannot_change(vary: str, message: str) -> None:
    text = f"[driveline]\n{WIDE_ANGLE}synchronous_deg = 35\n[optimise]\nvary.{vary}\n"
    with pytest.raises(ValueError, match=re.escape(message)):
        Scene.parse(text)


def test_what_several_changes_are_to_make_least(tmp_path: Path) -> None:
    text = "[driveline]\nbends_deg = [12, 11.9]\nphases_deg = 90\ntwists_deg = 90\n"
    text += "[load]\nspeed_rpm = 3000\n[limits]\n{}\n"
    for limits, minimise in (
        ("inertia_excitation_rad_s2 = 1", "inertia_excitation"),
        ("inertia_excitation_rad_s2 = 1\ntorsional_excitation_rad_s2 = 1e-9", "equivalent_bend"),
    ):
        own = text.format(limits)
        (tmp_path / "a.toml").write_text(own)
        *_, advice = json.loads(scripts.run("check", tmp_path / "a.toml", "--json").stdout)[
            "advice"
        ]
        found = Scene.parse(own + advice.partition("\n")[2]).optimisation
        assert found
        assert found.minimise == minimise
    (tmp_path / "a.toml").write_text(own + advice.partition("\n")[2])
    *_, advice = advice_on(tmp_path / "a.toml")
    assert advice.endswith("'cardan optimise' finds those of [optimise].")


def test_the_scene_is_never_overwritten(tmp_path: Path) -> None:
    (tmp_path / "link.toml").symlink_to(tmp_path / "a.toml")
    (tmp_path / "a.toml").touch()
    (tmp_path / "same.toml").hardlink_to(tmp_path / "a.toml")
    for target in ("a.toml", "link.toml", "same.toml"):
        result = run(tmp_path, TRUCK + VARY, "--to", str(tmp_path / target))
        assert result.exit_code == 2
        assert result.stderr.endswith("is the scene itself; it is never overwritten\n")
    assert (tmp_path / "a.toml").read_text("utf-8") == TRUCK + VARY


def test_another_file(tmp_path: Path) -> None:
    target = tmp_path / "better.toml"
    result = run(tmp_path, TRUCK + VARY, "--to", str(target), "--picture", str(tmp_path / "a.svg"))
    assert result.exit_code == 0, result.output
    assert largest_bend(Scene.load(target)) < largest_bend(Scene.parse(TRUCK))
    # The scene gives no phases: a line is added.
    assert re.search(r"^phases_deg = \[\S+, 0\]$", target.read_text("utf-8"), re.MULTILINE)
    assert "<svg" in (tmp_path / "a.svg").read_text("utf-8")
    assert run(tmp_path, TRUCK + VARY, "--to", str(tmp_path / "a.csv")).exit_code == 2


@pytest.mark.parametrize(
    ("section", "given"),
    [
        ("joints", '[joints]\nsizes = "a.csv"\nsize = "1480"\n[life]\noutput_torque_Nm = 9\n'),
        ("angles", '[angles]\nfile = "b.csv"\nangle_column_deg = "drive"\n'),
    ],
)
def test_a_scene_that_names_files_stays_in_their_folder(
    tmp_path: Path, section: str, given: str
) -> None:
    sizes = (ROOT / "examples" / "joint_sizes.csv").read_text("utf-8")
    (tmp_path / "a.csv").write_text(sizes, encoding="utf-8")
    (tmp_path / "b.csv").write_text("drive\n0\n90\n180\n", encoding="utf-8")
    (tmp_path / "other").mkdir()
    text = f"{given}[driveline]\nbends_deg = [8, 6]\n[load]\nspeed_rpm = 900\n" + (
        '[optimise]\nvary = {"bends_deg.1" = [-3, 3]}\n'
    )
    elsewhere = run(tmp_path, text, "--to", str(tmp_path / "other" / "better.toml"))
    assert elsewhere.exit_code == 2
    assert f"in the folder of the scene, from which [{section}] names its file" in elsewhere.output
    assert list((tmp_path / "other").iterdir()) == []
    assert run(tmp_path, text, "--to", str(tmp_path / "better.toml")).exit_code == 0
    assert Scene.load(tmp_path / "better.toml").line.bends_deg[1] == pytest.approx(8.0, abs=1e-6)


def test_a_scene_without_the_section(tmp_path: Path) -> None:
    result = run(tmp_path, TRUCK)
    assert result.exit_code == 2
    assert result.stderr.endswith('as vary = {"points_mm.2.y" = [-40, 40]}\n')


def test_a_single_driveline_without_states(tmp_path: Path) -> None:
    result = run(
        tmp_path, f'{Z_SHAFT}[optimise]\nvary = {{"bends_deg.1" = [-3, 3], phases_deg = "free"}}\n'
    )
    assert result.exit_code == 0, result.output
    assert result.output.startswith("Equivalent bend: ")
    written = (tmp_path / "a.optimised.toml").read_text("utf-8")
    assert "bends_deg = [10, 10]" in written
    assert "phases_deg = [0] # as found" in written


TOML = '''\
title = "a # b" # [driveline]
[ driveline ] # points
"bends_deg" = [ 1.0, # one ]
   2_0, ] # two
phases_deg.x = """ # ]
" [y] """
other = {a = [1, {b = 2}], "c.d" = 'it''s'}
[[bearing]]
shaft = 1
[load]
speed_rpm=15
'''.replace("'it''s'", "'its'")


def test_values_are_changed_in_place() -> None:
    changed = with_values(TOML, {"driveline.bends_deg": [1, 3.5], "load.speed_rpm": -7.25})
    expected = TOML.replace("2_0", "3.5").replace("=15", "=-7.25")
    assert changed == expected
    added = with_values(TOML, {"load.drive_torque_Nm": 2.0, "driveline.twists_deg": [0.5]})
    document = tomllib.loads(added)
    assert document["load"] == {"speed_rpm": 15, "drive_torque_Nm": 2}
    assert document["driveline"]["twists_deg"] == [0.5]


@pytest.mark.parametrize("path", EXAMPLES, ids=lambda p: p.stem)
def test_examples_are_read_as_toml_reads_them(path: Path) -> None:
    text = path.read_text("utf-8")

    def leaves(value: Any, above: str) -> dict[str, Any]:  # noqa: ANN401 - any TOML
        if isinstance(value, list) and value and isinstance(value[0], dict):
            value = {str(i): entry for i, entry in enumerate(value)}
        if not isinstance(value, dict):
            return {above: value}
        parts = [leaves(entry, f"{above}.{key}".strip(".")) for key, entry in value.items()]
        return {key: entry for part in parts for key, entry in part.items()}

    found = {
        path: tomllib.loads(f"v = {text[span.start : span.end]}")["v"]
        for path, span in map_of(text).values.items()
    }
    tables = {key for key, value in tomllib.loads(text).items() if isinstance(value, list)}
    wanted = leaves(tomllib.loads(text), "")
    apart = [
        {k: v for k, v in of.items() if k.partition(".")[0] not in tables} for of in (found, wanted)
    ]
    assert apart[0] == apart[1]


LIMITED = """[tolerances]
phases_deg = 1
[optimise]
vary = {"points_mm.2.y" = [-40, 40], "phases_deg.0" = "free"}
keep = {inertia_excitation_rad_s2 = 250, max_angle_error_deg = 0.2}
"""


def test_pictures_and_page_show_where_a_limit_is_not_kept(tmp_path: Path) -> None:
    pytest.importorskip("jinja2")
    scene = Scene.parse(TRUCK + LIMITED)
    found = optimised(scene)
    assert found
    axes = plot_over_variable(found, 0)
    within, beyond = axes.get_lines()[:2]
    assert beyond.get_label() == "beyond a limit"
    x = np.asarray(within.get_xdata(), dtype=np.float64)
    line = found.asked.drivelines(np.stack([x + 46.0, np.full(x.shape, found.best.x[1])], -1))
    bend = np.degrees(line.equivalent().bend.max(axis=-1))
    speed = 1500.0 * np.pi / 30.0
    ways = (line, line.reversed())
    sums = [np.abs(way.transmission(1).q + way.transmission(2).q) for way in ways]
    excitation = np.max(sums, axis=(0, -1))
    error = np.degrees(np.arcsin(np.abs(line.transmission().q))).max(axis=-1)
    kept = (4.0 * speed**2 * excitation <= 250.0) & (error <= 0.2)
    assert 5 < np.count_nonzero(kept) < len(x) - 5
    y = np.asarray(within.get_ydata(), dtype=np.float64)
    np.testing.assert_allclose(y, np.where(kept, bend, np.nan))
    drawn = np.isfinite(np.asarray(beyond.get_ydata(), dtype=np.float64))
    # The dashed curve meets the other.
    assert np.all(drawn[~kept])
    meeting = np.flatnonzero(drawn & kept)
    assert meeting.size
    assert all(not kept[i - 1] or not kept[i + 1] for i in meeting if 0 < i < len(x) - 1)
    assert "beyond a limit" in [text.get_text() for text in axes.get_legend().get_texts()]  # type: ignore[union-attr]
    captions = [caption for caption, _ in by_state(found)]
    assert captions[1] == "Inertia excitation, at most 250 rad/s²"
    write_report(scene, tmp_path / "a.html")
    page = (tmp_path / "a.html").read_text("utf-8")
    section = page[page.index('id="optimise"') :]
    assert section.count("beyond a limit") >= 1
    assert "nan" not in section.partition("</section>")[0]


def test_bearings_move(tmp_path: Path) -> None:
    text = example("bearings.toml").read_text("utf-8")
    text = text.replace("position_mm = 1050", "from_end_mm = 150 # before the joint")
    asked = (
        '[optimise]\nvary = {"bearing.2.from_end_mm" = [-100, 300]}\n'
        'minimise = "joint_force_0_peak"\n'
    )
    done = run(tmp_path, text + asked)
    assert done.exit_code == 0, done.output
    written = (tmp_path / "a.optimised.toml").read_text("utf-8")
    changed = [
        (old, new)
        for old, new in zip((text + asked).splitlines(), written.splitlines(), strict=True)
        if old != new
    ]
    ((old, new), (_, vary)) = changed
    assert old == "from_end_mm = 150 # before the joint"
    place = float(new.split()[2])
    assert new == f"from_end_mm = {place:.6g} # before the joint"
    # Both ends of its range stay where they were: 50 and 450 mm.
    ends = re.findall(r"[-\d.]+", vary.partition("= [")[2])
    assert [place + float(end) for end in ends] == pytest.approx([50.0, 450.0])

    def force(at: float) -> float:
        scene = Scene.parse(text.replace("from_end_mm = 150", f"from_end_mm = {at}"))
        values = scene.line.evaluate(
            np.linspace(0.0, np.pi, 721), "joint_force", load=scene.load_case
        )
        return float(np.max(np.linalg.norm(values.joint_force[0], axis=-1)))

    tried = [force(at) for at in np.linspace(50.0, 450.0, 81)]
    assert force(place) <= min(tried) * (1.0 + 1e-6)
    sense = "up" if place > 150.0 else "down"
    assert f"move bearing 2 by {abs(place - 150):.6g} mm {sense}stream" in done.output.replace(
        "\n", " "
    )


@pytest.mark.parametrize(
    ("path", "message"),
    [
        ("bearing.9.position_mm", "bearing.9.position_mm does not exist; there are 5 bearings"),
        ("bearing.2.from_end_mm", "bearing.2.from_end_mm does not go with position_mm of that"),
        ("bearing.2.shaft", "is no path of a key that may change"),
    ],
)
def test_bearings_that_cannot_move(path: str, message: str) -> None:
    text = example("bearings.toml").read_text("utf-8")
    asked = f'[optimise]\nvary = {{"{path}" = [-1, 1]}}\nminimise = "joint_force_0_peak"\n'
    with pytest.raises(ValueError, match=re.escape(message)):
        Scene.parse(text + asked)


def test_json_follows_its_schema(tmp_path: Path) -> None:
    result = run(tmp_path, EXAMPLE, "--json")
    data = json.loads(result.stdout)
    jsonschema.Draft202012Validator(answers_schema()).validate(data)
    after = Scene.load(tmp_path / "a.optimised.toml")
    assert data["minimised"]["after"] == pytest.approx(largest_bend(after), rel=1e-9)
    first = data["variables"][0]
    assert (first["key"], first["unit"]) == ("points_mm.2.y", "mm")
    assert (first["least"], first["largest"]) == pytest.approx((-40, 40))
    assert first["before"] + first["change"] == pytest.approx(first["after"])
    assert first["at_end"] == "low"
    assert (data["variables"][1]["least"], data["variables"][1]["largest"]) == (None, None)
    turned = data["variables"][1]["teeth"] * 15.0
    assert data["variables"][1]["change"] == pytest.approx(turned)
    assert [state["state"] for state in data["minimised"]["states"]][4] == "rest"
    assert data["kept"][0]["limit"] == pytest.approx(300)
    assert data["files"] == [str(tmp_path / "a.optimised.toml")]

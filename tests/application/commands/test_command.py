"""The command as a user meets it: what it prints, writes and says when something is wrong."""

from __future__ import annotations

import json
import math
import re
import shutil
import subprocess
import textwrap
from pathlib import Path

import numpy as np
import pytest

from cardan.app.answers.answer import Answer
from cardan.app.answers.explain import explain_text
from cardan.app.answers.schema import VERSION
from cardan.app.command import commands
from cardan.app.files.columns import write_columns
from cardan.app.scene import Scene, load_scene
from cardan.app.scene.language.units import si_key
from cardan.app.scene.scene import FORMAT
from cardan.app.scene.starters import STARTERS
from example_scenes import EXAMPLES, Answers, each_driveline, example
from scripts import SCRIPT, failed, posix, run, script
from tiers import few


@each_driveline
def test_every_example_runs(path: Path, answered: Answers) -> None:
    answer, scene = answered(path), Scene.load(path)
    (status, text), into = answer.run, answer.files
    assert status == 0, text
    named = {scene.curves_file: len(scene.drive_angle), scene.picture_file: 0}
    if scene.study and scene.table_file:
        rows_of_table = scene.states.count if scene.states else math.prod(scene.study.shape)
        named[scene.table_file] = rows_of_table
    files = {name: rows for name, rows in named.items() if name}
    written = {entry.name: entry.stat().st_size for entry in into.iterdir()}
    assert set(written) == set(files) >= {f"{path.stem}.csv", f"{path.stem}.svg"}
    # A table over states has a row for each of a few states.
    least = 300 if scene.states else 2_000
    assert min(written.values()) > least
    lines = text.splitlines()
    assert lines[0] == scene.title
    said = [line for line in lines if line.startswith("wrote ")]
    rows = {name: f" ({rows} rows)" if rows else "" for name, rows in files.items()}
    assert set(said) == {f"wrote {into / name}{rows[name]}" for name in files}
    assert max(len(line) for line in lines if line not in said) <= 79
    for name, count in files.items():
        if count:
            assert len((into / name).read_text().splitlines()) == count + 1


def test_installed_script(into: Path) -> None:
    """The README's command, in a real process; files go to the current folder."""
    foeppl = next(path for path in EXAMPLES if path.stem == "foeppl")
    done = script("run", foeppl, cwd=into)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout == textwrap.dedent("""\
        Föppl's rig (Thoma 1920)

        Driveline
          bend, joint 0                        8.50°
          equivalent bend, shaft 1             8.50°
          non-uniformity U, shaft 1            0.0221

        Over a whole turn
          largest angle error, shaft 1         0.316° at 44.8°
          speed ratio, shaft 1                 0.9890 to 1.0111
          speed, shaft 1                       2967 to 3033 rpm
          largest acceleration ratio, shaft 1  0.0221 at 44.4°
          largest acceleration, shaft 1        2180 rad/s² at 44.4°
          largest torque, shaft 1              43.6 N m at 44.4°
          largest moment, joint 0              43.9 N m at 44.2°

        Angles after 'at' are drive angles; at 0° the driving pin of joint 0 lies in
        the plane of shafts 0 and 1. Each extreme recurs every 180°.
        Accelerations are those at constant drive speed.

        wrote foeppl.csv (721 rows)
        wrote foeppl.svg
        """)
    assert {entry.name for entry in into.iterdir()} == {"foeppl.csv", "foeppl.svg"}


def test_scene_without_files(tmp_path: Path) -> None:
    path = tmp_path / "scene.toml"
    path.write_text("[driveline]\nbends_deg = [8.5]\n")
    result = run("run", path, "--into", tmp_path)
    assert result.exit_code == 0
    assert result.output.startswith("Driveline\n  bend, joint 0 ")
    assert result.output.endswith("shafts 0 and 1. Each extreme recurs every 180°.\n")
    assert list(tmp_path.iterdir()) == [path]


def examples_of(*arguments: str) -> list[str]:
    text = run(*arguments, "--help")
    assert text.exit_code == 0
    return re.findall(r"^    cardan (.*)$", text.output, re.MULTILINE)


NAMES = list(commands().commands)


LONG = """\
[angles]
file = "angles.parquet"
angle_column_deg = "angle_deg"
[driveline]
bends_deg = [8.5]
[output]
curves = "curves.parquet"
"""

TORSION = """
[torsion]
inertias_kgm2 = [0, 0, [0, 0.1]]
stiffnesses_Nm_per_rad = ["rigid", 20000, "rigid"]
damping_ratio = 0.02
speed_rpm = [500, 3000]
"""


@pytest.mark.parametrize("name", few(["", *NAMES], {"", *NAMES} - {"plot"}))
def test_examples_of_the_help_work(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    first, *others = examples_of()
    assert run(*first.split()).exit_code == 0
    examples = examples_of(*filter(None, [name]))
    if name == "stream":
        write_columns("angles.parquet", {"angle_deg": np.array([0.0, 0.5, 1.0])})
        Path("long.toml").write_text(LONG)
    if name == "identify":
        angles = np.linspace(0.0, 720.0, 200)
        one, time = np.ones_like(angles), angles / 360.0
        columns = [angles, angles + 1.0, angles + 2.0, one, time, *(60.0 * one,) * 2, 60.01 * one]
        rows = [
            "crank,mid,axle,ratio,t,n,n1,n2",
            *(",".join(map(str, row)) for row in zip(*columns, strict=True)),
        ]
        Path("run.csv").write_text("\n".join(rows))
    if name == "optimise":
        with Path("shaft.toml").open("a") as file:
            file.write('[optimise]\nvary = {"bends_deg.1" = [-2, 2]}\n')
    if name == "tolerances":
        with Path("shaft.toml").open("a") as scene:
            scene.write("\n[tolerances]\nphases_deg = 1\n")
    if name in ("life", "plot"):
        for needed in ("conveyor.toml", "joint_sizes.csv"):
            shutil.copy(TRUCK.with_name(needed), ".")
    if name == "lateral":
        shutil.copy(example("shudder.toml"), "shaft.toml")
    if name == "torsion":
        with Path("shaft.toml").open("a") as scene:
            scene.write(TORSION)
    monkeypatch.setattr("webbrowser.open", lambda _: True)
    assert examples
    assert all(line.split()[0] == name for line in examples if name)
    for line in examples if name else others:
        result = run(*line.split())
        assert result.exit_code == 0, result.output


def test_help_without_arguments() -> None:
    assert run().output == run("--help").output
    assert run("--help").exit_code == 0
    for name in NAMES:
        assert f"  {name} " in run("--help").output
        assert max(map(len, run(name, "--help").output.splitlines())) < 80


def test_help_lists_every_key_on_a_line_of_its_own() -> None:
    text = run("run", "--help").output
    for name, section in FORMAT.items():
        assert not name or f"\n  {section.heading}  " in text
        for key in filter(lambda key: key == si_key(key), section.keys if name != "study" else ()):
            assert f"\n    {key} " in text
    assert max(map(len, text.splitlines())) < 80


def test_recording_is_not_overwritten(tmp_path: Path, into: Path) -> None:
    recording, path = tmp_path / "a.csv", tmp_path / "a.toml"
    recording.write_text("crank\n0\n1\n")
    path.write_text(
        "[driveline]\nbends_deg = [8]\n[angles]\nfile = 'a.csv'\nangle_column_deg = 'crank'\n"
        "[output]\ncurves = 'a.csv'\n"
    )
    message = f"{recording} is the recording that the scene reads; it would be overwritten"
    failed(run("run", path, "--into", tmp_path), message)
    assert recording.read_text() == "crank\n0\n1\n"
    assert run("run", path, "--into", into).exit_code == 0


# What the other commands do


def test_json_in_both_units(into: Path) -> None:
    foeppl = next(path for path in EXAMPLES if path.stem == "foeppl")
    degrees = json.loads(run("run", foeppl, "--into", into, "--json").output)
    radians = json.loads(run("run", foeppl, "--into", into, "--json", "--radians").output)
    assert degrees["rows"][0] == {
        "quantity": "bend",
        "joint": 0,
        "statistic": "value",
        "of": "driveline",
        "value_deg": 8.5,
    }
    for in_degrees, in_radians in zip(degrees["rows"], radians["rows"], strict=True):
        turned = {
            key.replace("_deg", "_rad"): math.radians(value) if key.endswith("_deg") else value
            for key, value in in_degrees.items()
        }
        assert in_radians.keys() == turned.keys()
        for key, value in turned.items():
            assert in_radians[key] == (pytest.approx(value) if key.endswith("_rad") else value)
    assert degrees["drive_angles"]["last_deg"] == 360
    assert radians["drive_angles"]["last_rad"] == pytest.approx(math.tau)
    head = (into / "foeppl.csv").read_text().splitlines()[0].split(",")
    assert head[:2] == ["drive_angle_rad", "angle_error_rad"]


def test_run_prints_a_study(tmp_path: Path) -> None:
    path = tmp_path / "a.toml"
    path.write_text(
        "[driveline]\nbends_deg = [8]\n[load]\nspeed_rpm = 1\noutput_torque_Nm = 10\n"
        "[study]\nbends_deg = [30, 10, 20]\nspeed_rpm = [5, 6]\n"
        "[output]\nclosed_forms = ['equivalent_bend']\nquantities = ['torque', 'bending_driven']\n"
        "[sweep]\nsamples_per_turn = 36\n"
    )
    result = run("run", path)
    assert result.stderr == ""
    text = result.output.split("\n\n")
    assert text[3].splitlines() == [
        "Study of 6 drivelines, 3 x 2",
        "  bends_deg  10 to 30",
        "  speed_rpm  5 to 6",
    ]
    # What does not depend on the speed is not placed at one.
    assert text[4].splitlines() == [
        "equivalent_bend_deg",
        "  least    10 at bends_deg = 10",
        "  largest  30 at bends_deg = 30",
        "torque_peak_Nm            10",
        "bending_driven_0_peak_Nm",
        "  least    1.76 at bends_deg = 10",
        "  largest  5.77 at bends_deg = 30",
    ]
    assert text[5].splitlines() == [
        "Best driveline",
        "  by equivalent_bend_deg, bending_driven_0_peak_Nm:",
        "    bends_deg = 10",
    ]
    assert text[6].splitlines() == [
        "Figures that end in peak are of samples, drive angles 0° to 360°, 1 turn of 36",
        "samples.",
    ]
    # Fewer are too few.
    path.write_text(path.read_text().replace("36", "35"))
    warning = "cardan: only 35 samples per turn; the largest values may lie between the samples\n"
    assert run("run", path).stderr == warning
    # Closed forms need none.
    path.write_text("[driveline]\nbends_deg = [8]\n[sweep]\nsamples_per_turn = 4\n")
    assert run("run", path).stderr == ""


TRUCK = next(path for path in EXAMPLES if path.stem == "truck")


def test_check_says_pass_or_fail(tmp_path: Path) -> None:
    """The four joints of the workshop books, whose figures test_check.py knows."""
    failed = run("check", TRUCK)
    assert failed.exit_code == 1
    assert failed.output.startswith(
        "Beyond their limits: the equivalent bend, the torsional excitation and the\n"
        "inertia excitation, driving.\n\nBeyond\n- equivalent bend: 6.00°, 3.00° above the limit "
        "of 3° ("
    )
    assert "\n- torsional excitation: 753 rad/s², 253 rad/s² above the maximum" in failed.output
    _, _, advice = failed.output.partition("\n\nWhat would help\n")
    assert advice.startswith("- Turn the output-side yoke of shaft 1 by 81.8° clockwise or ")
    data = json.loads(run("check", TRUCK, "--json").output)
    assert (data["answer"], data["version"]) == ("check", VERSION)
    assert (data["passes"], data["verdict"]) == (False, "beyond")
    motion = data["limits"]
    assert motion["preset"] == "truck"
    assert data["beyond"] == [
        {"figure": f"limits.{key}", "name": name}
        for key, name in (
            ("equivalent_bend", "equivalent bend"),
            ("torsional_excitation", "torsional excitation"),
            ("inertia_excitation_driving", "inertia excitation, driving"),
        )
    ]
    torsional = motion["torsional_excitation"]
    assert torsional["value_rad_s2"] == pytest.approx(752.5, abs=0.1)
    assert (torsional["limit_rad_s2"], torsional["maximum_rad_s2"]) == (300, 500)
    (speed,) = (each for each in motion["speeds"] if each["excitation"].startswith("torsional"))
    assert speed["within_up_to_rpm"] == pytest.approx(2500 * math.sqrt(300 / 752.5), abs=0.1)
    assert speed["tolerable_up_to_rpm"] == pytest.approx(2500 * math.sqrt(500 / 752.5), abs=0.1)
    assert motion["inertia_excitation_coasting"]["verdict"] == "within"
    assert "section 6.4" in motion["equivalent_bend"]["source"]
    assert motion["non_uniformity"] == pytest.approx(0.01098, abs=1e-5)
    assert motion["bend_difference"] is None

    path = tmp_path / "a.toml"
    path.write_text("[driveline]\nbends_deg = [2]\n")
    passed = run("check", path)
    assert passed.exit_code == 0
    assert passed.output.startswith("Everything that has a limit is within it.")
    assert json.loads(run("check", path, "--json").output)["passes"] is True
    path.write_text("[driveline]\nbends_deg = [92]\n")
    assert run("check", path).exit_code == 2


@pytest.mark.parametrize(
    ("limit", "code", "verdict"),
    [("3.5", 0, "within"), ("[3, 3.5]", 0, "tolerable"), ("3", 1, "beyond"), ("[3, 2]", 2, "")],
)
def test_exit_status_of_the_verdicts(tmp_path: Path, limit: str, code: int, verdict: str) -> None:
    path = tmp_path / "a.toml"
    path.write_text(f"[driveline]\nbends_deg = [3.2]\n[limits]\nequivalent_bend_deg = {limit}\n")
    assert run("check", path).exit_code == code
    if verdict:
        assert json.loads(run("check", path, "--json").output)["verdict"] == verdict


def test_figures_without_a_limit_are_said_not_to_be_judged(tmp_path: Path) -> None:
    path = tmp_path / "a.toml"
    path.write_text("[driveline]\nbends_deg = [2]\n[load]\nspeed_rpm = 100\n")
    data = json.loads(run("check", path, "--json").output)
    motion = data["limits"]
    assert motion["equivalent_bend"]["verdict"] == "within"
    assert motion["torsional_excitation"]["verdict"] == "not judged"
    assert motion["torsional_excitation"]["value_rad_s2"] > 0
    assert motion["torsional_excitation"]["limit_rad_s2"] is None
    (said,) = data["not_judged"]
    assert "torsional excitation ([limits] torsional_excitation_rad_s2)" in said


def test_a_limit_that_cannot_be_judged_leaves_no_verdict_within(tmp_path: Path) -> None:
    path = tmp_path / "a.toml"
    limit = "[limits]\ntorsional_excitation_rad_s2 = 300\n"
    path.write_text(f"[driveline]\nbends_deg = [2]\n{limit}")
    found = run("check", path)
    assert found.exit_code == 0
    first = "Not judged, although there is a limit: the torsional excitation."
    assert found.output.splitlines()[0] == first
    assert "- torsional excitation: needs a speed, and the scene gives none" in found.output
    path.write_text("[driveline]\nbends_deg = [2, 2, 2]\n[limits]\nbend_difference_deg = 1\n")
    said = run("check", path).output
    assert "- bend difference: is that of two joints; the driveline has 3\n" in said


def test_check_of_a_study_is_of_every_driveline(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "a.toml"
    text = "[driveline]\nbends_deg = [2]\n[load]\nspeed_rpm = 100\n"
    text += "[limits]\npreset = 'truck'\n[study]\n"
    path.write_text(f"{text}bends_deg = [1, 2, 2.9, 3.1]\nspeed_rpm = [100, 6000]")
    for block in (1 << 21, 3):
        monkeypatch.setattr("cardan.app.scene.study.study._BLOCK", block)
        result = run("check", path)
        assert result.exit_code == 1
        said = " ".join(result.output.split())
        assert said.startswith(
            "Beyond their limits: the equivalent bend and the torsional excitation. Beyond - "
            "equivalent bend: 3.10° at bends_deg = 3.1, 0.10° above the limit of 3° ("
        )
        assert (
            "torsional excitation: 1156 rad/s² at bends_deg = 3.1, speed_rpm = 6000, 656 rad/s² "
            "above the maximum of 500 rad/s² ("
        ) in said
    motion = json.loads(run("check", path, "--json").output)["limits"]
    assert motion["equivalent_bend"]["at"] == [{"key": "bends_deg", "value": 3.1}]
    assert motion["torsional_excitation"]["at"] == [
        {"key": "bends_deg", "value": 3.1},
        {"key": "speed_rpm", "value": 6000},
    ]
    numbers = {"within": 4, "tolerable": 1, "beyond": 3, "not_judged": 0}
    assert motion["counts"] == {"counted": "drivelines", **numbers}
    # The worst in the middle of an axis, and figures that no key varies.
    path.write_text(f"{text}bends_deg = [1, 3.1, 2]")
    assert " at bends_deg = 3.1;" in " ".join(run("check", path).output.split())
    path.write_text(f"{text}speed_rpm = [100, 6000, 200]")
    found = run("check", path).output
    assert "  2.00°; at most 3°\n" in found
    assert " at speed_rpm = 6000; at" in " ".join(found.split())
    path.write_text(f"{text}bends_deg = [1, 2, 2.9]")
    assert run("check", path).exit_code == 0


def test_check_of_a_study_from_standstill(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Blocks of drivelines at rest have the same figures as the others."""
    monkeypatch.setattr("cardan.app.scene.study.study._BLOCK", 1)
    path = tmp_path / "a.toml"
    text = "[driveline]\nbends_deg = [2]\n[limits]\npreset = 'truck'\n[load]\n"
    path.write_text(f"{text}[study]\nspeed_rpm = [0, 6000]")
    assert run("check", path).output.startswith("Tolerable, ")
    path.write_text(f"{text}speed_rpm = 0\n[study]\nbends_deg = [1, 2]")
    found = run("check", path).output
    assert "- torsional excitation: needs a speed, and the scene gives none\n" in found
    assert "\n  Drive speeds up to which limits are kept\n" in found


def test_phase_in_workshop_words() -> None:
    """The worked example of the catalogue: 70.8728 deg counter-clockwise, 71 off its drawing."""
    path = next(path for path in EXAMPLES if path.stem == "spatial_shaft")
    result = run("phase", path)
    assert result.exit_code == 0
    assert result.output == textwrap.dedent("""\
        Spatial two-joint shaft, 15/7/-11.5/12 deg

        Spatial arrangement: the bends lie in different planes.

        Set the output-side yoke of each shaft against its input-side yoke, looking
        from the drive towards the output (drive → output). A yoke looks the same every
        180°.
        - shaft 1: 70.9° counter-clockwise = 109.1° clockwise; nothing to turn

                                         now        best
        Equivalent bend                0.95°       0.95°
        Catalogue's root rule          0.94°       0.94°
          its fork signs                 + -         + -
          yokes off these by              0°          0°

        The yokes have their best setting; nothing to turn. 0.95° is within the limit
        of 3°.
        With the best setting the driveline passes the check.

        phases_deg counts clockwise from yokes in one plane, not from the best setting:
        a yoke 6° off has the best value plus or minus 6.
        In the scene: phases_deg = [-70.8728]
        """)


def test_plot(scene: Path, into: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(into)
    result = run("plot", scene)
    assert (result.exit_code, result.output) == (0, "wrote scene.svg\n")
    assert run("plot", scene, "--output", "a.png").exit_code == 0
    assert (into / "a.png").read_bytes().startswith(b"\x89PNG")
    assert {entry.name for entry in into.iterdir()} == {"scene.svg", "a.png"}
    failed(run("plot", scene, "--output", "a.gif"), "a.gif must end in .svg or .png or .pdf")


def test_report_is_opened_in_the_browser(
    scene: Path, into: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Only when asked for, by the address of the file, whatever its name."""
    opened: list[str] = []

    def page_opened(address: str) -> bool:
        opened.append(address)
        return True

    monkeypatch.chdir(into)
    monkeypatch.setattr("webbrowser.open", page_opened)
    assert run("report", scene).exit_code == 0
    assert opened == []
    result = run("report", scene, "--open", "--output", "50 % #1.html")
    assert (result.exit_code, result.output) == (0, "wrote 50 % #1.html\n")
    assert opened == [f"{into.as_uri()}/50%20%25%20%231.html"]
    monkeypatch.setattr("webbrowser.open", lambda _: False)
    result = run("report", scene, "--open")
    said = "cardan: --open has found no browser; open scene.html yourself\n"
    assert (result.exit_code, result.output) == (2, f"wrote scene.html\n{said}")
    assert (into / "scene.html").exists()


@posix
def test_a_browser_is_started(scene: Path, into: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The one that the environment names."""
    assert SCRIPT, "the script cardan is not installed"
    browser = into / "browser"
    browser.write_text(f'#!/bin/sh\necho "$@" >"{into}/address"\n')
    browser.chmod(0o755)
    monkeypatch.setenv("BROWSER", f"{browser} %s")
    page = into / "a.html"
    done = subprocess.run(
        [SCRIPT, "report", scene, "--open", "--output", page], capture_output=True, text=True
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert (into / "address").read_text() == f"{page.as_uri()}\n"


def test_plot_of_a_study(into: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(into)
    keys = (
        "bends_deg.1 = {from = 5, to = 15, steps = 7}\nphases_deg = {from = 0, to = 9, steps = 6}"
    )
    text = "[driveline]\nbends_deg = [10, 10]\nphases_deg = [0]\n"
    Path("a.toml").write_text(f"title = 'A grid'\n{text}[study]\n{keys}\n")
    result = run("plot", "a.toml", "--study", "equivalent_bend")
    assert (result.exit_code, result.output) == (0, "wrote a.svg\n")
    drawn = Path("a.svg").read_text()
    for words in ("A grid", "equivalent bend [deg]", "phase", "bend, joint 1 [deg]", "limit 3 deg"):
        assert words in drawn
    failed(
        run("plot", "a.toml", "--study", "k"),
        "--study is 'k'; known are equivalent_bend, non_uniformity, max_angle_error",
    )
    Path("a.toml").write_text(text)
    failed(
        run("plot", "a.toml", "--study", "k"),
        "a.toml: there is no study to draw; it needs a section [study]",
    )


def test_explain_a_figure() -> None:
    said = run("explain", TRUCK, "limits.torsional_excitation").output
    assert said.startswith("Torsional excitation\n  value       753 rad/s²\n")
    assert "peak acceleration of the last shaft at constant drive speed" in said
    assert "limit from  [limits] torsional_excitation_rad_s2\n" in said
    assert "limit       at most 300 rad/s², maximum 500 rad/s² (Dana, " in said
    assert "verdict     beyond\n" in said
    assert re.search(r"\nInputs\n  \[driveline\] bends_deg +\[5, 4, 3, 2\]\n", said)
    assert "[load] speed_rpm " in said


def test_explain_a_figure_with_the_inputs_of_its_worst_state(tmp_path: Path) -> None:
    wide = tmp_path / "wide.toml"
    run("new", "wide-angle", wide)
    said = run("explain", wide, "limits.equivalent_bend").output
    assert "  limit from       [limits] equivalent_bend_deg\n" in said
    inputs = said.partition('\nInputs in the state "turn 50 deg"\n')[2]
    assert re.search(r"^  \[states\] double_joint_deg +50.09$", inputs, re.MULTILINE)
    assert re.search(r"^  \[driveline\] synchronous_deg +40$", inputs, re.MULTILINE)
    assert "[driveline] double_joint_deg" not in inputs


def test_explain_says_whose_limit_it_is_without_one(tmp_path: Path) -> None:
    path = tmp_path / "a.toml"
    path.write_text("[driveline]\nbends_deg = [9, 4]\n")
    said = " ".join(run("explain", path, "limits.equivalent_bend").output.split())
    default = "default of driveshaft catalogues; [limits] equivalent_bend_deg is not given"
    assert f"limit from the {default} limit at most 3° (driveshaft catalogues, " in said
    checked = " ".join(run("check", path).output.split())
    assert "above the limit of 3° (default: driveshaft catalogues, section 6.4" in checked
    path.write_text(path.read_text() + "[limits]\nequivalent_bend_deg = 3\n")
    assert "default" not in run("explain", path, "limits.equivalent_bend").output
    assert "default" not in run("check", path).output


def test_every_figure_of_an_answer_can_be_explained() -> None:
    path = example("slip.toml")
    answer = Answer(load_scene(path))
    for part, found in answer.parts("check"):
        for entry in part.entries(found):
            said = explain_text(answer, entry.path, path)
            assert entry.row.meaning in " ".join(said.split())


def test_explain_names_the_keys_that_there_are() -> None:
    refused = run("explain", example("slip.toml"), "spline.travels")
    assert refused.exit_code == 2
    assert "KEY is 'spline.travels'; did you mean spline.travel or " in refused.stderr
    for label_or_limit in ("steering.asymmetry", "steering.ratio_percent", "asymmetry_of"):
        refused = run("explain", example("steering-column.toml"), label_or_limit)
        assert "; did you mean steering.difference?\n" in refused.stderr
    refused = run("explain", example("slip.toml"), "zzz")
    assert "KEY is 'zzz'; the keys of this answer begin with " in refused.stderr


def test_explain_names_what_a_preset_has(into: Path) -> None:
    scene = into / "a.toml"
    scene.write_text('driveline.bends_deg = [4, 4]\nlimits.preset = "spicer"\n', encoding="utf-8")
    assert "presets.spicer.rule?" in run("explain", scene, "presets.spicer").stderr


def test_new_names_the_command_that_a_starter_names() -> None:
    named = {kind: re.search(r"cardan (\w+) {name}", STARTERS[kind].text) for kind in STARTERS}
    own = {kind: found[1] for kind, found in named.items() if found}
    # The shaft shows what its yokes do before they are set.
    assert own.pop("z-shaft") == "phase"
    assert own == {kind: STARTERS[kind].command for kind in own}
    assert set(own.values()) == {"run", "check", "phase", "lateral"}


# The scenes of the other machines are examples, which `new` copies.
@pytest.mark.parametrize(
    "kind",
    few(
        [kind for kind in STARTERS if kind == "steering-column" or not STARTERS[kind].machine],
        ["recorded", "steering-column", "ball-joint"],
    ),
)
def test_new(kind: str, into: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(into)
    result = run("new", kind, "first.toml")
    assert result.exit_code == 0, result.output
    *wrote, following = result.output.splitlines()
    assert wrote == [f"wrote {name}" for name in ("first.toml", "first_run.csv")[: len(wrote)]]
    assert {f"wrote {entry.name}" for entry in into.iterdir()} == set(wrote)
    text = (into / "first.toml").read_text()
    assert max(map(len, text.splitlines())) <= 100
    assert "{name}" not in text

    assert following == f"next: cardan {STARTERS[kind].command} first.toml"
    assert run(*following.removeprefix("next: cardan ").split()).exit_code in {0, 1}
    done = run("run", "first.toml")
    assert done.exit_code == 0, done.output
    curves = set() if kind == "ball-joint" else {"first.csv"}
    assert {"first.svg", *curves} < {entry.name for entry in into.iterdir()}
    # A check reads the scene too; some machines are beyond a limit as they are drawn.
    assert run("check", "first.toml").exit_code in {0, 1}
    # What stands in comments runs as well.
    (into / "first.toml").write_text(re.sub(r"(?m)^# (?=[a-z]+ = )", "", text))
    assert run("run", "first.toml").exit_code == 0


@pytest.mark.parametrize("kind", [kind for kind in STARTERS if STARTERS[kind].machine])
def test_new_writes_the_scene_of_the_page(
    kind: str, into: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(into)
    shown = example(f"{kind}.toml").read_text("utf-8")
    assert run("new", kind, f"{kind}.toml").exit_code == 0
    assert Path(f"{kind}.toml").read_text("utf-8") == shown
    assert run("new", kind, "mine.toml").exit_code == 0
    mine = Path("mine.toml").read_text("utf-8")
    pairs = zip(shown.splitlines(), mine.splitlines(), strict=True)
    changed = [(old, new) for old, new in pairs if old != new]
    assert len(changed) == 2
    for old, new in changed:
        assert old.replace(f"{kind}.", "mine.") == new


def test_new_overwrites_nothing(into: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(into)
    for name in ("a.toml", "b_run.csv"):
        (into / name).write_text("mine")
    failed(run("new", "joint", "a.toml"), "a.toml: File exists")
    failed(run("new", "recorded", "b.toml"), "b_run.csv: File exists")
    failed(run("new", "joint", "a.txt"), "a.txt must be a file name that ends in .toml")
    failed(run("new", "joint", "no/a.toml"), "no/a.toml: No such file or directory")
    failed(
        run("new", "jiont", "c.toml"),
        "Invalid value for 'KIND': 'jiont' is not one of 'joint', 'z-shaft', 'multi-joint', "
        "'wide-angle', 'readings', 'shudder', 'recorded', 'ball-joint', 'truck-shaft', "
        "'steering-column', 'pto-shaft', 'mill-spindle', 'test-rig', 'ship-shaft'.",
    )
    assert {entry.name: entry.read_text() for entry in into.iterdir()} == {
        "a.toml": "mine",
        "b_run.csv": "mine",
    }


def test_missing_samples_of_a_stream(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("long.toml").write_text(LONG)
    write_columns("angles.parquet", {"angle_deg": np.array([0.0, np.nan, 1.0])})
    result = run("stream", "long.toml")
    assert result.exit_code == 0, result.output
    said = "1 of 3 samples is missing in the recording; their results are NaN."
    assert result.output.splitlines()[-1] == said

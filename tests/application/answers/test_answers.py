"""Answers in JSON by their schema, and printed answers read back, label by label."""

from __future__ import annotations

import itertools
import json
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import pytest

import cardan
import scripts
from cardan.app.answers.answer import Answer
from cardan.app.answers.schema import VERSION, answers_schema
from cardan.app.answers.table import PARTS
from cardan.app.answers.torsion.figures import TorsionFigures, torsion_figures
from cardan.app.answers.torsion.text import brief as torsion_check_text
from cardan.app.scene import Scene, starters
from cardan.design.wrapping import fill
from example_scenes import ANSWERS, Answers, each_driveline, each_example, example
from pages import EXAMPLES, first_number, near, printed, three

ROOT = Path(__file__).parents[3]


SCHEMA = answers_schema()


def answer(command: str, *arguments: str | Path) -> Any:  # noqa: ANN401 - JSON
    result = scripts.run(command, *arguments, "--json")
    assert result.exit_code in (0, 1), result.output
    return json.loads(result.stdout)


def test_schema_is_a_schema() -> None:
    jsonschema.Draft202012Validator.check_schema(SCHEMA)


def objects(schema: Any) -> Iterator[dict[str, Any]]:  # noqa: ANN401 - JSON
    if isinstance(schema, dict):
        if schema.get("type") == "object":
            yield schema
        for value in schema.values():
            yield from objects(value)
    elif isinstance(schema, list):
        for value in schema:
            yield from objects(value)


def test_no_object_has_other_keys() -> None:
    assert all(found["additionalProperties"] is False for found in objects(SCHEMA["$defs"]))


@pytest.mark.parametrize("options", [[], ["--radians"]], ids=["deg", "rad"])
@each_example
def test_examples_answer_by_the_schema(path: Path, options: list[str], answered: Answers) -> None:
    data = answered(path).data("run", *options)
    ANSWERS.validate(data)
    assert (data["answer"], data["version"]) == ("run", VERSION)
    unit = "rad" if options else "deg"
    other = {"rad": "_deg", "deg": "_rad"}[unit]
    found = {key for key in _keys_of(data) if key.endswith(other)}
    assert not {key for key in found if not key.endswith("per_rad")}


@each_driveline
def test_settings_of_the_examples_answer_by_the_schema(path: Path, answered: Answers) -> None:
    line = Scene.load(path).line
    if line.n_joints > 1 and not line.shape:
        ANSWERS.validate(answered(path).data("phase"))


@each_example
def test_verdicts_on_the_examples_answer_by_the_schema(path: Path, answered: Answers) -> None:
    ANSWERS.validate(answered(path).data("check"))


def _keys_of(data: Any) -> Iterator[str]:  # noqa: ANN401 - JSON
    for value in data.values() if isinstance(data, dict) else data:
        if isinstance(value, dict | list):
            yield from _keys_of(value)
    if isinstance(data, dict):
        yield from data


# The machines' scenes are examples.
@pytest.mark.parametrize(
    "kind", [kind for kind, starter in starters.STARTERS.items() if not starter.machine]
)
def test_starters_answer_by_the_schema(kind: str, tmp_path: Path) -> None:
    starters.write_starter(kind, tmp_path / "scene.toml")
    ANSWERS.validate(answer("run", tmp_path / "scene.toml", "--into", tmp_path))


def test_the_schema_refuses_other_answers(tmp_path: Path) -> None:
    data = answer("run", ROOT / "examples" / "foeppl.toml", "--into", tmp_path)
    for change in (
        {"answer": "walk"},
        {"version": VERSION + 1},
        {"more": 1},
        {"rows": [{**data["rows"][0], "value": 1.0}]},
        {"rows": [{key: v for key, v in data["rows"][0].items() if key != "joint"}]},
        {"rows": [{**data["rows"][0], "statistic": "worst"}]},
    ):
        assert not ANSWERS.is_valid({**data, **change})


def test_quantities_are_one_row_each_however_many_shafts(tmp_path: Path) -> None:
    """The keys of a row do not depend on how many shafts there are."""
    text = (
        "[driveline]\nbends_deg = [10, 20]\n[load]\nspeed_rpm = 60\ndrive_torque_Nm = 5\n[output]\n"
    )
    shapes = []
    for shafts in ("", "shafts = [2]", "shafts = [0, 1, 2]"):
        (tmp_path / "scene.toml").write_text(f"{text}{shafts}")
        rows = answer("run", tmp_path / "scene.toml")["rows"]
        last = [row for row in rows if row.get("shaft") == 2]
        shapes.append([(row["quantity"], row["statistic"], row["of"], {*row}) for row in last])
    assert shapes[0] == shapes[1] == shapes[2]
    assert len(shapes[0]) == 10


def columns(text: str, item: str) -> dict[str, str]:
    """Return the column of an item in the table that has it in its head, by the labels."""
    lines = iter(text.splitlines())
    head = next(cells for line in lines if item in (cells := re.split(r"\s{2,}", line.strip())))
    place = head.index(item) - len(head)
    found: dict[str, str] = {}
    label, first = "", 0
    for line in lines:
        indent = len(line) - len(line.lstrip())
        first = first or indent
        name, *cells = re.split(r"\s{2,}", line.strip())
        if len(cells) != len(head):
            break
        label = f"{label}: {name}" if indent > first else name
        found[label] = cells[place]
        label = label.partition(": ")[0]
    return found


@pytest.mark.parametrize("steps", [1, 2])
def test_the_worst_step_is_named_where_there_are_several(steps: int, tmp_path: Path) -> None:
    """Wear and heat of one step are those of the whole duty cycle; of two they have a worst."""
    names, hours, torques = ["slow", "fast"][:steps], [60, 40][:steps], [100, 200][:steps]
    text = (
        "[driveline]\nbends_deg = [10]\n[load]\nspeed_rpm = 600\n"
        "[joints]\nrating_Nm = 500\nfriction = 0.01\npin_radius_mm = 8\narm_mm = 30\n"
        f"[life]\nnames = {names}\nhours = {hours}\noutput_torque_Nm = {torques}\n"
    )
    shown = columns(answered("life", text, tmp_path), "joint 0")
    heat = cardan.Driveline.from_bends([10], degrees=True).losses(
        cardan.Load(output_torque=np.asarray(torques, float), speed=20.0 * np.pi),
        friction=0.01,
        pin_radius=0.008,
        arm=0.03,
    )
    assert shown["heat"] == f"{three(float(np.average(heat.power[0], weights=hours)))} W"
    wear = np.array([60.0, 40.0 * 2.0 ** (10.0 / 3.0)])
    worst = {
        "largest heat": f"{three(float(heat.power[0].max()))} W",
        "largest heat: worst": "in fast",
        "most wear": f"{three(100.0 * wear[1] / wear.sum())}%",
        "most wear: worst": "in fast",
    }
    assert {key: shown[key] for key in worst if key in shown} == (worst if steps > 1 else {})


@pytest.mark.parametrize(("phase", "sense"), [(-0.4, "clockwise"), (0.4, "counter-clockwise")])
def test_a_small_turn_has_its_sense(phase: float, sense: str, tmp_path: Path) -> None:
    """Two equal bends cancel each other at a phase of 0."""
    text = (
        f"[driveline]\nbends_deg = [10, 10]\nphases_deg = [{phase}]\n"
        '[optimise]\nvary = {"phases_deg.0" = "free"}\nminimise = "equivalent_bend"\n'
    )
    words = answered("optimise", text, tmp_path)
    assert f"- turn the output-side yoke of shaft 1 by 0.4° {sense}" in words, words
    # Of a single driveline the first sentence has all; there are no splines.
    assert not re.search("before +after", words)
    assert "teeth" not in words


OPTIMUM = """\
[driveline]
bends_deg = [10, 6]
[load]
speed_rpm = 1500
drive_torque_Nm = 300
[states]
names = ["low", "high"]
"bends_deg.0" = [9, 11]
[optimise]
vary = {"bends_deg.1" = [-2, 8]}
"""


@pytest.mark.parametrize(
    ("was", "instead", "words"),
    [
        ("", "", "No range and no limit keeps it from being better."),
        ("[-2, 8]", "[-2, 1]", "bends_deg.1 is at the upper end of its range, a change of 1°."),
        ("6]", "14]", "bends_deg.1 is at the lower end of its range, a change of -2°."),
    ],
)
def test_what_keeps_an_optimum_from_being_better(
    was: str, instead: str, words: str, tmp_path: Path
) -> None:
    text = answered("optimise", OPTIMUM.replace(was, instead, 1) if was else OPTIMUM, tmp_path)
    found = re.search(r"bends_deg\.1: (\d+) → ([\d.]+)°", text)
    assert found, text
    before, after = map(float, found.groups())
    change = f"{abs(after - before):.4g}°"
    assert f"{'increase' if after > before else 'reduce'} the bend of joint 1 by {change}" in text
    assert [line for line in text.splitlines() if line.startswith("- ")][1:] == [f"- {words}"]
    bends = [[[first, last] for first in (9.0, 11.0)] for last in (after - 0.1, after, after + 0.1)]
    largest = cardan.Driveline.from_bends(bends, degrees=True).equivalent().bend.max(axis=-1)
    better = [bool(largest[place] < largest[1]) for place in (0, 2)]
    assert better == ["lower" in words, "upper" in words]


SECTIONS = {
    "bearings": "forces",
    "worn_joints": "backlash",
    "slip": "spline",
    "axial_travel": "axial_travel",
    "steering-column": "steering",
}


@pytest.mark.parametrize("name", SECTIONS)
def test_sections_of_a_scene_are_printed_once(name: str, tmp_path: Path) -> None:
    scene = Scene.load(example(f"{name}.toml"))
    answer, part = Answer(scene), PARTS[SECTIONS[name]]
    section = part.text(answer[part.name])
    ran, checked = printed("run", name, "--into", tmp_path), printed("check", name)
    for text in (ran, checked):
        assert text.count(f"\n\n{section}\n") == 1
    assert ran.startswith(f"{scene.title}\n\n")
    # Below a blank line, every file that is written, tables with the number of their rows.
    *_, last = ran.split("\n\n")
    assert last.startswith("wrote ")
    written = dict(re.findall(r"^wrote (.*?)(?: \((\d+) rows\))?$", last, re.M))
    assert set(map(Path, written)) == set(tmp_path.iterdir()) != set()
    for path, count in written.items():
        lines = Path(path).read_text(encoding="utf-8").count("\n")
        assert count == (f"{lines - 1}" if path.endswith(".csv") else "")


@pytest.mark.parametrize(("turns", "is_short"), [(0.49, True), (0.5, False)])
def test_a_sweep_of_half_a_turn_has_all_extremes(
    turns: float, is_short: bool, tmp_path: Path
) -> None:
    text = f"[driveline]\nbends_deg = [9]\n[sweep]\nturns = {turns}\n"
    said = answered("run", text, tmp_path)
    assert ("; the scene sweeps 0° to " in said) == is_short
    assert ("An extreme that the sweep does not reach has no angle." in said) == is_short


@pytest.mark.parametrize(("bends", "limit"), [([5, 5], 2.0), ([3], 3.0)])
def test_a_permitted_tolerance_is_the_largest(
    bends: list[int], limit: float, tmp_path: Path
) -> None:
    """At its last digit the limit is not exceeded, at the next one it is; it may be 0."""
    given = [0.0] * (len(bends) - 1) + [0.1]
    text = (
        f"[driveline]\nbends_deg = {bends}\n[limits]\nequivalent_bend_deg = {limit}\n"
        f"[tolerances]\nbends_deg = {given}\nsamples = 100\n"
    )
    words = " ".join(answered("tolerances", text, tmp_path).split())
    pattern = rf"Every driveline is within {limit:g}° if the bends are exact to ±([\d.]+)°\."
    found = re.search(pattern, words)
    assert found, words
    assert f"As drawn, the driveline is within the {limit:g}° limit." in words
    permitted = float(found[1])
    assert (permitted == 0.0) == (len(bends) == 1)
    ends = [[*bends[:-1], bends[-1] + permitted * (1.0 + more)] for more in (0.0, 0.003)]
    ends[1][-1] += 0.003 * (permitted == 0.0)
    line = cardan.Driveline.from_bends(ends, degrees=True)
    least, most = np.degrees(line.equivalent().bend).tolist()
    assert least <= limit * (1.0 + 1e-12)
    assert most > limit


@pytest.mark.parametrize("most", [90, 360, 500])
def test_a_recording_that_goes_back_and_forth(most: int, tmp_path: Path) -> None:
    """The extent of the angles is printed, also of a swing within a turn."""
    angles = [*range(0, most), *range(most, 20, -1)]
    (tmp_path / "a.csv").write_text("deg\n" + "\n".join(map(str, angles)), encoding="utf-8")
    (tmp_path / "a.toml").write_text(
        "[driveline]\nbends_deg = [8]\n[angles]\nfile = 'a.csv'\nangle_column_deg = 'deg'\n",
        encoding="utf-8",
    )
    result = scripts.run("run", tmp_path / "a.toml", "--into", tmp_path)
    assert result.exit_code == 0, result.output
    turns, samples = (2 * most - 21) / 360.0, 2 * most - 20
    assert (
        f"In these {samples} samples, first 0°, last 21°, least 0°, largest {most}°, "
        f"{turns:.4g} turns forward and back, 360 samples per turn"
    ) in " ".join(result.output.split())
    assert max(map(len, result.output.splitlines())) <= 79
    # However short, a recording is no sweep that could pass by an extreme.
    assert "the sweep" not in result.output


@pytest.mark.parametrize("start", [0.0, 1_700_000_000.0])
def test_times_of_a_recording_have_the_digits_that_tell_them_apart(
    start: float, tmp_path: Path
) -> None:
    time = start + 0.004 * np.arange(626)
    lines = [f"{t:.3f},{10.0 * i}" for i, t in enumerate(time)]
    (tmp_path / "a.csv").write_text("s,deg\n" + "\n".join(lines), encoding="utf-8")
    text = (
        "[driveline]\nbends_deg = [8]\n"
        "[angles]\nfile = 'a.csv'\nangle_column_deg = 'deg'\ntime_column_s = 's'\n"
    )
    said = " ".join(answered("run", text, tmp_path).split())
    found = re.search(r"([\d.]+) to ([\d.]+) s\b", said)
    assert found, said
    assert [float(end) for end in found.groups()] == [start, start + 2.5]
    assert "250.0 samples per second" in said


def answered(command: str, text: str, folder: Path) -> str:
    path = folder / "a.toml"
    path.write_text(text, encoding="utf-8")
    into = ["--into", str(folder)] if command == "run" else []
    return scripts.run(command, path, *into).output


# --- widths ---------------------------------------------------------------------------------------

SENTENCES = [
    "with these tolerances 99.83 % of the drivelines are within it",
    "move joint 1 by 40 mm along -y and by 12.4 m along +x",
    "the axial force is 19247 N and the torque 139.2 to 221.3 N m at 3030 rpm",
    "accelerations from -65 to 193 rad/s² and an inertia of 0.02 kg m² at 1200 rad/s",
]


PARTED = re.compile(r"(?:\d\n(?:%|mm|m|N|rpm|rad/s²?|kg)\b|\d\n%|N\nm\b|kg\nm)")


@pytest.mark.parametrize("text", SENTENCES)
def test_no_width_parts_a_number_from_its_unit(text: str) -> None:
    for width in range(24, 80):
        filled = fill(text, width)
        assert not PARTED.search(filled), filled
        assert max(map(len, filled.splitlines())) <= width
        assert filled.replace("\n", " ") == text


torsion_text = PARTS["torsion"].text


def table(found: TorsionFigures, heading: str) -> list[list[str]]:
    """Return the cells below a heading of the printed answer."""
    lines = torsion_text(found).partition(f"\n  {heading}\n")[2].splitlines()
    shown = itertools.takewhile(lambda line: line.startswith("    "), lines)
    return [re.split(r"\s{2,}", line.strip()) for line in shown]


@pytest.mark.parametrize(("first", "words"), [(1200, "a critical speed lies"), (600, "critical")])
def test_a_check_names_the_critical_speeds_in_the_range(first: int, words: str) -> None:
    """Of even order, each at the natural frequency over the order."""
    text = (EXAMPLES / "rig_torsion.toml").read_text(encoding="utf-8")
    ends = f"from = {first}, to = 1800"
    basics = Answer(Scene.parse(text.replace("from = 500, to = 4000", ends)))["torsion"]
    assert basics
    (mode,) = basics.modes
    speeds = {order: mode.frequency / order * 30.0 / np.pi for order in (2, 4, 6, 8, 10)}
    inside = {order: speed for order, speed in speeds.items() if first <= speed <= 1800}
    assert len(inside) == (1 if first == 1200 else 2)
    said = " ".join(torsion_check_text(basics).split())
    assert f"{words} " in said
    assert ("critical speeds lie" in said) == (len(inside) > 1)
    shown = re.findall(r"order (\d+) at ([\d.]+) rpm \(shaft", said)
    assert {int(order): float(rpm) for order, rpm in shown} == pytest.approx(inside, rel=1e-3)
    assert f"within {first} to 1800 rpm:" in said


@pytest.mark.parametrize(
    ("first", "last", "inside"),
    [(0.5, 0.99, False), (0.5, 1.01, True), (0.99, 1.5, True), (1.01, 1.5, False)],
)
def test_unstable_motion_outside_the_speeds_of_the_scene_is_named_as_such(
    first: float, last: float, inside: bool
) -> None:
    """Of order 2, between the natural frequency times 1 - bend²/4 and times 1 + bend²/4."""
    text = (EXAMPLES / "rig_torsion.toml").read_text(encoding="utf-8")
    basics = Answer(Scene.parse(text))["torsion"]
    assert basics
    (mode,), half = basics.modes, np.radians(25.0) ** 2 / 4.0
    edge = mode.frequency * 30.0 / np.pi * (1.0 - half if first == 0.5 else 1.0 + half)
    ends = f"from = {first * edge}, to = {last * edge}"
    basics = Answer(Scene.parse(text.replace("from = 500, to = 4000", ends)))["torsion"]
    assert basics
    said = " ".join(torsion_check_text(basics).split())
    assert "permits unstable motion near 3030 rpm" in said
    assert (" rpm, outside the speed range, because" in said) != inside


@pytest.mark.parametrize("ratio", [0.02, 0.005])
def test_a_permitted_bend_is_the_largest_within_the_rule(ratio: float) -> None:
    """With hundredths of a degree: ``tan²(bend/2)`` is at most the damping ratio."""
    text = f"""\
    [driveline]
    bends_deg = [20]
    [torsion]
    inertias_kgm2 = [0, [0, 0.05]]
    stiffnesses_Nm_per_rad = [8000, "rigid"]
    speed_rpm = {{from = 3000, to = 4500, steps = 40}}
    damping_ratio = {ratio}
    """
    said = " ".join(torsion_text(torsion_figures(Scene.parse(text))).split())
    found = re.search(r"bend behind shaft 0 of at most (\S+)° instead of 20°", said)
    assert found
    bend = float(found[1])
    assert np.tan(np.radians(bend) / 2.0) ** 2 <= ratio
    assert np.tan(np.radians(bend + 0.01) / 2.0) ** 2 > ratio


def needed(name: str) -> TorsionFigures:
    found = torsion_figures(Scene.load(EXAMPLES / f"{name}.toml"))
    assert found
    return found


def test_largest_torques() -> None:
    found = needed("truck_torsion")
    shafts, speeds, *ends = table(found, "Largest torques")
    assert [label for label, *_ in ends] == ["least torque", "largest torque", "mean torque"]
    system = found.torsion.system
    speed = np.linspace(500.0, 3000.0, 2501)
    steady = system.steady(speed * np.pi / 30.0)
    for place, shaft in enumerate(shafts):
        assert shaft == f"shaft {system.compliant[place]}"
        rpm, least, most, mean = (first_number(row[place + 1]) for row in (speeds, *ends))
        at = int(np.argmax(np.fmax(steady.torque_max, -steady.torque_min)[place]))
        assert rpm == pytest.approx(speed[at], abs=1.0)
        assert least == pytest.approx(steady.torque_min[place, at], rel=2e-3)
        assert most == pytest.approx(steady.torque_max[place, at], rel=2e-3)
        assert mean == pytest.approx(steady.torque_mean[place, at], rel=5e-3)
    sentences = " ".join(torsion_text(found).rpartition("\n\n")[2].split())
    largest = max(found.largest, key=lambda torque: torque.size)
    ratio = largest.size / abs(largest.mean)
    (said,) = re.findall(r"in shaft 1 at \d+ rpm, ([\d.]+) times the mean torque there", sentences)
    assert ratio == near(said)
    # The worst critical speed of the table, with the amplitude that stands there.
    amplitudes = {
        first_number(amplitude): speed
        for _, _, speed, _, inside, amplitude, _ in table(found, "Critical speeds")[1:]
        if inside == "yes"
    }
    worst = max(amplitudes)
    assert f"The range contains {len(amplitudes)} critical speeds; the worst is" in sentences
    assert f"at {amplitudes[worst]}, where this order of the torque of shaft 2 is" in sentences
    assert f"is ±{worst:.0f} N m." in sentences

"""Printed answers read back: each label beside a number that a formula or the library gives."""

from __future__ import annotations

import csv
import re
import tomllib
from pathlib import Path
from typing import TypeVar

import numpy as np
import pytest
from click.testing import CliRunner

import cardan
from cardan.app.answers.answer import Answer
from cardan.app.answers.axial_travel import drawn_slides
from cardan.app.answers.life.figures import LifeFigures, needed
from cardan.app.answers.optimise.figures import optimised
from cardan.app.answers.printed import quantity
from cardan.app.answers.table import PARTS
from cardan.app.command import commands
from cardan.app.scene import Scene
from cardan.design.wrapping import fill, wrap
from example_scenes import example
from heights import HEIGHTS, NAMES, SPEED, drivelines, scene_text
from pages import EXAMPLES, blocks, first_number, near, printed, rows, three

_Figures = TypeVar("_Figures")


def conveyor() -> LifeFigures:
    return needed(Answer(Scene.load(EXAMPLES / "conveyor.toml")))


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


def test_life_of_joints() -> None:
    text = printed("life", "conveyor")
    given = tomllib.loads((EXAMPLES / "conveyor.toml").read_text(encoding="utf-8"))
    with open(EXAMPLES / "joint_sizes.csv", encoding="utf-8", newline="") as file:
        sizes = {row["size"]: row for row in csv.DictReader(file)}
    duty, own = given["life"], sizes[given["joints"]["size"]]
    found = conveyor()
    # Palmgren and Miner: turns times the power 10/3 of the torque.
    wear = [
        hours * speed * torque ** (10.0 / 3.0)
        for hours, speed, torque in zip(
            duty["hours"], duty["speed_rpm"], duty["output_torque_Nm"], strict=True
        )
    ]
    most = int(np.argmax(wear))
    for joint, bend in enumerate(given["driveline"]["bends_deg"]):
        shown = columns(text, f"joint {joint}")
        assert shown["size"] == own["size"]
        assert shown["rating"] == f"{own['rating_Nm']} N m"
        assert shown[f"largest bend, at most {own['max_bend_deg']}°"] == f"{bend}.00°"
        product = f"{bend * max(duty['speed_rpm'])} rpm·deg"
        limit = f"at most {own['max_speed_bend_rpm_deg']} rpm·deg"
        assert shown[f"largest speed times bend, {limit}"] == product
        assert shown["most wear"] == f"{three(100.0 * wear[most] / sum(wear))}%"
        assert shown["most wear: worst"] == f"in {duty['names'][most]}"
        figures = found.joints[joint]
        assert figures.hours
        assert figures.hours.value
        assert figures.catalogue
        assert figures.heat
        assert figures.heat.value
        assert figures.largest_heat
        assert figures.largest_heat.value
        assert shown["L10 life, at least 8000 h"] == f"{figures.hours.value:.0f} h"
        assert shown["L10 life by the catalogue"] == f"{figures.catalogue:.0f} h"
        assert figures.hours.value < figures.catalogue
        assert figures.heat.value < figures.largest_heat.value
        assert shown["heat"] == quantity(figures.heat.value, "W")
        assert shown["largest heat"] == quantity(figures.largest_heat.value, "W")
        assert shown["largest heat: worst"] == f"in {figures.largest_heat.state}"


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


def test_duty_cycle_and_sizes() -> None:
    text = printed("life", "conveyor")
    given = tomllib.loads((EXAMPLES / "conveyor.toml").read_text(encoding="utf-8"))
    duty = given["life"]
    names, *shown = rows(text, "  Duty cycle")[: 5 + 2]
    assert " ".join(names) == " ".join(duty["names"])
    labels, cells = [row[0] for row in shown], [row[1:] for row in shown]
    assert labels == [
        *("share of the time", "speed", "torque", "at", "bend of joint 0", "bend of joint 1")
    ]
    for i in range(3):
        assert [first_number(row[i]) for j, row in enumerate(cells) if j != 3] == [
            *(duty[key][i] for key in ("hours", "speed_rpm", "output_torque_Nm")),
            *given["driveline"]["bends_deg"],
        ]
    found = conveyor()
    hours_of = {one.size: one.hours for one in found.sizes}
    heat = sum(joint.heat.value for joint in found.joints if joint.heat and joint.heat.value)
    with open(EXAMPLES / "joint_sizes.csv", encoding="utf-8", newline="") as file:
        sizes = list(csv.DictReader(file))
    table = np.transpose([row[-len(sizes) :] for row in rows(text, "  Sizes")])
    assert len(table) == len(sizes)
    for column, size in zip(table.tolist(), sizes, strict=True):
        # The bends are 12° and 18°, at up to 1500 rpm.
        fits = float(size["max_bend_deg"]) >= 18.0
        fits = fits and float(size["max_speed_bend_rpm_deg"]) >= 27_000.0
        assert column == [
            *(size["size"], f"{float(size['rating_Nm']):g} N m"),
            *(f"{hours_of[size['size']]:.0f} h", "1", "yes" if fits else "no"),
            f"{three(heat)} W",
        ]
    # What is chosen is the smallest size that lasts and fits.
    assert (
        f"L10 life {found.hours:.0f} h, below the required 8000 h; joint 1 fails first; size "
        f"1550 would give {hours_of['1550']:.0f} h."
    ) in " ".join(text.split())


def test_tube() -> None:
    shown = columns(printed("life", "conveyor"), "shaft 1")
    tube = cardan.tube(0.09, 0.003, length=1.5)
    assert shown["torsional stiffness"] == f"{three(float(tube.stiffness))} N m/rad"
    assert shown["moment of inertia"] == f"{three(float(tube.inertia))} kg m²"
    # In the start 700 N m at the output; joint 1, bent by 18°, lifts the torque of shaft 1.
    torque = 700.0 / np.cos(np.radians(18.0))
    assert shown["largest torque"] == f"{three(torque)} N m"
    assert shown["largest torque: worst"] == "in start"
    area = np.pi / 32.0 * (0.09**4 - 0.084**4)
    stress = 1e-6 * torque * 0.045 / area
    assert shown["shear stress, at most 60 MPa"] == f"{stress:.1f} MPa"
    assert shown["critical bending speed"].endswith(" rpm")
    margin = first_number(shown["critical bending speed"]) / 1500.0
    assert shown["largest speed"] == "1500 rpm"
    assert margin == near(shown["margin, at least 1.5"])
    over = printed("life", "ship-shaft")
    shown = columns(over, "shaft 1")
    stress_there = shown["shear stress, at most 60 MPa"]
    assert first_number(stress_there) > 60.0
    words = f"The shear stress in the tube of shaft 1 is {stress_there} in heavy sea, beyond the "
    assert words in " ".join(over.split())


def test_figures_before_and_after(tmp_path: Path) -> None:
    text = printed("optimise", "truck_heights", "--to", tmp_path / "a.toml")
    before, after = (
        np.degrees(Scene.load(path).drivelines().equivalent().bend)
        for path in (EXAMPLES / "truck_heights.toml", tmp_path / "a.toml")
    )
    scene = Scene.load(EXAMPLES / "truck_heights.toml")
    assert scene.states
    head, *lines = rows(text, "\nEquivalent bend")
    assert head == ["before", "after"]
    assert [line[0] for line in lines] == list(scene.states.names)
    assert before.tolist() == [near(line[1]) for line in lines]
    assert after.tolist() == [near(line[2]) for line in lines]
    assert (
        f"Equivalent bend, largest of 9 states: {before.max():.2f}° before, "
        f"{after.max():.2f}° after." in text
    )
    # The changes that the sentences name are those of the scene that is written.
    old, new = (
        tomllib.loads(path.read_text(encoding="utf-8"))["driveline"]
        for path in (EXAMPLES / "truck_heights.toml", tmp_path / "a.toml")
    )
    rise = new["points_mm"][2][1] - old["points_mm"][2][1]
    assert rise < 0.0
    assert f"- move joint 1 by {round(-rise, 1):g} mm along -y (points_mm.2.y:" in text
    turn = new["phases_deg"][0] - old["phases_deg"][0]
    assert turn < 0.0
    teeth = -turn / 360.0 * scene.options.get("teeth", 24)
    assert f"of shaft 1 by {teeth:g} teeth counter-clockwise ({-turn:.1f}°)" in text
    assert new["phases_deg"][1] == old["phases_deg"][1]
    assert "- leave the output-side yoke of shaft 2 as it is (phases_deg.1)" in text
    assert text.count("\n- Yokes are set by whole teeth of their splines.\n") == 1


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


def test_a_limit_that_an_optimum_meets_is_named_with_its_state(tmp_path: Path) -> None:
    text = answered("optimise", f"{OPTIMUM}keep = {{support_moment_2_peak_Nm = 45}}\n", tmp_path)
    found = re.search(r"bends_deg\.1: 6 → ([\d.]+)°", text)
    assert found, text
    turn, load = np.linspace(0.0, np.pi, 2001), cardan.Load(drive_torque=300.0, speed=SPEED)
    rows_of: dict[str, list[str]] = {}
    for last in (6.0, float(found[1])):
        for name, first in (("low", 9.0), ("high", 11.0)):
            line = cardan.Driveline.from_bends([first, last], degrees=True)
            moment = line.evaluate(turn, "support_moment", load=load).support_moment
            largest = three(float(np.linalg.norm(moment, axis=-1).max()))
            rows_of.setdefault(name, [name]).append(f"{largest} N m")
    scene = Scene.parse(f"{OPTIMUM}keep = {{support_moment_2_peak_Nm = 45}}\n")
    result = optimised(scene)
    assert result
    assert [kept.at_limit for kept in result.kept] == [True]
    head, *shown = rows(text, "Support moment of shaft 2, peak, at most 45 N m")
    turned = [[*row] for row in zip(["", "before", "after"], *rows_of.values(), strict=True)]
    assert [["", *head], *shown] == turned
    assert "- Support moment of shaft 2, peak is at its limit of 45 N m in high." in text


def test_spline() -> None:
    shown = blocks(printed("check", "slip"))["Spline of shaft 1"]

    def length(y: float) -> float:
        return float(np.linalg.norm([1200.0, y, 40.0]))

    rest = length(-110.0)
    lengths = [first_number(shown[f"{name} length"]) for name in ("shortest", "longest")]
    assert first_number(shown["length at the points of the scene"]) == pytest.approx(rest, abs=0.5)
    given = tomllib.loads((EXAMPLES / "slip.toml").read_text(encoding="utf-8"))
    heights = given["study"]["points_mm"]["2-3"]["y"]
    every = [length(y) for y in np.linspace(heights["from"], heights["to"], heights["steps"])]
    assert lengths == pytest.approx([min(every), max(every)], abs=0.5)
    assert shown["longest length"].endswith(" at points_mm.2-3.y = -180")
    travel = max(every) - min(every)
    assert shown["travel"] == f"{travel:.1f} mm; at most 40 mm"
    engaged = 80.0 - (max(every) - rest)
    low, high = " at points_mm.2-3.y = -180", " at points_mm.2-3.y = 0"
    assert shown["engaged length"] == f"{engaged:.1f} mm{low}; at least 65 mm"
    left = 25.0 - (rest - min(every))
    assert shown["left to push in"] == f"{left:.1f} mm{high}; at least 0 mm"
    # The torque of the shaft is largest where joint 1 is bent most; friction 0.12 at 20 mm.
    cosine = 1200.0 / length(-180.0)
    torque = 400.0 / cosine
    force = 0.12 * torque / 0.02
    place = " at points_mm.2-3.y = -180"
    assert shown["largest torque of the shaft"] == f"{three(torque)} N m{place}"
    assert shown["largest axial force"] == f"{three(force)} N"
    along, across = force * cosine, force * np.sqrt(1.0 - cosine**2)
    assert re.split("  +", shown["force along it"]) == [f"{three(along)} N"] * 2
    assert re.split("  +", shown["force across it"]) == [f"{three(across)} N"] * 2


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


def test_a_check_has_the_verdict_of_every_state(tmp_path: Path) -> None:
    text = answered("check", scene_text(20.0, "[limits]\nequivalent_bend_deg = 4"), tmp_path)
    bends = [float(np.degrees(line.equivalent().bend)) for line in drivelines(20.0)]
    _, _, table = text.partition("Motion in each state\n")
    _, *rows = (" ".join(line.split()) for line in table.split("\n\n")[0].splitlines())
    assert rows == [
        f"{name} {bend:.2f}° {'beyond' if bend > 4.0 else 'within'}"
        for name, bend in zip(NAMES, bends, strict=True)
    ]


@pytest.mark.parametrize(("turns", "is_short"), [(0.49, True), (0.5, False)])
def test_a_sweep_of_half_a_turn_has_all_extremes(
    turns: float, is_short: bool, tmp_path: Path
) -> None:
    text = f"[driveline]\nbends_deg = [9]\n[sweep]\nturns = {turns}\n"
    said = answered("run", text, tmp_path)
    assert ("; the scene sweeps 0° to " in said) == is_short
    assert ("An extreme that the sweep does not reach has no angle." in said) == is_short


def _columns(text: str, heading: str) -> dict[str, dict[str, str]]:
    """The table below a heading: by its rows, then by its columns."""
    below = text.partition(f"  {heading}\n")[2]
    table = re.match(r"(?:    .*\n)+", below)
    assert table
    head, *rows = (re.split(r" {2,}", line.strip()) for line in table[0].splitlines())
    return {label: dict(zip(head, cells, strict=True)) for label, *cells in rows}


@pytest.mark.parametrize("name", ["workshop", "mill-spindle"])
def test_tolerances(name: str) -> None:
    text = printed("tolerances", name)
    given = tomllib.loads((example(f"{name}.toml")).read_text(encoding="utf-8"))["tolerances"]
    lines = dict(re.findall(r"^ *(\S.*?)  +(\S.*)$", text, re.M))
    sizes = _columns(text, "Given")["largest tolerance, ±"]
    for key, group in (("bends_deg", "bends"), ("phases_deg", "phases"), ("points_mm", "points")):
        assert (group in sizes) == (key in given)
        if key in given:
            assert first_number(sizes[group]) == pytest.approx(given[key], rel=1e-3)
            assert sizes[group].endswith(" mm" if group == "points" else "°")
    tolerances = Scene.load(example(f"{name}.toml")).tolerances
    assert tolerances
    sampled = np.degrees(np.asarray(tolerances.ascending))
    shares = {"half of the drivelines up to": 0.5, "95% up to": 0.95, "99% up to": 0.99}
    for label, share in shares.items():
        at = sampled[int(share * (len(sampled) - 1))]
        assert at == near(lines[label])
    worst = first_number(lines["worst with tolerances, at most 3°"])
    assert worst >= sampled[-1]
    assert first_number(lines["guaranteed bound"]) >= worst
    passing = 100.0 * np.mean(sampled <= 3.0)
    assert first_number(lines["share within the limit"]) == pytest.approx(passing, abs=0.06)
    # The largest share is named, and whether it is more than half of the scatter.
    table = _columns(text, "Shares in the scatter")
    parts = {label: cells["share in the scatter"] for label, cells in table.items()}
    most, percent = max(parts.items(), key=lambda part: first_number(part[1]))
    words = "mostly" if first_number(percent) > 50.0 else "the largest share"
    article = "" if most.startswith("point ") else "the "
    assert f", {words} from {article}{most}." in " ".join(text.split())


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
    result = CliRunner().invoke(
        commands(), ["run", str(tmp_path / "a.toml"), "--into", str(tmp_path)]
    )
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


def test_slides_are_printed_in_millimetres() -> None:
    travels = drawn_slides(Scene.load(EXAMPLES / "axial_travel.toml")).travel()
    want = " +".join(f"{three(travel)} mm" for travel in travels)
    assert re.search(rf"Driven shafts.*\n.*\n +travel +{want}\n", printed("check", "axial_travel"))


LIMIT = "[limits]\nequivalent_bend_deg = 6"


def answered(command: str, text: str, folder: Path) -> str:
    path = folder / "a.toml"
    path.write_text(text, encoding="utf-8")
    into = ["--into", str(folder)] if command == "run" else []
    return CliRunner().invoke(commands(), [command, str(path), *into]).output


def test_the_tables_of_states_have_all_figures(tmp_path: Path) -> None:
    text = answered("run", scene_text(60.0), tmp_path)
    cells: dict[str, dict[str, str]] = {}
    for part in text.split("\n\n"):
        if part.startswith("States "):
            head, *below = (words.split() for words in part.splitlines())
            for row in below:
                cells.setdefault(row[0], {}).update(zip(head[1:], row[1:], strict=True))
    assert tuple(cells) == NAMES
    load = cardan.Load(drive_torque=300.0, speed=SPEED)
    turn = np.linspace(0.0, np.pi, 20_001)
    for name, height, line in zip(NAMES, HEIGHTS, drivelines(60.0), strict=True):
        joint = line.equivalent()
        torque = line.evaluate(turn, "torque", load=load).torque
        moments = [
            np.linalg.norm(line.evaluate(turn, "moment", load=load, joints=j).moment, axis=-1)
            for j in (0, 1)
        ]
        assert cells[name] == {
            "points_mm.2-3.y": f"{height:g}",
            "equivalent_bend_deg": f"{float(np.degrees(joint.bend)):.2f}",
            "non_uniformity": three(float(joint.non_uniformity)),
            "max_angle_error_deg": three(float(np.degrees(joint.max_angle_error))),
            "torque_peak_Nm": three(float(torque.max())),
            "moment_0_peak_Nm": three(float(moments[0].max())),
            "moment_1_peak_Nm": three(float(moments[1].max())),
        }
    largest = blocks(text)["Largest over the states"]
    bends = [line.equivalent().bend for line in drivelines(60.0)]
    worst = int(np.argmax(bends))
    bend = f"{float(np.degrees(bends[worst])):.2f}"
    assert largest["equivalent_bend_deg"] == f"{bend} in {NAMES[worst]}"


def test_the_advice_for_states_leaves_what_it_says(tmp_path: Path) -> None:
    text = " ".join(answered("check", scene_text(60.0, LIMIT), tmp_path).split())
    advice = re.search(
        r"Turn the output-side yoke of shaft 1 by (\S+)° (clockwise|counter-clockwise) = \S+ "
        r"(?:counter-)?clockwise: everything is then within its limits\.",
        text,
    )
    assert advice, text
    turn = float(advice[1]) * (1.0 if advice[2] == "clockwise" else -1.0)
    bends = [float(np.degrees(line.equivalent().bend)) for line in drivelines(60.0 + turn)]
    worst = int(np.argmax(bends))
    # The smallest turn that suffices leaves the worst state at the limit; the text has tenths.
    turned = [
        float(np.degrees(line.equivalent().bend))
        for line in drivelines(60.0 + turn - 0.1 * np.sign(turn))
    ]
    assert bends[worst] <= 6.0 < max(turned)


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


def test_a_word_after_a_number_is_no_unit() -> None:
    assert wrap("state 0 moves", 8) == ["state 0", "moves"]
    assert wrap("joint 1 may turn", 8) == ["joint 1", "may turn"]
    assert wrap("shaft 2 has 3 splines", 7) == ["shaft 2", "has 3", "splines"]

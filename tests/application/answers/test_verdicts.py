"""One verdict wherever it is told, and single changes that bring everything within its limits."""

from __future__ import annotations

import json
import math
import re
import tomllib
from collections import Counter
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner

import scripts
import tiers
from cardan.app.answers.answer import Answer, JudgedFigure
from cardan.app.answers.limits import verdict_text
from cardan.app.answers.over import check_scene
from cardan.app.answers.rows import element_of, rows_of
from cardan.app.answers.table import PARTS, Part
from cardan.app.command import commands
from cardan.app.report import write_report
from cardan.app.scene import Scene, load_scene
from cardan.design.check import Check
from cardan.driveline import Driveline
from example_scenes import Answers, each_example, example
from scene_values import as_toml

MOTION = """
[driveline]
bends_deg = [6, 4]
phases_deg = 90
[load]
speed_rpm = 1500
output_torque_Nm = 120
"""


POINTS = """
[driveline]
points_mm = [[0, 0, 0], [300, 0, 0], [900, 60, 20], [1300, 60, 0]]
[load]
speed_rpm = 1500
output_torque_Nm = 120
[[bearing]]
shaft = 0
position_mm = 50
[[bearing]]
shaft = 0
position_mm = 200
[[bearing]]
shaft = 2
position_mm = 100
[[bearing]]
shaft = 2
position_mm = 300
[limits]
equivalent_bend_deg = 60
"""


STATES = """
[states]
names = ["up", "down"]
points_mm.2.y = [90, 30]
"""


COLUMN = """
[driveline]
bends_deg = [20, 30]
twists_deg = 40
phases_deg = 10
[limits]
equivalent_bend_deg = 60
[steering]
centre_deg = 25
"""


TUBES = f"{POINTS}{STATES}[tubes]\nouter_diameter_mm = 40\nwall_mm = 2\n"


SPLINE = f"{POINTS}{STATES}[slip]\nshaft = 1\nengaged_mm = 60\n"


WIDE = f"{MOTION}[limits]\nequivalent_bend_deg = 60\n"


JOINTS = f"{WIDE}[joints]\n"


RUBS = "friction = 0.05\npin_radius_mm = 10\narm_mm = 30\nrating_Nm = 300\n"


RIG = """
[driveline]
bends_deg = 25
[tubes]
shafts = [0]
outer_diameter_mm = 25
length_mm = 600
[limits]
equivalent_bend_deg = 60
[torsion]
inertias_kgm2 = [0, [0, 0.05]]
load_torque_Nm = 10
speed_rpm = {from = 900, to = 1300, steps = 3}
"""


# An engine of three cylinders and a rubber coupling, unstable beyond its resonance.
ENGINE = """
[driveline]
bends_deg = [0, 30]
[limits]
equivalent_bend_deg = 60
[torsion]
drive = "free"
drive_slope_Nms_per_rad = 0.02
inertias_kgm2 = [[0.3, 0.01], 0, [0, 0.05]]
dampings_Nms_per_rad = [3, 0, 0]
load_torque_Nm = 30
speed_rpm = {from = 1500, to = 2500, steps = 5}
{limit}
[[torsion.harmonic]]
order = 1.5
amplitude_Nm = 20
[[torsion.coupling]]
shaft = 0
stiffness_Nm_per_rad = 8000
"""


# A rigid two-piece shaft on rubber, above its shudder.
RUBBER = """
[driveline]
points_mm = [[0, 0, 0], [300, 0, 0], [1500, 0, 0], [3200, -250, 0], [3500, -260, 0]]
[load]
drive_torque_Nm = 800
[[bearing]]
shaft = 1
from_end_mm = 150
stiffness_N_per_mm = 300
loss_factor = 0.1
[limits]
equivalent_bend_deg = 60
{limits}
[lateral]
speed_rpm = {{from = 900, to = 1100, steps = 5}}
{lateral}
[[lateral.rigid]]
shaft = 1
mass_kg = 14
[[lateral.rigid]]
shaft = 2
mass_kg = 18
"""


BALL = """
[ball_joint]
load_N = 5000
radius_mm = 20
{part} = {{allowable_pressure_MPa = {limit!r}}}
"""


def in_section(text: str, key: str) -> Callable[[float], str]:
    """Return what adds a limit to the last section of a scene."""
    return lambda limit: f"{text}{key} = {limit!r}\n"


# A scene for each key of a limit: its text, to which the limit is added.
LIMITED: dict[str, Callable[[float], str]] = {
    "[limits] equivalent_bend_deg": lambda x: f"{MOTION}[limits]\nequivalent_bend_deg = {x!r}\n",
    "[limits] bend_difference_deg": in_section(WIDE, "bend_difference_deg"),
    "[limits] torsional_excitation_rad_s2": lambda x: (
        f"{WIDE}torsional_excitation_rad_s2 = {x!r}\n"
    ),
    "[limits] inertia_excitation_rad_s2": in_section(WIDE, "inertia_excitation_rad_s2"),
    "[limits] joint_force_N": lambda x: f"{POINTS}joint_force_N = {x!r}\n{STATES}",
    "[limits] bearing_force_N": lambda x: f"{POINTS}bearing_force_N = {x!r}\n{STATES}",
    "[limits] lash_deg": lambda x: f"{POINTS}lash_deg = {x!r}\n[joints]\narm_mm=30\nplay_mm=0.02\n",
    "[steering] ratio_percent": in_section(COLUMN, "ratio_percent"),
    "[steering] offset_deg": in_section(COLUMN, "offset_deg"),
    "[torsion] resonance_margin": lambda x: f"{RIG}resonance_margin = {0.01 * x!r}\n",
    "[torsion] unstable_percent": lambda x: ENGINE.replace("{limit}", f"unstable_percent = {x!r}"),
    "[torsion] rattle_percent": lambda x: ENGINE.replace("{limit}", f"rattle_percent = {x!r}"),
    **{
        f"[torsion] coupling.{key}": in_section(ENGINE.replace("{limit}", ""), key)
        for key in ("rated_torque_Nm", "vibratory_torque_Nm", "largest_torque_Nm")
    },
    "[limits] bearing_displacement_mm": lambda x: RUBBER.format(
        limits=f"bearing_displacement_mm = {x!r}", lateral=""
    ),
    "[lateral] resonance_margin": lambda x: RUBBER.format(
        limits="", lateral=f"resonance_margin = {0.01 * x!r}"
    ),
    "[lateral] least_torque_margin": lambda x: RUBBER.format(
        limits="", lateral=f"least_torque_margin = {x!r}"
    ),
    "[tolerances] limit": lambda x: (
        f"{MOTION}[limits]\nequivalent_bend_deg = {x!r}\n[tolerances]\nbends_deg = 0.5\n"
    ),
    "[tolerances] share": lambda x: (
        f"{MOTION}[limits]\nequivalent_bend_deg = 7.25\n[tolerances]\nbends_deg = 0.5\n"
        f"share = {0.01 * x!r}\n"
    ),
    "[tubes] permitted_stress_MPa": in_section(TUBES, "permitted_stress_MPa"),
    "[tubes] least_margin": in_section(TUBES, "least_margin"),
    "[tubes] resonance_margin": lambda x: f"{TUBES}resonance_margin = {0.01 * x!r}\n",
    "[slip] travel_mm": in_section(SPLINE, "travel_mm"),
    "[slip] least_engaged_mm": in_section(SPLINE, "least_engaged_mm"),
    "[life] target_h": lambda x: f"{JOINTS}{RUBS}[life]\ntarget_h = {x!r}\n",
    "[joints] max_bend_deg": in_section(JOINTS, "max_bend_deg"),
    "[joints] max_speed_bend_rpm_deg": in_section(JOINTS, "max_speed_bend_rpm_deg"),
    "[joints] heat_W": lambda x: f"{JOINTS}{RUBS}heat_W = {x!r}\n",
    "[ball_joint] ball.allowable_pressure_MPa": lambda x: BALL.format(part="ball", limit=x),
    "[ball_joint] seat.allowable_pressure_MPa": lambda x: BALL.format(part="seat", limit=x),
}


# Limits that are 0: what is beyond them has come apart or bottoms.
AT_ZERO = {"[slip] push_in_mm"}


def agreed(path: Path) -> Answer:
    """Return the answer to a scene of which all that people see agrees."""
    answer = Answer(load_scene(path))
    printed, data = (scripts.run("check", path, *more) for more in ((), ("--json",)))
    page = path.with_suffix(".html")
    write_report(answer.of, page)
    agree(answer, (printed.exit_code, printed.output), json.loads(data.stdout), page.read_text())
    assert data.exit_code == printed.exit_code
    return answer


def agree(answer: Answer, printed: tuple[int, str], data: dict[str, object], page: str) -> None:
    """The first printed line, the exit status, the JSON and the page say the same."""
    verdict = answer.verdict
    status, text = printed
    assert re.findall(r'data-verdict="([^"]+)"', page) == [verdict] == [data["verdict"]]
    assert status == (1 if verdict == "beyond" else 0)
    assert data["passes"] == (status == 0)
    assert bool(data["beyond"]) == (verdict == "beyond")
    first = " ".join(text.split("\n\n")[0].split())
    assert first == verdict_text(answer)
    assert first.split()[0].strip(",").lower() in (*verdict.split(), "everything", "nothing")


@each_example
def test_examples_agree(path: Path, answered: Answers) -> None:
    found = answered(path)
    printed = found.check
    agree(Answer(load_scene(path)), (printed.status, printed.text), found.data("check"), found.page)


def limited(answer: Answer, key: str) -> list[JudgedFigure]:
    return [each for each in answer.judged if each.entry.row.limit == key]


def nearest(answer: Answer, key: str) -> float:
    """The value of the figure that a limit meets first, in the unit in which it is shown."""
    found = [each for each in limited(answer, key) if each.value.value is not None]
    values = [each.entry.row.shown(each.value.value or 0.0) for each in found]
    return max(values) if found[0].value.sense == "most" else min(values)


@pytest.mark.parametrize("key", LIMITED)
def test_at_its_limit_a_scene_is_within_and_past_it_beyond(key: str, tmp_path: Path) -> None:
    """The limit is the value of the figure to the last digit, and a millionth less or more."""
    path, text = tmp_path / "scene.toml", LIMITED[key]
    path.write_text(text(20.0), encoding="utf-8")
    value = nearest(Answer(load_scene(path)), key)
    path.write_text(text(value), encoding="utf-8")
    answer = agreed(path)
    at = {each.value.verdict for each in limited(answer, key)}
    assert at <= {"within", "not judged"}
    assert "within" in at
    assert answer.verdict == "within"
    sense = limited(answer, key)[0].value.sense
    path.write_text(text(value * (1.0 + (1e-6 if sense == "least" else -1e-6))), encoding="utf-8")
    answer = agreed(path) if tiers.whole else Answer(load_scene(path))
    assert answer.verdict == "beyond"
    assert "beyond" in {each.value.verdict for each in limited(answer, key)}


def test_what_cannot_be_judged_leaves_no_better_verdict(tmp_path: Path) -> None:
    """A limit of the heat, which needs friction, beside figures that have each of the verdicts."""
    path = tmp_path / "scene.toml"
    for bend, alone, both in (
        ("8", "within", "not judged"),
        ("[7, 8]", "tolerable", "not judged"),
        ("7", "beyond", "beyond"),
    ):
        text = f"{MOTION}[limits]\nequivalent_bend_deg = {bend}\n"
        path.write_text(text, encoding="utf-8")
        assert agreed(path).verdict == alone
        path.write_text(f"{text}[joints]\nheat_W = 1\n", encoding="utf-8")
        assert agreed(path).verdict == both


def test_every_key_of_a_limit_has_its_scene() -> None:
    """So that a limit that is added is tried as well."""

    def keys(of: type) -> set[str]:
        found = set()
        for _, row, hint in rows_of(of):
            if row.kind == "parts":
                found |= keys(element_of(hint))
            elif row.limit:
                found.add(row.limit)
        return found

    every = set().union(*(keys(part.figures()) for part in PARTS.values()))
    # Presets have limits of their own, which test_presets.py tries.
    assert every == {*LIMITED, *AT_ZERO, "[limits] preset"}


def test_the_spline_that_bottoms_is_beyond(tmp_path: Path) -> None:
    path = tmp_path / "scene.toml"
    path.write_text(f"{SPLINE}push_in_mm = 100\n", encoding="utf-8")
    left = nearest(agreed(path), "[slip] push_in_mm")
    for room, verdict in ((100.0 - left, "within"), (100.0 - left - 1e-4, "beyond")):
        path.write_text(f"{SPLINE}push_in_mm = {room!r}\n", encoding="utf-8")
        assert agreed(path).verdict == verdict


@pytest.mark.parametrize("command", ["check", "run", "report", "life"])
def test_each_part_is_found_once_per_call(
    command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    found: Counter[str] = Counter()
    find = Part.find

    def counted(part: Part, answer: Answer) -> object:
        found[part.name] += 1
        return find(part, answer)

    def checked(*arguments: Any) -> Check:  # noqa: ANN401 - passed on
        found["check"] += 1
        return check_scene(*arguments)

    monkeypatch.setattr(Part, "find", counted)
    monkeypatch.setattr("cardan.app.answers.answer.check_scene", checked)
    options = {"run": ["--into", str(tmp_path)], "report": ["--output", str(tmp_path / "a.html")]}
    arguments = [command, str(example("pto-shaft.toml")), *options.get(command, [])]
    result = CliRunner().invoke(commands(), arguments)
    assert result.exit_code in (0, 1), result.output
    assert len(found) >= 2
    assert set(found.values()) == {1}, found


def checked(scene: dict[str, Any], path: Path) -> dict[str, Any]:
    path.write_text("\n".join(f"{name} = {as_toml(keys)}" for name, keys in scene.items()))
    result = scripts.run("check", path, "--json")
    found: dict[str, Any] = json.loads(result.stdout)
    return found


def moved(scene: dict[str, Any], move: dict[str, Any], share: float) -> dict[str, Any]:
    """The scene after a share of a move of a point, in the drawing and in all states."""
    number, axis = move["number"], "xyz".index(move["axis"])
    points = [list(point) for point in scene["driveline"]["points_mm"]]
    points[number][axis] += share * move["shift_mm"]
    changed = {**scene, "driveline": {**scene["driveline"], "points_mm": points}}
    states = json.loads(json.dumps(scene.get("states", {})))
    nested = states.get("points_mm", {}).get(str(number), {})
    for held, key in ((nested, move["axis"]), (states, f"points_mm.{number}.{move['axis']}")):
        if key in held:
            held[key] = (np.array(held[key]) + share * move["shift_mm"]).tolist()
    if states:
        changed["states"] = states
    return changed


MOVES_COLUMN: dict[str, Any] = {
    "driveline": {"points_mm": [[0, 0, 0], [550, 0, -280], [780, 90, -520], [900, 100, -600]]},
    "steering": {"centre_deg": 10, "offset_deg": 6},
    "limits": {"equivalent_bend_deg": 30},
    "states": {"names": ["high", "low"], "points_mm.0.z": [30, -30]},
}


LOOSE: dict[str, Any] = {
    "driveline": {"points_mm": [[0, 0, 0], [300, 0, 0], [900, 300, 0], [1200, 500, 0]]},
    "joints": {"arm_mm": 30, "play_mm": 0.02},
    "limits": {"equivalent_bend_deg": 60, "lash_deg": 0.32},
}


def of_example(name: str) -> dict[str, Any]:
    scene = tomllib.loads(example(f"{name}.toml").read_text(encoding="utf-8"))
    return {key: scene[key] for key in ("driveline", "load", "limits", "states") if key in scene}


@pytest.mark.parametrize(
    "scene",
    [
        *(of_example(f) for f in ("bearings", "ride_heights", "truck_heights", "truck_torsion")),
        MOVES_COLUMN,
        LOOSE,
    ],
    ids=["bearings", "ride_heights", "truck_heights", "truck_torsion", "steering", "lash"],
)
def test_a_check_after_a_move_finds_what_it_says(scene: dict[str, Any], tmp_path: Path) -> None:
    """A hundredth less does not suffice, so the move is the smallest of its kind.

    In words it is rounded so that it suffices as well.
    """
    path = tmp_path / "scene.toml"
    before = checked(scene, path)
    assert before["verdict"] == "beyond"
    moves = [move for move in before["moves"] if move["variable"] == "point"]
    assert moves
    for move in moves:
        assert (move["verdict"], move["untried"]) == ("within", "")
        assert checked(moved(scene, move, 1.0), path)["verdict"] == "within"
        assert checked(moved(scene, move, 0.99), path)["verdict"] != "within"
    sizes = [abs(move["shift_mm"]) for move in moves]
    assert sizes == sorted(sizes)
    said = re.findall(
        r"Move \D*\d* by ([\d.]+) mm along [+\N{MINUS SIGN}]([xyz])", " ".join(before["advice"])
    )
    assert said
    for move, (by, axis) in zip(moves, said, strict=False):
        assert move["axis"] == axis
        share = float(by) / abs(move["shift_mm"])
        assert 1.0 <= share < 1.1
        assert checked(moved(scene, move, share), path)["verdict"] == "within"


def test_what_is_within_needs_no_move(tmp_path: Path) -> None:
    data = checked(
        {"driveline": {"points_mm": [[0, 0, 0], [300, 0, 0], [900, 10, 0]]}}, tmp_path / "a"
    )
    assert (data["verdict"], data["moves"], data["advice"]) == ("within", [], [])


def test_a_move_is_said_in_words() -> None:
    answer = Answer(load_scene(example("bearings.toml")))
    first, *_ = PARTS["moves"].sentences(answer["moves"])
    assert first == "Move joint 2 by 12.8 mm along +y: everything is then within its limits."


def test_a_turn_of_a_yoke_is_a_move(tmp_path: Path) -> None:
    """Of two equal bends in one plane a phase of 90 degrees cancels the motion."""
    for bend, teeth, turn in ((20, None, 60.0), (20, 24, 60.0), (20.1, None, 60.0)):
        driveline = {"bends_deg": [20, bend], "phases_deg": 30} | (
            {"teeth": teeth} if teeth else {}
        )
        data = checked({"driveline": driveline}, tmp_path / "a.toml")
        (move,) = (move for move in data["moves"] if move["variable"] == "phase")
        assert move["verdict"] == "within"
        assert abs(move["turn_deg"]) <= turn + 1e-9
        (said,) = re.findall(r"shaft 1 by (?:\d+ teeth \()?([\d.]+)°", " ".join(data["advice"]))
        assert float(said) == pytest.approx(abs(move["turn_deg"]), abs=0.1)
        for size in (abs(move["turn_deg"]), float(said)):
            turned = np.copysign(size, move["turn_deg"])
            after = {"driveline": driveline | {"phases_deg": 30 + turned}}
            assert checked(after, tmp_path / "a.toml")["verdict"] == "within"


YOKES_OFF: dict[str, Any] = {
    "points_mm": [[0, 0, 0], [350, -24, 0], [1650, -46, 0], [3150, -180, 45], [3450, -196, 45]],
    "phases_deg": [30, -25],
}


def test_yokes_that_help_are_named(tmp_path: Path) -> None:
    """The answer lists the smallest moves of points first and includes the turn of a yoke."""
    data = checked({"driveline": YOKES_OFF}, tmp_path / "a.toml")
    advice = data["advice"]
    said = re.match(
        r"The best setting of the yokes, as 'cardan phase' shows it, leaves an equivalent bend of "
        r"(\S+)° in place of (\S+)°, within the limit of 3°\.",
        advice[0],
    )
    assert said
    line = Driveline.from_points(YOKES_OFF["points_mm"], np.radians([30, -25]))
    best = line.with_phases(line.optimal_phases())
    for text, each in ((said[1], best), (said[2], line)):
        assert float(text) == pytest.approx(float(each.equivalent().bend_deg), abs=0.005)
    assert sum(each.startswith("Turn the output-side yoke of shaft") for each in advice) == 1
    assert len(advice) == 6
    apart = {"points_mm": [[0, 0, 0], [600, 0, -270], [900, 60, -560], [1020, 60, -640]]}
    limits = {"equivalent_bend_deg": 15}
    scene = {"driveline": apart | {"phases_deg": 6}, "limits": limits}
    assert checked(scene, tmp_path / "a.toml")["advice"][-1].endswith(
        "leaves an equivalent bend of 16.98° in place of 17.48°, still beyond the limit of 15°."
    )
    (phase,) = Driveline.from_points(apart["points_mm"]).optimal_phases()
    scene["driveline"] = apart | {"phases_deg": round(math.degrees(phase), 2)}
    assert not any("best setting" in each for each in checked(scene, tmp_path / "a.toml")["advice"])


def test_a_steering_column_says_where_straight_ahead_is_assumed() -> None:
    text = "[driveline]\nbends_deg = [30, 25]\nphases_deg = 20\n[steering]\noffset_deg = 1\n"
    answer = Answer(Scene.parse(text))
    words = PARTS["steering"].sentences(answer["steering"])
    assert words[0] == (
        "Straight ahead is assumed at a drive angle of 0°, because [steering] has no centre_deg."
    )
    assert words[1].startswith("Left and right differ: ")
    given = Answer(Scene.parse(f"{text}centre_deg = 0\n"))
    assert [*PARTS["steering"].sentences(given["steering"])] == words[1:]


def test_what_is_worst_after_a_change_has_the_name_of_its_figure() -> None:
    answer = Answer(load_scene(example("steering-column.toml")))
    (change,) = PARTS["moves"].sentences(answer["moves"])
    (beyond,) = answer.of_verdict("beyond")
    assert beyond.name == "angle off symmetry of the steering"
    assert change.endswith(f"this helps most; the {beyond.name} is then still beyond.")


SHUDDER = """
[driveline]
points_mm = [[0, 0, 0], [280, -18, 0], [1480, -105, 0], [3000, -360, 0], [3280, -385, 0]]
[load]
drive_torque_Nm = 1100
speed_rpm = 700
[[bearing]]
shaft = 1
from_end_mm = 110
stiffness_N_per_mm = 220
{loss}
[tubes]
outer_diameter_mm = 76
wall_mm = 2.2
[lateral]
speed_rpm = {{from = 300, to = 2600, steps = 231}}
[limits]
bearing_force_N = {force}
equivalent_bend_deg = {bend}
"""


@pytest.mark.parametrize(
    ("loss", "force", "bend", "first", "left"),
    [
        ("loss_factor = 0.1", 300, 3, True, " (beyond its limit: see "),
        ("", 300, 3, True, " (not judged: see "),
        # The bend is the worse of the two.
        ("loss_factor = 0.1", 380, 2.7, False, " (beyond its limit: see "),
        ("loss_factor = 0.1", 500, 3, None, "."),
    ],
)
def test_the_worst_exceedance_is_advised_on_first(
    tmp_path: Path, loss: str, force: float, bend: float, first: bool | None, left: str
) -> None:
    path = tmp_path / "a.toml"
    path.write_text(SHUDDER.format(loss=loss, force=force, bend=bend))
    advice = json.loads(scripts.run("check", path, "--json").stdout)["advice"]
    ends = ["this ends the shudder and leaves" in each for each in advice]
    assert (sum(ends), ends[0]) == ((0, False) if first is None else (1, first))
    if first is False:
        assert ends[-1]
    # One sentence names all figures that the search leaves out.
    (untried,) = (each for each in advice if "ot tried" in each)
    assert untried.startswith("Not tried with these changes: ")
    assert f"largest dynamic force of bearing 0{left}" in untried


RESONANT = """
[driveline]
points_mm = [[0, 0, 0], [500, -15, 0], [1900, -130, 0], [2300, -150, 0]]
[load]
speed_rpm = 4500
output_torque_Nm = 150
[tubes]
shafts = [1]
outer_diameter_mm = 70
wall_mm = 2
least_margin = 1.5
{tubes}
[torsion]
drive = "free"
inertias_kgm2 = [[0.15, 0.03], 0, [0.02, 1.5]]
stiffnesses_Nm_per_rad = [900, "tube", 6000]
dampings_Nms_per_rad = [5, 1.6, 0.34]
speed_rpm = {{from = {start}, to = 4500, steps = 10}}
resonance_margin = 0.15
"""


@pytest.mark.parametrize(
    ("tubes", "start", "said"),
    [
        ("", 900, ["distance of the nearest critical speed of the shafts", "Torsional vibration"]),
        # 1.45 times 1669 rpm is further away than the limit.
        ("", 2420, []),
        # At 1.14 times it is nearer than that, but the tube is further from its limit.
        ("", 1903, []),
        ("resonance_margin = 0.9", 2420, ["distance from half critical of the tube of", "Tubes"]),
    ],
)
def test_what_the_changes_leave_far_beyond_is_said_first(
    tmp_path: Path, tubes: str, start: float, said: list[str]
) -> None:
    path = tmp_path / "a.toml"
    path.write_text(RESONANT.format(tubes=tubes, start=start))
    advice = json.loads(scripts.run("check", path, "--json").stdout)["advice"]
    firsts = [each.startswith("No change below is tried for the ") for each in advice]
    assert firsts == [bool(said), *([False] * (len(advice) - 1))]
    assert all(each in advice[0] for each in said)
    assert "everything tried is then within its limits" in advice[bool(said)]


def test_recorded_runs_have_no_moves() -> None:
    assert Answer(Scene.load(example("recorded_run.toml")))["moves"] == ()


def test_what_the_search_leaves_out_is_named() -> None:
    """Heat is judged as the mean over the duty cycle, which no change is tried for."""
    text = """[driveline]
    points_mm = [[0, 0, 0], [300, 0, 0], [900, 200, 0], [1200, 230, 0]]
    [load]
    output_torque_Nm = 500
    speed_rpm = 1500
    [joints]
    friction = 0.05
    pin_radius_mm = 10
    arm_mm = 30
    heat_W = 1
    [limits]
    bend_difference_deg = 0.1
    """
    moves = Answer(Scene.parse(text))["moves"]
    assert moves
    assert {move.untried for move in moves} == {"heat of joint 0, heat of joint 1"}

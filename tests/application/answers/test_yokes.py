"""How to set the yokes: senses, teeth, arrangements, what would fix the rest; text and JSON."""

from __future__ import annotations

import json
import math
import re
from itertools import product
from pathlib import Path

import jsonschema
import numpy as np
import pytest
from numpy.typing import ArrayLike

import scripts
from cardan import Driveline, approximations
from cardan.app.answers.moves import held_in
from cardan.app.answers.schema import VERSION, answers_schema
from cardan.app.answers.yokes.figures import advice, scene_advice, yoke_settings
from cardan.app.answers.yokes.text import remedies, yoke_text
from cardan.app.scene import Scene
from cardan.motion import workshop
from example_scenes import EXAMPLES
from pages import near

VIEW = "looking from the drive towards the output"
YOKED = [
    path
    for path in EXAMPLES
    if path.stem not in {"ball_joint", "drive_inertia", "foeppl", "recorded_run", "rig_torsion"}
]
SCHEMA = answers_schema()["$defs"]["phase"]
OPPOSITE = {"clockwise": "counter-clockwise", "counter-clockwise": "clockwise"}


def phase(path: Path | str, *options: str) -> str:
    result = scripts.run("phase", path, *options)
    assert result.exit_code == 0, result.output
    return result.output


def scene(tmp_path: Path, driveline: str) -> Path:
    path = tmp_path / "a.toml"
    path.write_text(f"[driveline]\n{driveline}\n")
    return path


def bend_deg(line: Driveline, phases: ArrayLike | None = None) -> float:
    return float(
        np.degrees((line if phases is None else line.with_phases(phases)).equivalent().bend)
    )


def tooth_turns(line: Driveline, teeth: int) -> list[int]:
    off = line.optimal_phases(teeth=teeth) - line.phases
    return [round(turn) for turn in off * teeth / (2 * np.pi)]


# --- senses and axes --------------------------------------------------------------------------


@pytest.mark.parametrize("angle", [-8.17, 8.17, 81.83, -171.83, 350.0])
def test_a_turn_is_said_in_both_senses(angle: float) -> None:
    said = str(workshop.turn(math.radians(angle)))
    found = re.fullmatch(rf"(.+)° (.+) = (.+)° (.+), {VIEW}", said)
    assert found is not None
    assert found[4] == OPPOSITE[found[2]]
    assert float(found[1]) < 90.0
    for degrees, sense in ((found[1], found[2]), (found[3], found[4])):
        turned = float(degrees) * (1 if sense == "clockwise" else -1)
        assert (turned - angle) % 180.0 == pytest.approx(0.0, abs=1e-9) or (
            turned - angle
        ) % 180.0 == pytest.approx(180.0, abs=1e-9)


def test_clockwise_is_seen_from_the_drive() -> None:
    """Whoever looks along +x, with y up, has +z at the right: clockwise goes from y to z."""
    line = Driveline.from_directions(np.array([[1, 0, 0], [1, 0.2, 0], [1, 0.2, 0.2]]))
    along = line.directions[1]
    first, second = line.normals
    twist = float(line.twists[0])
    # Rodrigues' formula, right-handed about the shaft.
    turned = math.cos(twist) * first + math.sin(twist) * np.cross(along, first)
    assert turned == pytest.approx(second)
    assert np.cross([1, 0, 0], [0, 1, 0]).tolist() == [0, 0, 1]
    assert str(workshop.turn(math.radians(30.0))).startswith("30.00° clockwise")


# --- the command -----------------------------------------------------------------------------


@pytest.mark.parametrize("path", YOKED, ids=lambda path: path.stem)
def test_json_fits_its_schema(path: Path) -> None:
    jsonschema.Draft202012Validator.check_schema(SCHEMA)
    data = json.loads(phase(path, "--json"))
    jsonschema.Draft202012Validator(SCHEMA).validate(data)
    assert list(data)[:3] == ["answer", "version", "title"]
    assert (data["answer"], data["version"], data["view"]) == ("phase", VERSION, VIEW)
    line = Scene.load(path).line
    for i, shaft in enumerate(data["shafts"]):
        present = math.degrees(line.phases[i])
        for name, start in (("setting", 0.0), ("turn", present)):
            sense = shaft["sense" if name == "setting" else "turn_sense"]
            sign = {"clockwise": 1, "counter-clockwise": -1, "none": 0}[sense]
            one, other = shaft[f"{name}_deg"], shaft[f"{name}_other_sense_deg"]
            assert one + other == pytest.approx(180.0)
            # Both ways round lead to the same yoke.
            ends = start + sign * one, start - sign * other
            assert all(
                math.cos(math.radians(2 * (end - shaft["phase_deg"]))) == pytest.approx(1)
                for end in ends
            )


# --- arrangement and advice -------------------------------------------------------------------


@pytest.mark.parametrize(
    ("bends", "twists", "name"),
    [
        ([15], [], "single bend"),
        ([15, 15], [180], "Z"),
        ([15, 9], [0], "W"),
        ([15, 9], [-180], "Z"),
        ([15, 9], [30], "spatial"),
        ([0, 0], [0], "straight"),
        ([15, 0], [0], "single bend"),
        ([15, 0, 9], [90, 90], "Z"),
        ([15, 0, 9], [90, 80], "spatial"),
        ([5, 4, 3], [0, 180], "planar"),
        ([5, 4, 3], [0, 179], "spatial"),
    ],
)
def test_the_arrangement_has_a_name(bends: list[float], twists: list[float], name: str) -> None:
    line = Driveline.from_bends(bends, twists, degrees=True)
    assert line.arrangement() == name
    assert advice(line).arrangement == name


def test_arrangements_of_a_drawing() -> None:
    """Rounding of points does not make a shaft bent in space, nor a straight joint bent."""
    points = np.array([[0, 0, 0], [300, 0, 0], [1300, -100, 0], [1600, -100, 0]], dtype=float)
    turned = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]])
    assert Driveline.from_points(points @ turned.T).arrangement() == "Z"
    inline = np.arange(4.0)[:, np.newaxis] * turned[0]
    assert Driveline.from_points(inline).arrangement() == "straight"
    with pytest.raises(ValueError, match="an arrangement is that of one driveline"):
        Driveline.from_points([inline]).arrangement()


BENDS = [[14, 9], [9, 14], [25, 4, 3, 2, 5], [4, 20, 6], [7, 7], [12, 0], [10, 6, 6]]


@pytest.mark.parametrize("limit", [3.0, 1.0])
@pytest.mark.parametrize("bends", BENDS, ids=str)
def test_ranges_of_bends_end_where_the_best_setting_reaches_the_limit(
    bends: list[float], limit: float
) -> None:
    data = advice(Driveline.from_bends(bends, degrees=True), math.radians(limit))
    assert len(data.bend_ranges) == len(bends)

    def best(joint: int, bend: float) -> float:
        changed = [*bends[:joint], bend, *bends[joint + 1 :]]
        line = Driveline.from_bends(changed, degrees=True)
        return bend_deg(line, line.optimal_phases())

    for found in data.bend_ranges:
        joint, low, high = found.joint, found.from_deg, found.to_deg
        assert found.bend_deg == pytest.approx(bends[joint])
        assert best(joint, high) == pytest.approx(limit, abs=1e-6)
        assert best(joint, high + 0.01) > limit
        assert best(joint, (low + high) / 2) < limit
        if low > 0.0:
            assert best(joint, low) == pytest.approx(limit, abs=1e-6)
            assert best(joint, low - 0.01) > limit
    inside = all(found.from_deg <= found.bend_deg <= found.to_deg for found in data.bend_ranges)
    assert (data.cause != "bends") == inside
    two = Driveline.from_bends([bends, bends], degrees=True).bend_ranges(math.radians(limit))
    each = [(found.from_deg, found.to_deg) for found in data.bend_ranges]
    assert np.degrees(two) == pytest.approx(np.array([each, each]))


def test_bends_that_differ(tmp_path: Path) -> None:
    path = scene(tmp_path, "bends_deg = [14, 9]\ntwists_deg = [180]")
    words = " ".join(phase(path).split())
    assert (
        "The bends differ (14° and 9°), so no setting of the yokes is enough: the present one is "
        "the best and leaves 10.77°. To come within the limit of 3°, give joint 0"
    ) in words
    said = re.search(
        r"give joint 0 a bend of (.+?)° to (.+?)°, or joint 1 a bend of (.+?)° to (.+?)°; then",
        words,
    )
    assert said is not None
    ends = [
        (float(said[1]), 9.0),
        (float(said[2]), 9.0),
        (14.0, float(said[3])),
        (14.0, float(said[4])),
    ]
    # What is printed keeps what it promises, and no more than a hundredth is lost.
    for bends in ends:
        line = Driveline.from_bends(bends, 180, degrees=True)
        assert 2.95 < bend_deg(line, line.optimal_phases()) <= 3.0
    assert json.loads(phase(path, "--json"))["cause"] == "bends"


def test_a_turn_that_is_not_enough_says_what_remains(tmp_path: Path) -> None:
    path = scene(tmp_path, "bends_deg = [14, 9]\ntwists_deg = [180]\nphases_deg = [20]")
    words = " ".join(phase(path).split())
    assert "shaft 1: in one plane; turn it 20.0° counter-clockwise" in words
    line = Driveline.from_bends([14, 9], 180, 20, degrees=True)
    found = re.search(r"no setting of the yokes is enough: the best one leaves (\S+)° in ", words)
    assert found
    assert float(found[1]) == pytest.approx(bend_deg(line, line.optimal_phases()), abs=0.005)
    assert f"in place of {bend_deg(line):.2f}°. To come within" in words


def test_of_more_joints_the_largest_is_to_be_changed(tmp_path: Path) -> None:
    words = " ".join(phase(scene(tmp_path, "bends_deg = [4, 20, 6]")).split())
    assert "Joint 1 is bent by 20°, more than the other joints can cancel, so no setting" in words
    said = re.search(r"give joint 1 a bend of (.+?)° to (.+?)°; then", words)
    assert said is not None
    for bend in said.groups():
        line = Driveline.from_bends([4, float(bend), 6], degrees=True)
        assert 2.95 < bend_deg(line, line.optimal_phases()) <= 3.0


def test_phases_that_are_wrong(tmp_path: Path) -> None:
    path = scene(tmp_path, "bends_deg = [15, 15]\ntwists_deg = [180]\nphases_deg = [5]")
    words = " ".join(phase(path).split())
    assert "- shaft 1: in one plane; turn it 5.0° counter-clockwise" in words
    assert "The phases are the cause: 6.29° is beyond the limit of 3°." in words
    assert json.loads(phase(path, "--json"))["cause"] == "phases"


def test_nothing_to_turn(tmp_path: Path) -> None:
    """At the best setting already; with a setting that is good enough; with bends to blame."""
    path = scene(tmp_path, "bends_deg = [15, 15]\ntwists_deg = [180]")
    words = " ".join(phase(path).split())
    assert "The yokes have their best setting; nothing to turn. 0° is within" in words
    path = scene(tmp_path, "bends_deg = [15, 15]\nphases_deg = [1]")
    words = " ".join(phase(path).split())
    assert "Nothing has to be turned: 2.82°" in words
    assert "The best setting leaves 0°." in words
    words = " ".join(phase(scene(tmp_path, "bends_deg = [0, 7]")).split())
    assert "One bend alone cannot cancel" in words
    assert (
        "give joint 1 a bend of at most 3.00°, or joint 0 a bend of 6.33° to 7.61°; then" in words
    )


def test_remedies_for_a_check() -> None:
    """They say by themselves which yoke to turn; also of one joint, which has none."""

    def words(*bends: float, phases: list[float]) -> list[str]:
        return remedies(advice(Driveline.from_bends(bends, 0, phases, degrees=True)))

    assert words(2, phases=[]) == []
    assert words(15, 15, phases=[1]) == []
    assert words(15, 15, phases=[5]) == [
        f"Turn the output-side yoke of shaft 1 by 5.0° counter-clockwise, {VIEW}; that leaves 0°."
    ]
    assert ", of shaft 2 by " in words(9, 8, 7, phases=[60, 50])[0]
    assert words(15, phases=[]) == [
        "A single joint cannot cancel its own unevenness.",
        "To come within the limit of 3°, give joint 0 a bend of at most 3.00°, or add a second "
        "joint with the same bend.",
    ]
    assert len(words(14, 9, phases=[0])) == 2


# --- the catalogues' rule ---------------------------------------------------------------------


def test_fork_signs_follow_the_rule_of_alternating_yokes() -> None:
    """Compared with the exact product of the joints, for yokes parallel or crossed at random."""
    random = np.random.default_rng(7)
    for _ in range(50):
        n = int(random.integers(2, 6))
        bends = random.uniform(0.5, 4.0, n)
        twists = random.uniform(-180, 180, n - 1)
        phases = twists + 90.0 * random.integers(-2, 3, n - 1)
        line = Driveline.from_bends(bends, twists, phases, degrees=True)
        signs, off = line.fork_signs()
        assert off == pytest.approx(np.zeros(n - 1), abs=1e-9)
        # ln sec obeys the rule exactly where the root rule takes its first term.
        total = abs(np.sum(signs * -np.log(np.cos(line.bends))))
        assert math.cos(math.radians(bend_deg(line))) == pytest.approx(math.exp(-total), abs=1e-12)


def test_the_root_rule_stands_beside_the_exact_figure(tmp_path: Path) -> None:
    path = scene(tmp_path, "bends_deg = [20, 25, 15]\nphases_deg = [10, 60]")
    data = json.loads(phase(path, "--json"))
    line = Scene.load(path).line
    best = line.with_phases([s["phase_deg"] for s in data["shafts"]], degrees=True)
    for key, settled in (("present", line), ("best", best)):
        rule = data["catalogue"][key]
        expected = approximations.catalogue_bend(line.bends, rule["fork_signs"])
        assert rule["equivalent_bend_deg"] == pytest.approx(math.degrees(expected))
        assert data["equivalent_bend_deg"][key] == pytest.approx(bend_deg(settled), abs=1e-5)
    assert data["catalogue"]["present"]["fork_signs"] == [1, -1, -1]
    assert data["catalogue"]["present"]["off_deg"] == pytest.approx(30.0)
    row = next(row for row in phase(path).splitlines() if "root rule" in row)
    shown = [near(cell) for cell in row.split()[3:]]
    rules = data["catalogue"].values()
    assert [rule["equivalent_bend_deg"] for rule in rules] == shown


# --- teeth ------------------------------------------------------------------------------------


def brute_force(line: Driveline, teeth: list[int]) -> float:
    """The least equivalent bend of all teeth of all shafts, one setting at a time."""
    settings = product(*(range(count) for count in teeth))
    pitches = 2 * np.pi / np.array(teeth)
    return min(bend_deg(line, line.phases + pitches * np.array(steps)) for steps in settings)


@pytest.mark.parametrize(
    ("bends", "twists", "phases", "teeth"),
    [
        ([15, 15], [70], [0], [16]),
        ([15, 15], [70], [3], [15]),
        ([14, 9], [-40], [0], [1]),
        ([14, 9], [-40], [0], [2]),
        ([9, 8, 6], [20, 50], [0, 0], [16, 21]),
        ([9, 8, 6], [20, 50], [7, 3], [1, 36]),
        ([25, 8, 6], [20, 50], [7, 3], [18, 12]),
        ([9, 8, 6, 7], [20, 50, -30], [7, 3, 0], [7, 10, 8]),
    ],
)
def test_no_other_teeth_are_better(
    bends: list[float], twists: list[float], phases: list[float], teeth: list[int], tmp_path: Path
) -> None:
    path = scene(
        tmp_path,
        f"bends_deg = {bends}\ntwists_deg = {twists}\nphases_deg = {phases}\nteeth = {teeth}",
    )
    line = Scene.load(path).line
    data = json.loads(phase(path, "--json"))
    jsonschema.Draft202012Validator(SCHEMA).validate(data)
    least = brute_force(line, teeth)
    assert data["equivalent_bend_deg"]["on_teeth"] == pytest.approx(least, abs=1e-6)
    # The turns of the answer lead there, and each is a whole number of teeth.
    steps = []
    for tooth, count in zip(data["teeth"], teeth, strict=True):
        sign = {"clockwise": 1, "counter-clockwise": -1, "none": 0}[tooth["turn_sense"]]
        assert tooth["teeth"] == count
        assert tooth["turn_deg"] == pytest.approx(tooth["turn_teeth"] * 360 / count)
        assert tooth["turn_deg"] <= 180.0
        steps.append(sign * tooth["turn_deg"])
    reached = line.with_phases(line.phases + np.radians(steps))
    assert bend_deg(reached) == pytest.approx(least, abs=1e-6)
    settled = [tooth["phase_deg"] for tooth in data["teeth"]]
    assert bend_deg(line.with_phases(settled, degrees=True)) == pytest.approx(least, abs=1e-6)
    cost = data["equivalent_bend_deg"]["on_teeth"] - data["equivalent_bend_deg"]["best"]
    assert f"whose teeth cost {cost:.2f}° of" in phase(path)
    assert phase(path).splitlines()[-1].startswith("In the scene: phases_deg = [")


@pytest.mark.parametrize(("n", "teeth"), [(8, 36), (25, 16)])
def test_many_shafts_come_near_as_well(n: int, teeth: int) -> None:
    """Too many settings to compare all: the nearest, of a few shafts at a time."""
    random = np.random.default_rng(3)
    line = Driveline.from_bends(
        random.uniform(3, 6, n), random.uniform(0, 180, n - 1), degrees=True
    )
    best = line.optimal_phases()
    pitch = 2 * np.pi / teeth
    turns = np.array(tooth_turns(line, teeth))
    rounded = pitch * np.round((best - line.phases) / pitch)
    reached = bend_deg(line, line.phases + pitch * turns)
    assert reached <= bend_deg(line, line.phases + rounded)
    assert reached < 1.0
    for shaft in range(n - 1):
        for step in (-1, 1):
            other = turns.copy()
            other[shaft] += step
            assert bend_deg(line, line.phases + pitch * other) > reached - 1e-6


@pytest.mark.parametrize("teeth", ["0", "-3", "1001", "2.5", "true", '"16"', "[16]", "[16, 0]"])
def test_teeth_are_positive_whole_numbers(teeth: str, tmp_path: Path) -> None:
    path = scene(tmp_path, f"bends_deg = [9, 8, 6]\nteeth = {teeth}")
    result = scripts.run("phase", path)
    assert result.exit_code == 2
    assert "teeth" in result.output
    assert len(result.output.splitlines()) == 1


def test_teeth_that_miss_the_limit(tmp_path: Path) -> None:
    path = scene(tmp_path, "bends_deg = [9, 9]\nphases_deg = [10]\nteeth = 16")
    words = " ".join(phase(path).split())
    assert "The exact setting leaves 0°, but no teeth bring it within the limit." in words
    # The check is of what can be set.
    assert "On these teeth the driveline does not pass the check" in words
    assert words.endswith("In the scene: phases_deg = [10]")


def test_a_check_advises_what_the_teeth_allow(tmp_path: Path) -> None:
    """A check names the same teeth as cardan phase, and none where no teeth help."""
    text = "bends_deg = [9, 9]\nphases_deg = [20]\nteeth = "
    loaded = scene_advice(Scene.load(scene(tmp_path, f"{text}36")))
    assert loaded is not None
    assert remedies(loaded) == [
        f"Turn the output-side yoke of shaft 1 by 2 teeth counter-clockwise (20.0°), {VIEW}; "
        "that leaves 0°."
    ]
    path = scene(tmp_path, f"{text}1")
    said = scripts.run("check", path).output
    assert "No teeth of the splines bring it within the limit of 3°" in said
    assert "Turn the output-side yoke" not in said


WIDE_ANGLE = """\
[driveline]
double_joint_deg = 50
joint_distance_mm = 80
synchronous_deg = 35
single_bend_deg = 10
{rest}
"""


@pytest.mark.parametrize(
    "rest", ["", "teeth = [1, 16]", "[states]\ndouble_joint_deg = [5, 35, 60]\nweights = [8, 2, 1]"]
)
def test_the_best_pivot_has_its_value(rest: str) -> None:
    """No other pivot leaves less, each with its own best setting of the yokes."""

    def least(synchronous: float) -> float:
        text = WIDE_ANGLE.format(rest=rest).replace("= 35", f"= {synchronous}", 1)
        found = scene_advice(Scene.parse(text))
        assert found
        return found.settable_deg

    (said,) = remedies_of(WIDE_ANGLE.format(rest=rest))
    synchronous, left = float(said[1]), float(said[2])
    assert least(synchronous) == pytest.approx(left, abs=0.005)
    assert all(left < least(other) + 0.005 for other in np.arange(0.0, 80.0, 2.5))
    alone = WIDE_ANGLE.format(rest="").replace("single_bend_deg = 10\n", "")
    (said,) = remedies_of(alone)
    assert (said[1], said[2], said[3]) == ("50", "0", None)


def remedies_of(text: str) -> list[re.Match[str]]:
    """The pivots that a scene would have."""
    found = scene_advice(Scene.parse(text))
    assert found
    pattern = r"a synchronous_deg of (\S+)° leaves (?:at most )?(\S+)°( with the yokes set anew)?\."
    return [*re.finditer(pattern, " ".join(remedies(found)))]


def remedy(text: str) -> str:
    """What would help a scene of several states by its yokes, bends and pivot."""
    found = scene_advice(Scene.parse(text))
    assert found
    return " ".join(remedies(found))


def test_a_straight_single_joint_is_said_where_its_bend_remains() -> None:
    text = WIDE_ANGLE.format(rest="[states]\ndouble_joint_deg = [5, 50]")
    said = re.findall(
        r"With a straight single joint, (\S+)° would leave at most (\S+)°\.", remedy(text)
    )
    level = text.replace("single_bend_deg = 10", "single_bend_deg = 0")
    pivot = re.findall(
        r"synchronous_deg of (\S+)° leaves at most (\S+)° with", remedy(f"{level}\n[limits]\n{LOW}")
    )
    assert said == pivot
    assert len(said) == 1
    # The answer omits it where the pivot suffices or the states set the bend.
    assert "straight" not in remedy(f"{text}\n[limits]\nequivalent_bend_deg = 9.8\n")
    assert "straight" not in remedy(f"{text}\nsingle_bend_deg = [9, 10]\n")


LOW = "equivalent_bend_deg = 0.01\n"


@pytest.mark.parametrize(
    ("states", "mean", "worst"),
    [
        # The present yokes are better in the worst state than those with the least mean.
        ("weights = [1, 9]\nbends_deg.0 = [12, 5]\ntwists_deg = [0, 90]", "", "state 1"),
        ("bends_deg.0 = [12, 11.5]", "mean", "that state"),
        ("weights = [1, 2]\nbends_deg.0 = [12, 11.5]", "weighted mean", "that state"),
    ],
)
def test_the_best_setting_of_states_is_said_where_it_helps(
    states: str, mean: str, worst: str
) -> None:
    text = f"[driveline]\nbends_deg = [12, 8]\ntwists_deg = {{}}\n[states]\n{states}\n"
    said = remedy(text.format(90 if mean else 0))
    assert f"nearer to each other in {worst}." in said
    assert ("Giving that state more weight in [states] improves it" in said) == bool(mean)
    if mean:
        assert f"yokes, with the least {mean} over the states, leaves" in said
    else:
        assert "setting" not in said


def test_yokes_that_are_better_in_the_worst_state_stay(tmp_path: Path) -> None:
    """The setting with the least weighted mean leaves 9.78° where the present one leaves 9.51°."""
    path = tmp_path / "wide.toml"
    scripts.run("new", "wide-angle", path)
    said = scripts.run("check", path).stdout
    assert "9.51° in turn 50 deg" in said
    assert "common setting" not in said
    # A double joint alone has no yoke to set.
    alone = WIDE_ANGLE.replace("single_bend_deg = 10\n{rest}", "[states]\n")
    assert "setting" not in remedy(f"{alone}double_joint_deg = [5, 60]\n")


def test_a_pivot_that_the_states_set_has_no_value() -> None:
    rest = "[states]\nsynchronous_deg = [20, 25]"
    found = scene_advice(Scene.parse(WIDE_ANGLE.format(rest=rest)))
    assert found
    assert "double joint: change synchronous_deg in the states." in " ".join(remedies(found))


DOUBLE = """\
[driveline]
double_joint_deg = 30
joint_distance_mm = 60
synchronous_deg = 35
"""


def test_only_the_yokes_behind_a_double_joint_are_set() -> None:
    """Its middle piece has no spline, and the setting is a key that its scene takes."""
    alone = yoke_settings(Scene.parse(DOUBLE))
    assert not alone.turned
    assert "In the scene" not in yoke_text("", alone)
    behind = Scene.parse(f"{DOUBLE}single_bend_deg = 6\nsingle_phase_deg = 20\n")
    found = yoke_settings(behind)
    assert [shaft.shaft for shaft in found.turned] == [2]
    line = yoke_text("", found).rpartition("In the scene: ")[2].strip()
    set_line = Scene.parse(f"{DOUBLE}single_bend_deg = 6\n{line}\n").line
    assert set_line.equivalent().bend < behind.line.equivalent().bend
    assert ("phase", 1) in held_in(behind)


def test_a_yoke_that_is_off_counts_from_its_best_phase(tmp_path: Path) -> None:
    driveline = "bends_deg = [14, 9]\ntwists_deg = [120]"
    *_, counted, line = phase(scene(tmp_path, driveline)).splitlines()
    assert counted.endswith("a yoke 6° off has the best value plus or minus 6.")
    best = float(line.partition("[")[2].rstrip("]"))
    for off in (6.0, -6.0):
        found = phase(scene(tmp_path, f"{driveline}\nphases_deg = {best + off}"))
        assert "; turn it 6.0° " in " ".join(found.split())
    found = phase(scene(tmp_path, f"{driveline}\nphases_deg = 6"))
    assert "; turn it 6.0° " not in " ".join(found.split())

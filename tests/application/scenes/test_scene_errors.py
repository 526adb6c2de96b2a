"""What is wrong in a scene file, by fields, and remarks on what may be meant otherwise."""

from __future__ import annotations

import pickle
from pathlib import Path

import numpy as np
import pytest

import cardan
from cardan import ArgumentValueError
from cardan.app.answers.answer import Answer
from cardan.app.answers.printed import quantity
from cardan.app.scene import Scene, SceneError
from cardan.app.scene.language.errors import StudyPointError
from cardan.app.scene.language.units import RPM
from cardan.app.scene.study.cluster import connect, write_study
from cardan.arrays import FloatArray

TWO = "[driveline]\nbends_deg = [8.5, 8.5]\n"


# Text, then line, section, argument, place, key, and how the problem begins.
CASES: list[tuple[str, int | None, str, str, tuple[int | str, ...], str, str]] = [
    (
        "[driveline]\nbends_deg = [8, 8, 99]\n",
        2,
        "driveline",
        "bends_deg",
        (2,),
        "driveline.bends_deg.2",
        "is 99 deg; a bend must lie in",
    ),
    (
        "[driveline]\npoints_mm = [[0, 0, 0], [1, 0, 0], [1, 0, 0]]\n",
        2,
        "driveline",
        "points_mm",
        (2,),
        "driveline.points_mm.2",
        "is (1, 0, 0) after (1, 0, 0);",
    ),
    (
        "[driveline]\npoints_mm = [[0, 0, 0], [1, 'a', 0], [1, 0, 0]]\n",
        2,
        "driveline",
        "points_mm",
        (1, 1),
        "driveline.points_mm.1.1",
        "is 'a'; it must be a number",
    ),
    (
        "[driveline]\nslopes_vertical_deg = [0, 89]\nslopes_horizontal_deg = [-89, 89]\n",
        2,
        "driveline",
        "slopes_vertical_deg",
        (),
        "driveline.slopes_vertical_deg",
        "and slopes_horizontal_deg give joint 0 a bend of ",
    ),
    (
        f"{TWO}[load]\ninertias_kgm2 = [1, -2, 1]\n",
        4,
        "load",
        "inertias_kgm2",
        (1,),
        "load.inertias_kgm2.1",
        "is -2; an inertia must not be negative",
    ),
    (
        f"{TWO}[output]\nshafts = [0, 5]\n",
        4,
        "output",
        "shafts",
        (1,),
        "output.shafts.1",
        "is 5; there are 3, counted from 0",
    ),
    (
        f"{TWO}[study]\nbends_deg.1 = {{from = 0, to = 'a', steps = 3}}\n",
        4,
        "study",
        "bends_deg",
        ("1", "to"),
        "study.bends_deg.1.to",
        "is 'a'; it must be a number",
    ),
    (
        f"{TWO}[study]\nbends_deg.2 = [1, 2]\n",
        4,
        "study",
        "bends_deg",
        ("2",),
        "study.bends_deg.2",
        "does not exist; there are 2",
    ),
    # What has no fields, or is about no key that there is.
    (
        "[driveline]\nbend_deg = [8]\n",
        2,
        "driveline",
        "bend_deg",
        (),
        "driveline.bend_deg",
        "unknown key 'bend_deg'; did you mean",
    ),
    ("[drivelin]\nbends_deg = [8]\n", 1, "", "drivelin", (), "drivelin", "unknown section"),
    ("driveline = 3\n", 1, "", "driveline", (), "driveline", "is 3; it must be a section"),
    (f"{TWO}[study]\n", 3, "study", "", (), "study", "is empty; give at least one key"),
    ("[driveline", None, "", "", (), "", "not TOML: "),
]


@pytest.mark.parametrize(
    ("text", "line", "section", "argument", "place", "key", "problem"),
    CASES,
    ids=[f"{case[5]} {case[6]}" for case in CASES],
)
def test_fields(
    text: str,
    line: int | None,
    section: str,
    argument: str,
    place: tuple[int | str, ...],
    key: str,
    problem: str,
) -> None:
    with pytest.raises(SceneError) as caught:
        Scene.parse(text, "a.toml")
    error = caught.value
    assert isinstance(error, ValueError)
    assert (error.name, error.line, error.section, error.key) == ("a.toml", line, section, key)
    assert (error.argument, error.place, error.point) == (argument, place, {})
    assert error.problem.startswith(problem)
    assert error.problem in str(error)
    other = pickle.loads(pickle.dumps(error))
    assert (type(other), str(other), vars(other)) == (SceneError, str(error), vars(error))


@pytest.mark.parametrize(
    ("line", "bend_deg"),
    [
        # tan(bend) sin(bend), and tan(bend/2)**2 = sin(error).
        ("non_uniformity = 0.01", 5.725),
        ("max_angle_error_deg = 1", 15.05),
        ("non_uniformity = [0.01, 0.02]", None),
        ("max_angle_error_deg = 120", None),
    ],
)
def test_a_limit_of_what_follows_from_the_bend_says_where_it_goes(
    line: str, bend_deg: float | None
) -> None:
    with pytest.raises(SceneError, match="unknown key") as caught:
        Scene.parse(f"{TWO}[limits]\n{line}\n")
    name = line.partition(" ")[0].removesuffix("_deg")
    own = f"_deg = {bend_deg}, which is the same" if bend_deg else "_deg, from which it follows"
    assert caught.value.problem.endswith(
        f'; give equivalent_bend{own}, or [tolerances] of = "{name}" and limit'
    )


GRID = (
    "[driveline]\npoints_m = [[0, 0, 0], [0, 1, 0], [0, 5, 0]]\n"
    "[study]\npoints_m.1.x = [0, 1, 1.9]\npoints_m.1.y = [2, 0.8, 4.1]\n"
    "[output]\nclosed_forms = ['k']\ntable = 'a.parquet'\n"
)


POINT = {"points_m.1.x": 1.9, "points_m.1.y": 0.8}


def test_a_point_of_a_study() -> None:
    scene = Scene.parse(GRID, "a.toml")
    with pytest.raises(SceneError) as caught:
        scene.run()
    error = caught.value
    assert (error.name, error.line, error.section) == ("a.toml", None, "study")
    assert (error.argument, error.place, error.point) == ("points_m", (), POINT)
    assert error.key == "driveline.points_m"
    assert error.problem.startswith("give joint 0 a bend of 91.5")


def test_a_point_of_a_study_counts_no_rows() -> None:
    """Neither does it where one of the lists that varies is at fault, nor in the load."""
    for text, argument, place, key in (
        (f"{TWO}[study]\nbends_deg = [1, 99]\n", "bends_deg", (0,), "driveline.bends_deg.0"),
        (f"{TWO}[study]\nbends_deg.1 = [1, 99]\n", "bends_deg", (1,), "driveline.bends_deg.1"),
        (
            f"{TWO}[load]\nspeed_rpm = 1\ninertias_kgm2 = [1, 1, 1]\n"
            "[study]\ninertias_kgm2.2 = [1, -1]\n",
            "inertias_kgm2",
            (2,),
            "load.inertias_kgm2.2",
        ),
    ):
        with pytest.raises(SceneError) as caught:
            Scene.parse(text, "a.toml")
        error = caught.value
        assert (error.argument, error.place, error.key) == (argument, place, key)
        assert list(error.point.values()) in ([99.0], [-1.0])


def test_a_point_of_a_study_on_a_worker(tmp_path: Path) -> None:
    pytest.importorskip("pyarrow")
    pytest.importorskip("distributed")
    study = Scene.parse(GRID).study
    assert study
    with connect(processes=1) as client, pytest.raises(ArgumentValueError) as caught:
        write_study(study, tmp_path / "a.parquet", client, part_rows=2)
    error = caught.value
    assert isinstance(error, StudyPointError)
    assert (error.argument, error.place, error.section) == ("points_m", (), "driveline")
    assert error.point == POINT
    assert str(error).startswith("at points_m.1.x = 1.9, points_m.1.y = 0.8: points_m give joint 0")


RIGHT = """\
[driveline]
bends_deg = [10, 10]
phases_deg = [30]
lengths_mm = [300, 1200, 300]
"""


POINTS = "points_mm = [[0, 0, 0], [300, 0, 0], [1200, -200, 0], [1500, -200, 0]]\n"


TUBES = "[tubes]\nouter_diameter_mm = 70\nwall_mm = 2\n"


def remarks(text: str) -> dict[str, str]:
    return {each.about: each.remark for each in Answer(Scene.parse(text))["remarks"]}


def test_ordinary_scenes_have_none() -> None:
    assert remarks(RIGHT + TUBES) == {}


@pytest.mark.parametrize(
    "section",
    ["[lateral]\n", '[torsion]\ndrive = "free"\ninertias_kgm2 = [[1, 0], 0, [0, 1]]\n'],
)
@pytest.mark.parametrize(
    ("limit", "is_said", "below"),
    [("least_margin = 1.5\n", "is judged", ", below 1.5"), ("", "is that", "")],
)
def test_a_margin_at_speeds_beyond_the_load_is_remarked_on(
    section: str, limit: str, is_said: str, below: str
) -> None:
    tubes = f"{TUBES}shafts = [1]\n{limit}"
    text = f"{RIGHT}[load]\nspeed_rpm = 2000\n{tubes}{section}"
    (tube,) = Answer(Scene.parse(RIGHT + tubes))["tubes"]
    highest = tube.critical.value / RPM
    name = section.partition("\n")[0]
    said = f"the margin of the tube of shaft 1 {is_said} at 2000 rpm; at "
    then = f", up to which {name} looks, it is 1.40{below}"
    for margin, is_remarked in ((1.6, False), (1.4, True)):
        speeds = f"speed_rpm = {{from = 300, to = {highest / margin}, steps = 10}}\n"
        found = remarks(text + speeds).get("[tubes]", "")
        assert (found.startswith(said) and found.endswith(then)) == is_remarked
        assert bool(found) == is_remarked


@pytest.mark.parametrize(
    ("start", "stop", "load", "bends", "is_remarked"),
    [
        (0.2, 0.55, 0.3, "[10, 10]", True),
        (0.2, 0.45, 0.3, "[10, 10]", False),
        (0.55, 0.7, 0.3, "[10, 10]", False),
        (0.2, 0.55, 0.3, "[0, 0]", False),
        # Beyond its limit at the speed of the load.
        (0.2, 0.55, 0.47, "[10, 10]", False),
    ],
)
def test_half_a_critical_speed_among_those_of_torsion_is_remarked_on(
    start: float, stop: float, load: float, bends: str, is_remarked: bool
) -> None:
    tubes = f"{TUBES}shafts = [1]\nresonance_margin = 0.15\n"
    (tube,) = Answer(Scene.parse(RIGHT + tubes))["tubes"]
    critical = tube.critical.value / RPM
    text = f"""{RIGHT.replace("[10, 10]", bends)}
    [load]
    speed_rpm = {load * critical}
    {tubes}
    [torsion]
    drive = "free"
    inertias_kgm2 = [[1, 0], 0, [0, 1]]
    speed_rpm = {{from = {start * critical}, to = {stop * critical}, steps = 10}}
    """
    found = remarks(text).get("[tubes]", "")
    assert ("among the speeds of [torsion]" in found) == is_remarked
    if is_remarked:
        assert f"it is {quantity(0.5 * tube.critical.value, 'rpm')}, among" in found


@pytest.mark.parametrize(
    ("old", "new", "about", "says"),
    [
        ("[300, 1200, 300]", "[300, 1200,5, 300]", "line 4", "[300, 1200,5, 300] separates some"),
        ("[10, 10]", "[0.1745, 0.1745]", "[driveline] bends_deg", "every bend is below 0.5°"),
        ("[30]", "[1.5708]", "[driveline] phases_deg", "1.5708 is 0.5 pi; the key takes degrees"),
        ("[30]", "[-0.262]", "[driveline] phases_deg", "-0.262 is -0.0834 pi"),
        ("300, 1200, 300", "300, 50001, 300", "[driveline] lengths_mm", "shaft 1 is 50.00 m long"),
        ("300, 1200, 300", "0.3, 1.2, 3", "[driveline] lengths_mm", "0.0003000 m long; the key ta"),
        ("= 70", "= 2001", "[tubes] outer_diameter_mm", "2.001 m wide; the key takes millimetres"),
        ("mm = [300, 1200, 300]", "m = [0.3, 1.2, 99]", "[driveline] lengths_m", "takes metres"),
    ],
)
def test_a_wrong_unit_is_remarked_on(old: str, new: str, about: str, says: str) -> None:
    text = RIGHT + TUBES
    assert old in text
    text = text.replace(old, new)
    if "1200,5" in new:
        text = text.replace("[10, 10]", "[10, 10, 10]").replace("[30]", "[30, 30]")
    found = remarks(text)
    assert list(found) == [about]
    assert says in found[about]


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("[10, 10]", "[10,10]"),
        ("[10, 10]", "[10,\n10,5]"),
        ("[10, 10]", "[10, 10] # [10,5, 9]"),
        ("[10, 10]", "[0, 0]"),
        ("[10, 10]", "[0.5, 0.1]"),
        ("[30]", "[1.57]"),
        ("[30]", "[90]"),
        ("300, 1200, 300", "1, 50000, 300"),
        ("= 70", "= 2000"),
    ],
)
def test_what_may_be_meant_is_not(old: str, new: str) -> None:
    text = (RIGHT + TUBES).replace(old, new)
    if "10,5]" in new:
        text = text.replace("[30]", "[30, 30]").replace("300, 1200", "300, 1200, 500")
    assert remarks(text) == {}


BEARING = "[[bearing]]\nshaft = 1\nposition_mm = 0.2\n"


JOINTS = "[joints]\nrating_Nm = 500\nfriction = 0.01\npin_radius_mm = 10\narm_mm = 0.04\n"


@pytest.mark.parametrize(
    ("more", "about", "says"),
    [
        (BEARING, "[[bearing]][0] position_mm", "a value is 0.2 mm"),
        (BEARING.replace("position", "from_end"), "[[bearing]][0] from_end_mm", "0.2 mm"),
        (JOINTS, "[joints] arm_mm", "a value is 0.04 mm; the key takes millimetres"),
        (
            TUBES.replace("70", "0.07").replace("= 2", "= 0.002"),
            "[tubes] outer_diameter_mm",
            "0.07",
        ),
        ("[load]\nspeed_rad_s = 3000\n", "[load]", "the drive turns at 28648 rpm"),
        ("[load]\nspeed_rpm = -30000\n", "[load]", "the drive turns at 30000 rpm"),
    ],
)
def test_a_size_or_a_speed_of_no_machine(more: str, about: str, says: str) -> None:
    found = remarks(RIGHT + more)
    assert list(found) == [about]
    assert says in found[about]
    usual = (("0.2", "1"), ("0.04", "40"), ("= 0.07", "= 70"), ("0.002", "2"), ("000", "00"))
    for old, new in usual:
        more = more.replace(old, new)
    assert remarks(RIGHT + more) == {}


@pytest.mark.parametrize(
    ("angles", "bends", "about"),
    [
        (np.arange(2000) * 0.1 % (2 * np.pi), 10.0, ["[angles] angle_column_deg"]),
        (np.arange(2000) * 0.1 % (2 * np.pi) - np.pi, 10.0, ["[angles] angle_column_deg"]),
        (np.arange(2000) * 6.0 % 360.0, 0.17, ["[angles] bend_columns_deg"]),
        (np.arange(2000) * 6.0 % 360.0, 10.0, []),
        (np.arange(2000) * 6.25, 10.0, []),  # Steps of about 2 pi are no jumps.
        # A gap of 6.2° in a slow turn, and one of 4.5° within less than 2 pi degrees.
        (np.arange(2000) * 0.1 + np.where(np.arange(2000) > 99, 6.1, 0.0), 10.0, []),
        (np.arange(100) * 0.01 + np.where(np.arange(100) > 50, 4.5, 0.0), 10.0, []),
        (3.1 * np.sin(np.arange(2000) * 0.1), 10.0, []),  # To and fro, by less than a turn in rad.
    ],
)
def test_a_recording_in_radians(
    tmp_path: Path, angles: FloatArray, bends: float, about: list[str]
) -> None:
    table = np.column_stack([angles, np.full(angles.size, bends)])
    np.savetxt(tmp_path / "run.csv", table, delimiter=",", header="angle,bend", comments="")
    text = (
        "[driveline]\n[angles]\nfile = 'run.csv'\nangle_column_deg = 'angle'\n"
        "bend_columns_deg = ['bend']\n"
    )
    scene = Scene.parse(text, folder=tmp_path)
    assert [each.about for each in Answer(scene)["remarks"]] == about


def test_points_in_another_unit() -> None:
    found = remarks("[driveline]\n" + POINTS.replace("mm", "m"))
    assert "shaft 2 is 300.0 m long; the key takes metres" in found["[driveline] points_m"]


def test_a_tube_in_millimetres_warns() -> None:
    with pytest.warns(UserWarning, match="outer_diameter reaches 60; sizes are in metres"):
        cardan.tube(60, 2.5, length=1200)


@pytest.mark.parametrize(
    ("single", "states", "remarked"),
    [
        ("single_bend_deg = 10\nsingle_twist_deg = 180", "double_joint_deg = [5, 50]", True),
        ("single_bend_deg = 10", "double_joint_deg = [5, 50]", True),
        # It stays upright, or is straight, or nothing turns.
        ("single_bend_deg = 10\nsingle_twist_deg = -90", "double_joint_deg = [5, 50]", False),
        ("single_bend_deg = 0", "double_joint_deg = [5, 50]", False),
        ("", "double_joint_deg = [5, 50]", False),
        ("single_bend_deg = 10", "synchronous_deg = [35, 40]", False),
        (
            "single_bend_deg = 10",
            "double_joint_deg = [5, 50]\nsingle_twist_deg = [180, 94]",
            False,
        ),
    ],
)
def test_a_single_joint_whose_plane_turns(single: str, states: str, remarked: bool) -> None:
    double = "double_joint_deg = 5\njoint_distance_mm = 80\nsynchronous_deg = 35\n"
    found = remarks(f"[driveline]\n{double}{single}\n[states]\n{states}\n")
    said = found.get("[states] double_joint_deg", "")
    assert bool(said) == remarked
    twist = "180°" if "180" in single else "0°"
    assert not remarked or said.startswith(f"single_twist_deg is {twist} in every state, so the ")


@pytest.mark.parametrize(("values", "remarked"), [("[-60, 0, 60]", True), ("[-260, -200]", False)])
def test_states_without_the_drawing(values: str, remarked: bool) -> None:
    text = f'[driveline]\n{POINTS}[states]\n"points_mm.2.y" = {values}\n'
    found = remarks(text)
    assert ("no state has the values of [driveline]" in found.get("[states]", "")) == remarked
    assert remarks(text.replace(values, f"{{add = {values}}}")).keys() == (
        set() if "0, 60" in values else {"[states]"}
    )


BALER = """\
[driveline]
bends_deg = [35]
[load]
speed_rpm = 1000
output_torque_Nm = 600
inertias_kgm2 = [0.1, 0.8]
"""


def test_a_torque_that_reverses_is_said_with_both_ends() -> None:
    found = remarks(BALER)
    assert list(found) == ["shaft 0", "shaft 1"]
    # Of one joint in closed form: shaft 1 carries the load and its own inertia.
    angle, bend, speed = np.linspace(0.0, np.pi, 1_000_001), np.radians(35.0), 1000.0 * np.pi / 30.0
    ratio = np.cos(bend) / (1.0 - np.sin(bend) ** 2 * np.cos(angle) ** 2)
    slope = ratio**2 * np.sin(bend) ** 2 * np.sin(2.0 * angle) / np.cos(bend)
    torque = 600.0 + 0.8 * slope * speed**2
    for shaft, values in enumerate((torque * ratio, torque)):
        assert values.min() < -600.0
        ends = f"from {values.min():.0f} N m to {values.max():.0f} N m"
        assert ends in found[f"shaft {shaft}"]


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("= 1000", "= 400"),  # The torque keeps its sign.
        ("= 600", "= 0"),  # There is no torque to reverse.
        ("inertias_kgm2 = [0.1, 0.8]", ""),
    ],
)
def test_other_torques_are_not(old: str, new: str) -> None:
    assert old in BALER
    assert remarks(BALER.replace(old, new)) == {}


def test_the_state_in_which_it_reverses_most_is_named() -> None:
    text = BALER + '[states]\nnames = ["slow", "fast"]\nspeed_rpm = [900, 1000]\n'
    found = remarks(text)
    assert "N m in fast: splines" in found["shaft 1"]

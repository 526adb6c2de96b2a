"""What is wrong in a scene file, by fields: file, line, section, key and place."""

from __future__ import annotations

import pickle
from pathlib import Path

import pytest

from cardan import ArgumentValueError
from cardan.app.scene import Scene, SceneError
from cardan.app.scene.language.errors import StudyPointError
from cardan.app.scene.study.cluster import connect, write_study

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

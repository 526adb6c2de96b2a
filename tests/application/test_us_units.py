"""Scenes in US units: every key, the answers of machines, and what is refused."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from cardan.app.answers.answer import Answer
from cardan.app.answers.limits.data import check_data
from cardan.app.scene import Scene
from cardan.app.scene.language.errors import Location
from cardan.app.scene.language.rules import InUnit, Rule
from cardan.app.scene.language.section import Key
from cardan.app.scene.language.units import ENDINGS, split, us_keys
from cardan.app.scene.scene import FORMAT
from us_units import si_scene, us_scene

ROOT = Path(__file__).parents[2]
MACHINES = sorted((ROOT / "python/cardan/app/scene/machines").glob("*.toml"))

PAIRS = [
    (section.name, key, us)
    for section in FORMAT.values()
    for key in section.keys
    for us in us_keys(key)
]


def test_there_are_us_units_of_what_a_shop_measures() -> None:
    known = {f"{section}.{us}" for section, _, us in PAIRS}
    assert known >= {
        "driveline.points_in",
        "driveline.lengths_ft",
        "load.output_torque_lbft",
        "joints.rating_lbin",
        "load.inertias_lbin2",
        "limits.bearing_force_lbf",
        "tubes.permitted_stress_psi",
        "tubes.elastic_modulus_Mpsi",
        "tubes.density_lb_in3",
        "torsion.stiffnesses_lbft_per_rad",
        "states.points_in",
    }


def test_the_factors_are_those_of_the_standards() -> None:
    """NIST Special Publication 811 (2008), appendix B.8, to the digits printed there."""
    printed = {
        "in": 25.4,
        "ft": 0.3048,
        "lbf": 4.448222,
        "lbft": 1.355818,
        "lbin": 0.1129848,
        "lbin2": 2.926397e-4,
        "psi": 6.894757e-3,
        "lb": 0.45359237,
        "lb_in3": 2.767990e4,
    }
    for ending, size in printed.items():
        assert ENDINGS[ending].size == pytest.approx(size, rel=5e-7)
    assert ENDINGS["in"].size == 25.4
    assert ENDINGS["lbf"].size == 4.4482216152605


_SAMPLES: list[Any] = [
    10.0,
    [10.0, 20.0],
    [[1.0, 2.0, 3.0]],
    [10.0],
    [1.0, 2.0, 3.0],
    [2.0, [3.0, 4.0]],
    "T",
]


def _sample(rule: Rule, key: str) -> Any:  # noqa: ANN401 - any value of TOML
    for value in _SAMPLES:
        try:
            rule.read(Location(key), value)
        except ValueError:
            continue
        return value
    return None


def _divided(value: Any, size: float) -> Any:  # noqa: ANN401 - any value of TOML
    if isinstance(value, list):
        return [_divided(each, size) for each in value]
    return value / size if isinstance(value, float) else value


def _flat(value: Any) -> list[Any]:  # noqa: ANN401 - any value of TOML
    return [part for each in value for part in _flat(each)] if isinstance(value, list) else [value]


@pytest.mark.parametrize(("section", "key", "us"), PAIRS)
def test_every_key_is_read_in_us_units(section: str, key: str, us: str) -> None:
    keys: dict[str, Key] = dict(FORMAT[section].keys)
    rule, other = keys[key].rule, keys[us].rule
    if section in ("study", "states") or key.partition("_")[2].startswith("column"):
        # Paths and names of columns, whose values stay in the unit of their key.
        assert other == rule
        return
    assert isinstance(other, InUnit)
    value, size = _sample(rule, key), ENDINGS[split(us)[1]].size
    assert value is not None
    read = other.read(Location(us), _divided(value, size))
    assert _flat(read) == pytest.approx(_flat(rule.read(Location(key), value)), rel=1e-15)


def _answer(text: str, path: Path) -> dict[str, Any]:
    return check_data(Answer(Scene.parse(text, str(path), path.parent)), [])


@pytest.mark.parametrize("path", MACHINES, ids=lambda path: path.stem)
def test_machines_have_the_same_answers_in_us_units(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    given = us_scene(text, "us")
    assert "_mm" not in given.replace("_Nmm", "")
    assert "_Nm" not in given
    assert _answer(given, path) == _answer(si_scene(text), path)


BASE = """\
[driveline]
points_in = [[0, 0, 0], [12, -1, 0], [60, -2, 0], [100, -6, 1]]
phases_deg = [0]
"""
REFUSED = [
    (
        "points_mm = [[0, 0, 0], [1, 1, 1], [2, 3, 4]]\n",
        "line 4: [driveline] points_mm and points_in are both given; give one of them",
    ),
    (
        '[states]\n"points_mm.2.y" = [1, 2]\n',
        "line 5: [states] points_mm is in millimetres, but [driveline] gives points_in; give both "
        "in the same unit",
    ),
    (
        '[states]\n"points_in.2.y" = [1, 2]\n"points_mm.3.y" = [1, 2]\n',
        "line 6: [states] points_mm and points_in are both given; give one of them",
    ),
    (
        '[states]\n"points_in.2" = {turn_deg = [1, 2], about_mm = [0, 0, 0], axis = "y"}\n',
        "line 5: [states] points_in.2 has about_mm; the point is in the unit of points_in",
    ),
    (
        "[[bearing]]\nshaft = 0\nposition_in = 6\n[study]\nbearing.0.position_mm = [1, 2]\n",
        "line 8: [study] bearing.0.position_mm is in millimetres, but [[bearing]] gives "
        "position_in; give both in the same unit",
    ),
    (
        "[load]\noutput_torque_lbft = 1\n[study]\noutput_torque_Nm = [1, 2]\n",
        "line 7: [study] output_torque_Nm is in N m, but [load] gives output_torque_lbft; give "
        "both in the same unit",
    ),
    (
        "[load]\noutput_torque_lbft = 1\noutput_torque_lbin = 2\n",
        "line 6: [load] output_torque_lbin and output_torque_lbft are both given; give one of them",
    ),
    (
        "[load]\noutput_torque_lbft = 1\ndrive_torque_Nm = 2\n",
        "line 6: [load] drive_torque_Nm and output_torque_lbft are both given; give one of them",
    ),
    (
        '[optimise]\nvary = {"points_mm.2.y" = [-1, 1]}\n',
        "line 5: [optimise] vary.points_mm.2.y is in millimetres, but [driveline] gives points_in; "
        "give both in the same unit",
    ),
    (
        "[load]\noutput_torque_lbft = 300\n[optimise]\nvary = {'points_in.2.y' = [-1, 1]}\n"
        "keep = {support_moment_1_peak_Nm = 3, support_moment_1_peak_lbft = 3}\n",
        "line 8: [optimise] keep.support_moment_1_peak_lbft and support_moment_1_peak_Nm are both "
        "given; give one of them",
    ),
    (
        "[ball_joint]\nload_lbf = 100\nradius_in = 1\n"
        "ball = {layer_in = 0.1, layer_mm = 3, modulus_psi = 1000}\n",
        "line 7: [ball_joint] ball.layer_mm and layer_in are both given; give one of them",
    ),
    # Key and values as they are given, also those that follow from others.
    (
        "[offsets]\nshafts_in = 50\n",
        "line 5: [offsets] shafts_in is 50 in; it must lie within ±39.3701 in",
    ),
    (
        "[tubes]\nouter_diameter_in = 2\nwall_in = 1.5\n",
        "line 6: [tubes] wall_in is 1.5 in; a wall is at most half the outer diameter of 2 in",
    ),
    (
        "[tubes]\nouter_diameter_in = 2\nwall_mm = 70\n",
        "line 6: [tubes] wall_mm is 70 mm; a wall is at most half the outer diameter of 50.8 mm",
    ),
    (
        "[[bearing]]\nshaft = 0\nposition_in = 20\n",
        "line 6: [[bearing]][0] position_in is 20 in on shaft 0 of length 12.04159458 in; a "
        "bearing must lie between the end and the joint of its shaft",
    ),
    (
        "[load]\ninertias_lbin2 = [1, 2]\n",
        "line 5: [load] inertias_lbin2 has length 2; it needs 3, one per shaft",
    ),
    (
        '[states]\n"points_in.2.y" = [1, 2000]\n',
        "line 4: [states] in 'points_in.2.y = 2000', at points_in.2.y = 2000: points_in give joint "
        "0 a bend of 93.389494 deg at point 1, between points 0 and 2; a bend must lie in [0, 90) "
        "deg",
    ),
]


@pytest.mark.parametrize(("text", "message"), REFUSED)
def test_errors_speak_of_what_was_written(text: str, message: str) -> None:
    with pytest.raises(ValueError, match=r"^shaft\.toml") as caught:
        Scene.parse(BASE + text, "shaft.toml")
    assert str(caught.value) == f"shaft.toml, {message}"


def test_a_table_of_sizes_is_in_us_units(tmp_path: Path) -> None:
    (tmp_path / "sizes.csv").write_text("size;rating_lbin;arm_in\n1310;1000;1,5\n")
    text = (
        BASE + '[joints]\nsizes = "sizes.csv"\nsize = "1310"\nfriction = 0.01\npin_radius_in = 1\n'
    )
    sizes = Scene.parse(text, "a.toml", tmp_path).sizes
    assert sizes
    assert sizes.each[0].rating == pytest.approx(112.9848290276, rel=1e-12)
    assert sizes.each[0].arm == pytest.approx(0.0381, rel=1e-15)
    (tmp_path / "sizes.csv").write_text("size,rating_lbin,rating_Nm\n1310,1000,113\n")
    with pytest.raises(ValueError, match="columns 'rating_lbin' and 'rating_Nm' hold the same"):
        Scene.parse(text, "a.toml", tmp_path)


def test_a_recorded_torque_is_in_us_units(tmp_path: Path) -> None:
    (tmp_path / "run.csv").write_text("angle,torque\n0,100\n90,110\n180,90\n")
    text = (
        "[driveline]\nbends_deg = [10]\n"
        '[angles]\nfile = "run.csv"\nangle_column_deg = "angle"\ntorque_column_lbft = "torque"\n'
    )
    load = Scene.parse(text, "a.toml", tmp_path).load_case
    assert load is not None
    assert load.torque == pytest.approx([135.58179483314, 149.13997431645, 122.02361534983])

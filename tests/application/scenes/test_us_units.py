"""Scenes in US units: every key, the answers of machines, and what is refused."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner

from cardan.app.answers.answer import Answer
from cardan.app.answers.printed import row_text
from cardan.app.answers.rows import UNITS, Judged
from cardan.app.answers.schema import check_data
from cardan.app.answers.turn.picture import quantities
from cardan.app.command import commands
from cardan.app.scene import Scene
from cardan.app.scene.language.errors import Location
from cardan.app.scene.language.rules import InUnit, Rule
from cardan.app.scene.language.section import Key
from cardan.app.scene.language.units import ENDINGS, US, System, shown_in, split, us_keys
from cardan.app.scene.scene import FORMAT
from live import Run, at, in_node, moves_of, sent, told_after, without_slow_parts
from us_units import si_scene, us_scene

ROOT = Path(__file__).parents[3]
MACHINES = sorted((ROOT / "python/cardan/app/scene/machines").glob("*.toml"))
_QUICK = ("pto-shaft", "steering-column", "test-rig")
each_machine = pytest.mark.parametrize(
    "path",
    [
        pytest.param(path, id=path.stem, marks=[pytest.mark.long] * (path.stem not in _QUICK))
        for path in MACHINES
    ],
)

PAIRS = [
    (section.name, key, us)
    for section in FORMAT.values()
    for key in section.keys
    for us in us_keys(key)
]


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


@each_machine
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


# --- what is printed, drawn and written -----------------------------------------------------------

TRUCK = next(path for path in MACHINES if path.stem == "truck-shaft")


@each_machine
def test_printed_figures_are_those_of_the_json(path: Path) -> None:
    """In US units to at least as many digits, but for those that are exact."""
    answer = Answer(Scene.load(path))
    count = 0
    for part, found in answer.parts("check"):
        for _, row, value, _ in part.entries(found):
            number = value.value if isinstance(value, Judged) else value
            if row.kind != "figure" or row.unit not in US or not number or not np.isfinite(number):
                continue
            us = US[row.unit][0]
            texts = [row_text(number, row)]
            with shown_in("us"):
                texts.append(row_text(number, row))
            figures = [float(text.partition(" ")[0]) for text in texts]
            assert texts[1].endswith(f" {ENDINGS[us].symbol}")
            expected = UNITS[row.unit].factor * number / ENDINGS[us].size
            mantissa, _, power = texts[1].partition(" ")[0].partition("e")
            step = 10.0 ** (int(power or 0) - len(mantissa.partition(".")[2]))
            # What was given in SI units has six digits.
            assert abs(figures[1] - expected) <= max(step, 1e-6 * abs(expected))
            coarse = abs(figures[0] / ENDINGS[us].size - expected)
            assert abs(figures[1] - expected) <= max(coarse, 0.006 * abs(expected))
            count += 1
    assert count > 3 or path.stem == "steering-column"


def _said(*arguments: str) -> str:
    output: str = CliRunner().invoke(commands(), arguments).output
    return output


SI = r"(?<![\w.])-?[\d.]+ (mm|m|N m|N|kN|MPa|kg m²|kg)(?![\w/])"


_COMMANDS = ("run", "tolerances", "torsion", "life")


@pytest.mark.parametrize(
    "name", ["check", "phase", *(pytest.param(name, marks=pytest.mark.long) for name in _COMMANDS)]
)
def test_no_command_prints_si_units_besides(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    # Names of states are those of the file.
    text = TRUCK.read_text(encoding="utf-8").replace(' mm"', '"')
    Path("si.toml").write_text(text)
    Path("us.toml").write_text(us_scene(text, "us"))
    given, asked = _said(name, "us.toml"), _said(name, "si.toml", "--units", "us")
    for said in (given, asked):
        assert not re.search(SI, said)
        assert re.search(r"\d (lb·ft|lbf|in|psi|lb·in²)", said) or name == "phase"
    assert re.search(SI, _said(name, "us.toml", "--units", "si")) or name == "phase"
    # Both are the same but for what rounding makes of numbers, and the names of keys.
    assert len(given.split()) == len(asked.split())


def test_json_is_in_si_units(tmp_path: Path) -> None:
    path = tmp_path / "us.toml"
    path.write_text(us_scene(TRUCK.read_text(encoding="utf-8"), "us"))
    us, si = (json.loads(_said("run", str(path), "--json", "--units", u)) for u in ("us", "si"))
    assert us["rows"] == si["rows"]
    assert us["forces"] == si["forces"]


def test_a_file_in_us_units_whose_answer_is_not_is_remarked_on() -> None:
    text = us_scene(TRUCK.read_text(encoding="utf-8"))
    (remark,) = [each for each in Answer(Scene.parse(text))["remarks"] if "US units" in each.remark]
    assert remark.about == "[driveline] points_in"
    both = Answer(Scene.parse('units = "us"\n' + text))["remarks"]
    assert not any("US units" in each.remark for each in both)


def test_axes_and_columns_name_us_units(tmp_path: Path) -> None:
    scene = Scene.parse(us_scene(TRUCK.read_text(encoding="utf-8"), "us"), folder=tmp_path)
    with shown_in("us"):
        panels = {panel.name: panel for panel in quantities(scene.run())}
    torque = panels["torque, shaft 3"]
    assert torque.heading == "torque, shaft 3 [lb·ft]"
    assert torque.curves[0] == pytest.approx(1500.0 / 1.3558179483314004, rel=1e-12)
    heads, *_ = _written(scene, tmp_path).splitlines()
    assert "torque_lbft" in heads
    assert "_Nm" not in heads


def _written(scene: Scene, folder: Path) -> str:
    from cardan.app.scene.study.curves import write_curves

    write_curves(scene.run(), folder / "curves.csv")
    return (folder / "curves.csv").read_text(encoding="utf-8")


def test_an_optimum_is_written_in_the_units_of_the_file(tmp_path: Path) -> None:
    """And it is the optimum of the same scene in SI units."""
    si = """\
[driveline]
points_mm = [[0, 0, 0], [350, -24, 0], [1650, -46, 0], [3150, -180, 45], [3450, -196, 45]]
[states]
points_mm.3.y = [-200, -180, -160]
[optimise]
vary = {"points_mm.2.y" = [-40, 40]}
"""
    found = []
    for units, text in (("us", us_scene(si)), ("si", si_scene(si))):
        path = tmp_path / f"{units}.toml"
        path.write_text(text)
        said = _said("optimise", str(path))
        assert "Equivalent bend" in said
        written = (tmp_path / f"{units}.optimised.toml").read_text()
        assert ("points_in" in written) == (units == "us")
        optimum = Scene.parse(written).points
        assert optimum is not None
        found.append(optimum[2, 1])
    assert found[0] == pytest.approx(found[1], abs=1e-4)
    assert abs(found[1] - -46.0) > 1.0


# --- the moving page ------------------------------------------------------------------------------


@in_node
def test_the_page_shows_the_units_of_the_scene_and_the_others(node: Run) -> None:
    """Each figure is written as Python writes it, in both."""
    scene = Scene.parse(us_scene(without_slow_parts(TRUCK.read_text(encoding="utf-8")), "us"))
    data = sent(scene)
    assert data["units"] == "us"
    texts = node(
        data,
        """const model = new Model(cardan, data);
        return ["us", "si"].map((units) => {
            showIn(units);
            return model.rows().map(({ text, bound }) => `${text}|${bound}`);
        });""",
    )
    by_name = {each.name: each for each in Answer(scene).judged}
    both: tuple[System, ...] = ("us", "si")
    for units, rows in zip(both, texts, strict=True):
        with shown_in(units):
            for figure, row in zip(data["figures"], rows, strict=True):
                own = by_name[figure["name"]]
                text, bound = row.split("|")
                assert text.replace("\u2212", "-") == row_text(own.value, own.entry.row)
                assert bound == figure["bound"][units]
    assert any(" in|" in row for row in texts[0])
    assert any(" psi|" in row for row in texts[0])
    assert not any(re.search(r" (mm|MPa|N)\b", row) for row in texts[0])


@in_node
def test_the_page_writes_a_scene_in_its_own_units(node: Run) -> None:
    text = us_scene(without_slow_parts(TRUCK.read_text(encoding="utf-8")), "us")
    scene = Scene.parse(text, "t.toml")
    random = np.random.default_rng(5)
    moves = [moves_of(scene, random) for _ in range(4)]
    moves.append([("point", 2, [0.0, 10.0, 0.0]), ("torque", 0, [0.2]), ("bearing", 0, [2.0])])
    for told in told_after(node, scene, moves):
        assert told["refused"] == ""
        assert told["same"]
        saved = Scene.parse(told["text"], "t.toml")
        assert re.findall(r"\w+(?= =)", told["text"]) == re.findall(r"\w+(?= =)", text)
        data = check_data(Answer(saved))
        for key, row in told["rows"].items():
            assert row["value"] == pytest.approx(at(data, key), rel=1e-6, abs=1e-9), key


# --- what else changes a driveline ----------------------------------------------------------------

WOUND = """\
[driveline]
points_mm = [[0, 0, 0], [350, -24, 0], [1650, -46, 0], [3150, -180, 45], [3450, -196, 45]]
[load]
speed_rpm = 1500
[states]
names = ["coast", "drive"]
output_torque_Nm = [-300, 1500]
[[wind_up]]
points = "3-4"
about_mm = [3450, -196, 45]
deg_per_kNm = 1.5
mm_per_kNm = [0, 2, 0]
[slip]
shaft = 2
engaged_mm = 90
"""
MEASURED = """\
[driveline]
readings_deg = [-3, -1.2, -4.1, -3.6]
offsets_mm = [0, 0, 45, 45, 45]
lengths_mm = [350, 1300, 1507, 300]
[load]
speed_rpm = 1500
output_torque_Nm = 800
"""


@pytest.mark.parametrize("text", [WOUND, MEASURED], ids=["wound up", "measured"])
def test_scenes_have_the_same_answers_in_us_units(text: str) -> None:
    given = us_scene(text, "us")
    assert not re.search(r"_(mm|Nm|kNm)\b", given)
    path = Path("scene.toml")
    assert _answer(given, path)["states" if "[states]" in text else "limits"]
    us, si = (check_data(Answer(Scene.parse(each))) for each in (given, si_scene(text)))
    assert us["limits"]["equivalent_bend"]["value_deg"] == pytest.approx(
        si["limits"]["equivalent_bend"]["value_deg"], rel=1e-9
    )
    if "spline" in si:
        values = [each["spline"]["longest"]["value_mm"] for each in (us, si)]
        assert values[0] == pytest.approx(values[1], rel=1e-12)


def test_offsets_are_noted_in_inches() -> None:
    text = us_scene(MEASURED).replace("1.7716535433070868, ", '"1.5 in left", ', 1)
    layout = Scene.parse(text).layout
    assert layout is not None
    assert layout.driveline["offsets_mm"][2] == pytest.approx(38.1, rel=1e-15)
    with pytest.raises(ValueError, match=r"offsets_in\[2\] is '38 mm left'; it must be as"):
        Scene.parse(text.replace("1.5 in left", "38 mm left"))


def test_ranges_and_limits_of_a_search_are_in_the_units_of_their_keys() -> None:
    text = """\
[driveline]
points_in = [[0, 0, 0], [14, -1, 0], [66, -2, 0], [126, -7, 2], [138, -8, 2]]
[load]
speed_rpm = 100
output_torque_lbft = 300
[optimise]
vary = {"points_in.2.y" = [-2, 2]}
keep = {support_moment_1_peak_lbft = 50}
"""
    found = Scene.parse(text).optimisation
    assert found is not None
    assert found._kept == {"support_moment_1_peak": pytest.approx(67.79089741657, rel=1e-12)}
    parameters = found._parameters
    assert parameters is not None
    assert parameters[0][2] == pytest.approx(0.0254, rel=1e-15)
    (low, high) = (found.drivelines(np.array([x])).lengths().each[0, 1] for x in (-2.0, 2.0))
    assert low == pytest.approx(0.0254 * np.hypot(52.0, 3.0), rel=1e-12)
    assert high == pytest.approx(0.0254 * np.hypot(52.0, 1.0), rel=1e-12)

"""Tolerances of a scene over its states: values, sentences, answers, check, report and pictures."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import pytest
from click.testing import CliRunner

from cardan import Driveline, Load
from cardan.app.answers.answer import Answer
from cardan.app.answers.data import data_of
from cardan.app.answers.printed import quantity
from cardan.app.answers.schema import answer, answers_schema, check_data
from cardan.app.answers.table import PARTS
from cardan.app.answers.tolerances.figures import ToleranceFigure, sentences, tolerance_figures
from cardan.app.command import commands
from cardan.app.report import write_report
from cardan.app.scene import Scene

POINTS = np.array([[0, 0, 0], [350, -24, 0], [1650, -86, 0], [3150, -180, 45], [3450, -196, 45]])
HEIGHTS = (-80, 0, 80)
TEXT = f"""\
[driveline]
points_mm = {POINTS.tolist()}
phases_deg = [-30, 0]
[states]
"points_mm.3.y" = {[-180 + y for y in HEIGHTS]}
"points_mm.4.y" = {[-196 + y for y in HEIGHTS]}
names = ["low", "rest", "high"]
[limits]
equivalent_bend_deg = 2
[tolerances]
points_mm = 1
phases_deg = 3
samples = 20_000
"""
ANSWERS = jsonschema.Draft202012Validator(answers_schema())


def tolerances_data(of: Scene) -> dict[str, Any]:
    return answer("tolerances", of.title, **data_of(Answer(of).needed("tolerances")))


def line() -> Driveline:
    points = np.repeat(1e-3 * POINTS[np.newaxis], 3, axis=0)
    points[:, 3:, 1] += 1e-3 * np.array(HEIGHTS)[:, np.newaxis]
    return Driveline.from_points(points, [-30, 0], degrees=True)


def figure(text: str = TEXT) -> ToleranceFigure:
    found = tolerance_figures(Scene.parse(text))
    assert found is not None
    return found.figures[0]


def test_values_are_those_of_the_library() -> None:
    found, states = figure(), line()
    sizes = {"points": 1e-3, "phases": np.radians(3.0), "limit": np.radians(2.0)}
    own = states.tolerances(**sizes, states=0, samples=20_000, seed=0)
    assert found.passing is not None
    assert found.guaranteed is not None
    assert found.worst.value == pytest.approx(own.worst, rel=1e-9)
    assert found.passing.value == own.passing
    quantiles = (found.half, found.most, found.nearly)
    assert quantiles == pytest.approx(own.quantile([0.5, 0.95, 0.99]), rel=1e-9)
    assert found.worst.state == ("low", "rest", "high")[own.worst_state]
    for i, state in enumerate(("low", "rest", "high")):
        alone = states[i].tolerances(**sizes, samples=20_000, seed=0)
        assert found.nominal.each[state] == pytest.approx(alone.nominal, rel=1e-9)
        assert found.worst.each[state] == pytest.approx(alone.worst, rel=1e-9)
        assert found.guaranteed.each[state] == pytest.approx(alone.guaranteed, rel=1e-9)
        assert found.passing.each[state] == alone.passing
    assert own.passing <= min(found.passing.each.values())
    # As drawn the worst state is another one than within the tolerances.
    assert found.nominal.state == "high" != found.worst.state


def test_the_driveline_of_the_scene_need_not_be_a_state() -> None:
    apart = TEXT.replace("[3150, -180, 45], [3450, -196, 45]", "[3150, -600, 45], [3450, 96, 45]")
    assert figure(apart) == figure()


def test_speed_and_load_are_those_of_each_state() -> None:
    of = '["inertia_excitation", "support_moment_1_peak"]'
    text = TEXT.replace("samples = 20_000", f"samples = 100\nof = {of}").replace(
        '"points_mm.3.y"', 'output_torque_Nm = [100, 900, 200]\n"points_mm.3.y"'
    )
    text += "[load]\nspeed_rpm = 2000\noutput_torque_Nm = 50\n"
    found = tolerance_figures(Scene.parse(text))
    assert found is not None
    inertia, moment = found.figures
    speed = 2000.0 * np.pi / 30.0
    for i, torque in enumerate((100.0, 900.0, 200.0)):
        check = line()[i].check(speed).findings
        excitations = [
            float(one.value) for one in check if one.figure.startswith("inertia_excitation")
        ]
        state = ("low", "rest", "high")[i]
        assert inertia.nominal.each[state] == pytest.approx(max(excitations), rel=1e-9)
        load = Load(output_torque=torque, speed=speed)
        turn = np.radians(np.arange(360.0))
        peak = line()[i].evaluate(turn, "support_moment", shafts=1, load=load, reduce="peak")
        assert moment.nominal.each[state] == pytest.approx(float(peak.support_moment), rel=1e-9)
    assert moment.worst.state == "rest"
    varied = text.replace("output_torque_Nm = [100, 900, 200]", "speed_rpm = [1000, 1500, 3000]")
    assert Scene.parse(varied).tolerances is not None
    alone = Scene.parse(varied).in_state(2)
    assert alone.tolerances is not None
    assert alone.tolerances.n_states is None
    check = line()[2].check(3000.0 * np.pi / 30.0).findings
    assert alone.tolerances.nominal["inertia_excitation"] == pytest.approx(
        max(float(one.value) for one in check if one.figure.startswith("inertia")), rel=1e-9
    )


def test_the_sentence_names_the_state() -> None:
    found = tolerance_figures(Scene.parse(TEXT))
    assert found is not None
    (sentence,) = sentences(found)
    passing, worst = found.figures[0].passing, found.figures[0].worst.value
    assert passing is not None
    assert passing.value is not None
    assert worst is not None
    share = f"{100.0 * passing.value:.1f}%"
    assert sentence.startswith(
        f"As drawn, the driveline is within the 2° limit in every state. With these tolerances, "
        f"{share} of all drivelines are within it in every state; the worst has "
        f"{np.degrees(worst):.2f}° in low, "
    )
    tight = tolerance_figures(Scene.parse(TEXT.replace("bend_deg = 2", "bend_deg = 1.4")))
    assert tight is not None
    assert re.match(
        r"As drawn, the driveline is beyond the 1\.4° limit in high\. With these tolerances, "
        r"\d+\.\d% of all drivelines are within it in every state; the worst has "
        r"\d\.\d+° in low, ",
        next(sentences(tight)),
    )
    none = TEXT.replace("samples", "of = 'torque_1_peak'\nsamples") + "[load]\noutput_torque_Nm = 9"
    open_ = tolerance_figures(Scene.parse(none))
    assert open_ is not None
    said = r"Torque of shaft 1, peak: 9\.\d+ N m as drawn in low; with these"
    assert re.match(said, next(sentences(open_)))
    unnamed = TEXT.replace('names = ["low", "rest", "high"]\n', "")
    found = tolerance_figures(Scene.parse(unnamed))
    assert found is not None
    assert " in state 0, " in next(sentences(found))


def test_the_text_has_a_row_for_each_state() -> None:
    found = tolerance_figures(Scene.parse(TEXT))
    assert found is not None
    text = PARTS["tolerances"].text(found)
    assert "Equivalent bend in each state\n" in text
    heads, *rows = text.partition("  state ")[2].partition("\n\n")[0].splitlines()
    assert heads.split("  ")[-1] == "within the limit"
    assert [row.split()[0] for row in rows] == ["low", "rest", "high"]
    assert [row.split()[1] for row in rows] == [
        quantity(value, "deg") for value in found.figures[0].nominal.each.values()
    ]
    assert max(map(len, text.splitlines())) <= 79


@pytest.mark.long
def test_answers_check_report_and_picture(tmp_path: Path) -> None:
    given = Scene.parse(TEXT)
    data = tolerances_data(given)
    ANSWERS.validate(data)
    (entry,) = data["figures"]
    states = entry["worst"]["states"]
    assert [state["state"] for state in states] == ["low", "rest", "high"]
    assert entry["worst"]["value"] == max(state["value"] for state in states)
    assert (entry["unit"], entry["worst"]["state"]) == ("deg", "low")
    checked = check_data(Answer(given))
    ANSWERS.validate(checked)
    assert checked["tolerances"]["figures"] == data["figures"]
    path = tmp_path / "truck.toml"
    path.write_text(TEXT, encoding="utf-8")
    picture = tmp_path / "scatter.svg"
    result = CliRunner().invoke(commands(), ["tolerances", str(path), "--output", str(picture)])
    assert result.exit_code == 0, result.output
    assert picture.stat().st_size > 5000
    printed = CliRunner().invoke(commands(), ["tolerances", str(path), "--json"])
    assert json.loads(printed.output) == data
    found = tolerance_figures(given)
    assert found is not None
    (sentence,) = sentences(found)
    said = CliRunner().invoke(commands(), ["check", str(path)])
    assert sentence in " ".join(said.output.split())
    page = tmp_path / "page.html"
    write_report(given, page)
    text = page.read_text(encoding="utf-8")
    assert text.count(sentence) == 2
    assert "Equivalent bend in each state" in text

"""Tolerances of a scene and over its states: values, errors, sentences and pictures."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pytest

import cardan
import scripts
from cardan import Driveline, Load
from cardan.app.answers.answer import Answer
from cardan.app.answers.printed import quantity
from cardan.app.answers.table import PARTS
from cardan.app.answers.tolerances.figures import (
    ToleranceFigure,
    ToleranceFigures,
    percent,
    permitted_texts,
    permitted_tolerances,
    sentences,
    tolerance_figures,
)
from cardan.app.plots import plot_tolerance_shares, plot_tolerances
from cardan.app.report import write_report
from cardan.app.scene import Scene

ROOT = Path(__file__).parents[3]


WORKSHOP = ROOT / "examples" / "workshop.toml"


TEXT = WORKSHOP.read_text(encoding="utf-8")


POINTS = """\
[driveline]
points_mm = [[0, 0, 0], [300, 0, 0], [1500, -100, 20], [2400, -250, 30]]
"""


POINTS_M = """\
[driveline]
points_m = [[0, 0, 0], [0.3, 0, 0], [1.5, -0.1, 0.02], [2.4, -0.25, 0.03]]
"""


TWO = "[driveline]\nbends_deg = [10, 10]\n"


def scene(text: str) -> Scene:
    return Scene.parse(text)


def figures(text: str) -> ToleranceFigures:
    found = tolerance_figures(scene(text))
    assert found is not None
    return found


def test_values_are_those_of_the_library() -> None:
    whole = figures(TEXT)
    found = whole.figures[0]
    line = cardan.Driveline.from_bends([10, 10], degrees=True)
    own = line.tolerances(bends=0.1, phases=5.0, degrees=True, seed=0)
    assert found.worst.value == pytest.approx(own.worst, rel=1e-12)
    assert found.guaranteed is not None
    assert found.guaranteed.value == pytest.approx(own.guaranteed, rel=1e-12)
    assert (found.half, found.most, found.nearly) == pytest.approx(
        own.quantile([0.5, 0.95, 0.99]), rel=1e-12
    )
    assert found.passing is not None
    assert found.passing.value == own.passing
    assert found.limit == pytest.approx(math.radians(3.0))
    assert whole.shares[0].label == "phase of shaft 1"
    assert sum(share.share for share in whole.shares) == pytest.approx(1.0)
    permitted = {part.group: part.factor for part in permitted_tolerances(own)}
    assert math.isnan(permitted["bends"])
    assert permitted["phases"] == pytest.approx(own.permitted("phases"))


def test_points_have_millimetres() -> None:
    scenes = [scene(f"{text}[tolerances]\npoints_mm = 2\n") for text in (POINTS, POINTS_M)]
    points = np.array([[0, 0, 0], [300, 0, 0], [1500, -100, 20], [2400, -250, 30]])
    own = cardan.Driveline.from_points(points).tolerances(points=2.0)
    for given in scenes:
        assert given.tolerances is not None
        assert given.tolerances.worst == pytest.approx(own.worst, rel=1e-9)
    each = scene(f"{POINTS}[tolerances]\npoints_mm = [0, 1, 0, 0]\n").tolerances
    assert each is not None
    assert (each.given["points"] > 0).sum(axis=-1).tolist() == [0, 3, 0, 0]
    assert each.given["points"][1] == pytest.approx(1e-3)


def test_limits_are_those_of_the_scene() -> None:
    of = '["equivalent_bend", "non_uniformity", "inertia_excitation_driving", "torque"]'
    text = (
        f"{TWO}[load]\nspeed_rpm = 1500\noutput_torque_Nm = 100\n[limits]\npreset = 'truck'\n"
        f"equivalent_bend_deg = [2, 4]\n[tolerances]\nphases_deg = 1\nof = {of}\nsamples = 100\n"
    )
    limits = {figure.name: figure.limit for figure in figures(text).figures}
    joint = cardan.Driveline.from_bends([2.0], degrees=True).equivalent()
    assert limits["equivalent_bend"] == pytest.approx(math.radians(2.0))
    assert limits["non_uniformity"] == pytest.approx(float(joint.non_uniformity))
    assert limits["inertia_excitation_driving"] == pytest.approx(1000.0)
    assert limits["torque"] is None
    guaranteed = {figure.name: figure.guaranteed for figure in figures(text).figures}
    assert guaranteed["torque"] is None
    assert None not in (guaranteed["equivalent_bend"], guaranteed["non_uniformity"])
    own = f"{TWO}[tolerances]\nphases_deg = 1\nlimit = 1.5\nsamples = 100\n"
    assert figures(own).figures[0].limit == pytest.approx(math.radians(1.5))
    ratio = own.replace("limit = 1.5", "of = 'non_uniformity'\nlimit = 0.01")
    assert figures(ratio).figures[0].limit == 0.01


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (f"{TWO}[tolerances]\nsamples = 9\n", "[tolerances]"),
        (f"{TWO}[tolerances]\nphases_deg = -1\n", "phases_deg is -1; it must not be negative"),
        (
            f"{TWO}[tolerances]\nphases_deg = [1, 2]\n",
            "phases_deg has length 2; it needs 1, one per shaft",
        ),
        (f"{TWO}[tolerances]\nbends_deg = 81\n", "bends_deg permit a bend of 91 deg at joint 0"),
        (
            f"{TWO}[tolerances]\npoints_mm = 1\n",
            "points_mm have tolerances, but the driveline was not made from points",
        ),
        (f"{POINTS}[tolerances]\npoints_mm = 1\nbends_deg = 1\n", "points_mm"),
        (f"{POINTS}[tolerances]\npoints_mm = 1e3\n", "points_mm permit a bend of"),
        (
            f"{POINTS}[tolerances]\npoints_mm = [1, 2]\n",
            "points_mm has length 2; it needs 4, one per point",
        ),
        (f"{TWO}[tolerances]\nphases_deg = 1\nof = 'bend'\n", "of is 'bend'"),
        (
            f"{TWO}[tolerances]\nphases_deg = 1\nof = 'torque'\n",
            "of has 'torque', which needs a section [load]",
        ),
        (
            f"{TWO}[tolerances]\nphases_deg = 1\nof = 'torsional_excitation'\n",
            "of has 'torsional_excitation', which needs a speed in [load]",
        ),
        (
            f"{TWO}[tolerances]\nphases_deg = 1\nof = ['angle', 'equivalent_bend']\nlimit = 2\n",
            "limit applies to a single figure, and 'of' names 2",
        ),
    ],
)
def test_what_is_refused(text: str, said: str) -> None:
    with pytest.raises(ValueError, match=re.escape(said)) as caught:
        scene(text)
    # The line of the section or of the key.
    assert re.match(r"scene, line [3-6]: \[tolerances\]", str(caught.value)), caught.value


def test_the_sentence_of_check_and_report(tmp_path: Path) -> None:
    result = scripts.run("check", WORKSHOP)
    assert result.exit_code == 1
    flat = " ".join(result.output.split())
    sentence = (
        "As drawn, the driveline is within the 3° limit. With these tolerances, 50.3% of all "
        "drivelines are within it; the worst has 4.24°, mostly from the phase of shaft 1."
    )
    assert sentence in flat
    page = tmp_path / "page.html"
    write_report(scene(TEXT), page)
    text = page.read_text(encoding="utf-8")
    # In the first section and in its own, which the navigation names.
    assert text.count(sentence) == 2
    assert text.count('href="#tolerances"') == 2
    assert "What makes the equivalent bend scatter" in text
    without = tmp_path / "without.html"
    write_report(scene(TWO), without)
    assert "olerances" not in without.read_text(encoding="utf-8").split("<script")[0]


def test_sentences() -> None:
    texts = {
        "[tolerances]\nphases_deg = 1\n": "As drawn, the driveline is within the 3° limit. With "
        "these tolerances, 100% of all",
        "phases_deg = [20]\n[tolerances]\nphases_deg = 1\n": "As drawn, the driveline is beyond "
        "the 3° limit. With these tolerances, 0% of all drivelines are within it; the worst has",
    }
    for text, said in texts.items():
        assert next(sentences(figures(TWO + text))).startswith(said)
    several = (
        f"{TWO}[load]\nspeed_rpm = 900\n[tolerances]\nphases_deg = 1\nsamples = 100\n"
        "of = ['equivalent_bend', 'inertia_excitation_driving']\n"
    )
    first, second = sentences(figures(several))
    assert first.startswith("Equivalent bend: as drawn, the driveline is within the 3° limit.")
    assert re.match(r"Inertia excitation, driving: \d+ rad/s² as drawn; with", second)
    alone = scene(f"{TWO}[tolerances]\nphases_deg = 1\n").tolerances
    assert alone is not None
    found = figures(f"{TWO}[tolerances]\nphases_deg = 1\n")
    (text,) = permitted_texts(found, permitted_tolerances(alone))
    assert text == "Every driveline is within 3° if the phases are exact to ±2.56°."
    small = scene("[driveline]\nbends_deg = [1, 1]\n[tolerances]\nphases_deg = 1\n").tolerances
    assert small is not None
    (text,) = permitted_texts(found, permitted_tolerances(small))
    assert text == "With any error of the phases every driveline is within 3°."
    assert [percent(x) for x in (1.0, 0.99999, 0.5, 1e-5, 0.0)] == [
        "100%",
        "99.999%",
        "50.0%",
        "0.001%",
        "0%",
    ]


def test_pictures_show_samples_limit_and_shares() -> None:
    from matplotlib import pyplot

    found = scene(TEXT).tolerances
    assert found is not None
    axes = plot_tolerances(found)
    (bars,) = axes.containers
    shares = [bar.get_height() for bar in bars]
    assert sum(shares) == pytest.approx(100.0)
    (upto,) = [other for other in axes.figure.axes if other is not axes]
    curve, limit, worst = upto.get_lines()
    x, y = np.asarray(curve.get_xdata()), np.asarray(curve.get_ydata())
    assert y[-1] == 100.0
    for place in (50, 200, 350):
        assert y[place] == pytest.approx(100 * np.mean(found.sampled_deg <= x[place]), abs=1e-9)
    assert np.asarray(limit.get_xdata())[0] == pytest.approx(3.0)
    assert np.asarray(worst.get_xdata())[0] == pytest.approx(found.worst_deg)
    assert axes.get_xlabel() == "equivalent bend [deg]"
    bars = plot_tolerance_shares(found).containers[0]
    assert [bar.get_width() for bar in bars] == pytest.approx([97.4, 1.3, 1.3], abs=0.05)
    pyplot.close("all")


@pytest.mark.parametrize(
    ("more", "verdict"),
    [
        ("phases_deg = 2", "within"),
        # The worst driveline counts, although half of the others are within the limit.
        ("phases_deg = 5", "beyond"),
        ("phases_deg = 5\nshare = 0.5", "within"),
        ("phases_deg = 5\nshare = 0.53", "beyond"),
        ("phases_deg = 5\nlimit = 4.5", "within"),
        ("phases_deg = 5\nof = 'acceleration_order_1'\n[load]\nspeed_rpm = 100", "not judged"),
    ],
)
def test_the_worst_driveline_or_the_share_is_judged(more: str, verdict: str) -> None:
    found = Answer(scene(f"{TWO}[tolerances]\n{more}\n"))
    judged = [each for each in found.judged if each.part.name == "tolerances"]
    known = {each.value.verdict for each in judged} - {"not judged"}
    assert known == ({verdict} if verdict != "not judged" else set())
    assert found.passes == (verdict != "beyond")
    assert len([each for each in judged if each.value.limit is not None]) == len(known)


def test_a_share_that_is_settled_needs_few_drivelines() -> None:
    """All or none of thousands mean less than 0.1 %; with one half, the default stays."""
    for phases, limit, drawn in ((5, 0.01, 16_384), (1, 3, 16_384), (5, 3, 100_000)):
        found = figures(f"{TWO}[tolerances]\nphases_deg = {phases}\nlimit = {limit}\n")
        assert found.samples == drawn
        assert found.figures[0].passing is not None
        line = cardan.Driveline.from_bends([10, 10], degrees=True)
        own = line.tolerances(phases=phases, degrees=True, limit=limit, seed=0)
        assert found.figures[0].passing.value == pytest.approx(own.passing, abs=1e-3)
    asked = figures(f"{TWO}[tolerances]\nphases_deg = 1\nsamples = 50_000\n")
    assert asked.samples == 50_000


STATES_POINTS = np.array(
    [[0, 0, 0], [350, -24, 0], [1650, -86, 0], [3150, -180, 45], [3450, -196, 45]]
)


HEIGHTS = (-80, 0, 80)


STATES_TEXT = f"""\
[driveline]
points_mm = {STATES_POINTS.tolist()}
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


def line() -> Driveline:
    points = np.repeat(1e-3 * STATES_POINTS[np.newaxis], 3, axis=0)
    points[:, 3:, 1] += 1e-3 * np.array(HEIGHTS)[:, np.newaxis]
    return Driveline.from_points(points, [-30, 0], degrees=True)


def figure(text: str = STATES_TEXT) -> ToleranceFigure:
    found = tolerance_figures(Scene.parse(text))
    assert found is not None
    return found.figures[0]


def test_speed_and_load_are_those_of_each_state() -> None:
    of = '["inertia_excitation", "support_moment_1_peak"]'
    text = STATES_TEXT.replace("samples = 20_000", f"samples = 100\nof = {of}").replace(
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
    found = tolerance_figures(Scene.parse(STATES_TEXT))
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
    tight = tolerance_figures(Scene.parse(STATES_TEXT.replace("bend_deg = 2", "bend_deg = 1.4")))
    assert tight is not None
    assert re.match(
        r"As drawn, the driveline is beyond the 1\.4° limit in high\. With these tolerances, "
        r"\d+\.\d% of all drivelines are within it in every state; the worst has "
        r"\d\.\d+° in low, ",
        next(sentences(tight)),
    )
    none = (
        STATES_TEXT.replace("samples", "of = 'torque_1_peak'\nsamples")
        + "[load]\noutput_torque_Nm = 9"
    )
    open_ = tolerance_figures(Scene.parse(none))
    assert open_ is not None
    said = r"Torque of shaft 1, peak: 9\.\d+ N m as drawn in low; with these"
    assert re.match(said, next(sentences(open_)))
    unnamed = STATES_TEXT.replace('names = ["low", "rest", "high"]\n', "")
    found = tolerance_figures(Scene.parse(unnamed))
    assert found is not None
    assert " in state 0, " in next(sentences(found))


def test_the_text_has_a_row_for_each_state() -> None:
    found = tolerance_figures(Scene.parse(STATES_TEXT))
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


def test_text_of_teeth_and_points() -> None:
    text = f"{POINTS}[tolerances]\npoints_mm = [0, 1, 2, 0]\nteeth = 40\nsamples = 1000\n"
    printed = PARTS["tolerances"].text(figures(text))
    assert re.search(r"least tolerance, ± +1 mm +4\.5°\n", printed)
    assert re.search(r"largest tolerance, ± +2 mm +4\.5°\n", printed)
    assert "random drivelines  1000" in printed
    assert max(map(len, printed.splitlines())) <= 79

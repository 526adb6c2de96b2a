"""Limits, verdicts and their words, and yoke settings in the words of a workshop."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from cardan import Driveline, Finding, Limit, Limits
from cardan.design.limits import PRESETS
from cardan.motion import workshop

RPM = 2 * math.pi / 60

TORSIONAL, DRIVING, COASTING = (
    "torsional_excitation",
    "inertia_excitation_driving",
    "inertia_excitation_coasting",
)


def joints(*bends: float) -> Driveline:
    return Driveline.from_bends(bends, degrees=True)


def values(line: Driveline, speed: float) -> dict[str, float]:
    return {found.figure: float(found.value) for found in line.check(speed).findings}


# --- verdicts ----------------------------------------------------------------------------------


def test_without_limits_only_the_catalogue_judges() -> None:
    """A steering column or a tractor's shaft must not fail by the rules for trucks."""
    found = joints(35, 35).check(2500 * RPM)
    assert found.verdict == "within"
    assert found.catalogue.verdict == "within"
    assert found.practice.verdict == "not judged"
    assert found.practice.passes
    judged = [finding.figure for finding in found.findings if finding.limit]
    assert judged == ["equivalent_bend"]
    shaken = {f.figure: f for f in found.findings}[DRIVING]
    assert float(shaken.value) > 2000.0
    assert shaken.words == ("not judged, no limit given",)
    assert joints(35, 35).check(2500 * RPM, "truck").verdict == "beyond"


def test_without_a_speed_there_is_no_excitation() -> None:
    assert [f.figure for f in joints(5, 5).check().findings] == ["equivalent_bend"]


def test_a_joint_has_no_shafts_between() -> None:
    found = joints(5).check(100 * RPM).practice
    assert [f.figure for f in found.findings] == [TORSIONAL]


@pytest.mark.parametrize(
    ("bend", "verdict"), [(2.98, "within"), (3.0, "within"), (3.0001, "beyond")]
)
def test_the_limit_itself_is_within(bend: float, verdict: str) -> None:
    """One verdict for the bend and for the non-uniformity that follows from it."""
    found = joints(bend).check()
    assert found.verdict == verdict
    assert found.passes == (verdict == "within")
    bend_found = found.findings[0]
    assert bend_found.limit is not None
    assert bend_found.limit.limit == 3.0
    assert "non-uniformity 0.0027" in str(bend_found)


def test_non_uniformity_is_that_of_the_driveline() -> None:
    line = joints(9, 4)
    exact = float(line.equivalent().non_uniformity)
    assert f"non-uniformity {exact:.4g}, limit 0.002743" in str(line.check())


@pytest.mark.parametrize("size", [299.0, 300.0, 301.0, 500.0, 501.0])
def test_between_limit_and_maximum_a_driveline_is_tolerable(size: float) -> None:
    line = joints(1.0)
    speed = math.sqrt(size / float(line.equivalent().max_acceleration_ratio))
    found = line.check(speed, "truck")
    verdict = "within" if size <= 300.0 else "tolerable" if size <= 500.0 else "beyond"
    assert found.verdict == verdict
    assert found.practice.verdict == verdict
    assert found.catalogue.verdict == "within"
    assert bool(found) == (verdict != "beyond")
    assert float(found.findings[1].margin) == pytest.approx(300.0 - size, abs=1e-9)


def test_a_check_is_true_if_it_passes() -> None:
    assert joints(5, 5).check()
    assert not joints(5, 1).check()
    batch = Driveline.from_bends([[5, 5], [5, 1]], degrees=True).check()
    with pytest.raises(ValueError, match=r"each of 2 drivelines or speeds.*check\.passes\.all\(\)"):
        bool(batch)
    with pytest.raises(ValueError, match="each of 1 drivelines or speeds"):
        bool(joints(5, 5).check([100.0]))


def test_verdicts_of_a_batch() -> None:
    found = Driveline.from_bends([[1], [2], [4]], degrees=True).check()
    assert found.verdict.tolist() == ["within", "within", "beyond"]
    assert found.passes.tolist() == [True, True, False]
    size = joints(1).equivalent().max_acceleration_ratio
    speeds = np.sqrt(np.array([100.0, 400.0, 600.0, np.nan]) / size)
    limits = Limits(torsional_excitation_rad_s2=(300, 500))
    speeds_found = joints(1).check(speeds, limits)
    assert speeds_found.verdict.tolist() == ["within", "tolerable", "beyond", "unknown"]
    assert speeds_found.passes.tolist() == [True, True, False, False]


def test_speeds_at_which_limits_are_reached() -> None:
    line = Driveline.from_bends([[5, 4, 3], [2, 2, 1]], phases=[90, 0], degrees=True)
    found = line.check(limits="truck").practice.findings
    assert [f.figure for f in found] == [TORSIONAL, DRIVING, COASTING]
    for finding, (limit, maximum) in zip(
        found, [(300.0, 500.0), (1000.0, 2000.0), (1000.0, 2000.0)], strict=True
    ):
        assert finding.verdict.tolist() == ["not judged"] * 2
        for speeds, size in ((finding.within_up_to, limit), (finding.tolerable_up_to, maximum)):
            at = {f.figure: f for f in line.check(speeds, "truck").findings}[finding.figure]
            np.testing.assert_allclose(at.value, size, rtol=1e-12)
    assert np.isnan(line.check().findings[0].within_up_to).all()
    assert "within up to" in str(found[0])
    straight = joints(0.0).check(limits="truck").findings[1]
    assert np.isinf(straight.within_up_to)
    assert "within at every speed" in str(straight)


def test_printed_speeds_are_within() -> None:
    """Rounded down: at the speed that is printed the limit is not exceeded."""
    line = joints(4.0)
    words = str(line.check(limits="truck").findings[1])
    printed = float(words.partition("within up to ")[2].partition(" rpm")[0])
    assert line.check(printed * RPM, "truck").practice.verdict == "within"
    assert line.check((printed + 1) * RPM, "truck").practice.verdict == "tolerable"


# --- limits ------------------------------------------------------------------------------------


def test_presets() -> None:
    truck = Limits("truck").figures
    assert {key: (at.limit, at.maximum) for key, at in truck.items()} == {
        "equivalent_bend_deg": (3.0, 3.0),
        "torsional_excitation_rad_s2": (300.0, 500.0),
        "inertia_excitation_rad_s2": (1000.0, 2000.0),
    }
    industrial = Limits("industrial").figures
    assert {key: (at.limit, at.maximum) for key, at in industrial.items()} == {
        "equivalent_bend_deg": (3.0, 3.0),
        "bend_difference_deg": (1.5, 5.0),
    }


@pytest.mark.parametrize("preset", [None, *PRESETS])
def test_every_limit_is_printed_with_its_source(preset: str | None) -> None:
    limits = Limits(preset)
    text = str(joints(5, 4).check(100.0, limits))
    sources = " ".join(text.partition("Sources of the limits:")[2].split())
    for limit in limits.figures.values():
        assert f": {limit.source}" in sources


@pytest.mark.parametrize(
    ("bends", "verdict"),
    [((14, 13), "within"), ((14, 11), "tolerable"), ((9, 14), "tolerable"), ((14, 8.5), "beyond")],
)
def test_the_difference_of_two_bends(bends: tuple[float, float], verdict: str) -> None:
    found = joints(*bends).check(limits=Limits("industrial", equivalent_bend_deg=20))
    assert found.practice.verdict == verdict
    assert float(found.practice.findings[0].value) == pytest.approx(abs(bends[0] - bends[1]))
    assert not joints(*bends, 5).check(limits="industrial").practice.findings


def test_figures_of_your_own() -> None:
    limits = Limits(
        "truck", equivalent_bend_deg=(4, 6), torsional_excitation_rad_s2=800, source="works rule 7"
    )
    assert limits.figures["equivalent_bend_deg"] == Limit(4.0, 6.0, "works rule 7")
    assert limits.figures["torsional_excitation_rad_s2"] == Limit(800.0, 800.0, "works rule 7")
    assert (
        limits.figures["inertia_excitation_rad_s2"]
        == Limits("truck").figures["inertia_excitation_rad_s2"]
    )
    assert joints(5).check(limits=limits).verdict == "tolerable"
    assert "Catalogue (own limit): tolerable" in str(joints(5).check(limits=limits))
    assert "Practice (truck, own limit): " in str(joints(5).check(limits=limits))
    assert "Practice (truck): " in str(joints(5).check(limits="truck"))
    alone = Limits(torsional_excitation_rad_s2=800)
    assert "Catalogue: beyond" in str(joints(5).check(limits=alone))
    assert "Practice (own limit): " in str(joints(5).check(limits=alone))
    both = Limits(torsional_excitation_rad_s2=800, inertia_excitation_rad_s2=900)
    assert "Practice (own limits): " in str(joints(5, 4).check(limits=both))
    assert "Practice: not judged" in str(joints(5).check(100.0))
    # With a speed some sentences are longer than a line of a terminal.
    said = str(Driveline.from_bends([6, 5], [180], degrees=True).check(350.0, Limits("truck")))
    assert "tolerable, " in said
    assert max(map(len, said.splitlines())) <= 79
    assert "works rule 7" in str(joints(5).check(limits=limits))
    assert Limits(equivalent_bend_deg=4).figures["equivalent_bend_deg"].source == "own figure"


@pytest.mark.parametrize(
    ("error", "argument", "limits"),
    [
        (ValueError, "limits", lambda: joints(5).check(limits="steering")),
        (ValueError, "preset", lambda: Limits("passenger_car")),
        (TypeError, "limits", lambda: joints(5).check(limits=3.0)),  # type: ignore[arg-type]
        (TypeError, "equivalent_bend_deg", lambda: Limits(equivalent_bend_deg="3")),  # type: ignore[arg-type]
        (ValueError, "equivalent_bend_deg", lambda: Limits(equivalent_bend_deg=90)),
        (ValueError, "equivalent_bend_deg", lambda: Limits(equivalent_bend_deg=0)),
        (ValueError, "equivalent_bend_deg", lambda: Limits(equivalent_bend_deg=math.nan)),
        (ValueError, "bend_difference_deg", lambda: Limits(bend_difference_deg=(2, 1))),
        (ValueError, "bend_difference_deg", lambda: Limits(bend_difference_deg=[])),
        (ValueError, "bend_difference_deg", lambda: Limits(bend_difference_deg=(1, 2, 3))),
        (
            ValueError,
            "inertia_excitation_rad_s2",
            lambda: Limits(inertia_excitation_rad_s2=math.inf),
        ),
    ],
)
def test_limits_that_are_none(
    error: type[Exception], argument: str, limits: Callable[[], object]
) -> None:
    with pytest.raises(error) as raised:
        limits()
    assert raised.value.argument == argument  # type: ignore[attr-defined]


def test_a_preset_without_a_source_says_what_there_is() -> None:
    with pytest.raises(ValueError, match="'steering'") as raised:
        Limits("steering")
    for name in (*PRESETS, "own figures", "equivalent_bend_deg", "torsional_excitation_rad_s2"):
        assert name in str(raised.value)


# --- words -------------------------------------------------------------------------------------


def finding(
    value: float | list[float], unit: str = "deg", worst_at: dict[str, float] | None = None
) -> Finding:
    limit = Limit(2.0, 5.0, "a book")
    found = np.array(value)
    return Finding("shake", "shake", "practice", found, unit, limit, worst_at=worst_at or {})


def test_findings_in_words() -> None:
    assert str(finding(1.5)) == "shake 1.5° is within the 2° limit by 0.5° (a book)"
    assert str(finding(2.0)) == "shake 2° is within the 2° limit by 0° (a book)"
    assert finding(4.0, "rad/s²").words == (
        "tolerable, 2 rad/s² above the 2 rad/s² limit and 1 rad/s² below the 5 rad/s² maximum",
    )
    assert finding(5.0).words == ("tolerable, 3° above the 2° limit and 0° below the 5° maximum",)
    assert finding(5.25).words == ("beyond the 5° maximum by 0.25°",)
    assert str(joints(4).check().findings[0]).startswith(
        "equivalent bend 4° is beyond the 3° limit by 1°; non-uniformity 0.004878, limit 0.002743 ("
    )
    assert finding(2e-7).value_text == "0°"
    assert finding(4e-6).value_text == "4e-06°"
    assert finding(math.nan).words == ("not a number",)


def test_findings_of_several_drivelines_in_words() -> None:
    assert str(finding([1.0, 3.0, 6.0])) == (
        "shake up to 6° is beyond the 5° maximum by 1°; 1 of 3 within, 1 tolerable, 1 beyond "
        "(a book)"
    )
    worst = finding([1.0, 3.0], worst_at={"bends_deg.0": 16.0, "speed_rpm": 1e3})
    assert str(worst).startswith("shake up to 3° (at bends_deg.0 = 16, speed_rpm = 1000) is tol")
    nothing = finding([0.0, 1e-9], worst_at={"bends_deg.0": 16.0})
    assert str(nothing).startswith("shake up to 0° is within")
    assert finding([]).words == ("within the 2° limit by 2°", "0 of 0 within")


def test_the_whole_check_in_words() -> None:
    line = Driveline.from_bends([15, 15], twists=[180], degrees=True)
    assert float(line.check().findings[0].value) > 0
    assert str(line.check(1500 * RPM, "truck")).splitlines()[:11] == [
        "The driveline is tolerable: above a limit, but below every maximum.",
        "",
        "Catalogue: within",
        "- equivalent bend: 0°",
        "    within the 3° limit by 3°",
        "    non-uniformity 0, limit 0.002743",
        "",
        "Practice (truck): tolerable",
        "- torsional excitation, last shaft: 0 rad/s²",
        "    within the 300 rad/s² limit by 300 rad/s²",
        "    within at every speed",
    ]
    assert str(joints(1).check()).startswith("The driveline is within the limits.\n")
    assert str(joints(4).check()).startswith("The driveline is beyond the limits.\n")
    assert str(joints(1).check(np.nan, "truck")).startswith("The driveline cannot be judged")


def test_a_batch_in_words() -> None:
    text = str(Driveline.from_bends([[1], [2], [4]], degrees=True).check(100.0, "truck"))
    assert text.startswith(
        "2 of 3 drivelines are within all limits, 1 beyond.\n\nCatalogue: beyond\n"
    )
    assert "- equivalent bend: up to 4°\n    beyond the 3° limit by 1°\n" in text
    assert "Practice: not judged" in str(joints(5, 5).check([1.0, 2.0]))


def test_a_table_for_notebooks() -> None:
    html = joints(5, 1).check(100.0)._repr_html_()
    assert "<caption>The driveline is beyond the limits.</caption>" in html
    assert "<td>catalogue</td><td>equivalent bend</td><td>" in html
    assert "section 6.4" in html


# --- figures -----------------------------------------------------------------------------------


def test_four_joints_of_a_truck() -> None:
    # 5/4/3/2 degrees, first shaft crossed, the others parallel, 2500 rpm. Practice finds torsional
    # 6.00 degrees or 749, driving 9.90 or 2026, coasting 3.16 or 209 rad/s^2, from w^2 sin^2; the
    # exact figures lie above by up to 1.5 per cent.
    line = Driveline.from_bends([5, 4, 3, 2], phases=[90, 0, 0], degrees=True)
    found = values(line, 2500 * RPM)
    assert found["equivalent_bend"] == pytest.approx(6.00, abs=0.005)
    assert 749 < found[TORSIONAL] < 749 * 1.015
    assert 2026 < found[DRIVING] < 2026 * 1.015
    assert found[COASTING] == pytest.approx(209, rel=0.015)
    assert line.check(2500 * RPM, "truck").verdict == "beyond"


def test_the_example_of_the_catalogue_is_within_its_limit() -> None:
    """At the setting that it finds; what shakes the shaft between is not its concern."""
    line = Driveline.from_projected_bends([15, -11.5], [7, 12], phases=-71, degrees=True)
    found = line.check(2000 * RPM)
    assert found.verdict == "within"
    # 71 deg as the catalogue reads it off its drawing; 0.951 deg at the exact setting.
    assert found.catalogue.findings[0].value == pytest.approx(1.230, abs=1e-3)


def test_the_driving_figure_is_the_sampled_one() -> None:
    line = Driveline.from_bends([12, 9, 7, 5], [20, 30, 40], [50, 10, -20], degrees=True)
    speed = 100.0
    angle = np.linspace(0, 2 * math.pi, 512, endpoint=False)
    shaken = line.evaluate(angle, "acceleration_ratio", shafts=[1, 2, 3]).acceleration_ratio
    second = 2 * abs(np.fft.rfft(shaken.sum(axis=0))[2]) / len(angle)
    assert values(line, speed)[DRIVING] == pytest.approx(speed**2 * second, rel=1e-12)


def test_coasting_is_driving_from_the_other_end() -> None:
    line = Driveline.from_bends([12, 9, 7], [20, 30], [50, 10], degrees=True)
    there, back = values(line, 50.0), values(line.reversed(), 50.0)
    assert there[DRIVING] == pytest.approx(back[COASTING], rel=1e-14)
    assert there[COASTING] == pytest.approx(back[DRIVING], rel=1e-14)


# --- yokes -------------------------------------------------------------------------------------


def test_the_fork_of_the_catalogue_example() -> None:
    line = Driveline.from_projected_bends([15, -11.5], [7, 12], degrees=True)
    setting = workshop.turn(line.optimal_phases())
    # The smallest |q| of unequal bends is where the yokes line up with the twist.
    assert str(setting) == (
        "70.87° counter-clockwise = 109.13° clockwise, looking from the drive towards the output"
    )


@pytest.mark.parametrize(
    ("angle", "size", "sense"),
    [
        (0.3, 0.3, "clockwise"),
        (-0.3, 0.3, "counter-clockwise"),
        (math.pi - 0.3, 0.3, "counter-clockwise"),
        (math.pi + 0.3, 0.3, "clockwise"),
        (0.0, 0.0, "none"),
    ],
)
def test_turns_are_modulo_180_degrees(angle: float, size: float, sense: str) -> None:
    found = workshop.turn(angle)
    assert float(found.angle) == pytest.approx(size, abs=1e-15)
    assert str(found.sense) == sense


def test_turns_of_arrays() -> None:
    found = workshop.turn([[0.1, -0.2], [0.0, math.nan]])
    assert found.sense.tolist()[0] == ["clockwise", "counter-clockwise"]
    assert found.angle.shape == (2, 2)
    assert str(found).splitlines()[2] == "in one plane"


def test_speeds_that_do_not_fit_the_batch() -> None:
    with pytest.raises(ValueError, match=r"driveline \(2,\), speed \(3,\)"):
        Driveline.from_bends([[5], [6]], degrees=True).check([1.0, 2.0, 3.0])


def test_a_speed_that_is_not_a_number() -> None:
    found = joints(5, 5).check(np.nan, "truck")
    assert found.verdict == "unknown"
    assert not found.passes
    assert "is not a number" in str(found.findings[1])


def test_turns_that_are_not_finite_have_no_sense() -> None:
    turn = workshop.turn([np.nan, np.inf, 0.0])
    assert turn.sense.tolist() == ["unknown", "unknown", "none"]
    assert str(turn).splitlines() == ["not a number", "not a number", "in one plane"]

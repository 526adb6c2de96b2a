"""Limits, of makers as well, verdicts and their words, and yoke settings in workshop words."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
import pytest

import cardan
import scripts
from cardan import Driveline, Finding, Limit, Limits
from cardan.app.answers.limits import not_judged
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


# --- words -------------------------------------------------------------------------------------


def finding(
    value: float | list[float], unit: str = "deg", worst_at: dict[str, float] | None = None
) -> Finding:
    limit = Limit(2.0, 5.0, "a book")
    found = np.array(value)
    return Finding("shake", "shake", "practice", found, unit, limit, worst_at=worst_at or {})


def test_findings_in_words() -> None:
    assert str(finding(1.5)) == "shake 1.5° is 0.5° below the 2° limit (a book)"
    assert str(finding(2.0)) == "shake 2° is 0° below the 2° limit (a book)"
    assert finding(4.0, "rad/s²").words == (
        "tolerable, 2 rad/s² above the 2 rad/s² limit and 1 rad/s² below the 5 rad/s² maximum",
    )
    assert finding(5.0).words == ("tolerable, 3° above the 2° limit and 0° below the 5° maximum",)
    assert finding(5.25).words == ("0.25° above the 5° maximum",)
    assert str(joints(4).check().findings[0]).startswith(
        "equivalent bend 4° is 1° above the 3° limit; non-uniformity 0.004878, limit 0.002743 ("
    )
    assert finding(2e-7).value_text == "0°"
    assert finding(4e-6).value_text == "4e-06°"
    assert finding(math.nan).words == ("not a number",)


def test_findings_of_several_drivelines_in_words() -> None:
    assert str(finding([1.0, 3.0, 6.0])) == (
        "shake up to 6° is 1° above the 5° maximum; 1 of 3 within, 1 tolerable, 1 beyond (a book)"
    )
    worst = finding([1.0, 3.0], worst_at={"bends_deg.0": 16.0, "speed_rpm": 1e3})
    assert str(worst).startswith("shake up to 3° (at bends_deg.0 = 16, speed_rpm = 1000) is tol")
    nothing = finding([0.0, 1e-9], worst_at={"bends_deg.0": 16.0})
    assert str(nothing).startswith("shake up to 0° is 2° below the 2° limit")
    assert finding([]).words == ("2° below the 2° limit", "0 of 0 within")


def test_the_whole_check_in_words() -> None:
    line = Driveline.from_bends([15, 15], twists=[180], degrees=True)
    assert float(line.check().findings[0].value) > 0
    assert str(line.check(1500 * RPM, "truck")).splitlines()[:11] == [
        "The driveline is tolerable: above a limit, but below every maximum.",
        "",
        "Catalogue: within",
        "- equivalent bend: 0°",
        "    3° below the 3° limit",
        "    non-uniformity 0, limit 0.002743",
        "",
        "Practice (truck): tolerable",
        "- torsional excitation, last shaft: 0 rad/s²",
        "    300 rad/s² below the 300 rad/s² limit",
        "    within at every speed",
    ]
    assert str(joints(1).check()).startswith("The driveline is within the limits.\n")
    assert str(joints(4).check()).startswith("The driveline is beyond the limits.\n")
    assert str(joints(1).check(np.nan, "truck")).startswith("The driveline cannot be judged")


def test_the_help_says_what_each_preset_limits() -> None:
    said = " ".join(scripts.run("run", "--help").stdout.split())
    listed = said.partition(" preset name or names: ")[2].partition("; default: ")[0]
    assert "truck (excitations); " in listed
    assert "; spicer, tremec, gm, meritor (bends and difference of bends); " in listed
    assert all(re.search(rf"\b{name}\b", listed) for name in PRESETS)


@pytest.mark.parametrize(
    ("sections", "counted"),
    [
        ("[states]\nbends_deg.0 = [2, 9]\n", "states"),
        ("[study]\nbends_deg.0 = [2, 9]\n", "drivelines"),
        (
            "[angles]\nfile = 'run.csv'\nangle_column_deg = 'angle'\nbend_columns_deg = ['bend']\n",
            "samples",
        ),
    ],
)
def test_verdicts_on_the_motion_say_what_they_count(
    tmp_path: Path, sections: str, counted: str
) -> None:
    (tmp_path / "run.csv").write_text("angle,bend\n0,2\n90,9\n")
    bends = "" if "angles" in sections else "bends_deg = [2]\n"
    (tmp_path / "a.toml").write_text(f"[driveline]\n{bends}{sections}")
    said = scripts.run("check", tmp_path / "a.toml").stdout
    lines = said.partition("  Verdicts on the motion\n")[2].splitlines()[:4]
    assert [line.split() for line in lines] == [
        *(["counted", counted], ["within", "1"]),
        *(["tolerable", "0"], ["beyond", "1"]),
    ]


def test_a_table_for_notebooks() -> None:
    html = joints(5, 1).check(100.0)._repr_html_()
    assert "<caption>The driveline is beyond the limits.</caption>" in html
    assert "<td>catalogue</td><td>equivalent bend</td><td>" in html
    assert "section 6.4" in html


# --- figures -----------------------------------------------------------------------------------


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


PRESETS_RPM = math.tau / 60.0


def z_shaft(*bends: float) -> Driveline:
    return Driveline.from_bends(bends, [180.0] * (len(bends) - 1), degrees=True)


def verdict(line: Driveline, preset: str, rpm: float | None = None) -> str:
    """What an answer says of one preset alone."""
    rows = "".join(f"speed_rpm = {rpm}\n" for _ in [rpm] if rpm)
    text = f"[driveline]\nbends_deg = {line.bends_deg.tolist()}\n"
    if line.n_joints > 1:
        text += f"twists_deg = {line.twists_deg.tolist()}\n"
    text += f"[load]\n{rows}" if rows else ""
    answer = cardan.Answer(cardan.Scene.parse(f'{text}[limits]\npreset = "{preset}"\n'))
    (found,) = answer["presets"]
    return str(found.verdict)


EDGES: list[tuple[str, Sequence[float], float | None, str]] = [
    ("spicer", (0.5, 0.5), None, "within"),
    ("spicer", (0.49, 0.5), None, "beyond"),
    ("spicer", (3, 2), None, "within"),
    ("spicer", (3, 1.99), None, "beyond"),
    ("spicer", (3.01, 3), None, "not judged"),
    ("spicer", (3.01, 3), 3000, "tolerable"),
    ("spicer", (5.8, 5.8), 3000, "tolerable"),
    ("spicer", (5.81, 5.8), 3000, "beyond"),
    ("spicer", (11.5, 11.5), 100, "tolerable"),
    ("spicer", (11.51, 11.5), 100, "beyond"),
    ("spicer", (11.51, 11.5), None, "beyond"),
    ("spicer", (3.2, 3.2), 5000, "tolerable"),
    ("spicer", (2.9, 2.9), 5001, "not judged"),
    ("spicer", (3.21, 3.2), 5001, "beyond"),
    ("tremec", (3, 1), None, "within"),
    ("tremec", (3.01, 2), None, "beyond"),
    ("tremec", (3, 0.99), None, "beyond"),
    ("tremec", (1, 0), None, "beyond"),
    ("gm", (4, 3.5), None, "within"),
    ("gm", (4.01, 4), None, "beyond"),
    ("gm", (4, 3.49), None, "beyond"),
    ("gm", (0.4, 0), None, "beyond"),
    ("gm", (0.4, 0.01), None, "within"),
    ("meritor", (5, 3.5), None, "within"),
    ("meritor", (5.01, 4), None, "beyond"),
    ("meritor", (5, 3.49), None, "beyond"),
    ("meritor", (5, 5, 0), None, "not judged"),
    ("parker", (8 + 40 / 60,), 2000, "within"),
    ("parker", (8.67,), 2000, "within"),
    ("parker", (8.68,), 2000, "beyond"),
    ("parker", (5.84,), 3000, "within"),
    ("parker", (5.0,), 3001, "not judged"),
    ("parker", (5.0,), None, "not judged"),
    ("parker", (11.51,), None, "beyond"),
    ("john_deere", (20, 20), None, "within"),
    ("john_deere", (20, 19.9), None, "not judged"),
    ("camaro", (0.5, 3, 3), None, "within"),
    ("camaro", (3, 0.5, 3), None, "within"),
    ("camaro", (3, 3, 0.51), None, "beyond"),
    ("camaro", (0.5, 3, 2.9), None, "not judged"),
    # The two that are equal make the third the odd one, although another is bent less.
    ("hombre", (0.2, 0.2, 0.45), None, "within"),
    ("hombre", (0.2, 0.2), None, "not judged"),
    ("truck", (5, 5), 2400, "within"),
    ("drivetrain", (2, 2), None, "not judged"),
]


@pytest.mark.parametrize(("preset", "bends", "rpm", "expected"), EDGES)
def test_edges(preset: str, bends: Sequence[float], rpm: float | None, expected: str) -> None:
    if preset == "truck":
        found = z_shaft(*bends).check(rpm and rpm * PRESETS_RPM, preset).of_presets[preset]
        assert found.verdict == expected
        return
    assert verdict(z_shaft(*bends), preset, rpm) == expected


def test_every_preset_has_its_edges() -> None:
    assert {preset for preset, *_ in EDGES} | {"industrial"} == {*PRESETS}


@pytest.mark.parametrize(("twist", "inches"), [(180.0, 5.0), (0.0, 10.0)])
def test_the_angle_by_the_length(twist: float, inches: float) -> None:
    """With parallel axes a degree for each 5 in, with intersecting ones for each 10 in."""
    length = 4.0 * inches * 0.0254
    for bend, passes in ((3.99, True), (4.0, True), (4.01, False)):
        line = Driveline.from_bends([bend, bend], [twist], degrees=True)
        line = line.with_bearings([], lengths=[0.3, length, 0.3])
        found = line.check(limits="drivetrain").published
        assert [bool(each.passes) for each in found.findings] == [passes, passes]


def test_angles_between_the_speeds_of_a_table() -> None:
    """Bend times speed goes straight from one speed of the source to the next."""
    limit = z_shaft(3.5, 3.5).check(2750 * PRESETS_RPM, "spicer").published.findings[0].there
    assert limit is not None
    assert limit.maximum == math.ceil(100 * (7.0 * 2500 + 5.8 * 3000) / 2 / 2750) / 100
    speeds = np.array([1500.0, 2750.0, 6000.0, 0.0]) * PRESETS_RPM
    found = z_shaft(6.0, 6.0).check(speeds, "spicer").published.findings[0]
    assert found.verdict.tolist() == ["tolerable", "tolerable", "beyond", "not judged"]
    np.testing.assert_allclose(found.margin[:2], -3.0)


# --- several -------------------------------------------------------------------------------------

SEVERAL = """
[driveline]
points_mm = [[0, 0, 0], [300, 0, 0], [1300, {height}, 0], [1600, {height}, 0]]

[load]
speed_rpm = 2400

[limits]
preset = ["spicer", "gm", "truck"]
"""


def test_the_answer_says_which_allow_it(tmp_path: Path) -> None:
    scene = tmp_path / "scene.toml"
    scene.write_text(SEVERAL.format(height=-5), encoding="utf-8")
    found = scripts.run("check", scene)
    assert found.exit_code == 1
    words = " ".join(found.output.split())
    assert words.startswith(
        "Beyond their limits: the least bend of joint 0 and the least bend of joint 1."
    )
    assert (
        "Allowed by General Motors and truck. Not by Spicer: the least bend of joint 0 is 0.29°, "
        "at least 0.5°; the least bend of joint 1 is 0.29°, at least 0.5°." in words
    )
    scene.write_text(SEVERAL.format(height=-60), encoding="utf-8")
    found = scripts.run("check", scene)
    assert found.exit_code == 0
    assert "Allowed by General Motors, truck and Spicer (tolerable)." in found.output
    # Between 8.7° at 2000 rpm and 7° at 2500 rpm, rounded up.
    words = " ".join(found.output.split())
    assert re.search(r" 0\.\d\d° above the limit of 3°, maximum 7\.29° \(Spicer, ", words)


def test_of_one_preset_the_answer_says_whether_it_allows_it(tmp_path: Path) -> None:
    scene = tmp_path / "scene.toml"
    one = SEVERAL.replace('["spicer", "gm", "truck"]', '"spicer"')
    scene.write_text(one.format(height=-5), encoding="utf-8")
    words = scripts.run("check", scene).output
    assert "\nNot allowed by Spicer: the least bend of joint 0 is 0.29°, at least" in words
    assert "none" not in words
    scene.write_text(one.format(height=-60), encoding="utf-8")
    assert "\nAllowed by Spicer (tolerable).\n" in scripts.run("check", scene).output


def test_what_is_not_judged_names_its_source() -> None:
    """Several sources limit the same bends."""
    text = "[driveline]\nbends_deg = [11, 9.5]\n[limits]\n"
    text += 'preset = ["john_deere", "camaro", "hombre", "drivetrain"]\n'
    said = [*not_judged(cardan.Answer(cardan.Scene.parse(text)))]
    for source in ("John Deere, equal", "Chevrolet Camaro of", "Isuzu Hombre,", "drivetrain.com"):
        assert any(f" ({source}" in each for each in said), source


def test_states_and_studies_have_the_worst() -> None:
    text = '[driveline]\nbends_deg = [3, 3]\ntwists_deg = [180]\n[limits]\npreset = "spicer"\n'
    states = '[states]\nnames = ["low", "high"]\nspeed_rpm = [1500, 4500]\nbends_deg.0 = [4, 3.8]\n'
    (found,) = cardan.Answer(cardan.Scene.parse(f"{text}[load]\nspeed_rpm = 1500\n{states}"))[
        "presets"
    ]
    bend = found.joints[0].bend
    # 4° are allowed at 1500 rpm, and 3.8° not at 4500 rpm.
    assert (bend.verdict, bend.state) == ("beyond", "high")
    assert np.degrees([bend.value, bend.limit, bend.maximum]) == pytest.approx([3.8, 3.0, 3.7])
    study = "[study]\nbends_deg.0 = [0.3, 1.0, 3.0]\nspeed_rpm = [1000, 2000]\n"
    (found,) = cardan.Answer(cardan.Scene.parse(f"{text}[load]\nspeed_rpm = 1000\n{study}"))[
        "presets"
    ]
    least = found.joints[0].least
    assert (least.verdict, dict(least.at)) == ("beyond", {"bends_deg.0": 0.3})
    assert math.degrees(least.value) == pytest.approx(0.3)


def test_one_state_that_cannot_be_judged_is_said() -> None:
    """It counts more than others that are within, and less than one that is beyond."""
    text = "[driveline]\nbends_deg = [3, 3]\ntwists_deg = [180]\n[limits]\npreset = '{}'\n"
    text += "[load]\nspeed_rpm = 2000\n"
    states = "[states]\nnames = ['level', 'tilted', 'fast']\n{}\n"
    for preset, keys, verdict, state in (
        ("john_deere", "bends_deg.0 = [3, 2.9, 3]", "not judged", "tilted"),
        ("parker", "speed_rpm = [2000, 2900, 3100]", "not judged", "fast"),
        ("parker", "speed_rpm = [2000, 2900, 3100]\nbends_deg.0 = [9, 4, 4]", "beyond", "level"),
    ):
        answer = cardan.Answer(cardan.Scene.parse(text.format(preset) + states.format(keys)))
        (found,) = answer["presets"]
        worst = found.differences[0].difference if found.differences else found.joints[0].bend
        assert (found.verdict, worst.verdict, worst.state) == (verdict, verdict, state)
        assert answer.verdict == verdict
    study = "[study]\nbends_deg.0 = [3, 2.9]\n"
    answer = cardan.Answer(cardan.Scene.parse(text.format("john_deere") + study))
    assert answer.verdict == "not judged"


def test_what_the_gauge_may_hide_counts_the_bends() -> None:
    """At the limit both bends keep it if of three errors that of the middle is the least."""
    text = "[driveline]\nreadings_deg = [0, {bend}, 0]\ngauge_deg = 0.1\n"
    text += "[limits]\npreset = '{name}'\n"
    for bend, share in ((3.0, 1.0), (4.0, 1 / 3), (4.3, 0.0)):
        scene = cardan.Scene.parse(text.format(bend=bend, name="meritor"))
        found = cardan.Answer(scene)["readings"]
        assert (found.within, found.as_read) == (1.0, "")
        scene = cardan.Scene.parse(text.format(bend=bend, name="gm"))
        found = cardan.Answer(scene)["readings"]
        assert found.within == pytest.approx(share, abs=0.02)
        assert found.as_read == "published limits on more than bends and their difference"


def test_single_changes_keep_the_bends() -> None:
    """The smallest change leaves the strictest limit at its edge, and the looser is no matter."""
    text = SEVERAL.replace('"spicer", "gm", "truck"', '"meritor", "gm"')
    moves = cardan.Answer(cardan.Scene.parse(text.format(height=-90)))["moves"]
    move = next(each for each in moves if (each.number, each.axis) == (2, "y"))
    assert move.verdict == "within"
    assert move.untried == "least bend of joint 0, least bend of joint 1"
    height = -90.0 + 1e3 * move.shift
    scene = cardan.Scene.parse(
        text.replace("[1300, {height}", "[1300, {moved}").format(height=-90, moved=height)
    )
    bends = scene.line.bends_deg
    assert max(bends) <= 4.0
    assert abs(bends[0] - bends[1]) == pytest.approx(0.5, rel=1e-6)


def test_names_of_presets() -> None:
    assert Limits("spicer").presets == ("spicer",)
    assert Limits(["truck", "gm", "truck"]).presets == ("truck", "gm")
    assert Limits(["truck", "industrial"]).figures == (
        Limits("truck").figures | Limits("industrial").figures  # type: ignore[operator]
    )
    with pytest.raises(ValueError, match=r"preset.* 'vdi'"):
        Limits(["truck", "vdi"])
    with pytest.raises(TypeError, match="presets"):
        Limits([3])  # type: ignore[list-item]
    with pytest.raises(ValueError, match="'gm' again"):
        cardan.Scene.parse('[driveline]\nbends_deg = [1]\n[limits]\npreset = ["gm", "gm"]\n')

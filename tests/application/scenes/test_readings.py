"""Drivelines as an inclinometer and a tape measure show them."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pytest

import cardan
from cardan.app.answers.answer import Answer
from cardan.app.answers.moves import Move
from cardan.app.answers.moves import sentences as moves_in_words
from cardan.app.answers.readings import ReadingFigures, picture, sentences
from cardan.app.report.live import live
from cardan.app.scene.language.units import shown_in
from cardan.app.scene.starters import STARTERS

EXAMPLES = Path(__file__).parents[3] / "examples"
LENGTHS, OFFSETS = [350, 1300, 1507, 300], [0, 0, 45, 45, 45]
TEXT = """
[driveline]
readings_deg = ["3.0 down", "1.2 down", "87.0 from vertical down", "4.0 down"]
offsets_mm = [0, 0, "45 left", "45 left", 45]
lengths_mm = [350, 1300, 1507, 300]
gauge_deg = 0.25
"""
LIMITS = "[limits]\nequivalent_bend_deg = 0.9\n"


def parsed(changes: dict[str, str] | None = None, rest: str = "") -> cardan.Scene:
    text = TEXT
    for old, new in (changes or {}).items():
        assert old in text
        text = text.replace(old, new)
    return cardan.Scene.parse(text + rest)


def test_a_scene_of_readings_is_its_points() -> None:
    scene = parsed()
    assert scene.points is not None
    spans = np.diff(scene.points, axis=0)
    np.testing.assert_allclose(np.linalg.norm(spans, axis=1), LENGTHS, rtol=1e-15)
    np.testing.assert_allclose(scene.points[:, 2], OFFSETS, atol=1e-12)
    rise = np.degrees(np.arcsin(spans[:, 1] / LENGTHS))
    np.testing.assert_allclose(rise, [-3.0, -1.2, -3.0, -4.0], rtol=1e-14)
    line = cardan.Driveline.from_points(1e-3 * scene.points)
    np.testing.assert_allclose(scene.line.bends, line.bends, rtol=1e-12)
    np.testing.assert_allclose(scene.line.lengths().each, np.array(LENGTHS) / 1e3, rtol=1e-14)


@pytest.mark.parametrize(
    ("text", "degrees"),
    [
        ("-3", -3.0),
        ("0", 0.0),
        ('"0"', 0.0),
        ('"3 up"', 3.0),
        ('" 3.25° down "', -3.25),
        ('"3.25 deg down"', -3.25),
        ('"+3.25"', 3.25),
        ('"90 from vertical"', 0.0),
        ('"87.5 from vertical up"', 2.5),
        ('"5.2 % down"', -math.degrees(math.atan(0.052))),
        ('"-5.2 %"', -math.degrees(math.atan(0.052))),
    ],
)
def test_how_a_reading_is_written(text: str, degrees: float) -> None:
    scene = parsed({'"3.0 down"': text})
    assert scene.layout is not None
    assert scene.layout.driveline["readings_deg"][0] == pytest.approx(degrees, rel=1e-15)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('"3.0 down"', '"3.0"', "readings_deg[0] is '3.0' without a direction; write \"3.0 up\""),
        ('"3.0 down"', '"-3.0 down"', "readings_deg[0] is '-3.0 down', with a sign and 'down'"),
        ('"3.0 down"', '"3,0 down"', "readings_deg[0] is '3,0 down'; it must be as \"3.0 down\""),
        ('"3.0 down"', '"3 left"', "readings_deg[0] is '3 left'; it must be as \"3.0 down\""),
        (
            '"3.0 down"',
            '"0 from vertical up"',
            "readings_deg[0] is 90.0 deg; of a gauge that counts from the v",
        ),
        ('"3.0 down"', "true", "readings_deg[0] is true; it must be a number"),
        (
            '"3.0 down"',
            '"87.0 down"',
            "readings_deg[0] is -87.0 deg; of a gauge that counts from t",
        ),
        ('"3.0 down", "1.2 down"', '"59 up", "59 down"', "readings_deg give joint 0 a bend of 1"),
        ('"45 left"', '"45"', "offsets_mm[2] is '45' without a direction; write \"45 left\""),
        ('0, "45 left"', '400, "45 left"', "offsets_mm go aside by 400 along shaft 0, which is 35"),
        (", 45]", "]", "offsets_mm has length 4; it needs 5, one per point"),
        ("lengths_mm", "#", "offsets_mm need the lengths of the shafts"),
        ("lengths_mm = [350,", "lengths_m = [350,", "lengths_m is in m; with readings_deg give le"),
        ("1507, 300]", "1507]", "lengths_mm has length 3; it needs 4, one per shaft"),
        ("gauge_deg = 0.25", "gauge_deg = 0", "gauge_deg is 0 deg; the accuracy of a gauge must"),
        (
            "gauge_deg",
            "feet_apart_mm = [9]\ngauge_deg",
            "feet_apart_mm has length 1; it needs 2, one per end, 0 where there are no feet; or "
            "give one number for both",
        ),
        ("gauge_deg", "feet_apart_in = [9]\ngauge_deg", "feet_apart_in has length 1; it needs 2"),
        ("gauge_deg", "feet_apart_mm = -1\ngauge_deg", "feet_apart_mm is -1; it must lie in [0, "),
        ("offsets_mm", "bends_deg = [1]\noffsets_mm", "bends_deg and readings_deg are both given"),
    ],
)
def test_what_is_wrong_with_a_reading(old: str, new: str, words: str) -> None:
    with pytest.raises(ValueError, match=re.escape(words)):
        parsed({old: new})


def test_states_and_studies_vary_readings_and_lengths() -> None:
    states = parsed(rest='[states]\n"readings_deg.3" = [-4, -2]\n"offsets_mm.4" = [45, 30]\n')
    assert states.states is not None
    last = states.states.points(1)
    assert last is not None
    assert last[4, 2] == pytest.approx(30.0)
    np.testing.assert_allclose(states.drivelines().lengths().each[:, 3], 0.3, rtol=1e-14)
    study = parsed(rest="[study]\nlengths_mm.1 = [1200, 1300]\n").run().study
    assert study is not None
    own = study.values["equivalent_bend"]
    assert own[1] == pytest.approx(float(parsed().line.equivalent().bend), rel=1e-12)
    assert own[0] != own[1]


def test_a_gauge_spreads_what_it_hides_evenly() -> None:
    read = np.radians([-3.0, -1.2, -3.0])
    hidden = cardan.Driveline.from_readings(read, gauge=0.01, samples=4000)
    one = cardan.Driveline.from_readings(read)
    np.testing.assert_array_equal(hidden[0].directions, one.directions)
    off = (np.arcsin(hidden.directions[..., 1]) - read) / 0.01
    assert np.max(np.abs(off)) < 1.0 + 1e-9
    # Moments of a uniform distribution, and none in common.
    np.testing.assert_allclose(off.mean(axis=0), 0.0, atol=0.01)
    np.testing.assert_allclose(np.cov(off.T), np.eye(3) / 3.0, atol=0.01)


def certainty(scene: cardan.Scene) -> ReadingFigures:
    found: ReadingFigures = Answer(scene)["readings"]
    return found


@pytest.mark.parametrize("states", ["", '[states]\n"readings_deg.3" = [-4, -3.8]\n'])
def test_the_share_is_that_of_random_readings(states: str) -> None:
    """Of random readings within the accuracy, the points made of them by the formula."""
    scene = parsed(rest=LIMITS + states)
    rng = np.random.default_rng(3)
    off = rng.uniform(-0.25, 0.25, (40000, 4))
    worst = np.zeros(len(off))
    for last in (-4.0, -3.8) if states else (-4.0,):
        read = np.radians(np.array([-3.0, -1.2, -3.0, last]) + off)
        long, aside = np.array(LENGTHS), np.diff(OFFSETS)
        heading = np.arcsin(aside / (long * np.cos(read)))
        along = np.cos(read) * np.cos(heading), np.sin(read), np.cos(read) * np.sin(heading)
        line = cardan.Driveline.from_directions(np.stack(along, axis=-1))
        worst = np.maximum(worst, line.equivalent().bend_deg)
    share = float(np.mean(worst <= 0.9))
    found = certainty(scene)
    assert 0.05 < share < 0.95
    assert found.within == pytest.approx(share, abs=0.015)
    assert found.acceptable is None
    assert found.decides == "equivalent bend"
    for each in found.angles:
        assert each.least is not None
        assert each.largest is not None
        assert 0.0 <= each.least <= each.bend <= each.largest <= each.bend + math.radians(0.5)


@pytest.mark.parametrize("second", ["1.2 down", "2.6 down"])
def test_the_gauge_bounds_each_working_angle(second: str) -> None:
    """A fine grid of both readings nearly reaches the bounds and nowhere exceeds them."""
    gauge, count = 0.4, 401
    scene = parsed({'"1.2 down"': f'"{second}"', "gauge_deg = 0.25": f"gauge_deg = {gauge}"})
    assert scene.layout is not None
    read = np.radians(scene.layout.driveline["readings_deg"])
    aside = np.diff(OFFSETS) / LENGTHS
    off = np.radians(np.linspace(-gauge, gauge, count))
    for joint, found in enumerate(certainty(scene).angles):
        up = np.sin(read[joint] + off)[:, np.newaxis], np.sin(read[joint + 1] + off)
        along = [
            np.sqrt(1.0 - rise**2 - side**2)
            for rise, side in zip(up, aside[joint : joint + 2], strict=True)
        ]
        cosine = along[0] * along[1] + up[0] * up[1] + aside[joint] * aside[joint + 1]
        bends = np.arccos(np.minimum(cosine, 1.0))
        assert found.least is not None
        assert found.largest is not None
        assert found.largest == pytest.approx(bends.max(), abs=1e-7)
        assert found.least == pytest.approx(bends.min(), abs=1e-4)
        assert found.least <= bends.min() + 1e-7


def test_bounds_of_readings_in_one_plane_are_whole() -> None:
    text = YACHT.format(units="", engine=5)
    angles = certainty(cardan.Scene.parse(text)).angles
    ends = [(math.degrees(each.least or 0.0), math.degrees(each.largest or 0.0)) for each in angles]
    np.testing.assert_allclose(ends, [(3.9, 5.1), (0.9, 2.1)], rtol=1e-12)


@pytest.mark.parametrize(
    ("limit", "words"),
    [
        (3.0, "Everything is within its limits, whatever the gauge may hide."),
        (0.01, "Whatever the gauge may hide, the equivalent bend is not within its limit."),
        (1.0, r"Everything is within its limits for \d\d\.\d% of what the gauge may hide; else"),
    ],
)
def test_what_is_said_of_it(limit: float, words: str) -> None:
    scene = parsed(rest=f"[limits]\nequivalent_bend_deg = {limit}\n")
    text = " ".join(sentences(certainty(scene)))
    assert re.search(words, text)
    assert "Read towards the output, shaft by shaft: 3° down, 1.2° down, 3° down, 4° down." in text
    assert "Each reading may be off by 0.25° on its own." in text


def test_what_is_tolerable_has_a_share_of_its_own() -> None:
    found = certainty(parsed(rest="[limits]\nequivalent_bend_deg = [0.9, 1.2]\n"))
    strict = certainty(parsed(rest="[limits]\nequivalent_bend_deg = 1.2\n"))
    assert found.within == certainty(parsed(rest=LIMITS)).within
    assert found.acceptable == strict.within


def test_a_gauge_coarser_than_an_angle_is_told() -> None:
    text = " ".join(sentences(certainty(parsed({'"4.0 down"': '"3.1 down"'}, LIMITS))))
    assert "more than the working angle of joint 2, 0.10°" in text
    assert "read shafts 2 and 3 again" in text


def read_after(move: Move) -> cardan.Driveline:
    """The driveline after a shim or a spacer, made by hand."""
    scene = parsed()
    assert scene.points is not None
    points = 1e-3 * scene.points
    if move.tilt is not None:
        shaft = int(move.of.removeprefix("shaft "))
        span = points[shaft + 1] - points[shaft]
        level = math.hypot(span[0], span[2])
        up = math.atan2(span[1], level) + move.tilt
        turned = np.array([span[0], level * math.tan(up), span[2]])
        ends = (points[shaft + 1] - turned, points[shaft] + turned)
        points[0 if shaft == 0 else -1] = ends[0 if shaft == 0 else 1]
    else:
        assert move.axis == "up"
        assert move.shift is not None
        points[move.number, 1] += move.shift
    return cardan.Driveline.from_points(points)


def test_shims_and_spacers_that_help() -> None:
    found = Answer(parsed(rest=LIMITS))["moves"]
    moves = [move for move in found if move.variable == "point"]
    bends = [float(read_after(move).equivalent().bend_deg) for move in moves]
    # Every one leads onto the limit, which is 0.1° away.
    np.testing.assert_allclose(bends, 0.9, rtol=1e-6)
    assert {move.of for move in moves} == {"shaft 0", "shaft 3", "joint 0", "joint 1", "joint 2"}
    words = " ".join(moves_in_words(moves))
    assert re.search(r"Lower joint 2 by 0\.\d+ mm with a spacer: everything", words)
    assert re.search(r"Tilt shaft 3 up towards the output by 0\.\d+° with a shim", words)


YACHT = """
{units}
[driveline]
readings_deg = ["{engine} down", "9.5 down", "11 down"]
gauge_deg = 0.3
lengths_mm = [160, 780, 400]
[load]
speed_rpm = 2800
[limits]
torsional_excitation_rad_s2 = 300
"""


@pytest.mark.parametrize(
    ("units", "length", "per"), [("", "mm", 1000.0), ('units = "us"', "in", 12.0)]
)
def test_a_shim_has_its_thickness(units: str, length: str, per: float) -> None:
    answer = Answer(cardan.Scene.parse(YACHT.format(units=units, engine=5)))
    with shown_in(answer.scene.units):
        words = " ".join(moves_in_words(answer["moves"]))
    found = re.search(
        r"Tilt shaft 0 down towards the output by (\S+)° with a shim, (\S+) (mm|in) thick per "
        r"(m|ft) between the feet: ",
        words,
    )
    assert found
    assert (found[3], found[4]) == (length, {"mm": "m", "in": "ft"}[length])
    assert float(found[2]) == pytest.approx(per * math.tan(math.radians(float(found[1]))), rel=0.01)


@pytest.mark.parametrize(
    ("key", "apart", "factor"),
    [
        ("feet_apart_mm = [600, 120]", 600.0, 1.0),
        ("feet_apart_mm = [600, 0]", 600.0, 1.0),
        ("feet_apart_mm = 250", 250.0, 1.0),
        ("feet_apart_in = [20, 4]", 508.0, 25.4),
    ],
)
@pytest.mark.parametrize("tilted", [0.0, 8.0])
def test_a_shim_under_feet_that_are_known(
    key: str, apart: float, factor: float, tilted: float
) -> None:
    """It tilts an engine whose other feet stay, and a turn up needs it under those."""
    units = 'units = "us"' if "_in" in key else ""
    text = YACHT.format(units=units, engine=5 + tilted).replace("gauge_deg", f"{key}\ngauge_deg")
    scene = cardan.Scene.parse(text)
    with shown_in(scene.units):
        words = [*moves_in_words(Answer(scene)["moves"])]
    (said,) = (
        found
        for each in words
        if (
            found := re.match(
                r"Tilt shaft 0 (up|down) towards the output by (\S+)° with shims, (\S+) (?:mm|in) "
                r"thick, that raise the feet (nearer to|farther from) joint 0: .* and with "
                r"(\S+)°, a shim of (\S+) (?:mm|in), whatever",
                each,
            )
        )
    )
    assert (said[1], said[4]) == (("up", "nearer to") if tilted else ("down", "farther from"))
    for turn, thick in ((said[2], said[3]), (said[5], said[6])):
        wanted = apart * math.tan(math.radians(float(turn)))
        assert factor * float(thick) == pytest.approx(wanted, rel=0.02, abs=0.06 * factor)
    assert not any("feet_apart" in each for each in words)
    at_the_output = [each for each in words if each.startswith("Tilt shaft 2")]
    assert len(at_the_output) == (", 0]" not in key)
    for each in at_the_output:
        side = "farther from" if each.startswith("Tilt shaft 2 up ") else "nearer to"
        assert f"that raise the feet {side} joint 1: " in each
    without = Answer(cardan.Scene.parse(text.replace(key, "")))["moves"]
    assert sum("feet_apart_mm in [driveline]" in each for each in moves_in_words(without)) == 1


def test_a_remedy_at_the_edge_of_the_limits_says_what_is_certain() -> None:
    moves = Answer(cardan.Scene.parse(YACHT.format(units="", engine=5)))["moves"]
    engine = next(move for move in moves if move.of == "shaft 0")
    assert engine.tilt is not None
    assert engine.certain is not None
    shares = {}
    for tilt in (engine.tilt, engine.certain):
        text = YACHT.format(units="", engine=5.0 - math.degrees(tilt))
        shares[tilt] = certainty(cardan.Scene.parse(text)).within
    assert 0.2 < (shares[engine.tilt] or 0.0) < 0.8
    assert shares[engine.certain] == 1.0
    words = [*moves_in_words(moves)]
    thick = 1e3 * math.tan(abs(engine.certain))
    found = [
        re.search(r", and with (\S+)°, a shim of (\S+) mm per m, whatever the gauge may hide", each)
        for each in words
    ]
    (said,) = (one for one in found if one and one[1] == f"{abs(math.degrees(engine.certain)):.2f}")
    assert thick <= float(said[2]) < thick + 0.1
    assert words[-1].startswith("A change without a second value leads just to the edge")
    assert "the gauge may hide 0.3° of each reading" in words[-1]
    exact = YACHT.format(units="", engine=5).replace("gauge_deg = 0.3\n", "")
    assert "gauge" not in " ".join(moves_in_words(Answer(cardan.Scene.parse(exact))["moves"]))


def test_where_no_tilt_is_certain_the_likeliest_is_named() -> None:
    """The difference of the bends may be 1° either way, and the gauge hides 1.2° of it."""
    text = YACHT.format(units="", engine="{}").partition("[load]")[0]
    text = text.replace("gauge_deg", "feet_apart_mm = [620, 0]\ngauge_deg")
    text += "[limits]\nequivalent_bend_deg = 9\nbend_difference_deg = 1\n"
    moves = Answer(cardan.Scene.parse(text.format(5)))["moves"]
    (engine,) = (move for move in moves if move.tilt is not None)
    # A spacer at joint 1 would tilt the shaft that has no feet.
    assert [move.of for move in moves if move.axis == "up"] == ["joint 0"]
    assert {
        "A shim is computed for a joint that stays where it is.",
        "A spacer at a joint tilts the shafts on both sides of it.",
    } < {*moves_in_words(moves)}
    assert engine.certain is None
    assert engine.likeliest is not None
    tilt = -math.degrees(engine.likeliest)
    # The middle of the tilts that suffice, from 2° to 4°, to a half of the gauge.
    assert tilt == pytest.approx(3.0, abs=0.15)
    assert engine.share == certainty(cardan.Scene.parse(text.format(5.0 + tilt))).within
    (words,) = (each for each in moves_in_words(moves) if each.startswith("Tilt"))
    share = 100.0 * (engine.share or 0.0)
    found = re.search(
        rf", and with {tilt:.2f}°, a shim of (\S+) mm, for {share:.1f}% of what the "
        "gauge may hide; no tilt tried is certain.$",
        words,
    )
    assert found
    thick = 620.0 * math.tan(math.radians(tilt))
    assert thick <= float(found[1]) < thick + 0.1
    text = text.replace("gauge_deg = 0.3", "gauge_deg = 0.1")
    finer = Answer(cardan.Scene.parse(text.format(5)))
    (engine,) = (move for move in finer["moves"] if move.tilt is not None)
    assert engine.certain is not None
    assert engine.likeliest is None


def test_a_steep_shaft_is_not_tilted_until_it_stands_upright() -> None:
    """Six times the gauge beyond what suffices would be more than 90°."""
    text = '[driveline]\nreadings_deg = ["50 down", "56 down", "58 down"]\ngauge_deg = 8\n'
    moves = [move for move in Answer(cardan.Scene.parse(text))["moves"] if move.tilt is not None]
    assert moves
    assert all(move.verdict == "within" and move.share for move in moves)


def test_without_lengths_no_spacer_is_advised() -> None:
    scene = parsed({"lengths_mm": "#", "offsets_mm": "#"}, LIMITS)
    moves = Answer(scene)["moves"]
    assert {move.of for move in moves if move.variable == "point"} == {"shaft 0", "shaft 3"}
    shaft = next(move for move in moves if move.of == "shaft 3")
    after = cardan.Driveline.from_readings(
        np.radians([-3.0, -1.2, -3.0, -4.0 + math.degrees(shaft.tilt or 0.0)])
    )
    assert float(after.equivalent().bend_deg) == pytest.approx(0.9, rel=1e-6)


def test_a_shim_suffices_in_every_state_as_it_is_printed() -> None:
    """A point that moves alike tilts its shaft by another angle where that slopes more."""
    text = (EXAMPLES / "launch.toml").read_text()
    words, *_ = moves_in_words(Answer(cardan.Scene.parse(text))["moves"])
    found = re.match(r"Tilt shaft 2 down towards the output by (\d\.\d\d)° with a shim", words)
    assert found
    for size, verdict in ((float(found[1]), "within"), (float(found[1]) - 0.02, "beyond")):
        after = text.replace('"3.0 down"]', f'"{3.0 + size:.2f} down"]')
        assert Answer(cardan.Scene.parse(after)).verdict == verdict


def test_working_angles_are_those_of_the_drawing_in_any_order_of_states() -> None:
    text = (EXAMPLES / "launch.toml").read_text().replace("teeth = 24", "gauge_deg = 0.25")
    for torques in ("[-100, 150, 600]", "[600, -100, 150]"):
        found = certainty(cardan.Scene.parse(text.replace("[-100, 150, 600]", torques)))
        for each in found.angles:
            assert each.least is not None
            assert each.largest is not None
            assert math.degrees(each.least) == pytest.approx(2.5, abs=0.05)
            assert math.degrees(each.largest) == pytest.approx(3.5, abs=0.05)


def test_the_page_says_what_a_workshop_can_do() -> None:
    answer = Answer(parsed(rest=LIMITS))
    data = live(answer)
    assert data
    told = " ".join(data["data"]["shims"])
    for words in ("Tilt shaft 3 up", "Lower joint 2", "of what the gauge may hide", "as sent"):
        assert words in told
    points = live(Answer(cardan.Scene.parse(STARTERS["truck-shaft"].text)))
    assert points
    assert points["data"]["shims"] is None


def test_the_picture_says_what_was_measured() -> None:
    text = picture(parsed())
    for words in ("3.00° down", "1.20° down", "4.00° down", "45 mm left", "shaft 3", "Plan:"):
        assert words in text
    assert text.count("45 mm left") == 3
    assert "Plan:" not in picture(parsed({"lengths_mm": "#", "offsets_mm": "#"}))
    assert "2.00° up" in picture(parsed({'"3.0 down"': "2"}))

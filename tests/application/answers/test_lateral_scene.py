"""Lateral vibration of a scene: a light truck, what helps, verdicts, errors, texts and pictures."""

from __future__ import annotations

import math
import re
from functools import cache

import numpy as np
import pytest
from test_verdicts import RUBBER

from cardan.app.answers.answer import Answer
from cardan.app.answers.lateral.figures import LateralFigures
from cardan.app.answers.lateral.vibration import KNOWN
from cardan.app.answers.table import PARTS
from cardan.app.plots import plot_part
from cardan.app.scene import Scene, SceneError
from example_scenes import example

RPM = math.pi / 30.0
TEXT = example("shudder.toml").read_text(encoding="utf-8")
RIGID = RUBBER.format(limits="", lateral="")
# A tube between two machines, whose joints are bent alike.
ONE = """
[driveline]
points_mm = [[0, 0, 0], [300, 0, 0], [1800, 150, 0], [2100, 150, 0]]
[load]
drive_torque_Nm = 1500
[tubes]
outer_diameter_mm = 90
wall_mm = 3
[lateral]
speed_rpm = {from = 300, to = 4000, steps = 50}
"""
# Two shafts on two bearings each, which need no joint.
FOUR = """
[driveline]
bends_deg = 8
lengths_mm = [1000, 1000]
[load]
drive_torque_Nm = 900
[tubes]
outer_diameter_mm = 60
[lateral]
speed_rpm = [500, 600]
""" + "".join(
    f"[[bearing]]\nshaft = {shaft}\nposition_mm = {at}\nstiffness_N_per_mm = 2000\n"
    for shaft in (0, 1)
    for at in (100, 800)
)

# Shafts that bend nearly as much as their bearing.
SHARED = """
[driveline]
points_mm = [[0, 0, 0], [280, -18, 0], [1480, -105, 0], [3000, -360, 0], [3280, -385, 0]]
[load]
drive_torque_Nm = 1100
[[bearing]]
shaft = 1
from_end_mm = 110
stiffness_N_per_mm = {stiffness}
{loss}
[tubes]
outer_diameter_mm = 76
wall_mm = 2.2
[lateral]
speed_rpm = {{from = 300, to = 2600, steps = 231}}
"""


def changed(text: str, *changes: tuple[str, str]) -> str:
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    return text


@cache
def figures(text: str) -> LateralFigures:
    found = Answer(Scene.parse(text)).needed("lateral")
    assert isinstance(found, LateralFigures)
    return found


def said(text: str) -> str:
    return " ".join(PARTS["lateral"].text(figures(text)).split())


def shudder(text: str) -> tuple[float, float, float]:
    """Static force of order 2, its peak and the displacement there in mm."""
    found = figures(text)
    static = found.bearings[0].static
    met = next(each for each in found.resonances if each.order == 2)
    assert static
    assert met.peak
    assert met.moved
    return static, met.peak, 1e3 * met.moved


# By N/mm: natural frequency, speed of the shudder, order 2 there and how many times the static
# force that is, displacement, order 2 at 300, 1500 and 2500 rpm, order 1 at the speed behind it.
TABLE = {
    150: (15.13, 454, 555.1, 7.97, 3.67, (118, 1.5, 61), (36, 920)),
    300: (21.30, 639.3, 513.48, 7.37, 1.70, (86, 3.3, 117), (70, 1280)),
    600: (29.85, 893.9, 420.8, 6.04, 0.70, (76, 8.2, 219), (139, 1800)),
}


@pytest.mark.parametrize("rubber", TABLE)
def test_the_light_truck_shudders_as_the_theory_has_it(rubber: int) -> None:
    frequency, speed, peak, times, moved, forces, (unbalance, at) = TABLE[rubber]
    text = changed(TEXT, ("N_per_mm = 300", f"N_per_mm = {rubber}"))
    found = figures(text)
    met = next(each for each in found.resonances if each.order == 2)
    assert found.modes[0].frequency / math.tau == pytest.approx(frequency, abs=0.006)
    assert met.speed / RPM == pytest.approx(speed, rel=2e-3)
    assert met.peak_speed is not None
    assert met.peak_speed / RPM == pytest.approx(speed, rel=2e-3)
    static, own, displacement = shudder(text)
    assert static == pytest.approx(69.65, abs=0.02)
    assert own == pytest.approx(peak, rel=5e-4)
    assert own / static == pytest.approx(times, abs=0.006)
    assert displacement == pytest.approx(moved, abs=0.006)
    assert found.bearings[0].mean == pytest.approx(69.64, abs=0.02)
    one = found.vibration
    assert one.load
    response = one.system.response(RPM * np.array([300.0, 1500.0, 2500.0, at]), one.load)
    order_1, order_2, order_4 = response.of_order("bearing_force")[0].T
    # Digits as printed; at 2500 rpm the shear coefficient counts, which is 0.522 in the theory.
    for force, wanted, half in zip(order_2, forces, (0.5, 0.05, 0.8), strict=False):
        assert force == pytest.approx(wanted, abs=half)
    assert round(order_1[-1]) == unbalance
    assert order_4 == pytest.approx(0.0, abs=1e-9)


# The slopes of the shafts are 3, 4, 9 and 4 degrees down; joint 1 is the third point.
LAYOUTS = {
    "the pinion wound up": (
        (("3574.268, -397.584", "3572.763, -413.218"),),
        94.5,
        756,
    ),
    "joint 1 lower by 20 mm": ((("1546.544, -102.896", "1546.544, -122.896"),), 54.5, 395),
    "joint 1 higher by 20 mm": ((("1546.544, -102.896", "1546.544, -82.896"),), 84.9, 635),
    "yokes turned": ((("[load]", "phases_deg = [90, 0]\n[load]"),), 46.5, 319),
    "W at the axle": ((("3574.268, -397.584", "3566.088, -449.234"),), 152, 1322),
}


@pytest.mark.parametrize("name", LAYOUTS)
def test_other_layouts_of_the_truck(name: str) -> None:
    changes, static, peak = LAYOUTS[name]
    own, largest, _ = shudder(changed(TEXT, *changes))
    assert own == pytest.approx(static, rel=6e-3)
    assert largest == pytest.approx(peak, rel=6e-3)


def test_a_change_that_is_listed_helps_as_it_says() -> None:
    """Those of joint 1, of the yokes and of both are made in the scene."""
    found = figures(TEXT)
    by_words = {each.change: each for each in found.remedies}
    lower = by_words[next(words for words in by_words if words.startswith("joint 1 lower by 88"))]
    down = float(lower.change.split()[-2])
    assert lower.left is not None
    assert lower.left < 0.02
    layout = changed(TEXT, ("-102.896", f"{-102.896 - down}"))
    response = figures(layout).vibration.system.response(
        found.vibration.speed, found.vibration.load, orders=(2,)
    )
    near = np.abs(found.vibration.speed / RPM - 639.0) < 50.0
    now = found.vibration.response.of_order("bearing_force")[0, near, 2]
    assert np.max(response.of_order("bearing_force")[0, near, 0]) < 0.02 * np.max(now)
    yokes = by_words["yokes of shaft 1 turned by 90°"]
    assert yokes.static == pytest.approx(46.5, abs=0.05)
    assert yokes.peak == pytest.approx(319, abs=1)
    both = min((each for each in found.remedies if each.left), key=lambda each: each.bend)
    assert both.bend < math.radians(0.05)
    assert both.left is not None
    assert both.left < 0.05
    # Shaft 0 slopes 0.74 degrees less, about joint 0.
    raised = 15.701 - 299.589 * math.tan(math.radians(3.0 - 0.74))
    made = changed(
        TEXT,
        ("[0, 0, 0],", f"[0, {-raised}, 0],"),
        ("-102.896", f"{-102.896 - 16.9}"),
        ("[load]", "phases_deg = [90, 0]\n[load]"),
    )
    assert float(figures(made).vibration.line.equivalent().bend) < math.radians(0.2)
    after = figures(made).vibration
    assert (
        np.interp(639.0 * RPM, after.speed, after.response.of_order("bearing_force")[0, :, 2]) < 10
    )
    assert f"{both.change[1:]}: this ends the shudder" in said(TEXT)


def largest_of(text: str, near: float = 0.1) -> float:
    """Order 2 of the largest force of a bearing around the lowest resonance, over all states."""
    scene = Scene.parse(text)
    assert scene.lateral
    each = [scene.in_state(i) for i in range(scene.states.count)] if scene.states else [scene]
    found = []
    for one in each:
        system = scene.lateral.on(one.line)
        lowest = 0.5 * float(system.natural_frequencies(1)[0])
        speed = lowest * np.linspace(1.0 - near, 1.0 + near, 401)
        response = system.response(speed, one.load_case, orders=[2])
        found.append(float(np.max(response.of_order("bearing_force"))))
    return max(found)


@pytest.mark.parametrize("loss", ["0.04", "0.12"])
def test_what_a_change_leaves_does_not_need_the_damping(loss: str) -> None:
    """Where it is not known, no force is told, and the share is still that of resonance."""
    text = changed(TEXT, ("loss_factor = 0.12", f"loss_factor = {loss}"))
    yokes = next(each for each in figures(text).remedies if each.change.startswith("yokes"))
    made = changed(text, ("[load]", "phases_deg = [90, 0]\n[load]"))
    assert yokes.left == pytest.approx(largest_of(made) / largest_of(text), rel=0.02)
    assert (yokes.peak is None) == (loss == "0.04")


def test_changes_count_in_all_states() -> None:
    """The yokes that help in one state make another one worse."""
    height = '[states]\n"points_mm.2.y" = {add = [-40, 0, 40]}\nnames = ["low", "rest", "high"]\n'
    text = changed(TEXT, ("[limits]", f"{height}[limits]"))
    found = figures(text)
    assert found.state
    made = changed(text, ("[load]", "phases_deg = [90, 0]\n[load]"))
    left = largest_of(made) / largest_of(text)
    listed = [each for each in found.remedies if each.change == "yokes of shaft 1 turned by 90°"]
    assert [each.left for each in listed] == ([pytest.approx(left, rel=0.01)] if left < 0.7 else [])
    assert any(each.left is not None and each.left < 0.9 for each in found.remedies)
    assert "in all states" in said(text)


def test_the_speed_of_the_load_is_answered() -> None:
    """Next to the resonance, in the band of another one, and beside the speeds."""
    at = "At 640 rpm, the speed in [load], bearing 0 bears up to 578 N"
    assert f"{at} (order 1 alone 2.73 N and order 2 alone 513 N)." in said(TEXT)
    high = changed(TEXT, ("speed_rpm = 640", "speed_rpm = 2400"))
    assert "At 2400 rpm, the speed in [load], the forces are not known" in said(high)
    assert "the speed in [load]" not in said(changed(TEXT, ("speed_rpm = 640", "speed_rpm = 200")))
    away = changed(TEXT, ("{from = 300, to = 2500, steps = 221}", "[700, 800]"))
    near = (
        "No resonance of an excited order lies in the speed range; the nearest is that of order 2"
    )
    assert near in said(away)


def test_a_resonance_that_nothing_limits_is_no_good_news() -> None:
    """On the page it has the colour of what is not judged, or that of its verdict."""
    free = changed(TEXT, ("bearing_displacement_mm = 1 ", "joint_force_N = 1e6  # "))
    limited = changed(free, ("tube_loss", "resonance_margin = 0.16\ntube_loss"))
    for text, wanted in ((TEXT, "bad"), (free, "open"), (limited, "bad")):
        answer = Answer(Scene.parse(text))
        assert PARTS["lateral"].section(answer, figures(text))["class"] == wanted


def test_stiffnesses_are_tried_as_they_are() -> None:
    soft, stiff = (each for each in figures(TEXT).remedies if each.stiffness != 1.0)
    for rubber, own in ((150, soft), (600, stiff)):
        _, speed, peak, _, moved, *_ = TABLE[rubber]
        assert own.resonance / RPM == pytest.approx(speed, rel=2e-3)
        assert own.peak == pytest.approx(peak, rel=1e-3)
        assert own.moved == pytest.approx(1e-3 * moved, abs=6e-6)


def test_the_band_of_a_tube_begins_in_the_speeds() -> None:
    text = changed(TEXT, ("to = 2500", "to = 3000"), ("steps = 221", "steps = 271"))
    met = next(each for each in figures(text).resonances if each.order == 2 and not each.known)
    assert met.speed / RPM == pytest.approx(2634.0, abs=1.0)
    assert met.peak is None
    assert (met.start, met.stop) == pytest.approx((0.84 * met.speed, 1.16 * met.speed))
    assert "so stay out of 2213 rpm to 3056 rpm" in said(text)
    # Outside the band the middle of shaft 2 is known.
    response = figures(text).vibration.response
    middle = 1e3 * response.largest("displacement")[1]
    speed = figures(text).vibration.speed / RPM
    order_2 = 1e3 * response.of_order("displacement")[1, :, 2]
    assert np.interp(2212.0, speed, order_2) == pytest.approx(0.48, abs=0.006)
    assert np.interp(2500.0, speed, order_2) == pytest.approx(1.35, abs=0.01)
    # Within the band it would move by 12 mm.
    assert np.max(middle) > 10.0
    assert figures(text).middles[1].moved == pytest.approx(1.34e-3, abs=6e-6)


def test_a_change_says_where_nothing_is_judged_after_it() -> None:
    left = "; from 2213 rpm to 2500 rpm the limit then stays not judged, as the damping there"
    assert left in said(TEXT)
    for text in (
        changed(TEXT, ("bearing_displacement_mm = 1 ", "equivalent_bend_deg = 3 ")),
        changed(TEXT, ("to = 2500, steps = 221", "to = 2200, steps = 191")),
    ):
        assert "this ends the shudder" in said(text)
        assert "stays not judged" not in said(text)


def test_a_limit_that_a_band_reaches_is_not_judged_within() -> None:
    for limit, verdict in ((1.0, "beyond"), (3.0, "not judged")):
        text = changed(TEXT, ("displacement_mm = 1 ", f"displacement_mm = {limit} "))
        assert figures(text).bearings[0].displacement.verdict == verdict
    why = figures(text).bearings[0].displacement.why
    assert why.startswith("it is kept from 300 rpm to 2213 rpm; at the other speeds the damping of")
    assert why.endswith(
        "the resonance of order 2 at 2634 rpm (of tubes, above the speed range) is too small "
        "(tube_loss_factor in [lateral]); a speed range up to 2212 rpm is judged"
    )
    below = changed(text, ("to = 2500, steps = 221", "to = 2212, steps = 191"))
    assert figures(below).bearings[0].displacement.verdict == "within"
    assert "largest displacement, at most 3 mm, not judged 1.92 mm or more" in said(text)
    below = changed(text, ("to = 2500, steps = 221", "to = 2200, steps = 191"))
    assert figures(below).bearings[0].displacement.verdict == "within"


def test_what_is_not_judged_names_the_keys_that_are_missing() -> None:
    """Rubber in a bearing, or tubes where these have the energy."""
    wide = ("displacement_mm = 1 ", "displacement_mm = 30 ")
    bare = changed(TEXT, wide, ("loss_factor = 0.12", ""))
    rubber, tube = "loss_factor in [[bearing]], 0.05 to 0.2 for rubber", "tube_loss_factor in"
    assert f"is too small or not known ({tube} [lateral]; {rubber})." in said(bare)
    assert f"is too small ({tube} [lateral])" in said(changed(TEXT, wide))
    within = changed(
        bare, ("from = 300, to = 2500, steps = 221", "from = 600, to = 700, steps = 3")
    )
    assert f"the damping is not known at any of the speeds ({rubber})." in said(within)


def test_the_loss_factor_decides_whether_there_is_a_peak() -> None:
    """That of a resonance is by its energies: 98 % of the first one are in the rubber."""
    for loss, known in ((KNOWN - 0.001, False), (KNOWN + 0.003, True)):
        text = changed(TEXT, ("loss_factor = 0.12", f"loss_factor = {loss}"))
        met = next(each for each in figures(text).resonances if each.order == 2)
        assert met.known is known
        assert (met.peak is None) is not known
    half = changed(TEXT, ("loss_factor = 0.12", "loss_factor = 0.06"))
    assert shudder(half)[1] == pytest.approx(1035, rel=2e-3)
    bare = changed(TEXT, ("loss_factor = 0.12", ""), ("tube_loss_factor = 0.01", ""))
    assert "its damping is not known, so stay out of 537 rpm to 741 rpm" in said(bare)
    assert "its damping is too small, so stay out of 2213 rpm to 3056 rpm" in said(TEXT)
    assert figures(bare).torque_margin is None
    # Without damping the changes are those of statics.
    assert any(each.left is not None and each.left < 0.01 for each in figures(bare).remedies)


def test_static_forces_of_an_elastic_bearing_are_called_so() -> None:
    found = Answer(Scene.parse(SHARED.format(stiffness=220, loss="")))["forces"]
    assert PARTS["forces"].sentences(found) == [
        "The force of bearing 0 is that by statics; the lateral vibration has it over the speeds, "
        "with resonances."
    ]
    rigid = SHARED.format(stiffness=220, loss="").replace("stiffness_N_per_mm", "# ")
    assert PARTS["forces"].sentences(Answer(Scene.parse(rigid))["forces"]) == []


def test_a_range_between_bands_is_kept() -> None:
    """Without a limit the largest displacement is open as well."""
    bare = changed(TEXT, ("loss_factor = 0.12", ""), ("tube_loss_factor = 0.01", ""))
    text = changed(bare, ("displacement_mm = 1 ", "displacement_mm = 30 "))
    why = figures(text).bearings[0].displacement.why
    assert why.startswith("it is kept from 300 rpm to 537 rpm, 741 rpm to 1074 rpm and 1483 rpm to")
    assert "resonances of order 2 at 639 rpm, order 1 at 1278 rpm and order 2 at 2634 rpm" in why
    # Some lie within the speeds.
    assert "is judged" not in why
    assert figures(text).bearings[0].displacement.verdict == "not judged"
    force = figures(text).bearings[0].largest
    assert force.limit is None
    assert force.value is not None
    assert f"largest dynamic force {force.value:.0f} N or more" in said(text)


@pytest.mark.parametrize("loss", ["0.05", "[0.05, 0.05]"])
def test_the_least_loss_factor_of_rubber_has_a_peak(loss: str) -> None:
    """That of the bearing decides, if it has most of the elastic energy: here 85 %."""
    text = SHARED.format(stiffness=440, loss=f"loss_factor = {loss}\naxis = [0, 1, 0]")
    found = figures(text)
    met = next(each for each in found.resonances if each.order == 2)
    assert found.modes[0].loss < KNOWN
    assert met.known
    assert met.peak
    # Where tubes have nearly all of it, the loss factor of rubber does not damp.
    assert not any(each.known for each in found.resonances if each.mode)
    low = figures(text.replace("0.05", "0.049"))
    assert not next(each for each in low.resonances if each.order == 2).known


@pytest.mark.parametrize("stiffness", [220, 440, 617])
def test_frequencies_of_resonances_give_their_speeds(stiffness: int) -> None:
    text = SHARED.format(stiffness=stiffness, loss="loss_factor = 0.1")
    text = text.replace("to = 2600", "to = 3200")
    met = re.findall(r"rder (\d) is in resonance at (\d+) rpm \(([\d.]+) Hz", said(text))
    assert len(met) >= 2
    for order, speed, frequency in met:
        assert f"{60.0 * float(frequency) / int(order):.0f}" == speed


def test_order_1_without_an_unbalance_excites_nothing() -> None:
    """Neither force nor band, but the margin counts it: no shaft is balanced exactly."""
    text = SHARED.format(stiffness=440, loss="").replace("to = 2600", "to = 3200")
    found = figures(text)
    (first,) = (each for each in found.resonances if each.order == 1 and not each.mode)
    assert first.inside
    assert not first.excited
    assert not first.known
    assert {each.order for each in found.vibration.bands} == {2}
    assert found.bearings[0].order_1 == 0.0
    told = re.findall(r"Order 1 is in resonance at \d+ rpm \([^)]*\)(.*?\w)\. ", said(text))
    assert told == ["; no [[lateral.unbalance]] is given"]
    alone = figures(text.replace("from = 300", "from = 2600"))
    assert [each.order for each in alone.resonances if each.inside and not each.mode] == [1]
    assert alone.margin
    assert alone.margin.value == 0.0
    unbalance = "shaft = 1\nposition_mm = 900\nunbalance_gmm = 50\ndirection = [0, 1, 0]\n"
    given = f"{text}[[lateral.unbalance]]\n{unbalance}"
    assert {each.order for each in figures(given).vibration.bands} == {1, 2}
    assert "no [[lateral.unbalance]]" not in said(given)


def test_a_shaft_without_yokes_is_told_what_their_mass_does() -> None:
    text = SHARED.format(stiffness=220, loss="loss_factor = 0.1")
    told = "No mass of yokes is given ([[lateral.mass]]): resonances are lower with them."
    assert told in said(text)
    given = f"{text}[[lateral.mass]]\nshaft = 1\nfrom_end_mm = 0\nmass_kg = 7\n"
    assert told not in said(given)
    assert figures(given).modes[0].frequency < 0.8 * figures(text).modes[0].frequency
    # Rigid shafts have their mass.
    assert told not in said(RIGID)


def test_each_change_of_the_layout_is_said_once() -> None:
    changes = [each.change for each in figures(TEXT).remedies if each.stiffness == 1.0]
    assert len(changes) > 3
    assert [said(TEXT).count(f"{each[0].upper()}{each[1:]}:") for each in changes] == [1] * len(
        changes
    )
    assert "All changes hold for the stiffness and the masses given:" in said(TEXT)


@pytest.mark.parametrize(
    "text",
    [TEXT, SHARED.format(stiffness=220, loss="loss_factor = 0.1")],
    ids=["with yokes", "without"],
)
def test_what_a_change_leaves_with_other_stiffnesses_is_said(text: str) -> None:
    """As the whole answer of the changed scene has it."""
    told = re.search(
        r"At half the stiffness the first leaves ([\d.]+) N in place of ([\d.]+) N, and at twice "
        r"([\d.]+) N in place of ([\d.]+) N\.",
        said(text),
    )
    assert told
    (first,) = re.findall(r"\. ([^.:]+(?:\.\d[^.:]*)*): this ends the shudder", said(text))
    found = figures(text)
    best = next(each for each in found.remedies if each.change[1:] == first[1:])
    line = best.made(found.vibration.line)
    steps = np.cumsum(1e3 * line.directions * line.lengths().each[:, np.newaxis], axis=0)
    points = f"points_mm = {[[0.0, 0.0, 0.0], *steps.tolist()]}"
    points += f"\nphases_deg = {np.degrees(line.phases).tolist()}\n"
    changed_line = re.sub(r"points_mm = \[.*?\]\n?\]?\n(?=\n?\[load)", points, text, flags=re.S)
    assert points in changed_line
    # The bearing stays where it is while its shaft becomes longer.
    place_now = f"position_mm = {1e3 * float(line.bearings[0][1])!r}"
    changed_line = re.sub(r"from_end_mm = \d+", place_now, changed_line, count=1)
    for place, factor in enumerate((0.5, 2.0)):
        for number, own in enumerate((changed_line, text)):
            (old,) = re.findall(r"stiffness_N_per_mm = (\d+)", own)
            stiffness = f"stiffness_N_per_mm = {factor * float(old)}"
            after = figures(own.replace(f"stiffness_N_per_mm = {old}", stiffness))
            peak = next(each.peak for each in after.resonances if each.order == 2)
            assert float(told[1 + 2 * place + number]) == pytest.approx(peak, rel=3e-3)


def test_the_peak_has_its_own_speed() -> None:
    """Damping and the flank of the next resonance move it from that of the resonance."""
    text = SHARED.format(stiffness=440, loss="loss_factor = 0.1")
    assert "86.6 N at bearing 0 at 1349 rpm, 1.49 times the static force" in said(text)


def test_other_stiffnesses_say_their_forces() -> None:
    soft = "454 rpm, with 555 N at the bearing and ±3.67 mm of the shaft"
    stiff = "894 rpm, with 421 N at the bearing and ±0.696 mm of the shaft"
    assert f"moves the peak of order 2 to {soft}, and twice the stiffness to {stiff}." in said(TEXT)


def test_without_a_stiffness_the_couples_and_static_forces_are_said() -> None:
    text = changed(
        TEXT,
        ("stiffness_N_per_mm = 300 ", "#"),
        ("loss_factor = 0.12", ""),
        ("bearing_displacement_mm = 1 ", "equivalent_bend_deg = 3 "),
        ("speed_rpm = {from = 300, to = 2500, steps = 221}\ntube_", "#"),
    )
    found = figures(text)
    assert found.statics[0].static == pytest.approx(69.65, abs=0.02)
    assert not found.modes
    assert not found.resonances
    assert not found.bearings
    assert found.couples == figures(TEXT).couples
    assert "half the critical speeds at 4755 rpm of shaft 1 and 2426 rpm of shaft 2" in said(text)
    for picture in ("lateral", "shapes"):
        with pytest.raises(ValueError, match=r"no stiffness_N_per_mm, .* static"):
            plot_part(Scene.parse(text), picture)


def test_a_bow_excites_half_the_critical_speed_and_a_tilt_does_not() -> None:
    """Z with equal bends, and W, whose bends point to the same side."""
    (couple,) = figures(ONE).couples
    # D tan(bend), of the bend of 5.71 degrees: D sin β/2 to D tan β/2.
    half = 0.5 * 1500.0 * np.array([math.sin(0.0996687), math.tan(0.0996687)])
    assert half[0] <= couple.bow <= half[1]
    assert couple.tilt == 0.0
    assert "which excites half its critical speed, and load no bearing" in said(ONE)
    w = changed(ONE, ("[2100, 150, 0]", "[2094.059, 209.406, 0]"))
    (couple,) = figures(w).couples
    assert couple.tilt == pytest.approx(half[0], rel=5e-3)
    assert couple.bow < 0.01 * couple.tilt


def test_a_redundant_layout_says_which_force_it_has() -> None:
    assert "No shaft needs the support of joint 0: statics takes the force" in said(FOUR)
    assert "No shaft needs" not in said(TEXT)


def test_states_are_judged_and_the_worst_is_shown() -> None:
    text = f'{TEXT}[states]\nnames = ["low", "high"]\n"points_mm.2.y" = [-122.896, -82.896]\n'
    found = figures(text)
    assert found.state == "high"
    assert found.bearings[0].static == pytest.approx(84.9, abs=0.3)
    largest = found.bearings[0].largest
    assert largest.state == "high"
    assert set(largest.each) == {"low", "high"}
    assert largest.each["high"] == largest.value
    assert ", in high" in said(text)


def test_without_a_load_the_resonances_are_known() -> None:
    text = changed(TEXT, ("drive_torque_Nm = 1500", "drive_torque_Nm = 0"))
    found = figures(text)
    assert "a torque or inertias in [load]" in found.why
    assert found.modes[0].frequency == figures(TEXT).modes[0].frequency
    assert found.bearings[0].displacement.verdict == "not judged"


ERRORS: dict[str, tuple[str, tuple[tuple[str, str], ...], str]] = {
    "beyond its shaft": (
        *(RIGID, (("from_end_mm = 150", "from_end_mm = 1500"),)),
        r"\[\[bearing\]\]\[0\] from_end_mm is 1500 mm on shaft 1 of length 1200 mm",
    ),
    "negative stiffness": (
        *(RIGID, (("N_per_mm = 300", "N_per_mm = -300"),)),
        r"stiffness_N_per_mm is -300; a stiffness must lie in \[0.001, 1e\+09\]",
    ),
    "loss factor": (
        *(RIGID, (("loss_factor = 0.1", "loss_factor = 1.2"),)),
        r"loss_factor is 1.2; a loss factor must lie in \[0, 1\]",
    ),
    "no axis": (
        *(RIGID, (("N_per_mm = 300", "N_per_mm = [300, 200]"),)),
        r"axis is missing; stiffness_N_per_mm differs in two directions",
    ),
    "axis along": (
        *(RIGID, (("N_per_mm = 300", "N_per_mm = 300\naxis = [2, 0, 0]"),)),
        r"axis is \[2, 0, 0\], along the shaft",
    ),
    "no mass": (
        *(RIGID, (("[[lateral.rigid]]\nshaft = 2\nmass_kg = 18\n", ""),)),
        r"\[lateral\] shaft 2 moves, but its mass is not known",
    ),
    "no speeds": (
        *(RIGID, (("speed_rpm = {from = 900, to = 1100, steps = 5}", ""),)),
        r"\[lateral\] speed_rpm is missing",
    ),
    "both held": (
        "[driveline]\nbends_deg = 5\nlengths_mm = [300, 900]\n[lateral]\nspeed_rpm = [100, 200]\n",
        (),
        r"joint 0 joins two shafts that are held by their machines, shafts 0 and 1",
    ),
    "no support": (
        "[driveline]\nbends_deg = [5, 4, 3, 2]\nlengths_mm = [300, 900, 900, 900, 300]\n"
        "[[bearing]]\nshaft = 1\nposition_mm = 500\nstiffness_N_per_mm = 300\n"
        "[lateral]\nspeed_rpm = [100, 200]\n"
        + "".join(f"[[lateral.rigid]]\nshaft = {shaft}\nmass_kg = 10\n" for shaft in (1, 2, 3)),
        (),
        r"\[lateral\] bearings and joints leave shaft 3 without support",
    ),
    "no lengths": (
        "[driveline]\nbends_deg = 5\n[lateral]\nspeed_rpm = [100, 200]\n",
        (),
        r"\[lateral\] the shafts have no lengths; give points_mm",
    ),
    "one stiffness of two": (
        *(RIGID, (("[limits]", "[[bearing]]\nshaft = 2\nposition_mm = 700\n[limits]"),)),
        r"\[\[bearing\]\]\[1\] stiffness_N_per_mm is missing; another bearing has one",
    ),
    "no section": (
        "[driveline]\nbends_deg = [5, 5]\nlengths_mm = [300, 900, 300]\n[[bearing]]\nshaft = 1\n"
        "position_mm = 100\nstiffness_N_per_mm = 300\n",
        (),
        r"stiffness_N_per_mm needs a section \[lateral\]",
    ),
    "mass on a machine": (
        f"{RIGID}[[lateral.mass]]\nshaft = 0\nposition_mm = 3\nmass_kg = 2\n",
        (),
        r"\[\[lateral.mass\]\]\[0\] shaft is 0, which its machine holds",
    ),
    "direction along": (
        f"{RIGID}[[lateral.unbalance]]\nshaft = 1\nposition_mm = 3\nunbalance_gmm = 2\n"
        "direction = [1, 0, 0]\n",
        (),
        r"direction is \[1, 0, 0\], along the shaft",
    ),
    "margin of rigid bearings": (
        RUBBER.format(limits="", lateral="resonance_margin = 0.1"),
        (("stiffness_N_per_mm = 300\nloss_factor = 0.1", ""),),
        r"\[lateral\] resonance_margin needs stiffness_N_per_mm in \[\[bearing\]\]",
    ),
    "displacement without": (
        "[driveline]\nbends_deg = [5, 5]\nlengths_mm = [300, 900, 300]\n[[bearing]]\nshaft = 1\n"
        "position_mm = 100\n[limits]\nbearing_displacement_mm = 2\n",
        (),
        r"bearing_displacement_mm needs stiffness_N_per_mm in \[\[bearing\]\]",
    ),
}


@pytest.mark.parametrize("name", ERRORS)
def test_errors_name_the_key_and_the_rule(name: str) -> None:
    text, changes, message = ERRORS[name]
    with pytest.raises(SceneError, match=message):
        Scene.parse(changed(text, *changes))


def test_the_picture_of_the_force_has_its_peak() -> None:
    (axes,) = plot_part(Scene.parse(TEXT), "lateral").axes
    curves = {line.get_label(): np.asarray(line.get_data()) for line in axes.lines}
    speed, force = curves["order 2"]
    assert np.max(force[speed < 1000]) == pytest.approx(513.5, abs=0.2)
    assert np.all(curves["largest"][1] >= force)


def test_half_the_stiffness_of_one_of_two_bearings_moves_its_own_resonance() -> None:
    text = """
        [driveline]
        slopes_vertical_deg = [-2, -3, -5, -8, -4]
        lengths_m = [0.3, 1.1, 1.0, 1.4, 0.3]
        [load]
        drive_torque_Nm = 800
        [tubes]
        outer_diameter_mm = 76
        wall_mm = 2
        [lateral]
        speed_rpm = {from = 300, to = 3000, steps = 271}
        tube_loss_factor = 0.01
        """ + "".join(
        f"[[bearing]]\nshaft = {shaft}\nfrom_end_mm = 100\nstiffness_N_per_mm = {stiffness}\n"
        "loss_factor = 0.1\n"
        for shaft, stiffness in ((1, 180), (2, 220))
    )
    soft = next(each for each in figures(text).remedies if each.stiffness == 0.5)
    after = figures(changed(text, ("= 180", "= 90")))
    worst = max((each for each in after.resonances if each.peak), key=lambda each: each.peak or 0.0)
    assert worst.order == 2
    assert soft.resonance == pytest.approx(worst.peak_speed, rel=2e-3)
    assert soft.peak == pytest.approx(worst.peak, rel=1e-3)
    assert soft.moved == pytest.approx(worst.moved, rel=1e-3)


@pytest.mark.parametrize(
    ("points", "stiffness", "speed"),
    [
        ("[280, -14, 0], [1500, -60, 0], [2860, -210, 0], [3120, -225, 0]", 220, 1470),
        # The bearing holds the second resonance as well, which is above the speeds.
        ("[280, -18, 0], [1480, -105, 0], [3000, -360, 0], [3280, -385, 0]", 440, 1837),
    ],
)
def test_twice_the_stiffness_moves_the_resonance_itself(
    points: str, stiffness: int, speed: float
) -> None:
    """A higher resonance, in which the force is larger, is another one."""
    text = f"""
        [driveline]
        points_mm = [[0, 0, 0], {points}]
        [load]
        drive_torque_Nm = 1100
        [tubes]
        outer_diameter_mm = 76
        wall_mm = 2.2
        [[bearing]]
        shaft = 1
        from_end_mm = 115
        stiffness_N_per_mm = {stiffness}
        loss_factor = 0.1
        [lateral]
        speed_rpm = {{from = 300, to = 2600, steps = 231}}
        """
    stiff = next(each for each in figures(text).remedies if each.stiffness == 2.0)
    after = figures(changed(text, (f"= {stiffness}", f"= {2 * stiffness}")))
    own = next(each for each in after.resonances if each.peak)
    assert own.speed / RPM == pytest.approx(speed, abs=30)
    assert stiff.resonance == pytest.approx(own.peak_speed, rel=2e-3)
    assert stiff.peak == pytest.approx(own.peak, rel=1e-3)
    assert stiff.moved == pytest.approx(own.moved, rel=1e-3)


def test_vibration_is_that_at_steady_speeds() -> None:
    """An acceleration changes other answers, and the scene is told so."""
    text = changed(TEXT, ("[load]", "[load]\nacceleration_rad_s2 = 40"))
    assert said(text) == said(TEXT)
    (remark,) = Answer(Scene.parse(text))["remarks"]
    assert remark.about == "[load]"
    assert remark.remark == "lateral vibration is that at steady speeds, without acceleration"

"""The printed answer of torsional vibration read back: each line against the library."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

from cardan.app.answers.torsion.figures import (
    Missing,
    TorsionFigures,
    Unstable,
    needed_torsion,
    torsion_basics,
    torsion_data,
)
from cardan.app.answers.torsion.text import brief as torsion_check_text
from cardan.app.answers.torsion.text import stability_lines, torsion_text
from cardan.app.scene import Scene
from pages import EXAMPLES, blocks, first_number


def needed(name: str) -> TorsionFigures:
    return needed_torsion(Scene.load(EXAMPLES / f"{name}.toml"))


def test_natural_frequencies_and_critical_speeds() -> None:
    found = needed("truck_torsion")
    shown = blocks(torsion_text(found))
    system = found.torsion.system
    frequencies = []
    for (hertz, words), mode in zip(shown["Natural frequencies"].items(), found.modes, strict=True):
        frequencies.append(first_number(hertz))
        assert hertz.endswith(" Hz")
        assert frequencies[-1] == pytest.approx(mode.frequency / (2.0 * np.pi), rel=1e-3)
        shares = re.findall(r"shaft (\d) \((\d+) %\)", words)
        by_shaft = {each.shaft: each.share for each in mode.shares}
        assert [int(shaft) for shaft, _ in shares] == sorted(
            by_shaft, key=lambda shaft: -by_shaft[shaft]
        )
        for shaft, percent in shares:
            assert float(percent) == pytest.approx(100.0 * by_shaft[int(shaft)], abs=0.5)
        ratio = float(words.rpartition("damping ratio ")[2])
        assert ratio == pytest.approx(mode.damping_ratio, rel=1e-3)
    criticals = shown["Critical speeds"]
    orders = []
    for speed, words in criticals.items():
        found_words = re.fullmatch(
            r"order (\d) meets ([\d.]+) Hz: ([\d.]+) N m of this order in shaft (\d)"
            r"(, outside the speed range)?",
            words,
        )
        assert found_words, words
        order, hertz, amplitude, shaft, outside = found_words.groups()
        orders.append((int(order), float(hertz)))
        rpm = first_number(speed)
        assert rpm == pytest.approx(60.0 * float(hertz) / int(order), rel=2e-3)
        assert bool(outside) == (not 500.0 <= rpm <= 3000.0)
        steady = system.steady(60.0 * float(hertz) / int(order) * np.pi / 30.0, int(order))
        sizes = np.abs(steady.torque_orders[:, 0])
        place = list(system.compliant).index(int(shaft))
        assert float(amplitude) == pytest.approx(sizes[place], rel=0.02)
    assert orders == [(order, hertz) for order in (2, 4) for hertz in frequencies]


def test_largest_torques() -> None:
    found = needed("truck_torsion")
    shown = blocks(torsion_text(found))["Largest torque, 500 to 3000 rpm"]
    system = found.torsion.system
    speed = np.linspace(500.0, 3000.0, 2501)
    steady = system.steady(speed * np.pi / 30.0)
    for place, (shaft, words) in enumerate(shown.items()):
        assert shaft == f"shaft {system.compliant[place]}"
        numbers = re.fullmatch(r"(\S+) to (\S+) N m at (\S+) rpm, mean (\S+) N m", words)
        assert numbers, words
        least, most, rpm, mean = map(float, numbers.groups())
        at = int(np.argmax(np.fmax(steady.torque_max, -steady.torque_min)[place]))
        assert rpm == pytest.approx(speed[at], abs=1.0)
        assert least == pytest.approx(steady.torque_min[place, at], rel=2e-3)
        assert most == pytest.approx(steady.torque_max[place, at], rel=2e-3)
        assert mean == pytest.approx(steady.torque_mean[place, at], rel=5e-3)
    sentences = " ".join(torsion_text(found).rpartition("\n\n")[2].split())
    largest = max(found.largest, key=lambda torque: torque.size)
    ratio = largest.size / abs(largest.mean)
    (said,) = re.findall(r"in shaft 1 at \d+ rpm, ([\d.]+) times the mean torque there", sentences)
    assert float(said) == pytest.approx(ratio, rel=1e-3)
    # The worst critical speed of the table, with the amplitude that stands there.
    amplitudes = {
        float(words.split(": ")[1].split()[0]): speed
        for speed, words in blocks(torsion_text(found))["Critical speeds"].items()
        if "outside" not in words
    }
    worst = max(amplitudes)
    assert f"The range contains {len(amplitudes)} critical speeds; the worst is" in sentences
    assert f"at {amplitudes[worst]}, where this order of the torque of shaft 2 is" in sentences
    assert f"is ±{worst:.0f} N m." in sentences


def test_unstable_speeds() -> None:
    found = needed("rig_torsion")
    assert found.unstable
    shown = blocks(torsion_text(found))["Stability"]
    assert len(shown) == len(found.unstable)
    for (speeds, words), region in zip(shown.items(), found.unstable, strict=True):
        ends = [float(end) for end in speeds.removesuffix(" rpm").split(" to ")]
        rpm = [speed * 30.0 / np.pi for speed in (region.start, region.stop)]
        assert ends == pytest.approx(rpm, rel=1e-3)
        percent = re.fullmatch(r"unstable, a deviation grows by up to (\S+) % per half turn", words)
        assert percent, words
        assert float(percent[1]) == pytest.approx(100.0 * (region.multiplier - 1.0), rel=6e-3)


def test_ranges_of_the_answer_are_those_of_the_scene() -> None:
    """Speeds that the scene gives in rpm come back as such."""
    found = needed("rig_torsion")
    data = torsion_data("", found)
    assert data["speed_range"] == pytest.approx({"start_rpm": 500.0, "stop_rpm": 4000.0})
    printed_ends = [
        [float(end) for end in speeds.removesuffix(" rpm").split(" to ")]
        for speeds in blocks(torsion_text(found))["Stability"]
    ]
    ends = [[part["start_rpm"], part["stop_rpm"]] for part in data["unstable"]]
    assert ends == [pytest.approx(pair, rel=1e-3) for pair in printed_ends]


def test_the_worst_critical_speed_is_one_whose_motion_is_known() -> None:
    found = needed("rig_torsion")
    inside = [one for one in found.critical_speeds if one.inside and one.order % 2 == 0]
    assert len(inside) == 3
    worst = max(inside, key=lambda one: one.amplitude or 0.0)
    known = [
        replace(one, amplitude=np.nan) if one is worst else one for one in found.critical_speeds
    ]
    second = max((one for one in inside if one is not worst), key=lambda one: one.amplitude or 0.0)
    for criticals, named in ((found.critical_speeds, worst), (tuple(known), second)):
        said = " ".join(torsion_text(replace(found, critical_speeds=criticals)).split())
        pattern = r"contains 3 critical speeds; the worst is that of order (\d+) at ([\d.]+) rpm"
        shown = re.search(pattern, said)
        assert shown, said
        assert int(shown[1]) == named.order
        assert float(shown[2]) == pytest.approx(named.speed * 30.0 / np.pi, rel=1e-3)
    assert "no periodic motion was found" in said


def test_ranges_of_speed_have_their_two_ends() -> None:
    found, rpm = needed("rig_torsion"), np.pi / 30.0
    region = Unstable(2000.0 * rpm, 2100.0 * rpm, 1.5)
    missing = Missing(600.0 * rpm, 700.0 * rpm, "it does not settle")
    shown = stability_lines(replace(found, unstable=(region,), missing=(missing,)))
    assert [speeds for speeds, _ in shown] == ["2000 to 2100 rpm", "600 to 700 rpm"]
    said = torsion_text(replace(found, unstable=(region,), missing=(missing,)))
    assert "Between 2000 and 2100 rpm the motion" in said
    assert "Between 600 and 700 rpm the torques" in said


def test_of_several_rules_the_one_is_named_that_is_exceeded_most() -> None:
    found = needed("rig_torsion")
    (region, *_), (rule, *_) = found.unstable, found.rules
    at = replace(rule, speed=(region.start + region.stop) / 2.0)
    steep = replace(at, shaft=3, bend=np.radians(40.0), factor=0.1325, damping_ratio=0.1)
    # A larger ratio than that, but of a bend that permits little more.
    damped = replace(at, shaft=4, bend=np.radians(41.0), factor=0.1398, damping_ratio=0.13)
    for rules in ((steep, damped), (damped, steep)):
        said = " ".join(torsion_text(replace(found, rules=rules)).split())
        assert "an equivalent bend behind shaft 3 of at most" in said
        assert "instead of 40°" in said


@pytest.mark.parametrize(("first", "words"), [(1200, "a critical speed lies"), (600, "critical")])
def test_a_check_names_the_critical_speeds_in_the_range(first: int, words: str) -> None:
    """Of even order, each at the natural frequency over the order."""
    text = (EXAMPLES / "rig_torsion.toml").read_text(encoding="utf-8")
    ends = f"from = {first}, to = 1800"
    basics = torsion_basics(Scene.parse(text.replace("from = 500, to = 4000", ends)))
    assert basics
    (mode,) = basics.modes
    speeds = {order: mode.frequency / order * 30.0 / np.pi for order in (2, 4, 6, 8, 10)}
    inside = {order: speed for order, speed in speeds.items() if first <= speed <= 1800}
    assert len(inside) == (1 if first == 1200 else 2)
    said = " ".join(torsion_check_text(basics).split())
    assert f"{words} " in said
    assert ("critical speeds lie" in said) == (len(inside) > 1)
    shown = re.findall(r"order (\d+) at ([\d.]+) rpm \(shaft", said)
    assert {int(order): float(rpm) for order, rpm in shown} == pytest.approx(inside, rel=1e-3)
    assert f"within {first} to 1800 rpm:" in said


@pytest.mark.parametrize(
    ("first", "last", "inside"),
    [(0.5, 0.99, False), (0.5, 1.01, True), (0.99, 1.5, True), (1.01, 1.5, False)],
)
def test_unstable_motion_outside_the_speeds_of_the_scene_is_named_as_such(
    first: float, last: float, inside: bool
) -> None:
    """Of order 2, between the natural frequency times 1 - bend²/4 and times 1 + bend²/4."""
    text = (EXAMPLES / "rig_torsion.toml").read_text(encoding="utf-8")
    basics = torsion_basics(Scene.parse(text))
    assert basics
    (mode,), half = basics.modes, np.radians(25.0) ** 2 / 4.0
    edge = mode.frequency * 30.0 / np.pi * (1.0 - half if first == 0.5 else 1.0 + half)
    ends = f"from = {first * edge}, to = {last * edge}"
    basics = torsion_basics(Scene.parse(text.replace("from = 500, to = 4000", ends)))
    assert basics
    said = " ".join(torsion_check_text(basics).split())
    assert "permits unstable motion near 3030 rpm" in said
    assert (" rpm, outside the speed range, because" in said) != inside


@pytest.mark.parametrize("ratio", [0.02, 0.005])
def test_a_permitted_bend_is_the_largest_within_the_rule(ratio: float) -> None:
    """With hundredths of a degree: ``tan²(bend/2)`` is at most the damping ratio."""
    text = f"""\
    [driveline]
    bends_deg = [20]
    [torsion]
    inertias_kgm2 = [0, [0, 0.05]]
    stiffnesses_Nm_per_rad = [8000, "rigid"]
    speed_rpm = {{from = 3000, to = 4500, steps = 40}}
    damping_ratio = {ratio}
    """
    said = " ".join(torsion_text(needed_torsion(Scene.parse(text))).split())
    found = re.search(r"bend behind shaft 0 of at most (\S+)° instead of 20°", said)
    assert found
    bend = float(found[1])
    assert np.tan(np.radians(bend) / 2.0) ** 2 <= ratio
    assert np.tan(np.radians(bend + 0.01) / 2.0) ** 2 > ratio


def test_one_compliant_shaft_needs_no_shares() -> None:
    shown = blocks(torsion_text(needed("rig_torsion")))["Natural frequencies"]
    (words,) = shown.values()
    assert re.fullmatch(r"shaft \d, damping ratio [\d.]+", words)

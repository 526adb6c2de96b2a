"""The printed answer of torsional vibration read back: each line against the library."""

from __future__ import annotations

import itertools
import re
from dataclasses import replace

import numpy as np
import pytest

from cardan.app.answers.answer import Answer
from cardan.app.answers.data import data_of
from cardan.app.answers.table import PARTS
from cardan.app.answers.torsion.figures import Missing, TorsionFigures, Unstable, torsion_figures
from cardan.app.answers.torsion.text import brief as torsion_check_text
from cardan.app.scene import Scene
from pages import EXAMPLES, first_number, near

torsion_text = PARTS["torsion"].text


def needed(name: str) -> TorsionFigures:
    found = torsion_figures(Scene.load(EXAMPLES / f"{name}.toml"))
    assert found
    return found


def table(found: TorsionFigures, heading: str) -> list[list[str]]:
    """Return the cells below a heading of the printed answer."""
    lines = torsion_text(found).partition(f"\n  {heading}\n")[2].splitlines()
    shown = itertools.takewhile(lambda line: line.startswith("    "), lines)
    return [re.split(r"\s{2,}", line.strip()) for line in shown]


def test_natural_frequencies_and_critical_speeds() -> None:
    found = needed("truck_torsion")
    system = found.torsion.system
    modes, hertz, ratios, twisted, *shares = table(found, "Natural frequencies")
    assert modes == ["mode 0", "mode 1"]
    frequencies = [first_number(cell) for cell in hertz[1:]]
    for place, mode in enumerate(found.modes):
        assert hertz[place + 1].endswith(" Hz")
        assert frequencies[place] == pytest.approx(mode.frequency / (2.0 * np.pi), rel=1e-3)
        assert float(ratios[place + 1]) == pytest.approx(mode.damping_ratio, rel=1e-3)
        assert int(twisted[place + 1]) == max(mode.shares, key=lambda each: each.share).shaft
        for (label, *cells), each in zip(shares, mode.shares, strict=True):
            assert label == f"share in the energy of twist of shaft {each.shaft}"
            assert first_number(cells[place]) == pytest.approx(100.0 * each.share, abs=0.05)
    orders = []
    heads, *criticals = table(found, "Critical speeds")
    assert heads == [
        *("mode", "order", "drive speed", "shaft twisted most", "in the range", "amplitude")
    ]
    for number, order, speed, shaft, inside, amplitude in criticals:
        orders.append((int(order), int(number)))
        rpm = first_number(speed)
        assert rpm == pytest.approx(60.0 * frequencies[int(number)] / int(order), rel=2e-3)
        assert (inside == "yes") == (500.0 <= rpm <= 3000.0)
        steady = system.steady(
            60.0 * frequencies[int(number)] / int(order) * np.pi / 30.0, [int(order)]
        )
        sizes = np.abs(steady.torque_orders[:, 0])
        place = list(system.compliant).index(int(shaft))
        assert first_number(amplitude) == pytest.approx(sizes[place], rel=0.02)
    assert orders == [(order, number) for order in (2, 4) for number in (0, 1)]


def test_largest_torques() -> None:
    found = needed("truck_torsion")
    shafts, speeds, *ends = table(found, "Largest torques")
    assert [label for label, *_ in ends] == ["least torque", "largest torque", "mean torque"]
    system = found.torsion.system
    speed = np.linspace(500.0, 3000.0, 2501)
    steady = system.steady(speed * np.pi / 30.0)
    for place, shaft in enumerate(shafts):
        assert shaft == f"shaft {system.compliant[place]}"
        rpm, least, most, mean = (first_number(row[place + 1]) for row in (speeds, *ends))
        at = int(np.argmax(np.fmax(steady.torque_max, -steady.torque_min)[place]))
        assert rpm == pytest.approx(speed[at], abs=1.0)
        assert least == pytest.approx(steady.torque_min[place, at], rel=2e-3)
        assert most == pytest.approx(steady.torque_max[place, at], rel=2e-3)
        assert mean == pytest.approx(steady.torque_mean[place, at], rel=5e-3)
    sentences = " ".join(torsion_text(found).rpartition("\n\n")[2].split())
    largest = max(found.largest, key=lambda torque: torque.size)
    ratio = largest.size / abs(largest.mean)
    (said,) = re.findall(r"in shaft 1 at \d+ rpm, ([\d.]+) times the mean torque there", sentences)
    assert ratio == near(said)
    # The worst critical speed of the table, with the amplitude that stands there.
    amplitudes = {
        first_number(amplitude): speed
        for _, _, speed, _, inside, amplitude in table(found, "Critical speeds")[1:]
        if inside == "yes"
    }
    worst = max(amplitudes)
    assert f"The range contains {len(amplitudes)} critical speeds; the worst is" in sentences
    assert f"at {amplitudes[worst]}, where this order of the torque of shaft 2 is" in sentences
    assert f"is ±{worst:.0f} N m." in sentences


def test_unstable_speeds() -> None:
    """Their ends and those of the range are those of the scene, in print and in data."""
    found = needed("rig_torsion")
    assert found.unstable
    shown, data = table(found, "Unstable motion")[1:], data_of(found)
    assert data["speed_range"] == pytest.approx({"start_rpm": 500.0, "stop_rpm": 4000.0})
    for row, region, part in zip(shown, found.unstable, data["unstable"], strict=True):
        rpm = [speed * 30.0 / np.pi for speed in (region.start, region.stop)]
        assert [part["start_rpm"], part["stop_rpm"]] == pytest.approx(rpm)
        assert [*rpm, region.multiplier] == [*map(near, row)]


def test_the_worst_critical_speed_is_one_whose_motion_is_known() -> None:
    found = needed("rig_torsion")
    inside = [one for one in found.critical_speeds if one.inside and one.order % 2 == 0]
    assert len(inside) == 3
    worst = max(inside, key=lambda one: one.amplitude or 0.0)
    known = [replace(one, amplitude=None) if one is worst else one for one in found.critical_speeds]
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
    both = replace(found, unstable=(region,), missing=(missing,))
    assert table(both, "Unstable motion")[1] == ["2000 rpm", "2100 rpm", "1.50"]
    words = ["600 rpm", "700 rpm", "it does not settle"]
    assert table(both, "Speeds without a periodic motion")[1] == words
    said = torsion_text(both)
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
    basics = Answer(Scene.parse(text.replace("from = 500, to = 4000", ends)))["torsion"]
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
    basics = Answer(Scene.parse(text))["torsion"]
    assert basics
    (mode,), half = basics.modes, np.radians(25.0) ** 2 / 4.0
    edge = mode.frequency * 30.0 / np.pi * (1.0 - half if first == 0.5 else 1.0 + half)
    ends = f"from = {first * edge}, to = {last * edge}"
    basics = Answer(Scene.parse(text.replace("from = 500, to = 4000", ends)))["torsion"]
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
    said = " ".join(torsion_text(torsion_figures(Scene.parse(text))).split())
    found = re.search(r"bend behind shaft 0 of at most (\S+)° instead of 20°", said)
    assert found
    bend = float(found[1])
    assert np.tan(np.radians(bend) / 2.0) ** 2 <= ratio
    assert np.tan(np.radians(bend + 0.01) / 2.0) ** 2 > ratio

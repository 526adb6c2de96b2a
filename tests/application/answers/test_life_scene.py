"""Joints, duty cycles and tubes of a scene: values, errors, sentences and pictures."""

from __future__ import annotations

import math
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
import pytest
from matplotlib import pyplot
from matplotlib.patches import Rectangle

import cardan
import scripts
from cardan.app.answers.answer import Answer
from cardan.app.answers.life.figures import LifeFigures, needed
from cardan.app.answers.life.text import sentences
from cardan.app.answers.rows import Judged
from cardan.app.answers.table import PARTS
from cardan.app.answers.tubes import TubeFigures
from cardan.app.plots import plot_heat, plot_part, plot_pin_load, plot_sizes, save
from cardan.app.scene import Scene

TWO = "[driveline]\nbends_deg = [12, 18]\nphases_deg = [90]\n"


LOAD = "[load]\nspeed_rpm = 1500\noutput_torque_Nm = 400\n"


JOINTS = "[joints]\nrating_Nm = 1200\nfriction = 0.01\npin_radius_mm = 8\narm_mm = 32\n"


SCENE = f"{TWO}{LOAD}{JOINTS}"


TUBE = "[tubes]\nouter_diameter_mm = 90\nwall_mm = 3\nlength_mm = 1500\n"


UP_DOWN = "[states]\nbends_deg.0 = [1, 2]\nnames = ['up', 'down']\n"


TABLE = "size,rating_Nm,max_bend_deg\nsmall,500,30\nlarge,2000,30\nmiddle,1000,30\nflat,9000,10\n"


RPM_DEG = 30.0 / math.pi * 180.0 / math.pi


def beyond(scene: Scene) -> list[str]:
    """The figures of joints and tubes that are beyond their limits."""
    found = [each.entry.path for each in Answer(scene).of_verdict("beyond")]
    return [path for path in found if not path.startswith("limits.")]


def figures(text: str, folder: Path | str = ".") -> LifeFigures:
    return needed(Answer(Scene.parse(text, folder=folder)))


def life_of(text: str) -> LifeFigures:
    found = Answer(Scene.parse(text))["life"]
    assert isinstance(found, LifeFigures)
    return found


def tubes_of(text: str) -> tuple[TubeFigures, ...]:
    found = Answer(Scene.parse(text))["tubes"]
    assert isinstance(found, tuple)
    return found


def value(judged: Judged | None) -> float:
    assert judged is not None
    assert judged.value is not None
    return judged.value


def verdict(judged: Judged | None) -> str:
    return "" if judged is None else judged.verdict


def law(bend_deg: float, rpm: float, torque: float, rating: float) -> float:
    return 1.5e6 / (max(bend_deg, 3.0) * rpm) * math.pow(rating / torque, 10.0 / 3.0)


def headline(found: LifeFigures) -> str:
    return next(sentences(found))


def test_a_load_is_a_duty_cycle_of_one_step() -> None:
    found = figures(SCENE)
    line = cardan.Driveline.from_bends([12, 18], phases=[90], degrees=True)
    load = cardan.Load(output_torque=400.0, speed_rpm=1500.0)
    own = line.life(load, rating=1200.0)
    heat = line.losses(load, friction=0.01, pin_radius=0.008, arm=0.032)
    assert [value(joint.hours) for joint in found.joints] == pytest.approx(own.hours, rel=1e-12)
    assert [joint.catalogue for joint in found.joints] == pytest.approx(own.catalogue, rel=1e-12)
    assert [value(joint.heat) for joint in found.joints] == pytest.approx(heat.power)
    assert value(found.heat) == pytest.approx(heat.power.sum())
    assert value(found.efficiency) == pytest.approx(heat.efficiency, rel=1e-12)
    assert found.first is found.joints[1]
    assert found.hours == value(found.joints[1].hours)
    assert headline(found) == f"L10 life {own.hours[1]:.0f} h; joint 1 fails first."


def test_a_duty_cycle_adds_damage_and_heat() -> None:
    """By the law of the catalogue and the closed form of the loss, for a single joint."""
    cycle = "hours = [30, 10]\nspeed_rpm = [1500, 900]\noutput_torque_Nm = [400, 600]\n"
    single = f"[driveline]\nbends_deg = 18\n{JOINTS}[life]\nbends_deg = [18, 4]\n{cycle}"
    (joint,) = figures(single).joints
    lives = law(18, 1500, 400, 1200), law(4, 900, 600, 1200)
    damage = np.array([0.75 / lives[0], 0.25 / lives[1]])
    assert joint.catalogue == pytest.approx(1.0 / damage.sum(), rel=1e-12)
    line = cardan.Driveline.from_bends([[18], [4]], degrees=True)
    load = cardan.Load(output_torque=[400.0, 600.0], speed_rpm=[1500.0, 900.0])
    shares = [0.75, 0.25] / line.life(load, rating=1200.0).hours[0]
    assert joint.damage is not None
    assert joint.damage.state == "step 0"
    assert [*joint.damage.each.values()] == pytest.approx(shares / sum(shares), rel=1e-12)
    assert sum(joint.damage.each.values()) == pytest.approx(1.0)
    beta = [mpmath.radians(bend) for bend in (18, 4)]
    brackets = [float(mpmath.atanh(mpmath.sin(x)) + mpmath.tan(x)) for x in beta]
    power = np.array([400.0 * 1500.0, 600.0 * 900.0]) * math.pi / 30.0
    heat = 0.01 * 8.0 / 32.0 * 2.0 / math.pi * np.array(brackets) * power
    assert value(joint.heat) == pytest.approx(heat @ [0.75, 0.25], rel=1e-12)
    assert joint.largest_heat is not None
    assert joint.largest_heat.state == "step 0"
    assert [*joint.largest_heat.each.values()] == pytest.approx(heat)
    efficiency = 1.0 - heat @ [0.75, 0.25] / (power @ [0.75, 0.25])
    assert value(figures(single).efficiency) == pytest.approx(efficiency, rel=1e-12)


def test_a_step_that_brakes_loses_as_much_as_one_that_drives() -> None:
    def of(torques: str) -> LifeFigures:
        return figures(f"{SCENE}[life]\nhours = [1, 3]\noutput_torque_Nm = {torques}\n")

    driving, braking = of("[400, 200]"), of("[400, -200]")
    assert value(braking.heat) == pytest.approx(value(driving.heat))
    assert value(braking.efficiency) == pytest.approx(value(driving.efficiency))


def test_idling_takes_time_and_heat_of_the_seals() -> None:
    cycle = "hours = [1, 3]\noutput_torque_Nm = [400, 0]\n"
    found = figures(f"{SCENE}seal_torque_Nm = 0.5\n[life]\n{cycle}")
    always = figures(f"{SCENE}seal_torque_Nm = 0.5\n")
    for joint, loaded, bend in zip(found.joints, always.joints, (12.0, 18.0), strict=True):
        assert value(joint.hours) == pytest.approx(4.0 * value(loaded.hours))
        assert joint.damage is not None
        assert joint.damage.each == pytest.approx({"step 0": 1.0, "step 1": 0.0})
        idle = 0.5 * 8.0 * math.radians(bend) * 1500.0 / 60.0
        assert value(joint.heat) == pytest.approx(0.25 * value(loaded.heat) + 0.75 * idle)
    power = 0.25 * 400.0 * 1500.0 * math.pi / 30.0
    assert value(found.efficiency) == pytest.approx(1.0 - value(found.heat) / power)


def test_the_smallest_size_that_reaches_the_target_is_chosen(tmp_path: Path) -> None:
    (tmp_path / "sizes.csv").write_text(TABLE)
    joints = "[joints]\nsizes = 'sizes.csv'\nsize = 'small'\n"
    text = f"{TWO}{LOAD}{joints}[life]\ntarget_h = "
    line = cardan.Driveline.from_bends([12, 18], phases=[90], degrees=True)
    load = cardan.Load(output_torque=400.0, speed_rpm=1500.0)
    hours = {
        name: float(np.min(line.life(load, rating=rating).hours))
        for name, rating in (("small", 500), ("middle", 1000), ("large", 2000), ("flat", 9000))
    }
    found = figures(f"{text}{hours['middle'] * 0.99}\n", tmp_path)
    assert [one.size for one in found.sizes] == ["small", "middle", "large", "flat"]
    for one in found.sizes:
        assert one.hours == pytest.approx(hours[one.size], rel=1e-12)
        assert one.fits is (one.size != "flat")
    assert found.chosen == "middle"
    assert verdict(found.joints[1].hours) == "beyond"
    assert headline(found).endswith(
        f"joint 1 fails first; size middle would give {hours['middle']:.0f} h."
    )
    assert figures(f"{text}{hours['middle'] * 1.01}\n", tmp_path).chosen == "large"
    # The largest size does not permit the bends.
    none = figures(f"{text}{hours['large'] * 1.01}\n", tmp_path)
    assert none.chosen is None
    assert "no size of the table reaches" in headline(none)
    enough = figures(f"{text}{hours['small'] * 0.99}\n", tmp_path)
    assert enough.chosen is None
    assert [verdict(joint.hours) for joint in enough.joints] == ["within", "within"]
    # Without a target the next larger one is named.
    plain = figures(f"{TWO}{LOAD}{joints}", tmp_path)
    assert plain.chosen == "middle"
    only = figures(f"{TWO}{LOAD}[joints]\nsizes = 'sizes.csv'\n[life]\ntarget_h = 1\n", tmp_path)
    assert only.joints == ()
    assert headline(only) == f"Size small would give {hours['small']:.0f} h."


def test_a_driveline_that_turns_backwards_is_judged_by_the_size_of_its_speed() -> None:
    backwards = LOAD.replace("1500", "-1500")
    found = figures(f"{TWO}{backwards}[joints]\nmax_speed_bend_rpm_deg = 20000\n")
    assert [RPM_DEG * value(joint.speed_bend) for joint in found.joints] == pytest.approx(
        [18000.0, 27000.0]
    )
    assert [verdict(joint.speed_bend) for joint in found.joints] == ["within", "beyond"]


def test_small_swings_and_plain_bearings_are_named() -> None:
    text = SCENE.replace("12, 18", "2, 18")
    assert any(
        words.startswith("The needles of joint 0 swing by less than 3°")
        for words in sentences(figures(text))
    )
    plain = figures(f"{text}bearing = ['plain', 'needle']\n")
    assert plain.joints[0].hours is None
    assert not plain.joints[0].small_swing
    assert plain.first is plain.joints[1]
    assert "does not apply to the plain bearings of joint 0." in " ".join(sentences(plain))
    assert plain.heat == figures(text).heat


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (f"{TWO}{LOAD}[joints]\n", "[joints] is empty; give at least one key"),
        (f"{TWO}{LOAD}[joints]\nsize = 'a'\n", "size needs sizes, which is missing"),
        (SCENE.replace("= 1200", "= [1200]"), "rating_Nm has length 1; it needs 2, one per joint"),
        (SCENE.replace("= 1200", "= 0"), "rating_Nm is 0; it must be positive"),
        (SCENE.replace("arm_mm = 32\n", ""), "arm_mm is missing for joint 0, which has friction"),
        (f"{SCENE}bearing = 'ball'\n", "bearing is 'ball'"),
        (f"{SCENE}[life]\nhours = [1, 2]\nspeed_rpm = [1, 2, 3]\n", "speed_rpm has length 3"),
        (f"{SCENE}[life]\nhours = []\n", "hours has length 0; it needs 1, at least one step"),
        (f"{SCENE}[life]\noutput_torque_Nm = [0, 0]\n", "output_torque_Nm is 0 in all steps"),
        (f"{SCENE}[life]\nbends_deg = [[1, 2, 3]]\n", "bends_deg[0] has length 3; it needs 2"),
        (f"{SCENE}[life]\nbends_deg = [95]\n", "bends_deg[0] is 95 deg; a bend must lie"),
        (f"{SCENE}[life]\nstates = ['a']\n", "the scene has no section [states]"),
        (
            f"{SCENE}{UP_DOWN}[life]\nstates = ['ub']\n",
            "states[0] is 'ub'; known are up, down",
        ),
        (f"{TWO}[life]\nspeed_rpm = 5\n", "output_torque_Nm is missing here and in [load]"),
        (f"{TWO}[life]\noutput_torque_Nm = 5\n", "speed_rpm is missing here and in [load]"),
        (
            f"[driveline]\npoints_mm = [[0,0,0],[1,0,0],[2,1,0]]\n{LOAD}[life]\nbends_deg = [3]\n",
            "bends_deg needs bends_deg in [driveline], which gives points_mm; use states",
        ),
        (f"{TWO}[tubes]\nouter_diameter_mm = 90\n", "length_mm is missing; give it, or points_mm"),
        (f"{TWO}{TUBE}shafts = [3]\n", "shafts[0] is 3; there are 3, counted from 0"),
        (TWO + TUBE.replace("= 90", "= [90, 80]"), "outer_diameter_mm has length 2; it needs 1"),
        (TWO + TUBE.replace("wall_mm = 3", "wall_mm = 46"), "wall_mm is 46 mm; a wall is at most"),
    ],
)
def test_what_is_refused(text: str, said: str) -> None:
    with pytest.raises(ValueError, match=re.escape(said)) as caught:
        Scene.parse(text)
    assert re.match(r"scene(, line \d+)?: \[(joints|life|tubes)\]", str(caught.value)), caught.value


@pytest.mark.parametrize(
    ("table", "said"),
    [
        ("", "is empty; it needs a row of headings"),
        ("size,rating_Nm\n", "has headings but no sizes"),
        ("size\na\n", "line 1: no column 'rating_Nm', which each size needs"),
        ("size,rating_Nm,colour\na,1,red\n", "line 1: unknown column 'colour'"),
        ("size,rating_Nm,rating_Nm\na,1,2\n", "line 1: column 'rating_Nm' appears twice"),
        ("size,rating_Nm\na,1\n\nb,-5\n", "line 4: rating_Nm is -5.0; it must be positive"),
        ("size,rating_Nm\na,many\n", "line 2: rating_Nm is 'many'; it must be a number"),
        ("size,rating_Nm\na,1,2\n", "line 2: 3 cells; the header has 2"),
        ("size,rating_Nm\n,1\n", "line 2: size is empty"),
        ("size,rating_Nm\na,1\na,2\n", "line 3: size is 'a' again; name each size once"),
        ("size,rating_Nm\nb,1\n", "size is 'a'; "),
        ('size,rating_Nm\n"a,1\n', "not a CSV file in UTF-8"),
    ],
)
def test_wrong_tables_are_refused(table: str, said: str, tmp_path: Path) -> None:
    (tmp_path / "sizes.csv").write_text(table)
    text = f"{TWO}{LOAD}[joints]\nsizes = 'sizes.csv'\nsize = 'a'\n"
    with pytest.raises(ValueError, match=re.escape(said)) as caught:
        Scene.parse(text, folder=tmp_path)
    assert re.match(r"scene, line \d+: \[joints\]", str(caught.value)), caught.value


def test_a_table_with_commas_in_its_numbers(tmp_path: Path) -> None:
    table = "size;rating_Nm;friction;pin_radius_mm;arm_mm;bearing\n1480;1200,5;0,01;8;32;plain\n"
    (tmp_path / "sizes.csv").write_text(table, encoding="utf-8-sig")
    text = f"{TWO}[joints]\nsizes = 'sizes.csv'\nsize = ['1480', '1480']\nfriction = 0.02\n"
    joints = Scene.parse(text, folder=tmp_path).sizes
    assert joints is not None
    assert (joints.table[0].rating, joints.table[0].bearing) == (1200.5, "plain")
    assert joints.table[0].pin_radius == pytest.approx(0.008)
    # What the scene says goes before what the table says.
    assert joints.each == (replace(joints.table[0], friction=0.02),) * 2


def test_life_needs_joints_and_a_load() -> None:
    with pytest.raises(ValueError, match=r"section \[joints\] is missing"):
        figures(f"{TWO}{LOAD}")
    with pytest.raises(ValueError, match="a life needs a speed and a torque"):
        figures(f"{TWO}{JOINTS}")
    assert Answer(Scene.parse(f"{TWO}{LOAD}"))["life"] is None


def test_tubes_are_those_of_the_library() -> None:
    scene = Scene.parse(f"{SCENE}{TUBE}permitted_stress_MPa = 12\nleast_margin = 5\n")
    (found,) = Answer(scene)["tubes"]
    own = cardan.tube(0.09, 0.003, length=1.5)
    assert found.shaft == 1
    assert found.stiffness == pytest.approx(own.stiffness)
    assert value(found.critical) == pytest.approx(own.critical_speed)
    assert value(found.margin) == pytest.approx(own.critical_speed / (50.0 * math.pi))
    # The torque of the middle shaft behind which one joint of 18 degrees delivers 400 N m.
    torque = 400.0 / math.cos(math.radians(18.0))
    assert value(found.torque) == pytest.approx(torque, rel=1e-9)
    assert value(found.stress) == pytest.approx(own.shear_stress(torque))
    assert (verdict(found.stress), verdict(found.margin)) == ("beyond", "beyond")
    assert len(list(PARTS["tubes"].sentences((found,)))) == 2
    assert Answer(scene).verdict == "beyond"
    mild = f"{SCENE}{TUBE}permitted_stress_MPa = 13\nleast_margin = 4\n"
    (found,) = tubes_of(mild)
    assert (verdict(found.stress), verdict(found.margin)) == ("within", "within")
    assert PARTS["tubes"].sentences((found,)) == [
        "The tubes are within the limits that the scene gives."
    ]
    (turning,) = tubes_of(f"{TWO}[load]\nspeed_rpm = 900\n{TUBE}")
    assert turning.torque is turning.stress is None
    assert value(turning.speed) == pytest.approx(30.0 * math.pi)
    (backwards,) = tubes_of(f"{TWO}[load]\nspeed_rpm = -900\n{TUBE}")
    assert value(backwards.margin) == value(turning.margin)
    (alone,) = tubes_of(f"{TWO}{TUBE}")
    assert alone.stress is alone.margin is None
    said = (
        "The tubes are not judged: the scene gives no permitted_stress_MPa, least_margin or "
        "resonance_margin."
    )
    assert PARTS["tubes"].sentences((alone,)) == [said]


def test_tubes_bear_the_load_in_every_state_and_step() -> None:
    """The largest torque is that of the step or of the state with the larger one, by name."""
    text = (
        "[driveline]\nbends_deg = [18, 18]\n[load]\nspeed_rpm = 1500\noutput_torque_Nm = 400\n"
        '[states]\nbends_deg.1 = [18, 24]\nnames = ["straight", "turn"]\n'
        f"{TUBE}permitted_stress_MPa = 12\n"
    )
    duty = (
        "[life]\nhours = [2, 1]\nspeed_rpm = [1600, 900]\noutput_torque_Nm = {}\n"
        'names = ["haul", "lift"]\n'
    )
    of_states = 'states = ["turn", "straight"]\n'
    for section, torque, bend, place, rpm in (
        ("", 400.0, 24.0, "turn", 1500.0),
        (duty.format("[50, 60]"), 400.0, 24.0, "turn", 1600.0),
        # Without a state of its own each step is possible in each.
        (duty.format("[50, 900]"), 900.0, 24.0, "turn", 1600.0),
        (duty.format("[50, 900]") + of_states, 900.0, 18.0, "lift", 1600.0),
    ):
        (found,) = tubes_of(text + section)
        assert value(found.torque) == pytest.approx(torque / math.cos(math.radians(bend)), rel=1e-9)
        assert found.torque is not None
        assert found.torque.state == place
        assert value(found.speed) == pytest.approx(rpm * math.pi / 30.0)
    (same,) = tubes_of(text.replace("[18, 24]", "[18, 18]"))
    assert same.torque is not None
    assert same.torque.state == ""
    assert same.torque.each == pytest.approx(
        dict.fromkeys(["straight", "turn"], value(same.torque))
    )


@pytest.mark.parametrize(
    ("rpm", "half", "quarter", "said"),
    [
        # (pi/1.5 m)² sqrt(206 GPa (45² + 42²) mm²/(4 * 7850 kg/m³)) = 691.59 rad/s = 6604.2 rpm.
        (3000.0, 9.149, 81.70, "within 9.15% of half its critical bending speed (3302 of 6604"),
        (1500.0, 54.57, 9.149, ""),
        (2200.0, 33.38, 33.25, ""),
        (6604.0, 99.99, 299.99, ""),
    ],
)
def test_bent_joints_can_shake_a_tube_at_half_its_critical_speed(
    rpm: float, half: float, quarter: float, said: str
) -> None:
    load = f"[load]\nspeed_rpm = {rpm}\n"
    (steady,) = tubes_of(f"{TWO}{load}{TUBE}")
    (found,) = tubes_of(f"{TWO}{load}inertias_kgm2 = [0, 0, 1]\n{TUBE}")
    # Thoma's fourth order is that of accelerated inertias.
    assert steady.quarter is None
    assert value(steady.half) == value(found.half)
    assert 100.0 * value(found.half) == pytest.approx(half, abs=6e-3)
    assert 100.0 * value(found.quarter) == pytest.approx(quarter, abs=6e-3)
    near = [each for each in PARTS["tubes"].sentences((found,)) if "Thoma" in each]
    assert len(near) == (1 if said else 0)
    assert all(each.startswith(f"Shaft 1 turns {said}") for each in near)


def test_straight_joints_shake_no_tube() -> None:
    """The moments of the joints at either end of a shaft count, and of no other."""
    load = "[load]\nspeed_rpm = 3302\n"
    for bends, known in (("[0, 0, 8]", False), ("[0, 5, 0]", True), ("[5, 0, 8]", True)):
        (found,) = tubes_of(
            f"[driveline]\nbends_deg = {bends}\n{load}{TUBE}shafts = [1]\nresonance_margin = 0.1\n"
        )
        assert (value(found.half) < 1e-3) == known
        assert verdict(found.half) == ("beyond" if known else "within")
        assert any("Thoma" in each for each in PARTS["tubes"].sentences((found,))) == known


def test_life_is_judged_in_every_driveline_of_a_study() -> None:
    """The shortest life counts, in the driveline with the highest speed."""
    speeds = "[study]\nspeed_rpm = [350, 1000, 540]\n"
    text = f"{TWO}[load]\noutput_torque_Nm = 400\n{JOINTS}"
    line = cardan.Driveline.from_bends([12, 18], phases=[90], degrees=True)
    load = cardan.Load(output_torque=400.0, speed_rpm=1000.0)
    own = line.life(load, rating=1200.0)
    target = int(own.hours[1])
    found = life_of(f"{text}heat_W = 30\n[life]\ntarget_h = {target}\n{speeds}")
    assert [value(joint.hours) for joint in found.joints] == pytest.approx(own.hours, rel=1e-12)
    assert found.joints[1].hours is not None
    assert found.joints[1].hours.at == {"speed_rpm": 1000.0}
    assert verdict(found.joints[1].hours) == "within"
    for speed in (350.0, 1000.0, 540.0):
        one = cardan.Load(output_torque=400.0, speed_rpm=speed)
        alone = line.life(one, rating=1200.0)
        listed = found.joints[1].hours.each[f"speed_rpm = {speed:g}"]
        assert listed == pytest.approx(float(alone.hours[1]), rel=1e-12)
    assert headline(found) == (
        f"L10 life {own.hours[1]:.0f} h at speed_rpm = 1000, at least the required {target} h; "
        "joint 1 fails first."
    )
    heat = line.losses(load, friction=0.01, pin_radius=0.008, arm=0.032).power
    assert [value(joint.heat) for joint in found.joints] == pytest.approx(heat)
    assert [verdict(joint.heat) for joint in found.joints] == ["within", "beyond"]
    assert value(found.heat) == pytest.approx(sum(heat))
    assert found.steps[0].speed == pytest.approx(load.speed)
    short = Answer(Scene.parse(f"{text}[life]\ntarget_h = {target + 1}\n{speeds}"))
    assert short.verdict == "beyond"
    assert [each.name for each in short.of_verdict("beyond")][-1] == "L10 life of joint 1"


def test_life_and_type_are_judged_in_every_state() -> None:
    states = "[states]\nbends_deg.0 = [5, 20]\nnames = ['low', 'high']\n"
    scene = f"{SCENE}max_bend_deg = [15, 25]\n"
    line = cardan.Driveline.from_bends([20, 18], phases=[90], degrees=True)
    load = cardan.Load(output_torque=400.0, speed_rpm=1500.0)
    hours = line.life(load, rating=1200.0).hours
    found = life_of(f"{scene}{states}")
    bend, lasting = found.joints[0].bend, found.joints[0].hours
    assert bend is not None
    assert lasting is not None
    assert (bend.verdict, bend.state) == ("beyond", "high")
    assert [math.degrees(each) for each in bend.each.values()] == pytest.approx([5.0, 20.0])
    assert value(lasting) == pytest.approx(hours[0], rel=1e-12)
    assert lasting.state == "high"
    assert [*lasting.each] == ["low", "high"]
    # The type has its limit in states that the duty cycle does not name.
    found = life_of(f"{scene}{states}[life]\nstates = ['low', 'low']\n")
    bend = found.joints[0].bend
    assert bend is not None
    assert (bend.verdict, bend.state) == ("beyond", "high")
    low = cardan.Driveline.from_bends([5, 18], phases=[90], degrees=True)
    assert value(found.joints[0].hours) == pytest.approx(low.life(load, rating=1200.0).hours[0])
    # What is drawn is no state.
    drawn = life_of(f"{scene.replace('15, 25', '11, 25')}{states.replace('20', '10')}")
    assert verdict(drawn.joints[0].bend) == "within"


def test_steps_have_speed_and_torque_of_their_states() -> None:
    """The drawing gives only a torque; the states all give their speed."""
    states = (
        "[states]\nbends_deg.0 = [12, 6]\nspeed_rpm = [1500, 600]\n"
        "output_torque_Nm = [300, 800]\nnames = ['high', 'low']\n"
    )
    scene = f"{TWO}[load]\noutput_torque_Nm = 400\n{JOINTS}{states}"
    found = life_of(f"{scene}[life]\nstates = ['low', 'high']\nhours = [3, 1]\n")
    line = cardan.Driveline.from_bends([[6, 18], [12, 18]], phases=[90], degrees=True)
    load = cardan.Load(output_torque=[800.0, 300.0], speed_rpm=[600.0, 1500.0])
    own = line.life(load, rating=1200.0, shares=[0.75, 0.25])
    assert [value(joint.hours) for joint in found.joints] == pytest.approx(own.hours, rel=1e-12)
    assert [step.step for step in found.steps] == ["low", "high"]
    assert [step.torque for step in found.steps] == [800.0, 300.0]
    # The duty cycle goes before the states.
    given = life_of(f"{scene}[life]\nstates = ['low']\noutput_torque_Nm = 500\n")
    assert given.steps[0].torque == 500.0
    assert given.steps[0].speed == pytest.approx(20.0 * math.pi)
    alone = life_of(scene)
    own = line.life(load, rating=1200.0)
    assert value(alone.joints[1].hours) == pytest.approx(own.hours[1].min(), rel=1e-12)


def recorded(tmp_path: Path, columns: str, rows: str) -> str:
    (tmp_path / "run.csv").write_text(f"{columns}\n{rows}")
    return "[angles]\nfile = 'run.csv'\nangle_column_deg = 'a'\n"


def test_recorded_speeds_and_bends_are_judged(tmp_path: Path) -> None:
    rows = "".join(f"{12 * i},{0.002 * i},{5 + (i == 7) * 15}\n" for i in range(40))
    angles = recorded(tmp_path, "a,t,b", rows)
    limits = "[joints]\nmax_bend_deg = 15\nmax_speed_bend_rpm_deg = 6000\n"
    tube = f"{TUBE}permitted_stress_MPa = 9\nleast_margin = 7\n"
    text = f"[driveline]\nbends_deg = 18\n{angles}time_column_s = 't'\n{limits}"
    load = "[load]\noutput_torque_Nm = 400\n"
    answer = Answer(Scene.parse(f"{text}{load}{tube}shafts = [0]\n", folder=tmp_path))
    (joint,), (shaft,) = answer["life"].joints, answer["tubes"]
    assert (verdict(joint.bend), verdict(joint.speed_bend)) == ("beyond", "beyond")
    # 12 degrees in 2 ms.
    assert value(shaft.speed) == pytest.approx(1000.0 * math.pi / 30.0, rel=1e-6)
    assert RPM_DEG * value(joint.speed_bend) == pytest.approx(18000.0, rel=1e-6)
    assert (verdict(shaft.stress), verdict(shaft.margin)) == ("beyond", "beyond")
    angle = np.radians(12.0 * np.arange(40))
    line = cardan.Driveline.from_bends(18, degrees=True)
    torque = line.evaluate(angle, "torque", shafts=0, load=cardan.Load(output_torque=400.0)).torque
    assert value(shaft.torque) == pytest.approx(np.abs(torque).max(), rel=1e-12)
    # Bends that were recorded, without a speed.
    bends = Scene.parse(f"{angles}bend_columns_deg = ['b']\n{limits}", folder=tmp_path)
    (joint,) = Answer(bends)["life"].joints
    assert math.degrees(value(joint.bend)) == pytest.approx(20.0)
    assert verdict(joint.bend) == "beyond"
    assert joint.speed_bend is not None
    assert (joint.speed_bend.verdict, joint.speed_bend.why) == (
        "not judged",
        "the scene gives no speed",
    )


def test_a_type_is_judged_without_speed_and_torque() -> None:
    found = life_of(f"{TWO}[joints]\nmax_bend_deg = 15\nmax_speed_bend_rpm_deg = 1\nheat_W = 1\n")
    assert [verdict(joint.bend) for joint in found.joints] == ["within", "beyond"]
    assert [verdict(joint.speed_bend) for joint in found.joints] == ["not judged"] * 2
    said = list(sentences(found))
    assert said[0] == "No life is known: it needs a speed and a torque."
    assert "Joint 1 is bent by 18.00°; its type permits 15°." in said
    why = "The speed times bend of joint 0 is not judged: the scene gives no speed."
    assert why in said
    assert "The heat of joint 0 is not judged:" in " ".join(said)
    turning = life_of(f"{TWO}[load]\nspeed_rpm = 1500\n[joints]\nmax_speed_bend_rpm_deg = 20000\n")
    assert [verdict(joint.speed_bend) for joint in turning.joints] == ["within", "beyond"]


@pytest.mark.parametrize(
    ("joints", "why"),
    [
        ("[joints]\nmax_bend_deg = 30\n", "no rating is given"),
        ("[joints]\nrating_Nm = 9\nbearing = 'plain'\n", "plain bearings have no rated life"),
        ("", "the scene gives no rating of the joints"),
    ],
)
def test_a_target_that_cannot_be_judged_says_why(joints: str, why: str) -> None:
    answer = Answer(Scene.parse(f"{TWO}{LOAD}{joints}[life]\ntarget_h = 2e6\n"))
    (target,) = {each.value.why for each in answer.judged if each.entry.row.limit[1:5] == "life"}
    assert target == why
    assert headline(answer["life"]) == f"The required life of 2000000 h is not judged: {why}."


def test_a_target_that_no_size_reaches_is_beyond(tmp_path: Path) -> None:
    (tmp_path / "sizes.csv").write_text(TABLE)
    text = f"{TWO}{LOAD}[joints]\nsizes = 'sizes.csv'\n[life]\ntarget_h = 2e6\n"
    answer = Answer(Scene.parse(text, folder=tmp_path))
    assert [each.name for each in answer.of_verdict("beyond")][-1] == "life with the best size"
    best = answer["life"].of_sizes
    assert best.value == next(one.hours for one in answer["life"].sizes if one.size == "large")
    assert "No size of the table reaches 2000000 h" in headline(answer["life"])
    assert scripts.run("check", write(tmp_path, text)).exit_code == 1


def write(folder: Path, text: str) -> str:
    path = folder / "scene.toml"
    path.write_text(text)
    return str(path)


def test_a_tube_is_as_long_as_in_its_longest_state() -> None:
    points = "[driveline]\npoints_mm = [[0,0,0],[300,0,0],[1500,0,0],[1800,0,0]]\n"
    load = "[load]\nspeed_rpm = 3000\n"
    states = "[states]\npoints_mm.2-3.y = [0, -400, 100]\nnames = ['up', 'down', 'mid']\n"
    text = f"{points}{load}[tubes]\nouter_diameter_mm = 60\nleast_margin = 1.3\n"
    (found,) = tubes_of(f"{text}{states}")
    longest = cardan.tube(0.06, length=math.hypot(1.2, 0.4)).critical_speed
    assert value(found.critical) == pytest.approx(longest, rel=1e-12)
    assert found.margin is not None
    assert found.margin.state == "down"
    assert value(found.margin) == pytest.approx(longest / (100.0 * math.pi))
    (study,) = tubes_of(f"{text}[study]\npoints_mm.2-3.y = [0, -400, 100]\n")
    assert value(study.critical) == pytest.approx(longest, rel=1e-12)
    assert study.margin is not None
    assert study.margin.at == {"points_mm.2-3.y": -400.0}


CONVEYOR = Path(__file__).parents[3] / "examples" / "conveyor.toml"


LINE = cardan.Driveline.from_bends([12, 18], phases=[90], degrees=True)


PICTURES_LOAD = cardan.Load(output_torque=400.0, speed_rpm=1500.0)


BEARINGS: dict[str, Any] = {"friction": [0.01, 0.02], "pin_radius": 0.008, "arm": 0.032}


def _found(scene: Scene) -> LifeFigures:
    return needed(Answer(scene))


@pytest.fixture(autouse=True)
def _closed() -> Iterator[None]:
    yield
    pyplot.close("all")


def test_pins_bear_the_moment_of_their_joint() -> None:
    axes = plot_pin_load(LINE, PICTURES_LOAD)
    curves = axes.get_lines()
    assert [curve.get_label() for curve in curves] == ["joint 0", "joint 1"]
    for joint, curve in enumerate(curves):
        angle, drawn = np.asarray(curve.get_xdata()), np.asarray(curve.get_ydata())
        assert (angle[0], angle[-1]) == (0.0, pytest.approx(360.0))
        own = LINE.evaluate(np.radians(angle), "moment", joints=joint, load=PICTURES_LOAD).moment
        assert drawn == pytest.approx(np.linalg.norm(own, axis=-1), rel=1e-12)


def test_heat_grows_with_the_speed() -> None:
    axes = plot_heat(LINE, PICTURES_LOAD, **BEARINGS)
    for joint, curve in enumerate(axes.get_lines()):
        rpm, drawn = np.asarray(curve.get_xdata()), np.asarray(curve.get_ydata())
        assert drawn[0] == rpm[0] == 0.0
        assert rpm[-1] == pytest.approx(1500.0)
        fraction = LINE.losses(cardan.Load(output_torque=400.0), **BEARINGS).fraction[joint]
        assert drawn == pytest.approx(fraction * 400.0 * rpm * math.pi / 30.0, rel=1e-12)


def test_bars_are_lives() -> None:
    found = _found(Scene.load(CONVEYOR))
    axes = plot_sizes(found)
    bars = [bar for bar in axes.patches if isinstance(bar, Rectangle)]
    assert [bar.get_width() for bar in bars] == [one.hours for one in found.sizes]
    names = [tick.get_text() for tick in axes.get_yticklabels()]
    assert names == [one.size for one in found.sizes]
    assert [bool(bar.get_hatch()) for bar in bars] == [not one.fits for one in found.sizes]
    (line,) = axes.get_lines()
    assert list(np.asarray(line.get_xdata())) == [8000.0, 8000.0]
    texts = [text.get_text() for text in axes.texts]
    assert texts == [f"{one.hours:.0f} h" for one in found.sizes]


def test_a_picture_has_what_the_scene_gives(tmp_path: Path) -> None:
    full = tmp_path / "full.svg"
    save(plot_part(Scene.load(CONVEYOR), "life"), full)
    text = full.read_text(encoding="utf-8")
    save(plot_part(Scene.load(CONVEYOR), "life"), tmp_path / "again.svg")
    assert (tmp_path / "again.svg").read_bytes() == full.read_bytes()
    plain = Scene.parse(
        "[driveline]\nbends_deg = [12, 18]\n[load]\nspeed_rpm = 9\noutput_torque_Nm = 7\n"
        "[joints]\nrating_Nm = 1200\n"
    )
    less = tmp_path / "less.svg"
    save(plot_part(plain, "life"), less)
    assert len(less.read_bytes()) < len(text)


def test_pins_and_heat_are_those_of_the_worst_steps() -> None:
    """The joints are hottest in the start and wear most when loaded, which lasts longer."""
    text = CONVEYOR.read_text(encoding="utf-8")
    text = text.replace("hours = [50, 45, 5]", "hours = [70, 29, 1]").replace(", 600]", ", 1500]")
    scene = Scene.parse(text, str(CONVEYOR), folder=CONVEYOR.parent)
    figure = plot_part(scene, "life")
    _, pins, heat = figure.axes
    angle, moment = np.asarray(pins.get_lines()[1].get_xydata()).T
    loaded = cardan.Load(output_torque=400.0, speed_rpm=1500.0)
    own = LINE.evaluate(np.radians(angle), "moment", joints=1, load=loaded).moment
    assert moment == pytest.approx(np.linalg.norm(own, axis=-1), rel=1e-12)
    start = cardan.Load(output_torque=700.0, speed_rpm=1500.0)
    watts = LINE.losses(start, friction=0.01, pin_radius=0.008, arm=0.032).power
    for joint, line in enumerate(heat.get_lines()):
        assert np.asarray(line.get_xydata())[-1] == pytest.approx([1500.0, watts[joint]])
    assert heat.get_xlim() == pytest.approx((0.0, 1500.0))


def test_what_cannot_be_drawn_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"line has shape \(2,\); this picture shows one"):
        plot_pin_load(cardan.Driveline.from_bends([[0.1], [0.2]]), PICTURES_LOAD)
    with pytest.raises(ValueError, match="load has no speed; heat is drawn up to it"):
        plot_heat(LINE, cardan.Load(output_torque=1.0), **BEARINGS)
    scene = Scene.parse(
        "[driveline]\nbends_deg = 9\n[load]\nspeed_rpm = 9\noutput_torque_Nm = 7\n"
        "[joints]\nrating_Nm = 1200\n"
    )
    with pytest.raises(ValueError, match="no table of sizes whose life is known"):
        plot_sizes(_found(scene))
    with pytest.raises(ValueError, match="must end in"):
        save(plot_part(scene, "life"), tmp_path / "life.txt")
    assert list(tmp_path.iterdir()) == []

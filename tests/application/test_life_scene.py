"""Joints, duty cycles and tubes of a scene: values, errors, answers, sentences and the page."""

from __future__ import annotations

import json
import math
import re
from dataclasses import replace
from pathlib import Path

import jsonschema
import mpmath
import numpy as np
import pytest
from click.testing import CliRunner, Result

import cardan
from cardan.app.answers.answer import Answer
from cardan.app.answers.life.data import life_data
from cardan.app.answers.life.figures import LifeFigures, life_figures, needed_life
from cardan.app.answers.life.text import life_sentences
from cardan.app.answers.limits.data import check_data
from cardan.app.answers.schema import answers_schema
from cardan.app.answers.tubes.figures import data as tubes_data
from cardan.app.answers.tubes.text import tube_lines, tube_sentences
from cardan.app.command import commands
from cardan.app.report import write_report
from cardan.app.scene import Scene
from example_scenes import Answers, example

ROOT = Path(__file__).parents[2]
CONVEYOR = ROOT / "examples" / "conveyor.toml"
ANSWERS = jsonschema.Draft202012Validator(answers_schema())

TWO = "[driveline]\nbends_deg = [12, 18]\nphases_deg = [90]\n"
LOAD = "[load]\nspeed_rpm = 1500\noutput_torque_Nm = 400\n"
JOINTS = "[joints]\nrating_Nm = 1200\nfriction = 0.01\npin_radius_mm = 8\narm_mm = 32\n"
SCENE = f"{TWO}{LOAD}{JOINTS}"
TUBE = "[tubes]\nouter_diameter_mm = 90\nwall_mm = 3\nlength_mm = 1500\n"
UP_DOWN = "[states]\nbends_deg.0 = [1, 2]\nnames = ['up', 'down']\n"
TABLE = "size,rating_Nm,max_bend_deg\nsmall,500,30\nlarge,2000,30\nmiddle,1000,30\nflat,9000,10\n"


def beyond(scene: Scene) -> list[str]:
    """The figures of joints and tubes that are beyond their limits."""
    found = [each.entry.path for each in Answer(scene).of_verdict("beyond")]
    return [path for path in found if not path.startswith("limits.")]


def figures(text: str, folder: Path | str = ".") -> LifeFigures:
    return needed_life(Scene.parse(text, folder=folder))


def command(*arguments: str | Path) -> Result:
    return CliRunner().invoke(commands(), [*map(str, arguments)])


def law(bend_deg: float, rpm: float, torque: float, rating: float) -> float:
    return 1.5e6 / (max(bend_deg, 3.0) * rpm) * math.pow(rating / torque, 10.0 / 3.0)


def headline(found: LifeFigures) -> str:
    return next(life_sentences(found))


def test_a_load_is_a_duty_cycle_of_one_step() -> None:
    found = figures(SCENE)
    line = cardan.Driveline.from_bends([12, 18], phases=[90], degrees=True)
    load = cardan.Load(output_torque=400.0, speed_rpm=1500.0)
    own = line.life(load, rating=1200.0)
    heat = line.losses(load, friction=0.01, pin_radius=0.008, arm=0.032)
    assert [joint.hours for joint in found.joints] == pytest.approx(own.hours, rel=1e-12)
    assert [joint.catalogue for joint in found.joints] == pytest.approx(own.catalogue, rel=1e-12)
    assert [joint.heat.mean for joint in found.joints if joint.heat] == pytest.approx(heat.power)
    assert found.efficiency == pytest.approx(heat.efficiency, rel=1e-12)
    assert found.decisive is found.joints[1]
    assert headline(found) == f"L10h {own.hours[1]:.0f} h; joint 1 decides."


def test_a_duty_cycle_adds_damage_and_heat() -> None:
    """By the law of the catalogue and the closed form of the loss, for a single joint."""
    cycle = "hours = [30, 10]\nspeed_rpm = [1500, 900]\noutput_torque_Nm = [400, 600]\n"
    single = f"[driveline]\nbends_deg = 18\n{JOINTS}[life]\nbends_deg = [18, 4]\n{cycle}"
    (joint,) = figures(single).joints
    lives = law(18, 1500, 400, 1200), law(4, 900, 600, 1200)
    damage = np.array([0.75 / lives[0], 0.25 / lives[1]])
    assert joint.catalogue == pytest.approx(1.0 / damage.sum(), rel=1e-12)
    assert sum(joint.damage) == pytest.approx(1.0)
    beta = [mpmath.radians(bend) for bend in (18, 4)]
    brackets = [float(mpmath.atanh(mpmath.sin(x)) + mpmath.tan(x)) for x in beta]
    power = np.array([400.0 * 1500.0, 600.0 * 900.0]) * math.pi / 30.0
    heat = 0.01 * 8.0 / 32.0 * 2.0 / math.pi * np.array(brackets) * power
    assert joint.heat is not None
    assert joint.heat.mean == pytest.approx(heat @ [0.75, 0.25], rel=1e-12)
    assert joint.heat.largest == pytest.approx(heat[0])
    assert joint.heat.step == 0
    efficiency = 1.0 - heat @ [0.75, 0.25] / (power @ [0.75, 0.25])
    assert figures(single).efficiency == pytest.approx(efficiency, rel=1e-12)


def test_a_step_that_brakes_loses_as_much_as_one_that_drives() -> None:
    def of(torques: str) -> LifeFigures:
        return figures(f"{SCENE}[life]\nhours = [1, 3]\noutput_torque_Nm = {torques}\n")

    driving, braking = of("[400, 200]"), of("[400, -200]")
    assert braking.heat == pytest.approx(driving.heat)
    assert braking.efficiency == pytest.approx(driving.efficiency)


def test_idling_takes_time_and_heat_of_the_seals() -> None:
    cycle = "hours = [1, 3]\noutput_torque_Nm = [400, 0]\n"
    found = figures(f"{SCENE}seal_torque_Nm = 0.5\n[life]\n{cycle}")
    always = figures(f"{SCENE}seal_torque_Nm = 0.5\n")
    for joint, loaded, bend in zip(found.joints, always.joints, (12.0, 18.0), strict=True):
        assert joint.hours is not None
        assert loaded.hours is not None
        assert joint.hours == pytest.approx(4.0 * loaded.hours)
        assert joint.damage == pytest.approx((1.0, 0.0))
        assert joint.heat is not None
        assert loaded.heat is not None
        idle = 0.5 * 8.0 * math.radians(bend) * 1500.0 / 60.0
        assert joint.heat.mean == pytest.approx(0.25 * loaded.heat.mean + 0.75 * idle)
    assert found.efficiency is not None
    assert found.heat is not None
    power = 0.25 * 400.0 * 1500.0 * math.pi / 30.0
    assert found.efficiency == pytest.approx(1.0 - found.heat / power)


def test_steps_can_be_states() -> None:
    states = "[states]\nbends_deg.0 = [12, 6]\nnames = ['high', 'low']\n"
    cycle = "[life]\nstates = ['low', 'high', 'low']\nhours = [1, 2, 3]\n"
    by_states = figures(f"{SCENE}{states}{cycle}")
    by_bends = figures(
        f"{SCENE}[life]\nbends_deg = [[6, 18], [12, 18], [6, 18]]\nhours = [1, 2, 3]\n"
    )
    for one, other in zip(by_states.joints, by_bends.joints, strict=True):
        assert one.hours == pytest.approx(other.hours, rel=1e-12)


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
    assert [one.size.name for one in found.sizes] == ["small", "middle", "large", "flat"]
    for one in found.sizes:
        assert one.hours == pytest.approx(hours[one.size.name], rel=1e-12)
        assert one.fits is (one.size.name != "flat")
    assert found.chosen is found.sizes[1]
    assert not found.passes
    assert headline(found).endswith(
        f"joint 1 decides; size middle would give {hours['middle']:.0f} h."
    )
    assert figures(f"{text}{hours['middle'] * 1.01}\n", tmp_path).chosen == found.sizes[2]
    # The largest size does not permit the bends.
    none = figures(f"{text}{hours['large'] * 1.01}\n", tmp_path)
    assert none.chosen is None
    assert "no size of the table reaches" in headline(none)
    enough = figures(f"{text}{hours['small'] * 0.99}\n", tmp_path)
    assert enough.chosen is None
    assert enough.passes
    # Without a target the next larger one is named.
    plain = figures(f"{TWO}{LOAD}{joints}", tmp_path)
    assert plain.chosen is not None
    assert plain.chosen.size.name == "middle"
    only = figures(f"{TWO}{LOAD}[joints]\nsizes = 'sizes.csv'\n[life]\ntarget_h = 1\n", tmp_path)
    assert only.joints == ()
    assert headline(only) == f"Size small would give {hours['small']:.0f} h."


def test_limits_of_a_type_are_judged() -> None:
    limits = "max_bend_deg = [15, 15]\nmax_speed_bend_rpm_deg = [18000, 27000]\n"
    found = figures(f"{SCENE}{limits}")
    assert [joint.bend.passes for joint in found.joints] == [True, False]
    assert [joint.speed_bend.value for joint in found.joints] == [18000.0, 27000.0]
    assert [joint.speed_bend.passes for joint in found.joints] == [True, True]
    assert "Joint 1 is bent by 18°; its type permits 15°." in list(life_sentences(found))
    fast = figures(f"{SCENE}{limits}[life]\nspeed_rpm = [10, 1501]\n")
    assert [joint.speed_bend.passes for joint in fast.joints] == [False, False]
    assert beyond(Scene.parse(f"{SCENE}{limits}"))
    assert beyond(Scene.parse(SCENE)) == []


def test_a_driveline_that_turns_backwards_is_judged_by_the_size_of_its_speed() -> None:
    backwards = LOAD.replace("1500", "-1500")
    found = figures(f"{TWO}{backwards}[joints]\nmax_speed_bend_rpm_deg = 20000\n")
    assert [joint.speed_bend.value for joint in found.joints] == [18000.0, 27000.0]
    assert [joint.speed_bend.passes for joint in found.joints] == [True, False]


def test_small_swings_and_plain_bearings_are_named() -> None:
    text = SCENE.replace("12, 18", "2, 18")
    assert any(
        words.startswith("The needles of joint 0 swing by less than 3°")
        for words in life_sentences(figures(text))
    )
    plain = figures(f"{text}bearing = ['plain', 'needle']\n")
    assert plain.joints[0].hours is None
    assert not plain.joints[0].small_swing
    assert plain.decisive is plain.joints[1]
    assert "does not apply to the plain bearings of joint 0." in " ".join(life_sentences(plain))
    assert plain.heat == figures(text).heat


@pytest.mark.parametrize("name", ["conveyor.toml", "ship-shaft.toml"])
def test_the_torques_leave_out_the_vibration(name: str) -> None:
    """The answer says so where the scene gives shafts as torsion springs."""
    scene = Scene.load(example(name))
    found = life_figures(scene)
    assert found
    said = " ".join(life_sentences(found))
    assert ("the vibration of [torsion] is not in them" in said) == (scene.torsion is not None)


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
    joints = Scene.parse(text, folder=tmp_path).service.joints
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
    assert life_figures(Scene.parse(f"{TWO}{JOINTS}")) is None


def test_tubes_are_those_of_the_library() -> None:
    scene = Scene.parse(f"{SCENE}{TUBE}permitted_stress_MPa = 12\nleast_margin = 5\n")
    (found,) = Answer(scene)["tubes"]
    own = cardan.tube(0.09, 0.003, length=1.5)
    assert found.shaft == 1
    assert found.stiffness == pytest.approx(own.stiffness)
    assert found.critical_rpm == pytest.approx(own.critical_speed * 30.0 / math.pi)
    assert found.margin == pytest.approx(found.critical_rpm / 1500.0)
    # The torque of the middle shaft behind which one joint of 18 degrees delivers 400 N m.
    assert found.torque is not None
    assert found.torque == pytest.approx(400.0 / math.cos(math.radians(18.0)), rel=1e-9)
    assert found.stress == pytest.approx(own.shear_stress(found.torque))
    assert (found.stress_passes, found.margin_passes) == (False, False)
    assert len(list(tube_sentences([found]))) == 2
    assert beyond(scene)
    mild = f"{SCENE}{TUBE}permitted_stress_MPa = 13\nleast_margin = 4\n"
    assert Answer(Scene.parse(mild))["tubes"][0].passes
    assert beyond(Scene.parse(mild)) == []
    assert list(tube_sentences(Answer(Scene.parse(mild))["tubes"])) == []
    turning = Answer(Scene.parse(f"{TWO}[load]\nspeed_rpm = 900\n{TUBE}"))["tubes"][0]
    assert turning.torque is turning.stress is None
    assert turning.speed_rpm == pytest.approx(900.0)
    backwards = Answer(Scene.parse(f"{TWO}[load]\nspeed_rpm = -900\n{TUBE}"))["tubes"][0]
    assert backwards.margin == turning.margin
    alone = Answer(Scene.parse(f"{TWO}{TUBE}"))["tubes"][0]
    assert alone.stress is alone.margin is None
    assert alone.passes


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
    for section, torque, place, rpm in (
        ("", 400.0 / math.cos(math.radians(24.0)), "turn", 1500.0),
        (duty.format("[50, 60]"), 400.0 / math.cos(math.radians(24.0)), "turn", 1600.0),
        (duty.format("[50, 900]"), 900.0 / math.cos(math.radians(18.0)), "lift", 1600.0),
    ):
        (found,) = Answer(Scene.parse(text + section))["tubes"]
        assert found.torque == pytest.approx(torque, rel=1e-9)
        assert found.torque_in == place
        assert found.speed_rpm == pytest.approx(rpm)
        assert dict(tube_lines(found))["largest torque"].endswith(f" N m in {place}")
        (data,) = tubes_data((found,))
        assert (data["torque_Nm"], data["torque_in"]) == (found.torque, place)
    (same,) = Answer(Scene.parse(text.replace("[18, 24]", "[18, 18]")))["tubes"]
    assert same.torque_in == ""
    assert dict(tube_lines(same))["largest torque"].endswith(" N m")


def test_tubes_take_their_lengths_from_points() -> None:
    points = "[driveline]\npoints_mm = [[0,0,0],[300,0,0],[700,300,0],[1200,300,50]]\n"
    scene = Scene.parse(f"{points}[tubes]\nshafts = [0, 1]\nouter_diameter_mm = [60, 70]\n")
    found = Answer(scene)["tubes"]
    assert found[0].mass == pytest.approx(cardan.tube(0.06, length=0.3).mass)
    assert found[1].mass == pytest.approx(cardan.tube(0.07, length=0.5).mass)


def test_the_example_answers(tmp_path: Path) -> None:
    picture = tmp_path / "life.svg"
    done = command("life", CONVEYOR, "--output", picture)
    assert done.exit_code == 0, done.output
    scene = Scene.load(CONVEYOR)
    found = needed_life(scene)
    for part, each in Answer(scene).parts("life"):
        assert part.text(each) in done.output
    assert picture.read_text(encoding="utf-8").startswith("<?xml")
    data = json.loads(command("life", CONVEYOR, "--json").output)
    ANSWERS.validate(data)
    assert data == life_data(Answer(scene))
    assert data["chosen_size"] == "1550"
    assert data["steps"][0]["bends_deg"] == [12.0, 18.0]
    assert found.decisive is not None
    assert data["L10_h"] == found.decisive.hours
    checked = command("check", CONVEYOR)
    assert checked.exit_code == 1
    advice = "Choose size 1550 for the joints; their life is then 8772 h."
    assert f"- {advice}" in checked.output
    assert headline(found) in " ".join(checked.output.split())
    answer = json.loads(command("check", CONVEYOR, "--json").output)
    ANSWERS.validate(answer)
    assert answer["advice"][-1] == advice
    ANSWERS.validate(check_data(Answer(scene)))


def test_the_page_has_the_life(tmp_path: Path, answered: Answers) -> None:
    page = answered(CONVEYOR).page
    assert '<section id="life"' in page
    assert headline(needed_life(Scene.load(CONVEYOR))) in page
    tubes = tmp_path / "tubes.html"
    write_report(Scene.parse(f"{TWO}{TUBE}"), tubes)
    assert "The tubes are within the limits" in tubes.read_text(encoding="utf-8")
    write_report(Scene.parse(TWO), tubes)
    assert '<section id="life"' not in tubes.read_text(encoding="utf-8")

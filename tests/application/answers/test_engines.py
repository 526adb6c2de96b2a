"""Engines, propellers, couplings and motors in scenes: keys, errors, what a check judges."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest

import cardan
from cardan.app.answers.answer import Answer
from cardan.app.answers.data import data_of
from cardan.app.answers.printed import judged_text, quantity
from cardan.app.answers.rows import rows_of
from cardan.app.answers.schema import answer, check_data
from cardan.app.answers.table import PARTS
from cardan.app.answers.torsion.figures import (
    TorsionBasics,
    TorsionFigures,
    shape_text,
    torsion_figures,
)
from cardan.app.answers.torsion.text import torsion_advice
from cardan.app.report.live import live
from cardan.app.scene import Scene, SceneError
from cardan.app.scene.sections.torsion import HARMONIC, TORSION, TorsionCase
from engine_cases import ENGINE
from example_scenes import ANSWERS

RPM = np.pi / 30.0

# Beyond the resonance near 2083 rpm the torque that is needed falls with the speed.
MOTOR = """\
[driveline]
bends_deg = [20]
[torsion]
drive = "free"
inertias_kgm2 = [[0.3, 0], [0, 0.05]]
stiffnesses_Nm_per_rad = ["rigid", 8000]
dampings_Nms_per_rad = [0, 3]
load_torque_Nm = 30
speed_rpm = {from = 1400, to = 4000, steps = 27}
[torsion.motor]
speed_rpm = [1400, 3800]
torque_Nm = [95, 20]
"""


def case(text: str) -> TorsionCase:
    found = Scene.parse(text).torsion
    assert found is not None
    return found


def basics(text: str) -> TorsionBasics:
    found = Answer(Scene.parse(text))["torsion"]
    assert isinstance(found, TorsionBasics)
    return found


def figures(text: str) -> TorsionFigures:
    found = torsion_figures(Scene.parse(text))
    assert found is not None
    return found


def with_coupling(law: str) -> str:
    return ENGINE.replace("stiffness_Nm_per_rad = 3000\n", law + "\n")


def test_keys_are_the_arguments_of_the_library() -> None:
    given = case(ENGINE)
    one = [(0.5, 90, 60), (1.0, 70, 120), (1.5, 50, 90), (2.0, 20, 60), (3.0, 10, 20)]
    blades = cardan.TorqueHarmonic(2, "output", 3.0, 15 * np.cos(np.pi / 6), 15 * np.sin(np.pi / 6))
    own = cardan.TorsionalSystem(
        given.system.line,
        inertias=[[0.8, 0], [0.05, 0.01], [0, 0.15]],
        stiffnesses=[np.inf, 40000, np.inf],
        dampings=[8, 5, 0],
        load_damping=0.8,
        drive="free",
        harmonics=[*cardan.firing_harmonics(one, [1, 3, 2]), blades],
        couplings={0: cardan.Coupling(3000)},
    )
    speeds = np.array([800.0, 2000.0]) * RPM
    mine, theirs = given.system.steady(speeds), own.steady(speeds)
    assert mine.torque_max == pytest.approx(theirs.torque_max, rel=1e-9)
    assert given.orders == (1.5, 2.0, 3.0, 4.0)
    assert given.excited == (1.5, 2.0, 3.0, 4.0)
    listed = case(ENGINE.replace("speed_rpm = {", "orders = [1, 2.5]\nspeed_rpm = {"))
    assert listed.orders == (1.0, 1.5, 2.5, 3.0)
    assert listed.excited == (1.5, 3.0)
    assert case(ENGINE.replace("[[torsion.coupling]]", "[torsion.coupling]")).ratings.keys() == {0}


@pytest.mark.parametrize(
    ("law", "coupling"),
    [
        (
            "twist_deg = [0, 2, 4]\ntorque_Nm = [0, 50, 200]",
            cardan.Coupling(twist=np.radians([0, 2, 4]), torque=[0, 50, 200]),
        ),
        (
            "mean_torque_Nm = [0, 100]\nstiffness_by_mean_Nm_per_rad = [2000, 4000]\n"
            "relative_damping = 0.8",
            cardan.Coupling(
                mean_torque=[0, 100], stiffness_by_mean=[2000, 4000], loss_factor=0.4 / np.pi
            ),
        ),
        (
            'stiffness_Nm_per_rad = 5000\nplay_deg = 2\ndamper = "contact"',
            cardan.Coupling(5000, play=np.radians(2.0), contact_damping=True),
        ),
        ("stiffness_Nm_per_rad = 5000\nloss_factor = 0.2", cardan.Coupling(5000, loss_factor=0.2)),
    ],
)
def test_couplings(law: str, coupling: cardan.Coupling) -> None:
    found = case(with_coupling(law)).system.couplings[0]
    for name in ("play", "loss_factor", "contact_damping"):
        assert getattr(found, name) == pytest.approx(getattr(coupling, name))
    twists = np.array([-0.1, 0.001, 0.03, 0.06, 0.2])
    assert found.torque_at(twists) == pytest.approx(coupling.torque_at(twists))
    assert [found.stiffness_at(each) for each in (30.0, 80.0)] == pytest.approx(
        [coupling.stiffness_at(each) for each in (30.0, 80.0)]
    )


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('drive = "free"\n', "", "[torsion] drive is missing, and there is an inertia at the"),
        (
            'drive = "free"\n',
            'drive = "held"\ndrive_slope_Nms_per_rad = 1\n',
            '[torsion] drive_slope_Nms_per_rad needs drive = "free"; a drive that is held has its',
        ),
        (
            'drive = "free"\n',
            'drive = "free"\ndrive_slope_Nms_per_rad = -1\n',
            "drive_slope_Nms_per_rad is -1; the fall of the drive's torque with rising speed must",
        ),
        ('drive = "free"', 'drive = "fre"', "drive is 'fre'; did you mean 'free'?"),
        ('"propeller"]', '"propeller", "b"]', "names has length 4; it needs 3, one per shaft"),
        (
            "order = 3",
            "order = 1.1",
            "[torsion] harmonics have the orders [1.5, 3.0, 1.1], which with the joints' order 2",
        ),
        ("order = 3", "order = 0", "[[torsion.harmonic]][1] order is 0; an order must lie in (0"),
        ("order = 3", "ordr = 3", "[[torsion.harmonic]][1] unknown key 'ordr'; did you mean"),
        ("shaft = 2", "shaft = 9", "[[torsion.harmonic]][1] shaft is 9; there are 3, counted"),
        ("amplitude_Nm = 15\n", "", "[[torsion.harmonic]][1] amplitude_Nm is missing; or give"),
        ("sin_Nm = [60, 120,", "sin_Nm = [60,", "[[torsion.harmonic]][0] sin_Nm has length 4;"),
        ("[1, 3, 2]", "[1, 3, 1]", "[[torsion.harmonic]][0] firing_order[2] is 1 again"),
        (
            "[1, 3, 2]",
            "[1, 2, 3, 4, 5, 6, 7]",
            "order is 0.5, 1, 1.5, 2, 3; of 7 cylinders only multiples of 3.5 remain, all others",
        ),
        ("[1, 3, 2]", "[1, 3, 2]\nstrokes = 3", "[[torsion.harmonic]][0] strokes is 3; it must be"),
        ("order = [0.5, 1, 1.5, 2, 3]\n", "", "[[torsion.harmonic]][0] order is missing"),
        ("shaft = 0", "shaft = 1", "is 'coupling'; shaft 0 has no [[torsion.coupling]]"),
        ('"coupling"', "3000", 'is 3000.0; write "coupling", which [[torsion.coupling]] describes'),
        ("40000", '"coupling"', "is 'coupling'; shaft 1 has no [[torsion.coupling]]"),
        (
            "stiffness_Nm_per_rad = 3000",
            "twist_deg = [0, 1, 2]\ntorque_Nm = [0, 90, 80]",
            "torque_Nm[2] is 80; it must be above the value before, 90; the torque of a coupling "
            "rises with its twist",
        ),
        (
            "stiffness_Nm_per_rad = 3000",
            "twist_deg = [0, 2, 2]\ntorque_Nm = [0, 90, 100]",
            "[[torsion.coupling]][0] twist_deg[2] is 2; it must be above the value before, 2",
        ),
        (
            "stiffness_Nm_per_rad = 3000",
            "twist_deg = [0]\ntorque_Nm = [0]",
            "[[torsion.coupling]][0] twist_deg is [0]; a curve needs two points at least",
        ),
        (
            "stiffness_Nm_per_rad = 3000",
            "twist_deg = [0, 2]",
            "[[torsion.coupling]][0] twist_deg needs torque_Nm, which is missing",
        ),
        (
            "stiffness_Nm_per_rad = 3000",
            "twist_deg = [0, 2, 4]\ntorque_Nm = [0, 90, 100]\nloss_factor = 0.1",
            "[[torsion.coupling]][0] has a loss factor and a stiffness that varies with the twist",
        ),
        (
            "stiffness_Nm_per_rad = 3000",
            "stiffness_Nm_per_rad = 0",
            "[[torsion.coupling]][0] stiffness_Nm_per_rad is 0; a stiffness must lie in [0.001",
        ),
        (
            "stiffness_Nm_per_rad = 3000",
            "stiffness_Nm_per_rad = 9\nrated_torque_lbft = 3\nrated_torque_Nm = 4",
            "rated_torque_Nm and rated_torque_lbft are both given; give one of them",
        ),
        (
            "[[torsion.coupling]]",
            "[[torsion.coupling]]\nshaft = 0\nstiffness_Nm_per_rad = 9\n[[torsion.coupling]]",
            "[[torsion.coupling]][1] shaft is 0 again; a shaft has one coupling",
        ),
        ("[[torsion.coupling]]", "[torsion]\n[torsion.x]", "not TOML"),
    ],
)
def test_what_is_refused(old: str, new: str, said: str) -> None:
    assert ENGINE.count(old) == 1
    text = ENGINE.replace(old, new)
    with pytest.raises(SceneError) as caught:
        Scene.parse(text)
    assert said in str(caught.value)


def test_resonances_of_all_orders_are_judged() -> None:
    found = basics(ENGINE.replace("speed_rpm = {", "resonance_margin = 0.05\nspeed_rpm = {"))
    natural = found.torsion.system.natural_frequencies()[0]
    assert {(each.order, each.excited_by) for each in found.critical_speeds} == {
        (1.5, "torques"),
        (2.0, "joints"),
        (3.0, "torques"),
        (4.0, "joints"),
    }
    # Order 1.5 lies in the range; the joints' orders do not.
    inside = [(each.order, each.mode) for each in found.resonances]
    assert (1.5, 0) in inside
    assert found.margin.verdict == "beyond"
    above = ENGINE.replace("from = 700, to = 1300", "from = START, to = 1500")
    for share, verdict in ((1.04, "beyond"), (1.06, "within")):
        start = share * natural / 1.5 / RPM
        text = above.replace("START", f"{start:.9f}")
        judged = basics(text.replace("speed_rpm = {", "resonance_margin = 0.05\nspeed_rpm = {"))
        assert judged.margin.verdict == verdict
        assert judged.margin.value == pytest.approx(share - 1.0, rel=1e-6)


# Four cylinders, of which orders 4 and 6 hardly move the shafts.
FOUR = """
[driveline]
points_mm = [[0, 0, 0], [500, -15, 0], [1900, -130, 0], [2300, -150, 0]]
[load]
output_torque_Nm = 150
speed_rpm = 2000
[tubes]
shafts = [1]
outer_diameter_mm = 70
wall_mm = 2
[torsion]
drive = "free"
inertias_kgm2 = [[0.15, 0.03], 0, [0.02, 1.5]]
stiffnesses_Nm_per_rad = ["coupling", "tube", 6000]
dampings_Nms_per_rad = [0, 0.5, 1]
speed_rpm = {from = 900, to = 4500, steps = 181}
resonance_margin = 0.15
[[torsion.harmonic]]
order = [0.5, 1, 1.5, 2, 4, 6]
cos_Nm = [60, 50, 40, 25, 8, 3]
sin_Nm = [80, 90, 70, 50, 12, 3]
firing_order = [1, 3, 4, 2]
[[torsion.coupling]]
shaft = 0
stiffness_Nm_per_rad = 900
relative_damping = 0.6
"""


def test_the_help_says_where_gas_torques_come_from() -> None:
    said = HARMONIC.keys["cos_Nm"].meaning
    assert "tangential pressure, times the area of the piston and the radius of the crank" in said


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("", "", ": damping_ratio is that of the lowest mode, and viscous damping grows"),
        # Of the lowest mode it is what was given.
        ("[0, 0.01, 0.01]", "[0, 0.004, 0.004]", ""),
        ("damping_ratio = [0, 0.01, 0.01]", "dampings_Nms_per_rad = [0, 8, 2]", ""),
    ],
)
def test_a_damping_ratio_that_grows_with_the_frequency_is_said(
    old: str, new: str, said: str
) -> None:
    text = FOUR.replace("dampings_Nms_per_rad = [0, 0.5, 1]", "damping_ratio = [0, 0.01, 0.01]")
    found = figures(text.replace(old, new))
    ratio = found.modes[2].damping_ratio
    start = f"the damping ratio is {quantity(ratio, 'percent')} in mode 2 at 239 Hz{said}"
    for sentences in (torsion_advice(found), PARTS["torsion"].sentences(found)):
        several = [each for each in sentences if "he damping ratio is" in each]
        assert [each[:1].lower() + each[1 : len(start)] for each in several] == [start] * bool(said)
    # Twenty times the frequency is twenty times the ratio.
    assert (ratio > 0.1) == bool(said or "dampings" in new)
    # A loss factor is the same at every frequency.
    lossy = text.replace("0.01, 0.01", "0.001, 0.001").replace("damping = 0.6", "damping = 3")
    lossy = lossy.replace("Nm_per_rad = 900\n", "Nm_per_rad = 60000\n")
    assert basics(lossy).modes[2].damping_ratio > 0.1
    assert "he damping ratio is" not in " ".join(torsion_advice(basics(lossy)))
    help_text = TORSION.keys["damping_ratio"].meaning
    assert "1 % at 12 Hz is 20 % at 240 Hz" in help_text


@pytest.mark.parametrize(
    ("start", "rating", "above"),
    [
        (900, "", "the largest torque in the speed range"),
        (
            900,
            "largest_torque_Nm = 200\n",
            "the largest torque that the coupling can carry, 200",
        ),
        # Those of higher orders are small.
        (340, "", ""),
    ],
)
def test_a_resonance_below_the_speeds_that_is_large_is_said(
    start: float, rating: str, above: str
) -> None:
    text = FOUR.replace("from = 900", f"from = {start}")
    found = figures(text + rating)
    system = found.torsion.system
    speed = system.natural_frequencies()[0] / 2.0
    size = abs(system.steady(speed, 2.0).torque_orders[0, 0])
    largest = max(each.size for each in found.largest)
    assert (size > largest) == (start == 900)
    said = (
        f"he drive passes {quantity(speed, 'rpm')} (order 2) whenever it starts: in a steady "
        f"state there this order of the torque of shaft 0 is ±{quantity(float(size), 'Nm')}, above "
        f"{above}"
    )
    for each in (torsion_advice(found), PARTS["torsion"].sentences(found)):
        assert " ".join(each).count(said) == bool(above)
    if above and not rating:
        assert f"{above}, {quantity(largest, 'Nm')};" in " ".join(torsion_advice(found))


def test_critical_speeds_say_what_excites_them_and_why_no_amplitude_is_known() -> None:
    mixed = FOUR.replace("[0.5, 1, 1.5, 2, 4, 6]", "[0.5, 1, 1.5, 2, 3, 6]")
    mixed = mixed.replace("firing_order = [1, 3, 4, 2]\n", "")
    found = figures(mixed.replace("resonance_margin", "orders = [4, 5]\nresonance_margin"))
    by = {each.order: each.excited_by for each in found.critical_speeds}
    assert by == {
        **{0.5: "torques", 1.0: "torques", 1.5: "torques", 3.0: "torques"},
        **{2.0: "both", 6.0: "both", 4.0: "joints", 5.0: "nothing"},
    }
    text = PARTS["torsion"].text(found)
    assert "in the range    amplitude  excited by\n" in text
    assert "no amplitude" not in text
    slowest = min(found.critical_speeds, key=lambda each: each.speed)
    unknown = tuple(
        replace(each, amplitude=None) if each == slowest else each for each in found.critical_speeds
    )
    said = PARTS["torsion"].sentences(replace(found, critical_speeds=unknown))
    where = f"{quantity(slowest.speed, 'rpm')} (order {slowest.order:g})"
    assert f"At {where} no periodic motion was found, so the table has no amplitude." in said


def test_a_resonance_that_moves_no_torque_does_not_count() -> None:
    found = basics(FOUR)
    assert {each.order: each.negligible for each in found.resonances} == {
        2.0: False,
        4.0: True,
        6.0: True,
    }
    assert found.margin.value == 0.0
    row = next(row for name, row, _ in rows_of(TorsionBasics) if name == "margin")
    assert judged_text(found.margin, row) == (
        "within the speed range, at 1669 rpm (order 2); at least 15%"
    )
    near = replace(found.margin, value=0.05)
    assert judged_text(near, row) == "5.00% at 1669 rpm (order 2), 10.00% below the limit of 15%"
    said = [*torsion_advice(found)]
    assert said[0].startswith("a critical speed lies within 900 to 4500 rpm: order 2 at 1669 rpm")
    assert said[1].startswith("order 4 at 3585 rpm with ±1.24 N m in shaft 1 and order 6 at 2390")
    assert "below 1% of the mean torque of each shaft" in said[1]
    # Every shaft has so little of it, and the distance is that of order 2.
    system = found.torsion.system
    for each in found.resonances:
        steady = system.steady(each.speed, each.order)
        share = np.max(np.abs(steady.torque_orders[:, 0]) / np.abs(steady.torque_mean))
        assert (share < 0.01) == each.negligible
    above = basics(FOUR.replace("from = 900", "from = 2000"))
    speed = next(each.speed for each in found.resonances if each.order == 2.0)
    assert above.margin.value == pytest.approx(2000.0 * RPM / speed - 1.0)
    assert above.margin.verdict == "within"


def test_a_tube_bears_the_torque_of_its_vibration() -> None:
    """Without vibration the stress is 10.6 MPa, which is permitted."""
    for permitted, verdict in ((17.0, "beyond"), (18.0, "within")):
        text = FOUR.replace("wall_mm = 2", f"wall_mm = 2\npermitted_stress_MPa = {permitted}")
        answers = Answer(Scene.parse(text))
        (tube,) = answers["tubes"]
        largest = next(each for each in figures(text).largest if each.shaft == 1)
        assert tube.vibrating.value == pytest.approx(largest.size, rel=1e-12)
        assert tube.vibrating.state == "at 1662 rpm"
        ratio = tube.vibrating.value / tube.torque.value
        assert tube.vibrating_stress.value == pytest.approx(ratio * tube.stress.value)
        assert (tube.stress.verdict, tube.vibrating_stress.verdict) == ("within", verdict)
        said = " ".join(PARTS["tubes"].text(answers["tubes"], brief=True).split())
        beyond = "The shear stress in the tube of shaft 1 with vibration is 17.5 MPa at 1662 rpm,"
        assert (beyond in said) == (verdict == "beyond")
    # A machine does not vibrate.
    fast = text.replace("wall_mm = 2", "wall_mm = 2\nleast_margin = 1.5").replace(
        "= 2000", "= 4500"
    )
    assert Answer(Scene.parse(fast))["moves"]
    for move in Answer(Scene.parse(fast))["moves"]:
        assert "shear stress with vibration of the tube of shaft 1" in move.untried
    # Without a search nothing is known of it.
    assert Answer(Scene.parse(text.partition("[torsion]")[0]))["tubes"][0].vibrating is None


@pytest.mark.parametrize(
    ("old", "new"),
    [
        # Ten times the torque of order 6, and a shaft without mean torque.
        ("8, 3]", "8, 30]"),
        ("output_torque_Nm = 150", "output_torque_Nm = 0"),
        # Hardly any damping.
        ("= [0, 0.5, 1]", "= [0, 0.01, 0.01]"),
    ],
)
def test_a_resonance_that_moves_torques_counts(old: str, new: str) -> None:
    assert old in FOUR
    found = basics(FOUR.replace(old, new).replace("from = 900", "from = 2300"))
    (met,) = (each for each in found.resonances if each.order == 6.0)
    assert not met.negligible
    assert found.margin.verdict == "beyond"


def test_a_page_judges_no_margin_anew_that_leaves_resonances_out() -> None:
    """Other bends excite other torques."""
    for text, is_live in ((FOUR, False), (FOUR.replace("8, 3]", "80, 30]"), True)):
        found = live(Answer(Scene.parse(text)))
        assert found is not None
        kinds = {each["kind"] for each in found["data"]["figures"]}
        others = {each["name"] for each in found["data"]["others"]}
        name = "distance of the nearest critical speed of the shafts"
        assert ("resonance" in kinds, name in others) == (is_live, not is_live)


def test_a_check_that_searches_says_how_large_each_resonance_is() -> None:
    found = basics(ENGINE)
    said = next(each for each in torsion_advice(found) if "critical speed" in each)
    assert found.search
    assert found.resonances
    for each in found.resonances:
        steady = found.torsion.system.steady(each.speed, each.order)
        size = float(abs(steady.torque_orders[found.torsion.system.compliant.index(each.shaft), 0]))
        assert f") with ±{quantity(size, 'Nm')} in shaft {each.shaft}" in said
    assert "'cardan torsion'" not in said
    # Without a search the command says it.
    text = ENGINE[: ENGINE.index("[[torsion")].replace("coupling", "")
    plain = basics(text.replace('"free"', '"held"').replace('"", 40000', "3000, 40000"))
    assert plain.search is None
    assert "±" not in "".join(torsion_advice(plain))


def test_torques_of_a_coupling_are_judged() -> None:
    ratings = "rated_torque_Nm = 300\nvibratory_torque_Nm = 100\nlargest_torque_Nm = 900\n"
    scene = Scene.parse(ENGINE + ratings)
    found = Answer(scene)
    (coupling,) = found["torsion"].couplings
    assert scene.torsion
    system, speeds = scene.torsion.system, np.linspace(700.0, 1300.0, 601) * RPM
    steady = system.steady(speeds, [1.5, 2, 3, 4])
    assert coupling.mean.value == pytest.approx(steady.torque_mean[0].max(), rel=1e-6)
    largest = np.maximum(steady.torque_max[0], -steady.torque_min[0])
    assert coupling.largest.value == pytest.approx(largest.max(), rel=1e-4)
    assert coupling.largest_speed == pytest.approx(speeds[largest.argmax()], rel=1e-3)
    # Of order 1.5, by its frequency above 10 Hz.
    factor = np.sqrt(np.maximum(1.5 * speeds / (2.0 * np.pi) / 10.0, 1.0))
    vibratory = 0.5 * (steady.torque_max - steady.torque_min)[0] * factor
    assert np.abs(steady.torque_orders[0]).argmax(axis=-1).max() == 0
    assert coupling.vibratory.value == pytest.approx(vibratory.max(), rel=1e-4)
    verdicts = [each.verdict for each in (coupling.mean, coupling.vibratory, coupling.largest)]
    assert verdicts == ["within", "beyond", "within"]
    assert coupling.factor == pytest.approx(100.0 / coupling.vibratory.value, rel=1e-9)
    assert found.verdict == "beyond"
    avoided, *_ = found["torsion"].avoided
    over = speeds[vibratory > 100.0]
    assert avoided.start == pytest.approx(over[0], rel=2e-3)
    assert avoided.stop == pytest.approx(over[-1], rel=5e-3)
    said = " ".join(torsion_advice(found["torsion"]))
    assert re.search(r"avoid \d+ to \d+ rpm: the vibratory torque in the coupling of shaft 0", said)
    ANSWERS.validate(check_data(found))
    bare = Answer(Scene.parse(ENGINE))
    names = [each.name for each in bare.judged if each.value.limit is None]
    assert "vibratory torque at 10 Hz in the coupling of shaft 0" in names
    assert bare["torsion"].avoided == ()


def test_a_resonance_that_nothing_damps_is_refused() -> None:
    bare = ENGINE.replace("[8, 5, 0]", "[0, 0, 0]").replace("load_damping_Nms_per_rad = 0.8\n", "")
    natural = case(ENGINE).system.natural_frequencies()[0]
    said = (
        rf"speed_rpm contains {natural / 1.5 / RPM:.4g} rpm, where order 1.5 of the torques meets "
        rf"the natural frequency of {natural / 2 / np.pi:.3g} Hz, and nothing damps it: give damp"
    )
    with pytest.raises(SceneError, match=said):
        Scene.parse(bare)
    assert case(f"{bare}relative_damping = 0.1\n").system.couplings[0].loss_factor > 0.0
    assert case(bare.replace("from = 700, to = 1300", "from = 850, to = 1300")).system


def test_unstable_speeds_and_rattle_are_judged() -> None:
    limits = "unstable_percent = 0\nrattle_percent = 10\nspeed_rpm = {"
    found = basics(ENGINE.replace("speed_rpm = {", limits))
    assert found.search
    assert found.unstable_share
    assert found.unstable_share.verdict == "within"
    assert found.rattle_share
    assert found.rattle_share.verdict == "beyond"
    ends = [end for each in found.search.response.largest for end in each.reversals]
    union = max(stop for _, stop in ends) - min(start for start, _ in ends)
    assert found.rattle_share.value == pytest.approx(union / (600.0 * RPM))
    reasons = {each.reason for each in found.avoided}
    assert reasons == {f"the torque of shaft {i} changes its sign" for i in (0, 1)}
    # Scenes without an engine are searched if their limits need it.
    rig = """\
    [driveline]
    bends_deg = [20]
    [torsion]
    drive = "held"
    inertias_kgm2 = [0, [0, 0.05]]
    stiffnesses_Nm_per_rad = [8000, "rigid"]
    speed_rpm = {from = 3000, to = 4500, steps = 40}
    """
    assert basics(rig).unstable_share is None
    unstable = basics(rig + "unstable_percent = 5\n").unstable_share
    assert unstable
    share = 400.0 * (1.02995 - 0.96762) / (1500.0 * RPM)
    assert unstable.value == pytest.approx(share, rel=1e-3)
    assert unstable.verdict == "beyond"


def test_a_drive_whose_speed_runs_away() -> None:
    governed = MOTOR.partition("[torsion.motor]")[0]
    found = basics(governed + "unstable_percent = 0\n")
    assert found.unstable_share
    assert found.unstable_share.verdict == "within"
    said = " ".join(torsion_advice(found))
    assert re.search(
        r"between 208\d and 4000 rpm the torque that is needed falls with the speed; a governor "
        r"holds every speed, and so does a drive whose torque falls by more than 1\.43 N m s/rad",
        said,
    )
    assert "runs away" not in said
    # The slope of the drive counts.
    weak = governed + "unstable_percent = 0\ndrive_slope_Nms_per_rad = 0.5\n"
    assert basics(weak).unstable_share.verdict == "beyond"  # type: ignore[union-attr]
    assert basics(weak).avoided[0].reason == "the speed runs away"
    said = " ".join(torsion_advice(basics(weak)))
    assert re.search(
        r"between \d+ and \d+ rpm the speed runs away: the torque that is needed", said
    )
    strong = weak.replace("rad = 0.5", "rad = 1.5")
    assert basics(strong).unstable_share.verdict == "within"  # type: ignore[union-attr]
    whole = figures(governed)
    assert whole.verdict == "runaway"
    (part,) = whole.runaway
    assert part.needed_slope == pytest.approx(1.43, abs=0.01)
    ANSWERS.validate(answer("torsion", "", **data_of(whole), files=[]))


def test_a_motor_runs_at_some_speeds() -> None:
    found = basics(MOTOR)
    assert [each.stable for each in found.running] == [True, False, True]
    speeds, torques = np.array([1400.0, 3800.0]) * RPM, np.array([95.0, 20.0])
    for each in found.running:
        assert each.torque == pytest.approx(np.interp(each.speed, speeds, torques), rel=1e-9)
    said = " ".join(torsion_advice(found))
    low, middle, high = (round(each.speed / RPM) for each in found.running)
    assert f"the motor runs at {low} rpm and {high} rpm" in said
    assert f"at {middle} rpm its torque is what is needed too, but it does not stay" in said
    none = basics(MOTOR.replace("[95, 20]", "[5, 4]"))
    assert "the motor runs at no speed of its curve" in " ".join(torsion_advice(none))


def test_shapes_have_the_names_of_shafts() -> None:
    assert [mode.shape for mode in basics(ENGINE).modes] == [
        "the drive against the rest",
        "the shaft against the rest",
    ]
    unnamed = re.sub(r"names = .*\n", "", ENGINE)
    assert [mode.shape for mode in basics(unnamed).modes] == [
        "the drive against the rest",
        "shaft 1 against the rest",
    ]
    # Two bodies of one shaft are its ends.
    ends = ENGINE.replace("[[0.8, 0], [0.05, 0.01], [0, 0.15]]", "[[0.8, 0.1], 0, [0, 0.15]]")
    shapes = [mode.shape for mode in basics(ends).modes]
    assert shapes[1] == "the output end of shaft 0 (engine) against the rest"


def test_orders_may_be_halves() -> None:
    found = figures(ENGINE)
    said = PARTS["torsion"].text(found)
    assert re.search(r"\n    0 +1\.5 +\d+ rpm", said)
    assert re.search(r"\n    0 +2 +\d+ rpm", said)
    assert "the drive against the rest and at" in " ".join(said.split())
    assert "contains one critical speed: that of order 1.5 at" in " ".join(said.split())
    data = data_of(found)
    ANSWERS.validate(answer("torsion", "", **data, files=[]))
    assert [each["order"] for each in data["response"]["shafts"][0]["orders"]] == [1.5, 2, 3, 4]


@pytest.mark.long
def test_couplings_with_kinks_are_looked_at_at_few_speeds() -> None:
    law = "twist_deg = [0, 2, 4]\ntorque_Nm = [0, 100, 400]\nlargest_torque_Nm = 200"
    text = with_coupling(law).replace("steps = 13", "steps = 300")
    found = basics(text)
    assert found.search
    speeds = found.search.response.speed / RPM
    assert len(speeds) < 60
    critical = next(each.speed / RPM for each in found.resonances if each.order == 1.5)
    assert np.any(np.isclose(speeds, critical))
    (coupling,) = found.couplings
    largest = np.nanmax(np.abs(found.search.response.steady.torque_max[0]))
    assert coupling.largest.value == pytest.approx(largest)
    assert coupling.largest.verdict == "beyond"


BY_MEAN = """
[driveline]
bends_deg = [5, 5]
[torsion]
drive = "free"
inertias_kgm2 = [[0.3, 0], [0, 0], [0, 0.05]]
dampings_Nms_per_rad = [3, 0, 0]
load_damping_Nms_per_rad = 1.736
speed_rpm = [1300, 2200]
resonance_margin = 0.1
[[torsion.harmonic]]
order = 2
amplitude_Nm = 50
[[torsion.coupling]]
shaft = 0
mean_torque_Nm = [0, 200, 400]
stiffness_by_mean_Nm_per_rad = [2500, 4200, 7000]
rated_torque_Nm = 400
"""


def test_a_margin_is_that_of_the_stiffness_at_the_critical_speed() -> None:
    found = basics(BY_MEAN)
    inside = [(each.order, round(each.speed / RPM)) for each in found.resonances]
    assert inside == [(2.0, 1774)]
    assert found.margin.value == 0.0
    assert found.margin.verdict == "beyond"
    above = basics(BY_MEAN.replace("[1300, 2200]", "[1900, 2200]"))
    assert above.margin.value == pytest.approx((1900 - 1773.7) / 1773.7, abs=1e-3)


SHAPES: list[tuple[list[float], bool, str]] = [
    ([1.0, -0.3], True, "A against B"),
    ([-0.2, 1.0, 0.9], True, "A against the rest"),
    ([-0.05, 1.0, 0.9], True, "B and C against A"),
    ([0.02, 1.0, -0.3], True, "B against the rest"),
    ([0.3, -0.8, 1.0], True, "B against the rest"),
    ([0.0, 1.0], False, "B against the drive"),
    ([0.0, 0.5, 1.0], False, "B and C against the drive"),
    ([0.0, 1.0, -0.7], False, "B against C"),
]


@pytest.mark.parametrize(("sizes", "is_free", "said"), SHAPES)
def test_shapes_in_words(sizes: list[float], is_free: bool, said: str) -> None:
    bodies = [([(i, 0)], "ABC"[i]) for i in range(len(sizes))]
    assert shape_text([(size, size) for size in sizes], bodies, is_free=is_free) == said

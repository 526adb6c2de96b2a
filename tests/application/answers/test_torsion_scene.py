"""Torsional vibration of a scene: values, errors, answers, sentences and pictures."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib import pyplot
from matplotlib.axes import Axes
from matplotlib.patches import Polygon, Rectangle
from matplotlib.text import Annotation
from numpy.typing import NDArray

import cardan
import scripts
from cardan.app.answers.answer import Answer
from cardan.app.answers.data import data_of
from cardan.app.answers.schema import answer, check_data
from cardan.app.answers.table import PARTS
from cardan.app.answers.torsion.figures import TorsionBasics, TorsionFigures, torsion_figures
from cardan.app.answers.torsion.text import sentences, torsion_advice
from cardan.app.plots import (
    plot_campbell,
    plot_part,
    plot_stability,
    plot_torsion,
    plot_torsion_response,
)
from cardan.app.scene import Scene, SceneError
from cardan.app.scene.sections.torsion import TorsionCase
from example_scenes import ANSWERS

ROOT = Path(__file__).parents[3]


TRUCK, RIG = (ROOT / "examples" / f"{name}_torsion.toml" for name in ("truck", "rig"))


RPM = np.pi / 30.0


# A compliant driving shaft before a joint of 20 degrees and a flywheel.
JOINT = """\
[driveline]
bends_deg = [20]
[torsion]
drive = "held"
inertias_kgm2 = [0, [0, 0.05]]
stiffnesses_Nm_per_rad = [8000, "rigid"]
speed_rpm = {from = 3000, to = 4500, steps = 40}
"""


# Two compliant shafts without a bend: a chain of two masses, linear.
CHAIN = """\
[driveline]
bends_deg = [0, 0]
[torsion]
inertias_kgm2 = [[0, 0.02], [0.01, 0.03], [0, 0.05]]
stiffnesses_Nm_per_rad = [5000, 3000, "rigid"]
dampings_Nms_per_rad = [2.0, 0.5, 0]
speed_rpm = [100, 6000]
"""


def case(text: str) -> TorsionCase:
    found = Scene.parse(text).torsion
    assert found is not None
    return found


def figures(text: str) -> TorsionFigures:
    found = torsion_figures(Scene.parse(text))
    assert found is not None
    return found


def basics(scene: Scene) -> TorsionBasics:
    found = Answer(scene)["torsion"]
    assert isinstance(found, TorsionBasics)
    return found


def torsion_data(title: str, found: TorsionFigures) -> dict[str, Any]:
    return answer("torsion", title, **data_of(found), files=[])


def chain_matrices() -> tuple[NDArray[np.float64], NDArray[np.float64], NDArray[np.float64]]:
    """Inertias, stiffnesses and dampings of CHAIN; its unknowns are the output ends of shafts."""
    inertia = np.diag([0.02 + 0.01, 0.03 + 0.05])
    stiffness = np.array([[8000.0, -3000.0], [-3000.0, 3000.0]])
    damping = np.array([[2.5, -0.5], [-0.5, 0.5]])
    return inertia, stiffness, damping


def test_keys_are_the_arguments_of_the_library() -> None:
    given = case(TRUCK.read_text(encoding="utf-8"))
    lengths = Scene.load(TRUCK).line.lengths().each[1:3]
    tubes = [cardan.tube(0.09, 0.003, length=length) for length in lengths]
    halves = [0.5 * (own + tube.inertia) for own, tube in zip((0.004, 0.006), tubes, strict=True)]
    inertias = [[0.0, 0.0], *([half, half] for half in halves), [0.0, 0.14]]
    assert given.system.inertias == pytest.approx(np.array(inertias))
    stiffnesses = [np.inf, *(tube.stiffness for tube in tubes), np.inf]
    assert given.system.stiffnesses.tolist() == pytest.approx(stiffnesses)
    own = cardan.TorsionalSystem(
        given.system.line,
        inertias=inertias,
        stiffnesses=stiffnesses,
        damping_ratios=0.015,
        load_torque=400.0,
    )
    assert given.system.dampings == pytest.approx(own.dampings)
    speeds = np.array([600.0, 2500.0]) * RPM
    assert given.system.steady(speeds).torque_max == pytest.approx(own.steady(speeds).torque_max)
    assert given.speed[[0, 1, -1]] == pytest.approx(np.array([500, 510, 3000]) * RPM)
    assert given.orders == (2, 4)


def test_the_load_is_that_of_the_scene() -> None:
    load = "[load]\ndrive_torque_Nm = 70\n"
    assert case(load + JOINT).system.load_torque == 70.0
    assert case(f"{load}{JOINT}load_torque_Nm = 30\n").system.load_torque == 30.0
    assert case(JOINT).system.load_torque == 0.0
    damped = case(f"{JOINT}load_damping_Nms_per_rad = 0.5\n")
    mean = damped.system.steady(300.0).torque_mean
    assert mean > 0.5 * 300.0
    # A changed system keeps the loads.
    assert damped.system.changed().steady(300.0).torque_mean == pytest.approx(mean, rel=1e-12)


def test_stiffnesses_by_tubes_and_by_number_go_together() -> None:
    text = """\
    [driveline]
    bends_deg = [5, 6]
    [tubes]
    shafts = [0, 1]
    outer_diameter_mm = [50, 60]
    length_mm = 700
    [torsion]
    inertias_kgm2 = [0, 0.01, 0.1]
    stiffnesses_Nm_per_rad = ["tube", 9000, "rigid"]
    speed_rpm = [500, 2000]
    """
    given = case(text)
    tube = cardan.tube([0.05, 0.06], length=0.7)
    assert given.system.stiffnesses.tolist() == pytest.approx([tube.stiffness[0], 9000.0, np.inf])
    # Of shaft 1 only the inertia is that of its tube.
    halves = 0.5 * np.array([tube.inertia[0], 0.01 + tube.inertia[1], 0.1])
    assert given.system.inertias == pytest.approx(np.stack([halves, halves], axis=-1))
    without = text.replace("stiffnesses_Nm", "# ")
    assert case(without).system.stiffnesses.tolist() == pytest.approx([*tube.stiffness, np.inf])


def test_modes_are_those_of_a_chain_of_two_masses() -> None:
    inertia, stiffness, damping = chain_matrices()
    values, vectors = np.linalg.eig(np.linalg.inv(inertia) @ stiffness)
    order = np.argsort(values)
    modes = figures(CHAIN).modes
    assert [mode.frequency for mode in modes] == pytest.approx(np.sqrt(values[order]), rel=1e-9)
    for mode, shape in zip(modes, vectors.T[order], strict=True):
        twists = np.array([shape[0], shape[1] - shape[0]])
        energy = np.array([5000.0, 3000.0]) * twists**2
        assert [each.share for each in mode.shares] == pytest.approx(
            energy / energy.sum(), abs=1e-7
        )
        assert mode.shaft == int(np.argmax(energy))
        ratio = shape @ damping @ shape / (2.0 * mode.frequency * (shape @ inertia @ shape))
        assert mode.damping_ratio == pytest.approx(ratio, rel=1e-6)


def test_the_unstable_speeds_are_those_of_the_theory() -> None:
    # The edges are independent of this search: Whittaker-Hill's equation.
    (region,) = figures(JOINT).unstable
    assert region.start / 400.0 == pytest.approx(0.96762, abs=1e-5)
    assert region.stop / 400.0 == pytest.approx(1.02995, abs=1e-5)
    assert region.multiplier > 1.1
    # A coarse list of speeds misses nothing: regions are looked for where they can lie.
    coarse = JOINT.replace("{from = 3000, to = 4500, steps = 40}", "[3000, 4500]")
    (again,) = figures(coarse).unstable
    assert (again.start, again.stop) == pytest.approx((region.start, region.stop), rel=1e-6)
    # A range that begins within the region has its first speed as an edge.
    (part,) = figures(JOINT.replace("from = 3000", "from = 3800")).unstable
    assert part.start == 3800 * RPM


@pytest.mark.long
def test_largest_torques_and_reversals_are_those_of_dense_speeds() -> None:
    text = TRUCK.read_text(encoding="utf-8")
    coarse = figures(text.replace("steps = 251", "steps = 6"))
    given = case(text)
    speed = np.linspace(500.0, 3000.0, 8001) * RPM
    dense, fine = given.system.steady(speed), figures(text)
    for place, largest in enumerate(coarse.largest):
        sizes = np.maximum(dense.torque_max[place], -dense.torque_min[place])
        best = int(np.argmax(sizes))
        assert largest.size == pytest.approx(sizes[best], rel=1e-5)
        assert largest.speed == pytest.approx(speed[best], rel=1e-3)
        assert largest.mean == pytest.approx(dense.torque_mean[place, best], rel=1e-2)
        (part,) = fine.largest[place].reversals
        reversed_at = speed[dense.torque_min[place] < 0.0]
        assert part.start == pytest.approx(reversed_at[0], rel=1e-3)
        assert part.stop == pytest.approx(reversed_at[-1], rel=1e-9)


def test_critical_speeds_have_their_amplitude() -> None:
    found = figures(RIG.read_text(encoding="utf-8"))
    natural = found.modes[0].frequency
    assert [part.order for part in found.critical_speeds] == [2, 4, 6]
    for part in found.critical_speeds:
        assert part.speed == pytest.approx(natural / part.order)
        steady = found.torsion.system.steady(part.speed, part.order)
        assert part.amplitude == pytest.approx(abs(steady.torque_orders[0, 0]))
        assert part.inside


@pytest.mark.parametrize(("factor", "exceeded"), [(0.99, True), (1.01, False)])
def test_the_rule_of_the_bend(factor: float, exceeded: bool) -> None:
    ratio = factor * np.tan(np.radians(10.0)) ** 2
    scene = Scene.parse(f"{JOINT}damping_ratio = {ratio}\n")
    found = basics(scene)
    (rule,) = found.rules
    assert rule.bend == pytest.approx(np.radians(20.0))
    assert rule.damping_ratio == pytest.approx(ratio)
    assert (rule.exceeded, rule.inside) == (exceeded, True)
    assert bool([*torsion_advice(found)]) == exceeded


def test_the_rule_takes_the_joints_up_to_the_next_compliant_shaft() -> None:
    text = """\
    [driveline]
    bends_deg = [10, 12, 7]
    phases_deg = [20, 0]
    [torsion]
    inertias_kgm2 = [0, 0.01, 0.02, [0, 0.1]]
    stiffnesses_Nm_per_rad = [4000, "rigid", 9000, "rigid"]
    speed_rpm = [200, 4000]
    """
    found = basics(Scene.parse(text))
    first = cardan.Driveline.from_bends([10, 12], phases=20, degrees=True).equivalent().bend
    assert [rule.shaft for rule in found.rules] == [0, 2]
    assert [rule.bend for rule in found.rules] == pytest.approx([first, np.radians(7.0)])


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("[0, [0, 0.05]]", "[0]", "inertias_kgm2 has length 1; it needs 2, one per shaft"),
        ("[0, 0.05]", "[0, -1]", "inertias_kgm2[1][1] is -1; an inertia must lie in [0, 1e+06]"),
        ("[0, 0.05]", "[0]", "inertias_kgm2[1] is [0]; it must be a list of two numbers"),
        ("0.05", "0", "inertias_kgm2[0, 1] is 0.0, and so is every inertia"),
        ("8000", "-1", "stiffnesses_Nm_per_rad[0] is -1; a stiffness must lie in [0.001, 1e+12]"),
        ("8000", "0", "stiffnesses_Nm_per_rad[0] is 0; a stiffness must lie in [0.001, 1e+12]"),
        ("8000", "inf", 'is inf; it must be a positive number, "rigid", "tube" or "coupling"'),
        ("8000", "'stiff'", 'is \'stiff\'; it must be a positive number, "rigid", "tube" or'),
        ("8000", "'rigid'", "stiffnesses_Nm_per_rad are all infinite"),
        ("8000", "'tube'", "stiffnesses_Nm_per_rad[0] is 'tube'; shaft 0 is not in [tubes]"),
        (
            "stiff",
            "#",
            "stiffnesses_Nm_per_rad is missing; give it, a section [tubes] or a [[torsion",
        ),
        ("from = 3000", "from = 0", "speed_rpm.from is 0; a speed must lie in [0.001, 1e+06]"),
        ("from = 3000", "from = 5000", "speed_rpm.to is 4500; it must be above 'from', 5000"),
        ("{from = 3000, to = 4500, steps = 40}", "[100]", "name at least two speeds"),
        ("{from = 3000, to = 4500, steps = 40}", "100", "speed_rpm is 100; it must be {from = …"),
        ("speed_rpm", "orders = [0]\nspeed_rpm", "orders[0] is 0; an order must lie in (0, 256]"),
        ("speed_rpm", "damping_ratio = [1]\nspeed_rpm", "damping_ratio has length 1; it needs 2"),
        (
            "speed_rpm",
            "damping_ratio = 0\ndampings_Nms_per_rad = [1, 1]\nspeed_rpm",
            "damping_ratio and dampings_Nms_per_rad are both given",
        ),
        ("speed_rpm", "speeds = 3 #", "unknown key 'speeds'"),
        ("speed_rpm", "#", "speed_rpm is missing"),
    ],
)
def test_what_is_refused(old: str, new: str, said: str) -> None:
    assert JOINT.count(old) == 1
    with pytest.raises(ValueError, match=re.escape(said)) as caught:
        Scene.parse(JOINT.replace(old, new))
    # The line of the section or of the key.
    assert re.match(r"scene, line [3-7]: \[torsion\]", str(caught.value)), caught.value


def test_recorded_bends_and_a_recorded_torque_are_refused(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text("t,n,M,b\n0,100,5,1\n1,100,6,2\n2,100,7,3\n")
    torsion = JOINT.partition("[torsion]")[2]
    recorded = "[angles]\nfile = 'a.csv'\ntime_column_s = 't'\nspeed_column_rpm = 'n'\n"
    torque = f"[driveline]\nbends_deg = [20]\n{recorded}torque_column_Nm = 'M'\n[torsion]{torsion}"
    with pytest.raises(ValueError, match=r"load_torque_Nm is missing; the recorded torque"):
        Scene.parse(torque, folder=tmp_path)
    assert Scene.parse(f"{torque}load_torque_Nm = 3\n", folder=tmp_path).torsion is not None
    bends = f"{recorded}bend_columns_deg = ['b']\n[torsion]{torsion}"
    with pytest.raises(ValueError, match=r"\[torsion\] it does not go with recorded bends"):
        Scene.parse(bends, folder=tmp_path)


def test_a_resonance_without_damping_is_said() -> None:
    # A joint before the only spring: the equations are linear, and nothing limits the torque.
    text = """\
    [driveline]
    bends_deg = [10]
    [torsion]
    inertias_kgm2 = [0, [0, 0.05]]
    stiffnesses_Nm_per_rad = ["rigid", 8000]
    load_torque_Nm = 100
    speed_rpm = [1000, 4500]
    """
    found = figures(text)
    assert found.critical_speeds[0].speed == pytest.approx(200.0)
    assert found.critical_speeds[0].amplitude is None
    assert np.isinf(found.largest[0].size)
    part = found.missing[0]
    assert part.start == pytest.approx(200.0, rel=1e-12)
    assert part.stop == pytest.approx(200.0, rel=1e-12)
    assert part.reason.startswith("no periodic orbit was found from rigid shafts")
    assert "Without damping no torque is limited at 1910 rpm" in PARTS["torsion"].text(found)
    ANSWERS.validate(torsion_data("", found))
    above = figures(text.replace("[1000, 4500]", "[2500, 4500]"))
    assert np.isfinite(above.largest[0].size)
    assert not above.missing
    damped = figures(text + "damping_ratio = 0.01\n")
    assert not damped.missing
    assert np.isfinite(damped.largest[0].size)


@pytest.mark.long
def test_several_motions_at_a_critical_speed_are_said() -> None:
    # Two joints of 30 degrees and little damping: the peak leans, beside it three orbits exist.
    found = figures(
        """
        [driveline]
        bends_deg = [30, 30]
        [torsion]
        inertias_kgm2 = [0, [0, 0.004], [0.1, 0]]
        stiffnesses_Nm_per_rad = ["rigid", 9000, "rigid"]
        damping_ratio = 0.013
        load_torque_Nm = 20
        orders = 2
        speed_rpm = {from = 1200, to = 1600, steps = 5}
        """
    )
    (critical,) = found.critical_speeds
    at_critical = next(part for part in found.motions if part.speed == critical.speed)
    orbits = found.torsion.system.coexisting(critical.speed)
    assert at_critical.number == orbits.count == 3
    assert at_critical.stable == np.count_nonzero(orbits.stable) == 2
    sizes = np.fmax(-orbits.torque_min, orbits.torque_max)[0, :3]
    ends = (at_critical.smallest, at_critical.largest)
    assert ends == pytest.approx((sizes.min(), sizes.max()), rel=1e-4)
    said = "\n".join(sentences(found))
    assert "3 periodic motions were found, 2 of them stable: the largest torque of" in said
    data = torsion_data("", found)
    ANSWERS.validate(data)
    assert {part["number"] for part in data["motions"]} >= {3}
    # With more damping one motion is left, and nothing is said.
    alone = figures(JOINT.replace("speed_rpm", "damping_ratio = 0.1\nspeed_rpm"))
    assert [part.number for part in alone.motions] == [1] * len(alone.motions)
    assert "motions" not in " ".join(sentences(alone))


def test_verdicts() -> None:
    rig = RIG.read_text(encoding="utf-8")
    assert figures(rig).verdict == "unstable"
    damped = rig.replace("damping_ratio = 0.02", "damping_ratio = 0.2")
    assert figures(damped).verdict == "reversing"
    loaded = damped.replace("load_torque_Nm = 10\n", "load_torque_Nm = 900\n")
    assert figures(loaded).verdict == "resonant"
    high = loaded.replace("from = 500, to = 4000", "from = 2000, to = 2500")
    assert figures(high).verdict == "clear"
    (sentence, *_) = sentences(figures(high))
    assert sentence.startswith(
        "No critical speed of order 2 or 4 or 6 lies in the range; the nearest one is that of "
        "order 2 at 1515 rpm"
    )


@pytest.mark.parametrize("section", ["states", "study"])
def test_the_command_says_what_it_does_not_evaluate(section: str, tmp_path: Path) -> None:
    scene = tmp_path / "scene.toml"
    scene.write_text(JOINT, encoding="utf-8")
    assert "not evaluated" not in scripts.run("torsion", scene).stdout
    scene.write_text(f"{JOINT}[{section}]\nbends_deg.0 = [20, 30]\n", encoding="utf-8")
    said = scripts.run("torsion", scene).stdout
    assert said.endswith(f"[driveline]; the section [{section}] is not evaluated.\n")


def test_figures_beyond_the_arithmetic_are_refused() -> None:
    text = """\
    [driveline]
    bends_deg = [15, 40]
    [torsion]
    inertias_kgm2 = [[0, 449846.3982450503], [0, 0.002134298733825798], [0, 317535.14742940693]]
    stiffnesses_Nm_per_rad = [5.3044638340758405, 811993636353.138, 0.22452376546272745]
    damping_ratio = 0.02
    speed_rpm = [10, 20]
    """
    with pytest.raises(ValueError, match="stiffnesses and inertias differ by too many orders"):
        Scene.parse(text)


@pytest.mark.parametrize(
    ("speeds", "margin", "verdict"),
    [
        ("[3000, 4500]", "", "not judged"),
        # The natural frequency is 400 rad/s: order 2 meets it at 1909.9 rpm, order 4 at 954.9.
        ("[3000, 4500]", "resonance_margin = 0.15", "within"),
        ("[1800, 2000]", "resonance_margin = 0.01", "beyond"),
        ("[1950, 2500]", "resonance_margin = 0.02", "within"),
        ("[1950, 2500]", "resonance_margin = 0.022", "beyond"),
        ("[1000, 1870]", "resonance_margin = 0.02", "within"),
        ("[1000, 1870]", "resonance_margin = 0.021", "beyond"),
        ("[1000, 1950]", "resonance_margin = 0.1\norders = [3]", "not judged"),
    ],
)
def test_a_resonance_near_the_speeds_is_judged(speeds: str, margin: str, verdict: str) -> None:
    text = JOINT.replace("{from = 3000, to = 4500, steps = 40}", speeds).replace("[20]", "[0]")
    found = Answer(Scene.parse(f"{text}{margin}\n"))
    (judged,) = [each for each in found.judged if each.part.name == "torsion"]
    assert judged.value.verdict == verdict
    ANSWERS.validate(check_data(found))
    if speeds == "[1950, 2500]":
        critical = 200.0 / RPM
        assert judged.value.value == pytest.approx((1950.0 - critical) / critical, rel=1e-9)


@pytest.mark.parametrize(
    ("inertias", "first", "without"),
    [("[[0.3, 0.1], [0, 0.05]]", 8000, 0.3), ("[[0.3, 0.1], [0, 0.05]]", "rigid", 0.4)],
)
def test_an_inertia_at_the_drive_means_one_of_two(
    inertias: str, first: object, without: float
) -> None:
    text = JOINT.replace("[0, [0, 0.05]]", inertias)
    second = '"rigid"' if first == 8000 else "8000"
    text = text.replace('[8000, "rigid"]', f"[{json.dumps(first)}, {second}]")
    with pytest.raises(SceneError, match="drive is missing") as caught:
        Scene.parse(text.replace('drive = "held"\n', ""))
    assert "the drive is 'free', and this is its inertia" in str(caught.value)
    assert "'held' at constant speed, and the inertia has no effect" in str(caught.value)
    held = basics(Scene.parse(text))
    assert not [each for each in torsion_advice(held) if "held" in each]
    assert held.without_effect == pytest.approx(without)
    free = basics(Scene.parse(text.replace("held", "free")))
    assert free.without_effect is None
    assert free.modes[0].frequency > 1.05 * held.modes[0].frequency


def test_the_half_of_a_tube_at_the_drive_is_no_inertia_of_the_drive() -> None:
    text = """\
    [driveline]
    bends_deg = [20]
    [tubes]
    shafts = [0]
    outer_diameter_mm = 25
    length_mm = 600
    [torsion]
    inertias_kgm2 = [0, [0, 0.05]]
    speed_rpm = [500, 2000]
    """
    found = basics(Scene.parse(text))
    assert found.torsion.system.drive == "held"
    (said,) = [each for each in torsion_advice(found) if "held" in each]
    half = 0.5 * float(cardan.tube(0.025, length=0.6).inertia)
    assert found.without_effect == pytest.approx(half)
    assert "at the input end of shaft 0 has no effect" in said


PICTURES_TRUCK, PICTURES_RIG = (
    Scene.load(ROOT / "examples" / f"{name}_torsion.toml") for name in ("truck", "rig")
)


@pytest.fixture(scope="module")
def truck() -> TorsionFigures:
    found = torsion_figures(PICTURES_TRUCK)
    assert found is not None
    return found


@pytest.fixture(scope="module")
def rig() -> TorsionFigures:
    found = torsion_figures(PICTURES_RIG)
    assert found is not None
    return found


@pytest.fixture(autouse=True)
def _closed() -> object:
    yield
    pyplot.close("all")


def vertical_lines(axes: Axes) -> list[float]:
    """The speeds of dashed lines from bottom to top."""
    lines = [line for line in axes.get_lines() if np.asarray(line.get_ydata()).tolist() == [0, 1]]
    return sorted(float(np.asarray(line.get_xdata())[0]) for line in lines)


def marks(axes: Axes) -> list[Annotation]:
    """The texts that are at a place of the axes."""
    return [text for text in axes.texts if isinstance(text, Annotation)]


def test_the_response_has_torques_and_critical_speeds(truck: TorsionFigures) -> None:
    assert PICTURES_TRUCK.torsion is not None
    for place, shaft in enumerate((1, 2)):
        axes = plot_torsion_response(truck, shaft)
        most, least, mean = axes.get_lines()[:3]
        x = np.asarray(most.get_xdata(), dtype=np.float64)
        chosen = [0, len(x) // 3, len(x) // 2, -1]
        own = PICTURES_TRUCK.torsion.system.steady(x[chosen] * RPM)
        for line, values in ((most, own.torque_max), (least, own.torque_min)):
            drawn = np.asarray(line.get_ydata(), dtype=np.float64)[chosen]
            assert drawn == pytest.approx(values[place], rel=1e-9)
        assert np.asarray(mean.get_ydata())[chosen] == pytest.approx(own.torque_mean[place])
        # Both orders of the lower natural frequency; the other one is above the range.
        natural = PICTURES_TRUCK.torsion.system.natural_frequencies()[0] / RPM
        assert vertical_lines(axes) == pytest.approx([natural / 4, natural / 2])
        labels = [text.get_text() for text in axes.texts]
        assert sorted(labels) == ["2", "4"]
        places = {mark.get_text(): float(mark.xy[0]) for mark in marks(axes)}
        assert places["2"] == pytest.approx(natural / 2)
        assert axes.get_xlim() == pytest.approx((500, 3000))
        assert axes.get_ylabel() == f"torque of shaft {shaft} [N m]"
        # The peak is drawn, not cut between two speeds of the scene.
        largest = truck.largest[place]
        assert np.max(np.asarray(most.get_ydata())) == pytest.approx(largest.most, rel=1e-2)
    with pytest.raises(ValueError, match="shaft is 0; compliant shafts: 1, 2"):
        plot_torsion_response(truck, 0)


def test_the_response_marks_unstable_speeds(rig: TorsionFigures) -> None:
    axes = plot_torsion_response(rig)
    spans = [
        (patch.get_x(), patch.get_x() + patch.get_width())
        for patch in axes.patches
        if isinstance(patch, Rectangle) and patch.get_hatch()
    ]
    expected = [(part.start / RPM, part.stop / RPM) for part in rig.unstable]
    assert np.array(spans) == pytest.approx(np.array(expected))
    legend = axes.get_legend()
    assert legend is not None
    assert [text.get_text() for text in legend.get_texts()].count("unstable") == 1
    # Each edge separates stable from unstable speeds.
    assert PICTURES_RIG.torsion is not None
    edges = np.array(spans).ravel()
    outside = edges * np.tile([1.0 - 1e-4, 1.0 + 1e-4], len(spans)) * RPM
    inside = edges * np.tile([1.0 + 1e-4, 1.0 - 1e-4], len(spans)) * RPM
    assert PICTURES_RIG.torsion.system.stability(outside).stable.all()
    assert not PICTURES_RIG.torsion.system.stability(inside).stable.any()


def test_campbell_lines_cross_at_the_critical_speeds(truck: TorsionFigures) -> None:
    axes = plot_campbell(truck)
    rays = {line.get_label(): line for line in axes.get_lines()}
    points = next(line for line in axes.get_lines() if line.get_marker() == "o")
    x, y = (np.asarray(data, dtype=np.float64) for data in points.get_data())
    assert PICTURES_TRUCK.torsion is not None
    frequencies = PICTURES_TRUCK.torsion.system.natural_frequencies() / (2.0 * np.pi)
    assert len(x) == 4
    for order in (2, 4):
        (start, stop) = np.asarray(rays[f"order {order}"].get_xdata(), dtype=np.float64)
        low, high = np.asarray(rays[f"order {order}"].get_ydata(), dtype=np.float64)
        assert (start, low) == (0.0, 0.0)
        slope = high / stop
        assert slope == pytest.approx(order / 60.0)
        for frequency in frequencies:
            assert np.any(np.isclose(x, frequency / slope) & np.isclose(y, frequency))
    shaded = next(patch for patch in axes.patches if isinstance(patch, Rectangle | Polygon))
    assert isinstance(shaded, Rectangle)
    assert shaded.get_x() == pytest.approx(500)
    assert shaded.get_x() + shaded.get_width() == pytest.approx(3000)
    heights = [mark.xy[1] for mark in marks(axes)]
    assert heights == pytest.approx(frequencies)


def test_the_map_of_stability_is_that_of_the_library(rig: TorsionFigures) -> None:
    axes = plot_stability(rig)
    unstable = axes.collections[0]
    assert PICTURES_RIG.torsion is not None
    given = PICTURES_RIG.torsion
    points = np.array(
        [(3030, 25), (3030, 20), (3030, 12), (2600, 25), (3400, 25), (2800, 38), (2000, 8)]
    )
    paths = unstable.get_paths()
    inside = [any(path.contains_point(point) for path in paths) for point in points]
    line = type(given.system.line)
    for (speed, bend), drawn in zip(points, inside, strict=True):
        changed = given.system.changed(line.from_bends([bend], degrees=True))
        assert drawn != bool(changed.stability(speed * RPM).stable), (speed, bend)
    assert inside == [True, True, False, False, False, True, False]
    # The lowest unstable bend is that of the rule, tan²(bend/2) = damping ratio, to leading order.
    corners = np.concatenate([np.asarray(path.vertices, dtype=np.float64) for path in paths])
    lowest = np.min(corners[np.abs(corners[:, 0] - 3030) < 200, 1])
    assert lowest == pytest.approx(2.0 * np.degrees(np.arctan(np.sqrt(0.02))), abs=0.5)
    assert axes.get_ylabel() == "bend of joint 0 [deg]"
    assert axes.get_ylim() == pytest.approx((0.0, 50.0))
    assert np.max(corners[:, 1]) == pytest.approx(50.0)
    marked = next(line for line in axes.get_lines() if line.get_label() == "bend of the scene")
    assert np.asarray(marked.get_ydata()) == pytest.approx(25.0)
    with pytest.raises(ValueError, match="joint is 1; there are 1, counted from 0"):
        plot_stability(rig, 1)


def test_a_figure_has_a_panel_for_each_compliant_shaft(truck: TorsionFigures) -> None:
    figure = plot_torsion(truck, title="A truck")
    assert [axes.get_ylabel() for axes in figure.axes] == [
        "torque of shaft 1 [N m]",
        "torque of shaft 2 [N m]",
    ]
    (width, _) = figure.get_size_inches()
    assert width == pytest.approx(80.0 / 25.4)
    assert figure.get_suptitle() == "A truck"
    assert len(plot_part(PICTURES_TRUCK, "campbell").axes) == 1
    with pytest.raises(ValueError, match="name is 'map'; known are drive_speed, backlash"):
        plot_part(PICTURES_TRUCK, "map")

"""Free drives, harmonic torques and loss factors: the native module against others' numbers."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import cardan
from cardan import Coupling, Driveline, TorqueHarmonic, TorsionalSystem, reference
from cardan.reference import torsion
from cardan.torsion import SteadyState
from engine_cases import CASES, INF, SMOOTH, arguments_of, complexes, phases_of
from refusals import refusals

ONE = Driveline.from_bends([20], degrees=True)


def system_of(case: dict[str, Any]) -> TorsionalSystem:
    bends = case["bends"]
    line = Driveline.from_bends(bends, np.zeros(len(bends) - 1), phases_of(case))
    return TorsionalSystem(line, **arguments_of(case))


def two(drive: Any = "free", **own: Any) -> TorsionalSystem:  # noqa: ANN401
    """One joint of 20 degrees between a drive and a compliant shaft."""
    given: dict[str, Any] = {
        "inertias": [[0.3, 0], [0, 0.05]],
        "stiffnesses": [INF, 8000],
        "dampings": [0, 3],
    }
    return TorsionalSystem(ONE, drive=drive, **(given | own))


def off(case: dict[str, Any], found: SteadyState, place: Any = ...) -> dict[str, float]:  # noqa: ANN401
    """Return the errors: torques over the largest one, speeds over the mean, angles in rad."""
    size = np.max(np.abs([case["torque_min"], case["torque_max"]]))
    orders = found.orders
    # In the data, time begins at the drive angle 0; here its mean is 0.
    turned = np.exp(-1j * orders * (case["drive_angle_mean"] or 0.0))
    of_torque = np.array([complexes(own) for own in case["torque_orders"]]) * turned
    of_last = np.array(complexes(case["last_angle_orders"])) * turned
    wrong = {
        "mean": (found.torque_mean - case["torque_mean"]) / size,
        "least": (found.torque_min - case["torque_min"]) / size,
        "largest": (found.torque_max - case["torque_max"]) / size,
        "orders": (found.torque_orders - of_torque) / size,
        "drive": (found.drive_torque_mean - case["drive_torque_mean"]) / size,
        "last": found.angle_orders[-1, 1] - of_last,
    }
    if case["free"]:
        of_drive = np.array(complexes(case["drive_angle_orders"])) * turned
        wrong |= {
            "slowest": found.drive_speed_min / case["speed"]
            - case["drive_speed_min"] / case["speed"],
            "fastest": found.drive_speed_max / case["speed"]
            - case["drive_speed_max"] / case["speed"],
            "drive angle": found.angle_orders[0, 0] - of_drive,
        }
    return {name: float(np.max(np.abs(x))) for name, x in wrong.items()}


@pytest.mark.parametrize("number", SMOOTH)
def test_motions_of_an_independent_model(number: int) -> None:
    case = CASES[number]
    orders = [float(n) for n in case["torque_orders"][0]]
    found = system_of(case).steady(case["speed"], orders, tolerance=1e-10)
    assert system_of(case).period_turns == case["turns_per_period"]
    # Of a huge drive, whose speed hardly varies, the data know the mean torque to 6e-11.
    assert max(off(case, found).values()) < 1e-10


@pytest.mark.parametrize("number", [number for number in SMOOTH if CASES[number]["multipliers"]])
def test_multipliers_of_an_independent_model(number: int) -> None:
    case = CASES[number]
    found = system_of(case).stability(case["speed"])
    known = [complex(*x) for x in case["multipliers"]]
    if case["free"]:
        known.remove(min(known, key=lambda x: abs(x - 1.0)))
    assert len(known) == len(found.multipliers)
    # Nearly equal ones are sensitive; their polynomial is not.
    np.testing.assert_allclose(np.poly(found.multipliers), np.poly(known), atol=2e-8)
    if case["stable"] is not None:
        assert bool(found.stable) is case["stable"]


@pytest.mark.parametrize("number", [14, 16, 22])
def test_natural_frequencies_of_the_twin(number: int) -> None:
    case = CASES[number]
    line = reference.from_bends(case["bends"], None, phases_of(case))
    known = torsion.natural_frequencies(torsion.System(line, **arguments_of(case)))
    np.testing.assert_allclose(system_of(case).natural_frequencies(), known, rtol=1e-9)


def test_shapes_of_modes_balance() -> None:
    system = system_of(CASES[16])
    for frequency, shape, *_ in system._core.modes():
        of_ends = np.array(shape).reshape(-1, 2)
        assert np.max(of_ends) == 1.0
        assert np.min(of_ends) >= -1.0
        # What the shaft ends carry sums to 0 with the mean inertias, to the square of the bends.
        inertia = system.inertias * of_ends
        assert abs(inertia.sum()) < 0.05 * np.abs(inertia).sum()
        assert frequency > 0.0


def test_a_huge_drive_is_held() -> None:
    held = two("held", inertias=[[0, 0], [0, 0.05]], load_torque=30).steady(60.0)
    gaps = []
    for inertia in (1e2, 1e3):
        free = two(inertias=[[inertia, 0], [0, 0.05]], load_torque=30).steady(60.0)
        gaps.append(inertia * float(free.torque_max[0] - held.torque_max[0]))
        gaps.append(inertia * float(free.drive_speed_max - 60.0))
    # In proportion to 1/J.
    assert gaps[0] == pytest.approx(gaps[2], rel=1e-2)
    assert gaps[1] == pytest.approx(gaps[3], rel=1e-2)
    own: dict[str, Any] = {
        "inertias": [[1e4, 0], [0, 0.05]],
        "dampings": [0, 4],
        "load_torque": 30.0,
    }
    free, held = (two(drive, **own).steady(60.0) for drive in ("free", "held"))
    assert 1e4 * float(free.torque_max[0] - held.torque_max[0]) == pytest.approx(-1.3132, rel=1e-3)
    assert 1e4 * float(free.drive_speed_max - 60.0) == pytest.approx(0.19473, rel=1e-3)


@pytest.mark.parametrize("first", [True, False])
@pytest.mark.parametrize("loss", [0.0, 0.18])
def test_small_bends_have_a_closed_form(first: bool, loss: float) -> None:
    drive, last, c, d, load, speed, bend = 0.1, 0.05, 8000.0, 2.0, 100.0, 150.0, math.radians(0.5)
    d = 0.0 if loss else d
    system = TorsionalSystem(
        Driveline.from_bends([bend]),
        inertias=[[drive, 0], [0, last]] if first else [[drive, 0], [last, 0]],
        stiffnesses=[INF, c] if first else [c, INF],
        dampings=[d, d],
        load_torque=load,
        loss_factors=[0 if first else loss, loss if first else 0],
        drive="free",
    )
    k, both, order = math.tan(bend / 2) ** 2, drive * last / (drive + last), 2 * speed
    z = c * (1 + 1j * loss) + 1j * order * d
    if first:
        twist = k * (order**2 * both + 2j * load * both / drive) / (order**2 * both - z)
    else:
        twist = k * (order**2 * both - 2j * load * both / last) / (order**2 * both - z)
        twist *= np.exp(-2j * load / c)
    found = system.steady(speed, 2)
    # The twist is Im(D exp(2 i angle)), the order of a torque Re(X exp(2 i angle)).
    known = -1j * z * twist
    assert abs(found.torque_orders[0, 0] - known) < 3 * k * abs(known)
    more = 0.5 * order * np.abs(twist) ** 2 * z.imag / speed
    assert float(found.drive_torque_mean) - load == pytest.approx(more, rel=5 * k)


def test_a_straight_engine_has_a_closed_form() -> None:
    drive, last, c, d, speed, order, size = 0.1, 0.05, 8000.0, 2.0, 100.0, 1.5, 0.01
    system = TorsionalSystem(
        Driveline.from_bends([0]),
        inertias=[[drive, 0], [last, 0]],
        stiffnesses=[c, INF],
        dampings=[d, 0],
        harmonics=[TorqueHarmonic(0, "input", order, size)],
        drive="free",
    )
    both, omega = drive * last / (drive + last), order * speed
    z = c + 1j * omega * d
    known = z * size * (both / drive) / (z - omega**2 * both)
    found = system.steady(speed, [1.5, 2, 0.5, 1.7])
    np.testing.assert_allclose(found.torque_orders[0], [known, 0, 0, 0], atol=1e-8)
    assert found._system.period_turns == 2.0


def test_a_speed_beyond_a_resonance_runs_away() -> None:
    system = two(load_torque=30)
    found = system.stability([180.0, 250.0, 300.0])
    np.testing.assert_allclose(found.drive_torque_slope, [0.30707, -0.52205, -0.06982], atol=1e-5)
    np.testing.assert_allclose(found.speed_multiplier, [0.984952, 1.018855, 1.002094], atol=1e-6)
    # Governed, it vibrates evenly; a constant torque does not keep the speed.
    assert found.stable.all()
    np.testing.assert_allclose(found.needed_slope, [0, 0.52205, 0.06982], atol=1e-5)
    for slope, stable in ((0.4, False), (0.6, True)):
        assert bool(two(load_torque=30, drive_slope=slope).stability(250.0).stable) is stable


def test_the_mean_torque_is_its_own_derivative() -> None:
    system = system_of(CASES[22])
    speed, step = 120.0, 0.01
    around = system.steady([speed - step, speed + step], tolerance=1e-12).drive_torque_mean
    slope = float(system.stability(speed).drive_torque_slope)
    assert slope == pytest.approx(float(np.diff(around)[0]) / (2 * step), rel=1e-4)


@pytest.mark.long
def test_a_disturbed_motion_returns_to_the_orbit() -> None:
    case = CASES[22]
    system = system_of(case)
    speed, period = case["speed"], 4 * math.pi / case["speed"]
    steady = system.steady(speed)
    time = period * np.arange(201)
    start = system.transient(time[:2] / 50, speed=1.01 * speed, torque=0.9 * case["TL"])
    mean, slope = float(steady.drive_torque_mean), case.get("slope", 0.0)
    found = system.transient(
        time,
        speed=speed,
        start=start,
        tolerance=1e-10,
        drive_torque=lambda _, now: mean - slope * (now - speed),
    )
    # Once in each period the motion is at the same place, wherever in it that is.
    away = np.abs(np.diff(found.torque[0]))
    assert away[0] > 1.0
    assert away[-1] < 1e-5
    assert np.diff(found.drive_angle)[-1] == pytest.approx(4 * math.pi, abs=1e-7)


def test_a_motion_that_begins_on_the_orbit_stays_there() -> None:
    case = CASES[22]
    system = system_of(case)
    orbit = system.orbit(case["speed"], 32)
    period = 4 * math.pi / case["speed"]
    found = system.transient(
        period * np.arange(33) / 32, speed=case["speed"], start="steady", tolerance=1e-11
    )
    np.testing.assert_allclose(found.torque[0, :32], orbit.torque[0], atol=1e-6)
    np.testing.assert_allclose(found.drive_speed[:32], orbit.speed[0, 0], atol=1e-8)
    assert found.torque[0, 32] == pytest.approx(found.torque[0, 0], abs=1e-6)
    with pytest.raises(ValueError, match="no law in time"):
        two(loss_factors=[0, 0.2]).transient([0, 1], speed=50.0)


def test_stiffness_by_mean_torque() -> None:
    law = Coupling(mean_torque=[0, 100, 300], stiffness_by_mean=[2000, 4000, 9000])
    own: dict[str, Any] = {"dampings": [0, 2], "load_torque": 150.0}
    curved = two(stiffnesses=[INF, INF], couplings={1: law}, **own)
    linear = two(stiffnesses=[INF, 5250], **own)
    speeds = [50.0, 100.0, 230.0]
    np.testing.assert_allclose(
        curved.steady(speeds).torque_max, linear.steady(speeds).torque_max, rtol=1e-12
    )
    np.testing.assert_allclose(curved.natural_frequencies(), linear.natural_frequencies())
    # With a joint behind it, its mean torque is not the load: losses are added.
    behind = TorsionalSystem(
        ONE,
        inertias=[[0.3, 0], [0.05, 0]],
        stiffnesses=[INF, INF],
        dampings=[30, 0],
        load_torque=150.0,
        couplings={0: law},
        drive="free",
    )
    found = behind.steady(300.0)
    mean = float(found.torque_mean[0])
    assert mean > 151.0
    same = TorsionalSystem(
        ONE,
        inertias=[[0.3, 0], [0.05, 0]],
        stiffnesses=[law.stiffness_at(mean), INF],
        dampings=[30, 0],
        load_torque=150.0,
        drive="free",
    )
    np.testing.assert_allclose(found.torque_max, same.steady(300.0).torque_max, rtol=1e-8)


def test_critical_speeds_have_the_stiffness_at_their_own_torque() -> None:
    law = Coupling(mean_torque=[0, 200, 400], stiffness_by_mean=[2500, 4200, 7000])
    own: dict[str, Any] = {"inertias": [[0.3, 0], [0, 0], [0, 0.05]]}
    own["stiffnesses"] = [INF] * 3
    straight = Driveline.from_bends([0, 0])
    system = TorsionalSystem(
        straight,
        couplings={0: law},
        dampings=[0.5, 0, 0],
        load_damping=1.736,
        drive="free",
        harmonics=[TorqueHarmonic(0, "input", 2, 50)],
        **own,
    )
    found = system.critical_speeds([2, 4])
    for speed, order in zip(found[0], (2, 4), strict=True):
        stiffness = law.stiffness_at(1.736 * float(speed))
        natural = math.sqrt(stiffness * (1 / 0.3 + 1 / 0.05))
        assert order * float(speed) == pytest.approx(natural, rel=1e-9)
    # The motion itself is largest there.
    speeds = float(found[0, 0]) * np.linspace(0.9, 1.1, 41)
    torque = np.abs(system.steady(speeds, 2).torque_orders[0, :, 0])
    assert speeds[torque.argmax()] == pytest.approx(float(found[0, 0]), rel=0.011)
    # A batch has the critical speeds of its members.
    batch = TorsionalSystem(
        straight, couplings={0: law}, load_damping=[0.9, 1.736], drive="free", **own
    )
    np.testing.assert_allclose(batch.critical_speeds([2, 4])[1], found, rtol=1e-12)


def test_a_straight_driveline_permits_no_instability() -> None:
    line = Driveline.from_bends([0.1, 0.1], [0.0], [0.0])
    (rule,) = TorsionalSystem(
        line,
        inertias=[[0.3, 0.0], [0.0, 0.0], [0.0, 0.05]],
        stiffnesses=[4000, INF, INF],
        drive="free",
    ).bend_rules()
    assert rule.factor < 1e-12
    assert not rule.exceeded


def test_a_loss_factor_against_the_twin() -> None:
    own: dict[str, Any] = {
        "inertias": [[0.3, 0], [0.0, 0.02], [0.01, 0.05]],
        "stiffnesses": [4000, INF, 20000],
        "dampings": [0, 0, 1],
        "loss_factors": [0.15, 0, 0],
        "load_torque": 80.0,
        "drive": "free",
        "harmonics": [TorqueHarmonic(0, "input", 1.5, 60, 20), TorqueHarmonic(2, "output", 3, 8)],
    }
    bends, phases = [0.25, 0.2], [0.3]
    line = Driveline.from_bends(bends, [0], phases)
    slow = torsion.System(reference.from_bends(bends, None, phases), **own)
    fast = TorsionalSystem(line, **own)
    for speed in (70.0, 131.0):
        known = torsion.collocated(slow, speed, samples=48)
        orders = [0.5, 1.5, 2, 3, 3.5]
        found = fast.steady(speed, orders)
        size = float(np.max(np.abs(known.motion.torque)))
        far = found.torque_orders - known.orders(known.motion.torque, orders)
        assert np.max(np.abs(far)) < 1e-8 * size
        assert float(found.drive_torque_mean) == pytest.approx(known.drive_torque_mean, rel=1e-9)
        # The orbit has the same torques, those of the loss factor included.
        torque = fast.orbit(speed, 512).torque
        assert torque.max(axis=-1) == pytest.approx(found.torque_max, rel=1e-3)
        places = [round(fast.period_turns * order) for order in orders]
        sampled = (np.fft.rfft(torque) / 256)[:, places]
        assert np.max(np.abs(sampled - found.torque_orders)) < 1e-8 * size


def test_orbits_of_a_free_drive_keep_its_equation() -> None:
    case = CASES[24]
    system = system_of(case)
    orbit = system.orbit(case["speed"], 64)
    steady = system.steady(case["speed"])
    slope = case.get("slope", 0.0)
    law = float(steady.drive_torque_mean) - slope * (orbit.speed[0, 0] - case["speed"])
    np.testing.assert_allclose(orbit.drive_torque, law, atol=1e-6)
    assert orbit.drive_angle[-1] == pytest.approx(4 * math.pi * 63 / 64)
    assert float(np.mean(orbit.angle_error[0, 0])) == pytest.approx(0.0, abs=1e-10)


def of_orders(*orders: float) -> dict[str, Any]:
    return {"harmonics": [TorqueHarmonic(0, "input", order, 1) for order in orders]}


test_what_cannot_be_is_refused = refusals(
    {
        "drive is missing": {"drive": None},
        "drive_slope is -1.0; it says how much the torque of the drive falls with rising "
        "speed, so it must be 0 or more": {"drive_slope": -1.0},
        "inertias[0, 0]…a free drive needs an inertia": {"inertias": [[0, 0], [0, 0.05]]},
        "divisor of at least 1/8, so take 1.25 or 1.375 instead of 1.3": of_orders(1.3),
        "so take 0.125 instead of 0.1": of_orders(0.1),
        "so take 1.16…or 1.33…instead of 1.3": of_orders(1 / 3, 1.3),
        "[0.2, 3.0, 1.5, 0.75]… so take 1.4 or 1.6 instead of 1.5": of_orders(0.2, 3, 1.5, 0.75),
        "acts on shaft 2; the last one is 1": {"harmonics": [TorqueHarmonic(2, "input", 2, 1)]},
        "order 0.0; it must be positive": {"harmonics": [TorqueHarmonic(0, "input", 0, 1)]},
        "not finite": {"harmonics": [TorqueHarmonic(0, "input", 2, INF)]},
        "whose stiffness must be inf": {"couplings": {1: Coupling(5000)}},
        "names shaft 3; the last one is 1": {"couplings": {3: Coupling(5000)}},
        "rigid shaft": {"loss_factors": [0.1, 0]},
    },
    two,
)


@pytest.mark.parametrize(
    ("own", "words"),
    [
        ({"drive_slope": -1.0}, "^drive_slope is -1.0"),
        (of_orders(1.3), "^harmonics have the orders"),
        (of_orders(-1), r"^harmonics\[0\] has the order -1.0"),
        (
            {"stiffnesses": [INF, INF], "couplings": {1: Coupling(9, play=-1)}},
            r"^couplings\[1\] has",
        ),
        ({"inertias": [[0, 0], [0, 0.05]]}, r"^inertias\[0, 0, 0\] is 0"),
    ],
)
def test_the_system_of_a_batch_is_named_only_where_systems_differ(
    own: dict[str, Any], words: str
) -> None:
    batch = Driveline.from_bends([[0.1], [0.2]])
    given: dict[str, Any] = {"inertias": [[0.3, 0], [0, 0.05]], "stiffnesses": [INF, 8e3]}
    with pytest.raises(ValueError, match=words):
        TorsionalSystem(batch, drive="free", **(given | own))


def test_orders_may_be_refused() -> None:
    for orders in ([0.0], [-2.0], [300.0]):
        with pytest.raises(ValueError, match="positive and at most 256"):
            two().steady(60.0, orders)


def test_firing_orders() -> None:
    one = [(0.5 * n, 10.0 * n, 5.0) for n in range(1, 13)]
    for order, expected in (([1, 3, 2], [1.5, 3, 4.5, 6]), ([1, 3, 4, 2], [2, 4, 6])):
        found = cardan.firing_harmonics(one, order)
        assert [own.order for own in found] == expected
        # The sum over the cylinders, each turned by its firing angle.
        angle = 0.7
        for own in found:
            cos, sin = next((c, s) for n, c, s in one if n == own.order)
            turns = own.order * (angle - 4 * np.pi * np.arange(len(order)) / len(order))
            known = np.sum(cos * np.cos(turns) + sin * np.sin(turns))
            got = own.cos * np.cos(own.order * angle) + own.sin * np.sin(own.order * angle)
            assert got == pytest.approx(known)
    for wrong in ([1, 1], [1, 3, 5, 2]):
        with pytest.raises(ValueError, match="each cylinder, from 1 on, once"):
            cardan.firing_harmonics(one, wrong)

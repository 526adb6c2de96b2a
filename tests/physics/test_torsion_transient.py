"""Motion in time against periodic orbits, closed forms, balances of energy, and own integration."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.typing import ArrayLike, NDArray

import cardan
from cardan.torsion import TorsionalMotion
from refusals import refusals

integrate = pytest.importorskip("scipy.integrate")

INF = float("inf")
LINE = cardan.Driveline.from_bends([12, 9, 15], phases=[40, -23], degrees=True)
INERTIAS = np.array([[0.02, 0.01], [0.01, 0.02], [0.015, 0.01], [0.1, 0.05]])


def system_of(line: cardan.Driveline = LINE, **options: ArrayLike) -> cardan.TorsionalSystem:
    of: dict[str, Any] = {
        "inertias": INERTIAS,
        "drive": "held",
        "stiffnesses": [INF, 30000.0, 20000.0, INF],
        "dampings": [0.0, 12.0, 8.0, 0.0],
        "load_torque": 300.0,
        "load_damping": 0.4,
    }
    return cardan.TorsionalSystem(line, **(of | options))


def oscillator(bend: float = 0.0, ratio: float = 0.1) -> cardan.TorsionalSystem:
    """One joint, a compliant shaft and a flywheel: 400 rad/s."""
    line = cardan.Driveline.from_bends([bend], degrees=True)
    return cardan.TorsionalSystem(
        line, inertias=[[0.0, 0.0], [0.0, 0.05]], stiffnesses=[INF, 8000.0], damping_ratios=ratio
    )


def test_the_steady_state_is_reached() -> None:
    system, speed = system_of(), 150.0
    end = 120 * np.pi / speed
    angles = np.arange(32) * np.pi / 32
    times = np.concatenate([[0.0], end + angles / speed])
    found = system.transient(times, speed=speed)
    orbit = system.orbit(speed, 32)
    scale = np.abs(orbit.torque).max()
    assert np.abs(found.torque[:, :1] - orbit.torque[:, :1]).max() > 0.01 * scale
    assert found.torque[:, 1:] == pytest.approx(orbit.torque, abs=1e-6 * scale)
    assert found.angle_error[:, :, 1:] == pytest.approx(orbit.angle_error, abs=1e-8)
    assert found.speed[:, :, 1:] == pytest.approx(orbit.speed, abs=1e-6 * speed)


def test_a_steady_start_stays_on_the_orbit() -> None:
    system, speed = system_of(), 150.0
    angles = np.arange(33) * np.pi / 32
    found = system.transient(angles / speed, speed=speed, start="steady")
    orbit = system.orbit(speed, 32)
    scale = np.abs(orbit.torque).max()
    assert found.torque[:, :-1] == pytest.approx(orbit.torque, abs=1e-6 * scale)
    assert found.torque[:, -1] == pytest.approx(orbit.torque[:, 0], abs=1e-6 * scale)


def test_breaks_show_a_short_pulse_before_the_second_time() -> None:
    # At rest steps grow, and would pass over a pulse of 2 ms between two times.
    begin, end = 3.0, 3.002
    found = oscillator().transient(
        [0.0, end, 3.01],
        speed=0.0,
        torque=lambda t: 50.0 if begin <= t < end else 0.0,
        breaks=[begin, end],
    )
    # A damped oscillator at rest under a constant torque, by its characteristic roots.
    root = complex(-0.1, np.sqrt(1.0 - 0.1**2)) * 400.0

    def deflected(after: float) -> float:
        # x = s (1 + Re(conj(r) exp(r t) / (i Im r))), which begins with x = x' = 0.
        wave = root.conjugate() * np.exp(root * after) / (1j * root.imag)
        return float(50.0 / 8000.0 * (1.0 + wave.real))

    twists = found.angle_error[1, 0] - found.angle_error[1, 1]
    later = deflected(3.01 - begin) - deflected(3.01 - end)
    assert twists == pytest.approx([0.0, deflected(end - begin), later], abs=1e-9)


def test_a_step_of_the_load_is_that_of_an_oscillator() -> None:
    system, ratio, natural, step = oscillator(), 0.1, 400.0, 50.0
    times = np.linspace(0.0, 0.1, 101)
    found = system.transient(
        times, speed=30.0, torque=lambda t: step if t >= 0.02 else 0.0, breaks=0.02
    )
    after = np.maximum(times - 0.02, 0.0)
    decay, damped = ratio * natural, natural * np.sqrt(1.0 - ratio**2)
    swing = np.cos(damped * after) + decay / damped * np.sin(damped * after)
    # The torque of spring and damper together.
    twist = step / 8000.0 * (1.0 - np.exp(-decay * after) * swing)
    rate = step / 8000.0 * np.exp(-decay * after) * natural**2 / damped * np.sin(damped * after)
    torque = 8000.0 * twist + float(system.dampings[1]) * rate
    assert found.torque[0] == pytest.approx(torque, abs=1e-6 * step)
    assert found.angle_error[1, 0] - found.angle_error[1, 1] == pytest.approx(twist, abs=1e-10)
    dense = found.at(np.linspace(0.02, 0.1, 5001)).torque[0]
    assert dense.max() > 1.7 * step


def test_a_run_up_is_that_of_the_formula_of_one_joint() -> None:
    # theta follows atan2(sin a, cos b cos a) of the drive angle a = rate t^2/2.
    system, rate, bend = oscillator(20.0, 0.02), 300.0, np.radians(20.0)
    times = np.linspace(0.0, 1.0, 401)
    found = system.transient(times, speed=lambda t: rate * t)
    damping = float(system.dampings[1])

    def slopes(t: float, state: NDArray[np.float64]) -> list[float]:
        angle, speed = 0.5 * rate * t * t, rate * t
        turns = np.round(angle / np.pi) * np.pi
        driven = turns + np.arctan(np.tan(angle - turns) / np.cos(bend))
        ratio = np.cos(bend) / (1.0 - np.sin(bend) ** 2 * np.cos(angle) ** 2)
        torque = 8000.0 * (driven - state[0]) + damping * (ratio * speed - state[1])
        return [state[1], torque / 0.05]

    own = integrate.solve_ivp(
        slopes, (0.0, 1.0), [0.0, 0.0], method="DOP853", t_eval=times, rtol=1e-11, atol=1e-12
    )
    assert own.success
    angle = 0.5 * rate * times**2
    assert found.drive_angle == pytest.approx(angle, abs=1e-9)
    error = found.angle_error[1, 1] - (own.y[0] - angle)
    assert np.abs(error).max() < 1e-6
    # It passes the resonance of the second order at 200 rad/s.
    assert 190.0 < found.drive_speed[np.abs(found.torque[0]).argmax()] < 240.0


def energy(system: cardan.TorsionalSystem, at: TorsionalMotion, drive_inertia: float) -> Any:  # noqa: ANN401
    """Kinetic energy of all shaft ends and of the drive, and energy of the springs."""
    kinetic = 0.5 * np.tensordot(INERTIAS, at.speed**2, axes=2)
    kinetic = kinetic + 0.5 * drive_inertia * at.drive_speed**2
    for shaft, stiffness in ((1, 30000.0), (2, 20000.0)):
        twist = at.angle_error[shaft, 0] - at.angle_error[shaft, 1]
        kinetic = kinetic + 0.5 * stiffness * twist**2
    return kinetic


def test_energy_is_balanced_with_a_drive_of_finite_inertia() -> None:
    system, inertia, end = system_of(), 0.3, 0.2

    def torque(t: Any, speed: Any) -> Any:  # noqa: ANN401 - numbers or arrays
        return 400.0 + 500.0 * t - 0.3 * speed

    found = system.transient(
        [0.0, end], speed=60.0, drive_inertia=inertia, drive_torque=torque, tolerance=1e-11
    )
    # Gauss's rule on many short pieces.
    nodes, weights = np.polynomial.legendre.leggauss(8)
    edges = np.linspace(0.0, end, 401)
    middle, half = 0.5 * (edges[1:] + edges[:-1]), 0.5 * np.diff(edges)
    times = middle[:, np.newaxis] + half[:, np.newaxis] * nodes
    at = found.at(times)
    power = torque(times, at.drive_speed) * at.drive_speed
    power = power - (300.0 + 0.4 * at.speed[-1, 1]) * at.speed[-1, 1]
    for shaft, damping in ((1, 12.0), (2, 8.0)):
        power = power - damping * (at.speed[shaft, 0] - at.speed[shaft, 1]) ** 2
    work = np.sum(power * weights * half[:, np.newaxis])
    first, last = energy(system, found, inertia)
    assert abs(last - first) > 100.0
    assert last - first == pytest.approx(work, abs=1e-7 * last)


def test_a_free_drive_of_stiff_shafts_runs_as_the_rigid_driveline() -> None:
    inertias = INERTIAS.copy()
    inertias[0] = [0.2, 0.0]
    system = system_of(
        inertias=inertias,
        stiffnesses=[INF, 1e9, 1e9, INF],
        dampings=[0.0, 1e4, 1e4, 0.0],
        load_torque=0.0,
        load_damping=0.0,
    )
    free = LINE.free_running(inertias.sum(axis=1) + np.array([0.5, 0.0, 0.0, 0.0]))
    start = float(free.speed_ratio(0.0))
    found = system.transient(
        np.linspace(0.0, 0.1, 201), speed=100.0 * start, drive_inertia=0.5, method="Radau"
    )
    expected = 100.0 * free.speed_ratio(found.drive_angle)
    assert np.ptp(expected) > 0.5
    assert found.drive_speed == pytest.approx(expected, rel=1e-5)


def test_a_heavy_drive_keeps_its_speed() -> None:
    system = system_of()
    times = np.linspace(0.0, 0.05, 51)
    heavy = system.transient(times, speed=150.0, drive_inertia=1e9)
    constant = system.transient(times, speed=150.0)
    assert heavy.torque == pytest.approx(constant.torque, rel=1e-5, abs=1e-3)
    assert constant.drive_speed.tolist() == 51 * [150.0]


def test_a_stop_ends_at_rest() -> None:
    system = system_of(load_damping=0.0)
    found = system.transient(
        [0.0, 0.3, 2.0],
        speed=lambda t: max(100.0 - 400.0 * t, 0.0),
        start="steady",
        breaks=[0.25],
    )
    assert found.drive_angle == pytest.approx([0.0, 12.5, 12.5], abs=1e-9)
    assert np.abs(found.speed[..., -1]).max() < 1e-3
    # At rest the shafts carry the load through the joints.
    angle = 12.5
    static = LINE.evaluate(angle, "torque", shafts=[2], load=cardan.Load(output_torque=300.0))
    assert found.torque[1, -1] == pytest.approx(static.torque[0], rel=2e-2)


def test_events_are_found() -> None:
    def reached(motion: TorsionalMotion) -> float:
        return float(motion.drive_speed) - 50.0

    def turned(motion: TorsionalMotion) -> float:
        return float(np.sin(motion.drive_angle))

    turned.direction = 1.0  # type: ignore[attr-defined]
    system = oscillator(20.0)
    times = np.linspace(0.0, 1.0, 11)
    found = system.transient(times, speed=lambda t: 100.0 * t, events=[reached, turned])
    assert found.event_times[0] == pytest.approx([0.5], abs=1e-9)
    turns = np.sqrt(2.0 * 2.0 * np.pi * np.arange(1, 8) / 100.0)
    assert found.event_times[1][-7:] == pytest.approx(turns, abs=1e-8)
    assert not found.stopped
    assert found.time.tolist() == times.tolist()
    reached.terminal = True  # type: ignore[attr-defined]
    ended = system.transient(times, speed=lambda t: 100.0 * t, events=reached)
    assert ended.stopped
    assert ended.time.tolist() == times[:5].tolist() or ended.time.tolist() == times[:6].tolist()
    assert ended.at(0.4999).drive_speed == pytest.approx(49.99, abs=1e-6)


@pytest.mark.parametrize("inertia", [INF, 0.4])
def test_a_motion_goes_on_where_another_ends(inertia: float) -> None:
    system = system_of()
    options: dict[str, Any] = {"speed": 80.0, "drive_inertia": inertia}
    whole = system.transient([0.0, 0.02, 0.04], **options)
    first = system.transient([0.0, 0.02], **options)
    second = system.transient([0.02, 0.04], start=first, **options)
    assert second.torque[:, -1] == pytest.approx(whole.torque[:, -1], rel=1e-6)
    assert second.drive_angle == pytest.approx(whole.drive_angle[1:], rel=1e-9)


@pytest.mark.parametrize(("before", "after"), [(INF, 0.4), (0.4, INF)])
def test_a_motion_goes_on_with_another_drive(before: float, after: float) -> None:
    system = system_of()
    first = system.transient([0.0, 0.02], speed=80.0, drive_inertia=before)
    speed = float(first.drive_speed[-1])
    second = system.transient([0.02, 0.04], speed=speed, drive_inertia=after, start=first)
    for name in ("drive_angle", "drive_speed", "angle_error", "speed", "torque"):
        end, start = getattr(first, name)[..., -1], getattr(second, name)[..., 0]
        assert start == pytest.approx(end, rel=1e-9, abs=1e-12), name


def test_the_motion_between_the_samples() -> None:
    found = system_of().transient(np.linspace(0.0, 0.05, 6), speed=90.0, breaks=[0.013, 0.04])
    again = found.at(found.time)
    assert again.torque == pytest.approx(found.torque, rel=1e-12)
    assert found.at([[0.01], [0.02]]).angle_error.shape == (4, 2, 2, 1)
    assert found.at(0.02).torque.shape == (2,)
    # The speed is the derivative of the angle.
    step = 1e-6
    near = found.at([0.02 - step, 0.02, 0.02 + step])
    slope = (near.angle_error[..., 2] - near.angle_error[..., 0]) / (2 * step)
    assert near.speed[..., 1] - 90.0 == pytest.approx(slope, abs=1e-3)
    with pytest.raises(cardan.ArgumentValueError, match=r"time\[1\] is 0\.06; it must be from 0"):
        found.at([0.0, 0.06])


test_wrong_calls_are_refused = refusals(
    {
        "time has shape (); it needs two times at least": {"time": 1.0},
        "time[1] is 1.0; times must be finite and inc": {"time": [0.0, 1.0, 1.0]},
        "TypeError: speed is 'fast'; it must be a number or a function": {"speed": "fast"},
        "speed is inf; it must be finite": {"speed": INF},
        "speed is inf at 0.0 s; it must": {"speed": lambda t: t / 0.0 if t else INF},
        "drive_torque is given, but the speed of a drive of": {"drive_torque": 5.0},
        "drive_inertia is -1.0; it must not be negative": {"drive_inertia": -1.0},
        "speed is a function, but a drive of finite inertia only begins with a speed": {
            "drive_inertia": 1.0,
            "speed": np.sin,
        },
        "method is 'Euler'; it must be 'DOP853', 'RK45'": {"method": "Euler"},
        "start is 'soft'; it must be 'rigid', 'steady' or a tra": {"start": "soft"},
        "start is 'steady', but at 0.0 rad/s the": {"start": "steady", "speed": 0.0},
        "TypeError: events[0] is 3; it must be a function": {"events": [3]},
        "tolerance is 1.0; it must be from": {"tolerance": 1.0},
    },
    lambda **own: system_of().transient(**{"time": [0.0, 0.1], "speed": 50.0, **own}),
)


def test_other_systems_are_refused() -> None:
    batch = system_of(load_torque=[1.0, 2.0])
    with pytest.raises(cardan.ArgumentValueError, match=r"system has the batch \(2,\); a transi"):
        batch.transient([0.0, 1.0], speed=1.0)
    before = oscillator().transient([0.0, 0.01], speed=1.0)
    with pytest.raises(cardan.ArgumentValueError, match=r"start has the compliant shafts \(1,\)"):
        system_of().transient([0.0, 0.01], speed=1.0, start=before)


def test_a_motion_that_cannot_be_integrated_is_reported() -> None:
    # The speed grows beyond all bounds before the last time.
    pole: Callable[[float], float] = lambda t: 1.0 / max(0.5 - t, 1e-300)  # noqa: E731
    with pytest.raises((RuntimeError, ValueError)):
        oscillator(20.0).transient([0.0, 1.0], speed=pole)

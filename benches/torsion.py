"""Time torsional systems, and compare them with an integrator of SciPy on the same work.

``python benches/torsion.py [--quick]`` prints a table: 10 000 speeds of a driveline with one and
with two compliant shafts, a map of stability over speed and bend, and the periodic orbit at some
speeds by shooting with ``scipy.integrate.solve_ivp`` (DOP853) and differences. With openTorsion
installed (``pip install opentorsion``), a linear system that it can model is compared as well. All
figures are from one run. The programs find the same motions, which is checked.
"""

from __future__ import annotations

import argparse
import functools
import time
from collections.abc import Callable

import numpy as np

import cardan

INF = float("inf")
BEND, STIFFNESS, DAMPING = np.radians(15.0), 9000.0, 1.0
NEAR, FAR, LOAD = 0.006, 0.08, 100.0


def one_spring() -> cardan.TorsionalSystem:
    """Two joints with crossed yokes; the shaft between them is compliant."""
    line = cardan.Driveline.from_bends([BEND, BEND])
    return cardan.TorsionalSystem(
        line,
        inertias=[[0.0, 0.0], [0.0, NEAR], [FAR, 0.0]],
        stiffnesses=[INF, STIFFNESS, INF],
        dampings=[0.0, DAMPING, 0.0],
        load_torque=LOAD,
    )


def two_springs() -> cardan.TorsionalSystem:
    """Three joints; both intermediate shafts are compliant."""
    line = cardan.Driveline.from_bends([5, 4, 3], phases=[40, -23], degrees=True)
    return cardan.TorsionalSystem(
        line,
        inertias=[[0.0, 0.0], [0.01, 0.02], [0.015, 0.01], [0.1, 0.05]],
        stiffnesses=[INF, 30000.0, 20000.0, INF],
        dampings=[0.0, 2.0, 1.5, 0.0],
        load_torque=500.0,
    )


def engine(law: str) -> cardan.TorsionalSystem:
    """Three inertias that a free engine drives with half orders, through a coupling of some law."""
    laws = {
        "viscous": cardan.Coupling(850),
        "loss factor": cardan.Coupling(850, loss_factor=0.13),
        "play": cardan.Coupling(850, play=0.02),
    }
    gas = [(0.5, 90, 60), (1.0, 70, 120), (1.5, 43, 32), (3.0, 19, 8), (4.5, 6, 3)]
    return cardan.TorsionalSystem(
        cardan.Driveline.from_bends([4.5, 4.5], degrees=True),
        inertias=[[0.8, 0.004], [0.003, 0.003], [0.004, 0.07]],
        stiffnesses=[INF, INF, 14000.0],
        dampings=[0.0 if law == "loss factor" else 1.0, 0.0, 1.0],
        load_torque=5.0,
        load_damping=0.27,
        drive="free",
        harmonics=cardan.firing_harmonics(gas, [1, 3, 2]),
        couplings={0: laws[law]},
    )


def stability_map(size: int) -> object:
    """Stability over speed and bend around the natural frequency."""
    line = cardan.Driveline.from_bends(np.linspace(1.0, 40.0, size)[:, None, None], degrees=True)
    system = cardan.TorsionalSystem(
        line, inertias=[[0.0, 0.0], [0.0, 0.05]], stiffnesses=[8000.0, INF], damping_ratios=0.01
    )
    return system.stability(400.0 * np.linspace(0.4, 1.2, size))


def shooting(speed: float) -> float:
    """The largest torque at the samples of an orbit of ``one_spring``, by integration."""
    from scipy.integrate import solve_ivp

    k = np.tan(BEND / 2) ** 2

    def follow(angle: float) -> tuple[float, float, float]:
        z = -k * np.exp(-2j * angle)
        g = 1.0 / (1.0 + z)
        return angle + np.angle(1.0 + z), ((1.0 - z) * g).real, (4j * z * g * g).real

    def slopes(angle: float, state: np.ndarray) -> list[float]:
        theta, rate = state
        before, ratio_before, _ = follow(angle)
        _, ratio, slope = follow(theta)
        torque = STIFFNESS * (before + np.pi / 2 - theta)
        torque += DAMPING * speed * (ratio_before - rate)
        inertia, half_slope = NEAR + FAR * ratio**2, FAR * ratio * slope
        inertial = torque - ratio * LOAD - half_slope * (rate * speed) ** 2
        return [rate, inertial / (inertia * speed**2)]

    def end(start: np.ndarray) -> np.ndarray:
        found = solve_ivp(slopes, (0.0, np.pi), start, method="DOP853", rtol=1e-10, atol=1e-12)
        return np.asarray(found.y[:, -1]) - [np.pi, 0.0]

    start = np.array([np.pi / 2 - LOAD / STIFFNESS, 1.0])
    for _ in range(8):
        gap = end(start) - start
        if np.abs(gap).max() < 1e-9:
            break
        step = 1e-6
        columns = [(end(start + step * e) - start - step * e - gap) / step for e in np.eye(2)]
        start = start - np.linalg.solve(np.column_stack(columns), gap)
    orbit = one_spring().orbit(speed, 1)
    assert abs(orbit.angle_error[1, 1, 0] + np.pi / 2 - start[0]) < 1e-7
    return float(start[0])


def linear() -> cardan.TorsionalSystem:
    """One bent joint before two compliant shafts, which a straight joint connects."""
    line = cardan.Driveline.from_bends([BEND, 0.0])
    return cardan.TorsionalSystem(
        line,
        inertias=[[0.0, 0.0], [0.0, NEAR], [0.0, FAR]],
        stiffnesses=[INF, STIFFNESS, 2 * STIFFNESS],
        dampings=[0.0, DAMPING, DAMPING],
    )


def by_open_torsion(speeds: np.ndarray) -> np.ndarray:
    """The second order of the torque in the last shaft of ``linear``.

    openTorsion has no joint. It gets the torque by which the angle behind the joint, with the
    orders ``2 n`` of ``tan(bend/2)**(2 n) / n``, moves the first flywheel.
    """
    import opentorsion

    disks = [opentorsion.Disk(0, NEAR, c=DAMPING, k=STIFFNESS), opentorsion.Disk(1, FAR)]
    shafts = [opentorsion.Shaft(0, 1, k=2 * STIFFNESS, c=DAMPING)]
    assembly = opentorsion.Assembly(shafts, disk_elements=disks)
    orders = np.arange(1, 9)
    angles = np.tan(BEND / 2) ** (2 * orders) / orders
    torques = []
    for speed in speeds:
        rates = 2 * orders * speed
        excitation = np.zeros((2, len(orders)), dtype=complex)
        excitation[0] = (STIFFNESS + 1j * rates * DAMPING) * angles
        found, _ = assembly.ss_response(excitation, rates)
        twist = found[0, 0] - found[1, 0]
        torques.append(abs((2 * STIFFNESS + 1j * rates[0] * DAMPING) * twist))
    return np.array(torques)


def compared(speeds: np.ndarray) -> list[tuple[str, int, float]]:
    """Rows of the linear system, with the motions of both programs compared."""
    system, count = linear(), len(speeds)
    own = functools.partial(system.steady, speeds, 2 * np.arange(1, 9), workers=1)
    rows = [("steady, linear, two compliant, one thread", count, seconds(own, 3))]
    try:
        theirs = by_open_torsion(speeds)
    except ImportError:
        return rows
    torques = np.abs(own().torque_orders[1, :, 0])
    assert np.abs(theirs - torques).max() < 1e-8 * torques.max()
    taken = seconds(lambda: by_open_torsion(speeds), 3)
    return [*rows, ("openTorsion, linear, two masses, one thread", count, taken)]


def seconds(work: Callable[[], object], repeats: int) -> float:
    """The shortest of some runs."""
    times = []
    for _ in range(repeats):
        begin = time.perf_counter()
        work()
        times.append(time.perf_counter() - begin)
    return min(times)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--quick", action="store_true", help="a hundredth of the work")
    quick = parser.parse_args().quick
    count, size, repeats = (100, 30, 1) if quick else (10_000, 300, 3)
    speeds = np.linspace(40.0, 800.0, count)
    rows: list[tuple[str, int, float]] = []
    for name, system in (("one", one_spring()), ("two", two_springs())):
        for workers, threads in ((1, "one thread"), (-1, "all threads")):
            work = functools.partial(system.steady, speeds, workers=workers)
            rows.append((f"steady, {name} compliant, {threads}", count, seconds(work, repeats)))
    for law, part in (("viscous", 1), ("loss factor", 5), ("play", 20)):
        several = np.linspace(63.0, 272.0, max(count // (5 * part), 1))
        for workers, threads in ((1, "one thread"), (-1, "all threads")):
            work = functools.partial(engine(law).steady, several, [1.5, 3], workers=workers)
            rows.append((f"steady, engine, {law}, {threads}", len(several), seconds(work, 1)))
    mapped = seconds(lambda: stability_map(size), 1)
    rows.append((f"stability map, {size} x {size}", size * size, mapped))
    few = [70.0, 180.0, 350.0, 700.0]
    by_shooting = seconds(lambda: [shooting(speed) for speed in few], 1)
    rows.append(("SciPy, shooting, one compliant, one thread", len(few), by_shooting))
    rows += compared(speeds[:: max(count // 1000, 1)])
    for name, runs, duration in rows:
        print(f"{name:45} {duration:9.3f} s {duration / runs * 1e6:11.1f} us each")


if __name__ == "__main__":
    main()

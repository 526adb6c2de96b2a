"""Stability against Hill's equation in Fourier space, and against another choice of the unknown."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import cardan
from cardan import reference
from cardan.reference import torsion
from tiers import few

INF = float("inf")
STIFFNESS, INERTIA = 8000.0, 0.05
NATURAL = np.sqrt(STIFFNESS / INERTIA)


def edges(weight: NDArray[np.float64], periodic: bool) -> NDArray[np.float64]:
    """The least positive ``L`` for which ``y'' + L w y = 0`` has such a solution over half a turn.

    In the basis ``exp(i (2 n + 1) x)`` (or ``exp(2 i n x)`` if it is periodic) the equation is one
    of matrices, ``k^2 y = L W y``, with the Fourier coefficients of the weight.

    Args:
        weight: samples of ``w`` over half a turn.
        periodic: whether the solution repeats itself after half a turn, or changes its sign.
    """
    count = 48
    orders = 2 * np.arange(-count, count + 1) + (0 if periodic else 1)
    coefficients = np.fft.fft(weight).real / len(weight)
    between = (orders[:, np.newaxis] - orders) // 2
    matrix = coefficients[np.abs(between)]
    lower = np.linalg.inv(np.linalg.cholesky(matrix))
    values = np.linalg.eigvalsh(lower @ np.diag(orders.astype(float) ** 2) @ lower.T)
    return np.asarray(values[values > 1e-9])


@pytest.mark.parametrize("bend", [8.0, 20.0, 35.0])
def test_a_compensated_shaft_obeys_hills_equation(bend: float) -> None:
    # Two equal joints with a compliant shaft between them turn the flywheel uniformly, without
    # torque: rigid rotation is an orbit. A deviation y of the flywheel obeys y'' + L w y = 0 with
    # w, the square of the ratio of the first joint, and L, (natural frequency / speed)^2.
    line = cardan.Driveline.from_bends([bend, bend], phases=[0.0], twists=[180.0], degrees=True)
    assert float(line.equivalent().bend) < 1e-7
    system = cardan.TorsionalSystem(
        line,
        inertias=[[0.0, 0.0], [0.0, 0.0], [0.0, INERTIA]],
        stiffnesses=[INF, STIFFNESS, INF],
    )
    count, b = 256, np.radians(bend)
    angle = np.arange(count) * np.pi / count
    ratio = np.cos(b) / (1.0 - np.sin(b) ** 2 * np.cos(angle) ** 2)
    found = edges(ratio**2, periodic=False)[:4]
    # At these edges both multipliers are -1.
    multipliers = system.stability(NATURAL / np.sqrt(found)).multipliers
    assert multipliers.sum(axis=-1) == pytest.approx(-2.0, abs=1e-9)
    # At those of the next region both are 1, and the orbit is one of many.
    for low, high in (found[:2], edges(ratio**2, periodic=True)[:2]):
        gap = high - low
        around = np.array([low - gap, low + 0.1 * gap, high - 0.1 * gap, high + gap])
        stable = system.stability(NATURAL / np.sqrt(around)).stable
        assert stable.tolist() == [True, False, False, True]


def test_a_region_at_half_the_natural_frequency_is_found_between_the_speeds_given() -> None:
    system = cardan.TorsionalSystem(
        cardan.Driveline.from_bends([10.0, 40.0], phases=[45.0], degrees=True),
        inertias=[[0.0, 0.0], [0.0, 0.0], [0.0, INERTIA]],
        stiffnesses=[INF, STIFFNESS, INF],
    )
    (natural,) = system.natural_frequencies()
    given = float(natural) * np.array([0.45, 0.55])
    (region,) = system.unstable_ranges(given)
    every = np.linspace(given[0], given[1], 401)
    unstable = every[~system.stability(every).stable]
    step = every[1] - every[0]
    assert region.start == pytest.approx(unstable[0], abs=step)
    assert region.stop == pytest.approx(unstable[-1], abs=step)
    assert np.ptp(unstable) > 2.0 * step


def test_the_equation_about_rigid_rotation_is_whittakers_and_hills() -> None:
    # w = ((1 + m^2 + 2 m cos 2x)/(1 - m^2))^2 has the orders 2 and 4 only. Its edges are those that
    # the theory quotes for rigid rotation; those of the true orbit lie elsewhere.
    m = np.tan(np.radians(10.0)) ** 2
    angle = np.arange(256) * np.pi / 256
    found = edges(((1 + m**2 + 2 * m * np.cos(2 * angle)) / (1 - m**2)) ** 2, periodic=False)
    speeds = np.sort(1.0 / np.sqrt(found[:2]))
    assert speeds == pytest.approx([0.97157, 1.03375], abs=6e-6)
    system = cardan.TorsionalSystem(
        cardan.Driveline.from_bends([20.0], degrees=True),
        inertias=[[0.0, 0.0], [0.0, INERTIA]],
        stiffnesses=[STIFFNESS, INF],
    )
    middle = NATURAL * np.array([0.5 * (0.96762 + 0.97157), 0.5 * (1.02995 + 1.03375)])
    assert system.stability(middle).stable.tolist() == [False, True]


@pytest.mark.parametrize("speed", [0.45, 0.97, 1.0, 1.02, 1.3])
@pytest.mark.parametrize("load", [0.0, 150.0])
def test_multipliers_do_not_depend_on_the_unknown(speed: float, load: float) -> None:
    # The library's unknown is the angle of the shaft before the joint. Here it is that of the
    # flywheel behind it: J p'' = T dt/dp - load with the angle t(p) before the joint, the torque
    # T = c (a - t) + d (1 - dt/dp p') of the shaft, and the drive angle a as the variable.
    integrate = pytest.importorskip("scipy.integrate")
    bend, damping, drive = np.radians(20.0), 0.8, speed * NATURAL
    system = cardan.TorsionalSystem(
        cardan.Driveline.from_bends([bend]),
        inertias=[[0.0, 0.0], [0.0, INERTIA]],
        stiffnesses=[STIFFNESS, INF],
        dampings=[damping, 0.0],
        load_torque=load,
    )
    cosine = np.cos(bend)

    def before(p: float) -> tuple[float, float, float]:
        """The angle before the joint and two derivatives: tan p = tan t / cos b."""
        turns = np.round(p / np.pi) * np.pi
        below = np.cos(p) ** 2 + cosine**2 * np.sin(p) ** 2
        slope = (1.0 - cosine**2) * np.sin(2 * p)
        return (
            turns + np.arctan(cosine * np.tan(p - turns)),
            cosine / below,
            cosine * slope / below**2,
        )

    def slopes(a: float, state: NDArray[np.float64]) -> NDArray[np.float64]:
        p, rate = state[:2]
        deviations = state[2:].reshape(2, 2)
        t, first, second = before(p)
        spring, slip = STIFFNESS * (a - t), damping * drive * (1.0 - first * rate)
        scale = 1.0 / (INERTIA * drive**2)
        torque = spring + slip
        by_p = (-STIFFNESS * first - damping * drive * second * rate) * first + torque * second
        by_rate = -damping * drive * first**2
        changes = scale * (by_p * deviations[0] + by_rate * deviations[1])
        return np.concatenate([[rate, scale * (torque * first - load)], deviations[1], changes])

    def half_turn(start: NDArray[np.float64]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        full = np.concatenate([start, np.eye(2).ravel()])
        found = integrate.solve_ivp(
            slopes, (0.0, np.pi), full, method="DOP853", rtol=1e-12, atol=1e-13
        )
        end = found.y[:, -1]
        return end[:2] - [np.pi, 0.0], end[2:].reshape(2, 2)

    # At drive angle 0 the flywheel of the orbit stands where the joint puts it.
    orbit = system.orbit(drive, 1)
    start = np.array([orbit.angle_error[1, 1, 0], orbit.speed[1, 1, 0] / drive])
    end, matrix = half_turn(start)
    assert end == pytest.approx(start, abs=1e-8)
    own: Any = np.linalg.eigvals(matrix)
    multipliers = system.stability(drive).multipliers
    assert multipliers.sum() == pytest.approx(own.sum(), abs=2e-7)
    assert multipliers.prod() == pytest.approx(own.prod(), abs=2e-7)


def test_a_flywheel_on_a_spring_behind_all_joints_vibrates_freely() -> None:
    # What deviates from the orbit obeys J y'' + (d + b) y' + c y = 0, whatever the constant load.
    damping, viscous, speeds = 1.5, 0.4, np.array([90.0, 150.0, 420.0])
    system = cardan.TorsionalSystem(
        cardan.Driveline.from_bends([20.0], degrees=True),
        inertias=[[0.0, 0.0], [0.0, INERTIA]],
        stiffnesses=[INF, STIFFNESS],
        dampings=[0.0, damping],
        load_torque=300.0,
        load_damping=viscous,
    )
    decay = (damping + viscous) / (2 * INERTIA)
    roots = -decay + np.array([1j, -1j]) * np.sqrt(NATURAL**2 - decay**2)
    for speed, multipliers in zip(speeds, system.stability(speeds).multipliers, strict=True):
        exact = np.exp(roots * np.pi / speed)
        assert np.poly(multipliers) == pytest.approx(np.poly(exact), abs=1e-9)


@pytest.mark.parametrize("drive", few([110.0, 180.0, 300.0], [180.0]))
def test_multipliers_are_those_of_neighbouring_motions(drive: float) -> None:
    # Two compliant shafts, each behind a joint, and a third joint before a flywheel with a viscous
    # load: what each shaft passes on depends on the angles and on the slopes of its neighbours. The
    # motions begin beside the orbit and are integrated by the reference.
    bends = np.radians([25.0, 30.0, 35.0])
    own: dict[str, Any] = {
        "inertias": [(0.0, 0.0), (0.0, 0.03), (0.0, 0.01), (0.05, 0.0)],
        "stiffnesses": [INF, 9000.0, 7000.0, INF],
        "dampings": [0.0, 1.5, 1.0, 0.0],
        "load_torque": 40.0,
        "load_damping": 0.6,
    }
    system = cardan.TorsionalSystem(cardan.Driveline.from_bends(bends), **own)
    orbit, ends = system.orbit(drive, 1), [1, 2]
    assert orbit.found
    slow = torsion.System(reference.from_bends(bends.tolist()), **own)
    # Beside the orbit by a constant, which Newton's method corrects: the library takes the means of
    # the rigid pieces between springs.
    zeros = np.array([torsion.zero_of(slow, shaft) for shaft in ends])
    angles, speeds = orbit.angle_error[ends, 1, 0], orbit.speed[ends, 1, 0]
    start = np.concatenate([[0.0], angles + zeros, [drive], speeds])
    known = torsion.orbit(slow, drive, start, steps=400)
    assert known.state[4:] == pytest.approx(speeds, rel=1e-8)
    found = system.stability(drive).multipliers
    # The coefficients of the characteristic polynomial do not depend on an order.
    assert np.poly(found) == pytest.approx(np.poly(known.multipliers), abs=1e-6)


def test_modes_are_those_of_a_chain_of_two_masses() -> None:
    """Generalised eigenvectors of a chain of which the unknowns are the output ends of shafts."""
    system = cardan.TorsionalSystem(
        cardan.Driveline.from_bends([0.0, 0.0]),
        inertias=[[0.0, 0.02], [0.01, 0.03], [0.0, 0.05]],
        stiffnesses=[5000.0, 3000.0, INF],
        dampings=[2.0, 0.5, 0.0],
    )
    inertia = np.diag([0.03, 0.08])
    stiffness = np.array([[8000.0, -3000.0], [-3000.0, 3000.0]])
    damping = np.array([[2.5, -0.5], [-0.5, 0.5]])
    values, vectors = np.linalg.eig(np.linalg.inv(inertia) @ stiffness)
    order = np.argsort(values)
    for mode, value, shape in zip(system.modes(), values[order], vectors.T[order], strict=True):
        assert mode.frequency == pytest.approx(np.sqrt(value), rel=1e-9)
        energy = np.array([5000.0, 3000.0]) * np.array([shape[0], shape[1] - shape[0]]) ** 2
        assert mode.shares == pytest.approx(energy / energy.sum(), abs=1e-7)
        assert mode.shaft == int(np.argmax(energy))
        ratio = shape @ damping @ shape / (2.0 * mode.frequency * (shape @ inertia @ shape))
        assert mode.damping_ratio == pytest.approx(ratio, rel=1e-6)


@pytest.mark.parametrize(("factor", "exceeded"), [(0.99, True), (1.01, False)])
def test_the_rule_of_the_bend_and_its_edges(factor: float, exceeded: bool) -> None:
    system = cardan.TorsionalSystem(
        cardan.Driveline.from_bends([20.0], degrees=True),
        inertias=[[0.0, 0.0], [0.0, INERTIA]],
        stiffnesses=[STIFFNESS, INF],
        damping_ratios=factor * np.tan(np.radians(10.0)) ** 2,
    )
    (rule,) = system.bend_rules()
    assert (rule.exceeded, rule.shaft) == (exceeded, 0)
    # To leading order the region is as wide as half the squared bend.
    (found,) = system.changed().unstable_ranges(NATURAL * np.array([0.5, 1.5])) or [None]
    assert (found is not None) == exceeded
    assert rule.edges[1] - rule.edges[0] == pytest.approx(0.5 * rule.bend**2 * rule.speed)


def test_a_map_of_stability_is_that_of_each_system() -> None:
    line = cardan.Driveline.from_bends([20.0, 5.0], degrees=True)
    shafts: dict[str, Any] = {
        "inertias": [[0.0, 0.0], [0.0, 0.0], [0.0, INERTIA]],
        "stiffnesses": [STIFFNESS, INF, INF],
    }
    system = cardan.TorsionalSystem(line, **shafts)
    speed, bend = NATURAL * np.array([0.9, 1.0, 1.1]), np.radians([1.0, 25.0])
    found = system.stability_map(speed, bend)
    assert found.joint == 0
    assert found.stable.shape == (2, 3)
    for i, own in enumerate((1.0, 25.0)):
        alone = cardan.TorsionalSystem(
            cardan.Driveline.from_bends([own, 5.0], degrees=True), **shafts
        ).stability(speed)
        assert found.stable[i].tolist() == alone.stable.tolist()
        assert found.largest[i] == pytest.approx(np.abs(alone.multipliers[:, 0]), rel=1e-9)
    with pytest.raises(ValueError, match="joint is 2; there are 2, counted from 0"):
        system.stability_map(speed, bend, 2)


def test_methods_of_one_system_refuse_a_batch() -> None:
    batch = cardan.TorsionalSystem(
        cardan.Driveline.from_bends([[10.0], [20.0]], degrees=True),
        inertias=[[0.0, 0.0], [0.0, INERTIA]],
        stiffnesses=[STIFFNESS, INF],
    )
    for ask in (
        batch.modes,
        batch.bend_rules,
        lambda: batch.unstable_ranges([1.0, 2.0]),
        lambda: batch.stability_map([1.0], [0.1]),
        lambda: batch.side_by_side([1.0]),
    ):
        with pytest.raises(ValueError, match=r"batch of shape \(2,\); ask one of them"):
            ask()
    system = cardan.TorsionalSystem(
        cardan.Driveline.from_bends([0.1]),
        inertias=[[0.0, 0.0], [0.0, INERTIA]],
        stiffnesses=[STIFFNESS, INF],
    )
    for speeds in ([2.0, 1.0], []):
        with pytest.raises(ValueError, match="must be a list of rising speeds"):
            system.unstable_ranges(speeds)

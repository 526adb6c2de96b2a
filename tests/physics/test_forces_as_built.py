"""Forces of joints as built, against the equilibrium of all shafts and the vectors of the pins.

``tests/equilibrium.py`` has the equations, ``tests/deviation_oracle.py`` the pins, and moments that
follow from them alone. Neither shares a formula with the library.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest

from cardan import Driveline, Load, Sweep, _core
from deviation_oracle import LeaningFrames
from equilibrium import BearingPlace, assignments, forces
from oracle import Doubles, Exact, ExactTurn, plan_at
from test_forces import (
    KINDS,
    LIMITS,
    TRUCK,
    Assignment,
    driveline,
    exact,
    load_of,
    mounted,
    shortest_span,
)
from vectors import ExactLoads

FORCES = ("joint_force", "bearing_force")
ANGLES = np.array([-2.9, -0.4, 1.3, 2.7])


def leaning(rng: np.random.Generator, line: Driveline, most: float = 0.05) -> Driveline:
    """Return the driveline with deviations up to this size, or a quarter of what blocks a joint."""
    room = np.minimum(most, 0.25 * (0.5 * np.pi - line.bends))
    return line.with_deviations(*(rng.uniform(-1.0, 1.0, (3, line.n_joints)) * room))


DETERMINATE: list[tuple[int, ...]] = [
    counts
    for n in (1, 2, 3)
    for counts in itertools.product(range(3), repeat=n + 1)
    if len(list(assignments(n, counts))) == 1 and any(counts)
]


@pytest.mark.parametrize("counts", DETERMINATE)
def test_every_arrangement_is_in_equilibrium(counts: tuple[int, ...]) -> None:
    n = len(counts) - 1
    rng = np.random.default_rng([*counts, 1])
    line, bearings = mounted(rng, driveline(rng, n), counts)
    built, load = leaning(rng, line), load_of(rng, n)
    (way,) = assignments(n, counts)
    angle = float(rng.uniform(-4.0, 4.0))
    got = built.evaluate([angle], FORCES, load=Load(**load), tolerance=rng.choice([0.0, 1e-15]))
    exact_loads = ExactLoads.of(LeaningFrames.of(built), ExactTurn.by(angle), **load)
    moments = np.array(exact_loads.moment, float)
    of_bearings, of_joints = forces(line.directions, line._geometry.lengths, moments, bearings, way)
    size = max(np.abs(of_joints).max(), np.abs(of_bearings).max())
    np.testing.assert_allclose(got.bearing_force[:, 0], of_bearings, rtol=0, atol=1e-12 * size)
    np.testing.assert_allclose(got.joint_force[:, 0], of_joints, rtol=0, atol=1e-12 * size)
    ideal = line.evaluate([angle], FORCES, load=Load(**load))
    assert np.abs(ideal.bearing_force - got.bearing_force).max() > 1e-4 * size


def errors(
    line: Driveline,
    bearings: Sequence[BearingPlace],
    way: Assignment,
    angles: Doubles,
    load: dict[str, Any],
) -> dict[str, list[float]]:
    """Return the largest errors, with error terms and without.

    They are in ulp of the largest force of the driveline over the turn; without error terms, of the
    largest bending moment over the smallest distance between the supports of a shaft if that is
    larger, since terms of this size may cancel.
    """
    names = FORCES if bearings else FORCES[:1]
    turn = Sweep.revolutions(1, 512)
    bending = ("bending_driving", "bending_driven")
    peaks = line.evaluate(turn, (*names, *bending), load=Load(**load), reduce="peak")
    of_forces = max(float(np.max(peaks[name])) for name in names)
    largest = max(float(np.max(peaks[name])) for name in bending)
    terms = largest / shortest_span(line, bearings, way)
    frames, wanted = LeaningFrames.of(line), []
    for angle in angles.tolist():
        loads = ExactLoads.of(frames, ExactTurn.by(angle), **load)
        wanted.append(exact(line, frames, loads, bearings, way))
    found: dict[str, list[float]] = {name: [] for name in names}
    for tolerance, size in ((0.0, of_forces), (None, max(of_forces, terms))):
        got = line.evaluate(angles, names, load=Load(**load), tolerance=tolerance)
        unit, worst = np.spacing(size), dict.fromkeys(names, 0.0)
        for sample, at in enumerate(wanted):
            for name in names:
                for vector, own in zip(got[name][:, sample], at[name], strict=True):
                    off = Exact.of(own).distance(vector).max() / unit
                    worst[name] = max(worst[name], float(off))
        for name in names:
            found[name].append(worst[name])
    return found


@pytest.mark.parametrize("kind", KINDS)
def test_errors_in_ulp(kind: str) -> None:
    counts, steepest = KINDS[kind]
    n = len(counts) - 1
    rng = np.random.default_rng([len(kind), len(counts), 2])
    (way,) = assignments(n, counts)
    for _ in range(3):
        line, bearings = mounted(rng, driveline(rng, n, steepest), counts)
        load = load_of(rng, n)
        if rng.random() < 0.6:
            load = {name: load[name] for name in load if "torque" in name}
        found = errors(leaning(rng, line), bearings, way, rng.uniform(-4, 4, 2), load)
        for name, own in found.items():
            allowed = [LIMITS[name][tier] for tier in ("tolerance_0", "default")]
            assert np.all(np.array(own) <= allowed), f"{kind}, {name}: {own} of {allowed} ulp"


def truck(seed: int = 3) -> tuple[Driveline, Driveline, Load]:
    """A driveline with bearings, the same with deviations, and a load with inertias."""
    rng = np.random.default_rng(seed)
    line, _ = mounted(rng, driveline(rng, 3), TRUCK)
    return line, leaning(rng, line), Load(**load_of(rng, 3))


def test_forces_of_small_deviations_are_those_of_the_drawing() -> None:
    line, _, load = truck()
    near = line.with_deviations([1e-13, 0.0, 0.0], 0.0, [0.0, 0.0, -1e-13])
    for tolerance in (None, 0):
        one, other = (
            x.evaluate(ANGLES, FORCES, load=load, tolerance=tolerance) for x in (near, line)
        )
        for name in FORCES:
            size = np.abs(other[name]).max()
            np.testing.assert_allclose(one[name], other[name], rtol=0, atol=1e-11 * size)


def test_a_floating_shaft_passes_its_support_moment_on_as_a_pair() -> None:
    rng = np.random.default_rng(1)
    line = leaning(rng, driveline(rng, 2))
    got = line.evaluate(
        ANGLES, ("joint_force", "support_moment"), shafts=1, load=Load(drive_torque=9.0)
    )
    pair = np.cross(line.directions[1], got.support_moment) / line._geometry.lengths[1]
    np.testing.assert_allclose(got.joint_force, [pair, pair], atol=1e-13 * np.abs(pair).max())


def test_batches_sweeps_threads_and_levels() -> None:
    line, built, load = truck()
    # Each row is asked for alone, in a batch, and sample by sample.
    rows = [built, line.with_deviations(0.01, [0.0, 0.02, 0.0]), built.with_deviations(0.0, 0.001)]
    batch = Driveline.concatenate(rows)
    angles = np.linspace(-3.0, 9.0, 3001)
    together = batch[:, np.newaxis].evaluate(angles, FORCES, load=load, workers=1)
    by_sample = batch.evaluate(0.7, FORCES, load=load)
    for i, own in enumerate(rows):
        alone = own.evaluate(angles, FORCES, load=load, workers=2)
        at = own.evaluate(0.7, FORCES, load=load)
        for level in _core.levels():
            same = plan_at(own, FORCES, load=load, level=level)(angles)
            for name in FORCES:
                assert same[name].tobytes() == alone[name].tobytes(), (name, level)
        for name in FORCES:
            assert np.array_equal(together[name][:, i], alone[name]), name
            assert np.array_equal(by_sample[name][:, i], at[name]), name
    sweep = Sweep(0.3, 5.0, 721)
    for tolerance in (None, 0, 1e-12, 1e-6):
        one, two = (
            built.evaluate(x, FORCES, load=load, tolerance=tolerance)
            for x in (sweep, np.asarray(sweep))
        )
        for name in FORCES:
            size = np.abs(two[name]).max()
            np.testing.assert_allclose(one[name], two[name], rtol=0, atol=1e-13 * size)
    single = built.evaluate(angles, FORCES, load=load, dtype="float32")
    for name in FORCES:
        wanted = built.evaluate(angles, FORCES, load=load)[name].astype(np.float32)
        assert np.array_equal(single[name], wanted), name


def test_reductions_are_those_of_the_samples() -> None:
    _, built, load = truck()
    turn = Sweep.revolutions(1, 360)
    samples = built.evaluate(turn, FORCES, load=load)
    for name in FORCES:
        found = built.evaluate(turn, name, load=load, reduce="mean")[name]
        peak = built.evaluate(turn, name, load=load, reduce="peak")[name]
        sizes = np.linalg.norm(samples[name], axis=-1)
        size = sizes.max()
        mean = samples[name].mean(axis=-2)
        np.testing.assert_allclose(found, mean, rtol=0, atol=1e-13 * size)
        np.testing.assert_allclose(peak, sizes.max(axis=-1), rtol=1e-13)


def test_orders_are_those_of_samples_and_odd_ones_appear() -> None:
    line, built, load = truck()
    turn = np.arange(4096) * (2.0 * math.pi / 4096)
    orders = [1, 2, 3, 4]
    ideal = line.harmonics(orders, outputs=FORCES, load=load)
    found = built.harmonics(orders, outputs=FORCES, load=load)
    samples = built.evaluate(turn, FORCES, load=load)
    for name in FORCES:
        size = np.abs(samples[name]).max()
        spectrum = 2.0 * np.fft.rfft(samples[name], axis=1)[:, 1:5] / 4096
        got = np.moveaxis(found.complex_amplitude[name], -1, 1)
        np.testing.assert_allclose(got, spectrum, rtol=0, atol=1e-12 * size)
        assert np.abs(spectrum[:, 0]).max() > 1e-3 * size
        assert np.abs(ideal.amplitude[name][..., ::2]).max() == 0.0


def test_nan_stays_with_its_sample() -> None:
    _, built, load = truck()
    found = built.evaluate([0.3, np.nan, 0.3], FORCES, load=load)
    for name in FORCES:
        assert np.array_equal(np.isnan(found[name]).all(axis=(0, 2)), [False, True, False]), name
        assert np.array_equal(found[name][:, 0], found[name][:, 2])


SHAFTS = (0, 3, 1, 0, 3)
GIVEN: dict[str, Doubles] = {
    "bends": np.array([0.3, 0.2, 0.4]),
    "twists": np.array([0.3, -1.0]),
    "phases": np.array([0.5, 2.0]),
    "deviations": np.array([[0.01, 0.03, -0.02], [0.02, 0.0, 0.01], [-0.01, 0.02, 0.005]]),
    "lengths": np.array([0.4, 1.1, 1.3, 0.6]),
    "positions": np.array([0.1, 0.4, 0.75, 0.35, 0.2]),
    "inertias": np.array([0.1, 0.2, 0.3, 0.4]),
    "output_torque": np.array(-80.0),
    "angle": np.array([0.4, -2.1]),
}


def plan_of(given: dict[str, Doubles], **options: Any) -> Any:  # noqa: ANN401 - a plan
    line = Driveline.from_bends(given["bends"], given["twists"], given["phases"])
    bearings = list(zip(SHAFTS, given["positions"].tolist(), strict=True))
    line = line.with_bearings(bearings, given["lengths"])
    load = Load(
        output_torque=float(given["output_torque"]),
        speed=20.0,
        acceleration=5.0,
        inertias=given["inertias"],
    )
    return line.with_deviations(*given["deviations"].T).plan(FORCES, load=load, **options)


def shifted(kind: str, place: Sequence[int], by: float) -> dict[str, Doubles]:
    own = {name: array.copy() for name, array in GIVEN.items()}
    own[kind][... if kind == "angle" else tuple(place)] += by
    return own


@pytest.mark.parametrize("kind", GIVEN)
def test_derivatives_are_differences(kind: str) -> None:
    """Differences over one and two steps, extrapolated, with error terms carried."""
    step = 1e-4
    found = plan_of(GIVEN).derivatives(GIVEN["angle"], kind)
    places = [()] if kind == "angle" else [*np.ndindex(GIVEN[kind].shape)]
    for place in places:
        at = {}
        for k in (-2, -1, 1, 2):
            own = shifted(kind, place, k * step)
            at[k] = plan_of(own, tolerance=0)(own["angle"])
        for name in FORCES:
            near, far = at[1][name] - at[-1][name], at[2][name] - at[-2][name]
            wanted = (8.0 * near - far) / (12.0 * step)
            got = found[name][kind][(..., *place)]
            np.testing.assert_allclose(
                got, wanted, rtol=0, atol=1e-9 * max(1.0, np.abs(wanted).max())
            )


def test_gradients_are_weighted_sums_of_derivatives() -> None:
    plan, turn = plan_of(GIVEN), Sweep.revolutions(1, 45)
    rng = np.random.default_rng(5)
    weights = {
        "joint_force": rng.normal(size=(3, 45, 3)),
        "bearing_force": rng.normal(size=(5, 45, 3)),
    }
    found, at = plan.gradient(turn, weights), plan(turn)
    kinds = [kind for kind in GIVEN if kind != "angle"]
    each = plan.derivatives(turn, kinds)
    value = sum(np.sum(weights[name] * at[name]) for name in FORCES)
    assert found.value == pytest.approx(value, rel=1e-12)
    for kind in kinds:
        wanted = sum(np.tensordot(weights[name], each[name][kind], 3) for name in FORCES)
        size = np.abs(wanted).max()
        np.testing.assert_allclose(getattr(found, kind), wanted, rtol=0, atol=1e-12 * size)


# --- derivatives -------------------------------------------------------------------------------


def test_derivatives_by_deviations_of_ideal_joints_are_the_change_to_first_order() -> None:
    line, _, load = truck()
    angle, step = np.array([0.4, 2.0]), 1e-5
    found = line.plan(FORCES, load=load).derivatives(angle, "deviations")
    for place in np.ndindex(3, 3):
        ends = []
        for sign in (1.0, -1.0):
            own = np.zeros((3, 3))
            own[place] = sign * step
            ends.append(
                line.with_deviations(*own.T).evaluate(angle, FORCES, load=load, tolerance=0)
            )
        for name in FORCES:
            wanted = (ends[0][name] - ends[1][name]) / (2.0 * step)
            got = found[name]["deviations"][(..., *place)]
            np.testing.assert_allclose(got, wanted, rtol=0, atol=1e-7 * np.abs(wanted).max())


# --- tolerances --------------------------------------------------------------------------------


def test_tolerances_of_forces_are_those_of_the_drivelines() -> None:
    line, _, load = truck()
    halves: dict[str, Any] = {"driving_yoke": [0.004, 0.0, 0.002], "driven_yoke": 0.003}
    of = ("bearing_force_1_peak", "joint_force_2_peak")
    found = line.tolerances(**halves, of=of, load=load, samples=40, seed=1)
    signs = np.array([*itertools.product((-1.0, 1.0), repeat=5)])
    driving = np.insert(signs[:, :2], 1, 0.0, axis=1) * halves["driving_yoke"]
    corners = line.with_deviations(driving, 0.0, 0.003 * signs[:, 2:])
    turn = Sweep.revolutions(1, 360)
    for name in of:
        output, item, _ = name.rsplit("_", 2)
        at = corners[:, np.newaxis].evaluate(turn, output, load=load, reduce="peak")[output]
        assert float(found.worst[name]) == pytest.approx(at[int(item)].max(), rel=1e-9)
        assert np.max(found.sampled[name]) <= found.worst[name]
        assert found.linear[name] == pytest.approx(float(found.worst[name]), rel=1e-3)
        total = sum(float(np.sum(part)) for part in found.shares[name].values())
        assert total == pytest.approx(1.0)

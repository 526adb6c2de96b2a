"""Derivatives of forces, in turning axes and at driven angles, against differences in 60 digits."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from cardan import Driveline, Load
from cardan.evaluation.plan import Plan
from derivative_oracle import (
    BearingPlaces,
    differences,
    drive_angle,
    from_angles,
    from_points,
    numbers,
    outputs,
)
from oracle import mp
from tiers import part

ANGLES = [0.4, -2.1][: part(2)]
FORCES = ("joint_force", "bearing_force")
LOADS: dict[str, dict[str, Any]] = {
    "drive": {"drive_torque": 120.0, "speed": 20.0, "inertias": [0.1, 0.2, 0.3, 0.4]},
    "output": {
        "output_torque": -80.0,
        "speed": 30.0,
        "acceleration": 50.0,
        "inertias": [0.3, 0.2, 0.1, 0.4],
    },
}
# Bends, twists and phases; then shaft and position of each bearing, and lengths.
Chain = tuple[list[float], list[float], list[float]]
CHAINS: dict[str, tuple[Chain, list[tuple[int, float]], list[float]]] = {
    "floating": (([0.5, 0.8], [0.4], [1.0]), [], [0.3, 0.7, 0.4]),
    "truck": (
        ([0.3, 0.2, 0.4], [0.3, -1.0], [0.5, 2.0]),
        [(0, 0.1), (3, 0.4), (1, 0.75), (0, 0.35), (3, 0.2)],
        [0.4, 1.1, 1.3, 0.6],
    ),
    "one after another": (
        ([0.6, 0.3], [-0.7], [0.2]),
        [(0, 0.2), (1, 0.6), (1, 0.2), (2, 0.3)],
        [0.5, 0.8, 0.5],
    ),
    "straight": (
        ([0.3, 0.0], [0.3], [0.5]),
        [(0, 0.1), (0, 0.3), (2, 0.2), (2, 0.4)],
        [0.4, 1.1, 0.6],
    ),
}


def close(got: Any, want: Any, scale: float, what: object) -> None:  # noqa: ANN401
    largest = max(scale, float(np.max(np.abs(want), initial=0.0)))
    error = np.max(np.abs(np.reshape(got, np.shape(want)) - want), initial=0.0)
    assert error <= 1e-9 * largest, what


def split(x: list[Any], lengths: Sequence[int]) -> list[list[Any]]:
    ends = np.cumsum(lengths)
    return [x[end - length : end] for end, length in zip(ends, lengths, strict=True)]


@pytest.mark.parametrize("loaded", LOADS)
@pytest.mark.parametrize("name", CHAINS)
def test_forces_by_everything(name: str, loaded: str) -> None:
    (bends, twists, phases), bearings, lengths = CHAINS[name]
    n = len(bends)
    load = {**LOADS[loaded], "inertias": LOADS[loaded]["inertias"][: n + 1]}
    torque = next(key for key in load if key.endswith("_torque"))
    line = Driveline.from_bends(bends, twists, phases).with_bearings(bearings, lengths)
    names = FORCES if bearings else FORCES[:1]
    by = ["bends", "twists", "phases", "angle", torque, "inertias", "lengths"]
    by += ["positions"] if bearings else []
    plan = line.plan(names, load=Load(**load))
    found = plan.derivatives(ANGLES, by)
    shafts = [shaft for shaft, _ in bearings]
    counts = [n, n - 1, n - 1, 1, 1, n + 1, n + 1, len(bearings)]
    for i, angle in enumerate(ANGLES):

        def of(x: list[Any]) -> dict[str, list[Any]]:
            b, t, p, a, d, inertias, spans, places = split(x, counts)
            changed = {**load, torque: d[0], "inertias": inertias}
            return outputs(
                from_angles(b, t, p), a[0], changed, BearingPlaces(shafts, places, spans)
            )

        places = [at for _, at in bearings]
        whole = [*bends, *twists, *phases, angle, load[torque], *load["inertias"]]
        want = differences(of, numbers([*whole, *lengths, *places]))
        for output in names:
            value = float(np.max(np.abs(plan([angle])[output])))
            start = 0
            for kind, count in zip(by, counts, strict=False):
                part = want[output][:, start : start + count]
                close(found[output][kind][:, i], part, 1e-3 * value, (output, kind, angle))
                start += count


@pytest.mark.parametrize("loaded", LOADS)
def test_forces_by_points(loaded: str) -> None:
    points: list[list[float]] = [
        [0, 0, 0],
        [1, 0.125, 0],
        [2, 0.25, 0.5],
        [3.25, 0.25, 0.375],
        [4, 0, 0.5],
    ]
    phases = [0.5, 2.0]
    places = [(3, 0.25), (0, 0.375), (0, 0.75), (1, 0.5), (3, 0.5)]
    load = LOADS[loaded]
    line = Driveline.from_points(points, phases).with_bearings(places)
    plan = line.plan(FORCES, load=Load(**load))
    found = plan.derivatives(ANGLES, "points")
    for i, angle in enumerate(ANGLES):

        def of(x: list[Any], a: float = angle) -> dict[str, list[Any]]:
            corners = [x[k : k + 3] for k in range(0, len(x), 3)]
            spans = [
                mp.sqrt(sum((q - p) ** 2 for p, q in zip(*ends, strict=True)))
                for ends in pairwise(corners)
            ]
            mounting = BearingPlaces(
                [s for s, _ in places], numbers([at for _, at in places]), spans
            )
            return outputs(from_points(x, numbers(phases)), mp.mpf(a), load, mounting)

        want = differences(of, numbers(points))
        for output in FORCES:
            close(found[output]["points"][:, i], want[output], 0.0, (output, angle))


@pytest.mark.parametrize("loaded", LOADS)
@pytest.mark.parametrize("name", ["truck", "straight"])
def test_moments_in_turning_axes(name: str, loaded: str) -> None:
    (bends, twists, phases), _, _ = CHAINS[name]
    n = len(bends)
    load = {**LOADS[loaded], "inertias": LOADS[loaded]["inertias"][: n + 1]}
    torque = next(key for key in load if key.endswith("_torque"))
    by = ("bends", "twists", "phases", "angle", torque, "inertias")
    counts = [n, n - 1, n - 1, 1, 1, n + 1]
    names = ("moment", "support_moment")
    line = Driveline.from_bends(bends, twists, phases)
    plan = line.plan(names, shafts=slice(None), load=Load(**load), axes="shaft")
    found = plan.derivatives(ANGLES, by)
    for i, angle in enumerate(ANGLES):

        def of(x: list[Any]) -> dict[str, list[Any]]:
            b, t, p, a, d, inertias = split(x, counts)
            return outputs(from_angles(b, t, p), a[0], {**load, torque: d[0], "inertias": inertias})

        whole = [*bends, *twists, *phases, angle, load[torque], *load["inertias"]]
        want = differences(of, numbers(whole))
        for output in names:
            value, start = float(np.max(np.abs(plan([angle])[output]))), 0
            for kind, count in zip(by, counts, strict=True):
                part = want[f"turning_{output}"][:, start : start + count]
                close(found[output][kind][:, i], part, 1e-3 * value, (output, kind, angle))
                start += count


@pytest.mark.parametrize("reduce", [None, "rms"])
@pytest.mark.parametrize("name", FORCES)
def test_forces_in_turning_axes_are_refused(name: str, reduce: Any) -> None:  # noqa: ANN401
    (bends, twists, phases), bearings, lengths = CHAINS["truck"]
    line = Driveline.from_bends(bends, twists, phases).with_bearings(bearings, lengths)
    load = Load(**LOADS["output"])
    plan = line.plan(("speed_ratio", name), load=load, axes="shaft", reduce=reduce)
    with pytest.raises(ValueError, match=f"axes is 'shaft'; derivatives of {name} are known in"):
        plan.derivatives(ANGLES, "phases")
    with pytest.raises(ValueError, match=f"axes is 'shaft'; derivatives of {name} are known in"):
        plan.gradient(ANGLES, {"speed_ratio": 1.0})


def test_moments_in_turning_axes_are_smooth_by_points_at_straight_joints() -> None:
    points: list[list[float]] = [[0, 0, 0], [1, 0.25, 0], [2, 0.25, 0.5], [3, 0.25, 1], [4, 0.5, 1]]
    phases, names = [0.5, 2.0], ("moment", "support_moment")
    line = Driveline.from_points(points, phases)
    assert line.bends.min() == 0.0
    plan = line.plan(names, shafts=slice(None), load=Load(**LOADS["output"]), axes="shaft")
    found = plan.derivatives(ANGLES, "points")
    for i, angle in enumerate(ANGLES):

        def of(x: list[Any], a: float = angle) -> dict[str, list[Any]]:
            return outputs(from_points(x, numbers(phases)), mp.mpf(a), LOADS["output"])

        want = differences(of, numbers(points))
        for output in names:
            value = float(np.max(np.abs(plan([angle])[output])))
            close(found[output]["points"][:, i], want[f"turning_{output}"], value, (output, angle))


DRIVEN = (
    *("angle", "speed_ratio", "acceleration_ratio", "jerk_ratio", "tilt_driving", "torque"),
    *("bending_driven", "moment", *FORCES),
)


@pytest.mark.parametrize("loaded", LOADS)
def test_derivatives_at_angles_of_the_last_shaft(loaded: str) -> None:
    (bends, twists, phases), bearings, lengths = CHAINS["truck"]
    load, n = LOADS[loaded], len(bends)
    torque = next(key for key in load if key.endswith("_torque"))
    by = ("bends", "twists", "phases", "angle", torque, "inertias", "lengths", "positions")
    counts = [n, n - 1, n - 1, 1, 1, n + 1, n + 1, len(bearings)]
    line = Driveline.from_bends(bends, twists, phases).with_bearings(bearings, lengths)
    plan = line.plan(DRIVEN, shafts=slice(None), load=Load(**load), angle_of="driven")
    found = plan.derivatives(ANGLES, by)
    shafts = [shaft for shaft, _ in bearings]
    for i, angle in enumerate(ANGLES):

        def of(x: list[Any], start: float = angle) -> dict[str, list[Any]]:
            b, t, p, a, d, inertias, spans, places = split(x, counts)
            frames = from_angles(b, t, p)
            drive = drive_angle(frames.folds[-1], a[0], start)
            changed = {**load, torque: d[0], "inertias": inertias}
            return outputs(frames, drive, changed, BearingPlaces(shafts, places, spans))

        whole = [*bends, *twists, *phases, angle, load[torque], *load["inertias"], *lengths]
        want = differences(of, numbers([*whole, *(at for _, at in bearings)]))
        for output in DRIVEN:
            value, start = float(np.max(np.abs(plan([angle])[output]))), 0
            for kind, count in zip(by, counts, strict=True):
                part = want[output][:, start : start + count]
                scale = 1e-3 * value if kind in by[4:] else value
                close(found[output][kind][:, i], part, scale, (output, kind, angle))
                start += count


def test_an_earlier_shaft_at_angles_of_the_last_one_has_derivatives_by_all_joints() -> None:
    (bends, twists, phases), *_ = CHAINS["truck"]

    def changed(by: float, joint: int) -> Plan:
        own = np.array(bends)
        own[joint] += by
        line = Driveline.from_bends(own, twists, phases)
        return line.plan("speed_ratio", shafts=1, angle_of="driven")

    plan, angles = changed(0.0, 0), np.linspace(-3.0, 3.0, 7)
    found = plan.derivatives(angles, "bends")["speed_ratio"]["bends"]
    total = plan.gradient(angles, {"speed_ratio": 1.0}).bends
    step = 1e-5
    for joint in range(len(bends)):
        above, below = (changed(by, joint)(angles).speed_ratio for by in (step, -step))
        slope = (above - below) / (2 * step)
        assert np.max(np.abs(slope)) > 1e-3
        assert found[:, joint] == pytest.approx(slope, abs=1e-8)
        assert total[joint] == pytest.approx(slope.sum(), abs=1e-8)


def test_gradients_are_sums_of_these_derivatives() -> None:
    (bends, twists, phases), bearings, lengths = CHAINS["truck"]
    line = Driveline.from_bends(bends, twists, phases).with_bearings(bearings, lengths)
    angle, rng = np.linspace(-3.0, 9.0, 1001), np.random.default_rng(5)
    load = Load(**LOADS["drive"])
    by = ("bends", "twists", "phases", "drive_torque", "inertias", "lengths", "positions")
    cases: list[tuple[tuple[str, ...], dict[str, Any]]] = [
        (FORCES, {}),
        ((*FORCES, "moment"), {"angle_of": "driven"}),
        (("speed_ratio", "angle_error"), {"angle_of": "driven"}),
        (("moment", "support_moment", "torque"), {"axes": "shaft"}),
        (("support_moment", "tilt_driven"), {"axes": "shaft", "angle_of": "driven"}),
    ]
    for names, options in cases:
        plan = line.plan(names, shafts=slice(None), load=load, **options)
        result, derivatives = plan(angle), plan.derivatives(angle, by)
        weights = {name: rng.normal(size=result[name].shape) for name in names}
        found = plan.gradient(angle, weights)
        value = sum(float(np.sum(weights[name] * result[name])) for name in names)
        close(found.value, value, 0.0, names)
        for kind in by:
            want = sum(
                np.tensordot(weights[name], derivatives[name][kind], weights[name].ndim)
                for name in names
            )
            scale = float(np.max(np.abs(found.bends)))
            close(getattr(found, kind), want, 1e-3 * scale, (names, kind))

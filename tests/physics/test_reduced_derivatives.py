"""Derivatives of reduced outputs against differences in 60 digits of the reduced oracle."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import cardan
from cardan import Driveline, Load
from derivative_oracle import differences, from_angles, numbers, outputs
from oracle import mp

BENDS, TWISTS, PHASES = [0.3, 0.5], [0.4], [-1.0]
ANGLES = np.linspace(0.1, 3.0, 9)
LOAD: dict[str, Any] = {"output_torque": 9.0, "speed": 5.0, "inertias": [0.1, 0.2, 0.3]}
SCALARS = ("speed_ratio", "angle_error", "acceleration_ratio", "bending_driven")
NAMES = (*SCALARS, "moment")


def reduced(reduce: str, samples: list[Any]) -> Any:  # noqa: ANN401 - of any arithmetic
    """Reduce numbers, or lists of components."""
    if reduce == "peak":
        return max(mp.sqrt(sum(x * x for x in sample)) for sample in samples)
    columns = [*zip(*samples, strict=True)]
    count = len(samples)
    formulas: dict[str, Any] = {
        "min": min,
        "max": max,
        "mean": lambda column: sum(column) / count,
        "rms": lambda column: mp.sqrt(sum(x * x for x in column) / count),
    }
    return [formulas[reduce](column) for column in columns]


@pytest.mark.parametrize("reduce", ["min", "max", "mean", "rms", "peak"])
def test_reduced_outputs(reduce: Any) -> None:  # noqa: ANN401
    line = Driveline.from_bends(BENDS, TWISTS, PHASES)
    plan = line.plan(NAMES, shafts=-1, joints=1, load=Load(**LOAD), reduce=reduce)
    by = ("bends", "twists", "phases", "output_torque", "inertias")
    found = plan.derivatives(ANGLES, by)
    counts = [2, 1, 1, 1, 3]

    def of(x: list[Any]) -> dict[str, list[Any]]:
        load = {**LOAD, "output_torque": x[4], "inertias": x[5:]}
        frames = from_angles(x[:2], x[2:3], x[3:4])
        samples = [outputs(frames, angle, load) for angle in numbers(ANGLES)]
        # Of the last shaft or joint, whose components are the last.
        last = {name: 3 if cardan.OUTPUTS[name].vector else 1 for name in NAMES}
        rows = {name: [s[name][-last[name] :] for s in samples] for name in NAMES}
        return {name: [*np.atleast_1d(reduced(reduce, rows[name]))] for name in NAMES}

    whole = numbers([*BENDS, *TWISTS, *PHASES, LOAD["output_torque"], *LOAD["inertias"]])
    want, value = differences(of, whole), of(whole)
    rng = np.random.default_rng(1)
    weights = {name: rng.normal(size=np.shape(plan(ANGLES)[name])) for name in NAMES}
    gradient = plan.gradient(ANGLES, weights)
    total = sum(float(np.dot(np.ravel(weights[n]), [float(x) for x in value[n]])) for n in NAMES)
    assert gradient.value == pytest.approx(total, rel=1e-12)
    start = 0
    for kind, count in zip(by, counts, strict=True):
        summed: Any = 0.0
        for name in NAMES:
            part = want[name][:, start : start + count]
            got = found[name][kind]
            scalar = kind == "output_torque"
            shape = np.shape(plan(ANGLES)[name])
            assert got.shape == (shape if scalar else (*shape, count))
            scale = max(1e-3, float(np.max(np.abs(part))))
            assert np.max(np.abs(got.reshape(part.shape) - part)) <= 1e-9 * scale, (name, kind)
            summed = summed + np.ravel(weights[name]) @ part
        got = np.ravel(getattr(gradient, kind))
        assert np.max(np.abs(got - summed)) <= 1e-9 * max(1e-3, float(np.max(np.abs(summed))))
        start += count


def test_reductions_work_over_batches_and_driven_angles() -> None:
    bends = np.random.default_rng(2).uniform(0.1, 0.6, (4, 1, 3))
    batch = Driveline.from_bends(bends, 0.3, 0.2)
    options: dict[str, Any] = {"reduce": "max", "shafts": [1, 3], "angle_of": "driven"}
    angle = np.linspace(-3.0, 3.0, 100)
    plan = batch.plan("speed_ratio", **options)
    whole = plan.derivatives(angle, ("bends", "phases"))["speed_ratio"]
    gradient = plan.gradient(angle, {"speed_ratio": [[1.0], [0.5]]})
    for i in range(4):
        alone = batch[i, 0].plan("speed_ratio", **options)
        derivatives = alone.derivatives(angle, ("bends", "phases"))["speed_ratio"]
        for kind in ("bends", "phases"):
            assert np.array_equal(derivatives[kind], whole[kind][:, i])
            weighted = derivatives[kind][0] + 0.5 * derivatives[kind][1]
            got = getattr(gradient, kind)[i, 0]
            assert np.allclose(got, weighted, rtol=1e-12, atol=1e-15)


def test_a_magnitude_that_vanishes_has_no_slope() -> None:
    line = Driveline.from_bends([0.0, 0.0])
    for reduce in ("peak", "rms"):
        plan = line.plan("angle_error", reduce=reduce)
        gradient = plan.gradient(ANGLES, {"angle_error": 1.0})
        assert gradient.value == 0.0
        assert not gradient.bends.any()


def test_refusals() -> None:
    plan = Driveline.from_bends([0.3]).plan("speed_ratio", reduce="max")
    with pytest.raises(ValueError, match="by has 'angle', of which a reduced output has many"):
        plan.derivatives(ANGLES, ("bends", "angle"))
    with pytest.raises(ValueError, match="works over the last axis"):
        plan.gradient(0.3, {"speed_ratio": 1.0})
    with pytest.raises(ValueError, match=r"has shape \(9,\); it must be \(\)"):
        plan.gradient(ANGLES, {"speed_ratio": ANGLES})

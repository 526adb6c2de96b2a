"""Reduced outputs and their derivatives, against formulas over the samples and differences."""

from __future__ import annotations

import itertools
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

import cardan
from cardan import Driveline, Load, Sweep
from cardan.design.quantities import ReducedQuantity, reduced_quantity
from tiers import few

Array = NDArray[np.float64]

REST: dict[str, Any] = {"speed": 40.0, "acceleration": 7.0, "inertias": [0.3, 0.2, 0.1, 0.4]}
LOAD = Load(output_torque=[90.0, 120.0], **REST)
BEARINGS = [(0, 0.1), (0, 0.3), (1, 0.75), (3, 0.2), (3, 0.45)]
ANGLES: dict[str, Any] = {
    "bends": np.array([[0.3, 0.2, 0.4], [0.1, 0.35, 0.2]]),
    "twists": np.array([[0.3, -1.0], [0.5, 0.7]]),
    "phases": np.array([[0.5, 2.0], [-0.3, 0.4]]),
    "lengths": np.array([[0.4, 1.1, 1.3, 0.6], [0.5, 1.0, 1.2, 0.7]]),
    "positions": np.array([[at for _, at in BEARINGS]] * 2) * [[1.0], [1.02]],
}
POINTS: dict[str, Any] = {
    "points": np.array(
        [
            [[0, 0, 0], [0.4, 0.02, 0], [1.5, 0.1, 0.2], [2.8, 0.12, 0.15], [3.4, 0, 0.2]],
            [[0, 0, 0], [0.5, 0.0, 0.1], [1.4, 0.2, 0.2], [2.7, 0.1, 0.0], [3.3, 0, 0.3]],
        ]
    ),
    "phases": ANGLES["phases"],
    "positions": ANGLES["positions"],
}
ITEMS = {"shaft": (None, 1, slice(1, None)), "joint": (None, 1), "bearing": (None, 3)}


def line_of(given: dict[str, Any]) -> Driveline:
    places = [(shaft, given["positions"][..., i]) for i, (shaft, _) in enumerate(BEARINGS)]
    if "points" in given:
        return Driveline.from_points(given["points"], given["phases"]).with_bearings(places)
    line = Driveline.from_bends(given["bends"], given["twists"], given["phases"])
    return line.with_bearings(places, given["lengths"])


def quantities(reduction: Any) -> list[ReducedQuantity]:  # noqa: ANN401
    return [
        ReducedQuantity(output, items, reduction)
        for output in cardan.OUTPUTS.values()
        for items in ITEMS[output.per]
    ]


# In the short tier each reduction is differentiated by one of them.
@pytest.mark.parametrize(
    ("way", "reduction"),
    few(
        itertools.product(["angles", "points"], ["peak", "rms", "mean", "min", "max"]),
        [
            ("angles", "peak"),
            ("angles", "min"),
            *(("points", each) for each in ("rms", "mean", "max")),
        ],
    ),
)
def test_derivatives_are_those_of_differences(way: str, reduction: str) -> None:
    given = {"angles": ANGLES, "points": POINTS}[way]
    line, step = line_of(given), 1e-6
    for quantity in quantities(reduction):
        found = quantity.derivatives(line, LOAD, given.keys())
        for name, got in found.items():
            values = given[name]
            assert got.shape == values.shape
            want = np.empty(values.shape)
            for place in np.ndindex(values.shape[1:]):
                moved = np.zeros(values.shape)
                moved[(slice(None), *place)] = step
                ends = [
                    quantity.of(line_of({**given, name: values + sign * moved}), LOAD)
                    for sign in (1.0, -1.0)
                ]
                want[(slice(None), *place)] = (ends[0] - ends[1]) / (2.0 * step)
            # A mean may vanish, the samples do not.
            rms = ReducedQuantity(quantity.output, quantity.items, "rms").of(line, LOAD)
            scale = max(float(np.max(np.abs(want))), float(np.max(rms)))
            np.testing.assert_allclose(
                got, want, atol=1e-7 * scale, err_msg=f"{quantity.label} by {name}"
            )


@pytest.mark.parametrize("reduction", ["peak", "rms", "mean", "min", "max"])
def test_values_are_those_of_the_samples(reduction: str) -> None:
    line, load = line_of(ANGLES), Load(output_torque=[[90.0], [120.0]], **REST)
    turn = np.asarray(Sweep.revolutions(1.0, 360))
    for quantity in quantities(reduction):
        of = {} if quantity.output.per == "bearing" else {f"{quantity.output.per}s": quantity.items}
        plan = line[:, np.newaxis].plan(quantity.output.name, load=load, **of)  # type: ignore[arg-type]
        samples = np.asarray(plan(turn)[quantity.output.name])
        if quantity.output.per == "bearing" and isinstance(quantity.items, int):
            samples = samples[quantity.items]
        columns = samples if quantity.output.vector else samples[..., np.newaxis]
        peak = np.max(np.linalg.norm(columns, axis=-1), axis=-1)
        rms = np.sqrt(np.mean(np.sum(columns**2, axis=-1), axis=-1))
        if reduction in ("mean", "min", "max"):
            part = getattr(np, reduction)(columns, axis=-2)
            value = np.linalg.norm(part, axis=-1) if quantity.output.vector else part[..., 0]
        else:
            value = {"peak": peak, "rms": rms}[reduction]
        value = np.max(value, axis=0) if value.ndim > 1 else value
        np.testing.assert_allclose(quantity.of(line, LOAD), value, rtol=1e-12, atol=1e-12)


@pytest.mark.parametrize(
    "name",
    [
        *("support_moment_1_peak", "support_moment_1_rms", "support_moment_1_mean"),
        *("support_moment_1_max", "acceleration_ratio_peak", "acceleration_ratio_rms"),
    ],
)
def test_what_vanishes_has_no_direction_to_grow_in(name: str) -> None:
    line, found = Driveline.from_bends([[0.0, 0.0]]), reduced_quantity(name)
    load = Load(drive_torque=9.0)
    assert found
    np.testing.assert_array_equal(found.of(line, load), [0.0])
    slopes = found.derivatives(line, load, ["bends"])["bends"]
    np.testing.assert_array_equal(slopes, [[0.0, 0.0]])


@pytest.mark.parametrize(
    ("name", "items"),
    [
        ("torque_peak", None),
        ("torque_0_peak", 0),
        ("moment_1_rms", 1),
        ("moment_rms", "none"),
        ("joint_force_2_max", 2),
        ("joint_force_max", "none"),
        ("torque_1_2_peak", "none"),
    ],
)
def test_only_outputs_of_shafts_go_without_a_number(name: str, items: object) -> None:
    found = reduced_quantity(name)
    assert (found.items if found else "none") == items


@pytest.mark.parametrize("reduction", ["peak", "rms", "mean", "min", "max"])
def test_without_a_torque_nothing_loads_a_driveline_however_it_is_built(reduction: str) -> None:
    line = line_of(ANGLES)
    for quantity in quantities(reduction):
        if quantity.output.needs_load:
            found = quantity.derivatives(line, Load(output_torque=0.0), ANGLES.keys())
            assert all(np.all(own == 0.0) for own in found.values()), quantity.label

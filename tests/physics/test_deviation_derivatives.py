"""Derivatives of joints as built, against 60 digits and against differences of evaluations."""

from __future__ import annotations

import re
from typing import Any

import numpy as np
import pytest

from cardan import ArgumentValueError, Driveline, Load, Sweep
from deviation_oracle import LeaningChain, LeaningJoint
from oracle import MpNumber, mp

BENDS, TWISTS, PHASES = [0.3, 0.45], [0.4], [1.2]
IDEAL = Driveline.from_bends(BENDS, TWISTS, PHASES)
LINE = IDEAL.with_deviations([0.02, -0.01], [0.03, -0.015], [-0.01, 0.02])
RATES = ("speed_ratio", "acceleration_ratio", "jerk_ratio")
LOADED = (
    "moment",
    "support_moment",
    "torque",
    "bending_driving",
    "bending_driven",
    "tilt_driving",
    "tilt_driven",
)
PARAMETERS = ("bends", "twists", "phases", "deviations")
STEP = mp.mpf(10) ** -20


def shifted(name: str, place: tuple[int, ...], by: MpNumber) -> LeaningChain:
    """The chain with one parameter changed."""
    given: dict[str, Any] = {
        "bends": [mp.mpf(x) for x in BENDS],
        "twists": [mp.mpf(x) for x in TWISTS],
        "phases": [mp.mpf(x) for x in PHASES],
        "deviations": [[mp.mpf(x) for x in row] for row in LINE.deviations.tolist()],
    }
    *outer, last = place
    target = given[name]
    for index in outer:
        target = target[index]
    target[last] += by
    joints = [
        LeaningJoint(bend, own)
        for bend, own in zip(given["bends"], given["deviations"], strict=True)
    ]
    return LeaningChain(joints, given["twists"], given["phases"])


def test_motions_by_every_parameter_with_60_digits() -> None:
    angle = 0.8
    found = LINE.plan(("angle_error", *RATES)).derivatives(angle, by=PARAMETERS)

    def motion(chain: LeaningChain) -> list[MpNumber]:
        return [chain.lag(angle) - chain.mean_lag(32), *chain.rates(angle)]

    for name in PARAMETERS:
        for place in np.ndindex(found["speed_ratio"][name].shape):
            ahead, behind = (motion(shifted(name, place, by)) for by in (STEP, -STEP))
            for output, one, other in zip(found, ahead, behind, strict=True):
                exact = float((one - other) / (2 * STEP))
                got = found[output][name][place]
                assert got == pytest.approx(exact, rel=1e-13, abs=1e-14), (output, name, place)


def test_to_first_order_deviations_add_on_top_of_the_ideal_chain() -> None:
    """The sum over the joints that the theory derives, less its mean."""
    turn = 2 * np.pi * np.arange(64) / 64
    found = IDEAL.plan("angle_error").derivatives(turn, by="deviations")["angle_error"][
        "deviations"
    ]
    motion = IDEAL.evaluate(turn, ("angle", "speed_ratio"), shafts=slice(None))
    speed, angle = motion.speed_ratio, motion.angle
    inputs = [angle[0], angle[1] + PHASES[0] - TWISTS[0] + 0.5 * np.pi]
    for joint, bend in enumerate(BENDS):
        own, ratio = speed[2] / speed[joint + 1], speed[joint + 1] / speed[joint]
        driven = np.arctan2(np.sin(inputs[joint]), np.cos(bend) * np.cos(inputs[joint]))
        parts = [
            speed[2] / speed[joint] * np.tan(bend) * np.sin(inputs[joint]),
            -own * np.sqrt(ratio / np.cos(bend)),
            own * np.tan(bend) * np.cos(driven),
        ]
        for which, part in enumerate(parts):
            wanted = part - part.mean()
            np.testing.assert_allclose(found[:, joint, which], wanted, rtol=0, atol=2e-14)


def load_of(torque: float, inertias: Any, end: str) -> Load:  # noqa: ANN401 - an array or a list
    return Load(**{end: torque}, speed=20.0, acceleration=5.0, inertias=inertias)


@pytest.mark.parametrize("end", ["drive_torque", "output_torque"])
def test_loaded_outputs_are_differentiated_as_they_are_evaluated(end: str) -> None:
    """Differences over one and two steps, extrapolated, with error terms carried."""
    angles, inertias, step = np.array([0.4, 2.9]), np.array([0.1, 0.02, 0.03]), 2e-4
    load = load_of(3.0, inertias, end)
    found = LINE.plan((*RATES, *LOADED), load=load, shafts=slice(None)).derivatives(
        angles, by=(*PARAMETERS, "angle", end, "inertias")
    )
    given = {
        "bends": np.array(BENDS),
        "twists": np.array(TWISTS),
        "phases": np.array(PHASES),
        "deviations": LINE.deviations,
        "angle": angles,
        end: np.array(3.0),
        "inertias": inertias,
    }

    def at(name: str, place: tuple[int, ...], by: float) -> Any:  # noqa: ANN401 - a result
        own = {key: array.copy() for key, array in given.items()}
        own[name][... if name == "angle" else place] += by
        line = Driveline.from_bends(own["bends"], own["twists"], own["phases"])
        line = line.with_deviations(*own["deviations"].T)
        return line.evaluate(
            own["angle"],
            (*RATES, *LOADED),
            load=load_of(float(own[end]), own["inertias"], end),
            shafts=slice(None),
            tolerance=0,
        )

    for name in given:
        places = [()] if name in ("angle", end) else [*np.ndindex(given[name].shape)]
        for place in places:
            four = {k: at(name, place, k * step) for k in (-2, -1, 1, 2)}
            for output, array in found.items():
                near, far = four[1][output] - four[-1][output], four[2][output] - four[-2][output]
                wanted = (8 * near - far) / (12 * step)
                got = array[name][(..., *place)]
                np.testing.assert_allclose(
                    got, wanted, rtol=1e-9, atol=2e-9, err_msg=f"{output} by {name}{place}"
                )


def test_gradients_are_weighted_sums_of_derivatives() -> None:
    angles = np.linspace(-1.0, 5.0, 23)
    random = np.random.default_rng(3)
    plan = LINE.plan(("angle", "moment"), load=Load(drive_torque=3.0))
    weights = {"angle": random.normal(size=23), "moment": random.normal(size=(2, 23, 3))}
    found = plan.gradient(angles, weights)
    at, by = plan(angles), plan.derivatives(angles, by=(*PARAMETERS, "drive_torque"))
    value = sum(np.sum(weights[name] * at[name]) for name in weights)
    assert found.value == pytest.approx(value, rel=1e-14)
    for name in (*PARAMETERS, "drive_torque"):
        wanted: Any = 0.0
        for output, weight in weights.items():
            own = by[output][name]
            extra = own.ndim - weight.ndim
            whole = weight.reshape(*weight.shape, *(1,) * extra)
            wanted = wanted + (whole * own).sum(axis=tuple(range(weight.ndim)))
        np.testing.assert_allclose(getattr(found, name), wanted, rtol=1e-13, atol=1e-13)


def test_batches_and_sweeps_are_their_parts() -> None:
    lines = IDEAL.with_deviations(np.linspace(-0.02, 0.02, 5)[:, np.newaxis] * [1.0, 2.0], 0.01)
    sweep = Sweep.revolutions(1, 90)
    found = lines[:, np.newaxis].plan("angle_error").derivatives(sweep, by=("deviations", "bends"))
    total = lines[:, np.newaxis].plan("angle_error").gradient(sweep, {"angle_error": np.ones(90)})
    for i, line in enumerate(lines):
        own = line.plan("angle_error").derivatives(np.asarray(sweep), by=("deviations", "bends"))
        for name, array in own["angle_error"].items():
            got = found["angle_error"][name][i]
            np.testing.assert_allclose(got, array, rtol=0, atol=1e-14)
        wanted = own["angle_error"]["deviations"].sum(axis=0)
        np.testing.assert_allclose(total.deviations[i, 0], wanted, rtol=0, atol=1e-12)


@pytest.mark.long
def test_bits_do_not_depend_on_the_number_of_threads() -> None:
    angles = np.linspace(0.0, 60.0, 70_001)
    weights = {"speed_ratio": np.cos(angles)}
    one, two = (LINE.plan("speed_ratio", workers=n).gradient(angles, weights) for n in (1, 2))
    assert one.value == two.value
    assert one.deviations.tobytes() == two.deviations.tobytes()
    each = [
        LINE.plan("speed_ratio", workers=n).derivatives(angles, by="deviations") for n in (1, 2)
    ]
    first, second = (found["speed_ratio"]["deviations"].tobytes() for found in each)
    assert first == second


def test_an_optimum_of_order_1_is_found_by_the_gradient() -> None:
    """A step of Newton along the derivatives lets driven yokes cancel a driving one."""
    turn = 2 * np.pi * np.arange(128) / 128
    line = Driveline.from_bends([0.2, 0.2]).with_deviations(driving_yoke=[0.003, 0.0])
    slopes = line.plan("angle_error").derivatives(turn, by="deviations")["angle_error"][
        "deviations"
    ]
    wave = np.exp(-1j * turn) / 64
    orders = np.einsum("s,sjk->jk", wave, slopes).ravel()
    now = np.sum(wave * line.evaluate(turn, "angle_error").angle_error)
    free = orders[[2, 5]]
    step = np.linalg.solve([free.real, free.imag], [-now.real, -now.imag])
    better = line.with_deviations([0.003, 0.0], 0.0, step)
    left = np.sum(wave * better.evaluate(turn, "angle_error").angle_error)
    assert abs(now) == pytest.approx(0.003 * np.tan(0.2), rel=0.03)
    assert abs(left) < 1e-3 * abs(now)


def test_what_is_not_differentiated_is_refused() -> None:
    points = np.array([[0, 0, 0], [1, 0, 0], [2, 0.3, 0], [3, 0.3, 0.2]])
    line = Driveline.from_points(points).with_deviations(0.01)
    with pytest.raises(ArgumentValueError, match=re.escape("use bends and twists")):
        line.plan("speed_ratio").derivatives(0.3, by="points")
    gradient = line.plan("speed_ratio").gradient([0.3], {"speed_ratio": [1.0]})
    assert gradient.deviations.shape == (2, 3)
    with pytest.raises(AttributeError, match="made from points"):
        gradient.points  # noqa: B018 - it raises
    with pytest.raises(AttributeError, match="a driveline with deviations"):
        IDEAL.plan("speed_ratio").gradient([0.3], {"speed_ratio": [1.0]}).deviations  # noqa: B018
    plan = IDEAL.plan("speed_ratio", angle_of="driven")
    with pytest.raises(ArgumentValueError, match="derivatives are those at drive angles"):
        plan.derivatives(0.3, by="deviations")


def test_a_batch_of_none_has_gradients() -> None:
    empty = Driveline.from_bends(np.zeros((0, 1, 2)))
    for line in (empty, empty.with_deviations(0.1)):
        found = line.plan("angle_error").gradient(np.linspace(0.0, 1.0, 5), {"angle_error": 1.0})
        assert (found.value.shape, found.bends.shape) == ((0, 1), (0, 1, 2))

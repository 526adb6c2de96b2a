"""JAX, PyTorch and SciPy differentiate evaluations."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import cardan
from cardan import Driveline
from cardan.interop.differentiable import Evaluation
from refusals import refusals

POINTS = np.array([[0, 0, 0], [1, 0.1, 0], [2, 0.3, 0.4], [3.2, 0.3, 0.3], [4, 0.2, 0.2]])
ANGLE = np.linspace(0.1, 3.0, 7)
LOADED = {
    "points": POINTS,
    "phases": np.array([0.3, 0.4]),
    "output_torque": np.array(12.0),
    "inertias": np.array([0.1, 0.2, 0.3, 0.4]),
}
ANGLES = {"bends": np.array([0.3, 0.2]), "twists": np.array(0.4), "phases": np.array([-1.0])}
MOUNTED = {
    **ANGLES,
    "drive_torque": np.array(5.0),
    "lengths": np.array([0.5, 0.8, 0.6]),
    "positions": np.array([0.4, 0.2, 0.3, 0.35]),
}


def total(found: Any) -> Any:  # noqa: ANN401
    """Return a number that no two outputs contribute to alike."""
    return sum((0.3 + 0.1 * i) * (x * x).sum() for i, (_, x) in enumerate(sorted(found.items())))


@pytest.fixture
def jax() -> Any:  # noqa: ANN401
    found: Any = pytest.importorskip("jax")
    before = found.config.jax_enable_x64
    found.config.update("jax_enable_x64", True)
    yield found
    found.config.update("jax_enable_x64", before)


CASES: list[tuple[dict[str, Any], Any, dict[str, Any]]] = [
    (ANGLES, ("angle_error", "jerk_ratio"), {}),
    (MOUNTED, ("bearing_force", "joint_force"), {"bearings": [0, 0, 1, 2], "speed": 3.0}),
    (LOADED, ("moment", "torque", "tilt_driven"), {"speed": 4.0, "shafts": [1, 2]}),
]


def differences(parameters: dict[str, Any], outputs: Any, options: dict[str, Any]) -> Any:  # noqa: ANN401
    """Return central differences by every number, and by the angles."""
    evaluation = Evaluation(outputs, **options)
    given = {**parameters, "angle": ANGLE}

    def value(changed: dict[str, Any]) -> float:
        rest = {name: x for name, x in changed.items() if name != "angle"}
        return float(total(evaluation.values(rest, changed["angle"])))

    found = {}
    for name, array in given.items():
        slopes = np.empty(np.shape(array))
        for at in np.ndindex(slopes.shape):
            ends = []
            for step in (1e-5, -1e-5):
                moved = np.array(array, float)
                moved[at] += step
                ends.append(value({**given, name: moved}))
            slopes[at] = (ends[0] - ends[1]) / 2e-5
        found[name] = slopes
    return found


@pytest.mark.parametrize(("parameters", "outputs", "options"), CASES)
def test_jax_gradients(jax: Any, parameters: Any, outputs: Any, options: Any) -> None:  # noqa: ANN401
    def f(given: Any, angle: Any) -> Any:  # noqa: ANN401
        return total(cardan.jax.evaluate(given, angle, outputs, **options))

    want = differences(parameters, outputs, options)
    for transformed in (jax.grad(f, (0, 1)), jax.jit(jax.grad(f, (0, 1)))):
        by_name, by_angle = transformed(parameters, ANGLE)
        for name, slopes in {**by_name, "angle": by_angle}.items():
            scale = np.max(np.abs(want[name]))
            assert np.max(np.abs(np.asarray(slopes) - want[name])) < 1e-7 * (scale + 1.0), name


def test_jax_maps_over_batches(jax: Any) -> None:  # noqa: ANN401
    bends = np.random.default_rng(1).uniform(0.1, 0.5, (4, 2))

    def f(bends: Any) -> Any:  # noqa: ANN401
        given = {"bends": bends, "phases": 0.3}
        return (cardan.jax.evaluate(given, ANGLE, "speed_ratio")["speed_ratio"] ** 3).sum()

    mapped = np.asarray(jax.jit(jax.vmap(jax.grad(f)))(bends))
    for i in range(4):
        assert np.allclose(mapped[i], jax.grad(f)(bends[i]), rtol=1e-13, atol=0)
    # One call with a batch.
    whole = jax.grad(lambda x: f(x[:, None, :]))(bends)
    assert np.allclose(np.asarray(whole), mapped, rtol=1e-12, atol=0)
    values = cardan.jax.evaluate({"bends": bends[:, None, :]}, ANGLE, "speed_ratio")["speed_ratio"]
    want = Driveline.from_bends(bends[:, None, :]).evaluate(ANGLE, "speed_ratio").speed_ratio
    assert np.array_equal(np.asarray(values), want)


def test_jax_in_single_precision() -> None:
    jax: Any = pytest.importorskip("jax")
    assert not jax.config.jax_enable_x64
    found = cardan.jax.evaluate(ANGLES, ANGLE, "speed_ratio")["speed_ratio"]
    assert found.dtype == np.float32
    slope = jax.grad(lambda p: cardan.jax.evaluate(p, ANGLE, "angle")["angle"].sum())(ANGLES)
    assert slope["bends"].dtype == np.float32


@pytest.mark.parametrize(("parameters", "outputs", "options"), CASES)
def test_torch_gradients(parameters: Any, outputs: Any, options: Any) -> None:  # noqa: ANN401
    torch: Any = pytest.importorskip("torch")
    names = [*parameters]
    tensors = [torch.tensor(np.array(parameters[name]), requires_grad=True) for name in names]
    angle = torch.tensor(ANGLE, requires_grad=True)

    def f(angle: Any, *tensors: Any) -> Any:  # noqa: ANN401
        given = dict(zip(names, tensors, strict=True))
        return tuple(cardan.torch.evaluate(given, angle, outputs, **options).values())

    assert torch.autograd.gradcheck(f, (angle, *tensors))
    total(dict(zip(outputs, f(angle, *tensors), strict=True))).backward()
    want = differences(parameters, outputs, options)
    for name, tensor in zip(["angle", *names], [angle, *tensors], strict=True):
        scale = np.max(np.abs(want[name]))
        assert np.max(np.abs(tensor.grad.numpy() - want[name])) < 1e-7 * (scale + 1.0), name


def test_scipy_finds_constant_velocity() -> None:
    optimize: Any = pytest.importorskip("scipy.optimize")
    start: dict[str, Any] = {"bends": [0.3, 0.3], "twists": 0.7, "phases": [0.3]}
    f = cardan.scipy.Objective(start, "phases", np.linspace(0, np.pi, 24), "angle_error")
    found = optimize.minimize(f, f.start, jac=True, tol=1e-12)
    # Equal bends compensate each other when the phase is the twist (double joint, 6.2).
    assert found.x == pytest.approx([0.7], abs=1e-6)
    assert f.parameters(found.x)["phases"].shape == (1,)


@pytest.mark.parametrize(("parameters", "outputs", "options"), CASES)
def test_scipy_objectives_are_consistent(parameters: Any, outputs: Any, options: Any) -> None:  # noqa: ANN401
    vary = [name for name in parameters if name != "inertias"]

    def cost(found: Any) -> Any:  # noqa: ANN401
        listed = enumerate(sorted(found.items()))
        weights = {name: (0.6 + 0.2 * i) * x for i, (name, x) in listed}
        return float(total(found)), weights

    f = cardan.scipy.Objective(parameters, vary, ANGLE, outputs, cost, **options)
    value, slope = f(f.start)
    want = differences(parameters, outputs, options)
    flat = np.concatenate([want[name].ravel() for name in vary])
    assert value == pytest.approx(float(cost(f._evaluation.values(parameters, ANGLE))[0]))
    assert np.max(np.abs(slope - flat)) < 1e-7 * (np.max(np.abs(flat)) + 1.0)


test_refusals = refusals(
    {
        "did you mean 'bends'": {"bend": [0.3]},
        "either 'bends' or 'points'": {"phases": [0.3]},
        "parameters must have either 'bends' or 'points'": {"bends": [0.3], "points": POINTS},
        "parameters['twists'] follow from the points": {"points": POINTS, "twists": 0.1},
        "parameters['lengths'] follow from the points": {"points": POINTS, "lengths": np.ones(4)},
        "one position per bearing, of which there are 0": {"bends": [0.3], "positions": [0.1]},
        "it must be one number": {"bends": [0.3], "drive_torque": [1.0, 2.0]},
        "it must be one number per shaft": {"bends": [0.3], "inertias": 1.0},
    },
    lambda **parameters: cardan.scipy.Objective(parameters, "bends", ANGLE, "speed_ratio"),
)


def test_what_varies_has_a_start() -> None:
    with pytest.raises(ValueError, match="has no start value"):
        cardan.scipy.Objective({"bends": [0.3]}, "phases", ANGLE, "speed_ratio")
    f = cardan.scipy.Objective({"bends": [0.3]}, "bends", ANGLE, "speed_ratio")
    with pytest.raises(ValueError, match=r"must be \(1,\)"):
        f([0.1, 0.2])


def test_adapters_are_imported_when_asked_for() -> None:
    assert {"jax", "scipy", "torch"} <= set(dir(cardan))

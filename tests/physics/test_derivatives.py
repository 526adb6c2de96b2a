"""Derivatives of all outputs by all parameters, against differences in 60 digits."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import cardan
from cardan import OUTPUTS, Driveline, Load, Sweep
from derivative_oracle import differences, from_angles, from_points, numbers, outputs
from oracle import Fold, mp
from tiers import part

MOTION = ("angle", "angle_error", "speed_ratio", "acceleration_ratio", "jerk_ratio")
CROSS = tuple(name for name, own in OUTPUTS.items() if own.of_cross)
SWINGS = tuple(name for name in CROSS if not OUTPUTS[name].vector)
LOADS = tuple(name for name, own in OUTPUTS.items() if own.unit == "N m")
ANGLES = [0.4, -2.1, 5.0][: part(3)]

CHAINS: dict[str, tuple[list[float], list[float], list[float]]] = {
    "one": ([0.5], [], []),
    "steep": ([1.4, 0.3], [0.4], [1.0]),
    "three": ([0.3, 0.2, 0.4], [0.3, -1.0], [0.5, 2.0]),
    "straight": ([0.3, 0.0, 0.4, 0.0], [0.3, 0.5, -1.0], [0.5, 0.1, 2.0]),
    "small": ([1e-4, 2e-4], [0.3], [0.5]),
}
POINTS: dict[str, tuple[list[list[float]], list[float]]] = {
    "space": (
        [[0, 0, 0], [1, 0.125, 0], [2, 0.25, 0.5], [3.25, 0.25, 0.375], [4, 0, 0.5]],
        [0.5, 2],
    ),
    "middle straight": (
        [[0, 0, 0], [1, 0.25, 0], [2, 0.25, 0.5], [3, 0.25, 1], [4, 0.5, 1], [5, 1, 2]],
        [0.5, 2, 0.3],
    ),
    "end straight": ([[0, 0, 0], [1, 0.25, 0], [2, 0.25, 0.5], [3, 0.25, 1]], [0.7]),
    "nearly straight": (
        [[0, 0, 0], [1, 0.25, 0], [2, 0.25, 0.5], [3, 0.25 + 1e-9, 1], [4, 0.5, 1]],
        [0.5, 2],
    ),
    "two": ([[0, 0, 0], [0.5, 0, 0], [1.5, 0.25, 0.125], [2, 0.25, 0]], [0.25]),
}
LOADINGS: dict[str, dict[str, Any]] = {
    "drive": {"drive_torque": 120.0, "inertias": [0.1, 0.2, 0.3, 0.4, 0.5], "speed": 20.0},
    "output": {
        "output_torque": -80.0,
        "inertias": [0.3, 0.2, 0.1, 0.4, 0.6],
        "speed": 30.0,
        "acceleration": 50.0,
    },
}


def loading(name: str, n: int) -> dict[str, Any]:
    return {**LOADINGS[name], "inertias": LOADINGS[name]["inertias"][: n + 1]}


def assert_close(got: Any, want: Any, scale: float, what: object) -> None:  # noqa: ANN401
    got, want = np.asarray(got), np.asarray(want)
    got = got.reshape(want.shape)
    # Relative to the largest derivative of the output by this variable, or to the output itself.
    largest = max(scale, float(np.max(np.abs(want), initial=0.0)))
    assert np.max(np.abs(got - want), initial=0.0) <= 1e-9 * largest, what


def item_first(array: Any, vector: bool, after: int) -> Any:  # noqa: ANN401
    """Put the components of a vector behind the items, then the angles, then the variables."""
    return np.moveaxis(array, array.ndim - 1 - after, 1) if vector else array


@pytest.mark.parametrize("loaded", LOADINGS)
@pytest.mark.parametrize("name", CHAINS)
def test_by_angles_and_loads(name: str, loaded: str) -> None:
    bends, twists, phases = CHAINS[name]
    n = len(bends)
    load = loading(loaded, n)
    line = Driveline.from_bends(bends, twists, phases)
    torque = next(key for key in load if key.endswith("_torque"))
    by = ("bends", "twists", "phases", "angle", torque, "inertias")
    names = MOTION + CROSS + LOADS
    plan = line.plan(names, shafts=slice(None), load=Load(**load))
    found = plan.derivatives(ANGLES, by)
    for i, angle in enumerate(ANGLES):
        whole = [*bends, *twists, *phases, angle, load[torque], *load["inertias"]]
        ends = np.cumsum([n, n - 1, n - 1, 1, 1])

        def of(x: list[Any], ends: Any = ends) -> dict[str, list[Any]]:  # noqa: ANN401
            b, t, p, a, d, inertias = (
                x[start:end] for start, end in zip([0, *ends], [*ends, None], strict=True)
            )
            changed = {**load, torque: d[0], "inertias": inertias}
            return outputs(from_angles(b, t, p), a[0], changed)

        want = differences(of, numbers(whole))
        for output in names:
            vector = cardan.OUTPUTS[output].vector
            value = np.max(np.abs(plan([angle])[output]))
            for kind, start, end in zip(by, [0, *ends], [*ends, None], strict=True):
                scalar = kind in ("angle", torque)
                got = found[output][kind][..., None] if scalar else found[output][kind]
                got = item_first(got, vector, 1)
                part = want[output][:, start:end]
                got = got[..., i, :].reshape(part.shape)
                if kind == "bends" and output.startswith("bending"):
                    # From straight on these magnitudes only grow.
                    bent = [j for j in range(n) if bends[j] > 0.0]
                    got, part = got[:, bent], part[:, bent]
                unit = 1.0 if kind in ("bends", "twists", "phases", "angle") else 1e-3
                assert_close(got, part, unit * value, (output, kind, angle))


@pytest.mark.parametrize("loaded", LOADINGS)
@pytest.mark.parametrize("name", POINTS)
def test_by_points(name: str, loaded: str) -> None:
    points, phases = POINTS[name]
    n = len(points) - 2
    load = loading(loaded, n)
    line = Driveline.from_points(points, phases)
    names = MOTION + CROSS + LOADS
    plan = line.plan(names, shafts=slice(None), load=Load(**load))
    found = plan.derivatives(ANGLES, by="points")
    straight = [j for j in range(n) if line.bends[j] < 1e-6]
    for i, angle in enumerate(ANGLES):
        # The magnitudes of bending moments have kinks where a joint is straight.
        smooth = [name for name in names if not (straight and name.startswith("bending"))]

        def of(x: list[Any], a: float = angle) -> dict[str, list[Any]]:
            return outputs(from_points(x, numbers(phases)), mp.mpf(a), load)

        want = differences(of, numbers(points))
        for output in smooth:
            vector = cardan.OUTPUTS[output].vector
            got = item_first(found[output]["points"], vector, 2)[..., i, :, :]
            value = float(np.max(np.abs(plan([angle])[output])))
            if output in SWINGS:
                # The tilt of a straight joint has a direction, of which only a limit exists.
                keep = [j for j in range(n) if j not in straight]
                assert_close(got.reshape(n, -1)[keep], want[output][keep], 1e-3, (output, angle))
                continue
            assert_close(got.reshape(want[output].shape), want[output], value, (output, angle))


@pytest.mark.parametrize("name", CHAINS)
@pytest.mark.parametrize("shaft", [0, 1, -1])
def test_q_by_angles(name: str, shaft: int) -> None:
    bends, twists, phases = CHAINS[name]
    n = len(bends)
    transmission = Driveline.from_bends(bends, twists, phases).transmission(shaft)

    def of(x: list[Any]) -> dict[str, list[Any]]:
        s = shaft % (n + 1)
        fold = Fold.of(
            x[:n][:s], x[n : 2 * n - 1][: max(s - 1, 0)], x[2 * n - 1 :][: max(s - 1, 0)]
        )
        q = fold.b / fold.a
        return {"re": [mp.re(q)], "im": [mp.im(q)], "abs2": [abs(q) ** 2]}

    want = differences(of, numbers([*bends, *twists, *phases]))
    for i, by in enumerate(("bends", "twists", "phases")):
        part = slice(*((0, n), (n, 2 * n - 1), (2 * n - 1, None))[i])
        dq = transmission.dq(by)  # type: ignore[arg-type]
        assert_close(dq.real, want["re"][0, part], 0.0, by)
        assert_close(dq.imag, want["im"][0, part], 0.0, by)
        size = float(np.max(np.abs(dq), initial=0.0)) * float(np.abs(transmission.q))
        assert_close(transmission.d_abs2(by), want["abs2"][0, part], size, by)  # type: ignore[arg-type]


@pytest.mark.parametrize("name", POINTS)
@pytest.mark.parametrize("shaft", [1, 2, -1])
def test_q_by_points(name: str, shaft: int) -> None:
    points, phases = POINTS[name]
    transmission = Driveline.from_points(points, phases).transmission(shaft)

    def of(x: list[Any]) -> dict[str, list[Any]]:
        fold = from_points(x, numbers(phases)).folds[shaft]
        q = fold.b / fold.a
        return {"re": [mp.re(q)], "im": [mp.im(q)]}

    want = differences(of, numbers(points))
    dq = transmission.dq("points")
    assert dq.shape == (len(points), 3)
    scale = float(np.max(np.abs(want["re"] + 1j * want["im"])))
    assert_close(dq.real, want["re"][0].reshape(dq.shape), scale, name)
    assert_close(dq.imag, want["im"][0].reshape(dq.shape), scale, name)


def test_abs2_is_smooth_where_the_first_joint_is_straight() -> None:
    points: list[list[float]] = [[0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0.25, 0.5], [4, 1, 0.5]]
    transmission = Driveline.from_points(points, 0.3).transmission()

    def of(x: list[Any]) -> dict[str, list[Any]]:
        return {"abs2": [from_points(x, numbers([0.3, 0.3])).folds[-1].k ** 2]}

    want = differences(of, numbers(points))["abs2"][0]
    assert np.max(np.abs(want)) > 0.01
    assert_close(transmission.d_abs2("points"), want.reshape(5, 3), 0.0, "points")


def test_constant_velocity_has_a_slope_of_q_and_none_of_abs2() -> None:
    transmission = Driveline.from_bends([0.3, 0.3], 0.4, 0.4).transmission()
    assert abs(transmission.q) < 1e-16
    assert np.max(np.abs(transmission.dq("phases"))) > 0.01
    assert np.max(np.abs(transmission.d_abs2("phases"))) < 1e-16
    with pytest.raises(TypeError, match="infinite"):
        transmission.d_bend("phases")


@pytest.mark.parametrize("bend", [1e-3, 0.5, 1.5])
def test_one_joint_against_its_closed_form(bend: float) -> None:
    line = Driveline.from_bends([bend])
    slope = math.tan(bend / 2) / math.cos(bend / 2) ** 2
    assert line.transmission().dq("bends") == pytest.approx([-slope], rel=1e-14)
    # The largest speed ratio is 1/cos(bend), at the drive angle 0.
    d = line.plan("speed_ratio").derivatives(0.0, "bends")["speed_ratio"]["bends"]
    assert d == pytest.approx([math.sin(bend) / math.cos(bend) ** 2], rel=1e-12)


def test_points_moved_together_change_nothing_but_what_they_carry() -> None:
    points, phases = POINTS["space"]
    plan = Driveline.from_points(points, phases).plan(
        ("speed_ratio", "moment"), load=Load(output_torque=100.0)
    )
    d = plan.derivatives(Sweep.revolutions(1, 16), by="points")
    for output in d.values():
        assert np.max(np.abs(output["points"].sum(axis=-2))) < 1e-10 * np.max(
            np.abs(output["points"])
        )

"""Derivatives of all outputs by all parameters, against differences in 60 digits."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

from cardan import OUTPUTS, Driveline, Load, Sweep
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
from oracle import Fold, mp
from refusals import refusals
from tiers import part

FORCES = ("joint_force", "bearing_force")
TURNING = ("moment", "support_moment")
ALL = tuple(name for name in OUTPUTS if name not in FORCES)
# The tilt of a straight joint has a direction, of which only a limit exists.
SWINGS = tuple(name for name in ALL if OUTPUTS[name].of_cross and not OUTPUTS[name].vector)
ANGLES = [0.4, -2.1, 5.0][: part(3)]

# Bends, twists and phases; then shaft and position of each bearing, and lengths.
Chain = tuple[list[float], list[float], list[float], list[tuple[int, float]], list[float]]
CHAINS: dict[str, Chain] = {
    "one": ([0.5], [], [], [], []),
    "steep": ([1.4, 0.3], [0.4], [1.0], [], []),
    "floating": ([0.5, 0.8], [0.4], [1.0], [], [0.3, 0.7, 0.4]),
    "truck": (
        *([0.3, 0.2, 0.4], [0.3, -1.0], [0.5, 2.0]),
        [(0, 0.1), (3, 0.4), (1, 0.75), (0, 0.35), (3, 0.2)],
        [0.4, 1.1, 1.3, 0.6],
    ),
    "one after another": (
        *([0.6, 0.3], [-0.7], [0.2]),
        [(0, 0.2), (1, 0.6), (1, 0.2), (2, 0.3)],
        [0.5, 0.8, 0.5],
    ),
    "straight": (
        *([0.3, 0.0, 0.4, 0.0], [0.3, 0.5, -1.0], [0.5, 0.1, 2.0]),
        [(0, 0.1), (0, 0.3), (1, 0.5), (2, 0.2), (4, 0.2), (4, 0.4)],
        [0.4, 1.1, 0.6, 0.9, 0.5],
    ),
    "small": ([1e-4, 2e-4], [0.3], [0.5], [], []),
}
POINTS: dict[str, tuple[list[list[float]], list[float], list[tuple[int, float]]]] = {
    "space": (
        [[0, 0, 0], [1, 0.125, 0], [2, 0.25, 0.5], [3.25, 0.25, 0.375], [4, 0, 0.5]],
        [0.5, 2],
        [(3, 0.25), (0, 0.375), (0, 0.75), (1, 0.5), (3, 0.5)],
    ),
    "middle straight": (
        [[0, 0, 0], [1, 0.25, 0], [2, 0.25, 0.5], [3, 0.25, 1], [4, 0.5, 1], [5, 1, 2]],
        *([0.5, 2, 0.3], []),
    ),
    "end straight": ([[0, 0, 0], [1, 0.25, 0], [2, 0.25, 0.5], [3, 0.25, 1]], [0.7], []),
    "nearly straight": (
        [[0, 0, 0], [1, 0.25, 0], [2, 0.25, 0.5], [3, 0.25 + 1e-9, 1], [4, 0.5, 1]],
        *([0.5, 2], []),
    ),
    "two": ([[0, 0, 0], [0.5, 0, 0], [1.5, 0.25, 0.125], [2, 0.25, 0]], [0.25], []),
}
LOADS: dict[str, dict[str, Any]] = {
    "drive": {"drive_torque": 120.0, "speed": 20.0, "inertias": [0.1, 0.2, 0.3, 0.4, 0.5]},
    "output": {
        "output_torque": -80.0,
        "speed": 30.0,
        "acceleration": 50.0,
        "inertias": [0.3, 0.2, 0.1, 0.4, 0.6],
    },
}
loadings = pytest.mark.parametrize("loaded", LOADS)


def loading(name: str, n: int) -> dict[str, Any]:
    return {**LOADS[name], "inertias": LOADS[name]["inertias"][: n + 1]}


def close(got: Any, want: Any, scale: float, what: object) -> None:  # noqa: ANN401
    """Compare by the largest derivative of an output by a variable, or by the output itself."""
    largest = max(scale, float(np.max(np.abs(want), initial=0.0)))
    off = np.max(np.abs(np.reshape(got, np.shape(want)) - want), initial=0.0)
    assert off <= 1e-9 * largest, what


def split(x: list[Any], lengths: Sequence[int]) -> list[list[Any]]:
    ends = np.cumsum(lengths)
    return [x[end - length : end] for end, length in zip(ends, lengths, strict=True)]


@loadings
@pytest.mark.parametrize(
    ("name", "options"),
    [
        *((name, {}) for name in CHAINS),
        *((name, {"axes": "shaft"}) for name in ("truck", "straight")),
        ("truck", {"angle_of": "driven"}),
    ],
)
def test_by_everything(name: str, options: dict[str, Any], loaded: str) -> None:
    """In space, in axes that turn with the shafts, and at angles of the last shaft."""
    bends, twists, phases, bearings, lengths = CHAINS[name]
    n, load = len(bends), loading(loaded, len(bends))
    torque = next(key for key in load if key.endswith("_torque"))
    line = Driveline.from_bends(bends, twists, phases)
    if lengths:
        line = line.with_bearings(bearings, lengths)
    names = TURNING if "axes" in options else (*ALL, *FORCES[: bool(lengths) + bool(bearings)])
    given: dict[str, list[float]] = {
        "bends": bends,
        "twists": twists,
        "phases": phases,
        "angle": [0.0],
        torque: [load[torque]],
        "inertias": load["inertias"],
        "lengths": lengths,
        "positions": [at for _, at in bearings],
    }
    by = [kind for kind, values in given.items() if values or kind in ("twists", "phases")]
    plan = line.plan(names, shafts=slice(None), load=Load(**load), **options)
    found, sizes = plan.derivatives(ANGLES, by), [len(values) for values in given.values()]
    for i, angle in enumerate(ANGLES):

        def of(x: list[Any], start: float = angle) -> dict[str, list[Any]]:
            b, t, p, a, d, inertias, spans, places = split(x, sizes)
            frames, changed = from_angles(b, t, p), {**load, torque: d[0], "inertias": inertias}
            drive = drive_angle(frames.folds[-1], a[0], start) if "angle_of" in options else a[0]
            held = BearingPlaces([shaft for shaft, _ in bearings], places, spans)
            return outputs(frames, drive, changed, held if spans else None)

        at = {**given, "angle": [angle]}
        want = differences(of, numbers([x for values in at.values() for x in values]))
        values = plan([angle])
        for output in names:
            whole = want[f"turning_{output}" if "axes" in options else output]
            parts = dict(zip(given, np.split(whole, np.cumsum(sizes)[:-1], axis=1), strict=True))
            for kind in by:
                got = np.reshape(found[output][kind][:, i], parts[kind].shape)
                bent: Any = slice(None)
                if kind == "bends" and output.startswith("bending"):
                    # From straight on these magnitudes only grow.
                    bent = [j for j in range(n) if bends[j] > 0.0]
                scale = 1.0 if kind in ("bends", "twists", "phases", "angle") else 1e-3
                scale *= float(np.max(np.abs(values[output])))
                close(got[:, bent], parts[kind][:, bent], scale, (output, kind, angle))


@loadings
@pytest.mark.parametrize("name", POINTS)
def test_by_points(name: str, loaded: str) -> None:
    points, phases, bearings = POINTS[name]
    n = len(points) - 2
    load = loading(loaded, n)
    line = Driveline.from_points(points, phases)
    if bearings:
        line = line.with_bearings(bearings)
    options: dict[str, Any] = {"shafts": slice(None), "load": Load(**load)}
    names = ALL + FORCES if bearings else ALL
    plan = line.plan(names, **options)
    turning = line.plan(TURNING, **options, axes="shaft")
    found, turned = (each.derivatives(ANGLES, by="points") for each in (plan, turning))
    straight = [j for j in range(n) if line.bends[j] < 1e-6]
    for i, angle in enumerate(ANGLES):

        def of(x: list[Any], a: float = angle) -> dict[str, list[Any]]:
            corners = [x[k : k + 3] for k in range(0, len(x), 3)]
            spans = [
                mp.sqrt(sum((q - p) ** 2 for p, q in zip(*ends, strict=True)))
                for ends in pairwise(corners)
            ]
            places = numbers([at for _, at in bearings])
            held = BearingPlaces([shaft for shaft, _ in bearings], places, spans)
            frames = from_points(x, numbers(phases))
            return outputs(frames, mp.mpf(a), load, held if bearings else None)

        want = differences(of, numbers(points))
        for output in names:
            # The magnitudes of bending moments have kinks where a joint is straight.
            if straight and output.startswith("bending"):
                continue
            value = float(np.max(np.abs(plan([angle])[output])))
            got = found[output]["points"][:, i]
            if output in SWINGS:
                keep = [j for j in range(n) if j not in straight]
                close(got[keep], want[output][keep], 1e-3, (output, angle))
            else:
                close(got, want[output], value, (output, angle))
        for output in TURNING:
            value = float(np.max(np.abs(turning([angle])[output])))
            close(turned[output]["points"][:, i], want[f"turning_{output}"], value, output)


# --- how a shaft follows the drive ---------------------------------------------------------------


@pytest.mark.parametrize("name", ["one", "steep", "truck", "straight", "small"])
@pytest.mark.parametrize("shaft", [0, 1, -1])
def test_q_by_angles(name: str, shaft: int) -> None:
    bends, twists, phases, *_ = CHAINS[name]
    n = len(bends)
    s = shaft % (n + 1)
    transmission = Driveline.from_bends(bends, twists, phases).transmission(shaft)

    def of(x: list[Any]) -> dict[str, list[Any]]:
        b, t, p = split(x, [n, n - 1, n - 1])
        fold = Fold.of(b[:s], t[: max(s - 1, 0)], p[: max(s - 1, 0)])
        q = fold.b / fold.a
        return {"re": [mp.re(q)], "im": [mp.im(q)], "abs2": [abs(q) ** 2]}

    want = differences(of, numbers([*bends, *twists, *phases]))
    ends = {"bends": slice(n), "twists": slice(n, 2 * n - 1), "phases": slice(2 * n - 1, None)}
    for by, own in ends.items():
        dq = transmission.dq(by)  # type: ignore[arg-type]
        close(dq.real, want["re"][0, own], 0.0, by)
        close(dq.imag, want["im"][0, own], 0.0, by)
        size = float(np.max(np.abs(dq), initial=0.0)) * float(np.abs(transmission.q))
        close(transmission.d_abs2(by), want["abs2"][0, own], size, by)  # type: ignore[arg-type]


@pytest.mark.parametrize("name", POINTS)
@pytest.mark.parametrize("shaft", [1, 2, -1])
def test_q_by_points(name: str, shaft: int) -> None:
    points, phases, _ = POINTS[name]
    transmission = Driveline.from_points(points, phases).transmission(shaft)

    def of(x: list[Any]) -> dict[str, list[Any]]:
        fold = from_points(x, numbers(phases)).folds[shaft]
        q = fold.b / fold.a
        return {"re": [mp.re(q)], "im": [mp.im(q)]}

    want = differences(of, numbers(points))
    dq = transmission.dq("points")
    scale = float(np.max(np.abs(want["re"] + 1j * want["im"])))
    close(dq.real, want["re"][0].reshape(len(points), 3), scale, name)
    close(dq.imag, want["im"][0].reshape(len(points), 3), scale, name)


def test_abs2_is_smooth_where_the_first_joint_is_straight() -> None:
    points: list[list[float]] = [[0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0.25, 0.5], [4, 1, 0.5]]
    transmission = Driveline.from_points(points, 0.3).transmission()

    def of(x: list[Any]) -> dict[str, list[Any]]:
        return {"abs2": [from_points(x, numbers([0.3, 0.3])).folds[-1].k ** 2]}

    want = differences(of, numbers(points))["abs2"][0]
    assert np.max(np.abs(want)) > 0.01
    close(transmission.d_abs2("points"), want.reshape(5, 3), 0.0, "points")


def test_constant_velocity_has_a_slope_of_q_and_none_of_abs2() -> None:
    transmission = Driveline.from_bends([0.3, 0.3], 0.4, 0.4).transmission()
    assert abs(transmission.q) < 1e-16
    assert np.max(np.abs(transmission.dq("phases"))) > 0.01
    assert np.max(np.abs(transmission.d_abs2("phases"))) < 1e-16
    with pytest.raises(TypeError, match="infinite"):
        transmission.d_bend("phases")


def test_an_earlier_shaft_at_angles_of_the_last_one_has_derivatives_by_all_joints() -> None:
    bends, twists, phases, *_ = CHAINS["truck"]

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


# --- sums and reductions -------------------------------------------------------------------------


def test_points_moved_together_change_nothing_but_what_they_carry() -> None:
    points, phases, _ = POINTS["space"]
    plan = Driveline.from_points(points, phases).plan(
        ("speed_ratio", "moment"), load=Load(output_torque=100.0)
    )
    for output in plan.derivatives(Sweep.revolutions(1, 16), by="points").values():
        moved = np.max(np.abs(output["points"].sum(axis=-2)))
        assert moved < 1e-10 * np.max(np.abs(output["points"]))


def test_gradients_are_sums_of_these_derivatives() -> None:
    bends, twists, phases, bearings, lengths = CHAINS["truck"]
    line = Driveline.from_bends(bends, twists, phases).with_bearings(bearings, lengths)
    angle, rng = np.linspace(-3.0, 9.0, 1001), np.random.default_rng(5)
    load = Load(**loading("drive", 3))
    by = ("bends", "twists", "phases", "drive_torque", "inertias", "lengths", "positions")
    cases: list[tuple[tuple[str, ...], dict[str, Any]]] = [
        (FORCES, {}),
        ((*FORCES, "moment"), {"angle_of": "driven"}),
        (("speed_ratio", "angle_error"), {"angle_of": "driven", "shafts": 1}),
        (("moment", "support_moment", "torque"), {"axes": "shaft"}),
        (("support_moment", "tilt_driven"), {"axes": "shaft", "angle_of": "driven"}),
    ]
    for names, options in cases:
        plan = line.plan(names, load=load, **{"shafts": slice(None), **options})
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


REDUCED = ("speed_ratio", "angle_error", "acceleration_ratio", "bending_driven", "moment")
SOME = np.linspace(0.1, 3.0, 9)


def reduced(reduce: str, samples: list[Any]) -> Any:  # noqa: ANN401 - of any arithmetic
    """Reduce numbers, or lists of components."""
    if reduce == "peak":
        return max(mp.sqrt(sum(x * x for x in sample)) for sample in samples)
    count = len(samples)
    formulas: dict[str, Any] = {
        "min": min,
        "max": max,
        "mean": lambda column: sum(column) / count,
        "rms": lambda column: mp.sqrt(sum(x * x for x in column) / count),
    }
    return [formulas[reduce](column) for column in zip(*samples, strict=True)]


@pytest.mark.parametrize("reduce", ["min", "max", "mean", "rms", "peak"])
def test_reduced_outputs(reduce: Any) -> None:  # noqa: ANN401
    own: dict[str, Any] = {"output_torque": 9.0, "speed": 5.0, "inertias": [0.1, 0.2, 0.3]}
    line = Driveline.from_bends([0.3, 0.5], [0.4], [-1.0])
    plan = line.plan(REDUCED, shafts=-1, joints=1, load=Load(**own), reduce=reduce)
    sizes = {"bends": 2, "twists": 1, "phases": 1, "output_torque": 1, "inertias": 3}
    found = plan.derivatives(SOME, (*sizes,))

    def of(x: list[Any]) -> dict[str, list[Any]]:
        b, t, p, torque, inertias = split(x, [*sizes.values()])
        load, frames = (
            {**own, "output_torque": torque[0], "inertias": inertias},
            from_angles(b, t, p),
        )
        samples = [outputs(frames, angle, load) for angle in numbers(SOME)]
        # Of the last shaft or joint, whose components are the last.
        last = {name: 3 if OUTPUTS[name].vector else 1 for name in REDUCED}
        rows = {name: [s[name][-last[name] :] for s in samples] for name in REDUCED}
        return {name: [*np.atleast_1d(reduced(reduce, rows[name]))] for name in REDUCED}

    whole = numbers([0.3, 0.5, 0.4, -1.0, own["output_torque"], *own["inertias"]])
    want, value, result = differences(of, whole), of(whole), plan(SOME)
    rng = np.random.default_rng(1)
    weights = {name: rng.normal(size=np.shape(result[name])) for name in REDUCED}
    gradient = plan.gradient(SOME, weights)
    total = sum(np.ravel(weights[name]) @ [float(x) for x in value[name]] for name in REDUCED)
    assert gradient.value == pytest.approx(total, rel=1e-12)
    ends = np.cumsum([*sizes.values()])[:-1]
    parts = {name: np.split(want[name], ends, axis=1) for name in REDUCED}
    for k, kind in enumerate(sizes):
        for name in REDUCED:
            shape = np.shape(result[name]) + ((sizes[kind],) if kind != "output_torque" else ())
            assert found[name][kind].shape == shape
            close(found[name][kind], parts[name][k], 1e-3, (name, kind))
        summed = sum(np.ravel(weights[name]) @ parts[name][k] for name in REDUCED)
        close(getattr(gradient, kind), summed, 1e-3, kind)


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
        gradient = plan.gradient(SOME, {"angle_error": 1.0})
        assert gradient.value == 0.0
        assert not gradient.bends.any()


LARGEST = Driveline.from_bends([0.3]).plan("speed_ratio", reduce="max")
MOUNTED = Driveline.from_bends(*CHAINS["truck"][:3]).with_bearings(*CHAINS["truck"][3:])


def turning_forces(name: str, reduce: Any = None) -> Any:  # noqa: ANN401 - a plan
    load = Load(**loading("output", 3))
    return MOUNTED.plan(("speed_ratio", name), load=load, axes="shaft", reduce=reduce)


test_refusals = refusals(
    {
        "by has 'angle', of which a reduced output has many": lambda: LARGEST.derivatives(
            SOME, ("bends", "angle")
        ),
        "works over the last axis": lambda: LARGEST.gradient(0.3, {"speed_ratio": 1.0}),
        "has shape (9,); it must be ()": lambda: LARGEST.gradient(SOME, {"speed_ratio": SOME}),
        "axes is 'shaft'; derivatives of joint_force are known in": lambda: turning_forces(
            "joint_force"
        ).derivatives(ANGLES, "phases"),
        "axes is 'shaft'; derivatives of bearing_force are known in": lambda: turning_forces(
            "bearing_force", "rms"
        ).gradient(ANGLES, {"speed_ratio": 1.0}),
    }
)


@pytest.mark.parametrize("bend", [1e-3, 0.5, 1.5])
def test_one_joint_against_its_closed_form(bend: float) -> None:
    line = Driveline.from_bends([bend])
    slope = math.tan(bend / 2) / math.cos(bend / 2) ** 2
    assert line.transmission().dq("bends") == pytest.approx([-slope], rel=1e-14)
    # The largest speed ratio is 1/cos(bend), at the drive angle 0.
    d = line.plan("speed_ratio").derivatives(0.0, "bends")["speed_ratio"]["bends"]
    assert d == pytest.approx([math.sin(bend) / math.cos(bend) ** 2], rel=1e-12)

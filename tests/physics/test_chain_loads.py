"""The loads of chains with ``tolerance=0``, in ulp of the exact ones, of a vector in ulp of its
largest component.

The exact loads are those of the vector picture in ``tests/vectors.py``, for the doubles in
``line.bends``, ``line.twists`` and ``line.phases``, laid out from the first of ``line.directions``
and the first of ``line.normals``.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import tiers
from cardan import OUTPUTS, Driveline, Load, Result, Sweep
from oracle import EPS, LIMIT_TABLE, OUTPUT_LIMITS, Doubles, Exact, ExactJoint, ExactTurn, mp
from vectors import load_errors

# Vectors in axes that turn with their shaft are judged by the stress tool.
LIMITS: dict[str, float] = {
    name: row["tolerance_0"] for name, row in LIMIT_TABLE["chain"].items() if name in OUTPUTS
}
NAMES = tuple(LIMITS)
RIGHT = math.pi / 2


def evaluated(line: Driveline, angle: Any, load: dict[str, Any], **options: Any) -> Result:  # noqa: ANN401
    settings = {"shafts": slice(None), "tolerance": 0, **options}
    return line.evaluate(angle, NAMES, load=Load(**load), **settings)


def judge(line: Driveline, angles: list[float], load: dict[str, Any]) -> None:
    off = load_errors(line, evaluated(line, angles, load), map(ExactTurn.by, angles), load)
    for name, column in zip(NAMES, off.T, strict=True):
        where = f"{line.bends.tolist()}, {line.twists.tolist()}, {line.phases.tolist()}"
        report = (
            f"{name} is {column.max():.3f} ulp off: {where} at {angles[column.argmax()]}, {load}"
        )
        assert column.max() <= LIMITS[name], report


def loads(rng: np.random.Generator, n: int) -> dict[str, Any]:
    turning = {
        "inertias": rng.uniform(0, 0.1, n + 1).tolist(),
        "speed": float(rng.uniform(1, 5)),
        "acceleration": float(rng.uniform(-3, 3)),
    }
    end = ("drive_torque", "output_torque")[rng.integers(2)]
    return {end: float(rng.uniform(-9, 9)), **(turning if rng.random() < 0.4 else {})}


def spatial(rng: np.random.Generator, bends: Doubles) -> Driveline:
    twists, phases = rng.uniform(-math.pi, math.pi, (2, len(bends) - 1))
    return Driveline.from_bends(bends, twists, phases)


def spans(rng: np.random.Generator, line: Driveline) -> Doubles:
    """Return vectors along the shafts of a driveline that points anywhere."""
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    vectors: Doubles = line.directions * rng.uniform(0.5, 2.0, (line.n_joints + 1, 1)) @ turn
    return vectors


def from_points(rng: np.random.Generator, line: Driveline) -> Driveline:
    start = rng.normal(size=(1, 3))
    return Driveline.from_points(np.cumsum([*start, *spans(rng, line)], axis=0), line.phases)


def from_slopes(rng: np.random.Generator, line: Driveline) -> Driveline:
    up, right = rng.uniform(-0.4, 0.4, (2, line.n_joints + 1))
    return Driveline.from_slopes(up, right, line.phases)


WAYS: dict[str, Callable[[np.random.Generator, Driveline], Driveline]] = {
    "bends": lambda _, line: line,
    "points": from_points,
    "directions": lambda rng, line: Driveline.from_directions(spans(rng, line), line.phases),
    "slopes": from_slopes,
    "reversed": lambda rng, line: from_points(rng, line).reversed(),
}


@pytest.mark.parametrize("n", [2, 3, 4, 6, 20])
@pytest.mark.parametrize("way", WAYS)
def test_ordinary_bends(way: str, n: int) -> None:
    rng = np.random.default_rng([n, *way.encode()])
    for _ in range(tiers.part(120 // n)):
        line = WAYS[way](rng, spatial(rng, rng.uniform(0, math.radians(60), n)))
        judge(line, rng.uniform(-4, 4, 5).tolist(), loads(rng, n))


@pytest.mark.parametrize("n", [2, 3, 5])
@pytest.mark.parametrize("steepest", [85.0, 89.0, 89.9])
def test_steep_bends(steepest: float, n: int) -> None:
    rng = np.random.default_rng([n, int(10 * steepest)])
    for _ in range(tiers.part(20)):
        bends = rng.uniform(0, math.radians(60), n)
        bends[rng.integers(n)] = math.radians(steepest)
        judge(spatial(rng, bends), rng.uniform(-4, 4, 4).tolist(), loads(rng, n))


def test_planes_straight_joints_and_large_angles() -> None:
    rng = np.random.default_rng(16)
    for twists, phases in (
        ([0.0, math.pi, 0.0], [0.0, RIGHT, 0.3]),
        ([RIGHT, -RIGHT, math.pi], [0.7, 0.0, RIGHT]),
        ([1e6, -3e13, 2.0], [5e12, 0.1, -1e9]),
    ):
        for bends in ([0.3, 0.3, 0.3, 0.3], [0.4, 0.0, 0.2, 0.0], [0.0, 0.5, 1e-7, 0.9]):
            for load in ({"drive_torque": 7.0}, {"output_torque": -3.0}):
                line = Driveline.from_bends(bends, twists, phases)
                judge(line, [0.4, *rng.uniform(-9, 9, 3).tolist(), 1e5, -3e14], load)


def test_a_chain_that_was_far_off() -> None:
    """Rounded unit vectors gave it a moment 2.13 ulp off."""
    line = Driveline.from_bends(
        [0.5086599476892322, 0.8729047167854193], [-1.2831465338629575], [-1.2733741913095722]
    )
    judge(line, [-2.909946453918602], {"drive_torque": 1.0})


@pytest.mark.parametrize("n", [2, 4, 6])
def test_beside_zeros(n: int) -> None:
    """Pins keep their digits where their sine or cosine all but vanishes."""
    rng = np.random.default_rng([8, n])
    for name in ("tilt_driving", "tilt_driven"):
        line = spatial(rng, rng.uniform(0.1, 1.0, n))
        low, high = 0.0, math.pi
        rising = line.evaluate(low, name, joints=-1)[name] < 0
        while high - low > 1e-13:
            middle = 0.5 * (low + high)
            below = (line.evaluate(middle, name, joints=-1)[name] < 0) == rising
            low, high = (middle, high) if below else (low, middle)
        judge(line, [low + d for d in (1e-3, -1e-5, 1e-7, -1e-8)], {"drive_torque": 3.0})


def test_inertias_behind_small_and_compensated_bends() -> None:
    """Their accelerations are far smaller than the terms of the map that they come from."""
    rng = np.random.default_rng(12)
    load = {"drive_torque": 0.0, "inertias": [0.0, 0.0, 0.3], "speed": 20.0}
    for bends in ([1e-12, 3e-10], [1e-7, 1e-9], [0.4, 0.4], [1e-5, 0.9]):
        for turn in (0.3, 0.3 + 1e-9):
            line = Driveline.from_bends(bends, [0.3], [turn])
            judge(line, rng.uniform(-4, 4, 4).tolist(), load)


@pytest.mark.parametrize("n", [1, 2, 4])
def test_a_flywheel_beside_zeros_of_its_acceleration(n: int) -> None:
    """Its torque is as accurate as the acceleration itself."""
    rng = np.random.default_rng([15, n])
    load = {"output_torque": 0.0, "inertias": [*[0.0] * n, 0.3], "speed": 20.0}
    for _ in range(3):
        line = spatial(rng, rng.uniform(0.1, 1.0, n))
        zeros = -float(line.equivalent().angle_offset) + RIGHT * np.arange(-2.0, 3.0)
        with mp.workdps(120):
            judge(line, [*zeros, *(zeros * (1.0 + EPS)), *(zeros + 1e-9)], load)


@pytest.mark.parametrize(
    ("bends", "twists", "phases", "angle"),
    [
        (
            [1.5707786360552296, 1.5707963202309416],
            [0.36011133950258545],
            [2.6006951916939594],
            -1.4009445256146636e-05,
        ),
        (
            [1.5675582741731924, 0.7010243500330174, 1.5356765840973932, 1.5707963099454976],
            [2.686190462129205, -0.8710465381564383, -1.84510306735028],
            [3.1204138561479837, 1.0510903282425588, -2.6756497506818055],
            0.0035948241714982643,
        ),
        (
            [0.7034961799410808, 1.5707963267947662],
            [1.688624197782124],
            [-1.3061613565491905],
            1.3792657990715835,
        ),
    ],
)
def test_cosines_that_multiply_to_little(
    bends: list[float], twists: list[float], phases: list[float], angle: float
) -> None:
    """Their product is 1e-13 to 1e-12. Bending moments beside a zero were 165 to 964 ulp off."""
    with mp.workdps(120):
        judge(Driveline.from_bends(bends, twists, phases), [angle], {"drive_torque": 3.0})


def test_sweeps() -> None:
    rng = np.random.default_rng(3)
    for n in (2, 5):
        line, load = spatial(rng, rng.uniform(0, 1.0, n)), loads(rng, n)
        for turns, per_turn in ((1, 36), (3, 7200)):
            samples = rng.integers(turns * per_turn, size=5).tolist()
            angles = [2 * mp.pi * sample / per_turn for sample in samples]
            at = [ExactTurn(angle, mp.sin(angle), mp.cos(angle)) for angle in angles]
            got = evaluated(line, Sweep.revolutions(turns, per_turn), load)
            picked = {name: got[name][:, samples] for name in NAMES}
            off = load_errors(line, picked, at, load).max(axis=0)
            assert np.all(off <= list(LIMITS.values())), f"{off} ulp"


def test_batches() -> None:
    rng = np.random.default_rng(4)
    bends = rng.uniform(0, 1.2, (70, 3))
    lines = Driveline.from_bends(bends, *rng.uniform(-math.pi, math.pi, (2, 70, 2)))
    angles = rng.uniform(-4, 4, 70)
    load = {"drive_torque": 5.0, "inertias": [0.1, 0.0, 0.2, 0.1], "speed": 3.0}
    each, rows = evaluated(lines, angles, load), evaluated(lines[:, None], angles[:2], load)
    for i in range(0, 70, 9):
        for got, at in (
            ({name: each[name][:, [i]] for name in NAMES}, angles[[i]]),
            ({name: rows[name][:, i] for name in NAMES}, angles[:2]),
        ):
            off = load_errors(lines[i], got, map(ExactTurn.by, at.tolist()), load).max(axis=0)
            assert np.all(off <= list(LIMITS.values())), f"{off} ulp"


def test_drive_and_inertia_that_nearly_cancel() -> None:
    """The default is as exact as each term: its unit is the ulp of the larger one."""
    rng = np.random.default_rng(29)
    bends, angles = rng.uniform(0, RIGHT - 1e-3, 300), rng.uniform(-4, 4, 300)
    speed, inertia = rng.uniform(0.5, 3, 300), rng.uniform(0.1, 1, 300)
    terms = [
        mp.mpf(w) ** 2 * mp.mpf(i) * ExactJoint.bent(bend).acceleration_ratio(ExactTurn.by(angle))
        for bend, angle, w, i in zip(
            *(x.tolist() for x in (bends, angles, speed, inertia)), strict=True
        )
    ]
    term = Exact.of(terms)
    output = -term.high * (1 + 10 ** rng.uniform(-12, -1, 300))
    want = Exact.of(x + mp.mpf(y) for x, y in zip(terms, output.tolist(), strict=True))
    inertias = np.stack([np.zeros(300), inertia], axis=-1)
    load = Load(output_torque=output, inertias=inertias, speed=speed)
    line = Driveline.from_bends(bends[:, None])
    for tolerance, unit, limit in (
        (None, term.ulp, OUTPUT_LIMITS["torque of a flywheel"]["worst"]),
        (0, want.ulp, LIMITS["torque"]),
    ):
        got = line.evaluate(angles, "torque", load=load, shafts=1, tolerance=tolerance).torque
        assert np.max(want.distance(got) / unit) <= limit

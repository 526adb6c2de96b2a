"""The same bits whichever way a result is computed."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from cardan import OUTPUTS, Driveline, Load, Result, Sweep, _core
from oracle import plan_at

MOTION = ("angle", "angle_error", "speed_ratio", "acceleration_ratio", "jerk_ratio")
LOADS = tuple(name for name, output in OUTPUTS.items() if output.unit == "N m")
CROSS = tuple(name for name, output in OUTPUTS.items() if output.of_cross)
ALL = (*MOTION, *LOADS, *CROSS)
FORCES = ("joint_force", "bearing_force")  # of drivelines with lengths
# Loops that find the pins of several motions themselves.
TOGETHER = (
    ("angle", "speed_ratio"),
    ("angle_error", "speed_ratio"),
    ("speed_ratio", "acceleration_ratio"),
    ("angle", "speed_ratio", "acceleration_ratio"),
)
TIERS: dict[str, dict[str, Any]] = {
    "default": {},
    "tolerance=0": {"tolerance": 0.0},
    "tolerance=1e-6": {"tolerance": 1e-6},
    "float32": {"dtype": np.float32},
}

LINES = {
    "one joint": Driveline.from_bends([0.5]),
    "one steep joint": Driveline.from_bends([1.55]),
    "small": Driveline.from_bends([0.01]),
    "large": Driveline.from_bends([1.2]),
    "steep chain": Driveline.from_bends([0.9, 0.8, 0.4], [0.3, 0.2], [0.1, 0.4]),
    "three joints": Driveline.from_bends([0.5, 0.0, 0.9], [0.3, -1.0], [0.7, 0.2]),
}
RANDOM = np.random.default_rng(1939)
ANGLES = np.concatenate([RANDOM.uniform(-20, 20, 3000), 10.0 ** RANDOM.uniform(-9, 15, 96)])
RANDOM.shuffle(ANGLES)


def load_for(line: Driveline) -> Load:
    return Load(
        drive_torque=7.0,
        speed=30.0,
        acceleration=2.0,
        inertias=np.linspace(0.1, 0.4, line.n_joints + 1),
    )


def evaluate(line: Driveline, angle: Any, names: Any = ALL, **options: Any) -> Result:  # noqa: ANN401
    out = options.pop("out", None)
    settings = {"shafts": slice(None), "load": load_for(line), **options}
    return plan_at(line, names, **settings)(angle, out)


def same(got: Result, want: Result, pick: Any = ...) -> None:  # noqa: ANN401
    """The same bits; but a zero may have either sign."""
    for name in got:
        expected = np.asarray(want[name])[pick] + 0.0
        assert (np.asarray(got[name]) + 0.0).tobytes() == expected.tobytes(), name


@pytest.fixture(params=LINES, ids=str)
def line(request: pytest.FixtureRequest) -> Driveline:
    return LINES[request.param]


def contiguous(result: Result) -> Result:
    return Result({name: np.ascontiguousarray(result[name]) for name in result})


@pytest.mark.parametrize("level", _core.levels())
@pytest.mark.parametrize("tier", TIERS, ids=str)
def test_every_level(line: Driveline, tier: str, level: str) -> None:
    assert {*ALL, *FORCES} == set(OUTPUTS)
    options = TIERS[tier]
    for angle in (ANGLES, Sweep(0.1, 4321.0, 2500), Sweep.revolutions(3, 500)):
        # One output alone takes other loops than all together.
        for names in (ALL, *ALL, *TOGETHER):
            want = contiguous(evaluate(line, angle, names, **options))
            same(contiguous(evaluate(line, angle, names, level=level, **options)), want)


def test_a_level_that_the_machine_does_not_have() -> None:
    with pytest.raises(ValueError, match='level "avx1024" is not available here'):
        evaluate(LINES["one joint"], ANGLES, level="avx1024")


SWEEPS = {
    "turns": Sweep.revolutions(3, 720),
    "short": Sweep(-3.0, 17.0, 2049),
    "long": Sweep(0.1, 43.21, 8193),
}


@pytest.mark.parametrize("level", _core.levels())
@pytest.mark.parametrize("sweep", SWEEPS.values(), ids=SWEEPS)
@pytest.mark.parametrize("options", [{}, {"tolerance": 0.0}, {"dtype": "float32"}], ids=str)
def test_sweeps_on_every_level(
    line: Driveline, sweep: Sweep, level: str, options: dict[str, Any]
) -> None:
    want = contiguous(evaluate(line, sweep, **options))
    same(contiguous(evaluate(line, sweep, level=level, **options)), want)


@pytest.mark.parametrize("level", _core.levels())
@pytest.mark.parametrize("options", [{}, {"tolerance": 0.0}, {"dtype": "float32"}], ids=str)
def test_geometry_per_sample_on_every_level(level: str, options: dict[str, Any]) -> None:
    bends = np.random.default_rng(3).uniform(0.0, 1.2, (2049, 3))
    lines = Driveline.from_bends(bends, 0.4, 0.1)
    for angle in (ANGLES[:2049], SWEEPS["short"]):
        want = contiguous(evaluate(lines, angle, **options))
        same(contiguous(evaluate(lines, angle, level=level, **options)), want)


@pytest.mark.parametrize("level", _core.levels())
@pytest.mark.parametrize("options", [{}, {"tolerance": 0.0}, {"dtype": "float32"}], ids=str)
def test_axes_of_shafts_on_every_level(
    line: Driveline, level: str, options: dict[str, Any]
) -> None:
    names = ("moment", "support_moment")
    for angle in (ANGLES, *SWEEPS.values()):
        want = contiguous(evaluate(line, angle, names, axes="shaft", **options))
        got = evaluate(line, angle, names, axes="shaft", level=level, **options)
        same(contiguous(got), want)


@pytest.mark.parametrize("axes", ["space", "shaft"])
@pytest.mark.parametrize("level", _core.levels())
def test_forces_on_every_level(level: str, axes: str) -> None:
    points = np.array([[0, 0, 0], [0.3, 0, 0], [1.5, -0.1, 0.05], [1.9, -0.2, 0.05]])
    bearings = [(0, 0.05), (0, 0.2), (2, 0.1), (2, 0.2)]
    line = Driveline.from_points(points).with_bearings(bearings)
    for angle in (ANGLES, SWEEPS["turns"]):
        for options in ({}, {"tolerance": 0.0}, {"dtype": "float32"}):
            settings: dict[str, Any] = {"axes": axes, **options}
            want = contiguous(evaluate(line, angle, FORCES, **settings))
            same(contiguous(evaluate(line, angle, FORCES, level=level, **settings)), want)


@pytest.mark.parametrize("tier", ["default", "tolerance=1e-6", "float32"])
@pytest.mark.parametrize("level", _core.levels()[:2])
def test_results_beyond_the_caches(line: Driveline, level: str, tier: str) -> None:
    # Each plane begins elsewhere in a cache line.
    angle = np.resize(ANGLES, 1_600_003)
    names = ("angle", "speed_ratio", "acceleration_ratio", "moment", "bending_driven")
    plan = plan_at(line, names, joints=0, load=load_for(line), level=level, **TIERS[tier])
    new = plan(angle)
    given = plan(angle, {name: np.full_like(new[name], np.nan) for name in names})
    for start in (0, 1024, 777_777, 1_595_003):
        part = slice(start, start + 5000)
        want = plan(angle[part])
        for name in names:
            expected = (np.ascontiguousarray(want[name]) + 0.0).tobytes()
            for found in (new, given):
                got = np.ascontiguousarray(found[name][part]) + 0.0
                assert got.tobytes() == expected, name


@pytest.mark.parametrize("tier", ["default", "float32"])
def test_every_length(line: Driveline, tier: str) -> None:
    whole = contiguous(evaluate(line, ANGLES, **TIERS[tier]))
    for length in [*range(68), 1023, 1024, 1025, 2047, 2049]:
        part = contiguous(evaluate(line, ANGLES[:length], **TIERS[tier]))
        for name in ALL:
            lead = whole[name].ndim - 1 - (whole[name].shape[-1] == 3)
            index = (slice(None),) * lead + (slice(length),)
            assert part[name].tobytes() == np.ascontiguousarray(whole[name][index]).tobytes(), name


@pytest.mark.parametrize("workers", [1, 2, 3, 4, 5, -1, None])
def test_every_number_of_threads(workers: int | None) -> None:
    line = LINES["three joints"]
    angle = np.tile(ANGLES, 50)
    assert angle.size > 65536  # from here on threads are used
    names = ("angle", "acceleration_ratio", "moment")
    got = evaluate(line, angle, names, workers=workers)
    once = evaluate(line, ANGLES, names)
    for name in names:
        axis = -2 if name == "moment" else -1
        assert np.array_equal(got[name], np.concatenate([once[name]] * 50, axis=axis)), name


@pytest.mark.parametrize("per_turn", [4500, 8191])
def test_turns_on_every_number_of_threads(line: Driveline, per_turn: int) -> None:
    sweep, names = Sweep.revolutions(24, per_turn), ("angle", "speed_ratio", "tilt_driven")
    want = evaluate(line, sweep, names, workers=1)
    for workers in (2, 3, -1):
        same(evaluate(line, sweep, names, workers=workers), want)


def test_rows_of_turns_that_blocks_divide() -> None:
    """A part of a row at the end of a block is longer than a period, but not repeated."""
    lines = Driveline.from_bends(np.linspace(0.1, 1.0, 100)[:, np.newaxis, np.newaxis])
    sweep, names = Sweep.revolutions(4, 750), ("angle", "speed_ratio")
    want = lines.plan(names, workers=1)(sweep)
    for workers in (2, 3, -1):
        same(lines.plan(names, workers=workers)(sweep), want)


def test_strided_angles(line: Driveline) -> None:
    spread = np.full((ANGLES.size, 3), np.nan)
    spread[::-1, 1] = ANGLES
    same(contiguous(evaluate(line, spread[::-1, 1])), contiguous(evaluate(line, ANGLES)))


@pytest.mark.parametrize("name", ["one joint", "one steep joint", "three joints"])
def test_geometry_per_sample(name: str) -> None:
    line = LINES[name]
    each = Driveline.from_bends(
        np.tile(line.bends, (ANGLES.size, 1)),
        np.tile(line.twists, (ANGLES.size, 1)),
        np.tile(line.phases, (ANGLES.size, 1)),
    )
    same(contiguous(evaluate(each, ANGLES)), contiguous(evaluate(line, ANGLES)))


def test_geometries_by_rows() -> None:
    bends = [[0.2, 0.3], [0.9, 0.4], [0.0, 1.2]]
    lines = Driveline.from_bends(np.array(bends)[:, np.newaxis], 0.4, 0.1)
    got = lines.evaluate(ANGLES, MOTION)
    for i, bend in enumerate(bends):
        single = Driveline.from_bends(bend, 0.4, 0.1).evaluate(ANGLES, MOTION)
        for name in MOTION:
            assert np.array_equal(got[name][i], single[name]), name


@pytest.mark.parametrize("tier", TIERS)
def test_outputs_alone_or_together(line: Driveline, tier: str) -> None:
    options = TIERS[tier]
    together = evaluate(line, ANGLES, **options)
    for names in (*((name,) for name in ALL), *TOGETHER[:3]):
        alone = evaluate(line, ANGLES, names, **options)
        same(contiguous(alone), contiguous(Result({name: together[name] for name in names})))


@pytest.mark.parametrize("tier", TIERS)
def test_shafts_and_joints_alone_or_together(line: Driveline, tier: str) -> None:
    options = TIERS[tier]
    together = evaluate(line, ANGLES, **options)
    for shaft in range(line.n_joints + 1):
        for name in (*MOTION, "torque", "support_moment"):
            alone = evaluate(line, ANGLES, name, shafts=shaft, **options)[name]
            assert np.array_equal(alone, together[name][shaft]), name
    for joint in range(line.n_joints):
        for name in (*LOADS[2:], *CROSS):
            alone = evaluate(line, ANGLES, name, joints=joint, **options)[name]
            assert np.array_equal(alone, together[name][joint]), name


def test_filled_in_place(line: Driveline) -> None:
    want = evaluate(line, ANGLES)
    out = {name: np.full(want[name].shape, np.nan) for name in ALL}
    evaluate(line, ANGLES, out=out)
    for name in ALL:
        assert np.array_equal(out[name], want[name]), name
    # The last shaft's angle over the drive angles themselves.
    inplace = ANGLES.copy()
    line.evaluate(inplace, "angle", out={"angle": inplace})
    assert np.array_equal(inplace, want.angle[-1])

"""Closed forms of design, against recorded figures, symmetry and textbooks."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import cardan
from cardan import Driveline
from cardan.design.judged import VERDICTS, is_within, ranked
from cardan.reference import design
from oracle import read
from refusals import refusals

DATA = read("design.json")


def line_of(case: dict[str, Any]) -> Driveline:
    return Driveline.from_bends(case["bends"], case["twists"], case["phases"])


def agrees(found: object, recorded: dict[str, Any]) -> None:
    """Compare with figures of 12 digits, next to a zero with those of the largest figure."""
    for name, want in recorded.items():
        got = np.ravel(getattr(found, name))
        near = 2e-15 * max(1.0, *np.abs(np.ravel(want)))
        np.testing.assert_allclose(got, np.ravel(want), rtol=1e-11, atol=near, err_msg=name)


@pytest.mark.parametrize("case", DATA["check"])
def test_recorded_excitations(case: dict[str, Any]) -> None:
    found = {f.figure: f.value for f in line_of(case).check(case["speed"]).findings}
    assert found.keys() == case["found"].keys()
    for figure, want in case["found"].items():
        assert found[figure] == pytest.approx(want, rel=1e-11)


@pytest.mark.parametrize("case", DATA["steering"])
def test_recorded_steering(case: dict[str, Any]) -> None:
    agrees(line_of(case).steering(case["centre"]), case["found"])


@pytest.mark.parametrize("case", DATA["spline"])
def test_recorded_splines(case: dict[str, Any]) -> None:
    line = Driveline.from_points(case["points"]).with_bearings(case["bearings"])
    agrees(line.spline_force(case["shaft"], *case["arguments"]), case["found"])


@pytest.mark.parametrize("case", DATA["tube"])
def test_recorded_tubes(case: dict[str, Any]) -> None:
    outer, wall, length = case["arguments"]
    found = cardan.tube(outer, wall, length=length)
    want = dict(case["found"])
    assert found.shear_stress(1500.0) == pytest.approx(want.pop("shear_stress"), rel=1e-11)
    agrees(found, want)


def test_excitations_of_a_batch_are_those_of_its_drivelines() -> None:
    """Many drivelines are shared among threads."""
    bends = np.random.default_rng(3).uniform(0.0, 1.2, (3, 1000, 3))
    lines = Driveline.from_bends(bends, 0.3, -0.4)
    batch = lines.check(2.0).findings
    assert batch[0].value.shape == (3, 1000)
    for place in ((0, 0), (1, 500), (2, 999)):
        for found, alone in zip(batch, lines[place].check(2.0).findings, strict=True):
            assert found.value[place] == alone.value


def test_steering_broadcasts() -> None:
    lines = Driveline.from_bends([[0.2, 0.3], [0.4, 0.5]], 0.1, 0.2)
    found = lines.steering(np.linspace(-1.0, 1.0, 5)[:, np.newaxis])
    assert found.quick.shape == found.slope.shape == (5, 2)
    assert found.ratio[3, 1] == lines[1].steering(0.5).ratio


def test_the_ratio_differs_by_as_much_as_a_scan_finds() -> None:
    away = np.linspace(0.0, np.pi / 2.0, 20001)
    rng = np.random.default_rng(0)
    for top in (0.01, 0.5, 1.2, 1.5):
        line = Driveline.from_bends(rng.uniform(0.0, top, 2), *rng.uniform(-3.0, 3.0, (2, 1)))
        for centre in rng.uniform(-3.0, 3.0, 5):
            left, right = (
                line.evaluate(centre + side * away, "speed_ratio").speed_ratio for side in (-1, 1)
            )
            worst = np.max(np.abs(left - right))
            found = line.steering(centre).difference
            assert worst * (1.0 - 1e-12) - 1e-14 <= found <= worst * (1.0 + 1e-3) + 1e-14
    assert Driveline.from_bends([0.0]).steering(0.1).difference == 0.0


def test_joints_as_built_have_no_closed_forms() -> None:
    line = Driveline.from_bends([0.1, 0.2]).with_deviations(cross=0.01)
    for call in (line.check, line.steering):
        with pytest.raises(ValueError, match="has joints with deviations"):
            call()


# --- steering ------------------------------------------------------------------------------------

POINTS = np.array([[0, 0, 0], [0.55, 0, -0.28], [0.78, 0.09, -0.52], [0.90, 0.10, -0.60]])


def column() -> Driveline:
    line = Driveline.from_points(POINTS)
    return line.with_phases(line.optimal_phases())


def test_a_column_computed_elsewhere() -> None:
    """Numbers of an independent computation, with the best phase of these points."""
    line = column()
    np.testing.assert_allclose(np.degrees(line.bends), [24.30841215, 16.64808719], atol=5e-9)
    np.testing.assert_allclose(np.degrees(line.twists), [-175.8855785], atol=5e-8)
    np.testing.assert_allclose(np.degrees(line.phases), [4.1144215], atol=5e-8)
    quick = line.steering(line.steering().turn_to_quick)
    slow = line.steering(line.steering().turn_to_slow)
    assert abs(quick.ratio - 1.051286534) < 5e-10
    assert abs(slow.ratio - 0.951215456) < 5e-10
    assert quick.quick
    assert not slow.quick
    np.testing.assert_allclose([quick.slope, slow.slope, quick.offset, slow.offset], 0, atol=1e-12)


@pytest.mark.parametrize("seed", range(8))
def test_turned_to_symmetry_the_ratio_is_the_same_on_both_sides(seed: int) -> None:
    rng = np.random.default_rng(seed)
    line = Driveline.from_bends(rng.uniform(0.1, 0.6, 3), rng.uniform(-3, 3, 2), [0.3, -0.2])
    centre = rng.uniform(-4.0, 4.0)
    found = line.steering(centre)
    away = np.linspace(0.0, 3.0, 61)
    for turn, quick in ((found.turn_to_quick, True), (found.turn_to_slow, False)):
        left, right = (
            line.evaluate(centre + turn + sign * away, "speed_ratio").speed_ratio
            for sign in (-1.0, 1.0)
        )
        np.testing.assert_allclose(left, right, rtol=1e-12)
        np.testing.assert_allclose(left[0], np.max(left) if quick else np.min(left), rtol=1e-12)
    # Nowhere else are both sides alike.
    ratios = [line.evaluate(centre + sign * away, "speed_ratio").speed_ratio for sign in (-1, 1)]
    assert np.max(np.abs(ratios[0] - ratios[1])) > 1e-3 * abs(found.offset)
    assert abs(found.offset) <= np.pi / 4.0
    nearest = found.turn_to_quick if found.quick else found.turn_to_slow
    np.testing.assert_allclose(found.offset, -nearest, atol=1e-12)


def test_batches_and_degrees() -> None:
    lines = Driveline.from_bends([[0.1], [0.2]])
    found = lines.steering([[0.0], [30.0], [90.0]], degrees=True)
    assert found.ratio.shape == found.quick.shape == (3, 2)
    np.testing.assert_allclose(found.ratio[0], 1.0 / np.cos([0.1, 0.2]), rtol=1e-13)
    np.testing.assert_allclose(found.ratio[2], np.cos([0.1, 0.2]), rtol=1e-13)
    np.testing.assert_allclose(np.degrees(found.offset), [[0, 0], [30, 30], [0, 0]], atol=1e-12)
    assert found.quick.tolist() == [[True, True], [True, True], [False, False]]
    with pytest.raises(TypeError, match="centre"):
        lines.steering("a")


def pin(line: Driveline, angle: float) -> np.ndarray[Any, np.dtype[np.float64]]:
    """The driving pin of joint 0 at an angle of the drive, which counts from the first plane."""
    along, normal = line.directions[0], line.normals[0]
    return np.asarray(np.cos(angle) * np.cross(normal, along) + np.sin(angle) * normal)


@pytest.mark.parametrize("move", [(0.0, 0.0, 0.12), (0.0, -0.2, 0.05), (0.1, 0.3, -0.3)])
def test_a_column_that_tilts_carries_its_yoke_along(move: tuple[float, ...]) -> None:
    """The pin of the drawing is rotated about the axis that is square to both columns."""
    tilted = POINTS.copy()
    tilted[0] += move
    drawn, there = Driveline.from_points(POINTS), Driveline.from_points(tilted)
    axis = np.cross(drawn.directions[0], there.directions[0])
    angle = np.arctan2(np.linalg.norm(axis), drawn.directions[0] @ there.directions[0])
    rotation = Rotation.from_rotvec(angle * axis / np.linalg.norm(axis))
    start = 0.3
    carried = rotation.apply(pin(drawn, start))
    centre = np.arctan2(
        carried @ there.normals[0], carried @ np.cross(there.normals[0], there.directions[0])
    )
    np.testing.assert_allclose(pin(there, centre), carried, atol=1e-14)
    found, same = there.steering(start, drawn=drawn), there.steering(centre)
    np.testing.assert_allclose(found.offset, same.offset, atol=1e-13)
    np.testing.assert_allclose(found.ratio, same.ratio, rtol=1e-13)
    machine = cardan.Machine(there, drawn=drawn).with_steering(start)
    (offset,) = (one.values for one in machine.figures() if one.kind.name == "steering_offset")
    np.testing.assert_allclose(offset, [abs(found.noticed)], atol=1e-13)
    assert abs(there.steering(start).offset - found.offset) > 1e-3


def test_what_no_driver_notices() -> None:
    """Below 0.1 % of difference from left to right, the offset does not count."""
    for bend, counts in ((0.02, False), (0.04, True)):
        found = Driveline.from_bends([bend]).steering(0.5)
        assert (found.difference >= 1e-3) == counts
        assert found.offset == pytest.approx(0.5)
        assert found.noticed == (found.offset if counts else 0.0)


def test_one_driveline_is_the_drawing() -> None:
    line = Driveline.from_bends([[0.1], [0.2]])
    for call in (lambda: line.steering(drawn=line), lambda: cardan.Machine(line, drawn=line)):
        with pytest.raises(ValueError, match=r"drawn has shape \(2,\); it is one driveline"):
            call()


# --- tubes ---------------------------------------------------------------------------------------


def test_a_tube_of_steel() -> None:
    # 90 x 3 mm, 1.5 m long.
    shaft = cardan.tube(0.09, 0.003, length=1.5)
    assert shaft.stiffness == pytest.approx(82123.4, abs=0.05)
    assert shaft.shear_stress(2000.0) == pytest.approx(57.937e6, abs=500.0)
    assert shaft.critical_speed * 30 / math.pi == pytest.approx(6604.19, abs=0.005)
    assert isinstance(shaft.shear_stress(2000.0), float)


def test_a_solid_bar_has_the_largest_wall() -> None:
    solid, full = cardan.tube(0.04, length=1.0), cardan.tube(0.04, 0.02, length=1.0)
    assert solid.stiffness == full.stiffness == pytest.approx(7.93e10 * math.pi * 0.04**4 / 32)


def test_tubes_broadcast() -> None:
    shafts = cardan.tube([0.08, 0.09], [[0.002], [0.003], [0.004]], length=1.2)
    assert shafts.stiffness.shape == (3, 2)
    assert shafts.shear_stress(100.0).shape == (3, 2)
    assert shafts.stiffness[1, 1] == cardan.tube(0.09, 0.003, length=1.2).stiffness
    assert shafts.bending_stiffness.shape == shafts.shear_stiffness.shape == (3, 2)
    damped = cardan.tube(0.09, 0.003, length=1.2, rotary=True, loss_factor=[0.0, 0.01])
    assert damped.loss_factor.tolist() == [0.0, 0.01]
    assert damped.rotary_inertia.shape == damped.stiffness.shape == (2,)


def test_a_tube_bends_by_one_of_two_theories() -> None:
    """Euler's has neither shear nor rotary inertia."""
    euler = cardan.tube(0.09, 0.003, length=1.5)
    assert (euler.shear_stiffness, euler.rotary_inertia, euler.loss_factor) == (math.inf, 0.0, 0.0)
    inertia = math.pi / 64.0 * (0.09**4 - 0.084**4)
    assert euler.bending_stiffness == pytest.approx(2.06e11 * inertia, rel=1e-13)
    area = math.pi / 4.0 * (0.09**2 - 0.084**2)
    assert euler.line_mass == pytest.approx(7850.0 * area, rel=1e-13)
    given = cardan.tube(0.09, 0.003, length=1.5, rotary=True, shear_coefficient=0.5)
    assert given.shear_stiffness == pytest.approx(0.5 * 7.93e10 * area, rel=1e-13)
    assert given.rotary_inertia == pytest.approx(7850.0 * inertia, rel=1e-13)


@pytest.mark.parametrize("poisson", [0.0, 0.3, 0.5])
def test_shear_coefficient_of_round_sections(poisson: float) -> None:
    """Those of Cowper 1966: a solid bar, and a wall so thin that its thickness has no effect."""
    options = {"elastic_modulus": 2.0 * (1.0 + poisson), "shear_modulus": 1.0, "density": 1.0}
    for wall, wanted in (
        (None, 6.0 * (1.0 + poisson) / (7.0 + 6.0 * poisson)),
        (1e-7, 2.0 * (1.0 + poisson) / (4.0 + 3.0 * poisson)),
    ):
        tube = cardan.tube(0.1, wall, length=1.0, rotary=True, **options)
        assert tube.shear_stiffness / tube.line_mass == pytest.approx(wanted, rel=1e-9)


test_wrong_tubes_are_refused = refusals(
    {
        "outer_diameter is 0.0; it must be positive": {"outer_diameter": 0.0, "length": 1.0},
        "length is inf; it must be positive": {"outer_diameter": 0.1, "length": float("inf")},
        "wall[1] is 0.06 m; a wall is at most half the outer diameter": {
            "outer_diameter": 0.1,
            "wall": [0.01, 0.06],
            "length": 1.0,
        },
        "wall[1] is 0.06 m; a wall is": {
            "outer_diameter": 0.1,
            "wall": [0.05, 0.06],
            "length": 1.0,
        },
        "wall[1] is 0.06 m": {"outer_diameter": [0.2, 0.1], "wall": 0.06, "length": 1.0},
        "shear_coefficient is given without rotary=True; without it shear has no effect": {
            "outer_diameter": 0.1,
            "length": 1.0,
            "shear_coefficient": 0.5,
        },
        "shear_coefficient is 0.0; it must be positive": {
            "outer_diameter": 0.1,
            "length": 1.0,
            "rotary": True,
            "shear_coefficient": 0.0,
        },
        "loss_factor is -0.1; it": {"outer_diameter": 0.1, "length": 1.0, "loss_factor": -0.1},
    },
    cardan.tube,
)


# --- ranks ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("most", [True, False])
@pytest.mark.parametrize("size", [0.0, 1.0, 1e4])
def test_ranks_are_those_of_exact_fractions(size: float, most: bool) -> None:
    # None is just at the rounding.
    near = [sign * 0.7 * 10.0**-power for power in range(6, 13) for sign in (1, -1)]
    limits = [0.0, 7.3e-3, 3.0, -2.0, math.inf, -math.inf, math.nan]
    for limit in limits:
        for room in (0.0, 0.5):
            maximum = limit + room if most else limit - room
            scale = max(abs(limit), size) if math.isfinite(limit) else 1.0
            values = [limit, maximum, *(limit + x * scale for x in near), math.inf, math.nan, -1e9]
            values += [maximum + x * max(abs(maximum), size) for x in near]
            got = ranked(values, limit, maximum, most=most, size=size)
            for value, rank in zip(values, got, strict=True):
                want = design.ranked(value, limit, maximum, most=most, size=size)
                unknown = math.isnan(value) and not math.isnan(limit)
                names = ("not judged", "within", "tolerable", "beyond")
                word = "unknown" if unknown else names[want]
                assert VERDICTS[rank] == word, (value, limit, maximum)
                within = design.ranked(value, limit, limit, most=most, size=size) == 1
                assert is_within(value, limit, most=most, size=size) == within


def test_ranks_broadcast() -> None:
    got = ranked([[1.0], [3.0]], [2.0, math.nan, 0.5], [4.0, 4.0, 0.5])
    words = [["within", "not judged", "beyond"], ["tolerable", "not judged", "beyond"]]
    assert np.array(VERDICTS)[got].tolist() == words

"""Geometry: the five ways to a driveline, its frames, and the equivalent joint."""

from __future__ import annotations

import copy
import math
import pickle
from typing import Any

import numpy as np
import pytest

from cardan import Driveline, reference
from oracle import EPS, mp, read
from refusals import refusals

CHAINS = read("chains.json")["cases"]


def chain(case: dict[str, Any]) -> Driveline:
    points = [[float(x) for x in point] for point in case["points"]]
    return Driveline.from_points(points, [float(x) for x in case["yoke_phase"]])


def folded(angle: float, period: float) -> float:
    return abs(angle - period * round(angle / period))


def test_the_frame_of_bends() -> None:
    line = Driveline.from_bends([0.3, 0.5], twists=[math.pi / 2])
    assert line.directions[0].tolist() == [1, 0, 0]
    assert line.normals[0].tolist() == [0, 0, 1]
    assert line.directions[1] == pytest.approx([math.cos(0.3), math.sin(0.3), 0], abs=EPS)
    # A quarter turn of the normal about shaft 1 bends the rest out of the first plane.
    u = line.directions[1]
    m = np.cross(u, line.normals[0])
    assert line.normals[1] == pytest.approx(m, abs=4 * EPS)
    bent = math.cos(0.5) * u + math.sin(0.5) * np.cross(m, u)
    assert line.directions[2] == pytest.approx(bent, abs=4 * EPS)


def test_every_way_leads_to_the_same_driveline() -> None:
    given = Driveline.from_bends([0.3, 0.5, 0.2], [0.4, -2.0], [1.0, 0.5])
    spans = given.directions * np.array([[2.0], [0.5], [1.0], [3.0]])
    points = np.array([1, 2, 3]) + np.vstack([np.zeros(3), np.cumsum(spans, axis=0)])
    slopes = np.arctan(given.directions[:, 1:] / given.directions[:, :1])
    for line in (
        Driveline.from_directions(spans, given.phases),
        Driveline.from_points(points, given.phases),
        Driveline.from_slopes(slopes[:, 0], slopes[:, 1], given.phases),
        Driveline.from_slopes(
            np.degrees(slopes[:, 0]),
            np.degrees(slopes[:, 1]),
            np.degrees(given.phases),
            degrees=True,
        ),
    ):
        assert line.n_joints == 3
        assert line.bends == pytest.approx(given.bends, rel=1e-13)
        assert line.twists == pytest.approx(given.twists, abs=1e-13)
        assert line.phases == pytest.approx(given.phases, rel=1e-15)
        assert line.directions == pytest.approx(given.directions, abs=1e-14)
        assert line.normals == pytest.approx(given.normals, abs=1e-13)


def test_batches_are_drivelines_side_by_side() -> None:
    random = np.random.default_rng(2)
    steps = random.uniform([1, -0.5, -0.5], [2, 0.5, 0.5], (4, 1, 5, 3))
    points = np.cumsum(steps, axis=-2)
    phases = random.uniform(-3, 3, (6, 2))
    lines = Driveline.from_points(points, phases)
    assert lines.shape == (4, 6)
    assert lines.bends.shape == (4, 6, 3)
    assert lines.directions.shape == (4, 6, 4, 3)
    for i in range(4):
        for j in range(6):
            one = Driveline.from_points(points[i, 0], phases[j])
            for name in ("bends", "twists", "phases", "directions", "normals"):
                assert np.array_equal(getattr(lines, name)[i, j], getattr(one, name)), name
    joints = lines.equivalent()
    assert joints.bend.shape == (4, 6)
    assert joints.k[2, 3] == Driveline.from_points(points[2, 0], phases[3]).equivalent().k


def test_projected_bends_are_slopes_against_the_named_shaft() -> None:
    line = Driveline.from_projected_bends([0.2, -0.1], [0.1, 0.3])
    assert line.directions[1] == pytest.approx([1, 0, 0])
    up, right = line.directions[2, 1:] / line.directions[2, 0]
    assert (up, right) == pytest.approx((math.tan(-0.1), math.tan(0.3)))
    up, right = line.directions[0, 1:] / line.directions[0, 0]
    assert (up, right) == pytest.approx((-math.tan(0.2), -math.tan(0.1)))
    first = Driveline.from_projected_bends([0.2, -0.1], [0.1, 0.3], reference="input")
    assert first.directions[0] == pytest.approx([1, 0, 0])
    last = Driveline.from_projected_bends([0.2, -0.1], [0.1, 0.3], reference="output")
    assert last.directions[2] == pytest.approx([1, 0, 0])


def test_z_and_w_from_points() -> None:
    z = Driveline.from_points(np.array([[0, 0, 0], [1, 0, 0], [2, 0.3, 0], [3, 0.3, 0]]))
    w = Driveline.from_points(np.array([[0, 0.3, 0], [1, 0, 0], [2, 0, 0], [3, 0.3, 0]]))
    assert abs(z.twists[0]) == pytest.approx(math.pi, abs=1e-15)
    assert w.twists[0] == 0
    for line in (z, w):
        assert line.equivalent().k < 1e-16
        crossed = line.with_phases([math.pi / 2]).equivalent()
        doubled = math.cos(float(line.bends[0])) ** 2
        assert crossed.min_speed_ratio == pytest.approx(doubled, rel=1e-14)


def test_straight_joints_take_the_plane_of_their_neighbours() -> None:
    u, v = [1, 0, 0], [1, 1, 0]
    first = Driveline.from_directions([u, u, u, v], 0.3)
    assert first.bends.tolist()[:2] == [0, 0]
    assert first.normals.tolist() == [[0, 0, 1]] * 3
    assert first.twists.tolist() == [0, 0]
    # Of two bends out of one plane the next counts, or the drive angle's zero would move.
    for spatial in (
        Driveline.from_directions([u, u, v, [1, 1, 1]]),
        reference.from_directions([u, u, v, [1, 1, 1]]),
    ):
        assert np.array(spatial.normals)[:2].tolist() == [[0, 0, 1]] * 2
        assert abs(spatial.twists[0]) == 0
        assert abs(spatial.twists[1]) > 1
    last = Driveline.from_directions([v, u, u], 0.0)
    assert last.normals.tolist() == [[0, 0, -1]] * 2
    assert Driveline.from_directions([u, u]).normals.tolist() == [[0, 0, 1]]
    assert Driveline.from_directions([[0, 0, 2], [0, 0, 1]]).normals.tolist() == [[1, 0, 0]]


def test_points_on_a_line_are_straight_within_rounding() -> None:
    along = np.array([0.1, 0.2, 0.7])
    line = Driveline.from_points([i * along for i in (0.0, 0.3, 0.7, 1.9)])
    assert line.bends.tolist() == [0, 0]
    assert line.equivalent().bend == 0


@pytest.mark.parametrize("size", [1e-3, 1e-6, 1e-9, 1e-12])
def test_small_bends_keep_their_digits(size: float) -> None:
    random = np.random.default_rng(9)
    for _ in range(20):
        a = random.uniform(-1, 1, 3)
        b = a + size * random.uniform(-1, 1, 3)
        line = Driveline.from_directions([a, b])
        u, v = ([mp.mpf(float(x)) for x in vector] for vector in (a, b))
        cross = [u[i - 2] * v[i - 1] - u[i - 1] * v[i - 2] for i in range(3)]
        dot = sum(x * y for x, y in zip(u, v, strict=True))
        exact = mp.atan2(mp.sqrt(sum(x * x for x in cross)), dot)
        assert abs(mp.mpf(float(line.bends[0])) / exact - 1) < 4 * EPS


@pytest.mark.parametrize("scale", [1e-200, 1e-9, 1.0, 1e12, 1e200])
def test_any_unit_of_length(scale: float) -> None:
    points = np.array([[0, 0, 0], [1, 0.1, 0], [2, 0.3, 0.2], [3, 0.1, 0.1]])
    want = Driveline.from_points(points)
    got = Driveline.from_points(points * scale)
    assert got.bends == pytest.approx(want.bends, rel=1e-13)


@pytest.mark.parametrize("case", CHAINS, ids=lambda case: case["name"])
def test_chains(case: dict[str, Any]) -> None:
    line = chain(case)
    bends = [float(b) for b in case["beta_deg"]]
    assert np.degrees(line.bends) == pytest.approx(bends, rel=4e-15, abs=1e-13)
    for found, twist in zip(np.degrees(line.twists), case["twist_deg"], strict=True):
        if twist is not None:
            assert folded(found - float(twist), 360) < 1e-12
    if "equivalent" not in case:
        return
    # w -> A w + B conj(w) of the unit vector along the driving pin, from the vector model.
    a, b = (complex(*map(float, case["equivalent"][name])) for name in "AB")
    got = line.equivalent()
    # Absolute in k: near full compensation its digits have cancelled.
    assert abs(float(got.k) - abs(b / a)) <= 1e-15
    if abs(b) > 1e-6:
        want = (b / a).conjugate() / abs(b / a)
        found = -np.exp(2j * got.angle_offset)
        assert abs(found - want) <= 1e-15 / float(got.k)


@pytest.mark.parametrize("case", read("aligned_bends.json")["cases"], ids=lambda c: str(c["betas"]))
def test_aligned_and_crossed_yokes(case: dict[str, Any]) -> None:
    # A sign that differs from the one before: this joint works against it, yokes in one plane.
    bends = np.array(case["betas"], dtype=float)
    crossed = np.where(bends[1:] * bends[:-1] > 0, 90.0, 0.0)
    line = Driveline.from_bends(abs(bends), phases=crossed, degrees=True)
    assert math.degrees(line.equivalent().bend) == pytest.approx(
        float(case["exact_deg"]), rel=1e-13
    )
    rule = math.degrees(line.catalogue_bend(np.sign(bends)))
    assert rule == pytest.approx(float(case["rule_deg"]), rel=1e-13, abs=1e-6)


@pytest.mark.parametrize(
    "case", read("extremes.json")["extremes"], ids=lambda case: case["beta_deg"]
)
def test_extremes_of_one_joint(case: dict[str, Any]) -> None:
    bend = float(case["beta_deg"])
    got = Driveline.from_bends([bend], degrees=True).equivalent()
    rounded = 4 * EPS * (1 + math.radians(bend) * math.tan(math.radians(bend)))
    assert math.degrees(got.bend) == pytest.approx(bend, rel=1e-15)
    assert got.angle_offset == 0
    want = {
        "max_speed_ratio": float(case["ratio_max"]),
        "min_speed_ratio": float(case["ratio_min"]),
        "non_uniformity": float(case["u"]),
        "max_acceleration_ratio": abs(float(case["accel_min"])),
        "max_angle_error": math.radians(float(case["delta_max_deg"])),
    }
    for name, value in want.items():
        assert getattr(got, name) == pytest.approx(value, rel=4 * rounded), name


def test_extremes_are_those_of_the_sampled_motion() -> None:
    line = Driveline.from_bends([0.5, 0.9, 0.3], [0.1, 1.0], [0.5, 0.2])
    angle = np.linspace(0, math.pi, 200_001)
    for shaft in range(4):
        joint = line.equivalent(shaft)
        motion = line.evaluate(
            angle, ("angle_error", "speed_ratio", "acceleration_ratio"), shafts=shaft
        )
        assert np.ptp(motion.speed_ratio) == pytest.approx(float(joint.non_uniformity), rel=1e-8)
        for name, value in (
            ("angle_error", joint.max_angle_error),
            ("acceleration_ratio", joint.max_acceleration_ratio),
        ):
            assert np.max(motion[name]) == pytest.approx(float(value), rel=1e-8, abs=0), name
        assert np.max(motion.speed_ratio) == pytest.approx(float(joint.max_speed_ratio), rel=1e-8)
        assert np.min(motion.speed_ratio) == pytest.approx(float(joint.min_speed_ratio), rel=1e-8)


def test_the_cost_of_sixty_four_joints_is_that_of_one() -> None:
    # Not timed: the chain must fold to a joint whose motion is the last shaft's.
    random = np.random.default_rng(64)
    line = Driveline.from_bends(random.uniform(0, 0.3, 64), *random.uniform(-3, 3, (2, 63)))
    joint = line.equivalent()
    angle = np.linspace(0, 6, 500)
    single = Driveline.from_bends([float(joint.bend)])
    got = line.evaluate(angle, "speed_ratio").speed_ratio
    want = single.evaluate(angle + float(joint.angle_offset), "speed_ratio").speed_ratio
    assert got == pytest.approx(want, rel=1e-12)


@pytest.mark.parametrize("n", [1, 2, 3, 4])
def test_where_the_angles_of_a_reversed_driveline_count_from(n: int) -> None:
    rng = np.random.default_rng(n)
    line = Driveline.from_bends(
        rng.uniform(0.2, 0.8, n), rng.uniform(-3, 3, n - 1), rng.uniform(-3, 3, n - 1)
    )
    back, drive = line.reversed(), np.linspace(0.0, 6.0, 50)
    last = line.evaluate(drive, "angle").angle
    from_where = float(np.angle(-line.transmission().q * back.transmission().q)) / 2
    if n == 1:
        assert abs(from_where) == pytest.approx(math.pi / 2)
    again = back.evaluate(from_where - last, "angle").angle
    assert again == pytest.approx(from_where - drive, abs=1e-13)
    # The shafts stand as they did: the tilts of the last joint change places.
    tilts = line.evaluate(drive, ("tilt_driving", "tilt_driven"), joints=-1)
    turned = back.evaluate(from_where - last, ("tilt_driving", "tilt_driven"), joints=0)
    assert np.abs(turned.tilt_driving) == pytest.approx(np.abs(tilts.tilt_driven), abs=1e-13)
    assert np.abs(turned.tilt_driven) == pytest.approx(np.abs(tilts.tilt_driving), abs=1e-13)


def test_with_phases() -> None:
    line = Driveline.from_bends([0.1, 0.2, 0.3])
    set_anew = line.with_phases([[1, 2], [3, 4], [5, 6]])
    assert set_anew.shape == (3,)
    assert set_anew.phases.tolist() == [[1, 2], [3, 4], [5, 6]]
    assert set_anew.bends.tolist() == [line.bends.tolist()] * 3
    assert line.phases.tolist() == [0, 0]
    assert line.with_phases(90, degrees=True).phases == pytest.approx([math.pi / 2] * 2)


def test_with_phases_of_a_batch() -> None:
    line = Driveline.from_bends([[0.1, 0.2, 0.3], [0.3, 0.1, 0.2]], [[1, 2], [3, 4]])
    for phases in (np.full((4, 1, 2), 0.5), np.linspace(0, 1, 4).reshape(2, 2)):
        set_anew = line.with_phases(phases)
        assert set_anew.shape == np.broadcast_shapes((2,), phases.shape[:-1])
        for place in np.ndindex(set_anew.shape):
            got, own = set_anew[place], line[place[-1]]
            own_phases = np.broadcast_to(phases, (*set_anew.shape, 2))[place]
            for name in ("bends", "twists", "directions", "normals"):
                assert getattr(got, name).tolist() == getattr(own, name).tolist()
            assert got.phases.tolist() == own_phases.tolist()
    with pytest.raises(
        ValueError, match=r"^shapes do not broadcast: driveline \(2,\), phases \(3,"
    ):
        line.with_phases(np.zeros((3, 2)))


def test_slopes_and_projected_bends_to_the_right_angle() -> None:
    near = Driveline.from_slopes([0.0, 1.57], [0.0, 0.0])
    assert near.bends == pytest.approx([1.57], rel=1e-14)
    steep = Driveline.from_projected_bends([40, 45], [0, 0], reference="input", degrees=True)
    assert np.degrees(steep.bends) == pytest.approx([40, 45], rel=1e-14)


def test_orders_of_harmonics() -> None:
    line = Driveline.from_bends([0.4])
    for orders in ([1, 2, 4], np.array([1, 2, 4], np.uint8)):
        found = line.harmonics(orders)
        assert found.orders.dtype == np.int64
        assert found.orders.tolist() == [1, 2, 4]
        k = math.tan(0.2) ** 2
        assert found.speed_ratio == pytest.approx([0, 2 * k, 2 * k**2], rel=1e-14)


def test_drivelines_do_not_change() -> None:
    phases = np.array([0.5])
    line = Driveline.from_bends([0.1, 0.2], phases=phases)
    set_anew = line.with_phases(phases)
    phases[0] = 9.0
    assert line.phases.tolist() == set_anew.phases.tolist() == [0.5]
    for name in ("bends", "twists", "phases", "directions", "normals"):
        with pytest.raises(ValueError, match="read-only"):
            getattr(line, name)[...] = 0.0
        with pytest.raises(AttributeError):
            setattr(line, name, np.zeros(2))
    assert copy.copy(line) is line
    assert copy.deepcopy(line) is line
    again = pickle.loads(pickle.dumps(line))
    assert again.directions.tolist() == line.directions.tolist()
    assert again != line
    assert len({line, again}) == 2
    assert repr(line) == (
        "<Driveline of 2 joints: bends 5.72958 11.4592 deg, twists 0 deg, phases 28.6479 deg>"
    )
    assert repr(Driveline.from_bends([[0.1], [0.2]])) == "<Driveline batch (2,) of 1 joint>"
    with pytest.raises(TypeError, match="from_bends"):
        Driveline()


test_bad_input = refusals(
    {
        "bends[2] is 1.6 rad; a bend": lambda: Driveline.from_bends([0.1, 0.2, 1.6]),
        "bends[1, 0] is -0.1 rad": lambda: Driveline.from_bends([[0.1], [-0.1]]),
        "bends[0, 2, 0] is -0.1 rad": lambda: Driveline.from_bends(
            [[[0.1], [0.1], [-0.1]], [[0.1], [0.1], [0.1]]]
        ),
        "bends[0] is nan rad": lambda: Driveline.from_bends([math.nan]),
        "bends[0] is 90.0 deg": lambda: Driveline.from_bends([90], degrees=True),
        "it needs at least one": lambda: Driveline.from_bends([]),
        "twists has shape (2,)": lambda: Driveline.from_bends([0.1, 0.2], [1, 2]),
        "phases has shape (1, 1)": lambda: Driveline.from_bends([0.1] * 3, 0, [[1]]),
        "twists[1] is inf; it must be finite": lambda: Driveline.from_bends(
            [0.1] * 3, [0, math.inf]
        ),
        "shapes do not broadcast: bends (2,), twists (3,), phases ()": lambda: Driveline.from_bends(
            [[0.1] * 2] * 2, [[0]] * 3
        ),
        "TypeError: bends has dtype complex128": lambda: Driveline.from_bends([1j]),
        "TypeError: bends has dtype <U1": lambda: Driveline.from_bends(["a"]),
        "points[2] is (1, 0, 0) after (1, 0, 0); two successive points must differ": lambda: (
            Driveline.from_points([[0, 0, 0], [1, 0, 0], [1, 0, 0]])
        ),
        "points[0, 1] is (1, 0, NaN); a point must be finite": lambda: Driveline.from_points(
            np.array([[[0, 0, 0], [1, 0, math.nan], [2, 0, 0]]])
        ),
        "points give bends[0] = 2.03": lambda: Driveline.from_points(
            np.array([[0, 0, 0], [1, 0, 0], [0.5, 1, 0]])
        ),
        "(2, 3); it must be (..., 3 or more, 3)": lambda: Driveline.from_points(
            [[0, 0, 0], [1, 0, 0]]
        ),
        "directions[1] is (0, 0, 0); a direction must be finite and not zero": lambda: (
            Driveline.from_directions([[1, 0, 0], [0, 0, 0]])
        ),
        "directions has shape": lambda: Driveline.from_directions([[1, 0], [1, 1]]),
        "vertical[1] is 95.0; a slope must lie between -90 deg and 90 deg": lambda: (
            Driveline.from_slopes([0, 95], [0, 0], degrees=True)
        ),
        "vertical[1] is 1.5708; a slope must lie between -pi/2 rad and pi/2 rad": lambda: (
            Driveline.from_slopes([0, 1.5708], [0, 0])
        ),
        "horizontal[0] is 90.0; a slope must lie between -90 deg and 90 deg": lambda: (
            Driveline.from_slopes([0, 0], [90, 0], degrees=True)
        ),
        "vertical has 2 shafts and horizontal 1; they must be the same": lambda: (
            Driveline.from_slopes([0, 1], [0])
        ),
        "shapes do not broadcast: vertical (2, 3), horizontal (4, 3)": lambda: (
            Driveline.from_slopes(np.zeros((2, 3)), np.zeros((4, 3)))
        ),
        "vertical has shape (3,); two joints need (..., 2)": lambda: Driveline.from_projected_bends(
            [0, 0, 0], [0, 0, 0]
        ),
        "horizontal[1] is -95.0; a projected bend must lie between -90 deg and 90 deg": lambda: (
            Driveline.from_projected_bends([0, 0], [0, -95], degrees=True)
        ),
        "vertical adds up to 90 deg or more against the output shaft": lambda: (
            Driveline.from_projected_bends([1, 1], [0, 0], reference="output")
        ),
        "reference is 'middle'; it must be 'common', 'input' or 'output'": lambda: (
            Driveline.from_projected_bends([0, 0], [0, 0], reference="middle")  # type: ignore[arg-type]
        ),
        "orders[1] is 0; an order is at least 1": lambda: Driveline.from_bends([0.1]).harmonics(
            [1, 0]
        ),
        "TypeError: orders has dtype float64; an order is an integer": lambda: Driveline.from_bends(
            [0.1]
        ).harmonics(2.0),
        "IndexError: shaft is 2; there are 2": lambda: Driveline.from_bends([0.1]).equivalent(2),
        "TypeError: shaft is 0.5": lambda: Driveline.from_bends([0.1]).equivalent(0.5),  # type: ignore[arg-type]
        "phases has shape (3,); 3 joints need (..., 2)": lambda: Driveline.from_bends(
            [0.1] * 3
        ).with_phases([1, 2, 3]),
    }
)


def test_the_largest_angle_error_is_where_it_is_said_to_be() -> None:
    rng = np.random.default_rng(7)
    bends, phases = rng.uniform(0.0, 1.5, (200, 3)), rng.uniform(-4.0, 4.0, (200, 2))
    line = Driveline.from_bends(bends, phases[::-1], phases)
    joint = line.equivalent()
    place = joint.max_angle_error_at
    assert np.all((place >= 0.0) & (place < np.pi))
    for turn in (0.0, np.pi):
        error = line.evaluate(place + turn, "angle_error").angle_error
        assert error == pytest.approx(joint.max_angle_error, rel=1e-9)
    assert np.isnan(Driveline.from_bends([0.0]).equivalent().max_angle_error_at)


def test_help_begins_with_a_line_for_each_method() -> None:
    assert Driveline.__mro__ == (Driveline, object)
    lines = (Driveline.__doc__ or "").splitlines()
    # Four screens of a terminal.
    assert len(lines) <= 4 * 24
    named = {line.split()[0] for line in lines if line.startswith("    ") and "  " in line.strip()}
    assert {name for name in dir(Driveline) if not name.startswith("_")} <= named


def test_batches_have_the_bits_of_single_drivelines() -> None:
    random = np.random.default_rng(9)
    count, n = 150, 4
    bends = random.uniform(0.0, 1.5, (count, n)) * (random.random((count, n)) > 0.4)
    twists, phases = random.uniform(-9.0, 9.0, (2, count, n - 1))
    twists[3, 1], phases[70, 0] = 1e300, -3e13
    lines = Driveline.from_bends(bends, twists, phases)
    for i in range(count):
        one = Driveline.from_bends(bends[i], twists[i], phases[i])
        assert lines[i].directions.tobytes() == one.directions.tobytes()
        assert lines[i].normals.tobytes() == one.normals.tobytes()
        for shaft in range(n + 1):
            batch, single = lines.equivalent(shaft), one.equivalent(shaft)
            for name in ("bend", "angle_offset", "k", "max_acceleration_ratio"):
                assert getattr(batch, name)[i] == getattr(single, name)

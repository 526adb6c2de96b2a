"""The pure-Python reference against 40-digit numbers from an independent vector model.

Tolerances are in units of ``EPS = 2**-52``, per joint, and divided by the power of ``c`` (the
product of the cosines of the bends) that conditioning asks for: the pins turn up to ``1/c`` times
as fast as the drive, so a rounding of the drive angle or of a shaft direction reaches an angle or a
moment ``1/c``-fold, a speed ratio ``1/c**2``-fold, an acceleration ratio ``1/c**3``-fold and a jerk
ratio ``1/c**4``-fold.
"""

from __future__ import annotations

import cmath
import math
from fractions import Fraction
from functools import partial
from itertools import pairwise
from typing import Any

import pytest

from cardan import reference
from cardan.reference import Shafts
from oracle import (
    EPS,
    PI,
    ExactJoint,
    ExactTurn,
    angles,
    cosines,
    distinct,
    dot,
    off,
    off_all,
    off_vectors,
    radians,
    read,
    start_angle,
)

CHAINS = read("chains.json")["cases"]
SINGLE = read("single_kinematics.json")
MOMENTS = read("single_moments.json")["cases"]

chains = pytest.mark.parametrize("case", CHAINS, ids=lambda case: case["name"])


# --- one joint -------------------------------------------------------------------------------


def check_single(shafts: Shafts, angle: float, delta: Fraction, row: dict[str, str]) -> None:
    (bend,) = shafts.bends
    c = math.cos(bend)
    # One joint leads the drive by an odd function of the drive angle, so the mean is zero by
    # symmetry. Where the mean can be computed it is, which checks just that.
    offset = reference.mean_offset(shafts) if c > 2e-4 else 0.0
    got = reference.motion(shafts, angle, offset=offset)
    assert off(got.angle_error, delta) <= 2 * EPS / c
    assert off(got.angle, Fraction(angle) + delta) <= 2 * EPS / c + EPS * abs(angle)
    assert off(got.speed_ratio, row["ratio"]) <= 2 * EPS / c**2
    # Shafts in the x-y plane leave most products exact, so here even bends of 1e-8 keep their
    # accelerations, of order tan(bend)**2.
    assert off(got.acceleration_ratio, row["accel"]) <= 4 * EPS * math.tan(bend) ** 2 / c


@pytest.mark.parametrize("beta", distinct(SINGLE["degrees"], "beta_deg"))
def test_single_joint_in_degrees(beta: str) -> None:
    shafts = reference.from_bends([radians(beta)])
    for row in SINGLE["degrees"]:
        if row["beta_deg"] == beta:
            angle = radians(row["alpha1_deg"])
            check_single(shafts, angle, Fraction(row["delta_deg"]) * PI / 180, row)


@pytest.mark.parametrize("beta", distinct(SINGLE["radians"], "beta"))
def test_single_joint_in_radians(beta: str) -> None:
    shafts = reference.from_bends([float(beta)])
    assert shafts.bends[0] == pytest.approx(float(beta), rel=2 * EPS, abs=0)
    for row in SINGLE["radians"]:
        if row["beta"] == beta:
            check_single(shafts, float(row["alpha1"]), Fraction(row["delta"]), row)


@pytest.mark.parametrize("bend", [1e-6, 0.01, 0.3, 0.7, 1.0, 1.3, 1.5, 1.56])
def test_jerk_of_a_single_joint(bend: float) -> None:
    # The data end with the second derivative: the third against the exact speed ratio's.
    shafts = reference.from_bends([bend])
    joint, c = ExactJoint.bent(bend), math.cos(bend)
    for i in range(200):
        angle = 0.0321 * i - 3.0
        got = reference.motion(shafts, angle, offset=0.0)
        want = joint.jerk_ratio(ExactTurn.by(angle))
        assert abs(float(got.jerk_ratio - want)) <= 8 * EPS * math.tan(bend) ** 2 / c**2


@chains
def test_jerk_of_chains(case: dict[str, Any]) -> None:
    # Against differences of the second derivative, of the sixth order.
    shafts = lay_out(case)
    h, weights = 2e-3, (-1, 9, -45, 0, 45, -9, 1)
    c = cosines(shafts)
    for i in range(40):
        angle = 0.17 * i
        for shaft in range(len(shafts.directions)):
            near = [
                reference.motion(shafts, angle + h * n, shaft, offset=0.0).acceleration_ratio
                for n in range(-3, 4)
            ]
            slope = math.fsum(w * x for w, x in zip(weights, near, strict=True)) / (60 * h)
            got = reference.motion(shafts, angle, shaft, offset=0.0).jerk_ratio
            assert abs(got - slope) <= 1e-9 / c**8


@pytest.mark.parametrize("beta", distinct(MOMENTS, "beta_deg"))
def test_single_joint_moments(beta: str) -> None:
    bend = radians(beta)
    shafts = reference.from_bends([bend])
    # Thoma's right-handed triad (n1, e_in, m) is ours (+x, +y, +z): a vector's components here are
    # its products with these three, written in his axes.
    triad = [
        (-math.sin(bend), -math.cos(bend), 0.0),
        (math.cos(bend), -math.sin(bend), 0.0),
        (0.0, 0.0, 1.0),
    ]
    tolerance = 2 * EPS / math.cos(bend)
    for row in MOMENTS:
        if row["beta_deg"] != beta:
            continue
        phi = radians(row["phi_deg"])

        def ours(thoma: list[str]) -> list[Fraction]:
            v = [Fraction(x) for x in thoma]
            return [
                sum((x * Fraction(y) for x, y in zip(v, axis, strict=True)), Fraction(0))
                for axis in triad
            ]

        static, want = reference.loads(shafts, phi, drive_torque=1.0), row["static"]
        limit = tolerance * math.hypot(*static.moment[0])
        assert off_vectors(static.moment, [ours(want["M_on_shaft2_xyz"])]) <= limit
        assert static.torque[0] == 1.0
        assert off(static.torque[1], want["D2"]) <= limit
        assert off(static.bending_driving[0], want["B1"]) <= limit
        assert off(static.bending_driven[0], want["B2"]) <= limit
        # Each shaft's bearings take the bending that the joint brings into it.
        m, (u, v) = shafts.normals[0], shafts.directions
        for i, (shaft, sign) in enumerate(((u, 1.0), (v, -1.0))):
            in_plane = (-shaft[1], shaft[0], 0.0)  # m x shaft
            support, name = static.support_moment[i], f"bend{i + 1}"
            assert off(sign * dot(support, in_plane), want[f"{name}_inplane"]) <= limit
            assert off(sign * dot(support, m), want[f"{name}_normal"]) <= limit
            assert abs(dot(support, shaft)) <= limit

        wheel, want = reference.loads(shafts, phi, speed=1.0, inertias=[0.0, 1.0]), row["flywheel"]
        # The moment follows the acceleration ratio, whose conditioning it inherits.
        limit = 4 * EPS * math.tan(bend) ** 2 / math.cos(bend) ** 2 + tolerance * math.hypot(
            *wheel.moment[0]
        )
        assert off_vectors(wheel.moment, [ours(want["M_on_shaft2_xyz"])]) <= limit
        assert off_all(wheel.torque, [want["torque_on_shaft1"], want["Mt"]]) <= limit


@pytest.mark.parametrize("degrees", [0, 1, 10, 30, 50, 85])
@pytest.mark.parametrize("angle", [0.0, 0.3, 1.2, 1.7, 2.9, -0.4, -2.0, 5.0])
def test_tilts_of_one_joint(degrees: float, angle: float) -> None:
    bend = math.radians(degrees)
    ((psi_1, psi_2),) = reference.tilts(reference.from_bends([bend]), angle)
    tolerance = 2 * EPS / math.cos(bend)
    assert psi_1 == pytest.approx(math.atan(math.tan(bend) * math.sin(angle)), abs=tolerance)
    assert psi_2 == pytest.approx(math.asin(math.sin(bend) * math.cos(angle)), abs=tolerance)
    assert math.cos(psi_1) * math.cos(psi_2) == pytest.approx(math.cos(bend), abs=2 * EPS)


# --- chains ----------------------------------------------------------------------------------


def lay_out(case: dict[str, Any]) -> Shafts:
    points = [[float(x) for x in point] for point in case["points"]]
    return reference.from_points(points, [float(x) for x in case["yoke_phase"]])


def start_of(case: dict[str, Any], shafts: Shafts) -> float:
    return start_angle(case, shafts.directions[0], shafts.normals[0])


@chains
def test_chain_geometry(case: dict[str, Any]) -> None:
    shafts = lay_out(case)
    assert off_vectors(shafts.directions, case["shaft_dir"]) <= EPS
    for got, want in zip(shafts.bends, case["beta_deg"], strict=True):
        assert off(got, Fraction(want) * PI / 180) <= EPS
    for got, want, bends in zip(
        shafts.twists, case["twist_deg"], pairwise(shafts.bends), strict=True
    ):
        if want is None:
            assert min(bends) == 0.0
            assert abs(got) <= EPS  # a straight joint lies in its neighbour's plane
        else:
            error = math.remainder(float(Fraction(got) - Fraction(want) * PI / 180), 2 * math.pi)
            assert abs(error) <= 4 * EPS
    for normal, (u, v) in zip(shafts.normals, pairwise(shafts.directions), strict=True):
        assert math.hypot(*normal) == pytest.approx(1.0, abs=EPS)
        assert max(abs(dot(normal, u)), abs(dot(normal, v))) <= 2 * EPS


@chains
def test_chain_motion(case: dict[str, Any]) -> None:
    shafts = lay_out(case)
    unit, c = 2 * len(shafts.bends) * EPS, cosines(shafts)
    start = start_of(case, shafts)
    for shaft in range(len(shafts.directions)):
        offset = reference.mean_offset(shafts, shaft)
        at_start = reference.motion(shafts, start, shaft, offset=offset).angle_error
        for angle, step in zip(angles(case, start_of(case, shafts)), case["steps"], strict=True):
            got = reference.motion(shafts, angle, shaft, offset=offset)
            lead = Fraction(step["theta"][shaft]) - Fraction(step["theta0"])
            assert off(got.angle_error - at_start, lead) <= unit / c
            assert off(got.speed_ratio, step["ratio"][shaft]) <= unit / c**2
            assert off(got.acceleration_ratio, step["accel_unit"][shaft]) <= unit / c**3


@pytest.mark.parametrize(
    "case", [case for case in CHAINS if "equivalent" in case], ids=lambda case: case["name"]
)
def test_chain_mean(case: dict[str, Any]) -> None:
    # The equivalent joint of the data fixes what the differences above leave open: the lead with
    # mean zero, arg(1 + (B/A) exp(-2 i alpha)).
    shafts = lay_out(case)
    equivalent = case["equivalent"]
    a, b = (complex(float(x), float(y)) for x, y in (equivalent["A"], equivalent["B"]))
    alpha = math.radians(float(equivalent["alpha_in_at_theta0_deg"]))
    want = cmath.phase(1 + b / a * cmath.exp(-2j * alpha))
    got = reference.motion(shafts, start_of(case, shafts)).angle_error
    assert got == pytest.approx(want, rel=0, abs=2 * len(shafts.bends) * EPS / cosines(shafts))


@chains
@pytest.mark.parametrize("way", ["static_T0_1", "dynamic"])
def test_chain_loads(case: dict[str, Any], way: str) -> None:
    shafts = lay_out(case)
    speed, acceleration = float(case["omega0"]), float(case["eps0"])
    inertias = [float(x) for x in case["inertia"]]
    unit, c = 2 * len(shafts.bends) * EPS, cosines(shafts)
    for angle, step in zip(angles(case, start_of(case, shafts)), case["steps"], strict=True):
        want = step[way]
        largest = max(abs(float(x)) for x in [want["T_in"], *(x for v in want["M"] for x in v)])
        limit = unit / c * largest
        if way == "static_T0_1":
            results = [reference.loads(shafts, angle, drive_torque=1.0)]
        else:
            state = partial(
                reference.loads,
                shafts,
                angle,
                speed=speed,
                acceleration=acceleration,
                inertias=inertias,
            )
            # The same state, once from the load and once from the drive torque it calls for.
            results = [
                state(output_torque=-float(case["T_load"])),
                state(drive_torque=float(want["T_in"])),
            ]
            # What the inertias take has the conditioning of speed and acceleration ratios.
            limit += unit * sum(inertias) * (speed**2 / c**3 + abs(acceleration) / c**2)
        for got in results:
            assert off_vectors(got.moment, want["M"]) <= limit
            assert off_vectors(got.support_moment, want["support_moment"]) <= limit
            assert off_all(got.torque, [want["T_in"], *want["torsion_in"]]) <= limit
            assert off_all(got.bending_driving, want["bend_on_driver"]) <= limit
            assert off_all(got.bending_driven, want["bend_on_driven"]) <= limit
            sizes = [math.hypot(*map(float, moment)) for moment in want["M"]]
            assert got.pin_moment == pytest.approx(sizes, rel=0.0, abs=limit)


@chains
def test_chain_tilts(case: dict[str, Any]) -> None:
    # The moment points along the normal of the cross, so its bending parts give the tilts' sizes.
    shafts = lay_out(case)
    tolerance = 2 * len(shafts.bends) * EPS / cosines(shafts)
    for angle, step in zip(angles(case, start_of(case, shafts)), case["steps"], strict=True):
        want = step["static_T0_1"]
        for j, (psi_1, psi_2) in enumerate(reference.tilts(shafts, angle)):
            size = math.hypot(*map(float, want["M"][j]))
            assert off(size * math.sin(abs(psi_1)), want["bend_on_driver"][j]) <= tolerance * size
            assert off(size * math.sin(abs(psi_2)), want["bend_on_driven"][j]) <= tolerance * size


@chains
def test_chain_crosses(case: dict[str, Any]) -> None:
    # The swings are the slopes of the tilts, and the moment is normal to both pins.
    shafts, step = lay_out(case), 1e-4
    scale = cosines(shafts)
    for angle, at in zip(angles(case, start_of(case, shafts)), case["steps"], strict=True):
        moments = at["static_T0_1"]["M"]
        crosses = reference.crosses(shafts, angle)
        ends = [reference.tilts(shafts, angle + by) for by in (-step, step)]
        for cross, moment, *tilts in zip(crosses, moments, *ends, strict=True):
            slopes = [(after - before) / (2.0 * step) for before, after in zip(*tilts, strict=True)]
            swings = [cross.swing_driving, cross.swing_driven]
            assert swings == pytest.approx(slopes, rel=0.0, abs=step**2 / scale**4)
            normal = [float(x) for x in moment]
            for pin in (cross.driving_pin, cross.driven_pin):
                assert math.hypot(*pin) == pytest.approx(1.0, abs=4 * EPS)
                along = math.fsum(x * y for x, y in zip(normal, pin, strict=True))
                assert abs(along) <= 16 * EPS * math.hypot(*normal) / scale


@pytest.mark.parametrize("angle", [0.0, 0.7, 2.0, 4.0, -1.0])
def test_joint_behind_a_straight_one(angle: float) -> None:
    # The straight joint hands on its angle a quarter turn ahead; then the yokes add the phase and
    # the bend plane recedes by the twist.
    bend, twist, phase = 0.6, 0.4, 0.25
    shafts = reference.from_bends([0.0, bend], [twist], [phase])
    own = angle + math.pi / 2 + phase - twist
    alone = reference.from_bends([bend])
    got, want = reference.motion(shafts, angle), reference.motion(alone, own)
    assert got.angle_error == pytest.approx(want.angle_error, abs=8 * EPS)
    assert got.speed_ratio == pytest.approx(want.speed_ratio, abs=8 * EPS)
    assert got.acceleration_ratio == pytest.approx(want.acceleration_ratio, abs=8 * EPS)
    (tilt,) = reference.tilts(alone, own)
    assert reference.tilts(shafts, angle)[0] == pytest.approx((0.0, 0.0), abs=2 * EPS)
    assert reference.tilts(shafts, angle)[1] == pytest.approx(tilt, abs=8 * EPS)


@pytest.mark.parametrize("shaft", [1, 2, 3])
def test_mean_is_zero_on_another_grid(shaft: int) -> None:
    # 85 degrees and yokes out of line: a coarse or lopsided mean would show.
    shafts = reference.from_bends([math.radians(85), 0.5, 0.7], [0.4, -2.0], [0.7, 1.9])
    offset = reference.mean_offset(shafts, shaft)
    count = 1009
    leads = [
        reference.motion(shafts, 0.1 + 2 * math.pi * i / count, shaft, offset=offset).angle_error
        for i in range(count)
    ]
    assert max(leads) > 0.9
    assert abs(math.fsum(leads) / count) <= 2 * EPS
    assert reference.motion(shafts, 0.3, shaft).angle_error == pytest.approx(
        reference.motion(shafts, 0.3, shaft, offset=offset).angle_error, abs=0
    )


@pytest.mark.parametrize("shaft", [1, 2, 3, 4])
def test_angle_is_continuous(shaft: int) -> None:
    shafts = reference.from_bends([1.0] * 4, [0.3, 2.5, -1.3], [2.0, -0.8, 3.0])
    count = 2000
    step = 2 * math.pi / count
    points = [
        reference.motion(shafts, i * step, shaft, offset=0.0) for i in range(-count, count + 1)
    ]
    assert points[-1].angle - points[0].angle == pytest.approx(4 * math.pi, abs=32 * EPS)
    for before, after in pairwise(points):
        # Between its speeds at the two ends, but for the curvature (at most 1/c**3 = 40 times 8).
        rise = (after.angle - before.angle) / step
        low, high = sorted((before.speed_ratio, after.speed_ratio))
        assert low - 1e-2 <= rise <= high + 1e-2


# --- layout and refusals ---------------------------------------------------------------------


def test_frame_of_from_bends() -> None:
    shafts = reference.from_bends([0.3, 0.4, 0.5], [0.7, -2.5], [0.1, 0.2])
    assert shafts.directions[0] == (1.0, 0.0, 0.0)
    assert shafts.directions[1] == pytest.approx((math.cos(0.3), math.sin(0.3), 0.0), abs=EPS)
    assert shafts.normals[0] == (0.0, 0.0, 1.0)
    assert shafts.bends == pytest.approx((0.3, 0.4, 0.5), abs=2 * EPS)
    assert shafts.twists == pytest.approx((0.7, -2.5), abs=2 * EPS)
    assert shafts.phases == (0.1, 0.2)
    # The normal +z, turned by +90 degrees about +x, is -y, and about that +x bends towards +z.
    up = reference.from_bends([0.0, 0.4], [math.pi / 2])
    assert up.normals[1] == pytest.approx((0.0, -1.0, 0.0), abs=EPS)
    assert up.directions[2] == pytest.approx((math.cos(0.4), 0.0, math.sin(0.4)), abs=EPS)


def test_from_bends_does_not_drift() -> None:
    shafts = reference.from_bends([0.7] * 1000, [0.3] * 999)
    for vector in (*shafts.directions, *shafts.normals):
        assert math.hypot(*vector) == pytest.approx(1.0, abs=EPS)
    for normal, (u, v) in zip(shafts.normals, pairwise(shafts.directions), strict=True):
        assert max(abs(dot(normal, u)), abs(dot(normal, v))) <= 2 * EPS


def test_layouts_agree() -> None:
    shafts = reference.from_bends([0.3, 0.4, 0.5], [0.7, -2.5], [0.1, 0.2])
    scaled = [[3.0 * x for x in u] for u in shafts.directions]
    points = [[0.0, 0.0, 0.0]]
    for u in shafts.directions:
        points.append([p + 2.0 * x for p, x in zip(points[-1], u, strict=True)])
    for other in (
        reference.from_directions(scaled, shafts.phases),
        reference.from_points(points, shafts.phases),
    ):
        assert other.bends == pytest.approx(shafts.bends, abs=4 * EPS)
        assert other.twists == pytest.approx(shafts.twists, abs=16 * EPS)
        assert other.phases == shafts.phases


def test_twists_of_straight_joints_are_kept() -> None:
    shafts = reference.from_bends([0.0, 0.0, 0.3], [0.5, 0.25])
    assert shafts.twists == pytest.approx((0.5, 0.25), abs=2 * EPS)


X, Y, Z = [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]


@pytest.mark.parametrize(
    ("directions", "normals"),
    [
        ([X, X], [Z]),
        ([Z, Z, Z], [X, X]),
        ([[1.0, 0.0, 1.0], [2.0, 0.0, 2.0]], [[-(0.5**0.5), 0.0, 0.5**0.5]]),
        ([X, X, X, [1.0, 0.0, 1.0]], [[0.0, -1.0, 0.0]] * 3),
        ([X, [1.0, 1.0, 0.0], [2.0, 2.0, 0.0], [1.0, 0.0, 0.0]], [Z, Z, [0.0, 0.0, -1.0]]),
    ],
    ids=["along x", "along z", "oblique", "next bent", "previous"],
)
def test_normals_of_straight_joints(
    directions: list[list[float]], normals: list[list[float]]
) -> None:
    got = reference.from_directions(directions).normals
    for normal, want in zip(got, normals, strict=True):
        assert normal == pytest.approx(tuple(want), abs=2 * EPS)


def test_carried_normal_stays_across_a_shaft_that_differs_by_rounding() -> None:
    # Each shaft leaves the plane of the first two by an angle that still counts as straight.
    drift = [[1.0, 0.0, 8e-16 * i] for i in range(5)]
    shafts = reference.from_directions([[1.0, 1.0, 0.0], *drift])
    for normal, direction in zip(shafts.normals, shafts.directions, strict=False):
        assert normal[2] == pytest.approx(-1.0, abs=EPS)
        assert abs(dot(normal, direction)) <= EPS


def test_drive_shaft_turns_with_the_drive() -> None:
    shafts = reference.from_bends([0.8])
    assert reference.motion(shafts, 7.5, 0) == reference.ShaftMotion(7.5, 0.0, 1.0, 0.0, 0.0)
    assert reference.motion(shafts, 7.5, -2) == reference.motion(shafts, 7.5, 0)
    assert reference.motion(shafts, 7.5) == reference.motion(shafts, 7.5, 1)


@pytest.mark.parametrize("angle", [math.nan, math.inf, -math.inf])
def test_angles_that_are_not_finite_give_nan(angle: float) -> None:
    shafts = reference.from_bends([0.3, 0.2])
    got = reference.motion(shafts, angle)
    assert math.isnan(got.angle)
    assert math.isnan(got.speed_ratio)
    assert all(math.isnan(psi) for pair in reference.tilts(shafts, angle) for psi in pair)
    assert math.isnan(reference.loads(shafts, angle, drive_torque=1.0).torque[2])


def test_refusals() -> None:
    line = reference.from_bends([0.3, 0.2])
    with pytest.raises(ValueError, match=r"bends\[1\] is 1\.6 rad"):
        reference.from_bends([0.3, 1.6])
    with pytest.raises(ValueError, match=r"bends\[0\] is nan rad"):
        reference.from_bends([math.nan])
    with pytest.raises(ValueError, match="at least one joint"):
        reference.from_bends([])
    with pytest.raises(ValueError, match="twists has 2 values; 2 joints need 1"):
        reference.from_bends([0.3, 0.2], [0.0, 0.0])
    with pytest.raises(ValueError, match="phases has 0 values; 2 joints need 1"):
        reference.from_bends([0.3, 0.2], phases=[])
    with pytest.raises(ValueError, match="at least one joint"):
        reference.from_points([X, Y])
    with pytest.raises(ValueError, match=r"directions\[1\] is"):
        reference.from_points([X, Y, Y])
    with pytest.raises(ValueError, match=r"directions\[0\] is"):
        reference.from_directions([[1.0, 0.0], X])
    with pytest.raises(ValueError, match=r"joint 0 is bent by 1\.57"):
        reference.from_directions([X, Y])
    with pytest.raises(ValueError, match="exclude one another"):
        reference.loads(line, 0.0, drive_torque=1.0, output_torque=0.0)
    with pytest.raises(ValueError, match="inertias has 2 values; there are 3 shafts"):
        reference.loads(line, 0.0, inertias=[1.0, 1.0])
    with pytest.raises(ValueError, match="at least 2e-4"):
        reference.mean_offset(reference.from_bends([math.radians(89.99)]))
    with pytest.raises(IndexError, match="shaft is 3"):
        reference.motion(line, 0.0, 3)

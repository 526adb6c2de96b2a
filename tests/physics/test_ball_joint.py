"""The ball joint: Marcus's equations by number, integrals over the surface, exact numbers, errors.

M. Marcus, "Beitrag zur Berechnung eines Kugelgelenks", Schweizerische Bauzeitung 39/40 (1902).
``pytest -s`` prints the largest errors in ulp.
"""

from __future__ import annotations

import copy
import math
import pickle
from collections.abc import Callable, Sequence
from dataclasses import FrozenInstanceError
from typing import Any

import numpy as np
import pytest

from cardan import ball_joint
from cardan.ball_joint import BallJoint, layer_compliance
from oracle import EPS, LIMIT_TABLE, Doubles, Exact, MpNumber, mp, radians, read
from refusals import refusals

DATA = read("ball_joint.json")
RIGHT = math.pi / 2


def loose_at(angle: float, radius: float = 1.0) -> tuple[BallJoint, float]:
    """Return a hemisphere with clearance, and the load that makes it touch up to an angle."""
    clearance, compliance = 1e-4 * radius, 2e-12
    c, versine = math.cos(angle), 2 * math.sin(angle / 2) ** 2
    peak = clearance * versine / c / compliance
    load = peak * math.pi * radius**2 * versine * (2 + c) / 3
    return BallJoint(radius).with_clearance(clearance, compliance=compliance), load


# --- Marcus by equation ----------------------------------------------------------------------

RADIUS, LOAD, ALPHA_1, ALPHA_2 = 0.06, 2.5e5, 3e-12, 4e-12
THETA = np.linspace(-RIGHT, RIGHT, 181)
JOINT = BallJoint(RADIUS)


def test_marcus_1_and_2_compression() -> None:
    # (1): each side gives way by its own coefficient; (2): together by the approach's part along
    # the normal.
    n = JOINT.pressure(THETA, LOAD)
    approach = JOINT.approach(LOAD, ALPHA_1 + ALPHA_2)
    want = approach * np.cos(THETA)
    assert ALPHA_1 * n + ALPHA_2 * n == pytest.approx(want, rel=4 * EPS, abs=1e-20)


def test_marcus_3_pressure_from_the_approach() -> None:
    approach = JOINT.approach(LOAD, ALPHA_1 + ALPHA_2)
    want = approach / (ALPHA_1 + ALPHA_2) * np.cos(THETA)
    assert JOINT.pressure(THETA, LOAD) == pytest.approx(want, rel=4 * EPS)


def test_marcus_4_to_7_the_load_is_the_vertical_part_of_the_pressure() -> None:
    # (4) element of surface, (5) force on it, (6) its vertical part, (7) the sum; the d psi that
    # the print of (7) lost is the factor 2 pi.
    nodes, weights = np.polynomial.legendre.leggauss(20)
    theta, d_theta = RIGHT / 2 * (nodes + 1), RIGHT / 2 * weights
    d_f = RADIUS**2 * np.sin(theta) * d_theta * 2 * math.pi
    d_v = JOINT.pressure(theta, LOAD) * d_f * np.cos(theta)
    assert d_v.sum() == pytest.approx(LOAD, rel=1e-14)


def test_marcus_8_approach() -> None:
    approach = JOINT.approach(LOAD, ALPHA_1 + ALPHA_2)
    load = 2 * math.pi * RADIUS**2 * approach / (3 * (ALPHA_1 + ALPHA_2))
    assert load == pytest.approx(LOAD, rel=4 * EPS)


def test_marcus_9_pressure_from_the_load() -> None:
    want = 3 * LOAD / (2 * math.pi * RADIUS**2) * np.cos(THETA)
    assert JOINT.pressure(THETA, LOAD) == pytest.approx(want, rel=4 * EPS)


def test_marcus_10_peak() -> None:
    peak = JOINT.peak_pressure(LOAD)
    assert peak == pytest.approx(3 * LOAD / (2 * math.pi * RADIUS**2), rel=4 * EPS)
    assert peak == JOINT.pressure(0.0, LOAD)
    # His "three times" is the load over the whole surface; a pressure that is the same everywhere
    # would carry it as the load over the projection.
    assert peak == pytest.approx(3 * LOAD / (2 * math.pi * RADIUS**2), rel=4 * EPS)
    assert peak == pytest.approx(1.5 * LOAD / (math.pi * RADIUS**2), rel=4 * EPS)


@pytest.mark.parametrize("row", DATA["marcus"], ids=lambda row: f"{row['D']}, {row['K']}")
def test_marcus_11_radius(row: dict[str, str]) -> None:
    sized = BallJoint.sized_for(float(row["D"]), float(row["K"]))
    assert sized.radius == pytest.approx(float(row["r"]), rel=2 * EPS)
    assert sized.peak_pressure(float(row["D"])) == pytest.approx(float(row["K"]), rel=4 * EPS)


@pytest.mark.parametrize("half_angle", [0.3, 1.0, RIGHT])
@pytest.mark.parametrize("clearance", [0.0, 1e-6, 2e-5, 1e-3])
def test_a_joint_that_is_sized_with_clearance_reaches_the_allowable_pressure(
    half_angle: float, clearance: float
) -> None:
    """The size comes from the approach in closed form, the pressure from the load by iteration."""
    joint = BallJoint.sized_for(
        LOAD, 60e6, half_angle, clearance=clearance, compliance=ALPHA_1 + ALPHA_2
    )
    assert joint.peak_pressure(LOAD) == pytest.approx(60e6, rel=1e-13)
    assert joint.allowable_load(60e6) == pytest.approx(LOAD, rel=1e-13)
    assert joint.clearance == clearance
    if clearance == 0.0:
        assert joint.radius == pytest.approx(
            BallJoint.sized_for(LOAD, 60e6, half_angle).radius, rel=1e-14
        )
        fit = BallJoint(joint.radius, half_angle)
        assert fit.allowable_load([60e6, 120e6]) == pytest.approx([LOAD, 2 * LOAD], rel=1e-13)


@pytest.mark.parametrize("poisson", [0.0, 0.3, 0.45])
def test_a_layer_yields_as_hookes_law_without_lateral_strain(poisson: float) -> None:
    """Three strains from three stresses; the lateral strains of a bonded layer are zero."""
    modulus, thickness = 2.1e9, 0.8e-3
    strain_of = (np.eye(3) * (1.0 + poisson) - poisson * np.ones((3, 3))) / modulus
    pressure = np.linalg.solve(strain_of, [0.0, 0.0, 1.0])[2]
    found = layer_compliance(thickness, modulus, poisson)
    assert found == pytest.approx(thickness / pressure, rel=1e-13)


# --- data ------------------------------------------------------------------------------------


@pytest.mark.parametrize("row", DATA["fit"], ids=lambda row: row["theta0_deg"])
def test_cut_seats(row: dict[str, str]) -> None:
    angle = radians(row["theta0_deg"])
    seat = BallJoint(1.0, angle)
    peak = float(row["peak_factor"])
    assert seat.contact_angle(1.0) == angle
    assert seat.peak_pressure(1.0) == pytest.approx(peak, rel=5 * EPS)
    over_mean = seat.peak_pressure(1.0) * math.pi * math.sin(angle) ** 2
    assert over_mean == pytest.approx(float(row["over_projected_mean"]), rel=6 * EPS)
    assert seat.friction_moment(1.0, 1.0) == pytest.approx(float(row["pivot"]), rel=4 * EPS)
    sized = BallJoint.sized_for(50.0, 2.0, angle)
    assert sized.radius == pytest.approx(5.0 * float(row["r_factor"]), rel=4 * EPS)
    assert sized.half_angle == angle


@pytest.mark.parametrize("row", DATA["clearance"], ids=lambda row: row["theta0_deg"])
def test_contacts_ended_by_a_clearance(row: dict[str, str]) -> None:
    angle, peak = radians(row["theta0_deg"]), float(row["peak_factor"])
    if angle == RIGHT:  # only a perfect fit touches so far
        joint, load = BallJoint(1.0).with_clearance(0.0, compliance=2e-12), 1.0
    else:
        joint, _ = loose_at(angle)
        versine = 2 * math.sin(angle / 2) ** 2
        load = joint.clearance * versine / math.cos(angle) / joint.compliance / peak
    assert joint.contact_angle(load) == pytest.approx(angle, rel=6 * EPS)
    assert joint.peak_pressure(load) / load == pytest.approx(peak, rel=12 * EPS)
    assert joint.friction_moment(load, 0.1) == pytest.approx(
        0.1 * load * float(row["pivot"]), rel=16 * EPS
    )
    over_mean = joint.peak_pressure(load) / load * math.pi * math.sin(angle) ** 2
    assert over_mean == pytest.approx(float(row["over_projected_mean"]), rel=16 * EPS)


# --- integrals over the surface --------------------------------------------------------------

AXIS = np.array([0.48, -0.6, 0.64])
FORCE = 7e4 * AXIS
EDGE = 1.2

# Every law there is: a fit, a cut seat, a contact ending freely, one ending where the seat does.
JOINTS = {
    "fit": BallJoint(0.3),
    "cut": BallJoint(0.3, 0.8),
    "tiny cut": BallJoint(0.3, 1e-4),
    "loose": BallJoint(0.3).with_clearance(1e-4, compliance=1e-10),
    "tight": BallJoint(0.3).with_clearance(1e-9, compliance=1e-10),
    "just touching": BallJoint(0.3).with_clearance(1e-3, compliance=1e-16),
    "loose, cut": BallJoint(0.3, 0.5).with_clearance(1e-4, compliance=1e-10),
    "loose, not yet at the edge": BallJoint(0.3, EDGE).with_clearance(1e-4, compliance=1e-10),
}
joints = pytest.mark.parametrize("joint", JOINTS.values(), ids=JOINTS)


def across(axis: Doubles) -> tuple[Doubles, Doubles]:
    first = np.cross(axis, [0.0, 0.0, 1.0])
    first /= np.linalg.norm(first)
    return first, np.cross(axis, first)


def surface(half_angle: float, n: int = 60) -> tuple[Doubles, Doubles]:
    """Points of the unit ball about AXIS up to an angle, and their weights."""
    nodes, weights = np.polynomial.legendre.leggauss(n)
    theta = half_angle / 2 * (nodes + 1)[:, None]
    psi = np.arange(2 * n) * math.pi / n
    first, second = across(AXIS)
    circle = np.cos(psi)[:, None] * first + np.sin(psi)[:, None] * second
    points = np.cos(theta)[..., None] * AXIS + np.sin(theta)[..., None] * circle
    area = half_angle / 2 * weights[:, None] * np.sin(theta) * (math.pi / n)
    return points.reshape(-1, 3), np.broadcast_to(area, (n, 2 * n)).reshape(-1)


@joints
def test_the_pressure_adds_up_to_the_load(joint: BallJoint) -> None:
    load = float(np.linalg.norm(FORCE))
    points, area = surface(joint.contact_angle(load))
    pressure = joint.pressure_at(2.5 * points, FORCE)
    resultant = ((pressure * area)[:, None] * points).sum(axis=0) * joint.radius**2
    # A small contact is limited by the rounding of the points, 1e-16 of a radius.
    relative = 1e-13 + 1e-16 / float(joint.contact_angle(load))
    assert resultant == pytest.approx(FORCE, rel=relative, abs=relative * load)


@joints
def test_nothing_presses_outside_the_contact(joint: BallJoint) -> None:
    load = float(np.linalg.norm(FORCE))
    edge = float(joint.contact_angle(load))
    inside, outside = edge * (1 - 1e-9), edge * (1 + 1e-9)
    assert joint.pressure(inside, load) > 0
    assert joint.pressure([outside, -outside, 2.0, math.pi, -3.0, 100.0], load).tolist() == [0] * 6
    first, _ = across(AXIS)
    ring = np.array([math.cos(t) * AXIS + math.sin(t) * first for t in (edge / 2, edge + 1e-9)])
    got = joint.pressure_at(np.concatenate([ring, -ring, [first]]), FORCE)
    assert got[0] > 0
    if edge < RIGHT - 0.1:
        assert got[1:].tolist() == [0.0] * 4
    else:
        assert np.max(got[1:]) <= 1e-8 * got[0]


@joints
def test_pressure_over_angles_and_over_directions_agree(joint: BallJoint) -> None:
    load = float(np.linalg.norm(FORCE))
    edge = float(joint.contact_angle(load))
    theta = np.linspace(0, edge, 12)[:-1]
    first, _ = across(AXIS)
    points = np.cos(theta)[:, None] * AXIS + np.sin(theta)[:, None] * first
    want = joint.pressure(theta, load)
    slack = 4e-15 + 1e-15 / edge
    assert joint.pressure_at(1e-3 * points, FORCE) == pytest.approx(
        want, abs=slack * joint.peak_pressure(load)
    )


def test_a_fit_presses_as_the_cosine_between_load_and_normal() -> None:
    rng = np.random.default_rng(1)
    normals = rng.normal(size=(400, 3))
    forces = rng.normal(size=(400, 3)) * 1e5
    lengths = np.linalg.norm(forces, axis=1)
    cosine = (normals * forces).sum(axis=1) / np.linalg.norm(normals, axis=1) / lengths
    peak = 3 * lengths / (2 * math.pi * RADIUS**2)
    got = JOINT.pressure_at(normals, forces)
    assert np.max(np.abs(got / peak - np.maximum(0, cosine))) <= 1e-15
    cut = BallJoint(RADIUS, 0.7)
    inside = cosine >= math.cos(0.7)
    assert inside.any()
    got = cut.pressure_at(normals, forces) / cut.peak_pressure(lengths)
    assert np.max(np.abs(got - np.where(inside, cosine, 0))) <= 1e-15


def moment(joint: BallJoint, axis: Doubles, n: int) -> float:
    """Friction moment about an axis, from velocities and forces as vectors."""
    points, area = surface(joint.contact_angle(np.linalg.norm(FORCE)), n)
    force = joint.pressure_at(points, FORCE) * area * joint.radius**2
    velocity = np.cross(axis, points)
    speed = np.linalg.norm(velocity, axis=1)
    friction = force[:, None] * velocity / speed[:, None]
    return float((np.cross(joint.radius * points, friction) @ axis).sum())


@joints
def test_friction_about_the_load(joint: BallJoint) -> None:
    got = joint.friction_moment(np.linalg.norm(FORCE), 0.12)
    edge = float(joint.contact_angle(np.linalg.norm(FORCE)))
    relative = 1e-13 + 1e-15 / edge
    assert got == pytest.approx(0.12 * moment(joint, AXIS, 60), rel=relative)


@joints
def test_friction_against_tilting(joint: BallJoint) -> None:
    first, second = across(AXIS)
    got = joint.tilting_friction_moment(np.linalg.norm(FORCE), 0.12)
    # Where the contact reaches the axis of the swivel the arm has a cusp.
    edge = float(joint.contact_angle(np.linalg.norm(FORCE)))
    relative = 1e-6 if edge > 1.4 else 1e-12 + 1e-15 / edge
    for axis in (first, math.cos(0.4) * first + math.sin(0.4) * second):
        assert got == pytest.approx(0.12 * moment(joint, axis, 120), rel=relative)


def test_friction_of_a_hemisphere() -> None:
    whole = 0.1 * LOAD * RADIUS
    assert JOINT.friction_moment(LOAD, 0.1) == pytest.approx(whole, rel=4 * EPS)
    tilting = 4 / math.pi * whole
    assert JOINT.tilting_friction_moment(LOAD, 0.1) == pytest.approx(tilting, rel=8 * EPS)


def test_friction_of_a_small_contact() -> None:
    # A flat disc, pressed alike everywhere or as 1 - x²: arms of 2/3 or 8/15 of its edge.
    for joint, arm in (
        (BallJoint(1.0, 1e-9), 2 / 3),
        (BallJoint(1.0, 1e-9).with_clearance(0.0, compliance=1e-12), 2 / 3),
        (BallJoint(1.0).with_clearance(1e-3, compliance=1e-24), 8 / 15),
    ):
        edge = float(joint.contact_angle(1.0))
        assert edge < 1e-5
        assert joint.friction_moment(1.0, 1.0) == pytest.approx(arm * edge, rel=1e-10)
        assert joint.tilting_friction_moment(1.0, 1.0) == pytest.approx(1.0, rel=1e-10)


# --- accuracy --------------------------------------------------------------------------------

LIMITS = LIMIT_TABLE["ball_joint"]


def judge(law: str, name: str, got: Doubles, want: Sequence[MpNumber], at: Sequence[Any]) -> None:
    ulps = Exact.of(want).ulps(np.asarray(got))
    worst = int(ulps.argmax())
    report = f"{law}: {name} is {ulps[worst]:.2f} ulp off at {at[worst]}"
    print(report)
    assert ulps[worst] <= LIMITS[law][name], report


def half_angles() -> Doubles:
    """From 1e-8 to pi/2, close to both ends too."""
    spread = 10 ** np.linspace(-8, math.log10(RIGHT), 150)
    steep = RIGHT - 10 ** np.linspace(-15.5, -0.5, 50)
    plain = np.radians([1, 5, 10, 15, 20, 30, 40, 45, 50, 60, 70, 75, 80, 85, 90])
    every: Doubles = np.minimum(np.concatenate([spread, steep, plain]), RIGHT)
    return every


def test_accuracy_of_cut_seats() -> None:
    angle = half_angles()
    seats = BallJoint(1.0, angle)
    exact: dict[str, list[MpNumber]] = {name: [] for name in LIMITS["cut"]}
    with mp.workdps(60):
        for theta in map(mp.mpf, angle.tolist()):
            c, s = mp.cos(theta), mp.sin(theta)
            exact["peak"].append(3 / (2 * mp.pi * (1 - c**3)))
            exact["radius"].append(mp.sqrt(exact["peak"][-1]))
            exact["friction"].append(s**3 / (1 - c**3))
            # The textbook form of the integral of k E(k).
            elliptic = (1 + s**2) * mp.ellipe(s**2) - c**2 * mp.ellipk(s**2)
            exact["tilting"].append(2 / mp.pi * elliptic / (1 - c**3))
    got = {
        "peak": seats.peak_pressure(1.0),
        "radius": BallJoint.sized_for(1.0, 1.0, angle).radius,
        "friction": seats.friction_moment(1.0, 1.0),
        "tilting": seats.tilting_friction_moment(1.0, 1.0),
    }
    for name, want in exact.items():
        judge("cut", name, got[name], want, angle.tolist())


def exact_approach(case: Sequence[float]) -> MpNumber:
    """Return the approach that balances the load, by secants from what the library found."""
    radius, seat, clearance, compliance, load = map(mp.mpf, case)

    def excess(approach: MpNumber) -> MpNumber:
        # The integral of ((approach + clearance) cos - clearance)/compliance over the contact.
        c = max(mp.cos(seat), clearance / (approach + clearance))
        rest = (approach + clearance) * (1 - c**3) / 3 - clearance * (1 - c**2) / 2
        return 2 * mp.pi * radius**2 * rest / compliance / load - 1

    joint = BallJoint(case[0], case[1]).with_clearance(case[2], compliance=case[3])
    start = mp.mpf(float(joint.approach(case[4])))
    found = mp.findroot(excess, (start * (1 - mp.mpf(1e-12)), start * (1 + mp.mpf(1e-12))))
    assert abs(excess(found)) < mp.mpf(10) ** -40
    return found


def loose_cases(kind: str) -> Doubles:
    """Rows of radius, half-angle, clearance, compliance and load, by the ``q`` of the source."""
    n = 150
    ones = np.ones(n)
    if kind == "all loads":  # q from 1e-300 to 1e300: a point of contact, and all of the seat
        q = 10 ** np.concatenate([np.linspace(-300, 300, n - 50), np.linspace(-5, 20, 50)])
        return np.stack([ones, RIGHT * ones, ones, ones, q * (math.pi / 3)], axis=1)
    rng = np.random.default_rng(2)
    radius, clearance = 10 ** rng.uniform(-3, 1, n), 10 ** rng.uniform(-8, -3, n)
    compliance, q = 10 ** rng.uniform(-14, -9, n), 10 ** rng.uniform(-20, 5, n)
    seat = 10 ** rng.uniform(-6, math.log10(RIGHT), n) if kind == "cut" else RIGHT * ones
    load = q * (math.pi / 3) * radius**2 * clearance / compliance
    return np.stack([radius, seat, clearance, compliance, load], axis=1)


@pytest.mark.parametrize("kind", ["all loads", "hemisphere", "cut"])
def test_accuracy_of_contacts_with_clearance(kind: str) -> None:
    cases = loose_cases(kind)
    radius, seat, clearance, compliance, load = cases.T
    joint = BallJoint(radius, seat).with_clearance(clearance, compliance=compliance)
    want: dict[str, list[MpNumber]] = {"approach": [], "peak": [], "angle": []}
    with mp.workdps(700):  # 1 - c is 1e-150, and squared
        for case in cases.tolist():
            approach = exact_approach(case)
            free = mp.acos(case[2] / (approach + case[2]))
            want["approach"].append(approach)
            want["peak"].append(approach / mp.mpf(case[3]))
            want["angle"].append(min(free, mp.mpf(case[1])))
        got = {
            "approach": joint.approach(load),
            "peak": joint.peak_pressure(load),
            "angle": joint.contact_angle(load),
        }
        for name, values in want.items():
            judge("loose", name, got[name], values, cases.tolist())


@pytest.mark.long
@pytest.mark.parametrize(
    ("name", "arm"),
    [
        ("friction", lambda theta: mp.sin(theta)),
        ("tilting", lambda theta: 2 / mp.pi * mp.ellipe(mp.sin(theta) ** 2)),
    ],
)
def test_accuracy_of_friction_with_clearance(
    name: str, arm: Callable[[MpNumber], MpNumber]
) -> None:
    found, want, at = [], [], []
    for free in (1e-70, 1e-8, 1e-3, 0.1, 0.5, 1.0, 1.3, 1.5, 1.55, 1.57, 1.5707):
        for part in (1.0, 0.999, 0.5, 1e-3):
            seat = free * part if part < 1 else RIGHT
            # The load that would make the contact end at `free` if the seat did not end before.
            with mp.workdps(200):
                c, cut = mp.cos(mp.mpf(free)), mp.mpf(free * part)
                end = mp.cos(cut)
                approach = (1 - c) / c
                rest = (1 + approach) * (1 - end**3) / 3 - (1 - end**2) / 2
                load = float(2 * mp.pi * rest)
            with mp.workdps(30):

                def weight(x: MpNumber, edge: MpNumber = cut, tip: float = free) -> MpNumber:
                    theta = edge * x
                    fall = mp.sin((tip + theta) / 2) * mp.sin((tip - theta) / 2)
                    return fall / mp.sin(mp.mpf(tip) / 2) ** 2 * mp.sin(theta) / edge

                def turn(
                    x: MpNumber, edge: MpNumber = cut, f: Callable[..., MpNumber] = weight
                ) -> MpNumber:
                    return f(x) * arm(edge * x) / (edge if name == "friction" else 1)

                top = mp.quad(turn, [0, 0.5, 1])
                under = mp.quad(lambda x, f=weight, edge=cut: f(x) * mp.cos(edge * x), [0, 0.5, 1])
                want.append(top / under * (cut if name == "friction" else 1) * mp.mpf(load))
            joint = BallJoint(1.0, seat).with_clearance(1.0, compliance=1.0)
            method = joint.friction_moment if name == "friction" else joint.tilting_friction_moment
            found.append(float(method(load, 1.0)))
            at.append((free, part))
    judge("loose", name, np.array(found), want, at)


# --- limits ----------------------------------------------------------------------------------


def test_no_clearance_is_a_fit() -> None:
    load = np.array([0.0, 1.0, 1e9])
    theta = np.linspace(-2, 2, 81)[:, None]
    for angle in (RIGHT, 1.0, 1e-5):
        fit = BallJoint(0.2, angle)
        tight = fit.with_clearance(0.0, compliance=3e-12)
        assert tight.contact_angle(load).tolist() == [angle] * 3
        assert tight.peak_pressure(load) == pytest.approx(fit.peak_pressure(load), rel=4 * EPS)
        assert tight.approach(load) == pytest.approx(fit.approach(load, 3e-12), rel=4 * EPS)
        top = fit.peak_pressure(1e9)
        assert tight.pressure(theta, load) == pytest.approx(
            fit.pressure(theta, load), abs=4 * EPS * top
        )
        for name in ("friction_moment", "tilting_friction_moment"):
            want = getattr(fit, name)(load, 0.1)
            assert getattr(tight, name)(load, 0.1) == pytest.approx(want, rel=16 * EPS)


def test_a_clearance_beyond_measure_is_a_fit() -> None:
    tight = BallJoint(0.2, 1.0).with_clearance(1e-310, compliance=3e-12)
    assert tight.contact_angle(1e9) == 1.0


def test_no_load_presses_nowhere() -> None:
    # Memory of every size that a result could take holds other numbers before.
    for size in range(1, 40):
        used = [np.full(size, 7.0) for _ in range(40)]
        none = np.zeros(size)
        del used
        for joint in (BallJoint(0.2), BallJoint(0.2).with_clearance(1e-4, compliance=3e-12)):
            assert not joint.peak_pressure(none).any()


def test_the_contact_grows_with_the_load_up_to_the_seat() -> None:
    joint = BallJoint(0.2, 0.9).with_clearance(1e-4, compliance=1e-11)
    _, full = loose_at(0.9, 0.2)
    full *= joint.clearance / 2e-5 / (joint.compliance / 2e-12)
    load = full * np.concatenate([np.linspace(0.5, 2, 301), 1 + np.linspace(-1e-9, 1e-9, 201)])
    load.sort()
    edge, approach = joint.contact_angle(load), joint.approach(load)
    assert np.all(np.diff(edge) >= -4 * EPS)
    assert np.all(edge[load < full * (1 - 1e-12)] < 0.9)
    assert np.all(edge[load > full * (1 + 1e-12)] == 0.9)
    # No jump where one law takes over from the other.
    assert np.all(np.diff(approach) >= -8 * EPS * approach[1:])
    assert np.all(np.diff(approach) / approach[1:] <= 1.1 * np.diff(load) / load[1:] + 8 * EPS)


def test_no_load() -> None:
    loose, _ = loose_at(0.5)
    for method in ("contact_angle", "peak_pressure", "approach"):
        assert getattr(loose, method)(0.0) == 0.0
    assert loose.pressure([0.0, 0.1, -2.0], 0.0).tolist() == [0.0, 0.0, 0.0]
    assert loose.friction_moment(0.0, 0.1) == 0.0
    assert loose.tilting_friction_moment(0.0, 0.1) == 0.0
    assert JOINT.peak_pressure(0.0) == 0.0
    assert JOINT.contact_angle(0.0) == RIGHT
    # So little that even its q is a subnormal number.
    assert BallJoint(1.0).with_clearance(1.0, compliance=1.0).approach(5e-324) > 1e-162


# --- arrays ----------------------------------------------------------------------------------


def test_everything_broadcasts() -> None:
    radius = np.array([0.1, 0.2])[:, None, None]
    angle = np.array([0.5, 1.0, RIGHT])[:, None]
    load = np.array([1e3, 1e4, 1e5, 1e6])
    fit = BallJoint(radius, angle)
    loose = fit.with_clearance([[1e-5], [2e-5], [3e-5]], compliance=1e-12)
    assert fit.shape == loose.shape == (2, 3, 1)
    direction, force = np.array([[1.0, 2.0, 3.0]] * 4), np.array([[0.0, 0.0, 1.0]]) * load[:, None]
    got = {
        "contact_angle": loose.contact_angle(load),
        "peak_pressure": loose.peak_pressure(load),
        "pressure": loose.pressure(0.3, load),
        "pressure_at": loose.pressure_at(direction, force),
        "approach": loose.approach(load),
        "friction_moment": loose.friction_moment(load, 0.1),
        "tilting_friction_moment": loose.tilting_friction_moment(load, 0.1),
    }
    for i, r in enumerate((0.1, 0.2)):
        for j, gap in enumerate((1e-5, 2e-5, 3e-5)):
            seat = (0.5, 1.0, RIGHT)[j]
            one = BallJoint(r, seat).with_clearance(gap, compliance=1e-12)
            for k, d in enumerate(load.tolist()):
                want = {
                    "pressure": one.pressure(0.3, d),
                    "pressure_at": one.pressure_at([1, 2, 3], [0, 0, d]),
                    "friction_moment": one.friction_moment(d, 0.1),
                    "tilting_friction_moment": one.tilting_friction_moment(d, 0.1),
                }
                for name, array in got.items():
                    assert array.shape == (2, 3, 4)
                    value = want[name] if name in want else getattr(one, name)(d)
                    # NumPy's functions may round arrays and scalars differently.
                    assert array[i, j, k] == pytest.approx(value, rel=16 * EPS), name
    assert fit.contact_angle(load).shape == (2, 3, 4)
    assert fit.friction_moment(load, [0.1] * 4).shape == (2, 3, 4)
    assert BallJoint.sized_for(load, 1e7, angle).shape == (3, 4)
    assert isinstance(JOINT.peak_pressure(1), float)


def test_nan_stays_where_it_is() -> None:
    loose, load = loose_at(0.6)
    nan, loads, thetas = math.nan, [load, math.nan], [0.1, math.nan, 2.0]
    for joint in (BallJoint(1.0), BallJoint(1.0, 0.5), loose):
        for name, extra in (
            ("contact_angle", []),
            ("peak_pressure", []),
            ("approach", [] if joint is loose else [1e-12]),
            ("friction_moment", [0.1]),
            ("tilting_friction_moment", [0.1]),
        ):
            got = getattr(joint, name)(loads, *extra)
            assert np.isnan(got).tolist() == [False, True], name
        assert np.isnan(joint.friction_moment(load, [nan, 0.1])).tolist() == [True, False]
        got = joint.pressure(thetas, np.array([[load], [nan]]))
        assert np.isnan(got).tolist() == [[False, True, False], [True] * 3]
        assert np.isnan(joint.pressure([math.inf, -math.inf, 1.0], load)).tolist() == [1, 1, 0]
        directions = [[0.0, 0.1, 1.0], [nan, 0.0, 1.0], [0.0, 1.0, -1.0]]
        got = joint.pressure_at(directions, [0.0, 0.0, load])
        assert np.isnan(got).tolist() == [False, True, False]
        got = joint.pressure_at([0, 0, 1], [[0.0, 0.0, load], [0.0, nan, load]])
        assert np.isnan(got).tolist() == [False, True]


def test_joints_never_change() -> None:
    radius = np.array([0.1, 0.2])
    joint = BallJoint(radius).with_clearance(1e-5, compliance=[1e-12, 2e-12])
    radius[0] = 9.0
    assert joint.radius.tolist() == [0.1, 0.2]
    for array in (joint.radius, joint.compliance):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1.0
    with pytest.raises(FrozenInstanceError):
        joint.radius = 1.0  # type: ignore[misc]
    other = BallJoint(0.1)
    for copied in (pickle.loads(pickle.dumps(joint)), copy.deepcopy(joint), copy.copy(joint)):
        assert copied.peak_pressure(1e4).tolist() == joint.peak_pressure(1e4).tolist()
        assert not copied.radius.flags.writeable
    assert pickle.loads(pickle.dumps(other)).compliance is None
    assert pickle.loads(pickle.dumps(BallJoint(0.1, 1.25))).half_angle == 1.25
    assert len({joint, other, joint}) == 2


# --- refusals --------------------------------------------------------------------------------

SEAT = "half-angle must lie in (0, pi/2]"
POSITIVE = "must be positive and finite"
NOT_NEGATIVE = "must be finite and not negative"
LOOSE = BallJoint(0.1).with_clearance(1e-4, compliance=1e-12)


test_refusals = refusals(
    {
        f"radius is -1.0; it {POSITIVE}": lambda: BallJoint(-1.0),
        f"radius[1] is 0.0; it {POSITIVE}": lambda: BallJoint([1.0, 0.0]),
        f"radius is nan; it {POSITIVE}": lambda: BallJoint(math.nan),
        f"radius is inf; it {POSITIVE}": lambda: BallJoint(math.inf),
        f"half_angle is 0.0 rad; a {SEAT}": lambda: BallJoint(1.0, 0.0),
        f"half_angle is -0.1 rad; a {SEAT}": lambda: BallJoint(1.0, -0.1),
        f"half_angle[0, 1] is 90.0 rad; a {SEAT}": lambda: BallJoint(1.0, [[1.0, 90.0]]),
        f"half_angle is nan rad; a {SEAT}": lambda: BallJoint(1.0, math.nan),
        "shapes do not broadcast: radius (2,), half_angle (3,), clearance ()": lambda: BallJoint(
            [1.0, 2.0], [1.0] * 3
        ),
        "clearance is -1e-06 m; a clearance must be finite and not negative": lambda: (
            JOINT.with_clearance(-1e-6, compliance=1.0)
        ),
        "clearance[1] is nan m; a clearance must be finite and not negative": lambda: (
            JOINT.with_clearance([0.0, math.nan], compliance=1.0)
        ),
        "clearance is inf m; a clearance must be finite and not negative": lambda: (
            JOINT.with_clearance(math.inf, compliance=1.0)
        ),
        f"compliance is 0.0; it {POSITIVE}": lambda: JOINT.with_clearance(1.0, compliance=0.0),
        "…broadcast: radius (2,), half_angle (), clearance (), compliance (3,)": lambda: BallJoint(
            [1.0, 2.0]
        ).with_clearance(1.0, compliance=[1.0] * 3),
        f"load is -5.0; it {NOT_NEGATIVE}": lambda: JOINT.peak_pressure(-5.0),
        f"load[1] is -5.0; it {NOT_NEGATIVE}": lambda: JOINT.contact_angle([1.0, -5.0]),
        f"load[1] is inf; it {NOT_NEGATIVE}": lambda: JOINT.pressure(0.0, [1.0, math.inf]),
        "shapes do not broadcast: joint (), theta (2,), load (3,)": lambda: JOINT.pressure(
            [0.0, 0.1], [1.0, 2.0, 3.0]
        ),
        "shapes do not broadcast: joint (2,), load (3,)": lambda: BallJoint(
            [1.0, 2.0]
        ).peak_pressure([1.0] * 3),
        "directions has shape (2,); vectors need (..., 3)": lambda: JOINT.pressure_at(
            [1.0, 2.0], [0.0, 0.0, 1.0]
        ),
        "directions has shape ()": lambda: JOINT.pressure_at(1.0, [0.0, 0.0, 1.0]),
        f"length of directions[1] is 0.0; it {POSITIVE}": lambda: JOINT.pressure_at(
            [[1.0, 0.0, 0.0], [0.0, 0.0, 0.0]], [0.0, 0.0, 1.0]
        ),
        f"length of load_vector is 0.0; it {POSITIVE}": lambda: JOINT.pressure_at(
            [1.0, 0.0, 0.0], [0.0, 0.0, 0.0]
        ),
        f"length of load_vector[0] is inf; it {POSITIVE}": lambda: JOINT.pressure_at(
            [1.0, 0.0, 0.0], [[0.0, 0.0, -math.inf]]
        ),
        "shapes do not broadcast: joint (), directions (2,), load_vector (3,)": lambda: (
            JOINT.pressure_at([[1.0, 0.0, 0.0]] * 2, [[1.0, 0.0, 0.0]] * 3)
        ),
        "compliance is missing; the approach needs it once": lambda: JOINT.approach(1.0),
        "compliance is given, but with_clearance has set it; the approach needs it once": lambda: (
            LOOSE.approach(1.0, 1e-12)
        ),
        f"compliance is -1.0; it {POSITIVE}": lambda: JOINT.approach(1.0, -1.0),
        "shapes do not broadcast: joint (), load (2,), compliance (3,)": lambda: JOINT.approach(
            [1.0] * 2, [1.0] * 3
        ),
        f"friction is -0.1; it {NOT_NEGATIVE}": lambda: JOINT.friction_moment(1.0, -0.1),
        "shapes do not broadcast: joint (), load (2,), friction (3,)": lambda: (
            JOINT.tilting_friction_moment([1.0] * 2, [1.0] * 3)
        ),
        f"load is 0.0; it {POSITIVE}": lambda: BallJoint.sized_for(0.0, 1.0),
        f"allowable_pressure[1] is nan; it {POSITIVE}": lambda: BallJoint.sized_for(
            1.0, [1.0, math.nan]
        ),
        f"half_angle is 2.0 rad; a {SEAT}": lambda: BallJoint.sized_for(1.0, 1.0, 2.0),
        "shapes do not broadcast: load (2,), allowable_pressure (3,), half_angle ()": lambda: (
            BallJoint.sized_for([1.0] * 2, [1.0] * 3)
        ),
        "clearance is given without a compliance; it needs one": lambda: BallJoint.sized_for(
            1.0, 1.0, clearance=1e-5
        ),
        "…broadcast: load (2,), allowable_pressure (), half_angle (), clearance (3,)": lambda: (
            BallJoint.sized_for([1.0] * 2, 1.0, clearance=[0.0] * 3, compliance=1.0)
        ),
        f"allowable_pressure is -1.0; it {POSITIVE}": lambda: JOINT.allowable_load(-1.0),
        f"thickness is 0.0; it {POSITIVE}": lambda: layer_compliance(0.0, 1.0),
        f"modulus[1] is -1.0; it {POSITIVE}": lambda: layer_compliance(1.0, [1.0, -1.0]),
        "poisson is 0.5; Poisson's ratio must lie in [0, 0.5)": lambda: layer_compliance(
            1.0, 1.0, 0.5
        ),
    }
)


def test_nodes_of_the_rule_are_those_of_gauss() -> None:
    nodes = ball_joint._GAUSS
    assert len(nodes) == 12
    with mp.workdps(40):
        for found, weight in nodes:
            node = mp.findroot(lambda x: mp.legendre(24, x), mp.mpf(found))
            slope = 24 * (mp.legendre(23, node) - node * mp.legendre(24, node)) / (1 - node**2)
            assert found == float(node)
            assert weight == float(2 / ((1 - node**2) * slope**2))
    assert len({node for node, _ in nodes}) == 12

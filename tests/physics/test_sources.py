"""The formulas and printed figures of the sources, by equation number.

K. H. Grossmann, Die Momente im Kreuzgelenk, 1939; the catalogue chapters on the single joint
("Kinematik des Kreuzgelenks", Bilder 10 to 13) and on double joints (sections 6.1 to 6.5); the
introduction of D. Thoma, Das Kräftespiel im Kreuzgelenk, 1920. His equations and Marcus's are in
test_approximations.py and test_ball_joint.py.
"""

from __future__ import annotations

import math

import numpy as np
import pytest

from cardan import Driveline, Load, Result

ANGLES = np.linspace(-7.0, 7.0, 1401)
BENDS = [0.1, 0.5, math.radians(45), math.radians(50), 1.3, math.radians(89)]


def joint(bend: float) -> Result:
    return Driveline.from_bends([bend]).evaluate(
        ANGLES,
        (
            "angle",
            "speed_ratio",
            "torque",
            "moment",
            "bending_driving",
            "bending_driven",
            "tilt_driving",
            "tilt_driven",
        ),
        joints=0,
        load=Load(drive_torque=1.0),
    )


def close(got: np.ndarray, want: np.ndarray, scale: float = 1.0) -> None:
    assert np.max(np.abs(got - want)) <= 1e-14 * scale


@pytest.mark.parametrize("bend", BENDS)
def test_grossmann_1_angles(bend: float) -> None:
    # tan a1 = cos phi tan a2, without its poles.
    turned = joint(bend).angle
    left = np.sin(ANGLES) * np.cos(turned)
    close(left, math.cos(bend) * np.cos(ANGLES) * np.sin(turned))


@pytest.mark.parametrize("bend", BENDS)
def test_grossmann_2_to_5_tilts(bend: float) -> None:
    result = joint(bend)
    psi1, psi2 = result.tilt_driving, result.tilt_driven
    tangent = math.tan(bend)
    close(np.cos(psi1) * np.cos(psi2), np.full_like(psi1, math.cos(bend)))  # (2)
    close(np.tan(psi1), tangent * np.sin(ANGLES), tangent**2 + 1)  # (3)
    # (4) at the driven angle, whose rounding counts 1/cos phi times.
    close(np.tan(psi2), tangent * np.cos(result.angle), 2 * (tangent**2 + 1))
    close(np.sin(psi2), math.sin(bend) * np.cos(ANGLES))  # (5)


@pytest.mark.parametrize("bend", BENDS)
def test_grossmann_6_to_8_moments(bend: float) -> None:
    result = joint(bend)
    sine, cosine, tangent = np.sin(ANGLES), np.cos(ANGLES), math.tan(bend)
    stretch = 1 + (tangent * sine) ** 2
    scale = 1 + tangent**2
    close(result.bending_driving, tangent * abs(sine), scale)  # (6)
    close(result.torque, math.cos(bend) * stretch, scale)  # (7)
    other = 1 / (math.cos(bend) * (1 + (tangent * np.cos(result.angle)) ** 2))
    close(result.torque, other, 4 * scale)  # (7), over the driven angle
    close(result.bending_driven, math.sin(bend) * abs(cosine) * np.sqrt(stretch), scale)  # (8)


@pytest.mark.parametrize("bend", BENDS)
def test_thoma_3_and_4_rotation(bend: float) -> None:
    # tan psi = tan phi / cos alpha without its poles; (3) is its square.
    turned, cosine = joint(bend).angle, math.cos(bend)
    close(np.sin(turned) * np.cos(ANGLES) * cosine, np.cos(turned) * np.sin(ANGLES))
    square = np.sin(ANGLES) ** 2
    close(np.sin(turned) ** 2, square / (cosine**2 + (1.0 - cosine**2) * square), 2.0)


@pytest.mark.parametrize("bend", BENDS)
def test_thoma_introduction_the_moment_bends_one_of_the_shafts(bend: float) -> None:
    line = Driveline.from_bends([bend])
    least = math.atan(math.sqrt(math.cos(bend)))  # where both shafts are equally far from it
    angle = np.append(ANGLES, [least, math.pi - least])
    moment = line.evaluate(angle, "moment", joints=0, load=Load(drive_torque=1.0)).moment
    # From sine and cosine: the inverse cosine loses half the digits of small angles.
    along = np.abs(line.directions @ moment.T)
    across = np.linalg.norm(np.cross(line.directions[:, None], moment), axis=-1)
    larger = np.arctan2(across, along).max(axis=0)
    bound = math.acos(math.sqrt(math.cos(bend)))
    assert bound >= bend / 2  # his bound
    assert larger.min() >= bound - 1e-14  # the sharper one
    close(larger[-2:], np.full(2, bound))


def test_grossmann_figure_3_and_4_at_50_degrees() -> None:
    bend = math.radians(50)
    line = Driveline.from_bends([bend])
    angle = np.linspace(0, 2 * math.pi, 100_001)
    names = ("torque", "bending_driving", "bending_driven", "moment")
    result = line.evaluate(angle, names, joints=0, load=Load(drive_torque=1.0))
    # Figure 3: the torque runs between cos and 1/cos.
    assert result.torque.min() == pytest.approx(math.cos(bend), rel=1e-12)
    assert result.torque.max() == pytest.approx(1 / math.cos(bend), rel=1e-8)
    # Figure 4, across the driving shaft: a circle through the origin of diameter tan.
    (_, along, across) = result.moment.T
    radius = math.tan(bend) / 2
    close(np.hypot(along - radius, across), np.full_like(along, radius), 2)
    # Across the driven shaft: an ellipse. Its largest value is 1/(2 cos), and not the sine that
    # catalogues print, which holds up to 45 degrees only.
    assert result.bending_driven.max() == pytest.approx(0.77786, abs=5e-6)
    assert math.sin(bend) == pytest.approx(0.76604, abs=5e-6)


@pytest.mark.parametrize("degrees", [10, 30, 45, 46, 60, 80])
def test_the_peak_of_the_driven_bending_moment(degrees: float) -> None:
    bend = math.radians(degrees)
    line = Driveline.from_bends([bend])
    load = Load(drive_torque=1.0)
    angle = np.linspace(0, math.pi, 20_001)
    peak = line.evaluate(angle, "bending_driven", joints=0, load=load).bending_driven.max()
    exact = math.sin(bend) if degrees <= 45 else 1 / (2 * math.cos(bend))
    assert peak == pytest.approx(exact, rel=1e-6)


def test_catalogue_bild_10_driven_angle() -> None:
    angle = np.linspace(-1.5, 1.5, 301)
    for bend in BENDS:
        turned = Driveline.from_bends([bend]).evaluate(angle, "angle").angle
        assert turned == pytest.approx(np.arctan(np.tan(angle) / math.cos(bend)), abs=1e-13)


@pytest.mark.parametrize(
    ("degrees", "printed", "at"), [(10, 0.438, 44.8), (20, 1.782, 44.1), (30, 4.117, 42.9)]
)
def test_catalogue_bild_11_and_12_largest_error(degrees: float, printed: float, at: float) -> None:
    # 0.438 is printed for 0.43856.
    line = Driveline.from_bends([degrees], degrees=True)
    largest = math.degrees(line.equivalent().max_angle_error)
    assert largest == pytest.approx(printed, abs=6e-4)
    bend = math.radians(degrees)
    formula = math.atan((1 - math.cos(bend)) / (2 * math.sqrt(math.cos(bend))))
    assert math.radians(largest) == pytest.approx(formula, rel=1e-13)
    angle = np.radians(np.linspace(0, 90, 90_001))
    error = line.evaluate(angle, "angle_error").angle_error
    assert math.degrees(angle[np.argmax(error)]) == pytest.approx(at, abs=0.06)


@pytest.mark.parametrize("bend", BENDS)
def test_catalogue_bild_13_non_uniformity(bend: float) -> None:
    line = Driveline.from_bends([bend])
    formula = math.tan(bend) * math.sin(bend)
    assert line.equivalent().non_uniformity == pytest.approx(formula, rel=1e-13)
    ratio = line.evaluate(np.array([0.0, math.pi / 2]), "speed_ratio").speed_ratio
    assert ratio[0] - ratio[1] == pytest.approx(formula, rel=1e-12)


@pytest.mark.parametrize(("twist", "name"), [(180, "Z"), (0, "W")])
def test_catalogue_6_1_and_6_2_full_compensation(twist: float, name: str) -> None:
    line = Driveline.from_bends([15, 15], twists=twist, degrees=True)
    assert line.equivalent().k < 1e-16, name
    crossed = line.with_phases(90, degrees=True).equivalent()
    # Wrongly set yokes add up: ln sec of the equivalent bend is twice that of one.
    assert crossed.min_speed_ratio == pytest.approx(math.cos(math.radians(15)) ** 2, rel=1e-14)


def test_catalogue_6_3_spatial_bends() -> None:
    # Printed from the diagram: 16.5 and 71 degrees; the exact values beside it.
    line = Driveline.from_projected_bends([15, -11.5], [7, 12], degrees=True)
    assert np.degrees(line.bends) == pytest.approx([16.4225, 16.3956], abs=5e-5)
    assert np.degrees(line.twists) == pytest.approx([109.127], abs=5e-4)
    for (vertical, horizontal), bend in zip([(15, 7), (-11.5, 12)], line.bends[:], strict=True):
        squares = math.tan(math.radians(vertical)) ** 2 + math.tan(math.radians(horizontal)) ** 2
        assert math.tan(bend) ** 2 == pytest.approx(squares, rel=1e-13)
    set_right = line.with_phases(line.twists).equivalent()
    assert math.degrees(set_right.bend) == pytest.approx(0.951, abs=5e-4)
    assert math.degrees(line.equivalent().bend) == pytest.approx(22.4, abs=0.05)
    as_printed = line.with_phases(-71, degrees=True).equivalent()
    assert math.degrees(as_printed.bend) == pytest.approx(1.2302, abs=5e-5)


@pytest.mark.parametrize(("reference", "twist"), [("input", -72.295), ("output", -73.389)])
def test_catalogue_6_3_read_from_another_shaft(reference: str, twist: float) -> None:
    line = Driveline.from_projected_bends([15, -11.5], [7, 12], degrees=True, reference=reference)  # type: ignore[arg-type]
    folded = (np.degrees(line.twists[0]) + 90) % 180 - 90
    assert folded == pytest.approx(twist, abs=5e-4)


def test_catalogue_6_4_tolerance() -> None:
    # 3 degrees stand for a non-uniformity of 0.0027.
    found = Driveline.from_bends([3], degrees=True).equivalent().non_uniformity
    assert found == pytest.approx(0.0027, abs=5e-5)


def test_catalogue_bild_20_signs_of_a_chain() -> None:
    """As drawn on the page on chains: parallel, crossed and parallel yokes in one plane."""
    line = Driveline.from_bends([5, 4, 6, 3], [0] * 3, [0, 90, 0], degrees=True)
    signs, off = line.fork_signs()
    assert signs.tolist() == [1, -1, -1, 1]
    close(off, np.zeros(3))
    rule = math.sqrt(abs(25 - 16 - 36 + 9))
    assert math.degrees(line.catalogue_bend(signs)) == pytest.approx(rule, rel=1e-12)
    assert math.degrees(line.equivalent().bend) == pytest.approx(rule, rel=2e-3)

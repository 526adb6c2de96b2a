"""Round shafts against textbook numbers and the solid bar."""

from __future__ import annotations

import math

import numpy as np
import pytest

import cardan


def test_a_tube_of_steel() -> None:
    # 90 x 3 mm, 1.5 m long.
    shaft = cardan.tube(0.09, 0.003, length=1.5)
    assert shaft.stiffness == pytest.approx(82123.4, abs=0.05)
    assert shaft.shear_stress(2000.0) == pytest.approx(57.937e6, abs=500.0)
    assert shaft.critical_speed * 30 / math.pi == pytest.approx(6604.19, abs=0.005)
    assert isinstance(shaft.shear_stress(2000.0), float)


def test_inertia_is_that_of_rings() -> None:
    # The rings of a tube, by the midpoint rule: dm r**2.
    rings, wall, density, length = 20_000, 0.01, 7850.0, 2.0
    step = wall / rings
    radii = [0.03 - wall + (i + 0.5) * step for i in range(rings)]
    masses = [density * length * 2 * math.pi * r * step for r in radii]
    shaft = cardan.tube(0.06, wall, length=length)
    assert shaft.mass == pytest.approx(sum(masses), rel=1e-8)
    inertia = sum(m * r**2 for m, r in zip(masses, radii, strict=True))
    assert shaft.inertia == pytest.approx(inertia, rel=1e-8)


def test_a_solid_bar_has_the_largest_wall() -> None:
    solid, full = cardan.tube(0.04, length=1.0), cardan.tube(0.04, 0.02, length=1.0)
    assert solid.stiffness == full.stiffness == pytest.approx(7.93e10 * math.pi * 0.04**4 / 32)


def test_tubes_broadcast() -> None:
    shafts = cardan.tube([0.08, 0.09], [[0.002], [0.003], [0.004]], length=1.2)
    assert shafts.stiffness.shape == (3, 2)
    assert shafts.shear_stress(100.0).shape == (3, 2)
    assert shafts.stiffness[1, 1] == cardan.tube(0.09, 0.003, length=1.2).stiffness


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"outer_diameter": 0.0, "length": 1.0}, "outer_diameter is 0.0; it must be positive"),
        ({"outer_diameter": 0.1, "length": float("inf")}, "length is inf; it must be positive"),
        (
            {"outer_diameter": 0.1, "wall": [0.01, 0.06], "length": 1.0},
            r"wall\[1\] is 0\.06 m; a wall is at most half the outer diameter",
        ),
        # A wall of half the diameter is a solid bar, and one wall may be too thick for one tube.
        ({"outer_diameter": 0.1, "wall": [0.05, 0.06], "length": 1.0}, r"wall\[1\] is 0\.06 m"),
        ({"outer_diameter": [0.2, 0.1], "wall": 0.06, "length": 1.0}, r"wall\[1\] is 0\.06 m"),
    ],
)
def test_wrong_tubes_are_refused(arguments: dict[str, object], message: str) -> None:
    with pytest.raises(cardan.ArgumentValueError, match=message):
        cardan.tube(**arguments)  # type: ignore[arg-type]


def beam_frequency(outer: float, wall: float, length: float, elements: int) -> float:
    """First bending frequency in rad/s of a pinned tube from beam elements with cubic shapes."""
    inner = outer - 2.0 * wall
    stiffness = 2.06e11 * math.pi / 64.0 * (outer**4 - inner**4)
    mass = 7850.0 * math.pi / 4.0 * (outer**2 - inner**2)
    h = length / elements
    k = np.array([[12, 6 * h, -12, 6 * h], [6 * h, 4 * h**2, -6 * h, 2 * h**2]])
    k = stiffness / h**3 * np.array([*k, -k[0], [6 * h, 2 * h**2, -6 * h, 4 * h**2]])
    m = (
        mass
        * h
        / 420.0
        * np.array(
            [
                [156, 22 * h, 54, -13 * h],
                [22 * h, 4 * h**2, 13 * h, -3 * h**2],
                [54, 13 * h, 156, -22 * h],
                [-13 * h, -3 * h**2, -22 * h, 4 * h**2],
            ]
        )
    )
    size = 2 * elements + 2
    whole_k, whole_m = np.zeros((size, size)), np.zeros((size, size))
    for i in range(elements):
        part = slice(2 * i, 2 * i + 4)
        whole_k[part, part] += k
        whole_m[part, part] += m
    # The ends cannot move but can turn.
    free = [i for i in range(size) if i not in (0, size - 2)]
    squares = np.linalg.eigvals(
        np.linalg.solve(whole_m[np.ix_(free, free)], whole_k[np.ix_(free, free)])
    )
    return float(np.sqrt(np.min(squares.real)))


@pytest.mark.parametrize(("outer", "wall", "length"), [(0.09, 0.003, 1.5), (0.05, 0.02, 0.9)])
def test_the_critical_speed_is_that_of_beam_elements(
    outer: float, wall: float, length: float
) -> None:
    shaft = cardan.tube(outer, wall, length=length)
    assert shaft.critical_speed == pytest.approx(beam_frequency(outer, wall, length, 24), rel=1e-6)


def test_stress_is_that_of_rings() -> None:
    """The torque that rings with a shear proportional to their radius carry together."""
    rings, outer, wall = 20_000, 0.06, 0.01
    step = wall / rings
    radii = 0.5 * outer - wall + (np.arange(rings) + 0.5) * step
    torque = np.sum(radii * (radii / (0.5 * outer)) * 2.0 * math.pi * radii * step)
    assert cardan.tube(outer, wall, length=1.0).shear_stress(torque) == pytest.approx(1.0, rel=1e-8)

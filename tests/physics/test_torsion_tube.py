"""Round shafts against textbook numbers and the solid bar."""

from __future__ import annotations

import math

import pytest

import cardan


def test_a_tube_of_steel() -> None:
    # 90 x 3 mm, 1.5 m long.
    shaft = cardan.tube(0.09, 0.003, length=1.5)
    assert shaft.stiffness == pytest.approx(82123.4, abs=0.05)
    assert shaft.shear_stress(2000.0) == pytest.approx(57.937e6, abs=500.0)
    assert shaft.critical_speed * 30 / math.pi == pytest.approx(6604.19, abs=0.005)


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
    ],
)
def test_wrong_tubes_are_refused(arguments: dict[str, object], message: str) -> None:
    with pytest.raises(cardan.ArgumentValueError, match=message):
        cardan.tube(**arguments)  # type: ignore[arg-type]

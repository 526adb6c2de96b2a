"""Lateral systems that the tests of the library and of its twin share.

The cases of ``lateral.json`` come from a model without a mesh, with 12 digits. Systems are those of
the twin; ``library`` makes the library's of them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields
from itertools import pairwise
from typing import Any

import numpy as np
import pytest

import cardan
from cardan import Driveline, LateralSystem, reference
from cardan.lateral import LateralResponse, TorqueStiffness
from cardan.reference import Shafts
from cardan.reference.lateral import (
    Array,
    Complex,
    ElasticBearing,
    PointMass,
    Response,
    RigidShaft,
    System,
    Tube,
    Unbalance,
)
from oracle import read

CASES: dict[str, dict[str, Any]] = {case["name"]: case for case in read("lateral.json")["cases"]}
RIGID = [name for name, case in CASES.items() if all("E" not in own for own in case["shafts"])]
TUBES = [name for name in CASES if name not in RIGID]

# The names in the data, their unit included, of what a response has.
VECTORS = {
    "bearing_force": "bearing_force_N",
    "bearing_displacement": "bearing_displacement_m",
    "joint_force": "joint_force_N",
    "joint_displacement": "joint_displacement_m",
    "displacement": "probe_displacement_m",
}


def planar(bends: Sequence[float], phases: Sequence[float]) -> Shafts:
    """A driveline in a plane; bends the other way are negative."""
    slopes = np.cumsum([0.0, *bends])
    return reference.from_directions([(math.cos(x), math.sin(x), 0.0) for x in slopes], phases)


def shaft_of(own: dict[str, Any]) -> RigidShaft | Tube | None:
    if own["kind"] == "held":
        return None
    if own["kind"] == "rigid":
        return RigidShaft(own["mass"], own["centre"], own["Jd"], own["Jp"])
    moduli = own["E"], own["G"], own["rho"], own.get("loss", 0.0)
    return Tube(own["outer_diameter"], own["wall"], own.get("kappa"), *moduli)


def system_of(case: dict[str, Any], step: float = 0.2) -> System:
    points = case["points"]
    return System(
        reference.from_points(points, [math.radians(phase) for phase in case["phases_deg"]]),
        [math.dist(p, q) for p, q in pairwise(points)],
        [shaft_of(own) for own in case["shafts"]],
        [
            ElasticBearing(
                own["shaft"],
                own["position"],
                own["stiffness"],
                own["axis"],
                own["loss"],
                own.get("damping", 0.0),
            )
            for own in case["bearings"]
        ],
        [
            PointMass(own["shaft"], own["position"], own["mass"], own["Jd"], own["Jp"])
            for own in case.get("masses", [])
        ],
        [Unbalance(**own) for own in case.get("unbalance", [])],
        case["sliding"],
        step,
    )


def load_of(case: dict[str, Any]) -> dict[str, Any]:
    load = dict(case["load"])
    inertia = load.pop("output_inertia", 0.0)
    return load | {"inertias": [*[0.0] * (len(case["shafts"]) - 1), inertia]}


def speeds_of(case: dict[str, Any]) -> Array:
    return np.array(case["speeds_rpm"]) * math.pi / 30.0


def probes_of(case: dict[str, Any]) -> list[tuple[int, float]]:
    return [(own["shaft"], own["position"]) for own in case.get("probes", [])]


def check(
    case: dict[str, Any],
    frequencies: Array,
    response: Response | LateralResponse,
    close: float,
    energy: float,
) -> None:
    """Compare what was found with a case.

    Args:
        case: of the data.
        frequencies: as many natural frequencies as the case has.
        response: at its speeds and orders.
        close: relative error of frequencies, and of vectors by the largest one of their kind and
            order; orders below a hundredth of the largest count as that.
        energy: error of the balance of power, relative to the power at this speed and order.
    """
    shape = (len(case["speeds_rpm"]), len(case["orders"]))
    assert frequencies == pytest.approx(case["natural_frequencies_rad_s"], rel=close)
    for name, key in VECTORS.items():
        numbers = np.array([own[key] for own in case["results"]], dtype=np.float64)
        own = getattr(response, name)
        assert own.size == numbers.size // 2, name
        if numbers.size:
            data = numbers.view(np.complex128).reshape(*shape, -1, 3)
            size = np.max(np.abs(data), axis=(0, 2, 3))
            size = np.maximum(size, 1e-2 * np.max(size))[:, None, None]
            # Where nothing moves, what is left is rounding.
            off = np.abs(np.moveaxis(own, 0, 2) - data)
            assert np.all(off <= close * size + 1e-18), name
    lost = response.bearing_power.sum(axis=0) + 0.0 * response.given_power
    power = np.reshape([own["bearing_power_W"] for own in case["results"]], shape)
    assert lost == pytest.approx(power, rel=close, abs=1e-9 * close)
    lost = lost + response.tube_power
    assert response.given_power == pytest.approx(lost, rel=energy, abs=1e-10)


# --- the library ---------------------------------------------------------------------------------


def tube_of(own: Tube) -> cardan.Tube:
    """Return the library's tube; its length is that of the driveline."""
    return cardan.tube(
        own.outer_diameter,
        own.wall,
        length=1.0,
        shear_modulus=own.shear_modulus,
        elastic_modulus=own.elastic_modulus,
        density=own.density,
        rotary=own.shear_coefficient is not None,
        shear_coefficient=own.shear_coefficient,
        loss_factor=own.loss_factor,
    )


def library(system: System) -> LateralSystem:
    """Return the library's system for the twin's."""
    steps = np.array(system.line.directions) * np.array(system.lengths)[:, None]
    points = np.concatenate([np.zeros((1, 3)), np.cumsum(steps, axis=0)])

    def same(kind: Any, item: Any) -> Any:  # noqa: ANN401 - any of four pairs of classes
        return kind(**{field.name: getattr(item, field.name) for field in fields(item)})

    shafts = [
        None
        if own is None
        else tube_of(own)
        if isinstance(own, Tube)
        else same(cardan.RigidShaft, own)
        for own in system.shafts
    ]
    return LateralSystem(
        Driveline.from_points(points, system.line.phases),
        shafts=shafts,
        bearings=[same(cardan.ElasticBearing, own) for own in system.bearings],
        masses=[same(cardan.PointMass, own) for own in system.masses],
        unbalance=[same(cardan.Unbalance, own) for own in system.unbalance],
        sliding=system.sliding,
    )


def load(options: dict[str, Any]) -> cardan.Load:
    """Return the library's load for options of the twin's; its speed does not count."""
    return cardan.Load(**({"speed": 0.0} if "inertias" in options else {}), **options)


@dataclass(frozen=True)
class Library:
    """The library's system for the twin's, with the arguments of the twin's methods."""

    system: System

    @property
    def own(self) -> LateralSystem:
        return library(self.system)

    def natural_frequencies(self, count: int = 6) -> Array:
        found = self.own.natural_frequencies(count)
        return found[np.isfinite(found)]

    def response(
        self,
        speed: Any,  # noqa: ANN401
        options: dict[str, Any],
        orders: Any = (1, 2, 4),  # noqa: ANN401
        probes: Any = (),  # noqa: ANN401
    ) -> LateralResponse:
        return self.own.response(speed, load(options), orders, probes)

    def torque_stiffness(self, torque: float) -> TorqueStiffness:
        return self.own.torque_stiffness(torque)

    def is_stable(self, speed: float, torque: float) -> bool:
        return bool(self.own.is_stable(speed, torque))


# --- systems with closed forms -------------------------------------------------------------------

TUBE = Tube(0.09, 0.003)
LINE = TUBE.density * TUBE.area
BENDING = TUBE.elastic_modulus * TUBE.second_moment


def between_machines(
    tube: Tube, length: float, bends: Sequence[float] = (0.0, 0.0), step: float = 0.2
) -> System:
    return System(planar(bends, [0.0]), [0.3, length, 0.3], [None, tube, None], step=step)


def pinned(tube: Tube, length: float, mode: int) -> float:
    """Natural frequency of a tube that is pinned at both ends."""
    p = mode * math.pi / length
    if tube.shear_coefficient is None:
        return p**2 * math.sqrt(BENDING / LINE)
    rotary = tube.density * tube.second_moment
    shear = tube.shear_coefficient * tube.shear_modulus * tube.area
    middle = LINE + rotary * p**2 + LINE * BENDING * p**2 / shear
    # The lower root of a w^4 - b w^2 + c, without cancellation.
    first, last = rotary * LINE / shear, BENDING * p**4
    return math.sqrt(2.0 * last / (middle + math.sqrt(middle**2 - 4.0 * first * last)))


def two_piece(
    bends: Sequence[float],
    phases: Sequence[float] = (0.0, 0.0),
    stiffness: float = 1.5e5,
    damping: float = 0.0,
    loss_factor: float = 0.0,
    along: float = 0.0,
) -> System:
    """Two rigid rods that are balanced about any point, on a centre bearing."""
    first, second = 1.25, 1.75
    return System(
        planar(bends, phases),
        [0.3, first, second, 0.3],
        [
            None,
            RigidShaft(12.0, first / 2.0, first**2, along),
            RigidShaft(17.0, second / 2.0, 17.0 * second**2 / 12.0, along),
            None,
        ],
        [ElasticBearing(1, 1.13, (stiffness,) * 2, None, loss_factor, damping)],
    )


def effective_mass(cosine: float = 1.0) -> float:
    """Mass at the joint that stands for both rods; the second one counts by a cosine in a plane."""
    return (1.25**2 + 12.0 * 1.25**2 / 4.0) / 1.25**2 + 17.0 / 3.0 * cosine**2


def bracket(bends: Sequence[complex], phases: Sequence[float]) -> complex:
    """The layout in the order 2 of a centre bearing, of signed bends in a plane."""
    first, second = 1.25, 1.75
    turn = np.exp(2j * np.cumsum(phases))
    return complex(
        bends[0] / first
        + turn[0] * bends[1] * (1.0 / first + 1.0 / second)
        + turn[1] * bends[2] / second
    )


def rigid_limit() -> tuple[System, dict[str, Any], list[tuple[int, float]]]:
    """Three pieces in space on two bearings that do not give way."""
    points = [
        (0, 0, 0),
        (0.3, 0, 0),
        (1.4, -0.1, 0.1),
        (2.6, -0.2, 0.05),
        (4.2, -0.5, 0),
        (4.5, -0.5, 0),
    ]
    places = [(1, 1.0), (2, 1.1)]
    lengths = [math.dist(p, q) for p, q in pairwise(points)]
    rods = [RigidShaft(12.0, length / 2.0, length**2) for length in lengths[1:-1]]
    system = System(
        reference.from_points(points, [0.3, 1.2, -0.5]),
        lengths,
        [None, *rods, None],
        [ElasticBearing(*place, (1e13, 1e13)) for place in places],
    )
    return system, {"output_torque": 2000.0}, places


def summed(vectors: Complex, orders: Sequence[float], angle: float) -> Array:
    turned = np.exp(1j * np.array(orders) * angle)
    return np.asarray(np.einsum("k,ikx->ix", turned, vectors).real)

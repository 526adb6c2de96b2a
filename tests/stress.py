"""What Python computes on top of the core, and loads of steep chains, against independent models.

``python tests/stress.py --rows 2000`` judges random drivelines: harmonics of the motion and of the
loads, the figures of tolerances, tolerances of one order, and loads of steep chains beside zeros,
for which the oracle of ``cardan-stress`` has too few digits; that judges everything else that the
core computes. Exits with 1 if anything is beyond its limit in ``data/limits.toml``. ``--worst
FILE`` writes the worst case of each surface in the form of ``data/worst_python.json``.

Every error of a harmonic is divided by the bound that is returned with it. Those of tolerances are
in parts of the largest sum of ``tan(bend/2)**2`` of the joints, of which ``q`` keeps the rounding.
The model of ideal chains is the map ``w -> A w + B conj(w)``. Its angle error is the argument of
``1 + q exp(-2 i a)``, at samples in extended precision. The model of joints as built turns the
driven pin until it has its angle to the driving one; that of loads puts these pins into space.
Loads of steep chains are held against the vectors of ``vectors.py``.
"""

from __future__ import annotations

import argparse
import json
import sys
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from cardan import Driveline, Load
from oracle import Doubles, ExactTurn, limits, mp
from vectors import load_errors

Complexes = NDArray[np.clongdouble]
LIMITS = limits("worst", "python")
PI = np.longdouble("3.14159265358979323846264338327950288")
ORDERS = np.arange(1, 9)
# Orders of the drawn drivelines decrease by at least half per two: those that equal these orders
# at the samples are below 1e-20.
SAMPLES = 128

Case: TypeAlias = dict[str, Doubles]
"""Parameters of drivelines by name, rows first. What has one row belongs to all."""


@dataclass(frozen=True)
class Surface:
    """What is judged, and how.

    Attributes:
        draw: makes a case of so many rows.
        judge: returns the worst error of each row, and the number of results.
    """

    draw: Callable[[np.random.Generator, int], Case]
    judge: Callable[[Case], tuple[Doubles, int]]


@dataclass(frozen=True)
class Found:
    """What a run found of a surface: the number of results, the worst error and its case."""

    results: int
    worst: float
    case: Case


def q_of(bends: Any, twists: Any, phases: Any) -> Complexes:  # noqa: ANN401
    """Return ``B/A`` of chains whose joints are on the last axis."""
    bends, twists, phases = (np.asarray(x, np.longdouble) for x in (bends, twists, phases))
    a: Complexes = np.ones(bends.shape[:-1], np.clongdouble)
    b: Complexes = np.zeros_like(a)
    for j in range(bends.shape[-1]):
        if j > 0:
            # A quarter turn more than the phase less the twist; ``1j`` is exact.
            turn = np.exp(1j * (phases[..., j - 1] - twists[..., j - 1])) * 1j
            a, b = a * turn, b * turn
        k = np.tan(bends[..., j] / 2) ** 2
        a, b = a - k * np.conj(b), b - k * np.conj(a)
    return np.asarray(b / a, np.clongdouble)


def orders_of(error: Any) -> Any:  # noqa: ANN401
    """Return complex amplitudes of samples of a turn on the last axis."""
    turns = np.exp(-2j * PI * (np.outer(np.arange(SAMPLES), ORDERS) % SAMPLES) / SAMPLES)
    return 2.0 / SAMPLES * (error @ turns.astype(np.result_type(error, np.complex128)))


def drawn(random: np.random.Generator, rows: int) -> Case:
    """Return bends to 40 deg, twists and phases of drivelines with as many joints."""
    joints = int(random.integers(1, 5))
    bends = random.uniform(0.0, 0.7, (rows, joints)) ** random.uniform(1.0, 4.0)
    twists, phases = random.uniform(-np.pi, np.pi, (2, rows, joints - 1))
    return {"bends": bends, "twists": twists, "phases": phases}


def harmonics(case: Case) -> tuple[Doubles, int]:
    """Orders of the motion of ideal chains."""
    names = ("angle_error", "speed_ratio", "acceleration_ratio", "jerk_ratio")
    bends, twists, phases = (case[name] for name in ("bends", "twists", "phases"))
    found = Driveline.from_bends(bends, twists, phases).harmonics(ORDERS, outputs=names)
    turns = np.exp(-4j * PI * np.arange(SAMPLES) / SAMPLES)
    exact = orders_of(np.angle(1 + q_of(bends, twists, phases)[:, np.newaxis] * turns))
    worst: Doubles = np.zeros(len(exact))
    for derivative, name in enumerate(names):
        wanted = exact * (1j * ORDERS) ** derivative
        off = np.abs(found.complex_amplitude[name] - wanted)
        # What the samples of the model lose of each order.
        bound = found.error[name][:, np.newaxis] + 1e-19 * ORDERS**derivative
        worst = np.maximum(worst, np.max(off / bound, axis=-1).astype(np.float64))
    return worst, exact.size * len(names)


@dataclass(frozen=True)
class Pins:
    """Where the pins of one joint are, at samples on the last axis.

    Attributes:
        driving: cosine and sine of the joint's input angle.
        driven: those of its driven angle.
    """

    driving: tuple[Any, Any]
    driven: tuple[Any, Any]


def turned_pins(
    bends: Any,  # noqa: ANN401
    twists: Any,  # noqa: ANN401
    phases: Any,  # noqa: ANN401
    deviations: Any,  # noqa: ANN401
) -> Iterator[Pins]:
    """Yield the pins of each joint, of the precision of the arguments; Newton's method turns them.

    A pin is a cosine and a sine.
    """
    precision = np.finfo(np.result_type(bends))
    angle = (2 * PI * np.arange(SAMPLES) / SAMPLES).astype(precision.dtype)
    quarter = (PI / 2).astype(precision.dtype)
    cosine, sine = np.cos(angle), np.sin(angle)
    for j in range(bends.shape[-1]):
        if j > 0:
            turn = (phases[..., j - 1] - twists[..., j - 1])[..., np.newaxis] + quarter
            c, s = np.cos(turn), np.sin(turn)
            cosine, sine = cosine * c - sine * s, sine * c + cosine * s
        lean, skew, lean_driven = (deviations[..., j, i][..., np.newaxis] for i in range(3))
        bend = bends[..., j][..., np.newaxis]
        # The driving pin along e_out, m and v.
        out = np.cos(lean) * np.cos(bend) * cosine - np.sin(lean) * np.sin(bend)
        normal = np.cos(lean) * sine
        along = np.cos(lean) * np.sin(bend) * cosine + np.sin(lean) * np.cos(bend)
        # Where it is without deviations.
        c, s = np.cos(bend) * cosine, np.broadcast_to(sine, out.shape)
        size = np.hypot(c, s)
        c, s = c / size, s / size
        constant = (np.sin(lean_driven) * along - np.sin(skew)) / np.cos(lean_driven)
        for _ in range(20):
            residual = c * normal - s * out + constant
            step = residual / (c * out + s * normal)
            c, s = c - step * s, s + step * c
            size = np.sqrt(1.0 + step * step)
            c, s = c / size, s / size
            # Each step leaves about the square of it.
            if np.max(np.abs(step)) ** 2 < 0.01 * precision.eps:
                break
        yield Pins((cosine, sine), (c, s))
        cosine, sine = c, s


def error_of(pins: Iterable[Pins]) -> Any:  # noqa: ANN401
    """Return the sum of the joints' angle errors with its mean."""
    return sum(
        np.arctan2(s * cosine - c * sine, c * cosine + s * sine)
        for (cosine, sine), (c, s) in ((own.driving, own.driven) for own in pins)
    )


def drawn_as_built(random: np.random.Generator, rows: int) -> Case:
    """Return drivelines and the deviations of their joints, to 1.7 deg."""
    case = drawn(random, rows)
    return {**case, "deviations": random.uniform(-0.03, 0.03, (*case["bends"].shape, 3))}


def as_built_harmonics(case: Case) -> tuple[Doubles, int]:
    """Orders of the angle error of drivelines of joints as built."""
    line = Driveline.from_bends(case["bends"], case["twists"], case["phases"])
    line = line.with_deviations(*np.moveaxis(case["deviations"], -1, 0))
    found = line.harmonics(ORDERS, outputs="angle_error")
    exact = orders_of(error_of(turned_pins(**case)))
    off = np.abs(found.complex_amplitude["angle_error"] - exact)
    bound = found.error["angle_error"] + 1e-15
    return np.asarray(np.max(off, axis=-1) / bound), exact.size


def drawn_loads(random: np.random.Generator, rows: int) -> Case:
    """Return drivelines, half of them of joints as built, and one load of all."""
    case = drawn_as_built(random, rows)
    case["deviations"] *= random.integers(0, 2)
    shafts = case["bends"].shape[-1] + 1
    load = {
        "given at the output": random.integers(0, 2, 1).astype(np.float64),
        "torque": random.uniform(-2.0, 2.0, 1),
        "speed": random.uniform(0.0, 2.0, 1),
        "acceleration": random.uniform(-2.0, 2.0, 1),
        "inertias": random.uniform(0.0, 0.2, (1, shafts)) * random.integers(0, 2, (1, shafts)),
    }
    return {**case, **load}


def load_harmonics(case: Case) -> tuple[Doubles, int]:
    """Orders of torques, moments and support moments."""
    (at_output, torque, speed, acceleration) = (
        float(case[name][0]) for name in ("given at the output", "torque", "speed", "acceleration")
    )
    given = {"output_torque" if at_output else "drive_torque": torque}
    load = Load(**given, speed=speed, acceleration=acceleration, inertias=case["inertias"][0])
    line = Driveline.from_bends(case["bends"], case["twists"], case["phases"])
    if np.any(case["deviations"]):
        line = line.with_deviations(*np.moveaxis(case["deviations"], -1, 0))
    exact = loads_of(line, load)
    found = line.plan(tuple(exact), shafts=slice(None), load=load).harmonics(ORDERS)
    worst: Doubles = np.zeros(len(case["bends"]))
    count = 0
    for name, samples in exact.items():
        off = np.abs(found.complex_amplitude[name] - orders_of(samples))
        mean = np.abs(found.mean[name] - np.mean(samples, axis=-1))
        # The model has errors of its own where nothing is left.
        each = np.maximum(np.max(off, axis=-1), mean) / (found.error[name] + 1e-18)
        # Rows follow the items.
        each = np.max(np.moveaxis(each, 1, 0).reshape(len(worst), -1), axis=-1)
        worst = np.maximum(worst, each.astype(np.float64))
        count += off.size + mean.size
    return worst, count


def loads_of(line: Driveline, load: Load) -> dict[str, Any]:
    """Return the loads of each item at samples of a turn, from vectors of pins and shafts.

    Only a moment that is normal to both pins passes a cross, and power is kept.
    """
    bends, twists, phases, deviations = (
        np.asarray(x, np.longdouble)
        for x in (line.bends, line.twists, line.phases, line.deviations)
    )
    # Vectors before the samples.
    u, m = (
        np.asarray(x[..., 0, :, np.newaxis], np.longdouble) for x in (line.directions, line.normals)
    )
    directions, moments, ratios = [u], [], [np.ones((len(bends), SAMPLES), np.longdouble)]
    for j, pins in enumerate(turned_pins(bends, twists, phases, deviations)):
        if j > 0:
            turn = twists[:, j - 1, np.newaxis, np.newaxis]
            m = np.cos(turn) * m + np.sin(turn) * np.cross(u, m, axis=1)
        bend, lean, lean_driven = (
            x[:, np.newaxis, np.newaxis]
            for x in (bends[:, j], deviations[:, j, 0], deviations[:, j, 2])
        )
        (c, s), (c_driven, s_driven) = (
            (x[:, np.newaxis] if x.ndim > 1 else x for x in pin)
            for pin in (pins.driving, pins.driven)
        )
        e = np.cross(m, u, axis=1)
        behind, across = np.cos(bend) * u + np.sin(bend) * e, np.cos(bend) * e - np.sin(bend) * u
        driving = np.sin(lean) * u + np.cos(lean) * (c * e + s * m)
        driven = np.sin(lean_driven) * behind + np.cos(lean_driven) * (
            c_driven * m - s_driven * across
        )
        moment = np.cross(driving, driven, axis=1)
        before, after = (np.sum(moment * shaft, axis=1) for shaft in (u, behind))
        # Of a torsion of 1 in the driving shaft.
        moments.append(moment / before[:, np.newaxis])
        ratios.append(ratios[-1] * before / after)
        u = behind
        directions.append(u)
    torques = torques_of(ratios, load)
    moments = [
        moment * (torque * ratio / before)[:, np.newaxis]
        for moment, torque, ratio, before in zip(
            moments, torques[1:], ratios[1:], ratios, strict=False
        )
    ]
    supports = []
    for shaft, before, after in zip(directions, [0.0, *moments], [*moments, 0.0], strict=True):
        both = after - before
        supports.append(both - np.sum(both * shaft, axis=1, keepdims=True) * shaft)
    return {
        "torque": np.array(torques),
        "moment": np.array(moments),
        "support_moment": np.array(supports),
    }


def torques_of(ratios: list[Any], load: Load) -> list[Any]:
    """Return the torque of each shaft: the power into it, which the inertias take, by its speed."""
    assert load.inertias is not None
    # Before NumPy 2 an array of doubles times a long double has doubles.
    orders = np.fft.fftfreq(SAMPLES, 1.0 / SAMPLES).astype(np.longdouble)
    steps = 2 * PI * (np.outer(orders, np.arange(SAMPLES)) % SAMPLES) / SAMPLES
    waves = np.exp(1j * steps)
    derivative = ((np.conj(waves.T) * (1j * orders)) @ waves).real / SAMPLES
    taken = [
        inertia * (load.speed**2 * (ratio @ derivative) + load.acceleration * ratio) * ratio
        for inertia, ratio in zip(load.inertias, ratios, strict=True)
    ]
    if load.end == "drive":
        powers = np.cumsum([load.torque * ratios[0], *(-own for own in taken[:-1])], axis=0)
    else:
        powers = np.cumsum([load.torque * ratios[-1], *taken[::-1]], axis=0)[:0:-1]
    return [power / ratio for power, ratio in zip(powers, ratios, strict=True)]


def drawn_tolerances(random: np.random.Generator, rows: int) -> Case:
    """Return one driveline, its tolerances, and deviations in units of them, half at corners."""
    case = drawn(random, 1)
    size = 10.0 ** random.uniform(-4.0, -1.5)
    tolerances = {
        f"tolerance of {name}": size * random.uniform(0.1, most, case[name].shape)
        for name, most in (("bends", 1.0), ("phases", 3.0))
    }
    parameters = case["bends"].size + case["phases"].size
    shares = random.uniform(-1.0, 1.0, (200 * rows, parameters))
    shares[::2] = np.sign(shares[::2])
    return {**case, **tolerances, "shares": shares}


def tolerances(case: Case) -> tuple[Doubles, int]:
    """Figures of tolerances: no driveline exceeds the worst, which one has, nor any the bound."""
    bends, twists, phases = (case[name][0] for name in ("bends", "twists", "phases"))
    given = {name: case[f"tolerance of {name}"][0] for name in ("bends", "phases")}
    line = Driveline.from_bends(bends, twists, phases)
    # A driveline of one joint has no phases.
    found = line.tolerances(**{name: half for name, half in given.items() if half.size})
    own, between = np.split(case["shares"], [bends.size], axis=-1)
    # A bend that changes its sign is a bend to the other side.
    q = q_of(bends + own * given["bends"], twists, phases + between * given["phases"])
    at = found.worst_at
    reached = np.abs(q_of(bends + at["bends"], twists, phases + at.get("phases", 0.0)))
    worst, guaranteed = (
        np.tan(np.longdouble(bend) / 2) ** 2 for bend in (found.worst, found.guaranteed)
    )
    beyond = np.maximum(reached - guaranteed, np.abs(reached - worst))
    each = np.maximum(np.abs(q) - worst, beyond) / np.sum(np.tan((bends + given["bends"]) / 2) ** 2)
    return each.astype(np.float64), len(each)


def drawn_order_tolerances(random: np.random.Generator, rows: int) -> Case:
    """Return one driveline, the tolerances of its deviations, and an order."""
    del rows
    case = drawn(random, 1)
    halves = random.uniform(1e-4, 1e-2, (*case["bends"].shape, 3))
    return {**case, "halves": halves, "order": random.integers(1, 5, 1).astype(np.float64)}


def order_tolerances(case: Case) -> tuple[Doubles, int]:
    """Contributions of deviations to an order, against differences of joints as built."""
    bends, twists, phases = (case[name][0] for name in ("bends", "twists", "phases"))
    halves, order = case["halves"][0], int(case["order"][0])
    line = Driveline.from_bends(bends, twists, phases)
    found = line.order_tolerances(*halves.T, order=order)
    # Four steps of each deviation, the worst deviations, and these with one to the other side.
    units = np.eye(halves.size).reshape(-1, *halves.shape)
    steps = 1e-3 * np.concatenate([units, -units, 2.0 * units, -2.0 * units])
    at = found.worst_deviations
    all_of_them = np.concatenate([steps, at[np.newaxis], at * (1.0 - 2.0 * units)])
    count = len(all_of_them)
    bends, twists, phases = (np.tile(x, (count, 1)) for x in (bends, twists, phases))
    errors = error_of(turned_pins(bends, twists, phases, all_of_them))
    amplitudes = orders_of(errors)[:, order - 1]
    near, opposite, far, beyond = np.split(amplitudes[: len(steps)], 4)
    at_worst, *others = np.abs(amplitudes[len(steps) :]) - found.worst
    slope = ((8.0 * (near - opposite) - (far - beyond)) / 12e-3).reshape(halves.shape)
    off = np.abs(found.contributions - slope * halves)
    worst = np.max([np.max(off), abs(at_worst), *others])
    return np.array([worst]), 2 * off.size + 1


LOADS = ("torque", "moment", "support_moment", "bending_driving", "bending_driven", "pin_moment")


def drawn_steep(random: np.random.Generator, rows: int) -> Case:
    """Return chains whose cosines multiply to as little as 1e-13, beside zeros, and their loads."""
    # The exact model takes milliseconds for each.
    rows = rows // 20 + 1
    n = int(random.integers(2, 5))
    bends = random.uniform(0.0, 1.0, (rows, n))
    share = random.dirichlet(np.ones(n), rows) * random.integers(0, 2, (rows, n))
    steep = 10.0 ** (random.uniform(-12.0, 0.0, (rows, 1)) * share)
    bends = np.where(share > 0.0, np.arccos(steep * np.cos(bends)), bends)
    twists, phases = random.uniform(-np.pi, np.pi, (2, rows, n - 1))
    crossed = random.random((rows, 1)) < 0.2
    twists = np.where(crossed, np.pi * random.integers(0, 2, (rows, n - 1)), twists)
    phases = np.where(crossed, np.pi / 2 * random.integers(0, 2, (rows, n - 1)), phases)
    # Where a shaft is fastest or slowest its acceleration is zero, and moments nearly are.
    lines = Driveline.from_bends(bends, twists, phases)
    before = np.asarray(lines.equivalent(int(random.integers(1, n + 1))).angle_offset)
    fastest = np.pi / 2 * np.arange(-1.0, 3.0) - before[:, np.newaxis]
    aside = np.prod(np.cos(bends), axis=-1)[:, np.newaxis] * random.normal(size=(rows, 4))
    aside *= 10.0 ** random.uniform(-2.0, 6.0, (rows, 4))
    angles = np.concatenate([fastest, fastest + aside, random.uniform(-4.0, 4.0, (rows, 2))], -1)
    kind = random.integers(0, 4, (rows, 1))
    heavy = random.uniform(0.0, 0.1, (rows, n + 1)) * (kind > 1)
    # A flywheel alone, which only an acceleration of its shaft loads.
    heavy = np.where((kind == 3) & (np.arange(n + 1) < n), 0.0, heavy)
    return {
        "bends": bends,
        "twists": twists,
        "phases": phases,
        "angles": angles,
        "given at the output": (kind != 0).astype(np.float64),
        "torque": random.uniform(-9.0, 9.0, (rows, 1)) * (kind < 3),
        "speed": random.uniform(1.0, 5.0, (rows, 1)),
        "acceleration": random.uniform(-3.0, 3.0, (rows, 1)) * (kind < 3),
        "inertias": heavy,
    }


def steep_loads(case: Case) -> tuple[Doubles, int]:
    """Loads with ``tolerance=0``, in ulp of the exact ones."""
    worst, results = [], 0
    for row in range(len(case["bends"])):
        own = {name: array[row].tolist() for name, array in case.items()}
        end = "output_torque" if own["given at the output"][0] else "drive_torque"
        load: dict[str, Any] = {end: own["torque"][0], "inertias": own["inertias"]}
        load |= {name: own[name][0] for name in ("speed", "acceleration")}
        line = Driveline.from_bends(own["bends"], own["twists"], own["phases"])
        found = line.evaluate(
            own["angles"], LOADS, shafts=slice(None), load=Load(**load), tolerance=0
        )
        with mp.workdps(120):
            off = load_errors(line, found, map(ExactTurn.by, own["angles"]), load)
        worst.append(np.max(off))
        results += off.size
    return np.array(worst), results


SURFACES = {
    "harmonics": Surface(drawn, harmonics),
    "harmonics as built": Surface(drawn_as_built, as_built_harmonics),
    "harmonics of loads": Surface(drawn_loads, load_harmonics),
    "tolerances": Surface(drawn_tolerances, tolerances),
    "order tolerances": Surface(drawn_order_tolerances, order_tolerances),
    "loads of steep chains": Surface(drawn_steep, steep_loads),
}


def stress(
    rows: int, rounds: int, seed: int, surfaces: dict[str, Surface] = SURFACES
) -> dict[str, Found]:
    """Return what a run finds of each surface."""
    found = {}
    for name, surface in surfaces.items():
        random = np.random.default_rng([seed, len(name)])
        results, worst, kept = 0, -1.0, Case()
        for _ in range(rounds):
            case = surface.draw(random, rows)
            off, count = surface.judge(case)
            # What is not a number is as wrong as can be.
            off = np.where(np.isnan(off), np.inf, off)
            results += count
            row = int(np.argmax(off))
            if off[row] > worst:
                worst = float(off[row])
                kept = {key: x[[row]] if len(x) > 1 else x for key, x in case.items()}
        found[name] = Found(results, worst, kept)
    return found


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rows", type=int, default=200, help="drivelines of a round")
    parser.add_argument("--rounds", type=int, default=10, help="rounds of each surface")
    parser.add_argument("--seed", type=int, default=1, help="another run")
    parser.add_argument("--only", choices=SURFACES, help="one surface")
    parser.add_argument("--worst", type=Path, help="write the worst cases, as JSON")
    options = parser.parse_args()
    surfaces = {options.only: SURFACES[options.only]} if options.only else SURFACES
    found = stress(options.rows, options.rounds, options.seed, surfaces)
    for name, own in found.items():
        print(f"{name:20} {own.worst:.2e} of {LIMITS[name]:g} in {own.results} results")
    if options.worst:
        cases = [
            {"surface": name, "off": own.worst}
            | {key: array.tolist() for key, array in own.case.items()}
            for name, own in found.items()
        ]
        rows = ",\n  ".join(map(json.dumps, cases))
        options.worst.write_text(f'{{"cases": [\n  {rows}\n]}}\n', encoding="utf-8")
    return 0 if all(own.worst <= LIMITS[name] for name, own in found.items()) else 1


if __name__ == "__main__":
    sys.exit(main())

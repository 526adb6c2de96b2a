"""Every capability of the core has a slow twin in the reference, and agrees with it.

Capabilities are the outputs, the functions of the package, and the public names of its classes that
compute. A twin is named by its place in `cardan.reference`. What has none is no capability of the
core: the sentence in its place says what it is.
"""

from __future__ import annotations

import importlib
import math
from dataclasses import dataclass, fields, replace
from itertools import pairwise
from typing import Any, Literal

import numpy as np
import pytest

import cardan
from cardan import OUTPUTS, Driveline, Load, Sweep, reference
from cardan.app.answers.turn.extremes import peak
from cardan.reference import design, evaluation, torsion
from cardan.reference.forces import Forces
from cardan.wear.axial_travel import SlideName

CLASSES = (
    "Driveline",
    "Machine",
    "Transmission",
    "Plan",
    "TorsionalSystem",
    "LateralSystem",
    "BallJoint",
)

# The other public names of the package: they state, choose or carry results of those above.
CARRIERS = (
    "ActiveLimit Answer ArgumentError ArgumentTypeError ArgumentValueError Check Coupling "
    "Derivatives ElasticBearing EquivalentJoint Finding FreeRunning Gradient Harmonics "
    "Identification Lengths Life Limit Limits Load Losses Motion Optimum OrderTolerances Output "
    "PointMass Result RigidShaft Scene Slides SplineForce Steering Tolerances TorqueHarmonic Tube "
    "TwoJoints Unbalance OUTPUTS"
)

SHAPE = "it selects, arranges or labels and computes nothing"
UNIT = "another unit of what has a twin"
SEARCH = "it searches or samples in Python above outputs that have twins"
CONTACT = "contact in Python beside the core; tests judge it by integrals over the surface"
SOURCES = "formulas of the sources, themselves compared with the core"

TWINS = {
    "cardan": {
        "approximations": SOURCES,
        "firing_harmonics": "the sum over cylinders, which tests form cylinder by cylinder",
        "identify identify_two_joints optimise": SEARCH,
        "plots": "pictures of what is computed elsewhere",
        "reference": "the twins themselves",
        "tube": "design.tube",
        "Sweep": "evaluation.sweep",
        "workshop": "words of the workshop for phases, which have a twin",
    },
    "Driveline": {
        "from_bends": "vectors.from_bends",
        "from_directions": "vectors.from_directions",
        "from_points": "vectors.from_points",
        "from_slopes": "design.from_slopes",
        "from_readings": "design.from_readings",
        "from_projected_bends": "design.from_projected_bends",
        "wound_up": "design.under_torque",
        "from_double_joint": "design.from_double_joint",
        "reversed": "design.turned_round",
        "bends": "vectors.Shafts.bends",
        "twists": "vectors.Shafts.twists",
        "directions normals phases with_phases": "vectors.Shafts",
        "deviations has_deviations with_deviations": "vectors.Shafts",
        "bends_deg twists_deg phases_deg deviations_deg": UNIT,
        "evaluate": "evaluation.outputs",
        "equivalent": "phasing.equivalent",
        "transmission": "phasing.transmission",
        "optimal_phases": "phasing.optimal_phases",
        "harmonics": "evaluation.harmonics",
        "losses": "wear.losses",
        "life": "wear.life",
        "free_running": "wear.free_running",
        "lengths": "design.lengths",
        "spline_force": "design.spline",
        "slides": "design.slides",
        "steering": "design.steering",
        "check": "design.excitations",
        "with_play": "design.with_skews",
        "lash": "design.lash",
        "wind_up": "design.wind_up",
        "catalogue_bend fork_signs": SOURCES,
        "arrangement": SHAPE,
        "bend_ranges": SEARCH,
        "order_tolerances tolerances": SEARCH,
        "plot approx_equal bearings concatenate has_points n_bearings n_joints ndim plan reshape "
        "shape size with_bearings": SHAPE,
    },
    "Transmission": {
        "q abs2": "phasing.Transmission",
        "motion": "phasing.Transmission.motion",
        "gradient": "phasing.Transmission.gradient",
        "dq d_abs2": "phasing.dq",
        "d_bend": "it refuses",
    },
    "Plan": {
        "derivatives gradient": "evaluation.slopes",
        "harmonics": "evaluation.harmonics",
        "dtype explain labels line places planes request": SHAPE,
    },
    "TorsionalSystem": {
        "compliant": "torsion.System.compliant",
        "natural_frequencies critical_speeds": "torsion.natural_frequencies",
        "steady orbit stability coexisting": "torsion.orbit",
        "transient": "torsion.transient",
        "modes bend_rules unstable_ranges stability_map side_by_side speed_response": SEARCH,
        "running_speeds": SEARCH,
        "period_turns": "torsion.System.period_turns",
        "changed couplings dampings drive drive_slope free harmonics inertias line load_damping "
        "load_torque shape stiffness_follows_speed stiffnesses": SHAPE,
    },
    "LateralSystem": {
        "natural_frequencies modes": "lateral.System.natural_frequencies",
        "response": "lateral.System.response",
        "torque_stiffness": "lateral.System.torque_stiffness",
        "is_stable largest_stable_torque": "lateral.System.is_stable",
        "resonances": SEARCH,
        "bearings lengths line masses shafts shape sliding unbalance": SHAPE,
    },
    "Machine": {
        "figures verdict": "design.ranked",
        "suggest": "design.smallest_change",
        "to_dict with_duty with_friction with_play with_ratings": SHAPE,
        "with_spline with_steering with_tubes": SHAPE,
    },
    "BallJoint": {
        "allowable_load approach contact_angle friction_moment peak_pressure pressure pressure_at "
        "sized_for tilting_friction_moment with_clearance": CONTACT,
        "shape": SHAPE,
    },
}


def names_of(owner: str) -> list[str]:
    if owner == "cardan":
        return sorted({*vars(cardan)["__all__"]} - {*CARRIERS.split(), *CLASSES, "__version__"})
    return [name for name in dir(getattr(cardan, owner)) if not name.startswith("_")]


def test_the_table_has_all_classes() -> None:
    assert set(TWINS) == {"cardan", *CLASSES}


def test_every_output_has_a_twin() -> None:
    records = (reference.ShaftMotion, reference.Loads, reference.Cross, Forces)
    twins = {field.name for record in records for field in fields(record)}
    # `reference.tilts` returns both.
    assert twins | {"tilt_driving", "tilt_driven"} == set(cardan.OUTPUTS)


@pytest.mark.parametrize("owner", TWINS)
def test_every_capability_has_a_twin_or_a_reason(owner: str) -> None:
    listed = [name for names in TWINS[owner] for name in names.split()]
    assert sorted(listed) == sorted(names_of(owner))


@pytest.mark.parametrize(
    "twin", sorted({t for own in TWINS.values() for t in own.values() if " " not in t})
)
def test_every_twin_exists(twin: str) -> None:
    module, *path = twin.split(".")
    found: object = importlib.import_module(f"cardan.reference.{module}")
    for name in path:
        found = getattr(found, name)
    assert callable(found) or isinstance(found, property)


# --- drivelines ----------------------------------------------------------------------------------


@dataclass(frozen=True)
class Case:
    """A driveline twice, with two bearings in shaft 0 and one in every other shaft.

    Attributes:
        line: the library's.
        shafts: the reference's.
        load: with inertias.
        steepness: by which rounding grows: 1 over the product of the cosines of the bends.
    """

    line: Driveline
    shafts: reference.Shafts
    load: dict[str, Any]
    steepness: float

    @property
    def mounting(self) -> tuple[list[float], list[tuple[int, float]]]:
        """Lengths and bearings as the reference takes them."""
        lengths = self.line.lengths().each.tolist()
        return lengths, [(shaft, float(at)) for shaft, at in self.line.bearings]

    def outputs(self, angle: float, **options: Any) -> dict[str, Any]:  # noqa: ANN401
        return evaluation.outputs(self.shafts, angle, self.load, *self.mounting, **options)

    @property
    def names(self) -> list[str]:
        """The outputs, of which joints as built have not all."""
        only_ideal = ("pin", "swing") if self.line.has_deviations else ("none",)
        return [name for name in OUTPUTS if not any(word in name for word in only_ideal)]


def case_of(bends: list[float], deviation: float = 0.0) -> Case:
    """Lay out a random driveline with these bends."""
    n, rng = len(bends), np.random.default_rng([len(bends), int(1e3 * bends[0])])
    twists, phases = rng.uniform(-3.0, 3.0, (2, n - 1)).tolist()
    deviations = rng.uniform(-deviation, deviation, (n, 3))
    bearings = [(0, 0.2), (0, 0.7), *((shaft, 0.4) for shaft in range(1, n + 1))]
    line = Driveline.from_bends(bends, twists, phases).with_deviations(*deviations.T)
    shafts = reference.from_bends(bends, twists, phases)
    if deviation:
        shafts = replace(shafts, deviations=tuple(map(tuple, deviations.tolist())))
    load = {"output_torque": 3.0, "speed": 5.0, "acceleration": 2.0}
    inertias = rng.uniform(0.05, 0.2, n + 1).tolist()
    return Case(
        line.with_bearings(bearings, np.linspace(1.0, 1.5, n + 1)),
        shafts,
        load | {"inertias": inertias},
        1.0 / math.prod(map(math.cos, bends)),
    )


CASES = {
    "one": case_of([0.5]),
    "three": case_of([0.3, 0.45, 0.2]),
    "steep": case_of([0.35, 1.45]),
    "steeper": case_of([1.55]),
    "as built": case_of([0.4, 0.6], 0.05),
    "steep as built": case_of([1.35, 0.2], 0.02),
}

each = pytest.mark.parametrize("case", CASES.values(), ids=CASES)
moderate = pytest.mark.parametrize(
    "case", [CASES["three"], CASES["as built"]], ids=["ideal", "as built"]
)


def same(found: Any, known: Any, close: float, message: str = "") -> None:  # noqa: ANN401
    """Compare numbers by the largest of them, or by 1 if all are smaller."""
    size = max(1.0, float(np.max(np.abs(known), initial=0.0)))
    np.testing.assert_allclose(found, known, rtol=0.0, atol=close * size, err_msg=message)


# --- evaluation ----------------------------------------------------------------------------------


@each
def test_every_output(case: Case) -> None:
    axes: tuple[Literal["space", "shaft"], ...] = ("space", "shaft")
    for way in axes[: 1 if case.line.has_deviations else 2]:
        names = [name for name in case.names if way == "space" or not name.endswith("_pin")]
        for angle in (0.7, -2.9):
            load = Load(**case.load)
            found = case.line.evaluate(angle, names, shafts=slice(None), load=load, axes=way)
            known = case.outputs(angle, axes=way)
            for name in names:
                same(found[name], known[name], 2e-15 * case.steepness**2, f"{name} {way}")


@moderate
def test_sweeps_and_reductions(case: Case) -> None:
    turn = Sweep(-1.0, 5.5, 14)
    angles = evaluation.sweep(-1.0, 5.5, 14)
    assert np.asarray(turn).tolist() == angles
    same(np.asarray(Sweep.revolutions(1, 6)), evaluation.sweep(0.0, math.tau, 7)[:-1], 1e-15)
    options: dict[str, Any] = {"shafts": slice(None), "load": Load(**case.load)}
    samples = [case.outputs(angle) for angle in angles]
    ways: tuple[Literal["min", "max", "mean", "rms", "peak"], ...]
    ways = ("min", "max", "mean", "rms", "peak")
    found = [case.line.evaluate(turn, case.names, reduce=way, **options) for way in ways]
    for name in case.names:
        vector = OUTPUTS[name].vector
        values = np.stack([sample[name] for sample in samples], axis=1)
        for way, got in zip(ways, found, strict=True):
            same(got[name], evaluation.reduced(values, way, vector=vector), 1e-13, f"{name} {way}")


def test_the_drive_angle_of_a_driven_angle() -> None:
    case = CASES["three"]
    for driven in (0.4, 7.0):
        at = evaluation.drive_angle(case.shafts, driven)
        found = case.line.plan("speed_ratio", angle_of="driven")(driven).speed_ratio
        same(found, case.outputs(at)["speed_ratio"][-1], 1e-13)


def blocks(outputs: dict[str, Any], names: list[str]) -> tuple[Any, dict[str, slice]]:
    """Join outputs to one array, and say where each of them is."""
    ends = np.cumsum([0, *(np.size(outputs[name]) for name in names)]).tolist()
    joined = np.concatenate([np.ravel(outputs[name]) for name in names])
    return joined, {name: slice(*pair) for name, pair in zip(names, pairwise(ends), strict=True)}


@moderate
def test_orders(case: Case) -> None:
    """Of the smooth outputs; kinks of magnitudes make a sum over steps converge slowly."""
    kinked = ("angle", "pin_moment", "bending_driving", "bending_driven")
    names, orders = [name for name in case.names if name not in kinked], [1, 2, 4]
    plan = case.line.plan(names, shafts=slice(None), load=Load(**case.load))
    found, (_, places) = plan.harmonics(orders), blocks(case.outputs(0.0), names)
    mean, *known = evaluation.harmonics(
        lambda angle: blocks(case.outputs(angle), names)[0], [0, *orders], steps=96
    )
    for name, place in places.items():
        same(np.ravel(found.mean[name]), mean[place].real, 1e-12, name)
        for k, amplitudes in enumerate(known):
            got = np.ravel(found.complex_amplitude[name][..., k])
            same(got, amplitudes[place], 1e-12, f"{name}, order {orders[k]}")


PEAKS = [
    ("one", "joint_force", 0),
    ("three", "bearing_force", 1),
    ("three", "moment", 1),
    ("three", "bending_driven", 2),
    ("steep", "torque", 0),
    ("steep", "tilt_driving", 1),
    ("as built", "bearing_force", 2),
]


@pytest.mark.parametrize(("name", "output", "item"), PEAKS)
def test_peaks(name: str, output: str, item: int) -> None:
    case = CASES[name]

    def size(angle: float) -> float:
        return float(np.linalg.norm(case.outputs(angle)[output][item]))

    period = math.tau if case.line.has_deviations else math.pi
    place, value = evaluation.largest(size, period, steps=120)
    found = peak(case.line, output, item, Load(**case.load))
    same(found.value, value, 1e-12)
    nearest = min(abs(math.remainder(place - at, period)) for at in found.places)
    assert nearest < 1e-6


@pytest.mark.parametrize("name", ["three", "steep", "as built"])
def test_derivatives_by_everything(name: str) -> None:
    case, angle = CASES[name], 0.6
    line, n = case.line, case.line.n_joints
    lengths, bearings = case.mounting
    given: dict[str, Any] = {
        "angle": [angle],
        "bends": line.bends,
        "twists": line.twists,
        "phases": line.phases,
        "output_torque": [case.load["output_torque"]],
        "inertias": case.load["inertias"],
        "lengths": lengths,
        "positions": [at for _, at in bearings],
        "deviations": line.deviations,
    }
    sizes = {by: np.size(value) for by, value in given.items()}
    flat = np.concatenate([np.ravel(value) for value in given.values()]).tolist()

    def outputs(numbers: list[float]) -> dict[str, Any]:
        parts = np.split(np.array(numbers), np.cumsum([*sizes.values()])[:-1])
        own = {by: part.tolist() for by, part in zip(sizes, parts, strict=True)}
        laid_out = reference.from_bends(own["bends"], own["twists"], own["phases"])
        triples = np.reshape(own["deviations"], (n, 3)).tolist()
        if case.shafts.deviations:
            laid_out = replace(laid_out, deviations=tuple(map(tuple, triples)))
        load = case.load | {"output_torque": own["output_torque"][0], "inertias": own["inertias"]}
        places = [(shaft, at) for (shaft, _), at in zip(bearings, own["positions"], strict=True)]
        return evaluation.outputs(laid_out, own["angle"][0], load, own["lengths"], places)

    # A part of what is left to 90 degrees, where the outputs change their size.
    step = 1e-3 / case.steepness
    known = np.stack(
        evaluation.slopes(lambda x: blocks(outputs(x), case.names)[0], flat, step=step), axis=-1
    )
    ends = np.cumsum([0, *sizes.values()]).tolist()
    columns = {by: slice(*pair) for by, pair in zip(sizes, pairwise(ends), strict=True)}
    if not case.shafts.deviations:
        columns.pop("deviations")
    plan = line.plan(case.names, shafts=slice(None), load=Load(**case.load))
    found = plan.derivatives(angle, by=[*columns])
    _, rows = blocks(case.outputs(angle), case.names)
    close = 1e-9 * case.steepness**3
    for by, column in columns.items():
        for name, row in rows.items():
            got = np.reshape(found[name][by], (row.stop - row.start, -1))
            same(got, known[row, column], close, f"{name} by {by}")
    shapes = {name: np.shape(values) for name, values in plan(angle).items()}
    weights = {name: np.cos(np.arange(math.prod(x))).reshape(x) for name, x in shapes.items()}
    gradient = plan.gradient(angle, weights)
    weighted = blocks(weights, case.names)[0] @ known
    for by in columns.keys() - {"angle"}:
        same(np.ravel(getattr(gradient, by)), weighted[columns[by]], close, by)


POINTS = [[0.0, 0.0, 0.0], [0.5, 0.05, 0.0], [1.6, 0.2, 0.3], [2.2, 0.0, 0.2], [2.9, -0.3, 0.5]]


def test_derivatives_by_points() -> None:
    angle, phases, names = -0.4, [0.3, -0.8], ["angle_error", "jerk_ratio", "moment"]
    found = Driveline.from_points(POINTS, phases).plan(names, load=Load(drive_torque=2.0))

    def values(numbers: list[float]) -> Any:  # noqa: ANN401
        shafts = reference.from_points(np.reshape(numbers, (-1, 3)).tolist(), phases)
        known = evaluation.outputs(shafts, angle, {"drive_torque": 2.0})
        motion = [known["angle_error"][-1], known["jerk_ratio"][-1]]
        return np.concatenate([motion, *known["moment"]])

    known = np.stack(evaluation.slopes(values, np.ravel(POINTS).tolist(), step=2e-4), axis=-1)
    by_points = found.derivatives(angle, by="points")
    got = np.concatenate([np.reshape(by_points[name]["points"], (-1, 15)) for name in names])
    same(got, known, 1e-9)


# --- design --------------------------------------------------------------------------------------


def same_layout(line: Driveline, shafts: reference.Shafts) -> None:
    np.testing.assert_allclose(line.directions, shafts.directions, rtol=0.0, atol=1e-15)
    np.testing.assert_allclose(line.normals, shafts.normals, rtol=0.0, atol=1e-14)
    np.testing.assert_allclose(line.phases, shafts.phases, rtol=0.0, atol=1e-15)


def test_layouts() -> None:
    rng = np.random.default_rng(5)
    up, right = rng.uniform(-0.4, 0.4, (2, 4)).tolist()
    phases = [0.3, -0.8]
    line = Driveline.from_slopes(up, right, phases)
    same_layout(line, design.from_slopes(up, right, phases))
    same_layout(line.reversed(), design.turned_round(design.from_slopes(up, right, phases)))
    lengths, offsets = rng.uniform(0.5, 1.5, 4).tolist(), rng.uniform(-0.2, 0.2, 5).tolist()
    line = Driveline.from_readings(up, lengths, offsets, phases)
    same_layout(line, design.from_readings(up, lengths, offsets, phases))
    same(line.lengths().each, lengths, 1e-15)
    line = Driveline.from_readings(up, phases=phases)
    same_layout(line, design.from_readings(up, lengths, [0.0] * 5, phases))
    ways: tuple[Literal["input", "common", "output"], ...] = ("input", "common", "output")
    for level, way in enumerate(ways):
        line = Driveline.from_projected_bends(up[:2], right[:2], 0.3, reference=way)
        same_layout(line, design.from_projected_bends(up[:2], right[:2], [0.3], level=level))
    for total, pivot in ((0.9, 0.033), (1.9, 0.025)):
        found = Driveline.from_double_joint(total, 0.06, pivot).bends
        same(found, design.from_double_joint(total, 0.06, pivot).bends, 1e-14)
    same(Driveline.from_points(POINTS).lengths().each, design.lengths(POINTS), 1e-15)


@pytest.mark.parametrize("seed", range(3))
def test_steering_and_excitations(seed: int) -> None:
    rng = np.random.default_rng(seed)
    n = 1 + seed
    bends, between = rng.uniform(0.1, 0.6, n), rng.uniform(-3.0, 3.0, (2, n - 1))
    line = Driveline.from_bends(bends, *between)
    shafts = reference.from_bends(bends.tolist(), *between.tolist())
    centre = float(rng.uniform(-4.0, 4.0))
    found = line.steering(centre)
    ratio, slope, *turns = design.steering(shafts, centre)
    assert found.ratio == pytest.approx(ratio, rel=1e-13)
    assert found.slope == pytest.approx(slope, abs=1e-10)
    assert found.difference == pytest.approx(design.left_and_right(shafts, centre), rel=1e-11)
    # Where a ratio is largest it is flat, which leaves half of the digits.
    for got, turn in zip((found.turn_to_quick, found.turn_to_slow), turns, strict=True):
        assert abs(math.remainder(float(got) - turn, math.pi)) < 1e-6
    _, quick = evaluation.largest(lambda a: reference.motion(shafts, a, offset=0.0).speed_ratio)
    values = {f.figure: float(f.value) for f in line.check(1.0).findings}
    bend = math.degrees(math.acos(1.0 / quick))
    assert values.pop("equivalent_bend") == pytest.approx(bend, rel=1e-11)
    assert [*values.values()] == pytest.approx(design.excitations(shafts)[: len(values)], rel=1e-11)


@pytest.mark.parametrize("shaft", range(4))
def test_splines(shaft: int) -> None:
    bearings = [(own, at) for own in {shaft - 1, shaft + 1} & {0, 1, 2, 3} for at in (0.1, 0.35)]
    line = Driveline.from_points(POINTS)
    found = line.with_bearings(bearings).spline_force(shaft, -400.0, 0.12, 0.02)
    known = design.spline(POINTS, shaft, 0.12 * 400.0 / 0.02, bearings)
    bare = design.spline(POINTS, shaft, 0.12 * 400.0 / 0.02)
    same(found.bearing_force, known[2], 1e-12)
    for upstream, downstream, _ in (known, bare):
        same(found.upstream, upstream, 1e-12)
        same(found.downstream, downstream, 1e-12)


@each
def test_slides(case: Case) -> None:
    line = case.line.with_deviations()
    shafts = replace(case.shafts, deviations=())
    offsets: dict[str, Any] = {"driving_pin": 0.7, "cross": -0.4, "driven_pin": 0.3, "shafts": 0.9}
    found, angle = line.slides(**offsets), 1.1
    known = design.slides(shafts, angle, [[*offsets.values()]] * line.n_joints)
    ways: list[SlideName] = ["driving_pin", "driven_pin", "shaft"]
    for way, of_way in zip(ways, np.transpose(known), strict=True):
        same(found.at(angle, way), of_way, 1e-14 * case.steepness, way)


@each
def test_lash_and_wind_up(case: Case) -> None:
    radial = 1e-3 * np.arange(1.0, case.line.n_joints + 1.0)
    play = (radial / 0.5).tolist()
    for angle in (0.8, 2.0):
        for shaft in range(1, case.line.n_joints + 1):
            found = case.line.lash(angle, radial, 0.5, shaft)
            same(found, design.lash(case.shafts, angle, play, shaft), 1e-14 * case.steepness)
    for sign, flank in zip((1.0, -1.0), case.line.with_play(radial, 0.5), strict=True):
        known = design.with_skews(case.shafts, [2.0 * sign * x for x in play]).deviations
        np.testing.assert_allclose(flank.deviations, known, rtol=0.0, atol=1e-17)
    if not case.line.has_deviations:
        stiffnesses = np.linspace(1e5, 3e5, case.line.n_joints)
        found = case.line.wind_up(2.0, Load(**case.load), stiffnesses)
        known_lag = design.wind_up(case.shafts, 2.0, stiffnesses.tolist(), case.load)
        assert found == pytest.approx(known_lag, rel=1e-9 * case.steepness)


@pytest.mark.parametrize(("outer", "wall", "length"), [(0.09, 0.003, 1.5), (0.05, 0.025, 0.9)])
def test_tubes(outer: float, wall: float, length: float) -> None:
    found = cardan.tube(outer, wall, length=length, rotary=True, loss_factor=0.01)
    known = design.tube(outer, wall, length, 7.93e10, 2.06e11, 7850.0)
    for name in ("stiffness", "inertia", "mass"):
        assert getattr(found, name) == pytest.approx(known[name], rel=1e-7), name
    assert found.critical_speed == pytest.approx(known["critical_speed"], rel=3e-6)
    assert found.shear_stress(1.0) == pytest.approx(known["shear_per_torque"], rel=1e-7)
    for name in ("bending_stiffness", "line_mass", "shear_stiffness", "rotary_inertia"):
        assert getattr(found, name) == pytest.approx(known[name], rel=1e-7), name
    assert found.loss_factor == 0.01


# --- torsion -------------------------------------------------------------------------------------


def systems(bends: list[float], **own: Any) -> tuple[cardan.TorsionalSystem, torsion.System]:  # noqa: ANN401
    """A torsional system twice."""
    twists, phases = [0.5, -0.3][: len(bends) - 1], [0.2, 0.7][: len(bends) - 1]
    line = Driveline.from_bends(bends, twists, phases)
    shafts = reference.from_bends(bends, twists, phases)
    fast = cardan.TorsionalSystem(line, drive="held", **own)
    return fast, torsion.System(shafts, **own)


ONE_SPRING: dict[str, Any] = {
    "inertias": [(0.01, 0.02), (0.01, 0.03), (0.05, 0.02)],
    "stiffnesses": [math.inf, 9000.0, math.inf],
    "dampings": [0.0, 2.5, 0.0],
    "load_torque": 40.0,
    "load_damping": 0.6,
}
TWO_SPRINGS: dict[str, Any] = {
    "inertias": [(0.0, 0.02), (0.01, 0.03), (0.0, 0.01), (0.05, 0.02)],
    "stiffnesses": [5000.0, math.inf, math.inf, 7000.0],
    "dampings": [1.5, 0.0, 0.0, 2.0],
    "load_torque": -30.0,
}
VIBRATING = [
    pytest.param([0.3, 0.5], ONE_SPRING, 120.0, id="one spring"),
    pytest.param([0.4, 1.2], ONE_SPRING, 90.0, id="steep", marks=pytest.mark.long),
    pytest.param([0.3, 0.4, 0.2], TWO_SPRINGS, 150.0, id="two"),
]


@pytest.mark.parametrize(("bends", "own", "speed"), VIBRATING)
def test_periodic_motions_and_their_stability(
    bends: list[float], own: dict[str, Any], speed: float
) -> None:
    fast, slow = systems(bends, **own)
    assert list(fast.compliant) == slow.compliant
    # What so many steps leave of the steepest.
    steps, close = 160, 8e-6
    by_twin = torsion.orbit(slow, speed, steps=steps)
    known = by_twin.motion
    found = fast.orbit(speed, steps)
    for name in ("speed", "acceleration", "torque", "drive_torque"):
        same(getattr(found, name), np.roll(getattr(known, name), 1, axis=-1), close, name)
    # Up to a constant: the library takes the means of the rigid pieces between springs.
    off = found.angle_error - np.roll(known.angle_error, 1, axis=-1)
    same(off - off[..., :1], 0.0, close)
    multipliers = fast.stability(speed).multipliers
    same(np.poly(multipliers), np.poly(by_twin.multipliers), close)
    steady = fast.steady(speed, [2, 4])
    torque = known.torque
    size = np.max(np.abs(torque))
    same(steady.torque_mean, torque.mean(axis=-1), close)
    assert steady.torque_min == pytest.approx(torque.min(axis=-1), abs=1e-2 * size)
    assert steady.torque_max == pytest.approx(torque.max(axis=-1), abs=1e-2 * size)
    angles = np.arange(1, steps + 1) * np.pi / steps
    for k, order in enumerate((2, 4)):
        turned = np.exp(-1j * order * angles)
        same(steady.torque_orders[..., k], 2.0 * np.mean(torque * turned, axis=-1), close)
        by_ends = 2.0 * np.mean(known.speed * turned, axis=-1)
        same(steady.speed_orders[..., k], by_ends, close)


def test_natural_frequencies() -> None:
    for bends, own in (([0.3, 1.2], ONE_SPRING), ([0.3, 0.4, 0.2], TWO_SPRINGS)):
        fast, slow = systems(bends, **own)
        known = torsion.natural_frequencies(slow)
        np.testing.assert_allclose(fast.natural_frequencies(), known, rtol=1e-12)
        by_order = known[:, np.newaxis] / [2, 3]
        np.testing.assert_allclose(fast.critical_speeds([2, 3]), by_order, rtol=1e-12)


def test_motions_in_time() -> None:
    pytest.importorskip("scipy")
    fast, slow = systems([0.3, 0.5], **ONE_SPRING)
    start = fast.orbit(80.0, 1)
    angle = start.angle_error[1, 1, 0] + torsion.zero_of(slow, 1)
    at = np.array([0.0, angle, 80.0, start.speed[1, 1, 0]])
    end, steps = 0.04, 240
    known = torsion.transient(slow, lambda t: 80.0 + 500.0 * t, at, end, steps=steps)
    times = np.linspace(0.0, end, steps + 1)
    found = fast.transient(times, speed=lambda t: 80.0 + 500.0 * t, start="steady")
    for name in ("speed", "torque"):
        same(getattr(found, name)[..., 1:], getattr(known, name), 1e-6, name)
    # Up to a constant: the library takes the means of the rigid pieces between springs.
    off = found.angle_error[..., 1:] - known.angle_error
    same(off - off[..., :1], 0.0, 1e-7)


@pytest.mark.long
def test_motions_that_exist_side_by_side() -> None:
    """Two joints in line and little damping, at 0.489 of the natural frequency."""
    line = Driveline.from_bends([math.radians(30.0)] * 2)
    own: dict[str, Any] = {
        "inertias": [(0.0, 0.0), (0.0, 0.004), (0.1, 0.0)],
        "stiffnesses": [math.inf, 9000.0, math.inf],
    }
    natural = float(cardan.TorsionalSystem(line, **own).natural_frequencies()[0])
    own |= {"dampings": [0.0, 2.0 * 0.013 * 9000.0 / natural, 0.0], "load_torque": 20.0}
    speed = 0.489 * natural
    found = cardan.TorsionalSystem(line, **own).coexisting(speed)
    slow = torsion.System(reference.from_bends(line.bends.tolist()), **own)
    aside = np.zeros((4, 4))
    aside[:, 1], aside[1:, 3] = [0.0, 0.0, -1.0, 1.0], 2.0 * speed
    peaks: list[float] = []
    for start in torsion.rigid(slow, speed) + aside:
        largest = float(torsion.orbit(slow, speed, start, steps=120).motion.torque.max())
        if not any(largest == pytest.approx(other, rel=1e-6) for other in peaks):
            peaks.append(largest)
    assert found.count == len(peaks) == 3
    assert found.torque_max[0, :3] == pytest.approx(sorted(peaks), rel=3e-4)

"""A machine's figures are those that the library finds one by one, and its changes mend it."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import Any, TypeAlias

import numpy as np
import pytest

import cardan
from cardan import Driveline, Load, Machine
from cardan.app.answers.turn.extremes import peak
from cardan.design.machine import KINDS, RANKS, Change, MachineFigure
from cardan.reference import design
from tiers import few

HEIGHTS = np.array([-0.26, -0.22, -0.18, -0.14, -0.10])
BEARINGS = [(0, 0.06), (0, 0.26), (1, 1.15), (3, 0.08), (3, 0.22)]
INERTIAS = [0.0, 0.10, 0.12, 0.0]
DUTY: Any = {"output_torque": [4000.0, 1500.0, 900.0], "speed_rpm": [1000, 1600, 2200]}
SHARES = [0.1, 0.4, 0.5]
FRICTION = {"friction": 0.01, "pin_radius": 0.012, "arm": 0.05, "seal_torque": 0.3}
SPLINE = {"engaged": 0.09, "push_in": 0.03, "friction": 0.12, "radius": 0.035}
CENTRES = [0.1, 0.2, -0.3, 0.4, 1.5]
Moved: TypeAlias = Mapping[tuple[int, int], float]
"""By how much a coordinate of a point is moved."""

LIMITS: Mapping[str, Any] = {
    "equivalent_bend": math.radians(3.0),
    "torsional_excitation": (300.0, 400.0),
    "inertia_excitation_driving": (500.0, 1000.0),
    "inertia_excitation_coasting": (500.0, 1000.0),
    "life": 15000.0,
    "shear_stress": 110e6,
    "critical_margin": 1.4,
    "spline_engaged": 0.07,
    "spline_push_in": 0.0,
}


def points(height: float, moved: Moved = MappingProxyType({})) -> Any:  # noqa: ANN401
    axle = [[3.15, height, 0.045], [3.45, height - 0.016, 0.045]]
    found = np.array([[0.0, 0.0, 0.0], [0.35, -0.024, 0.0], [1.65, -0.046, 0.0], *axle])
    for place, by in moved.items():
        found[place] += by
    return found


def truck(
    limits: Mapping[str, Any] = LIMITS,
    *,
    moved: Moved = MappingProxyType({}),
    phases: Any = (0.0, 0.0),  # noqa: ANN401
    bearings: Any = BEARINGS,  # noqa: ANN401
    ratings: Any = 6500.0,  # noqa: ANN401
    engaged: float = 0.09,
    inertias: Any = INERTIAS,  # noqa: ANN401
    has_play: bool = True,
) -> Machine:
    """A truck in five states with all that a machine can have, and changes of it."""
    lines = Driveline.from_points([points(y, moved) for y in HEIGHTS], phases=phases)
    lines = lines.with_bearings(bearings)
    drawn = Driveline.from_points(points(-0.18, moved))
    load = Load(output_torque=1500.0, speed_rpm=2200.0, inertias=inertias)
    duty = Load(**DUTY, inertias=inertias)
    machine = Machine(lines, load, limits=limits, drawn=drawn)
    machine = machine.with_duty(lines[1:4], duty, SHARES)
    machine = machine.with_ratings(ratings).with_friction(**FRICTION)
    machine = machine.with_tubes([1, 2], 0.11, 0.004).with_steering(CENTRES)
    if has_play:
        machine = machine.with_play(0.02e-3, [0.03, 0.04, 0.05])
    return machine.with_spline(2, **{**SPLINE, "engaged": engaged})


def by_name(machine: Machine) -> dict[tuple[str, int | None], MachineFigure]:
    return {(figure.kind.name, figure.item): figure for figure in machine.figures()}


DRAWN = Driveline.from_points(points(-0.18))


# --- figures -------------------------------------------------------------------------------------


def near(figure: MachineFigure, want: Any, accuracy: float = 1e-12) -> None:  # noqa: ANN401
    found = np.asarray(figure.values)
    assert found.shape == np.shape(want), figure.kind
    np.testing.assert_allclose(found, want, rtol=accuracy, atol=1e-15, err_msg=figure.kind.name)


def test_every_figure_is_that_of_the_library() -> None:
    machine = truck()
    found, lines = by_name(machine), machine.states
    duty = Load(**DUTY, inertias=INERTIAS)
    load = Load(output_torque=1500.0, speed_rpm=2200.0, inertias=INERTIAS)
    speed = load.speed
    every = [(line, load) for line in lines]
    for line, torque, own in zip(lines[1:4], duty.torque, duty.speed, strict=True):
        every.append((line, Load(output_torque=torque, speed=own, inertias=INERTIAS)))
    checked = {f.figure: f.value for f in lines.check(speed).findings}
    near(found.pop(("equivalent_bend", None)), np.radians(checked["equivalent_bend"]))
    for name in ("torsional_excitation", "inertia_excitation_driving"):
        near(found.pop((name, None)), checked[name])
    near(found.pop(("inertia_excitation_coasting", None)), checked["inertia_excitation_coasting"])
    life = lines[1:4].life(duty, rating=6500.0, shares=SHARES)
    for joint in range(3):
        bends = [line.bends[joint] for line, _ in every]
        near(found.pop(("bend", joint)), bends)
        products = [load.speed * bend for bend, (_, load) in zip(bends, every, strict=True)]
        near(found.pop(("speed_bend", joint)), products)
        near(found.pop(("life", joint)), [life.hours[joint]])
        heat = [line.losses(load, **FRICTION).power[joint] for line, load in every]
        near(found.pop(("heat", joint)), heat)
        forces = [peak(line, "joint_force", joint, load).value for line, load in every[:5]]
        near(found.pop(("joint_force", joint)), forces, 1e-11)
    for bearing in range(5):
        forces = [peak(line, "bearing_force", bearing, load).value for line, load in every[:5]]
        near(found.pop(("bearing_force", bearing)), forces, 1e-11)
    lengths = lines.lengths()
    torques = {
        shaft: [peak(line, "torque", shaft, load).value for line, load in every] for shaft in (1, 2)
    }
    for shaft in (1, 2):
        tubes = [cardan.tube(0.11, 0.004, length=line.lengths().each[shaft]) for line, _ in every]
        near(found.pop(("shear_stress", shaft)), tubes[0].shear_stress(torques[shaft]))
        margins = [
            tube.critical_speed / load.speed for tube, (_, load) in zip(tubes, every, strict=True)
        ]
        near(found.pop(("critical_margin", shaft)), margins)
    drawn = DRAWN.lengths().each[2]
    near(found.pop(("spline_travel", 2)), [lengths.travel[2]])
    near(found.pop(("spline_engaged", 2)), lengths.engagement(2, 0.09, drawn))
    near(found.pop(("spline_push_in", 2)), 0.03 + (lengths.each[:, 2] - drawn))
    axial = [
        line.spline_force(2, torque, 0.12, 0.035).axial
        for (line, _), torque in zip(every, torques[2], strict=True)
    ]
    near(found.pop(("spline_force", 2)), axial)
    steering = lines.steering(CENTRES)
    near(found.pop(("steering_offset", None)), np.abs(steering.noticed))
    near(found.pop(("steering_ratio", None)), steering.difference)
    turn = cardan.Sweep.revolutions(721 / 720, 720)
    lash = [np.max(line.lash(turn, 0.02e-3, [0.03, 0.04, 0.05])) for line in lines]
    near(found.pop(("lash", None)), lash, 1e-9)
    assert not found


@pytest.mark.parametrize("end", ["drive", "output"])
def test_without_inertias_the_largest_torques_are_closed_forms(end: str) -> None:
    lines = Driveline.from_bends([[0.3, 0.4, 0.2], [0.5, 0.1, 0.9]], 0.3, [0.2, -0.7])
    torques = [-300.0, 200.0]
    load = Load(**{f"{end}_torque": torques}, speed=10.0)
    shafts = range(4)
    machine = Machine(lines, load).with_tubes(shafts, 0.05, length=1.0)
    found, tube = by_name(machine), cardan.tube(0.05, length=1.0)
    for shaft in shafts:
        want = [
            peak(line, "torque", shaft, Load(**{f"{end}_torque": torque})).value
            for line, torque in zip(lines, torques, strict=True)
        ]
        near(found["shear_stress", shaft], tube.shear_stress(want), 1e-11)


def test_two_joints_have_a_difference_and_one_has_no_inertia_excitation() -> None:
    two = by_name(Machine(Driveline.from_bends([[0.1, 0.25], [0.3, 0.1]]), speed=2.0))
    near(two["bend_difference", None], [0.15, 0.2])
    one = by_name(Machine(Driveline.from_bends([0.1]), speed=2.0))
    names = ["equivalent_bend", "torsional_excitation", "bend", "speed_bend"]
    assert [name for name, _ in one] == names
    near(one["equivalent_bend", None], [0.1], 1e-14)


def test_every_kind_is_had_by_some_machine() -> None:
    two = Machine(Driveline.from_bends([0.1, 0.25]))
    assert {name for name, _ in [*by_name(truck()), *by_name(two)]} == set(KINDS)
    for figure in truck().figures():
        count = {"states": 5, "cases": 8, "once": 1}[figure.kind.scope]
        assert figure.values.shape == figure.ranks.shape == (count,)


# --- verdicts ------------------------------------------------------------------------------------


def worst_value(figure: MachineFigure) -> float:
    assert figure.worst is not None
    return float(figure.values[figure.worst])


@pytest.mark.long
def test_each_limit_is_met_to_the_last_digit_and_missed_beyond() -> None:
    bare = {
        key: figure for key, figure in by_name(truck({})).items() if abs(worst_value(figure)) > 0.0
    }
    assert {name for name, _ in bare} == set(KINDS) - {"bend_difference"}
    for (name, item), figure in bare.items():
        # A spline that has come apart or bottoms is beyond, whatever the limit.
        assert figure.verdict == ("within" if figure.limit == 0.0 else "not judged")
        value, outwards = worst_value(figure), 1.0 if figure.kind.most else -1.0
        extreme = np.max(figure.values) if figure.kind.most else np.min(figure.values)
        assert value == extreme
        for off in (0.0, 0.9e-9, -0.9e-9, -1e-6):
            word = "beyond" if off == -1e-6 else "within"
            limit = value + off * outwards * abs(value)
            bound: Any = limit if item is None else {item: limit}
            judged = by_name(truck({name: bound}))
            assert judged[name, item].verdict == word, (name, off)
            assert truck({name: bound}).verdict() == word
        room = (value - outwards * 1e-6 * abs(value), value)
        given: Any = room if item is None else {item: room}
        assert by_name(truck({name: given}))[name, item].verdict == "tolerable"


def test_every_state_has_its_rank_and_the_worst_its_place() -> None:
    found = by_name(truck())
    bend = found["equivalent_bend", None]
    assert bend.ranks.tolist() == [3, 3, 1, 1, 3]
    assert bend.worst == 0
    inertia = found["inertia_excitation_driving", None]
    assert [RANKS[rank] for rank in inertia.ranks] == ["tolerable", *["within"] * 4]
    assert [found["life", joint].verdict for joint in range(3)] == ["within", "beyond", "within"]
    assert truck().verdict() == "beyond"
    assert truck({"bend": 1.0}).verdict() == "within"
    assert Machine(truck().states).verdict() == "not judged"


def test_what_is_not_known_is_not_judged() -> None:
    lines = Driveline.from_bends([[0.1, 0.2], [0.2, 0.2]])
    limits = dict.fromkeys(("torsional_excitation", "shear_stress", "critical_margin"), 1.0)
    limits["speed_bend"] = 1e-9
    still = Machine(lines, Load(output_torque=[0.0, 5.0], speed=[3.0, 0.0]), limits=limits)
    found = by_name(still.with_tubes([1], 0.1, length=1.0))
    assert np.isnan(found["torsional_excitation", None].values).tolist() == [False, True]
    assert found["torsional_excitation", None].ranks.tolist() == [1, 0]
    assert found["shear_stress", 1].ranks.tolist() == [0, 3]
    assert found["critical_margin", 1].ranks.tolist() == [1, 0]
    assert found["speed_bend", 0].ranks.tolist() == [3, 0]
    # No lengths: neither tubes without one nor forces are known.
    bare = by_name(Machine(lines, Load(output_torque=5.0)).with_tubes([1], 0.1))
    assert np.isnan(bare["critical_margin", 1].values).all()
    assert bare["critical_margin", 1].worst is None
    assert ("joint_force", 0) not in bare


def test_forces_that_are_not_determinate_are_not_judged() -> None:
    lines = Driveline.from_points(points(-0.2)).with_bearings([(1, 0.2), (1, 0.4), (1, 0.6)])
    machine = Machine(lines, Load(output_torque=100.0), limits={"bearing_force": 1e-9})
    found = by_name(machine)
    assert np.isnan(found["bearing_force", 0].values).all()
    assert machine.verdict() == "not judged"


def test_a_spline_that_has_come_apart_or_bottoms_is_beyond() -> None:
    engaged, push_in = (
        np.min(by_name(truck())[name, 2].values) for name in ("spline_engaged", "spline_push_in")
    )
    assert truck({}).verdict() == "within"
    assert truck({}, engaged=0.09 - engaged).verdict() == "within"
    assert truck({}, engaged=0.09 - engaged - 1e-6).verdict() == "beyond"
    for room, verdict in ((0.0, "within"), (1e-6, "beyond")):
        lines = truck().states
        spline = Machine(lines, drawn=DRAWN).with_spline(2, push_in=0.03 - push_in - room)
        assert spline.verdict() == verdict


def test_a_limit_of_what_a_machine_lacks_is_not_judged() -> None:
    lines = Driveline.from_bends([[0.1, 0.2, 0.1]])
    limits: Any = {"life": 1.0, "lash": 1.0, "shear_stress": {1: 1.0}, "bend_difference": 1.0}
    found = by_name(Machine(lines, limits=limits))
    for key in (("life", None), ("lash", None), ("shear_stress", 1), ("bend_difference", None)):
        assert found[key].verdict == "not judged"
        assert found[key].limit == 1.0
        assert found[key].worst is None
    assert Machine(lines, limits=limits).suggest() == ()


# --- changes -------------------------------------------------------------------------------------


def excess(machine: Machine) -> float:
    """How far the worst figure is past its limit, over this."""
    worst = -math.inf
    for figure in machine.figures():
        size = 1.0 if figure.limit == 0.0 else abs(figure.limit)
        past = (figure.values - figure.limit) * (1.0 if figure.kind.most else -1.0)
        if not math.isnan(figure.limit):
            worst = max(worst, float(np.max(past / size)))
    return worst


def changed(change: Change, by: float, limits: Mapping[str, Any]) -> Machine:
    """The truck with a change, made anew with what its limits need."""
    bearings = list(BEARINGS) if "bearing_force" in limits else []
    own: dict[str, Any] = {"bearings": bearings, "has_play": False}
    if change.variable == "point":
        assert change.axis is not None
        own["moved"] = {(change.item, change.axis): by}
    elif change.variable == "phase":
        own["phases"] = [by * (shaft == change.item) for shaft in (1, 2)]
    elif change.variable == "bearing":
        shaft, place = bearings[change.item]
        bearings[change.item] = (shaft, place + by)
    elif change.variable == "engaged":
        own["engaged"] = 0.09 + by
    else:
        own["ratings"] = [6500.0 + by * (joint == change.item) for joint in range(3)]
    return truck(limits, **own)


def suffices(change: Change, by: float, limits: Mapping[str, Any]) -> bool:
    try:
        return changed(change, by, limits).verdict() == "within"
    except ValueError:
        return False


NARROW: Mapping[str, Mapping[str, Any]] = {
    "all": LIMITS,
    "bend": {"bend": {2: 0.08}},
    "phases": {"torsional_excitation": 290.0},
    "forces": {"bearing_force": {3: 900.0}},
    "engaged": {"spline_engaged": 0.085},
    "life": {"life": 15000.0},
}


@pytest.mark.parametrize("case", few(NARROW, set(NARROW) - {"forces"}))
def test_the_smallest_changes_that_suffice(case: str) -> None:
    limits = NARROW[case]
    reach = 0.06
    ratings = [5000.0, 7000.0, 8000.0, 9000.0, 12000.0]
    found = truck(limits).suggest(reach, ratings=ratings)
    assert found
    assert [change.share for change in found] == sorted(change.share for change in found)
    for change in found:
        assert change.verdict == "within"
        assert suffices(change, change.change, limits)
        assert change.worst is not None
        assert change.worst.verdict == "within"
        if change.variable == "rating":
            assert change.end in ratings
            between = [r for r in ratings if 6500.0 < r < change.end]
            assert not any(suffices(change, r - 6500.0, limits) for r in between)
            continue
        span = math.pi / 2.0 if change.variable == "phase" else reach
        assert change.share == pytest.approx(abs(change.change) / span)
        twin = design.smallest_change(lambda by: suffices(change, by, limits), span, 96)  # noqa: B023
        assert twin is not None
        assert abs(change.change) <= abs(twin) * (1.0 + 1e-6)


def test_what_is_not_listed_does_not_suffice() -> None:
    """Every point, phase, bearing and length of the truck, by the twin."""
    (only,) = truck(LIMITS).suggest(0.06)
    assert (only.variable, only.item, only.axis) == ("point", 2, 1)
    points = [("point", point, axis) for point in range(5) for axis in range(3)]
    others: Any = [*points, ("phase", 1, None), ("phase", 2, None)]
    for variable, item, axis in others:
        change = dataclasses.replace(only, variable=variable, item=item, axis=axis)
        span = math.pi / 2.0 if variable == "phase" else 0.06
        twin = design.smallest_change(lambda by: suffices(change, by, LIMITS), span, 12)  # noqa: B023
        assert (twin is not None) == ((variable, item, axis) == ("point", 2, 1))


def test_more_teeth_than_a_spline_has_are_refused() -> None:
    with pytest.raises(ValueError, match=r"teeth\[1\] is 1001.0; it must be at most 1000"):
        truck().suggest(teeth=[36, 1001])


def test_teeth_turn_yokes_by_whole_pitches() -> None:
    limits = {"equivalent_bend": math.radians(4.24)}
    free = {c.item: c for c in truck(limits).suggest()}
    toothed = {c.item: c for c in truck(limits).suggest(teeth=[360, 0])}
    assert all(c.verdict == "within" for c in [*free.values(), *toothed.values()])
    pitch = 2.0 * math.pi / 360
    assert toothed[1].change / pitch == pytest.approx(round(toothed[1].change / pitch), abs=1e-9)
    assert 0.0 <= abs(toothed[1].change) - abs(free[1].change) < pitch
    assert (2 in toothed) == (2 in free)


def test_the_nearest_where_nothing_suffices() -> None:
    limits = {"equivalent_bend": math.radians(0.5)}
    (nearest,) = truck(limits).suggest(0.06)
    assert nearest.verdict == "beyond"
    left = excess(changed(nearest, nearest.change, limits))
    assert left < excess(truck(limits))
    # None of many others is nearer.
    for point in range(5):
        for axis in range(3):
            for by in np.linspace(-0.06, 0.06, 13):
                other = truck(limits, moved={(point, axis): float(by)})
                assert excess(other) >= left * (1.0 - 1e-9)


def test_nothing_is_suggested_where_all_is_within_or_nothing_helps() -> None:
    assert truck({"bend": 1.0}).suggest(0.06) == ()
    assert truck({"critical_margin": 1e9}).suggest() == ()


def test_a_preset_is_refused_by_name() -> None:
    line = Driveline.from_bends([5.0, 4.0], degrees=True)
    with pytest.raises(TypeError, match="limits is 'industrial'; it must be a dict"):
        Machine(line, limits="industrial")  # type: ignore[arg-type]


def test_results_do_not_depend_on_the_threads() -> None:
    core = truck()._core
    one, all_ = core.figures(1), core.figures(None)
    for first, second in zip(one, all_, strict=True):
        assert first[2].tobytes() == second[2].tobytes()
    alone, together = core.suggest(0.06, [], [], 1), core.suggest(0.06, [], [], None)
    assert [row[:6] for row in alone] == [row[:6] for row in together]

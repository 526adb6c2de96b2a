"""A scene as a machine: its drivelines in all states with their parts and limits, in SI units."""

from __future__ import annotations

from typing import Any

import numpy as np

from cardan.app.scene.language.units import RPM
from cardan.app.scene.scene import Scene
from cardan.app.scene.sections.driveline import has_lengths
from cardan.app.scene.sections.life import DutyCycle, load_at
from cardan.design.limits import PRESETS, Rule
from cardan.design.machine import Machine
from cardan.driveline import Driveline
from cardan.evaluation.load import Load


def machine_of(scene: Scene, *, can_tilt: bool = False) -> Machine | None:
    """Return a scene as a machine; ``None`` where a study or a recording has no states.

    Where ``can_tilt``, the shafts of readings without lengths have one metre each, so that the ends
    can move.
    """
    recorded = scene.line.shape or scene.speed_recorded or scene.recording is not None
    if recorded or scene.deviations is not None or (scene.study is not None and scene.study.axes):
        return None
    lines, load = scene.drivelines(), scene.load_case
    if scene.states:
        load = scene.states.loads(load)
    # Without tubes nothing that is judged depends on lengths that are not known.
    if can_tilt and scene.is_measured and not has_lengths(lines) and not scene.tubes:
        lines = lines.with_bearings([], np.ones(lines.n_joints + 1))
    return _with_duty_and_spline(scene, moving(scene, lines, load))


def moving(scene: Scene, lines: Driveline, load: Load | None) -> Machine:
    """Return the machine of drivelines without duty cycle and spline."""
    speed = None if load else scene.speed
    machine = Machine(lines, load, limits=_limits(scene), speed=speed, drawn=scene.line)
    if tubes := scene.tubes:
        # The stiffness of a tube is not judged.
        given = {name: each for name, each in tubes.given.items() if name != "shear_modulus"}
        machine = machine.with_tubes(tubes.shafts, **given)
    if scene.steering:
        machine = machine.with_steering(np.radians(scene.steering.centre_deg))
    play = scene.play
    return machine.with_play(play.radial, play.arm) if play else machine


def _with_duty_and_spline(scene: Scene, machine: Machine) -> Machine:
    ratings = _ratings(scene)
    if duty := scene.duty:
        place = _place_of(duty, ratings)
        steps = load_at(duty.load, duty.line.shape, (place,))
        machine = machine.with_duty(duty.line[place], steps, duty.shares)
    if ratings and duty:
        machine = machine.with_ratings(ratings)
    if slip := scene.slip:
        drawn = {"engaged": slip.engaged, "push_in": slip.push_in}
        lengths = {name: 1e-3 * value for name, value in drawn.items() if value is not None}
        if slip.friction is not None and slip.radius is not None:
            lengths |= {"friction": slip.friction, "radius": slip.radius}
        machine = machine.with_spline(slip.shaft, **lengths)
    return machine


def _ratings(scene: Scene) -> list[float]:
    sizes = scene.sizes.each if scene.sizes else ()
    return [size.rating if size.wears and size.rating else np.nan for size in sizes]


def _place_of(duty: DutyCycle, ratings: list[float]) -> int:
    """Return the state in which a joint fails first, of states that share a duty cycle."""
    if len(duty.line) == 1 or not np.isfinite(ratings).any():
        return 0
    known = np.nan_to_num(ratings, nan=1e12)
    life = duty.line.life(duty.load, rating=known, shares=duty.shares)
    return int(np.argmin(np.min(life.hours, axis=0)))


_METRES = {"mm": 1e-3, "m": 1.0}


def rules_of(scene: Scene) -> dict[str, tuple[str, Rule]]:
    """Return the rules of presets on bends that a machine has, with their preset, by its figures.

    They are the strictest of those that hold at every speed, where nothing else limits the figure.
    """
    kinds = {"bend_deg": "bend", "difference_deg": "bend_difference"}
    if scene.sizes and any(size.max_bend_deg is not None for size in scene.sizes.each):
        del kinds["bend_deg"]
    if scene.line.n_joints != 2 or "bend_difference_deg" in scene.limits.figures:
        del kinds["difference_deg"]
    found: dict[str, tuple[str, Rule]] = {}
    for preset in scene.limits.presets:
        for rule in PRESETS[preset].on_bends:
            kind = kinds.get(rule.figure)
            if kind is None or not rule.holds_always:
                continue
            if kind not in found or rule.limit < found[kind][1].limit:
                found[kind] = (preset, rule)
    return found


def _limits(scene: Scene) -> dict[str, Any]:
    """The limits that the scene gives, in SI, by the names of the machine's figures."""
    limits: dict[str, Any] = {}
    for key, bound in scene.limits.figures.items():
        name, factor = key.removesuffix("_rad_s2"), 1.0
        if key.endswith("_deg"):
            name, factor = key.removesuffix("_deg"), np.pi / 180.0
        pair = (factor * bound.limit, factor * bound.maximum)
        for ending in ("_driving", "_coasting") if name == "inertia_excitation" else ("",):
            limits[f"{name}{ending}"] = pair
    for kind, (_, rule) in rules_of(scene).items():
        most = np.radians(rule.limit)
        limits[kind] = dict.fromkeys(range(scene.line.n_joints), most) if kind == "bend" else most
    for key, each in (("joint", scene.line.n_joints), ("bearing", scene.line.n_bearings)):
        if force := scene.part_limits.get(f"{key}_force_N"):
            pair = (force.limit, force.maximum)
            limits[f"{key}_force"] = dict.fromkeys(range(each), pair)
    if (lash := scene.part_limits.get("lash_deg")) and scene.play:
        limits["lash"] = (np.radians(lash.limit), np.radians(lash.maximum))
    if column := scene.steering:
        if column.offset_deg is not None:
            limits["steering_offset"] = np.radians(column.offset_deg)
        if column.ratio_percent is not None:
            limits["steering_ratio"] = 1e-2 * column.ratio_percent
    for joint, size in enumerate(scene.sizes.each if scene.sizes else ()):
        if size.max_bend_deg is not None:
            limits.setdefault("bend", {})[joint] = np.radians(size.max_bend_deg)
        if size.max_speed_bend is not None:
            product = size.max_speed_bend * RPM * np.pi / 180.0
            limits.setdefault("speed_bend", {})[joint] = product
        if scene.duty is not None and scene.duty.target is not None and size.wears:
            limits.setdefault("life", {})[joint] = scene.duty.target
    if tubes := scene.tubes:
        each_tube = {"shear_stress": tubes.permitted_stress, "critical_margin": tubes.least_margin}
        limits |= {
            name: dict.fromkeys(tubes.shafts, limit)
            for name, limit in each_tube.items()
            if limit is not None
        }
    if slip := scene.slip:
        in_mm = {
            "spline_travel": slip.travel,
            "spline_engaged": slip.least_engaged,
            "spline_push_in": None if slip.push_in is None else 0.0,
        }
        limits |= {name: 1e-3 * one for name, one in in_mm.items() if one is not None}
    return limits


def machine_data(scene: Scene) -> dict[str, Any] | None:
    """Return the machine of a scene as plain data, as ``cardan.js`` reads it; ``None`` without one.

    Points are as the scene gives them, so that drivelines made of them have the same bits here and
    there.
    """
    machine = machine_of(scene)
    if machine is None:
        return None
    data = machine.to_dict()
    if scene.points is not None:
        unit, states = _METRES[scene.length_unit], scene.states
        each = [states.points(i) for i in range(states.count)] if states else [scene.points]
        data |= {"points": [np.asarray(points).tolist() for points in each], "unit": unit}
        data["drawn_points"] = [scene.points.tolist()]
        if scene.duty:
            own = [scene.points if i is None else each[i] for i in states_of_steps(scene)]
            data["step_points"] = [np.asarray(points).tolist() for points in own]
    if scene.states:
        data |= {"state_names": list(scene.states.names), "weights": scene.states.weights.tolist()}
    return {"title": scene.title, "teeth": list(scene.teeth), **data}


def states_of_steps(scene: Scene) -> list[int | None]:
    """The state of every step of the duty cycle; ``None`` is that of the drawing."""
    duty, states = scene.duty, scene.states
    if duty is None:
        return []
    if states and "states" in duty.values:
        return [states.names.index(name) for name in duty.values["states"]]
    place = _place_of(duty, _ratings(scene)) if len(duty.line) > 1 else None
    return [place] * len(duty.names)

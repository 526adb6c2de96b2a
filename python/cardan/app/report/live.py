"""The live part of a page: the machine that moves, and what its figures are called there."""

from __future__ import annotations

import base64
import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Any, get_args

import numpy as np

from cardan.app.answers.answer import FROM_THE_WORST, Answer
from cardan.app.answers.lateral.vibration import ORDERS
from cardan.app.answers.moves import held_in, search
from cardan.app.answers.printed import bound_of, judged_text
from cardan.app.answers.rows import DIGITS, UNITS, Judged, Row, element_of, rows_of
from cardan.app.answers.table import PARTS
from cardan.app.pictures.space import right_and_up
from cardan.app.scene.changes import given, pieces, sizes
from cardan.app.scene.language.units import ENDINGS, US, System, shown_in
from cardan.app.scene.machine import machine_data, machine_of, rules_of
from cardan.app.scene.scene import Scene
from cardan.arrays import FloatArray
from cardan.design.machine import KINDS
from cardan.driveline import Driveline
from cardan.evaluation.load import Load
from cardan.torsion import Coupling
from cardan.torsion.tube import SHEAR_MODULUS

_PLACES = {
    "bend": "life.joints[joint={}].bend",
    "speed_bend": "life.joints[joint={}].speed_bend",
    "life": "life.joints[joint={}].hours",
    "heat": "life.joints[joint={}].heat",
    "critical_margin": "tubes[shaft={}].margin",
    "shear_stress": "tubes[shaft={}].stress",
    "spline_travel": "spline.travel",
    "spline_engaged": "spline.engaged",
    "spline_push_in": "spline.push_in",
    "spline_force": "spline.force",
    "steering_offset": "steering.offset",
    "steering_ratio": "steering.difference",
    "lash": "backlash.lash",
    "joint_force": "forces.joints[joint={}].largest",
    "bearing_force": "forces.bearings[bearing={}].largest",
    "resonance": "torsion.margin",
}
"""Places of a machine's figures in an answer, by their kind; others are of the part ``limits``.

``resonance`` is computed beside the machine.
"""

_OF_PRESETS = {
    "bend": "joints[joint={}].bend",
    "bend_difference": "differences[joints=joints 0-1].difference",
}
"""Places in a preset of the figures of a machine that it limits."""

_OVER = {"life": "over the duty cycle"}
"""Over what a kind of figure is, where that is neither a state nor a step."""


def live(answer: Answer) -> dict[str, Any] | None:
    """Return what the live part of the page of a scene reads; ``None`` if it has no machine.

    ``data`` is plain data for its script, and ``module`` the core for browsers in base64.
    """
    scene = answer.scene
    machine = machine_of(scene)
    if machine is None:
        return None
    limited = [
        (each.kind.name, each.item) for each in machine.figures() if not np.isnan(each.limit)
    ]
    changeable = given(scene)
    torsion = _torsion(answer, changeable)
    if torsion and torsion["arguments"]["margin"] is not None:
        limited.append(("resonance", None))
    judged = {each.entry.path: each for each in answer.judged}
    figures = []
    for kind, number in limited:
        own = judged.pop(_path(kind, number, scene))
        figures.append(
            {
                "kind": kind,
                "item": number,
                "name": own.name,
                "bound": _in_units(bound_of, replace(own.value, maximum=None), own.entry.row),
                "limit": _in_units(bound_of, own.value, own.entry.row),
                "source": own.value.source,
                "over": _OVER.get(kind, ""),
            }
        )
    reach = search(scene)
    weights = scene.states.weights if scene.states else np.ones(1)
    states, directions = scene.states, machine.states.directions
    joints = [f"joint {joint}" for joint in range(scene.line.n_joints)]
    sent = machine_data(scene) or {}
    data = {
        "machine": sent,
        "states": states.names if states else [""],
        "weights": weights.tolist(),
        "steps": scene.duty.names if scene.duty else [],
        # The state that differs least from the drawing.
        "drawn": int(np.argmin(np.max(np.abs(directions - scene.line.directions), axis=(1, 2)))),
        "points": ["upstream end", *joints, "downstream end"],
        "views": [
            {"name": name, "right": axes[0].tolist(), "down": axes[1].tolist()}
            for name, axes in views(directions).items()
        ],
        "kinds": {name: _kind(name, scene) for name in (*KINDS, "resonance")},
        "torsion": torsion,
        "lateral": _lateral(answer),
        "units": scene.units,
        "torques": _shown("Nm"),
        "figures": figures,
        "others": [
            {
                "name": each.name,
                "verdict": each.value.verdict,
                "words": _in_units(
                    lambda value, row: f"{judged_text(value, row)} ({value.source})",
                    each.value,
                    each.entry.row,
                ),
            }
            for each in judged.values()
            if each.value.limit is not None
        ],
        "verdicts": FROM_THE_WORST,
        "title": scene.title,
        "core": _file("sources.sha256").decode().strip(),
        "curves": list(_curves(answer, sent)),
        "here": _here(answer),
        "search": {
            "reach": reach["reach"],
            "teeth": reach["teeth"],
            "known_ratings": reach["ratings"],
        },
        "fixed": sorted(held_in(scene)),
        "shims": _shims(answer) if scene.is_measured else None,
        "given": changeable,
        "source": {
            "name": Path(scene.name).name,
            "text": scene.text,
            "pieces": pieces(scene),
            "sizes": sizes(scene),
        },
    }
    return {"data": data, "module": _module()}


def views(directions: FloatArray) -> dict[str, FloatArray]:
    """Directions to the right, down and to the viewer for side view and top view, by its name.

    In both the drive is on the left, and none is a mirror image. The directions are those of the
    shafts, ``(states, n + 1, 3)``.
    """
    right, up = right_and_up(np.mean(directions, axis=(0, 1)))
    side = np.cross(right, up)
    names = [
        f"{'-' if axis.sum() < 0 else ''}{'xyz'[int(np.argmax(np.abs(axis)))]}"
        for axis in (right, up, side)
    ]
    return {
        f"Side view: {names[0]} to the right, {names[1]} up": np.stack([right, -up, side]),
        f"Top view: {names[0]} to the right, {names[2]} down": np.stack([right, side, up]),
    }


def _place(kind: str, scene: Scene) -> str:
    if rule := rules_of(scene).get(kind):
        return f"presets[preset={rule[0]}].{_OF_PRESETS[kind]}"
    return _PLACES.get(kind, f"limits.{kind}")


def _path(kind: str, item: int | None, scene: Scene) -> str:
    """The path of a figure in the rows of an answer: ``"tubes.1.margin"``."""
    place = re.sub(r"\[\w+=(?:\w+ )?(.*?)\]", r".\1", _place(kind, scene))
    return place.replace("{}", str(item))


def _kind(name: str, scene: Scene) -> dict[str, Any]:
    """Return label, unit and digits of a kind of figure, from the row that declares it."""
    row = _row(name, scene)
    return {
        "label": row.label,
        **_scaled(row.unit, row.digits),
        "meaning": row.meaning,
        "source": row.source,
        "path": _place(name, scene),
        "ending": row.ending(),
    }


def _torsion(answer: Answer, changeable: dict[str, Any]) -> dict[str, Any] | None:
    """Return inputs of natural frequencies and critical speeds; ``None`` without [torsion].

    ``changeable`` is what a page can change. ``arguments`` are those of the core's function but for
    the driveline, and inertias without those of tubes. The shafts ``springs`` have the stiffness
    of their tube. A margin that leaves critical speeds out is not judged anew, since what they do
    to torques changes with the bends.
    """
    case, found = answer.scene.torsion, answer["torsion"]
    if case is None or found is None or case.system.stiffness_follows_speed:
        return None
    system, tubes = case.system, answer.scene.tubes
    rigid = [shaft not in system.compliant for shaft in range(system.line.n_joints + 1)]
    shear = (
        np.broadcast_to(tubes.given.get("shear_modulus", SHEAR_MODULUS), (len(tubes.shafts),))
        if tubes
        else np.zeros(0)
    )
    return {
        "arguments": {
            "inertias": case.apart.tolist(),
            "stiffnesses": [
                None if is_rigid else own
                for own, is_rigid in zip(system.stiffnesses.tolist(), rigid, strict=True)
            ],
            "load_torque": float(system.load_torque),
            "free": system.drive == "free",
            **coupling_data(system.couplings),
            "orders": [float(order) for order in case.orders],
            "excited": [order in case.excited for order in case.orders],
            "range": [found.speed_range.start, found.speed_range.stop],
            "margin": None
            if any(each.negligible for each in found.critical_speeds)
            else case.margin,
        },
        "is_loaded": case.is_loaded and changeable["torque"] is not None,
        "springs": list(case.springs),
        "shear_modulus": shear.tolist(),
        "frequency": _scaled("Hz"),
        "speed": _scaled("rpm"),
        "away": _scaled("percent"),
    }


def _lateral(answer: Answer) -> dict[str, Any] | None:
    """Return inputs of the first resonance on elastic bearings; ``None`` without one.

    ``arguments`` are those of the core's function but for the driveline, speeds and moments. Shafts
    whose mass follows from a length that the page can change are left out.
    """
    case, found = answer.scene.lateral, answer["lateral"]
    if case is None or found is None or found.why or not case.elastic:
        return None
    if any("mass" not in given or "centre" not in given for given in case.rigid.values()):
        return None
    system = case.on(answer.scene.line)
    arguments = system._described()
    for name, items in (("of_masses", case.masses), ("of_unbalances", case.unbalance)):
        for own, item in zip(arguments[name], items, strict=True):
            own[0] = item.distance
    return {
        "arguments": _without_nan(arguments),
        "elastic": list(case.elastic),
        "from_end": {
            "of_masses": [each.from_end for each in case.masses],
            "of_unbalances": [each.from_end for each in case.unbalance],
        },
        "orders": list(ORDERS),
        "known": [[*each.known] for each in found.vibration.groups],
        "range": [float(case.speed[0]), float(case.speed[-1])],
        "frequency": _scaled("Hz"),
        "speed": _scaled("rpm"),
        "force": _scaled("N"),
        "moved": _scaled("mm", "small"),
    }


def _without_nan(arguments: dict[str, list[Any]]) -> dict[str, list[Any]]:
    """JSON has no NaN and no infinity: ``None`` is one, and 1e300 is as good as the other."""
    numbers = {
        name: [[None if np.isnan(x) else min(float(x), 1e300) for x in row] for row in rows]
        for name, rows in arguments.items()
        if name.startswith("of_")
    }
    return arguments | numbers


def coupling_data(couplings: Mapping[int, Coupling]) -> dict[str, Any]:
    """Return couplings by their shafts as arguments of the core's function, but for dampings."""
    laws = [each._fields(shaft) for shaft, each in couplings.items()]
    return {
        "couplings": [shaft for shaft, *_ in laws],
        "coupling_stiffnesses": [stiffness for _, stiffness, *_ in laws],
        "twist_counts": [len(points) for _, _, points, *_ in laws],
        "twist_torques": [points for _, _, points, *_ in laws],
        "plays": [play for *_, play, _, _, _ in laws],
        "mean_counts": [len(points) for *_, points in laws],
        "stiffnesses_by_mean": [points for *_, points in laws],
    }


def _row(kind: str, scene: Scene) -> Row:
    part, *names = re.sub(r"\[.*?\]", "", _place(kind, scene)).split(".")
    of = PARTS[part].figures()
    *outer, last = names
    for name in outer:
        of = element_of(next(hint for own, _, hint in rows_of(of) if own == name))
    return next(row for own, row, _ in rows_of(of) if own == last)


def _here(answer: Answer) -> dict[str, str]:
    """Return places of figures of one state in ``cardan check --json``."""
    in_state = ".states[state={state}]" if answer.scene.states else ""
    force = f"check:forces.bearings[bearing={{}}].largest{in_state}.value_N"
    return {
        "bend": f"check:{in_state[1:]}.bends_deg[{{}}]" if in_state else "derived:bend_deg",
        "bearing_force": force if answer["forces"] else "derived:bearing_force_N",
    }


def _curves(answer: Answer, data: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """Yield curves drawn over the turn; for each item the place of its largest, by state."""
    scene = answer.scene
    names = scene.states.names if scene.states else [""]
    shafts = range(scene.line.n_joints + 1)
    here, asked = _state_of_rows(scene), scene.shafts or shafts[-1:]

    def item(per: str, number: int, shaft: int, paths: list[str]) -> dict[str, Any]:
        return {"number": number, "name": f"{per} {number}", "shaft": shaft, "paths": paths}

    def rows(quantity: str, ending: str) -> list[dict[str, Any]]:
        items = []
        for shaft in shafts:
            path = f"run:rows[quantity={quantity},shaft={shaft},statistic=peak].value{ending}"
            own = [path if shaft in asked and i == here else "derived:" for i in range(len(names))]
            items.append(item("shaft", shaft, shaft, own))
        return items

    runs = any(data["speed"])
    quantity, unit = (
        ("acceleration_at_steady_drive", "rad_s2") if runs else ("acceleration_ratio", "")
    )
    motion = {
        "output": "acceleration_ratio",
        "heading": "Acceleration" if runs else "Acceleration ratio",
        "bounded": "torsional_excitation" if runs else "",
        "items": rows(quantity, "_rad_s2" if runs else "")[1:],
    }
    yield motion | _shown(unit)
    if not any(data.get("torque") or ()) and not any(map(any, data.get("inertias") or ())):
        return
    if "torque" not in scene.quantities:
        here = None
    yield {"output": "torque", "heading": "Torque", "items": rows("torque", "_Nm")} | _shown("Nm")
    if answer["forces"] and answer["forces"].bearings:
        items = []
        for bearing, (shaft, _) in enumerate(scene.line.bearings):
            path = f"run:forces.bearings[bearing={bearing}].largest"
            each = [f".states[state={name}]" if scene.states else "" for name in names]
            paths = [f"{path}{in_state}.value_N" for in_state in each]
            items.append(item("bearing", bearing, shaft, paths))
        yield {"output": "bearing_force", "heading": "Bearing force", "items": items} | _shown("N")


def _shown(unit: str, digits: str = "") -> dict[str, Any]:
    """A unit with its digits, and the US unit in its place: how many of it that is."""
    found = {"unit": UNITS[unit].symbol, "digits": DIGITS[digits or unit]._asdict(), "us": None}
    if unit in US:
        us = US[unit][0]
        own = DIGITS[f"{digits}_{us}" if f"{digits}_{us}" in DIGITS else digits or us]._asdict()
        found["us"] = {"unit": ENDINGS[us].symbol, "size": ENDINGS[us].size, "digits": own}
    return found


def _scaled(unit: str, digits: str = "") -> dict[str, Any]:
    """A unit with its digits, and how many of it are one inside."""
    return {"factor": UNITS[unit].factor, **_shown(unit, digits)}


def _shims(answer: Answer) -> list[str]:
    """Return sentences on what a workshop can change, and how certain the verdict is."""
    parts = [PARTS[name].sentences(answer[name]) for name in ("moves", "readings")]
    found = [sentence for sentences in parts for sentence in sentences]
    return [*found, "Of the scene as sent. Enter new readings to see what a shim does."]


def _in_units(text: Callable[[Judged, Row], str], value: Judged, row: Row) -> dict[str, str]:
    """Return the text of a figure in SI and in US units."""
    found = {}
    for units in get_args(System):
        with shown_in(units):
            found[units] = text(value, row)
    return found


def _state_of_rows(scene: Scene) -> int | None:
    """The state that is the drawing with its load, of which the rows of ``cardan run`` are."""
    states = scene.states
    if not states:
        return 0
    own = _given(scene.line, scene.load_case)
    each = [_given(states.driveline(i), states.load(i)) for i in range(states.count)]
    return each.index(own) if own in each else None


def _given(line: Driveline, load: Load | None) -> list[Any]:
    """Return inputs of the motion and the torques of a driveline."""
    chain = [line.bends.tolist(), line.twists.tolist(), line.phases.tolist()]
    return [*chain, load and [float(load.torque), float(load.speed), float(load.acceleration)]]


_IMPORT = re.compile(r'(?m)^import (\{[^}]*\}) from "\.+/((\w+)\.js)";')


@cache
def script(*, moves: bool = False) -> str:
    """Return modules as one script, since a page without a server cannot import any.

    They draw the charts of a page, and let the driveline be moved.
    """
    modules = dict.fromkeys(_with_imports("page.js" if moves else "charts.js"))
    start = "modules.charts.start();\n" + "modules.page.start();\n" * moves
    return (
        f'"use strict";\n(() => {{\nconst modules = {{}};\n'
        f"{''.join(map(_enclosed, modules))}{start}}})();"
    )


def _with_imports(name: str) -> Iterator[str]:
    """A module behind those that it imports."""
    for found in _IMPORT.finditer(_text(name)):
        yield from _with_imports(found[2])
    yield name


def _enclosed(name: str) -> str:
    """A module as a function that returns what it exports."""
    # Types, descriptions and indents are for those who read the modules.
    text = re.sub(r"/\*\*(?:(?!\*/)[\s\S])*\*/ ?", "", _text(name))
    text = re.sub(r"(?m)^ *(?:(?:// .*)?\n)?", "", text)
    exported = re.findall(r"(?m)^export (?:async )?\w+ (\w+)", text)
    text = re.sub(r"(?m)^export ", "", text)
    text = _IMPORT.sub(r"const \1 = modules.\3;", text)
    own = name.removesuffix(".js")
    return f"modules.{own} = (() => {{\n{text}return {{ {', '.join(exported)} }};\n}})();\n"


@cache
def _module() -> str:
    return base64.b64encode(_file("cardan.wasm.gz")).decode()


def _text(module: str) -> str:
    return _file(module if module == "cardan.js" else f"page/{module}").decode()


def _file(name: str) -> bytes:
    return resources.files("cardan").joinpath("web", name).read_bytes()

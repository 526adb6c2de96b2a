"""What a page can change in a scene: what is given, and where the text of the scene says it.

A changed scene is its text with other numbers, all else as it stands. The page holds pieces of the
text; where something of a piece has changed, it writes the piece with its new numbers.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Iterator
from typing import Any

import numpy as np

from cardan.app.scene.language.edit import Map, Span, map_of
from cardan.app.scene.language.units import ENDINGS, size_of, split, us_keys
from cardan.app.scene.machine import states_of_steps
from cardan.app.scene.scene import Scene
from cardan.app.scene.sections.bearing import Bearing
from cardan.app.scene.sections.driveline import points_of
from cardan.app.scene.sections.life import gives
from cardan.app.scene.sections.load import LOAD, TORQUES
from cardan.app.scene.study.axes import Axis
from cardan.geometry.wound_up import rotation

_SPEEDS = ("speed_rpm", "speed_rad_s")

Changed = tuple[str, int, int | None]
"""What a number is of: the variable, its item, and of a point the axis."""


def given(scene: Scene) -> dict[str, Any]:
    """Return what the scene gives of what a page can change, in the SI units of its keys.

    ``turned`` says of points that states turn where each is ``before`` and which ``turns`` follow;
    ``steps`` has the state of every step.
    ``factor`` brings a value to SI. By ``per`` it changes when a bearing moves downstream by one
    millimetre. ``columns`` are those of the machine's data that it sets.
    """
    bearings = scene.layout.mounting.bearings if scene.layout else ()
    return {
        "points": scene.points is not None,
        "bearings": [
            {"value": each.value, "factor": each.factor, "per": _per_mm(each)} for each in bearings
        ],
        "turned": _turned(scene),
        "steps": states_of_steps(scene),
        "speed": _of_load(scene, _SPEEDS, "speed"),
        "torque": _of_load(scene, TORQUES, "torque"),
    }


def _turned(scene: Scene) -> dict[int, list[dict[str, Any]]]:
    """Of points that states turn, where each is before and what turns it, in every state."""
    states = scene.states
    axes = [axis for axis in states.axes if axis.rotation] if states else []
    if states is None or not axes:
        return {}
    others = [axis for axis in states.axes if not axis.rotation]
    before = points_of(states.layout.values(others, states.count))
    assert before is not None
    found: dict[int, list[dict[str, Any]]] = {}
    for axis in axes:
        assert axis.rotation is not None
        about, angles = axis.rotation.about.tolist(), np.radians(axis.values)
        turns = [
            {"about": about, "matrix": matrix.tolist()}
            for matrix in rotation(axis.rotation.axis, angles)
        ]
        # A set, whose order would depend on the hashes of a process.
        for point, _ in sorted(axis.entries(scene.line.n_joints + 2)):
            each = found.setdefault(
                point, [{"before": line[point].tolist(), "turns": []} for line in before]
            )
            for state, turn, angle in zip(each, turns, angles, strict=True):
                state["turns"] += [turn] if angle else []
    return found


def _per_mm(bearing: Bearing) -> float:
    size = 1.0 if bearing.unit == "mm" else 1e-3
    return -size if bearing.key.startswith("from_end") else size


def _of_load(scene: Scene, keys: tuple[str, ...], what: Any) -> dict[str, Any] | None:  # noqa: ANN401
    """The speed or the torque of [load], unless it differs from state to state."""
    load = scene.layout.load if scene.layout else None
    key = next((key for key in keys if load and key in load), None)
    varied = {axis.name for axis in scene.states.axes} if scene.states else set()
    if load is None or key is None or key in varied:
        return None
    follows = scene.duty is not None and not gives(scene.duty.values, what)
    return {
        "value": load[key],
        "key": key,
        "unit": ENDINGS[split(key)[1]].symbol,
        "us": _us_unit(key),
        "factor": LOAD.keys[key].factor,
        "columns": [what, *([f"step_{what}"] if follows else [])],
    }


def _us_unit(key: str) -> dict[str, Any] | None:
    """The US unit of what a key in SI units holds: how many of that unit it is."""
    us = [ENDINGS[split(each)[1]] for each in us_keys(key)]
    return {"unit": us[0].symbol, "size": us[0].size} if us else None


def pieces(scene: Scene) -> list[dict[str, Any]]:
    """Return the pieces of the scene's text in which changes are written, in their order.

    A piece replaces ``text[start:end]``. Its ``text`` is what stands there, or the same in a form
    that has a place for every number. ``numbers`` are these places with what they are of. What the
    text has no place for, such as a point that a file of another form gives, is in no piece. The
    unit of a number there is ``size`` of that in which it changes.
    """
    known = map_of(scene.text)
    of_states, elsewhere = _states(scene, known)
    found = [*_points(scene, known), *_phases(scene, known), *of_states, *_others(scene, known)]
    for piece in found:
        numbers = piece["numbers"]
        piece["numbers"] = [each for each in numbers if _changed(each) not in elsewhere]
        for number in piece["numbers"]:
            section, key = _place(scene, number["variable"], number["item"])
            number["size"] = size_of(_as_given(scene, section, key))
    return sorted(
        (piece for piece in found if piece["numbers"]), key=lambda piece: int(piece["start"])
    )


def _place(scene: Scene, variable: str, item: int) -> tuple[str, str]:
    """Return the section and the key that give what changes; "" if no key does."""
    if variable == "bearing" and scene.layout:
        return f"bearing.{item}", scene.layout.mounting.bearings[item].key
    own = given(scene)["torque"] if variable == "torque" else None
    return {
        "point": ("driveline", f"points_{scene.length_unit}"),
        "engaged": ("slip", "engaged_mm"),
        "torque": ("load", own["key"] if own else ""),
    }.get(variable, ("", ""))


def _as_given(scene: Scene, section: str, key: str) -> str:
    """A key as the file has it, in US units or not."""
    return scene.given.get(section, {}).get(key, key)


def _points(scene: Scene, known: Map) -> Iterator[dict[str, Any]]:
    name = f"points_{scene.length_unit}"
    for point, row in enumerate(_items(known, f"driveline.{_as_given(scene, 'driveline', name)}")):
        for number, span in enumerate(row.items):
            yield _piece(scene.text, span, [(span, ("point", point, number))])


def _phases(scene: Scene, known: Map) -> Iterator[dict[str, Any]]:
    count, path = scene.line.n_joints - 1, "driveline.phases_deg"
    each: list[Changed] = [("phase", shaft + 1, None) for shaft in range(count)]
    if path in known.values:
        yield from _listed(scene.text, known.values[path], each)
    elif count and "driveline" in known.ends:
        end = known.ends["driveline"]
        yield _written("\nphases_deg = ", ["0"] * count, each, (end, end))


def _states(scene: Scene, known: Map) -> tuple[list[dict[str, Any]], set[Changed]]:
    """What the states set, and what of it stands elsewhere: in a table that the scene names."""
    joints = scene.line.n_joints
    found: list[dict[str, Any]] = []
    elsewhere: set[Changed] = set()
    for axis in _set_by_states(scene):
        is_point = axis.name != "phases_deg"
        entries = sorted(entry for entry, _ in axis.entries(joints + 2 if is_point else joints - 1))
        each: list[Changed] = [
            ("point", entry, axis.component) if is_point else ("phase", entry + 1, None)
            for entry in entries
        ]
        pieces = list(_of_states(scene, known, axis, each))
        found += pieces
        elsewhere |= set() if pieces else set(each)
    return found, elsewhere


def _others(scene: Scene, known: Map) -> Iterator[dict[str, Any]]:
    own = given(scene)
    paths: dict[tuple[str, str], Changed] = {("slip", "engaged_mm"): ("engaged", 0, None)}
    for name in ("speed", "torque"):
        if own[name]:
            paths["load", own[name]["key"]] = (name, 0, None)
    for number, bearing in enumerate(scene.layout.mounting.bearings if scene.layout else ()):
        paths[f"bearing.{number}", bearing.key] = ("bearing", number, None)
    for (section, key), of in paths.items():
        if span := known.values.get(f"{section}.{_as_given(scene, section, key)}"):
            yield _piece(scene.text, span, [(span, of)])
    if scene.sizes and (span := known.values.get("joints.size")):
        joints: list[Changed] = [("rating", joint, None) for joint in range(scene.line.n_joints)]
        yield from _listed(scene.text, span, joints)


def _set_by_states(scene: Scene) -> list[Axis]:
    names = (f"points_{scene.length_unit}", "phases_deg")
    axes = scene.states.axes if scene.states else ()
    return [each for each in axes if each.name in names and not each.is_added and not each.rotation]


def _of_states(
    scene: Scene, known: Map, axis: Axis, each: list[Changed]
) -> Iterator[dict[str, Any]]:
    """What the states set: the values of one entry, or of several that have them in common."""
    path = f"states.{axis.key}"
    spans = _items(known, path)
    if not spans:
        spans = tuple(
            known.values[key] for key in (f"{path}.from", f"{path}.to") if key in known.values
        )
    if len(each) == 1:
        yield from (_piece(scene.text, span, [(span, each[0])]) for span in spans)
        return
    # Entries that move apart need a line each.
    whole = known.wholes.get(path)
    key = _RANGE.search(scene.text, whole.start, spans[0].start) if whole and spans else None
    if not whole or not key:
        return
    before, after = scene.text[whole.start : key.start()], scene.text[key.end() : whole.end]
    text, numbers = "", list[dict[str, Any]]()
    for of in each:
        entry = of[1] - (1 if of[0] == "phase" else 0)
        text += f"{chr(10) if text else ''}{before}{entry}"
        off = len(text) - key.end()
        numbers += [_number(Span(span.start + off, span.end + off), of) for span in spans]
        text += after
    yield {"start": whole.start, "end": whole.end, "text": text, "numbers": numbers}


_RANGE = re.compile(r"(?<=\.)\d*-\d*(?=[.\s=\"'])")


def _listed(text: str, span: Span, each: list[Changed]) -> Iterator[dict[str, Any]]:
    """A value for each item, or one for all of them."""
    if len(span.items) == len(each):
        for item, of in zip(span.items, each, strict=True):
            yield _piece(text, item, [(item, of)])
    elif not span.items and len(each) == 1:
        yield _piece(text, span, [(span, each[0])])
    elif not span.items:
        yield _written("", [text[span.start : span.end]] * len(each), each, (span.start, span.end))


def _written(
    before: str, values: Iterable[str], each: Iterable[Changed], ends: tuple[int, int]
) -> dict[str, Any]:
    """A piece with a list of values."""
    text = f"{before}["
    numbers: list[dict[str, Any]] = []
    for value, of in zip(values, each, strict=True):
        text += ", " if numbers else ""
        numbers.append(_number(Span(len(text), len(text) + len(value)), of))
        text += value
    return {"start": ends[0], "end": ends[1], "text": f"{text}]", "numbers": numbers}


def _piece(text: str, span: Span, numbers: Iterable[tuple[Span, Changed]]) -> dict[str, Any]:
    """A piece of the text as it stands."""
    at = span.start
    return {
        "start": at,
        "end": span.end,
        "text": text[at : span.end],
        "numbers": [_number(Span(own.start - at, own.end - at), of) for own, of in numbers],
    }


def _number(span: Span, of: Changed) -> dict[str, Any]:
    variable, item, axis = of
    return {"start": span.start, "end": span.end, "variable": variable, "item": item, "axis": axis}


def _changed(number: dict[str, Any]) -> Changed:
    return number["variable"], number["item"], number["axis"]


def _items(known: Map, path: str) -> tuple[Span, ...]:
    span = known.values.get(path)
    return span.items if span else ()


def sizes(scene: Scene) -> dict[str, str]:
    """Return what the text calls the sizes of the joints, by their rating in N m."""
    table = scene.sizes.table if scene.sizes else ()
    return {f"{size.rating:g}": json.dumps(size.name) for size in table if size.rating}

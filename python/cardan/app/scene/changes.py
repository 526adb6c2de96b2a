"""Numbers that a page can change in a scene, and their places in the text of the scene.

A changed scene is its text with other numbers, all else as it stands. The page holds pieces of the
text; where something of a piece has changed, it writes the piece with its new numbers.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from typing import Any, TypeAlias

import numpy as np

from cardan.app.scene.language.edit import Map, Span, map_of
from cardan.app.scene.language.units import ENDINGS, size_of, split, us_keys
from cardan.app.scene.machine import states_of_steps
from cardan.app.scene.scene import Scene
from cardan.app.scene.sections.driveline import points_of
from cardan.app.scene.sections.life import gives
from cardan.app.scene.sections.load import LOAD, TORQUES
from cardan.app.scene.study.axes import Axis
from cardan.geometry.wound_up import rotation

_SPEEDS = ("speed_rpm", "speed_rad_s")

Changed = tuple[str, int, int | None]
"""Owner of a number: the variable, its item, and the axis of a point."""


def given(scene: Scene) -> dict[str, Any]:
    """Return what the scene gives of what a page can change, in the SI units of its keys.

    ``turned`` says of points that states turn where each is ``before`` and which ``turns`` follow;
    ``steps`` has the state of every step.
    ``factor`` brings a value to SI. By ``per`` it changes when a bearing moves downstream by one
    millimetre. ``columns`` are those of the machine's data that it sets.
    """
    bearings = []
    for each in scene.layout.mounting.bearings if scene.layout else ():
        per = (1.0 if each.unit == "mm" else 1e-3) * (-1.0 if each.from_end else 1.0)
        bearings.append({"value": each.value, "factor": each.factor, "per": per})
    return {
        "points": scene.points is not None,
        "bearings": bearings,
        "turned": _turned(scene),
        "steps": states_of_steps(scene),
        "speed": _of_load(scene, _SPEEDS, "speed"),
        "torque": _of_load(scene, TORQUES, "torque"),
    }


def _turned(scene: Scene) -> dict[int, list[dict[str, Any]]]:
    """Return points that states turn: the position before and the turn, in every state."""
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


def _of_load(scene: Scene, keys: tuple[str, ...], what: Any) -> dict[str, Any] | None:  # noqa: ANN401
    """The speed or the torque of [load], unless it differs from state to state."""
    load = scene.layout.load if scene.layout else None
    key = next((key for key in keys if load and key in load), None)
    varied = {axis.name for axis in scene.states.axes} if scene.states else set()
    if load is None or key is None or key in varied:
        return None
    follows = scene.duty is not None and not gives(scene.duty.values, what)
    us = [ENDINGS[split(each)[1]] for each in us_keys(key)]
    return {
        "value": load[key],
        "key": key,
        "unit": ENDINGS[split(key)[1]].symbol,
        # How many of the SI unit one of the US unit is.
        "us": {"unit": us[0].symbol, "size": us[0].size} if us else None,
        "factor": LOAD.keys[key].factor,
        "columns": [what, *([f"step_{what}"] if follows else [])],
    }


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
    made: list[dict[str, Any]] = []
    for start, end, text, places in sorted(found, key=lambda piece: piece[0]):
        numbers = [
            {
                "start": span.start,
                "end": span.end,
                "variable": of[0],
                "item": of[1],
                "axis": of[2],
                "size": size_of(_as_given(scene, *_place(scene, *of[:2]))),
            }
            for span, of in places
            if of not in elsewhere
        ]
        if numbers:
            made.append({"start": start, "end": end, "text": text, "numbers": numbers})
    return made


_Piece: TypeAlias = tuple[int, int, str, list[tuple[Span, Changed]]]
"""Begin and end of a piece, its text, and the places of its numbers."""


def _place(scene: Scene, variable: str, item: int) -> tuple[str, str]:
    """Return the section and the key that give what changes; "" if no key does."""
    if variable == "bearing" and scene.layout:
        return f"bearing.{item}", scene.layout.mounting.bearings[item].key
    own = _of_load(scene, TORQUES, "torque") if variable == "torque" else None
    return {
        "point": ("driveline", f"points_{scene.length_unit}"),
        "engaged": ("slip", "engaged_mm"),
        "torque": ("load", own["key"] if own else ""),
    }.get(variable, ("", ""))


def _as_given(scene: Scene, section: str, key: str) -> str:
    """A key as the file has it, in US units or not."""
    return scene.given.get(section, {}).get(key, key)


def _points(scene: Scene, known: Map) -> Iterator[_Piece]:
    name = _as_given(scene, "driveline", f"points_{scene.length_unit}")
    for point, row in enumerate(_items(known, f"driveline.{name}")):
        for number, span in enumerate(row.items):
            yield _piece(scene.text, span, ("point", point, number))


def _phases(scene: Scene, known: Map) -> Iterator[_Piece]:
    each: list[Changed] = [("phase", shaft, None) for shaft in range(1, scene.line.n_joints)]
    if span := known.values.get("driveline.phases_deg"):
        yield from _listed(scene.text, span, each)
    elif each and (end := known.ends.get("driveline")) is not None:
        yield _written("\nphases_deg = ", "0", each, Span(end, end))


def _states(scene: Scene, known: Map) -> tuple[list[_Piece], set[Changed]]:
    """Return pieces that the states set, and values from a table that the scene names."""
    joints, names = scene.line.n_joints, (f"points_{scene.length_unit}", "phases_deg")
    found: list[_Piece] = []
    elsewhere: set[Changed] = set()
    for axis in scene.states.axes if scene.states else ():
        if axis.name not in names or axis.is_added or axis.rotation:
            continue
        is_point = axis.name != "phases_deg"
        entries = sorted(entry for entry, _ in axis.entries(joints + 2 if is_point else joints - 1))
        each: list[Changed] = [
            ("point", entry, axis.component) if is_point else ("phase", entry + 1, None)
            for entry in entries
        ]
        pieces = list(_of_states(scene.text, known, axis, each))
        found += pieces
        elsewhere |= set() if pieces else set(each)
    return found, elsewhere


def _others(scene: Scene, known: Map) -> Iterator[_Piece]:
    paths: dict[tuple[str, str], Changed] = {("slip", "engaged_mm"): ("engaged", 0, None)}
    for name, keys in (("speed", _SPEEDS), ("torque", TORQUES)):
        if own := _of_load(scene, keys, name):
            paths["load", own["key"]] = (name, 0, None)
    for number, bearing in enumerate(scene.layout.mounting.bearings if scene.layout else ()):
        paths[f"bearing.{number}", bearing.key] = ("bearing", number, None)
    for (section, key), of in paths.items():
        if span := known.values.get(f"{section}.{_as_given(scene, section, key)}"):
            yield _piece(scene.text, span, of)
    if scene.sizes and (span := known.values.get("joints.size")):
        joints: list[Changed] = [("rating", joint, None) for joint in range(scene.line.n_joints)]
        yield from _listed(scene.text, span, joints)


def _of_states(text: str, known: Map, axis: Axis, each: list[Changed]) -> Iterator[_Piece]:
    """Yield pieces set by the states: values of one entry, or of several that share them."""
    path = f"states.{axis.key}"
    ends = (known.values.get(f"{path}.{end}") for end in ("from", "to"))
    spans = _items(known, path) or tuple(filter(None, ends))
    if len(each) == 1:
        yield from (_piece(text, span, each[0]) for span in spans)
        return
    # Entries that move apart need a line each.
    whole = known.wholes.get(path)
    key = _RANGE.search(text, whole.start, spans[0].start) if whole and spans else None
    if not whole or not key:
        return
    before, after = text[whole.start : key.start()], text[key.end() : whole.end]
    lines, numbers = "", list[tuple[Span, Changed]]()
    for of in each:
        entry = of[1] - (1 if of[0] == "phase" else 0)
        lines += f"{chr(10) if lines else ''}{before}{entry}"
        off = len(lines) - key.end()
        numbers += [(Span(span.start + off, span.end + off), of) for span in spans]
        lines += after
    yield whole.start, whole.end, lines, numbers


_RANGE = re.compile(r"(?<=\.)\d*-\d*(?=[.\s=\"'])")


def _listed(text: str, span: Span, each: list[Changed]) -> Iterator[_Piece]:
    """A value for each item, or one for all of them."""
    if len(span.items) == len(each):
        yield from (_piece(text, item, of) for item, of in zip(span.items, each, strict=True))
    elif not span.items and len(each) == 1:
        yield _piece(text, span, each[0])
    elif not span.items:
        yield _written("", text[span.start : span.end], each, span)


def _written(before: str, value: str, each: list[Changed], place: Span) -> _Piece:
    """A piece with a list in which each has the same value."""
    text, numbers = f"{before}[", list[tuple[Span, Changed]]()
    for of in each:
        text += ", " if numbers else ""
        numbers.append((Span(len(text), len(text) + len(value)), of))
        text += value
    return place.start, place.end, f"{text}]", numbers


def _piece(text: str, span: Span, of: Changed) -> _Piece:
    """A number of the text as it stands."""
    own = text[span.start : span.end]
    return span.start, span.end, own, [(Span(0, len(own)), of)]


def _items(known: Map, path: str) -> tuple[Span, ...]:
    span = known.values.get(path)
    return span.items if span else ()


def sizes(scene: Scene) -> dict[str, str]:
    """Return what the text calls the sizes of the joints, by their rating in N m."""
    table = scene.sizes.table if scene.sizes else ()
    return {f"{size.rating:g}": json.dumps(size.name) for size in table if size.rating}

"""The sections [study] and [states]: what each varies, and the table of figures of a scene."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from cardan.app.files.sheets import TABLES, Table, read_table
from cardan.app.scene.language.document import broken, nested
from cardan.app.scene.language.errors import Location
from cardan.app.scene.language.rules import TEXTS, FileName, ListOf, Number, Rule, Text
from cardan.app.scene.language.section import Key, Reading, Section, check_count
from cardan.app.scene.language.units import alike, si_key, units_of
from cardan.app.scene.sections.bearing import BEARING
from cardan.app.scene.sections.driveline import DRIVELINE, FEET, GAUGE, LENGTHS, TEETH
from cardan.app.scene.sections.joints import JOINTS
from cardan.app.scene.sections.load import ANGLES, LOAD, SWEEP, TORQUES, check_not_recorded
from cardan.app.scene.sections.output import OUTPUT, caused, has_table
from cardan.app.scene.sections.wind_up import WIND_UP
from cardan.app.scene.study.axes import (
    BEARING_AXES,
    LIST_AXES,
    NUMBER_AXIS,
    VECTOR_AXES,
    Axis,
    Varied,
    axes_of,
    check_apart,
    grid_of,
)
from cardan.app.scene.study.states import States
from cardan.app.scene.study.study import SceneLayout, Study
from cardan.arrays import FloatArray
from cardan.arrays.errors import ArgumentError, ArgumentValueError, nearest

_CLOSED_FORMS = ("equivalent_bend", "non_uniformity", "max_angle_error")


def varied_keys(
    meaning: str, without: tuple[str, ...] = (TEETH, GAUGE, FEET, *LENGTHS)
) -> dict[str, Key]:
    """Return the keys that a study or states may vary."""
    found = {}
    for section in (DRIVELINE, LOAD):
        for name, key in section.keys.items():
            rule: Rule = NUMBER_AXIS if key.rule == Number() else LIST_AXES
            if key.kind == "vectors":
                rule = VECTOR_AXES
            if name == si_key(name) and name not in without:
                found[name] = Key(rule, f"{meaning} this key of [{section.name}]")
    return found


# --- columns of a table ---------------------------------------------------------------------------


def _of_table(rows: str) -> dict[str, Key]:
    """The keys that name a table; ``rows`` says what its rows are."""
    return {
        "file": Key(
            FileName(TABLES, folders=True),
            f"table whose column headings are keys as here, {rows}; path from the folder of the "
            f"scene, its name ends in {' or '.join(TABLES)}",
            kind="file",
        ),
        "sheet": Key(Text(), "name of the sheet, if an .xlsx file has several"),
    }


_IN_ROWS = {
    "study": _of_table("with the values of each key below it, from which the grid is made"),
    "states": _of_table("with one state per row"),
}


def with_columns(section: Section[Any], values: Mapping[str, Any], folder: Path) -> dict[str, Any]:
    """Return the values of [study] or [states] with those of the table that it names.

    A column of a study ends with its last value. States need a value in each row.

    Raises:
        ImportError: openpyxl is missing.
        OSError: the table cannot be read.
        ValueError: as for ``read_table``; a head that is no key or is given already, or a value
            that breaks the rule of its key.
    """
    table = read_table(folder / values["file"], values.get("sheet"))
    of_table = _IN_ROWS[section.name]
    found = {key: value for key, value in values.items() if key not in of_table}
    known = [key for key in section.keys if key not in of_table]
    for head in table.columns:
        key, _, _ = head.partition(".")
        if key not in known:
            hint = units_of(key, known) or nearest(key, alike(key, known))
            raise table.error(head, f"is no key of [{section.name}]; {hint}")
        for other in found:
            if other != key and si_key(other) == si_key(key):
                raise table.error(head, f"and {other} are both given; give one of them")
        read = _column(section, table, head)
        if not isinstance(read, dict):
            if key in found:
                raise table.error(head, _TWICE)
            found[key] = read
            continue
        there = found.setdefault(key, {})
        for place, steps in read.items():
            if place in there:
                raise table.error(head, _TWICE)
            found[key] = there = {**there, place: steps}
    for problem in broken(section, {si_key(key): key for key in found}):
        raise problem
    return found


_TWICE = "gives what the scene or another column gives as well"


def _column(section: Section[Any], table: Table, head: str) -> Any:  # noqa: ANN401 - of the rule
    """The cells of a column as the rule of its key reads them."""
    key = head.partition(".")[0]
    rule = section.keys[key].rule
    cells = table.texts(head) if rule is TEXTS else table.numbers(head)
    last = max((row for row, cell in enumerate(cells) if cell is not None), default=-1)
    if last < 0:
        raise table.error(head, "has no values")
    if section is STUDY:
        cells = cells[: last + 1]
    for row, cell in enumerate(cells):
        if cell is None:
            needs = "values follow below it" if section is STUDY else "each state needs a value"
            raise table.error(head, f"is empty; {needs}", row)
    try:
        return rule.read(Location(key), nested({head: cells})[key])
    except ArgumentError as error:
        at = next((part for part in error.place if isinstance(part, int)), None)
        raise table.error(head, error.problem, at) from None


# --- the sections ---------------------------------------------------------------------------------


def _check_units(varied: Varied, scene: Reading) -> None:
    """Refuse what varies in another unit than the scene gives it."""
    for key, places in varied.items():
        for place in places if key == BEARING.name else ("",):
            path = f"{key}.{place}" if place else key
            scene.check_unit(path, Location.of(path))


def _study(varied: Mapping[str, Any], scene: Reading) -> Study | None:
    check_not_recorded(varied, scene)
    _check_units(varied, scene)
    recorded_bends, output = scene.line.shape, scene.given.get(OUTPUT.name, {})
    if varied and recorded_bends:
        raise ArgumentValueError(next(iter(varied)), "does not go with recorded bends")
    if not has_table(scene):
        return None
    described, loaded, asked = scene[DRIVELINE], scene[LOAD], scene[OUTPUT]
    angles, recorded = scene[SWEEP], scene[ANGLES]
    keys = described.keys
    if recorded and recorded.bends is not None:
        keys = {**keys, described.form.keys[0]: recorded.bends[recorded.known]}
    lengths = {k: v for k, v in scene.given.get(DRIVELINE.name, {}).items() if k in LENGTHS}
    # Motion is in the closed forms already, unless the scene asks for it.
    quantities = asked.quantities
    if not output.keys() & {"quantities", "reduce"}:
        of_states = {k: v for k, v in scene.given.get("states", {}).items() if k in LOAD.keys}
        quantities = caused(loaded.keys and {**of_states, **loaded.keys})
    bearings = scene.document.tables.get(BEARING.name, ())
    every_joint = tuple(range(scene.line.n_joints))
    study = Study(
        grid_of(varied, {**described.keys, **lengths}, loaded.keys, bearings),
        SceneLayout(described.form, keys, loaded.to_reduce, scene[BEARING].mounting),
        angles.to_reduce,
        quantities,
        tuple(output.get("reduce", ("peak",))),
        tuple(output.get("closed_forms", () if recorded_bends else _CLOSED_FORMS)),
        asked.shafts,
        every_joint if asked.joints is None else asked.joints,
        {**asked.options, **({} if angles.driven is None else {"angle_of": "driven"})},
        scene[JOINTS].deviations,
    )
    # The ends of the grid, so that a value out of range shows before a long run.
    study.check_ends()
    return study


STUDY: Section[Study | None] = Section(
    "study",
    "keys to vary; several keys make a grid, with one driveline per row of the table",
    {
        **_IN_ROWS["study"],
        **varied_keys("values for", without=(TEETH, GAUGE, FEET)),
        "bearing": Key(BEARING_AXES, "values for the position of a [[bearing]], by its number"),
    },
    _study,
    together=(*LOAD.together, LENGTHS),
    with_key=(("sheet", "file"),),
    fewest=1,
    always=True,
    help_on_paths="Give a key of [driveline], [load] or a [[bearing]] the value "
    "{from = …, to = …, steps = …} (both ends included) or a list of numbers. bends_deg varies all "
    "entries of a list alike, bends_deg.0 the first, and bends_deg.0-1 the first two. "
    "points_mm.2.y varies one coordinate of a point. {add = …} adds to the value of [driveline], "
    'and {turn_deg = …, about_mm = [0, 0, 0], axis = "y"} turns points. The key bearing moves '
    "bearings: bearing.0.position_mm.",
)


_OF_STATES = {
    "names": Key(TEXTS, "name of each state; default: the value of the key, or state 0"),
    "weights": Key(
        ListOf(Number(0, what="a weight"), "numbers"),
        "how much each state counts when one setting must serve all; default 1",
    ),
}


def _states(values: Mapping[str, Any], scene: Reading) -> States:
    check_not_recorded(values, scene)
    layout = scene.layout
    assert layout
    varied: Varied = {key: value for key, value in values.items() if key not in _OF_STATES}
    if not varied:
        raise ValueError('no key varies; give one value per state, as in "points_mm.2.y" = [0, 40]')
    _check_units(varied, scene)
    axes = axes_of(varied, layout.driveline, layout.load, "a state")
    first, count = axes[0], len(axes[0].values)
    for axis in axes[1:]:
        if len(axis.values) != count:
            raise axis.location.error(
                f"has {len(axis.values)} values and {first.key} {count}; each state needs one"
            )
    for key in _OF_STATES:
        check_count(key, values.get(key), count, "one per state")
    weights = np.array(values.get("weights", [1.0] * count))
    if not np.any(weights > 0.0):
        raise ArgumentValueError("weights", "has only zeros; at least one state must count")
    names = tuple(values.get("names") or _names(axes))
    if wind_ups := scene[WIND_UP]:
        torque = _torques(axes, layout.load or {}, count)
        for each in wind_ups:
            axes += axes_of(each.at(torque), layout.driveline, None, "a state")
        check_apart(axes, {**layout.driveline, **(layout.load or {})})
    states = States(names, weights, axes, layout)
    states.drivelines()
    for i in range(count):
        states.load(i)
    return states


def _torques(axes: tuple[Axis, ...], load: Mapping[str, Any], count: int) -> FloatArray:
    """The torque in every state, as [states] or else [load] gives it."""
    for axis in axes:
        if axis.name in TORQUES:
            return axis.size * axis.values
    given = [load[key] for key in TORQUES if key in load]
    if not given:
        raise ValueError(
            "no torque for [[wind_up]] to follow; give each state one: output_torque_Nm = [0, 1500]"
        )
    return np.full(count, given[0])


def _names(axes: tuple[Axis, ...]) -> list[str]:
    if len(axes) == 1 and len(set(axes[0].values)) == len(axes[0].values):
        return [f"{axes[0].key} = {value:.6g}" for value in axes[0].values]
    return [f"state {i}" for i in range(len(axes[0].values))]


STATES: Section[States | None] = Section(
    "states",
    "positions in which the same driveline runs, such as ride heights: one value per state "
    "for each key",
    {**_IN_ROWS["states"], **_OF_STATES, **varied_keys("one value per state for")},
    _states,
    together=LOAD.together,
    with_key=(("sheet", "file"),),
    fewest=1,
    paths=True,
    recorded_bends=False,
    help_on_paths="Give keys of [driveline] or [load] their values in each state, as in [study]; "
    "all lists have one entry per state. A list holds values; {add = [-60, 0, 60]} is for changes. "
    "Paths may be in quotes.",
)

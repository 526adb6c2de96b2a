"""The section [study]: the keys that it varies, and the table of figures that a scene wants."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from cardan.app.scene.language.rules import Number, Rule
from cardan.app.scene.language.section import Key, Section
from cardan.app.scene.sections.angles import ANGLES
from cardan.app.scene.sections.bearing import BEARING
from cardan.app.scene.sections.driveline import DRIVELINE, LENGTHS, TEETH
from cardan.app.scene.sections.joints import JOINTS
from cardan.app.scene.sections.load import LOAD, check_not_recorded
from cardan.app.scene.sections.output import OUTPUT, caused, has_table
from cardan.app.scene.sections.sweep import SWEEP
from cardan.app.scene.study.axes import BEARING_AXES, LIST_AXES, NUMBER_AXIS, VECTOR_AXES, grid_of
from cardan.app.scene.study.study import Study
from cardan.arrays.errors import ArgumentValueError

if TYPE_CHECKING:
    from cardan.app.scene.reading import Reading

_CLOSED_FORMS = ("equivalent_bend", "non_uniformity", "max_angle_error")


def varied_keys(meaning: str, without: tuple[str, ...] = (TEETH, *LENGTHS)) -> dict[str, Key]:
    """Return the keys that a study or states may vary."""
    found = {}
    for section in (DRIVELINE, LOAD):
        for name, key in section.keys.items():
            rule: Rule = NUMBER_AXIS if key.rule == Number() else LIST_AXES
            if key.kind == "vectors":
                rule = VECTOR_AXES
            if name not in without:
                found[name] = Key(rule, f"{meaning} this key of [{section.name}]")
    return found


def _study(varied: Mapping[str, Any], scene: Reading) -> Study | None:
    check_not_recorded(varied, scene)
    recorded_bends, output = scene.line.shape, scene.given.get(OUTPUT.name, {})
    if varied and recorded_bends:
        raise ArgumentValueError(next(iter(varied)), "does not go with recorded bends")
    if not has_table(scene):
        return None
    described, loaded, asked = scene[DRIVELINE], scene[LOAD], scene[OUTPUT]
    angles, recorded = scene[SWEEP], scene[ANGLES]
    keys = described.keys
    if recorded and recorded.bends_to_reduce is not None:
        keys = {**keys, described.form.keys[0]: recorded.bends_to_reduce}
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
        described.form,
        keys,
        loaded.to_reduce,
        angles.to_reduce,
        quantities,
        tuple(output.get("reduce", ("peak",))),
        tuple(output.get("closed_forms", () if recorded_bends else _CLOSED_FORMS)),
        asked.shafts,
        every_joint if asked.joints is None else asked.joints,
        {**asked.options, **({} if angles.driven is None else {"angle_of": "driven"})},
        scene[BEARING].mounting,
        scene[JOINTS].deviations,
    )
    # The ends of the grid, so that a value out of range shows before a long run.
    study.check_ends()
    return study


STUDY: Section[Study | None] = Section(
    "study",
    "keys to vary; several keys make a grid, with one driveline per row of the table",
    {
        **varied_keys("values for", without=(TEETH,)),
        "bearing": Key(BEARING_AXES, "values for the position of a [[bearing]], by its number"),
    },
    _study,
    together=(*LOAD.together, LENGTHS),
    fewest=1,
    always=True,
    help_on_paths="Give a key of [driveline], [load] or a [[bearing]] the value "
    "{from = …, to = …, steps = …} (both ends included) or a list of numbers. bends_deg varies all "
    "entries of a list alike, bends_deg.0 the first, and bends_deg.0-1 the first two. "
    "points_mm.2.y varies one coordinate of a point. The key bearing moves bearings: "
    "bearing.0.position_mm.",
)
"""The section [study]."""

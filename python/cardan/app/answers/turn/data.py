"""The answer of ``cardan run`` as plain data, and its JSON Schema."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any, get_args

from cardan.app.answers.answer import Answer
from cardan.app.answers.json_schema import ANGLE, answer, answers_with, one_of, record
from cardan.app.answers.states.figures import STATES_SCHEMA, states_data
from cardan.app.answers.study.extremes import StudyTable, study_data
from cardan.app.answers.table import PARTS
from cardan.app.answers.turn.figures import SummaryRow, drive_angles, summary_data
from cardan.app.scene.recording.signals import Measured
from cardan.app.scene.study.reductions import CLOSED_FORMS, REDUCTIONS
from cardan.app.scene.study.states import StatesResult
from cardan.evaluation.outputs import OUTPUTS


def run_data(
    found: Answer,
    rows: Sequence[SummaryRow],
    study: StudyTable | None,
    files: Iterable[Mapping[str, Any]],
    *,
    radians: bool = False,
) -> dict[str, Any]:
    """Return what ``cardan run`` found, as plain data for JSON.

    Args:
        found: the answer to the scene.
        rows: its table.
        study: its study, if it was evaluated.
        files: the files written.
        radians: whether angles are in radians.
    """
    scene = found.scene
    data = answer("run", scene.title, drive_angles=drive_angles(scene, radians=radians))
    data["rows"] = summary_data(rows, radians=radians)
    if isinstance(study, StatesResult):
        data["states"] = states_data(study, radians=radians)
    elif study and scene.study:
        data["study"] = study_data(study, len(scene.study.angle), radians=radians)
    data |= {part.name: part.data(each, radians=radians) for part, each in found.parts("run")}
    return {**data, "files": list(files)}


def ball_joint_run_data(
    found: Answer, files: Iterable[Mapping[str, Any]], *, radians: bool = False
) -> dict[str, Any]:
    """Return what ``cardan run`` found of a ball joint alone, as plain data for JSON."""
    parts = {part.name: part.data(each, radians=radians) for part, each in found.parts("run")}
    return answer("run", found.of.title, **parts, files=list(files))


_NUMBER = {"type": ["number", "null"], "description": "null if it is not finite"}
_COUNT = {"type": "integer", "minimum": 0}
_VALUE = {
    f"value{ending}": _NUMBER
    for ending in ("", "_deg", "_rad", "_rpm", "_rad_s2", "_Nm", "_N", "_m", "_mm")
}
_OF_DRIVELINE = ("bend", "twist", "phase", "equivalent_bend", "non_uniformity")
_OF_DRIVE = ("speed", "acceleration_at_steady_drive")
_ITEM = {"shaft": _COUNT, "joint": _COUNT, "bearing": _COUNT}
_SIGNAL = record(
    {
        "signal": {"enum": list(get_args(Measured))},
        "column": {
            "type": ["string", "null"],
            "description": "the recorded column; null of what was derived from others",
        },
        "unit": {"enum": ["s", "rpm", "rad/s", "rad/s²", "N m"]},
        **{end: {"type": "number"} for end in ("first", "last", "min", "max")},
    },
    {
        "filter_samples": {
            **_COUNT,
            "description": "samples of the parabola that derived it by differentiating",
        },
        "samples_per_second": {
            "type": ["number", "null"],
            "description": "of times, without gaps; null of a single one",
        },
        "gaps": {**_COUNT, "description": "of times: steps far longer than those around them"},
        "longest_gap_s": {"type": "number"},
        "longest_gap_after_s": {
            "type": "number",
            "description": "the time of the sample before the longest gap",
        },
    },
)
_AT = {
    "type": "array",
    "description": "the keys on which the figure depends there",
    "items": record({"key": {"type": "string"}, "value": {"type": "number"}}),
}
_END = one_of({"at": _AT}, _VALUE)


def run_schema() -> dict[str, Any]:
    """Return the JSON Schema of ``run_data``."""
    return answers_with(
        "run",
        "what cardan run prints with --json",
        {
            "drive_angles": one_of(
                {
                    "source": {"enum": ["sweep", "recording"]},
                    "samples": {**_COUNT, "minimum": 1},
                    "missing_samples": _COUNT,
                    "turns": {
                        "type": "number",
                        "description": "the way of the drive, forward and back",
                    },
                    "samples_per_turn": {"type": ["number", "null"]},
                },
                *(
                    {f"{end}_{angle}": {"type": "number"} for angle in ANGLE}
                    for end in ("first", "last")
                ),
                optional={
                    **{
                        f"{end}_{angle}": {
                            "type": "number",
                            "description": "of a recorded drive that turns back",
                        }
                        for angle in ANGLE
                        for end in ("min", "max")
                    },
                    **{
                        f"period_{angle}": {
                            "type": "number",
                            "description": "after which extremes recur, if joints have deviations; "
                            "otherwise half a turn",
                        }
                        for angle in ANGLE
                    },
                    "signals": {"type": "array", "items": _SIGNAL},
                    "angle_of": {
                        "const": "driven",
                        "description": "the scene gives angles of the last shaft; these drive "
                        "angles follow from them",
                    },
                },
            ),
            "rows": {
                "type": "array",
                "items": one_of(
                    {
                        "quantity": {"enum": [*_OF_DRIVELINE, *OUTPUTS, *_OF_DRIVE]},
                        "statistic": {
                            "enum": ["value", "min", "max", "peak"],
                            "description": "peak is the largest magnitude",
                        },
                        "of": {"enum": ["driveline", "turn", "samples"]},
                    },
                    _ITEM,
                    _VALUE,
                    optional={
                        f"at_drive_angle_{angle}": {
                            "type": "number",
                            "description": "absent if every angle has it, or none of the scene",
                        }
                        for angle in ANGLE
                    },
                ),
            },
        },
        {"ball_joint": PARTS["ball_joint"].schema()},
        needed={
            "files": {
                "type": "array",
                "items": record(
                    {"file": {"type": "string"}}, dict.fromkeys(("rows", "parts", "found"), _COUNT)
                ),
            },
        },
        optional={
            **{name: part.schema() for name, part in PARTS.items() if "run" in part.shown},
            "states": STATES_SCHEMA,
            "study": record(
                {
                    "drivelines": _COUNT,
                    "samples": {
                        **_COUNT,
                        "description": "drive angles over which figures are reduced",
                    },
                    "axes": {
                        "type": "array",
                        "items": record(
                            {
                                "key": {"type": "string"},
                                "values": _COUNT,
                                "min": {"type": "number"},
                                "max": {"type": "number"},
                            }
                        ),
                    },
                    "figures": {
                        "type": "array",
                        "items": one_of(
                            {
                                "column": {
                                    "type": "string",
                                    "description": "its heading in the table",
                                },
                                "quantity": {"enum": [*CLOSED_FORMS, *OUTPUTS]},
                                "statistic": {"enum": ["value", *REDUCTIONS]},
                                "of": {"enum": ["turn", "samples"]},
                                "least": _END,
                                "largest": _END,
                            },
                            _ITEM,
                            optional={"component": {"enum": ["x", "y", "z"]}},
                        ),
                    },
                }
            ),
        },
    )

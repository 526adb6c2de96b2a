"""What a recording shows of the joints of a driveline, as plain data."""

from __future__ import annotations

from collections.abc import Mapping
from os import PathLike, fspath
from typing import Any

import numpy as np

from cardan.app.answers.json_schema import ANGLE, answer, answer_schema, one_of
from cardan.app.answers.study.extremes import finite_or_none
from cardan.app.files.recording import read_columns
from cardan.motion.identification import Identification, TwoJoints, identify, identify_two_joints

LARGEST_ORDER = 4
"""The largest order that an answer holds."""


def identification_data(
    path: str | PathLike[str],
    drive: str,
    *,
    driven: str | None = None,
    speed_ratio: str | None = None,
    intermediate: str | None = None,
    radians: bool = False,
) -> dict[str, Any]:
    """Find the joints that a file's columns show, and return them as ``IDENTIFY_SCHEMA`` says.

    Args:
        path: a recording in CSV, Parquet, NPZ or MDF.
        drive: name of the column with the drive angle.
        driven: name of the column with the angle of the driven shaft.
        speed_ratio: or: name of the column with its speed over that of the drive.
        intermediate: with ``driven``: name of the column with the angle of the shaft between two
            joints, which tells both bends.
        radians: whether the angles of the file and of the answer are in radians.

    Raises:
        ImportError: Parquet without pyarrow, MDF without asammdf.
        OSError: the file cannot be read.
        ValueError: columns that are missing or do not fit, less than a turn, too few samples.
    """
    names = [name for name in (drive, driven, speed_ratio, intermediate) if name is not None]
    columns = dict(zip(names, read_columns(path, names), strict=True))
    both = None
    if intermediate is not None and driven is not None:
        angles = (columns[drive], columns[intermediate], columns[driven])
        both = identify_two_joints(*angles, degrees=not radians)
        found = both.whole
    elif speed_ratio is not None:
        found = identify(columns[drive], speed_ratio=columns[speed_ratio], degrees=not radians)
    else:
        found = identify(columns[drive], angle=columns[names[1]], degrees=not radians)
    return answer(
        "identify",
        fspath(path),
        samples=found.samples,
        missing_samples=len(columns[drive]) - found.samples,
        turns=found.turns,
        equivalent_joint=_joint(found, speed_ratio is not None, radians),
        two_joints=None if both is None else _two_joints(both, radians),
    )


def _joint(found: Identification, of_ratio: bool, radians: bool) -> dict[str, Any]:
    unit, angle = ("rad", float) if radians else ("deg", np.degrees)
    # Speed ratios have no unit.
    ending, size = ("", float) if of_ratio else (f"_{unit}", angle)
    return {
        f"equivalent_bend_{unit}": float(angle(found.bend)),
        f"standard_deviation_{unit}": finite_or_none(float(angle(found.std))),
        f"detection_limit_{unit}": float(angle(found.detection_limit)),
        "detected": found.detected,
        f"angle_offset_{unit}": float(angle(found.angle_offset)),
        "purity": finite_or_none(found.purity),
        "purity_standard_deviation": finite_or_none(found.std_purity),
        f"residual{ending}": float(size(found.residual)),
        "orders": [
            {"order": order, f"amplitude{ending}": float(size(abs(found.orders[order])))}
            for order in range(1, LARGEST_ORDER + 1)
        ],
    }


def _two_joints(found: TwoJoints, radians: bool) -> dict[str, Any]:
    unit, angle = ("rad", np.asarray) if radians else ("deg", np.degrees)
    return {
        "joints": [
            {
                "joint": joint,
                f"bend_{unit}": float(angle(found.bends[joint])),
                f"standard_deviation_{unit}": finite_or_none(float(angle(found.std[joint]))),
            }
            for joint in range(2)
        ],
        f"phase_less_twist_{unit}": finite_or_none(float(angle(found.phase_less_twist))),
    }


_NUMBER = {"type": "number"}
_OR_NULL = {"type": ["number", "null"]}
_COUNT = {"type": "integer", "minimum": 0}


def _either(name: str, schema: Mapping[str, Any] = _NUMBER) -> dict[str, Any]:
    return {f"{name}_{unit}": schema for unit in ANGLE}


def _listed(schema: Mapping[str, Any]) -> dict[str, Any]:
    return {"type": "array", "items": schema}


_SHARED = {
    "detected": {"type": "boolean"},
    "purity": {"description": "1 for a chain of joints and nothing else", **_OR_NULL},
    "purity_standard_deviation": _OR_NULL,
    "orders": _listed(one_of({"order": _COUNT}, {"amplitude": _NUMBER, **_either("amplitude")})),
}
_JOINT = one_of(
    _SHARED,
    _either("equivalent_bend"),
    _either("standard_deviation", _OR_NULL),
    _either("detection_limit"),
    _either("angle_offset"),
    {"residual": _NUMBER, **_either("residual")},
)
_BEND = one_of({"joint": _COUNT}, _either("bend"), _either("standard_deviation", _OR_NULL))
_TWO = one_of({"joints": _listed(_BEND)}, _either("phase_less_twist", _OR_NULL))

IDENTIFY_SCHEMA = answer_schema(
    "identify",
    "what cardan identify prints with --json; the title is the file",
    {
        "samples": _COUNT,
        "missing_samples": _COUNT,
        "turns": _NUMBER,
        "equivalent_joint": _JOINT,
        "two_joints": {"oneOf": [_TWO, {"type": "null"}]},
    },
)
"""JSON Schema of ``identification_data``."""

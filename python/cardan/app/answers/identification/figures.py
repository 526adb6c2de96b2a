"""What a recording shows of the joints of a driveline."""

from __future__ import annotations

import math
from dataclasses import dataclass
from os import PathLike, fspath
from typing import Any, Literal

from cardan.app.answers.data import data_of, schema_of
from cardan.app.answers.json_schema import answer, answer_schema
from cardan.app.answers.rows import count, figure, flag, item, parts, word
from cardan.app.files.recording import read_columns
from cardan.motion.identification import identify, identify_two_joints

_LARGEST_ORDER = 4


@dataclass(frozen=True)
class Order:
    """The amplitude of one order of what was recorded."""

    order: int = item("order")
    unit: str = word("unit", is_detail=True)
    amplitude: float = figure(
        "amplitude", "own", "joints have even orders, eccentric encoders orders 1 and 3"
    )


@dataclass(frozen=True)
class JointBend:
    """The bend of one of two joints."""

    joint: int = item("joint")
    bend: float = figure("bend", "deg")
    standard_deviation: float | None = figure("standard deviation", "deg")


@dataclass(frozen=True)
class Identified:
    """What a recording shows of the joints of a driveline; ``path`` is its file."""

    path: str
    samples: int = count("samples", "rows of the file that are known")
    missing_samples: int = count("missing samples", "rows of the file that are not")
    turns: float = figure("turns of the drive", meaning="at least 1")
    equivalent_bend: float = figure(
        "equivalent bend", "deg", "bend of the single joint that turns the last shaft as unevenly"
    )
    standard_deviation: float | None = figure(
        "standard deviation of the bend", "deg", "by the noise"
    )
    detection_limit: float = figure(
        "smallest bend detected", "deg", "that the noise alone may imitate"
    )
    detected: bool = flag("detected", "whether the bend is larger than the noise permits to detect")
    angle_offset: float = figure(
        "offset of the drive angle",
        "deg",
        "to add to the recorded angle, so that the driving pin is in the bend plane at 0°",
    )
    phase_less_twist: float | None = figure(
        "phase less twist", "deg", "of two joints, modulo 180°; 0° where they should cancel"
    )
    purity: float | None = figure(
        "purity",
        meaning="order 4 over what order 2 demands; 1 for a chain of joints and nothing else",
    )
    purity_standard_deviation: float | None = figure(
        "standard deviation of the purity", meaning="by the noise"
    )
    unit: str = word("unit", "of the residual and the orders", is_detail=True)
    residual: float = figure("not explained, rms", "own", "what remains without the joints")
    recorded: Literal["angle error", "speed ratio"] = word(
        "recorded", "what the orders and the residual are of"
    )
    orders: tuple[Order, ...] = parts("Orders of what was recorded")
    joints: tuple[JointBend, ...] = parts("Joints")


def identified(
    path: str | PathLike[str],
    drive: str,
    *,
    driven: str | None = None,
    speed_ratio: str | None = None,
    intermediate: str | None = None,
    radians: bool = False,
) -> Identified:
    """Find the joints that a file's columns show.

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
    # Speed ratios have no unit.
    unit = "" if speed_ratio is not None else "rad" if radians else "deg"
    return Identified(
        fspath(path),
        found.samples,
        len(columns[drive]) - found.samples,
        found.turns,
        found.bend,
        _known(found.std),
        found.detection_limit,
        found.detected,
        found.angle_offset,
        None if both is None else _known(both.phase_less_twist),
        _known(found.purity),
        _known(found.std_purity),
        unit,
        found.residual,
        "speed ratio" if speed_ratio is not None else "angle error",
        tuple(Order(n, unit, abs(found.orders[n])) for n in range(1, _LARGEST_ORDER + 1)),
        ()
        if both is None
        else tuple(JointBend(n, both.bends[n], _known(both.std[n])) for n in range(2)),
    )


def _known(value: float) -> float | None:
    return value if math.isfinite(value) else None


def identification_data(found: Identified, *, radians: bool = False) -> dict[str, Any]:
    """Return an identification as plain data for JSON."""
    return answer("identify", found.path, **data_of(found, radians=radians))


_SCHEMA = schema_of(Identified)

IDENTIFY_SCHEMA = answer_schema(
    "identify",
    "what cardan identify prints with --json; the title is the file",
    {key: _SCHEMA["properties"][key] for key in _SCHEMA["required"]},
    {key: each for key, each in _SCHEMA["properties"].items() if key not in _SCHEMA["required"]},
) | {"allOf": _SCHEMA["allOf"]}
"""JSON Schema of ``identification_data``."""

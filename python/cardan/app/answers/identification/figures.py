"""What a recording shows of the joints of a driveline."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from os import PathLike, fspath
from typing import Literal

from cardan.app.answers.rows import count, figure, flag, item, parts, word
from cardan.app.files.recording import read_columns
from cardan.motion.identification import identify, identify_two_joints

_LARGEST_ORDER = 4

# A recording whose purity is farther from 1, and by more than the noise can do, shows something
# besides the joints.
_PURE = 0.2
_SIGMAS = 3.0


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
    """Find the joints that the columns of a file show, as ``cardan identify`` names them.

    The angles of the file and of the answer are in degrees unless ``radians`` says otherwise.
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


def sentences(found: Identified) -> Iterator[str]:
    """Say what the recording shows and what it cannot show."""
    if not found.detected:
        yield "The bend is not larger than the noise permits to detect."
    else:
        yield (
            "The offset is what to add to the recorded drive angle so that the driving pin lies in "
            "the bend plane of the equivalent joint at 0°."
        )
    if found.detected and found.purity is not None:
        noise = _SIGMAS * (found.purity_standard_deviation or 0.0)
        if abs(found.purity - 1.0) > max(_PURE, noise):
            yield (
                "The purity is not 1: order 4 does not fit order 2, so the recording shows "
                "something besides universal joints."
            )
        elif noise > 1.0:
            yield (
                "The noise hides order 4, so the purity does not tell whether order 2 comes from "
                "joints. A longer recording, with more samples, does."
            )
    yield (
        "An ovality of an encoder has order 2 as well. A recording with straight joints tells it "
        "from a bend."
    )
    if found.joints:
        yield "Phase and twist cannot be told apart: only their difference shows."
    else:
        yield (
            "Bends and phases of several joints cannot be told apart by two encoders: only the "
            "equivalent bend shows."
        )

"""Joints of a driveline, identified from a recording."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations
from os import PathLike, fspath
from statistics import fmean
from typing import Literal

import numpy as np

from cardan._core import Integral
from cardan.app.answers.printed import filled, given, part_text, plain_text, quantity
from cardan.app.answers.rows import count, figure, flag, item, optional, parts, taken, word
from cardan.app.files.recording import read_columns
from cardan.app.scene.language.units import RPM
from cardan.design.limits import MAX_EQUIVALENT_BEND
from cardan.motion.identification import Part, identify, identify_two_joints, two_joints

_LARGEST_ORDER = 4

# A recording whose purity is farther from 1, and by more than the noise can do, shows something
# besides the joints.
_PURE = 0.2
_SIGMAS = 3.0

# Turns that show whether the noise of neighbouring samples is related, and a drift to speak of.
_ENOUGH_TURNS = 1.9
_DRIFTS = 1e-3


@dataclass(frozen=True)
class Order:
    """The amplitude of one order of what was recorded."""

    order: int = item("order")
    unit: str = word("unit", is_detail=True)
    amplitude: float = figure(
        "amplitude",
        "own",
        "joints have even orders, eccentric encoders orders 1 and 3",
        digits="measured",
    )


@dataclass(frozen=True)
class JointBend:
    """The bend of one of two joints."""

    joint: int = item("joint")
    bend: float = figure("bend", "deg", digits="measured")
    standard_deviation: float | None = figure("standard deviation", "deg", digits="measured")
    interval_low: float = figure("95% interval from", "deg", digits="measured", end="interval_high")
    interval_high: float = figure("95% interval to", "deg", digits="measured", end="interval_low")


@dataclass(frozen=True)
class BendOfPart:
    """The bend that some turns of a recording show."""

    speed: float | None = optional(figure("drive speed", "rpm", "the mean of these turns"))
    least_speed: float | None = optional(figure("least driven speed", "rpm", "by the bend"))
    largest_speed: float | None = optional(figure("largest driven speed", "rpm", "by the bend"))
    turn: float | None = optional(
        figure("turn", "", "the mean of these turns, where no speed is known")
    )
    bend: float = figure("bend", "deg", digits="measured")
    standard_deviation: float | None = figure("standard deviation", "deg", digits="measured")
    angle_offset: float = figure(
        "offset of the drive angle", "deg", "likewise of these turns", digits="phase"
    )


@dataclass(frozen=True)
class Identified:
    """Joints of a driveline, identified from a recording; ``path`` is its file."""

    path: str
    samples: int = count("samples", "rows of the file that are known")
    missing_samples: int = count("missing samples", "rows of the file that are not")
    turns: float = figure("turns of the drive", meaning="at least 1")
    mean_ratio: float = figure(
        "mean speed ratio",
        meaning="of the driven shaft to the drive; 1 but for a drift",
        digits="speed_ratio",
    )
    equivalent_bend: float = figure(
        "equivalent bend",
        "deg",
        "bend of the single joint that turns the last shaft as unevenly",
        digits="measured",
    )
    standard_deviation: float | None = figure(
        "standard deviation of the bend", "deg", "by the noise", digits="measured"
    )
    interval_low: float = figure(
        "95% interval from",
        "deg",
        "contains the bend in 95 % of cases",
        digits="measured",
        end="interval_high",
    )
    interval_high: float = figure("95% interval to", "deg", digits="measured", end="interval_low")
    detection_limit: float = figure(
        "smallest bend detected", "deg", "that the noise alone may imitate", digits="measured"
    )
    detected: bool = flag("detected", "whether the bend is larger than the noise permits to detect")
    angle_offset: float = figure(
        "offset of the drive angle",
        "deg",
        "to add to the recorded angle, so that the driving pin is in the bend plane at 0°",
        digits="phase",
    )
    phase_less_twist: float | None = figure(
        "phase less twist",
        "deg",
        "of two joints, modulo 180°; 0° where they should cancel",
        digits="phase",
    )
    purity: float | None = figure(
        "purity",
        meaning="order 4 over what order 2 demands; 1 for a chain of joints and nothing else",
    )
    purity_standard_deviation: float | None = figure(
        "standard deviation of the purity", meaning="by the noise"
    )
    unit: str = word("unit", "of the residual and the orders", is_detail=True)
    residual: float = figure(
        "not explained, rms", "own", "what remains without the joints", digits="measured"
    )
    recorded: Literal["angle error", "speed ratio"] = word(
        "recorded", "what the orders and the residual are of"
    )
    orders: tuple[Order, ...] = parts("Orders of what was recorded")
    joints: tuple[JointBend, ...] = parts("Joints")
    changes: bool = flag(
        "bend changes",
        "whether bends of parts of the recording, or their planes, differ by more than the noise",
    )
    by_part: tuple[BendOfPart, ...] = parts(
        "Bend in parts of the recording", "with the speed of the drive, or where they differ"
    )


def identified(
    path: str | PathLike[str],
    drive: str | None,
    *,
    driven: str | None = None,
    speed_ratio: str | None = None,
    intermediate: str | None = None,
    time: str | None = None,
    drive_speed: str | None = None,
    driven_speed: str | None = None,
    radians: bool = False,
) -> Identified:
    """Find the joints that the columns of a file show, as ``cardan identify`` names them.

    The angles of the file and of the answer are in degrees unless ``radians`` says otherwise,
    times in s and speeds in rpm. The drive angle is the integral of the speed if none is given.
    """
    given = (drive, driven, speed_ratio, intermediate, time, drive_speed, driven_speed)
    names = [name for name in given if name is not None]
    if twice := [name for i, name in enumerate(names) if name in names[:i]]:
        raise ValueError(f"{fspath(path)}: column {twice[0]!r} is named for two signals")
    columns = dict(zip(names, read_columns(path, names), strict=True))
    angles = [(name, column) for name, column in columns.items() if name != time]
    for (name, one), (other, another) in combinations(angles, 2):
        # One signal under two names would show a bend of 0.
        if np.array_equal(one, another, equal_nan=True):
            raise ValueError(
                f"{fspath(path)}: columns {name!r} and {other!r} are the same in all rows; "
                "each shaft needs its own encoder"
            )
    speed = None if drive_speed is None else columns[drive_speed] * RPM
    if drive is not None:
        angle = columns[drive]
    else:
        assert time is not None
        assert speed is not None
        if np.any(np.diff(columns[time][~np.isnan(columns[time])]) <= 0.0):
            raise ValueError(f"{fspath(path)}: column {time!r}: times must increase")
        angle = np.asarray(Integral(0.0).at(columns[time], speed), np.float64)
        angle = angle if radians else np.degrees(angle)
    is_ratio, both = driven is None, None
    if driven is None:
        if speed_ratio is not None:
            ratios = [columns[speed_ratio]]
        else:
            assert speed is not None
            with np.errstate(divide="ignore", invalid="ignore"):
                ratios = [
                    columns[name] * RPM / speed for name in (intermediate, driven_speed) if name
                ]
        *firsts, found = (
            identify(angle, speed_ratio=ratio, drive_speed=speed, degrees=not radians)
            for ratio in ratios
        )
        both = two_joints(firsts[0], found) if firsts else None
    elif intermediate is not None:
        shafts = (angle, columns[intermediate], columns[driven])
        both = identify_two_joints(*shafts, drive_speed=speed, degrees=not radians)
        found = both.whole
    else:
        found = identify(angle, angle=columns[driven], drive_speed=speed, degrees=not radians)
    # Speed ratios have no unit.
    unit = "" if is_ratio else "rad" if radians else "deg"
    joints: tuple[JointBend, ...] = ()
    if both is not None:
        joints = tuple(
            JointBend(n, both.bends[n], _known(both.std[n]), *both.intervals[n]) for n in range(2)
        )
    return taken(
        *(Identified, found),
        path=fspath(path),
        missing_samples=len(angle) - found.samples,
        equivalent_bend=found.bend,
        standard_deviation=_known(found.std),
        interval_low=found.interval[0],
        interval_high=found.interval[1],
        phase_less_twist=None if both is None else _known(both.phase_less_twist),
        purity=_known(found.purity),
        purity_standard_deviation=_known(found.std_purity),
        unit=unit,
        recorded="speed ratio" if is_ratio else "angle error",
        orders=tuple(Order(n, unit, abs(found.orders[n])) for n in range(1, _LARGEST_ORDER + 1)),
        joints=joints,
        by_part=tuple(map(_of_part, found.parts)) if found.changes or speed is not None else (),
    )


def _of_part(part: Part) -> BendOfPart:
    bend, std, offset = part.bend, _known(part.std), part.angle_offset
    if math.isnan(part.speed):
        return BendOfPart(None, None, None, part.turn, bend, std, offset)
    # The largest speed ratio of a joint is 1/cos of its bend, the least one cos.
    slow = math.cos(bend)
    return BendOfPart(part.speed, part.speed * slow, part.speed / slow, None, bend, std, offset)


def _known(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _ranges(found: Identified, *, radians: bool) -> str:
    """Say between which values bend and plane change from part to part."""
    bends = [part.bend for part in found.by_part]
    # Half a turn more is the same plane.
    mean = found.angle_offset
    offsets = [mean + math.remainder(part.angle_offset - mean, math.pi) for part in found.by_part]
    ends = [
        " to ".join(
            quantity(end(values), "deg", radians=radians, digits=kind) for end in (min, max)
        )
        for values, kind in ((bends, "measured"), (offsets, "phase"))
    ]
    return f"from part to part the bend is {ends[0]}, and the offset of its plane {ends[1]}"


def identified_text(found: Identified, *, radians: bool = False) -> str:
    """Return the answer as plain text, of two joints from their verdict to a scene of them."""
    verdict = filled(_verdict(found, radians=radians))
    heading = "\n".join([*verdict, "", found.path] if verdict else [found.path])
    text = part_text(heading, found, sentences(found, radians=radians), radians=radians)
    return "\n    ".join([text, *_scene(found)])


def _scene(found: Identified) -> Iterator[str]:
    """Yield the lines of a scene of two joints, at the mean speed of the parts if it is known."""
    if found.phase_less_twist is None:
        return
    bends, phase = (
        ", ".join(plain_text(math.degrees(angle), "measured") for angle in angles)
        for angles in ([joint.bend for joint in found.joints], [found.phase_less_twist])
    )
    yield "[driveline]"
    yield f"bends_deg = [{bends}]"
    yield "twists_deg = [0]"
    yield f"phases_deg = [{phase}]"
    speeds = [part.speed for part in found.by_part if part.speed is not None]
    if speeds:
        yield "[load]"
        yield f"speed_rpm = {plain_text(abs(fmean(speeds)) / RPM, 'rpm')}"


def _verdict(found: Identified, *, radians: bool) -> Iterator[str]:
    """Say whether two joints cancel each other, by the interval of the equivalent bend."""
    if not found.joints:
        return
    if found.interval_low > MAX_EQUIVALENT_BEND:
        said = "The joints do not cancel each other"
    elif found.interval_high <= MAX_EQUIVALENT_BEND:
        said = "The joints cancel each other well enough"
    else:
        said = "Whether the joints cancel each other is not certain"
    limit = given(MAX_EQUIVALENT_BEND, "deg", radians=radians)
    bend = quantity(
        found.equivalent_bend,
        "deg",
        radians=radians,
        digits="measured",
        bounds=[MAX_EQUIVALENT_BEND],
    )
    yield f"{said}: the equivalent bend is {bend}, and driveshaft catalogues permit {limit}."


def sentences(found: Identified, *, radians: bool = False) -> Iterator[str]:
    """Say what the recording shows and what it cannot show."""
    if not found.detected:
        yield "The bend is not larger than the noise permits to detect."
    else:
        yield (
            "The offset is what to add to the recorded drive angle so that the driving pin lies in "
            "the bend plane of the equivalent joint at 0°."
        )
    if found.detected and not found.joints:
        limit = given(MAX_EQUIVALENT_BEND, "deg", radians=radians)
        yield (
            f"The catalogues permit an equivalent bend of {limit}; 'cardan check' of a scene "
            "compares its driveline with this and with the limits of machines."
        )
    shows_joints = False
    if found.detected and found.purity is not None:
        noise = _SIGMAS * (found.purity_standard_deviation or 0.0)
        if abs(found.purity - 1.0) > max(_PURE, noise):
            yield (
                "The purity is not 1: order 4 does not fit order 2, so the recording shows "
                "something besides universal joints."
            )
        elif shows_joints := noise <= 1.0 and found.purity > noise:
            yield (
                "The purity is 1 as far as the noise tells, as that of joints is; an ovality of an "
                "encoder alone has 0."
            )
        else:
            yield (
                "The noise hides order 4, so the purity does not tell whether order 2 comes from "
                "joints. A longer recording, with more samples, does."
            )
    if found.turns < _ENOUGH_TURNS:
        yield (
            "Less than two turns: the interval takes the noise of each sample for independent. "
            "Vibration or an unsteady drift may make it too narrow; two turns show them."
        )
    if abs(found.mean_ratio - 1.0) > _DRIFTS:
        yield (
            "The driven shaft drifts against the drive, so its encoder may have a wrong scale. The "
            "standard deviation covers that."
        )
    if found.changes:
        speed = any(part.speed is not None for part in found.by_part)
        yield (
            f"The bend or its plane changes {'with the drive speed' if speed else 'with time'} by "
            f"more than the noise: {_ranges(found, radians=radians)}. Torsional vibration near a "
            "resonance does that, or a drive angle that drifts. The interval does not cover it. "
            "Record well below the lowest natural frequency."
        )
    adds = "beside the joints changes order 2" if shows_joints else "has order 2 as well"
    yield (
        f"An ovality of an encoder {adds}. A recording with straight joints tells it from a bend. "
        "Torsional vibration changes order 2 unless the drive turns well below the lowest natural "
        "frequency."
    )
    if found.phase_less_twist is not None:
        yield (
            "Phase and twist cannot be told apart: only their difference shows. It is positive in "
            "the sense in which the recorded angle or speed increases, here taken for clockwise, "
            "looking from the drive towards the output. If the shaft turned counter-clockwise, "
            "change its sign, also in phases_deg below."
        )
        yield (
            "The turn of a yoke that helps depends on this difference alone, so a scene may take 0 "
            "for the twist; if you give that of the drawing, add it to phases_deg as well. 'cardan "
            "check' of these lines judges the driveline, and 'cardan phase' says which way to turn "
            "the yoke:"
        )
    elif not found.joints:
        yield (
            "Bends and phases of several joints cannot be told apart by two encoders: only the "
            "equivalent bend shows."
        )

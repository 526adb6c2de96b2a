"""The short table of a scene as printed text."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import groupby
from types import MappingProxyType

import numpy as np

from cardan.app.answers.printed import (
    aligned,
    angle_text,
    in_unit,
    items_text,
    kind_of,
    number_text,
    range_ends,
)
from cardan.app.answers.turn.figures import DriveAngles, SignalFigures, SummaryRow, TurnFigures
from cardan.app.scene.language.units import as_shown, in_shown, shown_unit
from cardan.design.wrapping import fill
from cardan.evaluation.outputs import OUTPUTS

FEWEST = 36
"""Samples per turn below which the largest of them may be far from the largest of the turn."""

_LABELS: Mapping[str, str] = MappingProxyType(
    {
        "twist": "twist of the bend planes",
        "phase": "phase of the yokes",
        "non_uniformity": "non-uniformity U",
        "acceleration_at_steady_drive": "acceleration",
        "drive_torque": "drive torque",
    }
)


def summary_text(turn: TurnFigures, *, radians: bool = False) -> str:
    """Return the table as aligned plain text, at most 79 characters wide."""
    own = [row for row in turn.rows if row.of == "driveline"]
    over = [row for row in turn.rows if row.of != "driveline"]
    parts = [summary_lines(part, radians=radians) for part in (own, over)]
    width = max(len(label) for lines in parts for label, _ in lines) + 4
    headings = ("Driveline", over_text(turn.drive_angles, radians=radians))
    text = "\n\n".join(
        f"{heading}\n{aligned(lines, width, '  ')}"
        for heading, lines in zip(headings, parts, strict=True)
        if lines
    )
    notes = "\n".join(notes_text(turn, radians=radians))
    return f"{text}\n\n{notes}" if notes else text


def over_text(angles: DriveAngles, *, radians: bool = False) -> str:
    """Say over what the extremes are."""
    swept = angles_text(angles, radians=radians)
    if angles.source == "sweep":
        return f"Over a whole turn{f'; the scene sweeps {swept}' if _is_short(angles) else ''}"
    text = f"In these {angles.samples - angles.missing_samples} samples, {swept}"
    return fill(text, 79, subsequent_indent="  ")


def angles_text(angles: DriveAngles, *, radians: bool = False) -> str:
    """Say from where to where drive angles go, and in how many turns of how many samples."""
    first, last = (_end(angle, radians) for angle in (angles.first, angles.last))
    turns = f"{angles.turns:.4g} turn{'s' if angles.turns != 1.0 else ''}"
    per_turn = "" if angles.samples_per_turn is None else f"{angles.samples_per_turn:.4g} samples"
    if angles.min is None or angles.max is None:
        return f"{first} to {last}, {turns}{per_turn and f' of {per_turn}'}"
    low, high = (_end(angle, radians) for angle in (angles.min, angles.max))
    text = f"first {first}, last {last}, least {low}, largest {high}, "
    text += f"{angles.turns:.4g} turns forward and back"
    return f"{text}{per_turn and f', {per_turn} per turn'}"


def _end(degrees: float, radians: bool) -> str:
    """An end of a sweep as someone gave it, of a recording to a tenth of a degree."""
    end = round(math.radians(degrees), 4) if radians else round(degrees, 1)
    return in_unit([number_text(end, "given")], "deg", radians=radians)


def _is_short(angles: DriveAngles) -> bool:
    """Whether a sweep may pass by an extreme."""
    return angles.source == "sweep" and angles.turns < 0.5


def notes_text(turn: TurnFigures, *, radians: bool = False) -> Iterator[str]:
    """Say what must be known to read the table, a paragraph at a time."""
    angles = turn.drive_angles
    zero, period = ("0 rad", "pi rad") if radians else ("0°", "180°")
    if angles.period is not None:
        period = "turn"
    if any(row.at_drive_angle is not None for row in turn.rows):
        text = (
            f"Angles after 'at' are drive angles; at {zero} the driving pin of joint 0 lies in the "
            "plane of shafts 0 and 1."
        )
        if angles.source == "sweep":
            text += f" Each extreme recurs every {period}."
        yield fill(text, 79)
    if angles.angle_of:
        text = (
            "The scene gives angles of the driven shaft; the drive angles follow from them: "
            f"{angles_text(angles, radians=radians)}."
        )
        yield fill(text, 79)
    if _is_short(angles):
        yield "An extreme that the sweep does not reach has no angle."
    if any(row.quantity == "acceleration_at_steady_drive" for row in turn.rows):
        yield "Accelerations are those at constant drive speed."


def few_samples_text(angles: DriveAngles) -> str | None:
    """Warn of values that come from few samples per turn; ``None`` if they are enough."""
    per_turn = angles.samples_per_turn
    if per_turn is None or per_turn >= FEWEST:
        return None
    return f"only {per_turn:.4g} samples per turn; the largest values may lie between the samples"


def noise_text(angles: DriveAngles) -> str | None:
    """Warn of an acceleration that is mostly noise; ``None`` if it is not."""
    for signal in angles.signals:
        if signal.quiet_reach:
            noise = f"{_recorded(signal.noise or 0.0)} {signal.unit} rms"
            return (
                f"the acceleration is mostly noise, {noise}, and so are the torques of inertias; "
                f"try filter_reach = {signal.quiet_reach} in [angles]"
            )
    return None


def summary_lines(rows: Iterable[SummaryRow], *, radians: bool = False) -> list[tuple[str, str]]:
    """Return the table as pairs of what a line is about and its figures.

    Several shafts share a line, without their places; ranges of several shafts are left out.
    """
    lines = []
    for (quantity, is_range), group in groupby(rows, key=_about):
        found = list(group)
        items = dict.fromkeys(row.item for row in found)
        # A place belongs to each of the loads, which lie apart; a range to each recorded one.
        apart = quantity in OUTPUTS and OUTPUTS[quantity].needs_load
        apart = apart or any(row.of == "samples" for row in found)
        if len(items) > 1 and is_range and not apart:
            continue
        parts = [found] if not apart else [[r for r in found if r.item == item] for item in items]
        lines += [_line(part, radians) for part in parts]
    return lines


def _about(row: SummaryRow) -> tuple[str, bool]:
    return row.quantity, row.statistic in ("min", "max")


def _line(rows: Sequence[SummaryRow], radians: bool) -> tuple[str, str]:
    first = rows[0]
    quantity, is_range = _about(first)
    label = _LABELS.get(quantity) or (
        OUTPUTS[quantity].label if quantity in OUTPUTS else quantity.replace("_", " ")
    )
    label = f"largest {label}" if first.statistic == "peak" else label
    label += f", {items_text(first.per, [first.item] if is_range else [row.item for row in rows])}"
    shown = shown_unit(first.unit)
    unit = "rad" if radians and shown == "deg" else shown
    kind = kind_of(quantity, unit)
    values = [
        math.radians(row.value) if unit == "rad" else in_shown(row.value, row.unit) for row in rows
    ]
    if is_range:
        apart = values[-1] > values[0]
        figures = (
            range_ends(values[0], values[-1], kind) if apart else (number_text(values[0], kind),)
        )
        return label, in_unit(figures, shown, " to ", radians=radians)
    text = in_unit([number_text(value, kind) for value in values], shown, radians=radians)
    if len(rows) == 1 and first.at_drive_angle is not None:
        at = first.at_drive_angle
        text += f" at {angle_text(math.radians(at) if radians else at, radians=radians)}"
    return label, text


def signals_text(angles: DriveAngles) -> str:
    """Return the signals as aligned lines of at most 79 characters; "" if there are none."""
    if not angles.signals:
        return ""
    rates = [each.samples_per_second for each in angles.signals if each.signal == "time"]
    step = 1.0 / rates[0] if rates and rates[0] else 0.0
    lines = []
    for signal in angles.signals:
        column = "" if signal.column is None else f", column {signal.column!r}"
        label = f"{_LABELS.get(signal.signal, signal.signal)}{column}"
        lines.append((label, "; ".join(_signal_parts(signal, angles.samples, step))))
    return f"Recording\n{aligned(lines, max(len(label) for label, _ in lines) + 4, '  ')}"


def _signal_parts(signal: SignalFigures, samples: int, step: float) -> Iterator[str]:
    """Describe a signal of so many samples; ``step`` is the mean time between them in s."""
    ends = np.array([signal.first, signal.last, signal.min, signal.max])
    shown, unit = as_shown(ends, signal.unit)
    first, last, low, high = map(float, shown)
    if signal.signal == "time":
        yield f"{_time(first, last - first)} to {_time(last, last - first)} s"
        if step:
            yield f"{_recorded(1.0 / step)} samples per second"
        if signal.longest_gap is not None and signal.longest_gap_after is not None:
            after = _time(signal.longest_gap_after, last - first)
            longest = f"{_recorded(signal.longest_gap)} s after {after} s"
            several = f"{signal.gaps} gaps, the longest"
            yield f"{several if (signal.gaps or 0) > 1 else 'a gap of'} {longest}"
        return
    yield f"first {_recorded(first)}, last {_recorded(last)} {unit}"
    if high - low > 1e-6 * max(abs(low), abs(high)):
        yield f"{' to '.join(range_ends(low, high, 'measured'))} {unit}"
    if signal.filter_samples:
        count = min(signal.filter_samples, samples)
        yield f"by parabolas over {count} samples, {_recorded((count - 1) * step)} s"


def _recorded(value: float) -> str:
    return number_text(value, "measured")


def _time(time: float, duration: float) -> str:
    """A time with the digits that tell the samples of a recording apart, also one of an epoch."""
    if not duration > 0.0:
        return f"{time:.7g}"
    decimals = min(9, max(0, 4 - math.floor(math.log10(duration))))
    text = f"{time:.{decimals}f}"
    return text.rstrip("0").rstrip(".") if decimals else text

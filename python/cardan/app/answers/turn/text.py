"""The short table of a scene as printed text."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import groupby
from types import MappingProxyType
from typing import Any

from cardan.app.answers.printed import aligned, angle_text, figure_text, range_ends
from cardan.app.answers.turn.figures import SummaryRow
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
    }
)


def summary_text(
    rows: Sequence[SummaryRow], drive_angles: Mapping[str, Any], *, radians: bool = False
) -> str:
    """Return the table as aligned plain text, at most 79 characters wide.

    Args:
        rows: the table.
        drive_angles: over what it is, as ``figures.summary.drive_angles`` returns it.
        radians: whether angles are in radians.
    """
    parts = [summary_lines(part, radians=radians) for part in _parts(rows)]
    width = max(len(label) for lines in parts for label, _ in lines) + 4
    headings = ("Driveline", over_text(drive_angles, radians=radians))
    text = "\n\n".join(
        f"{heading}\n{aligned(lines, width, '  ')}"
        for heading, lines in zip(headings, parts, strict=True)
        if lines
    )
    notes = "\n".join(notes_text(rows, drive_angles, radians=radians))
    return f"{text}\n\n{notes}" if notes else text


def _parts(rows: Sequence[SummaryRow]) -> tuple[list[SummaryRow], list[SummaryRow]]:
    own = [row for row in rows if row.of == "driveline"]
    return own, [row for row in rows if row.of != "driveline"]


def over_text(drive_angles: Mapping[str, Any], *, radians: bool = False) -> str:
    """Say over what the extremes are."""
    if drive_angles["source"] == "sweep":
        swept = angles_text(drive_angles, radians=radians)
        return "Over a whole turn" + (
            f"; the scene sweeps {swept}" if _is_short(drive_angles) else ""
        )
    known = drive_angles["samples"] - drive_angles["missing_samples"]
    text = f"In these {known} samples, {angles_text(drive_angles, radians=radians)}"
    return fill(text, 79, subsequent_indent="  ")


def angles_text(drive_angles: Mapping[str, Any], *, radians: bool = False) -> str:
    """Say from where to where drive angles go, and in how many turns of how many samples."""
    unit = "rad" if radians else "deg"
    first, last = (angle_text(drive_angles[f"{end}_{unit}"], radians) for end in ("first", "last"))
    turns, per_turn = drive_angles["turns"], drive_angles["samples_per_turn"]
    text = f"{first} to {last}, {turns:.4g} turn{'s' if turns != 1.0 else ''}"
    if f"min_{unit}" in drive_angles:
        low, high = (angle_text(drive_angles[f"{end}_{unit}"], radians) for end in ("min", "max"))
        text = (
            f"first {first}, last {last}, least {low}, largest {high}, "
            f"{turns:.4g} turns forward and back"
        )
        return text if per_turn is None else f"{text}, {per_turn:.4g} samples per turn"
    return text if per_turn is None else f"{text} of {per_turn:.4g} samples"


def _is_short(drive_angles: Mapping[str, Any]) -> bool:
    """Whether a sweep may pass by an extreme."""
    return bool(drive_angles["source"] == "sweep" and drive_angles["turns"] < 0.5)


def notes_text(
    rows: Iterable[SummaryRow], drive_angles: Mapping[str, Any], *, radians: bool = False
) -> Iterator[str]:
    """Say what must be known to read the table, a paragraph at a time."""
    found = list(rows)
    zero, period = ("0 rad", "pi rad") if radians else ("0°", "180°")
    if drive_angles.keys() & {"period_deg", "period_rad"}:
        period = "turn"
    if any(row.at_deg is not None for row in found):
        text = (
            f"Angles after 'at' are drive angles; at {zero} the driving pin of joint 0 lies in the "
            "plane of shafts 0 and 1."
        )
        if drive_angles["source"] == "sweep":
            text += f" Each extreme recurs every {period}."
        yield fill(text, 79)
    if drive_angles.get("angle_of") == "driven":
        text = (
            "The scene gives angles of the driven shaft; the drive angles follow from them: "
            f"{angles_text(drive_angles, radians=radians)}."
        )
        yield fill(text, 79)
    if _is_short(drive_angles):
        yield "An extreme that the sweep does not reach has no angle."
    if any(row.quantity == "acceleration_at_steady_drive" for row in found):
        yield "Accelerations are those at constant drive speed."


def few_samples_text(samples_per_turn: float | None) -> str | None:
    """Warn of values that come from few samples per turn; ``None`` if they are enough."""
    if samples_per_turn is None or samples_per_turn >= FEWEST:
        return None
    return (
        f"only {samples_per_turn:.4g} samples per turn; "
        "the largest values may lie between the samples"
    )


def summary_lines(rows: Iterable[SummaryRow], *, radians: bool = False) -> list[tuple[str, str]]:
    """Return the table as pairs of what a line is about and its figures.

    Several shafts share a line, without their places; ranges of several shafts are left out.
    """
    lines = []
    for (quantity, statistic), group in groupby(rows, key=_about):
        found = list(group)
        items = list(dict.fromkeys(row.item for row in found))
        several = len(items) > 1
        # A place belongs to each of the loads, which lie apart; a range to each recorded one.
        apart = quantity in OUTPUTS and OUTPUTS[quantity].needs_load
        apart = apart or any(row.of == "samples" for row in found)
        if several and statistic == "range" and not apart:
            continue
        parts = [found] if not apart else [[r for r in found if r.item == item] for item in items]
        lines += [_line(part, statistic, radians) for part in parts]
    return lines


def _about(row: SummaryRow) -> tuple[str, str]:
    return row.quantity, "range" if row.statistic in ("min", "max") else row.statistic


def _line(rows: Sequence[SummaryRow], statistic: str, radians: bool) -> tuple[str, str]:
    first = rows[0]
    label = _LABELS.get(first.quantity) or (
        OUTPUTS[first.quantity].label
        if first.quantity in OUTPUTS
        else first.quantity.replace("_", " ")
    )
    if statistic == "peak":
        label = f"largest {label}"
    items = [row.item for row in rows] if statistic != "range" else [first.item]
    label += f", {_items(first.per, items)}"
    values = [_in_unit(row, radians) for row in rows]
    if statistic == "range":
        low, high = values[0], values[-1]
        figures = list(range_ends(low, high)) if 0.0 < high - low < math.inf else [figure_text(low)]
        return label, _with_unit(figures, " to ", first.unit, radians)
    text = _with_unit(list(map(figure_text, values)), ", ", first.unit, radians)
    if len(rows) == 1 and first.at_deg is not None:
        at = math.radians(first.at_deg) if radians else first.at_deg
        text += f" at {angle_text(at, radians)}"
    return label, text


def _items(per: str, items: Sequence[int]) -> str:
    if len(items) == 1:
        return f"{per} {items[0]}"
    if len(items) > 2 and list(items) == list(range(items[0], items[-1] + 1)):
        return f"{per}s {items[0]} to {items[-1]}"
    return f"{per}s {', '.join(map(str, items[:-1]))} and {items[-1]}"


def _in_unit(row: SummaryRow, radians: bool) -> float:
    return math.radians(row.value) if row.unit == "deg" and radians else row.value


def _with_unit(figures: Sequence[str], between: str, unit: str, radians: bool) -> str:
    if unit == "deg" and not radians:
        return between.join(f"{figure}°" for figure in figures)
    unit = "rad" if unit == "deg" else unit
    return f"{between.join(figures)} {unit}".rstrip()


_NAMES = {"drive_torque": "drive torque"}


def signals_text(drive_angles: Mapping[str, Any]) -> str:
    """Return the signals as aligned lines of at most 79 characters; "" if there are none.

    Args:
        drive_angles: as ``figures.summary.drive_angles`` returns it.
    """
    signals = drive_angles.get("signals", [])
    if not signals:
        return ""
    time = next((signal for signal in signals if signal["signal"] == "time"), None)
    rate = time["samples_per_second"] if time else None
    step = 1.0 / rate if rate else 0.0
    samples = drive_angles["samples"]
    lines = [
        (_label(signal), "; ".join(_signal_parts(signal, samples, step))) for signal in signals
    ]
    return f"Recording\n{aligned(lines, max(len(label) for label, _ in lines) + 4, '  ')}"


def _label(signal: Mapping[str, Any]) -> str:
    name = _NAMES.get(signal["signal"], signal["signal"])
    return name if signal["column"] is None else f"{name}, column {signal['column']!r}"


def _signal_parts(signal: Mapping[str, Any], samples: int, step: float) -> Iterator[str]:
    """What to say of a signal of so many samples; ``step`` is the mean time between them in s."""
    unit = signal["unit"]
    first, last, low, high = (signal[end] for end in ("first", "last", "min", "max"))
    if signal["signal"] == "time":
        yield f"{_time(first, last - first)} to {_time(last, last - first)} s"
        if step:
            yield f"{figure_text(1.0 / step)} samples per second"
        if gaps := signal["gaps"]:
            longest = f"{figure_text(signal['longest_gap_s'])} s after "
            longest += f"{_time(signal['longest_gap_after_s'], last - first)} s"
            yield f"{gaps} gaps, the longest {longest}" if gaps > 1 else f"a gap of {longest}"
        return
    yield f"first {figure_text(first)}, last {figure_text(last)} {unit}"
    if high - low > 1e-6 * max(abs(low), abs(high)):
        yield f"{' to '.join(range_ends(low, high))} {unit}"
    if "filter_samples" in signal:
        count = min(signal["filter_samples"], samples)
        yield f"by parabolas over {count} samples, {figure_text((count - 1) * step)} s"


def _time(time: float, duration: float) -> str:
    """A time with the digits that tell the samples of a recording apart, also one of an epoch."""
    if not duration > 0.0:
        return f"{time:.7g}"
    decimals = min(9, max(0, 4 - math.floor(math.log10(duration))))
    text = f"{time:.{decimals}f}"
    return text.rstrip("0").rstrip(".") if decimals else text

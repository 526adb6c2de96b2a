"""The signals of a recording as printed text, by which a wrong unit is seen."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any

from cardan.app.answers.printed import aligned, figure_text, range_ends

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
    lines = [(_label(signal), "; ".join(_parts(signal, samples, step))) for signal in signals]
    return f"Recording\n{aligned(lines, max(len(label) for label, _ in lines) + 4, '  ')}"


def _label(signal: Mapping[str, Any]) -> str:
    name = _NAMES.get(signal["signal"], signal["signal"])
    return name if signal["column"] is None else f"{name}, column {signal['column']!r}"


def _parts(signal: Mapping[str, Any], samples: int, step: float) -> Iterator[str]:
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

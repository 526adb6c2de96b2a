"""The signals of a recording as printed text, by which a wrong unit is seen."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from cardan.words.summary import aligned, figure_text, range_ends

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
    duration = time["last"] - time["first"] if time else 0.0
    samples = drive_angles["samples"]
    step = duration / (samples - 1) if samples > 1 else 0.0
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
        yield f"{_number(first)} to {_number(last)} s"
        if step:
            yield f"{figure_text(1.0 / step)} samples per second"
        return
    yield f"first {figure_text(first)}, last {figure_text(last)} {unit}"
    if high - low > 1e-6 * max(abs(low), abs(high)):
        yield f"{' to '.join(range_ends(low, high))} {unit}"
    if "filter_samples" in signal:
        count = min(signal["filter_samples"], samples)
        yield f"by parabolas over {count} samples, {figure_text((count - 1) * step)} s"


def _number(time: float) -> str:
    return f"{time:.7g}"

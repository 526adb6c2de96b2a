"""Charts as inline SVG: axes with units, curves that dashes alone tell apart, a cursor."""

from __future__ import annotations

import math
from collections.abc import Sequence
from html import escape

import numpy as np

from cardan.arrays import FloatArray
from cardan.report.samples import Panel

_WIDTH, _HEIGHT = 360, 180
_LEFT, _RIGHT, _TOP, _BOTTOM = 56, 344, 8, 142

_DEGREES = (1, 2, 5, 10, 15, 30, 45, 90, 180, 360)

# A curve that varies less than this beside its panel's scale or its own size is flat: it would
# fill the chart with rounding.
_FLAT = 1e-9


def chart(panel: Panel, x: FloatArray, x_label: str, first: int | None = None) -> str:
    """Return a figure with heading, curves and legend as HTML.

    Args:
        panel: what to draw.
        x: abscissa of the curves, ``(samples,)``.
        x_label: what it is, with its unit.
        first: number of the first curve, by which the script finds it to set its cursor; without
            one the chart has no cursor.
    """
    low, high, noise = _extent(panel)
    y_ticks = _ticks(low, high)
    low, high = min(low, y_ticks[0]), max(high, y_ticks[-1])
    start, stop = float(np.min(x)), float(np.max(x))
    stop = stop if stop > start else start + 1.0
    across = _LEFT + (_RIGHT - _LEFT) * (x - start) / (stop - start)
    parts = []
    for tick in _degree_ticks(start, stop) if "deg" in x_label else _ticks(start, stop):
        if start <= tick <= stop:
            at = _LEFT + (_RIGHT - _LEFT) * (tick - start) / (stop - start)
            parts.append(
                f'<line class="grid" x1="{at:.1f}" x2="{at:.1f}" y1="{_TOP}" y2="{_BOTTOM}"/>'
            )
            parts.append(
                f'<text x="{at:.1f}" y="{_BOTTOM + 15}" class="middle">{number(tick)}</text>'
            )
    for tick in y_ticks:
        at = _BOTTOM - (_BOTTOM - _TOP) * (tick - low) / (high - low)
        parts.append(f'<line class="grid" x1="{_LEFT}" x2="{_RIGHT}" y1="{at:.1f}" y2="{at:.1f}"/>')
        parts.append(f'<text x="{_LEFT - 5}" y="{at + 4:.1f}" class="end">{number(tick)}</text>')
    middle = (_LEFT + _RIGHT) / 2
    parts.append(f'<text x="{middle}" y="{_HEIGHT - 5}" class="middle">{escape(x_label)}</text>')
    if first is not None:
        parts.append(f'<line class="cursor" x1="{_LEFT}" x2="{_LEFT}" y1="{_TOP}" y2="{_BOTTOM}"/>')
    legend = []
    for i, curve in enumerate(panel.curves):
        values = np.full_like(curve.values, np.mean(curve.values)) if noise else curve.values
        up = _BOTTOM - (_BOTTOM - _TOP) * (values - low) / (high - low)
        points = " ".join(f"{a:.1f},{b:.1f}" for a, b in zip(across, up, strict=True))
        key = "" if first is None else f' id="curve-{first + i}"'
        parts.append(f'<polyline{key} class="curve c{i}" points="{points}"/>')
        if first is not None:
            parts.append(f'<circle class="dot c{i}" r="3.5"/>')
        swatch = (
            f'<svg class="swatch" aria-hidden="true"><path class="curve c{i}" d="M0 6H30"/></svg>'
        )
        value = "" if first is None else f' <output data-curve="{first + i}"></output>'
        unit = f" {escape(panel.unit)}" if value and panel.unit else ""
        legend.append(f"<li>{swatch} {escape(curve.label)}{value}{unit}</li>")
    unit = f" [{panel.unit}]" if panel.unit else ""
    heading = f"{panel.heading}{unit}"
    said = f"{heading} over {x_label}, from {low:.4g} to {high:.4g}"
    rest = f"<li>and {panel.left_out} that vary no more</li>" if panel.left_out else ""
    return (
        f"<figure><figcaption>{escape(heading)}</figcaption>"
        f'<svg viewBox="0 0 {_WIDTH} {_HEIGHT}" role="img" aria-label="{escape(said)}">'
        f'{"".join(parts)}</svg><ul class="legend">{"".join(legend)}{rest}</ul></figure>'
    )


def decimals(panel: Panel) -> int:
    """Return how many decimals show a panel's values to about four digits of their variation."""
    low, high, flat = _extent(panel)
    size = max(abs(low), abs(high))
    digits = 3 - math.floor(math.log10(size if flat else min(size, high - low)))
    return min(9, max(0, digits))


def number(value: float) -> str:
    """Write a round number with a true minus sign."""
    return f"{value:.10g}".replace("-", "\N{MINUS SIGN}")


def _extent(panel: Panel) -> tuple[float, float, bool]:
    """Least and largest value with some room if they are the same but for rounding, and whether."""
    low = min(float(np.min(curve.values)) for curve in panel.curves)
    high = max(float(np.max(curve.values)) for curve in panel.curves)
    noise = _FLAT * max(panel.scale, abs(low), abs(high))
    if high - low > noise:
        return low, high, False
    middle = (low + high) / 2.0
    room = 0.05 * abs(middle) if abs(middle) > noise else panel.scale or 1.0
    return middle - room, middle + room, True


def _ticks(low: float, high: float) -> Sequence[float]:
    """Round numbers from at or below ``low`` to at or above ``high``, about five of them."""
    rough = (high - low) / 4.0
    power = 10.0 ** math.floor(math.log10(rough))
    step = next(part * power for part in (1.0, 2.0, 2.5, 5.0, 10.0) if part * power >= rough)
    return [step * i for i in range(math.floor(low / step), math.ceil(high / step) + 1)]


def _degree_ticks(low: float, high: float) -> Sequence[float]:
    span = high - low
    step = next((step for step in _DEGREES if span <= 5 * step), 360 * math.ceil(span / 1800.0))
    return [float(step * i) for i in range(math.ceil(low / step), math.floor(high / step) + 1)]

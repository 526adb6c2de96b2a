"""Maps of a figure over two keys as data for SVG: bands of colour, the least value marked."""

from __future__ import annotations

from typing import Any

import numpy as np

from cardan.app.charts.charts import FRAME, Panel, number, scale_of, some, ticks, ticks_of
from cardan.arrays import FloatArray

# More cells than that are finer than the page shows.
_MOST_ACROSS, _MOST_UP = 96, 64


def heat_map(
    panel: Panel, x: FloatArray, y: FloatArray, values: FloatArray, labels: list[str]
) -> dict[str, Any]:
    """Return heading, ticks, bands and their legend as plain data for the macro ``map``.

    The values, ``(rows, columns)``, are finite, and those of both keys, x across, rise.
    """
    low, high, flat = scale_of(values, panel.scale)
    levels = np.array(ticks(low, high, 7.0))
    rows, columns = some(len(y), _MOST_UP), some(len(x), _MOST_ACROSS)
    across, up = _edges(x[columns]), _edges(y[rows])
    shown = np.full_like(values, np.mean(values)) if flat else values
    bands = np.digitize(shown[np.ix_(rows, columns)], levels[1:-1])
    to_x = _to(across[0], across[-1], FRAME.left, FRAME.right)
    to_y = _to(up[0], up[-1], FRAME.bottom, FRAME.top)
    place = np.unravel_index(int(np.argmin(values)), values.shape)
    x_label, y_label = labels
    heading = f"{panel.heading} [{panel.unit}]" if panel.unit else panel.heading
    return {
        "frame": FRAME,
        "heading": heading,
        "spoken": f"{heading} over {x_label} and {y_label}, "
        f"from {np.min(values):.4g} to {np.max(values):.4g}",
        "x_label": x_label,
        "y_label": y_label,
        "x_ticks": [(f"{to_x(t):.1f}", number(t)) for t in ticks_of(x_label, x[0], x[-1])],
        "y_ticks": [(f"{to_y(t) + 4:.1f}", number(t)) for t in ticks_of(y_label, y[0], y[-1])],
        "bands": [
            {
                "path": _path(bands == band, to_x(across), to_y(up)),
                "label": f"{number(levels[band])} to {number(levels[band + 1])}",
            }
            for band in range(len(levels) - 1)
        ],
        "least": None if flat else [f"{to_x(x[place[1]]):.1f}", f"{to_y(y[place[0]]):.1f}"],
        "least_at": f"{number(x[place[1]])}, {number(y[place[0]])}",
        "thinned": f"{len(columns)} of {len(x)} by {len(rows)} of {len(y)} values are drawn"
        if len(rows) < len(y) or len(columns) < len(x)
        else "",
    }


def _path(inside: Any, x: FloatArray, y: FloatArray) -> str:  # noqa: ANN401 - booleans
    """Bars over the cells of one band, each as long as its run of columns."""
    bars = []
    for row, cells in enumerate(inside):
        ends = np.flatnonzero(np.diff(np.concatenate([[False], cells, [False]]).astype(int)))
        bars += [
            f"M{x[first]:.1f} {y[row]:.1f}H{x[last]:.1f}V{y[row + 1]:.1f}H{x[first]:.1f}z"
            for first, last in ends.reshape(-1, 2)
        ]
    return "".join(bars)


def _edges(places: FloatArray) -> FloatArray:
    """Borders of cells around places: halfway between neighbours, and as far beyond the ends."""
    middles = (places[1:] + places[:-1]) / 2.0
    ends = [2.0 * places[0] - middles[0]], [2.0 * places[-1] - middles[-1]]
    return np.concatenate([ends[0], middles, ends[1]])


def _to(low: float, high: float, start: float, stop: float) -> Any:  # noqa: ANN401 - numbers or arrays
    return lambda value: start + (stop - start) * (value - low) / (high - low)

"""Amplitudes by order of the drive's rotation."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

import cardan.app.answers.turn.panel as panel
from cardan.app.pictures.style import drawing, legend_above
from cardan.arrays.errors import ArgumentValueError
from cardan.arrays.indices import item_index
from cardan.driveline import Driveline
from cardan.evaluation.outputs import OUTPUTS

if TYPE_CHECKING:
    from matplotlib.axes import Axes


def plot_harmonics(
    line: Driveline,
    quantity: Literal["angle_error", "speed_ratio"] = "angle_error",
    *,
    orders: ArrayLike = (2, 4, 6, 8),
    shaft: int = -1,
    labels: Sequence[str] | None = None,
    ax: Axes | None = None,
) -> Axes:
    """Draw the amplitudes of a shaft's motion over the order, on a logarithmic scale.

    A batch ``(m,)`` is drawn side by side. Amplitudes of 0 stay out.

    Args:
        line: one driveline or a batch of one dimension.
        quantity: which motion.
        orders: multiples of the drive's speed; odd ones have no amplitude.
        shaft: index of the shaft, by default the last.
        labels: what to call the drivelines of a batch.
        ax: where to draw; by default on a new figure of pyplot, 80 mm wide.

    Raises:
        ImportError: matplotlib is missing.
        IndexError: a shaft that does not exist.
        ValueError: an unknown quantity, an order below 1, a batch of more dimensions or more than
            can be told apart, labels that do not fit.
    """
    if quantity not in ("angle_error", "speed_ratio"):
        raise ArgumentValueError("quantity", f"is {quantity!r}; known are angle_error, speed_ratio")
    if len(line.shape) > 1:
        raise ArgumentValueError(
            "line", f"has shape {line.shape}; a picture shows a batch of one dimension"
        )
    item = item_index("shaft", shaft, line.n_joints + 1)
    found = line.harmonics(orders, shaft)
    amplitudes, unit = panel.in_unit(OUTPUTS[quantity], np.atleast_2d(getattr(found, quantity)))
    names = panel.names(line, labels)
    with drawing(ax, height_mm=45.0) as axes:
        curves = list(zip(names, amplitudes, strict=True))
        width = 0.8 * _least_step(found.orders)
        panel.draw_stems(axes, np.asarray(found.orders, np.float64), curves, width)
        if np.any(amplitudes > 0.0):
            least = float(np.min(amplitudes[amplitudes > 0.0]))
            axes.set_yscale("log")
            axes.set_ylim(10.0 ** math.floor(math.log10(least) - 0.1), None)
        axes.set_xticks(found.orders)
        axes.set_xlabel("order of the drive's rotation")
        axes.set_ylabel(f"{quantity.replace('_', ' ')}\nshaft {item}{unit}")
        axes.grid(visible=True, axis="y")
        if any(names):
            legend_above(axes)
    return axes


def _least_step(orders: NDArray[np.int64]) -> float:
    return float(np.min(np.diff(np.unique(orders)), initial=2))

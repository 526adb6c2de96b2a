"""Pictures of a scene, drawn with matplotlib."""

from __future__ import annotations

import math
import os
import textwrap
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from cardan.arrays import FloatArray
from cardan.curves import whole_file

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from cardan.scene import SceneResult

# What makes a file differ from run to run is left out.
SUFFIXES: Mapping[str, dict[str, Any]] = {
    ".svg": {"Date": None},
    ".png": {},
    ".pdf": {"CreationDate": None},
}
"""Formats of a picture file, by suffix, and the metadata to write."""

# Okabe and Ito's palette; the dashes alone tell the curves apart in grey.
_STYLES = (("#0072B2", "-"), ("#D55E00", (0, (4, 1.5))), ("#009E73", (0, (1, 1.2))))

_RULES = {
    "font.size": 7.0,
    "axes.linewidth": 0.6,
    "axes.titlesize": 7.0,
    "axes.titlepad": 3.0,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "grid.color": "0.88",
    "grid.linewidth": 0.5,
    "lines.linewidth": 1.1,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "svg.hashsalt": "cardan",
}

_MM = 1.0 / 25.4
_WIDTH, _PANEL, _FRAME = 80.0 * _MM, 24.0 * _MM, 14.0 * _MM

_TICKS = (1, 2, 5, 10, 15, 30, 45, 90, 180, 360)  # degrees

# A curve that varies less than this, relative to its panel's scale or its own size, is flat: it
# would fill the panel with rounding.
_FLAT = 1e-9


@dataclass(frozen=True)
class _Panel:
    heading: str
    curves: dict[str, FloatArray]
    scale: float = 1.0


def plot_scene(result: SceneResult) -> Figure:
    """Return a picture of everything that the scene evaluates, over the drive angle in degrees.

    It is 80 mm wide, with one panel per quantity, or per joint where the quantity is a joint's.
    With the speed of the drive given, acceleration is in rad/s² instead of a ratio.

    Raises:
        ImportError: matplotlib is missing.
    """
    matplotlib = _matplotlib()
    from matplotlib.figure import Figure

    panels = list(_panels(result))
    title = textwrap.fill(result.scene.title, width=48)
    height = _FRAME + _PANEL * len(panels) + 4.0 * _MM * title.count("\n")
    with matplotlib.rc_context(_RULES):
        figure = Figure(figsize=(_WIDTH, height), layout="constrained")
        all_axes = figure.subplots(len(panels), sharex=True, squeeze=False)[:, 0]
        for axes, panel in zip(all_axes, panels, strict=True):
            _draw(axes, panel, result.scene.drive_angle_deg)
        all_axes[-1].set_xlabel("drive angle [deg]")
        if title:
            figure.suptitle(title, fontsize=8.0, parse_math=False)
    return figure


def write_picture(result: SceneResult, path: str | PathLike[str]) -> None:
    """Write the picture of a scene in the format that the path's suffix names.

    Raises:
        ImportError: matplotlib is missing.
        OSError: the file cannot be written; nothing of it is left behind then.
        ValueError: an unknown suffix.
    """
    suffix = Path(path).suffix
    if suffix not in SUFFIXES:
        raise ValueError(f"{os.fspath(path)} must end in {' or '.join(SUFFIXES)}")
    matplotlib = _matplotlib()
    figure = plot_scene(result)
    with matplotlib.rc_context(_RULES), whole_file(path) as file:
        figure.savefig(file, format=suffix[1:], dpi=300, metadata=SUFFIXES[suffix])


def _matplotlib() -> Any:  # noqa: ANN401 - a module that may be missing
    try:
        import matplotlib
    except ModuleNotFoundError:
        hint = "a picture needs matplotlib: pip install 'cardan[app]'"
        raise ModuleNotFoundError(hint) from None
    return matplotlib


def _panels(result: SceneResult) -> Iterable[_Panel]:
    speed = result.scene.speed
    for output, item, values in result.curves():
        heading, unit, scale = output.name.replace("_", " "), output.unit, 1.0
        if unit == "rad":
            values, unit = np.degrees(values), "deg"
        if output.name == "acceleration_ratio" and speed:
            scale = speed * speed
            heading, values, unit = "acceleration", values * scale, "rad/s²"
            heading += " at steady drive" if result.scene.accelerates else ""
        unit = "" if unit == "1" else f" [{unit}]"
        curves = _components(values, output.vector)
        yield _Panel(f"{heading}, {output.per} {item}{unit}", curves, scale)


def _components(values: FloatArray, vector: bool) -> dict[str, FloatArray]:
    return {axis: values[:, i] for i, axis in enumerate("xyz")} if vector else {"": values}


def _draw(axes: Axes, panel: _Panel, angle: FloatArray) -> None:
    from matplotlib.ticker import FuncFormatter, MaxNLocator, MultipleLocator

    for (label, curve), (colour, dashes) in zip(panel.curves.items(), _STYLES, strict=False):
        axes.plot(angle, curve, color=colour, linestyle=dashes, label=label)
    axes.set_title(panel.heading, loc="left")
    if len(panel.curves) > 1:
        axes.legend(
            loc="lower right",
            bbox_to_anchor=(1.0, 1.02),
            ncols=3,
            frameon=False,
            borderaxespad=0.0,
            borderpad=0.0,
            handlelength=1.7,
            handletextpad=0.3,
            columnspacing=0.7,
        )
    axes.grid(visible=True)
    # Recorded angles need not rise.
    first, last = float(np.min(angle)), float(np.max(angle))
    span = last - first
    if span > 0.0:
        axes.set_xlim(first, last)
    if span > _TICKS[0]:
        step = next((step for step in _TICKS if span <= 5 * step), 360 * math.ceil(span / 1800.0))
        axes.xaxis.set_major_locator(MultipleLocator(step))
    axes.yaxis.set_major_locator(MaxNLocator(5, steps=[1, 2, 2.5, 5, 10]))
    # Full numbers: an offset above the axis would cover the heading.
    axes.yaxis.set_major_formatter(FuncFormatter(lambda tick, _: _tick(tick)))

    low = min(float(np.min(curve)) for curve in panel.curves.values())
    high = max(float(np.max(curve)) for curve in panel.curves.values())
    noise = _FLAT * max(panel.scale, abs(low), abs(high))
    if high - low <= noise:
        middle = (low + high) / 2.0
        room = 0.05 * abs(middle) if abs(middle) > noise else panel.scale
        axes.set_ylim(middle - room, middle + room)


def _tick(value: float) -> str:
    return f"{value:.10g}".replace("-", "\N{MINUS SIGN}")

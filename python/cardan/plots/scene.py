"""The picture of a whole scene."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable
from dataclasses import dataclass
from os import PathLike
from typing import TYPE_CHECKING

import cardan.plots.panel as panel
from cardan.arrays import FloatArray
from cardan.plots.study import plot_study
from cardan.plots.style import MM, STYLE, WIDTH, legend_above, matplotlib, save
from cardan.scene.scene import SceneResult

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_PANEL, _FRAME = 24.0 * MM, 14.0 * MM


@dataclass(frozen=True)
class _Panel:
    heading: str
    curves: list[tuple[str, FloatArray]]
    scale: float = 1.0


def plot_scene(result: SceneResult) -> Figure:
    """Return a picture of everything that the scene evaluates, over the drive angle in degrees.

    It is 80 mm wide, with one panel per quantity, or per joint where the quantity is a joint's.
    With the speed of the drive given, acceleration is in rad/s² instead of a ratio.

    Raises:
        ImportError: matplotlib is missing.
    """
    with matplotlib().rc_context(STYLE):
        from matplotlib.figure import Figure

        panels = list(_panels(result))
        title = textwrap.fill(result.scene.title, width=48)
        height = _FRAME + _PANEL * len(panels) + 4.0 * MM * title.count("\n")
        figure = Figure(figsize=(WIDTH, height), layout="constrained")
        all_axes = figure.subplots(len(panels), sharex=True, squeeze=False)[:, 0]
        for axes, part in zip(all_axes, panels, strict=True):
            panel.draw(axes, result.scene.drive_angle_deg, part.curves, part.scale)
            axes.set_title(part.heading, loc="left")
            if len(part.curves) > 1:
                legend_above(axes)
        all_axes[-1].set_xlabel("drive angle [deg]")
        if title:
            figure.suptitle(title, fontsize=8.0, parse_math=False)
    return figure


def write_picture(
    result: SceneResult, path: str | PathLike[str], column: str | None = None
) -> None:
    """Write the picture of a scene in the format that the path's suffix names.

    Args:
        result: an evaluated scene.
        path: file to write.
        column: a figure of the scene's study, to draw over its keys as ``plot_study`` does.

    Raises:
        ImportError: matplotlib is missing.
        OSError: the file cannot be written; nothing of it is left behind then.
        ValueError: an unknown suffix or column, a study of no key or more than two.
    """
    save(plot_scene(result) if column is None else _study(result, column), path)


def _study(result: SceneResult, column: str) -> Figure:
    scene = result.scene
    if result.study is None:
        raise ValueError(f"{scene.name}: there is no study to draw; it needs a section [study]")
    with matplotlib().rc_context(STYLE):
        from matplotlib.figure import Figure

        figure = Figure(figsize=(WIDTH, 66.0 * MM), layout="constrained")
        plot_study(result.study, column, ax=figure.add_subplot())
        if scene.title:
            title = textwrap.fill(scene.title, width=48)
            figure.suptitle(title, fontsize=8.0, parse_math=False)
    return figure


def _panels(result: SceneResult) -> Iterable[_Panel]:
    speed = result.scene.speed
    for output, item, values in result.curves():
        heading, scale = output.label, 1.0
        values, unit = panel.in_unit(output, values)
        if output.name == "acceleration_ratio" and speed:
            scale = speed * speed
            heading, values, unit = "acceleration", values * scale, " [rad/s²]"
            heading += " at steady drive" if result.scene.accelerates else ""
        curves = list(zip("xyz", values.T, strict=True)) if output.vector else [("", values)]
        yield _Panel(f"{heading}, {output.per} {item}{unit}", curves, scale)

"""The quantities of a scene as panels: what is drawn in each, and on which scale."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

import cardan.app.answers.turn.panel as panel
from cardan.app.answers.turn.abscissa import Abscissa
from cardan.app.pictures.style import LINES, legend_above
from cardan.app.scene.language.units import RPM
from cardan.app.scene.scene import SceneResult
from cardan.arrays import FloatArray
from cardan.evaluation.outputs import Output

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MOST = len(LINES)
"""How many shafts or joints a panel shows at most."""


_KINDS = {"N m": "moments", "N": "forces"}


@dataclass(frozen=True, eq=False)
class DrawnQuantity:
    """A panel: a curve, ``(samples,)``, for each shaft, joint or bearing that there is room for."""

    heading: str
    per: str
    items: tuple[int, ...]
    curves: tuple[FloatArray, ...]
    # Panels of the same name share their scale.
    scale: str
    # What values that are all 0 would be measured in.
    unit_size: float = 1.0
    left_out: int = 0
    # What it is a component of, "moments" or "forces"; "" of a scalar.
    vector: str = ""

    def draw(self, axes: Axes, over: Abscissa, aside: float) -> None:
        """Draw the panel with its heading and, of several curves, its legend.

        These begin so many points to the left of the axes.
        """
        names = [f"{self.per} {self.items[0]}", *map(str, self.items[1:])]
        labels = names if len(self.items) > 1 else [""]
        curves = list(zip(labels, self.curves, strict=True))
        over.draw(axes, curves=curves, scale=self.unit_size)
        # Over the ticks too, where long headings and six names need the width.
        left = -aside / axes.bbox.width * axes.figure.dpi / 72.0
        many = len(self.items) > 1
        axes.set_title(self.heading, loc="left", x=left, pad=14.5 if many else 5.5)
        if many:
            place = {"loc": "lower left", "bbox_to_anchor": (left, 1.0), "borderaxespad": 0.7}
            legend_above(axes, ncols=MOST, **{**place, "handlelength": 1.6, "columnspacing": 0.5})


def quantities(result: SceneResult) -> list[DrawnQuantity]:
    """Return the panels of a scene: one per quantity, three for one that is a vector.

    The speed and acceleration of a drive that was recorded over time come first.
    """
    found: dict[str, tuple[Output, list[int], list[FloatArray]]] = {}
    for output, item, values in result.curves():
        _, items, curves = found.setdefault(output.name, (output, [], []))
        items.append(item)
        curves.append(values)
    panels = list(_drive(result))
    for output, items, curves in found.values():
        if output.vector:
            along = _along(result)
            for i, axis in enumerate(output.axes):
                part = [values[:, i] for values in curves]
                scale = f"{output.name} {'along' if i == along else 'across'}"
                sense = "about" if _KINDS[output.unit] == "moments" else "along"
                panels.append(_panel(result, output, items, part, f" {sense} {axis}", scale))
        else:
            panels.append(_panel(result, output, items, curves, "", output.name))
    return panels


def _drive(result: SceneResult) -> Iterator[DrawnQuantity]:
    scene = result.scene
    if not scene.speed_recorded or scene.load_case is None:
        return
    for heading, values in (
        ("drive speed [rpm]", scene.load_case.speed / RPM),
        ("drive acceleration [rad/s²]", scene.load_case.acceleration),
    ):
        yield DrawnQuantity(heading, "shaft", (0,), (values,), heading)


def _panel(
    result: SceneResult,
    output: Output,
    items: Sequence[int],
    curves: Sequence[FloatArray],
    component: str,
    scale: str,
) -> DrawnQuantity:
    heading, size = f"{output.label}{component}", 1.0
    in_unit = [panel.in_unit(output, values)[0] for values in curves]
    unit = panel.in_unit(output, np.empty(0))[1]
    if output.name == "acceleration_ratio" and result.scene.speed:
        size = result.scene.speed**2
        speed = result.scene.load_case.speed if result.scene.load_case else 0.0
        in_unit, unit = [values * speed**2 for values in in_unit], " [rad/s²]"
        heading = "acceleration" + " at steady drive" * result.scene.accelerates
    extents = np.array([_extent(values) for values in in_unit])
    # Those that vary most, of equal ones the first, in the order of the driveline.
    shown = np.sort(np.argsort(-extents, kind="stable")[:MOST])
    if len(items) == 1:
        heading += f", {output.per} {items[0]}"
    elif len(items) > len(shown):
        heading += f", {len(shown)} of {len(items)} {output.per}s"
    return DrawnQuantity(
        heading + unit,
        output.per,
        tuple(items[i] for i in shown),
        tuple(in_unit[i] for i in shown),
        scale,
        size,
        len(items) - len(shown),
        _KINDS[output.unit] if output.vector else "",
    )


def _extent(values: FloatArray) -> float:
    known = values[~np.isnan(values)]
    return float(np.ptp(known)) if known.size else 0.0


def _along(result: SceneResult) -> int:
    """The axis that the driveline follows most: torque goes along it, bending across."""
    directions = result.scene.line.directions
    return int(np.argmax(np.abs(np.mean(directions.reshape(-1, 3), axis=0))))

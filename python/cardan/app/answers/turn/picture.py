"""The picture of a whole scene: one page."""

from __future__ import annotations

import textwrap
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from os import PathLike
from typing import TYPE_CHECKING

import numpy as np

import cardan.app.pictures.style as style
from cardan.app.answers.printed import curves_text
from cardan.app.answers.rounding import MAGNITUDES, is_steady, signed
from cardan.app.answers.rows import UNITS
from cardan.app.answers.turn.figures import SummaryRow, summary
from cardan.app.answers.turn.panel import Abscissa, Over, abscissa, frame_values
from cardan.app.answers.turn.text import summary_lines
from cardan.app.pictures.driveline import plot_driveline
from cardan.app.pictures.study import height_mm, plot_states, plot_study
from cardan.app.scene.language.units import RPM, as_shown, shown_in
from cardan.app.scene.scene import Scene, SceneResult
from cardan.app.scene.study.states import StatesResult
from cardan.arrays import FloatArray
from cardan.evaluation.outputs import Output

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# Millimetres: A4 across, its margin, the sketch and the table beside it, the panels below.
_PAGE, _MARGIN = (297.0, 210.0), 12.0
_SKETCH, _SKETCH_HEIGHTS = 176.0, (60.0, 80.0, 100.0)
_GAP, _BESIDE, _OVER, _UNDER = 4.0, 14.0, 10.0, 5.0
_TITLE_LINE, _LINE = 5.2, 3.4
# Lines of the key figures that long values may take.
_SPARE = 3
_LOW = 8.0
_IN_ONE_ROW = 3


def plot_scene(result: SceneResult, *, over: Over | None = None) -> Figure:
    """Return a page, A4 across, of everything that the scene evaluates.

    It has a sketch of the driveline, the key figures, and a panel for each quantity, with a curve
    for each shaft or joint on one scale: at most 6, those that vary most. What varies by less than
    1 % of its size, and angles of many turns, are lines of text instead. The components of a
    vector have a panel each; those across the driveline share a scale, that along it has its own.
    Up to three turns are drawn over the drive angle in degrees; of more turns bands show the
    extremes of each turn, or span of time, and lines the mean of its samples. With the speed of the
    drive given, acceleration is in rad/s² instead of a ratio.

    Args:
        result: an evaluated scene.
        over: ``"turns"``, ``"time"`` or ``"orders"``, amplitudes by multiples of the drive's
            rotation; by default the time where it was recorded, and else the turns.

    Raises:
        ValueError: times that were not recorded; orders of less than a turn or of a drive that
            turns back.
    """
    style.check_kind("result", result, SceneResult)
    with style.matplotlib().rc_context(style.STYLE), shown_in(result.scene.units):
        from matplotlib.figure import Figure

        figure = Figure(figsize=(_PAGE[0] * style.MM, _PAGE[1] * style.MM))
        along = abscissa(result.scene, over)
        every = quantities(result)
        drawn = [quantity for quantity in every if over == "orders" or not quantity.is_line(along)]
        lines = [quantity.line for quantity in every if quantity not in drawn]
        top = _title(figure, result.scene)
        height = _SKETCH_HEIGHTS[0 if len(drawn) > _IN_ONE_ROW else 1 if drawn else 2]
        _sketch(figure, result.scene, top, height)
        _key_figures(figure, result, top, height)
        foot = _notes(figure, result.scene, drawn, lines, along)
        if drawn:
            _panels(figure, drawn, along, top - height - _GAP, foot)
    return figure


def write_picture(
    result: SceneResult,
    path: str | PathLike[str],
    column: str | None = None,
    *,
    over: Over | None = None,
) -> None:
    """Write the picture of a scene in the format that the path's suffix names.

    Args:
        result: an evaluated scene.
        path: file to write.
        column: a figure of the scene's study, to draw over its keys as ``plot_study`` does, or of
            its states, as ``plot_states`` does.
        over: what to draw the scene over, as ``plot_scene`` takes it.

    Raises:
        OSError: the file cannot be written; nothing of it is left behind then.
        ValueError: an unknown suffix or column, a study of no key or more than two, what
            ``plot_scene`` cannot draw.
    """
    style.save(plot_scene(result, over=over) if column is None else _study(result, column), path)


def _study(result: SceneResult, column: str) -> Figure:
    scene = result.scene
    if result.study is None:
        raise ValueError(f"{scene.name}: there is no study to draw; it needs a section [study]")
    states = result.study if isinstance(result.study, StatesResult) else None
    height = height_mm(states.states.count) if states else 66.0
    with style.page(style.WIDTH, height, scene.title) as figure, shown_in(scene.units):
        axes = figure.add_subplot()
        if states:
            limits = scene.limits.figures if column == "equivalent_bend" else {}
            limit = limits.get("equivalent_bend_deg")
            bound = None if limit is None else float(np.radians(limit.maximum))
            plot_states(states, column, limit=bound, ax=axes)
        else:
            plot_study(result.study, column, ax=axes)
    return figure


def _text(figure: Figure, x: float, y: float, text: str, align: str = "left", **font: str) -> None:
    """Write at a place in millimetres from the page's lower left corner."""
    place = x / _PAGE[0], y / _PAGE[1]
    figure.text(*place, text, ha=align, va="baseline", parse_math=False, fontdict=dict(font))


def _axes(figure: Figure, left: float, low: float, width: float, height: float, name: str) -> Axes:
    """Make axes at a place in millimetres."""
    place = (left / _PAGE[0], low / _PAGE[1], width / _PAGE[0], height / _PAGE[1])
    return figure.add_axes(place, label=name)


def _title(figure: Figure, scene: Scene) -> float:
    """Write title and angles; return what is left of the page's height."""
    y = _PAGE[1] - _MARGIN
    for text in textwrap.wrap(scene.title or "Driveline", 100 if scene.title.isascii() else 60)[:3]:
        _text(figure, _MARGIN, y, text, fontsize="x-large", fontweight="bold")
        y -= _TITLE_LINE
    driven = scene.driven_angle_deg
    angles = scene.drive_angle_deg if driven is None else driven
    first, last = (style.number(round(float(find(angles)), 2)) for find in (np.nanmin, np.nanmax))
    shaft = "drive" if driven is None else "driven"
    said = [f"{shaft} angle {first}° to {last}°", f"{len(angles)} samples"]
    said[1] += f" of {scene.recording.name}" if scene.recording else ""
    if scene.speed:
        rpm = float(f"{scene.speed / RPM:.6g}")
        said += [
            f"drive at {'up to ' * scene.speed_recorded}{style.number(rpm)} {UNITS['rpm'].symbol}"
        ]
    _text(figure, _MARGIN, y - 0.5, ", ".join(said))
    return y - 5.0


def _sketch(figure: Figure, scene: Scene, top: float, height: float) -> None:
    known = scene.without_missing().line
    line = known[0] if known.shape else known
    axes = _axes(figure, _MARGIN, top - height, _SKETCH, height, "driveline")
    points = None if known.shape else scene.points
    plot_driveline(line, points=points, length_unit=scene.length_unit, ax=axes)


def _key_figures(figure: Figure, result: SceneResult, top: float, height: float) -> None:
    left, right = _MARGIN + _SKETCH + _GAP, _PAGE[0] - _MARGIN
    y, size = top - _LINE, float(style.STYLE["font.size"])
    _text(figure, left, y, "Key figures", fontweight="bold")
    for label, value in key_figures(summary(result), int(height / _LINE) - _SPARE):
        y -= _LINE
        _text(figure, left, y, label)
        wide = style.text_width(label, size) + style.text_width(value, size) + 2.0 * size
        # A value that does not fit beside its label goes below it.
        y -= _LINE if 25.4 / 72.0 * wide > right - left else 0.0
        _text(figure, right, y, value, "right")


def _panels(
    figure: Figure,
    drawn: Sequence[DrawnQuantity],
    along: Abscissa,
    top: float,
    foot: float,
) -> None:
    """Fill the page between two heights with panels, row by row."""
    count = len(drawn)
    rows = 1 if count <= _IN_ONE_ROW else 2 if count <= 8 else -(-count // 4)
    columns = -(-count // rows)
    width = (_PAGE[0] - 2.0 * _MARGIN) / columns
    height = (top - foot) / rows
    by_scale: dict[str, list[Axes]] = {}
    for i, quantity in enumerate(drawn):
        row, column = divmod(i, columns)
        low = top - (row + 1) * height
        axes = _axes(
            figure,
            _MARGIN + column * width + _BESIDE,
            low + _UNDER,
            width - _BESIDE - _GAP,
            height - _OVER - _UNDER,
            quantity.heading,
        )
        quantity.draw(axes, along, 0.8 * _BESIDE / 25.4 * 72.0)
        if rows > 2:
            style.value_ticks(axes.yaxis, 3)
        by_scale.setdefault(quantity.scale, []).append(axes)
        # The lowest panel of each column names what is along it.
        if i + columns >= count:
            axes.set_xlabel(along.label, labelpad=1.0)
    for sharing in by_scale.values():
        limits = [axes.get_ylim() for axes in sharing]
        for axes in sharing:
            axes.set_ylim(min(low for low, _ in limits), max(high for _, high in limits))


def _notes(
    figure: Figure,
    scene: Scene,
    drawn: Sequence[DrawnQuantity],
    lines: Sequence[str],
    along: Abscissa,
) -> float:
    """Write what has no panel and what the panels cannot say; return the height above it."""
    said = [f"Without a curve: {'; '.join(lines)}."] if lines else []
    if scene.line.shape:
        said.append("The driveline is drawn with the bends of the first sample.")
    if scene.driven_angle_deg is not None:
        said.append("Angles among the key figures are drive angles.")
    if along.note and drawn:
        said.append(along.note)
    if any(quantity.left_out for quantity in drawn):
        said.append(
            f"Panels show the {MOST} shafts, joints or bearings that vary most; "
            "those that their legends do not name are left out."
        )
    if vectors := list(dict.fromkeys(quantity.vector for quantity in drawn if quantity.vector)):
        what = " and ".join(vectors).capitalize()
        said.append(f"{_axes_named(scene)}. {what} across the driveline have a separate scale.")
    notes = textwrap.wrap(" ".join(said), 200)
    for i, note in enumerate(reversed(notes)):
        _text(figure, _MARGIN, _LOW + _LINE * i, note)
    # Between the panels and the notes are the name of what is along them, and some room.
    return _LOW + _LINE * len(notes) + 5.0


def _axes_named(scene: Scene) -> str:
    """Whose axes the components of vectors have."""
    line = scene.line[0] if scene.line.shape else scene.line
    if scene.points is not None:
        return "x, y, z: axes of the points"
    if np.array_equal(line.directions[0], (1, 0, 0)) and np.array_equal(line.normals[0], (0, 0, 1)):
        return "x: along shaft 0; z: normal of the bend plane of joint 0; y: in that plane"
    return "x, y, z: axes in which the scene gives its shafts"


_MANY = 4


def key_figures(rows: Sequence[SummaryRow], most: int) -> list[tuple[str, str]]:
    """Return label and value of each figure, at most so many lines.

    Of a figure of more than four shafts or joints only the largest stays, and where the lines are
    too many still, of each figure. What is left out from the end then is counted in a last line.
    """
    lines = list(_lines(rows, _MANY))
    if len(lines) > most:
        lines = list(_lines(rows, 1))
    if len(lines) > most:
        lines = [*lines[: most - 1], (f"and {len(lines) - most + 1} more", "")]
    return lines


def _lines(rows: Sequence[SummaryRow], most: int) -> Iterator[tuple[str, str]]:
    for _, group in groupby(rows, key=lambda row: row.quantity):
        found = list(group)
        if len({row.item for row in found}) <= most:
            yield from summary_lines(found)
            continue
        item = max(found, key=lambda row: abs(row.value)).item
        for label, text in summary_lines(row for row in found if row.item == item):
            yield label if label.startswith("largest") else f"largest {label}", text


# --- panels: what is drawn in each, and on which scale --------------------------------------------

MOST = len(style.LINES)
"""How many shafts or joints a panel shows at most."""


_KINDS = {"N m": "moments", "N": "forces"}


@dataclass(frozen=True, eq=False)
class DrawnQuantity:
    """A panel: a curve, ``(samples,)``, for each shaft, joint or bearing that there is room for."""

    name: str
    unit: str
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
    # Samples at each end of a recording that have an acceleration from one side only: its noise
    # there does not set the scale.
    ends: int = 0

    @property
    def heading(self) -> str:
        """Name of the quantity with its unit."""
        return f"{self.name} [{self.unit}]" if self.unit else self.name

    def is_line(self, over: Abscissa) -> bool:
        """Return whether a line of text says as much as the panel."""
        # The angle of many turns rises, whatever else it does.
        many = self.scale == "angle" and bool(over.note)
        return many or all(is_steady(curve, self.unit_size) for curve in self.curves)

    @property
    def line(self) -> str:
        """The panel as text: ``"torque, shaft 2: 600 N m"``."""
        between = " of " if len(self.items) > 1 else ": "
        return f"{self.name}{between}{curves_text(self._labelled(), self.unit, self.unit_size)}"

    def _labelled(self) -> list[tuple[str, FloatArray]]:
        names = [f"{self.per} {self.items[0]}", *map(str, self.items[1:])]
        return list(zip(names if len(names) > 1 else [""], self.curves, strict=True))

    def draw(self, axes: Axes, over: Abscissa, aside: float) -> None:
        """Draw the panel with its heading and, of several curves, its legend.

        These begin so many points to the left of the axes.
        """
        curves = self._labelled()
        over.draw(axes, curves=curves, scale=self.unit_size)
        inner = np.stack(self.curves)[:, self.ends : -self.ends or None]
        if self.ends and over.is_of_samples and not np.isnan(inner).all():
            frame_values(axes, inner, self.unit_size)
        # Over the ticks too, where long headings and six names need the width.
        left = -aside / axes.bbox.width * axes.figure.dpi / 72.0
        many = len(self.items) > 1
        axes.set_title(self.heading, loc="left", x=left, pad=14.5 if many else 5.5)
        if many:
            place = {"loc": "lower left", "bbox_to_anchor": (left, 1.0), "borderaxespad": 0.7}
            style.legend_above(
                axes, ncols=MOST, **{**place, "handlelength": 1.6, "columnspacing": 0.5}
            )


def quantities(result: SceneResult) -> list[DrawnQuantity]:
    """Return the panels of a scene: one per quantity, three for one that is a vector.

    The speed and acceleration of a drive that was recorded over time come first.
    """
    found: dict[str, tuple[Output, list[int], list[FloatArray]]] = {}
    for output, item, values in result.curves():
        _, items, curves = found.setdefault(output.name, (output, [], []))
        items.append(item)
        curves.append(values)
    scene, panels = result.scene, []
    if scene.speed_recorded and scene.load_case:
        for name, unit, values in (
            ("drive speed", "rpm", scene.load_case.speed / RPM),
            ("drive acceleration", "rad/s²", scene.load_case.acceleration),
        ):
            ends = 0 if "speed" in name else _ends(scene)
            panels.append(DrawnQuantity(name, unit, "shaft", (0,), (values,), name, ends=ends))
    for output, items, curves in found.values():
        if output.vector:
            # Torque goes along the axis that the driveline follows most, bending across.
            directions = scene.line.directions.reshape(-1, 3)
            along = int(np.argmax(np.abs(np.mean(directions, axis=0))))
            for i, axis in enumerate(output.axes):
                part = [values[:, i] for values in curves]
                scale = f"{output.name} {'along' if i == along else 'across'}"
                sense = "about" if _KINDS[output.unit] == "moments" else "along"
                panels.append(_panel(result, output, items, part, f" {sense} {axis}", scale))
        else:
            panels.append(_panel(result, output, items, curves, "", output.name))
    return panels


def _panel(
    result: SceneResult,
    output: Output,
    items: Sequence[int],
    curves: Sequence[FloatArray],
    component: str,
    scale: str,
) -> DrawnQuantity:
    name, size = f"{output.label}{component}", 1.0
    if output.name in MAGNITUDES:
        torque = _torques(result, items)
        curves = [signed(curve, own) for curve, own in zip(curves, torque, strict=True)]
        if any(np.nanmin(curve) < 0.0 for curve in curves):
            name += ", with the sign of the torque"
    every, unit = as_shown(np.stack(curves), output.unit)
    if output.name == "acceleration_ratio" and result.scene.speed:
        size = result.scene.speed**2
        speed = result.scene.load_case.speed if result.scene.load_case else 0.0
        every, unit = every * speed**2, "rad/s²"
        name = "acceleration" + " at steady drive" * result.scene.accelerates
    extents = np.array([_extent(values) for values in every])
    # Those that vary most, of equal ones the first, in the order of the driveline.
    shown = np.sort(np.argsort(-extents, kind="stable")[:MOST])
    if len(items) == 1:
        name += f", {output.per} {items[0]}"
    elif len(items) > len(shown):
        name += f", {len(shown)} of {len(items)} {output.per}s"
    return DrawnQuantity(
        name,
        unit,
        output.per,
        tuple(items[i] for i in shown),
        tuple(every[shown]),
        scale,
        size,
        len(items) - len(shown),
        _KINDS[output.unit] if output.vector else "",
        _ends(result.scene) if output.needs_load else 0,
    )


def _ends(scene: Scene) -> int:
    """Samples at each end whose acceleration has a filter on one side only."""
    return max((signal.reach for signal in scene.signals), default=0)


def _torques(result: SceneResult, joints: Sequence[int]) -> FloatArray:
    """Return the torques that leave joints, ``(joints, samples)``."""
    shafts = tuple(joint + 1 for joint in joints)
    scene = replace(result.scene, quantities=("torque",), shafts=shafts, study=None)
    return np.asarray(scene.run().values["torque"])


def _extent(values: FloatArray) -> float:
    known = values[~np.isnan(values)]
    return float(np.ptp(known)) if known.size else 0.0

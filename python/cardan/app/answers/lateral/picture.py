"""Pictures of lateral vibration: force over speed, shapes in resonance, force over stiffness."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

import cardan.app.pictures.style as style
from cardan.app.answers.answer import Answer
from cardan.app.answers.lateral.figures import BearingResponse, LateralFigures
from cardan.app.answers.lateral.vibration import Group
from cardan.app.answers.page import CLASSES, Curve, Panel, chart, some
from cardan.app.answers.printed import listed, quantity, with_unit
from cardan.app.answers.rows import UNITS, worst_of
from cardan.app.scene.language.units import RPM, shown_unit
from cardan.arrays import FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_SPEED = "drive speed [rpm]"
_PANEL, _SHAPE, _MAP = 50.0, 34.0, 62.0  # mm
_UNKNOWN = "0.55"
_RESONANCE: Mapping[str, Any] = {**style.THIN, "linestyle": (0, (4, 1.5))}
_DRAWN = 600  # speeds of a chart of the page
# Places along each shaft of a shape, and shapes of a picture.
_PLACES, _MOST = 25, 3
# Stiffnesses and speeds of a map, from a quarter of the stiffness to four times it.
_STIFFNESSES, _SPEEDS, _SPAN = 49, 241, 4.0


def drawn(_: Answer, found: LateralFigures) -> dict[str, Any]:
    """Return the force of each bearing over the speed as charts of the page.

    Where the damping is not known there are gaps. A resonance within the speeds without a limit of
    its own is not judged, whatever else has one.
    """
    charts: list[Any] = []
    response = found.response
    if response is None:
        return {"charts": charts}
    unknown = found.vibration.unknown
    places = some(len(response.speed), _DRAWN)
    for own in response.bearings:
        curves = tuple(
            Curve(label, np.where(unknown, np.nan, values)[places])
            for label, values in _curves(found, own)
        )
        scale = float(np.max(own.largest))
        panel = Panel(f"Force of bearing {own.bearing}", "N", curves, scale)
        charts.append(chart(panel, response.speed[places] / RPM, _SPEED))
    is_met = any(each.inside and each.excited for each in found.resonances)
    judged = [found.margin, found.torque_margin]
    judged += [value for each in found.bearings for value in (each.largest, each.displacement)]
    is_within = worst_of(value.verdict for value in judged if value) == "within"
    is_open = is_met and is_within and (found.margin is None or found.margin.limit is None)
    return {"charts": charts} | ({"class": CLASSES["not judged"]} if is_open else {})


def _curves(found: LateralFigures, own: BearingResponse) -> list[tuple[str, FloatArray]]:
    """Return the largest force of a bearing and that of each excited order, by labels."""
    excited = found.vibration.excited
    orders = [each for each in own.orders if each.order in excited]
    return [("largest", own.largest), *((f"order {each.order}", each.force) for each in orders)]


def _needed(answer: Answer, *, response: bool = True) -> LateralFigures:
    """Return the figures of a scene, with its response if that is needed."""
    found = answer.needed("lateral")
    assert isinstance(found, LateralFigures)
    if found.vibration.case.rigid_bearings:
        number = found.vibration.case.rigid_bearings[0]
        problem = (
            f"bearing {number} has no stiffness_N_per_mm, from which forces over the speed and "
            "shapes follow; 'cardan lateral' without a picture has couples and static forces"
        )
        raise ValueError(f"{answer.of.name}: {problem}")
    if response and (found.response is None or not found.response.bearings):
        why = found.why or "no bearing has a stiffness"
        raise ValueError(f"{answer.of.name}: there is no force over the speed: {why}")
    return found


def _force(answer: Answer) -> Figure:
    """Force of elastic bearings over the speed, with its orders."""
    found = _needed(answer)
    assert found.response
    panels = [
        (_PANEL, lambda axes, own=own: _draw_force(axes, found, own))
        for own in found.response.bearings
    ]
    return style.stacked(panels, answer.of.title)


def _draw_force(axes: Axes, found: LateralFigures, own: BearingResponse) -> None:
    """Draw the force of one bearing; resonances have their order at the top."""
    assert found.response
    factor, rpm = UNITS[shown_unit("N")].factor, found.response.speed / RPM
    for line, (label, values) in zip(style.LINES, _curves(found, own), strict=False):
        axes.plot(rpm, factor * values, label=label, **line)
    one = found.vibration
    for i, met in enumerate(one.bands):
        low, high = (np.clip(end / RPM, rpm[0], rpm[-1]) for end in met.band)
        look: dict[str, Any] = {"facecolor": "none", "edgecolor": _UNKNOWN, "hatch": "////"}
        axes.axvspan(low, high, linewidth=0.0, label=None if i else "not known", **look)
    # What is in a band would hide the rest.
    known = own.largest[~one.unknown]
    top = 1.15 * factor * float(np.max(known if known.size else own.largest))
    for each in found.resonances:
        if each.inside and each.excited:
            axes.axvline(each.speed / RPM, **_RESONANCE)
            axes.annotate(
                str(each.order),
                (each.speed / RPM, 1.0),
                xycoords=axes.get_xaxis_transform(),
                xytext=(1.5, -1.5),
                textcoords="offset points",
                va="top",
            )
    force = with_unit(f"force of bearing {own.bearing}", "N")
    style.finish(axes, _SPEED, force, (rpm[0], rpm[-1]), (0.0, top), ncols=5, handlelength=1.4)
    axes.set_axisbelow(True)


def _shapes(answer: Answer) -> Figure:
    """Shapes of the shafts in the lowest resonances."""
    found = _needed(answer, response=False)
    one = found.vibration
    met = {each.group.number for each in one.met if each.order in one.excited}
    groups = [group for group in one.groups if group.number in met][:_MOST]
    if not groups:
        raise ValueError(f"{answer.of.name}: no resonance is near the speeds of [lateral]")
    with style.page(style.WIDTH, _SHAPE * len(groups) + 6.0, answer.of.title) as figure:
        panels = figure.subplots(len(groups), squeeze=False, sharex=True)[:, 0]
        for axes, group in zip(panels, groups, strict=True):
            _draw_shape(axes, found, group)
            axes.label_outer()
        panels[0].legend(loc="lower left", frameon=False, borderpad=0.0, ncols=2)
    return figure


def _draw_shape(axes: Axes, found: LateralFigures, group: Group) -> None:
    """Draw how far each place of the shafts moves, along the direction in which most move."""
    one, ends = found.vibration, np.concatenate([[0.0], np.cumsum(found.vibration.system.lengths)])
    factor = UNITS[shown_unit("mm")].factor
    moving = one.case.moving
    along = {shaft: np.linspace(0.0, float(one.system.lengths[shaft]), _PLACES) for shaft in moving}
    probes = [(shaft, float(s)) for shaft in moving for s in along[shaft]]
    modes = one.system.modes(group.number + 1, probes=probes)
    moved = modes.displacement[:, group.number]
    direction = moved[np.argmax(np.linalg.norm(moved, axis=-1))]
    shape = np.split(moved @ direction / np.linalg.norm(direction), len(moving))
    axes.plot(factor * ends[[0, -1]], [0.0, 0.0], **style.THIN)
    for shaft, own in zip(moving, shape, strict=True):
        axes.plot(factor * (ends[shaft] + along[shaft]), own, **style.LINES[0])
    for i, (shaft, position) in enumerate(one.line.bearings):
        if one.case.supports[i]:
            at = float(position)
            height = float(np.interp(at, along[shaft], shape[moving.index(shaft)]))
            label = None if i else "bearing"
            axes.plot(factor * (ends[shaft] + at), height, "^", color="#D55E00", label=label)
    joints = factor * ends[1:-1]
    heights = [
        float(shape[moving.index(joint + 1)][0])
        if joint + 1 in moving
        else float(shape[moving.index(joint)][-1])
        for joint in range(len(joints))
    ]
    axes.plot(joints, heights, "o", color="k", markerfacecolor="w", label="joint")
    orders = [
        f"order {each.order} at {quantity(each.speed, 'rpm')}"
        for each in one.met
        if each.group.number == group.number and each.order in one.excited
    ]
    text = f"{quantity(group.frequency, 'Hz')}: {listed(orders)}"
    style.finish(axes, with_unit("along the driveline", "mm"), "moves by", None, (-1.2, 1.2))
    axes.set_yticks([-1.0, 0.0, 1.0])
    axes.set_title(text, loc="left")
    if legend := axes.get_legend():
        legend.remove()


def _stiffness(answer: Answer) -> Figure:
    """Force of order 2 over stiffness of a bearing and speed."""
    found = _needed(answer)
    return style.stacked([(_MAP, lambda axes: _draw_map(axes, found))], answer.of.title)


def _draw_map(axes: Axes, found: LateralFigures) -> None:
    """Draw the force of the bearing with the most of order 2; its scale is logarithmic."""
    from matplotlib import colormaps
    from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

    one = found.vibration
    assert one.load
    place = max(
        range(len(one.case.elastic)), key=lambda i: found.bearings[i].order_2 or 0.0, default=0
    )
    bearing = one.case.elastic[place]
    factors = np.geomspace(1.0 / _SPAN, _SPAN, _STIFFNESSES)
    speed = np.linspace(one.case.speed[0], one.case.speed[-1], _SPEEDS)
    rows = [
        one.case.stiffened(bearing, factor)
        .on(one.line)
        .response(speed, one.load, orders=(2,))
        .of_order("bearing_force")[place, :, 0]
        for factor in factors
    ]
    force = UNITS[shown_unit("N")].factor * np.maximum(rows, 1e-12)
    unit = shown_unit("N_per_mm")
    own = float(np.mean(one.case.supports[bearing]["stiffness"]))
    stiffness = UNITS[unit].factor * own * factors
    top = math.ceil(3.0 * math.log10(float(np.max(force))))
    levels = [_round(10.0 ** (step / 3.0)) for step in range(top - 7, top + 1)]
    colours = colormaps["Blues"](np.linspace(0.02, 0.65, len(levels)))
    axes.contourf(speed / RPM, stiffness, force, levels=[0.0, *levels], colors=colours)
    lines = axes.contour(
        speed / RPM, stiffness, force, levels=levels[:-1], colors="0.15", linewidths=0.5
    )
    axes.clabel(lines, fmt=style.number, fontsize="small")
    axes.axhline(UNITS[unit].factor * own, label="of the scene", **_RESONANCE)
    axes.set_yscale("log")
    axes.yaxis.set_major_locator(FixedLocator(stiffness[:: _STIFFNESSES // 4].tolist()))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda tick, _: style.number(tick)))
    axes.yaxis.set_minor_locator(NullLocator())
    axes.set_xlabel(_SPEED)
    axes.set_ylabel(with_unit(f"stiffness of bearing {bearing}", "N_per_mm"))
    axes.set_title(with_unit("order 2 of its force", "N"), loc="left")
    style.legend_above(axes)


def _round(value: float) -> float:
    """Return 1, 2 or 5 times a power of ten near a value."""
    power = 10.0 ** math.floor(math.log10(value) + 1e-9)
    return power * min((1.0, 2.0, 5.0, 10.0), key=lambda x: abs(math.log(x * power / value)))


PICTURES = {"lateral": _force, "shapes": _shapes, "stiffness": _stiffness}

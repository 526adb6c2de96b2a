"""Readings of an inclinometer, and how certain the verdict on them is."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from cardan.app.answers.answer import Answer
from cardan.app.answers.names import kind_name
from cardan.app.answers.printed import given, number_text, quantity
from cardan.app.answers.rows import figure, item, numbers, parts, word
from cardan.app.scene.machine import moving
from cardan.app.scene.scene import Scene
from cardan.app.scene.sections.driveline import OFFSETS, READINGS
from cardan.app.scene.study.states import States
from cardan.arrays import FloatArray
from cardan.design.limits import PRESETS
from cardan.design.machine import RANKS, MachineFigure
from cardan.driveline import Driveline
from cardan.geometry.constructors import spread_evenly

# Drivelines that the gauge may hide, which gives shares to about half a percent.
_SAMPLES = 1000

# Parts that are judged as read, because they have drivelines of their own.
_AS_READ = {
    "duty": "life",
    "slip": "spline",
    "torsion": "torsional vibration",
    "lateral": "lateral vibration",
    "tolerances": "tolerances",
}


@dataclass(frozen=True)
class WorkingAngle:
    """The angle of one joint as read, and what the gauge may hide."""

    joint: int = item("joint")
    bend: float = figure("working angle", "deg")
    least: float | None = figure("at least", "deg", "of what the gauge may hide", rounds="down")
    largest: float | None = figure("at most", "deg", "of what the gauge may hide", rounds="up")


@dataclass(frozen=True)
class ReadingFigures:
    """A driveline as an inclinometer has shown it."""

    inclinations: tuple[float, ...] = numbers("inclinations", "deg", "upwards to the output")
    angles: tuple[WorkingAngle, ...] = parts("Working angles")
    gauge: float | None = figure("each reading may be off by", "deg")
    within: float | None = figure(
        "within the limits",
        "percent",
        "share of what the gauge may hide in which everything is within its limits",
        source="1000 drivelines with errors of the readings spread evenly up to the accuracy",
        digits="share",
    )
    acceptable: float | None = figure(
        "within or tolerable",
        "percent",
        "the same with what is tolerable, where that is more",
        digits="share",
    )
    decides: str | None = word("decided by", "what is most often not within its limits")
    as_read: str = word("judged as read", "what has a limit and is not part of these shares")


def find(answer: Answer) -> ReadingFigures | None:
    """Return what was read of a driveline; ``None`` of one that is described otherwise."""
    scene = answer.scene
    if not scene.is_measured:
        return None
    assert scene.layout is not None
    read = np.radians(np.asarray(scene.layout.driveline[READINGS], float))
    bends = scene.line.bends
    if scene.gauge_deg is None:
        angles = (WorkingAngle(joint, float(bend), None, None) for joint, bend in enumerate(bends))
        return ReadingFigures(tuple(read.tolist()), tuple(angles), None, None, None, None, "")
    off = scene.gauge_deg * spread_evenly(_SAMPLES, len(read))
    ends = np.transpose([bends, *_bounds(scene)]).tolist()
    ranks, decides = _judged(scene, [*_hidden(scene, off, scene.states)])
    within, acceptable = (
        None if ranks is None else float(np.mean(ranks <= RANKS.index(rank)))
        for rank in ("within", "tolerable")
    )
    return ReadingFigures(
        tuple(read.tolist()),
        tuple(WorkingAngle(joint, *each) for joint, each in enumerate(ends)),
        float(np.radians(scene.gauge_deg)),
        within,
        None if acceptable == within else acceptable,
        decides,
        ", ".join(_as_read(answer)),
    )


def _bounds(scene: Scene) -> Iterator[FloatArray]:
    """Yield the least and the largest bend of each joint that the gauge may hide.

    A reading turns its shaft about the horizontal across the vehicle. The bend of a joint grows
    with the difference of two such turns, so it is largest at ends of both, and least where they
    are alike or as near as they come.
    """
    assert scene.gauge_deg is not None
    ends = scene.gauge_deg * np.array([[-1.0], [1.0]])
    (read,) = _hidden(scene, ends, None)
    forward, rise, aside = np.moveaxis(read.directions, -1, 0)
    low, high = np.arctan2(rise, forward)
    apart = np.stack([high[:-1] - low[1:], high[1:] - low[:-1]])
    across = np.sqrt(1.0 - aside[0] ** 2)
    fixed = np.diff(across) ** 2 + np.diff(aside[0]) ** 2
    for turn in (np.maximum(-apart.min(axis=0), 0.0), apart.max(axis=0)):
        chord = np.sqrt(fixed + across[:-1] * across[1:] * (2.0 * np.sin(0.5 * turn)) ** 2)
        yield 2.0 * np.arcsin(0.5 * chord)


def share_within(scene: Scene, tilts: FloatArray) -> float:
    """Return the share of what the gauge may hide in which tilted shafts keep every limit.

    Tilts are in degrees, one for each shaft, of a scene whose gauge has an accuracy.
    """
    assert scene.gauge_deg is not None
    off = scene.gauge_deg * spread_evenly(_SAMPLES, len(tilts)) + tilts
    ranks, _ = _judged(scene, [*_hidden(scene, off, scene.states)])
    return 0.0 if ranks is None else float(np.mean(ranks <= RANKS.index("within")))


def _as_read(answer: Answer) -> Iterator[str]:
    """Yield limits that the drivelines within the gauge error are not judged by."""
    rules = [rule for name in answer.scene.limits.presets for rule in PRESETS[name].on_bends]
    if not all(rule.holds_always for rule in rules):
        yield "published limits on more than bends and their difference"
    yield from (name for part, name in _AS_READ.items() if getattr(answer.scene, part) is not None)


def _hidden(scene: Scene, off: FloatArray, states: States | None) -> Iterator[Driveline]:
    """The drivelines that the gauge may hide, of the drawing or in every state."""
    layout = scene.layout
    assert layout is not None
    axes, count = (states.axes, states.count) if states else ((), 1)
    values = layout.values(axes, count)
    for state in range(count):
        own = {key: value[state] for key, value in values.items()}
        yield layout.of({**own, READINGS: own[READINGS] + off})


def _judged(scene: Scene, hidden: list[Driveline]) -> tuple[FloatArray | None, str | None]:
    """The worst rank of every driveline, and which figure is most often not within."""
    worst = np.zeros(_SAMPLES, int)
    often: dict[str, int] = {}
    for state, lines in enumerate(hidden):
        load = scene.states.load(state) if scene.states else scene.load_case
        for each in moving(scene, lines, load).figures():
            if np.isnan(each.limit):
                continue
            # What cannot be judged is not within.
            ranks = np.where(each.ranks == RANKS.index("not judged"), len(RANKS), each.ranks)
            worst = np.maximum(worst, ranks)
            past = int(np.count_nonzero(ranks > RANKS.index("within")))
            often[_name(each)] = often.get(_name(each), 0) + past
    if not often:
        return None, None
    name = max(often, key=lambda each: often[each])
    return worst, name if often[name] else None


def _name(each: MachineFigure) -> str:
    name = kind_name(each.kind.name)
    return name if each.item is None else f"{name} of {each.kind.per} {each.item}"


def _reading(inclination: float) -> str:
    way = "up" if inclination > 0.0 else "down"
    return f"{given(abs(inclination), 'deg')} {way}" if inclination else "level"


def sentences(found: ReadingFigures) -> Iterator[str]:
    """Say what was read, how certain the verdict is, and where the gauge is too coarse."""
    read = ", ".join(map(_reading, found.inclinations))
    yield f"Read towards the output, shaft by shaft: {read}."
    if found.gauge is None:
        return
    off = given(found.gauge, "deg")
    if found.within is not None:
        share = number_text(100.0 * found.within, "share")
        text = f"Everything is within its limits for {share}% of what the gauge may hide"
        if found.within == 1.0:
            text = "Everything is within its limits, whatever the gauge may hide"
        elif found.within == 0.0:
            text = f"Whatever the gauge may hide, the {found.decides} is not within its limit"
        elif found.decides:
            text += f"; else it is most often the {found.decides} that is not"
        yield f"{text}. Each reading may be off by {off} on its own."
    for each in found.angles:
        if each.bend < found.gauge:
            yield (
                f"The gauge may hide more than the working angle of joint {each.joint}, "
                f"{quantity(each.bend, 'deg')}; if that matters, read shafts {each.joint} and "
                f"{each.joint + 1} again with a finer one."
            )


# Pixels: width, height of each view, margin, radius of a gauge, and what is shorter than a label.
_WIDTH, _HEIGHT, _MARGIN, _GAUGE, _SHORT = 760.0, 190.0, 50.0, 13.0, 100.0


def drawn(answer: Answer, _: ReadingFigures) -> dict[str, Any]:
    """Return the picture as the template of the page takes it."""
    return {"picture": picture(answer.scene)}


def picture(scene: Scene) -> str:
    """Return side view and plan of a driveline that was read, as SVG."""
    assert scene.layout is not None
    read = np.asarray(scene.layout.driveline[READINGS], float)
    points = scene.points
    if points is None:
        along = scene.line.directions
        points = np.concatenate([np.zeros((1, 3)), np.cumsum(along, axis=0)])
    offsets = scene.layout.driveline.get(OFFSETS)
    parts = [*_side(points, read)]
    height = _HEIGHT
    if offsets is not None:
        parts += _plan(points, np.asarray(offsets, float))
        height *= 2.0
    return (
        f'<svg class="measured" viewBox="0 0 {_WIDTH:g} {height:g}" role="img" '
        f'xmlns="http://www.w3.org/2000/svg" font-size="13" fill="none" stroke="currentColor" '
        f'stroke-width="2"><title>What was measured where</title>{"".join(parts)}</svg>'
    )


def _scaled(points: Any, axis: int, middle: float) -> list[tuple[float, float]]:  # noqa: ANN401
    """Points of a view, true to scale, about a height; an axis of 1 is up, one of 2 is down."""
    scale = (_WIDTH - 2.0 * _MARGIN) / (points[-1, 0] - points[0, 0])
    across = points[:, axis] * (-1.0 if axis == 1 else 1.0)
    across = across - 0.5 * (across.min() + across.max())
    x = _MARGIN + scale * (points[:, 0] - points[0, 0])
    return [(float(a), float(middle + scale * b)) for a, b in zip(x, across, strict=True)]


def _line(points: list[tuple[float, float]]) -> list[str]:
    path = " ".join(f"{x:.1f},{y:.1f}" for x, y in points)
    joints = "".join(
        f'<circle cx="{x:.1f}" cy="{y:.1f}" r="5" fill="var(--page, white)"/>'
        for x, y in points[1:-1]
    )
    return [f'<polyline points="{path}" stroke-width="4"/>{joints}']


def _text(x: float, y: float, words: str, anchor: str = "middle") -> str:
    return (
        f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}" fill="currentColor" '
        f'stroke="none">{words}</text>'
    )


def _side(points: Any, read: Any) -> list[str]:  # noqa: ANN401 - arrays
    """The side view, with what the gauge shows on every shaft."""
    line = _scaled(points, 1, 0.6 * _HEIGHT)
    parts = [_text(_MARGIN, 20.0, "Side view: the gauge along each shaft", "start"), *_line(line)]
    for i, angle in enumerate(read):
        (x0, y0), (x1, y1) = line[i : i + 2]
        x, y = 0.5 * (x0 + x1), 0.5 * (y0 + y1) - _GAUGE - 6.0
        turn = math.radians(angle)
        dx, dy = _GAUGE * math.cos(turn), -_GAUGE * math.sin(turn)
        way = "up" if angle > 0.0 else "down"
        words = quantity(math.radians(abs(angle)), "deg") + (f" {way}" if angle else "")
        parts += [
            f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{_GAUGE}" stroke-width="1.5"/>',
            f'<path d="M{x - dx:.1f} {y - dy:.1f}L{x + dx:.1f} {y + dy:.1f}" stroke-width="1.5"/>',
            # Short shafts that follow each other have their labels on two heights.
            _text(x, y - _GAUGE - (22.0 if i % 2 and x1 - x0 < _SHORT else 6.0), words),
            _text(x, max(y0, y1) + 24.0, f"shaft {i}"),
        ]
    return parts


def _plan(points: Any, offsets: Any) -> list[str]:  # noqa: ANN401 - arrays
    """The plan, with the offset of every end and joint centre from the line along the vehicle."""
    line = _scaled(points, 2, 1.6 * _HEIGHT)
    scale = (_WIDTH - 2.0 * _MARGIN) / (points[-1, 0] - points[0, 0])
    axis = line[0][1] - scale * offsets[0]
    parts = [
        _text(_MARGIN, _HEIGHT + 20.0, "Plan: the tape from one line to each centre", "start"),
        f'<path d="M{_MARGIN:g} {axis:.1f}H{_WIDTH - _MARGIN:g}" stroke-dasharray="6 5" '
        'stroke-width="1"/>',
        *_line(line),
    ]
    for i, ((x, y), offset) in enumerate(zip(line, offsets, strict=True)):
        side = "left" if offset > 0.0 else "right"
        if offset:
            parts.append(f'<path d="M{x:.1f} {axis:.1f}V{y:.1f}" stroke-width="1.5"/>')
            words = f"{given(1e-3 * abs(offset), 'mm')} {side}"
            away = 16.0 * (i % 2)
            parts.append(_text(x, y + (22.0 + away if offset > 0.0 else -12.0 - away), words))
    return parts

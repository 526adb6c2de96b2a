"""A picture of what was measured where: a gauge on every shaft, a tape in plan."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from cardan.app.answers.answer import Answer
from cardan.app.answers.printed import given, quantity
from cardan.app.answers.readings.figures import ReadingFigures
from cardan.app.scene.scene import Scene
from cardan.app.scene.sections.driveline import OFFSETS, READINGS

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

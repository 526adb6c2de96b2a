"""Draw double joints and joints with offsets."""

from __future__ import annotations

import math

import numpy as np
from draw import BLUE, GREEN, GREY, INK, RED, Drawing, Point, Space, arc


def double_joint() -> Drawing:
    """The triangle of both joints and the pivot."""
    d = Drawing(560, 230, "A double joint with a pivot")
    total, scale, share = math.radians(50), 230.0, 0.55
    first, pivot = (170.0, 60.0), (170.0 + share * scale, 60.0)
    along = -share * math.cos(total) + math.sqrt(1.0 - (share * math.sin(total)) ** 2)

    def behind(length: float) -> Point:
        """A point of the driven shaft, so far behind the pivot."""
        return (
            pivot[0] + length * scale * math.cos(total),
            pivot[1] + length * scale * math.sin(total),
        )

    second = behind(along)
    d.line((20.0, 60.0), first, colour=BLUE, width=6)
    d.line(second, behind(along + 0.32), colour=RED, width=6)
    d.line(first, second, colour=INK, width=5)
    d.line(first, pivot, colour=BLUE, dash="7 4")
    d.line(pivot, (pivot[0] + 150.0, 60.0), colour=GREY, dash="4 4", width=1.2)
    d.line(pivot, second, colour=RED, dash="7 4")
    for point in (first, pivot, second):
        d.dot(point, 5.5)
    lean = math.degrees(math.atan2(second[1] - first[1], second[0] - first[0]))
    d.arrow(*arc(first, 62, 0, lean), colour=GREEN)
    d.arrow(*arc(pivot, 52, 0, math.degrees(total)), colour=GREEN)
    beyond = (second[0] + 0.4 * (second[0] - first[0]), second[1] + 0.4 * (second[1] - first[1]))
    d.line(second, beyond, colour=GREY, dash="4 4", width=1.2)
    d.arrow(*arc(second, 62, lean, math.degrees(total)), colour=GREEN)
    d.text((251, 68), "*β_0", colour=GREEN, size=15)
    d.text((360, 78), "*t", colour=GREEN, size=15)
    d.text((second[0] + 78, second[1] + 54), "*β_1", colour=GREEN, size=15)
    d.text((236, 38), "*p", colour=BLUE, size=16)
    d.text((first[0] + 60, first[1] + 60), "*a", size=16)
    d.text((170, 34), "joint 0", size=13)
    d.text((pivot[0] + 22, 34), "pivot", size=13)
    d.text((second[0] - 44, second[1] + 14), "joint 1", size=13)
    d.text((76, 76), "driving shaft", colour=BLUE, size=13)
    d.text((behind(along + 0.32)[0] - 58, 214), "driven shaft", colour=RED, size=13)
    return d


def offset_joint() -> Drawing:
    """The loop of offsets and slides from the driving shaft round to it."""
    d = Drawing(560, 330, "The loop of a joint whose axes do not meet")
    bend, angle = math.radians(40), math.radians(30)
    u, m = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])
    v = np.array([math.cos(bend), math.sin(bend), 0.0])
    p = math.cos(angle) * np.cross(m, u) + math.sin(angle) * m
    q = np.cross(v, p) / np.linalg.norm(np.cross(v, p))
    # Slides that can be seen; the offsets are those that cause them.
    s_2, s_3, s_4, apart = 0.5, 0.5, -0.5, 1.0
    sides = np.stack([np.cross(u, p), np.cross(p, q), np.cross(q, v)], axis=-1)
    g_1, h, g_3 = np.linalg.solve(sides, apart * m - s_2 * p - s_3 * q - s_4 * v)
    steps = (
        (g_1 * np.cross(u, p), "*g_1", INK, (-34, 6)),
        (s_2 * p, "*s_2", GREEN, (26, -14)),
        (h * np.cross(p, q), "*h", INK, (4, 10)),
        (s_3 * q, "*s_3", RED, (18, -6)),
        (g_3 * np.cross(q, v), "*g_3", INK, (-18, -8)),
        (s_4 * v, "*s_4", BLUE, (0, 10)),
        (-apart * m, "*d", INK, (-14, 30)),
    )
    see = Space((270.0, 80.0), 190.0, -62.0, 28.0)
    at = np.zeros(3)
    for way, label, colour, (dx, dy) in steps:
        along = way / np.linalg.norm(way)
        if colour in (GREEN, RED, BLUE):
            d.line(see(at - 0.35 * along), see(at + way + 0.35 * along), colour=GREY, dash="4 4")
        d.arrow(see(at), see(at + way), colour=colour, width=2.2)
        x, y = see(at + 0.5 * way)
        d.text((x + dx, y + dy), label, colour=colour, size=16)
        at = at + way
    d.line(see(-1.1 * u), see(0.9 * u), colour=BLUE, dash="7 4")
    d.text((446, 68), "axis of the driving shaft", colour=BLUE, size=13)
    d.text((120, 246), "axis of the driven shaft", colour=BLUE, size=13)
    d.text((190, 60), "driving pin", colour=GREEN, size=13)
    d.text((440, 216), "driven pin", colour=RED, size=13)
    return d


DRAWINGS = (double_joint, offset_joint)

"""Draw the angles of the conventions."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Literal

import numpy as np
from matplotlib.font_manager import FontProperties
from matplotlib.path import Path
from matplotlib.textpath import TextPath
from numpy.typing import NDArray

Point = tuple[float, float]
Vector = NDArray[np.float64]

INK, GREY, BLUE, RED, GREEN = "#222222", "#9a9a9a", "#0072B2", "#D55E00", "#007A5A"


class Drawing:
    """An SVG in units of pixels, y upwards.

    Attributes:
        size: width and height.
        labels: the texts with their boxes: left, bottom, right, top.
        lines: the points of each line.
        parts: elements of the file.
    """

    def __init__(self, width: float, height: float, title: str) -> None:
        """Begin an empty drawing."""
        self.size = (width, height)
        self.labels: list[tuple[str, tuple[float, ...]]] = []
        self.lines: list[tuple[Point, ...]] = []
        self.parts = [f"<title>{title}</title>", '<rect width="100%" height="100%" fill="white"/>']

    def _at(self, point: Point) -> str:
        return f"{point[0]:.1f},{self.size[1] - point[1]:.1f}"

    def line(self, *points: Point, colour: str = INK, width: float = 1.6, dash: str = "") -> None:
        """Draw a line through points."""
        self.lines.append(points)
        listed = " ".join(map(self._at, points))
        dashes = f' stroke-dasharray="{dash}"' if dash else ""
        self.parts.append(
            f'<polyline points="{listed}" fill="none" stroke="{colour}" stroke-width="{width}"'
            f' stroke-linejoin="round" stroke-linecap="round"{dashes}/>'
        )

    def area(self, *points: Point, colour: str) -> None:
        """Fill an area."""
        listed = " ".join(map(self._at, points))
        self.parts.append(f'<polygon points="{listed}" fill="{colour}"/>')

    def arrow(self, *points: Point, colour: str = INK, width: float = 1.6) -> None:
        """Draw a line through points with a head at its end."""
        (x0, y0), (x1, y1) = points[-2:]
        along = math.atan2(y1 - y0, x1 - x0)
        # The line ends within the head.
        neck = (x1 - 6 * math.cos(along), y1 - 6 * math.sin(along))
        self.line(*points[:-1], neck, colour=colour, width=width)
        sides = [
            (x1 - 10 * math.cos(along + turn), y1 - 10 * math.sin(along + turn))
            for turn in (-0.33, 0.33)
        ]
        self.area((x1, y1), *sides, colour=colour)

    def text(
        self,
        point: Point,
        text: str,
        *,
        colour: str = INK,
        size: float = 14,
        anchor: str = "middle",
    ) -> None:
        """Write; what is between underscores is a subscript, a leading * makes it a symbol.

        Letters become outlines: a text that a browser sets in its own font could be cut.
        """
        main, *rest = text.removeprefix("*").split("_")
        low, *after = [*rest, ""]
        style: Literal["normal", "italic"] = "italic" if text.startswith("*") else "normal"
        parts: list[tuple[str, float, Literal["normal", "italic"], float]] = [
            (main, size, style, 0.0),
            (low, 0.72 * size, "normal", -4.0),
            ("".join(after), size, style, 0.0),
        ]
        pieces, width = [], 0.0
        for words, tall, slant, rise in parts:
            if words:
                path = TextPath((width, rise), words, size=tall, prop=_font(slant))
                pieces.append(path)
                # A blank at the end has no outline.
                width = path.vertices[:, 0].max() + (0.06 * size)
        outline = Path.make_compound_path(*pieces)
        shift = {"start": 0.0, "middle": -width / 2.0, "end": -width}[anchor]
        at = (point[0] + shift, point[1])
        box = outline.get_extents()
        self.labels.append((text, (*(box.min + at), *(box.max + at))))
        self.parts.append(
            f'<path aria-label="{main}{low}" fill="{colour}" d="{self._d(outline, at)}"/>'
        )

    def _d(self, path: Path, at: Point) -> str:
        letters = {Path.MOVETO: "M", Path.LINETO: "L", Path.CURVE3: "Q", Path.CURVE4: "C"}
        written = []
        for points, code in path.iter_segments(curves=True, simplify=False):
            if code == Path.CLOSEPOLY:
                written.append("Z")
            elif code in letters:
                pairs = np.reshape(points, (-1, 2)) + at
                listed = " ".join(f"{x:.1f},{self.size[1] - y:.1f}" for x, y in pairs)
                written.append(letters[code] + listed)
        return "".join(written)

    def dot(self, point: Point, radius: float = 4, colour: str = INK) -> None:
        """Draw a filled circle."""
        x, y = self._at(point).split(",")
        self.parts.append(f'<circle cx="{x}" cy="{y}" r="{radius}" fill="{colour}"/>')

    def svg(self) -> str:
        """Return the file."""
        width, height = self.size
        head = f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:g} {height:g}">'
        return "\n".join([head, *self.parts, "</svg>", ""])


def _font(style: Literal["normal", "italic"]) -> FontProperties:
    return FontProperties(family="DejaVu Sans", style=style)


def polar(centre: Point, radius: float, degrees: float) -> Point:
    """Return a point at an angle from the x axis."""
    angle = math.radians(degrees)
    return centre[0] + radius * math.cos(angle), centre[1] + radius * math.sin(angle)


def arc(centre: Point, radius: float, start: float, stop: float) -> list[Point]:
    """Return points of an arc, angles in degrees."""
    return [polar(centre, radius, angle) for angle in np.linspace(start, stop, 97)]


class Space:
    """Three dimensions seen obliquely: x to the right and towards the eye, z up."""

    def __init__(self, origin: Point, scale: float, azimuth: float, elevation: float) -> None:
        """Look from an azimuth (about z, from x) and an elevation, both in degrees."""
        a, e = math.radians(azimuth), math.radians(elevation)
        self.origin, self.scale = origin, scale
        self.right = np.array([-math.sin(a), math.cos(a), 0.0])
        self.up = np.array([-math.sin(e) * math.cos(a), -math.sin(e) * math.sin(a), math.cos(e)])

    def __call__(self, vector: Vector) -> Point:
        """Return where a vector from the origin ends."""
        return (
            self.origin[0] + self.scale * float(self.right @ vector),
            self.origin[1] + self.scale * float(self.up @ vector),
        )


def turn(start: Vector, towards: Vector, degrees: float, radius: float = 1.0) -> list[Vector]:
    """Return an arc from a unit vector towards another across it."""
    angles = np.linspace(0.0, math.radians(degrees), 33)
    return [radius * (math.cos(t) * start + math.sin(t) * towards) for t in angles]


def driveline() -> Drawing:
    """Names and numbers along a driveline, and its bends."""
    d = Drawing(640, 220, "Shafts, joints and bends of a driveline")
    points = [(30.0, 60.0), (190.0, 60.0), (430.0, 140.0), (610.0, 140.0)]
    slope = math.degrees(math.atan2(80, 240))
    for first, second in pairwise(points):
        d.line(first, second, width=5, colour="#c9c9c9")
    for joint, along in ((1, 0.0), (2, slope)):
        d.line(points[joint], polar(points[joint], 95, along), colour=GREY, dash="4 4", width=1.2)
    d.arrow(*arc(points[1], 78, 0, slope), colour=RED)
    d.arrow(*arc(points[2], 78, slope, 0), colour=RED)
    d.text((288, 73), "*β_0", colour=RED)
    d.text((525, 151), "*β_1", colour=RED)
    for i, (first, second) in enumerate(pairwise(points)):
        angle = slope if i == 1 else 0.0
        tail = polar(first, 18 if i == 0 else 100, angle)
        d.arrow(tail, polar(tail, 52, angle), colour=BLUE, width=2.4)
        middle = polar(tail, 30, angle)
        d.text((middle[0] - 4 * (i == 1), middle[1] + 10), f"*u_{i}", colour=BLUE)
        d.text(
            (
                (first[0] + second[0]) / 2 + 60 * (i == 1),
                (first[1] + second[1]) / 2 - 28 - 10 * (i == 1),
            ),
            ("shaft 0, drive", "shaft 1, intermediate", "shaft 2, output")[i],
            size=13,
        )
    for joint in (1, 2):
        d.dot(points[joint], 8)
        d.text((points[joint][0] - 8, points[joint][1] + 18), f"joint {joint - 1}", size=13)
    d.text(
        (320, 205),
        "drive at the left, output at the right; shafts and joints are counted from 0",
        size=13,
    )
    return d


def joint() -> Drawing:
    """One joint in space: bend plane, normal, pins and drive angle."""
    d = Drawing(560, 400, "One joint: bend plane, normal, pins and drive angle")
    bend, angle = math.radians(38), math.radians(35)
    u_in = np.array([1.0, 0.0, 0.0])
    m = np.array([0.0, 0.0, 1.0])
    u_out = np.array([math.cos(bend), math.sin(bend), 0.0])
    e_in, e_out = np.cross(m, u_in), np.cross(m, u_out)
    driven = math.atan2(math.sin(angle), math.cos(bend) * math.cos(angle))
    a = math.cos(angle) * e_in + math.sin(angle) * m
    b = -math.sin(driven) * e_out + math.cos(driven) * m
    see = Space((285.0, 195.0), 140.0, -115.0, 18.0)
    zero = np.zeros(3)
    plane = [see(v) for v in (-1.55 * u_in, -1.55 * u_in + 0.9 * e_in, 1.35 * u_out + 0.35 * e_in)]
    d.area(*plane, see(1.35 * u_out), see(zero), colour="#eef3f7")
    d.line(*(see(v) for v in turn(e_in, m, 360)), colour=GREY, width=1.1, dash="3 3")
    d.line(see(-1.55 * u_in), see(zero), width=6, colour="#c9c9c9")
    d.line(see(zero), see(1.4 * u_out), width=6, colour="#c9c9c9")
    d.line(see(zero), see(1.2 * u_in), colour=GREY, width=1.2, dash="4 4")
    d.arrow(see(-1.5 * u_in), see(-0.85 * u_in), colour=BLUE, width=2.4)
    d.arrow(see(0.75 * u_out), see(1.4 * u_out), colour=BLUE, width=2.4)
    d.arrow(see(zero), see(1.25 * m))
    d.arrow(see(zero), see(1.25 * e_in))
    d.line(see(-0.6 * a), see(0.95 * a), colour=GREEN, width=4)
    d.line(see(-0.6 * b), see(0.95 * b), colour=RED, width=4)
    d.arrow(*(see(v) for v in turn(e_in, m, 35, 0.78)), colour=GREEN)
    d.arrow(*(see(v) for v in turn(u_in, e_in, 38, 1.1)), colour=RED)
    for vector, label, colour, dx, dy in (
        (-1.2 * u_in, "*u_in", BLUE, 4, 12),
        (1.4 * u_out, "*u_out", BLUE, 24, 4),
        (1.25 * m, "*m", INK, 14, 0),
        (1.25 * e_in, "*e_in", INK, -16, 6),
        (0.95 * a, "*a", GREEN, 14, 2),
        (0.95 * b, "*b", RED, 12, 0),
        (0.57 * (math.cos(0.3) * e_in + math.sin(0.3) * m), "*α", GREEN, 0, -6),
        (1.1 * (math.cos(0.3) * u_in + math.sin(0.3) * e_in), "*β", RED, 17, 3),
    ):
        x, y = see(vector)
        d.text((x + dx, y + dy), label, colour=colour, size=16)
    d.dot(see(zero), 5)
    d.text((280, 34), "a: pin of the driving yoke, b: pin of the driven yoke;", size=13)
    d.text(
        (280, 14),
        "m: normal of the bend plane (shaded, level here); dashed: path of pin a",
        size=13,
    )
    return d


def along_the_shaft() -> Drawing:
    """Drive angle, twist and phase, looking from the drive towards the output."""
    d = Drawing(760, 270, "Drive angle, twist and phase, looking from the drive towards the output")
    panels = (
        (130.0, "drive angle α", 180.0, 40.0, ("*e_in", "*a"), GREEN, "*α"),
        (360.0, "twist τ of the bend planes", 90.0, 50.0, ("*m_j−1", "*m_j"), INK, "*τ"),
        (565.0, "phase δ of the shaft", 60.0, 65.0, ("input pin", "output pin"), RED, "*δ"),
    )
    for x, title, start, size, labels, colour, symbol in panels:
        centre = (x, 135.0)
        d.line(*arc(centre, 78, 0, 360), colour=GREY, width=1.2)
        d.dot(centre, 4)
        d.text((x, 254), title)
        if symbol == "*α":
            d.arrow(centre, polar(centre, 95, 90))
            d.text((x + 14, 222), "*m")
        for label, angle in zip(labels, (start, start - size), strict=True):
            tint = colour if label == labels[1] else INK
            if symbol == "*δ":
                tint = GREEN if label == labels[1] else RED
                d.line(
                    polar(centre, 62, angle + 180), polar(centre, 84, angle), colour=tint, width=4
                )
            elif label == "*a":
                d.line(
                    polar(centre, 62, angle + 180), polar(centre, 84, angle), colour=tint, width=4
                )
            else:
                d.arrow(centre, polar(centre, 92, angle), colour=tint)
            place = polar(centre, 104, angle)
            if symbol == "*δ":
                place = (place[0] + (22 if label == labels[1] else 8), place[1])
            height = 12 if symbol == "*δ" else 14
            d.text((place[0], place[1] - 5), label, colour=tint, size=height)
        d.arrow(*arc(centre, 48, start, start - size), colour=INK)
        place = polar(centre, 33, start - size / 2)
        d.text((place[0], place[1] - 5), symbol, size=16)
    d.text(
        (380, 30), "looking from the drive towards the output: u points away from the eye,", size=13
    )
    d.text((380, 12), "positive turns are clockwise", size=13)
    return d


def tilts() -> Drawing:
    """The moment vector and the pin tilts."""
    d = Drawing(560, 280, "Moment vector and tilts of the cross")
    bend, angle = math.radians(38), math.radians(35)
    u_in, m = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])
    u_out = np.array([math.cos(bend), math.sin(bend), 0.0])
    e_in, e_out = np.cross(m, u_in), np.cross(m, u_out)
    driven = math.atan2(math.sin(angle), math.cos(bend) * math.cos(angle))
    a = math.cos(angle) * e_in + math.sin(angle) * m
    b = -math.sin(driven) * e_out + math.cos(driven) * m
    moment = np.cross(a, b)
    moment = moment / np.linalg.norm(moment)
    moment = moment * np.sign(moment @ u_in)
    see = Space((190.0, 110.0), 215.0, -115.0, 18.0)
    zero = np.zeros(3)
    reach = 1.25
    d.area(see(zero), *(see(reach * v) for v in between(u_in, moment)), colour="#e3efe9")
    d.area(see(zero), *(see(reach * v) for v in between(u_out, moment)), colour="#f8e7dc")
    d.line(see(-0.5 * u_in), see(zero), width=6, colour="#c9c9c9")
    d.line(see(zero), see(0.45 * u_out), width=6, colour="#c9c9c9")
    d.line(see(-0.3 * a), see(0.42 * a), colour=GREEN, width=4)
    d.line(see(-0.3 * b), see(0.42 * b), colour=RED, width=4)
    for vector, label, colour, dx, dy in (
        (u_in, "*u_in", BLUE, 4, -20),
        (u_out, "*u_out", BLUE, 22, 2),
        (moment, "*M", INK, 14, 4),
    ):
        d.arrow(see(zero), see(1.4 * vector), colour=colour, width=2.2)
        x, y = see(1.4 * vector)
        d.text((x + dx, y + dy), label, colour=colour, size=16)
    for vector, colour, label in ((u_in, GREEN, "*ψ_1"), (u_out, RED, "*ψ_2")):
        points = between(vector, moment)
        d.arrow(*(see(reach * v) for v in points), colour=colour)
        x, y = see(
            (reach - (0.14 if colour == GREEN else 0.22)) * points[16 if colour == GREEN else 7]
        )
        d.text((x, y - (4 if colour == GREEN else 8)), label, colour=colour, size=16)
    x, y = see(0.42 * a)
    d.text((x - 4, y + 8), "*a", colour=GREEN, size=16)
    x, y = see(0.42 * b)
    d.text((x, y + 8), "*b", colour=RED, size=16)
    d.text(
        (280, 34), "M is perpendicular to both pins. ψ₁ lies in the plane across pin a,", size=13
    )
    d.text((280, 14), "ψ₂ in the plane across pin b; both are drawn from the shaft to M.", size=13)
    return d


def sphere() -> Drawing:
    """Grossmann's figure 2: shafts and moment as points of a sphere."""
    d = Drawing(640, 330, "Shafts and moment vector as points of a sphere")
    bend, turned = math.radians(55), math.radians(50)
    first = np.array([1.0, 0.0, 0.0])
    second = np.array([math.cos(bend), math.sin(bend), 0.0])
    # The moment stays in the plane across pin 1, which the drive angle turns about shaft I.
    along = math.sin(turned) * np.array([0.0, 1.0, 0.0]) + math.cos(turned) * np.array([0, 0, 1.0])
    tilt = math.atan(math.tan(bend) * math.sin(turned))
    moment = math.cos(tilt) * first + math.sin(tilt) * along
    viewer = first + second + 0.5 * np.array([0.0, 0.0, 1.0])
    viewer = viewer / np.linalg.norm(viewer)
    right = np.cross([0.0, 0.0, 1.0], viewer)
    right = right / np.linalg.norm(right)
    up, centre, radius = np.cross(viewer, right), (205.0, 165.0), 145.0

    def see(vector: Vector) -> Point:
        return centre[0] + radius * float(vector @ right), centre[1] + radius * float(vector @ up)

    def corner(at: Vector, one: Vector, other: Vector) -> list[Point]:
        return [see(math.cos(0.26) * at + math.sin(0.26) * way) for way in between(one, other)]

    d.line(*arc(centre, radius, 0, 360), colour=GREY, width=1.2)
    for ends, label, colour, aside in (
        ((first, second), "*φ", BLUE, (0, -20)),
        ((first, moment), "*ψ_1", GREEN, (16, -22)),
        ((second, moment), "*ψ_2", RED, (24, 4)),
    ):
        points = [see(v) for v in between(*ends)]
        d.line(*points, colour=colour, width=2.4)
        x, y = points[len(points) // 2]
        d.text((x + aside[0], y + aside[1]), label, colour=colour, size=17)
    start = np.array([0.0, 0.0, 1.0])
    d.line(
        *(see(math.cos(a) * first + math.sin(a) * start) for a in np.linspace(0, 0.62, 20)),
        colour=GREY,
        dash="4 4",
        width=1.2,
    )
    d.arrow(*corner(first, start, along), colour=GREEN)
    to_first, to_moment = (
        (v - (v @ second) * second) / np.linalg.norm(v - (v @ second) * second)
        for v in (first, moment)
    )
    d.arrow(*corner(second, to_first, to_moment), colour=RED)
    for at, ways, label, colour in (
        (first, start + along, "*α_1", GREEN),
        (second, to_first + to_moment, "*α_2", RED),
    ):
        x, y = see(at + 0.42 * ways / np.linalg.norm(ways))
        d.text((x, y + (4 if at is first else -6)), label, colour=colour, size=17)
    for vector, label, dx, dy in (
        (first, "I", -14, -12),
        (second, "II", 14, -12),
        (moment, "M", 4, 12),
    ):
        d.dot(see(vector), 4)
        d.text((see(vector)[0] + dx, see(vector)[1] + dy), label, size=17)
    for row, text in enumerate(
        (
            "I, II: the shafts; M: the moment",
            "right angle at M: cos φ = cos ψ₁ cos ψ₂",
            "tan ψ₁ = tan φ sin α₁",
            "tan ψ₂ = tan φ cos α₂",
            "dashed: where M moves from I at first",
        )
    ):
        d.text((372, 250 - 26 * row), text, size=12, anchor="start")
    return d


def signs() -> Drawing:
    """A chain of four joints with the signs of the root rule (Bild 20)."""
    d = Drawing(640, 210, "A chain of joints with the signs of the root rule")
    points = [
        (20.0, 120.0),
        (110.0, 120.0),
        (270.0, 92.0),
        (420.0, 110.0),
        (540.0, 84.0),
        (622.0, 90.0),
    ]
    for start, end in pairwise(points):
        d.line(start, end, width=5, colour="#c9c9c9")
    # Whether the driving yoke of each joint lies in its bend plane, which is the plane of the page.
    for joint, (inside, sign) in enumerate(((True, "+"), (False, "−"), (False, "−"), (True, "+"))):
        at = points[joint + 1]
        for other, lies in ((points[joint], inside), (points[joint + 2], not inside)):
            way = math.degrees(math.atan2(other[1] - at[1], other[0] - at[0]))
            root = polar(at, 30, way)
            colour = BLUE if other is points[joint] else RED
            if lies:
                for side in (90, -90):
                    d.line(
                        root,
                        polar(root, 16, way + side),
                        polar(at, 16, way + side),
                        colour=colour,
                        width=3,
                    )
            else:
                d.line(root, at, colour=colour, width=6)
        d.dot(at, 5)
        d.text((at[0], at[1] + 34), f"*{sign}β_{joint}", size=17)
    d.text(
        (320, 44),
        "blue: driving yokes, red: driven yokes; all bends in the plane of the page",
        size=13,
    )
    d.text(
        (320, 20), "+: the driving yoke lies in the bend plane; −: it is across that plane", size=13
    )
    return d


def between(first: Vector, second: Vector) -> list[Vector]:
    """Return the unit vectors of the shortest turn from one unit vector to another."""
    across = second - (first @ second) * first
    across = across / np.linalg.norm(across)
    return turn(first, across, math.degrees(math.acos(float(first @ second))))


def deviations() -> Drawing:
    """Yokes that lean and a cross that is not square."""
    d = Drawing(600, 200, "Deviations of driving yoke, cross and driven yoke")
    for x, axis, blue, pin, colour, angle, caption in (
        (90.0, "*u", BLUE, "*p", GREEN, "*e_1", "driving yoke"),
        (290.0, "*p", GREEN, "*q", RED, "*e_2", "cross"),
        (490.0, "*v", BLUE, "*q", RED, "*e_3", "driven yoke"),
    ):
        d.line((x, 80), (x, 175), colour=GREY, width=1.2, dash="4 4")
        d.arrow((x - 55, 80), (x + 70, 80), colour=blue, width=2.4)
        d.line(polar((x, 80), -40, 72), polar((x, 80), 95, 72), colour=colour, width=4)
        d.arrow(*arc((x, 80), 75, 90, 72))
        labels = (84, 74, axis, blue), (46, 166, pin, colour), (8, 180, angle, INK)
        for right, up, label, ink in labels:
            d.text((x + right, up), label, colour=ink, size=16)
        d.text((x, 12), caption, size=13)
    return d


def views() -> Drawing:
    """Slopes of a shaft in side view and top view."""
    d = Drawing(640, 300, "Slopes of a shaft in side view and top view")
    for x, title, second, sign, symbol in (
        (40.0, "side view, from the right", "*y", 1.0, "*V"),
        (360.0, "top view, from above", "*z", -1.0, "*H"),
    ):
        origin = (x, 130.0 if sign > 0 else 215.0)
        d.text((x + 115, 275), title)
        d.arrow(origin, (x + 235, origin[1]))
        d.text((x + 228, origin[1] - 18 if sign > 0 else origin[1] + 8), "*x")
        tip = (x, origin[1] + sign * 110)
        d.arrow(origin, tip)
        d.text((x - 14, tip[1] - 4), second)
        d.text((x + 8, tip[1] - 4), "up" if sign > 0 else "right", size=12, anchor="start")
        d.arrow(origin, polar(origin, 200, sign * 24), colour=BLUE, width=3)
        d.arrow(*arc(origin, 120, 0, sign * 24), colour=RED)
        place = polar(origin, 140, sign * 12)
        d.text((place[0], place[1] - 5), symbol, colour=RED, size=16)
    d.text((320, 40), "x from the drive towards the output, y up, z to the right", size=13)
    d.text((320, 20), "(looking from the drive); the shaft points along (1, tan V, tan H)", size=13)
    return d


def projected() -> Drawing:
    """The four bends of a drawing of two joints, and the planes that they make."""
    d = Drawing(640, 300, "Projected bends of two joints and their bend planes")
    for x, title, bends, sign in (
        (20.0, "side view", (15.0, -11.5), 1.0),
        (20.0, "top view", (7.0, 12.0), -1.0),
    ):
        y = 225.0 if sign > 0 else 95.0
        first, second = (x + 95, y), (x + 235, y)
        # Twice as steep as it is, to be seen.
        start, end = (
            polar(first, 85, 180 - sign * 2 * bends[0]),
            polar(second, 85, sign * 2 * bends[1]),
        )
        for p, q in ((start, first), (first, second), (second, end)):
            d.line(p, q, width=5, colour="#c9c9c9")
        for centre, along, bend in (
            (first, -sign * 2 * bends[0], bends[0]),
            (second, 0.0, bends[1]),
        ):
            d.line(centre, polar(centre, 62, along), colour=GREY, dash="4 4", width=1.2)
            stop = 0.0 if centre == first else sign * 2 * bend
            d.arrow(*arc(centre, 52, along, stop), colour=RED)
            d.dot(centre, 6)
            place = polar(centre, 30, 90)
            d.text((place[0], place[1] - 10), f"{bend:+g}°".replace("-", "−"), colour=RED, size=13)
        d.text((x + 165, y + 46), title)
    centre = (490.0, 155.0)
    d.arrow((centre[0] - 110, centre[1]), (centre[0] + 125, centre[1]), colour=GREY, width=1.2)
    d.arrow((centre[0], centre[1] - 105), (centre[0], centre[1] + 115), colour=GREY, width=1.2)
    d.text((centre[0] + 122, centre[1] - 18), "H", colour=GREY)
    d.text((centre[0] + 14, centre[1] + 106), "V", colour=GREY)
    tips = []
    for bends, label in (((15.0, 7.0), "1"), ((-11.5, 12.0), "2")):
        up, right = (math.tan(math.radians(b)) for b in bends)
        tip = (centre[0] + 340 * right, centre[1] + 340 * up)
        d.arrow(centre, tip, colour=BLUE, width=2.4)
        d.text((tip[0] + 12, tip[1] - 2), f"*β_{label}", colour=BLUE, size=16)
        tips.append(math.degrees(math.atan2(up, right)))
    d.arrow(*arc(centre, 46, tips[0], tips[1]), colour=RED)
    d.text((centre[0] + 62, centre[1] + 12), "*τ", colour=RED, size=16)
    d.text((490, 284), "looking from the drive towards the output", size=12)
    d.text(
        (320, 22), "Side and top view are drawn twice as steep. Up and right are positive.", size=13
    )
    return d


def ball() -> Drawing:
    """A ball in its seat: angles and pressure."""
    d = Drawing(420, 330, "A ball in its seat: angles, approach and pressure")
    centre, radius = (200.0, 205.0), 95.0
    seat = arc(centre, radius, -90 - 65, -90 + 65)
    outer = [(315.0, seat[-1][1]), (315.0, 60.0), (85.0, 60.0), (85.0, seat[0][1])]
    d.area(*seat, *outer, colour="#dedede")
    d.line(*arc(centre, radius, 0, 360), width=2)
    for theta in range(-60, 61, 12):
        root = polar(centre, radius, -90 + theta)
        tip = polar(centre, radius - 52 * math.cos(math.radians(theta)), -90 + theta)
        d.line(root, tip, colour=BLUE, width=1.3)
    d.line(
        *(
            polar(centre, radius - 52 * math.cos(math.radians(t)), -90 + t)
            for t in np.linspace(-65, 65, 41)
        ),
        colour=BLUE,
        width=2,
    )
    d.arrow((centre[0], 322.0), (centre[0], 222.0), colour=INK, width=3)
    d.text((centre[0] + 18, 305), "*D", size=16)
    d.line(centre, polar(centre, radius, -90), colour=GREY, dash="4 4", width=1.2)
    d.line(centre, polar(centre, 150, -25), colour=GREY, dash="4 4", width=1.2)
    d.line(centre, polar(centre, radius, -54), colour=GREEN, width=1.4)
    d.arrow(*arc(centre, 34, -90, -54), colour=GREEN)
    d.text((233, 171), "*θ", colour=GREEN, size=16)
    d.arrow(*arc(centre, 128, -90, -25), colour=RED)
    d.text((302, 100), "*θ_0", colour=RED, size=16)
    d.text((96, 168), "*N", colour=BLUE, size=16)
    d.line(centre, polar(centre, radius, 160), colour=INK, width=1.2)
    d.text((150, 234), "*r", size=16)
    d.dot(centre, 3.5)
    d.text((210, 36), "pressure N = N₀ cos θ from the line of the load", size=13)
    d.text((210, 16), "to the edge of the seat at its half-angle θ₀", size=13)
    return d


DRAWINGS = (
    driveline,
    joint,
    along_the_shaft,
    tilts,
    sphere,
    signs,
    deviations,
    views,
    projected,
    ball,
)

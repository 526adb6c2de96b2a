"""Draw the machines of the how-to pages from their scenes."""

from __future__ import annotations

import math
import pathlib
import tomllib
from itertools import pairwise
from typing import Any

import numpy as np
from draw import BLUE, GREEN, GREY, INK, RED, Drawing, Point, arc, polar

MACHINES = pathlib.Path(__file__).parents[2] / "python" / "cardan" / "app" / "scene" / "machines"
TRUE = "lengths and bends are true"
NOTE = f"{TRUE}; triangles: bearings"
SHAFT, BLOCK = "#c9c9c9", "#e6e6e6"


class View:
    """A plane of a machine in a drawing: millimetres to pixels, one axis perhaps stretched."""

    def __init__(self, d: Drawing, origin: Point, scale: float, stretch: float = 1.0) -> None:
        """Put the origin of the machine at a point of the drawing."""
        self.d, self.origin, self.scale = d, origin, (scale, scale * stretch)

    def __call__(self, place: Any) -> Point:  # noqa: ANN401
        """Return where a place in mm is drawn."""
        (x, y), (across, up) = self.origin, self.scale
        return x + across * float(place[0]), y + up * float(place[1])

    def shafts(self, places: Any, *, colour: str = SHAFT, dash: str = "") -> None:  # noqa: ANN401
        """Draw shafts and joints along the points of a driveline."""
        drawn = [self(place) for place in places]
        self.d.line(*drawn, colour=colour, width=1.4 if dash else 6, dash=dash)
        if not dash:
            for point in drawn[1:-1]:
                self.d.dot(point, 6)

    def bearings(self, scene: dict[str, Any], places: Any) -> None:  # noqa: ANN401
        """Draw the bearings of a scene as triangles under their shafts."""
        for number, bearing in enumerate(scene["bearing"]):
            start, end = (np.asarray(places[bearing["shaft"] + i], dtype=float) for i in (0, 1))
            along = (end - start) / np.linalg.norm(end - start)
            x, y = self(start + bearing["position_mm"] * along)
            self.d.area((x, y - 3), (x - 6, y - 14), (x + 6, y - 14), colour=GREEN)
            self.d.text((x, y - 28), str(number), colour=GREEN, size=12)


def dimension(d: Drawing, start: Point, end: Point, length: float, aside: float) -> None:
    """Draw a length in mm along a line, to its left by some pixels, or to its right if negative."""
    first, last = np.array(start), np.array(end)
    along = (last - first) / np.linalg.norm(last - first)
    out = math.copysign(1.0, aside) * np.array([-along[1], along[0]])
    near, far = (place + abs(aside) * out for place in (first, last))
    for place, foot in ((first, near), (last, far)):
        d.line(_point(place + 10.0 * out), _point(foot + 5.0 * out), colour=GREY, width=1)
    middle, size = (near + far) / 2.0, 12.0
    d.text(_point(middle - (0.0, 0.37 * size)), f"{length:.4g} mm", size=size)
    left, low, right, high = d.labels[-1][1]
    # The line leaves out its text with some room around it.
    room = np.array([(right - left) / 2.0 + 5.0, (high - low) / 2.0 + 5.0])
    reach = float(np.min(room / np.maximum(np.abs(along), 1e-9)))
    for tip, way in ((near, 1.0), (far, -1.0)):
        d.arrow(_point(middle - way * reach * along), _point(tip), width=0.9)


def _point(place: Any) -> Point:  # noqa: ANN401
    return float(place[0]), float(place[1])


def bends(points: Any) -> list[str]:  # noqa: ANN401
    """Return the bend of every joint of points in space, in degrees."""
    steps = np.diff(np.asarray(points, dtype=float), axis=0)
    steps /= np.linalg.norm(steps, axis=-1, keepdims=True)
    return [f"{math.degrees(math.acos(a @ b)):.3g}°" for a, b in pairwise(steps)]


def scene_of(name: str) -> dict[str, Any]:
    """Return the scene of a machine as the tables of its file."""
    return tomllib.loads((MACHINES / f"{name}.toml").read_text("utf-8"))


def box(d: Drawing, left: float, bottom: float, right: float, top: float) -> None:
    """Draw a housing."""
    d.area((left, bottom), (right, bottom), (right, top), (left, top), colour=BLOCK)


def both_ways(d: Drawing, middle: Point, reach: float, colour: str = RED) -> None:
    """Draw an arrow up and an arrow down."""
    for sense in (1, -1):
        d.arrow(middle, (middle[0], middle[1] + sense * reach), colour=colour)


def side_view(
    name: str,
    size: tuple[int, int],
    title: str,
    origin: Point,
    scale: float,
    stretch: float = 1.0,
) -> tuple[dict[str, Any], Any, Drawing, View]:
    """Begin the drawing of a scene from the side: its tables, points x and y, drawing and view."""
    scene = scene_of(name)
    points = np.array(scene["driveline"]["points_mm"], dtype=float)[:, :2]
    d = Drawing(*size, title)
    return scene, points, d, View(d, origin, scale, stretch)


def machine_truck() -> Drawing:
    """Side view of a truck's driveline with its bearings."""
    title = "Driveline of a truck with a centre bearing, from the side"
    scene, points, d, see = side_view("truck-shaft", (745, 235), title, (70.0, 165.0), 0.165, 3.0)
    whole = np.array(scene["driveline"]["points_mm"], dtype=float)
    box(d, 8, 118, 118, 205)
    start, end = see(points[3]), see(points[4])
    box(d, start[0] + 6, end[1] - 40, end[0] + 8, end[1] + 30)
    see.shafts(points)
    see.bearings(scene, points)
    both_ways(d, (end[0] + 24, end[1]), 40)
    d.text((63, 212), "gearbox", size=13)
    d.text((start[0] + 34, end[1] + 36), "axle", size=13)
    d.text((end[0] + 36, end[1] - 5), "±80 mm", colour=RED, size=13, anchor="start")
    names = [f"joint {number}, {bend}" for number, bend in enumerate(bends(whole))]
    for point, name, (right, up), anchor in zip(
        points[1:4],
        names,
        ((-8.0, 16.0), (-4.0, 16.0), (2.0, -26.0)),
        ("start", "end", "end"),
        strict=True,
    ):
        x, y = see(point)
        d.text((x + right, y + up), name, size=13, anchor=anchor)
    for shaft, aside in ((1, -58.0), (2, 32.0)):
        length = float(np.linalg.norm(whole[shaft + 1] - whole[shaft]))
        dimension(d, see(points[shaft]), see(points[shaft + 1]), length, aside)
    x, y = see(points[1] + 1150.0 / 1300.0 * (points[2] - points[1]))
    d.text((x - 60, y - 26), "centre bearing", size=13)
    d.text(
        (330, 14),
        f"side view, heights drawn 3 times as large; {NOTE}",
        size=13,
    )
    return d


def machine_steering() -> Drawing:
    """Side and top view of a steering column."""
    scene = scene_of("steering-column")
    points = np.array(scene["driveline"]["points_mm"], dtype=float)
    d = Drawing(670, 260, "Steering column from the side and from above")
    side = View(d, (40.0, 220.0), 0.27)
    top = View(d, (372.0, 80.0), 0.27)
    for see, axes, title in (
        (side, (0, 2), f"side view; {TRUE}"),
        (top, (0, 1), "top view"),
    ):
        places = points[:, axes]
        see.shafts(places)
        start, end = see(places[0]), see(places[3])
        across = np.array([-(places[1] - places[0])[1], (places[1] - places[0])[0]])
        across = 34.0 * across / np.linalg.norm(across)
        d.line(
            (start[0] - across[0], start[1] - across[1]),
            (start[0] + across[0], start[1] + across[1]),
            width=5,
        )
        d.text((end[0] + 22, end[1] - (20 if see is side else 4)), "rack", size=13)
        d.text((see((450, 0))[0], 10), title, size=13)
    for number, bend in enumerate(bends(points)):
        x, y = side(points[number + 1, [0, 2]])
        d.text((x + 10, y + 6), f"joint {number}, {bend}", size=13, anchor="start")
        x, y = top(points[number + 1, [0, 1]])
        d.text((x - 4, y + 14), f"joint {number}", size=13)
    length = float(np.linalg.norm(points[2] - points[1]))
    dimension(d, side(points[1, [0, 2]]), side(points[2, [0, 2]]), length, -30.0)
    d.text((112, 236), "steering wheel", size=13)
    both_ways(d, (16.0, 205.0), 22)
    d.text((44, 168), "±30 mm", colour=RED, size=13)
    return d


def machine_pto() -> Drawing:
    """Top view of a PTO shaft, straight and in a turn about the hitch pin."""
    scene = scene_of("pto-shaft")
    straight = np.array(scene["driveline"]["points_mm"], dtype=float)[:, [0, 2]]
    whole = np.array(scene["driveline"]["points_mm"], dtype=float)
    for point in (2, 3):
        for axis, column in ((0, "x"), (2, "z")):
            whole[point, axis] = scene["states"]["points_mm"][str(point)][column][-1]
    turned = whole[:, [0, 2]]
    d = Drawing(640, 310, "PTO shaft from above, straight and in a turn")
    see = View(d, (150.0, 60.0), 0.3)
    pin = see((400, 0))
    box(d, 20, 25, see((-150, 0))[0], 95)
    see.shafts(straight, colour=GREY, dash="5 4")
    d.line(pin, see(turned[3]), colour=GREY, width=1.2, dash="2 3")
    see.shafts(turned)
    d.line((105.0, 36.0), (pin[0], 36.0), pin, colour=BLUE, width=2)
    d.dot(pin, 5, BLUE)
    d.arrow(*arc(pin, 150, 0, 35), colour=RED)
    d.text((pin[0] + 172, pin[1] + 44), "35°", colour=RED, size=13)
    end = see(turned[3])
    along = np.array([math.cos(math.radians(35)), math.sin(math.radians(35))])
    corners = [(0, -42), (90, -42), (90, 42), (0, 42)]
    d.area(
        *(tuple(end + a * along + b * np.array([-along[1], along[0]])) for a, b in corners),
        colour=BLOCK,
    )
    d.text((end[0] + 38, end[1] + 20), "baler", size=13)
    d.text((62, 56), "tractor", size=13)
    d.text((pin[0] + 34, 34), "hitch pin", colour=BLUE, size=13)
    d.text((200, 20), "drawbar", colour=BLUE, size=13)
    first, second = bends(whole)
    x, y = see(turned[1])
    d.text((x - 16, y + 44), f"joint 0, {first}", size=13, anchor="end")
    x, y = see(turned[2])
    d.text((x + 14, y - 16), f"joint 1, {second}", size=13, anchor="start")
    length = float(np.linalg.norm(whole[2] - whole[1]))
    dimension(d, see(turned[1]), see(turned[2]), length, 30.0)
    d.text((632, 12), f"top view; dashed: straight; {TRUE}", size=13, anchor="end")
    return d


def machine_mill() -> Drawing:
    """Side view of a mill spindle with its bearings."""
    title = "Spindle of a rolling mill, from the side"
    scene, points, d, see = side_view("mill-spindle", (700, 225), title, (140.0, 150.0), 0.075, 2.0)
    start, end = see(points[0]), see(points[3])
    box(d, start[0] - 15, 105, start[0] + 90, 192)
    box(d, see((4700, 0))[0] - 8, 60, see((4950, 0))[0], 190)
    box(d, see((6600, 0))[0] - 10, 60, end[0] + 10, 190)
    see.shafts(points)
    left, right = see((5100, -260)), see((6400, -260))
    d.area(
        (left[0], left[1] - 16),
        (right[0], left[1] - 16),
        (right[0], left[1] + 16),
        (left[0], left[1] + 16),
        colour=SHAFT,
    )
    see.bearings(scene, points)
    d.text((start[0] + 38, 198), "pinion stand", size=13)
    d.text((0.5 * (left[0] + right[0]), left[1] - 32), "roll", size=13)
    for number, (point, bend) in enumerate(zip(points[1:3], bends(points), strict=True)):
        x, y = see(point)
        d.text((x + (30 if number == 0 else -40), y + 14), f"joint {number}, {bend}", size=13)
    length = float(np.linalg.norm(points[2] - points[1]))
    dimension(d, see(points[1]), see(points[2]), length, -40.0)
    middle = (0.5 * (left[0] + right[0]), left[1] + 50)
    both_ways(d, middle, 26)
    d.text((middle[0], middle[1] + 34), "gap, wear", colour=RED, size=13)
    d.text((350, 12), f"side view, heights drawn twice as large; {NOTE}", size=13)
    return d


def machine_rig() -> Drawing:
    """Side view of a test rig with a Z shaft."""
    scene = scene_of("test-rig")
    lengths, bend = (
        scene["driveline"]["lengths_mm"],
        math.radians(scene["driveline"]["bends_deg"][0]),
    )
    slopes = np.array([0.0, -bend, 0.0])
    steps = np.array(lengths)[:, None] * np.stack([np.cos(slopes), np.sin(slopes)], axis=-1)
    points = np.vstack([np.zeros(2), np.cumsum(steps, axis=0)])
    d = Drawing(640, 190, "Shaft of a test rig, from the side")
    see = View(d, (100.0, 130.0), 0.34)
    end = see(points[3])
    box(d, 15, 90, 185, 170)
    box(d, end[0] - 85, end[1] - 45, end[0] + 85, end[1] + 45)
    see.shafts(points)
    see.bearings(scene, points)
    first, second = see(points[1]), see(points[2])
    slope = math.degrees(bend)
    d.line(first, polar(first, 110, 0), colour=GREY, width=1.2, dash="4 4")
    d.line(second, polar(second, 110, 180), colour=GREY, width=1.2, dash="4 4")
    d.arrow(*arc(first, 92, 0, -slope), colour=RED)
    d.arrow(*arc(second, 92, 180, 180 - slope), colour=RED)
    d.text((first[0] + 108, first[1] + 8), "9°", colour=RED, size=13)
    d.text((second[0] - 108, second[1] - 20), "9°", colour=RED, size=13)
    dimension(d, first, second, lengths[1], -52.0)
    d.text((first[0] + 8, first[1] + 15), "joint 0", size=13)
    d.text((second[0] - 6, second[1] + 15), "joint 1", size=13)
    d.text((80, 152), "motor", size=13)
    d.text((end[0] + 20, end[1] + 26), "dynamometer", size=13)
    d.text((320, 12), "side view; triangles: bearings", size=13)
    return d


def machine_ship() -> Drawing:
    """Side view of a boat's shaft with its bearings."""
    title = "Shaft of a boat, from the side"
    scene, points, d, see = side_view("ship-shaft", (700, 215), title, (130.0, 165.0), 0.19)
    start, end = see(points[0]), see(points[3])
    box(d, 15, 135, start[0] + 2, 205)
    for x in (35.0, 105.0):
        d.area((x - 12, 112), (x + 12, 112), (x + 7, 135), (x - 7, 135), colour=BLUE)
    slope = (points[3] - points[2]) / np.linalg.norm(points[3] - points[2])
    tail = see(points[3] + 330.0 * slope)
    d.line(end, tail, colour=SHAFT, width=6)
    see.shafts(points)
    for sense in (1, -1):
        d.area(
            tail,
            (tail[0] + 7, tail[1] + sense * 34),
            (tail[0] - 7, tail[1] + sense * 34),
            colour=INK,
        )
    d.line((10.0, 70.0), (430.0, 58.0), (620.0, 78.0), colour=GREY, width=1.4)
    see.bearings(scene, points)
    d.text((70, 168), "engine", size=13)
    d.text((70, 92), "soft mounts", colour=BLUE, size=13)
    for number, (point, bend) in enumerate(zip(points[1:3], bends(points), strict=True)):
        x, y = see(point)
        d.text((x + 26, y + 14), f"joint {number}, {bend}", size=13)
    length = float(np.linalg.norm(points[2] - points[1]))
    dimension(d, see(points[1]), see(points[2]), length, -36.0)
    d.text((tail[0] - 4, tail[1] + 42), "propeller", size=13)
    d.text((240, 48), "hull", colour=GREY, size=13)
    d.text((350, 12), "side view, to scale; triangles: bearings", size=13)
    return d


DRAWINGS = (
    machine_truck,
    machine_steering,
    machine_pto,
    machine_mill,
    machine_rig,
    machine_ship,
)

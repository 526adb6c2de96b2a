"""A driveline in space, with its yokes and bends."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, get_args

import numpy as np
from numpy.typing import ArrayLike

from cardan.app.answers.printed import plain_text
from cardan.app.pictures.labels import PlacedLabels
from cardan.app.pictures.space import (
    DEPTH,
    View,
    bearing_places,
    length_text,
    pins,
    shaft_lengths,
    tube,
    wedge,
    yoke,
)
from cardan.app.pictures.style import THIN, arrow, check_single, drawing, legend_above
from cardan.app.scene.language.units import LengthUnit
from cardan.arrays import FloatArray, as_float64, one_number
from cardan.arrays.errors import ArgumentValueError
from cardan.driveline import Driveline

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_HEIGHT = 52.0  # mm
_ASIDE, _ABOVE, _BELOW = 26.0, 36.0, 38.0  # points around the drawing, for its labels
_ARM = 2.8  # points that the arm of a yoke is wide at most
_SIDES = ("driving yoke", "driven yoke")
# In grey one is dark and the other light.
_YOKES: tuple[Mapping[str, Any], ...] = (
    {"color": "#0072B2", "solid_capstyle": "butt"},
    {"color": "#F7C59F", "solid_capstyle": "butt"},
)
# Over half the span of a yoke: radius and width of a bearing, height and half width of its foot.
_RING, _WIDTH, _FOOT, _FOOT_ASIDE = 0.62, 0.5, 1.15, 0.42
_ALONG = 80  # points along a line that no label may cover
_BEARING = "#009E73"
_BEND: Mapping[str, Any] = {"facecolor": "#D55E00", "alpha": 0.22, "linewidth": 0.0}
_CONTINUED: Mapping[str, Any] = {"color": "0.35", "linestyle": (0, (4, 2)), "linewidth": 0.6}


def yoke_pins(line: Driveline, angle: float = 0.0) -> FloatArray:
    """Return the direction of every pin at a drive angle.

    Args:
        line: one driveline.
        angle: drive angle in rad.

    Returns:
        unit vectors ``(n, 2, 3)``: for each joint the pin of its driving and of its driven yoke.

    Raises:
        ValueError: a batch.
    """
    check_single(line)
    found: FloatArray = pins(line, np.array([one_number("angle", angle)]))[0]
    return found


def plot_driveline(
    line: Driveline,
    angle: float = 0.0,
    *,
    points: ArrayLike | None = None,
    length_unit: LengthUnit | None = None,
    ax: Axes | None = None,
) -> Axes:
    """Draw a driveline in space with its yokes at a drive angle: its side view, with depth aslant.

    The axis that the shafts follow most points to the right, y up; in this plane everything is to
    scale. What comes out of it leads to the right and downwards; small arrows show x, y and z.
    At each joint the dashed line continues the input shaft, and the area between it and the
    output shaft is the bend in its plane. Labels give the bend of each joint, and the phase of each
    shaft between two joints with its length if a unit is given; those that find no room are left
    out, small bends first. Bearings are
    rings around their shafts, on feet; where room is short, their numbers alone name them.

    Args:
        line: one driveline.
        angle: drive angle in rad.
        points: its ends and joint centres, ``(n + 2, 3)``; by default its shafts have its lengths,
            or are all as long if it has none.
        length_unit: in what to label the line's lengths, which are in m; by default they are not.

    Raises:
        ValueError: a batch, points that do not lie along the shafts, an unknown unit.
    """
    check_single(line)
    angle = one_number("angle", angle)
    if length_unit not in (None, *get_args(LengthUnit)):
        raise ArgumentValueError("length_unit", f"is {length_unit!r}; it must be 'mm' or 'm'")
    places = _places(line, points)
    with drawing(ax, height_mm=_HEIGHT) as axes:
        if ax is None:
            axes.set_position((0.0, 0.0, 1.0, 1.0))
        _Sketch.begin(axes, line, places).draw(angle, length_unit)
    return axes


@dataclass
class _Sketch:
    """A drawing on its way."""

    axes: Axes  # where, of ``box`` points
    line: Driveline  # what
    places: FloatArray  # its ends and joint centres, ``(n + 2, 3)``
    bearings: FloatArray  # where its bearings are, ``(b, 3)``
    view: View  # from where it is seen
    size: float  # half the span of its yokes
    scale: float  # points per unit of length
    corner: FloatArray  # what lies in the lower left corner, ``(2,)``
    box: tuple[float, float]  # width and height of the axes in points
    drawn: list[FloatArray]  # what no label may cover

    @classmethod
    def begin(cls, axes: Axes, line: Driveline, places: FloatArray) -> _Sketch:
        """Choose the view and the scale, and give the axes one scale both ways."""
        view = View.of(line.directions)
        size = _yoke_size(np.linalg.norm(np.diff(places, axis=0), axis=-1))
        figure = axes.get_figure()
        assert figure is not None
        extent = axes.get_window_extent().transformed(figure.dpi_scale_trans.inverted())
        box = 72.0 * extent.width, 72.0 * extent.height
        flat = view.flat(places)
        low, high = flat.min(axis=0) - size, flat.max(axis=0) + size
        room = np.array(box) - (2.0 * _ASIDE, _ABOVE + _BELOW)
        scale = float(np.min(np.maximum(room, 10.0) / (high - low)))
        # Up as far as the labels above need, the rest below.
        middle = np.array([box[0] / 2.0, _BELOW + max(room[1], 10.0) / 2.0])
        corner = (low + high) / 2.0 - middle / scale
        ends = corner + np.array(box) / scale
        axes.set(xlim=(corner[0], ends[0]), ylim=(corner[1], ends[1]))
        axes.set_aspect("equal", adjustable="datalim")
        axes.set_axis_off()
        bearings = bearing_places(line, places)
        return cls(axes, line, places, bearings, view, size, scale, corner, box, [])

    def draw(self, angle: float, length_unit: LengthUnit | None) -> None:
        """Draw it at a drive angle, with its lengths in a unit if there is one."""
        self._shafts()
        self._bends()
        self._joints(angle)
        self._names(length_unit)

    def _points(self, points: FloatArray) -> FloatArray:
        """Return the place of points in space, in points from the lower left corner."""
        return self.scale * (self.view.flat(points) - self.corner)

    def _take(self, points: FloatArray) -> None:
        self.drawn.append(self._points(points))

    def _shafts(self) -> None:
        """Draw shafts and bearings, far pieces first: a bearing cuts its shaft in two."""
        from matplotlib.patches import Polygon

        thin: dict[str, Any] = {
            "edgecolor": "0.25",
            "linewidth": min(0.6, 0.1 * self.size * self.scale),
        }
        ends = np.stack([self.places[:-1], self.places[1:]], axis=1)
        # A shaft ends where its yokes begin.
        base = DEPTH * self.size * self.line.directions
        ends[1:, 0] += base[1:]
        ends[:-1, 1] -= base[:-1]
        areas: list[tuple[float, FloatArray, str]] = []
        for shaft, (start, end) in enumerate(ends):
            half = 0.5 * _WIDTH * self.size * self.line.directions[shaft]
            centres = [
                place
                for (own, _), place in zip(self.line.bearings, self.bearings, strict=True)
                if own == shaft
            ]
            centres.sort(key=lambda place: float(place @ self.line.directions[shaft]))
            cuts = [start, *(edge for place in centres for edge in (place - half, place + half))]
            for first, last in zip(cuts[::2], [*cuts[1::2], end], strict=True):
                outline, rim = tube(first, last, self.size, self.view)
                depth = self.view.depth(np.stack([first, last]))
                areas += [(depth, outline, "0.82"), (depth, rim, "0.93")]
                self._take(_edge(outline))
            for place in centres:
                outline, rim = tube(place - half, place + half, self.size, self.view, _RING)
                depth = self.view.depth(place)
                foot = place - _FOOT * self.size * self.view.plane[1]
                aside = _FOOT_ASIDE * self.size * self.view.plane[0]
                stand = np.stack([place, foot - aside, foot + aside])
                areas += [(depth, stand, "white"), (depth, outline, _BEARING), (depth, rim, "0.93")]
                self._take(np.linspace(2.0 * place - foot, foot, 20))
                self._take(_edge(outline))
            self._take(np.linspace(start, end, _ALONG))
        # Sorting is stable: of one piece, what is added later lies on top.
        for _, area, colour in sorted(areas, key=lambda piece: piece[0]):
            shape = Polygon(self.view.flat(area), facecolor=colour, zorder=2.0, **thin)
            self.axes.add_artist(shape)

    def _bends(self) -> None:
        from matplotlib.patches import Polygon

        lengths = np.linalg.norm(np.diff(self.places, axis=0), axis=-1)
        for joint, centre in enumerate(self.places[1:-1]):
            before, after = self.line.directions[joint : joint + 2]
            reach = min(5.0 * self.size, 0.6 * float(lengths[joint + 1]))
            area = wedge(centre, before, after, reach)
            self.axes.add_artist(Polygon(self.view.flat(area), zorder=1.5, **_BEND))
            self.axes.plot(*self.view.flat(area[:2]).T, zorder=2.5, **_CONTINUED)
            self.axes.plot(*self.view.flat(area[1:]).T, zorder=2.5, **THIN)
            self._take(centre + np.linspace(0.0, 1.0, 30)[:, np.newaxis] * (area[1] - centre))

    def _joints(self, angle: float) -> None:
        width = min(_ARM, 0.27 * self.size * self.scale)
        for side, name in enumerate(_SIDES):
            # For the legend, which needs no yoke of a driveline that is too small to be seen.
            self.axes.plot([], [], linewidth=_ARM - side, label=name, **_YOKES[side], **_rim(_ARM))
        pieces: list[tuple[FloatArray, dict[str, Any]]] = []
        for joint, both in enumerate(yoke_pins(self.line, angle)):
            centre = self.places[joint + 1]
            towards = (-self.line.directions[joint], self.line.directions[joint + 1])
            for side, pin in enumerate(both):
                arms = yoke(centre, pin, towards[side], self.size)
                style = {"linewidth": width, "label": f"_{_SIDES[side]} {joint}", **_rim(width)}
                # Cut at its base, so that its arms lie on either side of the cross.
                middle = len(arms) // 2
                pieces += [
                    (half, {**style, **_YOKES[side]})
                    for half in (arms[: middle + 1], arms[middle:])
                ]
                cross = {"linewidth": 0.9 * width, "color": "0.1", "label": f"_pin {joint}"}
                eye = {"marker": "o", "markersize": 1.9 * width, "markeredgewidth": 0.5 * width}
                eye |= {"color": "0.1", "markerfacecolor": _YOKES[side]["color"]}
                for tip in centre + self.size * np.stack([pin, -pin]):
                    pieces.append((np.stack([centre, tip]), cross))
                    if width > 1.0:
                        pieces.append((tip[np.newaxis], eye))
                self._take(arms)
        # Far pieces first.
        pieces.sort(key=lambda piece: self.view.depth(piece[0]))
        for rank, (points, style) in enumerate(pieces):
            self.axes.plot(*self.view.flat(points).T, zorder=3.0 + rank / len(pieces), **style)

    def _names(self, length_unit: LengthUnit | None) -> None:
        # A grid of two points is fine enough for labels, and much less to search.
        drawn = 2.0 * np.unique(np.round(np.concatenate(self.drawn) / 2.0), axis=0)
        labels = PlacedLabels(self.axes, self.box, drawn)
        away = self.size * self.scale + 3.0
        self._ends(labels)
        self._directions(labels)
        legend_above(self.axes, loc="upper right", bbox_to_anchor=(0.98, 0.98), ncols=2)
        labels.boxes.append((self.box[0] - 135.0, self.box[1] - 15.0, *self.box))
        bends = np.degrees(self.line.bends)
        named = [
            labels.beside(
                self._points(self.places[joint + 1]),
                f"joint {joint}\n{plain_text(float(bends[joint]), 'deg')}°",
                away,
                above=True,
            )
            for joint in sorted(range(self.line.n_joints), key=lambda j: (-bends[j], j))
        ]
        for bearing, place in enumerate(self.bearings):
            at = self._points(place)
            for text in (f"bearing {bearing}", f"{bearing}"):
                if labels.beside(at, text, away, above=False):
                    break
        lengths = self.line._geometry.lengths
        for shaft, phase in enumerate(np.degrees(self.line.phases) if all(named) else (), 1):
            at = self._points((self.places[shaft] + self.places[shaft + 1]) / 2.0)
            turned = 180.0 - (180.0 - float(phase)) % 360.0
            angle = plain_text(turned, "phase").replace("-", "\N{MINUS SIGN}")
            text = f"shaft {shaft}\nphase {angle}°"
            lines = [text]
            if length_unit and lengths.size:
                lines.append(length_text(float(lengths[shaft]), length_unit))
            while lines and not labels.beside(at, "\n".join(lines), 0.34 * away + 1.0, above=False):
                lines.pop()

    def _ends(self, labels: PlacedLabels) -> None:
        """Name the ends of the driveline, with arrows along the power flow."""
        for end, along, name in (
            (0, self.line.directions[0], "drive"),
            (-1, self.line.directions[-1], "output"),
        ):
            flow = self.view.flat(along)
            flow /= max(float(np.hypot(*flow)), 1e-9)
            at = self._points(self.places[end])
            near, far = (
                (at - 3.0 * flow, at - 15.0 * flow)
                if end == 0
                else (at + 3.0 * flow, at + 15.0 * flow)
            )
            self._arrow(*((far, near) if end == 0 else (near, far)), "0.1", 1.0)
            # On the side to which the arrow leads away, unless the driveline comes back there.
            aside = -7.0 if far[1] < near[1] - 6.0 else 7.0
            away = np.sign(far - near) * (1.0, 0.0)
            places = [
                far + out * away + (0.0, way * step * aside)
                for step in (1.0, 1.6, 2.2, 2.8)
                for out in (0.0, 6.0, 12.0)
                for way in (1.0, -1.0)
            ]
            free = (place for place in places if not labels.covers(place[0], place[1], name))
            x, y = next(free, places[0])
            labels.at(float(x), float(y), name, "center")

    def _directions(self, labels: PlacedLabels) -> None:
        """Show the axes, and from where the senses of turn are meant."""
        start = np.array([13.0, 11.0])
        for name, axis in zip("xyz", self.view.axes[:2].T, strict=True):
            self._arrow(start, start + 15.0 * axis, "0.35", 0.7)
            x, y = start + 15.0 * axis + 4.5 * axis / max(float(np.hypot(*axis)), 1e-9)
            labels.at(float(x), float(y), name, "center")
        self._arrow(np.array([46.0, 6.0]), np.array([62.0, 6.0]), "0.1", 1.0)
        labels.at(65.0, 6.0, "looking from the drive towards the output", "left")

    def _arrow(self, tail: FloatArray, head: FloatArray, colour: str, width: float) -> None:
        ends, where = (tuple(tail / self.box), tuple(head / self.box)), "axes fraction"
        options: dict[str, Any] = {"xycoords": where, "textcoords": where, "annotation_clip": False}
        shape = "-|>,head_width=0.18,head_length=0.36"
        arrow(self.axes, *ends, shape, colour, width, **options)
        self.drawn.append(tail + np.linspace(0.0, 1.0, 9)[:, np.newaxis] * (head - tail))


def _edge(outline: FloatArray) -> FloatArray:
    """Points along the edge of an area, ``(points, 3)``."""
    share = np.linspace(0.0, 1.0, _ALONG)[:, np.newaxis, np.newaxis]
    onward = np.roll(outline, -1, axis=0) - outline
    return np.asarray((outline + share * onward).reshape(-1, 3), np.float64)


def _rim(width: float) -> dict[str, Any]:
    """The dark rim of a line, so that it stands out from what it crosses."""
    from matplotlib.patheffects import Normal, Stroke

    stroke = Stroke(linewidth=width + min(1.0, 0.6 * width), foreground="0.1")
    return {"path_effects": [stroke, Normal()]}


def _yoke_size(lengths: FloatArray) -> float:
    """Half the span of a yoke that leaves some of every shaft to be seen."""
    between = float(np.min(lengths[1:-1], initial=np.inf))
    ends = float(min(lengths[0], lengths[-1]))
    return min(0.07 * float(np.sum(lengths)), 0.33 * between, 0.5 * ends)


def _places(line: Driveline, points: ArrayLike | None) -> FloatArray:
    if points is None:
        steps = shaft_lengths(line)[:, np.newaxis] * line.directions
        return np.concatenate([np.zeros((1, 3)), np.cumsum(steps, axis=0)])
    places = as_float64("points", points)
    if places.shape != (line.n_joints + 2, 3):
        raise ArgumentValueError(
            "points", f"has shape {places.shape}; it must be ({line.n_joints + 2}, 3)"
        )
    steps = np.diff(places, axis=0)
    off = np.linalg.norm(np.cross(steps, line.directions), axis=-1)
    wrong = ~(off <= 1e-6 * np.linalg.norm(steps, axis=-1))
    wrong |= ~(np.sum(steps * line.directions, axis=-1) > 0.0)
    if wrong.any():
        shaft = int(np.argmax(wrong))
        raise ArgumentValueError(
            "points", f"and [{shaft + 1}] do not lie along shaft {shaft}", (shaft,)
        )
    return places

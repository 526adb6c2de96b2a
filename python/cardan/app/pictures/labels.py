"""Labels of a drawing, each in the nearest place where it covers nothing."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np

from cardan.app.pictures.style import text_width
from cardan.arrays import FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes

Bounds = tuple[float, float, float, float]  # left, bottom, right, top

_ROOM = 2.0  # points around a label
_NEAR, _FAR = 8, 30  # points from which, and to which, a line connects a label to its point
_ASIDE = (0.0, 6.0, -6.0, 14.0, -14.0, 28.0, -28.0)  # points to the right
_LINE = 1.25  # height of a line over the size of its font


@dataclass
class PlacedLabels:
    """Occupied areas of a drawing, in points from its lower left corner."""

    axes: Axes  # where to write
    size: tuple[float, float]  # width and height of the axes
    drawn: FloatArray  # what no label may cover, ``(n, 2)``
    boxes: list[Bounds] = field(default_factory=list)  # the labels that are placed

    def beside(self, anchor: FloatArray, text: str, away: float, *, above: bool) -> bool:
        """Write above or below a point, and return whether there is room for it.

        A label that must go far gets a line to its point. A distance of at least ``away`` stays
        free; the side ``above`` is tried first.
        """
        width, height = self._measure(text)
        places = sorted(
            (step + abs(aside) + 12.0 * ((side > 0.0) != above), aside, side, step)
            for step in range(0, _FAR, 2)
            for side in (1.0, -1.0)
            for aside in _ASIDE
        )
        for _, aside, side, step in places:
            x, begin = float(anchor[0]) + aside, float(anchor[1]) + side * away
            edge = begin + side * step
            y = edge + side * height / 2.0
            line = np.asarray(np.linspace((float(anchor[0]), begin), (x, edge), 12), np.float64)
            if self._is_free(self._box(x, y, width, height)) and not self._is_written(line):
                self._write(x, y, text, "center")
                self.boxes.append(self._box(x, y, width, height))
                if step > _NEAR or abs(aside) > _NEAR + 6.0:
                    self._line(line)
                return True
        return False

    def covers(self, x: float, y: float, text: str) -> bool:
        """Whether a text in the middle of a place would cover something."""
        return not self._is_free(self._box(x, y, *self._measure(text)))

    def at(self, x: float, y: float, text: str, align: str) -> None:
        """Write in a place that is kept for the text, centred on its height."""
        width, height = self._measure(text)
        middle = x + {"left": 0.5, "center": 0.0, "right": -0.5}[align] * width
        self._write(x, y, text, align)
        self.boxes.append(self._box(middle, y, width, height))

    def _measure(self, text: str) -> tuple[float, float]:
        from matplotlib import rcParams

        size, lines = float(rcParams["font.size"]), text.split("\n")
        return max(text_width(line, size) for line in lines), _LINE * size * len(lines)

    @staticmethod
    def _box(x: float, y: float, width: float, height: float) -> Bounds:
        return x - width / 2.0, y - height / 2.0, x + width / 2.0, y + height / 2.0

    def _is_free(self, box: Bounds) -> bool:
        left, low, right, high = box
        left, low, right, high = left - _ROOM, low - _ROOM, right + _ROOM, high + _ROOM
        if left < 0.0 or low < 0.0 or right > self.size[0] or high > self.size[1]:
            return False
        if any(left < b[2] and b[0] < right and low < b[3] and b[1] < high for b in self.boxes):
            return False
        x, y = self.drawn.T
        return not bool(np.any((left < x) & (x < right) & (low < y) & (y < high)))

    def _write(self, x: float, y: float, text: str, align: str) -> None:
        self.axes.annotate(
            text,
            (x / self.size[0], y / self.size[1]),
            xycoords="axes fraction",
            ha=align,
            va="center",
            linespacing=1.05,
            annotation_clip=False,
        )

    def _is_written(self, line: FloatArray) -> bool:
        """Whether a line runs through a label."""
        x, y = line.T
        return any(
            bool(np.any((b[0] < x) & (x < b[2]) & (b[1] < y) & (y < b[3]))) for b in self.boxes
        )

    def _line(self, line: FloatArray) -> None:
        ends = line[[0, -1]] / self.size
        across = self.axes.transAxes
        self.axes.plot(*ends.T, transform=across, color="0.5", linewidth=0.4, zorder=1.0)
        self.drawn = np.concatenate([self.drawn, line])

"""The comparison as a picture: error against time, every method a point with its name.

``python benches/picture.py`` draws that of ``compare.md`` again, without measuring.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

import report

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from judge import ComparisonRow

JOB = "motion"
MM = 1.0 / 25.4
WIDTH, PANEL = 160.0, 92.0
BLUE = "#0072B2"
RULES = {
    "font.size": 8.0,
    "axes.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "svg.hashsalt": "cardan",
}

Bounds = tuple[float, float, float, float]  # left, bottom, right, top


class Point(NamedTuple):
    """A method in the picture: its name, whether it is this package's, error and ns per angle."""

    name: str
    ours: bool
    error: float
    time: float


def draw(rows: Sequence[ComparisonRow], path: Path) -> None:
    """Draw one job twice: in the cache on one thread, from memory on all."""
    own = [row for row in rows if row.job.name == JOB and not row.wrong]
    panels = {
        report.case(*column): [
            Point(row.method.name, row.method.peer == "cardan", row.verdict.relative, row.best)
            for row in own
            if (row.num, row.threads) == column
        ]
        for column in report.columns(own)
    }
    if own:
        _draw(panels, own[0].job.title, path)


def redraw(table: Path, path: Path) -> None:
    """Draw the picture of a comparison that is written."""
    _, _, section = table.read_text(encoding="utf-8").partition(f"\n## {JOB}: ")
    title, *lines = section.partition("\n## ")[0].splitlines()
    cells = [[cell.strip() for cell in line.strip("|").split("|")] for line in lines if line]
    panels: dict[str, list[Point]] = {column: [] for column in cells[0][3:]}
    for label, error, _, *times in cells[2:]:
        ours = label.startswith("cardan, ")
        for column, time in zip(panels, times, strict=True):
            if time:
                own = Point(
                    label.removeprefix("cardan, "), ours, float(error), float(time.split()[0])
                )
                panels[column].append(own)
    _draw(panels, title, path)


def _draw(cases: Mapping[str, Sequence[Point]], title: str, path: Path) -> None:
    import matplotlib as mpl
    from matplotlib.figure import Figure

    names = list(cases)
    panels = list(dict.fromkeys((names[0], names[-1])))
    with mpl.rc_context(RULES):
        height = PANEL * len(panels)
        figure = Figure(figsize=(WIDTH * MM, height * MM))
        axes = figure.subplots(len(panels), 1, squeeze=False)[:, 0]
        figure.subplots_adjust(left=14 / WIDTH, right=1 - 5 / WIDTH, hspace=0.2)
        figure.subplots_adjust(top=1 - 7 / height, bottom=15 / height)
        for ax, case in zip(axes, panels, strict=True):
            panel(ax, cases[case])
            number, _, threads = case.partition(",")
            ax.set_title(f"{number} angles,{threads}", loc="left", fontsize=8.0)
            ax.set_title("■ cardan   ○ others", loc="right", fontsize=8.0)
        axes[-1].set_xlabel(f"largest error of {title},\nrelative to the largest magnitude")
        figure.savefig(path, metadata={"Date": None} if path.suffix == ".svg" else {}, dpi=300)


def panel(ax: Axes, points: Sequence[Point]) -> None:
    """Draw the points of one case; this package's are filled squares."""
    from matplotlib.ticker import FixedLocator, NullLocator

    times = [point.time for point in points]
    ax.set(xscale="log", yscale="log", xlim=(1e-19, 1e-5), ylabel="ns per angle")
    ax.set_ylim(min(times) / 1.4, max(times) * 1.4)
    ax.yaxis.set_major_locator(FixedLocator([m * 10.0**e for e in range(-2, 4) for m in (1, 2, 5)]))
    ax.yaxis.set_minor_locator(NullLocator())
    ax.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
    ax.grid(color="0.9", linewidth=0.5)
    ax.set_axisbelow(True)
    for point in points:
        ax.plot(
            point.error,
            point.time,
            "s" if point.ours else "o",
            markersize=4.6 if point.ours else 4.0,
            markerfacecolor=BLUE if point.ours else "white",
            markeredgecolor=BLUE if point.ours else "0.25",
            markeredgewidth=0.9,
        )
    name(ax, points)


def name(ax: Axes, points: Sequence[Point]) -> None:
    """Write each name beside its point, in the nearest place where it covers nothing."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    assert isinstance(ax.figure, Figure)
    renderer = FigureCanvasAgg(ax.figure).get_renderer()
    point = ax.figure.dpi / 72.0
    frame = ax.get_window_extent(renderer)
    at = {each: ax.transData.transform((each.error, each.time)) for each in points}
    room = 3.0 * point
    dots: dict[Point, Bounds] = {
        each: (x - room, y - room, x + room, y + room) for each, (x, y) in at.items()
    }
    taken = list(dots.values())
    for each in sorted(points, key=lambda each: (not each.ours, each.time)):
        x, y = at[each]
        text = ax.annotate(
            each.name,
            (each.error, each.time),
            xytext=(0, 0),
            textcoords="offset points",
            va="center",
            color=BLUE if each.ours else "0.1",
            fontweight="bold" if each.ours else "normal",
        )
        # Glyphs are spaced a little wider in a file than on the canvas that measures them.
        width, tall = text.get_window_extent(renderer).width * 1.04, 9.5 * point
        own = dots[each]
        best, chosen = np.inf, ((4.5, 0.0), [], np.empty((0, 2)))
        for dx, dy in places(width / point):
            left, low = x + dx * point, y + dy * point - tall / 2
            box = (left, low, left + width, low + tall)
            within = frame.x0 < left and box[2] < ax.figure.bbox.x1
            within = within and frame.y0 < low and box[3] < frame.y1
            if not within or any(overlap(box, other) for other in taken):
                continue
            end = (left - point if dx > 0 else left + width + point, low + tall / 2)
            line = np.linspace((x, y), end, 17) if abs(dy) > 3 else np.empty((0, 2))
            specks = [(*p, *p) for p in line if not overlap((*p, *p), own)]
            hits = sum(any(overlap(p, other) for p in specks) for other in taken)
            if abs(dy) + 60 * hits < best:
                best, chosen = abs(dy) + 60 * hits, ((dx, dy), [box, *specks], line)
        place, covered, line = chosen
        text.set_position(place)
        taken += covered
        if len(line):
            ends = ax.transData.inverted().transform(line[[0, -1]])
            ax.plot(*ends.T, color="0.5", linewidth=0.4, zorder=1.5)


def places(width: float) -> Iterator[tuple[float, float]]:
    """Offsets of a text's left end from its point, in points, nearest first."""
    for dy in range(80):
        away = 4.5 if dy <= 3 else 11.0
        for sign in (1, -1):
            yield away, sign * dy
            yield -width - away, sign * dy


def overlap(a: Bounds, b: Bounds) -> bool:
    return a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]


if __name__ == "__main__":
    folder = Path(__file__).parent
    redraw(folder / "compare.md", folder / "compare.svg")

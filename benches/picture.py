"""The comparison as a picture: error against time, every method a point with its name."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

import report

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from row import Row

JOB = "motion"
MM = 1.0 / 25.4
WIDTH, PANEL = 92.0, 88.0
BLUE = "#0072B2"
RULES = {
    "font.size": 6.5,
    "axes.linewidth": 0.6,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "svg.hashsalt": "cardan",
}

Box = tuple[float, float, float, float]  # left, bottom, right, top


def draw(rows: Sequence[Row], path: Path) -> None:
    """Draw one job twice: in the cache on one thread, from memory on all."""
    import matplotlib as mpl
    from matplotlib.figure import Figure

    own = [row for row in rows if row.job.name == JOB and not row.wrong]
    if not own:
        return
    columns = report.columns(own)
    panels = list(dict.fromkeys((columns[0], columns[-1])))
    with mpl.rc_context(RULES):
        height = PANEL * len(panels)
        figure = Figure(figsize=(WIDTH * MM, height * MM))
        axes = figure.subplots(len(panels), 1, squeeze=False)[:, 0]
        figure.subplots_adjust(left=11 / WIDTH, right=1 - 4 / WIDTH, hspace=0.2)
        figure.subplots_adjust(top=1 - 6 / height, bottom=13 / height)
        for ax, (num, threads) in zip(axes, panels, strict=True):
            panel(ax, [row for row in own if (row.num, row.threads) == (num, threads)])
            title = f"{report.size(num)} angles, {threads} of {os.cpu_count()} cores"
            ax.set_title(title, loc="left", fontsize=6.5)
            ax.set_title("■ cardan   ○ others", loc="right", fontsize=6.5)
        axes[-1].set_xlabel(
            f"largest error of {own[0].job.title},\nrelative to the largest magnitude"
        )
        figure.savefig(path, metadata={"Date": None} if path.suffix == ".svg" else {}, dpi=300)


def panel(ax: Axes, rows: Sequence[Row]) -> None:
    """Draw the points of one case; this package's are filled squares."""
    from matplotlib.ticker import FixedLocator, NullLocator

    times = [row.best for row in rows]
    ax.set(xscale="log", yscale="log", xlim=(5e-20, 1e-5), ylabel="ns per angle")
    ax.set_ylim(min(times) / 1.4, max(times) * 1.4)
    ax.yaxis.set_major_locator(FixedLocator([m * 10.0**e for e in range(-2, 4) for m in (1, 2, 5)]))
    ax.yaxis.set_minor_locator(NullLocator())
    ax.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
    ax.grid(color="0.9", linewidth=0.5)
    ax.set_axisbelow(True)
    for row in rows:
        ours = row.method.peer == "cardan"
        ax.plot(
            row.verdict.relative,
            row.best,
            "s" if ours else "o",
            markersize=4.0 if ours else 3.4,
            markerfacecolor=BLUE if ours else "white",
            markeredgecolor=BLUE if ours else "0.25",
            markeredgewidth=0.8,
        )
    name(ax, rows)


def name(ax: Axes, rows: Sequence[Row]) -> None:
    """Write each name beside its point, in the nearest place where it covers nothing."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    assert isinstance(ax.figure, Figure)
    renderer = FigureCanvasAgg(ax.figure).get_renderer()
    point = ax.figure.dpi / 72.0
    frame = ax.get_window_extent(renderer)
    at = {id(row): ax.transData.transform((row.verdict.relative, row.best)) for row in rows}
    room = 2.5 * point
    dots: dict[int, Box] = {
        key: (x - room, y - room, x + room, y + room) for key, (x, y) in at.items()
    }
    taken = list(dots.values())
    for row in sorted(rows, key=lambda row: (row.method.peer != "cardan", row.best)):
        ours = row.method.peer == "cardan"
        x, y = at[id(row)]
        text = ax.annotate(
            row.method.name,
            (row.verdict.relative, row.best),
            xytext=(0, 0),
            textcoords="offset points",
            va="center",
            color=BLUE if ours else "0.1",
            fontweight="bold" if ours else "normal",
        )
        # Glyphs are spaced a little wider in a file than on the canvas that measures them.
        width, tall = text.get_window_extent(renderer).width * 1.04, 7.0 * point
        own = dots[id(row)]
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


def overlap(a: Box, b: Box) -> bool:
    return a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]

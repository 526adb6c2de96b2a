"""How pictures look, and how they become files."""

from __future__ import annotations

import contextlib
import math
import os
import textwrap
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from os import PathLike
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from cardan.app.files.columns import PICTURES as SUFFIXES
from cardan.app.files.whole_file import whole_file
from cardan.arrays import FloatArray
from cardan.arrays.errors import ArgumentTypeError, ArgumentValueError
from cardan.driveline import Driveline

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.container import BarContainer
    from matplotlib.figure import Figure
    from matplotlib.text import Text

STYLE: Mapping[str, Any] = {
    "font.size": 7.0,
    "axes.linewidth": 0.6,
    "axes.titlesize": 7.0,
    "axes.titlepad": 3.0,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "grid.color": "0.88",
    "grid.linewidth": 0.5,
    "lines.linewidth": 1.1,
    "lines.markersize": 3.0,
    "xtick.major.width": 0.6,
    "ytick.major.width": 0.6,
    "svg.hashsalt": "cardan",
}
"""Settings of matplotlib for pictures of 80 mm, for ``matplotlib.rc_context``."""

MM = 1.0 / 25.4
WIDTH = 80.0  # mm

# Okabe and Ito's palette, which the colour-blind can tell apart; in grey the dashes alone do.
LINES: tuple[Mapping[str, Any], ...] = (
    {"color": "#0072B2", "linestyle": "-"},
    {"color": "#D55E00", "linestyle": (0, (4, 1.5))},
    {"color": "#009E73", "linestyle": (0, (1, 1.2))},
    {"color": "#000000", "linestyle": (0, (6, 1.5, 1, 1.5))},
    {"color": "#CC79A7", "linestyle": (0, (8, 2))},
    {"color": "#56B4E9", "linestyle": (0, (3, 1, 1, 1, 1, 1))},
)
"""Colour and dashes of the curves of one picture, in turn."""

THIN: Mapping[str, Any] = {"color": "0.35", "linestyle": "-", "linewidth": 0.7}
"""A line that helps to read the curves."""

MARKERS = "os^Dvx"
"""Shapes of the points of one picture, in turn."""

_TICKS = (1, 2, 5, 10, 15, 30, 45, 90, 180, 360)  # degrees


def matplotlib() -> Any:  # noqa: ANN401 - a module that may be missing
    """Return the module; without it an ``ImportError`` says how to install it."""
    try:
        import matplotlib
    except ModuleNotFoundError:
        hint = "a picture needs matplotlib: pip install 'cardan[plot]'"
        raise ModuleNotFoundError(hint) from None
    return matplotlib


@contextlib.contextmanager
def drawing(
    ax: Axes | None, projection: str | None = None, height_mm: float = 50.0
) -> Iterator[Axes]:
    """Give the axes to draw on: those of the caller, as they are, or new ones in our style."""
    if ax is not None:
        matplotlib()
        from matplotlib.axes import Axes

        check_kind("ax", ax, Axes)
        if projection is not None and ax.name != projection:
            raise ArgumentValueError(
                "ax", f"has projection {ax.name!r}; this picture needs {projection!r}"
            )
        yield ax
        return
    with matplotlib().rc_context(STYLE):
        from matplotlib import pyplot

        figure = pyplot.figure(figsize=(WIDTH * MM, height_mm * MM), layout="constrained")
        try:
            yield figure.add_subplot(projection=projection)
        except BaseException:
            pyplot.close(figure)
            raise


def save(figure: Figure, path: str | PathLike[str]) -> None:
    """Write a figure in the format that the path's suffix names, the same bytes every time.

    Characters that the figure's font lacks are taken from another installed font; a warning names
    those that none has.

    Raises:
        OSError: the file cannot be written; nothing of it is left behind then.
        ValueError: an unknown suffix.
    """
    suffix = Path(path).suffix
    if suffix not in SUFFIXES:
        raise ValueError(f"{os.fspath(path)} must end in {' or '.join(SUFFIXES)}")
    with matplotlib().rc_context(STYLE), _with_glyphs(figure), whole_file(path) as file:
        figure.savefig(file, format=suffix[1:], dpi=300, metadata=SUFFIXES[suffix])


@contextlib.contextmanager
def page(width: float, height: float, title: str = "", letters: int = 48) -> Iterator[Figure]:
    """Give an empty figure of a size in mm, under the title of a scene in lines of some letters."""
    with matplotlib().rc_context(STYLE):
        from matplotlib.figure import Figure

        figure = Figure(figsize=(width * MM, height * MM), layout="constrained")
        if title:
            text = textwrap.fill(title, letters)
            figure.suptitle(text, fontsize=8.0, parse_math=False)
        yield figure


def stacked(panels: Sequence[tuple[float, Callable[[Axes], object]]], title: str = "") -> Figure:
    """Return a figure of panels below each other, 80 mm wide: of each height and what draws it."""
    heights = [height for height, _ in panels]
    with page(WIDTH, sum(heights), title) as figure:
        grid = figure.subplots(len(panels), squeeze=False, height_ratios=heights)
        for axes, (_, draw) in zip(grid[:, 0], panels, strict=True):
            draw(axes)
    return figure


def check_kind(argument: str, value: object, *kinds: type) -> None:
    """Refuse a value that is of none of the types that a picture shows."""
    if not isinstance(value, kinds):
        known = " or ".join(kind.__name__ for kind in kinds)
        raise ArgumentTypeError(argument, f"is {value!r}; it must be of type {known}")


def check_single(line: Driveline) -> None:
    """Refuse a batch, and what is no driveline, where a picture shows one driveline."""
    check_kind("line", line, Driveline)
    if line.shape:
        raise ArgumentValueError(
            "line", f"has shape {line.shape}; this picture shows one driveline"
        )


def line_style(number: int) -> Mapping[str, Any]:
    """Return colour and dashes of a picture's curve."""
    if number >= len(LINES):
        raise ValueError(f"a picture shows at most {len(LINES)} curves that can be told apart")
    return LINES[number]


def degree_ticks(axis: Axis, low: float, high: float) -> None:
    """Put ticks at round degrees."""
    from matplotlib.ticker import MultipleLocator

    span = high - low
    if span > _TICKS[0]:
        step = next((step for step in _TICKS if span <= 5 * step), 360 * math.ceil(span / 1800.0))
        axis.set_major_locator(MultipleLocator(step))


def value_ticks(axis: Axis, most: int = 5) -> None:
    """Put ticks at round values in full: an offset beside the axis would cover its heading.

    All of an axis have as many decimals.
    """
    from matplotlib.ticker import FuncFormatter, MaxNLocator

    axis.set_major_locator(MaxNLocator(most, steps=[1, 2, 2.5, 5, 10]))
    axis.set_major_formatter(
        FuncFormatter(lambda tick, _: _as_others(tick, axis.get_majorticklocs()))
    )


def _as_others(tick: float, others: Iterable[float]) -> str:
    """Write a tick with as many decimals as those beside it need."""
    texts = [number(other) for other in others]
    if any("e" in text for text in texts):
        return number(tick)
    decimals = max(len(text.partition(".")[2]) for text in texts)
    return f"{tick:.{decimals}f}".replace("-", "\N{MINUS SIGN}")


def number(value: float) -> str:
    """Return a number as labels show it."""
    return f"{value:.10g}".replace("-", "\N{MINUS SIGN}")


def text_width(text: str, size: float) -> float:
    """Return how wide a line of text is, in points, with room for glyphs rounded to pixels."""
    from matplotlib.font_manager import FontProperties
    from matplotlib.textpath import TextPath

    # There is no path of no letters.
    if not text.strip():
        return 0.0
    path = TextPath((0.0, 0.0), text, prop=FontProperties(size=size), usetex=False)
    return 1.06 * float(np.max(path.vertices[:, 0]))


def arrow(
    axes: Axes,
    tail: tuple[float, float],
    head: tuple[float, float],
    shape: str,
    colour: str,
    width: float,
    **options: Any,  # noqa: ANN401 - what Axes.annotate takes
) -> None:
    """Draw an arrow of a shape of matplotlib; further options are those of ``annotate``."""
    look = {"arrowstyle": shape, "color": colour, "linewidth": width, "shrinkA": 0, "shrinkB": 0}
    axes.annotate("", head, tail, arrowprops=look, **options)


def write_angle(axes: Axes, degrees: float, point: FloatArray, away: FloatArray) -> None:
    """Write a drive angle so many points away from its mark on a path."""
    axes.annotate(
        f"{degrees:g}°",
        (point[0], point[1]),
        xytext=tuple(away),
        textcoords="offset points",
        ha="center",
        va="center",
        fontsize="small",
        bbox={"facecolor": "white", "alpha": 0.8, "linewidth": 0.0, "pad": 0.0},
    )


def draw_bars(axes: Axes, bars: Sequence[tuple[str, float, str]]) -> BarContainer:
    """Draw bars of labels, sizes and texts, from the top down; return them.

    The texts are in a column beside the axes, where no line is.
    """
    from matplotlib import rcParams

    rows, size = range(len(bars)), float(rcParams["font.size"])
    longest = max((text for *_, text in bars), key=lambda text: text_width(text, size), default="")
    drawn = axes.barh(rows, [length for _, length, _ in bars], 0.62, color=LINES[0]["color"])
    for row, (_, _, text) in enumerate(bars):
        axes.annotate(
            text,
            (1.0, row),
            xycoords=axes.get_yaxis_transform(),
            xytext=(text_width(longest, size) + 4.0, 0.0),
            textcoords="offset points",
            ha="right",
            va="center",
            annotation_clip=False,
        )
    axes.set_yticks(list(rows), [label for label, _, _ in bars], parse_math=False)
    axes.invert_yaxis()
    axes.tick_params(axis="y", length=0)
    axes.set_xlim(0.0, 1.05 * max((length for _, length, _ in bars), default=0.0) or 1.0)
    return drawn


_Limits = tuple[float | None, float | None]


def finish(
    axes: Axes,
    x: str,
    y: str,
    xlim: _Limits | None = None,
    ylim: _Limits | None = None,
    **legend: Any,  # noqa: ANN401 - what Axes.legend takes
) -> None:
    """Label the axes of a picture, with round ticks, a grid and a legend above of what has a name.

    An angle along x has ticks at round degrees; other options are those of the legend.
    """
    axes.set(xlabel=x, ylabel=y)
    if xlim:
        axes.set_xlim(*xlim)
    if ylim:
        axes.set_ylim(*ylim)
    if x.endswith("[deg]"):
        degree_ticks(axes.xaxis, *axes.get_xlim())
    else:
        value_ticks(axes.xaxis)
    value_ticks(axes.yaxis)
    axes.grid(visible=True)
    if axes.get_legend_handles_labels()[1]:
        legend_above(axes, **legend)


def legend_above(axes: Axes, **options: Any) -> None:  # noqa: ANN401 - what Axes.legend takes
    """Put the legend over the right end of the axes, where no curve is."""
    axes.legend(
        **{
            "loc": "lower right",
            "bbox_to_anchor": (1.0, 1.02),
            "ncols": 3,
            "frameon": False,
            "borderaxespad": 0.0,
            "borderpad": 0.0,
            "handlelength": 1.7,
            "handletextpad": 0.3,
            "columnspacing": 0.7,
            **options,
        }
    )


# --- fonts for the characters of texts, such as those of a Chinese title -------------------------

_MOST_LACKING = 8


@contextlib.contextmanager
def _with_glyphs(figure: Figure) -> Iterator[None]:
    """Give the texts of a figure fonts that have their characters, as far as any is installed.

    One warning names the characters that no font has, in place of matplotlib's one for each.
    """
    from matplotlib.text import Text

    # A dict keeps the order of the text.
    lacking: dict[str, None] = {}
    for text in figure.findobj(Text):
        if isinstance(text, Text) and not text.get_text().isascii():
            lacking |= dict.fromkeys(_supplied(text))
    if lacking:
        named = "".join([*lacking][:_MOST_LACKING]) + "…" * (len(lacking) > _MOST_LACKING)
        warnings.warn(
            f"no installed font has the characters {named}; the picture shows boxes in their place",
            stacklevel=2,
        )
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", r"Glyph \d+ .* missing from")
        yield


def _supplied(text: Text) -> list[str]:
    """Add the font that has most of the missing characters; return those that it lacks too."""
    from matplotlib.font_manager import findfont, fontManager

    lacking = _lacking(findfont(text.get_fontproperties()), text.get_text())
    if not lacking:
        return []
    # Upright fonts of ordinary weight first; Last Resort has a box for every character.
    entries = sorted(
        (entry for entry in fontManager.ttflist if not entry.name.startswith("Last")),
        key=lambda entry: (entry.style != "normal", entry.weight not in (400, "normal")),
    )
    found = min(entries, key=lambda entry: len(_lacking(entry.fname, lacking)))
    left = _lacking(found.fname, lacking)
    if len(left) < len(lacking):
        text.set_fontfamily([*text.get_fontfamily(), found.name])
    return left


def _lacking(font: str, characters: str | list[str]) -> list[str]:
    from matplotlib.font_manager import get_font

    known = get_font(font).get_charmap()
    return [c for c in characters if c.isprintable() and not c.isspace() and ord(c) not in known]

"""Tolerances as pictures: how the drivelines scatter, and what makes them scatter."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

import cardan.app.pictures.style as style
from cardan.app.answers.answer import Answer
from cardan.app.answers.page import Curve, Panel, Table, bars, chart, tables_of
from cardan.app.answers.printed import capital, given, with_unit
from cardan.app.answers.rows import UNITS, key_of
from cardan.app.answers.tolerances.figures import (
    ToleranceFigure,
    ToleranceFigures,
    by_state,
    called,
    in_its_unit,
    percent,
    shares_of,
)
from cardan.app.scene.language.units import shown_unit
from cardan.arrays.errors import ArgumentValueError
from cardan.tolerances import Tolerances

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_BINS, _POINTS, _CHART_POINTS = 40, 400, 200
_PANEL = 55.0  # mm

# Parameters beyond this many share one bar.
_MOST_BARS = 8

_LIMIT: Mapping[str, Any] = {"color": "#D55E00", "linestyle": (0, (4, 1.5)), "linewidth": 1.4}
_WORST: Mapping[str, Any] = {"color": "0.25", "linestyle": (0, (1, 1.2)), "linewidth": 1.1}


def drawn(answer: Answer, found: ToleranceFigures) -> dict[str, Any]:
    """Return tables of the states, how the drivelines scatter and what makes them."""
    of = answer.scene.tolerances
    assert of
    return {
        "tables": [
            *tables_of("Tolerances", found),
            *(
                Table(caption, tuple(map(str.capitalize, head)), rows)
                for caption, (head, *rows) in by_state(found)
            ),
        ],
        "charts": [_scatter(figure, of) for figure in found.figures],
        "bars": [
            bars(f"What makes the {figure.label} scatter", _shares(of, figure.name, 10))
            for figure in found.figures
        ],
    }


def _scatter(figure: ToleranceFigure, of: Tolerances) -> dict[str, Any]:
    """The share of the drivelines up to each value, with the limit as a step."""
    sampled, worst = (in_its_unit(of, figure.name, each) for each in (of.ascending, of.worst))
    limit = None if figure.limit is None else UNITS[shown_unit(figure.unit)].factor * figure.limit
    high = max(float(sampled[-1]), float(worst), limit or 0.0)
    x = np.linspace(
        float(sampled[0]), high if high > sampled[0] else sampled[0] + 1.0, _CHART_POINTS
    )
    if limit is not None:
        x = np.sort(np.append(x, [limit, limit]))
    shares = 100.0 * np.searchsorted(sampled, x, side="right") / len(sampled)
    curves = [Curve("share up to this value", shares)]
    if limit is not None and figure.limit is not None:
        step = np.where(x > limit, 100.0, 0.0)
        step[np.searchsorted(x, limit, side="left") + 1] = 100.0
        curves.append(Curve(f"limit {given(figure.limit, figure.unit)}", step))
    panel = Panel(f"Random drivelines up to this {figure.label}", "%", tuple(curves), 100.0)
    return chart(panel, x, with_unit(figure.label, figure.unit))


def _shares(found: Tolerances, name: str, most: int) -> list[tuple[str, float, str]]:
    """The shares in the scatter as bars in percent; beyond so many parameters they share one."""
    shares = [(capital(each.label), each.share) for each in shares_of(found, name)]
    if rest := math.fsum(share for _, share in shares[most:]):
        shares[most:] = [(f"the other {len(shares) - most}", rest)]
    return [(label, 100.0 * share, percent(share)) for label, share in shares[: most + 1]]


def plot_tolerances(found: Tolerances, of: str | None = None, *, ax: Axes | None = None) -> Axes:
    """Draw how a figure scatters: a histogram, and the share of the drivelines up to each value.

    Args:
        found: the tolerances of a single driveline, from ``Driveline.tolerances``.
        of: the figure; by default the first.

    Returns:
        the axes of the histogram, with angles in degrees. Limit and worst case are marked.

    Raises:
        ValueError: a batch, a figure that was not asked for.
    """
    name = _checked(found, of)
    values = in_its_unit(found, name, found.ascending)
    limit, worst = in_its_unit(found, name, found.limit), in_its_unit(found, name, found.worst)
    with style.drawing(ax, height_mm=_PANEL) as axes:
        counts, edges = np.histogram(values, _BINS)
        shares = 100.0 * counts / len(values)
        axes.bar(
            edges[:-1],
            shares,
            np.diff(edges),
            align="edge",
            color="#BFD9EA",
            edgecolor="white",
            linewidth=0.3,
            label="in each bar",
        )
        axes.set_ylabel("drivelines in each bar [%]")
        axes.set_ylim(0.0, 1.08 * float(shares.max()))
        upto = axes.twinx()
        upto.spines["right"].set_visible(True)
        places = np.unique(np.linspace(0, len(values) - 1, _POINTS).astype(int))
        upto.plot(
            values[places],
            100.0 * (places + 1) / len(values),
            label="cumulative share",
            **style.LINES[0],
        )
        upto.set_ylim(0.0, 108.0)
        upto.set_yticks([0, 25, 50, 75, 95])
        upto.set_ylabel("drivelines up to this value [%]")
        upto.grid(visible=True, axis="y")
        upto.set_zorder(2.0)
        unit = key_of(found.unit(name))
        for word, value, look in (("limit", limit, _LIMIT), ("worst", worst, _WORST)):
            if not np.isnan(value):
                shown = given(value / UNITS[shown_unit(unit)].factor, unit)
                upto.axvline(value, label=f"{word} {shown}", **look)
        of = f", largest of {found.n_states} states" if found.n_states else ""
        axes.set_xlabel(with_unit(f"{called(found, name)}{of}", unit))
        style.value_ticks(axes.xaxis)
        style.value_ticks(axes.yaxis)
        style.legend_above(upto)
    return axes


def plot_tolerance_shares(
    found: Tolerances, of: str | None = None, *, ax: Axes | None = None
) -> Axes:
    """Draw the shares that joints, shafts and points have in the scatter of a figure, as bars.

    Arguments and errors are those of ``plot_tolerances``.
    """
    known = _shares(found, _checked(found, of), _MOST_BARS)
    with style.drawing(ax, height_mm=_height(len(known))) as axes:
        style.draw_bars(axes, known)
        axes.set_xticks([tick for tick in axes.get_xticks() if tick <= 100.0])
        axes.set_xlabel("share in the scatter [%]")
    return axes


def _whole(answer: Answer) -> Figure:
    """How a figure scatters, and which tolerances make it do so."""
    answer.needed("tolerances")
    found = answer.scene.tolerances
    assert found
    count = len(_shares(found, found.of[0], _MOST_BARS))
    return style.stacked(
        (
            (_PANEL, lambda axes: plot_tolerances(found, ax=axes)),
            (_height(count), lambda axes: plot_tolerance_shares(found, ax=axes)),
        ),
        answer.of.title,
    )


PICTURES = {"tolerances": _whole}


def _height(bars: int) -> float:
    return 12.0 + 5.0 * bars


def _checked(found: Tolerances, of: str | None) -> str:
    style.check_kind("found", found, Tolerances)
    if found.shape:
        raise ValueError(f"the tolerances are of a batch of shape {found.shape}; draw one of them")
    name = found.of[0] if of is None else of
    if name not in found.of:
        raise ArgumentValueError("of", f"is {name!r}; it must be one of {', '.join(found.of)}")
    return name

"""Tolerances as pictures: how the drivelines scatter, and what makes them scatter."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from cardan.app.answers.answer import Answer
from cardan.app.answers.tolerances.figures import (
    in_its_unit,
    needed_tolerances,
    shares_of,
    unit_of,
    with_symbol,
)
from cardan.app.pictures.style import (
    LINES,
    drawing,
    legend_above,
    stacked,
    value_ticks,
)
from cardan.arrays.errors import ArgumentValueError
from cardan.tolerances import Tolerances

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_BINS, _POINTS = 40, 400

# Smaller shares would be written as 0.0 %.
_LEAST = 5e-4

# Parameters beyond this many share one bar.
_MOST_BARS = 8

_LIMIT: Mapping[str, Any] = {"color": "#D55E00", "linestyle": (0, (4, 1.5)), "linewidth": 1.4}
_WORST: Mapping[str, Any] = {"color": "0.25", "linestyle": (0, (1, 1.2)), "linewidth": 1.1}


def plot_tolerances(found: Tolerances, of: str | None = None, *, ax: Axes | None = None) -> Axes:
    """Draw how a figure scatters: a histogram, and the share of the drivelines up to each value.

    Args:
        found: the tolerances of a single driveline, from ``Driveline.tolerances``.
        of: the figure; by default the first.
        ax: where to draw; by default on a new figure of pyplot, 80 mm wide.

    Returns:
        the axes of the histogram, with angles in degrees. Limit and worst case are marked.

    Raises:
        ValueError: a batch, a figure that was not asked for.
    """
    name = _checked(found, of)
    values = in_its_unit(found, name, found.ascending)
    limit, worst = in_its_unit(found, name, found.limit), in_its_unit(found, name, found.worst)
    with drawing(ax, height_mm=55.0) as axes:
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
            values[places], 100.0 * (places + 1) / len(values), label="cumulative share", **LINES[0]
        )
        upto.set_ylim(0.0, 108.0)
        upto.set_yticks([0, 25, 50, 75, 95])
        upto.set_ylabel("drivelines up to this value [%]")
        upto.grid(visible=True, axis="y")
        upto.set_zorder(2.0)
        mark = "°" if unit_of(found, name) == "deg" else ""
        if not np.isnan(limit):
            upto.axvline(limit, label=f"limit {limit:.4g}{mark}", **_LIMIT)
        upto.axvline(worst, label=f"worst {worst:.4g}{mark}", **_WORST)
        of = f", largest of {found.n_states} states" if found.n_states else ""
        name, bracket, unit = with_symbol(found, name).partition(" [")
        axes.set_xlabel(f"{name}{of}{bracket}{unit}")
        value_ticks(axes.xaxis)
        value_ticks(axes.yaxis)
        legend_above(upto)
    return axes


def plot_tolerance_shares(
    found: Tolerances, of: str | None = None, *, ax: Axes | None = None
) -> Axes:
    """Draw the shares that joints, shafts and points have in the scatter of a figure, as bars.

    Args:
        found: the tolerances of a single driveline, from ``Driveline.tolerances``.
        of: the figure; by default the first.
        ax: where to draw; by default on a new figure of pyplot, 80 mm wide.

    Raises:
        ValueError: a batch, a figure that was not asked for.
    """
    name = _checked(found, of)
    shares = shares_of(found, name)
    rest = math.fsum(share.share for share in shares[_MOST_BARS:])
    bars = [(share.label, share.share) for share in shares[:_MOST_BARS]]
    if rest > 0.0:
        bars.append((f"the other {len(shares) - _MOST_BARS}", rest))
    with drawing(ax, height_mm=12.0 + 5.0 * len(bars)) as axes:
        rows = range(len(bars))
        axes.barh(rows, [100.0 * share for _, share in bars], 0.62, color="#0072B2")
        for row, (_, share) in enumerate(bars):
            axes.annotate(
                f"{100.0 * share:.1f} %" if share == 0.0 or share >= _LEAST else "< 0.1 %",
                (100.0 * share, row),
                xytext=(2.0, 0.0),
                textcoords="offset points",
                va="center",
            )
        axes.set_yticks(list(rows), [label for label, _ in bars])
        axes.invert_yaxis()
        axes.tick_params(axis="y", length=0)
        # Room for the figures beside the bars.
        most = 100.0 * max((share for _, share in bars), default=1.0)
        axes.set_xlim(0.0, 1.18 * most if most > 0.0 else 1.0)
        axes.set_xticks([tick for tick in axes.get_xticks() if tick <= 100.0])
        axes.set_xlabel("share in the scatter [%]")
    return axes


def _whole(answer: Answer) -> Figure:
    """How the first figure scatters, and which tolerances make it do so."""
    needed_tolerances(answer.scene)
    found = answer.scene.tolerances
    assert found
    bars = min(len(shares_of(found, found.of[0])), _MOST_BARS + 1)
    return stacked(
        (
            (55.0, lambda axes: plot_tolerances(found, ax=axes)),
            (12.0 + 5.0 * bars, lambda axes: plot_tolerance_shares(found, ax=axes)),
        )
    )


PICTURES = {"tolerances": _whole}
"""The pictures of the part by name."""


def _checked(found: Tolerances, of: str | None) -> str:
    if found.shape:
        raise ValueError(f"the tolerances are of a batch of shape {found.shape}; draw one of them")
    name = found.of[0] if of is None else of
    if name not in found.of:
        raise ArgumentValueError("of", f"is {name!r}; it must be one of {', '.join(found.of)}")
    return name

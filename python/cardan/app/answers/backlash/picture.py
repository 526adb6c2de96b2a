"""The backlash loop of a driveline, and its lash over the turn."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from cardan.app.answers.answer import Answer
from cardan.app.answers.backlash.figures import TURN, Backlash, drawn_backlash
from cardan.app.answers.printed import angle_text, given, quantity, with_unit
from cardan.app.pictures.style import (
    THIN,
    check_kind,
    drawing,
    finish,
    line_style,
    stacked,
    value_ticks,
)
from cardan.app.scene.language.units import as_shown

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_CLOSE = 1e-3
"""Loops whose lash differs by less than this share are drawn as one."""


def plot_backlash(found: Backlash, *, ax: Axes | None = None) -> Axes:
    """Draw torque over the angle of the last shaft while the drive is held: the backlash loop.

    There is a loop at the drive angle with the largest lash and one at that with the least, unless
    they are nearly the same. Between the flanks the shaft is loose; on a flank the crosses wind up.

    Args:
        found: lash and wind-up, from ``cardan.app.answers.backlash.figures``.
        ax: where to draw; by default on a new figure of pyplot, 80 mm wide.

    Returns:
        the axes, with the angle in degrees from the middle of the play.
    """
    check_kind("found", found, Backlash)
    most, least = int(np.argmax(found.lash)), int(np.argmin(found.lash))
    apart = found.lash[most] - found.lash[least] > _CLOSE * found.lash[most]
    turn = np.degrees(np.asarray(TURN))
    with drawing(ax, height_mm=55.0) as axes:
        axes.axhline(0.0, **THIN)
        axes.axvline(0.0, **THIN)
        for place, sample in enumerate((most, least) if apart else (most,)):
            angle, torque = found.loop(sample)
            torque = as_shown(torque, "N m")[0]
            axes.plot(
                np.degrees(angle),
                torque,
                label=f"at {angle_text(float(turn[sample]), radians=False)}: loose by "
                f"{quantity(float(found.lash[sample]), 'deg')}",
                **line_style(place),
            )
        held = "angle of the last shaft, drive held [deg]"
        finish(axes, held, with_unit(f"torque at the {found.end}", "Nm"), ncols=2)
        value_ticks(axes.xaxis)
    return axes


def plot_lash(found: Backlash, *, ax: Axes | None = None) -> Axes:
    """Draw how far the last shaft is loose over the turn, and how far the torque winds it up.

    Arguments and errors are those of ``plot_backlash``.
    """
    check_kind("found", found, Backlash)
    turn = np.degrees(np.asarray(TURN))
    with drawing(ax, height_mm=45.0) as axes:
        axes.plot(turn, np.degrees(found.lash), label="loose by", **line_style(0))
        both = found.lash + 2.0 * found.wind_up
        if np.any(found.wind_up):
            label = f"from {given(found.torque, 'Nm')} to \N{MINUS SIGN}{given(found.torque, 'Nm')}"
            axes.plot(turn, np.degrees(both), label=label, **line_style(1))
        ends = (0.0, 360.0), (0.0, 1.1 * float(np.degrees(np.max(both))))
        finish(axes, "drive angle [deg]", "angle of the last shaft [deg]", *ends)
    return axes


def _whole(answer: Answer) -> Figure:
    """Torque over the angle of the loose last shaft, and its lash."""
    found = drawn_backlash(answer.scene)
    panels = (
        (60.5, lambda axes: plot_backlash(found, ax=axes)),
        (49.5, lambda axes: plot_lash(found, ax=axes)),
    )
    return stacked(panels, answer.of.title)


PICTURES = {"backlash": _whole}
"""The pictures of the part by name."""

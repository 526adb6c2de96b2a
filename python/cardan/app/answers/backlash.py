"""How far the last shaft is loose while the drive is held, and how far torque winds it up."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike

import cardan.app.pictures.style as style
from cardan.app.answers.answer import Answer
from cardan.app.answers.over import drivelines, limit_of, over
from cardan.app.answers.printed import angle_text, given, quantity, with_unit
from cardan.app.answers.rows import Judged, figure, word
from cardan.app.answers.turn.panel import TURN
from cardan.app.scene.language.units import as_shown
from cardan.app.scene.scene import Scene
from cardan.arrays import FloatArray
from cardan.arrays.errors import ArgumentValueError
from cardan.driveline import Driveline
from cardan.evaluation.load import Load

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


# Drivelines of a study at a time.
_ROWS = 256


@dataclass(frozen=True, eq=False)
class Backlash:
    """Lash and wind-up of the last shaft over a turn, ``(samples,)`` in rad."""

    lash: FloatArray  # angle by which it is loose while the drive is held
    # Angle by which the torque winds it up beyond its flank; 0 with rigid crosses.
    wind_up: FloatArray
    torque: float  # which makes the wind-up, in N m
    end: str  # where the torque acts, ``"drive"`` or ``"output"``

    def loop(self, sample: int) -> tuple[FloatArray, FloatArray]:
        """Return the loop at one sample: angle of the shaft in rad and torque in N m, ``(4,)``.

        From full torque through the play to the opposite torque. The angle counts from the middle
        of the play; under a positive torque the shaft lags.
        """
        half, wound = 0.5 * self.lash[sample], self.wind_up[sample]
        angle = np.array([-half - wound, -half, half, half + wound])
        return angle, self.torque * np.array([1.0, 0.0, 0.0, -1.0])


def backlash(
    line: Driveline,
    radial: ArrayLike,
    arm: ArrayLike,
    load: Load,
    stiffness: ArrayLike | None = None,
) -> Backlash:
    """Return lash and wind-up of one driveline over ``TURN``.

    The torque of the load alone acts, which must be one number and not 0; other arguments and
    errors are those of ``Driveline.lash`` and ``wind_up``.
    """
    if line.shape:
        raise ArgumentValueError(
            "driveline", f"has shape {line.shape}; backlash is that of one driveline"
        )
    if load.torque.ndim or load.torque == 0.0:
        raise ArgumentValueError(
            "load", "must have one torque that is not 0; backlash is the angle over this torque"
        )
    torque = abs(float(load.torque))
    lash = np.asarray(line.lash(TURN, radial, arm))
    wind_up = np.zeros(len(lash))
    if stiffness is not None:
        alone: dict[str, Any] = {f"{load.end}_torque": torque}
        wind_up = np.asarray(line.wind_up(TURN, Load(**alone), stiffness))
    return Backlash(lash, wind_up, torque, load.end)


@dataclass(frozen=True)
class BacklashFigures:
    """How far the last shaft is loose over a turn while the drive is held."""

    lash: Judged = figure(
        "largest lash",
        "deg",
        "angle by which the last shaft is loose while the drive is held, over the turn",
        limit="[limits] lash_deg",
    )
    least_lash: float | None = figure("least lash", "deg", "over the turn")
    torque: float | None = figure(
        "torque", "Nm", "that winds the last shaft up beyond its lash", digits="given"
    )
    end: Literal["drive", "output", ""] = word("acting at the", "where the torque acts")
    wind_up: Judged | None = figure(
        "largest wind-up", "deg", "by which the torque twists the crosses, either way"
    )
    least_wind_up: float | None = figure("least wind-up", "deg", "over the turn")


def find(answer: Answer) -> BacklashFigures | None:
    """Return lash and wind-up of a scene over its states or study; ``None`` without play."""
    scene = answer.scene
    play, load = scene.play, scene.load_case
    limit = limit_of(scene, "lash_deg")
    why = "the bends were recorded" if scene.line.shape else ""
    if play is None:
        why = "[joints] gives no play_mm"
    if why or play is None:
        found = Judged(None, why=why, **limit)
        return BacklashFigures(found, None, None, "", None, None) if limit else None
    twists = play.stiffness is not None and load is not None and not load.torque.ndim
    loose, wound, torques = [], [], [0.0]
    for lines, own in _blocks(scene):
        loose.append(_ends(lines.lash(TURN, play.radial, play.arm)))
        if own is None or play.stiffness is None or not twists:
            continue
        torques.append(float(np.max(np.abs(own.torque))))
        alone: dict[str, Any] = {f"{own.end}_torque": np.abs(own.torque)}
        wound.append(_ends(lines.wind_up(TURN, Load(**alone), play.stiffness)))
    least, most = np.concatenate(loose, axis=1)
    wind_up, least_wind_up = None, None
    if max(torques) > 0.0:
        low, high = np.concatenate(wound, axis=1)
        wind_up, least_wind_up = over(scene, high), float(np.min(low))
    return BacklashFigures(
        over(scene, most, **limit),
        float(np.min(least)),
        max(torques) or None,
        load.end if load and wind_up else "",
        wind_up,
        least_wind_up,
    )


def _blocks(scene: Scene) -> Iterator[tuple[Driveline, Load | None]]:
    """The drivelines that the scene judges, few enough for the samples of a turn of each."""
    for lines, load, _ in drivelines(scene, as_built=True):
        for first in range(0, lines.shape[0], _ROWS):
            rows = slice(first, first + _ROWS)
            if load is None or not load.torque.shape:
                yield lines[rows], load
                continue
            torque: dict[str, Any] = {f"{load.end}_torque": load.torque[rows]}
            yield lines[rows], Load(**torque)


def _ends(values: FloatArray) -> FloatArray:
    """The least and the largest of each row."""
    return np.stack([np.min(values, axis=-1), np.max(values, axis=-1)])


def drawn_backlash(scene: Scene) -> Backlash:
    """Return lash and wind-up to draw, over states those of the one with the largest lash.

    A scene without play, without one torque or with recorded bends raises a ``ValueError``.
    """
    play, load = scene.play, scene.load_case
    if play is None or load is None or scene.line.shape or load.torque.ndim or not load.torque:
        raise ValueError(
            f"{scene.name}: backlash needs play_mm and arm_mm in [joints], one torque in [load] "
            "that is not 0, and bends that were not recorded"
        )
    lines = [scene.line_as_built]
    if scene.states:
        lines = [scene.in_state(i).line_as_built for i in range(scene.states.count)]
    found = [backlash(line, play.radial, play.arm, load, play.stiffness) for line in lines]
    return max(found, key=lambda one: float(np.max(one.lash)))


_CLOSE = 1e-3
"""Loops whose lash differs by less than this share are drawn as one."""


def plot_backlash(found: Backlash, *, ax: Axes | None = None) -> Axes:
    """Draw torque over the angle of the last shaft while the drive is held: the backlash loop.

    There is a loop at the drive angle with the largest lash and one at that with the least, unless
    they are nearly the same. Between the flanks the shaft is loose; on a flank the crosses wind up.

    Args:
        found: lash and wind-up, from ``cardan.app.answers.backlash``.

    Returns:
        the axes, with the angle in degrees from the middle of the play.
    """
    style.check_kind("found", found, Backlash)
    most, least = int(np.argmax(found.lash)), int(np.argmin(found.lash))
    apart = found.lash[most] - found.lash[least] > _CLOSE * found.lash[most]
    turn = np.degrees(np.asarray(TURN))
    with style.drawing(ax, height_mm=55.0) as axes:
        axes.axhline(0.0, **style.THIN)
        axes.axvline(0.0, **style.THIN)
        for place, sample in enumerate((most, least) if apart else (most,)):
            angle, torque = found.loop(sample)
            torque = as_shown(torque, "N m")[0]
            axes.plot(
                np.degrees(angle),
                torque,
                label=f"at {angle_text(float(turn[sample]), radians=False)}: loose by "
                f"{quantity(float(found.lash[sample]), 'deg')}",
                **style.line_style(place),
            )
        held = "angle of the last shaft, drive held [deg]"
        style.finish(axes, held, with_unit(f"torque at the {found.end}", "Nm"), ncols=2)
        style.value_ticks(axes.xaxis)
    return axes


def plot_lash(found: Backlash, *, ax: Axes | None = None) -> Axes:
    """Draw how far the last shaft is loose over the turn, and how far the torque winds it up.

    Arguments and errors are those of ``plot_backlash``.
    """
    style.check_kind("found", found, Backlash)
    turn = np.degrees(np.asarray(TURN))
    with style.drawing(ax, height_mm=45.0) as axes:
        axes.plot(turn, np.degrees(found.lash), label="loose by", **style.line_style(0))
        both = found.lash + 2.0 * found.wind_up
        if np.any(found.wind_up):
            label = f"from {given(found.torque, 'Nm')} to \N{MINUS SIGN}{given(found.torque, 'Nm')}"
            axes.plot(turn, np.degrees(both), label=label, **style.line_style(1))
        ends = (0.0, 360.0), (0.0, 1.1 * float(np.degrees(np.max(both))))
        style.finish(axes, "drive angle [deg]", "angle of the last shaft [deg]", *ends)
    return axes


def _whole(answer: Answer) -> Figure:
    """Torque over the angle of the loose last shaft, and its lash."""
    found = drawn_backlash(answer.scene)
    panels = (
        (60.5, lambda axes: plot_backlash(found, ax=axes)),
        (49.5, lambda axes: plot_lash(found, ax=axes)),
    )
    return style.stacked(panels, answer.of.title)


PICTURES = {"backlash": _whole}

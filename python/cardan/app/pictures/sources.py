"""The figures of the sources: a single joint, its moments, those of a flywheel, bend vectors."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

import cardan.app.answers.turn.panel as panel
import cardan.app.pictures.style as style
from cardan.app.answers.printed import number_text
from cardan.app.answers.turn.panel import TURN
from cardan.arrays import FloatArray, finite, one_number
from cardan.arrays.errors import ArgumentValueError, check_choice, check_shape
from cardan.arrays.indices import item_index
from cardan.driveline import Driveline
from cardan.evaluation.load import Load
from cardan.evaluation.sweep import Sweep
from cardan.motion import workshop
from cardan.reference.approximations import thoma_small_angle

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_HALF_TURN_DEG = np.arange(721) / 4.0
_HALF_TURN = Sweep.revolutions(721 / 1440, 1440)


def plot_driven_angle(bend_deg: float = 60.0, *, ax: Axes | None = None) -> Axes:
    """Draw Bild 10: the driven angle over the drive angle, compared with a straight joint.

    At bends that are in use the two could hardly be told apart.

    Args:
        bend_deg: bend in degrees.

    Raises:
        ValueError: a bend outside [0, 90°).
    """
    bend_deg = one_number("bend_deg", bend_deg)
    line = Driveline.from_bends([bend_deg], degrees=True)
    driven = np.degrees(line.evaluate(_HALF_TURN, "angle").angle)
    with style.drawing(ax) as axes:
        axes.plot(_HALF_TURN_DEG, driven, label=f"bend {style.number(bend_deg)}°", **style.LINES[0])
        axes.plot(_HALF_TURN_DEG, _HALF_TURN_DEG, label="bend 0°", **style.LINES[1])
        axes.set(xlim=(0.0, 180.0), ylim=(0.0, 180.0))
        style.finish(axes, "drive angle [deg]", "driven angle [deg]")
        style.degree_ticks(axes.yaxis, 0.0, 180.0)
    return axes


def plot_angle_error(
    bends_deg: Sequence[float] = (10.0, 20.0, 30.0), *, ax: Axes | None = None
) -> Axes:
    """Draw Bild 11: the angle error over the drive angle, with the locus of its extremes.

    Args:
        bends_deg: bends in degrees, a curve for each.

    Raises:
        ValueError: a bend outside [0, 90°), more bends than can be told apart.
    """
    bends = finite("bends_deg", bends_deg)
    check_shape("bends_deg", bends, bends.ndim == 1 and bends.size > 0, "it must be (curves,)")
    lines = Driveline.from_bends(bends[:, np.newaxis], degrees=True)
    errors = lines[:, np.newaxis].evaluate(_HALF_TURN, "angle_error").angle_error
    places, largest = _extremes(lines)
    to = float(np.max(np.degrees(lines.bends)))
    locus = _extremes(_joints(to))
    with style.drawing(ax, height_mm=55.0) as axes:
        for i, (bend, curve) in enumerate(zip(bends, np.degrees(errors), strict=True)):
            size, place = number_text(largest[i], "angle_error"), number_text(places[i], "phase")
            label = f"bend {style.number(bend)}°: {size}° at {place}°"
            axes.plot(_HALF_TURN_DEG, curve, label=label, **style.line_style(i))
        # One line through both halves would run along the axis between them.
        for sign, label in ((1.0, "locus of the extremes"), (-1.0, "")):
            where = locus[0] if sign > 0.0 else 180.0 - locus[0]
            axes.plot(where, sign * locus[1], label=label, **style.THIN)
            where = places if sign > 0.0 else 180.0 - places
            axes.plot(where, sign * largest, "o", color=style.THIN["color"])
        style.finish(axes, "drive angle [deg]", "angle error [deg]", (0.0, 180.0), ncols=2)
    return axes


def plot_largest_angle_error(to_deg: float = 45.0, *, ax: Axes | None = None) -> Axes:
    """Draw Bild 12: the largest angle error over the bend.

    Args:
        to_deg: largest bend in degrees.

    Raises:
        ValueError: a bend outside [0, 90°).
    """
    return _over_bend("max_angle_error", "largest angle error [deg]", to_deg, ax)


def plot_non_uniformity(to_deg: float = 45.0, *, ax: Axes | None = None) -> Axes:
    """Draw Bild 13: the non-uniformity over the bend.

    Arguments and errors are those of ``plot_largest_angle_error``.
    """
    return _over_bend("non_uniformity", "non-uniformity U", to_deg, ax)


def _joints(to_deg: float) -> Driveline:
    """A joint at every bend up to one."""
    return Driveline.from_bends(np.linspace(0.0, to_deg, 181)[:, np.newaxis], degrees=True)


def _extremes(lines: Driveline) -> tuple[FloatArray, FloatArray]:
    """Drive angle of the largest angle error of single joints, and its size, both in degrees."""
    joint = lines.equivalent()
    return (
        np.degrees(np.arctan(np.sqrt(joint.min_speed_ratio))),
        np.degrees(joint.max_angle_error),
    )


def _over_bend(field: str, label: str, to_deg: float, ax: Axes | None) -> Axes:
    to_deg = one_number("to_deg", to_deg)
    lines = _joints(to_deg)
    values = getattr(lines.equivalent(), field)
    with style.drawing(ax, height_mm=45.0) as axes:
        in_unit = np.degrees(values) if field == "max_angle_error" else values
        axes.plot(np.degrees(lines.bends[:, 0]), in_unit, **style.LINES[0])
        style.finish(axes, "bend [deg]", label, (0.0, to_deg), (0.0, None))
    return axes


def plot_torque_ratio(bend_deg: float = 50.0, *, ax: Axes | None = None) -> Axes:
    """Draw Abb. 3: the torque of the driven shaft over the drive angle, per unit drive torque.

    Arguments and errors are those of ``plot_driven_angle``.
    """
    bend_deg = one_number("bend_deg", bend_deg)
    line = Driveline.from_bends([bend_deg], degrees=True)
    torque = line.evaluate(TURN, "torque", load=Load(drive_torque=1.0)).torque
    with style.drawing(ax, height_mm=45.0) as axes:
        axes.plot(
            np.degrees(TURN), torque, label=f"bend {style.number(bend_deg)}°", **style.LINES[0]
        )
        x = r"drive angle $\alpha_1$ [deg]"
        style.finish(axes, x, "torque $D_2/D_1$", (0.0, 360.0), (0.0, None))
    return axes


def plot_bending_moments(bend_deg: float = 50.0, *, ax: Axes | None = None) -> Axes:
    """Draw Abb. 4: the bending moments as a polar diagram, per unit drive torque.

    That of the driving shaft is drawn over the drive angle, that of the driven shaft over the
    driven angle.

    Args:
        bend_deg: bend in degrees.
        ax: polar axes; by default on a new figure of pyplot, 80 mm wide.

    Raises:
        ValueError: axes that are not polar, a bend outside [0, 90°).
    """
    bend_deg = one_number("bend_deg", bend_deg)
    line = Driveline.from_bends([bend_deg], degrees=True)
    found = line.evaluate(
        TURN, ("angle", "bending_driving", "bending_driven"), joints=0, load=Load(drive_torque=1.0)
    )
    with style.drawing(ax, "polar", height_mm=78.0) as axes:
        polar: Any = axes
        driving, driven = (rf"$B_{i}/D_1$ over $\alpha_{i}$" for i in (1, 2))
        axes.plot(
            np.asarray(TURN), found.bending_driving, label=f"driving {driving}", **style.LINES[0]
        )
        axes.plot(found.angle, found.bending_driven, label=f"driven {driven}", **style.LINES[1])
        style.value_ticks(axes.yaxis, 4)
        polar.set_rlabel_position(0.0)
        style.legend_above(axes, loc="lower center", bbox_to_anchor=(0.5, 1.12), ncols=2)
    return axes


_SYMBOLS = {"torque": "M_t", "moment_x": "M_x", "moment_z": "M_z"}


def plot_small_angle(
    component: Literal["torque", "moment_x", "moment_z"] = "torque",
    bend_deg: float = 30.0,
    *,
    ax: Axes | None = None,
) -> Axes:
    """Draw a moment on the driven shaft over the turn, exact and by Thoma's form for small bends.

    The drive turns steadily, the flywheel sits on the driven shaft, and the moments are over
    ``inertia * speed**2``, with Thoma's signs (``cardan.approximations.thoma_small_angle``).

    Args:
        component: his ``Mt``, ``Mx`` or ``Mz``.
        bend_deg: bend in degrees; his own example has 8.5.

    Raises:
        ValueError: an unknown component, a bend outside [0, 90°).
    """
    check_choice("component", component, tuple(_SYMBOLS))
    bend_deg = one_number("bend_deg", bend_deg)
    exact, small = _moments(component, bend_deg)
    curves = [(f"exact, bend {bend_deg:g}°", exact), ("for small bends", small)]
    with style.drawing(ax, height_mm=45.0) as axes:
        panel.draw(axes, np.degrees(panel.TURN), curves)
        style.finish(axes, "drive angle [deg]", rf"${_SYMBOLS[component]}\,/\,Θω^2$")
    return axes


def _moments(component: str, bend_deg: float) -> tuple[FloatArray, FloatArray]:
    line = Driveline.from_bends([bend_deg], degrees=True)
    load = Load(speed=1.0, inertias=[0.0, 1.0])
    moment = line.evaluate(panel.TURN, "moment", joints=0, load=load).moment
    along, across = line.directions[1], line.normals[0]
    # Thoma's axes point against the power flow, hence the signs.
    axis = {"torque": along, "moment_x": -np.cross(across, along), "moment_z": -across}[component]
    small = thoma_small_angle(np.asarray(panel.TURN), line.bends[0], 1.0, 1.0)
    return moment @ axis, getattr(small, component)


# --- vectors: bends at both ends of a shaft, and the path of a joint's moment ---------------------


def plot_bend_vectors(line: Driveline, shaft: int = 1, *, ax: Axes | None = None) -> Axes:
    """Draw the bends at both ends of a shaft as vectors, the catalogues' Bild 18.

    Looking from the drive towards the output, with y up and z to the right where the shaft lies
    along x. Each vector points
    where its joint bends to, exactly, and is as long as the bend. Rings show where the catalogue's
    drawing puts the ends: it adds the projected bends themselves, instead of their tangents. The
    arrow is the turn by which the output-side yoke must be set against the input-side one.

    Args:
        line: one driveline.
        shaft: a shaft between two bent joints.

    Raises:
        IndexError: a shaft that does not exist.
        ValueError: a batch, a shaft at an end of the driveline or beside a straight joint.
    """
    style.check_single(line)
    item = item_index("shaft", shaft, line.n_joints + 1)
    if not 0 < item < line.n_joints:
        raise ArgumentValueError("shaft", f"is {shaft}; it must lie between two joints")
    bends, along = line.bends[item - 1 : item + 1], line.directions[item]
    if not np.all(bends > 0.0):
        raise ArgumentValueError(
            "shaft", f"is {shaft}; a straight joint beside it has no bend plane"
        )
    pointing = np.cross(line.normals[item - 1 : item + 1], along) @ _view(along).T
    ends = np.degrees(bends)[:, np.newaxis] * pointing
    as_drawn = np.degrees(np.arctan(np.tan(bends)[:, np.newaxis] * pointing))
    # Seen along the shaft a turn about it is clockwise.
    first = np.degrees(np.arctan2(pointing[0, 1], pointing[0, 0]))
    turn = workshop.turn(line.twists[item - 1])
    sweep = np.degrees(turn.angle) * (1.0 if turn.sense == "counter-clockwise" else -1.0)
    last = np.radians(first + sweep)
    radius = 0.6 * float(np.degrees(np.min(bends)))
    with style.drawing(ax, height_mm=78.0) as axes:
        for i, (end, bend) in enumerate(zip(ends, np.degrees(bends), strict=True)):
            label = f"joint {item - 1 + i}: {number_text(bend, 'deg')}°"
            axes.plot(*zip((0.0, 0.0), end, strict=True), label=label, **style.LINES[i])
            axes.plot(*end, marker=style.MARKERS[i], color=style.LINES[i]["color"])
        ring = {
            "markerfacecolor": "none",
            "markeredgecolor": style.THIN["color"],
            "markersize": 5.0,
        }
        axes.plot(*as_drawn.T, "o", label="by the drawing", **ring)
        reach = 1.25 * radius * np.array([np.cos(last), np.sin(last)])
        axes.plot(*zip((0.0, 0.0), reach, strict=True), **style.THIN)
        curve = np.radians(first + np.linspace(0.0, sweep, 61))
        arc = radius * np.stack([np.cos(curve), np.sin(curve)])
        axes.plot(*arc, **style.THIN)
        if turn.angle > 0.0:
            head = {"arrowstyle": "-|>", "shrinkA": 0.0, "shrinkB": 0.0, **style.THIN}
            axes.annotate("", tuple(arc[:, -1]), tuple(arc[:, -4]), arrowprops=head)
        axes.annotate(
            f"{number_text(float(np.degrees(turn.angle)), 'twist')}°",
            tuple(reach),
            xytext=(14.0 * np.cos(last), 6.0 * np.sin(last)),
            textcoords="offset points",
            ha="center",
            va="center",
        )
        axes.set_aspect("equal", adjustable="datalim")
        style.finish(axes, "bend to the right [deg]", "bend upwards [deg]")
    return axes


def _view(along: FloatArray) -> FloatArray:
    """Right and up across a shaft, seen along it."""
    up = np.array([0.0, 1.0, 0.0]) - along[1] * along
    # Along a shaft that points up, x is up.
    up = up if np.linalg.norm(up) > 1e-6 else np.array([1.0, 0.0, 0.0]) - along[0] * along
    up /= np.linalg.norm(up)
    return np.stack([np.cross(along, up), up])


def plot_hodograph(
    line: Driveline, joint: int = 0, *, load: Load | None = None, ax: Axes | None = None
) -> Axes:
    """Draw the path of what bends the shafts at a joint: its moment seen along either shaft.

    Both views have the normal of the bend plane upwards and the bend plane across. A single joint
    under a steady drive torque traces a circle on its driving side and an ellipse on its driven
    side (Grossmann's moments (6) and (8)), each twice in a turn, and once if the joint has
    deviations. Drive angles of half a turn are marked.

    Args:
        line: one driveline.
        joint: index of the joint.
        load: the load; by default 1 N m of drive torque, and the axes are per unit of it.

    Raises:
        IndexError: a joint that does not exist.
        ValueError: a batch, a load that does not fit.
    """
    style.check_single(line)
    item = item_index("joint", joint, line.n_joints)
    # A second time round would fill the gaps of the dashes.
    angle_deg, period = panel.period(line)
    given = Load(drive_torque=1.0) if load is None else load
    moment = line.evaluate(period, "moment", joints=item, load=given).moment
    normal = line.normals[item]
    with style.drawing(ax, height_mm=60.0) as axes:
        for i, side in enumerate(("driving", "driven")):
            across = np.cross(normal, line.directions[item + i])
            x, y = moment @ across, moment @ normal
            axes.plot(x, y, label=f"{side} shaft {item + i}", **style.LINES[i])
            axes.plot(
                x[panel.MARKS], y[panel.MARKS], style.MARKERS[i], color=style.LINES[i]["color"]
            )
            middle = np.array([np.ptp(x) / 2.0 + np.min(x), np.ptp(y) / 2.0 + np.min(y)])
            for mark in panel.MARKS:
                inwards = middle - (x[mark], y[mark])
                inwards /= max(float(np.linalg.norm(inwards)), 1e-300)
                point = np.array([x[mark], y[mark]])
                style.write_angle(axes, angle_deg[mark], point, np.array([13.0, 10.5]) * inwards)
        unit = " / drive torque" if load is None else " [N m]"
        axes.set_aspect("equal", adjustable="datalim")
        style.finish(axes, f"moment in the bend plane{unit}", f"moment across it{unit}")
    return axes

"""The tables of the page: inputs, results, the exact equivalent bend beside the catalogue rule."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from cardan.arrays import FloatArray
from cardan.driveline import Driveline
from cardan.figures.rounding import equivalent_bend_deg
from cardan.figures.summary import summary
from cardan.report.samples import NOMINAL_TORQUE, Samples
from cardan.scene.scene import Scene, SceneResult
from cardan.scene.units import RPM
from cardan.words.summary import figure_text, row_text
from cardan.workshop import VIEW, turn


class Table(NamedTuple):
    """What the macro ``table`` takes; the first cell of a row is its heading."""

    caption: str
    head: Sequence[str]
    rows: Sequence[Sequence[str]]


def inputs(scene: Scene) -> dict[str, Table]:
    """Return what the scene gives: joints, load and drive angles, shafts."""
    line = scene.line
    joints = [(f"joint {j}", _span(np.degrees(line.bends[..., j]))) for j in range(line.n_joints)]
    heads = ["Shaft"]
    shafts = [[f"shaft {i}"] for i in range(line.n_joints + 1)]
    if line.n_joints > 1:
        twists = line.twists.reshape(-1, line.n_joints - 1)
        # Recorded bends leave the yokes as they are.
        phases = line.phases.reshape(-1, line.n_joints - 1)[0]
        heads += [
            "Twist of bend planes [deg]",
            "Phase of yokes [deg]",
            f"Yokes, {VIEW}",
        ]
        for i, cells in enumerate(shafts):
            if 0 < i < line.n_joints:
                words = str(turn(phases[i - 1])).split(",")[0]
                cells += [
                    _span(np.degrees(twists[:, i - 1])),
                    _figure(np.degrees(phases[i - 1])),
                    words,
                ]
            else:
                cells += ["", "", ""]
    if not line.shape:
        heads += ["Direction x, y, z"]
        for cells, direction in zip(shafts, line.directions, strict=True):
            cells += [", ".join(f"{value + 0.0:.5f}" for value in direction)]
    load = scene.load_case
    if load is not None and load.inertias is not None:
        heads += ["Inertia [kg m²]"]
        for cells, inertia in zip(shafts, load.inertias, strict=True):
            cells += [_figure(inertia)]
    given = []
    if load is not None:
        torque = float(load.torque)
        given += [(f"Torque at the {load.end}", f"{_figure(torque)} N m")]
        rpm = scene.speed / RPM
        given += [("Speed of the drive", f"{_figure(scene.speed)} rad/s, {_figure(rpm)} rpm")]
        if scene.accelerates:
            given += [("Acceleration of the drive", f"{_figure(load.acceleration)} rad/s²")]
    known = scene.without_missing().drive_angle_deg
    left_out = f"; {scene.missing} missing samples are left out" if scene.missing else ""
    given += [("Drive angles", f"{_span(known)} deg, {len(known)} samples{left_out}")]
    if scene.recording is not None:
        given += [("Recorded in", scene.recording.name)]
    given += [
        (key.replace("_", " ").capitalize(), str(value)) for key, value in scene.options.items()
    ]
    return {
        "joints": Table("Joints", ("Joint", "Bend [deg]"), joints),
        "drive": Table("Load and drive", ("What", "Value"), given),
        "shafts": Table("Shafts", heads, shafts),
    }


def results(result: SceneResult, samples: Samples) -> list[Table]:
    """Return the scene's own table, the loads shaft by shaft and the harmonics."""
    rows = [(row.label[0].upper() + row.label[1:], row_text(row)) for row in summary(result)]
    found = [Table("Summary, as cardan run prints it", ("What", "Value"), rows)]
    torques = samples.result.values["torque"]
    loads = []
    for peak, torque in zip(samples.support_peaks(), torques, strict=True):
        at = "everywhere" if peak.at_deg is None else f"{peak.at_deg:.1f}"
        vector = ", ".join(map(_figure, peak.vector))
        loads.append((f"shaft {peak.item}", _span(torque), figure_text(peak.size), at, vector))
    per = f", per {NOMINAL_TORQUE:g} N m at the drive" if samples.nominal else ""
    caption = f"What the bearings give each shaft{per}"
    heads = [
        "Shaft",
        "Torque [N m]",
        "Largest support moment [N m]",
        "at drive angle [deg]",
        "its components x, y, z [N m]",
    ]
    found.append(Table(caption, heads, loads))
    line = result.scene.line
    if not line.shape:
        orders = (2, 4, 6)
        series = line.harmonics(orders)
        amplitudes = [
            (f"order {order}", f"{np.degrees(error):.3g}", f"{ratio:.3g}")
            for order, error, ratio in zip(
                orders, series.angle_error, series.speed_ratio, strict=True
            )
        ]
        heads = ["Order of the drive", "Angle error [deg]", "Speed ratio"]
        found.append(Table("Amplitudes of the last shaft's motion", heads, amplitudes))
    return found


def catalogue(scene: Scene) -> Table | None:
    """Return the exact equivalent bend beside what the catalogues' root rule makes of it.

    For one joint both are its bend, and there is no table.
    """
    line = scene.line
    if line.n_joints == 1:
        return None
    settings = {"as it is": line}
    if not line.shape:
        settings["set best"] = line.with_phases(line.optimal_phases())
    rows = []
    for name, set_so in settings.items():
        exact = np.asarray(set_so.equivalent().bend)
        if not line.shape:
            exact = np.radians(equivalent_bend_deg(set_so))
        signs, astray = _forks(set_so)
        rule = set_so.catalogue_bend(signs)
        figures = (exact, rule, rule - exact, np.max(astray))
        rows.append((name, *(_fixed(figure) for figure in figures)))
    heads = (
        "Yokes",
        "Exact [deg]",
        "Catalogue [deg]",
        "Catalogue less exact [deg]",
        "Forks off the rule by [deg]",
    )
    return Table("Equivalent bend", heads, rows)


def _forks(line: Driveline) -> tuple[FloatArray, FloatArray]:
    """Signs of the catalogue rule, (..., n), and how far forks are from what they say, in rad.

    Parallel yokes change the sign and crossed ones keep it, once the turn of the bend planes is
    taken off.
    """
    turned = line.phases - line.twists
    crossed = np.cos(2.0 * turned) < 0.0
    signs = np.cumprod(np.where(crossed, 1.0, -1.0), axis=-1)
    first = np.ones((*line.shape, 1))
    off = turned - np.where(crossed, np.pi / 2.0, 0.0)
    return np.concatenate([first, signs], axis=-1), np.abs(off - np.pi * np.round(off / np.pi))


def _figure(value: float | FloatArray) -> str:
    return figure_text(float(value) + 0.0)


def _fixed(angles: FloatArray | float) -> str:
    """An angle in degrees, or the least and the largest of several; what is rounding reads 0."""
    low, high = (f"{np.degrees(end) + 0.0:.4f}" for end in (np.min(angles), np.max(angles)))
    low, high = (end.removeprefix("-") if float(end) == 0.0 else end for end in (low, high))
    return low if low == high else f"{low} to {high}"


def _span(values: FloatArray | float) -> str:
    """A figure, or the least and the largest of several."""
    low, high = float(np.min(values)), float(np.max(values))
    if high - low <= 1e-9 * max(abs(low), abs(high)):
        return _figure(high)
    return f"{_figure(low)} to {_figure(high)}"

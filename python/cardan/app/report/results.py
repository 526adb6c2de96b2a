"""The tables of the page: inputs, results, the exact equivalent bend beside the catalogue rule."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import ArrayLike

from cardan.app.answers.answer import Answer
from cardan.app.answers.page import Table
from cardan.app.answers.printed import in_unit, kind_of, number_text, range_ends, with_unit
from cardan.app.answers.rounding import alike, is_cancelled
from cardan.app.answers.rows import UNITS, key_of
from cardan.app.answers.turn.figures import within_turn
from cardan.app.answers.yokes.figures import SHOWN, YokeFigures
from cardan.app.report.samples import PeakSample, Samples, deviates, equivalent, turn_motion
from cardan.app.scene.language.units import RPM, as_shown, shown_unit
from cardan.app.scene.scene import Scene
from cardan.app.scene.sections.driveline import has_lengths
from cardan.arrays import FloatArray
from cardan.evaluation.load import Load
from cardan.motion.workshop import VIEW, turn

# Shafts or joints that fit side by side on paper; more go below each other.
_MOST_COLUMNS = 7


# A low end of a range that is rounding beside the high one: bends go with the root of motions.
_NEGLIGIBLE = 1e-6

_SETTINGS = {"present": "as in the scene", "best": "best setting", "on_teeth": "on the teeth"}

# Names and values by shaft or joint.
_Columns = dict[str, list[tuple[str, str]]]


def inputs(scene: Scene) -> dict[str, Table | None]:
    """Return what the scene gives: joints, load and drive angles, shafts, bearings if any.

    Over states, ranges are those of all of them.
    """
    line = scene.drivelines() if scene.states else scene.line
    joints = [
        (f"joint {j}", _span(np.degrees(line.bends[..., j]), "deg")) for j in range(line.n_joints)
    ]
    shafts = {"Shaft": [f"shaft {i}" for i in range(line.n_joints + 1)]}
    if line.n_joints > 1:
        phases = line.phases.reshape(-1, line.n_joints - 1)
        for head, cells in (
            ("Twist of bend planes [deg]", _each(within_turn(line.twists), "twist")),
            ("Phase of yokes [deg]", _each(within_turn(phases), "phase")),
            (f"Output-side yoke, {VIEW}", map(_setting, phases.T)),
        ):
            shafts[head] = ["", *cells, ""]
    if scene.states or not line.shape:
        directions = line.directions.reshape(-1, line.n_joints + 1, 3)
        for axis, values in zip("xyz", directions.T, strict=True):
            shafts[f"Direction, {axis}"] = [_span(each, "direction") for each in values]
    load = scene.states.loads(scene.load_case) if scene.states else scene.load_case
    if has_lengths(line):
        lengths = _factor("mm") * line.lengths().each
        shafts[with_unit("Length", "mm")] = _each(lengths, shown_unit("mm"))
    if load is not None and load.inertias is not None:
        inertias = _factor("kgm2") * load.inertias
        shafts[with_unit("Inertia", "kgm2")] = _each(inertias, "given")
    bearings = {
        "Bearing": [f"bearing {number}" for number in range(line.n_bearings)],
        "Shaft": [f"{shaft}" for shaft, _ in line.bearings],
        with_unit("Position from its upstream end", "mm"): [
            _span(_factor("mm") * position, shown_unit("mm")) for _, position in line.bearings
        ],
        **_supports(scene),
    }
    return {
        "joints": Table("Joints", ("Joint", "Bend [deg]"), joints),
        "drive": Table("Load and drive", ("Input", "Value"), _drive(scene, load)),
        "shafts": Table("Shafts", [*shafts], [*zip(*shafts.values(), strict=True)]),
        "bearings": Table("Bearings", [*bearings], [*zip(*bearings.values(), strict=True)])
        if line.n_bearings
        else None,
    }


_SUPPORT = {
    "stiffness": ("Stiffness", "N_per_mm"),
    "axis": ("First direction", ""),
    "loss_factor": ("Loss factor", ""),
    "damping": ("Damping", "Ns_per_m"),
}


def _supports(scene: Scene) -> dict[str, list[str]]:
    """What makes bearings elastic, by the heads of columns; none if all are rigid."""
    supports = [each.support for each in scene.layout.mounting.bearings] if scene.layout else []
    found = {}
    for key, (label, unit) in _SUPPORT.items():
        if any(key in support for support in supports):
            values = [_factor(unit) * np.ravel(support.get(key, [])) for support in supports]
            cells = [", ".join(number_text(x, "given") for x in own) for own in values]
            missing = "rigid" if key == "stiffness" else ""
            found[with_unit(label, unit)] = [cell or missing for cell in cells]
    return found


def _factor(unit: str) -> float:
    """How many of the units in which something is shown are one of SI."""
    return UNITS[shown_unit(unit)].factor


def _each(columns: FloatArray, kind: str) -> list[str]:
    """A figure for each shaft, ``(..., shafts)``."""
    return [_span(column, kind) for column in columns.reshape(-1, columns.shape[-1]).T]


def _drive(scene: Scene, load: Load | None) -> list[tuple[str, str]]:
    given = []
    if load is not None:
        torque = _span(_factor("Nm") * _known(load.torque), "given")
        given += [(f"Torque at the {load.end}", in_unit([torque], shown_unit("Nm")))]
        speed = _known(load.speed)
        each = ((speed, "rad_s"), (speed / RPM, "rpm"))
        texts = [in_unit([_span(values, "measured")], unit) for values, unit in each]
        given += [("Speed of the drive", ", ".join(texts))]
        if scene.accelerates:
            acceleration = in_unit([_span(_known(load.acceleration), "measured")], "rad_s2")
            given += [("Acceleration of the drive", acceleration)]
    known = scene.without_missing().drive_angle_deg
    left_out = f"; {scene.missing} missing samples are left out" if scene.missing else ""
    given += [("Drive angles", f"{_angles(known)}, {len(known)} samples{left_out}")]
    driven = scene.without_missing().driven_angle_deg
    if driven is not None:
        given += [("Given as angles of the driven shaft", _angles(driven))]
    if scene.recording is not None:
        given += [("Recording", scene.recording.name)]
    given += [
        (key.replace("_", " ").capitalize(), str(value)) for key, value in scene.options.items()
    ]
    return given


def results(samples: Samples, answer: Answer) -> list[Table]:
    """Return motion and loads of every shaft, loads of joints and bearings, and the harmonics."""
    scene = samples.result.scene
    tables = [_motion(scene), _largest(samples, "shaft"), _largest(samples, "joint")]
    if any(peak.output.per == "bearing" for peak in samples.peaks):
        tables.append(_largest(samples, "bearing"))
    if not scene.line.shape:
        orders = (2, 4, 6)
        lines = scene.drivelines() if scene.states else scene.line
        series = lines.harmonics(orders)
        # What is left where the joints cancel is rounding of the geometry.
        single = lines if lines.shape else [lines]
        moved = np.array([not is_cancelled(line, line.equivalent()) for line in single])
        errors, ratios = (
            np.max(moved[:, None] * amplitudes.reshape(-1, len(orders)), axis=0)
            for amplitudes in (series.angle_error, series.speed_ratio)
        )
        amplitudes = [
            (
                f"order {order}",
                number_text(np.degrees(error), "angle_error"),
                number_text(ratio, ""),
            )
            for order, error, ratio in zip(orders, errors, ratios, strict=True)
        ]
        heads = ["Order of the drive's rotation", "Angle error [deg]", "Speed ratio"]
        largest = f", largest of {scene.states.count} states" if scene.states else ""
        of = " of the drawing" if deviates(scene) else ""
        caption = f"Harmonics of shaft {scene.line.n_joints}{of}: amplitudes{largest}"
        tables.append(Table(caption, heads, amplitudes))
    return tables


def _motion(scene: Scene) -> Table:
    line, speed = scene.line, np.asarray(scene.speed)
    if scene.states:
        line, load = scene.drivelines(), scene.states.loads(scene.load_case)
        if load is not None and not scene.speed_recorded:
            speed = load.speed
    columns: _Columns = {}
    for shaft in range(1, line.n_joints + 1):
        # Of recorded bends each sample is a driveline, too many to be searched as built.
        searched = scene if scene.states or not line.shape else replace(scene, deviations=None)
        joint, found = equivalent(line, shaft), turn_motion(searched, line, shaft)
        cells = [
            ("Equivalent bend [deg]", _span(np.degrees(joint.bend), "deg")),
            ("Largest angle error [deg]", _span(np.degrees(found.angle_error), "angle_error")),
            ("Non-uniformity U", _span(joint.non_uniformity, "")),
            ("Speed ratio", _span([found.slowest, found.fastest], "speed_ratio")),
        ]
        if np.any(speed):
            rpm = speed / RPM
            cells += [("Speed [rpm]", _span([found.slowest * rpm, found.fastest * rpm], "rpm"))]
        cells += [("Largest acceleration ratio", _span(found.acceleration, ""))]
        if np.any(speed):
            acceleration = found.acceleration * speed * speed
            cells += [("Largest acceleration [rad/s²]", _span(acceleration, "rad_s2"))]
        columns[f"shaft {shaft}"] = cells
    over = (
        "the bends of all samples" if scene.line.shape else "a whole turn at constant drive speed"
    )
    over += f" and {scene.states.count} states" if scene.states else ""
    return _table(f"Motion of the shafts over {over}", columns)


def _largest(samples: Samples, per: str) -> Table:
    """Return largest values of each shaft or joint; the motion of shafts has its own table."""
    scene = samples.result.scene
    columns: _Columns = {}
    states = scene.states is not None and scene.recording is None
    for peak in samples.peaks:
        if peak.output.per == per:
            columns.setdefault(f"{per} {peak.item}", []).extend(_cells(peak, states=states))
    count = len(scene.drive_angle_deg)
    over = f"of {count} recorded samples" if scene.recording else "over a whole turn"
    if scene.states and not scene.recording:
        over += f" and {scene.states.count} states"
    return _table(f"Loads of the {per}s, largest {over}{samples.assumed}", columns)


def _cells(peak: PeakSample, *, states: bool) -> list[tuple[str, str]]:
    size, unit = as_shown(np.array(peak.size), peak.output.unit)
    kind = kind_of(peak.output.name, shown_unit(key_of(peak.output.unit)))
    name = f"Largest {peak.output.label}"
    cells = [(f"{name} [{unit}]" if unit else name, number_text(float(size), kind))]
    cells += [
        (
            "at drive angle [deg]",
            "any" if peak.at_deg is None else number_text(peak.at_deg, "phase"),
        )
    ]
    if states:
        cells += [("in", peak.state or "all states")]
    if peak.vector is not None:
        parts = as_shown(np.asarray(peak.vector), peak.output.unit)[0].tolist()
        for axis, value in zip("xyz", parts, strict=True):
            cells += [(f"{axis} component there [{unit}]", number_text(value, kind))]
    return cells


def _table(caption: str, columns: _Columns) -> Table:
    """A column per shaft or joint, or a row where they are too many for the paper's width."""
    names = [name for name, _ in next(iter(columns.values()))]
    values = [[item, *(value for _, value in cells)] for item, cells in columns.items()]
    if len(columns) > _MOST_COLUMNS:
        return Table(caption, ("", *names), values)
    head, *rows = zip(*values, strict=True)
    return Table(
        caption, ("", *head), [(name, *row) for name, row in zip(names, rows, strict=True)]
    )


def catalogue(scene: Scene, yokes: YokeFigures | None) -> Table | None:
    """Compare the exact equivalent bend with the root rule of the catalogues.

    For one joint both are its bend, and there is no table. ``yokes`` is what ``yoke_settings``
    finds, if the scene has any.
    """
    line = scene.line
    if line.n_joints == 1:
        return None
    compared = []
    if yokes:
        for key, rule in vars(yokes.catalogue).items():
            if rule:
                words = " ".join("\N{MINUS SIGN}" if sign < 0 else "+" for sign in rule.fork_signs)
                exact = getattr(yokes.equivalent_bend_deg, key)
                compared.append((key, exact, rule.equivalent_bend_deg, rule.off_deg, words))
    else:
        signs, off = line.fork_signs()
        exact, by_rule = np.degrees((line.equivalent().bend, line.catalogue_bend(signs)))
        compared.append(("present", exact, by_rule, np.degrees(np.max(off)), ""))
    rows = [
        (
            _SETTINGS[key],
            *(_span(values, "deg") for values in (exact, by_rule, by_rule - exact)),
            _span(off, "phase"),
            words,
        )
        for key, exact, by_rule, off, words in compared
    ]
    heads = (
        "Yokes",
        "Exact [deg]",
        "Catalogue rule [deg]",
        "Rule minus exact [deg]",
        "Yokes differ from the rule's by up to [deg]",
        "Signs of the rule, joint by joint",
    )
    return Table("Equivalent bend", heads, rows)


def _setting(phases: FloatArray) -> str:
    """How the output-side yoke of a shaft is turned against the input-side one, if it stays so."""
    if np.ptp(phases) != 0.0:
        return ""
    found = turn(phases[0])
    degrees = float(np.degrees(found.angle))
    return f"{number_text(degrees, 'phase')}° {found.sense}" if degrees >= SHOWN else "in one plane"


def _known(values: FloatArray) -> FloatArray:
    """Values without those of missing samples."""
    return values[~np.isnan(values)]


def _angles(degrees: FloatArray) -> str:
    """The first and the last of drive angles, to a tenth of a degree where they were recorded."""
    ends = dict.fromkeys(
        number_text(round(float(end), 1), "given") for end in (np.min(degrees), np.max(degrees))
    )
    return f"{' to '.join(ends)} deg"


def _span(values: ArrayLike, kind: str) -> str:
    """A figure, or the least and the largest of several, with the digits of a kind."""
    low, high = float(np.min(values)), float(np.max(values))
    if abs(low) < _NEGLIGIBLE * abs(high):
        low = 0.0
    if alike(low, high):
        return number_text(high, kind)
    return " to ".join(range_ends(low, high, "measured" if kind == "given" else kind))

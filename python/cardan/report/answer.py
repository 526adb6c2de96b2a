"""The first section: does it run smoothly, what loads the bearings, how to set the yokes."""

from __future__ import annotations

import math
from html import escape

import numpy as np

from cardan.check import Check
from cardan.figures.limits import check_scene
from cardan.figures.rounding import equivalent_bend_deg
from cardan.figures.yokes import yoke_settings
from cardan.report.samples import NOMINAL_TORQUE, Samples
from cardan.scene.scene import Scene
from cardan.words.summary import figure_text, range_ends
from cardan.words.yokes import phases_text, yoke_lines

# Shafts that one reads in a list.
_MOST = 8


def section(scene: Scene, samples: Samples) -> str:
    """Return the three answers as HTML."""
    cards = {
        "Does it run smoothly?": _smooth(scene),
        "What loads the bearings?": _bearings(samples),
        "How to set the yokes?": _yokes(scene),
    }
    return (
        '<div class="cards">'
        + "".join(f"<section><h3>{heading}</h3>{body}</section>" for heading, body in cards.items())
        + "</div>"
    )


def _smooth(scene: Scene) -> str:
    line = scene.line
    found = check_scene(scene)
    parts = []
    if scene.study and scene.study.axes:
        kept, rows = np.count_nonzero(found.passes), math.prod(scene.study.shape)
        parts += [_verdict(found, f"{kept} of the study's {rows} drivelines keep all limits.")]
        parts += [
            _findings(found),
            "<p>The driveline as it stands, before the study varies it:</p>",
        ]
        found = line.check(scene.speed or None)
        parts += [_findings(found)]
    elif line.shape:
        kept = np.count_nonzero(found.passes)
        words = f"{kept} of {math.prod(line.shape)} recorded samples keep all limits."
        parts += [_verdict(found, words), _findings(found)]
    else:
        wrong = sum(not finding.passes for finding in found.findings)
        words = "It keeps all limits." if not wrong else "It is above "
        if wrong:
            words += f"{wrong} of {len(found.findings)} limits."
        parts += [_verdict(found, words), _findings(found)]
    if not line.shape:
        parts += [f"<p>{_motion(scene)}</p>"]
    if not scene.speed:
        parts += [_note("Without a speed in the scene the excitation cannot be checked.")]
    return "".join(parts)


def _verdict(found: Check, words: str) -> str:
    good = bool(np.all(found.passes))
    return (
        f'<p class="verdict {"good" if good else "bad"}">{"Yes" if good else "No"}. '
        f"{escape(words)}</p>"
    )


def _findings(found: Check) -> str:
    items = []
    for finding in found.findings:
        good = bool(np.all(finding.passes))
        mark = "\N{CHECK MARK}" if good else "\N{MULTIPLICATION SIGN}"
        items.append(f'<li class="{"good" if good else "bad"}">{mark} {escape(str(finding))}</li>')
    return f'<ul class="findings">{"".join(items)}</ul>'


def _motion(scene: Scene) -> str:
    line = scene.line
    if equivalent_bend_deg(line) == 0.0:
        return "The last shaft turns at constant velocity."
    joint = line.equivalent()
    error = figure_text(float(np.degrees(joint.max_angle_error)))
    slowest, fastest = range_ends(float(joint.min_speed_ratio), float(joint.max_speed_ratio))
    return (
        f"At steady drive the last shaft leads and lags by up to {error}°, twice per turn, at "
        f"{slowest} to {fastest} times the speed of the drive."
    )


def _bearings(samples: Samples) -> str:
    words = []
    if samples.nominal:
        words.append(
            f"The scene gives no torque and no inertia in motion. With {NOMINAL_TORQUE:g} N m put "
            "into the drive, and in proportion with more:"
        )
    peaks = list(samples.support_peaks())
    largest = max(peaks, key=lambda peak: peak.size)
    if largest.size == 0.0:
        return "<p>Nothing: no joint is bent, so no moment crosses the shafts.</p>"
    at = "at every angle" if largest.at_deg is None else f"at {largest.at_deg:.1f}° of drive angle"
    if samples.result.scene.recording is None and largest.at_deg is not None:
        at += " and again half a turn later"
    listed = sorted(sorted(peaks, key=lambda peak: -peak.size)[:_MOST], key=lambda peak: peak.item)
    items = "".join(
        f"<li>shaft {peak.item}: up to {figure_text(peak.size)} N m</li>" for peak in listed
    )
    if len(listed) < len(peaks):
        items += f"<li>the other {len(peaks) - len(listed)}: no more (table below)</li>"
    first = f"Most on shaft {largest.item}: {figure_text(largest.size)} N m across it, {at}."
    return (
        _note(*words)
        + f'<p class="verdict">{first}</p><ul>{items}</ul>'
        + "<p>Over the distance of a shaft's two bearings such a moment is the force on each; a "
        "shaft between two joints without bearings of its own takes it, over its length, as forces "
        "at its joints.</p>"
    )


def _yokes(scene: Scene) -> str:
    line = scene.line
    if line.n_joints == 1:
        return (
            "<p>One joint has no yokes to set against each other. A second joint of the same bend, "
            "set right, would undo its unevenness.</p>"
        )
    if line.shape:
        return "<p>The bends were recorded; yokes are set for fixed bends.</p>"
    data = yoke_settings(scene)
    bend = data["equivalent_bend_deg"]
    items = "".join(f"<li>{escape(words)}</li>" for words in yoke_lines(data))
    limits = "<p>Set so, it passes the check.</p>"
    if above := "".join(f"<li>{escape(words)}</li>" for words in data["above_limits"]):
        limits = f"<p>Set so, it does not pass the check:</p><ul>{above}</ul>"
    return (
        f"<p>Set the output-side yoke against the input-side one, {escape(data['view'])}:</p>"
        f"<ul>{items}</ul><p>Equivalent bend: {bend['present']:.4g}° as it is, "
        f"<strong>{bend['best']:.4g}° set so</strong>.</p>{limits}"
        f"<p>In the scene: <code>{phases_text(data)}</code></p>"
    )


def _note(*words: str) -> str:
    return "".join(f'<p class="note">{escape(text)}</p>' for text in words)

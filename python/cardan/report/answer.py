"""The first section: does it run smoothly, what loads the bearings, how to set the yokes."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from cardan.check import Check
from cardan.figures.limits import check_scene
from cardan.figures.rounding import equivalent_bend_deg
from cardan.figures.yokes import yoke_settings
from cardan.report.samples import Samples
from cardan.scene.scene import Scene
from cardan.words.summary import figure_text, range_ends
from cardan.words.yokes import phases_text, yoke_lines

# Shafts that one reads in a list.
_MOST = 8


def answer(scene: Scene, samples: Samples) -> dict[str, Any]:
    """Return the three answers as plain data for ``answer.html``."""
    return {"smooth": _smooth(scene), "bearings": _bearings(samples), "yokes": _yokes(scene)}


def _smooth(scene: Scene) -> dict[str, Any]:
    line = scene.line
    found = check_scene(scene)
    kept, unvaried = np.count_nonzero(found.passes), []
    if scene.study and scene.study.axes:
        verdict = f"{kept} of the study's {math.prod(scene.study.shape)} drivelines keep all limits"
        unvaried = _findings(line.check(scene.speed or None, scene.limits))
    elif line.shape:
        verdict = f"{kept} of {math.prod(line.shape)} recorded samples keep all limits"
    elif str(found.verdict) == "tolerable":
        verdict = "It is above a limit, but below every maximum"
    elif kept:
        verdict = "It keeps all limits"
    else:
        wrong = sum(not finding.passes for finding in found.findings)
        judged = sum(finding.limit is not None for finding in found.findings)
        verdict = f"It is above {wrong} of {judged} limits"
    return {
        "good": bool(np.all(found.passes)),
        "verdict": verdict,
        "findings": _findings(found),
        "unvaried": unvaried,
        "motion": "" if line.shape else _motion(scene),
        "speed": scene.speed,
    }


def _findings(found: Check) -> list[tuple[bool, str]]:
    return [(bool(np.all(finding.passes)), str(finding)) for finding in found.findings]


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


def _bearings(samples: Samples) -> dict[str, Any] | None:
    """The largest support moments; ``None`` where there are none."""
    peaks = list(samples.support_peaks())
    largest = max(peaks, key=lambda peak: peak.size)
    if largest.size == 0.0:
        return None
    place = "at every angle"
    if largest.at_deg is not None:
        place = f"at {largest.at_deg:.1f}° of drive angle"
        if samples.result.scene.recording is None:
            place += " and again half a turn later"
    listed = sorted(sorted(peaks, key=lambda peak: -peak.size)[:_MOST], key=lambda peak: peak.item)
    return {
        "shaft": largest.item,
        "size": figure_text(largest.size),
        "place": place,
        "listed": [(peak.item, figure_text(peak.size)) for peak in listed],
        "others": len(peaks) - len(listed),
    }


def _yokes(scene: Scene) -> dict[str, Any] | None:
    """The best settings; ``None`` for a single joint and for recorded bends."""
    if scene.line.n_joints == 1 or scene.line.shape:
        return None
    data = yoke_settings(scene)
    return {
        "view": data["view"],
        "lines": yoke_lines(data),
        "present": f"{data['equivalent_bend_deg']['present']:.4g}",
        "best": f"{data['equivalent_bend_deg']['best']:.4g}",
        "above_limits": data["above_limits"],
        "phases": phases_text(data),
    }

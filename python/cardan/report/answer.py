"""The first section: does it run smoothly, what loads the bearings, how to set the yokes."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from cardan.check import Check
from cardan.figures.yokes import yoke_settings
from cardan.report.samples import Samples
from cardan.report.tables import motion
from cardan.scene.scene import Scene
from cardan.words.summary import figure_text, range_ends
from cardan.words.yokes import phases_text, yoke_lines

# Shafts that one reads in a list.
_MOST = 8


def answer(scene: Scene, samples: Samples, found: Check) -> dict[str, Any]:
    """Return the three answers as plain data for ``answer.html``.

    Args:
        scene: the scene.
        samples: the same evaluated for the page.
        found: its check, as ``check_scene`` makes it.
    """
    return {
        "smooth": _smooth(scene, found),
        "bearings": _bearings(samples),
        "yokes": _yokes(scene),
    }


def _smooth(scene: Scene, found: Check) -> dict[str, Any]:
    line = scene.line
    within, unvaried = np.count_nonzero(found.passes), []
    if scene.study and scene.study.axes:
        total = math.prod(scene.study.shape)
        verdict = f"{within} of the study's {total} drivelines are within all limits"
        unvaried = findings(line.check(scene.speed or None, scene.limits))
    elif line.shape:
        verdict = f"{within} of {math.prod(line.shape)} recorded samples are within all limits"
    elif within:
        verdict = "It is within all limits"
    else:
        wrong = sum(not finding.passes for finding in found.findings)
        verdict = f"It exceeds {wrong} of {len(found.findings)} limits"
    return {
        "good": bool(np.all(found.passes)),
        "verdict": verdict,
        "findings": findings(found),
        "unvaried": unvaried,
        "motion": "" if line.shape else _motion(scene),
        "speed": scene.speed,
    }


def findings(found: Check) -> list[tuple[bool, str]]:
    """Return each finding of a check in words, and whether it is good."""
    return [(bool(np.all(finding.passes)), str(finding)) for finding in found.findings]


def _motion(scene: Scene) -> str:
    joint = motion(scene.line)
    if joint.bend == 0.0:
        return "The last shaft turns at the speed of the drive, without any variation."
    error = figure_text(float(np.degrees(joint.max_angle_error)))
    slowest, fastest = range_ends(float(joint.min_speed_ratio), float(joint.max_speed_ratio))
    return (
        f"At constant drive speed, the last shaft leads and lags the drive by up to {error}°, "
        f"twice per turn. Its speed varies from {slowest} to {fastest} times that of the drive."
    )


def _bearings(samples: Samples) -> dict[str, Any] | None:
    """The largest support moments; ``None`` where there are none."""
    peaks = samples.support_peaks()
    by_size = sorted(peaks, key=lambda peak: -peak.size)
    largest = by_size[0]
    if largest.size == 0.0:
        return None
    place = "at every drive angle"
    if largest.at_deg is not None:
        at = [largest.at_deg]
        if samples.result.scene.recording is None:
            # Every joint repeats its motion after half a turn.
            at = sorted(angle % 360.0 for angle in (at[0], at[0] + 180.0))
        place = f"at {' and '.join(f'{angle:.1f}°' for angle in at)} of drive angle"
    listed = sorted(by_size[:_MOST], key=lambda peak: peak.item)
    return {
        "assumed": samples.assumed,
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

"""The first section: does it run smoothly, what loads the bearings, how to set the yokes."""

from __future__ import annotations

from typing import Any

from cardan.app.answers.answer import Answer
from cardan.app.answers.drive_speed import heading, sentences
from cardan.app.answers.forces.figures import largest_text
from cardan.app.answers.forces.figures import sentences as missing_forces
from cardan.app.answers.limits import motion_of, verdict_text
from cardan.app.answers.page import CLASSES, judged_lines
from cardan.app.answers.printed import angle_text, quantity, range_ends
from cardan.app.answers.rows import worst_of
from cardan.app.answers.table import PARTS
from cardan.app.answers.tolerances.figures import sentences as tolerance_sentences
from cardan.app.answers.yokes.figures import YokeFigures, advice, limit_of
from cardan.app.answers.yokes.text import (
    BEST_OF_STATES,
    advice_text,
    arrangement_text,
    bend_text,
    phases_text,
    remedies,
    tooth_lines,
    yoke_lines,
)
from cardan.app.report.samples import Samples, deviates, turn_motion
from cardan.app.scene.scene import Scene
from cardan.design.check import Check
from cardan.design.judged import counted
from cardan.motion.workshop import SAME_YOKE

# Shafts that one reads in a list.
_MOST = 8

# Speed ratios that differ by less differ by rounding.
_EVEN = 1e-14

_SMOOTH = {
    "within": "Yes",
    "tolerable": "Tolerably",
    "beyond": "No",
    "not judged": "Unknown",
}

_SETTINGS = {"present": "now", "best": "with this setting", "on_teeth": "on the best teeth"}


def first_answer(answer: Answer, samples: Samples, yokes: YokeFigures | None) -> dict[str, Any]:
    """Return the three answers as plain data for ``answer.html``."""
    scene, drive_speed, forces = answer.scene, answer["drive_speed"], answer["forces"]
    spline, tolerances = answer["spline"], answer["tolerances"]
    # Of more joints the yokes say it.
    has_one_bend = scene.line.n_joints == 1 and not scene.line.shape
    return {
        "verdict": verdict_of(answer),
        "smooth": _smooth(answer),
        "bearings": _bearings(samples),
        "yokes": _yokes(yokes) if yokes else None,
        "no_yokes": (
            "The states set the yokes themselves, so no setting can serve all of them."
            if scene.states
            else "The bends vary along the recording. Yoke settings are given for fixed bends only."
        ),
        "remedies": remedies(advice(scene.line, limit_of(scene))) if has_one_bend else [],
        "drive_speed": drive_speed
        and {"heading": heading(drive_speed), "words": list(sentences(drive_speed))},
        "forces": [*filter(None, [largest_text(forces)]), *missing_forces(forces)]
        if forces
        else [],
        "spline": ""
        if spline is None or spline.force is None
        else f"The spline of shaft {spline.shaft} adds an axial force of up to "
        f"{quantity(spline.force, 'N')} while it slides.",
        "toleranced": list(tolerance_sentences(tolerances)) if tolerances else [],
    }


def verdict_of(answer: Answer) -> dict[str, str]:
    """Return the one verdict for the top of a page."""
    words = verdict_text(answer)
    return {"word": answer.verdict, "class": CLASSES[answer.verdict], "words": words}


def _smooth(answer: Answer) -> dict[str, Any]:
    scene, found, part = answer.scene, answer.check, PARTS["limits"]
    judged = [entry for entry in part.entries(answer["limits"]) if entry.row.limit]
    verdict = worst_of(entry.value.verdict for entry in judged if entry.value)
    line, unvaried = scene.line, []
    # The verdict on everything, above, may differ.
    words = f"{_SMOOTH[verdict]}. {found.heading.replace('The driveline', 'The motion')}"
    if scene.study and scene.study.axes:
        words = f"Drivelines of the study: {counted(found.ranks)}."
        alone = motion_of(scene, line.check(scene.speed or None, scene.limits))
        unvaried = judged_lines(part.entries(alone))
    elif scene.states:
        words = f"States: {counted(found.ranks)}."
    elif line.shape:
        words = f"Recorded samples: {counted(found.ranks)}."
    return {
        "class": CLASSES[verdict],
        "verdict": words,
        "figures": judged_lines(judged),
        "unvaried": unvaried,
        "motion": "" if line.shape else _motion(scene, found),
    }


def _motion(scene: Scene, check: Check) -> str:
    """How the last shaft turns, over states in the one with the largest equivalent bend."""
    line, place = scene.line, ""
    if scene.states:
        bend = next(one for one in check.findings if one.figure == "equivalent_bend")
        line = scene.states.driveline(scene.states.names.index(bend.worst_in))
        place = f", in {bend.worst_in}"
    found = turn_motion(scene, line, line.n_joints)
    if found.fastest - found.slowest <= _EVEN:
        return "The last shaft turns at the speed of the drive, without any variation."
    error = quantity(float(found.angle_error), "deg", digits="angle_error")
    slowest, fastest = range_ends(float(found.slowest), float(found.fastest), "speed_ratio")
    often = "" if deviates(scene) else ", twice per turn"
    return (
        f"At constant drive speed, the last shaft leads and lags the drive by up to "
        f"{error}{often}{place}. Its speed varies from {slowest} to {fastest} times that of the "
        "drive."
    )


def _bearings(samples: Samples) -> dict[str, Any] | None:
    """The largest support moments; ``None`` where there are none."""
    peaks = [peak for peak in samples.peaks if peak.output.name == "support_moment"]
    by_size = sorted(peaks, key=lambda peak: -peak.size)
    largest = by_size[0]
    if largest.size == 0.0:
        return None
    place = "at every drive angle"
    if largest.at_deg is not None:
        at = [largest.at_deg]
        scene = samples.result.scene
        if scene.recording is None and not deviates(scene):
            # Every ideal joint repeats its motion after half a turn.
            at = sorted(angle % 360.0 for angle in (at[0], at[0] + 180.0))
        place = (
            f"at {' and '.join(angle_text(angle, radians=False) for angle in at)} of drive angle"
        )
    scene = samples.result.scene
    if scene.states:
        place += f", in {largest.state}" if largest.state else ", with the points of [driveline]"
    listed = sorted(by_size[:_MOST], key=lambda peak: peak.item)
    return {
        "assumed": samples.assumed,
        "shaft": largest.item,
        "size": quantity(largest.size, "Nm"),
        "place": place,
        "listed": [(peak.item, quantity(peak.size, "Nm")) for peak in listed],
        "others": len(peaks) - len(listed),
    }


def _yokes(found: YokeFigures) -> dict[str, Any]:
    bends, is_over_states = vars(found.equivalent_bend_deg), found.states is not None
    return {
        "view": found.view,
        "same": SAME_YOKE,
        "arrangement": arrangement_text(found),
        "lines": yoke_lines(found),
        # The first line is the heading of the others.
        "teeth": [line.removeprefix("- ") for line in tooth_lines(found)],
        "of": "Largest equivalent bend of all states" if is_over_states else "Equivalent bend",
        "bends": [
            (_SETTINGS[key], bend_text(found, bend))
            for key, bend in bends.items()
            if bend is not None
        ],
        "advice": " ".join([BEST_OF_STATES] * is_over_states + [advice_text(found)]),
        "tried": "On these teeth" if found.teeth else "With this setting",
        "above_limits": found.above_limits,
        "phases": phases_text(found),
    }

"""The motion of a scene's driveline, of all of its study or of its states, beside its limits."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from cardan.app.answers.answer import Answer
from cardan.app.answers.printed import bullets, judged_text, listed
from cardan.app.answers.rows import UNITS, Judged, count, figure, item, parts, word
from cardan.app.answers.table import PARTS
from cardan.app.scene.scene import Scene
from cardan.design.check import Check
from cardan.design.judged import VERDICTS, Finding, non_uniformity
from cardan.design.limits import CATALOGUE
from cardan.design.quantities import label
from cardan.design.wrapping import fill

# Findings have their own units; figures are in SI.
_UNITS = {"deg": UNITS["deg"].factor, "rad/s²": 1.0}


@dataclass(frozen=True)
class SpeedLimits:
    """The drive speeds up to which an excitation keeps its limit and its maximum."""

    excitation: str = item("excitation")
    within_up_to: float = figure("within up to", "rpm", "drive speed", rounds="down")
    tolerable_up_to: float | None = figure("tolerable up to", "rpm", "drive speed", rounds="down")


@dataclass(frozen=True)
class Counts:
    """How many states, drivelines of a study or recorded samples have which verdict."""

    counted: str = word("counted", "states, drivelines of a study or recorded samples")
    within: int = count("within")
    tolerable: int = count("tolerable")
    beyond: int = count("beyond")
    not_judged: int = count("not judged")


@dataclass(frozen=True)
class MotionFigures:
    """The motion of a driveline beside its limits, the worst of its states or its study."""

    preset: str | None = word("preset", "kinds of machine or makers whose limits apply")
    equivalent_bend: Judged = figure(
        "equivalent bend",
        "deg",
        "bend of the single joint that turns the last shaft as unevenly",
        source="catalogue, double joint, 6.4; exact by the product of the joints' maps",
        limit="[limits] equivalent_bend_deg",
    )
    non_uniformity: float | None = figure(
        "non-uniformity", "", "of a joint with the equivalent bend", source="tan(bend) sin(bend)"
    )
    bend_difference: Judged | None = figure(
        "bend difference",
        "deg",
        "difference of the bends of a driveline of two joints",
        limit="[limits] bend_difference_deg",
    )
    torsional_excitation: Judged | None = figure(
        "torsional excitation",
        "rad_s2",
        "peak acceleration of the last shaft at constant drive speed",
        limit="[limits] torsional_excitation_rad_s2",
    )
    inertia_excitation_driving: Judged | None = figure(
        "inertia excitation, driving",
        "rad_s2",
        "second-order amplitude of the accelerations of all shafts between two joints",
        limit="[limits] inertia_excitation_rad_s2",
    )
    inertia_excitation_coasting: Judged | None = figure(
        "inertia excitation, coasting",
        "rad_s2",
        "the same seen from the output",
        limit="[limits] inertia_excitation_rad_s2",
    )
    speeds: tuple[SpeedLimits, ...] = parts(
        "Drive speeds up to which limits are kept", "excitations grow with the square of the speed"
    )
    counts: Counts | None = parts("Verdicts on the motion", "of several drivelines")


def find(answer: Answer) -> MotionFigures:
    """Return the motion of a scene beside its limits."""
    return motion_of(answer.scene, answer.check)


def motion_of(scene: Scene, found: Check) -> MotionFigures:
    """Return what a check found of drivelines of a scene."""
    found = found.motion
    judged: dict[str, Any] = dict.fromkeys(FIGURES)
    judged |= {each.figure: judged_of(each, scene) for each in found.findings}
    bend = judged["equivalent_bend"].value
    given = scene.limits.figures.get("bend_difference_deg")
    if given and judged["bend_difference"] is None:
        limit = math.radians(given.limit)
        why = f"is that of two joints; the driveline has {scene.line.n_joints}"
        judged["bend_difference"] = Judged(None, limit, source=given.source, why=why)
    return MotionFigures(
        ", ".join(found.limits.presets) or None,
        non_uniformity=None if bend is None else non_uniformity(math.degrees(bend)),
        speeds=tuple(_speeds(found)),
        counts=_counts(found, scene) if found.ranks.shape else None,
        **judged,
    )


FIGURES = (
    "equivalent_bend",
    "bend_difference",
    "torsional_excitation",
    "inertia_excitation_driving",
    "inertia_excitation_coasting",
)
"""The judged figures of the motion."""


def judged_of(finding: Finding, scene: Scene) -> Judged:
    """Return a finding as the figure of an answer, where it is worst."""
    factor = _UNITS[finding.unit]
    values = np.asarray(finding.value) / factor
    known, why = values[np.isfinite(values)], ""
    if finding.needs_speed:
        why = "needs a speed, and the scene gives none"
    elif finding.is_undecided:
        why = finding.why
    elif known.size < values.size:
        unknown = values.size - known.size
        why = f"is not a number{f' in {unknown} drivelines' if values.size > 1 else ''}"
    limit = finding.there
    each = {}
    if scene.states and not finding.needs_speed:
        each = dict(zip(scene.states.names, map(float, values), strict=True))
    value = float(np.max(known)) if known.size else None
    if known.size and not math.isnan(finding.worst):
        # What rounding leaves is 0.
        value = finding.worst / factor
    return Judged(
        value,
        limit.limit / factor if limit else None,
        limit.maximum / factor if limit and limit.maximum > limit.limit else None,
        sense="most" if finding.most else "least",
        source=limit.source if limit else "",
        state=finding.worst_in if finding.largest_text else "",
        at=finding.worst_at if finding.largest_text else {},
        each=each,
        why=why,
    )


def _speeds(found: Check) -> Sequence[SpeedLimits]:
    speeds = []
    for each in found.findings:
        if each.limit is not None and each.at_unit_speed is not None:
            ends = (each.within_up_to, each.tolerable_up_to)
            within, tolerable = (float(np.min(end, initial=math.inf)) for end in ends)
            # Rounding noise is reached at no speed of a machine.
            if within * UNITS["rpm"].factor < 1e7:
                speeds.append(
                    SpeedLimits(
                        label(each.figure), within, tolerable if tolerable > within else None
                    )
                )
    return speeds


def _counts(found: Check, scene: Scene) -> Counts:
    numbers = {name: int(np.sum(found.ranks == rank)) for rank, name in enumerate(VERDICTS)}
    unknown = numbers["not judged"] + numbers["unknown"]
    of_study = scene.study is not None and scene.study.axes
    what = "states" if scene.states else "drivelines" if of_study else "samples"
    return Counts(what, numbers["within"], numbers["tolerable"], numbers["beyond"], unknown)


# More are counted in the first sentence.
_NAMED = 3


def verdict_text(answer: Answer) -> str:
    """Return the verdict on everything that has a limit in one sentence."""
    found = answer.of_verdict(answer.verdict)
    # By several presets a figure can have several limits.
    names = [*dict.fromkeys(f"the {each.name}" for each in found if each.value.limit is not None)]
    if len(names) > _NAMED + 1:
        names = [*names[:_NAMED], f"{len(names) - _NAMED} more"]
    if answer.verdict == "beyond":
        return f"Beyond {'its limit' if len(names) == 1 else 'their limits'}: {listed(names)}."
    if answer.verdict == "tolerable":
        return f"Tolerable, above the limit but below the maximum: {listed(names)}."
    if answer.verdict == "within":
        return "Everything that has a limit is within it."
    if names:
        return f"Not judged, although there is a limit: {listed(names)}."
    return "Nothing is judged: the scene gives no limit."


def findings(answer: Answer, verdict: str) -> Iterator[str]:
    """Say of each figure with a verdict what it is, where, and by how much it misses its limit."""
    for each in answer.of_verdict(verdict):
        if each.value.value is not None:
            source = each.value.source
            default = "default: " if source == CATALOGUE.source else ""
            yield f"{each.name}: {judged_text(each.value, each.entry.row)} ({default}{source})"


def not_judged(answer: Answer) -> Iterator[str]:
    """Say what is not judged and why: what has a limit one by one, what has none together."""
    without: dict[str, list[str]] = {}
    said = set()
    for each in answer.of_verdict("not judged"):
        if each.value.limit is not None:
            text = f"{each.name}: {each.value.why or 'it is not a number'}"
            if each.part.name == "presets":
                # Several sources limit the same bends.
                text += f" ({each.value.source})"
            if text not in said:
                yield text
            said.add(text)
        elif each.value.value is not None:
            without.setdefault(each.entry.row.limit, []).append(each.name)
    if without:
        keys = [
            f"{names[0]}{f' and {len(names) - 1} more' if len(names) > 1 else ''} ({key})"
            for key, names in without.items()
        ]
        yield f"no limit is given for: {'; '.join(keys)}"


def check_text(answer: Answer, advice: Sequence[str] = ()) -> str:
    """Return the verdict, what makes it, what would help and every part, as plain text, 79 wide."""
    lists = {
        "Beyond": list(findings(answer, "beyond")),
        "Tolerable": list(findings(answer, "tolerable")),
        "What would help": list(advice),
        "Not judged": list(not_judged(answer)),
    }
    blocks = [fill(verdict_text(answer), 79)]
    for heading, sentences in lists.items():
        blocks += ["\n".join([heading, *bullets(sentences)])] if sentences else []
    parts = (PARTS[part.name].text(found, brief=True) for part, found in answer.parts("check"))
    return "\n\n".join([*blocks, *filter(None, parts)])

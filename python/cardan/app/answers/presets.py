"""The bends of a scene's joints beside published limits, and which presets allow them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from cardan.app.answers.answer import FROM_THE_WORST, Answer
from cardan.app.answers.limits import judged_of
from cardan.app.answers.printed import bound_of, capital, listed, place_of, quantity
from cardan.app.answers.rows import Judged, Row, figure, item, parts, word
from cardan.app.scene.scene import Scene
from cardan.design.check import Check
from cardan.design.limits import PRESETS
from cardan.design.quantities import label

_UNITS = {"deg": "deg", "rad/s²": "rad_s2"}


@dataclass(frozen=True)
class JointBend:
    """A joint beside the limits of one preset."""

    joint: int = item("joint")
    bend: Judged | None = figure("bend", "deg", "of the joint", limit="[limits] preset")
    least: Judged | None = figure(
        "least bend", "deg", "of the joint, whose needles must roll", limit="[limits] preset"
    )


@dataclass(frozen=True)
class BendDifference:
    """The bends of some joints beside the limit of one preset on their difference."""

    joints: str = item("joints")
    difference: Judged | None = figure(
        "bend difference",
        "deg",
        "of two joints; of three those beside the odd one",
        limit="[limits] preset",
    )


@dataclass(frozen=True)
class PresetFigures:
    """Figures that one preset limits; those of the motion are judged with it."""

    preset: str = item("preset")
    verdict: str = word("verdict", "the worst of all that the preset limits")
    against: str | None = word(
        "against it", "the figures that make its verdict, if it is not within", is_detail=True
    )
    rule: str = word("rule", "as its source has it", is_detail=True)
    joints: tuple[JointBend, ...] = parts("Joints", is_detail=True)
    differences: tuple[BendDifference, ...] = parts("Differences", is_detail=True)


def find(answer: Answer) -> tuple[PresetFigures, ...]:
    """Return what each preset says; nothing of one alone that limits the motion."""
    check = answer.check
    if not check.published.findings and len(check.limits.presets) < 2:
        return ()
    pairs = dict.fromkeys(
        each.item for each in check.published.findings if each.figure == "bend_difference"
    )
    found = check.of_presets.items()
    return tuple(_preset(name, own, answer.scene, [*pairs]) for name, own in found)


def _preset(name: str, found: Check, scene: Scene, pairs: Sequence[str]) -> PresetFigures:
    own: dict[tuple[str, str], Judged] = {}
    said: dict[str, list[str]] = {}
    for each in found.findings:
        if not each.applies:
            continue
        value = judged_of(each, scene)
        about = f"{label(each.figure)} of {each.item}" if each.item else label(each.figure)
        if each.preset:
            own[each.figure, each.item] = value
        said.setdefault(value.verdict, []).append(_words(about, value, _UNITS[each.unit]))
    verdict = next((word for word in FROM_THE_WORST if word in said), "not judged")
    return PresetFigures(
        name,
        verdict,
        None if verdict == "within" else "; ".join(said[verdict]),
        "; ".join(rule.own for rule in PRESETS[name].rules),
        tuple(
            JointBend(
                joint,
                own.get(("bend", f"joint {joint}")),
                own.get(("least_bend", f"joint {joint}")),
            )
            for joint in range(scene.line.n_joints)
        ),
        tuple(BendDifference(pair, own.get(("bend_difference", pair))) for pair in pairs),
    )


def _words(about: str, value: Judged, unit: str) -> str:
    if value.verdict == "not judged":
        return f"the {about} {value.why or 'is not a number'}"
    where, bound = place_of(value), bound_of(value, Row("figure", "", unit))
    return f"the {about} is {quantity(value, unit)}{where}, {bound}"


def sentences(found: Sequence[PresetFigures]) -> Iterator[str]:
    """Say which presets allow the driveline, and what the others have against it."""
    titles = {
        verdict: [PRESETS[each.preset].title for each in found if each.verdict == verdict]
        for verdict in FROM_THE_WORST
    }
    allowing = [*titles["within"], *(f"{title} (tolerable)" for title in titles["tolerable"])]
    is_one = len(found) == 1
    if allowing or not is_one:
        yield capital(f"allowed by {listed(allowing)}." if allowing else "allowed by none.")
    for each in found:
        if each.verdict in ("beyond", "not judged"):
            start = "Not allowed by" if is_one else "Not by"
            start = start if each.verdict == "beyond" else "Not judged for"
            yield f"{start} {PRESETS[each.preset].title}: {each.against}."

"""What an inclinometer has shown, and how certain the verdict on it is."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from cardan.app.answers.answer import Answer
from cardan.app.answers.printed import given, number_text, quantity
from cardan.app.answers.rows import figure, item, numbers, parts, word
from cardan.app.scene.machine import moving
from cardan.app.scene.scene import Scene
from cardan.app.scene.sections.driveline import READINGS
from cardan.app.scene.study.states import States
from cardan.arrays import FloatArray
from cardan.design.limits import PRESETS
from cardan.design.machine import RANKS, MachineFigure
from cardan.driveline import Driveline
from cardan.geometry.constructors import spread_evenly

# Drivelines that the gauge may hide, which gives shares to about half a percent.
_SAMPLES = 1000

# Parts that are judged as read, because they have drivelines of their own.
_AS_READ = {
    "duty": "life",
    "slip": "spline",
    "torsion": "torsional vibration",
    "lateral": "lateral vibration",
    "tolerances": "tolerances",
}


@dataclass(frozen=True)
class WorkingAngle:
    """The angle of one joint as read, and what the gauge may hide."""

    joint: int = item("joint")
    bend: float = figure("working angle", "deg")
    least: float | None = figure("at least", "deg", "of what the gauge may hide", rounds="down")
    largest: float | None = figure("at most", "deg", "of what the gauge may hide", rounds="up")


@dataclass(frozen=True)
class ReadingFigures:
    """A driveline as an inclinometer has shown it."""

    inclinations: tuple[float, ...] = numbers("inclinations", "deg", "upwards to the output")
    angles: tuple[WorkingAngle, ...] = parts("Working angles")
    gauge: float | None = figure("each reading may be off by", "deg")
    within: float | None = figure(
        "within the limits",
        "percent",
        "share of what the gauge may hide in which everything is within its limits",
        source="1000 drivelines with errors of the readings spread evenly up to the accuracy",
        digits="share",
    )
    acceptable: float | None = figure(
        "within or tolerable",
        "percent",
        "the same with what is tolerable, where that is more",
        digits="share",
    )
    decides: str | None = word("decided by", "what is most often not within its limits")
    as_read: str = word("judged as read", "what has a limit and is not part of these shares")


def find(answer: Answer) -> ReadingFigures | None:
    """Return what was read of a driveline; ``None`` of one that is described otherwise."""
    scene = answer.scene
    if not scene.is_measured:
        return None
    assert scene.layout is not None
    read = np.radians(np.asarray(scene.layout.driveline[READINGS], float))
    bends = scene.line.bends
    if scene.gauge_deg is None:
        angles = (WorkingAngle(joint, float(bend), None, None) for joint, bend in enumerate(bends))
        return ReadingFigures(tuple(read.tolist()), tuple(angles), None, None, None, None, "")
    off = scene.gauge_deg * spread_evenly(_SAMPLES, len(read))
    (drawn,) = _hidden(scene, off, None)
    least, largest = drawn.bends.min(axis=0), drawn.bends.max(axis=0)
    ends = zip(bends.tolist(), least.tolist(), largest.tolist(), strict=True)
    ranks, decides = _judged(scene, [*_hidden(scene, off, scene.states)])
    within, acceptable = (
        None if ranks is None else float(np.mean(ranks <= RANKS.index(rank)))
        for rank in ("within", "tolerable")
    )
    return ReadingFigures(
        tuple(read.tolist()),
        tuple(WorkingAngle(joint, *each) for joint, each in enumerate(ends)),
        float(np.radians(scene.gauge_deg)),
        within,
        None if acceptable == within else acceptable,
        decides,
        ", ".join(_as_read(answer)),
    )


def _as_read(answer: Answer) -> Iterator[str]:
    """What has a limit that no driveline of those that the gauge may hide is judged by."""
    rules = [rule for name in answer.scene.limits.presets for rule in PRESETS[name].on_bends]
    if not all(rule.holds_always for rule in rules):
        yield "published limits on more than bends and their difference"
    yield from (name for part, name in _AS_READ.items() if getattr(answer.scene, part) is not None)


def _hidden(scene: Scene, off: FloatArray, states: States | None) -> Iterator[Driveline]:
    """The drivelines that the gauge may hide, of the drawing or in every state."""
    layout = scene.layout
    assert layout is not None
    axes, count = (states.axes, states.count) if states else ((), 1)
    values = layout.values(axes, count)
    for state in range(count):
        own = {key: value[state] for key, value in values.items()}
        yield layout.of({**own, READINGS: own[READINGS] + off})


def _judged(scene: Scene, hidden: list[Driveline]) -> tuple[FloatArray | None, str | None]:
    """The worst rank of every driveline, and which figure is most often not within."""
    worst = np.zeros(_SAMPLES, int)
    often: dict[str, int] = {}
    for state, lines in enumerate(hidden):
        load = scene.states.load(state) if scene.states else scene.load_case
        for each in moving(scene, lines, load).figures():
            if np.isnan(each.limit):
                continue
            # What cannot be judged is not within.
            ranks = np.where(each.ranks == RANKS.index("not judged"), len(RANKS), each.ranks)
            worst = np.maximum(worst, ranks)
            past = int(np.count_nonzero(ranks > RANKS.index("within")))
            often[_name(each)] = often.get(_name(each), 0) + past
    if not often:
        return None, None
    name = max(often, key=lambda each: often[each])
    return worst, name if often[name] else None


def _name(each: MachineFigure) -> str:
    name = each.kind.name.replace("_", " ")
    return name if each.item is None else f"{name} of {each.kind.per} {each.item}"


def _reading(inclination: float) -> str:
    way = "up" if inclination > 0.0 else "down"
    return f"{given(abs(inclination), 'deg')} {way}" if inclination else "level"


def sentences(found: ReadingFigures) -> Iterator[str]:
    """Say what was read, how certain the verdict is, and where the gauge is too coarse."""
    read = ", ".join(map(_reading, found.inclinations))
    yield f"Read towards the output, shaft by shaft: {read}."
    if found.gauge is None:
        return
    off = given(found.gauge, "deg")
    if found.within is not None:
        share = number_text(100.0 * found.within, "share")
        text = f"Everything is within its limits for {share}% of what the gauge may hide"
        if found.within == 1.0:
            text = "Everything is within its limits, whatever the gauge may hide"
        elif found.within == 0.0:
            text = f"Whatever the gauge may hide, the {found.decides} is not within its limit"
        elif found.decides:
            text += f"; else it is most often the {found.decides} that is not"
        yield f"{text}. Each reading may be off by {off} on its own."
    for each in found.angles:
        if each.bend < found.gauge:
            yield (
                f"The gauge may hide more than the working angle of joint {each.joint}, "
                f"{quantity(each.bend, 'deg')}; if that matters, read shafts {each.joint} and "
                f"{each.joint + 1} again with a finer one."
            )

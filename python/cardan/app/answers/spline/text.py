"""How the spline of a scene is used, in words."""

from __future__ import annotations

from collections.abc import Iterator

from cardan.app.answers.spline.figures import Limited, SlipFigures
from cardan.app.answers.study.extremes import End
from cardan.app.answers.study.text import place_text
from cardan.app.answers.turn.text import aligned, figure_text
from cardan.design.wrapping import fill


def slip_text(found: SlipFigures) -> str:
    """Return the figures of a spline and what follows from them as plain text, 79 wide."""
    lines = aligned(slip_lines(found), indent="  ")
    words = [fill(text, 79) for text in slip_sentences(found)]
    return "\n".join([f"Spline of shaft {found.slip.shaft}", lines, "", *words])


def slip_lines(found: SlipFigures) -> list[tuple[str, str]]:
    """Return the figures as pairs of what a line is about and its figures."""
    lines = [("length at the points of the scene", _mm(found.length))]
    if found.drivelines > 1:
        lines += [
            ("shortest length", _placed(found.shortest)),
            ("longest length", _placed(found.longest)),
            ("travel", _judged(found.travel, "at most")),
        ]
    if found.engaged.value is not None:
        least = "least engaged length" if found.drivelines > 1 else "engaged length"
        lines += [(least, _judged(found.engaged, "at least"))]
    if found.push_in.value is not None:
        lines += [("left to push in", _mm(found.push_in.value))]
    if found.torque is not None and found.force is not None:
        torque = f"{figure_text(found.torque.value)} N m{_at(found.torque)}"
        lines += [
            ("largest torque of the shaft", torque),
            ("largest axial force", f"{figure_text(found.force)} N"),
        ]
    lines += [
        (
            f"on shaft {support.shaft}, {support.side}",
            f"{figure_text(support.axial)} N along it, {figure_text(support.transverse)} N across",
        )
        for support in found.supports
    ]
    lines += [
        (f"added to bearing {load.bearing}, shaft {load.shaft}", f"{figure_text(load.force)} N")
        for load in found.bearings
    ]
    return lines


def slip_sentences(found: SlipFigures) -> Iterator[str]:
    """Say whether the spline suffices, what to change if not, and what the force loads."""
    yield from _verdict(found)
    for shaft, travel in found.others:
        yield (
            f"Shaft {shaft} changes its length by {_mm(travel)} as well, but the spline is in "
            f"shaft {found.slip.shaft}. Move both ends of shaft {shaft} together, or give it a "
            "spline."
        )
    if found.slip.friction is not None and found.torque is None:
        yield "The axial force is not computed: the section [load] gives no torque and no inertia."
    if found.supports:
        first, last = (support.shaft for support in found.supports)
        yield (
            "The axial force acts while the spline slides under torque: it pulls when the shaft "
            "becomes longer and pushes when it becomes shorter. The part along shafts "
            f"{first} and {last} loads their thrust bearings."
        )
    if found.supports and not found.bearings:
        yield (
            "The part across acts at the joint: with the distance a from the joint to the nearer "
            "bearing and b between the bearings, it adds (a + b)/b of itself to the nearer bearing "
            "and a/b to the other."
        )


def _verdict(found: SlipFigures) -> Iterator[str]:
    faults = []
    if found.travel.verdict == "beyond":
        assert found.travel.value is not None
        assert found.travel.limit is not None
        more = found.travel.value - found.travel.limit
        faults.append(f"its travel exceeds the permitted one by {_mm(more)}")
    if found.engaged.verdict == "beyond":
        assert found.engaged.value is not None
        assert found.engaged.limit is not None
        if found.engaged.value <= 0.0:
            faults.append(f"it comes apart{_at(found.longest)}")
        else:
            less = found.engaged.limit - found.engaged.value
            faults.append(f"{_mm(less)} of engaged length are missing{_at(found.longest)}")
    if found.push_in.verdict == "beyond":
        assert found.push_in.value is not None
        faults.append(f"it bottoms {_mm(-found.push_in.value)} too early{_at(found.shortest)}")
    if faults:
        yield f"The spline does not suffice: {'; '.join(faults)}."
    elif found.verdict == "within":
        yield "The spline is within the limits that the scene gives."
    else:
        yield (
            "The spline is not judged: "
            "the scene gives no travel_mm, least_engaged_mm or push_in_mm."
        )
    if found.drivelines == 1:
        yield "These are figures of one position; [states] or a [study] of points find the travel."
    elif not (found.longest.at or found.longest.state):
        yield (
            f"The study does not change the length of shaft {found.slip.shaft}; a [study] of "
            "points finds the travel."
        )


def _judged(part: Limited, rule: str) -> str:
    assert part.value is not None
    text = _mm(part.value)
    return text if part.limit is None else f"{text}; {rule} {_mm(part.limit)}"


def _placed(end: End) -> str:
    return f"{_mm(end.value)}{_at(end)}"


def _at(end: End) -> str:
    if end.state:
        return f" in {end.state}"
    return f" at {place_text(end)}" if end.at else ""


def _mm(value: float) -> str:
    return f"{figure_text(value)} mm" if abs(value) < 1e3 else f"{value:.1f} mm"

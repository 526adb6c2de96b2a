"""How the spline of a scene is used, in words."""

from __future__ import annotations

from collections.abc import Iterator

from cardan.app.answers.printed import place_of, quantity
from cardan.app.answers.spline.figures import SplineFigures


def sentences(found: SplineFigures) -> Iterator[str]:
    """Say whether the spline suffices, what to change if not, and what the force loads."""
    yield from _verdict(found)
    for other in found.others:
        yield (
            f"Shaft {other.shaft} changes its length by {_mm(other.travel)} as well, but the "
            f"spline is in shaft {found.shaft}. Move both ends of shaft {other.shaft} together, or "
            "give it a spline."
        )
    if found.no_force:
        yield f"The axial force is not computed: {found.no_force}."
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


def _verdict(found: SplineFigures) -> Iterator[str]:
    faults = [*_faults(found)]
    judged = [each for each in (found.travel, found.engaged, found.push_in) if each]
    if faults:
        yield f"The spline does not suffice: {'; '.join(faults)}."
    elif any(each.verdict == "within" for each in judged):
        yield "The spline is within the limits that the scene gives."
    else:
        yield (
            "The spline is not judged: "
            "the scene gives no travel_mm, least_engaged_mm or push_in_mm."
        )
    if found.drivelines == 1:
        yield "These are figures of one position; [states] or a [study] of points find the travel."
    elif found.longest and not (found.longest.at or found.longest.state):
        yield (
            f"The study does not change the length of shaft {found.shaft}; a [study] of "
            "points finds the travel."
        )


def _faults(found: SplineFigures) -> Iterator[str]:
    """What is beyond its limit, by how much and where."""
    travel, engaged, left = (
        each if each and each.verdict == "beyond" else None
        for each in (found.travel, found.engaged, found.push_in)
    )
    if travel:
        yield f"its travel exceeds the permitted one by {_mm(travel.excess)}"
    if engaged:
        assert engaged.value is not None
        missing = f"{_mm(engaged.excess)} of engaged length are missing"
        yield f"{'it comes apart' if engaged.value <= 0.0 else missing}{place_of(engaged)}"
    if left:
        yield f"it bottoms {_mm(left.excess)} too early{place_of(left)}"


def _mm(value: float) -> str:
    return quantity(value, "mm")

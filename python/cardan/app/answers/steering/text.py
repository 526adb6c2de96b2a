"""A steering column in words: ratio straight ahead, its slope, symmetry of left and right."""

from __future__ import annotations

from collections.abc import Iterator

from cardan.app.answers.limits.remedies_text import SHOWN
from cardan.app.answers.printed import aligned
from cardan.app.answers.steering.figures import OnCentre, SteeringFigures
from cardan.design.wrapping import fill

HEADINGS = ("ratio", "slope per rad", "off symmetry", "nearest")
"""What the figures of a row are."""

# Degrees; a workshop sets no yoke more finely.
_SETTABLE = 0.1


def words(found: SteeringFigures, *, radians: bool = False) -> str:
    """Return the figures of a steering column and what follows from them, 79 wide."""
    heading = f"Steering, straight ahead at a drive angle of {found.centre_deg:.6g}°"
    sentences = [fill(words, 79) for words in steering_sentences(found)]
    return "\n".join([heading, *_lines(found), "", *sentences])


def steering_rows(found: SteeringFigures) -> list[tuple[str, ...]]:
    """Return a row for each state: its name and its figures."""
    return [
        (
            one.state or "driveline",
            f"{one.ratio:.5f}",
            f"{0.0 if _symmetric(one) else one.slope:.4f}",
            f"{_off(one):.2f}°",
            one.nearest,
        )
        for one in found.each
    ]


def steering_sentences(found: SteeringFigures) -> Iterator[str]:
    """Say whether left and right are symmetric, and how to turn the yoke if not."""
    worst = found.worst
    where = f" in {worst.state}" if worst.state else ""
    if _symmetric(worst):
        yield f"Left and right are symmetric{' in all states' if worst.state else ''}."
        return
    judged = ""
    if found.limit_deg is not None:
        judged = f", {found.verdict} the limit of {found.limit_deg:.4g}°"
    yield (
        f"Left and right differ: straight ahead is {abs(worst.offset_deg):.2f}° from the nearest "
        f"symmetric angle{where}{judged}."
    )
    yield _turning(found, where)


def _turning(found: SteeringFigures, where: str) -> str:
    """How to turn the yoke: for one driveline to symmetry, for several states to the middle."""
    worst, offsets = found.worst, [one.offset_deg for one in found.each]
    if len({one.nearest for one in found.each}) == 1 and len(found.each) > 1:
        middle = (min(offsets) + max(offsets)) / 2.0
        left = (max(offsets) - min(offsets)) / 2.0
        if abs(middle) < _SETTABLE:
            return (
                "The driving yoke of joint 0 has its best place on the column: a turn brings the "
                f"worst state nearer by less than {_SETTABLE:g}°."
            )
        return (
            f"Turn the driving yoke of joint 0 on the column by {_turn(-middle)}, looking from the "
            f"column towards the output; that leaves at most {left:.2f}° in any state."
        )
    return (
        f"For symmetry{where}, turn the driving yoke of joint 0 on the column by "
        f"{_turn(worst.turn_to_quick_deg)} (ratio largest straight ahead) or by "
        f"{_turn(worst.turn_to_slow_deg)} (ratio least), looking from the column towards the "
        "output."
    )


def _lines(found: SteeringFigures) -> list[str]:
    rows = steering_rows(found)
    if len(rows) == 1:
        pairs = zip(HEADINGS, rows[0][1:], strict=True)
        return [aligned(pairs, indent="  ")]
    table = [("", *HEADINGS), *rows]
    widths = [max(map(len, column)) for column in zip(*table, strict=True)]
    return [
        "  ".join((f"  {row[0]:{widths[0]}}", *map(str.rjust, row[1:], widths[1:])))
        for row in table
    ]


def _symmetric(one: OnCentre) -> bool:
    return abs(one.offset_deg) < SHOWN


def _off(one: OnCentre) -> float:
    return 0.0 if _symmetric(one) else one.offset_deg


def _turn(degrees: float) -> str:
    sense = "clockwise" if degrees > 0.0 else "counter-clockwise"
    return f"{abs(degrees):.2f}° {sense}"

"""Single changes of a machine in words."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator

from cardan.app.answers.moves.figures import Move
from cardan.app.answers.printed import given, number_text, quantity, turn_text

# More are not read.
_MOST = 5


def sentences(found: Iterable[Move]) -> Iterator[str]:
    """Say each of the smallest changes and what it leaves."""
    for move in [*found][:_MOST]:
        then = "everything is then within its limits"
        if move.untried:
            then = f"everything tried is then within its limits (not tried: {move.untried})"
        if move.verdict != "within":
            then = f"this helps most; the {move.left} is then still {move.verdict}"
        yield f"{_change(move)}: {then}."


def _change(move: Move) -> str:
    if move.turn is not None:
        sense = "clockwise" if move.turn > 0.0 else "counter-clockwise"
        turn = turn_text(number_text(abs(math.degrees(move.turn)), "phase", rounds="up"), sense)
        if move.teeth:
            turn = f"{move.teeth} {'tooth' if move.teeth == 1 else 'teeth'} ({turn})"
        return f"Turn the output-side yoke of {move.of} by {turn}"
    if move.tilt is not None:
        way = "up" if move.tilt > 0.0 else "down"
        by = quantity(abs(move.tilt), "deg", rounds="up")
        return f"Tilt {move.of} {way} towards the output by {by} with a shim"
    if move.rating is not None:
        return f"Choose a rating of {given(move.rating, 'Nm')} for {move.of}"
    assert move.shift is not None
    by = quantity(abs(move.shift), "mm", rounds="up")
    if move.axis == "up":
        way = "Raise" if move.shift > 0.0 else "Lower"
        return f"{way} {move.of} by {by} with a spacer"
    if move.axis is not None:
        sign = "+" if move.shift > 0.0 else "\N{MINUS SIGN}"
        return f"Move {move.of} by {by} along {sign}{move.axis}"
    if move.variable == "bearing":
        return f"Move {move.of} by {by} {'down' if move.shift > 0.0 else 'up'}stream"
    more = "more" if move.shift > 0.0 else "less"
    return f"Make {move.of} engage {by} {more} where it is drawn"

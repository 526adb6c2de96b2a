"""What a check says in words."""

from __future__ import annotations

from collections.abc import Sequence

from cardan.app.words.phrases import listed
from cardan.design.check import Check
from cardan.design.wrapping import wrap


def check_text(found: Check, advice: Sequence[str] = (), beyond: Sequence[str] = ()) -> str:
    """Return a check in words, followed by what would bring it within the limits.

    Args:
        found: the check.
        advice: what would bring it within the limits, a sentence each.
        beyond: parts besides the driveline that are beyond their limits; they are listed below the
            verdict.
    """
    said = str(found)
    if beyond:
        verdict, rest = said.split("\n", 1)
        whose = "its limit" if len(beyond) == 1 else "their limits"
        said = "\n".join([verdict, *wrap(f"Beyond {whose}: {listed(beyond)}.", 79), rest])
    lines = ["", "What would help:"] if advice else []
    for sentence in advice:
        lines += wrap(f"- {sentence}", 79, subsequent_indent="  ", break_on_hyphens=False)
    return "\n".join([said, *lines])

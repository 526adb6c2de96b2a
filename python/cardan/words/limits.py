"""What a check says in words."""

from __future__ import annotations

from collections.abc import Sequence

from cardan.check import Check
from cardan.wrapping import wrap


def check_text(found: Check, advice: Sequence[str] = ()) -> str:
    """Return a check in words, followed by what would bring it within the limits."""
    lines = ["", "What would help:"] if advice else []
    for sentence in advice:
        lines += wrap(f"- {sentence}", 79, subsequent_indent="  ", break_on_hyphens=False)
    return "\n".join([str(found), *lines])

"""What a check says in words."""

from __future__ import annotations

from collections.abc import Sequence

from cardan.check import Check


def check_text(found: Check, advice: Sequence[str] = ()) -> str:
    """Return a check in words, followed by what would bring it within the limits."""
    lines = ["", "What would help:", *(f"- {sentence}" for sentence in advice)] if advice else []
    return "\n".join([str(found), *lines])

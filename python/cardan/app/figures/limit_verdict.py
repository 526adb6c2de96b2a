"""The verdict on a limit that a scene may give: one type for all figures that have such a limit."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Literal, TypeAlias

LimitVerdict: TypeAlias = Literal["within", "beyond", "not judged"]
"""``not judged`` where the scene gives no limit."""

_WORST_FIRST: tuple[LimitVerdict, ...] = ("beyond", "within", "not judged")


def worst_of(verdicts: Iterable[LimitVerdict]) -> LimitVerdict:
    """Return the worst of some verdicts, of which there is at least one."""
    return min(verdicts, key=_WORST_FIRST.index)

"""Dimensions of a view: the bend of every joint, and the lengths between joints."""

from __future__ import annotations

from itertools import pairwise
from typing import Any

from cardan.arrays import FloatArray

# Pixels: the font of the views, and what a letter of it takes at most.
SIZE = 34.0
_LETTER = 0.64 * SIZE

# Pixels between texts, of the head of an arrow, of the ends of a dimension line, and from the line
# to the middle of its text.
_GAP, _HEAD, _TICK, _BELOW = 14.0, 12.0, 16.0, 28.0


def bends(joints: FloatArray, texts: list[str], y: float) -> list[dict[str, Any]]:
    """Return the bends in a row above a view; none if one of them has no room.

    Args:
        joints: where the joints are drawn, ``(n, 2)``.
        texts: the bend of each.
        y: middle of the row.
    """
    places = sorted(zip(joints[:, 0].tolist(), texts, strict=True))
    ends = [(x - _half(text), x + _half(text)) for x, text in places]
    if any(left[1] + _GAP > right[0] for left, right in pairwise(ends)):
        return []
    return [{"class": "dimension", "path": "", "texts": [_text(x, y, text)]} for x, text in places]


def lengths(joints: FloatArray, texts: list[str], y: float) -> list[dict[str, Any]]:
    """Return a dimension line with its text for each shaft between two joints that has room for it.

    Args:
        joints: where the joints are drawn, ``(n, 2)``.
        texts: the length of each shaft between two of them, ``n - 1``.
        y: of the lines.
    """
    found = []
    for (start, end), text in zip(pairwise(joints[:, 0].tolist()), texts, strict=True):
        left, right = min(start, end), max(start, end)
        if right - left < 2.0 * _half(text) + _GAP:
            continue
        path = "".join(f"M{x:.1f} {y - _TICK:.1f}V{y + _TICK:.1f}" for x in (left, right))
        path += f"M{left:.1f} {y:.1f}H{right:.1f}"
        over, under = y - _HEAD / 3.0, y + _HEAD / 3.0
        for x, back in ((left, left + _HEAD), (right, right - _HEAD)):
            path += f"M{back:.1f} {over:.1f}L{x:.1f} {y:.1f}L{back:.1f} {under:.1f}"
        words = [_text((left + right) / 2.0, y + _BELOW, text)]
        found.append({"class": "dimension", "path": path, "texts": words})
    return found


def _half(text: str) -> float:
    return 0.5 * _LETTER * len(text)


def _text(x: float, y: float, words: str) -> dict[str, Any]:
    return {"words": words, "x": f"{x:.1f}", "y": f"{y:.1f}", "class": "middle"}

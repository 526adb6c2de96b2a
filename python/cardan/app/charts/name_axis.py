"""Names below a chart: level where they fit, aslant where they do not, none where they are many."""

from __future__ import annotations

import math
import unicodedata
from collections.abc import Sequence
from itertools import pairwise
from typing import NamedTuple

# Pixels: the font of the page's charts, what a line takes of it, and the least gap between names.
_SIZE, _LINE, _GAP = 11.0, 13.0, 7.0

# Degrees by which names are tilted, the least that suffices.
_TILTS = (0, 30, 45, 60, 90)

# Letters of a name; the tables of the report have all of it.
_MOST = 24


class NameAxis(NamedTuple):
    """The names of an axis.

    Attributes:
        texts: the names, cut if they are long. A level one has its middle at its place, a tilted
            one its end.
        tilt: degrees by which the names rise to the right.
        room: pixels that they need more than level names.
    """

    texts: list[str]
    tilt: int
    room: float


def name_axis(names: Sequence[str], places: Sequence[float], width: float) -> NameAxis | None:
    """Return the names below a frame, or ``None`` if they do not fit.

    Args:
        names: one or more.
        places: where each belongs, from left to right and evenly spread, in pixels.
        width: width of the drawing, in which the names must be.
    """
    names = [name if len(name) <= _MOST else f"{name[: _MOST - 1]}…" for name in names]
    wide = [_width(name) for name in names]
    step = min((b - a for a, b in pairwise(places)), default=math.inf)
    for tilt in _TILTS:
        cosine, sine = math.cos(math.radians(tilt)), math.sin(math.radians(tilt))
        if tilt:
            fits = step * sine >= _LINE
            fits &= all(x - own * cosine >= 0.0 for x, own in zip(places, wide, strict=True))
            fits &= places[-1] + _SIZE * sine <= width
            room = max(wide) * sine
        else:
            ends = [(x - own / 2.0, x + own / 2.0) for x, own in zip(places, wide, strict=True)]
            fits = all(left[1] + _GAP <= right[0] for left, right in pairwise(ends))
            fits &= ends[0][0] >= 0.0 and ends[-1][1] <= width
            room = 0.0
        if fits:
            return NameAxis(names, tilt, room)
    return None


def _width(name: str) -> float:
    """Pixels that a name takes at most in the fonts of browsers."""
    return _SIZE * sum(1.0 if unicodedata.east_asian_width(c) in "WF" else 0.62 for c in name)

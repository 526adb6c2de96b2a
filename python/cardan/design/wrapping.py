"""Text filled to a width, with every number on the line of its unit."""

from __future__ import annotations

import re
import textwrap
from typing import Any

_UNITS = "%|deg|rad|rpm|turns?|Hz|[km]?m|µm|k?N|[kM]?J|k?W|[MG]Pa|kg|K|h|s|1/s"

# A space that stays on its line: between a number and its unit, and within a unit.
_BOUND = re.compile(
    rf"(?:(?<=\d) (?=(?:{_UNITS})(?![A-Za-z]))"
    r"|(?<=N) (?=m(?![A-Za-z]))|(?<=kg) (?=m(?![A-Za-z]))|(?<=N m) (?=s(?![A-Za-z])))"
)

# No text has this character, and ``textwrap`` does not take it for a space.
_MARK = "\0"


def wrap(text: str, width: int, **options: Any) -> list[str]:  # noqa: ANN401 - of textwrap
    """Return the lines of a paragraph as ``textwrap.wrap`` does, parting no number and unit."""
    lines = textwrap.wrap(_BOUND.sub(_MARK, text), width, **options)
    return [line.replace(_MARK, " ") for line in lines]


def fill(text: str, width: int, **options: Any) -> str:  # noqa: ANN401 - of textwrap
    """Return the lines of ``wrap`` as one text."""
    return "\n".join(wrap(text, width, **options))

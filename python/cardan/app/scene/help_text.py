"""The format of a scene file as plain text."""

from __future__ import annotations

import textwrap

from cardan.app.scene.format import FORMAT, OF_STATES

_STUDY_HELP = """\
Give a key of [driveline], [load] or a [[bearing]] the value {from = …, to = …, steps = …} (both \
ends included) or a list of numbers. bends_deg varies all entries of a list alike, bends_deg.0 the \
first, and bends_deg.0-1 the first two. points_mm.2.y varies one coordinate of a point. The \
key bearing moves bearings: bearing.0.position_mm.\
"""

_PATHS_HELP = {
    "study": _STUDY_HELP,
    "states": "Give keys of [driveline] or [load] their values in each state, as in [study]; all "
    "lists have one entry per state. Paths may be in quotes.",
}


def describe() -> str:
    """Return the format of a scene file as plain text, at most 77 characters wide."""
    lines = []
    for name, section in FORMAT.items():
        heading = f"{section.heading(name)}  " if name else ""
        lines += _filled(f"{heading}{section.meaning}", "", "  ")
        if name in _PATHS_HELP:
            lines += _filled(_PATHS_HELP[name], "  ", "  ")
            listed = OF_STATES if name == "states" else {}
        else:
            listed = section.keys
        for key, entry in listed.items():
            default = "" if entry.default is None else f"; default {entry.default}"
            text = f"{entry.kind.name}: {entry.meaning}{default}"
            lines += _filled(text, f"  {key:32}", " " * 36)
        lines.append("")
    return "\n".join(lines)


def _filled(text: str, first: str, rest: str) -> list[str]:
    return textwrap.wrap(
        text, width=77, initial_indent=first, subsequent_indent=rest, break_on_hyphens=False
    )

"""How to set the yokes of a scene, in the words of a workshop."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from cardan.app.answers.limits.remedies_text import (
    BEST_OF_STATES,
    SHOWN,
    advice_text,
    arrangement_text,
    teeth_text,
    turn_text,
)
from cardan.design.wrapping import fill
from cardan.motion.workshop import ARROW, SAME_YOKE, VIEW, both_senses

_WIDTH = 79
_COLUMNS = {"present": "now", "best": "best", "on_teeth": "on teeth"}


def yoke_text(data: dict[str, Any]) -> str:
    """Say yoke settings in the words of a workshop."""
    above: list[str] = data["above_limits"]
    tried = "On these teeth" if data["teeth"] else "With the best setting"
    passes = "does not pass the check:" if above else "passes the check."
    if "states" in data:
        passes = f"{passes[:-1]} in every state{passes[-1]}"
    parts = [
        [data["title"]] if data["title"] else [],
        [arrangement_text(data)],
        [
            f"Set the output-side yoke of each shaft against its input-side yoke, {VIEW} "
            f"({ARROW}). {SAME_YOKE}.",
            *(f"- {words}" for words in yoke_lines(data)),
        ],
        tooth_lines(data),
        _states_table(data) if "states" in data else _table(data),
        [advice_text(data), f"{tried} the driveline {passes}", *(f"- {words}" for words in above)],
        [f"In the scene: {phases_text(data)}"],
    ]
    return "\n\n".join("\n".join(map(_wrapped, part)) for part in parts if part)


def phases_text(data: dict[str, Any]) -> str:
    """Return the setting as a line of a scene, on the teeth where these are known."""
    phases = (round(shaft["phase_deg"], 4) + 0.0 for shaft in data["teeth"] or data["shafts"])
    return f"phases_deg = [{', '.join(f'{phase:.7g}' for phase in phases)}]"


def yoke_lines(data: dict[str, Any]) -> list[str]:
    """Say the setting of each shaft, one line per shaft."""
    return [
        f"shaft {shaft['shaft']}: {_setting(shaft)}; "
        + ("nothing to turn" if shaft["turn_deg"] < SHOWN else f"turn it {turn_text(shaft)}")
        for shaft in data["shafts"]
    ]


def tooth_lines(data: dict[str, Any]) -> list[str]:
    """Say what the teeth cost, and on which tooth to set each shaft; nothing without teeth."""
    if not data["teeth"]:
        return []
    lines = ["On the splines:"]
    # Over several states teeth cost something in one and gain it in another.
    if "states" not in data:
        bend = data["equivalent_bend_deg"]
        cost = f"{bend['on_teeth'] - bend['best']:.3f}°"
        lines = [f"On the splines, whose teeth cost {cost} of equivalent bend:"]
    for tooth in data["teeth"]:
        change = f"turn it {teeth_text(tooth)}" if tooth["turn_teeth"] else "nothing to turn"
        spline = "cannot be turned" if tooth["teeth"] < 3 else f"{tooth['teeth']} teeth"
        lines.append(f"- shaft {tooth['shaft']} ({spline}): {_setting(tooth)}; {change}")
    return lines


def _table(data: dict[str, Any]) -> list[str]:
    """The equivalent bend of each setting, exactly and by the root rule, as aligned columns."""
    settings = data["catalogue"]
    signs = (
        " ".join("+" if sign > 0 else "-" for sign in rule["fork_signs"])
        for rule in settings.values()
    )
    rows: list[tuple[str, Iterable[str]]] = [
        ("", (_COLUMNS[key] for key in settings)),
        ("Equivalent bend", (f"{data['equivalent_bend_deg'][key]:.3f}°" for key in settings)),
        (
            "Catalogue's root rule",
            (f"{rule['equivalent_bend_deg']:.3f}°" for rule in settings.values()),
        ),
        ("  its fork signs", signs),
        ("  yokes off these by", (f"{rule['off_deg']:.2f}°" for rule in settings.values())),
    ]
    return [f"{label:24}" + "".join(f"{cell:>12}" for cell in cells) for label, cells in rows]


def _states_table(data: dict[str, Any]) -> list[str]:
    """The equivalent bend of each state with each setting, as aligned columns."""
    states = data["states"]
    bends = states["equivalent_bend_deg"]
    width = max(24, *(len(name) + 4 for name in states["names"]))
    rows = [("Equivalent bend", [_COLUMNS[key] for key in bends])]
    rows += [
        (f"  {name}", [f"{each[i]:.3f}°" for each in bends.values()])
        for i, name in enumerate(states["names"])
    ]
    lines = [f"{label:{width}}" + "".join(f"{cell:>12}" for cell in cells) for label, cells in rows]
    return [*lines, "", BEST_OF_STATES]


def _setting(shaft: dict[str, Any]) -> str:
    if shaft["setting_deg"] < SHOWN:
        return "in one plane"
    return both_senses(shaft["setting_deg"], shaft["sense"])


def _wrapped(line: str) -> str:
    # The columns of the table are narrow, and a line of a scene stays one line.
    if line.startswith(("In the scene", " ")) or len(line) <= _WIDTH:
        return line
    indent = "  " if line.startswith("- ") else ""
    return fill(
        line, _WIDTH, subsequent_indent=indent, break_on_hyphens=False, break_long_words=False
    )

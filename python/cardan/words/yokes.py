"""How to set the yokes of a scene, in the words of a workshop."""

from __future__ import annotations

from typing import Any

from cardan.workshop import VIEW

# Less than this, in degrees, would read 0.00.
_SHOWN = 0.005


def yoke_text(data: dict[str, Any]) -> str:
    """Say yoke settings in the words of a workshop."""
    lines = [data["title"], ""] if data["title"] else []
    lines += [f"Set the output-side yoke against the input-side one, {VIEW}:"]
    lines += [f"- {words}" for words in yoke_lines(data)]
    bend = data["equivalent_bend_deg"]
    above: list[str] = data["above_limits"]
    lines += [
        "",
        f"Equivalent bend: {bend['present']:.4g}° as it is, {bend['best']:.4g}° set so.",
        "Set so, it does not pass the check:" if above else "Set so, it passes the check.",
        *(f"- {words}" for words in above),
        f"In the scene: {phases_text(data)}",
    ]
    return "\n".join(lines)


def phases_text(data: dict[str, Any]) -> str:
    """Return the setting as a line of a scene."""
    phases = (round(shaft["phase_deg"], 4) + 0.0 for shaft in data["shafts"])
    return f"phases_deg = [{', '.join(f'{phase:.7g}' for phase in phases)}]"


def yoke_lines(data: dict[str, Any]) -> list[str]:
    """Say the setting of each shaft, one line per shaft."""
    lines = []
    for shaft in data["shafts"]:
        setting = "in one plane"
        if shaft["setting_deg"] >= _SHOWN:
            setting = f"{shaft['setting_deg']:.2f}° {shaft['sense']}"
        change = "as it is"
        if shaft["turn_deg"] >= _SHOWN:
            change = (
                f"turn it {shaft['turn_deg']:.2f}° {shaft['turn_sense']} from its present place"
            )
        lines.append(f"shaft {shaft['shaft']}: {setting} ({change})")
    return lines

"""What the command and the report say of a scene: its limits and how to set its yokes."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from cardan.check import Check
from cardan.summary import equivalent_bend_deg
from cardan.workshop import VIEW, turn

if TYPE_CHECKING:
    from cardan.scene import Scene


def check_scene(scene: Scene) -> Check:
    """Check the driveline of a scene, or all of its study."""
    if scene.study is None or not scene.study.axes:
        return scene.line.check(scene.speed or None)
    blocks = []
    for _, line, load in scene.study.blocks():
        speed = load.speed if load and np.any(load.speed) else None
        blocks.append(line.check(speed).findings)
    return Check(
        tuple(
            replace(parts[0], value=np.concatenate([np.ravel(part.value) for part in parts]))
            for parts in zip(*blocks, strict=True)
        )
    )


def yoke_settings(scene: Scene) -> dict[str, Any]:
    """Return the best yoke settings of a scene as plain data.

    Raises:
        ValueError: one joint alone, or bends that were recorded.
    """
    line = scene.line
    if line.n_joints == 1:
        raise ValueError(f"{scene.name}: one joint has no yokes to set against each other")
    if line.shape:
        raise ValueError(f"{scene.name}: the bends were recorded; yokes are set for fixed bends")
    best = line.optimal_phases()
    settings, turns = turn(best), turn(best - line.phases)
    return {
        "title": scene.title,
        "view": VIEW,
        "shafts": [
            {
                "shaft": i + 1,
                "phase_deg": float(np.degrees(best[i])),
                "setting_deg": float(np.degrees(settings.angle[i])),
                "sense": str(settings.sense[i]),
                "turn_deg": float(np.degrees(turns.angle[i])),
                "turn_sense": str(turns.sense[i]),
            }
            for i in range(line.n_joints - 1)
        ],
        "equivalent_bend_deg": {
            "present": equivalent_bend_deg(line),
            "best": equivalent_bend_deg(line.with_phases(best)),
        },
    }


# Less than this, in degrees, would read 0.00.
_SHOWN = 0.005


def yoke_text(data: dict[str, Any]) -> str:
    """Say yoke settings in the words of a workshop."""
    lines = [data["title"], ""] if data["title"] else []
    lines += [f"Set the output-side yoke against the input-side one, {VIEW}:"]
    lines += [f"- {words}" for words in yoke_lines(data)]
    bend = data["equivalent_bend_deg"]
    phases = ", ".join(f"{shaft['phase_deg']:.4f}" for shaft in data["shafts"])
    lines += [
        "",
        f"Equivalent bend: {bend['present']:.4g}° as it is, {bend['best']:.4g}° set so.",
        f"In the scene: phases_deg = [{phases}]",
    ]
    return "\n".join(lines)


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

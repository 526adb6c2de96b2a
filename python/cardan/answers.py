"""What the command and the report say of a scene: its limits and how to set its yokes."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from cardan.arrays import FloatArray
from cardan.check import Check
from cardan.summary import alike, equivalent_bend_deg
from cardan.workshop import VIEW, turn

if TYPE_CHECKING:
    from cardan.scene import Scene
    from cardan.study import Progress, Study


def check_scene(scene: Scene, progress: Progress | None = None) -> Check:
    """Check the driveline of a scene, or all of its study and say where the worst of it lies.

    ``progress`` is called after each block of the study with the rows done and all rows.
    """
    if scene.study is None or not scene.study.axes:
        return scene.line.check(scene.speed or None)
    blocks = []
    rows = math.prod(scene.study.shape)
    for first, line, load in scene.study.blocks():
        speed = load.speed if load and np.any(load.speed) else None
        blocks.append(line.check(speed).findings)
        if progress:
            progress(first + line.shape[0], rows)
    findings = []
    for parts in zip(*blocks, strict=True):
        value = np.concatenate([np.ravel(part.value) for part in parts])
        findings.append(replace(parts[0], value=value, worst_at=_worst_at(scene.study, value)))
    return Check(tuple(findings))


def _worst_at(study: Study, value: FloatArray) -> dict[str, float]:
    """The keys of a study on which its largest value depends, and their values there."""
    grid = value.reshape(study.shape)
    place: tuple[Any, ...] = np.unravel_index(np.argmax(grid), grid.shape)
    found = {}
    for number, axis in enumerate(study.axes):
        along = grid[(*place[:number], slice(None), *place[number + 1 :])]
        if not alike(float(np.min(along)), float(np.max(along))):
            found[axis.key] = float(axis.values[place[number]])
    return found


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
    # A yoke turned by 180 deg is the same yoke: the figure of the scene is that of the bench.
    phases = np.where(settings.sense == "counter-clockwise", -settings.angle, settings.angle)
    set_so = line.with_phases(best)
    check = set_so.check(scene.speed or None)
    return {
        "title": scene.title,
        "view": VIEW,
        "shafts": [
            {
                "shaft": i + 1,
                "phase_deg": float(np.degrees(phases[i])),
                "setting_deg": float(np.degrees(settings.angle[i])),
                "sense": str(settings.sense[i]),
                "turn_deg": float(np.degrees(turns.angle[i])),
                "turn_sense": str(turns.sense[i]),
            }
            for i in range(line.n_joints - 1)
        ],
        "equivalent_bend_deg": {
            "present": equivalent_bend_deg(line),
            "best": equivalent_bend_deg(set_so),
        },
        "above_limits": [str(found) for found in check.findings if not found.passes],
    }


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

"""A scene with three heights of the driven end, and the driveline at each height."""

from __future__ import annotations

import numpy as np

from cardan import Driveline

NAMES = ("low", "middle", "high")
HEIGHTS = (-250.0, -110.0, 40.0)
POINTS = np.array([[0, 0, 0], [300, 0, 0], [1500, -110, 40], [1800, -110, 60]], dtype=float)
SPEED = 50.0 * np.pi


def scene_text(phase: float, more: str = "") -> str:
    """Return the scene: its yokes turned by a phase in degrees, with more keys of its load."""
    return f"""\
[driveline]
points_mm = {POINTS.tolist()}
phases_deg = [{phase}]
[load]
speed_rpm = 1500
drive_torque_Nm = 300
{more}
[states]
names = {list(NAMES)}
"points_mm.2-3.y" = {list(HEIGHTS)}
"""


def drivelines(phase: float) -> list[Driveline]:
    """Return the driveline of each state."""
    made = []
    for height in HEIGHTS:
        points = 1e-3 * POINTS
        points[2:, 1] = 1e-3 * height
        made.append(Driveline.from_points(points, [phase], degrees=True))
    return made

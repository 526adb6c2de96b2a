"""Find the place of the middle bearing at which a truck's driveline runs most quietly.

Gearbox and axle stay where they are; the joint behind the middle bearing may move up and down. All
places are one batch of drivelines, each with its best yokes.
"""

import numpy as np

import cardan

HEIGHTS = np.linspace(-160.0, 20.0, 181)  # mm
# Axes of the points, right-handed, in mm: x rearwards, y up, z to the vehicle's left.
POINTS = np.array(
    [[0, 0, 0], [350, -24, 0], [1650, 0, 0], [3150, -180, 45], [3450, -196, 45]], dtype=float
)

points = np.repeat(POINTS[np.newaxis], len(HEIGHTS), axis=0)
points[:, 2, 1] = HEIGHTS
lines = cardan.Driveline.from_points(points)
smooth = lines.with_phases(lines.optimal_phases())
bend = np.abs(np.degrees(smooth.equivalent().bend))

# Smooth is not yet quiet: what shakes the shafts between is in the check as well.
check = smooth.check(speed=2500 * 2 * np.pi / 60, limits="truck")
within = check.verdict == "within"
good = HEIGHTS[within]

print(f"equivalent bend {bend.min():.2f} to {bend.max():.2f} deg with the best yokes")
print(f"within all limits from {good.min():.0f} to {good.max():.0f} mm")
best = int(np.argmin(np.max(np.degrees(lines.bends), axis=-1) + 1e6 * ~within))
print(f"smallest bends at {HEIGHTS[best]:.0f} mm: {np.degrees(lines.bends[best]).round(2)} deg")
print(cardan.workshop.turn(smooth[best].phases))

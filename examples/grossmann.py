"""Grossmann's figures 3 and 4 (1939): torque and bending moments of one joint at 50 degrees.

Figure 3 shows the torque over the drive angle, figure 4 the bending moments as polar diagrams,
each over the angle of its own shaft. It needs the extra ``plot`` and writes grossmann.svg.
"""

import math

import numpy as np
from matplotlib.figure import Figure

import cardan

BEND = 50.0

line = cardan.Driveline.from_bends([BEND], degrees=True)
driving = np.linspace(0.0, 2.0 * math.pi, 721)
result = line.evaluate(
    driving,
    ("angle", "torque", "bending_driving", "bending_driven"),
    joints=0,
    load=cardan.Load(drive_torque=1.0),
)
driven = result.angle

figure = Figure(figsize=(7.5, 3.0), layout="constrained")
curve = figure.add_subplot(1, 3, 1)
curve.plot(np.degrees(driving), result.torque)
curve.set(title="torque D₂/D₁", xlabel="drive angle [deg]", xticks=range(0, 361, 90))
for place, angle, moment, circles, title in (
    (2, driving, result.bending_driving, (0.5, 1.0), "bending B₁/D₁, driving"),
    (3, driven, result.bending_driven, (0.4, 0.8), "bending B₂/D₁, driven"),
):
    polar = figure.add_subplot(1, 3, place, projection="polar")
    polar.plot(angle, moment)
    polar.set_yticks(circles)
    polar.set_title(title)
figure.savefig("grossmann.svg")

print(f"joint at {BEND:g} deg, per unit drive torque")
print(f"torque           {result.torque.min():.5f} to {result.torque.max():.5f}")
print(f"bending, driving up to {result.bending_driving.max():.5f}")
print(f"bending, driven  up to {result.bending_driven.max():.5f}, 1/(2 cos), not the sine")
print(f"                       {math.sin(math.radians(BEND)):.5f} that catalogues print")

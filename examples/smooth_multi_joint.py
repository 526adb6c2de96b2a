"""Set the yokes of three unequal joints so that the driveline runs as smoothly as it can."""

import cardan

# Axes of the points, right-handed, in mm: x rearwards, y up, z to the vehicle's left.
line = cardan.Driveline.from_points(
    [[0, 0, 0], [600, 0, 0], [1900, -120, 60], [3100, -160, -40], [3500, -160, -40]]
)
print(line)
print("as it is:", line.check(), sep="\n")

smooth = line.with_phases(line.optimal_phases())
print("\nwith the output yoke of each intermediate shaft turned against its input yoke by")
print(cardan.workshop.turn(smooth.phases))
print(smooth.check(), sep="\n")

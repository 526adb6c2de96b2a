"""Find the smoothest yoke settings of a driveline with three unequal joints."""

import cardan

line = cardan.Driveline.from_points(
    [[0, 0, 0], [600, 0, 0], [1900, -120, 60], [3100, -160, -40], [3500, -160, -40]]
)
print(line)
print("as it is:", line.check(), sep="\n")

smooth = line.with_phases(line.optimal_phases())
print("\nwith the output yoke of each intermediate shaft turned against its input yoke by")
print(cardan.workshop.turn(smooth.phases))
print(smooth.check(), sep="\n")

"""The geometry of drivelines: how they are made, mounted in bearings and rearranged."""

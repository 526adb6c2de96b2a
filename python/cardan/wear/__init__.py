"""What drivelines in service bear: losses, life, forces of splines, axial travel."""

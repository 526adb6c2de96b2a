"""Drivelines in service: losses, life, forces of splines, axial travel."""

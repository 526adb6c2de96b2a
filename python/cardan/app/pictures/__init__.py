"""What pictures have in common, and those of joints and drivelines without a scene."""

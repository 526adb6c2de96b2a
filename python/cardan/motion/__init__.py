"""The motion of drivelines: equivalent joints, steering, free drives, the setting of yokes."""

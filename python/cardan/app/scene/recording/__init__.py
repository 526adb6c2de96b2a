"""Recorded angles, times, speeds and torques as a scene reads them."""

"""Judging a driveline: limits, checks, and the quantities that are toleranced and optimised."""

"""Tolerances: what the errors of a workshop make of a driveline."""

from cardan.tolerances.result import Tolerances, tolerances

__all__ = ["Tolerances", "tolerances"]

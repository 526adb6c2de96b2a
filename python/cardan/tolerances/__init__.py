"""Tolerances: what the errors of a workshop make of a driveline."""

from cardan.tolerances.quantities import FIGURES
from cardan.tolerances.reduced import REDUCTIONS
from cardan.tolerances.request import tolerances
from cardan.tolerances.result import Tolerances

__all__ = ["FIGURES", "REDUCTIONS", "Tolerances", "tolerances"]

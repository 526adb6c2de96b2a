"""Tolerances: the effect of manufacturing errors on a driveline."""

from cardan.tolerances.box import JOINT_GROUPS
from cardan.tolerances.request import REDUCTIONS, tolerances
from cardan.tolerances.result import Tolerances

__all__ = ["JOINT_GROUPS", "REDUCTIONS", "Tolerances", "tolerances"]

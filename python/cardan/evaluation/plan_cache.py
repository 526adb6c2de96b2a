"""Plans that a driveline remembers, for calls of ``evaluate`` with the same arguments.

Preparing a plan takes twice as long as evaluating it at a few angles. Only a second call with the
same arguments keeps its plan: most drivelines of a list are evaluated once, and plans take memory.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from cardan.evaluation.driven_angle import planned
from cardan.evaluation.load import Load
from cardan.evaluation.plan import Plan
from cardan.evaluation.request import Request

if TYPE_CHECKING:
    from cardan.driveline import Driveline

_MOST = 8
"""The most calls that a driveline remembers; one more replaces them all."""


def remembered(line: Driveline, request: Request) -> Plan:
    """Return the plan of ``planned`` for this request, made earlier if possible.

    Raises:
        IndexError, TypeError, ValueError: as there.
    """
    if not isinstance(request.names, (str, tuple)):
        request = request._replace(names=tuple(request.names))
    load = request.load
    # 1.0 equals 1, but is no index and no number of threads.
    key = (request, type(request.shafts), type(request.joints), type(request.workers))
    plans = line._plans
    try:
        plan: Plan | None = plans.get(key)
    except TypeError:
        return planned(line, request)  # A list of shafts, say, has no hash.
    if plan is not None:
        return plan
    if key in plans:
        # A plan holds its driveline. If that held the plan, both would stay until the garbage
        # collector finds the cycle, so the plan holds another object with the same arrays.
        plan = plans[key] = planned(line._twin(), request)
        return plan
    # Of a load with arrays a plan would keep a copy.
    small = load is None or (
        isinstance(load, Load) and load.inertias is None and not any(load.shapes().values())
    )
    if small and not line.shape:
        if len(plans) >= _MOST:
            plans.clear()
        plans[key] = None
    return planned(line, request)

"""Plans that a driveline remembers, for calls of ``evaluate`` with the same arguments.

Preparing a plan takes twice as long as evaluating it at a few angles. Only a second call with the
same arguments keeps its plan: most drivelines of a list are evaluated once, and plans take memory.
"""

from __future__ import annotations

from collections.abc import Iterable

from numpy.typing import DTypeLike

from cardan.bearings import Mounted
from cardan.driven_angle import planned
from cardan.load import Load
from cardan.plan import Plan
from cardan.request import AngleOf, Axes, Items, Reduction

_MOST = 8
"""The most calls that a driveline remembers; one more replaces them all."""


def remembered(
    line: Mounted,
    names: str | Iterable[str],
    shafts: Items,
    joints: Items,
    load: Load | None,
    reduce: Reduction | None,
    dtype: DTypeLike | None,
    tolerance: float | None,
    workers: int | None,
    axes: Axes,
    angle_of: AngleOf,
) -> Plan:
    """Return the plan of ``planned`` for these arguments, made earlier if possible.

    Raises:
        IndexError, TypeError, ValueError: as there.
    """
    if not isinstance(names, str):
        names = tuple(names)
    options = (shafts, joints, load, reduce, dtype, tolerance, workers, axes, angle_of)
    # 1.0 equals 1, but is no index and no number of threads.
    key = (names, *options, type(shafts), type(joints), type(workers))
    plans = line._plans
    try:
        plan: Plan | None = plans.get(key)
    except TypeError:
        return planned(line, names, *options)  # A list of shafts, say, has no hash.
    if plan is not None:
        return plan
    if key in plans:
        # A plan holds its driveline. If that held the plan, both would stay until the garbage
        # collector finds the cycle, so the plan holds another object with the same arrays.
        plan = plans[key] = planned(line._twin(), names, *options)
        return plan
    if not line.shape and (load is None or (isinstance(load, Load) and _is_small(load))):
        if len(plans) >= _MOST:
            plans.clear()
        plans[key] = None
    return planned(line, names, *options)


def _is_small(load: Load) -> bool:
    """Whether a load holds single numbers, and no inertias, of which a plan keeps a copy."""
    arrays = (load.torque, load.speed, load.acceleration)
    return load.inertias is None and not any(array.ndim for array in arrays)

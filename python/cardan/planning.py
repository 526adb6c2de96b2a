"""Which kind of plan serves a request."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from numpy.typing import DTypeLike

from cardan.axes import ShaftAxesPlan
from cardan.driven_angle import DrivenPlan
from cardan.errors import ArgumentValueError
from cardan.load import Load
from cardan.outputs import OUTPUTS, checked
from cardan.plan import Plan
from cardan.request import AngleOf, Axes, Items, Plannable, Reduction


def planned(
    line: Plannable,
    names: str | Iterable[str],
    shafts: Items = None,
    joints: Items = None,
    load: Load | None = None,
    reduce: Reduction | None = None,
    dtype: DTypeLike | None = None,
    tolerance: float | None = None,
    workers: int | None = None,
    axes: Axes = "space",
    angle_of: AngleOf = "drive",
) -> Plan:
    """Return the plan for these arguments of ``Driveline.plan``.

    Raises:
        IndexError, TypeError, ValueError: as there.
    """
    _check("axes", axes, ("space", "shaft"))
    _check("angle_of", angle_of, ("drive", "driven"))
    names = checked(names)
    # A length is the same in all axes.
    turns = axes == "shaft" and reduce != "peak" and any(OUTPUTS[name].vector for name in names)
    kind = ShaftAxesPlan if turns else Plan
    plan = kind(line, names, shafts, joints, load, reduce, dtype, tolerance, workers)
    return DrivenPlan(plan) if angle_of == "driven" else plan


def _check(argument: str, value: Any, known: tuple[str, str]) -> None:  # noqa: ANN401
    if not isinstance(value, str) or value not in known:
        wanted = " or ".join(map(repr, known))
        raise ArgumentValueError(argument, f"is {value!r}; it must be {wanted}")

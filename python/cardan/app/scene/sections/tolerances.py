"""What a scene's tolerances make of its driveline, in all of its states."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from cardan.app.scene.sections.joint_deviations import IN_DEGREES_OR_MM, angles_of
from cardan.app.scene.sections.parts import largest_speed
from cardan.app.scene.study.states import States
from cardan.arrays import FloatArray
from cardan.arrays.errors import ArgumentValueError
from cardan.design.limits import Limits
from cardan.design.quantities import (
    MOTION_QUANTITIES,
    MotionQuantity,
    OrderQuantity,
    modulus_of_bend,
    order_quantity,
    reduced_quantity,
)
from cardan.driveline import Driveline
from cardan.evaluation.load import Load
from cardan.evaluation.outputs import OUTPUTS, Output
from cardan.tolerances import Tolerances
from cardan.tolerances.box import GROUPS, JOINT_GROUPS, Sizes
from cardan.tolerances.request import Drawn, Figures, toleranced

_ANGLES = {"bends_deg": "bends", "twists_deg": "twists", "phases_deg": "phases"}


@dataclass(frozen=True, eq=False)
class ToleratedLine:
    """The driveline of a scene for its tolerances.

    Attributes:
        line: of the drawing, with lengths in metres.
        deviations: of its joints in rad, ``(n, 3)``, if the scene gives any.
        arms: of its joints in m, ``(n,)``, if they are known.
    """

    line: Driveline
    deviations: FloatArray | None
    arms: FloatArray | None


def tolerances_of(
    values: Mapping[str, Any],
    own: ToleratedLine,
    limits: Limits,
    load: Load | None,
    states: States | None,
) -> Tolerances:
    """Return the tolerances that the keys of the section describe.

    Args:
        values: values by key.
        own: the driveline of the scene. Its deviations are the middle of their tolerances, in
            figures of orders and outputs; those of the motion are of ideal joints.
        limits: of the scene.
        load: of the scene, if it has one.
        states: of the scene, if it has any; the driveline of [driveline] may be none of them.

    Raises:
        ValueError: recorded bends, as ``Driveline.tolerances`` with the key as the argument.
    """
    line = own.line
    if line.shape:
        raise ValueError("it does not go with recorded bends, which differ by sample")
    _check_lengths(values, line.n_joints)
    # Of a recorded speed the largest counts.
    speed: Any = largest_speed(load)
    if states:
        line, load = states.drivelines(), states.loads(load)
        speed = speed if load is None or load.speed.shape != line.shape else load.speed
    of = values.get("of") or _default(values, speed)
    for name in of:
        output = _output_of(name)
        if output and output.needs_load and load is None:
            raise ArgumentValueError("of", f"has {name!r}, which needs a section [load]")
        if not output and _motion_of(name).needs_speed and not np.all(speed):
            raise ArgumentValueError("of", f"has {name!r}, which needs a speed in [load]")
        if output and load is not None and (load.speed + load.torque).shape not in ((), line.shape):
            raise ArgumentValueError("of", f"has {name!r}, which does not go with a recorded load")
    given: dict[str, Any] = {
        argument: np.radians(values[key]) for key, argument in _ANGLES.items() if key in values
    }
    if "points_mm" in values:
        size = 1e-3 * np.asarray(values["points_mm"], dtype=float)
        given["points"] = size if size.ndim == 0 else size[:, np.newaxis]
    given |= angles_of(values, line.n_joints, own.arms)
    keys = {argument: key for key, argument in _ANGLES.items()} | {"points": "points_mm"}
    for group, pair in zip(JOINT_GROUPS, IN_DEGREES_OR_MM, strict=True):
        keys[group] = next((key for key in pair if key in values), pair[0])
    if own.deviations is not None:
        line = line.with_deviations(*own.deviations.T)
    try:
        return toleranced(
            line,
            Sizes(
                {group: given.get(group) for group in GROUPS},
                values.get("teeth"),
                values.get("distribution", "uniform"),
            ),
            Figures(
                of[0] if len(of) == 1 else of,
                _limits(values, of, limits),
                speed,
                load,
                states=None if states is None else 0,
                reduce=values.get("reduce", "peak"),
                motion_as_drawn=True,
            ),
            Drawn(values.get("samples"), values.get("seed", 0)),
        )
    except ArgumentValueError as error:
        key = keys.get(error.argument, error.argument)
        raise ArgumentValueError(key, error.problem, error.place) from None


def _check_lengths(values: Mapping[str, Any], joints: int) -> None:
    """Check that lists have as many entries as the driveline has parts."""
    between = (joints - 1, "shaft between two joints")
    wanted = {
        "bends_deg": (joints, "joint"),
        "twists_deg": between,
        "phases_deg": between,
        "points_mm": (joints + 2, "point"),
        "teeth": between,
    }
    for key, (count, part) in wanted.items():
        given = values.get(key)
        if isinstance(given, list) and len(given) != count:
            raise ArgumentValueError(
                key, f"has length {len(given)}; it needs {count}, one per {part}"
            )


def _default(values: Mapping[str, Any], speed: Any) -> list[str]:  # noqa: ANN401
    """The figures of a section that names none: what its tolerances act on first."""
    layout = (*_ANGLES, "points_mm", "teeth")
    joints = [key for pair in IN_DEGREES_OR_MM for key in pair]
    found = ["equivalent_bend"] if any(key in values for key in layout) else []
    if any(key in values for key in joints):
        found.append("acceleration_order_1" if np.all(speed) else "angle_error_order_1")
    return found


def _motion_of(name: str) -> MotionQuantity | OrderQuantity:
    """The quantity of the motion, or of one order of it."""
    return order_quantity(name) or MOTION_QUANTITIES[name]


def _output_of(name: str) -> Output | None:
    """The output of a figure; ``None`` of one of the motion."""
    reduced = reduced_quantity(name)
    return reduced.output if reduced else OUTPUTS.get(name)


def _limits(values: Mapping[str, Any], of: list[str], limits: Limits) -> Any:  # noqa: ANN401
    """The limit of each figure in SI units: the scene's own, or those of its section [limits]."""
    found: dict[str, float] = {}
    for name in of:
        quantity = MOTION_QUANTITIES.get(name)
        if quantity is None or quantity.limit not in limits.figures:
            continue
        limit = limits.figures[quantity.limit].limit
        if not quantity.needs_speed:
            # All of them follow from the bend of a joint.
            limit = float(quantity.ratio(modulus_of_bend(np.radians(limit))))
        found[name] = limit
    if "limit" in values:
        if len(of) > 1:
            raise ArgumentValueError(
                "limit", f"applies to a single figure, and 'of' names {len(of)}; give [limits]"
            )
        output = _output_of(of[0])
        unit = output.unit if output else _motion_of(of[0]).unit
        found[of[0]] = np.radians(values["limit"]) if unit == "rad" else values["limit"]
    return found if len(of) > 1 else found.get(of[0])

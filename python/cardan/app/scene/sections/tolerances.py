"""The section [tolerances]: how exactly a driveline is made and assembled, in all of its states."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from cardan.app.scene.language import rules
from cardan.app.scene.language.quantities import QuantityName
from cardan.app.scene.language.section import Key, Reading, Section
from cardan.app.scene.sections.joints import IN_DEGREES_OR_MM, JOINTS, angles_of, arms_of
from cardan.app.scene.sections.limits import LIMITS
from cardan.app.scene.sections.load import largest_speed
from cardan.app.scene.sections.study import STATES
from cardan.arrays import FloatArray
from cardan.arrays.errors import ArgumentValueError
from cardan.design import quantities
from cardan.design.limits import Limits
from cardan.evaluation.outputs import OUTPUTS, Output
from cardan.tolerances import REDUCTIONS, Tolerances
from cardan.tolerances.box import GROUPS, Sizes
from cardan.tolerances.request import Drawn, Figures, toleranced

_BETWEEN = "shaft between two joints"
_ANGLES = {"bends_deg": "bends", "twists_deg": "twists", "phases_deg": "phases"}
_OF_JOINTS = tuple(key for pair in IN_DEGREES_OR_MM.values() for key in pair)


@dataclass(frozen=True, eq=False)
class Toleranced:
    """Tolerances, the arms in m of groups given as lengths, and the share that must pass."""

    tolerances: Tolerances | None
    arms: Mapping[str, FloatArray]
    share: float | None


def _toleranced(values: Mapping[str, Any], scene: Reading) -> Toleranced:
    if not values:
        return Toleranced(None, {}, None)
    line, joints = scene.line, scene[JOINTS]
    if line.shape:
        raise ValueError("it does not go with recorded bends, which differ by sample")
    TOLERANCES.check_counts(values, line.n_joints)
    own_arm = scene.given.get(JOINTS.name, {}).get("arm_mm")
    arms = arms_of(
        values if own_arm is None else {"arm_mm": own_arm, **values}, line.n_joints, joints.sizes
    )
    in_mm = [group for group, (_, mm) in IN_DEGREES_OR_MM.items() if mm in values]
    tolerances = _tolerances(values, scene, arms)
    return Toleranced(
        tolerances, {} if arms is None else dict.fromkeys(in_mm, arms), values.get("share")
    )


def _tolerances(values: Mapping[str, Any], scene: Reading, arms: FloatArray | None) -> Tolerances:
    """The tolerances about the driveline in all of its states.

    Deviations of the scene are the middle of their tolerances in figures of orders and outputs;
    those of the motion are of ideal joints.
    """
    line, load, states, deviations = scene.line, scene.load, scene[STATES], scene[JOINTS].deviations
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
    given |= angles_of(values, line.n_joints, arms)
    if deviations is not None:
        line = line.with_deviations(*deviations.T)
    # An error is about the key that is given, of the two for a deviation.
    with TOLERANCES.named((*reversed([*TOLERANCES.keys]), *values)):
        return toleranced(
            line,
            Sizes(
                {group: given.get(group) for group in GROUPS},
                values.get("teeth"),
                values.get("distribution", "uniform"),
            ),
            Figures(
                of[0] if len(of) == 1 else of,
                _limits(values, of, scene[LIMITS].motion),
                speed,
                load,
                states=None if states is None else 0,
                reduce=values.get("reduce", "peak"),
                motion_as_drawn=True,
            ),
            Drawn(values.get("samples"), values.get("seed", 0)),
        )


def _default(values: Mapping[str, Any], speed: Any) -> list[str]:  # noqa: ANN401
    """The figures of a section that names none: what its tolerances act on first."""
    layout = (*_ANGLES, "points_mm", "teeth")
    found = ["equivalent_bend"] if any(key in values for key in layout) else []
    if any(key in values for key in _OF_JOINTS):
        found.append("acceleration_order_1" if np.all(speed) else "angle_error_order_1")
    return found


def _motion_of(name: str) -> quantities.MotionQuantity | quantities.OrderQuantity:
    """The quantity of the motion, or of one order of it."""
    return quantities.order_quantity(name) or quantities.MOTION_QUANTITIES[name]


def _output_of(name: str) -> Output | None:
    """The output of a figure; ``None`` of one of the motion."""
    reduced = quantities.reduced_quantity(name)
    return reduced.output if reduced else OUTPUTS.get(name)


def _limits(values: Mapping[str, Any], of: list[str], limits: Limits) -> Any:  # noqa: ANN401
    """The limit of each figure in SI units: the scene's own, or those of its section [limits]."""
    found: dict[str, float] = {}
    for name in of:
        quantity = quantities.MOTION_QUANTITIES.get(name)
        if quantity is None or quantity.limit not in limits.figures:
            continue
        limit = limits.figures[quantity.limit].limit
        if not quantity.needs_speed:
            # All of them follow from the bend of a joint.
            limit = float(quantity.ratio(quantities.modulus_of_bend(np.radians(limit))))
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


def _size(meaning: str, argument: str, per: str = "joint") -> Key:
    return Key(rules.each(rules.NOT_NEGATIVE), meaning, argument, per=per)


TOLERANCES: Section[Toleranced] = Section(
    "tolerances",
    "accuracy of manufacture and assembly: each value is a ± tolerance",
    {
        "bends_deg": _size("tolerance of the bends: one number, or one per joint", "bends"),
        "twists_deg": _size(
            "tolerance of the twists: one number, or one per intermediate shaft",
            "twists",
            _BETWEEN,
        ),
        "phases_deg": _size(
            "tolerance of the yokes: one number, or one per intermediate shaft",
            "phases",
            _BETWEEN,
        ),
        "points_mm": _size(
            "tolerance of every coordinate of the points: one number, or one per point; in place "
            "of bends_deg and twists_deg",
            "points",
            "point",
        ),
        "driving_yoke_deg": _size(
            "tolerance of the angle by which driving yokes lean, which [joints] gives as measured; "
            "one number, or one per joint",
            "driving_yoke",
        ),
        "cross_deg": _size("tolerance of the crosses", "cross"),
        "driven_yoke_deg": _size("tolerance of the driven yokes", "driven_yoke"),
        "driving_yoke_mm": _size(
            "in place of driving_yoke_deg: how far the ends of the pin may be off along the shaft, "
            "in opposite directions, at arm_mm",
            "driving_yoke",
        ),
        "cross_mm": _size("likewise in place of cross_deg", "cross"),
        "driven_yoke_mm": _size("likewise in place of driven_yoke_deg", "driven_yoke"),
        "arm_mm": Key(
            rules.each(rules.SIZE),
            "distance of the middle of a pin's bearing from the centre of the joint: one number, "
            "or one per joint; default: that of [joints]",
            per="joint",
        ),
        "teeth": Key(
            rules.TOOTH_COUNTS,
            "teeth of the spline of each intermediate shaft, on which a yoke can only be set to "
            "within half a tooth: one number, or one per shaft",
            per=_BETWEEN,
        ),
        "distribution": Key(
            rules.OneOf(("uniform", "normal")),
            "uniform, or normal with the tolerance as three standard deviations",
            default="uniform",
        ),
        "of": Key(
            rules.OneOrMore(rules.ListOf(QuantityName(outputs=True), "names", distinct=True)),
            f"figures, from {', '.join(quantities.MOTION_QUANTITIES)}; orders of the last shaft, "
            "as angle_error_order_1 or acceleration_order_1; or outputs over a turn, as "
            "support_moment_1_peak. Default: equivalent_bend, and with tolerances of joints order "
            "1 of the acceleration, or of the angle error without a speed",
        ),
        "reduce": Key(
            rules.OneOf(REDUCTIONS),
            "of outputs that are named without a reduction, of the last shaft or of all joints: "
            f"{', '.join(REDUCTIONS)}",
            default="peak",
        ),
        "limit": Key(
            rules.POSITIVE,
            "limit of a single figure, in degrees for an angle, else in SI units; default: that of "
            "[limits]. Every driveline within the tolerances must meet it",
        ),
        "share": Key(
            rules.Number(0, 1, above=True),
            "share of the drivelines that must meet the limit, instead of all",
        ),
        "samples": Key(
            rules.Whole(1, most=100_000_000),
            "number of random drivelines; default: 100 000, or 16 384 where almost all of these "
            "meet the limit, or almost none",
        ),
        "seed": Key(rules.Whole(0, most=(1 << 32) - 1), "seed of their random numbers", default=0),
    },
    _toleranced,
    needed=(("bends_deg", "twists_deg", "phases_deg", "points_mm", "teeth", *_OF_JOINTS),),
    together=(("bends_deg", "points_mm"), ("twists_deg", "points_mm"), *IN_DEGREES_OR_MM.values()),
    always=True,
)

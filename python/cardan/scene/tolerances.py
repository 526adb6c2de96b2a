"""The section of a scene that says how exactly a driveline is made and assembled."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

import cardan.scene.values as kinds
from cardan.driveline import Driveline
from cardan.errors import ArgumentValueError
from cardan.limits import Limits
from cardan.load import Load
from cardan.outputs import OUTPUTS, Output
from cardan.quantities import MOTION_QUANTITIES, modulus_of_bend, reduced_quantity
from cardan.scene.sections import Key, Section
from cardan.tolerances import REDUCTIONS, Tolerances

TOLERANCES = Section(
    "how exactly the driveline is made and assembled: each figure is ± that much",
    {
        "bends_deg": Key(kinds.TOLERANCES, "of the bends: one number, or one per joint"),
        "twists_deg": Key(
            kinds.TOLERANCES, "of the twists: one number, or one per intermediate shaft"
        ),
        "phases_deg": Key(
            kinds.TOLERANCES, "of the yokes: one number, or one per intermediate shaft"
        ),
        "points_mm": Key(
            kinds.TOLERANCES,
            "of every coordinate of the points: one number, or one per point; in place of "
            "bends_deg and twists_deg",
        ),
        "teeth": Key(
            kinds.TEETH,
            "teeth of the spline of each intermediate shaft, on which a yoke can only be set to "
            "within half a tooth: one number, or one per shaft",
        ),
        "distribution": Key(
            kinds.DISTRIBUTION,
            "uniform, or normal with the tolerance as three standard deviations",
            default="uniform",
        ),
        "of": Key(
            kinds.TOLERANCED,
            f"figures, from {', '.join(MOTION_QUANTITIES)}, or outputs over a turn, as "
            "support_moment_1_peak; default: equivalent_bend",
        ),
        "reduce": Key(
            kinds.WORST_REDUCED,
            "of outputs that are named without it, of the last shaft or of all joints: "
            f"{', '.join(REDUCTIONS)}",
            default="peak",
        ),
        "limit": Key(
            kinds.POSITIVE,
            "of the only figure: degrees for an angle, else SI units; default: that of [limits]",
        ),
        "samples": Key(kinds.SAMPLES, "random drivelines", default=100_000),
        "seed": Key(kinds.SEED, "of their random numbers", default=0),
    },
    needed=(("bends_deg", "twists_deg", "phases_deg", "points_mm", "teeth"),),
    together=(("bends_deg", "points_mm"), ("twists_deg", "points_mm")),
)
"""The section [tolerances]."""

_ANGLES = {"bends_deg": "bends", "twists_deg": "twists", "phases_deg": "phases"}


def tolerances_of(
    values: Mapping[str, Any], line: Driveline, limits: Limits, load: Load | None, speed: float
) -> Tolerances:
    """Return the tolerances that the keys of the section describe.

    Args:
        values: values by key.
        line: the driveline of the scene, with lengths in metres.
        limits: of the scene.
        load: of the scene, if it has one.
        speed: of the drive in rad/s, 0 if it is not known.

    Raises:
        ValueError: recorded bends, as ``Driveline.tolerances`` with the key as the argument.
    """
    if line.shape:
        raise ValueError("it does not go with recorded bends, which differ by sample")
    _check_lengths(values, line.n_joints)
    of = values.get("of", ["equivalent_bend"])
    for name in of:
        output = _output_of(name)
        if output and output.needs_load and load is None:
            raise ArgumentValueError("of", f"has {name!r}, which needs a section [load]")
        if not output and MOTION_QUANTITIES[name].needs_speed and not speed:
            raise ArgumentValueError("of", f"has {name!r}, which needs a speed in [load]")
        if output and load is not None and np.ndim(load.speed + load.torque):
            raise ArgumentValueError("of", f"has {name!r}, which does not go with a recorded load")
    given: dict[str, Any] = {
        argument: np.radians(values[key]) for key, argument in _ANGLES.items() if key in values
    }
    if "points_mm" in values:
        size = 1e-3 * np.asarray(values["points_mm"], dtype=float)
        given["points"] = size if size.ndim == 0 else size[:, np.newaxis]
    keys = {argument: key for key, argument in _ANGLES.items()} | {"points": "points_mm"}
    try:
        return line.tolerances(
            **given,
            teeth=values.get("teeth"),
            distribution=values.get("distribution", "uniform"),
            of=of[0] if len(of) == 1 else of,
            reduce=values.get("reduce", "peak"),
            limit=_limits(values, of, limits),
            speed=speed,
            load=load,
            samples=values.get("samples", 100_000),
            seed=values.get("seed", 0),
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
        unit = output.unit if output else MOTION_QUANTITIES[of[0]].unit
        found[of[0]] = np.radians(values["limit"]) if unit == "rad" else values["limit"]
    return found if len(of) > 1 else found.get(of[0])

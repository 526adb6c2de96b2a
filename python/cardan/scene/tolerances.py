"""What a scene's tolerances make of its driveline, in all of its states."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from cardan.driveline import Driveline
from cardan.errors import ArgumentValueError
from cardan.limits import Limits
from cardan.load import Load
from cardan.outputs import OUTPUTS, Output
from cardan.quantities import MOTION_QUANTITIES, modulus_of_bend
from cardan.reduced_quantities import reduced_quantity
from cardan.scene.parts import largest_speed
from cardan.scene.states import States
from cardan.tolerances import Tolerances

_ANGLES = {"bends_deg": "bends", "twists_deg": "twists", "phases_deg": "phases"}


def tolerances_of(
    values: Mapping[str, Any],
    line: Driveline,
    limits: Limits,
    load: Load | None,
    states: States | None,
) -> Tolerances:
    """Return the tolerances that the keys of the section describe.

    Args:
        values: values by key.
        line: the driveline of the scene, with lengths in metres.
        limits: of the scene.
        load: of the scene, if it has one.
        states: of the scene, if it has any; the driveline of [driveline] may be none of them.

    Raises:
        ValueError: recorded bends, as ``Driveline.tolerances`` with the key as the argument.
    """
    if line.shape:
        raise ValueError("it does not go with recorded bends, which differ by sample")
    _check_lengths(values, line.n_joints)
    # Of a recorded speed the largest counts.
    speed: Any = largest_speed(load)
    if states:
        line, load = states.drivelines(), states.loads(load)
        speed = speed if load is None or load.speed.shape != line.shape else load.speed
    of = values.get("of", ["equivalent_bend"])
    for name in of:
        output = _output_of(name)
        if output and output.needs_load and load is None:
            raise ArgumentValueError("of", f"has {name!r}, which needs a section [load]")
        if not output and MOTION_QUANTITIES[name].needs_speed and not np.all(speed):
            raise ArgumentValueError("of", f"has {name!r}, which needs a speed in [load]")
        if output and load is not None and (load.speed + load.torque).shape not in ((), line.shape):
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
            states=None if states is None else 0,
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

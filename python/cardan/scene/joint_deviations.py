"""What a scene says of its joints as built."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

import cardan.scene.values as kinds
from cardan.arrays import FloatArray
from cardan.driveline import Driveline
from cardan.errors import ArgumentValueError
from cardan.outputs import OUTPUTS
from cardan.scene.sections import Key

OF_DEVIATIONS: Mapping[str, Key] = {
    "driving_yoke_deg": Key(
        kinds.DEVIATIONS,
        "as built: angle by which the driving pin leans from the normal of the driving shaft "
        "towards the driven one",
    ),
    "cross_deg": Key(
        kinds.DEVIATIONS, "as built: angle by which the pins of the cross are closer than 90 deg"
    ),
    "driven_yoke_deg": Key(
        kinds.DEVIATIONS,
        "as built: angle by which the driven pin leans from the normal of the driven shaft "
        "towards its driven end",
    ),
}
"""The keys of [joints] that say how they deviate, in the order of ``Driveline.deviations``."""

# Sections whose figures are those of ideal joints.
_IDEAL_ONLY = ("study", "states", "optimise")


def deviations_of(
    values: Mapping[str, Any], line: Driveline, sections: Iterable[str]
) -> FloatArray | None:
    """Return the deviations of the joints in rad, ``(n, 3)``; ``None`` if none are given.

    Args:
        values: of [joints], by key.
        line: the driveline.
        sections: names of the scene's other sections.

    Raises:
        ValueError: lists that do not have one value per joint, a joint that cannot turn, a section
            that does not go with them.
    """
    given = [key for key in OF_DEVIATIONS if key in values]
    if not given:
        return None
    for section in _IDEAL_ONLY:
        if section in sections:
            raise ArgumentValueError(
                given[0], f"does not go with [{section}], whose figures are those of ideal joints"
            )
    n = line.n_joints
    for key in given:
        if isinstance(values[key], list) and len(values[key]) != n:
            raise ArgumentValueError(
                key, f"has length {len(values[key])}; it needs {n}, one per joint"
            )
    each = [np.broadcast_to(np.radians(values.get(key, 0.0)), n) for key in OF_DEVIATIONS]
    try:
        line.with_deviations(*each)
    except ArgumentValueError as error:
        raise ArgumentValueError(given[0], f"and the others {error.problem}", ()) from None
    return np.stack(each, axis=-1)


def check_as_built(quantities: Iterable[str], options: Mapping[str, Any]) -> None:
    """Refuse outputs that joints as built do not have.

    Raises:
        ValueError: forces, axes of shafts, angles of the driven shaft.
    """
    for i, name in enumerate(quantities):
        if OUTPUTS[name].unit == "N":
            problem = f"is {name!r}, which joints with deviations do not have"
            raise ArgumentValueError("quantities", problem, (i,))
    for key, ideal in (("axes", "space"), ("angle_of", "drive")):
        if options.get(key, ideal) != ideal:
            raise ArgumentValueError(
                key, f"is {options[key]!r}; joints with deviations have {ideal!r} only"
            )

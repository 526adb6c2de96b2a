"""What a scene says of its joints as built."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np

import cardan.app.scene.language.values as kinds
from cardan.app.scene.language.section import Key
from cardan.arrays import FloatArray
from cardan.arrays.errors import ArgumentValueError
from cardan.driveline import Driveline
from cardan.tolerances import JOINT_GROUPS

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
    "driving_yoke_mm": Key(
        kinds.DISTANCES,
        "in place of driving_yoke_deg: how far one end of the pin is off along the shaft, and the "
        "other end the other way, at arm_mm",
    ),
    "cross_mm": Key(kinds.DISTANCES, "likewise in place of cross_deg"),
    "driven_yoke_mm": Key(kinds.DISTANCES, "likewise in place of driven_yoke_deg"),
}
"""The keys of [joints] that say how they deviate, in the order of ``Driveline.deviations``."""

IN_DEGREES_OR_MM = tuple((f"{group}_deg", f"{group}_mm") for group in JOINT_GROUPS)
"""Pairs of keys of which at most one is given."""


def deviations_of(
    values: Mapping[str, Any],
    line: Driveline,
    sections: Iterable[str],
    arms: FloatArray | None,
) -> FloatArray | None:
    """Return the deviations of the joints in rad, ``(n, 3)``; ``None`` if none are given.

    Args:
        values: of [joints], by key.
        line: the driveline.
        sections: names of the scene's other sections.
        arms: of the joints in m, if they are known.

    Raises:
        ValueError: lists that do not have one value per joint, lengths without an arm, a joint that
            cannot turn, a section that does not go with them.
    """
    given = [key for key in OF_DEVIATIONS if key in values]
    if not given:
        return None
    if "optimise" in sections:
        raise ArgumentValueError(
            given[0],
            "does not go with [optimise], which searches drivelines of ideal joints; leave the "
            "deviations out, or use cardan.optimise in Python, which takes joints as built",
        )
    n = line.n_joints
    angles = angles_of(values, n, arms)
    each = [angles.get(group, np.zeros(n)) for group in JOINT_GROUPS]
    try:
        line.with_deviations(*each)
    except ArgumentValueError as error:
        raise ArgumentValueError(given[0], f"and the others {error.problem}", ()) from None
    return np.stack(each, axis=-1)


def angles_of(values: Mapping[str, Any], n: int, arms: FloatArray | None) -> dict[str, FloatArray]:
    """Return deviations, or their tolerances, in rad by group, ``(n,)`` each.

    Args:
        values: of a section, by key in degrees or mm.
        n: number of joints.
        arms: of the joints in m, if they are known.

    Raises:
        ValueError: lists that do not have one value per joint, lengths without an arm.
    """
    found: dict[str, FloatArray] = {}
    for group, (degrees, mm) in zip(JOINT_GROUPS, IN_DEGREES_OR_MM, strict=True):
        key = degrees if degrees in values else mm
        if key not in values:
            continue
        if isinstance(values[key], list) and len(values[key]) != n:
            raise ArgumentValueError(
                key, f"has length {len(values[key])}; it needs {n}, one per joint"
            )
        size = np.broadcast_to(np.asarray(values[key], dtype=float), n)
        if key == degrees:
            found[group] = np.radians(size)
        elif arms is None:
            raise ArgumentValueError(
                key, "needs arm_mm, the distance of a pin's bearing from the centre of the joint"
            )
        else:
            found[group] = 1e-3 * size / arms
    return found


def arms_of(values: Mapping[str, Any], n: int, known: Sequence[float | None]) -> FloatArray | None:
    """Return the arms of the joints in m, ``(n,)``: those of a section, or else known ones.

    Args:
        values: of the section, by key.
        n: number of joints.
        known: arm of each joint in m where it is known; empty without sizes.

    Raises:
        ValueError: a list that does not have one value per joint.
    """
    own = values.get("arm_mm")
    if own is not None:
        if isinstance(own, list) and len(own) != n:
            raise ArgumentValueError(
                "arm_mm", f"has length {len(own)}; it needs {n}, one per joint"
            )
        return 1e-3 * np.broadcast_to(np.asarray(own, dtype=float), n)
    return np.array(known, dtype=float) if known and None not in known else None


def arms_of_lengths(values: Mapping[str, Any], arms: FloatArray | None) -> dict[str, FloatArray]:
    """Return the arms in m by the groups that a section gives as lengths."""
    pairs = zip(JOINT_GROUPS, IN_DEGREES_OR_MM, strict=True)
    return {group: arms for group, (_, mm) in pairs if mm in values and arms is not None}


def in_mm(sections: Mapping[str, Mapping[str, Any]]) -> bool:
    """Whether a scene gives deviations, their tolerances or play as lengths, which need an arm."""
    keys = {"play_mm", *(mm for _, mm in IN_DEGREES_OR_MM)}
    return any(not keys.isdisjoint(sections.get(name, {})) for name in ("joints", "tolerances"))


def check_as_built(options: Mapping[str, Any]) -> None:
    """Refuse options that drivelines of joints as built do not take.

    Raises:
        ValueError: axes of shafts, angles of the driven shaft.
    """
    for key, ideal in (("axes", "space"), ("angle_of", "drive")):
        if options.get(key, ideal) != ideal:
            raise ArgumentValueError(
                key, f"is {options[key]!r}; joints with deviations have {ideal!r} only"
            )

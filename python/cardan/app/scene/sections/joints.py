"""The section of a scene that describes the joints themselves: sizes, bearings, deviations."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import cardan.app.scene.language.values as kinds
from cardan.app.scene.language.section import Key, Section
from cardan.app.scene.sections.backlash import OF_PLAY
from cardan.app.scene.sections.joint_deviations import IN_DEGREES_OR_MM, OF_DEVIATIONS
from cardan.app.scene.sections.sizes import FRICTION, OF_SIZE, JointSize, read_sizes, size_of
from cardan.arrays.errors import ArgumentValueError, nearest

JOINTS = Section(
    "sizes and bearings of the joints, for their life and heat, and how they deviate from their "
    "drawing; each value is one for all joints or a list with one per joint",
    {
        "sizes": Key(
            kinds.SIZES_FILE,
            "your own table of sizes, a CSV file with a column size and columns named like the "
            "keys below; path from the folder of the scene",
        ),
        "size": Key(kinds.SIZE_NAMES, "with sizes: which size the joints have"),
        **OF_SIZE,
        **OF_DEVIATIONS,
        **OF_PLAY,
    },
    together=IN_DEGREES_OR_MM,
    fewest=1,
    with_key=(("size", "sizes"), ("stiffness_Nm_per_rad", "play_mm")),
)
"""The section [joints]."""


@dataclass(frozen=True)
class Joints:
    """The joints of a scene.

    Attributes:
        each: size of each joint; empty if the scene only has a table from which to choose.
        table: the sizes from which to choose, by growing rating; those without a rating first.
    """

    each: tuple[JointSize, ...]
    table: tuple[JointSize, ...]


def joints_of(values: Mapping[str, Any], joints: int, folder: Path) -> Joints:
    """Return the joints that the keys of the section describe.

    Args:
        values: values by key.
        joints: their number.
        folder: from which the path of the table begins.

    Raises:
        OSError: the table cannot be read.
        ValueError: lists that do not have one value per joint, a size that the table lacks, a part
            of what the losses need, a table that is none.
    """
    for key, value in values.items():
        if isinstance(value, list) and len(value) != joints:
            raise ArgumentValueError(
                key, f"has length {len(value)}; it needs {joints}, one per joint"
            )
    table = read_sizes(folder / values["sizes"]) if "sizes" in values else ()
    own = {key: value for key, value in values.items() if key in OF_SIZE}
    table = tuple(sorted(table, key=lambda size: size.rating or 0.0))
    if "size" not in values and not own:
        return Joints((), table)
    each = tuple(_joint(values, own, table, joint) for joint in range(joints))
    for joint, size in enumerate(each):
        given = [key for key in FRICTION if getattr(size, OF_SIZE[key].argument) is not None]
        if given and not size.rubs:
            missing = next(key for key in FRICTION if key not in given)
            raise ArgumentValueError(
                missing,
                f"is missing for joint {joint}, which has {given[0]}; losses need {_and(FRICTION)}",
            )
    return Joints(each, table)


def _joint(
    values: Mapping[str, Any], own: Mapping[str, Any], table: tuple[JointSize, ...], joint: int
) -> JointSize:
    """One joint: its row of the table, with what the scene says instead."""
    described = size_of("", {key: _of_joint(value, joint) for key, value in own.items()})
    if "size" not in values:
        return described
    name = _of_joint(values["size"], joint)
    rows = {size.name: size for size in table}
    if name not in rows:
        place = (joint,) if isinstance(values["size"], list) else ()
        raise ArgumentValueError("size", f"is {name!r}; {nearest(name, list(rows))}", place)
    changes = {OF_SIZE[key].argument: getattr(described, OF_SIZE[key].argument) for key in own}
    return replace(rows[name], **changes)


def _of_joint(value: Any, joint: int) -> Any:  # noqa: ANN401 - a value or a list of them
    return value[joint] if isinstance(value, list) else value


def _and(names: tuple[str, ...]) -> str:
    return f"{', '.join(names[:-1])} and {names[-1]}"

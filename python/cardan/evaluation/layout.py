"""Where the outputs of a plan lie among the planes of its result, and of which items they are."""

from __future__ import annotations

import functools
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from cardan.arrays.indices import Items, is_index, item_indices
from cardan.arrays.planes import PlanePlace
from cardan.evaluation import outputs
from cardan.evaluation.request import Reduction, checked_reduction

# Lists of the joints of longer drivelines would take too much memory to be remembered.
_LONGEST = 64


@dataclass(frozen=True, slots=True)
class Layout:
    """What a plan knows of its result before it knows the driveline.

    Attributes:
        names: the outputs.
        shafts: the shafts of the outputs per shaft.
        joints: the joints of the outputs per joint.
        shown: the same as asked for, an index or a list.
        places: where each output lies among the planes.
        planes: the number of planes.
        shapes: the number of items of each output, if it has an axis for them, and whether it is a
            vector.
    """

    names: tuple[str, ...]
    shafts: list[int]
    joints: list[int]
    shown: tuple[int | list[int], int | list[int]]
    places: Mapping[str, PlanePlace]
    planes: int
    shapes: list[tuple[int | None, bool]]


def layout_of(
    names: str | Iterable[str],
    n: int,
    shafts: Items,
    joints: Items,
    reduce: Reduction | None,
    bearings: int,
) -> Layout:
    """Return the layout of outputs of a driveline with ``n`` joints.

    Args:
        names: names of outputs.
        n: number of joints.
        shafts: shafts for the outputs per shaft; the last by default.
        joints: joints for the outputs per joint; all by default.
        reduce: what rows of samples are reduced to.
        bearings: number of bearings.

    Raises:
        IndexError: a shaft or joint that does not exist.
        TypeError: names or indices of another type.
        ValueError: an unknown or repeated name, an unknown reduction.
    """
    names = names if isinstance(names, str) else tuple(names)
    # Of plain arguments only those are equal that mean the same; 1.0 is no index.
    one_shaft = shafts is None or type(shafts) is int
    if n <= _LONGEST and one_shaft and (joints is None or type(joints) is int):
        try:
            key = (names, n, shafts, joints, reduce, bearings)
            return _remembered(*key)  # type: ignore[arg-type]
        except TypeError:
            pass  # What is wrong is said below: here it may be that a name has no hash.
    return _layout(names, n, shafts, joints, reduce, bearings)


def _layout(
    names: str | tuple[str, ...],
    n: int,
    shafts: Items,
    joints: Items,
    reduce: Reduction | None,
    bearings: int,
) -> Layout:
    listed = tuple(map(str, outputs.checked(names)))
    # The last shaft is asked for, not a list of one.
    one_shaft = shafts is None or is_index(shafts)
    one_joint = joints is not None and is_index(joints)
    shaft_items = [n] if shafts is None else item_indices("shafts", shafts, n + 1)
    joint_items = [*range(n)] if joints is None else item_indices("joints", joints, n)
    checked_reduction(reduce)
    places: dict[str, PlanePlace] = {}
    first = 0
    for name in listed:
        output = outputs.OUTPUTS[name]
        vector = output.vector and reduce != "peak"
        if output.per == "bearing":
            count, one = bearings, False
        elif output.per == "shaft":
            count, one = len(shaft_items), one_shaft
        else:
            count, one = len(joint_items), one_joint
        items = None if one else count
        places[name] = (first, items, vector)
        first += 3 * count if vector else count
    shown = (
        shaft_items[0] if one_shaft else shaft_items,
        joint_items[0] if one_joint else joint_items,
    )
    shapes = [(items, vector) for _, items, vector in places.values()]
    return Layout(listed, shaft_items, joint_items, shown, places, first, shapes)


_remembered = functools.lru_cache(maxsize=256)(_layout)

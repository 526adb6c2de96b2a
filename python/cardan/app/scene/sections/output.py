"""What a scene asks for: its quantities, shafts and joints."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from cardan.app.scene.language.document import Document
from cardan.app.scene.sections.bearing import LENGTHS_NEEDED, has_lengths
from cardan.app.scene.sections.table import BEND_COLUMNS, DRIVE_ANGLES
from cardan.arrays.errors import ArgumentValueError
from cardan.driveline import Driveline
from cardan.evaluation.load import Load
from cardan.evaluation.outputs import OUTPUTS


def check_sections(document: Document, *, alone: bool) -> None:
    """Refuse sections that are missing or do not go together.

    Args:
        document: the scene file.
        alone: whether it describes a ball joint and no driveline.

    Raises:
        ValueError: no driveline, two sections for the drive angles, a study of states.
    """
    given = document.sections
    if "driveline" not in given and not given.get("angles", {}).keys() & set(BEND_COLUMNS):
        instead = (
            "; a ball joint alone can be run, checked, plotted and reported "
            "(in Python: cardan.scene.load_scene)"
        )
        raise ValueError(
            "section [driveline] is missing; it describes the joints and shafts"
            + (instead if alone else "")
        )
    if given.keys() >= {"study", "states"}:
        raise ValueError(
            "sections [study] and [states] are both given; a study varies the design, states are "
            "positions of one design: give one of them"
        )
    if given.keys() >= set(DRIVE_ANGLES):
        both = " and ".join(f"[{section}]" for section in DRIVE_ANGLES)
        raise ValueError(f"sections {both} are both given; give one of them")


def requested(output: Mapping[str, Any], load: Mapping[str, Any] | None) -> tuple[str, ...]:
    """Return the quantities of a scene.

    Args:
        output: values by key of [output].
        load: those of the load, if any.

    Raises:
        ValueError: a quantity that needs a load.
    """
    if "quantities" not in output:
        return ("angle_error", "speed_ratio", "acceleration_ratio", *_caused(load))
    for i, name in enumerate(output["quantities"]):
        if load is None and OUTPUTS[name].needs_load:
            raise ArgumentValueError("quantities", f"is {name!r}; it needs a section [load]", (i,))
    return tuple(output["quantities"])


def to_reduce(
    output: Mapping[str, Any], quantities: tuple[str, ...], load: Mapping[str, Any] | None
) -> tuple[str, ...]:
    """Return the quantities that a study reduces.

    Motion is in the closed forms already, unless the scene asks for it.
    """
    asked = "quantities" in output or "reduce" in output
    return quantities if asked else _caused(load)


def _caused(load: Mapping[str, Any] | None) -> tuple[str, ...]:
    loaded = load is not None and any("torque" in key or "inertia" in key for key in load)
    return ("torque", "moment") if loaded else ()


def items(output: Mapping[str, Any], key: str, count: int) -> tuple[int, ...] | None:
    """Return the shafts or joints that a scene names, ``None`` where it names none.

    Raises:
        ValueError: one that does not exist.
    """
    for i, item in enumerate(output.get(key, ())):
        if item >= count:
            raise ArgumentValueError(key, f"is {item}; there are {count}, counted from 0", (i,))
    return tuple(output[key]) if key in output else None


def check_forces(
    quantities: Iterable[str], line: Driveline, load: Load | None, joints: Sequence[int] | None
) -> None:
    """Refuse forces that the driveline does not determine.

    Raises:
        ValueError: the first such quantity, with the reason.
    """
    for i, name in enumerate(quantities):
        if OUTPUTS[name].unit != "N":
            continue
        if not has_lengths(line):
            raise ArgumentValueError("quantities", f"is {name!r}; it needs {LENGTHS_NEEDED}", (i,))
        try:
            line.plan(name, load=load, joints=None if joints is None else list(joints))
        except ArgumentValueError as error:
            raise ArgumentValueError("quantities", error.problem, (i,)) from None


def is_alone(document: Document) -> bool:
    """Whether a document describes a ball joint and no driveline."""
    given = document.sections
    return "ball_joint" in given and not given.keys() & {"driveline", "angles"}

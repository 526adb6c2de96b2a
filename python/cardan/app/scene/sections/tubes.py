"""The tubes of a scene: the round sections of its shafts."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from cardan.app.scene.sections.bearing import LENGTHS_NEEDED, has_lengths
from cardan.app.scene.sections.tubes_section import TUBES
from cardan.arrays import FloatArray
from cardan.arrays.errors import ArgumentValueError
from cardan.driveline import Driveline
from cardan.torsion import Tube, tube


@dataclass(frozen=True, eq=False)
class Tubes:
    """The tubes of a scene.

    Attributes:
        shafts: which shafts.
        given: what makes them, each ``(shafts,)``; no length if that of the driveline counts.
        tube: their figures in the driveline of the drawing, ``(shafts,)``.
        permitted_stress: in Pa; ``None`` if the scene permits any.
        least_margin: of the critical speed over the largest speed; ``None`` if any will do.
    """

    shafts: tuple[int, ...]
    given: Mapping[str, FloatArray]
    tube: Tube
    permitted_stress: float | None
    least_margin: float | None

    def critical_speed(self, line: Driveline) -> FloatArray:
        """Return the critical bending speeds in rad/s in other drivelines, ``(..., shafts)``."""
        if "length" in self.given or not has_lengths(line):
            return np.broadcast_to(self.tube.critical_speed, (*line.shape, len(self.shafts)))
        lengths = line.lengths().each[..., list(self.shafts)]
        return np.asarray(tube(**self.given, length=lengths).critical_speed)


def tubes_of(values: Mapping[str, Any], line: Driveline) -> Tubes:
    """Return the tubes that the keys of the section describe.

    Args:
        values: values by key.
        line: the driveline, with lengths in m if they are known.

    Raises:
        ValueError: a shaft that does not exist, lists that do not have one value per listed shaft,
            a length that neither the section nor the driveline gives, a wall that is too thick.
    """
    joints = line.n_joints
    between = list(range(1, joints)) or [0, 1]
    shafts = values.get("shafts", between)
    for i, shaft in enumerate(shafts):
        if shaft > joints:
            raise ArgumentValueError(
                "shafts", f"is {shaft}; there are {joints + 1}, counted from 0", (i,)
            )
    given: dict[str, Any] = {}
    for name, key in TUBES.keys.items():
        if not key.argument or name not in values:
            continue
        value = values[name]
        if isinstance(value, list) and len(value) != len(shafts):
            raise ArgumentValueError(
                name, f"has length {len(value)}; it needs {len(shafts)}, one per listed shaft"
            )
        array = key.factor * np.asarray(value, dtype=np.float64)
        given[key.argument] = np.broadcast_to(array, (len(shafts),))
    lengths = {}
    if "length" not in given:
        if not has_lengths(line):
            raise ArgumentValueError("length_mm", f"is missing; give it, or {LENGTHS_NEEDED}")
        if line.shape:
            raise ArgumentValueError("length_mm", "is missing; recorded bends have no lengths")
        lengths = {"length": line.lengths().each[..., list(shafts)]}
    try:
        found = tube(**given, **lengths)
    except ArgumentValueError as error:
        # In millimetres, as the file has it.
        wall, outer = (1e3 * given[name][error.place] for name in ("wall", "outer_diameter"))
        problem = f"is {wall:.6g} mm; a wall is at most half the outer diameter of {outer:.6g} mm"
        place = error.place if isinstance(values["wall_mm"], list) else ()
        raise ArgumentValueError("wall_mm", problem, place) from None
    stress = values.get("permitted_stress_MPa")
    return Tubes(
        tuple(shafts),
        given,
        found,
        None if stress is None else 1e6 * stress,
        values.get("least_margin"),
    )

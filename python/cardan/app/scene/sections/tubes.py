"""The section [tubes]: the round sections of shafts."""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from cardan.app.scene.language.rules import INDICES, POSITIVE, SIZE, each
from cardan.app.scene.language.section import Key, Reading, Section, check_count, check_exists
from cardan.app.scene.sections.driveline import LENGTHS_NEEDED, has_lengths
from cardan.arrays import FloatArray
from cardan.arrays.errors import ArgumentValueError
from cardan.driveline import Driveline
from cardan.torsion import Tube, tube


@dataclass(frozen=True, eq=False)
class Tubes:
    """Inputs of tubes, and their figures as drawn, ``(shafts,)`` each; the stress is in Pa.

    No length is given where that of the driveline counts. The least margin is that of the critical
    speed over the largest speed. The margin of the resonance is the least distance of the speeds
    from half the critical speed, in shares of that half.
    """

    shafts: tuple[int, ...]
    given: Mapping[str, FloatArray]
    tube: Tube
    permitted_stress: float | None
    least_margin: float | None
    resonance_margin: float | None

    def critical_speed(self, line: Driveline) -> FloatArray:
        """Return the critical bending speeds in rad/s in other drivelines, ``(..., shafts)``."""
        if "length" in self.given or not has_lengths(line):
            return np.broadcast_to(self.tube.critical_speed, (*line.shape, len(self.shafts)))
        lengths = line.lengths().each[..., list(self.shafts)]
        return np.asarray(_made({**self.given, "length": lengths}).critical_speed)


def _made(given: Mapping[str, Any]) -> Tube:
    """Return tubes without a warning of wide ones, on which the answer remarks."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return tube(**given)


def _tubes(values: Mapping[str, Any], scene: Reading) -> Tubes:
    line = scene.line
    shafts = values.get("shafts", list(range(1, line.n_joints)) or [0, 1])
    for i, shaft in enumerate(shafts):
        check_exists("shafts", shaft, line.n_joints + 1, (i,))
    for key, value in values.items():
        if TUBES.keys[key].argument:
            check_count(key, value, len(shafts), "one per listed shaft")
    given = {
        argument: np.broadcast_to(np.asarray(value, dtype=np.float64), (len(shafts),))
        for argument, value in TUBES.arguments(values).items()
    }
    lengths = {}
    if "length" not in given:
        if not has_lengths(line):
            raise ArgumentValueError("length_mm", f"is missing; give it, or {LENGTHS_NEEDED}")
        if line.shape:
            raise ArgumentValueError("length_mm", "is missing; recorded bends have no lengths")
        lengths = {"length": line.lengths().each[..., list(shafts)]}
    try:
        found = _made(given | lengths)
    except ArgumentValueError as error:
        # In millimetres, as the file has it.
        place = tuple(map(int, error.place))
        wall, outer = (1e3 * given[name][place] for name in ("wall", "outer_diameter"))
        problem = f"is {wall:.6g} mm; a wall is at most half the outer diameter of {outer:.6g} mm"
        listed = isinstance(values["wall_mm"], list)
        raise ArgumentValueError("wall_mm", problem, place if listed else ()) from None
    stress = values.get("permitted_stress_MPa")
    margins = (values.get(key) for key in ("least_margin", "resonance_margin"))
    return Tubes(tuple(shafts), given, found, stress and 1e6 * stress, *margins)


TUBES: Section[Tubes | None] = Section(
    "tubes",
    "round sections of shafts, for stiffness, stress and critical bending speed; each value is one "
    "for all listed shafts or a list with one per listed shaft",
    {
        "shafts": Key(
            INDICES,
            "which shafts, counted from 0; default: those between joints, or all of one joint",
        ),
        "outer_diameter_mm": Key(each(SIZE), "outer diameter", "outer_diameter", 1e-3),
        "wall_mm": Key(
            each(SIZE), "thickness of the wall; default: the shafts are solid", "wall", 1e-3
        ),
        "length_mm": Key(
            each(POSITIVE),
            "free length of the tube; default: the length of the shaft in [driveline]",
            "length",
            1e-3,
        ),
        "shear_modulus_GPa": Key(
            each(POSITIVE), "shear modulus", "shear_modulus", 1e9, default=79.3
        ),
        "elastic_modulus_GPa": Key(
            each(POSITIVE), "elastic modulus", "elastic_modulus", 1e9, default=206
        ),
        "density_kg_m3": Key(each(POSITIVE), "density", "density", default=7850),
        "permitted_stress_MPa": Key(
            POSITIVE,
            "largest permitted shear stress of the tubes by the torque, with torsional vibration "
            "as well where a check searches for it",
        ),
        "least_margin": Key(
            POSITIVE, "least permitted ratio of the critical bending speed to the largest speed"
        ),
        "resonance_margin": Key(
            POSITIVE,
            "least distance of the speeds from half the critical bending speed, in shares of that "
            "half, such as 0.15",
        ),
    },
    _tubes,
    needed=(("outer_diameter_mm",),),
)

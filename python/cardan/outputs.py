"""The quantities that can be evaluated, each named once."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal


@dataclass(frozen=True)
class Output:
    """What an output is.

    Attributes:
        name: the name to ask for it by.
        per: ``"shaft"`` or ``"joint"``.
        unit: SI unit; ``"1"`` for a ratio.
        meaning: one line.
        vector: whether it has three components.
        needs_load: whether ``evaluate`` needs ``load=``.
    """

    name: str
    per: Literal["shaft", "joint"]
    unit: str
    meaning: str
    vector: bool = False
    needs_load: bool = False

    @property
    def label(self) -> str:
        """What to call it in tables and pictures: ``bending, driving side``."""
        sides = self.name.replace("_driving", ", driving side").replace("_driven", ", driven side")
        return sides.replace("_", " ")


OUTPUTS: Mapping[str, Output] = MappingProxyType(
    {
        output.name: output
        for output in (
            Output("angle", "shaft", "rad", "rotation, mean-synchronous with the drive"),
            Output("angle_error", "shaft", "rad", "rotation less the drive angle, mean zero"),
            Output("speed_ratio", "shaft", "1", "speed over that of the drive"),
            Output(
                "acceleration_ratio",
                "shaft",
                "1",
                "second derivative of the rotation by the drive angle; times the square of the "
                "drive speed it is the acceleration at constant drive speed",
            ),
            Output("torque", "shaft", "N m", "torsion entering the shaft", needs_load=True),
            Output(
                "support_moment",
                "shaft",
                "N m",
                "vector that the bearings must give the shaft",
                vector=True,
                needs_load=True,
            ),
            Output(
                "moment",
                "joint",
                "N m",
                "vector that the joint exerts on its driven shaft",
                vector=True,
                needs_load=True,
            ),
            Output(
                "bending_driving",
                "joint",
                "N m",
                "size of the bending moment in the driving shaft",
                needs_load=True,
            ),
            Output(
                "bending_driven",
                "joint",
                "N m",
                "size of the bending moment in the driven shaft",
                needs_load=True,
            ),
            Output("tilt_driving", "joint", "rad", "signed tilt of the cross, driving shaft"),
            Output("tilt_driven", "joint", "rad", "signed tilt of the cross, driven shaft"),
        )
    }
)
"""Every output by name, in the order of the documentation."""


def checked(names: str | Iterable[str]) -> tuple[str, ...]:
    """Return the output names as a tuple.

    Raises:
        TypeError: something that is not a name.
        ValueError: an unknown or repeated name, with the nearest known one.
    """
    listed = (names,) if isinstance(names, str) else tuple(names)
    for i, name in enumerate(listed):
        if not isinstance(name, str):
            raise TypeError(f"outputs[{i}] is {name!r}; an output is asked for by its name")
        if name not in OUTPUTS:
            raise ValueError(f"outputs[{i}] is {name!r}; {nearest(name, OUTPUTS)}")
        if name in listed[:i]:
            raise ValueError(f"outputs[{i}] is {name!r} again; name each output once")
    return listed


def nearest(name: str, known: Iterable[str]) -> str:
    """Say which known name is meant, or list them all."""
    known = list(known)
    close = difflib.get_close_matches(name, known, n=1)
    return f"did you mean {close[0]!r}?" if close else f"known are {', '.join(known)}"

"""The quantities that can be evaluated, each named once."""

from __future__ import annotations

import difflib
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Literal

from cardan.errors import ArgumentTypeError, ArgumentValueError


@dataclass(frozen=True)
class Output:
    """What an output is.

    Attributes:
        name: the name to ask for it by.
        per: ``"shaft"`` or ``"joint"``.
        unit: SI unit; ``"1"`` for a ratio.
        meaning: one line.
        source: its equation, with where it comes from; ``a`` is the driving angle of the joint, or
            of the one joint that is equivalent to the chain, ``b`` its bend.
        vector: whether it has three components.
        needs_load: whether ``evaluate`` needs ``load=``.
    """

    name: str
    per: Literal["shaft", "joint"]
    unit: str
    meaning: str
    source: str
    vector: bool = False
    needs_load: bool = False

    @property
    def components(self) -> int:
        """Numbers for each sample: three of a vector."""
        return 3 if self.vector else 1

    @property
    def label(self) -> str:
        """What to call it in tables and pictures: ``bending, driving side``."""
        sides = self.name.replace("_driving", ", driving side").replace("_driven", ", driven side")
        return sides.replace("_", " ")


class _Outputs(Mapping[str, Output]):
    """A read-only mapping that, unlike a mapping proxy, is pickled and copied as what it is."""

    __slots__ = ("_by_name",)

    def __init__(self, outputs: Iterable[Output]) -> None:
        self._by_name = {output.name: output for output in outputs}

    def __getitem__(self, name: str) -> Output:
        return self._by_name[name]

    def __contains__(self, name: object) -> bool:
        return name in self._by_name

    def __iter__(self) -> Iterator[str]:
        return iter(self._by_name)

    def __len__(self) -> int:
        return len(self._by_name)

    def __repr__(self) -> str:
        return f"<outputs {', '.join(self)}>"

    def __reduce__(self) -> str:
        return "OUTPUTS"


OUTPUTS: Mapping[str, Output] = _Outputs(
    (
        Output(
            "angle",
            "shaft",
            "rad",
            "rotation, mean-synchronous with the drive",
            "tan angle = tan a / cos b (Thoma 4, Grossmann 1)",
        ),
        Output(
            "angle_error",
            "shaft",
            "rad",
            "rotation less the drive angle, mean zero",
            "atan2((1 - cos b) sin a cos a, cos b cos² a + sin² a) (from Thoma 4; Bild 11)",
        ),
        Output(
            "speed_ratio",
            "shaft",
            "1",
            "speed over that of the drive",
            "cos b / (cos² b cos² a + sin² a) (from Thoma 4)",
        ),
        Output(
            "acceleration_ratio",
            "shaft",
            "1",
            "second derivative of the rotation by the drive angle; times the square of the "
            "drive speed it is the acceleration at constant drive speed",
            "-2 cos b sin² b sin a cos a / (cos² b cos² a + sin² a)² (from Thoma 4)",
        ),
        Output(
            "torque",
            "shaft",
            "N m",
            "torsion entering the shaft",
            "D / speed ratio of the joint (Grossmann 7), less what inertias take (Thoma 8)",
            needs_load=True,
        ),
        Output(
            "support_moment",
            "shaft",
            "N m",
            "vector that the bearings must give the shaft",
            "moment of the joint at its end less that at its start, without the part along it",
            vector=True,
            needs_load=True,
        ),
        Output(
            "moment",
            "joint",
            "N m",
            "vector that the joint exerts on its driven shaft",
            "D (u_in + tan b sin a (sin a e_in - cos a m)), normal to both pins (Thoma 5)",
            vector=True,
            needs_load=True,
        ),
        Output(
            "bending_driving",
            "joint",
            "N m",
            "size of the bending moment in the driving shaft",
            "D tan b |sin a| (Grossmann 6)",
            needs_load=True,
        ),
        Output(
            "bending_driven",
            "joint",
            "N m",
            "size of the bending moment in the driven shaft",
            "D sin b |cos a| √(1 + tan² b sin² a) (Grossmann 8)",
            needs_load=True,
        ),
        Output(
            "tilt_driving",
            "joint",
            "rad",
            "signed tilt of the cross, driving shaft",
            "tan tilt = tan b sin a (Grossmann 3)",
        ),
        Output(
            "tilt_driven",
            "joint",
            "rad",
            "signed tilt of the cross, driven shaft",
            "sin tilt = sin b cos a (Grossmann 5)",
        ),
    )
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
            raise ArgumentTypeError(
                "outputs", f"is {name!r}; an output is asked for by its name", (i,)
            )
        if name not in OUTPUTS:
            raise ArgumentValueError("outputs", f"is {name!r}; {nearest(name, OUTPUTS)}", (i,))
        if listed.index(name) < i:
            raise ArgumentValueError("outputs", f"is {name!r} again; name each output once", (i,))
    return listed


def nearest(name: str, known: Iterable[str]) -> str:
    """Say which known name is meant, or list them all."""
    known = list(known)
    close = difflib.get_close_matches(name, known, n=1)
    return f"did you mean {close[0]!r}?" if close else f"known are {', '.join(known)}"

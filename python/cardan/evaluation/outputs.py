"""The quantities that can be evaluated, each named once."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Literal

from cardan import _core
from cardan.arrays.errors import ArgumentTypeError, ArgumentValueError, nearest


@dataclass(frozen=True)
class Output:
    """What an output is.

    Attributes:
        name: the name by which to request it.
        per: ``"shaft"``, ``"joint"`` or ``"bearing"``.
        unit: SI unit; ``"1"`` for a ratio.
        meaning: one line.
        source: its equation, with where it comes from; ``a`` is the input angle of the joint,
            or of the single joint equivalent to the chain, and ``b`` its bend.
        axes: names of the components of a vector; empty for a scalar.
        needs_load: whether ``evaluate`` needs ``load=``.
        ideal: whether only ideal joints have it.
    """

    name: str
    per: Literal["shaft", "joint", "bearing"]
    unit: str
    meaning: str
    source: str
    axes: tuple[str, ...] = ()
    needs_load: bool = False
    ideal: bool = False

    @property
    def vector(self) -> bool:
        """Whether it has three components."""
        return bool(self.axes)

    @property
    def components(self) -> int:
        """How many numbers it is: 3 for a vector, else 1."""
        return len(self.axes) or 1

    @property
    def of_cross(self) -> bool:
        """Whether it says where the cross of a joint stands, which half a turn turns over."""
        return self.per == "joint" and not self.needs_load

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


# What each output means, and its equation; the core's table says everything else.
_PROSE = {
    "angle": (
        "rotation, mean-synchronous with the drive",
        "tan angle = tan a / cos b (Thoma 4, Grossmann 1)",
    ),
    "angle_error": (
        "rotation minus the drive angle, with mean zero",
        "atan2((1 - cos b) sin a cos a, cos b cos² a + sin² a) (from Thoma 4; Bild 11)",
    ),
    "speed_ratio": (
        "speed over that of the drive",
        "cos b / (cos² b cos² a + sin² a) (from Thoma 4)",
    ),
    "acceleration_ratio": (
        "second derivative of the rotation by the drive angle; times the square of the "
        "drive speed it is the acceleration at constant drive speed",
        "-2 cos b sin² b sin a cos a / (cos² b cos² a + sin² a)² (from Thoma 4)",
    ),
    "jerk_ratio": (
        "third derivative of the rotation by the drive angle; times the cube of the "
        "drive speed it is the jerk at constant drive speed",
        "2 cos b sin² b (sin⁴ a + 3 sin² b sin² a cos² a - cos² b cos⁴ a) / "
        "(cos² b cos² a + sin² a)³ (derived here from Thoma 4)",
    ),
    "torque": (
        "torsion entering the shaft",
        "D / speed ratio of the joint (Grossmann 7), minus the share of the inertias (Thoma 8)",
    ),
    "support_moment": (
        "moment vector that the bearings must exert on the shaft",
        "moment of the joint at its end minus that at its start, without the part along the shaft",
    ),
    "moment": (
        "moment vector that the joint exerts on its driven shaft",
        "D (u_in + tan b sin a (sin a e_in - cos a m)), perpendicular to both pins (Thoma 5)",
    ),
    "bending_driving": (
        "magnitude of the bending moment in the driving shaft",
        "D tan b |sin a| (Grossmann 6)",
    ),
    "bending_driven": (
        "magnitude of the bending moment in the driven shaft",
        "D sin b |cos a| √(1 + tan² b sin² a) (Grossmann 8)",
    ),
    "pin_moment": (
        "magnitude of the moment vector, which the pins of both yokes bear",
        "D √(1 + tan² b sin² a), the length of the moment (Thoma 5)",
    ),
    "joint_force": (
        "force vector that the joint exerts on its driven shaft, across the shaft that it supports",
        "balance of that shaft; for a floating shaft of length L: (u x support moment) / L",
    ),
    "bearing_force": (
        "force vector that the bearing exerts on its shaft, across the shaft",
        "balance of the shaft: moments about its other support",
    ),
    "tilt_driving": (
        "signed tilt of the cross, driving shaft",
        "tan tilt = tan b sin a (Grossmann 3)",
    ),
    "tilt_driven": (
        "signed tilt of the cross, driven shaft",
        "sin tilt = sin b cos a (Grossmann 5)",
    ),
    "swing_driving": (
        "rate of the cross in the driving yoke per radian of the drive; the derivative of "
        "tilt_driving by the drive angle",
        "speed ratio of the driven shaft times sin tilt_driven (derived here from Grossmann 3)",
    ),
    "swing_driven": (
        "rate of the cross in the driven yoke per radian of the drive; the derivative of "
        "tilt_driven by the drive angle",
        "-(speed ratio of the driving shaft) sin tilt_driving (derived here from Grossmann 5)",
    ),
    "driving_pin": (
        "unit vector along the pin of the driving yoke",
        "cos a e_in + sin a m (Thoma, before 1)",
    ),
    "driven_pin": ("unit vector along the pin of the driven yoke", "unit(u_out x driving_pin)"),
}


def _rows() -> Iterator[Output]:
    for name, per, unit, components, needs_load, ideal in _core.outputs():
        meaning, source = _PROSE[name]
        named = tuple(filter(None, components))
        yield Output(name, per, unit, meaning, source, named, needs_load, ideal)


OUTPUTS: Mapping[str, Output] = _Outputs(_rows())
"""Every output by name, in the order of the documentation."""


def checked(names: str | Iterable[str]) -> tuple[str, ...]:
    """Return the names of outputs as a tuple, each known and once."""
    listed = (names,) if isinstance(names, str) else tuple(names)
    for i, name in enumerate(listed):
        if not isinstance(name, str):
            problem = f"is {name!r}; an output is asked for by its name"
            raise ArgumentTypeError("outputs", problem, (i,))
        if name not in OUTPUTS:
            raise ArgumentValueError("outputs", f"is {name!r}; {nearest(name, OUTPUTS)}", (i,))
        if listed.index(name) < i:
            raise ArgumentValueError("outputs", f"is {name!r} again; name each output once", (i,))
    return listed

"""The quantities that can be evaluated, each named once."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Literal

from cardan import _core
from cardan.arrays.errors import ArgumentTypeError, ArgumentValueError, nearest


@dataclass(frozen=True)
class Output:
    """Description of an output.

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
        """Name in tables and pictures: ``bending, driving side``."""
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
    Output(name, per, unit, meaning, source, tuple(axes), needs_load, ideal)
    for name, per, unit, meaning, source, axes, needs_load, ideal in _core.outputs()
)
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

from typing import TypeAlias, final

import numpy as np
from numpy.typing import NDArray

_Flat: TypeAlias = NDArray[np.float64]
_Broadcast: TypeAlias = tuple[_Flat, list[int]]

__all__ = [
    "Lines",
    "Plan",
    "Sweep",
    "__version__",
    "equivalent",
    "from_bends",
    "from_directions",
    "from_points",
    "levels",
    "optimal_phases",
]

__version__: str

def levels() -> list[str]: ...
def from_bends(
    joints: int, shape: list[int], bends: _Flat, twists: _Flat, phases: _Flat
) -> tuple[_Flat, _Flat, _Flat, _Flat]: ...
def from_directions(
    joints: int, shape: list[int], directions: _Flat, phases: _Flat
) -> tuple[_Flat, _Flat, _Flat, _Flat]: ...
def from_points(
    joints: int, shape: list[int], points: _Flat, phases: _Flat
) -> tuple[_Flat, _Flat, _Flat, _Flat]: ...
def equivalent(
    joints: int, shaft: int, bends: _Flat, twists: _Flat, phases: _Flat
) -> list[_Flat]: ...
def optimal_phases(
    joints: int, bends: _Flat, twists: _Flat, phases: _Flat, workers: int | None
) -> _Flat: ...

@final
class Sweep:
    LONGEST: int
    def __new__(cls, ends: tuple[float, float] | None, count: int, per_turn: int) -> Sweep: ...
    def fill(self, first: int, out: _Flat) -> None: ...

@final
class Lines:
    def __new__(cls, joints: int, arrays: list[_Flat]) -> Lines: ...

@final
class Plan:
    def __new__(
        cls,
        lines: Lines,
        outputs: tuple[str, ...],
        shaft_items: list[int],
        joint_items: list[int],
        load: str | None,
        inertias: list[int],
        tolerance: float | None,
        single: bool,
        reduction: str | None,
    ) -> Plan: ...
    def explain(self, sweep: bool, single: bool) -> str: ...
    def fill(self, angle: _Flat, out: list[_Flat], workers: int | None) -> bool: ...
    def run(
        self,
        shape: list[int],
        line_strides: list[int],
        sweep: Sweep | None,
        angle: _Broadcast | None,
        load: tuple[_Broadcast, _Broadcast, _Broadcast, list[tuple[int, _Flat, list[int]]]] | None,
        out: list[_Flat] | list[NDArray[np.float32]],
        workers: int | None,
        level: str | None,
    ) -> None: ...

from collections.abc import Sequence
from typing import Any, Literal, TypeAlias, final

import numpy as np
from numpy.typing import NDArray

_Flat: TypeAlias = NDArray[np.float64]
_Spread: TypeAlias = NDArray[np.float64]
_Stepped: TypeAlias = tuple[_Flat, int, int]
_Numbers: TypeAlias = NDArray[np.int64]
_Records: TypeAlias = tuple[_Flat, NDArray[np.uint8]]
_Per: TypeAlias = Literal["shaft", "joint", "bearing"]
_SpreadLoad: TypeAlias = tuple[str, _Spread, _Spread, _Spread, list[tuple[int, _Spread]]]
_SteppedLoad: TypeAlias = tuple[str, _Stepped, _Stepped, _Stepped, list[tuple[int, _Stepped]]]

_Load: TypeAlias = tuple[str, Sequence[float], Sequence[float], list[tuple[int, Sequence[float]]]]
_Cases: TypeAlias = tuple[Lines, Sequence[float], _Load | None]
_Items: TypeAlias = tuple[Sequence[int], _Flat]
_Figure: TypeAlias = tuple[str, int | None, _Flat, _Numbers, list[float], int | None]

__all__ = [
    "Integral",
    "Lateral",
    "Lines",
    "Machine",
    "Plan",
    "Sweep",
    "Torsion",
    "Transmission",
    "__version__",
    "check_bearings",
    "check_deviations",
    "common_phases",
    "critical_speeds",
    "derivatives_at",
    "differentiate",
    "dq",
    "equivalent",
    "excitations",
    "free_drives",
    "from_bends",
    "from_directions",
    "from_points",
    "hours",
    "kinds",
    "largest_over_turn",
    "least_drive_inertias",
    "levels",
    "mean_leads",
    "optimal_phases",
    "outputs",
    "pin_means",
    "ranks",
    "spline_forces",
    "steering",
    "tubes",
]

__version__: str

def levels() -> list[str]: ...
def outputs() -> list[tuple[str, _Per, str, str, str, list[str], bool, bool]]: ...
def differentiate(
    lines: Lines,
    outputs: list[tuple[str, list[int]]],
    samples: int,
    angle: Sweep | _Stepped,
    load: _SteppedLoad | None,
    weights: list[_Flat] | None,
    wanted: list[str],
    modes: tuple[str, bool],
    workers: int | None,
    level: str | None,
) -> _Flat: ...
def dq(lines: Lines, shaft: int, by: str, workers: int | None) -> NDArray[np.complex128]: ...
def from_bends(
    joints: int, shape: list[int], bends: _Flat, twists: _Flat, phases: _Flat, degrees: bool = False
) -> tuple[_Flat, _Flat, _Flat, _Flat]: ...
def from_directions(
    joints: int, shape: list[int], directions: _Flat, phases: _Flat
) -> tuple[_Flat, _Flat, _Flat, _Flat]: ...
def from_points(joints: int, shape: list[int], points: _Flat, phases: _Flat) -> list[_Flat]: ...
def equivalent(
    joints: int, shaft: int, bends: _Flat, twists: _Flat, phases: _Flat
) -> list[_Flat]: ...
def excitations(lines: Lines, workers: int | None) -> _Flat: ...
def steering(
    lines: Lines, numbers: _Numbers, centres: _Flat, drawn: Lines | None, workers: int | None
) -> _Flat: ...
def spline_forces(
    lines: Lines, shaft: int, numbers: _Numbers, loads: list[_Flat], workers: int | None
) -> tuple[_Flat, str | None]: ...
def critical_speeds(
    frequencies: list[float], orders: list[tuple[float, bool]], range: tuple[float, float]
) -> tuple[list[float], list[float], int | None]: ...
def tubes(dimensions: list[_Flat]) -> _Flat: ...
def kinds() -> list[tuple[str, str, _Per | None, bool, Literal["states", "cases", "once"]]]: ...
def ranks(values: _Flat, limits: _Flat, maxima: _Flat, most: bool, size: float) -> _Numbers: ...
def check_bearings(
    joints: int, shape: Sequence[int], bearings: Sequence[int], lengths: _Flat, positions: _Flat
) -> None: ...
def check_deviations(
    joints: int, shape: Sequence[int], bends: _Flat, deviations: _Flat
) -> None: ...
def mean_leads(lines: Lines, shaft: int) -> _Flat: ...
def optimal_phases(
    joints: int, bends: _Flat, twists: _Flat, phases: _Flat, workers: int | None
) -> _Flat: ...
def common_phases(
    joints: int,
    bends: _Flat,
    twists: _Flat,
    phases: _Flat,
    weights: _Flat,
    held: list[bool],
    teeth: list[int],
    workers: int | None,
) -> _Flat: ...
def derivatives_at(
    time: _Flat, values: _Flat, reach: int, begin: int, end: int
) -> tuple[_Flat, _Flat]: ...
def hours(means: _Flat, bends: _Flat, rpm: _Flat, rating: _Flat) -> list[_Flat]: ...
def free_drives(
    lines: Lines, shape: Sequence[int], inertias: _Flat, workers: int | None
) -> list[_Flat]: ...
def least_drive_inertias(
    lines: Lines, shape: Sequence[int], inertias: _Flat, variations: _Flat, workers: int | None
) -> _Flat: ...
def pin_means(
    lines: Lines,
    shape: Sequence[int],
    load: _SpreadLoad,
    wear: Literal["friction", "fatigue"],
    workers: int | None,
) -> _Flat: ...

@final
class Integral:
    def __new__(cls, start: float) -> Integral: ...
    def at(self, time: _Flat, values: _Flat) -> _Flat: ...

@final
class Sweep:
    LONGEST: int
    def __new__(cls, ends: tuple[float, float] | None, count: int, per_turn: int) -> Sweep: ...
    def fill(self, first: int, out: _Flat) -> None: ...

@final
class Lines:
    def __new__(
        cls, joints: int, shape: Sequence[int], arrays: list[_Flat], bearings: Sequence[int]
    ) -> Lines: ...

@final
class Machine:
    def __new__(
        cls,
        states: _Cases,
        steps: _Cases | None,
        shares: Sequence[float],
        ratings: Sequence[float],
        friction: Sequence[Sequence[float]],
        tubes: Sequence[tuple[int, Sequence[float]]],
        spline: tuple[int, Sequence[float]] | None,
        centres: Sequence[float],
        drawn: _Cases,
        play: Sequence[float],
        limits: Sequence[tuple[str, int | None, float, float]],
    ) -> Machine: ...
    def figures(self, workers: int | None) -> list[_Figure]: ...
    def suggest(
        self, reach: float, teeth: Sequence[int], ratings: Sequence[float], workers: int | None
    ) -> list[tuple[str, int, int | None, list[float], float, int, _Figure | None]]: ...

@final
class Plan:
    HIGHEST_ORDER: int
    def __new__(
        cls,
        lines: Lines,
        outputs: tuple[str, ...],
        shapes: list[tuple[int | None, bool]],
        shaft_items: list[int],
        joint_items: list[int],
        load: _SpreadLoad | None,
        tolerance: float | None,
        single: bool,
        reduction: str | None,
        axes: str,
    ) -> Plan: ...
    def explain(self, shape: tuple[int, ...], sweep: Sweep | None) -> str: ...
    def peaks(
        self, shape: Sequence[int], least: bool, workers: int | None
    ) -> list[tuple[float, list[float]]]: ...
    def orders(
        self,
        shape: Sequence[int],
        orders: Sequence[int],
        driven: bool,
        tolerance: float,
        workers: int | None,
    ) -> list[_Flat]: ...
    def drive_angles(
        self, shape: tuple[int, ...], angle: _Spread | Sweep, workers: int | None, level: str | None
    ) -> _Spread | None: ...
    def run(
        self,
        shape: tuple[int, ...] | None,
        angle: _Spread | tuple[_Spread, _Spread] | Sweep,
        out: list[NDArray[Any]] | dict[str, NDArray[Any]] | None,
        workers: int | None,
        level: str | None,
    ) -> Any: ...  # noqa: ANN401 - an array, the list given, or a dictionary

@final
class Torsion:
    def __new__(
        cls,
        lines: Lines,
        shape: Sequence[int],
        line: _Numbers,
        shafts: list[_Flat],
        load: list[_Flat],
        engine: tuple[float | None, list[tuple[int, float, float, float]], list[tuple[Any, ...]]],
    ) -> Torsion: ...
    def natural_frequencies(self) -> _Flat: ...
    def modes(self) -> list[tuple[float, list[float], list[float], int]]: ...
    def period_turns(self) -> float: ...
    def steady(
        self,
        system: _Numbers,
        speed: _Flat,
        orders: list[float],
        tolerance: float,
        workers: int | None,
    ) -> _Records: ...
    def multipliers(
        self, system: _Numbers, speed: _Flat, tolerance: float, workers: int | None
    ) -> _Records: ...
    def orbits(
        self, system: _Numbers, speed: _Flat, samples: int, tolerance: float, workers: int | None
    ) -> _Records: ...
    def coexisting(
        self, system: _Numbers, speed: _Flat, most: int, tolerance: float, workers: int | None
    ) -> _Records: ...
    def slopes(self, drive_and_load: list[float], state: _Flat) -> _Flat: ...
    def rigid(self, drive_and_load: list[float]) -> _Flat: ...
    def motion(self, rows: _Flat) -> _Flat: ...

@final
class Transmission:
    def __new__(cls, lines: Lines, shaft: int) -> Transmission: ...
    def q(self) -> NDArray[np.complex128]: ...
    def motion(self, lines: _Numbers, angles: _Flat) -> list[_Flat]: ...
    def gradient(self, lines: _Numbers, angles: _Flat) -> list[NDArray[np.complex128]]: ...

def largest_over_turn(amplitudes: NDArray[np.complex128], orders: Sequence[float]) -> _Flat: ...

@final
class Lateral:
    def __new__(
        cls,
        shape: Sequence[int],
        geometry: Sequence[_Flat],
        shafts: _Items,
        attached: Sequence[_Items],
        sliding: Sequence[int] | None,
    ) -> Lateral: ...
    def sliding(self) -> list[int]: ...
    def modes(self, count: int, probes: Sequence[tuple[int, float]]) -> tuple[_Flat, _Flat]: ...
    def responses(
        self,
        runs: tuple[_Numbers, _Flat],
        orders: Sequence[float],
        moments: NDArray[np.complex128],
        probes: Sequence[tuple[int, float]],
        workers: int | None,
    ) -> tuple[NDArray[np.complex128], _Flat]: ...
    def torque_stiffness(self) -> tuple[NDArray[np.complex128], _Flat]: ...
    def largest_stable_torque(self, system: _Numbers, speed: _Flat) -> _Flat: ...

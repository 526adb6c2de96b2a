"""The jobs that every method of the comparison does, and what a method is given of them."""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

import cardan
from cardan import _core

Array: TypeAlias = NDArray[Any]

LEVEL = os.environ.get("BENCH_LEVEL", _core.levels()[0])
"""The instruction set of this package and of what is compiled here."""

MOTION = ("angle", "speed_ratio", "acceleration_ratio")
SWEEP_STOP = 100.0  # rad: about sixteen turns, of a number of samples that is not whole
TORQUE = 100.0  # N m


class One(NamedTuple):
    """One joint, with ``t = tan(angle)``.

    ``error = atan(versine t / (cosine + t²))``, ``speed = cosine (1 + t²) / (cosine² + t²)`` and
    ``acceleration = -2 sine² t / (cosine² + t²) speed``.
    """

    cosine: float
    square: float  # of the cosine
    versine: float
    slope: float  # -2 sine²
    torque: float
    bending: float  # torque times tangent of the bend


class FoldedChain(NamedTuple):
    """A folded chain ``w -> A w + B conj(w)``, ``q = B / A``, with ``t = tan(angle)``.

    ``error = atan((n0 + n1 t - n0 t²) / (d0 + d1 t + d2 t²))``, ``N = a0 + a1 t + a2 t²``,
    ``speed = k (1 + t²) / N`` and ``acceleration = speed (-a1 + 2 (a0 - a2) t + a1 t²) / N``.
    """

    n0: float
    n1: float
    d0: float
    d1: float
    d2: float
    k: float
    a0: float
    a1: float
    a2: float


@dataclass(frozen=True)
class Job:
    """What is asked for: outputs of a driveline over angles or over a uniform sweep."""

    name: str
    title: str
    bends: tuple[float, ...]
    twists: tuple[float, ...] = ()
    phases: tuple[float, ...] = ()
    outputs: tuple[str, ...] = MOTION
    sweep: bool = False

    @property
    def planes(self) -> int:
        """Number of arrays to fill."""
        return 3 if self.outputs == ("moment",) else len(self.outputs)

    @property
    def kernel(self) -> str:
        """Which formulas a peer needs."""
        return "chain" if len(self.bends) > 1 else "motion" if self.sweep else self.name

    @cached_property
    def line(self) -> cardan.Driveline:
        return cardan.Driveline.from_bends(self.bends, twists=self.twists, phases=self.phases)

    @property
    def one(self) -> One:
        """Constants of a single joint, doubles."""
        return One(*map(float, self.constants))

    @property
    def chain(self) -> FoldedChain:
        """Constants of a chain, doubles."""
        return FoldedChain(*map(float, self.constants))

    @cached_property
    def constants(self) -> Array:
        """Constants of the kernel in extended precision, rounded only when used."""
        bends = np.array(self.bends, np.longdouble)
        if self.kernel != "chain":
            cosine, sine = np.cos(bends[0]), np.sin(bends[0])
            versine = 2 * np.sin(bends[0] / 2) ** 2
            torque = np.longdouble(TORQUE)
            bending = torque * sine / cosine
            return np.array([cosine, cosine**2, versine, -2 * sine**2, torque, bending])
        a, b = np.clongdouble(1), np.clongdouble(0)
        for j, k in enumerate(np.tan(bends / 2) ** 2):
            if j:
                turn = np.longdouble(self.phases[j - 1]) - np.longdouble(self.twists[j - 1])
                # Times i: a quarter turn, exactly.
                turned = np.clongdouble(complex(0, 1)) * (np.cos(turn) + 1j * np.sin(turn))
                a, b = a * turned, b * turned
            a, b = a - k * np.conj(b), b - k * np.conj(a)
        q = b / a
        x, y = q.real, q.imag
        plus, minus = (1 + x) ** 2 + y**2, (1 - x) ** 2 + y**2
        whole = 1 - (x**2 + y**2)
        return np.array([y, -2 * x, 1 + x, 2 * y, 1 - x, whole, plus, 4 * y, minus])


BEND = math.radians(30.0)

JOBS = (
    Job("angle", "angle of one joint", (BEND,), outputs=("angle",)),
    Job("motion", "angle, speed ratio, acceleration ratio of one joint", (BEND,)),
    Job("moment", "moment vector of one joint", (BEND,), outputs=("moment",)),
    Job(
        "chain",
        "the three of motion behind three joints",
        (0.3, 0.25, 0.2),
        (0.4, -0.7),
        (0.2, 0.9),
    ),
    Job("sweep", "the three of motion over a uniform sweep", (BEND,), sweep=True),
)


@dataclass(frozen=True)
class JobRun:
    """A job at one size on some threads, with the arrays to read and to fill.

    ``angles`` are doubles; a sweep has none, but ``num`` angles from 0 to ``SWEEP_STOP`` with both
    ends. ``planes`` holds one row per output or component, for each word length.
    """

    job: Job
    num: int
    threads: int
    angles: Array
    planes: Mapping[type, Array]

    @property
    def step(self) -> float:
        return SWEEP_STOP / (self.num - 1)

    def spans(self) -> list[slice]:
        """The samples, cut into one piece per thread."""
        cuts = [self.num * i // self.threads for i in range(self.threads + 1)]
        return [slice(a, b) for a, b in pairwise(cuts)]


# Evaluates once and returns one array per plane: those of the case, or new ones.
Call: TypeAlias = Callable[[], Any]


class Method(NamedTuple):
    """One way to do the jobs; ``prepare`` returns ``None`` for what it does not do."""

    peer: str
    name: str
    prepare: Callable[[JobRun], Call | None]
    word: type = np.float64
    permitted: float = 1e-13  # error relative to the largest magnitude, beyond which it is wrong
    note: str = ""


def recorded_angles(num: int) -> Array:
    """Drive angles in rad as a recording has them: ascending, not quite uniform, over 16 turns.

    Multiples of a quarter turn, where the tangent has its zeros and poles, are among them.
    """
    rng = np.random.default_rng(1920)
    angles = np.linspace(-SWEEP_STOP / 2, SWEEP_STOP / 2, num) + rng.uniform(-1e-4, 1e-4, num)
    quarters = np.arange(-31, 32) * (np.pi / 2)
    angles[np.searchsorted(angles, quarters)] = quarters
    return np.sort(angles)

"""How far results lie from the exact ones, which mpmath computes with 60 digits."""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from job import SWEEP_STOP, TORQUE, Job, JobRun, Method

sys.path.append(str(Path(__file__).parent.parent / "tests"))
from oracle import Exact, ExactJoint, ExactTurn, Fold, mp


class WorstErrors(NamedTuple):
    """Worst errors over the sample and all outputs.

    ``relative`` is relative to the largest magnitude of the output, ``ulp`` in units of the last
    place of the exact double (of a vector: of its largest component).
    """

    relative: float
    ulp: float


class Judge:
    """Exact results at a sample of a case's angles."""

    def __init__(self, case: JobRun, count: int) -> None:
        rng = np.random.default_rng(1939)
        places = rng.integers(0, case.num, count)
        if not case.job.sweep:
            # The hardest come first: next to multiples of a quarter turn.
            off = np.abs(np.remainder(case.angles + np.pi / 4, np.pi / 2) - np.pi / 4)
            places = np.concatenate([np.argpartition(off, 32)[:32], places])
        self.places = np.unique(places)
        job = case.job
        rows = [self._exact(case, int(i)) for i in self.places]
        self._planes = [Exact.of(column) for column in zip(*rows, strict=True)]
        self._vector = job.outputs == ("moment",)

    @staticmethod
    def _exact(case: JobRun, i: int) -> list[Any]:
        job = case.job
        if job.sweep:
            angle = mp.mpf(SWEEP_STOP) * i / (case.num - 1)
            cosine, sine = mp.cos_sin(angle)
            at = ExactTurn(angle, sine, cosine)
        else:
            at = ExactTurn.by(float(case.angles[i]))
        if job.outputs == ("moment",):
            return [TORQUE * x for x in ExactJoint.bent(job.bends[0]).moment(at)]
        fold = Fold.of(job.bends, job.twists, job.phases)
        of = {
            "angle": lambda: at.angle + fold.angle_error(at),
            "speed_ratio": lambda: fold.speed_ratio(at),
            "acceleration_ratio": lambda: fold.acceleration_ratio(at),
        }
        return [of[name]() for name in job.outputs]

    def __call__(self, planes: Any) -> WorstErrors:
        relative = ulp = 0.0
        unit = np.max([exact.ulp for exact in self._planes], axis=0) if self._vector else None
        for exact, plane in zip(self._planes, planes, strict=True):
            got = np.asarray(np.asarray(plane)[self.places], np.float64)
            off = np.where(np.isfinite(got), exact.distance(got), np.inf)
            largest = np.max(np.abs(exact.high)) if not self._vector else self._length()
            relative = max(relative, float(np.max(off) / largest))
            ulp = max(ulp, float(np.max(off / (exact.ulp if unit is None else unit))))
        return WorstErrors(relative, ulp)

    def _length(self) -> float:
        return float(max(np.max(np.abs(exact.high)) for exact in self._planes))


@dataclass(frozen=True)
class ComparisonRow:
    """What one method took for one case."""

    job: Job
    num: int
    threads: int
    method: Method
    best: float  # ns per angle
    median: float
    verdict: WorstErrors

    @property
    def wrong(self) -> bool:
        return not self.verdict.relative <= self.method.permitted

"""What one method took for one case: a row of the comparison."""

from __future__ import annotations

from dataclasses import dataclass

from job import Job, Method
from judge import WorstErrors


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

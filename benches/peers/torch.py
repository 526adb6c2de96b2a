"""PyTorch on the CPU: each job one function through its compiler, in place."""

from __future__ import annotations

from typing import Any

import numpy as np
import torch

from job import Call, JobRun, Method


def methods() -> list[Method]:
    return [Method("torch", "PyTorch", _prepare, note=f"PyTorch {torch.__version__}")]


def _angle(a: Any, o: Any, k: Any) -> None:
    t = torch.tan(a)
    o[0].copy_(a + torch.atan(k.versine * t / (t * t + k.cosine)))


def _motion(a: Any, o: Any, k: Any) -> None:
    t = torch.tan(a)
    below = 1.0 / (t * t + k.square)
    ratio = k.cosine * (1.0 + t * t) * below
    o[0].copy_(a + torch.atan(k.versine * t / (t * t + k.cosine)))
    o[1].copy_(ratio)
    o[2].copy_(k.slope * t * below * ratio)


def _moment(a: Any, o: Any, k: Any) -> None:
    t = torch.tan(a)
    part = k.bending * t / (1.0 + t * t)
    o[0].fill_(k.torque)
    o[1].copy_(part * t)
    o[2].copy_(-part)


def _chain(a: Any, o: Any, k: Any) -> None:
    t = torch.tan(a)
    below = 1.0 / (k.a0 + t * (k.a1 + t * k.a2))
    ratio = k.k * (1.0 + t * t) * below
    lead = torch.atan((k.n0 + t * (k.n1 - t * k.n0)) / (k.d0 + t * (k.d1 + t * k.d2)))
    o[0].copy_(a + lead)
    o[1].copy_(ratio)
    o[2].copy_(ratio * ((t * k.a1 + 2.0 * (k.a0 - k.a2)) * t - k.a1) * below)


FORMULAS = {"angle": _angle, "motion": _motion, "moment": _moment, "chain": _chain}


def _prepare(case: JobRun) -> Call:
    job = case.job
    formulas = FORMULAS[job.kernel]
    constants = job.chain if job.kernel == "chain" else job.one
    num, step = case.num, case.step
    planes = case.planes[np.float64]
    a, o = torch.from_numpy(case.angles), torch.from_numpy(planes)
    # The compiled loop keeps the number of threads it was compiled for.
    torch.set_num_threads(case.threads)
    torch._dynamo.reset()

    def run(a: Any, *o: Any) -> None:
        if job.sweep:
            a = torch.arange(num, dtype=torch.float64) * step
        formulas(a, o, constants)

    compiled = torch.compile(run, dynamic=False)
    rows = tuple(o)
    with torch.inference_mode():
        compiled(a, *rows)

    def call() -> Any:
        torch.set_num_threads(case.threads)
        with torch.inference_mode():
            compiled(a, *rows)
        return planes

    return call

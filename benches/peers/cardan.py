"""This package, at each of its accuracies."""

from __future__ import annotations

from typing import Any

import numpy as np

import cardan
from cardan.evaluation.plan import Plan
from cardan.evaluation.request import Request
from job import LEVEL, SWEEP_STOP, TORQUE, Call, JobRun, Method


def methods() -> list[Method]:
    tiers: list[tuple[str, dict[str, Any], type, float]] = [
        ("tolerance=0", {"tolerance": 0.0}, np.float64, 1e-15),
        ("default", {}, np.float64, 2e-15),
        ("tolerance=1e-6", {"tolerance": 1e-6}, np.float64, 1e-6),
        ("float32", {"dtype": np.float32}, np.float32, 1e-6),
    ]
    return [
        Method("cardan", name, lambda case, options=options: _prepare(case, options), word, limit)
        for name, options, word, limit in tiers
    ]


def _prepare(case: JobRun, options: dict[str, Any]) -> Call:
    job = case.job
    moment = job.outputs == ("moment",)
    word = np.dtype(options.get("dtype", np.float64)).type
    load = cardan.Load(drive_torque=TORQUE) if moment else None
    request = Request(job.outputs, joints=0, load=load, workers=case.threads, **options)
    plan = Plan(job.line, request, LEVEL)
    planes = case.planes[word]
    angle = cardan.Sweep(0.0, SWEEP_STOP, case.num) if job.sweep else case.angles
    if moment:
        out = {"moment": np.moveaxis(planes, 0, -1)}
    else:
        out = dict(zip(job.outputs, planes, strict=True))

    def call() -> Any:
        plan(angle, out)
        return planes

    return call

"""Numba: loops compiled with fast maths, over Intel's SVML where Numba can use it."""

from __future__ import annotations

import math
from typing import Any

import numba
import numpy as np

from job import Call, JobRun, Method


def methods() -> list[Method]:
    svml = bool(numba.config.USING_SVML)
    note = f"Numba {numba.__version__}, {'with' if svml else 'without'} SVML"
    return [Method("numba", "Numba, SVML" if svml else "Numba", _prepare, note=note)]


def _angle(a, step, o, k):
    cosine, versine = k[0], k[2]
    for i in numba.prange(o.shape[1]):
        t = math.tan(a[i])
        o[0, i] = a[i] + math.atan(versine * t / (cosine + t * t))


def _motion(a, step, o, k):
    cosine, square, versine, slope = k[0], k[1], k[2], k[3]
    for i in numba.prange(o.shape[1]):
        t = math.tan(a[i])
        below = 1.0 / (t * t + square)
        ratio = cosine * (1.0 + t * t) * below
        o[1, i] = ratio
        o[2, i] = slope * t * below * ratio
        o[0, i] = a[i] + math.atan(versine * t / (cosine + t * t))


def _sweep(a, step, o, k):
    cosine, square, versine, slope = k[0], k[1], k[2], k[3]
    for i in numba.prange(o.shape[1]):
        at = i * step
        t = math.tan(at)
        below = 1.0 / (t * t + square)
        ratio = cosine * (1.0 + t * t) * below
        o[1, i] = ratio
        o[2, i] = slope * t * below * ratio
        o[0, i] = at + math.atan(versine * t / (cosine + t * t))


def _moment(a, step, o, k):
    torque, bending = k[4], k[5]
    for i in numba.prange(o.shape[1]):
        t = math.tan(a[i])
        part = bending * t / (1.0 + t * t)
        o[0, i] = torque
        o[1, i] = part * t
        o[2, i] = -part


def _chain(a, step, o, k):
    n0, n1, d0, d1, d2, whole, a0, a1, a2 = k
    middle = 2.0 * (a0 - a2)
    for i in numba.prange(o.shape[1]):
        t = math.tan(a[i])
        below = 1.0 / (a0 + t * (a1 + t * a2))
        ratio = whole * (1.0 + t * t) * below
        o[1, i] = ratio
        o[2, i] = ratio * ((t * a1 + middle) * t - a1) * below
        o[0, i] = a[i] + math.atan((n0 + t * (n1 - t * n0)) / (d0 + t * (d1 + t * d2)))


LOOPS = {"angle": _angle, "motion": _motion, "moment": _moment, "chain": _chain, "sweep": _sweep}
_compiled: dict[tuple[str, bool], Any] = {}


def _prepare(case: JobRun) -> Call:
    job = case.job
    planes = case.planes[np.float64]
    key = ("sweep" if job.sweep else job.kernel, case.threads > 1)
    if key not in _compiled:
        _compiled[key] = numba.njit(
            LOOPS[key[0]], fastmath=True, error_model="numpy", parallel=key[1]
        )
    loop = _compiled[key]
    constants = tuple(job.chain if job.kernel == "chain" else job.one)

    def call() -> Any:
        if case.threads > 1:
            numba.set_num_threads(case.threads)
        loop(case.angles, case.step, planes, constants)
        return planes

    return call

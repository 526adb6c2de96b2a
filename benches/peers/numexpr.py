"""numexpr: one expression per output, in blocks that stay in the second-level cache."""

from __future__ import annotations

from typing import Any

import numexpr
import numpy as np

from job import Call, JobRun, Method

BLOCK = 1 << 16

# The tangent is a name of its own where several outputs need it.
ANGLE = ("a + arctan(versine * tan(a) / (tan(a) * tan(a) + cosine))",)
MOTION = (
    "a + arctan(versine * t / (t * t + cosine))",
    "cosine * (1 + t * t) / (t * t + square)",
    "factor * t * (1 + t * t) / ((t * t + square) * (t * t + square))",
)
MOMENT = ("torque + 0 * t", "bending * t * t / (1 + t * t)", "-bending * t / (1 + t * t)")
CHAIN = (
    "a + arctan((n0 + t * (n1 - t * n0)) / (d0 + t * (d1 + t * d2)))",
    "k * (1 + t * t) / (a0 + t * (a1 + t * a2))",
    "k * (1 + t * t) * ((t * a1 + middle) * t - a1)"
    " / ((a0 + t * (a1 + t * a2)) * (a0 + t * (a1 + t * a2)))",
)
EXPRESSIONS = {"angle": ANGLE, "motion": MOTION, "moment": MOMENT, "chain": CHAIN}


def methods() -> list[Method]:
    return [Method("numexpr", "numexpr", _prepare, note=f"numexpr {numexpr.__version__}")]


def _prepare(case: JobRun) -> Call:
    job = case.job
    planes = case.planes[np.float64]
    names: dict[str, Any]
    if job.kernel == "chain":
        names = job.chain._asdict()
        names["middle"] = 2.0 * (names["a0"] - names["a2"])
    else:
        names = job.one._asdict()
        names["factor"] = names["slope"] * names["cosine"]
    # Small cases in one block, whatever the threads leave of it.
    expressions = EXPRESSIONS[job.kernel]
    block = BLOCK * case.threads
    tangent = np.empty(block)
    own = np.empty(block)
    ramp = np.arange(block, dtype=np.float64)

    def call() -> Any:
        if numexpr.get_num_threads() != case.threads:  # begins new threads even if it is
            numexpr.set_num_threads(case.threads)
        for start in range(0, case.num, block):
            stop = min(start + block, case.num)
            m = stop - start
            if job.sweep:
                a = own[:m]
                numexpr.evaluate(
                    "(r + start) * step",
                    {"r": ramp[:m], "start": float(start), "step": case.step},
                    out=a,
                )
            else:
                a = case.angles[start:stop]
            given = {**names, "a": a}
            if job.kernel != "angle":
                given["t"] = numexpr.evaluate("tan(a)", {"a": a}, out=tangent[:m])
            for expression, row in zip(expressions, planes, strict=True):
                numexpr.evaluate(expression, given, out=row[start:stop])
        return planes

    return call

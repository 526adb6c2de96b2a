"""NumPy: as people write it, and as well as it can be written.

Written well means in blocks that stay in the cache, in place, with one tangent per angle. That form
is also the accurate one: the tangent keeps its digits near a right angle, and NumPy has it in SIMD,
which it has not for sine and cosine. Threads share the blocks out.
"""

from __future__ import annotations

import math
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from typing import Any

import numpy as np

from job import Array, Call, JobRun, Method

BLOCK = 8192


def methods() -> list[Method]:
    version = f"NumPy {np.__version__}"
    return [
        Method("numpy", "NumPy, plain", _plain, note=version),
        Method("numpy", "NumPy, blocks", lambda case: _blocks(case, np.float64)),
        Method("numpy", "NumPy, float32", lambda case: _blocks(case, np.float32), np.float32, 2e-6),
    ]


def _plain(case: JobRun) -> Call | None:
    """Textbook formulas over whole arrays, joint by joint, one thread."""
    if case.threads > 1:
        return None
    job = case.job
    n = case.num

    def turned(a: Array, bend: float) -> tuple[Array, Array, Array]:
        s, c = np.sin(a), np.cos(a)
        driven = np.arctan2(s, c * np.cos(bend))
        # arctan2 knows the angle up to whole turns only.
        driven += 2 * np.pi * np.round((a - driven) / (2 * np.pi))
        below = 1 - np.sin(bend) ** 2 * c**2
        ratio = np.cos(bend) / below
        return driven, ratio, -np.cos(bend) * np.sin(bend) ** 2 * np.sin(2 * a) / below**2

    def call() -> Any:
        a = np.linspace(0.0, case.step * (n - 1), n) if job.sweep else case.angles
        if job.kernel == "moment":
            bending = job.one.torque * np.tan(job.bends[0])
            s, c = np.sin(a), np.cos(a)
            return np.full(n, job.one.torque), bending * s**2, -bending * s * c
        if job.kernel == "angle":
            driven = np.arctan2(np.sin(a), np.cos(a) * np.cos(job.bends[0]))
            return (driven + 2 * np.pi * np.round((a - driven) / (2 * np.pi)),)
        angle, ratio, acceleration = turned(a, job.bends[0])
        for bend, twist, phase in zip(job.bends[1:], job.twists, job.phases, strict=True):
            offset = phase - twist + np.pi / 2
            angle, r, acc = turned(angle + offset, bend)
            acceleration = acc * ratio**2 + r * acceleration
            ratio = r * ratio
        if len(job.bends) > 1:
            # The mean of the angle error is zero by convention.
            angle -= _mean_lead(job.bends, job.twists, job.phases)
        return angle, ratio, acceleration

    return call


def _mean_lead(bends: Any, twists: Any, phases: Any) -> float:
    """Constant by which the joint-by-joint angle runs ahead."""
    turn = np.linspace(0.0, np.pi, 256, endpoint=False)
    angle = turn.copy()
    for j, bend in enumerate(bends):
        if j:
            angle += phases[j - 1] - twists[j - 1] + np.pi / 2
        s, c = np.sin(angle), np.cos(angle)
        angle += np.arctan2((1 - np.cos(bend)) * s * c, c * c * np.cos(bend) + s * s)
    return float(np.mean(angle - turn))


def _blocks(case: JobRun, word: type) -> Call:
    job = case.job
    planes = case.planes[word]
    angles, step = case.angles, case.step
    constants = job.chain if job.kernel == "chain" else job.one
    kernel = {"angle": _angle, "motion": _motion, "moment": _moment, "chain": _chain}[job.kernel]
    ramp = np.arange(BLOCK, dtype=np.float64)

    def span(part: slice) -> None:
        own, spare = np.empty((2, BLOCK))
        scratch = np.empty((5, BLOCK), word)
        for start in range(part.start, part.stop, BLOCK):
            stop = min(start + BLOCK, part.stop)
            m = stop - start
            if job.sweep:
                a = own[:m]
                np.add(ramp[:m], start, out=a)
                np.multiply(a, step, out=a)
            else:
                a = angles[start:stop]
            rows = planes[:, start:stop]
            work = scratch[:, :m]
            if word is np.float32:
                # What is left of the angle and the lead in single, their sum in double.
                kernel(_reduced(a, spare[:m], work[0]), rows, work[1:], constants, lead=True)
                if job.kernel != "moment":
                    np.add(a, rows[0], out=rows[0], casting="same_kind", dtype=np.float64)
            else:
                kernel(a, rows, work, constants)

    if case.threads == 1:
        whole = slice(0, case.num)

        def call() -> Any:
            span(whole)
            return planes

        return call

    pool, spans = _pool(case.threads), case.spans()

    def threaded() -> Any:
        for _ in pool.map(span, spans):
            pass
        return planes

    return threaded


@cache
def _pool(threads: int) -> ThreadPoolExecutor:
    return ThreadPoolExecutor(threads)


_PI_HIGH = 3.1415926218032837  # 27 bits
_PI_LOW = math.pi - _PI_HIGH


def _reduced(a: Array, own: Array, out: Array) -> Array:
    """Take half turns off in double and round what is left to single."""
    turns = np.rint(a * (1 / math.pi))
    np.multiply(turns, -_PI_HIGH, out=own)
    own += a
    turns *= _PI_LOW
    np.subtract(own, turns, out=out, casting="same_kind")
    return out


def _angle(a: Array, rows: Array, work: Array, k: Any, lead: bool = False) -> None:
    t, u = work[0], work[1]
    np.tan(a, out=t)
    np.multiply(t, t, out=u)
    u += k.cosine
    t *= k.versine
    t /= u
    np.arctan(t, out=rows[0])
    if not lead:
        rows[0] += a


def _motion(a: Array, rows: Array, work: Array, k: Any, lead: bool = False) -> None:
    t, square, below = work[0], work[1], work[2]
    angle, ratio, acceleration = rows
    np.tan(a, out=t)
    np.multiply(t, t, out=square)
    np.add(square, k.square, out=below)
    np.divide(1.0, below, out=below)
    np.add(square, 1.0, out=ratio)
    ratio *= below
    ratio *= k.cosine
    np.multiply(t, below, out=acceleration)
    acceleration *= ratio
    acceleration *= k.slope
    square += k.cosine
    t *= k.versine
    t /= square
    np.arctan(t, out=angle)
    if not lead:
        angle += a


def _moment(a: Array, rows: Array, work: Array, k: Any, lead: bool = False) -> None:
    t, square = work[0], work[1]
    along, up, side = rows
    np.tan(a, out=t)
    np.multiply(t, t, out=square)
    np.add(square, 1.0, out=up)
    np.divide(k.bending, up, out=up)
    np.multiply(t, up, out=side)
    np.negative(side, out=side)
    np.multiply(square, up, out=up)
    along.fill(k.torque)


def _chain(a: Array, rows: Array, work: Array, k: Any, lead: bool = False) -> None:
    t, below, x, y = work[0], work[1], work[2], work[3]
    angle, ratio, acceleration = rows
    np.tan(a, out=t)
    np.multiply(t, k.a2, out=below)
    below += k.a1
    below *= t
    below += k.a0
    np.divide(1.0, below, out=below)
    np.multiply(t, t, out=ratio)
    ratio += 1.0
    ratio *= below
    ratio *= k.k
    np.multiply(t, k.a1, out=acceleration)
    acceleration += 2.0 * (k.a0 - k.a2)
    acceleration *= t
    acceleration -= k.a1
    acceleration *= below
    acceleration *= ratio
    np.multiply(t, k.d2, out=x)
    x += k.d1
    x *= t
    x += k.d0
    np.multiply(t, -k.n0, out=y)
    y += k.n1
    y *= t
    y += k.n0
    y /= x
    np.arctan(y, out=angle)
    if not lead:
        angle += a

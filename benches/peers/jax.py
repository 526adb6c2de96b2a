"""JAX: compiled functions in double precision; JAX provides the memory."""

from __future__ import annotations

import os
from contextlib import suppress
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp

from job import Call, JobRun, Method

# Doubles must be asked for.
jax.config.update("jax_enable_x64", True)


_pool: list[int] = []  # threads of JAX


def methods() -> list[Method]:
    # Wide enough for JAX to begin all its threads.
    before = set(_threads())
    jax.block_until_ready(jax.jit(jnp.tan)(jnp.ones(1_000_000)))
    _pool.extend(set(_threads()) - before)
    return [Method("jax", "JAX", _prepare, note=f"JAX {jax.__version__}")]


def _angle(a: Any, t: Any, k: Any) -> tuple[Any, ...]:
    return (a + jnp.arctan(k.versine * t / (t * t + k.cosine)),)


def _motion(a: Any, t: Any, k: Any) -> tuple[Any, ...]:
    below = 1.0 / (t * t + k.square)
    ratio = k.cosine * (1.0 + t * t) * below
    return (*_angle(a, t, k), ratio, k.slope * t * below * ratio)


def _moment(a: Any, t: Any, k: Any) -> tuple[Any, ...]:
    part = k.bending * t / (1.0 + t * t)
    return jnp.full_like(a, k.torque), part * t, -part


def _chain(a: Any, t: Any, k: Any) -> tuple[Any, ...]:
    below = 1.0 / (k.a0 + t * (k.a1 + t * k.a2))
    ratio = k.k * (1.0 + t * t) * below
    lead = jnp.arctan((k.n0 + t * (k.n1 - t * k.n0)) / (k.d0 + t * (k.d1 + t * k.d2)))
    return a + lead, ratio, ratio * ((t * k.a1 + 2.0 * (k.a0 - k.a2)) * t - k.a1) * below


FORMULAS = {"angle": _angle, "motion": _motion, "moment": _moment, "chain": _chain}


def _threads() -> list[int]:
    tasks = Path("/proc/self/task")
    return [int(task.name) for task in tasks.iterdir()] if tasks.exists() else []


def _use(threads: int) -> None:
    """Keep JAX's threads, whose number it fixes when it begins, to so many cores."""
    if _pool:
        cores = sorted(os.sched_getaffinity(0))[-threads:]
        for thread in _pool:
            with suppress(ProcessLookupError):
                os.sched_setaffinity(thread, cores)


def _prepare(case: JobRun) -> Call | None:
    job = case.job
    constants = job.chain if job.kernel == "chain" else job.one
    num, step = case.num, case.step
    given = jnp.asarray(case.angles)
    _use(case.threads)

    def compiled(function: Any, *arguments: Any) -> Any:
        return jax.jit(function).lower(*arguments).compile()

    # Of a function with several results JAX computes what they share once for each: the tangent is
    # a function of its own.
    angles = compiled(lambda: jnp.arange(num) * step)
    tangent = compiled(jnp.tan, given)
    rest = compiled(lambda a, t: FORMULAS[job.kernel](a, t, constants), given, given)
    whole = compiled(lambda a: _angle(a, jnp.tan(a), constants), given) if job.planes == 1 else None

    def call() -> Any:
        a = angles() if job.sweep else given
        return jax.block_until_ready(whole(a) if whole else rest(a, tangent(a)))

    return call

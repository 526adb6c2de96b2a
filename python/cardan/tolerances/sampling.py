"""Random drivelines within their tolerances, drawn in chunks on several threads.

Each chunk has its own stream of random numbers, spawned from the seed by the number of the chunk,
so that the samples depend on neither the number of threads nor their order.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping

import numpy as np

from cardan.arrays import FloatArray, threads
from cardan.tolerances.box import Box

# Doubles of one parameter at a time: the arrays of a chunk stay in the caches of a core.
_CHUNK = 1 << 14

# Pieces of work for a thread pool below which its start costs more than it saves.
_FEWEST = 4


def sample(
    box: Box,
    seed: int,
    workers: int | None,
    of: Callable[[FloatArray], Mapping[str, FloatArray]],
    out: Mapping[str, FloatArray],
) -> None:
    """Fill arrays ``(samples,)`` with figures by name of random drivelines."""
    samples = len(next(iter(out.values())))
    firsts = range(0, samples, _CHUNK)

    def fill(number: int) -> None:
        first = firsts[number]
        count = min(_CHUNK, samples - first)
        random = np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(number,)))
        for name, values in of(box.drawn(random, count)).items():
            out[name][first : first + count] = values

    limit = threads.at_most(workers)
    many = min(limit or os.cpu_count() or 1, os.cpu_count() or 1)
    if many == 1 or len(firsts) < _FEWEST:
        for number in range(len(firsts)):
            fill(number)
        return
    from concurrent.futures import ThreadPoolExecutor

    with ThreadPoolExecutor(many) as pool:
        for _ in pool.map(fill, range(len(firsts))):
            pass

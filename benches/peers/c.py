"""C, compiled when asked for, with the maths of the C library, scalar and vector, and OpenMP."""

from __future__ import annotations

import ctypes
import os
import shutil
import subprocess
import tempfile
from functools import cache
from pathlib import Path

import numpy as np

from job import LEVEL, Array, Call, JobRun, Method

LANES = 8 if LEVEL == "avx512" else 4
"""Doubles in a register."""

MACHINE = {"avx512": "native", "avx2": "x86-64-v3"}[LEVEL]

KERNELS = ("angle", "motion", "moment", "chain", "sweep")


def methods() -> list[Method]:
    if shutil.which("gcc") is None:
        raise ImportError("gcc is not on the path")
    version = subprocess.run(["gcc", "--version"], capture_output=True, text=True, check=True)
    note = version.stdout.splitlines()[0]
    return [
        Method("c", "C, libmvec", lambda case: fast(case, np.float64), note=note),
        Method("c", "C, libmvec, float32", lambda case: fast(case, np.float32), np.float32, 2e-6),
        Method("c", "C, libm", lambda case: prepare(case, built(), np.float64)),
        Method("c", "C, long double", _extended, permitted=1e-13),
    ]


def fast(case: JobRun, word: type, *defines: str) -> Call:
    """Prepare with vector functions, which gcc uses only where it may reorder sums."""
    real = "double" if word is np.float64 else "float"
    library = built(("-ffast-math", *defines), work=real, store=real)
    return prepare(case, library, word)


def _extended(case: JobRun) -> Call | None:
    if case.num > 100_000:
        return None  # seconds a call
    return prepare(case, built(work="long double"), np.float64, np.longdouble)


@cache
def built(flags: tuple[str, ...] = (), work: str = "double", store: str = "double") -> ctypes.CDLL:
    """Compile the kernels and load them."""
    source = Path(__file__).parent / "kernel.c"
    with tempfile.TemporaryDirectory() as folder:
        compiled, library = Path(folder) / "kernel.o", Path(folder) / "kernel.so"
        vectors = f"-mprefer-vector-width={64 * LANES}"
        options = ["-O3", f"-march={MACHINE}", vectors, "-fopenmp", "-fPIC"]
        _gcc(*options, *flags, f"-DWORK={work}", f"-DSTORE={store}", "-c", source, "-o", compiled)
        # Linked without -ffast-math, which would turn off subnormal numbers in the whole process.
        _gcc("-shared", "-fopenmp", compiled, "-o", library, "-lm")
        # Its own libmvec first: SVML has functions of the same names.
        return ctypes.CDLL(str(library), mode=os.RTLD_NOW | os.RTLD_DEEPBIND)


def _gcc(*arguments: object) -> None:
    done = subprocess.run(["gcc", *map(str, arguments)], capture_output=True, text=True)
    if done.returncode:
        raise ImportError(f"gcc fails: {done.stderr.strip().splitlines()[-1]}")


def prepare(case: JobRun, library: ctypes.CDLL, word: type, work: type | None = None) -> Call:
    job = case.job
    planes = case.planes[word]
    constants: Array = job.constants.astype(work or word)
    address, whole = ctypes.c_void_p, ctypes.c_long
    library.run.argtypes = [
        *(ctypes.c_int, whole, address, ctypes.c_double),
        *(address, whole, address, ctypes.c_int),
    ]
    library.run.restype = None
    arguments = (
        KERNELS.index("sweep" if job.sweep else job.kernel),
        case.num,
        case.angles.ctypes.data,
        case.step,
        planes.ctypes.data,
        planes.strides[0] // planes.itemsize,
        constants.ctypes.data,
        case.threads,
    )

    def call(kept: Array = constants) -> Array:
        library.run(*arguments)
        return planes

    return call

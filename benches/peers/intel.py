"""Intel's vector maths between loops in C: SVML, and VML of the MKL."""

from __future__ import annotations

import ctypes
import os
from importlib.metadata import version

import numpy as np

from job import Call, JobRun, Method
from peers import c, load

# Names of the accuracies, suffixes of SVML's functions, and modes of VML.
TIERS = {"HA": ("_ha", 2, 1e-13), "LA": ("", 1, 1e-13), "EP": ("_ep", 3, 1e-6)}


def methods() -> list[Method]:
    c.methods()
    found: list[Method] = []
    if load("libintlc.so.5") and load("libsvml.so"):
        note = f"SVML {version('intel-cmplr-lib-rt')}"
        for tier, (suffix, _, limit) in TIERS.items():
            names = (f"-D{name.upper()}=__svml_{name}{c.LANES}{suffix}" for name in ("tan", "atan"))
            defines = (f"-DLANES={c.LANES}", *names)
            found.append(
                Method("svml", f"C, SVML {tier}", _svml(defines), permitted=limit, note=note)
            )
    # The loops have threads of their own, each of which calls the library for a block.
    os.environ.setdefault("MKL_THREADING_LAYER", "SEQUENTIAL")
    mkl = load("libmkl_rt.so.3") or load("libmkl_rt.so.2")
    if mkl:
        note = f"MKL {version('mkl')}"
        found.append(Method("mkl", "C, MKL VML", lambda case: _vml(case, mkl), note=note))
    if not found:
        raise ImportError("neither package mkl nor intel-cmplr-lib-rt is in this environment")
    return found


def _svml(defines: tuple[str, ...]) -> object:
    return lambda case: c.fast(case, np.float64, *defines)


def _vml(case: JobRun, mkl: ctypes.CDLL) -> Call:
    library = c.built(("-ffast-math", "-DVML=1"))
    address = ctypes.c_void_p
    library.use.argtypes = [address, address, ctypes.c_long]
    library.use(*(ctypes.cast(f, address) for f in (mkl.vmdTan, mkl.vmdAtan)), TIERS["LA"][1])
    return c.prepare(case, library, np.float64)

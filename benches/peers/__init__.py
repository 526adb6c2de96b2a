"""The methods compared: one module per peer, each with a function ``methods``."""

from __future__ import annotations

import ctypes
import sys
from contextlib import suppress
from importlib import import_module
from pathlib import Path

from job import Method

PEERS = ("cardan", "numpy", "numexpr", "numba", "jax", "torch", "c", "intel")


def methods(names: list[str] | None = None) -> tuple[list[Method], dict[str, str]]:
    """Return the methods of the peers that are here, and why the others are not."""
    # Numba looks for SVML by its bare name, which is found once it was loaded by its path.
    load("libintlc.so.5")
    load("libsvml.so")
    found: list[Method] = []
    missing: dict[str, str] = {}
    for name in names or PEERS:
        try:
            found += import_module(f"peers.{name}").methods()
        except (ImportError, OSError) as error:
            missing[name] = str(error).splitlines()[0]
    return found, missing


def load(name: str) -> ctypes.CDLL | None:
    """Load a library of this environment for all that follow; ``None`` where there is none."""
    with suppress(OSError):
        return ctypes.CDLL(str(Path(sys.prefix) / "lib" / name), mode=ctypes.RTLD_GLOBAL)
    return None

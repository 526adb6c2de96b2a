"""The rows of a batch with its loads, some at a time."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from cardan.load import Load
from cardan.request import Request

ComplexArray: TypeAlias = NDArray[np.complex128]


def blocks(count: int, size: int) -> Iterator[slice]:
    """Yield slices of at most ``size`` that cover ``count``."""
    return (slice(start, min(start + size, count)) for start in range(0, count, size))


def of_rows(request: Request, rows: tuple[int, ...], block: slice) -> Request:
    """Return the request for some of the rows, each an entry of the first of two axes.

    Args:
        request: of drivelines and loads that broadcast to ``rows``.
        rows: their shape together.
        block: which of the rows, counted flat.
    """
    line: Any = request.line
    index = np.broadcast_to(np.arange(line.size).reshape(line.shape), rows).ravel()[block]
    load = request.load
    if load is not None:
        values: dict[str, Any] = {"inertias": load.inertias}
        for name in ("torque", "speed", "acceleration"):
            array = getattr(load, name)
            taken = np.broadcast_to(array, rows).ravel()[block, np.newaxis]
            values[name] = taken if array.ndim else array
        if load.inertias is not None and load.inertias.ndim > 1:
            each = load.inertias.shape[-1]
            spread = np.broadcast_to(load.inertias, (*rows, each)).reshape(-1, each)
            values["inertias"] = spread[block, np.newaxis]
        values[f"{load.end}_torque"] = values.pop("torque")
        load = Load(**values)
    return replace(request, line=line.reshape(-1)[index][:, np.newaxis], load=load)

"""The rows of a batch with its loads, some at a time, and what lies before one of the joints."""

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


def chain_before(line: Any, joint: int) -> tuple[ComplexArray, ComplexArray]:  # noqa: ANN401
    """Return ``A`` and ``B`` of the chain before a joint, in the shape of the batch.

    The chain takes ``w = exp(i a)`` to ``A w + B conj(w)``, whose argument is the input angle of
    the joint.
    """
    line._geometry.check_ideal(
        "losses, lives and angles of the cross in closed form are computed",
        "evaluate gives moments and tilts as built",
    )
    a = np.ones(line.shape, np.complex128)
    b = np.zeros(line.shape, np.complex128)
    for before in range(joint):
        k = np.tan(line.bends[..., before] / 2.0) ** 2
        a, b = a - k * b.conj(), b - k * a.conj()
        turn = 1j * np.exp(1j * (line.phases[..., before] - line.twists[..., before]))
        a, b = turn * a, turn * b
    return a, b

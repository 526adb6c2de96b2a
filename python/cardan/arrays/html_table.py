"""Drivelines, results and checks as tables of HTML, which notebooks show."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from html import escape

import numpy as np
from numpy.typing import NDArray

from cardan.arrays import FloatArray


def table(caption: str, heads: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    """Return a table of HTML; every text in it is escaped."""
    head = "".join(f"<th>{escape(text)}</th>" for text in heads)
    body = "".join(
        "<tr>" + "".join(f"<td>{escape(str(cell))}</td>" for cell in row) + "</tr>" for row in rows
    )
    return (
        f"<table><caption>{escape(caption)}</caption>"
        f"<thead><tr>{head}</tr></thead><tbody>{body}</tbody></table>"
    )


def driveline(caption: str, bends: FloatArray, twists: FloatArray, phases: FloatArray) -> str:
    """Return the angles of drivelines in degrees, a row for each joint and the shaft behind it."""
    n_joints = bends.shape[-1]
    rows = []
    for joint in range(n_joints):
        between = [_extent(a[..., joint]) if joint < n_joints - 1 else "" for a in (twists, phases)]
        rows.append((joint, _extent(bends[..., joint]), *between))
    heads = ("joint", "bend, deg", "twist of the next shaft, deg", "phase of the next shaft, deg")
    return table(caption, heads, rows)


def result(
    caption: str, arrays: Mapping[str, NDArray[np.floating]], units: Mapping[str, str]
) -> str:
    """Return name, unit, shape and extent of every output."""
    rows = [(name, units[name], shape, extent) for name, shape, extent in extents(arrays)]
    return table(caption, ("output", "unit", "shape", "smallest to largest"), rows)


def extents(arrays: Mapping[str, NDArray[np.floating]]) -> list[tuple[str, tuple[int, ...], str]]:
    """Return name, shape and extent of every array; of those computed later no extent."""
    # The figures of arrays that are computed later would take time.
    return [
        (name, np.shape(array), "" if hasattr(array, "__dask_graph__") else _extent(array))
        for name, array in arrays.items()
    ]


def _extent(values: NDArray[np.floating]) -> str:
    """The only value, or the smallest and the largest; NaN counts as none."""
    known = np.asarray(values)[~np.isnan(values)]
    if not known.size:
        return "no numbers" if np.size(values) else ""
    low, high = known.min(), known.max()
    return f"{low:.6g}" if low == high else f"{low:.6g} to {high:.6g}"

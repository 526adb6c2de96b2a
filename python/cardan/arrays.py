"""Arguments as arrays of doubles: what is accepted, and in which words it is refused."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

FloatArray = NDArray[np.float64]


def real(name: str, value: ArrayLike) -> FloatArray:
    """Return the argument as a contiguous array of doubles, without a copy where it is one.

    Raises:
        TypeError: complex numbers, objects, text or anything else that is not a real number; a
            masked array, of which the mask would be lost.
    """
    if isinstance(value, np.ma.MaskedArray):
        raise TypeError(f"{name} is a masked array; give NaN for what is missing: .filled(nan)")
    array = np.asarray(value)
    if array.dtype.kind not in "fiub":
        raise TypeError(f"{name} has dtype {array.dtype}; it must hold real numbers")
    array = np.asarray(array, dtype=np.float64, order="C")
    return array if array.flags.aligned else array.copy()


def scalar_or_array(array: FloatArray) -> Any:  # noqa: ANN401 - as NumPy's own functions
    """Return a 0-d array as a NumPy scalar, anything else unchanged."""
    return array[()]


def at_place(name: str, array: FloatArray, wrong: NDArray[np.bool_]) -> str:
    """Name the first offending element and its value: ``bends[2] is 1.6``."""
    index = tuple(int(i) for i in np.argwhere(wrong)[0])
    place = f"[{', '.join(map(str, index))}]" if index else ""
    return f"{name}{place} is {array[index]!s}"


def common_shape(**shapes: tuple[int, ...]) -> tuple[int, ...]:
    """Return the shape to which the named shapes broadcast.

    Raises:
        ValueError: they do not.
    """
    try:
        return np.broadcast_shapes(*shapes.values())
    except ValueError:
        listed = ", ".join(f"{name} {shape}" for name, shape in shapes.items())
        raise ValueError(f"shapes do not broadcast: {listed}") from None

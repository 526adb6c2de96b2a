"""Arguments as arrays of doubles: what is accepted, and in which words it is refused."""

from __future__ import annotations

import importlib
import sys
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

FloatArray = NDArray[np.float64]


def real(name: str, value: ArrayLike) -> FloatArray:
    """Return the argument as a contiguous array of doubles, without a copy where it is one.

    Raises:
        TypeError: complex numbers, objects, text or anything else that is not a real number; arrays
            that carry what would be lost, as a mask or a unit; arrays of another library.
        MemoryError: more numbers than can be counted in bytes.
    """
    if type(value) is not np.ndarray:
        _refuse_more_than_numbers(name, value)
    array = np.asarray(value)
    if array.dtype.kind not in "fiub":
        raise TypeError(f"{name} has dtype {array.dtype}; it must hold real numbers")
    if array.size > sys.maxsize // 8:
        raise MemoryError(f"{name} has shape {array.shape}; there is no room for so many numbers")
    array = np.asarray(array, dtype=np.float64, order="C")
    return array if array.flags.aligned else array.copy()


def _refuse_more_than_numbers(name: str, value: ArrayLike) -> None:
    kind = type(value)
    if not hasattr(kind, "__array_function__"):
        return
    if np.ma.is_masked(value):
        raise TypeError(f"{name} has masked entries; fill them or leave them out")
    full = f"{kind.__module__.partition('.')[0]}.{kind.__name__}"
    unit = getattr(value, "unit", getattr(value, "units", None))
    if unit is not None:
        raise TypeError(f"{name} is a {full} in {unit}; give plain numbers in the unit asked for")
    if not isinstance(value, np.ndarray):
        raise TypeError(f"{name} is a {full}; make it an array of NumPy first")


def library(value: object) -> Literal["", "dask", "xarray"]:
    """Return whose array it is, where it is one of a library that is handled beside NumPy.

    Nothing is imported for that: what is not imported has made no arrays.
    """
    if not hasattr(value, "__array__"):
        return ""
    for name, kind in (("xarray", "DataArray"), ("dask.array", "Array")):
        found = sys.modules.get(name)
        if found is not None and isinstance(value, getattr(found, kind, ())):
            return "dask" if name == "dask.array" else "xarray"
    return ""


def module(name: str, extra: str) -> Any:  # noqa: ANN401 - a module
    """Import an optional module, or say which extra brings it.

    Raises:
        ImportError: it is missing.
    """
    try:
        return importlib.import_module(name)
    except ModuleNotFoundError:
        hint = f"this needs {name}: pip install 'cardan[{extra}]'"
        raise ModuleNotFoundError(hint) from None


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

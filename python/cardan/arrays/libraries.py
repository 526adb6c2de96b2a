"""Array libraries beside NumPy: how to know their arrays, and who evaluates at them.

An adapter is a module that is built upon plans and drivelines, so it is imported only when such an
array comes. It defines ``evaluate(plan, angle, out)``; that of a library whose arrays are computed
later also defines ``construct(cls, constructor, ends, whole, given)``, which makes drivelines.
"""

from __future__ import annotations

import functools
import importlib
import inspect
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, TypeVar

_Function = TypeVar("_Function", bound=Callable[..., Any])


@dataclass(frozen=True)
class Library:
    """An array library."""

    module: str  # that defines its arrays
    array: str  # the name of their class there
    adapter: str  # the module that evaluates at them
    deferred: bool = False  # whether they are computed later
    wraps: str = ""  # the attribute by which they hold an array of another library


LIBRARIES: Mapping[str, Library] = MappingProxyType(
    {
        "xarray": Library("xarray", "DataArray", "cardan.interop.labelled", wraps="data"),
        "pandas": Library("pandas", "Series", "cardan.interop.labelled", wraps="values"),
        "dask": Library("dask.array", "Array", "cardan.interop.lazy", deferred=True),
    }
)
"""The libraries that are handled beside NumPy, by name."""

_PICTURES = "cardan.app.plots"


def array_namespace_of(value: object) -> str:
    """Return the name of the library in ``LIBRARIES`` that an array is of, or "".

    Nothing is imported for that: what is not imported has made no arrays.
    """
    if not hasattr(value, "__array__"):
        return ""
    for name, library in LIBRARIES.items():
        found = sys.modules.get(library.module)
        if found is not None and isinstance(value, getattr(found, library.array, ())):
            return name
    return ""


def adapter(name: str) -> Any:  # noqa: ANN401 - a module
    """Return the module that evaluates at the arrays of a library."""
    return importlib.import_module(LIBRARIES[name].adapter)


def draw(picture: str, *arguments: Any, **options: Any) -> Any:  # noqa: ANN401 - of matplotlib
    """Draw by the name of a function of ``cardan.plots``, which is built upon the library."""
    return getattr(importlib.import_module(_PICTURES), picture)(*arguments, **options)


def import_optional(name: str, extra: str) -> Any:  # noqa: ANN401 - a module
    """Import an optional module, or say which extra brings it."""
    try:
        return importlib.import_module(name)
    except ModuleNotFoundError:
        hint = f"this needs {name}: pip install 'cardan[{extra}]'"
        raise ModuleNotFoundError(hint) from None


def deferring(ends: int, **whole: int) -> Callable[[_Function], _Function]:
    """Let a constructor take arrays that are computed later, of which the adapter makes drivelines.

    The first of its arrays has ``ends`` entries beyond one per joint; ``whole`` names all in order,
    with how many axes of each belong to one driveline.
    """

    def decorate(constructor: _Function) -> _Function:
        @functools.wraps(constructor)
        def either(cls: type, *arrays: Any, **named: Any) -> Any:  # noqa: ANN401
            given = {**dict(zip(whole, arrays, strict=False)), **named}
            name = next(filter(None, map(_deferred_namespace_of, given.values())), "")
            if not name:
                return constructor(cls, *arrays, **named)
            inspect.signature(constructor).bind(cls, *arrays, **named)
            return adapter(name).construct(cls, constructor.__name__, ends, whole, given)

        return either  # type: ignore[return-value]

    return decorate


def _deferred_namespace_of(value: object) -> str:
    """The library whose array it is, or wraps, where that is computed later."""
    name = array_namespace_of(value)
    if name and LIBRARIES[name].wraps:
        name = array_namespace_of(getattr(value, LIBRARIES[name].wraps, None))
    return name if name and LIBRARIES[name].deferred else ""

"""What an evaluation returns."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray


class Result(Mapping[str, NDArray[np.float64]]):
    """Read-only mapping of output names to arrays, with attribute access.

    ``result["speed_ratio"]`` and ``result.speed_ratio`` are the same array. The arrays themselves
    are yours to change.
    """

    __slots__ = ("_arrays",)

    def __init__(self, arrays: Mapping[str, NDArray[np.float64]]) -> None:
        """Keep the arrays under their names."""
        self._arrays = dict(arrays)

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        """Return the array of one output."""
        return self._arrays[name]

    def __iter__(self) -> Iterator[str]:
        """Iterate over the output names, in the order asked for."""
        return iter(self._arrays)

    def __len__(self) -> int:
        """Return the number of outputs."""
        return len(self._arrays)

    def __getattr__(self, name: str) -> NDArray[np.float64]:
        """Return the array of one output."""
        # Copying and unpickling ask for attributes before there is anything to look in.
        if name != "_arrays" and name in self._arrays:
            return self._arrays[name]
        raise AttributeError(f"the result holds no {name!r}")

    def __dir__(self) -> list[str]:
        """List the outputs beside the methods."""
        return [*super().__dir__(), *self._arrays]

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle as the arrays by name."""
        return (Result, (self._arrays,))

    def __repr__(self) -> str:
        """Show names and shapes."""
        shapes = ", ".join(f"{name}: {array.shape}" for name, array in self._arrays.items())
        return f"Result({shapes})"

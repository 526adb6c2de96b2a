"""Arguments made from a fuzzer's bytes: mostly such as fit, else anything."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import atheris

with atheris.instrument_imports(include=["cardan"]):
    from cardan import Driveline

import numpy as np

REFUSED = (ValueError, TypeError, IndexError, MemoryError, OverflowError)
"""The exceptions by which a call may refuse its arguments."""
DTYPES = ("f4", "i8", "u1", "?", "f2", ">f8", "c16", "O", "S2", "m8[s]")
NUMBERS = (0.0, -0.0, 0.3, 1.5, -7.0, 1e-300, 5e-324, 1e12, 1e300, np.inf, -np.inf, np.nan)
MOST = 600
"""Elements of an array, and joints of all drivelines together."""


class Input(atheris.FuzzedDataProvider):
    """Arguments from bytes: three times in four such as fit, else anything."""

    def __init__(self, data: bytes) -> None:
        """Take the bytes."""
        super().__init__(data)
        self.wild = self.ConsumeIntInRange(0, 3) == 0

    def often(self, usual: Any, *others: Any) -> Any:  # noqa: ANN401
        """Return what is usual, or, among anything, one of the others."""
        return self.pick(others) if self.wild and self.ConsumeBool() else usual

    def pick(self, options: Sequence[Any]) -> Any:  # noqa: ANN401
        """Return one of the options."""
        return options[self.ConsumeIntInRange(0, len(options) - 1)]

    def shape(self) -> tuple[int, ...]:
        """Return a shape, mostly a small one."""
        if not self.wild:
            return (self.ConsumeIntInRange(0, MOST),) if self.ConsumeBool() else ()
        shape = [self.ConsumeIntInRange(0, 5) for _ in range(self.ConsumeIntInRange(0, 3))]
        if shape and self.ConsumeBool():
            shape[-1] = self.ConsumeIntInRange(0, MOST)
        return tuple(shape) if np.prod(shape) <= MOST else tuple(shape[:1])

    def array(self, shape: tuple[int, ...] | None = None, dtype: str = "f8") -> Any:  # noqa: ANN401
        """Return an array of any type and layout, or something like one."""
        shape = self.shape() if shape is None else shape
        values = [self.often(0.7, *NUMBERS), self.often(-2.0, self.ConsumeRegularFloat())]
        values += [self.ConsumeIntInRange(0, 15) / 10 for _ in range(3)]
        dtype = self.often(dtype, *DTYPES)
        with np.errstate(all="ignore"):
            array = np.resize(np.array(values), shape).reshape(shape)
            array = array.astype("i8" if dtype == "m8[s]" else "f8").astype(dtype)
        layout = self.ConsumeIntInRange(0, 7 if self.wild else 4)
        if layout == 0:
            array = np.asfortranarray(array)
        elif layout == 1 and array.ndim:
            array = array[::-1]
        elif layout == 2 and array.ndim:
            array = np.repeat(array, 2, -1)[..., ::2]
        elif layout == 3 and not array.dtype.hasobject:
            raw = np.zeros(array.nbytes + 1, "u1")
            raw[1:] = np.frombuffer(array.tobytes(), "u1")
            array = raw[1:].view(array.dtype).reshape(array.shape)
        elif layout == 7:
            array = np.broadcast_to(array.reshape(-1)[:1].sum(), shape)
        elif layout == 5:
            return array.tolist()
        elif layout == 6:
            return self.pick((None, "a", 1j, object(), [[1], [1, 2]], {}, 10**400))
        array.flags.writeable = array.flags.writeable and self.often(True, False)
        return array

    def flat(self, most: int = 40) -> Any:  # noqa: ANN401
        """Return a flat array of doubles, as the native module takes them."""
        return np.linspace(0.0, 1.5, self.ConsumeIntInRange(0, most))

    def count(self) -> int:
        """Return a number of joints or the like, small or beyond all measure."""
        return self.pick((0, 1, 1, 2, 2, 3, 4, 2**40, 2**62, 2**63, 2**64 - 1, -1))

    def counts(self) -> list[int]:
        """Return some of them."""
        return [self.count() for _ in range(self.ConsumeIntInRange(0, 3))]

    def line(self) -> Driveline:
        """Return a driveline or a batch, from whatever goes."""
        make = self.ConsumeIntInRange(0, 4) if self.wild else 4
        degrees = self.ConsumeBool()
        if make == 0:
            return Driveline.from_bends(self.array(), degrees=degrees)
        if make == 1:
            return Driveline.from_directions(self.array(), self.array(), degrees=degrees)
        if make == 2:
            return Driveline.from_points(self.array(), self.array())
        if make == 3:
            return Driveline.from_slopes(self.array(), self.array(), degrees=degrees)
        batch = self.pick(((), (), (1,), (3, 1), (0, 1), (2, 3, 1)))
        bends = np.resize(self.flat() + 0.01, (*batch, self.ConsumeIntInRange(1, 4))) % 1.5
        return Driveline.from_bends(bends, self.array(()), self.array(()))

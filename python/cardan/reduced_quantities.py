"""Outputs over a turn of the drive, reduced to one number: their names, values and derivatives."""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import Any

import numpy as np

from cardan.arrays import FloatArray
from cardan.load import Load
from cardan.outputs import OUTPUTS, Output
from cardan.parameters import Parameters
from cardan.request import REDUCTIONS, Items, Reduction, item_index
from cardan.sweep import Sweep

_SAMPLES_PER_TURN = 360

# Of these a turn of the drive is the period; all else repeats after half a turn.
_PER_TURN = frozenset({"angle", "tilt_driving", "tilt_driven"})


@dataclass(frozen=True, eq=False)
class ReducedQuantity:
    """An output over a turn of the drive, reduced to one number.

    Attributes:
        output: what is evaluated.
        items: of which shafts or joints, as ``Driveline.evaluate`` takes them, or the index of a
            bearing; the largest value counts. ``None``: the last shaft, all joints or bearings.
        reduction: of the samples; of a vector, the length of what it makes of the components.
    """

    output: Output
    items: Items
    reduction: Reduction

    @property
    def unit(self) -> str:
        """SI unit; ``"1"`` for a ratio."""
        return self.output.unit

    @property
    def label(self) -> str:
        """What to call it in words: ``support moment of shaft 1, peak``."""
        of = "" if self.items is None else f" of {self.output.per} {self.items}"
        return f"{self.output.label}{of}, {self.reduction}"

    def check_item(self, line: Any) -> None:  # noqa: ANN401 - a driveline
        """Check that a driveline has the shaft, joint or bearing that the quantity names.

        Raises:
            IndexError: it has none.
        """
        per = self.output.per
        counts = {"shaft": line.n_joints + 1, "joint": line.n_joints, "bearing": line.n_bearings}
        if isinstance(self.items, int):
            item_index(f"{per} of {self.output.name}", self.items, counts[per])

    def of(self, line: Any, load: Load | None, workers: int | None = None) -> FloatArray:  # noqa: ANN401
        """Return the number of each driveline, in the shape of the batch.

        Args:
            line: the drivelines.
            load: for an output that needs one; its values broadcast to the batch.
            workers: largest number of threads, as for ``Driveline.evaluate``.

        Raises:
            IndexError: a shaft, joint or bearing that does not exist.
            ValueError: as of ``Driveline.evaluate``.
        """
        plan = self._plan(line, load, reduce=self.reduction, workers=workers)
        values = np.asarray(plan(self._angles)[self.output.name])
        if self.output.per == "bearing" and self.items is not None:
            values = values[self.items]
        if self.output.vector and self.reduction != "peak":
            values = np.linalg.norm(values, axis=-1)
        return np.asarray(values if values.ndim == len(line.shape) else np.max(values, axis=0))

    @property
    def differentiable(self) -> bool:
        """Whether ``derivatives`` are known: not of forces, nor of the ends of vectors."""
        ends = self.output.vector and self.reduction in ("min", "max")
        return self.output.unit != "N" and not ends

    def derivatives(self, line: Any, load: Load | None, by: Parameters) -> FloatArray:  # noqa: ANN401
        """Return the derivatives of ``of`` by parameters of each driveline.

        An end of the samples changes as the sample at which it lies.

        Args:
            line: the drivelines.
            load: as of ``of``.
            by: ``"bends"``, ``"twists"``, ``"phases"`` or ``"points"``.

        Returns:
            in the shape of the batch, followed by that of the parameters.
        """
        plan, name = self._plan(line, load), self.output.name
        values = np.asarray(plan(self._angles)[name])
        gradient = plan.gradient(self._angles, {name: self._weights(values)})
        return np.asarray(np.squeeze(getattr(gradient, by), axis=len(line.shape)))

    def _weights(self, values: FloatArray) -> FloatArray:
        """The derivatives of the number by the samples, ``(*batch, samples, [3])``."""
        columns = values if self.output.vector else values[..., np.newaxis]
        sizes = np.linalg.norm(columns, axis=-1, keepdims=True)
        count = columns.shape[-2]
        if self.reduction == "mean":
            mean = np.mean(columns, axis=-2, keepdims=True)
            length = np.linalg.norm(mean, axis=-1, keepdims=True)
            # The mean of a scalar keeps its sign.
            along = mean / np.where(length > 0.0, length, 1.0) if self.output.vector else 1.0
            weights = np.broadcast_to(along / count, columns.shape)
        elif self.reduction == "rms":
            rms = np.sqrt(np.mean(sizes**2, axis=-2, keepdims=True))
            weights = columns / (count * np.where(rms > 0.0, rms, 1.0))
        else:
            of = {"peak": sizes, "max": columns, "min": -columns}[self.reduction]
            chosen = np.arange(count)[:, np.newaxis] == np.argmax(of, axis=-2)[..., np.newaxis, :]
            along = columns / np.where(sizes > 0.0, sizes, 1.0) if self.reduction == "peak" else 1.0
            weights = np.where(chosen, along, 0.0)
        return np.asarray(weights if self.output.vector else weights[..., 0])

    @property
    def _angles(self) -> Sweep:
        return Sweep.revolutions(1.0 if self.output.name in _PER_TURN else 0.5, _SAMPLES_PER_TURN)

    def _plan(self, line: Any, load: Load | None, **options: Any) -> Any:  # noqa: ANN401
        """The plan of the output for drivelines with an axis for the drive angles."""
        per = self.output.per
        items = {} if per == "bearing" else {f"{per}s": self.items}
        at = None if load is None else load.at_any_angle()
        return line[..., np.newaxis].plan(self.output.name, load=at, **items, **options)


def reduced_quantity(name: str) -> ReducedQuantity | None:
    """Return the reduced output of a name; ``None`` if it is not one.

    >>> reduced_quantity("support_moment_1_peak").items
    1
    """
    for output in OUTPUTS.values():
        if re.fullmatch(pattern(output), name):
            rest, _, last = name.rpartition("_")
            number = rest.removeprefix(output.name)
            reduction = next(known for known in REDUCTIONS if known == last)
            return ReducedQuantity(output, int(number[1:]) if number else None, reduction)
    return None


def pattern(output: Output) -> str:
    """Return the regular expression of the names of an output's reductions."""
    number = "(_[0-9]{1,9})?" if output.per == "shaft" else "_[0-9]{1,9}"
    return f"{output.name}{number}_({'|'.join(REDUCTIONS)})"

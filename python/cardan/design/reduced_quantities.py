"""Outputs over a turn of the drive, reduced to one number: their names, values and derivatives."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from cardan.arrays import FloatArray
from cardan.arrays.indices import Items, item_index
from cardan.evaluation.load import Load
from cardan.evaluation.outputs import OUTPUTS, Output
from cardan.evaluation.request import REDUCTIONS, Reduction
from cardan.evaluation.sweep import Sweep

if TYPE_CHECKING:
    from cardan.driveline import Driveline
    from cardan.evaluation.plan import Plan

_Kind = TypeVar("_Kind", bound=str)

_SAMPLES_PER_TURN = 360


@dataclass(frozen=True, eq=False)
class ReducedQuantity:
    """An output over a turn of the drive, reduced to one number.

    The items are shafts or joints as ``Driveline.evaluate`` takes them, or the index of a bearing;
    the largest value counts. ``None`` is the last shaft, all joints or bearings. Of a vector, the
    length of what the reduction makes of the components counts.
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

    def check_item(self, line: Driveline) -> None:
        """Check that a driveline has the shaft, joint or bearing that the quantity names."""
        per = self.output.per
        counts = {"shaft": line.n_joints + 1, "joint": line.n_joints, "bearing": line.n_bearings}
        if isinstance(self.items, int):
            item_index(f"{per} of {self.output.name}", self.items, counts[per])

    def of(self, line: Driveline, load: Load | None, workers: int | None = None) -> FloatArray:
        """Return the number of each driveline, in the shape of the batch.

        The values of a load broadcast to the batch.
        """
        self.check_item(line)
        values = self._plan(line, load, workers)(self._angles(line))[self.output.name]
        sizes = self._sizes(np.asarray(values))
        if self._bearing is not None:
            sizes = sizes[self._bearing]
        return np.asarray(sizes if sizes.ndim == len(line.shape) else np.max(sizes, axis=0))

    def derivatives(
        self, line: Driveline, load: Load | None, by: Iterable[_Kind]
    ) -> dict[_Kind, FloatArray]:
        """Return the derivatives of ``of`` by parameters of each driveline.

        An end of the samples changes as the sample at which it lies, and the largest of several
        items as that item. The parameters are any of ``LAYOUT_VARIABLES`` that the drivelines
        have, or the deviations of joints as built; their axes follow those of the batch.
        """
        plan, name, batch = self._plan(line, load), self.output.name, len(line.shape)
        values = np.asarray(plan(self._angles(line))[name])
        sizes, weights = self._sizes(values), np.ones_like(values)
        if sizes.ndim < values.ndim:
            # A length that vanishes has no direction to grow in.
            lengths = sizes[..., np.newaxis]
            weights = np.divide(values, lengths, out=np.zeros_like(values), where=lengths > 0.0)
        if sizes.ndim > batch:
            number = np.argmax(sizes, axis=0) if self._bearing is None else self._bearing
            chosen = np.arange(len(sizes)).reshape(-1, *(1,) * batch) == number % len(sizes)
            weights = weights * chosen.reshape(chosen.shape + (1,) * (weights.ndim - chosen.ndim))
        gradient = plan.gradient(self._angles(line), {name: weights})
        return {kind: np.squeeze(getattr(gradient, kind), axis=batch) for kind in by}

    def _sizes(self, values: FloatArray) -> FloatArray:
        """What counts of the reduced output: of a vector, except a peak, its length."""
        of_vector = self.output.vector and self.reduction != "peak"
        return np.linalg.norm(values, axis=-1) if of_vector else values

    @property
    def _bearing(self) -> int | None:
        """The only bearing that counts: a plan has all of them."""
        return self.items if self.output.per == "bearing" and isinstance(self.items, int) else None

    def _angles(self, line: Driveline) -> Sweep:
        # Joints as built repeat after a whole turn only.
        # All else repeats after half a turn.
        whole = self.output.name == "angle" or self.output.of_cross or line.has_deviations
        return Sweep.revolutions(1.0 if whole else 0.5, _SAMPLES_PER_TURN)

    def _plan(self, line: Driveline, load: Load | None, workers: int | None = None) -> Plan:
        """The plan of the output for drivelines with an axis for the drive angles."""
        per = self.output.per
        items: dict[str, Any] = {} if per == "bearing" else {f"{per}s": self.items}
        at = None if load is None else load.at_any_angle()
        return line[..., np.newaxis].plan(
            self.output.name, load=at, reduce=self.reduction, workers=workers, **items
        )


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

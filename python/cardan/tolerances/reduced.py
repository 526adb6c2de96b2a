"""Reduced outputs of drivelines that deviate from their drawing."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from cardan import geometry
from cardan.arrays import FloatArray
from cardan.errors import ArgumentValueError
from cardan.geometry import Geometry
from cardan.load import Load
from cardan.outputs import OUTPUTS
from cardan.request import Items
from cardan.sweep import Sweep
from cardan.tolerances.chain import Deviations, Nominal

REDUCTIONS = ("peak", "rms", "max", "mean")
"""The reductions of which the largest value is the worst."""

# Drivelines at a time: each has its geometry with directions and normals.
_BLOCK = 2048

_SAMPLES_PER_TURN = 360


@dataclass(frozen=True, eq=False)
class ReducedOutput:
    """An output over one turn, reduced to one number: the largest of all requested items.

    Attributes:
        name: of the output.
        reduce: of the samples over the turn.
        load: for the outputs that need one.
        shafts: as of ``Driveline.evaluate``.
        joints: likewise.
        workers: largest number of threads.
    """

    name: str
    reduce: str
    load: Load | None
    shafts: Items
    joints: Items
    workers: int | None

    @property
    def unit(self) -> str:
        """SI unit."""
        return OUTPUTS[self.name].unit

    def check(self) -> None:
        """Check that one number comes out of which the largest is the worst.

        Raises:
            ValueError: another reduction, a vector that is not reduced to its largest length.
        """
        if self.reduce not in REDUCTIONS:
            known = ", ".join(map(repr, REDUCTIONS))
            raise ArgumentValueError("reduce", f"is {self.reduce!r}; it must be one of {known}")
        if OUTPUTS[self.name].vector and self.reduce != "peak":
            raise ArgumentValueError(
                "reduce", f"is {self.reduce!r}; the vector {self.name!r} needs 'peak'"
            )

    def values(
        self,
        line_of: Callable[[Geometry], Any],
        own: Geometry,
        nominal: Nominal,
        deviations: Deviations,
        samples: int,
    ) -> FloatArray:
        """Return the number for each sample.

        Args:
            line_of: makes the driveline of a geometry.
            own: the geometry of the driveline as drawn; its bearings and lengths stay.
            nominal: its parameters.
            deviations: by how much they deviate, ``(samples,)`` each.
            samples: how many samples there are.
        """
        found = np.empty(samples)
        for first in range(0, samples, _BLOCK):
            some = slice(first, min(first + _BLOCK, samples))
            part = {place: values[some] for place, values in deviations.items()}
            found[some] = self._block(line_of, _geometry(own, nominal, part, some.stop - first))
        return found

    def _block(self, line_of: Callable[[Geometry], Any], made: Geometry) -> FloatArray:
        line = line_of(made)[:, np.newaxis]
        result = line.evaluate(
            Sweep.revolutions(1, _SAMPLES_PER_TURN),
            self.name,
            load=self.load,
            shafts=self.shafts,
            joints=self.joints,
            reduce=self.reduce,
            workers=self.workers,
        )
        values = np.asarray(result[self.name])
        return np.asarray(values if values.ndim == 1 else np.max(values, axis=0))


def _geometry(own: Geometry, nominal: Nominal, deviations: Deviations, samples: int) -> Geometry:
    """The drivelines of the samples, with the bearings of the one as drawn."""

    def deviated(group: str, array: FloatArray) -> FloatArray:
        values = np.repeat(array[np.newaxis], samples, axis=0)
        for (name, place), deviation in deviations.items():
            if name == group:
                np.moveaxis(values, 0, -1)[place] += deviation
        return values

    phases = deviated("phases", nominal.phases)
    if nominal.points is not None:
        made = geometry.from_points(deviated("points", nominal.points), phases, False)
        lengths = made.lengths
    else:
        bends, twists = deviated("bends", nominal.bends), deviated("twists", nominal.twists)
        # Beyond straight a joint bends to the other side: its plane has turned by half a turn.
        flipped = bends < 0.0
        twists += np.pi * (flipped[:, 1:].astype(float) - flipped[:, :-1])
        made = geometry.from_bends(np.abs(bends), twists, phases, False)
        lengths = np.repeat(own.lengths[np.newaxis], samples, axis=0)
    positions = np.repeat(own.positions[np.newaxis], samples, axis=0)
    return made._replace(lengths=lengths, positions=positions, bearings=own.bearings)

"""One driveline with its tolerances: the worst case, the linear one, the bound and the shares."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, TypeAlias

import numpy as np

from cardan.arrays import FloatArray
from cardan.geometry import Geometry
from cardan.tolerances.box import Box
from cardan.tolerances.chain import ComplexArray
from cardan.tolerances.guaranteed import largest_modulus
from cardan.tolerances.quantities import Figure, amplitude
from cardan.tolerances.reduced import ReducedOutput
from cardan.tolerances.worst import MOST_CORNERS, largest_in_box, zonotope_radius

Quantity: TypeAlias = Figure | ReducedOutput

# Differences by this part of a tolerance: 9 digits remain, and a tolerance is a small change.
_STEP = 1e-4

# Every trial of a reduced output is an evaluation over a turn.
_MOST_REDUCED = 10


@dataclass(frozen=True, eq=False)
class Case:
    """One driveline, its tolerances, and what its figures depend on besides.

    Attributes:
        box: the parameters and their tolerances.
        geometry: the driveline as drawn, with its bearings.
        line_of: makes a driveline of a geometry.
        shaft: the shaft of the figures.
        speed: of the drive in rad/s.
    """

    box: Box
    geometry: Geometry
    line_of: Callable[[Geometry], Any]
    shaft: int
    speed: float

    def scaled(self, group: str, factor: float) -> Case:
        """Return the case with the tolerances of one group multiplied."""
        return replace(self, box=self.box.scaled(group, factor))

    def values(
        self, quantities: Mapping[str, Quantity], deviations: FloatArray
    ) -> dict[str, FloatArray]:
        """Return figures by name; each amplitude is computed once.

        Args:
            quantities: the figures.
            deviations: of the parameters, ``(parameters, samples)``.
        """
        by_place, samples = self.box.deviations(deviations), deviations.shape[1]
        moduli: dict[str, FloatArray] = {}
        found = {}
        for name, quantity in quantities.items():
            if isinstance(quantity, ReducedOutput):
                found[name] = quantity.values(
                    self.line_of, self.geometry, self.box.nominal, by_place, samples
                )
                continue
            kind = quantity.amplitude
            if kind not in moduli:
                q = amplitude(kind, self.box.nominal, by_place, self.shaft)
                moduli[kind] = np.broadcast_to(np.abs(q), samples)
            found[name] = quantity.of_modulus(moduli[kind], self.speed)
        return found

    def nominal(self, quantity: Quantity) -> float:
        """Return the figure of the driveline as drawn."""
        return float(self._of_units(quantity)(np.zeros((len(self.box.places), 1)))[0])

    def searched(self, quantity: Quantity) -> bool:
        """Whether the worst case is searched over the box, not found to first order."""
        most = _MOST_REDUCED if isinstance(quantity, ReducedOutput) else MOST_CORNERS
        return len(self.box.places) <= most

    def worst(self, quantity: Quantity) -> float:
        """Return the worst figure; the linear one is never more than the guaranteed bound."""
        if self.searched(quantity):
            return self._search(quantity)[0]
        linear = self.linear(quantity)
        return (
            linear
            if isinstance(quantity, ReducedOutput)
            else min(linear, self.guaranteed(quantity))
        )

    def worst_at(self, quantity: Quantity) -> FloatArray:
        """Return the deviations of the worst driveline, ``(parameters,)``."""
        return np.asarray(self._search(quantity)[1] * self.box.sizes)

    def linear(self, quantity: Quantity) -> float:
        """Return the worst figure to first order."""
        changes = self.slopes(quantity) * self.box.sizes
        if isinstance(quantity, ReducedOutput):
            return self.nominal(quantity) + float(np.sum(np.abs(changes)))
        centre = complex(amplitude(quantity.amplitude, self.box.nominal, {}, self.shaft))
        modulus = zonotope_radius(centre, changes)
        if quantity.amplitude == "last":
            # Large tolerances leave the linear range; a joint has |q| < 1.
            modulus = min(modulus, float(np.nextafter(1.0, 0.0)))
        return self._figure(quantity, modulus)

    def guaranteed(self, quantity: Figure) -> float:
        """Return a bound of the figure over the box."""
        return self._figure(quantity, largest_modulus(quantity.amplitude, self.box, self.shaft))

    def shares(self, quantity: Quantity) -> FloatArray:
        """Return the share of each parameter in the scatter, ``(parameters,)``."""
        parts = np.square(np.abs(self.slopes(quantity)) * self.box.sigmas)
        total = np.sum(parts)
        return np.asarray(parts / total if total > 0.0 else parts)

    def slopes(self, quantity: Quantity) -> ComplexArray:
        """Return the derivatives by each parameter, of the amplitude or of the reduced output."""
        steps = np.diag(np.full(len(self.box.places), _STEP))
        units = np.concatenate([steps, -steps], axis=1)
        if isinstance(quantity, ReducedOutput):
            values = self._of_units(quantity)(units).astype(complex)
        else:
            by_place = self.box.deviations(units * self.box.sizes[:, np.newaxis])
            found = amplitude(quantity.amplitude, self.box.nominal, by_place, self.shaft)
            values = np.broadcast_to(found, units.shape[1])
        plus, minus = np.split(values, 2)
        return np.asarray((plus - minus) / (2.0 * _STEP * self.box.sizes))

    def _figure(self, quantity: Figure, modulus: float) -> float:
        return float(quantity.of_modulus(np.asarray(modulus), self.speed))

    def _of_units(self, quantity: Quantity) -> Callable[[FloatArray], FloatArray]:
        """The figure as a function of deviations in units of the tolerances."""
        sizes = self.box.sizes[:, np.newaxis]
        return lambda units: self.values({"": quantity}, units * sizes)[""]

    def _search(self, quantity: Quantity) -> tuple[float, FloatArray]:
        """The worst driveline: its figure, and the deviations in units of the tolerances."""
        # Figures of one amplitude have their maximum in one place.
        key = quantity if isinstance(quantity, ReducedOutput) else quantity.amplitude
        if key not in self._searches:
            _, at = largest_in_box(self._of_units(quantity), len(self.box.places))
            self._searches[key] = at
        at = self._searches[key]
        return float(self._of_units(quantity)(at[:, np.newaxis])[0]), at

    @cached_property
    def _searches(self) -> dict[Any, FloatArray]:
        return {}

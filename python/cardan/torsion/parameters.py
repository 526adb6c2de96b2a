"""The parameters of a torsional system, checked and broadcast."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Self

import numpy as np
from numpy.typing import ArrayLike

from cardan.arrays import (
    FloatArray,
    as_float64,
    common_shape,
    finite,
    not_negative,
    per_shaft,
    together,
)
from cardan.arrays.errors import ArgumentValueError, check_elements, check_shape
from cardan.driveline import Driveline


@dataclass(frozen=True, eq=False)
class TorsionParameters:
    """What the shafts of a batch of systems have, all broadcast to the shape of the batch."""

    shape: tuple[int, ...]
    inertias: FloatArray  # (..., n + 1, 2)
    stiffnesses: FloatArray
    dampings: FloatArray
    load_torque: FloatArray
    load_damping: FloatArray

    @classmethod
    def checked(
        cls,
        line: Driveline,
        inertias: ArrayLike,
        stiffnesses: ArrayLike,
        dampings: ArrayLike | None,
        load_torque: ArrayLike,
        load_damping: ArrayLike,
    ) -> Self:
        """Check the arguments of ``TorsionalSystem``."""
        shafts = line.n_joints + 1
        ends = _pairs(not_negative("inertias", inertias), shafts)
        springs = _per_shaft("stiffnesses", as_float64("stiffnesses", stiffnesses), shafts)
        rule = "; a stiffness must be positive, infinite for a rigid shaft"
        check_elements("stiffnesses", springs, springs > 0.0, rule)
        compliant = springs < np.inf
        alike = compliant == compliant.reshape(-1, shafts)[:1].reshape(shafts)
        rule = "; the same shafts must be compliant in the whole batch"
        check_elements("stiffnesses", springs, alike, rule)
        viscosity = not_negative("dampings", 0.0 if dampings is None else dampings)
        damping = _per_shaft("dampings", viscosity, shafts)
        torque = finite("load_torque", load_torque)
        viscous = not_negative("load_damping", load_damping)
        given = {
            "inertias": (ends, 2),
            "stiffnesses": (springs, 1),
            "dampings": (damping, 1),
            "load_torque": (torque, 0),
            "load_damping": (viscous, 0),
        }
        shape, full = together(given, driveline=line.shape)
        # Copies: the caller may change the arrays.
        kept = [np.array(array) for array in full]
        for array in kept:
            array.flags.writeable = False
        return cls(shape, *kept)

    @property
    def compliant(self) -> tuple[int, ...]:
        """The compliant shafts."""
        shafts = self.stiffnesses.shape[-1]
        first = self.stiffnesses.reshape(-1, shafts)[:1].ravel()
        return tuple(int(i) for i in np.flatnonzero(first < np.inf))

    def flat(self) -> tuple[list[FloatArray], list[FloatArray]]:
        """Return the properties of shafts and the loads as the native module takes them."""
        shafts = [self.inertias, self.stiffnesses, self.dampings]
        load = [self.load_torque, self.load_damping]
        return [array.ravel() for array in shafts], [array.ravel() for array in load]

    def with_ratios(self, ratios: ArrayLike, lowest: FloatArray, joints: int) -> TorsionParameters:
        """Return the parameters with dampings from damping ratios."""
        given = not_negative("damping_ratios", ratios)
        given = _per_shaft("damping_ratios", given, joints + 1)
        shape = common_shape(system=self.shape, damping_ratios=given.shape[:-1])
        if shape != self.shape:
            raise ArgumentValueError(
                "damping_ratios", f"has the batch {given.shape[:-1]}, the system {self.shape}"
            )
        springs = np.where(self.stiffnesses < np.inf, self.stiffnesses, 0.0)
        return replace(self, dampings=np.array(2.0 * given * springs / lowest))


def checked_tolerance(tolerance: float) -> float:
    """Return the permitted error of an orbit."""
    value = float(as_float64("tolerance", tolerance))
    if not 1e-12 <= value <= 1e-3:
        raise ArgumentValueError("tolerance", f"is {value!r}; it must be from 1e-12 to 1e-3")
    return value


def _pairs(inertias: FloatArray, shafts: int) -> FloatArray:
    if inertias.shape[-2:] == (shafts, 2):
        return inertias
    rule = f"it needs one per shaft, (..., {shafts}), or one per end, (..., {shafts}, 2)"
    check_shape("inertias", inertias, inertias.shape[-1:] == (shafts,), rule)
    return np.repeat(0.5 * inertias[..., np.newaxis], 2, axis=-1)


def _per_shaft(name: str, array: FloatArray, shafts: int) -> FloatArray:
    return per_shaft(name, array, shafts) if array.ndim else np.full(shafts, array)

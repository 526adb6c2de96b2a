"""Shafts of round section: stiffness, inertia, shear stress and critical bending speed."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from cardan import _core
from cardan.arrays import (
    FloatArray,
    as_float64,
    common_shape,
    not_negative,
    positive,
    scalar_or_array,
    together,
)
from cardan.arrays.errors import ArgumentValueError, check_elements


@dataclass(frozen=True, eq=False)
class Tube:
    """A shaft of round section; each figure in the shape to which the arguments broadcast.

    Attributes:
        stiffness: torsional stiffness ``G I_p / L`` in N m/rad.
        inertia: moment of inertia about the axis ``rho I_p L`` in kg m².
        mass: in kg.
        critical_speed: first critical bending speed in rad/s, of a tube that is pinned at both
            ends: ``(pi/L)**2 sqrt(E I/(rho A))``.
        bending_stiffness: ``E I`` in N m².
        line_mass: mass per length ``rho A`` in kg/m.
        shear_stiffness: ``kappa G A`` in N with ``rotary``, else infinite.
        rotary_inertia: ``rho I`` in kg m with ``rotary``, else 0.
        loss_factor: as given.
    """

    stiffness: Any
    inertia: Any
    mass: Any
    critical_speed: Any
    bending_stiffness: Any
    line_mass: Any
    shear_stiffness: Any
    rotary_inertia: Any
    loss_factor: Any
    _shear_per_torque: FloatArray

    def shear_stress(self, torque: ArrayLike) -> Any:  # noqa: ANN401 - a scalar or an array
        """Return the largest shear stress ``T D / (2 I_p)`` in Pa, at the outer surface.

        Args:
            torque: in N m; broadcasts against the tube. Errors are as of ``cardan.tube``.
        """
        torques = as_float64("torque", torque)
        common_shape(tube=self._shear_per_torque.shape, torque=torques.shape)
        return scalar_or_array(np.asarray(self._shear_per_torque * torques))


WIDEST = 2.0
"""Diameter in m above which a shaft is probably given in another unit."""

SHEAR_MODULUS = 7.93e10
"""Shear modulus of steel in Pa."""


def tube(
    outer_diameter: ArrayLike,
    wall: ArrayLike | None = None,
    *,
    length: ArrayLike,
    shear_modulus: ArrayLike = SHEAR_MODULUS,
    elastic_modulus: ArrayLike = 2.06e11,
    density: ArrayLike = 7850.0,
    rotary: bool = False,
    shear_coefficient: ArrayLike | None = None,
    loss_factor: ArrayLike = 0.0,
) -> Tube:
    """Return the figures of a round shaft, by the textbook formulas for slender bars.

    Arguments broadcast against each other. The defaults are those of steel. A shaft wider than 2 m
    gives a warning, because its sizes are probably not in metres.

    Args:
        outer_diameter: in m.
        wall: thickness of the wall in m, at most half the diameter; a solid shaft by default.
        length: in m.
        shear_modulus: ``G`` in Pa.
        elastic_modulus: ``E`` in Pa.
        density: in kg/m³.
        rotary: whether a ``LateralSystem`` counts shear and rotary inertia (Timoshenko), and not
            bending alone (Euler and Bernoulli).
        shear_coefficient: ``kappa`` of Timoshenko's theory, by default that of Cowper, 1966.
        loss_factor: of the material for a ``LateralSystem``, at most 1.

    Raises:
        TypeError: values that are not real numbers.
        ValueError: a value that is not positive and finite, a wall thicker than half the diameter,
            a shear coefficient without ``rotary``, shapes that do not broadcast.

    >>> import cardan
    >>> shaft = cardan.tube(0.09, 0.003, length=1.5)
    >>> float(shaft.stiffness.round(1)), float((shaft.shear_stress(2000.0) / 1e6).round(3))
    (82123.4, 57.937)
    """
    diameter = positive("outer_diameter", outer_diameter)
    if np.any(diameter > WIDEST):
        text = f"outer_diameter reaches {np.max(diameter):g}; sizes are in metres"
        warnings.warn(text, stacklevel=2)
    given = {
        "outer_diameter": diameter,
        "wall": 0.5 * diameter if wall is None else wall,
        "length": length,
        "shear_modulus": shear_modulus,
        "elastic_modulus": elastic_modulus,
        "density": density,
    }
    if shear_coefficient is not None and not rotary:
        problem = "is given without rotary=True; without it shear has no effect"
        raise ArgumentValueError("shear_coefficient", problem)
    checked = {name: (positive(name, value), 0) for name, value in given.items()}
    loss = (not_negative("loss_factor", loss_factor), 0)
    shape, (*sizes, own_loss) = together(checked | {"loss_factor": loss})
    outer, thickness, own_length, shear, elastic, weight = sizes
    rule = " m; a wall is at most half the outer diameter"
    check_elements("wall", thickness, thickness <= 0.5 * outer, rule)
    flat = _core.tubes([array.ravel() for array in sizes])
    stiffness, inertia, mass, speed, shear_per_torque, bending, cowper = flat.reshape(7, *shape)
    line_mass = mass / own_length
    by_shear, by_turning = np.full(shape, np.inf), np.zeros(shape)
    if rotary:
        coefficient = cowper
        if shear_coefficient is not None:
            coefficient = positive("shear_coefficient", shear_coefficient)
        by_shear = np.asarray(coefficient * shear * line_mass / weight)
        by_turning = np.asarray(weight * bending / elastic)
    by_shear, by_turning, own_loss = map(scalar_or_array, (by_shear, by_turning, own_loss))
    return Tube(
        *(stiffness, inertia, mass, speed, bending, line_mass, by_shear, by_turning, own_loss),
        np.asarray(shear_per_torque),
    )

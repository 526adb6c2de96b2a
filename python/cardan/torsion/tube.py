"""Shafts of round section: stiffness, inertia, shear stress and critical bending speed."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from cardan import _core
from cardan.arrays import FloatArray, as_float64, common_shape, positive, scalar_or_array, together
from cardan.arrays.errors import check_elements


@dataclass(frozen=True, eq=False)
class Tube:
    """A shaft of round section; each figure in the shape to which the arguments broadcast.

    Attributes:
        stiffness: torsional stiffness ``G I_p / L`` in N m/rad.
        inertia: moment of inertia about the axis ``rho I_p L`` in kg m².
        mass: in kg.
        critical_speed: first critical bending speed in rad/s, of a tube that is pinned at both
            ends: ``(pi/L)**2 sqrt(E I/(rho A))``.
    """

    stiffness: Any
    inertia: Any
    mass: Any
    critical_speed: Any
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
"""That of steel in Pa."""


def tube(
    outer_diameter: ArrayLike,
    wall: ArrayLike | None = None,
    *,
    length: ArrayLike,
    shear_modulus: ArrayLike = SHEAR_MODULUS,
    elastic_modulus: ArrayLike = 2.06e11,
    density: ArrayLike = 7850.0,
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

    Raises:
        TypeError: values that are not real numbers.
        ValueError: a value that is not positive and finite, a wall thicker than half the diameter,
            shapes that do not broadcast.

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
    shape, full = together({name: (positive(name, x), 0) for name, x in given.items()})
    rule = " m; a wall is at most half the outer diameter"
    check_elements("wall", full[1], full[1] <= 0.5 * full[0], rule)
    flat = _core.tubes([array.ravel() for array in full])
    stiffness, inertia, mass, speed, shear_per_torque = flat.reshape(5, *shape)
    return Tube(stiffness, inertia, mass, speed, np.asarray(shear_per_torque))

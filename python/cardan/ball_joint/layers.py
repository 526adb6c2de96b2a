"""The compliance of a layer, such as the lining of a seat: Marcus's coefficients from a material.

Marcus leaves his ``alpha_1`` and ``alpha_2`` to experience. His law, a compression in proportion to
the pressure of the same point, is that of an elastic layer on a rigid ground that is wide in
comparison with its thickness, so that it cannot expand sideways (Winkler's foundation; K. L.
Johnson, "Contact Mechanics", 1985, section 4.3).
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from cardan.arrays import as_float64, common_shape, scalar_or_array
from cardan.arrays.errors import wrong_element


def layer_compliance(thickness: ArrayLike, modulus: ArrayLike, poisson: ArrayLike = 0.3) -> Any:  # noqa: ANN401 - a scalar or an array
    """Return how far a layer is compressed per unit of pressure, in m³/N (m per Pa).

    It is ``t (1 + nu)(1 - 2 nu)/((1 - nu) E)``: the layer is bonded to what is behind it, much
    stiffer than that, and much thinner than the contact is wide. The compliance of a ball joint
    is the sum of those of ball and seat.

    Args:
        thickness: of the layer in m.
        modulus: Young's modulus in Pa.
        poisson: Poisson's ratio, in [0, 0.5). Near 0.5 the layer hardly yields in this way, and
            the model does not describe it.

    Raises:
        TypeError: values that are not real numbers.
        ValueError: a thickness or modulus that is not positive and finite, a ratio out of its
            range, shapes that do not broadcast.

    >>> f"{layer_compliance(0.5e-3, 1e9, 0.3):.3g}"
    '3.71e-13'
    """
    values = {
        "thickness": as_float64("thickness", thickness),
        "modulus": as_float64("modulus", modulus),
        "poisson": as_float64("poisson", poisson),
    }
    for name in ("thickness", "modulus"):
        wrong = ~((values[name] > 0.0) & (values[name] < np.inf))
        if wrong.any():
            raise wrong_element(name, values[name], wrong, "; it must be positive and finite")
    ratio = values["poisson"]
    wrong = ~((ratio >= 0.0) & (ratio < 0.5))
    if wrong.any():
        raise wrong_element("poisson", ratio, wrong, "; Poisson's ratio must lie in [0, 0.5)")
    common_shape(**{name: value.shape for name, value in values.items()})
    lateral = (1.0 + ratio) * (1.0 - 2.0 * ratio) / (1.0 - ratio)
    return scalar_or_array(values["thickness"] * lateral / values["modulus"])

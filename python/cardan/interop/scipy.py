"""Values with gradients, as the minimisers of SciPy take them with ``jac=True``."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any, TypeAlias, Unpack

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cardan.arrays import FloatArray, as_float64
from cardan.arrays.errors import ArgumentValueError, check_shape, nearest
from cardan.interop.differentiable import Evaluation, Options

__all__ = ["Objective"]

Cost: TypeAlias = Callable[[Mapping[str, FloatArray]], tuple[float, Mapping[str, FloatArray]]]
"""Function of the outputs that returns a number and its derivatives with respect to them."""


class Objective:
    """A cost of outputs as a function of some parameters, with its gradient.

    >>> import cardan
    >>> bends = {"bends": [0.3, 0.3], "phases": [0.5]}
    >>> f = cardan.scipy.Objective(bends, "phases", [0.2, 0.9, 1.7], "angle_error")
    >>> value, gradient = f(f.start)
    >>> float(value.round(8)), gradient.round(8)
    (0.00021912, array([0.0006508]))
    """

    def __init__(
        self,
        parameters: Mapping[str, ArrayLike],
        vary: str | Sequence[str],
        angle: ArrayLike,
        outputs: str | Sequence[str],
        cost: Cost | None = None,
        **options: Unpack[Options],
    ) -> None:
        """Prepare the function.

        Args:
            parameters: start values by name, as of ``cardan.jax.evaluate``.
            vary: names of the parameters that the function takes, flat and one after another.
            angle: drive angles in rad.
            outputs: names from ``cardan.OUTPUTS``.
            cost: returns for a mapping of outputs a number and a mapping of its derivatives with
                respect to them; by default the sum of the mean squares of all outputs.
            options: ``shafts``, ``joints``, ``speed``, ``acceleration`` and ``bearings``, as of
                ``cardan.jax.evaluate``.

        Raises:
            ValueError: unknown parameters or outputs, a name to vary without a start value.
        """
        self._fixed = {name: as_float64(name, value) for name, value in parameters.items()}
        self._evaluation = Evaluation(outputs, **options)
        self._evaluation.check({name: array.shape for name, array in self._fixed.items()})
        self._vary = (vary,) if isinstance(vary, str) else tuple(vary)
        for i, name in enumerate(self._vary):
            if name not in self._fixed:
                problem = f"is {name!r}, which has no start value; {nearest(name, self._fixed)}"
                raise ArgumentValueError("vary", problem, (i,))
        self._angle = as_float64("angle", angle)
        self._cost = cost or mean_squares

    @property
    def start(self) -> NDArray[np.float64]:
        """The start values of what varies, flat."""
        return np.concatenate([self._fixed[name].ravel() for name in self._vary])

    def parameters(self, x: ArrayLike) -> dict[str, FloatArray]:
        """Return all parameters at a point of the minimiser, by name.

        Args:
            x: values in the order of ``start``, as many as it has.
        """
        flat, sizes = as_float64("x", x), [self._fixed[name].size for name in self._vary]
        check_shape("x", flat, flat.shape == (sum(sizes),), f"it must be ({sum(sizes)},)")
        parts = zip(self._vary, np.split(flat, np.cumsum(sizes)[:-1]), strict=True)
        varied = {name: part.reshape(self._fixed[name].shape) for name, part in parts}
        return {**self._fixed, **varied}

    def __call__(self, x: ArrayLike) -> tuple[float, NDArray[np.float64]]:
        """Return the cost and its gradient, for ``scipy.optimize.minimize(f, x0, jac=True)``.

        Args:
            x: values in the order of ``start``.
        """
        given = self.parameters(x)
        value, weights = self._cost(self._evaluation.values(given, self._angle))
        found, _ = self._evaluation.pull_back(given, self._angle, weights, by_angle=False)
        return value, np.concatenate([found[name].ravel() for name in self._vary])


def mean_squares(outputs: Mapping[str, FloatArray]) -> tuple[float, dict[str, FloatArray]]:
    """Return the sum of the mean squares of all outputs, and its derivatives."""
    value: Any = sum(np.mean(array**2) for array in outputs.values())
    return value, {name: 2.0 * array / array.size for name, array in outputs.items()}

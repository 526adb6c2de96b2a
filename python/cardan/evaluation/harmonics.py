"""Harmonics: the mean and the orders of any output over a turn.

The motion of a shaft has its series in closed form. The core sums every other output over samples.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cardan import _core
from cardan.arrays import ComplexArray, FloatArray, common_shape, threads
from cardan.arrays.errors import ArgumentValueError, check_elements
from cardan.arrays.indices import checked_orders, item_indices
from cardan.evaluation.load import Load
from cardan.evaluation.outputs import OUTPUTS
from cardan.evaluation.request import PlanePlace
from cardan.evaluation.sweep import Sweep

if TYPE_CHECKING:
    from cardan.evaluation.plan import Plan

# Complex amplitudes with the orders last, mean, and bound on the error of both.
_OrderSums: TypeAlias = tuple[ComplexArray, FloatArray, FloatArray]

_EPSILON = float(np.finfo(np.float64).eps)

# Outputs have errors of some ulp, and chains amplify those of their constants.
_ROUNDING = 32.0 * _EPSILON

# Samples of a turn that show the size of an output.
_SIZED = Sweep.revolutions(1, 64)


@dataclass(frozen=True, eq=False)
class Harmonics:
    """The mean of outputs over a turn of the drive, and their amplitudes by order.

    With the complex amplitudes ``c`` an output is ``mean + Re sum c[m] exp(i m a)``, where ``a`` is
    the drive angle. Its part of order ``m`` is therefore ``amplitude cos(m a + phase)``, with the
    modulus and the argument of ``c[m]``. If the plan takes the driven angle, ``a`` is that angle.

    The amplitudes of an output are also an attribute: ``harmonics.speed_ratio`` is
    ``harmonics.amplitude["speed_ratio"]``. Angles are in rad, everything else has the unit of the
    output. All orders are those of the drive's rotation.

    Attributes:
        orders: the orders asked for, ``(m,)``.
        complex_amplitude: of each output by name, complex, ``([items,] ... [, 3], m)``: the shape
            of the output with the orders in place of the samples, and these last.
        mean: over a turn, of each output by name, ``([items,] ... [, 3])``.
        error: bound on the error of the mean and of every complex amplitude, of each output by
            name, in its unit, ``([items,] ... [, 3])``.
    """

    orders: NDArray[np.int64]
    complex_amplitude: Mapping[str, ComplexArray]
    mean: Mapping[str, FloatArray]
    error: Mapping[str, FloatArray]

    @property
    def amplitude(self) -> Mapping[str, FloatArray]:
        """Amplitude of each order, of each output by name, ``([items,] ... [, 3], m)``."""
        return {name: np.abs(c) for name, c in self.complex_amplitude.items()}

    @property
    def phase(self) -> Mapping[str, FloatArray]:
        """Phase of each order in rad, within (-pi, pi], of each output by name.

        The part of order ``m`` is largest where ``m a + phase`` is 0. An amplitude of 0 has the
        phase 0.
        """
        return {name: np.angle(c) for name, c in self.complex_amplitude.items()}

    @property
    def angle_error_deg(self) -> FloatArray:
        """Amplitudes of ``angle_error`` in degrees, if that is among the outputs."""
        return np.degrees(self.__getattr__("angle_error"))

    def __getattr__(self, name: str) -> FloatArray:
        """Return the amplitudes of one output."""
        # Copying and unpickling ask for attributes before there is anything to look in.
        if name in self.__dict__.get("complex_amplitude", ()):
            return np.abs(self.complex_amplitude[name])
        raise AttributeError(f"the harmonics hold no {name!r}")

    def __dir__(self) -> list[str]:
        """List the outputs and the attributes."""
        return [*super().__dir__(), *self.complex_amplitude]


def harmonics(plan: Plan, orders: ArrayLike) -> Harmonics:
    """Find the harmonics as ``Plan.harmonics`` does."""
    request = plan.request
    if request.reduce is not None:
        problem = f"is {request.reduce!r}; harmonics need a plan without a reduction"
        raise ArgumentValueError("reduce", problem)
    if "angle" in plan.places:
        problem = "is 'angle', which grows with every turn and has no harmonics; "
        problem += "the periodic part is 'angle_error'"
        raise ArgumentValueError("outputs", problem, ([*plan.places].index("angle"),))
    order = np.atleast_1d(checked_orders(orders))
    of_load = {} if request.load is None else request.load.shapes()
    rows = common_shape(driveline=plan.line.shape, **of_load)
    found = {}
    for name, place in plan.places.items():
        closed = name in _CLOSED and not plan.line.has_deviations
        if request.angle_of == "drive" and closed:
            found[name] = _closed(plan, place, name, rows, order)
        else:
            found[name] = _summed(plan, name, rows, order)
    return Harmonics(
        order,
        {name: amplitudes for name, (amplitudes, _, _) in found.items()},
        {name: mean for name, (_, mean, _) in found.items()},
        {name: error for name, (_, _, error) in found.items()},
    )


# Of each quantity of motion: its mean, and how often the angle error is differentiated for it.
_CLOSED = {
    "angle_error": (0.0, 0),
    "speed_ratio": (1.0, 1),
    "acceleration_ratio": (0.0, 2),
    "jerk_ratio": (0.0, 3),
}


def _closed(
    plan: Plan, place: PlanePlace, name: str, rows: tuple[int, ...], order: NDArray[np.int64]
) -> _OrderSums:
    """The series of a shaft's motion.

    With the equivalent joint's ``k`` and offset ``f`` the angle error is ``arg(1 - k exp(-2 i (a +
    f)))``, which is ``sum k**n sin(2 n (a + f)) / n`` (from Thoma 4).
    """
    line, asked = plan.line, plan.request.shafts
    mean, derivatives = _CLOSED[name]
    shafts = item_indices("shafts", -1 if asked is None else asked, line.n_joints + 1)
    n = order / 2
    factor = np.where(order % 2 == 0, 1j ** (derivatives - 1) * order**derivatives / n, 0.0)
    joints = [line.equivalent(shaft) for shaft in shafts]
    # (items, ..., m)
    k = np.array([joint.k for joint in joints])[..., np.newaxis]
    offset = np.array([joint.angle_offset for joint in joints])[..., np.newaxis]
    series = factor * k**n * np.exp(1j * order * offset)
    # The roundings of a chain are those of its single joints, even where these cancel.
    own = np.sum(np.tan(line._geometry.bends / 2.0) ** 2, axis=-1)
    slope = np.abs(factor) * n * k ** np.maximum(n - 1.0, 0.0)
    error = 8.0 * _EPSILON * own * np.max(slope, axis=-1, initial=0.0)
    whole = place.shape(rows)

    def spread(array: NDArray[Any], *last: int) -> Any:  # noqa: ANN401 - an array
        """Broadcast the array of each item to the rows."""
        each = [np.broadcast_to(own, (*rows, *last)) for own in array]
        return np.array(each, array.dtype).reshape((*whole, *last))

    return spread(series, len(order)), np.full(whole, mean), spread(error)


def _summed(plan: Plan, name: str, rows: tuple[int, ...], order: NDArray[np.int64]) -> _OrderSums:
    """The orders of one output for drivelines and loads of the shape ``rows``."""
    highest = _core.Plan.HIGHEST_ORDER
    check_elements("orders", order, order <= highest, f"; an order of {name} is at most {highest}")
    request = plan.request._replace(names=name, dtype=None)
    own = plan._again(plan.line, request)
    place = own.places[name]
    planes = (1 if place.items is None else place.items, 3 if place.vector else 1)
    mean, error, flat = own._core.orders(
        rows,
        order.tolist(),
        request.angle_of == "driven",
        request.tolerance or 0.0,
        threads.at_most(request.workers),
    )
    load = request.load
    if load is not None and load.inertias is not None and OUTPUTS[name].needs_load:
        size = _size_without_inertias(plan, name, load, rows)
        error = error.reshape(*rows, *planes) + _ROUNDING * size.reshape(*rows, planes[0], 1)

    def shaped(array: NDArray[Any], *last: int) -> Any:  # noqa: ANN401 - an array
        """Items before the rows, the components of a vector behind them."""
        whole = np.moveaxis(array.reshape(*rows, *planes, *last), len(rows), 0)
        return whole.reshape((*place.shape(rows), *last))

    return shaped(flat.view(np.complex128), len(order)), shaped(mean), shaped(error)


def _size_without_inertias(plan: Plan, name: str, load: Load, rows: tuple[int, ...]) -> FloatArray:
    """The largest magnitudes of an output under the largest torque in any shaft, without inertias.

    Where the torque of an inertia nearly cancels another one, the output has the rounding of both.
    """
    line = plan.line._of(plan.line._geometry.batched(rows)).reshape(*rows, 1)
    request = plan.request._replace(dtype=None, reduce="peak", angle_of="drive")
    of_torque = request._replace(names="torque", shafts=slice(None), load=load.at_any_angle())
    torques = plan._again(line, of_torque)(_SIZED)["torque"]
    largest = np.maximum(np.max(torques, axis=0), np.abs(load.torque))
    alone = request._replace(names=name, load=Load(drive_torque=largest[..., np.newaxis]))
    sizes = plan._again(line, alone)(_SIZED)[name]
    return sizes if sizes.ndim == len(rows) else np.moveaxis(sizes, 0, -1)

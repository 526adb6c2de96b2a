"""Orders of an output over a turn, which the core sums over samples, in the shape of the output."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from cardan import _core
from cardan.arrays import FloatArray, threads
from cardan.arrays.errors import check_elements
from cardan.evaluation.load import Load
from cardan.evaluation.outputs import OUTPUTS
from cardan.evaluation.request import Request
from cardan.evaluation.sweep import Sweep

if TYPE_CHECKING:
    from cardan.driveline import Driveline
    from cardan.evaluation.plan import Plan

ComplexArray: TypeAlias = NDArray[np.complex128]

OrderSums: TypeAlias = tuple[ComplexArray, FloatArray, FloatArray]
"""Complex amplitudes with the orders last, mean, and bound on the error of both."""

# Outputs have errors of some ulp, and chains amplify those of their constants.
_ROUNDING = 32.0 * float(np.finfo(np.float64).eps)
# Samples that show the size of an output, and rows at a time.
_TERMS, _ROWS = 64, 1 << 12


def order_sums(plan: Plan, name: str, rows: tuple[int, ...], order: NDArray[np.int64]) -> OrderSums:
    """Find the orders of one output of a plan for drivelines and loads of the shape ``rows``."""
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
    if request.load is not None and request.load.inertias is not None and OUTPUTS[name].needs_load:
        load = request.load
        error = error.reshape(*rows, *planes) + _ROUNDING * _size_without_inertias(
            plan, request, load, name, rows, planes
        )

    def shaped(array: NDArray[Any], *last: int) -> Any:  # noqa: ANN401 - an array
        """Items before the rows, the components of a vector behind them."""
        whole = np.moveaxis(array.reshape(*rows, *planes, *last), len(rows), 0)
        return whole.reshape((*place.shape(rows), *last))

    return shaped(flat.view(np.complex128), len(order)), shaped(mean), shaped(error)


def _size_without_inertias(
    plan: Plan,
    request: Request,
    load: Load,
    name: str,
    rows: tuple[int, ...],
    planes: tuple[int, int],
) -> FloatArray:
    """The largest magnitudes of an output under the largest torque in any shaft, without inertias.

    Where the torque of an inertia nearly cancels another one, the output has the rounding of both.
    The largest of a vector's components counts for all of them.
    """
    turn, count = Sweep.revolutions(1, _TERMS), math.prod(rows)
    found = np.empty((count, planes[0], 1))
    for block in _blocks(count, _ROWS):
        line, part = _of_rows(plan.line, request._replace(angle_of="drive"), rows, block)
        of_torque = part._replace(names="torque", shafts=slice(None))
        torques = plan._again(line, of_torque)(turn)["torque"]
        given = np.broadcast_to(np.abs(load.torque), rows).ravel()[block]
        largest = np.maximum(np.max(np.abs(torques), axis=(0, -1)), given)
        alone = part._replace(load=Load(drive_torque=largest[:, np.newaxis]))
        values = np.abs(plan._again(line, alone)(turn)[name]).reshape(planes[0], len(given), -1)
        found[block, :, 0] = np.max(values, axis=-1).T
    return found.reshape(*rows, planes[0], 1)


def _blocks(count: int, size: int) -> Iterator[slice]:
    """Yield slices of at most ``size`` that cover ``count``."""
    return (slice(start, min(start + size, count)) for start in range(0, count, size))


def _of_rows(
    line: Driveline, request: Request, rows: tuple[int, ...], block: slice
) -> tuple[Driveline, Request]:
    """Return drivelines and request of some of the rows, each an entry of the first of two axes."""
    index = np.broadcast_to(np.arange(line.size).reshape(line.shape), rows).ravel()[block]

    def taken(values: FloatArray, own: int) -> FloatArray:
        if values.ndim <= own:
            return values
        core = values.shape[values.ndim - own :]
        return np.broadcast_to(values, (*rows, *core)).reshape(-1, *core)[block, np.newaxis]

    load = None if request.load is None else request.load.changed(taken)
    return line.reshape(-1)[index][:, np.newaxis], request._replace(load=load)

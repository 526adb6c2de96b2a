"""Orders of an output as sums over samples of half a turn.

Half a turn tells the whole: ideal joints look the same after it, except that their pins have the
opposite sense. What depends on that sense has odd orders only, everything else even ones. Joints
with deviations repeat after a whole turn only; they have all orders and are sampled over it.

A smooth output is sampled at ``N`` equal steps. The sum then differs from the integral by the
amplitudes of the orders ``2 N - m`` and beyond, and each order is about the ``k`` of the equivalent
joint times the one two below it. The magnitudes of bending moments have kinks where a pin passes
the bend plane or its normal; Gauss's sums between these keep that rate. Whatever else is not smooth
is noticed, because every sum is compared with the one over half as many samples.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any, Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

from cardan.arrays import FloatArray
from cardan.arrays.planes import PlanePlace
from cardan.equivalent import equivalent
from cardan.errors import wrong_element
from cardan.load import Load
from cardan.outputs import OUTPUTS
from cardan.request import Request, item_indices
from cardan.result import Result
from cardan.rows import ComplexArray, blocks, chain_before, of_rows
from cardan.sweep import Sweep

OrderSums: TypeAlias = tuple[ComplexArray, FloatArray, FloatArray]
"""Complex amplitudes with the orders last, mean, and bound on the error of both."""

_Sums: TypeAlias = tuple[ComplexArray, ComplexArray, FloatArray]
"""Mean and complex amplitudes, the same of half as many samples, and the largest magnitude."""

# Outputs have errors of some ulp, and chains amplify those of their constants.
_ROUNDING = 32.0 * float(np.finfo(np.float64).eps)
# Samples at a time, to keep them in bounded memory.
_BLOCK = 1 << 20
# Samples of half a turn.
_FEWEST, _MOST, _MOST_WITH_KINKS = 16, 1 << 20, 1 << 12
_HIGHEST = _MOST >> 2
# Samples that show the size of an output.
_TERMS = 64
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(16)


class Repeatable(Protocol):
    """What sums need of a plan."""

    places: Mapping[str, PlanePlace]

    @property
    def request(self) -> Request:
        """What it was made from."""

    def _again(self, request: Request) -> Callable[[Any], Result]:
        """Return a plan of the same kind for another request."""


def order_sums(
    plan: Repeatable, name: str, rows: tuple[int, ...], order: NDArray[np.int64]
) -> OrderSums:
    """Find the orders of one output of a plan.

    Args:
        plan: evaluates the output.
        name: of the output.
        rows: shape of the drivelines and loads together.
        order: the orders.
    """
    if np.any(order > _HIGHEST):
        limit = f"; an order of {name} is at most {_HIGHEST}"
        raise wrong_element("orders", order, order > _HIGHEST, limit)
    request = replace(plan.request, names=(name,), dtype=None)
    _, items, vector = plan.places[name]
    count = math.prod(rows)
    whole = _is_as_built(request)
    # Deviations move the zeros of a magnitude and round its kinks off.
    kinked = name in _ZEROS and not whole
    steepness = np.broadcast_to(_steepness(request), rows).ravel()
    shape = (1 if items is None else items, count, *((3,) if vector else ()))
    sums = np.empty((*shape, 1 + len(order)), np.complex128)
    error = np.empty(shape)
    samples = _samples(float(np.max(steepness, initial=0.0)), order)
    for block in blocks(count, max(1, _BLOCK // (samples * shape[0] * math.prod(shape[2:])))):
        part = of_rows(request, rows, block)
        samples = _samples(float(np.max(steepness[block])), order)
        if kinked:
            joints = item_indices("joints", _all(request.joints), request.line.n_joints)
            for item, joint in enumerate(joints):
                rule = _by_panels(plan, replace(part, joints=joint), name, order)
                found = _refined(rule, samples, _MOST_WITH_KINKS, request.tolerance, vector)
                sums[item, block], error[item, block] = found
        else:
            rule = _by_equal_steps(plan, part, name, order, items is None, whole)
            sums[:, block], error[:, block] = _refined(
                rule, samples, _MOST, request.tolerance, vector
            )
        if part.load is not None and part.load.inertias is not None and OUTPUTS[name].needs_load:
            error[:, block] += _ROUNDING * _size_without_inertias(plan, part, part.load, name)
    own = () if items is None else (items,)
    sums = sums.reshape((*own, *rows, *sums.shape[2:]))
    return sums[..., 1:], sums[..., 0].real, error.reshape((*own, *rows, *error.shape[2:]))


def _refined(
    rule: Callable[[int], _Sums], samples: int, most: int, tolerance: float | None, vector: bool
) -> tuple[ComplexArray, FloatArray]:
    """Sums over enough samples, with their error."""
    before = math.inf
    while True:
        sums, halved, size = rule(samples)
        if vector:
            size = np.broadcast_to(np.max(size, axis=-1, keepdims=True), size.shape)
        rounding = max(tolerance or 0.0, _ROUNDING) * size
        apart = np.max(np.abs(sums - halved), axis=-1)
        excess = float(np.max(apart / np.where(rounding > 0.0, rounding, 1.0), initial=0.0))
        # Sums that twice as many samples hardly change any less differ by the rounding of the
        # results: joints as built that compensate each other leave that of each joint.
        if 2 * samples > most or excess <= 1.0 or excess > 0.5 * before:
            return sums, apart + rounding
        before = excess
        samples *= 2


def _by_equal_steps(
    plan: Repeatable,
    request: Request,
    name: str,
    order: NDArray[np.int64],
    alone: bool,
    whole: bool,
) -> Callable[[int], _Sums]:
    own = plan._again(request)
    every = np.array([0, *order])
    # Of a scalar, or of each component of a vector.
    changes = np.array(_changes_sign(name, request.axes))
    kept = np.logical_or(whole, np.equal.outer(changes, every % 2 == 1))

    def rule(samples: int) -> _Sums:
        count = 2 * samples if whole else samples
        array = own(Sweep.revolutions(count / (2.0 * samples), 2 * samples))[name]
        values = np.moveaxis(array, -1, -2) if changes.ndim else array
        values = values[np.newaxis] if alone else values
        # Whole numbers of steps lose no digit of a high order's angle.
        steps = np.arange(count)[:, np.newaxis] * every % (2 * samples)
        turns = _parts(np.exp(-1j * np.pi / samples * steps))
        sums, halved = (
            np.where(kept, _whole(values[..., ::each] @ turns[::each]) * each / count, 0.0)
            for each in (1, 2)
        )
        return _doubled(sums), _doubled(halved), np.max(np.abs(values), axis=-1)

    return rule


def _by_panels(
    plan: Repeatable, request: Request, name: str, order: NDArray[np.int64]
) -> Callable[[int], _Sums]:
    """Sums from one kink to the next, half a turn later; only of scalars of one joint."""
    own = plan._again(request)
    every = np.array([0, *order])
    start = _ZEROS[name](request)

    def rule(samples: int) -> _Sums:
        panels = max(2, samples // len(_NODES))
        rules = [_panels(panels), _panels(panels // 2)]
        angles = np.concatenate([at for at, _ in rules])
        values = own(start + angles)[name]
        turns = np.where(every % 2 == 0, np.exp(-1j * every * start), 0.0)
        sums, first = [], 0
        for at, weights in rules:
            matrix = _parts(np.exp(-1j * np.outer(at, every)) * weights[:, np.newaxis])
            sums.append(_whole(values[:, first : first + len(at)] @ matrix) * turns)
            first += len(at)
        return _doubled(sums[0]), _doubled(sums[1]), np.max(np.abs(values), axis=-1)

    return rule


def _panels(count: int) -> tuple[FloatArray, FloatArray]:
    """Places and weights of the mean over half a turn, by Gauss in each of equal panels."""
    width = np.pi / count
    at = (np.arange(count)[:, np.newaxis] + 0.5 * (1.0 + _NODES)) * width
    return at.ravel(), np.tile(_WEIGHTS, count) / (2.0 * count)


def _size_without_inertias(plan: Repeatable, request: Request, load: Load, name: str) -> FloatArray:
    """The largest magnitudes of an output under the largest torque in any shaft, without inertias.

    Where the torque of an inertia nearly cancels another one, the output has the rounding of both.
    """
    turn = Sweep.revolutions(1, _TERMS)
    torques = plan._again(replace(request, names=("torque",), shafts=slice(None)))(turn)["torque"]
    largest = np.maximum(np.max(np.abs(torques), axis=(0, -1)), np.abs(load.torque).reshape(-1))
    alone = replace(request, names=(name,), load=Load(drive_torque=largest[:, np.newaxis]))
    values = np.abs(plan._again(alone)(turn)[name])
    if not OUTPUTS[name].vector:
        return np.asarray(np.max(values, axis=-1))
    return np.asarray(np.max(values, axis=(-2, -1))[..., np.newaxis])


def _parts(turns: NDArray[Any]) -> FloatArray:
    """Real and imaginary parts next to each other: real samples need no complex product."""
    return np.concatenate([turns.real, turns.imag], axis=-1)


def _whole(parts: FloatArray) -> ComplexArray:
    real, imaginary = np.split(parts, 2, axis=-1)
    return np.asarray(real + 1j * imaginary)


def _doubled(sums: ComplexArray) -> ComplexArray:
    """The mean, and amplitudes: the order ``m`` of a real output is also at ``-m``."""
    sums[..., 1:] *= 2.0
    return sums


def _is_as_built(request: Request) -> bool:
    line: Any = request.line
    return bool(line.has_deviations)


def _changes_sign(name: str, axes: str) -> bool | Sequence[bool]:
    """Whether half a turn changes the sign of an output, or of each component of a vector."""
    output = OUTPUTS[name]
    if output.vector:
        # The axes y and z follow the pin.
        return (False, True, True) if axes == "shaft" else (output.of_cross,) * 3
    return output.of_cross


def _zero_driving(request: Request) -> FloatArray:
    """The angle at which the driving pin of a joint is in the bend plane, ``(rows, 1)``.

    A chain takes ``w = exp(i a)`` to ``A w + B conj(w)``, which is real there.
    """
    a, b = _before(request)
    return _given(request, np.arctan2(-(a + b).imag, (a - b).real))


def _zero_driven(request: Request) -> FloatArray:
    """The angle at which the driving pin of a joint is normal to the bend plane."""
    a, b = _before(request)
    return _given(request, np.arctan2((a + b).real, (a - b).imag))


_ZEROS: Mapping[str, Callable[[Request], FloatArray]] = {
    "bending_driving": _zero_driving,
    "bending_driven": _zero_driven,
}
"""Where the magnitudes with a kink are zero."""


def _given(request: Request, drive: FloatArray) -> FloatArray:
    """The angle that the plan takes, for a drive angle."""
    if request.angle_of == "drive":
        return drive
    line: Any = request.line
    angle: FloatArray = line.evaluate(drive, "angle").angle
    return angle


def _before(request: Request) -> tuple[ComplexArray, ComplexArray]:
    """The chain before the joint of the request."""
    line: Any = request.line
    joint = item_indices("joints", _all(request.joints), line.n_joints)[0]
    return chain_before(line, joint)


def _all(items: Any) -> Any:  # noqa: ANN401 - an index, a slice or a list
    return slice(None) if items is None else items


def _steepness(request: Request) -> FloatArray:
    """The largest ``k`` of any shaft."""
    line: Any = request.line
    if _is_as_built(request):
        # Deviations change the rate at which orders decrease only a little.
        line = line.with_deviations()
    shafts = range(1, line.n_joints + 1)
    k = np.array([equivalent(line._geometry, shaft).k for shaft in shafts])
    steepest = np.max(k, axis=0)
    if request.angle_of == "driven":
        # Steps in the hyperbolic plane, in which a chain's q is a point at distance 2 artanh k.
        steepest = (steepest + k[-1]) / (1.0 + steepest * k[-1])
    return np.asarray(steepest)


def _samples(k: float, order: NDArray[np.int64]) -> int:
    """Samples of half a turn, of which every second leaves an error below rounding."""
    highest = int(np.max(order, initial=2)) / 2.0
    decay = -math.log(k) if k > 0.0 else math.inf
    length = 40.0 / decay if decay > 0.0 else float(_MOST)
    # Products of several ratios have poles of higher order, whose amplitudes decay later.
    wanted = 2.0 * (highest + 2.0 + length * (1.0 + 0.1 * math.log1p(length)))
    fewest = max(_FEWEST, 4.0 * (highest + 1.0))
    return 1 << math.ceil(math.log2(max(fewest, min(wanted, _MOST))))

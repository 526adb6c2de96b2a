"""Effect of tolerances of joints on one order of the angle error.

To first order the complex amplitude of an order is that of the drawing plus one vector for each
deviation, in proportion to it. The vectors are the derivatives with respect to the deviations,
summed over a turn with the order's wave. Their tolerances span a convex polygon. Its corners are
combinations of tolerances with signs, and the one that is farthest from zero is the worst (derived
here).
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal, SupportsIndex

import numpy as np
from numpy.typing import ArrayLike

from cardan.arrays import ComplexArray, FloatArray, not_negative
from cardan.arrays.errors import check_choice, check_shape, require
from cardan.arrays.indices import integer, item_index
from cardan.design.quantities import farthest_signs, order_amplitude
from cardan.evaluation.sweep import Sweep
from cardan.geometry.as_built import DEVIATIONS, angles_of_joints
from cardan.tolerances.case import largest_of_corners

if TYPE_CHECKING:
    from cardan.driveline import Driveline

_FEWEST = 256


@dataclass(frozen=True, eq=False)
class OrderTolerances:
    """Effect of tolerances of joints on one order; made by ``Driveline.order_tolerances``.

    Amplitudes are those of the angle error in rad. Multiply by ``(order speed)**2`` for the
    acceleration of the shaft at a steady speed of the drive.

    Attributes:
        order: the order.
        drawing: complex amplitude of the drawing.
        contributions: complex amplitude that each tolerance adds, ``(n, 3)``: driving yoke, cross
            and driven yoke of each joint.
        worst: amplitude of a driveline as built with the worst combination of tolerances: of those
            that are reached from the one that is worst to first order by turning one deviation
            after another to its other end.
        worst_deviations: its deviations in rad, ``(n, 3)``.
        normal: whether tolerances are three standard deviations of a normal distribution.
    """

    order: int
    drawing: complex
    contributions: ComplexArray
    worst: float
    worst_deviations: FloatArray
    normal: bool

    @property
    def rms(self) -> float:
        """Root mean square in rad of the amplitude of drivelines within the tolerances."""
        return float(np.sqrt(np.abs(self.drawing) ** 2 + np.sum(self._variances)))

    @property
    def shares(self) -> FloatArray:
        """Share of each deviation in the variance, ``(n, 3)``; they sum to 1, or are all 0."""
        total = np.sum(self._variances)
        return self._variances / total if total > 0.0 else np.zeros(self._variances.shape)

    def quantile(
        self, probability: float, samples: SupportsIndex = 100_000, seed: int | None = 0
    ) -> float:
        """Return the amplitude that such a share of random drivelines does not exceed.

        Args:
            probability: the share, in (0, 1).
            samples: number of random drivelines.
            seed: of the random numbers.

        Raises:
            ValueError: a probability outside (0, 1).
        """
        require("probability", 0.0 < probability < 1.0, f"is {probability}; it must lie in (0, 1)")
        random, vectors = np.random.default_rng(seed), self.contributions.ravel()
        shape = (int(samples), len(vectors))
        if self.normal:
            drawn = random.standard_normal(shape) / 3.0
        else:
            drawn = random.uniform(-1.0, 1.0, shape)
        return float(np.quantile(np.abs(self.drawing + drawn @ vectors), probability))

    @property
    def _variances(self) -> FloatArray:
        return np.abs(self.contributions) ** 2 / (9.0 if self.normal else 3.0)


def order_tolerances(
    line: Driveline,
    driving_yoke: ArrayLike = 0.0,
    cross: ArrayLike = 0.0,
    driven_yoke: ArrayLike = 0.0,
    *,
    degrees: bool = False,
    order: SupportsIndex = 1,
    shaft: SupportsIndex = -1,
    distribution: Literal["uniform", "normal"] = "uniform",
) -> OrderTolerances:
    """Return how tolerances of the joints affect one order of the angle error.

    The worst corner of the tolerances is evaluated as built, the spread is of first order.
    ``tolerances`` has quantiles of drivelines as built, and other figures.

    Args:
        driving_yoke: tolerance of this deviation, ± each, as for ``with_deviations``: one
            number, or one per joint, like the following arguments.
        cross: of the crosses.
        driven_yoke: of the driven yokes.
        degrees: whether they are in degrees.
        order: of the drive's rotation.
        shaft: by default the last.
        distribution: as for ``tolerances``.

    Raises:
        ValueError: a batch, negative tolerances, those with which a joint cannot turn, an order
            below 1, an unknown distribution.

    >>> import cardan
    >>> shaft = cardan.Driveline.from_bends([8.0, 8.0], degrees=True)
    >>> found = shaft.order_tolerances(0.0025, driven_yoke=0.0025)
    >>> round(found.worst * (100.0 * 3.14159265) ** 2, 1)  # at 3000 rpm, in rad/s²
    97.7
    """
    n, given = line.n_joints, zip(DEVIATIONS, (driving_yoke, cross, driven_yoke), strict=True)
    each = [angles_of_joints(name, not_negative(name, x), n, degrees) for name, x in given]
    halves = np.stack([np.broadcast_to(half, (n,)) for half in each], axis=-1)
    check_shape("driveline", line, not line.shape, "it must be one driveline")
    check_choice("distribution", distribution, ("uniform", "normal"))
    number = integer("order", order, 1)
    index = item_index("shaft", shaft, line.n_joints + 1)
    count = max(_FEWEST, 32 * number)
    slopes = line.plan("angle_error", shafts=index).derivatives(
        Sweep.revolutions(1, count), by="deviations"
    )["angle_error"]["deviations"]
    # Whole numbers of steps lose no digit of a high order's angle.
    wave = np.exp(-2j * np.pi / count * (np.arange(count) * number % count))
    whole = 2.0 / count * np.tensordot(wave, slopes, axes=1) * halves
    contributions = np.asarray(whole, np.complex128)
    drawing = complex(order_amplitude(line, number, index))
    own = line.deviations

    def size(units: FloatArray) -> FloatArray:
        moved = own + halves * units.T.reshape(-1, *halves.shape)
        built = line.with_deviations(*np.moveaxis(moved, -1, 0))
        return np.abs(order_amplitude(built, number, index))

    worst, corner = largest_of_corners(size, farthest_signs(drawing, contributions.ravel()))
    deviations = own + halves * corner.reshape(halves.shape)
    return OrderTolerances(
        number, drawing, contributions, worst, deviations, distribution == "normal"
    )

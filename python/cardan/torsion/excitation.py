"""Parts of a torsional system beside springs: torques of engines and machines, and couplings."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from cardan.arrays import FloatArray, as_float64, finite, keep
from cardan.arrays.errors import ArgumentValueError, check_choice, check_shape, require

ENDS = ("input", "output")


@dataclass(frozen=True)
class TorqueHarmonic:
    """A torque on a shaft end that repeats ``order`` times in a turn of this end.

    It is ``cos * cos(order * angle) + sin * sin(order * angle)`` with the end's own angle, which is
    that of the drive at the input end of shaft 0. Gas torques of engines, blades of propellers,
    meshing teeth and pumps are such torques. They depend on an angle alone, so over a period they
    do no work.

    Attributes:
        shaft: the shaft, counted from 0.
        end: ``"input"`` or ``"output"``.
        order: positive; multiples of 1/2 for engines of four strokes.
        cos: amplitude of the cosine in N m.
        sin: amplitude of the sine in N m.

    >>> import cardan
    >>> cardan.TorqueHarmonic(0, "input", 1.5, cos=60).order
    1.5
    """

    shaft: int
    end: Literal["input", "output"]
    order: float
    cos: float = 0.0
    sin: float = 0.0

    def __post_init__(self) -> None:
        """Check the names."""
        check_choice("end", self.end, ENDS)

    @property
    def amplitude(self) -> float:
        """Amplitude in N m."""
        return math.hypot(self.cos, self.sin)


@dataclass(frozen=True, eq=False)
class Coupling:
    """Connection of the ends of a compliant shaft that is no spring of one stiffness.

    One of ``stiffness``, ``twist`` with ``torque``, and ``mean_torque`` with ``stiffness_by_mean``
    is given. The dampings of the system are added.

    Args:
        stiffness: in N m/rad.
        twist: in rad, rising, ``(points,)``: a progressive coupling. The torque is linear between
            the points and goes straight on beyond them. If the first point is 0, the other
            direction is the same.
        torque: in N m at these twists, rising, ``(points,)``.
        play: the free angle from one flank to the other in rad, in which there is no torque.
        contact_damping: whether the damping acts in proportion to the stiffness, so not within the
            play; by default it always acts.
        loss_factor: constant damping per cycle, the tangent of the loss angle: catalogues give
            ``2 pi`` times it as relative damping. Not with a stiffness that varies with the twist.
        mean_torque: in N m, rising, ``(points,)``, for a stiffness that depends on the mean torque
            as catalogues of rubber couplings give it.
        stiffness_by_mean: in N m/rad at these torques, ``(points,)``; linear between them, constant
            beyond.

    >>> import cardan
    >>> cardan.Coupling(twist=[0, 0.02, 0.04], torque=[0, 100, 400]).stiffness_at(50.0)
    5000.0
    >>> cardan.Coupling(8000, play=0.02).torque_at([0.005, 0.02]).tolist()
    [0.0, 80.0]
    """

    stiffness: float | None = None
    twist: ArrayLike | None = None
    torque: ArrayLike | None = None
    play: float = 0.0
    contact_damping: bool = False
    loss_factor: float = 0.0
    mean_torque: ArrayLike | None = None
    stiffness_by_mean: ArrayLike | None = None

    def __post_init__(self) -> None:
        """Check what the arrays are; the native module checks what they mean."""
        for one, other in (("twist", "torque"), ("mean_torque", "stiffness_by_mean")):
            x, y = getattr(self, one), getattr(self, other)
            if (x is None) != (y is None):
                missing, known = (one, other) if x is None else (other, one)
                raise ArgumentValueError(missing, f"is missing; {known} is given")
            if x is not None:
                for name, given in ((one, x), (other, y)):
                    points = finite(name, given)
                    is_curve = points.ndim == 1 and (points.size > 1 or one != "twist")
                    rule = "it must be one list of numbers, of a curve two at least"
                    check_shape(name, points, is_curve, rule)
                    keep(self, **{name: tuple(points.tolist())})
                if len(getattr(self, one)) != len(getattr(self, other)):
                    problem = f"has {len(getattr(self, other))} values; {one} has {len(x)}"
                    raise ArgumentValueError(other, problem)
        every = ("stiffness", "twist", "mean_torque")
        laws = [name for name in every if getattr(self, name) is not None]
        if len(laws) != 1:
            given = " and ".join(laws) or "nothing"
            problem = f"is given with {given}; give one of a stiffness, twist and mean_torque"
            raise ArgumentValueError("stiffness", problem)
        for name in ("stiffness", "play", "loss_factor"):
            if getattr(self, name) is not None:
                keep(self, **{name: float(finite(name, getattr(self, name)))})

    def torque_at(self, twist: ArrayLike) -> FloatArray:
        """Return the torque in N m without damping at twists in rad, of the same shape."""
        at = as_float64("twist", twist)
        if self.twist is not None:
            x, y = self._table()
            place = np.clip(np.searchsorted(x, at) - 1, 0, len(x) - 2)
            slope = np.diff(y) / np.diff(x)
            return np.asarray(y[place] + slope[place] * (at - x[place]))
        beyond = np.sign(at) * np.maximum(np.abs(at) - 0.5 * self.play, 0.0)
        return np.asarray(self.stiffness_at(0.0) * beyond)

    def stiffness_at(self, torque: float) -> float:
        """Return the stiffness in N m/rad at a mean torque in N m."""
        if self.stiffness is not None:
            return self.stiffness
        if self.mean_torque is not None:
            return float(self.by_mean(torque))
        x, y = self._table()
        place = int(np.clip(np.searchsorted(y, torque) - 1, 0, len(x) - 2))
        return float(np.diff(y)[place] / np.diff(x)[place])

    def by_mean(self, torque: ArrayLike) -> FloatArray:
        """Return the stiffnesses in N m/rad at mean torques in N m, of a law by the mean torque."""
        x, y = np.array(self.mean_torque), np.array(self.stiffness_by_mean)
        given = as_float64("torque", torque)
        return np.asarray(np.interp(given if x[0] < 0.0 else np.abs(given), x, y))

    def scaled(self, factor: float) -> Coupling:
        """Return the coupling with so many times the stiffness and the torques at every twist."""
        names = ("stiffness", "torque", "stiffness_by_mean")
        given = {name: getattr(self, name) for name in names if getattr(self, name) is not None}
        return replace(self, **{name: np.multiply(factor, x) for name, x in given.items()})

    def _table(self) -> tuple[FloatArray, FloatArray]:
        x, y = np.array(self.twist), np.array(self.torque)
        if x[0] == 0.0 and y[0] == 0.0:
            x, y = np.concatenate([-x[:0:-1], x]), np.concatenate([-y[:0:-1], y])
        return x, y

    def _fields(self, shaft: int) -> tuple[Any, ...]:
        """Return the fields for the native module."""

        def pairs(x: Any, y: Any) -> list[list[float]]:  # noqa: ANN401 - of checked lists
            return [] if x is None else [list(pair) for pair in zip(x, y, strict=True)]

        return (
            shaft,
            self.stiffness,
            pairs(self.twist, self.torque),
            self.play,
            bool(self.contact_damping),
            self.loss_factor,
            pairs(self.mean_torque, self.stiffness_by_mean),
        )


def firing_harmonics(
    harmonics: Sequence[tuple[float, float, float]],
    firing_order: Sequence[int],
    *,
    strokes: Literal[2, 4] = 4,
    shaft: int = 0,
) -> tuple[TorqueHarmonic, ...]:
    """Return the torques of an engine with evenly spaced firings, from those of one cylinder.

    All cylinders act on one crank that is stiff. Cylinder ``j`` of the firing order fires at
    ``2 pi strokes/2 * j/cylinders``, so of the amplitudes ``cos - i sin`` of one cylinder only
    those orders remain that are multiples of ``2 cylinders/strokes``, times the number of
    cylinders. An uneven engine is the sum of harmonics that are turned by hand.

    Args:
        harmonics: order, cosine and sine in N m of one cylinder that fires at the crank angle 0.
        firing_order: the numbers of the cylinders in the order in which they fire.
        strokes: 2 or 4.
        shaft: whose input end is the crank.

    Raises:
        ValueError: a firing order that names a cylinder twice.

    >>> import cardan
    >>> one = [(0.5, 90, 60), (1.0, 70, 120), (1.5, 50, 90), (2.0, 20, 60), (3.0, 10, 20)]
    >>> [(own.order, own.cos) for own in cardan.firing_harmonics(one, [1, 3, 2])]
    [(1.5, 150.0), (3.0, 30.0)]
    """
    require("strokes", strokes in (2, 4), f"is {strokes!r}; it must be 2 or 4")
    count = len(firing_order)
    if not count or sorted(firing_order) != list(range(1, count + 1)):
        problem = f"is {list(firing_order)!r}; it must name each cylinder, from 1 on, once"
        raise ArgumentValueError("firing_order", problem)
    base = 2.0 * count / strokes
    return tuple(
        TorqueHarmonic(shaft, "input", order, float(count * cos), float(count * sin))
        for order, cos, sin in harmonics
        if abs(order / base - round(order / base)) < 1e-9
    )

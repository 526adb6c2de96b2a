"""Shafts whose axes do not meet: how far pins and shafts slide over the turn.

The loop from the driving shaft over both pins to the driven shaft closes by the slides, as long as
these are free; no angle changes (``docs/theory/offsets.md``).
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from cardan.arrays import FloatArray, as_float64, common_shape, finite, per_joint
from cardan.arrays.errors import ArgumentValueError, nearest
from cardan.arrays.indices import checked_orders
from cardan.wear.pin_loads import cross_axes, dot

if TYPE_CHECKING:
    from cardan.driveline import Driveline

SlideName = Literal["driving_pin", "driven_pin", "shaft"]
NAMES: tuple[SlideName, ...] = get_args(SlideName)

# Samples of a turn: a chain of steep joints needs more than a joint.
_FEWEST, _MOST = 256, 1 << 16
_SETTLED = 1e-12


@dataclass(frozen=True, eq=False)
class Slides:
    """How far pins and shafts slide because of offsets; see ``Driveline.slides``.

    Lengths have the unit of the offsets. Slides of joint ``j`` are those with its driving shaft
    held in place.
    """

    _line: Driveline = field(repr=False)
    _offsets: tuple[FloatArray, ...] = field(repr=False)

    def at(self, angle: ArrayLike, of: SlideName = "shaft") -> FloatArray:
        """Return how far a shaft or a pin slides at an angle, ``(n, ...)``.

        Args:
            angle: drive angle in rad; broadcasts against batch and offsets.
            of: ``"driving_pin"`` for the cross along the driving pin, ``"driven_pin"`` for the
                driven yoke along the driven pin, ``"shaft"`` for the driven shaft along its axis.

        Raises:
            ValueError: an unknown slide, shapes that do not broadcast.
        """
        return np.asarray(self._at(angle)[_number("of", of)])

    def amplitudes(self, orders: ArrayLike = (1, 2, 3, 4), of: SlideName = "shaft") -> FloatArray:
        """Return the amplitudes of a slide by multiples of the drive's rotation, ``(n, ..., m)``.

        Args:
            orders: positive integers up to 100, ``(m,)`` or one.
            of: as for ``at``, like the errors.
        """
        wanted, number = checked_orders(orders, 100), _number("of", of)
        count, before = _FEWEST, np.zeros(())
        while True:
            spectrum = np.fft.rfft(self._turn(count)[number], axis=-1)
            found = np.asarray(np.abs(spectrum[..., wanted]) * (2.0 / count))
            settled = _SETTLED * np.max(np.abs(found), initial=0.0)
            if count >= _MOST or np.all(np.abs(found - before) <= settled):
                return found
            count, before = 2 * count, found

    def travel(self, of: SlideName = "shaft") -> FloatArray:
        """Return the largest less the smallest slide of 720 angles of a turn, ``(n, ...)``.

        Args:
            of: as for ``at``, like the errors.
        """
        return np.asarray(np.ptp(self._turn(720)[_number("of", of)], axis=-1))

    def _turn(self, count: int) -> FloatArray:
        """The slides at equal steps of a turn, the samples on the last axis."""
        line = self._line.reshape(*self._line.shape, 1)
        offsets = tuple(offset[..., np.newaxis, :] for offset in self._offsets)
        steps = np.arange(count) * (2.0 * math.pi / count)
        return Slides(line, offsets)._at(steps)

    def check_free(self, blocked: str | Iterable[str], unit: str = "") -> None:
        """Refuse slides that are not free where the offsets need them.

        Args:
            blocked: names of slides, as of ``Driveline.slides``, like the errors.
            unit: what stands behind lengths in an error.
        """
        largest = max(float(np.max(np.abs(offset), initial=0.0)) for offset in self._offsets)
        for name in [blocked] if isinstance(blocked, str) else blocked:
            _number("blocked", name)
            travel = self.travel(name)  # type: ignore[arg-type]
            moves = travel > _SETTLED * largest
            if np.any(moves):
                place = tuple(int(i) for i in np.argwhere(moves)[0])
                by = f"{travel[place]:.4g}{unit}"
                yielding = "where it cannot slide, shafts and bearings yield or the joint binds, "
                yielding += "which depends on their stiffness and not on the geometry"
                slide = f"the offsets of joint {place[0]} make it slide by {by} in a turn"
                problem = f"has {name!r}, but {slide}; {yielding}"
                raise ArgumentValueError("blocked", problem)

    def _at(self, angle: ArrayLike) -> FloatArray:
        """The slides along driving pin, driven pin and driven shaft, ``(3, n, ...)``."""
        angles = as_float64("angle", angle)
        shapes = {f"offset {i}": one.shape[:-1] for i, one in enumerate(self._offsets)}
        common_shape(driveline=self._line.shape, angle=angles.shape, **shapes)
        joints = [self._of_joint(joint, angles) for joint in range(self._line.n_joints)]
        return np.stack(joints, axis=1)

    def _of_joint(self, joint: int, angles: FloatArray) -> FloatArray:
        """The solution of the loop; driven pin and driven shaft are perpendicular."""
        axes = cross_axes(self._line, joint, angles)
        driving, cross, driven, apart = (offset[..., joint, np.newaxis] for offset in self._offsets)
        closing = (
            apart * axes.normal
            - driving * np.cross(axes.driving, axes.driving_pin)
            - cross * axes.across
            - driven * np.cross(axes.driven_pin, axes.driven)
        )
        shaft = dot(closing, axes.across) / dot(axes.driven, axes.across)
        rest = closing - shaft[..., np.newaxis] * axes.driven
        return np.stack([dot(rest, axes.driving_pin), dot(rest, axes.driven_pin), shaft])


def slides(
    line: Driveline,
    *,
    driving_pin: ArrayLike = 0.0,
    cross: ArrayLike = 0.0,
    driven_pin: ArrayLike = 0.0,
    shafts: ArrayLike = 0.0,
    blocked: str | Iterable[str] = (),
) -> Slides:
    """Return how far pins and shafts slide where the axes of a joint do not meet.

    Offsets change no angle if the cross can slide along both pins and the driven shaft along
    its axis. A driving pin that misses its shaft by ``g`` moves the driven shaft along its axis
    with order 1 of the amplitude ``2 g tan(bend/2)``, shafts that miss each other by ``d`` with
    order 2 of ``2 d tan(bend/2)**2/sin(bend)`` (derived here).

    Each offset is one number, or one per joint ``(..., n)``, in any unit of length.

    Args:
        driving_pin: from the axis of the driving shaft to that of its pin, along ``u x p``.
        cross: from the driving pin to the driven pin, along ``p x q``.
        driven_pin: from the driven pin to the axis of its shaft, along ``q x v``.
        shafts: from the axis of the driving shaft to that of the driven one, along the
            bend-plane normal.
        blocked: names of slides that are not free: ``"driving_pin"``, ``"driven_pin"``,
            ``"shaft"``.

    Raises:
        ValueError: an offset that is not finite, not one value per joint, a blocked slide that
            the offsets would move, shapes that do not broadcast.

    >>> import cardan
    >>> joint = cardan.Driveline.from_bends([10], degrees=True)
    >>> joint.slides(driving_pin=0.5).amplitudes([1, 2]).round(4)
    array([[0.0875, 0.    ]])
    """
    n = line.n_joints
    given = {"driving_pin": driving_pin, "cross": cross, "driven_pin": driven_pin, "shafts": shafts}
    offsets = {name: per_joint(name, finite(name, value), n) for name, value in given.items()}
    shapes = {name: offset.shape[:-1] for name, offset in offsets.items()}
    common_shape(driveline=line.shape, **shapes)
    found = Slides(line, tuple(offsets.values()))
    found.check_free(blocked)
    return found


def _number(argument: str, name: str) -> int:
    if name not in NAMES:
        raise ArgumentValueError(argument, f"is {name!r}; {nearest(name, NAMES)}")
    return NAMES.index(name)

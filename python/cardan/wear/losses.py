"""Friction in the joints: the power that the pins take, at an angle and over a turn.

Everything is exact to first order in the friction: the loss of one joint is not subtracted from the
torque of the next (``docs/theory/wear.md``).
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from cardan.arrays import FloatArray, not_negative, per_joint, positive, scalar_or_array, together
from cardan.arrays.errors import require
from cardan.evaluation.load import Load, require_load
from cardan.wear.pin_loads import PinLoads, cross_axes, dot, means_over_turn, pins_at

if TYPE_CHECKING:
    from cardan.driveline import Driveline


@dataclass(frozen=True, eq=False)
class Losses:
    """Friction losses in each joint; see ``Driveline.losses``."""

    _mean: FloatArray = field(repr=False)
    _drive: FloatArray = field(repr=False)
    _line: Driveline = field(repr=False)
    _load: Load = field(repr=False)
    # The moment of friction over that of the joint, and the one that is always there, ``(..., n)``.
    _friction: tuple[FloatArray, FloatArray] = field(repr=False)

    @property
    def fraction(self) -> FloatArray:
        """Share of the mean drive power that each joint loses, ``(n, ...)``; needs no speed.

        Raises:
            ValueError: the load has no torque over the mean of a turn.
        """
        problem = "has no torque over the mean of a turn; no power goes through the driveline"
        require("load", np.all(np.abs(self._drive) > 0.0), problem)
        return self._mean / np.abs(self._drive)

    @property
    def efficiency(self) -> Any:  # noqa: ANN401 - a number or an array
        """1 less the sum of ``fraction``, with its error, in the shape of batch and load."""
        return scalar_or_array(1.0 - np.sum(self.fraction, axis=0))

    @property
    def power(self) -> FloatArray:
        """Heat of each joint in W, the mean over a turn, ``(n, ...)``; needs a speed."""
        speed = np.abs(self._load.speed)
        require("load", np.all(speed > 0.0), "has no speed; the power lost needs one")
        return self._mean * speed

    def torque(self, angle: ArrayLike) -> FloatArray:
        """Return the torque that friction adds at the drive in N m, of each joint ``(n, ...)``.

        It is the power lost over the speed of the drive (derived here).

        Args:
            angle: drive angle in rad; broadcasts against batch and load.

        Raises:
            ValueError: shapes that do not broadcast.
        """
        return np.stack([self._lost(joint, angle) for joint in range(self._line.n_joints)])

    def efficiency_at(self, angle: ArrayLike) -> Any:  # noqa: ANN401 - a number or an array
        """Return the efficiency at a drive angle: 1 less ``torque(angle)`` over the drive torque.

        It is below that over a turn where the pins turn fastest, and without meaning where
        inertias reverse the torque of the drive.

        Args:
            angle: as for ``torque``, like the errors.
        """
        drive = self._line.evaluate(angle, "torque", shafts=0, load=self._load).torque
        with np.errstate(divide="ignore", invalid="ignore"):
            share = np.sum(self.torque(angle), axis=0) / np.abs(drive)
        return scalar_or_array(np.asarray(1.0 - share))

    def moment(self, angle: ArrayLike) -> FloatArray:
        """Return the moment that friction adds to the moment of each joint, ``(n, ..., 3)`` in N m.

        The friction in the yokes is a moment ``f_1`` about the driving pin ``p`` and ``f_2`` about
        the driven pin ``q``, against the swing of the cross. The moment of the joint grows by ``f_1
        p + f_2 q + c (p x q)``, with ``c`` such that the torque stays the same in the shaft towards
        the end at which the load gives it (derived here). What it has across a shaft is friction's
        share in the bending of that shaft, what it has along the other shaft its share in the
        torque. The friction of other joints is left out. The vectors act on the driven shaft of
        each joint and are at rest in space.

        Args:
            angle: as for ``torque``, like the errors.
        """
        return np.stack([self._added(joint, angle) for joint in range(self._line.n_joints)])

    def _rubbed(self, joint: int, angle: ArrayLike) -> tuple[PinLoads, FloatArray]:
        """The pins of a joint, and the moment of friction in each of its yokes."""
        pins = pins_at(self._line, self._load, joint, angle)
        share, constant = (of_joints[..., joint] for of_joints in self._friction)
        return pins, np.asarray(share * pins.moment + constant)

    def _lost(self, joint: int, angle: ArrayLike) -> FloatArray:
        pins, size = self._rubbed(joint, angle)
        return np.asarray(size * (np.abs(pins.rate_driving) + np.abs(pins.rate_driven)))

    def _added(self, joint: int, angle: ArrayLike) -> FloatArray:
        axes, (_, size) = cross_axes(self._line, joint, angle), self._rubbed(joint, angle)
        # Against the rates of the cross in the driving and of the driven yoke on the cross: the
        # difference of both shafts' rotations has only parts along the pins.
        about_p = -size * np.sign(dot(axes.driven, axes.driving_pin))
        about_q = size * np.sign(dot(axes.driving, axes.driven_pin))
        rubbing = (
            about_p[..., np.newaxis] * axes.driving_pin + about_q[..., np.newaxis] * axes.driven_pin
        )
        kept = axes.driving if self._load.end == "drive" else axes.driven
        along = dot(rubbing, kept) / dot(axes.across, kept)
        return np.asarray(rubbing - along[..., np.newaxis] * axes.across)


def losses(
    line: Driveline,
    load: Load,
    *,
    friction: ArrayLike,
    pin_radius: ArrayLike,
    arm: ArrayLike,
    seal_torque: ArrayLike = 0.0,
) -> Losses:
    """Return the power that friction takes in each joint.

    For one joint and a constant torque the share lost is ``mu (p/R) (2/pi) (artanh sin b + tan
    b)`` with the friction ``mu``, the radius ``p`` of the pins and their arm ``R`` (derived
    here). A chain and a load with inertias need means over the turn. All is exact to first
    order in the friction.

    Args:
        load: constant over a turn; broadcasts against the batch. Without a torque over the
            mean of a turn there is heat, but no share and no efficiency.
        friction: coefficient of friction in the bearings of the pins: one number, or one per
            joint ``(..., n)``, like the following arguments.
        pin_radius: radius in m at which the friction acts.
        arm: distance of the middle of a pin's bearing from the centre of the joint in m.
        seal_torque: moment in N m that seals or a preload add about the pins of each yoke,
            whatever the load.

    Raises:
        ValueError: negative values, a radius or an arm of 0, not one value per joint, shapes
            that do not broadcast.

    >>> import cardan
    >>> joint = cardan.Driveline.from_bends([10], degrees=True)
    >>> load = cardan.Load(drive_torque=400.0, speed_rpm=1500.0)
    >>> loss = joint.losses(load, friction=0.05, pin_radius=0.008, arm=0.032)
    >>> round(float(loss.efficiency), 5), float(loss.power[0].round(1))
    (0.9972, 175.9)
    """
    require_load(load)
    n = line.n_joints
    given = {"friction": friction, "pin_radius": pin_radius, "arm": arm, "seal_torque": seal_torque}
    of_joints = {}
    for name, value in given.items():
        checked = not_negative if name in ("friction", "seal_torque") else positive
        of_joints[name] = (per_joint(name, checked(name, value), n), 1)
    rows, (mu, radius, reach, constant) = together(of_joints, driveline=line.shape, **load.shapes())
    drive, *of_pins = means_over_turn(line, load, rows, "friction")
    share = mu * radius / reach
    of_load, always = np.moveaxis(share, -1, 0), np.moveaxis(constant, -1, 0)
    lost = of_load * of_pins[::2] + always * of_pins[1::2]
    return Losses(lost, drive, line, load, (share, constant))

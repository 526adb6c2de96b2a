"""Joints as built: yokes that lean and crosses that are not square.

With unit vectors ``u`` and ``v`` along driving and driven shaft, ``p`` along the driving pin and
``q`` along the driven one, the deviations of a joint are

* of the driving yoke: ``p . u = sin e1``, so that it leans towards the driven shaft;
* of the cross: ``p . q = sin e2``;
* of the driven yoke: ``q . v = sin e3``.

The joint is then a general spherical four-bar linkage. Its motion repeats after a whole turn, and
the yokes bring odd orders.
"""

from __future__ import annotations

from typing import Any, Literal, Self, SupportsIndex

import numpy as np
from numpy.typing import ArrayLike

from cardan import _core, order_tolerances
from cardan.arrays import (
    FloatArray,
    as_float64,
    common_shape,
    not_negative,
    per_joint,
    positive,
    scalar_or_array,
)
from cardan.bearings import Mounted
from cardan.errors import wrong_element
from cardan.geometry import Geometry
from cardan.load import Load
from cardan.order_tolerances import OrderTolerances
from cardan.request import item_index
from cardan.sweep import Sweep

_NAMES = ("driving_yoke", "cross", "driven_yoke")


class AsBuilt(Mounted):
    """Drivelines whose joints may deviate from their drawing."""

    __slots__ = ()

    def with_deviations(
        self,
        driving_yoke: ArrayLike = 0.0,
        cross: ArrayLike = 0.0,
        driven_yoke: ArrayLike = 0.0,
        *,
        degrees: bool = False,
    ) -> Self:
        """Return the driveline with joints as built, in place of any other deviations.

        ``evaluate``, ``plan`` and ``harmonics`` take it like any other driveline and compute it
        joint by joint, with the forces of its joints and bearings. What needs one equivalent joint,
        such as ``equivalent`` and ``optimal_phases``, refuses it; without arguments,
        ``with_deviations()`` returns the ideal driveline for these. A joint turns if ``abs(C) < R``
        at every angle (the four-bar linkage of ``docs/theory/as-built.md``), for which
        ``abs(driving_yoke) + abs(cross) + abs(driven_yoke) < 90° - bend`` is enough.

        Args:
            driving_yoke: angle by which the driving pin leans from the normal of the driving shaft
                towards the driven one: one number, or one per joint ``(..., n)``, like the
                following arguments. A pin bearing that sits ``0.1 mm`` off at an arm of ``40 mm``
                leans by ``0.1 / 40`` rad.
            cross: angle by which the two pins of the cross are closer than 90°.
            driven_yoke: angle by which the driven pin leans from the normal of the driven shaft
                towards its driven end.
            degrees: whether the three are in degrees.

        Raises:
            TypeError: values that are not real numbers.
            ValueError: values that are not finite or not within 90°, a joint that cannot turn,
                shapes that do not fit.

        >>> import cardan
        >>> joint = cardan.Driveline.from_bends([10.0], degrees=True)
        >>> leaning = joint.with_deviations(driving_yoke=0.001)
        >>> leaning.harmonics([1, 2], outputs="angle_error").angle_error.round(6)
        array([0.000175, 0.007654])
        """
        given = (driving_yoke, cross, driven_yoke)
        own = _with_deviations(self._geometry, dict(zip(_NAMES, given, strict=True)), degrees)
        return self._of(own)

    def with_play(self, radial: ArrayLike, arm: ArrayLike) -> Self:
        """Return the driveline with its joints on either flank of the play in their pin bearings.

        Torque one way moves the pins of each yoke to one side by the angle ``radial / arm``. Both
        yokes of a joint together make this a deviation of the cross of twice that angle, one way or
        the other (derived here).

        Args:
            radial: radial play of a pin in its bearing, from the middle to either side: one number,
                or one per joint ``(..., n)``, like the following argument.
            arm: distance of the middle of a pin's bearing from the centre of the joint, in the same
                unit.

        Returns:
            a batch with a new first axis of 2: the flank under a positive torque, on which driven
            shafts lag, and the flank of coasting.

        Raises:
            TypeError: values that are not real numbers.
            ValueError: a negative play, an arm that is not positive, a joint that cannot turn,
                shapes that do not fit.

        >>> import cardan
        >>> joint = cardan.Driveline.from_bends([10.0], degrees=True).with_play(0.02e-3, 0.03)
        >>> joint.deviations[:, 0, 1].round(6)
        array([ 0.001333, -0.001333])
        """
        n = self.n_joints
        play = per_joint("radial", not_negative("radial", radial), n)
        play = play / per_joint("arm", positive("arm", arm), n)
        shape = common_shape(driveline=self.shape, play=play.shape[:-1])
        own = np.broadcast_to(self.deviations, (*shape, n, 3))
        skew = np.broadcast_to(2.0 * play, (*shape, n))
        driving, cross, driven = np.moveaxis(own, -1, 0)
        return self.with_deviations(driving, np.stack([cross + skew, cross - skew]), driven)

    def lash(
        self, angle: ArrayLike | Sweep, radial: ArrayLike, arm: ArrayLike, shaft: int = -1
    ) -> Any:  # noqa: ANN401 - a scalar or an array
        """Return the angle by which a shaft is loose while the drive is held.

        For one ideal joint it is ``2 asin(sin(d)/sqrt(sin**2 a + cos**2 b cos**2 a))`` with twice
        the angle ``radial / arm`` of the play for ``d`` (derived here): largest, ``1/cos b``
        times the least, where the driving pin is in the bend plane.

        Args:
            angle: drive angle in rad, any shape, or a ``Sweep``; broadcasts against the batch.
            radial: as for ``with_play``, like the following argument.
            arm: distance of the middle of a pin's bearing from the centre of the joint.
            shaft: index of the shaft, by default the last.

        Returns:
            rad, in the shape of batch and angles.

        Raises:
            IndexError: a shaft that does not exist.
            TypeError: values that are not real numbers.
            ValueError: as for ``with_play``.
        """
        line: Any = self.with_play(radial, arm)
        index = item_index("shaft", shaft, self.n_joints + 1)
        samples = angle.shape if isinstance(angle, Sweep) else np.shape(angle)
        more = max(0, len(samples) - len(line.shape) + 1)
        lines = line.reshape(2, *(1,) * more, *line.shape[1:])
        driven, coasting = lines.evaluate(angle, "angle_error", shafts=index).angle_error
        leads = _core.mean_leads(lines._lines, index).reshape(lines.shape)
        return scalar_or_array(coasting - driven + (leads[1] - leads[0]))

    def wind_up(self, angle: ArrayLike | Sweep, load: Load, stiffness: ArrayLike) -> Any:  # noqa: ANN401 - a scalar or an array
        """Return the angle by which the last shaft lags because torque twists the crosses.

        A cross is a spring against the moment that it transmits. Under a torque ``D`` in its
        driving shaft a joint of stiffness ``c`` winds its driven shaft up by ``D/(c cos b)``, the
        same at every angle (derived here). Later joints pass it on with their ratios.

        Args:
            angle: drive angle in rad, any shape, or a ``Sweep``; broadcasts against the batch.
            load: as for ``evaluate``.
            stiffness: moment about the normal of the cross per angle between its pins, in N m/rad:
                one number, or one per joint ``(..., n)``.

        Returns:
            rad, in the shape of batch, load and angles; to first order in ``1/c``.

        Raises:
            TypeError: values that are not real numbers.
            ValueError: a stiffness that is not positive, shapes that do not fit.

        >>> import cardan
        >>> joint = cardan.Driveline.from_bends([20.0], degrees=True)
        >>> joint.wind_up([0.0, 1.0], cardan.Load(drive_torque=500.0), 1e5).round(6)
        array([0.005321, 0.005321])
        """
        n = self.n_joints
        springs = per_joint("stiffness", positive("stiffness", stiffness), n)
        line: Any = self
        at = line.evaluate(angle, ("torque", "speed_ratio"), load=load, shafts=slice(None))
        lag: Any = 0.0
        cosines = np.cos(self.bends)
        for joint in range(n):
            # The torsion of the driving shaft at the joint, from the power behind it.
            torsion = at.torque[joint + 1] * at.speed_ratio[joint + 1] / at.speed_ratio[joint]
            own = torsion / (springs[..., joint] * cosines[..., joint])
            lag = lag + own * at.speed_ratio[n] / at.speed_ratio[joint + 1]
        return scalar_or_array(np.asarray(lag))

    def order_tolerances(
        self,
        driving_yoke: ArrayLike = 0.0,
        cross: ArrayLike = 0.0,
        driven_yoke: ArrayLike = 0.0,
        *,
        degrees: bool = False,
        order: SupportsIndex = 1,
        shaft: SupportsIndex = -1,
        distribution: Literal["uniform", "normal"] = "uniform",
    ) -> OrderTolerances:
        """Return what tolerances of the joints make of one order of the angle error.

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
            distribution: ``"uniform"`` within ± the tolerance, or ``"normal"`` with the tolerance
                as three standard deviations.

        Raises:
            IndexError: a shaft that does not exist.
            TypeError: values that are not real numbers.
            ValueError: a batch, negative tolerances, those with which a joint cannot turn, an order
                below 1, an unknown distribution.

        >>> import cardan
        >>> shaft = cardan.Driveline.from_bends([8.0, 8.0], degrees=True)
        >>> found = shaft.order_tolerances(0.0025, driven_yoke=0.0025)
        >>> round(found.worst * (100.0 * 3.14159265) ** 2, 1)  # at 3000 rpm, in rad/s²
        97.7
        """
        given = (driving_yoke, cross, driven_yoke)
        n = self.n_joints
        halves = [
            _of_joints(name, not_negative(name, value), n, degrees)
            for name, value in zip(_NAMES, given, strict=True)
        ]
        full = np.stack([np.broadcast_to(half, (n,)) for half in halves], axis=-1)
        return order_tolerances.order_tolerances(self, full, order, shaft, distribution)

    @property
    def deviations(self) -> FloatArray:
        """Deviations of driving yoke, cross and driven yoke in rad, ``(..., n, 3)``."""
        own = self._geometry
        return own.deviations if own.is_as_built else np.zeros((*own.bends.shape, 3))

    @property
    def deviations_deg(self) -> FloatArray:
        """The same in degrees."""
        return np.degrees(self.deviations)

    @property
    def has_deviations(self) -> bool:
        """Whether the joints deviate, so that the driveline is computed joint by joint."""
        return self._geometry.is_as_built


def _with_deviations(own: Geometry, given: dict[str, ArrayLike], degrees: bool) -> Geometry:
    n = own.n_joints
    arrays = {name: _of_joints(name, value, n, degrees) for name, value in given.items()}
    shape = common_shape(
        driveline=own.shape, **{name: array.shape[:-1] for name, array in arrays.items()}
    )
    ideal = own._replace(deviations=np.empty((*own.shape, 0, 3))).batched(shape)
    if not any(np.any(array != 0.0) for array in arrays.values()):
        return ideal
    full = np.stack([np.broadcast_to(array, (*shape, n)) for array in arrays.values()], axis=-1)
    _core.check_deviations(n, shape, ideal.bends.reshape(-1), full.reshape(-1))
    return ideal._replace(deviations=full)


def _of_joints(name: str, value: ArrayLike, n: int, degrees: bool) -> FloatArray:
    """Angles: one for all joints, or one for each on the last axis."""
    array = as_float64(name, value)
    right_angle, unit = (90.0, " deg") if degrees else (0.5 * np.pi, " rad")
    wrong = ~(np.abs(array) < right_angle)
    if wrong.any():
        rule = f"{unit}; a deviation must lie within 90 deg"
        raise wrong_element(name, array, wrong, rule)
    array = per_joint(name, array, n)
    return np.radians(array) if degrees else array

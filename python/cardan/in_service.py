"""Drivelines in service: friction, life, and the slides that offsets cause."""

from __future__ import annotations

from collections.abc import Iterable

from numpy.typing import ArrayLike

from cardan import life, losses, slides
from cardan.installed import Installed
from cardan.life import Life
from cardan.load import Load
from cardan.losses import Losses
from cardan.slides import Slides


class InService(Installed):
    """Drivelines that wear; ``Driveline`` adds how they are made and what is evaluated."""

    __slots__ = ()

    def losses(
        self,
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

        Returns:
            share of the drive power lost in each joint, efficiency, heat in W, and the torque that
            friction adds at the drive at any angle.

        Raises:
            TypeError: values that are not real numbers.
            ValueError: negative values, a radius or an arm of 0, not one value per joint, shapes
                that do not broadcast.

        >>> import cardan
        >>> joint = cardan.Driveline.from_bends([10], degrees=True)
        >>> load = cardan.Load(drive_torque=400.0, speed_rpm=1500.0)
        >>> loss = joint.losses(load, friction=0.05, pin_radius=0.008, arm=0.032)
        >>> round(float(loss.efficiency), 5), float(loss.power[0].round(1))
        (0.9972, 175.9)
        """
        return losses.losses(self, load, friction, pin_radius, arm, seal_torque)

    def life(
        self,
        load: Load,
        *,
        rating: ArrayLike,
        speed: ArrayLike | None = None,
        shares: ArrayLike | None = None,
        angle: ArrayLike | None = None,
    ) -> Life:
        """Return how long the joints last, by the catalogue's law and by the load of their pins.

        Args:
            load: constant over a turn, unless ``angle`` is given; broadcasts against the batch. Of
                a duty cycle the last axis are the steps.
            rating: torque in N m that gives 5000 h at a bend of 3 degrees and 100 rpm: one number,
                or one per joint ``(..., n)``.
            speed: of the drive in rad/s; by default that of the load.
            shares: of each step of the duty cycle in the time, ``(..., steps)``, with sum 1. The
                damages add up (Miner's rule).
            angle: drive angles of a run in rad, ``(samples,)`` in their order, with a load that
                varies from sample to sample: a recorded torque, or that of torsional vibration.
                The means are sums over these samples, so there must be some hundred in a turn.

        Returns:
            hours that 90 % of the joints reach, of each joint; which joint fails first, and where
            the pins swing too little.

        Raises:
            TypeError: values that are not real numbers.
            ValueError: a rating, speed or share that is not positive, a load without a speed,
                shares that do not fit the steps or do not add up to 1, angles that do not fit the
                load or do not change, shapes that do not broadcast.

        >>> import cardan
        >>> bends = [[5.0], [8.0], [3.0]]
        >>> load = cardan.Load(output_torque=[400, 700, 250], speed_rpm=[1500, 1000, 2500])
        >>> line = cardan.Driveline.from_bends(bends, degrees=True)
        >>> found = line.life(load, rating=1000.0, shares=[0.5, 0.3, 0.2])
        >>> found.catalogue.round(2), found.hours.round(2)
        (array([1625.98]), array([1603.01]))
        """
        return life.life(self, load, rating, speed, shares, angle)

    def slides(
        self,
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

        Returns:
            the slides at any angle, their travel over a turn and their amplitudes by order.

        Raises:
            TypeError: values that are not real numbers.
            ValueError: an offset that is not finite, not one value per joint, a blocked slide that
                the offsets would move, shapes that do not broadcast.

        >>> import cardan
        >>> joint = cardan.Driveline.from_bends([10], degrees=True)
        >>> joint.slides(driving_pin=0.5).amplitudes([1, 2]).round(4)
        array([[0.0875, 0.    ]])
        """
        return slides.slides(self, driving_pin, cross, driven_pin, shafts, blocked)

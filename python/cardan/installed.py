"""Drivelines as they are built: lengths, the inertia of the drive, the tolerances of a workshop."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any, Literal, SupportsIndex

from numpy.typing import ArrayLike

from cardan import free_running, slip, tolerances
from cardan.deviations import AsBuilt
from cardan.free_running import FreeRunning
from cardan.load import Load
from cardan.request import Items
from cardan.slip import Lengths, SplineForce
from cardan.tolerances import Tolerances


class Installed(AsBuilt):
    """Drivelines in a machine; ``Driveline`` adds how they are made and what is evaluated."""

    __slots__ = ()

    def lengths(self) -> Lengths:
        """Return the lengths of the shafts, in the unit of the points.

        Over a batch of points, such as the positions of an axle, the travel of a shaft is what its
        spline must take up.

        Returns:
            length of every shaft of every driveline; shortest, longest and travel over the batch.

        Raises:
            ValueError: a driveline without lengths: one that was neither made from points nor given
                lengths by ``with_bearings``.

        >>> import cardan
        >>> heights = [[[0, 0, 0], [0.3, 0, 0], [1.5, y, 0], [1.8, y, 0]] for y in (-0.1, 0.0, 0.1)]
        >>> cardan.Driveline.from_points(heights).lengths().travel.round(5)
        array([0.     , 0.00416, 0.     ])
        """
        return slip.lengths(self._geometry)

    def spline_force(
        self,
        shaft: SupportsIndex,
        torque: ArrayLike,
        friction: ArrayLike,
        radius: ArrayLike,
    ) -> SplineForce:
        """Return the axial force of a loaded spline while it slides: ``F = mu |T|/r``.

        Over a turn, the largest torque gives the largest force; a spline of which the length
        changes slowly slides whenever the force suffices. The bends turn part of it across the
        shafts next to it.

        Args:
            shaft: index of the shaft with the spline.
            torque: torque of that shaft in N m; broadcasts against the batch.
            friction: coefficient of friction in the spline.
            radius: pitch radius of the spline in m.

        Returns:
            the force along the shaft, and on the shafts next to it as vectors and as parts along
            and across those shafts.

        Raises:
            IndexError: a shaft that does not exist.
            TypeError: values that are not real numbers.
            ValueError: a negative friction, a radius that is not positive, shapes that do not
                broadcast.
        """
        return slip.spline_force(self, shaft, torque, friction, radius)

    def free_running(self, inertias: ArrayLike) -> FreeRunning:
        """Return how the speed of the drive varies where no torque holds it.

        The kinetic energy of all shafts stays the same, so the speed of the drive goes as
        ``1/sqrt(I_0 + sum I_i r_i**2)`` with the speed ratios ``r_i``. A motor or a load changes
        this only as far as its torque varies within a turn.

        Args:
            inertias: moment of inertia of each shaft about its axis in kg m², with what turns with
                it, ``(..., n + 1)``; broadcasts against the batch. Shaft 0 is the drive.

        Returns:
            speed of the drive over its mean: at any angle, least, largest and the variation.

        Raises:
            TypeError: inertias that are not real numbers.
            ValueError: not one inertia per shaft, a negative one, all of them 0, shapes that do
                not broadcast.

        >>> import cardan
        >>> rig = cardan.Driveline.from_bends([8.5], degrees=True)
        >>> round(float(rig.free_running([10.0, 1.0]).variation), 5)
        0.00201
        """
        self._geometry.check_ideal("free running is computed")
        line: Any = self
        return free_running.free_running(line, inertias)

    def tolerances(
        self,
        *,
        bends: ArrayLike | None = None,
        twists: ArrayLike | None = None,
        phases: ArrayLike | None = None,
        points: ArrayLike | None = None,
        driving_yoke: ArrayLike | None = None,
        cross: ArrayLike | None = None,
        driven_yoke: ArrayLike | None = None,
        degrees: bool = False,
        distribution: Literal["uniform", "normal"] = "uniform",
        teeth: ArrayLike | None = None,
        of: str | Iterable[str] = "equivalent_bend",
        limit: ArrayLike | Mapping[str, ArrayLike] | None = None,
        speed: ArrayLike | None = None,
        load: Load | None = None,
        states: SupportsIndex | None = None,
        reduce: Literal["peak", "rms", "max", "mean"] = "peak",
        shaft: SupportsIndex = -1,
        shafts: Items = None,
        joints: Items = None,
        samples: SupportsIndex = 100_000,
        seed: int | None = None,
        workers: int | None = None,
    ) -> Tolerances:
        """Return what errors of manufacture and assembly make of the driveline.

        Near constant velocity the equivalent bend grows with the square root of an error: 5° of
        phase spoil a shaft with two bends of 10° to 4.2°. The result is lazy: random drivelines
        are drawn when a quantile or the passing share is asked for.

        Args:
            bends: tolerance of the bends, ± each, one number or ``(..., n)``.
            twists: of the twists, one number or ``(..., n - 1)``.
            phases: of the phases, one number or ``(..., n - 1)``.
            points: of every coordinate of the points, in their unit: one number, ``(..., n + 2,
                1)`` or ``(..., n + 2, 3)``. Bends and twists follow from the points; only phases
                can have tolerances besides.
            driving_yoke: of the deviations of the joints, as ``with_deviations`` has them, one
                number or ``(..., n)`` like the following two. ``0.1 mm`` at an arm of ``40 mm`` are
                ``0.1 / 40`` rad. Deviations that the driveline has are the middle.
            cross: of the crosses.
            driven_yoke: of the driven yokes.
            degrees: whether tolerances and limits that are angles are in degrees.
            distribution: ``"uniform"`` within ± the tolerance, or ``"normal"`` with the tolerance
                as three standard deviations.
            teeth: of the spline that carries the output-side yoke of each intermediate shaft, one
                number or ``(..., n - 1)``. The yoke can only be set by teeth, so that its phase is
                off by up to half a tooth, uniformly, in addition to its tolerance.
            of: one name or several: ``"equivalent_bend"``, ``"non_uniformity"``,
                ``"max_angle_error"``, ``"torsional_excitation"``, ``"inertia_excitation_driving"``,
                ``"inertia_excitation_coasting"``, ``"inertia_excitation"`` for the larger of both,
                an order of the motion, such as ``"angle_error_order_1"`` or, at ``speed``,
                ``"acceleration_order_1"``, an output reduced over a turn of 360 samples, such as
                ``"support_moment_1_peak"``, or an output from ``cardan.OUTPUTS`` alone, with
                ``reduce``, ``shafts`` and ``joints``.
            limit: what must not be exceeded, in the unit of the figure; with several figures a
                mapping by name. Default: the 3° of the catalogues for the first three figures.
            speed: drive speed in rad/s, for the excitations; broadcasts to the batch.
            load: for the outputs that need one; its values broadcast to the batch.
            states: the axis of the batch along which one driveline takes several positions, such
                as ride heights, with the same deviations in all of them. Each figure is then the
                largest of the states, and the results have the shape without this axis.
            reduce: of the outputs that are named without it; of a vector, the length of what it
                makes of the components.
            shaft: the shaft of the figures, by default the last.
            shafts: for the outputs per shaft, by default the last; the largest value counts.
            joints: for the outputs per joint, by default all; the largest value counts.
            samples: number of random drivelines.
            seed: of the random numbers; default: a new one, which is the ``seed`` of the result.
            workers: largest number of threads, as for ``evaluate``; results do not depend on it.

        Returns:
            worst case, guaranteed bound, quantiles, passing share and shares of the parameters.
            Angles are in radians; names with ``_deg`` are in degrees.

        Raises:
            IndexError: a shaft, joint or bearing, or an axis of states, that does not exist.
            TypeError: values that are not real numbers.
            ValueError: no tolerances, a negative one, one that permits a bend of 90°, points of a
                driveline that was not made from points, an unknown figure, shapes that do not fit,
                states with different tolerances; deviations with which a joint could not turn, and
                with them the first six figures and forces, which are those of ideal joints.

        >>> import cardan
        >>> shaft = cardan.Driveline.from_bends([10, 10], degrees=True)
        >>> shaft.tolerances(phases=5.0, degrees=True).worst_deg.round(4)
        np.float64(4.184)

        What 0.1 mm at 40 mm on every yoke does to order 1 at 3000 rpm:

        >>> yokes = dict(driving_yoke=0.0025, driven_yoke=0.0025)
        >>> speed = 3000 * 3.14159265 / 30
        >>> found = shaft.tolerances(**yokes, of="acceleration_order_1", speed=speed)
        >>> found.worst.round(1)
        np.float64(122.4)
        """
        line: Any = self
        return tolerances.tolerances(
            line,
            type(self)._of,
            bends=bends,
            twists=twists,
            phases=phases,
            points=points,
            driving_yoke=driving_yoke,
            cross=cross,
            driven_yoke=driven_yoke,
            degrees=degrees,
            distribution=distribution,
            teeth=teeth,
            of=of,
            limit=limit,
            speed=speed,
            load=load,
            states=states,
            reduce=reduce,
            shaft=shaft,
            shafts=shafts,
            joints=joints,
            samples=samples,
            seed=seed,
            workers=workers,
        )

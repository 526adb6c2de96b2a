"""Drivelines: joints and shafts in space, one or a batch."""

from __future__ import annotations

import functools
from collections.abc import Iterable, Mapping
from typing import Any, Literal, Self

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from cardan import geometry
from cardan.arrays import FloatArray, as_float64, deferring
from cardan.check import Check, check
from cardan.degrees import PlanInDegrees
from cardan.double_joint import Centred
from cardan.driven_angle import planned
from cardan.equivalent import EquivalentJoint, Transmission, equivalent
from cardan.harmonics import Harmonics
from cardan.limits import Limits
from cardan.load import Load
from cardan.plan import Plan
from cardan.reduced import PlanOfReductions
from cardan.reference import approximations
from cardan.remembered import remembered
from cardan.request import AngleOf, Axes, Items, Reduction, is_index, item_index
from cardan.result import Result
from cardan.steering import Steering, steering
from cardan.sweep import Sweep


class Driveline(Centred):
    """Shafts joined by universal joints, or a batch of such drivelines of equal length.

    Make one with ``from_bends``, ``from_points``, ``from_directions``, ``from_slopes``,
    ``from_projected_bends`` or ``from_double_joint``; leading dimensions are the batch. Of dask
    arrays all but the last make a ``cardan.interop.lazy.LazyDriveline``, to be evaluated in pieces
    and anywhere. Drivelines are immutable: their arrays are read-only, and ``with_phases`` makes a
    new one.

    Geometry: ``u_i`` is the unit vector along shaft ``i`` in the direction of power flow, the bend
    of joint ``j`` the angle between ``u_j`` and ``u_{j+1}``, its bend-plane normal ``m_j = unit(u_j
    x u_{j+1})``. The twist of an intermediate shaft is the angle about it from one normal to the
    next, its phase the angle from its input-side to its output-side pin; phase 0 means both yokes
    in one plane. The drive angle counts from the driving pin of joint 0 lying in the plane of
    shafts 0 and 1. All rotations are right-handed about ``u_i``:
    clockwise, looking from the drive towards the output.
    """

    __slots__ = ()

    def __init__(self) -> None:
        """Refuse: a driveline is made from bends, points, directions or slopes."""
        raise TypeError("use Driveline.from_bends, from_points, from_directions or from_slopes")

    @classmethod
    @deferring(ends=0, bends=1, twists=1, phases=1)
    def from_bends(
        cls,
        bends: ArrayLike,
        twists: ArrayLike = 0.0,
        phases: ArrayLike = 0.0,
        *,
        degrees: bool = False,
    ) -> Self:
        """Make drivelines from the angles at their joints.

        Shaft 0 points along +x and the first bend-plane normal along +z, so shaft 1 points along
        ``(cos b, sin b, 0)``.

        Args:
            bends: bend of each joint, ``(..., n)``; a single number is one joint.
            twists: twist of each intermediate shaft, ``(..., n - 1)`` or one for all.
            phases: phase of each intermediate shaft, ``(..., n - 1)`` or one for all.
            degrees: whether the three are in degrees.

        Raises:
            TypeError: values that are not real numbers.
            ValueError: a bend outside [0, 90°), a value that is not finite, shapes that do not fit.
        """
        return cls._of(geometry.from_bends(bends, twists, phases, degrees))

    @classmethod
    @deferring(ends=1, directions=2, phases=1)
    def from_directions(
        cls, directions: ArrayLike, phases: ArrayLike = 0.0, *, degrees: bool = False
    ) -> Self:
        """Make drivelines from a vector along each shaft.

        A straight joint takes the bend-plane normal of the previous joint, a straight first joint
        that of the next bent one.

        Args:
            directions: ``(..., n + 1, 3)``, of any length, in the direction of power flow, in any
                right-handed axes.
            phases: phase of each intermediate shaft, ``(..., n - 1)`` or one for all.
            degrees: whether the phases are in degrees.

        Raises:
            TypeError: values that are not real numbers.
            ValueError: a direction that is zero or not finite, a bend of 90° or more, shapes that
                do not fit.
        """
        return cls._of(geometry.from_directions(directions, phases, degrees))

    @classmethod
    @deferring(ends=2, points=2, phases=1)
    def from_points(
        cls, points: ArrayLike, phases: ArrayLike = 0.0, *, degrees: bool = False
    ) -> Self:
        """Make drivelines from their ends and joint centres.

        Args:
            points: ``(..., n + 2, 3)``: the driving end, the joint centres, the driven end, in any
                unit of length and any right-handed axes. In left-handed ones the driveline would be
                mirrored, and all yoke settings would have the opposite sense.
            phases: phase of each intermediate shaft, ``(..., n - 1)`` or one for all.
            degrees: whether the phases are in degrees.

        Raises:
            TypeError: values that are not real numbers.
            ValueError: two equal successive points, a point that is not finite, a bend of 90° or
                more, shapes that do not fit.
        """
        return cls._of(geometry.from_points(points, phases, degrees))

    @classmethod
    @deferring(ends=1, vertical=1, horizontal=1, phases=1)
    def from_slopes(
        cls,
        vertical: ArrayLike,
        horizontal: ArrayLike,
        phases: ArrayLike = 0.0,
        *,
        degrees: bool = False,
    ) -> Self:
        """Make drivelines from the slope of each shaft in side view and in top view.

        A shaft points along ``(1, tan vertical, tan horizontal)`` in right-handed axes: x from the
        drive to the output, y up, z to the right, looking from the drive towards the output
        (catalogue, double joint, 6.3, exactly). If x points rearwards, z is the vehicle's left.

        Args:
            vertical: slope of each shaft in side view, ``(..., n + 1)``, positive upwards.
            horizontal: slope of each shaft in top view, ``(..., n + 1)``, positive towards +z.
            phases: phase of each intermediate shaft, ``(..., n - 1)`` or one for all.
            degrees: whether all three are in degrees.

        Raises:
            TypeError: values that are not real numbers.
            ValueError: a slope outside (-90°, 90°), a bend of 90° or more, shapes that do not fit.
        """
        return cls._of(geometry.from_slopes(vertical, horizontal, phases, degrees))

    @classmethod
    @deferring(ends=0, vertical=1, horizontal=1, phases=1)
    def from_projected_bends(
        cls,
        vertical: ArrayLike,
        horizontal: ArrayLike,
        phases: ArrayLike = 0.0,
        *,
        degrees: bool = False,
        reference: Literal["common", "input", "output"] = "common",
    ) -> Self:
        """Make shafts with two joints from their bends as projected in side view and top view.

        This is the catalogues' form (double joint, 6.3, Bilder 17 to 19). The bends of a drawing
        add up along the shaft, so it matters from which shaft the drawing measures them: by the
        catalogue's figure from the common one, for which ``tan(bend)**2 = tan(vertical)**2 +
        tan(horizontal)**2`` holds exactly.

        Args:
            vertical: bend of both joints in side view, ``(..., 2)``, positive upwards.
            horizontal: bend of both joints in top view, ``(..., 2)``, positive to the right,
                looking from the drive towards the output: towards +z as in ``from_slopes``.
            phases: phase of the common shaft, ``(..., 1)`` or one for all.
            degrees: whether all three are in degrees.
            reference: the shaft from which they are measured: ``"common"``, ``"input"`` or
                ``"output"``.

        Raises:
            TypeError: values that are not real numbers.
            ValueError: not two joints, an unknown reference, and as for ``from_slopes``.
        """
        return cls._of(
            geometry.from_projected_bends(vertical, horizontal, phases, degrees, reference)
        )

    def with_phases(self, phases: ArrayLike, *, degrees: bool = False) -> Driveline:
        """Return the driveline with its yokes set anew.

        Args:
            phases: phase of each intermediate shaft, ``(..., n - 1)`` or one for all; broadcasts
                against the batch.
            degrees: whether they are in degrees.

        Raises:
            TypeError: values that are not real numbers.
            ValueError: a phase that is not finite, shapes that do not fit.
        """
        return Driveline._of(self._geometry.with_phases(phases, degrees))

    def equivalent(self, shaft: int = -1) -> EquivalentJoint:
        """Return the one joint that moves a shaft exactly as the whole chain does.

        With ``w = exp(i a)`` a joint makes ``w - tan(b/2)**2 conj(w)`` of ``w`` (from Thoma 4) and
        a shaft turns it, so a chain makes ``A w + B conj(w)``; ``k = |B/A|``.

        Args:
            shaft: index of the shaft, by default the last.

        Returns:
            its bend and the closed forms of its motion, each in the shape of the batch.

        Raises:
            IndexError: a shaft that does not exist.
            TypeError: a shaft that is not an integer.
        """
        return equivalent(self._geometry, shaft)

    def harmonics(
        self,
        orders: ArrayLike = (2, 4, 6, 8),
        shaft: Items = -1,
        *,
        outputs: str | Iterable[str] = ("angle_error", "speed_ratio"),
        joints: Items = None,
        load: Load | None = None,
        axes: Axes = "space",
    ) -> Harmonics:
        """Return the mean of outputs over a turn, and their amplitudes and phases by order.

        At order ``2 n`` the amplitudes are ``k**n / n`` of the angle error and ``2 k**n`` of the
        speed ratio, with the ``k`` of ``equivalent``: the Fourier series of Thoma's (4). With
        deviations there are odd orders as well, and everything is summed over a turn.

        Args:
            orders: positive integers, ``(m,)`` or one; odd orders of the motion of ideal joints
                have amplitude 0. By default the first four even orders.
            shaft: shaft for the outputs per shaft, by default the last; also a slice or a list.
            outputs: names from ``cardan.OUTPUTS``, except ``angle``.
            joints: joints for the outputs per joint; default: all.
            load: for the outputs that need one; constant over the turn.
            axes: of vectors, as for ``evaluate``.

        Returns:
            mean, amplitudes and phases, with the orders on the last axis. ``Plan.harmonics`` has
            the details.

        Raises:
            IndexError: a shaft or joint that does not exist.
            TypeError: orders that are not integers.
            ValueError: an order below 1, an unknown output, the output ``angle``, a load that is
                missing or does not fit.
        """
        if is_index(shaft):
            shaft = item_index("shaft", shaft, self.n_joints + 1)  # type: ignore[arg-type]
        return planned(self, outputs, shaft, joints, load, axes=axes).harmonics(orders)

    def transmission(self, shaft: int = -1) -> Transmission:
        """Return how a shaft follows the drive: motion at one angle, derivatives by ``q``.

        Args:
            shaft: index of the shaft, by default the last.

        Returns:
            ``q``, ``motion(angle)`` and ``gradient(angle)``, each in the shape of the batch, and
            the derivatives ``dq(by)`` and ``d_abs2(by)`` by the driveline's parameters.

        Raises:
            IndexError: a shaft that does not exist.
            TypeError: a shaft that is not an integer.
        """
        return Transmission(self, shaft)

    def steering(self, centre: ArrayLike = 0.0, *, degrees: bool = False) -> Steering:
        """Return what the driveline does as a steering column about straight ahead.

        Args:
            centre: angle of shaft 0 straight ahead, as drive angles count; broadcasts against the
                batch.
            degrees: whether it is in degrees.

        Returns:
            ratio straight ahead and its slope, how far straight ahead is from symmetry of left and
            right, and how to turn the driving yoke of joint 0 to reach it.

        Raises:
            TypeError: angles that are not real numbers.
            ValueError: shapes that do not broadcast.
        """
        angle = np.radians(centre) if degrees else as_float64("centre", centre)
        return steering(self, angle)

    def catalogue_bend(self, fork_signs: ArrayLike) -> FloatArray:
        """Return the catalogues' equivalent bend ``sqrt|sum ± bend**2|``, for comparison.

        It is the first term of the exact ``ln sec`` rule for yokes that are aligned or crossed. For
        two joints up to 30° its error is at most 1.02°; for three joints it can fail completely.

        Args:
            fork_signs: +1 or -1 per joint, ``(..., n)``: joints whose yokes have the same
                position relative to their bend planes have the same sign. The two joints of an
                ordinary compensated shaft therefore have opposite signs.

        Returns:
            the bend in rad, broadcast from batch and signs (catalogue, double joint, 6.5).

        Raises:
            TypeError: signs that are not real numbers.
            ValueError: a sign other than +1 and -1, shapes that do not fit.
        """
        return np.asarray(approximations.catalogue_bend(self.bends, fork_signs))[()]

    def reversed(self) -> Driveline:
        """Return the driveline driven from its other end; reversing inverts its motion.

        Bends, twists and phases keep their values and change their order; directions and
        bend-plane normals change their sign as well.

        Its shafts point the other way, so that angles count the other way round, and from another
        yoke. If the last shaft is at ``f`` when the drive is at ``a``, then the last shaft of the
        reversed driveline is at ``c - a`` when its drive is at ``c - f``. For a single joint ``c``
        is a quarter turn, in general ``angle(-q*r)/2``, where ``q`` and ``r`` are those of
        ``transmission()`` of this driveline and of the reversed one.
        """
        return Driveline._of(self._geometry.reversed())

    def check(self, speed: ArrayLike | None = None, limits: str | Limits | None = None) -> Check:
        """Compare the driveline with limits: those of the catalogues and, if you wish, of practice.

        The equivalent bend should not exceed 3° (catalogue, double joint, 6.4); the non-uniformity
        follows from it. That is the only limit unless ``limits`` has others. Torsional excitation
        is the exact peak acceleration of the last shaft, inertia excitation the second-order
        amplitude of the accelerations of all intermediate shafts together; at a speed they are
        among the findings, without a verdict if they have no limit.

        Args:
            speed: drive speed in rad/s; broadcasts against the batch.
            limits: ``"truck"`` or ``"industrial"``, or a ``cardan.Limits`` with figures of your
                own.

        Returns:
            findings with values, in the shape of batch and speed, limits and verdicts; ``print``
                shows them as text.

        Raises:
            TypeError: a speed that is not a real number, limits of another type.
            ValueError: shapes that do not broadcast, an unknown preset.
        """
        return check(self, speed, limits)

    def evaluate(
        self,
        angle: ArrayLike | Sweep,
        outputs: str | Iterable[str] = ("angle", "speed_ratio"),
        *,
        shafts: Items = None,
        joints: Items = None,
        load: Load | None = None,
        reduce: Reduction | list[Reduction] | tuple[Reduction, ...] | None = None,
        out: Mapping[str, NDArray[Any]] | None = None,
        dtype: DTypeLike | None = None,
        tolerance: float | None = None,
        workers: int | None = None,
        degrees: bool = False,
        axes: Axes = "space",
        angle_of: AngleOf = "drive",
    ) -> Result:
        """Evaluate outputs over drive angles.

        Only what the outputs need is computed. The result of one output has the shape
        ``([items,] *broadcast(line.shape, angle.shape) [, 3])``. The axis of shafts or joints comes
        first and is dropped for a single index. The components of a vector come last.

        Args:
            angle: drive angle in rad, any shape, or a ``Sweep``; broadcasts against the batch. NaN
                and infinite angles give NaN for that sample only. A dask array gives a result of
                dask arrays, with one task of one thread per chunk. An xarray DataArray gives an
                ``xarray.Dataset`` with the same coordinates, and a pandas Series gives a DataFrame
                with the same index.
            outputs: names from ``cardan.OUTPUTS``.
            shafts: shafts for the outputs per shaft: an index, a slice or a list; default: the last
                shaft.
            joints: joints for the outputs per joint; default: all.
            load: the load, for the outputs that need one.
            reduce: ``"min"``, ``"max"``, ``"mean"``, ``"rms"`` or ``"peak"`` over the last axis of
                the samples, which is dropped; no sample is stored. The peak is the largest
                magnitude; for a vector it is the largest length, without an axis of components. The
                other reductions treat the components of a vector separately. NaN among the samples
                gives NaN. A list of reductions gives each array an axis with one entry per
                reduction, after the axis of shafts or joints.
            out: arrays to fill, by output name, of the right shape and dtype. They become the
                arrays of the result. One of them may be the array of angles itself. Existing arrays
                save the operating system the work of providing new memory, which beyond some 10⁶
                angles can take as long as the evaluation. Vectors need no copy if their components
                are stored plane by plane, as in ``numpy.moveaxis(numpy.empty((3, n)), 0, -1)``.
                Ctrl-C stops an evaluation within a fraction of a second and leaves the arrays
                partly filled. While a call fills an array, calls on other threads cannot use it.
            dtype: ``float64`` (default) or ``float32``, the dtype of the results. ``float32`` also
                uses single precision after an exact reduction of the angles, unless ``tolerance``
                says otherwise.
            tolerance: permitted error, relative to each output's largest magnitude over a turn; the
                cheapest arithmetic that keeps it is chosen. 0 asks for results within 1 ulp (2 for
                moments and torques), 1e-6 and more for single precision; the default is the fast
                double, some ulp (the documentation's page Accuracy has the table). The steeper a
                chain, the more careful the arithmetic that is chosen. Where joints compensate each
                other, a tolerance above 0 is relative to the largest magnitude behind one of them
                alone. The results are those of the doubles in ``bends``, ``twists`` and ``phases``;
                vectors are laid out from the first of ``directions`` and of ``normals``. With 0,
                loads lose digits only where their terms cancel to less than 1e-13 of themselves, or
                where the cosines of all bends multiply to less than 1e-13.
            workers: largest number of threads, ``-1`` for all cores; default: all cores for calls
                that are large enough. The environment variable ``RAYON_NUM_THREADS`` limits the
                number; a forked process uses one thread. The results do not depend on it.
            degrees: whether the drive angle is in degrees. Outputs that are angles are then in
                degrees as well; all others do not change. Both conversions round. A ``Sweep``
                must have been made with ``degrees=True`` or by ``Sweep.revolutions``.
            axes: axes of vectors, at rest (``"space"``) or turning with the shaft on which the
                vector acts (``"shaft"``): x along the shaft, y along its input-side pin (shaft 0:
                its output-side pin), z their cross product. A ``moment`` and a ``joint_force`` act
                on the joint's driven shaft; the moment is ``(torque, 0, ± bending_driven)``.
            angle_of: the shaft whose angle ``angle`` is: that of the drive (``"drive"``), or the
                output ``angle`` of the last shaft (``"driven"``), as an encoder at the output
                measures it. The drive angles are then found by the inverse chain, within 1 ulp, and
                are the ``drive_angle`` of the result. They are stored, also with ``reduce``.

        Raises:
            IndexError: a shaft or joint that does not exist.
            MemoryError: results or intermediate arrays that do not fit in memory.
            RuntimeError: an ``out`` that another thread is filling.
            TypeError: angles that are not plain real numbers (masked or with a unit), indices that
                are not integers.
            ValueError: an unknown output, reduction or dtype, a load that is missing or does not
                fit, shapes that do not broadcast, an ``out`` of the wrong shape or type.
        """
        plan: Plan | PlanOfReductions
        if isinstance(reduce, (list, tuple)):
            of = functools.partial(
                planned,
                self,
                outputs,
                shafts,
                joints,
                load,
                dtype=dtype,
                tolerance=tolerance,
                workers=workers,
                axes=axes,
                angle_of=angle_of,
            )
            plan = PlanOfReductions(reduce, of)
        else:
            options = (load, reduce, dtype, tolerance, workers, axes, angle_of)
            plan = remembered(self, outputs, shafts, joints, *options)
        if degrees:
            return PlanInDegrees(plan, angle_of == "driven")(angle, out)
        return plan(angle, out)

    def plan(
        self,
        outputs: str | Iterable[str] = ("angle", "speed_ratio"),
        *,
        shafts: Items = None,
        joints: Items = None,
        load: Load | None = None,
        reduce: Reduction | None = None,
        dtype: DTypeLike | None = None,
        tolerance: float | None = None,
        workers: int | None = None,
        axes: Axes = "space",
        angle_of: AngleOf = "drive",
    ) -> Plan:
        """Prepare an evaluation for any number of calls ``plan(angle, out=...)``.

        The plan decides once which steps the outputs need; ``print(plan.explain())`` shows them.

        Args:
            outputs: names from ``cardan.OUTPUTS``.
            shafts: as for ``evaluate``, like the following arguments.
            joints: for the outputs per joint.
            load: for the outputs that need one.
            reduce: of the last axis of the samples.
            dtype: of the results.
            tolerance: permitted error.
            workers: largest number of threads.
            axes: of vectors.
            angle_of: the shaft whose angle is given.

        Returns:
            the plan; calling it gives the result of ``evaluate``.

        Raises:
            IndexError: a shaft or joint that does not exist.
            TypeError: outputs that are not names, indices that are not integers, a
                tolerance that is not a number.
            ValueError: an unknown output, reduction or dtype, a load that is missing or has not
                one inertia per shaft, a tolerance or number of threads out of range.
        """
        options = (load, reduce, dtype, tolerance, workers, axes, angle_of)
        return planned(self, outputs, shafts, joints, *options)

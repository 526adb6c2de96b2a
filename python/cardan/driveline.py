"""Drivelines: joints and shafts in space, one or a batch."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, Literal, Self

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from cardan import _core, approximations, threads
from cardan.arrays import FloatArray, at_place, common_shape, real, scalar_or_array
from cardan.check import Check, check
from cardan.equivalent import EquivalentJoint, Harmonics
from cardan.lazy import lazily
from cardan.load import Load
from cardan.plan import Items, Plan, Reduction, item_index
from cardan.result import Result
from cardan.sweep import Sweep


class Driveline:
    """Shafts joined by universal joints, or a batch of such drivelines of equal length.

    Make one with ``from_bends``, ``from_points``, ``from_directions``, ``from_slopes`` or
    ``from_projected_bends``; leading dimensions are the batch. Of dask arrays these make a
    ``cardan.lazy.LazyDriveline``, to be evaluated in pieces and anywhere. Drivelines are immutable:
    their arrays are read-only, and ``with_phases`` makes a new one.

    Geometry: ``u_i`` is the unit vector along shaft ``i`` in the direction of power flow, the bend
    of joint ``j`` the angle between ``u_j`` and ``u_{j+1}``, its bend-plane normal ``m_j = unit(u_j
    x u_{j+1})``. The twist of an intermediate shaft is the angle about it from one normal to the
    next, its phase the angle from its input-side to its output-side pin; phase 0 means both yokes
    in one plane. The drive angle counts from the driving pin of joint 0 lying in the plane of
    shafts 0 and 1. All rotations are right-handed about ``u_i``.
    """

    __slots__ = (
        "_bends",
        "_directions",
        "_lines",
        "_n_joints",
        "_normals",
        "_phases",
        "_shape",
        "_twists",
    )
    _bends: FloatArray
    _twists: FloatArray
    _phases: FloatArray
    _directions: FloatArray
    _normals: FloatArray
    _shape: tuple[int, ...]
    _n_joints: int
    _lines: _core.Lines

    def __init__(self) -> None:
        """Refuse: a driveline is made from bends, points, directions or slopes."""
        raise TypeError("use Driveline.from_bends, from_points, from_directions or from_slopes")

    @classmethod
    @lazily(ends=0, bends=1, twists=1, phases=1)
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
        bend_array = np.atleast_1d(real("bends", bends))
        n = bend_array.shape[-1]
        if degrees:
            # Here and not in radians, so that the message shows what was given.
            wrong = ~((bend_array >= 0.0) & (bend_array < 90.0))
            if wrong.any():
                place = at_place("bends", bend_array, wrong)
                raise ValueError(f"{place} deg; a bend must lie in [0, 90) deg")
            bend_array = np.radians(bend_array)
        twist_array = _per_shaft("twists", twists, n, degrees)
        phase_array = _per_shaft("phases", phases, n, degrees)
        shape = common_shape(
            bends=bend_array.shape[:-1],
            twists=twist_array.shape[:-1],
            phases=phase_array.shape[:-1],
        )
        flat = [
            _flat(array, (*shape, array.shape[-1]))
            for array in (bend_array, twist_array, phase_array)
        ]
        return cls._laid_out(n, shape, _core.from_bends(n, list(shape), *flat), flat[2])

    @classmethod
    @lazily(ends=1, directions=2, phases=1)
    def from_directions(
        cls, directions: ArrayLike, phases: ArrayLike = 0.0, *, degrees: bool = False
    ) -> Self:
        """Make drivelines from a vector along each shaft.

        A straight joint takes the bend-plane normal of the previous joint, a straight first joint
        that of the next bent one.

        Args:
            directions: ``(..., n + 1, 3)``, of any length, in the direction of power flow.
            phases: phase of each intermediate shaft, ``(..., n - 1)`` or one for all.
            degrees: whether the phases are in degrees.

        Raises:
            TypeError: values that are not real numbers.
            ValueError: a direction that is zero or not finite, a bend of 90° or more, shapes that
                do not fit.
        """
        array = _vectors("directions", directions, 2)
        n = array.shape[-2] - 1
        return cls._along(_core.from_directions, array, n, _per_shaft("phases", phases, n, degrees))

    @classmethod
    @lazily(ends=2, points=2, phases=1)
    def from_points(
        cls, points: ArrayLike, phases: ArrayLike = 0.0, *, degrees: bool = False
    ) -> Self:
        """Make drivelines from their ends and joint centres.

        Args:
            points: ``(..., n + 2, 3)``: the driving end, the joint centres, the driven end, in any
                unit of length.
            phases: phase of each intermediate shaft, ``(..., n - 1)`` or one for all.
            degrees: whether the phases are in degrees.

        Raises:
            TypeError: values that are not real numbers.
            ValueError: two equal successive points, a point that is not finite, a bend of 90° or
                more, shapes that do not fit.
        """
        array = _vectors("points", points, 3)
        n = array.shape[-2] - 2
        return cls._along(_core.from_points, array, n, _per_shaft("phases", phases, n, degrees))

    @classmethod
    @lazily(ends=1, vertical=1, horizontal=1, phases=1)
    def from_slopes(
        cls,
        vertical: ArrayLike,
        horizontal: ArrayLike,
        phases: ArrayLike = 0.0,
        *,
        degrees: bool = False,
    ) -> Self:
        """Make drivelines from the slope of each shaft in side view and in top view.

        A shaft points along ``(1, tan vertical, tan horizontal)``: x is the travel, y up, z to the
        right seen along the travel (catalogue, double joint, 6.3, exactly).

        Args:
            vertical: slope of each shaft in side view, ``(..., n + 1)``.
            horizontal: slope of each shaft in top view, ``(..., n + 1)``.
            phases: phase of each intermediate shaft, ``(..., n - 1)`` or one for all.
            degrees: whether all three are in degrees.

        Raises:
            TypeError: values that are not real numbers.
            ValueError: a slope outside (-90°, 90°), a bend of 90° or more, shapes that do not fit.
        """
        directions = _sloping(
            _slopes("vertical", vertical, degrees), _slopes("horizontal", horizontal, degrees)
        )
        return cls.from_directions(directions, phases, degrees=degrees)

    @classmethod
    @lazily(ends=0, vertical=1, horizontal=1, phases=1)
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
        add up along the shaft, so it matters which shaft the drawing lays along the travel: by the
        catalogue's figure the common one, for which ``tan(bend)**2 = tan(vertical)**2 +
        tan(horizontal)**2`` holds exactly.

        Args:
            vertical: bend of both joints in side view, ``(..., 2)``, positive upwards.
            horizontal: bend of both joints in top view, ``(..., 2)``, positive to the right.
            phases: phase of the common shaft, ``(..., 1)`` or one for all.
            degrees: whether all three are in degrees.
            reference: the shaft along the travel: ``"common"``, ``"input"`` or ``"output"``.

        Raises:
            TypeError: values that are not real numbers.
            ValueError: not two joints, an unknown reference, and as for ``from_slopes``.
        """
        views = []
        for name, value in (("vertical", vertical), ("horizontal", horizontal)):
            bend = _slopes(name, value, degrees, "projected bend")
            if bend.shape[-1] != 2:
                raise ValueError(f"{name} has shape {bend.shape}; two joints need (..., 2)")
            first, second = np.moveaxis(bend, -1, 0)
            zero = np.zeros_like(first)
            slopes = {
                "common": (-first, zero, second),
                "input": (zero, first, first + second),
                "output": (-first - second, -second, zero),
            }
            if reference not in slopes:
                known = ", ".join(map(repr, slopes))
                raise ValueError(f"reference is {reference!r}; it must be one of {known}")
            view = np.stack(slopes[reference], axis=-1)
            if np.any(np.abs(view) >= np.pi / 2):
                raise ValueError(f"{name} adds up to 90 deg or more against the {reference} shaft")
            views.append(view)
        up, right = views
        return cls.from_directions(_sloping(up, right), phases, degrees=degrees)

    @classmethod
    def _along(
        cls,
        lay_out: Any,  # noqa: ANN401 - one of the two functions of the native module
        array: FloatArray,
        n: int,
        phases: FloatArray,
    ) -> Self:
        shape = common_shape(vectors=array.shape[:-2], phases=phases.shape[:-1])
        flat_phases = _flat(phases, (*shape, max(n - 1, 0)))
        flat = _flat(array, (*shape, *array.shape[-2:]))
        return cls._laid_out(n, shape, lay_out(n, list(shape), flat, flat_phases), flat_phases)

    @classmethod
    def _laid_out(
        cls, n: int, shape: tuple[int, ...], flat: Sequence[FloatArray], phases: FloatArray
    ) -> Self:
        bends, twists, directions, normals = flat
        return cls._of(
            bends.reshape(*shape, n),
            twists.reshape(*shape, n - 1),
            # The others are new; this may be the caller's own array.
            np.array(phases).reshape(*shape, n - 1),
            directions.reshape(*shape, n + 1, 3),
            normals.reshape(*shape, n, 3),
        )

    @classmethod
    def _of(cls, *arrays: FloatArray) -> Self:
        self = object.__new__(cls)
        self._bends, self._twists, self._phases, self._directions, self._normals = arrays
        for array in arrays:
            array.flags.writeable = False
        *shape, self._n_joints = self._bends.shape
        self._shape = tuple(shape)
        self._lines = _core.Lines(self._n_joints, shape, [array.reshape(-1) for array in arrays])
        return self

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle as the five arrays."""
        arrays = (self._bends, self._twists, self._phases, self._directions, self._normals)
        return (_unpickled, arrays)

    def __copy__(self) -> Self:
        """Return the driveline itself: it never changes."""
        return self

    def __deepcopy__(self, memo: object) -> Self:
        """Return the driveline itself: it never changes."""
        return self

    def __repr__(self) -> str:
        """Show number of joints and bends, or the shape of a batch."""
        joints = f"{self.n_joints} joint{'s' if self.n_joints > 1 else ''}"
        if self.shape:
            return f"<Driveline batch {self.shape} of {joints}>"
        bends = ", ".join(f"{bend:.6g}" for bend in np.degrees(self._bends))
        return f"<Driveline of {joints}, bent by {bends} deg>"

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the batch; ``()`` for one driveline."""
        return self._shape

    @property
    def n_joints(self) -> int:
        """Number of joints of each driveline, ``n``."""
        return self._n_joints

    @property
    def bends(self) -> FloatArray:
        """Bend of each joint in rad, ``(..., n)``."""
        return self._bends

    @property
    def twists(self) -> FloatArray:
        """Twist of each intermediate shaft in rad, ``(..., n - 1)``."""
        return self._twists

    @property
    def phases(self) -> FloatArray:
        """Phase of each intermediate shaft in rad, ``(..., n - 1)``."""
        return self._phases

    @property
    def directions(self) -> FloatArray:
        """Unit vector along each shaft, ``(..., n + 1, 3)``."""
        return self._directions

    @property
    def normals(self) -> FloatArray:
        """Unit normal of each joint's bend plane, ``(..., n, 3)``."""
        return self._normals

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
        array = _per_shaft("phases", phases, self.n_joints, degrees)
        shape = common_shape(driveline=self.shape, phases=array.shape[:-1])

        def spread(own: FloatArray, core: int) -> FloatArray:
            full = (*shape, *own.shape[own.ndim - core :])
            return own if full == own.shape else np.ascontiguousarray(np.broadcast_to(own, full))

        return Driveline._of(
            spread(self._bends, 1),
            spread(self._twists, 1),
            np.array(np.broadcast_to(array, (*shape, array.shape[-1]))),
            spread(self._directions, 2),
            spread(self._normals, 2),
        )

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
        index = item_index("shaft", shaft, self.n_joints + 1)
        bends, twists, phases = (a.reshape(-1) for a in (self._bends, self._twists, self._phases))
        columns = _core.equivalent(self.n_joints, index, bends, twists, phases)
        return EquivalentJoint(*(scalar_or_array(c.reshape(self.shape)) for c in columns))

    def harmonics(self, orders: ArrayLike, shaft: int = -1) -> Harmonics:
        """Return the amplitudes of a shaft's motion at orders of the drive's rotation.

        At order ``2 n`` they are ``k**n / n`` of the angle error and ``2 k**n`` of the speed ratio,
        with the ``k`` of ``equivalent``: the Fourier series of Thoma's (4).

        Args:
            orders: positive integers, ``(m,)`` or one; odd orders have amplitude 0.
            shaft: index of the shaft, by default the last.

        Returns:
            amplitudes in rad and as ratios, ``(..., m)``.

        Raises:
            IndexError: a shaft that does not exist.
            TypeError: orders that are not integers.
            ValueError: an order below 1.
        """
        order = np.atleast_1d(np.asarray(orders))
        if order.dtype.kind not in "iu":
            raise TypeError(f"orders has dtype {order.dtype}; an order is an integer")
        if np.any(order < 1):
            raise ValueError(f"{at_place('orders', order, order < 1)}; an order is at least 1")
        n = order / 2
        k = np.asarray(self.equivalent(shaft).k)[..., np.newaxis]
        power = np.where(order % 2 == 0, k**n, 0.0)
        return Harmonics(order.astype(np.int64), power / n, 2.0 * power)

    def optimal_phases(self) -> FloatArray:
        """Return the phases that bring the last shaft closest to constant velocity.

        With ``L = ln sec(bend)`` exact constant velocity is possible if and only if the largest
        ``L`` is not more than all others together; then these phases reach it. Otherwise they line
        all joints up against the largest, which leaves the least possible equivalent bend. Of all
        such phases they are those to which the yokes turn least from their present ones (least sum
        of squares; with four or more bent joints least within their neighbourhood).

        Two joints at ``p = phase - twist + 90°`` make ``cosh L = cosh L_1 cosh L_2 + sinh L_1 sinh
        L_2 cos 2p`` (from Thoma 4), the law of cosines of the hyperbolic plane, where constant
        velocity is a closed polygon of sides ``L``.

        Returns:
            phases in rad, ``(..., n - 1)``, for ``with_phases``.
        """
        bends, twists, phases = (a.reshape(-1) for a in (self._bends, self._twists, self._phases))
        best = _core.optimal_phases(self.n_joints, bends, twists, phases, threads.at_most(None))
        return best.reshape(self._phases.shape)

    def catalogue_bend(self, fork_signs: ArrayLike) -> FloatArray:
        """Return the catalogues' equivalent bend ``sqrt|sum ± bend**2|``, for comparison.

        It is the first term of the exact ``ln sec`` rule for yokes that are aligned or crossed:
        two joints up to 30° are at most 1.02° off, with three it can miss altogether.

        Args:
            fork_signs: +1 or -1 per joint, ``(..., n)``: joints with the same fork position
                relative to their bend planes have the same sign, so the two joints of an ordinary
                compensated shaft have opposite ones.

        Returns:
            the bend in rad, broadcast from batch and signs (catalogue, double joint, 6.5).

        Raises:
            TypeError: signs that are not real numbers.
            ValueError: a sign other than +1 and -1, shapes that do not fit.
        """
        return np.asarray(approximations.catalogue_bend(self._bends, fork_signs))[()]

    def reversed(self) -> Driveline:
        """Return the driveline driven from its other end; reversing inverts its motion.

        Bends, twists and phases keep their values and change their order; directions and
        bend-plane normals change their sign as well.
        """
        return Driveline._of(
            np.array(self._bends[..., ::-1]),
            np.array(self._twists[..., ::-1]),
            np.array(self._phases[..., ::-1]),
            -self._directions[..., ::-1, :],
            -self._normals[..., ::-1, :],
        )

    def check(self, speed: ArrayLike | None = None) -> Check:
        """Check the catalogues' tolerance and, at a drive speed, the limits of practice.

        The equivalent bend must not exceed 3° (non-uniformity 0.0027; catalogue, double joint,
        6.4). By the practice of driveshaft makers in the United States torsional excitation, the
        exact peak acceleration of the last shaft, should not exceed 300 rad/s², and inertia
        excitation, the second-order amplitude of the accelerations of all intermediate shafts
        together, 1000 rad/s².

        Args:
            speed: drive speed in rad/s; broadcasts against the batch.

        Returns:
            findings with values, in the shape of batch and speed, and limits; ``print`` says it in
                words.

        Raises:
            TypeError: a speed that is not a real number.
            ValueError: shapes that do not broadcast.
        """
        return check(self, speed)

    def evaluate(
        self,
        angle: ArrayLike | Sweep,
        outputs: str | Iterable[str] = ("angle", "speed_ratio"),
        *,
        shafts: Items = None,
        joints: Items = None,
        load: Load | None = None,
        reduce: Reduction | None = None,
        out: Mapping[str, NDArray[Any]] | None = None,
        dtype: DTypeLike | None = None,
        tolerance: float | None = None,
        workers: int | None = None,
    ) -> Result:
        """Evaluate outputs over drive angles.

        Only what the outputs need is computed. The result of one output has the shape
        ``([items,] *broadcast(line.shape, angle.shape) [, 3])``: the shaft or joint axis comes
        first and is dropped for a single index, a vector's components come last.

        Args:
            angle: drive angle in rad, any shape, or a ``Sweep``; broadcasts against the batch. NaN
                and infinite angles give NaN at their own samples. With an array of dask the arrays
                of the result are dask's, a task of one thread for each chunk; with a DataArray of
                xarray an ``xarray.Dataset`` is returned, which keeps its coordinates.
            outputs: names from ``cardan.OUTPUTS``.
            shafts: shafts for the outputs per shaft: an index, a slice or a list; by default the
                last one.
            joints: joints for the outputs per joint; by default all.
            load: the load, for the outputs that need one.
            reduce: ``"min"``, ``"max"``, ``"mean"``, ``"rms"`` or ``"peak"`` over the last axis of
                the samples, which is dropped; no sample is stored. The peak is the largest
                magnitude, of a vector its largest length without an axis of components; the others
                take vectors by component. NaN among the samples gives NaN.
            out: arrays to fill, by output name, of the right shape and dtype; they are the arrays
                of the result then. One may be the array of angles itself. Filling arrays that are
                there saves the system's work of providing new memory, which for some 10⁵ angles is
                more than the evaluation. Vectors need no copy where they lie plane by plane, as in
                ``numpy.moveaxis(numpy.empty((3, n)), 0, -1)``. Ctrl-C stops an evaluation within
                a fraction of a second and leaves them filled in part. While a call fills an array,
                other threads cannot use it in theirs.
            dtype: ``float64``, the default whatever the dtype of the angles, or ``float32``:
                results, and unless ``tolerance`` says otherwise the arithmetic after an exact
                reduction of the angles.
            tolerance: permitted error, relative to each output's largest magnitude over a turn; the
                cheapest arithmetic that keeps it is chosen. 0 asks for results within 1 ulp (2 for
                moments and torques), 1e-6 and more for single precision; the default is the fast
                double, some ulp (the documentation's page Accuracy has the table).
            workers: at most so many threads, ``-1`` for all cores; by default all where the work
                repays them. The environment variable ``RAYON_NUM_THREADS`` says how many that are;
                a forked process uses one. The results do not depend on it.

        Raises:
            IndexError: a shaft or joint that does not exist.
            MemoryError: results, or what is needed on the way to them, beyond the memory there is.
            RuntimeError: an ``out`` that another thread is filling.
            TypeError: angles that are not plain real numbers, as masked ones or ones with a unit,
                indices that are not integers.
            ValueError: an unknown output, reduction or dtype, a load that is missing or does not
                fit, shapes that do not broadcast, an ``out`` of the wrong shape or type.
        """
        plan = Plan(self, outputs, shafts, joints, load, reduce, dtype, tolerance, workers)
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
    ) -> Plan:
        """Prepare an evaluation for any number of calls: ``plan(angle, out=...)``.

        The chain is folded and everything that the outputs do not need is dropped once;
        ``print(plan.explain())`` shows what remains.

        Args:
            outputs: names from ``cardan.OUTPUTS``.
            shafts: as of ``evaluate``, like all that follow.
            joints: for the outputs per joint.
            load: for the outputs that need one.
            reduce: of the last axis of the samples.
            dtype: of the results.
            tolerance: permitted error.
            workers: at most so many threads.

        Returns:
            the plan; calling it gives what ``evaluate`` gives.

        Raises:
            IndexError: a shaft or joint that does not exist.
            TypeError: outputs that are not names, indices that are not integers, a
                tolerance that is not a number.
            ValueError: an unknown output, reduction or dtype, a load that is missing or has not
                one inertia per shaft, a tolerance or number of threads out of range.
        """
        return Plan(self, outputs, shafts, joints, load, reduce, dtype, tolerance, workers)

    def __getitem__(self, index: Any) -> Driveline:  # noqa: ANN401 - whatever NumPy takes
        """Return drivelines of the batch, by NumPy's rules over its dimensions.

        ``line[3]`` is one of a batch, ``line[:, None]`` adds a dimension to broadcast over.

        Raises:
            IndexError: an index that does not fit the batch.
            TypeError: a single driveline has nothing to index.
        """
        if not self.shape:
            raise TypeError("a single driveline has no batch to index")
        places = np.arange(math.prod(self.shape)).reshape(self.shape)[index]
        shape = np.shape(places)

        def taken(own: FloatArray) -> FloatArray:
            core = own.shape[len(self.shape) :]
            flat = own.reshape(math.prod(self.shape), *core)
            return np.ascontiguousarray(flat[np.ravel(places)]).reshape(*shape, *core)

        return Driveline._of(
            taken(self._bends),
            taken(self._twists),
            taken(self._phases),
            taken(self._directions),
            taken(self._normals),
        )


def _unpickled(*arrays: FloatArray) -> Driveline:
    # What came in a message lies anywhere in it.
    return Driveline._of(*(np.require(array, requirements=["C", "A"]) for array in arrays))


def _per_shaft(name: str, value: ArrayLike, n: int, degrees: bool) -> FloatArray:
    """Twists or phases as ``(..., n - 1)``; one number stands for all shafts."""
    array = real(name, value)
    between = max(n - 1, 0)
    if array.ndim == 0:
        array = np.full(between, array)
    if array.shape[-1] != between:
        raise ValueError(f"{name} has shape {array.shape}; {n} joints need (..., {between})")
    if not np.isfinite(array).all():
        raise ValueError(f"{at_place(name, array, ~np.isfinite(array))}; it must be finite")
    return np.radians(array) if degrees else array


def _vectors(name: str, value: ArrayLike, fewest: int) -> FloatArray:
    array = real(name, value)
    if array.ndim < 2 or array.shape[-1] != 3 or array.shape[-2] < fewest:
        wanted = f"(..., {fewest} or more, 3)"
        raise ValueError(f"{name} has shape {array.shape}; it must be {wanted}")
    return array


def _slopes(name: str, value: ArrayLike, degrees: bool, what: str = "slope") -> FloatArray:
    array = np.atleast_1d(real(name, value))
    right_angle, unit = (90.0, "90 deg") if degrees else (np.pi / 2, "pi/2 rad")
    wrong = ~(np.abs(array) < right_angle)
    if wrong.any():
        place = at_place(name, array, wrong)
        raise ValueError(f"{place}; a {what} must lie between -{unit} and {unit}")
    return np.radians(array) if degrees else array


def _sloping(vertical: FloatArray, horizontal: FloatArray) -> FloatArray:
    """Directions from the slopes in side view and top view."""
    if vertical.shape[-1] != horizontal.shape[-1]:
        raise ValueError(
            f"vertical has {vertical.shape[-1]} shafts and horizontal {horizontal.shape[-1]}; "
            "they must be the same"
        )
    common_shape(vertical=vertical.shape, horizontal=horizontal.shape)
    up, right = np.broadcast_arrays(np.tan(vertical), np.tan(horizontal))
    return np.stack([np.ones_like(up), up, right], axis=-1)


def _flat(array: FloatArray, shape: tuple[int, ...]) -> FloatArray:
    """The array spread to a shape, as one run of elements."""
    return np.ascontiguousarray(np.broadcast_to(array, shape)).reshape(-1)

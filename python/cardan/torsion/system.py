"""Torsional systems: drivelines with compliant shafts."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, Literal, SupportsIndex

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cardan import _core
from cardan.arrays import (
    FloatArray,
    as_float64,
    common_shape,
    finite,
    not_negative,
    per_shaft,
    threads,
    together,
)
from cardan.arrays.errors import (
    ArgumentTypeError,
    ArgumentValueError,
    check_elements,
    check_shape,
    exclusive,
)
from cardan.arrays.indices import checked_orders, integer
from cardan.driveline import Driveline
from cardan.torsion.analyses import (
    bend_rules,
    modes,
    side_by_side,
    speed_response,
    stability_map,
    unstable_ranges,
)
from cardan.torsion.results import Coexisting, Orbit, Stability, SteadyState
from cardan.torsion.transient import (
    Equations,
    Event,
    IntegrationMethod,
    OfTime,
    OfTimeAndSpeed,
    Transient,
    integrated,
)

_PARAMETERS = ("inertias", "stiffnesses", "dampings", "load_torque", "load_damping")


@dataclass(frozen=True, eq=False, init=False, repr=False, slots=True)
class TorsionalSystem:
    """A driveline whose shafts are torsion springs, or a batch of such drivelines.

    Shaft ``i`` has an inertia at its input end and one at its output end, a stiffness between them
    and a damping. The input end of shaft 0 turns at constant speed; the output end of the last
    shaft carries the load. Lagrange's equations of this chain are solved exactly, that is with the
    nonlinear motion of the joints: vibration and stability refer to the periodic orbit, not to
    rigid rotation, which is no solution behind a joint.

    Leading dimensions of all arguments broadcast against the batch of the driveline. Modes, rules
    for bends, unstable speeds, stability maps and motions side by side are those of one system;
    a batch is refused with a ``ValueError``, values that are not real numbers with a ``TypeError``.

    Args:
        line: the driveline.
        inertias: moments of inertia in kg m², ``(..., n + 1, 2)`` for input end and output end of
            each shaft, or ``(..., n + 1)``, half of it at each end. An array whose last axis has 2
            entries and whose axis before has ``n + 1`` holds pairs.
        stiffnesses: torsional stiffness of each shaft in N m/rad, ``(..., n + 1)``; infinite for a
            rigid shaft. The same shafts must be compliant in the whole batch.
        dampings: damping of each shaft in N m s/rad, ``(..., n + 1)``; 0 by default.
        damping_ratios: instead, ``zeta`` of each shaft or one for all: the damping is
            ``2 zeta c / w`` with the stiffness ``c`` and the lowest natural frequency ``w``. With
            one ratio for all this is the damping ratio of the lowest mode. For one compliant shaft
            and a constant inertia ``J`` it is ``d/(2 sqrt(c J))``.
        load_torque: constant torque in N m that brakes the last shaft.
        load_damping: viscous load on the last shaft in N m s/rad.

    Raises:
        TypeError: no driveline, values that are not real numbers.
        ValueError: a negative or infinite inertia or damping, a stiffness that is not positive, a
            load that is not finite, no compliant shaft, a compliant shaft without an inertia that
            is rigidly connected to its output end, shapes that do not fit.

    Attributes:
        line: the driveline.
        shape: of the batch, to which driveline and parameters are broadcast.
        compliant: indices of the compliant shafts in order, the first axis of their torques.
        inertias: of input end and output end of each shaft in kg m², ``(..., n + 1, 2)``.
        stiffnesses: as given, in the shape of the batch like what follows.
        dampings: as given, or by the damping ratios.
        load_torque: as given.
        load_damping: as given.

    >>> import cardan
    >>> line = cardan.Driveline.from_bends([20], degrees=True)
    >>> stiffnesses = [float("inf"), 8000]
    >>> system = cardan.TorsionalSystem(
    ...     line, inertias=[[0, 0], [0, 0.05]], stiffnesses=stiffnesses, damping_ratios=0.02
    ... )
    >>> system.critical_speeds(orders=(2, 4)).round(1)
    array([[200., 100.]])
    >>> float(abs(system.steady(200.0).torque_orders[0, 0]).round(1))
    6223.2
    """

    line: Driveline
    shape: tuple[int, ...]
    compliant: tuple[int, ...]
    inertias: FloatArray
    stiffnesses: FloatArray
    dampings: FloatArray
    load_torque: FloatArray
    load_damping: FloatArray
    _core: _core.Torsion

    def __init__(
        self,
        line: Driveline,
        *,
        inertias: ArrayLike,
        stiffnesses: ArrayLike,
        dampings: ArrayLike | None = None,
        damping_ratios: ArrayLike | None = None,
        load_torque: ArrayLike = 0.0,
        load_damping: ArrayLike = 0.0,
    ) -> None:
        """Check the arguments and pass them to the native module."""
        if not isinstance(line, Driveline):
            raise ArgumentTypeError("line", f"is {line!r}; it must be a driveline")
        exclusive(dampings=dampings, damping_ratios=damping_ratios)
        line._geometry.check_ideal("torsional systems are computed")
        shafts = line.n_joints + 1
        springs = _per_shaft("stiffnesses", as_float64("stiffnesses", stiffnesses), shafts)
        rule = "; a stiffness must be positive, infinite for a rigid shaft"
        check_elements("stiffnesses", springs, springs > 0.0, rule)
        is_compliant = (springs < np.inf).reshape(-1, shafts)[:1]
        alike = (springs < np.inf) == is_compliant.reshape(shafts)
        rule = "; the same shafts must be compliant in the whole batch"
        check_elements("stiffnesses", springs, alike, rule)
        viscosity = not_negative("dampings", 0.0 if dampings is None else dampings)
        given = {
            "inertias": (_pairs(not_negative("inertias", inertias), shafts), 2),
            "stiffnesses": (springs, 1),
            "dampings": (_per_shaft("dampings", viscosity, shafts), 1),
            "load_torque": (finite("load_torque", load_torque), 0),
            "load_damping": (not_negative("load_damping", load_damping), 0),
        }
        shape, full = together(given, driveline=line.shape)
        compliant = tuple(int(i) for i in np.flatnonzero(is_compliant))
        self._keep(
            line=line, shape=shape, compliant=compliant, **dict(zip(given, full, strict=True))
        )
        if damping_ratios is not None:
            ratios = not_negative("damping_ratios", damping_ratios)
            ratios = _per_shaft("damping_ratios", ratios, shafts)
            if common_shape(system=shape, damping_ratios=ratios.shape[:-1]) != shape:
                problem = f"has the batch {ratios.shape[:-1]}, the system {shape}"
                raise ArgumentValueError("damping_ratios", problem)
            finite_springs = np.where(self.stiffnesses < np.inf, self.stiffnesses, 0.0)
            lowest = self.natural_frequencies()[..., :1]
            self._keep(dampings=np.asarray(2.0 * ratios * finite_springs / lowest))

    def _keep(self, **values: Any) -> None:  # noqa: ANN401 - of attributes
        """Keep values, with read-only copies of arrays: the caller may change them."""
        for name, value in values.items():
            if isinstance(value, np.ndarray):
                value = value.copy()
                value.flags.writeable = False
            object.__setattr__(self, name, value)
        lines = np.arange(math.prod(self.line.shape)).reshape(self.line.shape)
        lines = np.broadcast_to(lines, self.shape).ravel()
        own = [getattr(self, name).ravel() for name in _PARAMETERS]
        core = _core.Torsion(self.line._lines, self.shape, lines, own[:3], own[3:])
        object.__setattr__(self, "_core", core)

    def __repr__(self) -> str:
        """Show the driveline and the compliant shafts."""
        return f"<TorsionalSystem of {self.line!r}, compliant shafts {list(self.compliant)}>"

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle as driveline and parameters."""
        return (_restored, (self.line, {name: getattr(self, name) for name in _PARAMETERS}))

    modes = modes
    bend_rules = bend_rules
    unstable_ranges = unstable_ranges
    stability_map = stability_map
    side_by_side = side_by_side
    speed_response = speed_response

    def changed(
        self, line: Driveline | None = None, stiffnesses: ArrayLike | None = None
    ) -> TorsionalSystem:
        """Return the system with another driveline or other stiffnesses, or a batch of them.

        Dampings in N m s/rad, inertias and loads stay. Errors are as of ``TorsionalSystem``.

        Args:
            line: the driveline; by default the same.
            stiffnesses: of each shaft in N m/rad, ``(..., n + 1)``; by default the same.
        """
        given: dict[str, Any] = {name: getattr(self, name) for name in _PARAMETERS}
        given |= {} if stiffnesses is None else {"stiffnesses": stiffnesses}
        return TorsionalSystem(self.line if line is None else line, **given)

    def natural_frequencies(self) -> FloatArray:
        """Return the undamped natural frequencies in rad/s, ``(..., compliant)``, lowest first.

        They are those of the mean system: every inertia is its mean over a turn as it acts on the
        next compliant shaft before it, and joints transmit one to one. The drive is held at
        constant speed.
        """
        return self._core.natural_frequencies().reshape(*self.shape, len(self.compliant))

    def critical_speeds(self, orders: ArrayLike = (2, 4)) -> FloatArray:
        """Return the drive speeds in rad/s at which an order meets a natural frequency.

        They are ``natural frequency / order``, ``(..., compliant, m)``.

        Args:
            orders: as of ``steady``, like the errors; joints excite even orders.
        """
        return np.asarray(self.natural_frequencies()[..., np.newaxis] / _orders(orders))

    def steady(
        self,
        speed: ArrayLike,
        orders: ArrayLike = (2, 4),
        *,
        tolerance: float = 1e-9,
        workers: SupportsIndex | None = None,
    ) -> SteadyState:
        """Return the periodic motion at constant drive speeds.

        The orbit is found by collocation and Newton's method on a mesh that is refined until the
        tolerance is met. Where Newton's method does not converge, the orbit of the straight
        driveline is followed while its bends grow, also where it turns back. Unstable orbits are
        found as well; see ``stability``. Near a resonance of little damping there may be several
        orbits; one of them is returned.

        Args:
            speed: of the drive in rad/s; broadcasts against the batch.
            orders: positive integers up to 256, ``(m,)`` or one.
            tolerance: permitted error relative to the largest value, from 1e-12 to 1e-3.
            workers: largest number of threads, as of ``Driveline.evaluate``. Results do not depend
                on it.

        Raises:
            TypeError: orders that are not integers.
            ValueError: an order or a tolerance out of range, shapes that do not broadcast.
        """
        wanted = _orders(orders)
        m, ends, count = len(self.compliant), self.line.n_joints + 1, len(wanted)
        of, each = (self._core.steady, wanted.tolist()), 3 * m + 2 * count * (m + 2 * ends)
        shape, speeds, records, failures = self._run(of, each, speed, tolerance, workers)
        sizes = np.cumsum([m, m, m, 2 * m * count])
        mean, least, most, torques, angles = np.split(records, sizes, axis=-1)
        angle_orders = _moved(_complex(angles).reshape(*shape, ends, 2, count), 2, len(shape))
        rates = 1j * wanted * np.where(failures == 0, speeds, np.nan)[..., np.newaxis]
        return SteadyState(
            found=failures == 0,
            _failures=failures,
            torque_mean=_moved(mean, 1, len(shape)),
            torque_min=_moved(least, 1, len(shape)),
            torque_max=_moved(most, 1, len(shape)),
            torque_orders=_moved(_complex(torques).reshape(*shape, m, count), 1, len(shape)),
            angle_orders=angle_orders,
            speed_orders=rates * angle_orders,
            orders=wanted,
            compliant=self.compliant,
            _system=self,
            _speed=np.array(speeds),
            _tolerance=tolerance,
        )

    def orbit(
        self,
        speed: ArrayLike,
        samples: SupportsIndex,
        *,
        tolerance: float = 1e-9,
        workers: SupportsIndex | None = None,
    ) -> Orbit:
        """Return one period, half a turn of the drive, of every shaft end and torque.

        Args:
            speed: as of ``steady``, like ``tolerance``, ``workers`` and the errors.
            samples: number of equally spaced drive angles, at least 1.
        """
        count = integer("samples", samples, 1)
        m, ends = len(self.compliant), self.line.n_joints + 1
        of, each = (self._core.orbits, count), count * (6 * ends + m + 1)
        shape, _, records, failures = self._run(of, each, speed, tolerance, workers)
        *motion, torques, of_drive = np.split(
            records, np.cumsum([*3 * [2 * ends * count], m * count]), axis=-1
        )
        angles, speeds, accelerations = (
            _moved(record.reshape(*shape, ends, 2, count), 2, len(shape)) for record in motion
        )
        return Orbit(
            found=failures == 0,
            _failures=failures,
            drive_angle=np.asarray(np.arange(count) * (np.pi / count), dtype=np.float64),
            angle_error=angles,
            speed=speeds,
            acceleration=accelerations,
            drive_torque=of_drive,
            torque=_moved(torques.reshape(*shape, m, count), 1, len(shape)),
            compliant=self.compliant,
        )

    def stability(
        self, speed: ArrayLike, *, tolerance: float = 1e-9, workers: SupportsIndex | None = None
    ) -> Stability:
        """Return the Floquet multipliers about the periodic orbit.

        For one compliant driving shaft before a joint and a flywheel, the rotation at
        ``speed = natural frequency`` is unstable only if ``tan(bend/2)**2`` of the equivalent bend
        exceeds the damping ratio (leading order; Mathieu's first region).

        Args:
            speed: as of ``steady``, like ``tolerance``, ``workers`` and the errors.
        """
        of, each = (self._core.multipliers,), 4 * len(self.compliant)
        _, _, records, failures = self._run(of, each, speed, tolerance, workers)
        return Stability(failures == 0, failures, _complex(records))

    def coexisting(
        self,
        speed: ArrayLike,
        most: SupportsIndex = 4,
        *,
        tolerance: float = 1e-9,
        workers: SupportsIndex | None = None,
    ) -> Coexisting:
        """Return the periodic motions that exist side by side at a speed.

        Within a resonance of little damping, a shaft may vibrate a little or a lot at the same
        speed, depending on its past. The orbits are searched from the start of ``steady``, from
        the straight driveline while its bends grow, and from oscillations of the second order with
        amplitudes of 0.25 to 2 rad and several phases. There is no proof that these are all. A
        search takes some hundred times as long as that of ``steady``.

        Args:
            speed: as of ``steady``, like ``tolerance``, ``workers`` and the errors.
            most: number of orbits that are returned, at least 1.
        """
        orbits, m = integer("most", most, 1), len(self.compliant)
        of, each = (self._core.coexisting, orbits), 1 + 7 * m * orbits
        shape, _, records, failures = self._run(of, each, speed, tolerance, workers)
        of_orbits = records[..., 1:].reshape(*shape, orbits, 7 * m)
        mean, least, largest, multipliers = np.split(of_orbits, [m, 2 * m, 3 * m], axis=-1)
        return Coexisting(
            found=failures == 0,
            _failures=failures,
            count=np.where(failures == 0, records[..., 0], 0.0).astype(np.int64),
            torque_mean=np.moveaxis(mean, -1, 0),
            torque_min=np.moveaxis(least, -1, 0),
            torque_max=np.moveaxis(largest, -1, 0),
            multipliers=_complex(multipliers),
        )

    def transient(
        self,
        time: ArrayLike,
        *,
        speed: OfTime,
        torque: OfTime | None = None,
        drive_torque: OfTimeAndSpeed | None = None,
        drive_inertia: float = math.inf,
        start: Literal["rigid", "steady"] | Transient = "rigid",
        breaks: ArrayLike = (),
        events: Event | Sequence[Event] = (),
        tolerance: float = 1e-9,
        method: IntegrationMethod = "DOP853",
    ) -> Transient:
        """Return the motion in time: a run-up, a step of the load, a stop, a drive that gives way.

        The nonlinear equations of the steady state are integrated by SciPy (extra ``optimise``).
        The system must be one, not a batch.

        Args:
            time: times in s at which the motion is wanted, increasing, ``(samples,)``; the first
                is the beginning.
            speed: of the drive in rad/s, a number or a function of the time. Of a drive of finite
                inertia it is the speed at the beginning.
            torque: load torque in N m that brakes the last shaft, a number or a function of the
                time; by default that of the system. Its sign does not follow the motion: it
                accelerates a shaft that turns backwards.
            drive_torque: torque in N m on a drive of finite inertia, a number or a function of time
                and drive speed; 0 by default.
            drive_inertia: inertia in kg m² in front of shaft 0; infinite by default: the speed is
                as given.
            start: ``"rigid"``: the shafts move as if they were rigid and are twisted by the load;
                ``"steady"``: on the periodic orbit at this speed; or another transient, at whose
                end this motion begins. A drive of finite inertia then keeps its speed. The drive
                angle is 0 at the beginning, or goes on.
            breaks: times in s at which the functions or their slopes jump; the integration begins
                anew there.
            events: functions of a ``TorsionalMotion`` at one time. Their zeros are found. The
                attributes ``terminal`` and ``direction`` of a function mean what they do in
                ``solve_ivp``.
            tolerance: permitted error of each step relative to angles and speeds, from 1e-12 to
                1e-3.
            method: integrator of ``solve_ivp``: ``"DOP853"``, ``"RK45"``, ``"Radau"``, ``"BDF"``
                or ``"LSODA"``. The implicit ones suit stiff shafts whose free vibration has died.

        Raises:
            ImportError: SciPy is missing.
            RuntimeError: the integrator does not reach the last time.
            TypeError: values that are neither numbers nor functions, events that are not functions.
            ValueError: times that do not increase, a batch of systems, values out of range, a
                steady start without an orbit.

        >>> import numpy as np
        >>> import cardan
        >>> line = cardan.Driveline.from_bends([20], degrees=True)
        >>> own = {"inertias": [[0, 0], [0, 0.05]], "stiffnesses": [float("inf"), 8000]}
        >>> system = cardan.TorsionalSystem(line, damping_ratios=0.02, **own)
        >>> run_up = system.transient(np.linspace(0, 2, 2001), speed=lambda t: 150 * t)
        >>> peak = int(np.abs(run_up.torque[0]).argmax())
        >>> float(run_up.drive_speed[peak].round()), float(run_up.torque[0, peak].round())
        (214.0, -4453.0)
        """
        system = Equations(self, speed, torque, drive_torque, drive_inertia)
        permitted = _checked_tolerance(tolerance)
        return integrated(system, time, start, breaks, events, permitted, method)

    def _run(
        self,
        of: tuple[Any, ...],
        each: int,
        speed: ArrayLike,
        tolerance: float,
        workers: SupportsIndex | None,
    ) -> tuple[tuple[int, ...], FloatArray, FloatArray, NDArray[np.uint8]]:
        """Return shape, speeds, records of the given size and failures of all samples.

        They are those of a function of the native module, which its own arguments follow.
        """
        options = (*of[1:], _checked_tolerance(tolerance), threads.at_most(workers))
        speeds = as_float64("speed", speed)
        shape = common_shape(system=self.shape, speed=speeds.shape)
        numbers = np.arange(math.prod(self.shape)).reshape(self.shape)
        systems, full = np.broadcast_to(numbers, shape).ravel(), np.broadcast_to(speeds, shape)
        records, failures = of[0](systems, full.ravel(), *options)
        return shape, full, records.reshape(*shape, each), failures.reshape(shape)


def _restored(line: Driveline, given: dict[str, Any]) -> TorsionalSystem:
    return TorsionalSystem(line, **given)


def _orders(orders: ArrayLike) -> NDArray[np.int64]:
    # An orbit of more orders would need more points than the native module allows.
    return np.atleast_1d(checked_orders(orders, 256))


def _complex(pairs: FloatArray) -> NDArray[np.complex128]:
    return np.ascontiguousarray(pairs).view(np.complex128)


def _moved(array: NDArray[Any], axes: int, batch: int) -> NDArray[Any]:
    """Move so many axes behind those of the batch to the front."""
    return np.moveaxis(array, range(batch, batch + axes), range(axes))


def _checked_tolerance(tolerance: float) -> float:
    """Return the permitted error of an orbit."""
    value = float(as_float64("tolerance", tolerance))
    if not 1e-12 <= value <= 1e-3:
        raise ArgumentValueError("tolerance", f"is {value!r}; it must be from 1e-12 to 1e-3")
    return value


def _pairs(inertias: FloatArray, shafts: int) -> FloatArray:
    if inertias.shape[-2:] == (shafts, 2):
        return inertias
    rule = f"it needs one per shaft, (..., {shafts}), or one per end, (..., {shafts}, 2)"
    check_shape("inertias", inertias, inertias.shape[-1:] == (shafts,), rule)
    return np.repeat(0.5 * inertias[..., np.newaxis], 2, axis=-1)


def _per_shaft(name: str, array: FloatArray, shafts: int) -> FloatArray:
    return per_shaft(name, array, shafts) if array.ndim else np.full(shafts, array)

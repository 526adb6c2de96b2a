"""Torsional systems: drivelines with compliant shafts."""

from __future__ import annotations

import functools
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType
from typing import Any, Literal, SupportsIndex

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cardan import _core
from cardan.arrays import (
    FloatArray,
    as_float64,
    common_shape,
    finite,
    keep,
    not_negative,
    numbered,
    per_shaft,
    threads,
    together,
)
from cardan.arrays.errors import (
    ArgumentTypeError,
    ArgumentValueError,
    check_choice,
    check_elements,
    check_shape,
    exclusive,
    require,
)
from cardan.arrays.indices import integer
from cardan.driveline import Driveline
from cardan.geometry.geometry import require_driveline
from cardan.torsion import analyses
from cardan.torsion.excitation import ENDS, Coupling, TorqueHarmonic
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
# An orbit of more orders would need more points than the native module allows.
_MOST_ORDER = 256
# Halvings of the interval of a critical speed.
_HALVINGS = 60
_ORDER_RULE = f"; an order must be positive and at most {_MOST_ORDER}"
_ENGINE = ("drive", "drive_slope", "harmonics")


@dataclass(frozen=True, eq=False, init=False, repr=False, slots=True)
class TorsionalSystem:
    """A driveline whose shafts are torsion springs, or a batch of such drivelines.

    Shaft ``i`` has an inertia at its input end and one at its output end, a stiffness between them
    and a damping. The input end of shaft 0 is held at constant speed or free; the output end of the
    last shaft carries the load. Lagrange's equations of this chain are solved exactly, that is with
    the nonlinear motion of the joints: vibration and stability refer to the periodic orbit, not to
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
        drive: ``"held"`` at constant speed, so that an inertia at the input end of shaft 0 has no
            effect, or ``"free"``: that inertia is the drive's and counts, and a torque drives it
            whose mean keeps the mean speed. It must be said where that inertia is not 0.
        drive_slope: of a free drive: how much its torque falls with rising speed in N m s/rad.
        harmonics: torques that vary with the angles of shaft ends, for the whole batch. Their
            orders and the joints' order 2 have a common divisor of at least 1/8.
        couplings: by the compliant shaft that each of them makes, whose stiffness is infinite in
            ``stiffnesses``; for the whole batch.
        loss_factors: constant damping per cycle of each shaft, ``(n + 1,)``, the tangent of the
            loss angle; 0 by default.

    Raises:
        TypeError: no driveline, values that are not real numbers.
        ValueError: a negative or infinite inertia or damping, a stiffness that is not positive, a
            load that is not finite, no compliant shaft, a compliant shaft without an inertia that
            is rigidly connected to its output end, shapes that do not fit; an inertia at the drive
            without a word on the drive, a negative slope, orders that do not close, a coupling that
            is not monotonic.

    Attributes:
        line: the driveline.
        shape: of the batch, to which driveline and parameters are broadcast.
        compliant: indices of the compliant shafts in order, the first axis of their torques.
        inertias: of input end and output end of each shaft in kg m², ``(..., n + 1, 2)``.
        dampings: as given, or by the damping ratios.
        couplings: as given; loss factors of other shafts are couplings as well.

    The other arguments are attributes as given, arrays in the shape of the batch.

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
    drive: Literal["held", "free"]
    drive_slope: float
    harmonics: tuple[TorqueHarmonic, ...]
    couplings: Mapping[int, Coupling]
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
        drive: Literal["held", "free"] | None = None,
        drive_slope: float = 0.0,
        harmonics: Iterable[TorqueHarmonic] = (),
        couplings: Mapping[int, Coupling] | None = None,
        loss_factors: ArrayLike | None = None,
    ) -> None:
        """Check the arguments and pass them to the native module."""
        require_driveline("line", line)
        exclusive(dampings=dampings, damping_ratios=damping_ratios)
        line._geometry.check_ideal("torsional systems are computed")
        shafts = line.n_joints + 1
        springs = _per_shaft("stiffnesses", as_float64("stiffnesses", stiffnesses), shafts)
        made = _couplings(couplings, loss_factors, springs)
        springs, loads = springs.copy(), finite("load_torque", load_torque)
        load = float(loads.mean()) if loads.size else 0.0
        for shaft, coupling in made.items():
            springs[..., shaft] = coupling.stiffness_at(load)
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
            "load_torque": (loads, 0),
            "load_damping": (not_negative("load_damping", load_damping), 0),
        }
        if drive is None and np.any(given["inertias"][0][..., 0, 0] != 0.0):
            raise ArgumentValueError(
                "drive",
                "is missing, and there is an inertia at the input end of shaft 0: the drive is "
                "'free', and this is its inertia, or it is 'held' at constant speed, and the "
                "inertia has no effect",
            )
        check_choice("drive", drive or "held", ("held", "free"))
        shape, full = together(given, driveline=line.shape)
        compliant = tuple(int(i) for i in np.flatnonzero(is_compliant))
        self._keep(
            line=line,
            shape=shape,
            compliant=compliant,
            drive=drive or "held",
            drive_slope=float(finite("drive_slope", drive_slope)),
            harmonics=_harmonics(harmonics),
            couplings=MappingProxyType(made),
            **dict(zip(given, full, strict=True)),
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
        """Keep values, and what the native module makes of them."""
        keep(self, **values)
        lines = np.arange(math.prod(self.line.shape)).reshape(self.line.shape)
        lines = np.broadcast_to(lines, self.shape).ravel()
        own = [getattr(self, name).ravel() for name in _PARAMETERS]
        engine = (
            self.drive_slope if self.drive == "free" else None,
            [
                (2 * own.shaft + ENDS.index(own.end), float(own.order), own.cos, own.sin)
                for own in self.harmonics
            ],
            [own._fields(shaft) for shaft, own in self.couplings.items()],
        )
        keep(
            self, _core=_core.Torsion(self.line._lines, self.shape, lines, own[:3], own[3:], engine)
        )

    def __repr__(self) -> str:
        """Show the driveline and the compliant shafts."""
        return f"<TorsionalSystem of {self.line!r}, compliant shafts {list(self.compliant)}>"

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle as driveline and parameters."""
        return (functools.partial(TorsionalSystem, **self._given()), (self.line,))

    def _given(self) -> dict[str, Any]:
        """The arguments that make this system."""
        given = {name: getattr(self, name) for name in (*_PARAMETERS, *_ENGINE)}
        springs = self.stiffnesses.copy()
        springs[..., list(self.couplings)] = np.inf
        return given | {"stiffnesses": springs, "couplings": dict(self.couplings)}

    modes = analyses.modes
    bend_rules = analyses.bend_rules
    unstable_ranges = analyses.unstable_ranges
    stability_map = analyses.stability_map
    side_by_side = analyses.side_by_side
    speed_response = analyses.speed_response
    running_speeds = analyses.running_speeds

    def changed(
        self,
        line: Driveline | None = None,
        stiffnesses: ArrayLike | None = None,
        couplings: Mapping[int, Coupling] | None = None,
    ) -> TorsionalSystem:
        """Return the system with another driveline, other stiffnesses or couplings, or a batch.

        Dampings in N m s/rad, inertias and loads stay. Errors are as of ``TorsionalSystem``.

        Args:
            line: the driveline; by default the same.
            stiffnesses: of each shaft in N m/rad, ``(..., n + 1)``; by default the same.
            couplings: by their shafts; by default the same.
        """
        given = self._given()
        others = {"stiffnesses": stiffnesses, "couplings": couplings}
        given |= {name: value for name, value in others.items() if value is not None}
        return TorsionalSystem(self.line if line is None else line, **given)

    def natural_frequencies(self) -> FloatArray:
        """Return the undamped natural frequencies in rad/s, ``(..., compliant)``, lowest first.

        They are those of the mean system: every inertia is its mean over a turn as it acts on the
        next compliant shaft before it, and joints transmit one to one. The rotation of a free drive
        with the whole driveline, which some programs list as 0 Hz first, is not among them. The
        stiffness of a coupling is that at the load torque.
        """
        return self._core.natural_frequencies().reshape(*self.shape, len(self.compliant))

    def critical_speeds(self, orders: ArrayLike = (2, 4)) -> FloatArray:
        """Return the drive speeds in rad/s at which an order meets a natural frequency.

        They are ``natural frequency / order``, ``(..., compliant, m)``. Where stiffnesses depend on
        the mean torque and the load on the speed, each is found with the stiffnesses at that speed.

        Args:
            orders: as of ``steady``, like the errors; joints excite even orders.
        """
        wanted = _orders(orders)
        if not self.stiffness_follows_speed:
            return np.asarray(self.natural_frequencies()[..., np.newaxis] / wanted)
        load, viscous = (
            each[..., np.newaxis, np.newaxis] for each in (self.load_torque, self.load_damping)
        )
        low = np.zeros((*self.shape, len(self.compliant), len(wanted)))
        high = np.ones_like(low)
        while np.any(above := self._frequencies_at(load + viscous * high) > wanted * high):
            high = np.where(above, 2.0 * high, high)
        for _ in range(_HALVINGS):
            middle = 0.5 * (low + high)
            above = self._frequencies_at(load + viscous * middle) > wanted * middle
            low, high = np.where(above, middle, low), np.where(above, high, middle)
        return np.asarray(0.5 * (low + high))

    @property
    def stiffness_follows_speed(self) -> bool:
        """Whether stiffnesses depend on the mean torque, and the load on the speed."""
        by_mean = any(own.mean_torque is not None for own in self.couplings.values())
        return by_mean and bool(np.any(self.load_damping > 0.0))

    def _frequencies_at(self, torque: FloatArray) -> FloatArray:
        """The frequency of each mode at its own load torques in N m, ``(..., compliant, m)``."""
        springs = np.broadcast_to(
            self.stiffnesses[..., np.newaxis, np.newaxis, :],
            (*torque.shape, self.stiffnesses.shape[-1]),
        ).copy()
        for shaft, own in self.couplings.items():
            if own.mean_torque is not None:
                springs[..., shaft] = own.by_mean(torque)
        line = self.line.reshape(*self.line.shape, 1, 1) if self.line.shape else self.line
        inertias = self.inertias[..., np.newaxis, np.newaxis, :, :]
        system = TorsionalSystem(line, inertias=inertias, stiffnesses=springs, drive=self.drive)
        found = np.diagonal(system.natural_frequencies(), axis1=-3, axis2=-1)
        return np.asarray(np.swapaxes(found, -1, -2))

    @property
    def free(self) -> bool:
        """Whether the drive is free."""
        return self.drive == "free"

    @property
    def period_turns(self) -> float:
        """The turns of the drive in one period: 0.5 by the joints, 2 with half orders."""
        return self._core.period_turns()

    def steady(
        self,
        speed: ArrayLike,
        orders: ArrayLike = (2, 4),
        *,
        tolerance: float = 1e-9,
        workers: SupportsIndex | None = None,
    ) -> SteadyState:
        """Return the periodic motion at mean drive speeds.

        The orbit is found by collocation and Newton's method on a mesh that is refined until the
        tolerance is met. Where Newton's method does not converge, the orbit of the straight
        driveline is followed while its bends grow, also where it turns back. Unstable orbits are
        found as well; see ``stability``. Near a resonance of little damping there may be several
        orbits; one of them is returned.

        Args:
            speed: of the drive in rad/s; broadcasts against the batch.
            orders: positive numbers up to 256, ``(m,)`` or one; those that do not repeat in the
                period are 0.
            tolerance: permitted error relative to the largest value, from 1e-12 to 1e-3.
            workers: largest number of threads, as of ``Driveline.evaluate``. Results do not depend
                on it.

        Raises:
            TypeError: orders that are not real numbers.
            ValueError: an order or a tolerance out of range, shapes that do not broadcast.
        """
        wanted = _orders(orders)
        m, ends, count = len(self.compliant), self.line.n_joints + 1, len(wanted)
        of, each = (self._core.steady, wanted.tolist()), 3 * m + 3 + 2 * count * (m + 2 * ends)
        shape, speeds, records, failures = self._run(of, each, speed, tolerance, workers)
        torques, orders = (m,), (m, count, 2)
        mean, least, most, needed, slowest, fastest, torque_orders, angles = _parts(
            records, torques, torques, torques, (), (), (), orders, (ends, 2, count, 2)
        )
        angle_orders = _moved(_complex(angles), 2, len(shape))
        rates = 1j * wanted * np.where(failures == 0, speeds, np.nan)[..., np.newaxis]
        return SteadyState(
            failures == 0,
            failures,
            _moved(mean, 1, len(shape)),
            _moved(least, 1, len(shape)),
            _moved(most, 1, len(shape)),
            needed,
            slowest,
            fastest,
            torque_orders=_moved(_complex(torque_orders), 1, len(shape)),
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
        """Return one period, ``period_turns`` of the drive, of every shaft end and torque.

        Args:
            speed: as of ``steady``, like ``tolerance``, ``workers`` and the errors.
            samples: number of equally spaced drive angles, at least 1.
        """
        count = integer("samples", samples, 1)
        m, ends = len(self.compliant), self.line.n_joints + 1
        of, each = (self._core.orbits, count), count * (6 * ends + m + 1)
        shape, _, records, failures = self._run(of, each, speed, tolerance, workers)
        of_ends = (ends, 2, count)
        *motion, torques, of_drive = _parts(
            records, of_ends, of_ends, of_ends, (m, count), (count,)
        )
        angles, speeds, accelerations = (_moved(record, 2, len(shape)) for record in motion)
        return Orbit(
            failures == 0,
            failures,
            drive_angle=np.asarray(np.arange(count) * (2.0 * np.pi * self.period_turns / count)),
            angle_error=angles,
            speed=speeds,
            acceleration=accelerations,
            drive_torque=of_drive,
            torque=_moved(torques, 1, len(shape)),
            compliant=self.compliant,
        )

    def stability(
        self, speed: ArrayLike, *, tolerance: float = 1e-9, workers: SupportsIndex | None = None
    ) -> Stability:
        """Return the Floquet multipliers about the periodic orbit.

        For one compliant driving shaft before a joint and a flywheel, the rotation at
        ``speed = natural frequency`` is unstable only if ``tan(bend/2)**2`` of the equivalent bend
        exceeds the damping ratio (leading order; Mathieu's first region).

        A constant loss factor is no law in time. In the multipliers a viscous damping takes its
        place, with the loss of a vibration at a natural frequency, or at the geometric mean of two,
        whose sum is nearest to twice the speed.

        The whole driveline with a free drive is slowed down and comes back to its speed with the
        ``speed_multiplier``. Where ``drive_torque_slope`` plus the slope of the drive is negative,
        as beyond a resonance, it runs away from this speed (Sommerfeld).

        Args:
            speed: as of ``steady``, like ``tolerance``, ``workers`` and the errors.
        """
        of, each = (self._core.multipliers,), 2 * self._multipliers + 2
        _, _, records, failures = self._run(of, each, speed, tolerance, workers)
        multipliers, slope, of_speed = _parts(records, (self._multipliers, 2), (), ())
        found = (failures == 0, failures, _complex(multipliers), slope, of_speed)
        return Stability(*found, self.drive_slope, self.period_turns)

    @property
    def _multipliers(self) -> int:
        return 2 * len(self.compliant) + (self.drive == "free")

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

        In place of constant loss factors, the multipliers and all orbits but the first have viscous
        dampings that take as much from the first.

        Args:
            speed: as of ``steady``, like ``tolerance``, ``workers`` and the errors.
            most: number of orbits that are returned, at least 1.
        """
        orbits, m = integer("most", most, 1), len(self.compliant)
        one = 3 * m + 2 * self._multipliers + 1
        of, each = (self._core.coexisting, orbits), 1 + one * orbits
        shape, _, records, failures = self._run(of, each, speed, tolerance, workers)
        of_orbits = records[..., 1:].reshape(*shape, orbits, one)
        mean, least, largest, multipliers, of_speed = _parts(
            of_orbits, (m,), (m,), (m,), (self._multipliers, 2), ()
        )
        return Coexisting(
            failures == 0,
            failures,
            np.where(failures == 0, records[..., 0], 0.0).astype(np.int64),
            np.moveaxis(mean, -1, 0),
            np.moveaxis(least, -1, 0),
            np.moveaxis(largest, -1, 0),
            _complex(multipliers),
            of_speed,
            self.drive_slope,
        )

    def transient(
        self,
        time: ArrayLike,
        *,
        speed: OfTime,
        torque: OfTime | None = None,
        drive_torque: OfTimeAndSpeed | None = None,
        drive_inertia: float | None = None,
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
                and drive speed. By default 0; of a free drive the mean torque of the steady state
                at the first speed, less its slope.
            drive_inertia: inertia in kg m² in front of shaft 0; by default infinite, so that the
                speed is as given, or 0 of a free drive, whose inertia is that of the system.
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
                steady start without an orbit, a constant loss factor.

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
        shape, systems, (flat,) = numbered(self.shape, "system", speed=speeds)
        records, failures = of[0](systems, flat, *options)
        return shape, flat.reshape(shape), records.reshape(*shape, each), failures.reshape(shape)


def _orders(orders: ArrayLike) -> FloatArray:
    given = np.atleast_1d(finite("orders", orders))
    check_elements("orders", given, (given > 0.0) & (given <= _MOST_ORDER), _ORDER_RULE)
    check_shape("orders", given, given.ndim == 1, "they must be a list of numbers, (m,)")
    return given


def _harmonics(harmonics: Iterable[TorqueHarmonic]) -> tuple[TorqueHarmonic, ...]:
    found = tuple(harmonics)
    for i, own in enumerate(found):
        if not isinstance(own, TorqueHarmonic):
            raise ArgumentTypeError("harmonics", f"is {own!r}; it must be a TorqueHarmonic", (i,))
    return found


def _couplings(
    couplings: Mapping[int, Coupling] | None, loss_factors: ArrayLike | None, springs: FloatArray
) -> dict[int, Coupling]:
    """Return the couplings by their shafts, with those that loss factors make of springs."""
    shafts = springs.shape[-1]
    made: dict[int, Coupling] = {}
    if not isinstance(couplings, Mapping | None):
        raise ArgumentTypeError("couplings", f"is {couplings!r}; it must map shafts to couplings")
    for shaft, own in sorted((couplings or {}).items()):
        if not isinstance(own, Coupling):
            raise ArgumentTypeError("couplings", f"has {own!r}; it must be a Coupling", (shaft,))
        problem = f"names shaft {shaft}; the last one is {shafts - 1}"
        require("couplings", 0 <= shaft < shafts, problem)
        problem = "is the only compliance of its shaft, whose stiffness must be inf"
        require("couplings", not np.any(springs[..., shaft] < np.inf), problem, (shaft,))
        made[shaft] = own
    if loss_factors is None:
        return made
    factors = not_negative("loss_factors", loss_factors)
    check_shape("loss_factors", factors, factors.shape == (shafts,), f"it must be ({shafts},)")
    for shaft in np.flatnonzero(factors).tolist():
        spring = springs[..., shaft]
        if shaft not in made and not (np.all(spring < np.inf) and np.ptp(spring) == 0.0):
            problem = "is that of a rigid shaft or of one whose stiffness varies in the batch"
            raise ArgumentValueError("loss_factors", problem, (shaft,))
        own = made.get(shaft) or Coupling(float(spring.flat[0]))
        made[shaft] = replace(own, loss_factor=float(factors[shaft]))
    return made


def _parts(records: FloatArray, *shapes: tuple[int, ...]) -> list[FloatArray]:
    """Part records along their last axis into arrays of some shapes."""
    parts = np.split(records, np.cumsum([math.prod(shape) for shape in shapes])[:-1], axis=-1)
    batch = records.shape[:-1]
    return [part.reshape((*batch, *shape)) for part, shape in zip(parts, shapes, strict=True)]


def _complex(pairs: FloatArray) -> NDArray[np.complex128]:
    """Join pairs on the last axis."""
    return np.ascontiguousarray(pairs).view(np.complex128)[..., 0]


def _moved(array: NDArray[Any], axes: int, batch: int) -> NDArray[Any]:
    """Move so many axes behind those of the batch to the front."""
    return np.moveaxis(array, range(batch, batch + axes), range(axes))


def _checked_tolerance(tolerance: float) -> float:
    """Return the permitted error of an orbit."""
    value = float(as_float64("tolerance", tolerance))
    require("tolerance", 1e-12 <= value <= 1e-3, f"is {value!r}; it must be from 1e-12 to 1e-3")
    return value


def _pairs(inertias: FloatArray, shafts: int) -> FloatArray:
    if inertias.shape[-2:] == (shafts, 2):
        return inertias
    rule = f"it needs one per shaft, (..., {shafts}), or one per end, (..., {shafts}, 2)"
    check_shape("inertias", inertias, inertias.shape[-1:] == (shafts,), rule)
    return np.repeat(0.5 * inertias[..., np.newaxis], 2, axis=-1)


def _per_shaft(name: str, array: FloatArray, shafts: int) -> FloatArray:
    return per_shaft(name, array, shafts) if array.ndim else np.full(shafts, array)

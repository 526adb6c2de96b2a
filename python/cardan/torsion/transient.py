"""Motion in time: run-up, steps of torque, stops, drives of finite inertia."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from cardan.arrays import FloatArray, as_float64, import_optional
from cardan.arrays.errors import (
    ArgumentTypeError,
    ArgumentValueError,
    check_choice,
    check_elements,
    require,
)

if TYPE_CHECKING:
    from cardan.torsion.system import TorsionalSystem

OfTime: TypeAlias = float | Callable[[float], float]
OfTimeAndSpeed: TypeAlias = float | Callable[[float, float], float]


@dataclass(frozen=True, eq=False)
class TorsionalMotion:
    """Motion of a system at some times; ``...`` is their shape.

    Attributes:
        time: in s.
        drive_angle: in rad, ``(...)``.
        drive_speed: in rad/s, ``(...)``.
        angle_error: angle of every shaft end relative to the drive in rad, input end before output
            end, ``(n + 1, 2, ...)``.
        speed: speed of every shaft end in rad/s, ``(n + 1, 2, ...)``.
        torque: torque of every compliant shaft in N m, ``(compliant, ...)``.
        compliant: the compliant shafts.
    """

    time: FloatArray
    drive_angle: FloatArray
    drive_speed: FloatArray
    angle_error: FloatArray
    speed: FloatArray
    torque: FloatArray
    compliant: tuple[int, ...]


class Equations:
    """The equations of one system with its drive and its load.

    The state is the drive angle, the speed of the drive if its inertia is finite, the angles of the
    output ends of the compliant shafts relative to the drive, and their speeds.
    """

    def __init__(
        self,
        system: TorsionalSystem,
        speed: OfTime,
        torque: OfTime | None,
        drive_torque: OfTimeAndSpeed | None,
        drive_inertia: float | None,
    ) -> None:
        """Check the drive and the load."""
        problem = f"has the batch {system.shape}; a transient is that of one system"
        require("system", not system.shape, problem)
        lossy = [shaft for shaft, own in system.couplings.items() if own.loss_factor > 0.0]
        if lossy:
            problem = "has a loss factor, which is no law in time; give the shaft a damping"
            raise ArgumentValueError("couplings", problem, (lossy[0],))
        if drive_inertia is None:
            drive_inertia = 0.0 if system.drive == "free" else math.inf
        problem = f"is {drive_inertia!r}; it must not be negative"
        require("drive_inertia", drive_inertia >= 0.0, problem)
        self.free = math.isfinite(drive_inertia)
        if drive_torque is not None and not self.free:
            problem = "is given, but the speed of a drive of infinite inertia does not follow it"
            raise ArgumentValueError("drive_torque", problem)
        if self.free and callable(speed):
            problem = "is a function, but a drive of finite inertia only begins with a speed"
            raise ArgumentValueError("speed", problem)
        self.system = system
        self.compliant = system.compliant
        self.drive_inertia = drive_inertia
        self.first = 2 if self.free else 1
        self.size = self.first + 2 * len(self.compliant)
        self._speed = _checked("speed", speed)
        load = float(system.load_torque) if torque is None else torque
        self._load = _checked("torque", load)
        if drive_torque is None and system.drive == "free" and self.free:
            drive_torque = self._law()
        self._driven = _checked("drive_torque", 0.0 if drive_torque is None else drive_torque)

    def _law(self) -> OfTimeAndSpeed:
        """The torque of a free drive: the mean of the steady state, and its slope."""
        speed, slope = self.speed(0.0), self.system.drive_slope
        steady = self.system.steady(speed)
        if not steady.found:
            problem = f"is missing; the mean torque at {speed} rad/s is not known: {steady.reasons}"
            raise ArgumentValueError("drive_torque", problem)
        mean = float(steady.drive_torque_mean)
        return lambda _, now: mean - slope * (now - speed)

    def speed(self, time: float) -> float:
        """The speed of the drive where it is given, or with which it begins."""
        return _value("speed", self._speed, time)

    def load_torque(self, time: float) -> float:
        """The torque that brakes the last shaft."""
        return _value("torque", self._load, time)

    def __call__(self, time: float, state: FloatArray) -> FloatArray:
        """Return the time derivative of the state."""
        speed = state[1] if self.free else self.speed(time)
        given = [state[0], speed, self.load_torque(time)]
        # Implicit integrators pass columns of a matrix.
        ends = np.ascontiguousarray(state[self.first :])
        found = self.system._core.slopes(given, ends)
        slopes = np.empty(self.size)
        slopes[0] = speed
        slopes[self.first :] = found[:-2]
        if self.free:
            torque, inertia = found[-2:]
            driven = _value("drive_torque", self._driven, time, speed)
            slopes[1] = (driven - torque) / (self.drive_inertia + inertia)
        return slopes

    def motion(self, times: FloatArray, states: FloatArray) -> TorsionalMotion:
        """Return the motion in states ``(variables, ...)``."""
        shape, shafts = times.shape, self.system.line.n_joints + 1
        if self.free:
            speeds = states[1]
        else:
            speeds = np.array([self.speed(time) for time in times.flat]).reshape(shape)
        rows = np.stack([states[0], speeds, *states[self.first :]], axis=-1)
        found = self.system._core.motion(np.ascontiguousarray(rows.ravel()))
        records = np.moveaxis(found.reshape(*shape, 4 * shafts + len(self.compliant)), -1, 0)
        return TorsionalMotion(
            time=times,
            drive_angle=states[0],
            drive_speed=speeds,
            angle_error=records[: 2 * shafts].reshape(shafts, 2, *shape),
            speed=records[2 * shafts : 4 * shafts].reshape(shafts, 2, *shape),
            torque=records[4 * shafts :],
            compliant=self.compliant,
        )

    def rigid(self, time: float) -> FloatArray:
        """Return the state of rigid shafts that are twisted by their static torques."""
        speed = self.speed(time)
        ends = self.system._core.rigid([speed, self.load_torque(time)])
        return np.concatenate([[0.0, speed][: self.first], ends])

    def steady(self, time: float) -> FloatArray:
        """Return the state on the periodic orbit, which must exist."""
        speed = self.speed(time)
        orbit = self.system.orbit(speed, 1)
        if not orbit.found:
            raise ArgumentValueError("start", f"is 'steady', but at {speed} rad/s {orbit.reasons}")
        ends = list(self.compliant)
        lead = orbit.angle_error[0, 0, 0]
        drive = [lead, orbit.speed[0, 0, 0]][: self.first]
        return np.concatenate(
            [drive, orbit.angle_error[ends, 1, 0] - lead, orbit.speed[ends, 1, 0]]
        )


def _checked(name: str, value: Any) -> Any:  # noqa: ANN401 - a number or a function
    if callable(value):
        return value
    try:
        number = float(value)
    except (TypeError, ValueError):
        problem = f"is {value!r}; it must be a number or a function"
        raise ArgumentTypeError(name, problem) from None
    require(name, math.isfinite(number), f"is {number!r}; it must be finite")
    return number


def _value(name: str, of: Any, time: float, *speed: float) -> float:  # noqa: ANN401
    if not callable(of):
        return float(of)
    value = float(of(time, *speed))
    require(name, math.isfinite(value), f"is {value!r} at {time} s; it must be finite")
    return value


IntegrationMethod: TypeAlias = Literal["DOP853", "RK45", "Radau", "BDF", "LSODA"]
METHODS: tuple[IntegrationMethod, ...] = ("DOP853", "RK45", "Radau", "BDF", "LSODA")
"""The integrators of ``scipy.integrate.solve_ivp`` that are offered."""

Event: TypeAlias = Callable[[TorsionalMotion], float]

# Permitted absolute errors relative to the tolerance: of an angle in rad, and of a speed relative
# to the lowest natural frequency.
_SMALL = 1e-3


@dataclass(frozen=True, eq=False)
class Transient(TorsionalMotion):
    """A motion in time, at the times that were asked for.

    Attributes:
        event_times: the times in s at which each event was zero.
        stopped: whether an event ended the motion; later times are missing.
    """

    event_times: tuple[FloatArray, ...]
    stopped: bool
    _equations: Equations = field(repr=False)
    _path: Any = field(repr=False)  # the states over time

    def at(self, time: ArrayLike) -> TorsionalMotion:
        """Return the motion at any times between the first and the last one.

        The integrator's own interpolation is used, with nearly the accuracy of its steps.

        Args:
            time: in s, any shape, within the integrated span.
        """
        times = as_float64("time", time)
        first, last = self._path.t_min, self._path.t_max
        right = (times >= first) & (times <= last)
        check_elements("time", times, right, f"; it must be from {first} to {last}")
        return self._equations.motion(times, _states(self._path, times))


def _states(path: Any, times: FloatArray) -> FloatArray:  # noqa: ANN401 - an ``OdeSolution``
    """Return the states ``(variables, ...)`` at times."""
    found: FloatArray = path(times.ravel())
    return found.reshape(len(found), *times.shape)


def integrated(
    equations: Equations,
    time: ArrayLike,
    start: Literal["rigid", "steady"] | Transient,
    breaks: ArrayLike,
    events: Event | Sequence[Event],
    tolerance: float,
    method: IntegrationMethod,
) -> Transient:
    """Return the motion from the first to the last time, as ``TorsionalSystem.transient`` does."""
    times = _times(time)
    check_choice("method", method, METHODS)
    listed = [events] if callable(events) else events
    watched = [_Watched(equations, event, i) for i, event in enumerate(listed)]
    scipy = import_optional("scipy.integrate", "optimise")
    state = _start(equations, start, times[0])
    natural = float(equations.system.natural_frequencies()[0])
    m = len(equations.compliant)
    scales = [*[1.0, natural][: equations.first], *m * [1.0], *m * [natural]]
    inner = np.unique(as_float64("breaks", breaks).ravel())
    inner = inner[(inner > times[0]) & (inner < times[-1])]
    ends = [*inner, times[-1]]
    steps, pieces = [times[0]], []
    zeros: list[list[float]] = [[] for _ in watched]
    stopped = False
    for first, last in zip([times[0], *inner], ends, strict=True):
        found = scipy.solve_ivp(
            equations,
            (first, last),
            state,
            method=method,
            dense_output=True,
            events=watched or None,
            rtol=tolerance,
            atol=_SMALL * tolerance * np.array(scales),
        )
        if found.status < 0:
            raise RuntimeError(f"the integration ends at {found.t[-1]} s: {found.message}")
        steps += [*found.sol.ts[1:]]
        pieces += found.sol.interpolants
        for of_event, here in zip(zeros, found.t_events or (), strict=True):
            of_event.extend(here)
        state, stopped = found.y[:, -1], found.status == 1
        if stopped:
            break
    path = scipy.OdeSolution(steps, pieces)
    kept = times[times <= path.t_max]
    return Transient(
        **vars(equations.motion(kept, _states(path, kept))),
        event_times=tuple(np.array(of_event) for of_event in zeros),
        stopped=stopped,
        _equations=equations,
        _path=path,
    )


class _Watched:
    """An event as ``solve_ivp`` takes it."""

    def __init__(self, equations: Equations, event: Event, number: int) -> None:
        if not callable(event):
            raise ArgumentTypeError("events", f"is {event!r}; it must be a function", (number,))
        self._equations, self._event = equations, event
        self.terminal = getattr(event, "terminal", False)
        self.direction = getattr(event, "direction", 0.0)

    def __call__(self, time: float, state: FloatArray) -> float:
        return float(self._event(self._equations.motion(np.asarray(time), state)))


def _start(
    equations: Equations, start: Literal["rigid", "steady"] | Transient, time: float
) -> FloatArray:
    """Return the state at the beginning."""
    if isinstance(start, Transient):
        before = start._equations
        problem = f"has the compliant shafts {before.compliant}, not {equations.compliant}"
        require("start", before.compliant == equations.compliant, problem)
        last = np.asarray(start._path.t_max)
        state = _states(start._path, last)
        drive = [state[0], float(before.motion(last, state).drive_speed)]
        return np.concatenate([drive[: equations.first], state[before.first :]])
    if start == "steady":
        return equations.steady(time)
    require("start", start == "rigid", f"is {start!r}; it must be 'rigid', 'steady' or a transient")
    return equations.rigid(time)


def _times(time: ArrayLike) -> FloatArray:
    times = as_float64("time", time)
    if times.ndim != 1 or times.size < 2:
        raise ArgumentValueError("time", f"has shape {times.shape}; it needs two times at least")
    right = np.append(np.diff(times) > 0.0, True) & np.isfinite(times)
    check_elements("time", times, right, "; times must be finite and increase")
    return np.array(times)

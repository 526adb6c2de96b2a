"""Motion in time: run-up, steps of torque, stops, drives of finite inertia."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Any, Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike

from cardan.arrays import FloatArray, as_float64, import_optional
from cardan.arrays.errors import ArgumentTypeError, ArgumentValueError, check_choice, check_elements
from cardan.torsion.equations import Equations, TorsionalMotion

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
    _path: _Path = field(repr=False)

    def at(self, time: ArrayLike) -> TorsionalMotion:
        """Return the motion at any times between the first and the last one.

        The integrator's own interpolation is used, with nearly the accuracy of its steps.

        Args:
            time: in s, any shape.

        Raises:
            TypeError: times that are not real numbers.
            ValueError: a time outside the integrated span.
        """
        times = as_float64("time", time)
        first, last = self._path.span
        right = (times >= first) & (times <= last)
        check_elements("time", times, right, f"; it must be from {first} to {last}")
        return self._equations.motion(times, self._path(times))


@dataclass(frozen=True, eq=False)
class _Path:
    """The states over time: one interpolation for each span between two breaks."""

    solutions: tuple[Any, ...]
    size: int

    @property
    def span(self) -> tuple[float, float]:
        """First and last time."""
        return self.solutions[0].t_min, self.solutions[-1].t_max

    def __call__(self, times: FloatArray) -> FloatArray:
        """Return the states ``(variables, ...)`` at times within the span."""
        flat = times.ravel()
        ends = [solution.t_max for solution in self.solutions[:-1]]
        numbers = np.searchsorted(ends, flat)
        found = np.empty((self.size, flat.size))
        for number, solution in enumerate(self.solutions):
            here = numbers == number
            if here.any():
                found[:, here] = solution(flat[here])
        return found.reshape(self.size, *times.shape)


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
    solve = import_optional("scipy.integrate", "optimise").solve_ivp
    state = _start(equations, start, times[0])
    natural = float(equations.system.natural_frequencies()[0])
    m = len(equations.compliant)
    scales = [*[1.0, natural][: equations.first], *m * [1.0], *m * [natural]]
    inner = np.unique(as_float64("breaks", breaks).ravel())
    inner = inner[(inner > times[0]) & (inner < times[-1])]
    ends = [*inner, times[-1]]
    solutions: list[Any] = []
    zeros: list[list[float]] = [[] for _ in watched]
    stopped = False
    for first, last in zip([times[0], *inner], ends, strict=True):
        found = solve(
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
        solutions.append(found.sol)
        for of_event, here in zip(zeros, found.t_events or (), strict=True):
            of_event.extend(here)
        state, stopped = found.y[:, -1], found.status == 1
        if stopped:
            break
    path = _Path(tuple(solutions), equations.size)
    kept = times[times <= path.span[1]]
    return Transient(
        **vars(equations.motion(kept, path(kept))),
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
        if before.compliant != equations.compliant:
            problem = f"has the compliant shafts {before.compliant}, not {equations.compliant}"
            raise ArgumentValueError("start", problem)
        last = np.asarray(start._path.span[1])
        state = start._path(last)
        drive = [state[0], float(before.motion(last, state).drive_speed)]
        return np.concatenate([drive[: equations.first], state[before.first :]])
    if start == "steady":
        return equations.steady(time)
    if start != "rigid":
        problem = f"is {start!r}; it must be 'rigid', 'steady' or a transient"
        raise ArgumentValueError("start", problem)
    return equations.rigid(time)


def _times(time: ArrayLike) -> FloatArray:
    times = as_float64("time", time)
    if times.ndim != 1 or times.size < 2:
        raise ArgumentValueError("time", f"has shape {times.shape}; it needs two times at least")
    right = np.append(np.diff(times) > 0.0, True) & np.isfinite(times)
    check_elements("time", times, right, "; times must be finite and increase")
    return np.array(times)

"""How a driveline is used: the steps of its duty cycle."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from cardan.app.scene.layout import SceneLayout
from cardan.app.scene.states import States
from cardan.app.scene.units import RPM
from cardan.arrays import FloatArray
from cardan.arrays.errors import ArgumentValueError, nearest
from cardan.driveline import Driveline
from cardan.evaluation.load import Load

_TORQUES = ("drive_torque_Nm", "output_torque_Nm")
_ONE_PER_STEP = ("hours", "speed_rpm", *_TORQUES, "bends_deg", "states", "names")


@dataclass(frozen=True, eq=False)
class DutyCycle:
    """How a driveline is used, in steps.

    Attributes:
        names: of the steps.
        shares: of each step in the time, ``(steps,)``, with sum 1.
        hours: as the scene has them, ``(steps,)``; ``None`` if it gives none.
        line: the driveline in each step, a batch ``(steps,)``.
        load: the load in each step, ``(steps,)``.
        target: required life in hours; ``None`` if the scene requires none.
    """

    names: tuple[str, ...]
    shares: FloatArray
    hours: FloatArray | None
    line: Driveline
    load: Load
    target: float | None

    @property
    def speed_rpm(self) -> FloatArray:
        """Speed of the drive in each step, ``(steps,)``."""
        return np.abs(self.load.speed) / RPM

    def load_of(self, step: int) -> Load:
        """Return the load in one step."""
        load = self.load
        values: dict[str, Any] = {
            f"{load.end}_torque": load.torque[step],
            "speed": load.speed[step],
        }
        return Load(inertias=load.inertias, **values)

    @property
    def count(self) -> int:
        """Number of steps."""
        return len(self.names)


def duty_cycle(
    values: Mapping[str, Any],
    line: Driveline,
    load: Load | None,
    layout: SceneLayout | None,
    states: States | None,
) -> DutyCycle:
    """Return the duty cycle that the keys of the section describe.

    Args:
        values: values by key.
        line: the driveline of the scene.
        load: its load, if it has one.
        layout: how the scene describes its driveline; ``None`` if its bends were recorded.
        states: its states, if it has any.

    Raises:
        ValueError: recorded bends or loads, lists of different lengths, a speed or a torque that
            neither the section nor the load gives, bends of a driveline that is not made of bends,
            a state that does not exist.
    """
    if layout is None or (load is not None and np.ndim(load.speed + load.torque)):
        raise ValueError("it does not go with recorded bends or loads; give the steps as numbers")
    steps = _steps(values)

    def column(key: str) -> FloatArray:
        return np.broadcast_to(np.asarray(values[key], dtype=np.float64), (steps,))

    hours = column("hours") if "hours" in values else None
    given = np.ones(steps) if hours is None else hours
    return DutyCycle(
        tuple(values.get("names", [f"step {i}" for i in range(steps)])),
        given / np.sum(given),
        hours,
        _lines(values, steps, line, layout, states),
        _load(values, steps, load),
        values.get("target_h"),
    )


def _steps(values: Mapping[str, Any]) -> int:
    """The number of steps, which all lists have."""
    lists = {key: len(values[key]) for key in _ONE_PER_STEP if isinstance(values.get(key), list)}
    first = next(iter(lists), "")
    for key, count in lists.items():
        if count != lists[first] or not count:
            what = f"as many as {first}" if count else "at least one step"
            wanted = lists[first] or 1
            raise ArgumentValueError(key, f"has length {count}; it needs {wanted}, {what}")
    return lists.get(first, 1)


def _load(values: Mapping[str, Any], steps: int, load: Load | None) -> Load:
    torque = next((key for key in _TORQUES if key in values), None)
    if "speed_rpm" in values:
        speed = RPM * np.asarray(values["speed_rpm"], dtype=np.float64)
    elif load is not None and np.all(load.speed != 0.0):
        speed = np.asarray(load.speed)
    else:
        raise ArgumentValueError("speed_rpm", "is missing here and in [load]; a life needs a speed")
    if torque is None and (load is None or not np.all(load.torque != 0.0)):
        raise ArgumentValueError(
            "output_torque_Nm", "is missing here and in [load]; a life needs a torque"
        )
    end, moment = ("output", np.zeros(())) if load is None else (str(load.end), load.torque)
    if torque is not None:
        end, moment = torque.partition("_")[0], np.asarray(values[torque], dtype=np.float64)
        if not np.any(moment):
            raise ArgumentValueError(torque, "is 0 in all steps; a life needs a torque")
    arguments: dict[str, Any] = {
        f"{end}_torque": np.broadcast_to(moment, (steps,)),
        "speed": np.broadcast_to(speed, (steps,)),
    }
    return Load(inertias=None if load is None else load.inertias, **arguments)


def _lines(
    values: Mapping[str, Any],
    steps: int,
    line: Driveline,
    layout: SceneLayout,
    states: States | None,
) -> Driveline:
    if "states" in values:
        if states is None:
            raise ArgumentValueError(
                "states", "names states, but the scene has no section [states]"
            )
        for i, name in enumerate(values["states"]):
            if name not in states.names:
                hint = nearest(name, list(states.names))
                raise ArgumentValueError("states", f"is {name!r}; {hint}", (i,))
        return states.drivelines()[[states.names.index(name) for name in values["states"]]]
    if "bends_deg" not in values:
        return line.reshape(1)[np.zeros(steps, dtype=int)]
    if "bends_deg" not in layout.driveline:
        given = next(iter(layout.driveline))
        raise ArgumentValueError(
            "bends_deg", f"needs bends_deg in [driveline], which gives {given}; use states"
        )
    joints, bends = line.n_joints, []
    for i, entry in enumerate(values["bends_deg"]):
        row = entry if isinstance(entry, list) else [entry] * joints
        if len(row) != joints:
            raise ArgumentValueError(
                "bends_deg", f"has length {len(row)}; it needs {joints}, one per joint", (i,)
            )
        bends.append(row)
    spread = {
        key: np.broadcast_to(np.asarray(value, dtype=np.float64), (steps, len(value)))
        for key, value in layout.driveline.items()
    }
    return layout.of({**spread, "bends_deg": np.array(bends, dtype=np.float64)})

"""The section [life]: how a driveline is used, the steps of its duty cycle."""

from __future__ import annotations

from collections.abc import Container, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np

from cardan.app.scene.language.rules import BEND, POSITIVE, TEXTS, ListOf, Number, Text, each
from cardan.app.scene.language.section import Key, Reading, Section, check_count
from cardan.app.scene.language.units import RPM, us_keys
from cardan.app.scene.sections.joints import JOINTS
from cardan.app.scene.sections.load import TORQUES
from cardan.app.scene.sections.study import STATES
from cardan.arrays import FloatArray
from cardan.arrays.errors import ArgumentValueError, nearest
from cardan.driveline import Driveline
from cardan.evaluation.load import Load

if TYPE_CHECKING:
    from cardan.app.scene.study.states import States
    from cardan.app.scene.study.study import SceneLayout

_ONE_PER_STEP = ("hours", "speed_rpm", *TORQUES, "bends_deg", "states", "names")


@dataclass(frozen=True, eq=False)
class DutyCycle:
    """How a driveline is used, in steps.

    Driveline and load are ``(places, steps)``: the places are the states of the scene or drivelines
    of its study; there is one where the steps say how the driveline stands. The shares have the
    sum 1, the target is in hours, and the values of [life] are none if [load] is the only step.
    """

    names: tuple[str, ...]
    shares: FloatArray
    line: Driveline
    load: Load
    target: float | None
    values: Mapping[str, Any]
    layout: SceneLayout

    @property
    def is_set(self) -> bool:
        """Whether the steps say how the driveline stands."""
        return stands(self.values)

    def of(self, line: Driveline, load: Load | None) -> DutyCycle:
        """Return the duty cycle of other drivelines, ``(places, 1)``, with their load."""
        return duty_cycle(self.values, line, load, self.layout, None)

    def load_of(self, place: int, step: int) -> Load:
        """Return the load in one step."""
        return load_at(self.load, self.line.shape, (place, step))


def load_at(load: Load, shape: tuple[int, ...], place: tuple[int, ...]) -> Load:
    """Return the load of one of the drivelines of a batch."""

    def there(values: FloatArray, own: int) -> FloatArray:
        whole = (*shape, *values.shape[values.ndim - own :])
        return np.asarray(np.broadcast_to(values, whole)[place])

    return load.changed(there)


def stands(values: Mapping[str, Any]) -> bool:
    """Return whether the keys of [life] say how the driveline stands in each step."""
    return not values.keys().isdisjoint({"states", "bends_deg"})


def duty_cycle(
    values: Mapping[str, Any],
    line: Driveline,
    load: Load | None,
    layout: SceneLayout | None,
    states: States | None,
    varied: Container[str] = (),
) -> DutyCycle:
    """Return the duty cycle that the keys of the section describe.

    The drivelines and their load are ``(places, 1)``. There is no layout where bends or loads were
    recorded; the keys varied by a study give what the load lacks.
    """
    if layout is None:
        raise ValueError("it does not go with recorded bends or loads; give the steps as numbers")
    steps = _steps(values)
    given = np.broadcast_to(np.asarray(values.get("hours", 1.0), dtype=np.float64), (steps,))
    names = [f"step {i}" for i in range(steps)]
    if "states" in values:
        line, load = _in_states(values["states"], load, states)
        if len(set(values["states"])) == steps:
            names = values["states"]
    elif "bends_deg" in values:
        line = _bent(values["bends_deg"], line, layout)
    else:
        line = line[:, np.zeros(steps, dtype=int)]
    return DutyCycle(
        tuple(values.get("names", names)),
        given / np.sum(given),
        line,
        _load(values, line.shape, load, varied),
        values.get("target_h"),
        values,
        layout,
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


def _load(
    values: Mapping[str, Any], shape: tuple[int, ...], load: Load | None, varied: Container[str]
) -> Load:
    torque = next((key for key in TORQUES if key in values), None)
    if "speed_rpm" in values:
        speed = RPM * np.asarray(values["speed_rpm"], dtype=np.float64)
    elif load is not None and (np.any(load.speed != 0.0) or gives(varied, "speed")):
        speed = np.asarray(load.speed)
    else:
        raise ArgumentValueError("speed_rpm", "is missing here and in [load]; a life needs a speed")
    if torque is not None:
        end, moment = torque.partition("_")[0], np.asarray(values[torque], dtype=np.float64)
        if not np.any(moment):
            raise ArgumentValueError(torque, "is 0 in all steps; a life needs a torque")
    elif load is not None and (np.any(load.torque != 0.0) or gives(varied, "torque")):
        end, moment = str(load.end), load.torque
    else:
        raise ArgumentValueError(
            "output_torque_Nm", "is missing here and in [load]; a life needs a torque"
        )
    torques: dict[str, Any] = {f"{end}_torque": np.broadcast_to(moment, shape)}
    inertias = None if load is None else load.inertias
    return Load(speed=np.broadcast_to(speed, shape), inertias=inertias, **torques)


def gives(varied: Container[str], what: Literal["speed", "torque"]) -> bool:
    """Return whether the keys of a study give speeds or torques."""
    keys = TORQUES if what == "torque" else ("speed_rpm", "speed_rad_s")
    return any(key in varied for si in keys for key in (si, *us_keys(si)))


def _in_states(
    names: Sequence[str], load: Load | None, states: States | None
) -> tuple[Driveline, Load | None]:
    """The driveline and the load in the states of these names, ``(1, steps)``."""
    if states is None:
        raise ArgumentValueError("states", "names states, but the scene has no section [states]")
    for i, name in enumerate(names):
        if name not in states.names:
            hint = nearest(name, list(states.names))
            raise ArgumentValueError("states", f"is {name!r}; {hint}", (i,))
    which = [[states.names.index(name) for name in names]]

    def picked(array: FloatArray, own: int) -> FloatArray:
        return np.asarray(array[which]) if array.ndim > own else array

    found = states.loads(load)
    return states.drivelines()[which], found and found.changed(picked)


def _bent(given: Sequence[Any], line: Driveline, layout: SceneLayout) -> Driveline:
    """The drivelines with the bends of each step, ``(places, steps)``."""
    if "bends_deg" not in layout.driveline:
        key = next(iter(layout.driveline))
        raise ArgumentValueError(
            "bends_deg", f"needs bends_deg in [driveline], which gives {key}; use states"
        )
    joints = line.n_joints
    bends = [entry if isinstance(entry, list) else [entry] * joints for entry in given]
    for i, row in enumerate(bends):
        check_count("bends_deg", row, joints, "one per joint", (i,))
    return Driveline.from_bends(np.radians([bends]), line.twists, line.phases)


def _life(values: Mapping[str, Any], scene: Reading) -> DutyCycle | None:
    """The duty cycle: that of [life], or the load as its only step if it turns and has a torque."""
    if not values and not scene[JOINTS].sizes and "tubes" not in scene.given:
        return None
    load, layout, states = scene.load, scene.layout, scene[STATES]
    varied = scene.given.get("study", {})
    if load is not None and np.ndim(load.speed + load.torque):
        layout = None
    lines = scene.line.reshape(-1, 1)
    if states and not stands(values):
        lines, load = states.drivelines().reshape(-1, 1), states.loads(load)
        load = load and load.at_any_angle()
    if not values and (
        load is None
        or layout is None
        or not (np.any(load.speed) or gives(varied, "speed"))
        or not (np.any(load.torque) or gives(varied, "torque"))
    ):
        return None
    return duty_cycle(values, lines, load, layout, states, varied)


LIFE: Section[DutyCycle | None] = Section(
    "life",
    "duty cycle of the driveline, for the life and the heat of its joints; each value is one for "
    "all steps or a list with one per step. Without it [load] is the only step",
    {
        "hours": Key(
            each(POSITIVE),
            "time of each step, in hours or any other unit: only the shares count; default: all "
            "alike",
        ),
        "speed_rpm": Key(each(POSITIVE), "speed of the drive; default: that of [load]"),
        "drive_torque_Nm": Key(each(Number()), "torque put into shaft 0; default: that of [load]"),
        "output_torque_Nm": Key(each(Number()), "or: torque delivered by the last shaft"),
        "bends_deg": Key(
            ListOf(each(BEND), "bends, one entry per step"),
            "bends in each step: of all joints, or a list with one per joint; needs bends_deg in "
            "[driveline]",
            kind="numbers",
        ),
        "states": Key(
            ListOf(Text(), "texts"),
            "or: the state of [states] in which the driveline is in each step",
        ),
        "names": Key(TEXTS, "name of each step; default: step 0 and so on"),
        "target_h": Key(POSITIVE, "life that 90 % of the joints must reach"),
    },
    _life,
    together=(TORQUES, ("bends_deg", "states")),
    fewest=1,
    always=True,
)

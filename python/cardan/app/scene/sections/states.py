"""The section [states]: positions in which the same driveline runs."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from cardan.app.scene.language.rules import TEXTS, ListOf, Number
from cardan.app.scene.language.section import Key, Section, check_count
from cardan.app.scene.sections.load import LOAD, check_not_recorded
from cardan.app.scene.sections.study import varied_keys
from cardan.app.scene.study.axes import Axis, Varied, axes_of
from cardan.app.scene.study.states import States
from cardan.arrays.errors import ArgumentValueError

if TYPE_CHECKING:
    from cardan.app.scene.reading import Reading

_OF_STATES = {
    "names": Key(TEXTS, "what each state is called; default: the value of the key, or state 0"),
    "weights": Key(
        ListOf(Number(0, what="a weight"), "numbers"),
        "how much each state counts when one setting must serve all; default 1",
    ),
}


def _states(values: Mapping[str, Any], scene: Reading) -> States:
    check_not_recorded(values, scene)
    layout = scene.layout
    assert layout
    varied: Varied = {key: value for key, value in values.items() if key not in _OF_STATES}
    if not varied:
        raise ValueError('no key varies; give one value per state, as in "points_mm.2.y" = [0, 40]')
    axes = axes_of(varied, layout.driveline, layout.load, "a state")
    first, count = axes[0], len(axes[0].values)
    for axis in axes[1:]:
        if len(axis.values) != count:
            raise axis.location.error(
                f"has {len(axis.values)} values and {first.key} {count}; each state needs one"
            )
    for key in _OF_STATES:
        check_count(key, values.get(key), count, "one per state")
    weights = np.array(values.get("weights", [1.0] * count))
    if not np.any(weights > 0.0):
        raise ArgumentValueError("weights", "has only zeros; at least one state must count")
    states = States(tuple(values.get("names") or _names(axes)), weights, axes, layout)
    states.drivelines()
    for i in range(count):
        states.load(i)
    return states


def _names(axes: tuple[Axis, ...]) -> list[str]:
    if len(axes) == 1 and len(set(axes[0].values)) == len(axes[0].values):
        return [f"{axes[0].key} = {value:.6g}" for value in axes[0].values]
    return [f"state {i}" for i in range(len(axes[0].values))]


STATES: Section[States | None] = Section(
    "states",
    "positions in which the same driveline runs, such as ride heights: one value per state "
    "for each key",
    {**_OF_STATES, **varied_keys("one value per state for")},
    _states,
    together=LOAD.together,
    fewest=1,
    paths=True,
    recorded_bends=False,
    help_on_paths="Give keys of [driveline] or [load] their values in each state, as in [study]; "
    "all lists have one entry per state. Paths may be in quotes.",
)
"""The section [states]."""

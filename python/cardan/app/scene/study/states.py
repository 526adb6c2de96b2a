"""States of a driveline, such as ride heights or tilts of a column: one value of a key in each."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from cardan.app.files.whole_file import Progress
from cardan.app.scene.language.errors import StudyPointError
from cardan.app.scene.language.units import si_key
from cardan.app.scene.sections.bearing import Mounting
from cardan.app.scene.sections.driveline import Form, make_driveline, points_of
from cardan.app.scene.sections.load import make_load
from cardan.app.scene.study.axes import Axis, axes_of, check_apart, put
from cardan.app.scene.study.study import Study, StudyResult
from cardan.arrays import FloatArray
from cardan.arrays.errors import ArgumentValueError
from cardan.driveline import Driveline
from cardan.evaluation.load import Load

STATE = "state"
"""The key of a table over states: the number of the state, counted from 0."""


@dataclass(frozen=True, eq=False)
class SceneLayout:
    """How a scene describes its driveline and its load: values by key as the file has them.

    Twists and phases that it leaves out are zeros.
    """

    form: Form
    driveline: Mapping[str, Any]
    load: Mapping[str, Any] | None
    mounting: Mounting

    def of(self, values: Mapping[str, Any]) -> Driveline:
        """Return the drivelines of values by key, each ``(count, entries, [3])``."""
        return self.mounting.on(make_driveline(self.form, values))

    def values(
        self,
        axes: Sequence[Axis] = (),
        count: int = 1,
        changes: Mapping[str, ArrayLike] | None = None,
    ) -> dict[str, FloatArray]:
        """Return values by key, each ``(count, entries, [3])``, with those of axes and changes.

        Changes are by path (``"points_mm.2.y"``, ``"phases_deg.0"``) in the unit of the key: one
        for all drivelines, or one each, ``(count,)``. The scene must use the path, and no axis may.
        """
        own = {axis.key for axis in axes}
        for path in changes or {}:
            if path in own:
                raise ArgumentValueError(path, "varies from state to state; it has no value to set")
            if si_key(path.partition(".")[0]) not in self.driveline:
                there = ", ".join(self.driveline)
                raise ArgumentValueError(path, f"is not in [driveline]; what can be set is {there}")
        given: dict[str, dict[str, list[float]]] = {}
        for path, column in (changes or {}).items():
            name, _, place = path.partition(".")
            whole = np.broadcast_to(np.asarray(column, dtype=np.float64), (count,))
            given.setdefault(name, {})[place] = whole.tolist()
        changed = axes_of(given, self.driveline, None, "a layout")
        varied = [*(axis for axis in axes if axis.section == "driveline"), *changed]
        check_apart(varied, self.driveline)
        values: dict[str, Any] = dict(self.driveline)
        for axis in sorted(varied, key=lambda axis: axis.turn):
            put(values, axis, axis.values)
        return {
            key: _rows(value, count, 2 if key.startswith(("points", "directions")) else 1)
            for key, value in values.items()
        }


def _rows(value: ArrayLike, count: int, core: int) -> FloatArray:
    """A list of the file, or what varies of it, ``(count, 1, …)``, as ``(count, …)``."""
    array = np.asarray(value, dtype=np.float64)
    rows = array if array.ndim == core else array[:, 0]
    return np.broadcast_to(rows, (count, *array.shape[-core:]))


@dataclass(frozen=True, eq=False)
class States:
    """The states that a scene's section [states] lists.

    Attributes:
        names: what each is called; ``"points_mm.2.y = -40"`` if one key varies and the scene names
            none, otherwise ``"state 0"``.
        weights: how much each counts, ``(count,)``; 1 unless the scene says otherwise.
        axes: the keys that vary, each with ``count`` values.
        layout: what the scene's other keys say.
    """

    names: tuple[str, ...]
    weights: FloatArray
    axes: tuple[Axis, ...]
    layout: SceneLayout

    @property
    def count(self) -> int:
        """Number of states."""
        return len(self.names)

    @property
    def set_phases(self) -> bool:
        """Whether the states set phases themselves, so that no one setting serves all."""
        return any(axis.name == "phases_deg" for axis in self.axes)

    @property
    def turned(self) -> set[tuple[str, int]]:
        """The points, by ``"point"`` and number, that states turn."""
        found = [axis for axis in self.axes if axis.rotation]
        return {
            ("point", entry)
            for axis in found
            for entry, _ in axis.entries(len(self.layout.driveline[axis.name]))
        }

    def drivelines(self, changes: Mapping[str, ArrayLike] | None = None) -> Driveline:
        """Return the driveline in every state: a batch ``(count,)`` in the order of ``names``.

        This is what a search for a better layout evaluates: it gives the keys that it varies new
        values, and the states keep theirs.

        Args:
            changes: values by path, as [study] and [states] name keys: ``"points_mm.2.y"``,
                ``"bends_deg.0"``, ``"phases_deg.0"``. They are in the unit of the key, one number
                for all states or an array ``(count,)``. A key that [driveline] does not give, such
                as ``phases_deg.0``, has its default and can be changed as well.

        Raises:
            ValueError: a path that the scene does not use, or that varies from state to state;
                values that make no driveline in one of the states, which the message names.
        """
        values = self.layout.values(self.axes, self.count, changes)
        try:
            return self.layout.of(values)
        except ArgumentValueError:
            # One by one, so that the message can name the state.
            for i in range(self.count):
                self._one(values, i)
            raise

    def driveline(self, state: int) -> Driveline:
        """Return the driveline in one state, without a batch axis."""
        return self._one(self.layout.values(self.axes, self.count), state)

    def points(self, state: int) -> FloatArray | None:
        """Return ends and joint centres in one state as the scene gives them, if it does."""
        values = self.layout.values(self.axes, self.count)
        return points_of({key: value[state] for key, value in values.items()})

    def load(self, state: int) -> Load | None:
        """Return the load in one state, if there is one."""
        return None if self.layout.load is None else make_load(self._loads(self.layout.load, state))

    def loads(self, load: Load | None) -> Load | None:
        """Return the load of all states, ``(count,)`` if they vary that of the scene."""
        if load is None or all(axis.section == "driveline" for axis in self.axes):
            return load
        each = [one for i in range(self.count) if (one := self.load(i))]

        def column(name: str) -> FloatArray:
            return np.stack([np.asarray(getattr(one, name)) for one in each])

        torque: dict[str, Any] = {f"{each[0].end}_torque": column("torque")}
        inertias = None if load.inertias is None else column("inertias")
        return Load(
            speed=column("speed"), acceleration=column("acceleration"), inertias=inertias, **torque
        )

    def study(self, of_one: Study, state: int) -> Study:
        """Return what a study without keys that vary computes of one state."""
        values = self.layout.values(self.axes, self.count)
        load = None if of_one.load is None else self._loads(of_one.load, state)
        driveline = {key: value[state] for key, value in values.items()}
        return replace(of_one, driveline=driveline, load=load)

    def _loads(self, load: Mapping[str, Any], state: int) -> dict[str, Any]:
        values: dict[str, Any] = dict(load)
        for axis in self.axes:
            if axis.section == "load" and axis.place is None:
                values[axis.name] = axis.size * float(axis.values[state])
            elif axis.section == "load":
                entries = np.array([values[axis.name]], dtype=np.float64)
                axis.change(entries, axis.values[[state]])
                values[axis.name] = entries[0]
        return values

    def _one(self, values: Mapping[str, FloatArray], state: int) -> Driveline:
        try:
            return self.layout.of({key: value[state] for key, value in values.items()})
        except ArgumentValueError as error:
            point = {axis.key: float(axis.values[state]) for axis in self.axes}
            section = "driveline" if error.argument in values else "bearing"
            what = (error.argument, error.problem, error.place, section, point)
            raise StudyPointError(*what, self.names[state]) from None


@dataclass(frozen=True, eq=False)
class StatesResult(StudyResult):
    """The figures of every state, as a study over the number of the state, counted from 0.

    Attributes:
        states: the states.
    """

    states: States

    def coordinates(self) -> dict[str, FloatArray]:
        """Return the number of each state and its values of the keys that vary."""
        return {**super().coordinates(), **{axis.key: axis.values for axis in self.states.axes}}

    def grid(self) -> dict[str, FloatArray]:
        """Return the same: all keys vary together, along one dimension."""
        return self.coordinates()


def states_result(states: States, of_one: Study, progress: Progress | None = None) -> StatesResult:
    """Evaluate a study without keys that vary in every state, and report progress after each."""
    results = []
    for state in range(states.count):
        results.append(states.study(of_one, state).run())
        if progress:
            progress(state + 1, states.count)
    columns = results[0].columns
    values = {
        column.name: np.array([float(each.values[column.name]) for each in results])
        for column in columns
    }
    axis = Axis(STATE, "states", STATE, None, None, np.arange(float(states.count)))
    return StatesResult((axis,), columns, values, states)

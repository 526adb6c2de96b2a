"""States of a driveline, such as ride heights or tilts of a column: one value of a key in each."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from cardan.app.files.whole_file import Progress
from cardan.app.scene.sections.driveline import points_of
from cardan.app.scene.sections.load import make_load
from cardan.app.scene.study.axes import Axis
from cardan.app.scene.study.study import SceneLayout, Study, StudyResult, Values
from cardan.arrays import FloatArray
from cardan.driveline import Driveline
from cardan.evaluation.load import Load

STATE = "state"
"""The key of a table over states: the number of the state, counted from 0."""


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
        axes = (*self.axes, *self.layout.changed(self.axes, self.count, changes))
        line, _ = self.layout.made(axes, [axis.values for axis in axes], self.names)
        return line.reshape(self.count)

    def driveline(self, state: int) -> Driveline:
        """Return the driveline in one state, without a batch axis."""
        return self.drivelines()[state]

    def points(self, state: int) -> FloatArray | None:
        """Return ends and joint centres in one state as the scene gives them, if it does."""
        values = self.layout.values(self.axes, self.count)
        return points_of({key: value[state] for key, value in values.items()})

    def load(self, state: int) -> Load | None:
        """Return the load in one state, if there is one."""
        _, values, _ = self._at(self.layout, state)
        varied = {axis.name for axis in self.axes}
        if values is None:
            return None
        return make_load({k: own[0, 0] if k in varied else own for k, own in values.items()})

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
        driveline, load, _ = self._at(of_one.layout, state)
        return replace(of_one, layout=replace(of_one.layout, driveline=driveline, load=load))

    def _at(self, layout: SceneLayout, state: int) -> Values:
        return layout.varied(self.axes, [axis.values[[state]] for axis in self.axes])


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
    found = replace(of_one, axes=states.axes, names=states.names).run(progress)
    axis = Axis(STATE, "states", STATE, None, None, np.arange(float(states.count)))
    return StatesResult((axis,), found.columns, found.values, states)

"""What a scene's keys say of its driveline, so that other values of them make other drivelines."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from cardan.app.scene.sections.bearing import Mounting
from cardan.app.scene.sections.driveline import Form
from cardan.app.scene.sections.parts import make_driveline
from cardan.app.scene.study.axes import Axis, axes_of, put
from cardan.arrays import FloatArray
from cardan.arrays.errors import ArgumentValueError
from cardan.driveline import Driveline


@dataclass(frozen=True, eq=False)
class SceneLayout:
    """How a scene describes its driveline.

    Attributes:
        form: in which form.
        driveline: values by key as the file has them, twists and phases that it leaves out as
            zeros.
        load: likewise those of its load; ``None`` without one.
        mounting: the bearings and the lengths of the shafts.
    """

    form: Form
    driveline: Mapping[str, Any]
    load: Mapping[str, Any] | None
    mounting: Mounting

    def drivelines(
        self,
        axes: Sequence[Axis] = (),
        count: int = 1,
        changes: Mapping[str, ArrayLike] | None = None,
    ) -> Driveline:
        """Return a batch of drivelines, ``(count,)``.

        Args:
            axes: keys with one value per driveline.
            count: the number of drivelines.
            changes: further values by path (``"points_mm.2.y"``, ``"phases_deg.0"``) in the unit
                of the key: one for all drivelines, or one each, ``(count,)``.

        Raises:
            ValueError: a path that the scene does not use or that varies among ``axes``, values
                that make no driveline.
        """
        return self.of(self.values(axes, count, changes))

    def of(self, values: Mapping[str, Any]) -> Driveline:
        """Return the drivelines of values by key, each ``(count, entries, [3])``."""
        return self.mounting.on(make_driveline(self.form, values))

    def values(
        self,
        axes: Sequence[Axis] = (),
        count: int = 1,
        changes: Mapping[str, ArrayLike] | None = None,
    ) -> dict[str, FloatArray]:
        """Return the values of ``drivelines`` by key, each ``(count, entries, [3])``."""
        own = {axis.key for axis in axes}
        for path in changes or {}:
            if path in own:
                raise ArgumentValueError(path, "varies from state to state; it has no value to set")
            if path.partition(".")[0] not in self.driveline:
                there = ", ".join(self.driveline)
                raise ArgumentValueError(path, f"is not in [driveline]; what can be set is {there}")
        columns = {axis.key: axis.values for axis in axes if axis.section == "driveline"}
        columns |= {
            path: np.broadcast_to(np.asarray(value, dtype=np.float64), (count,))
            for path, value in (changes or {}).items()
        }
        values: dict[str, Any] = dict(self.driveline)
        given: dict[str, dict[str, list[float]]] = {}
        for path, column in columns.items():
            name, _, place = path.partition(".")
            given.setdefault(name, {})[place] = list(column)
        for axis in axes_of(given, self.driveline, None, "a layout"):
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

"""Studies: a scene's keys varied over a grid, each of its drivelines a row of figures."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cardan.app.files.whole_file import Progress
from cardan.app.scene.language.errors import StudyPointError
from cardan.app.scene.language.units import converted, si_key, split
from cardan.app.scene.sections.bearing import BEARING, Mounting
from cardan.app.scene.sections.driveline import DRIVELINE, LENGTHS, Form, make_driveline
from cardan.app.scene.sections.load import LOAD, make_load
from cardan.app.scene.sections.output import CLOSED_FORMS, LENGTH
from cardan.app.scene.study.axes import Axis as Axis
from cardan.app.scene.study.axes import Varying, axes_of, check_apart, per_row, put, values_at
from cardan.arrays import FloatArray, import_optional
from cardan.arrays.errors import ArgumentValueError
from cardan.driveline import Driveline
from cardan.evaluation.load import Load
from cardan.evaluation.outputs import OUTPUTS
from cardan.evaluation.reductions import Reduction
from cardan.evaluation.sweep import Sweep

if TYPE_CHECKING:
    import xarray

# Doubles of one block: enough to hide the overhead of a call, few enough for any machine.
_BLOCK = 1 << 21


@dataclass(frozen=True, eq=False)
class Column:
    """One figure of every driveline of a study.

    Attributes:
        name: quantity, shaft or joint, component and reduction: ``moment_0_x_mean``.
        unit: SI unit; ``"1"`` for a ratio.
        quantity: an output or a closed form.
        per: ``"shaft"`` or ``"joint"``.
        item: of which.
        statistic: how the output is reduced; ``"value"`` for a closed form.
        component: of a vector: ``"x"``, ``"y"`` or ``"z"``; ``""`` for its length and for scalars.
    """

    name: str
    unit: str
    quantity: str
    per: Literal["shaft", "joint", "bearing"]
    item: int
    statistic: str
    component: str = ""


@dataclass(frozen=True, eq=False)
class StudyResult:
    """The table of a study, as a grid.

    Attributes:
        axes: the keys that vary; none for the figures of a single driveline.
        columns: what the figures are.
        values: the figures in SI units by the name of their column, each of ``shape``.
    """

    axes: tuple[Axis, ...]
    columns: tuple[Column, ...]
    values: Mapping[str, FloatArray]

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of values of each axis."""
        return tuple(len(axis.values) for axis in self.axes)

    @property
    def rows(self) -> int:
        """Number of drivelines."""
        return math.prod(self.shape)

    def coordinates(self) -> dict[str, FloatArray]:
        """Return the values of every axis over the grid, by key; views, nothing is copied."""
        grids = np.meshgrid(*(axis.values for axis in self.axes), indexing="ij", copy=False)
        return {axis.key: grid for axis, grid in zip(self.axes, grids, strict=True)}

    def grid(self) -> dict[str, FloatArray]:
        """Return the values of every axis, by key."""
        return {axis.key: axis.values for axis in self.axes}

    def figure(self, column: Column, *, radians: bool) -> tuple[str, FloatArray]:
        """Return the ending of a column's unit and its values, angles in the unit asked for."""
        return converted(self.values[column.name], column.unit, radians)

    def to_xarray(self) -> xarray.Dataset:
        """Return the figures as variables over the keys that are varied, with their units.

        Raises:
            ImportError: xarray is missing.
        """
        library = import_optional("xarray", "xarray")
        keys = tuple(axis.key for axis in self.axes)
        figures = {
            column.name: (keys, self.values[column.name], {"units": column.unit})
            for column in self.columns
        }
        made: xarray.Dataset = library.Dataset(figures, {a.key: a.values for a in self.axes})
        return made


@dataclass(frozen=True, eq=False)
class StudyPart:
    """Some rows of the table of a study; the figures are ``(rows,)``, in SI units."""

    axes: tuple[Axis, ...]
    rows: range
    columns: tuple[Column, ...]
    values: Mapping[str, FloatArray]

    def coordinates(self) -> dict[str, FloatArray]:
        """Return the values of every axis at these rows, by key."""
        keys = (axis.key for axis in self.axes)
        return dict(zip(keys, values_at(self.axes, self.rows), strict=True))


Values: TypeAlias = tuple[dict[str, Any], dict[str, Any] | None, Mounting]
"""Values of driveline and load by key, and the mounting."""


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

    def _is_mounted(self, axis: Axis) -> bool:
        """Whether an axis places bearings or gives lengths that the layout does not need."""
        lengths = axis.name in LENGTHS and axis.name not in self.driveline
        return lengths or axis.section == "bearing"

    def varied(self, axes: Sequence[Axis], columns: Sequence[FloatArray]) -> Values:
        """Return the values of driveline and load by key, and the mounting, with those of axes.

        The columns have one value per row. What varies is ``(rows, 1, …)``, all else as it was.
        """
        driveline, mounting = dict(self.driveline), self.mounting
        load = None if self.load is None else dict(self.load)
        for axis, column in sorted(zip(axes, columns, strict=True), key=lambda each: each[0].turn):
            if self._is_mounted(axis):
                mounting = mounting.varied(axis, column)
            else:
                values = driveline if axis.section == "driveline" else load
                assert values is not None
                put(values, axis, column)
        return driveline, load, mounting

    def made(
        self,
        axes: Sequence[Axis],
        columns: Sequence[FloatArray],
        names: Sequence[str] = (),
        check: Callable[[Driveline], object] = bool,
    ) -> tuple[Driveline, Load | None]:
        """Return the drivelines and loads of values of axes, one per row: ``(rows, 1)``.

        Without axes there is one row. An error, which ``check`` may raise too, is about the first
        row that is wrong, and has its values and its name.
        """
        rows = len(columns[0]) if axes else 1
        try:
            driveline, load, mounting = self.varied(axes, columns)
            if not axes:
                driveline = {key: _one_row(key, entries) for key, entries in driveline.items()}
            elif all(axis.section != "driveline" or self._is_mounted(axis) for axis in axes):
                key = self.form.keys[0]
                driveline[key] = per_row(driveline[key], rows)
            line = mounting.on(make_driveline(self.form, driveline))
            check(line)
            return line, None if load is None else make_load(load)
        except ArgumentValueError as error:
            for part in (slice(rows // 2), slice(rows // 2, None)) if rows > 1 else ():
                self.made(axes, [column[part] for column in columns], names[part], check)
            if rows > 1:
                raise
            # The first two places count rows of the block, which the reader has not seen.
            place = error.place[2:] if error.place[:2] == (0, 0) else error.place
            if not axes:
                raise ArgumentValueError(error.argument, error.problem, place) from None
            point = {axis.key: float(own[0]) for axis, own in zip(axes, columns, strict=True)}
            owners = (own.name for own in (DRIVELINE, BEARING) if error.argument in own.keys)
            what = (error.argument, error.problem, place, next(owners, LOAD.name), point)
            raise StudyPointError(*what, *names) from None

    def values(
        self,
        axes: Sequence[Axis] = (),
        count: int = 1,
        changes: Mapping[str, ArrayLike] | None = None,
    ) -> dict[str, FloatArray]:
        """Return values by key, each ``(count, entries, [3])``, with those of axes and changes."""
        varied = [axis for axis in axes if axis.section == "driveline"]
        varied += self.changed(axes, count, changes)
        driveline, _, _ = self.varied(varied, [axis.values for axis in varied])
        return {key: _rows(key, value, count) for key, value in driveline.items()}

    def changed(
        self, axes: Sequence[Axis], count: int, changes: Mapping[str, ArrayLike] | None
    ) -> tuple[Axis, ...]:
        """Return the axes of changes, which none of some others may vary.

        Changes are by path (``"points_mm.2.y"``, ``"phases_deg.0"``) in the unit of the key: one
        for all drivelines, or one each, ``(count,)``. The scene must use the path.
        """
        given: dict[str, dict[str, Varying]] = {}
        for path, column in (changes or {}).items():
            if any(axis.key == path for axis in axes):
                raise ArgumentValueError(path, "varies from state to state; it has no value to set")
            name, _, place = path.partition(".")
            if si_key(name) not in self.driveline:
                there = ", ".join(self.driveline)
                raise ArgumentValueError(path, f"is not in [driveline]; what can be set is {there}")
            whole = np.broadcast_to(np.asarray(column, dtype=np.float64), (count,))
            given.setdefault(name, {})[place] = Varying(whole.tolist())
        found = axes_of(given, self.driveline, None, "a layout")
        check_apart((*axes, *found), {**self.driveline, **(self.load or {})})
        return found


def _core(key: str) -> int:
    """The dimensions of the values of a key: 2 of vectors."""
    return 2 if DRIVELINE.keys[key].kind == "vectors" else 1


def _rows(key: str, value: ArrayLike, count: int) -> FloatArray:
    """A list of the file, or what varies of it, ``(count, 1, …)``, as ``(count, …)``."""
    array, core = np.asarray(value, dtype=np.float64), _core(key)
    rows = array if array.ndim == core else array[:, 0]
    return np.broadcast_to(rows, (count, *array.shape[-core:]))


def _one_row(key: str, value: ArrayLike) -> FloatArray:
    """A list of the file as a batch of one; recorded bends have their samples already."""
    array = np.asarray(value, dtype=np.float64)
    return array.reshape((1,) * (_core(key) + 2 - array.ndim) + array.shape)


@dataclass(frozen=True, eq=False)
class Study:
    """Axes that a scene varies, and the figures it wants of each driveline.

    The axes make a grid or, with names, vary together from state to state. ``layout`` and
    ``load`` hold the values that the file states. ``angle`` holds the drive angles of the
    reductions in rad. Without ``shafts`` a study concerns the last shaft, and its columns have no
    shaft number. All drivelines share ``deviations``, ``(n, 3)`` in rad; closed forms are those
    of ideal joints.
    """

    axes: tuple[Axis, ...]
    layout: SceneLayout
    angle: FloatArray | Sweep
    quantities: tuple[str, ...]
    reductions: tuple[Reduction, ...]
    closed_forms: tuple[str, ...]
    shafts: tuple[int, ...] | None
    joints: tuple[int, ...]
    options: Mapping[str, Any]
    deviations: FloatArray | None = None
    names: tuple[str, ...] = ()

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of values of each axis, or of the states."""
        return (len(self.names),) if self.names else tuple(len(axis.values) for axis in self.axes)

    @property
    def planes(self) -> int:
        """Numbers that the quantities take for one drive angle of one driveline."""
        items = {
            "shaft": len(self.shafts or [-1]),
            "joint": len(self.joints),
            "bearing": len(self.layout.mounting.bearings),
        }
        outputs = (OUTPUTS[name] for name in self.quantities)
        return sum(items[output.per] * output.components for output in outputs)

    def run(self, progress: Progress | None = None) -> StudyResult:
        """Evaluate the grid block by block: memory is that of the table and a block."""
        part = self.part(range(math.prod(self.shape)), progress)
        values = {name: figures.reshape(self.shape) for name, figures in part.values.items()}
        return StudyResult(self.axes, part.columns, values)

    def part(self, rows: range, progress: Progress | None = None) -> StudyPart:
        """Evaluate some rows of the grid as ``run`` does all of them, to the same bits."""
        columns: dict[str, Column] = {}
        table: dict[str, FloatArray] = {}
        for first, line, load in self.blocks(rows):
            done = first - rows.start
            for column, figures in self._figures(line, load):
                if column.name not in table:
                    columns[column.name] = column
                    table[column.name] = np.empty(len(rows))
                table[column.name][done : done + len(figures)] = figures
            if progress:
                progress(done + line.shape[0], len(rows))
        return StudyPart(self.axes, rows, tuple(columns.values()), table)

    def explain(self) -> str:
        """Describe how the study is evaluated: what needs no samples, and the plan of a block."""
        _, line, load = next(self.blocks())
        rows, block = math.prod(self.shape), line.shape[0]
        text = f"study of {rows} driveline{'s' if rows > 1 else ''}"
        text += f" in blocks of {block}" if block < rows else ""
        if self.closed_forms:
            text += f"\nclosed forms, without samples: {', '.join(self.closed_forms)}"
        if self.quantities:
            first, *others = self.reductions
            how = self._how(line, load)
            if self.shafts is None:
                how["shafts"] = None
            plan = self._as_built(line).plan(self.quantities, reduce=first, **how)
            likewise = f", likewise {', '.join(others)}" if others else ""
            text += f"\n{first} over {len(self.angle)} drive angles{likewise}:\n"
            text += plan.explain(self.angle)
        return text

    def check_ends(self) -> None:
        """Refuse a study with values out of range at either end of an axis."""
        rows = {0}
        for number, axis in enumerate(self.axes):
            # The others are at their first value.
            step = math.prod(self.shape[number + 1 :])
            rows |= {int(end(axis.values)) * step for end in (np.argmax, np.argmin)}
        for row in sorted(rows):
            self._block(np.array([row]))

    def blocks(self, rows: range | None = None) -> Iterator[tuple[int, Driveline, Load | None]]:
        """Yield first row, ideal drivelines ``(rows, 1)`` and load of each block."""
        rows = range(math.prod(self.shape)) if rows is None else rows
        # The geometry of one joint takes some 30 doubles itself, several times over.
        geometry = 64 * len(self.layout.driveline[self.layout.form.keys[0]])
        block = max(1, _BLOCK // max(geometry, self.planes * len(self.angle)))
        if self.names:
            # The steepest driveline of a block determines how its other ones are computed.
            block = 1
        for first in rows[::block]:
            yield first, *self._block(np.arange(first, min(first + block, rows.stop)))

    def _block(self, rows: NDArray[np.int_]) -> tuple[Driveline, Load | None]:
        """The drivelines and loads of some rows of the grid."""
        if not self.names:
            columns = values_at(self.axes, rows)
            return self.layout.made(self.axes, columns, check=self._as_built)
        names = [self.names[row] for row in rows]
        columns = [axis.values[rows] for axis in self.axes]
        return self.layout.made(self.axes, columns, names, self._as_built)

    def _as_built(self, line: Driveline) -> Driveline:
        """Drivelines with the deviations of their joints, which must be able to turn with them."""
        if self.deviations is None:
            return line
        try:
            return line.with_deviations(*self.deviations.T)
        except ArgumentValueError as error:
            problem = f"and the deviations in [joints] {error.problem}"
            raise ArgumentValueError(self.layout.form.keys[0], problem) from None

    def _how(self, line: Driveline, load: Load | None) -> dict[str, Any]:
        shafts = [line.n_joints] if self.shafts is None else list(self.shafts)
        return {"load": load, "shafts": shafts, "joints": list(self.joints), **self.options}

    def _figures(self, line: Driveline, load: Load | None) -> Iterator[tuple[Column, FloatArray]]:
        how = self._how(line, load)
        shafts = how["shafts"]
        equivalent = [line.equivalent(shaft) for shaft in shafts if self.closed_forms]
        for name in self.closed_forms:
            field, unit = CLOSED_FORMS[name]
            scale = 1.0
            if name == LENGTH:
                # Drivelines of scenes have lengths in metres.
                unit = split(self.layout.form.keys[0])[1]
                scale = 1e3 if unit == "mm" else 1.0
            for shaft, joint in zip(shafts, equivalent, strict=True):
                number = "" if self.shafts is None else f"_{shaft}"
                column = Column(f"{name}{number}", unit, name, "shaft", shaft, "value")
                own = line.lengths().each[..., shaft] if name == LENGTH else getattr(joint, field)
                yield column, scale * own[:, 0]
        if not self.quantities:
            return
        items = {"shaft": shafts, "joint": how["joints"], "bearing": range(line.n_bearings)}
        as_built = self._as_built(line)
        found = {
            reduction: as_built.evaluate(self.angle, self.quantities, reduce=reduction, **how)
            for reduction in self.reductions
        }
        for name, reduction in itertools.product(self.quantities, self.reductions):
            output = OUTPUTS[name]
            for item, figures in zip(items[output.per], found[reduction][name], strict=True):
                number = "" if output.per == "shaft" and self.shafts is None else f"_{item}"
                what = (output.unit, name, output.per, item, reduction)
                if output.vector and reduction != "peak":
                    for i, axis in enumerate("xyz"):
                        column = Column(f"{name}{number}_{axis}_{reduction}", *what, axis)
                        yield column, figures[:, i]
                else:
                    yield Column(f"{name}{number}_{reduction}", *what), figures

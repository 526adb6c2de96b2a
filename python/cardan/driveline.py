"""Drivelines: joints and shafts in space, one or a batch."""

from __future__ import annotations

import inspect
import sys
from collections.abc import Iterator
from typing import Any

import numpy as np

from cardan import _core
from cardan.arrays import FloatArray, html_table
from cardan.arrays.libraries import draw
from cardan.design.check import catalogue_bend, check, fork_signs
from cardan.evaluation.evaluate import evaluate, harmonics, plan
from cardan.geometry import constructors, geometry
from cardan.geometry.as_built import with_deviations, with_play
from cardan.geometry.geometry import Geometry
from cardan.geometry.wound_up import wound_up
from cardan.motion.equivalent import equivalent, steering, transmission
from cardan.motion.free_running import free_running
from cardan.motion.phases import arrangement, bend_ranges, optimal_phases
from cardan.tolerances.order_tolerances import order_tolerances
from cardan.tolerances.request import tolerances
from cardan.wear.axial_travel import slides
from cardan.wear.backlash import lash, wind_up
from cardan.wear.life import life
from cardan.wear.losses import losses
from cardan.wear.spline import lengths, spline_force

# Angles of one driveline in its ``repr``.
_MOST_SHOWN = 8


class Driveline:
    """Shafts joined by universal joints, or a batch of drivelines with as many joints each.

    A driveline of ``n`` joints has ``n + 1`` shafts, both counted from 0; shaft 0 drives. Angles
    are in radians and quantities in SI units, unless a name or keyword says otherwise. Make one
    with a constructor, ``from_bends`` and others; leading dimensions are the batch. Drivelines are
    immutable: their arrays are read-only, and ``with_phases`` makes a new one. Methods, and those
    of their results, refuse values that are not real numbers and indices that are not integers with
    a ``TypeError``, and shafts and joints that do not exist with an ``IndexError``.
    ``cardan.OUTPUTS`` lists what ``evaluate`` computes, ``cardan.Load`` and ``cardan.Sweep`` are
    what it takes besides angles, and ``cardan.optimise`` searches the best layout. Of dask arrays,
    all constructors but ``from_readings`` and ``from_double_joint`` make a
    ``cardan.interop.lazy.LazyDriveline``, which is evaluated in pieces and anywhere.

    Let ``u_i`` be the unit vector along shaft ``i`` in the direction of power flow. The bend of
    joint ``j`` is the angle between ``u_j`` and ``u_{j+1}``, its bend-plane normal ``m_j = unit(u_j
    x u_{j+1})``. The twist of an intermediate shaft is the angle about it from one normal to the
    next. Its phase is the angle from its input-side to its output-side pin; phase 0 means both
    yokes in one plane. The drive angle counts from the driving pin of joint 0 lying in the plane of
    shafts 0 and 1. All rotations are right-handed about ``u_i``: clockwise, looking from the drive
    towards the output.

    >>> import cardan
    >>> line = cardan.Driveline.from_bends([10, 20], phases=90, degrees=True)
    >>> line.evaluate([0.0, 0.5], "speed_ratio").speed_ratio.round(6)
    array([1.080594, 1.040492])
    """

    __slots__ = ("_geometry", "_lines", "_n_joints", "_plans", "_shape")
    _geometry: Geometry
    _lines: _core.Lines
    _n_joints: int
    _plans: dict[Any, Any]  # remembered by ``evaluate``, by its arguments
    _shape: tuple[int, ...]

    def __init__(self, *_: object, **__: object) -> None:
        """Refuse: a driveline is made from bends, points, directions or slopes."""
        raise TypeError("use Driveline.from_bends, from_points, from_directions or from_slopes")

    @classmethod
    def _of(cls, own: Geometry) -> Driveline:
        self = object.__new__(cls)
        self._geometry = own
        self._n_joints, self._shape = own.n_joints, own.shape
        for array in own.arrays:
            array.flags.writeable = False
        self._lines = _core.Lines(self._n_joints, self._shape, own.flat(), own.bearings)
        self._plans = {}
        return self

    def _twin(self) -> Driveline:
        """Return the same drivelines as another object, which remembers no plans."""
        twin = object.__new__(type(self))
        for name in Driveline.__slots__:
            setattr(twin, name, getattr(self, name))
        twin._plans = {}
        return twin

    # Functions of their rooms.
    from_bends = classmethod(constructors.from_bends)
    from_directions = classmethod(constructors.from_directions)
    from_points = classmethod(constructors.from_points)
    from_slopes = classmethod(constructors.from_slopes)
    from_projected_bends = classmethod(constructors.from_projected_bends)
    from_readings = classmethod(constructors.from_readings)
    from_double_joint = classmethod(constructors.from_double_joint)
    concatenate = classmethod(geometry.concatenate)

    with_phases = geometry.with_phases
    with_bearings = geometry.with_bearings
    with_deviations = with_deviations
    with_play = with_play
    wound_up = wound_up
    reversed = geometry.reversed

    evaluate = evaluate
    plan = plan
    harmonics = harmonics

    equivalent = equivalent
    transmission = transmission
    optimal_phases = optimal_phases
    arrangement = arrangement
    bend_ranges = bend_ranges
    steering = steering
    free_running = free_running

    check = check
    catalogue_bend = catalogue_bend
    fork_signs = fork_signs
    tolerances = tolerances
    order_tolerances = order_tolerances

    losses = losses
    life = life
    lengths = lengths
    spline_force = spline_force
    slides = slides
    lash = lash
    wind_up = wind_up

    reshape = geometry.reshape
    approx_equal = geometry.approx_equal
    __getitem__ = geometry.taken

    def plot(self, angle: float = 0.0, **options: Any) -> Any:  # noqa: ANN401 - of matplotlib
        """Draw the driveline in space, as ``cardan.plots.plot_driveline`` does.

        Args:
            angle: drive angle in rad.
            options: as there: ``points``, ``length_unit`` and ``ax``.

        Raises:
            ImportError: matplotlib is missing.
            ValueError: a batch, and as there.
        """
        return draw("plot_driveline", self, angle, **options)

    def __iter__(self) -> Iterator[Driveline]:
        """Iterate over the batch's first axis."""
        return map(self.__getitem__, range(len(self)))

    def __len__(self) -> int:
        """Return the length of the batch's first axis; a ``TypeError`` for a single driveline."""
        if not self._shape:
            raise TypeError("a single driveline has no length; n_joints is its number of joints")
        return self._shape[0]

    def __bool__(self) -> bool:
        """Return whether there is a driveline: only an empty batch is false."""
        return self.size > 0

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle as the arrays, with what else the geometry knows."""
        own = self._geometry
        return (geometry.unpickled, (type(self), (own.bearings, own.has_points), *own.arrays))

    def __copy__(self) -> Driveline:
        """Return the driveline itself: it never changes."""
        return self

    def __deepcopy__(self, memo: object) -> Driveline:
        """Return the driveline itself: it never changes."""
        return self

    def __repr__(self) -> str:
        """Show number of joints and angles, or the shape of a batch."""
        joints = f"{self.n_joints} joint{'s' if self.n_joints > 1 else ''}"
        if self.shape:
            return f"<Driveline batch {self.shape} of {joints}>"
        angles = {"bends": self.bends_deg, "twists": self.twists_deg, "phases": self.phases_deg}
        each = (f"{name} {_listed(values)} deg" for name, values in angles.items() if values.size)
        return f"<Driveline of {joints}: {', '.join(each)}>"

    def _repr_html_(self) -> str:
        """Show the angles of one driveline, or the ranges of a batch, as a table."""
        return html_table.driveline(repr(self), self.bends_deg, self.twists_deg, self.phases_deg)

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the batch; ``()`` for one driveline."""
        return self._shape

    @property
    def ndim(self) -> int:
        """Number of dimensions of the batch; 0 for one driveline."""
        return len(self._shape)

    @property
    def size(self) -> int:
        """Number of drivelines; 1 for one driveline."""
        return int(np.prod(self._shape))

    @property
    def n_joints(self) -> int:
        """Number of joints of each driveline, ``n``."""
        return self._n_joints

    @property
    def bends(self) -> FloatArray:
        """Bend of each joint in rad, ``(..., n)``."""
        return self._geometry.bends

    @property
    def bends_deg(self) -> FloatArray:
        """Bend of each joint in degrees, ``(..., n)``."""
        return np.degrees(self._geometry.bends)

    @property
    def twists(self) -> FloatArray:
        """Twist of each intermediate shaft in rad, ``(..., n - 1)``."""
        return self._geometry.twists

    @property
    def twists_deg(self) -> FloatArray:
        """Twist of each intermediate shaft in degrees, ``(..., n - 1)``."""
        return np.degrees(self._geometry.twists)

    @property
    def phases(self) -> FloatArray:
        """Phase of each intermediate shaft in rad, ``(..., n - 1)``."""
        return self._geometry.phases

    @property
    def phases_deg(self) -> FloatArray:
        """Phase of each intermediate shaft in degrees, ``(..., n - 1)``."""
        return np.degrees(self._geometry.phases)

    @property
    def has_points(self) -> bool:
        """Whether derivatives with respect to points exist.

        They do for drivelines from points, unless ``with_bearings`` gave them other lengths.
        """
        return self._geometry.has_points

    @property
    def directions(self) -> FloatArray:
        """Unit vector along each shaft, ``(..., n + 1, 3)``."""
        return self._geometry.directions

    @property
    def normals(self) -> FloatArray:
        """Unit normal of each joint's bend plane, ``(..., n, 3)``."""
        return self._geometry.normals

    @property
    def n_bearings(self) -> int:
        """Number of bearings of each driveline."""
        return len(self._geometry.bearings)

    @property
    def bearings(self) -> tuple[tuple[int, FloatArray], ...]:
        """Shaft and position of each bearing; positions have the shape of the batch."""
        positions = np.moveaxis(self._geometry.positions, -1, 0)
        return tuple(zip(self._geometry.bearings, positions, strict=True))

    @property
    def deviations(self) -> FloatArray:
        """Deviations of driving yoke, cross and driven yoke in rad, ``(..., n, 3)``."""
        own = self._geometry
        return own.deviations if own.is_as_built else np.zeros((*own.bends.shape, 3))

    @property
    def deviations_deg(self) -> FloatArray:
        """The same in degrees."""
        return np.degrees(self.deviations)

    @property
    def has_deviations(self) -> bool:
        """Whether the joints deviate, so that the driveline is computed joint by joint."""
        return self._geometry.is_as_built


def _listed(values: FloatArray) -> str:
    """All values, or of many the first and the last."""
    shown = [f"{value:.6g}" for value in values]
    return " ".join(shown if len(shown) <= _MOST_SHOWN else [*shown[:3], "...", shown[-1]])


def _overview() -> str:
    """The methods by room and the attributes, a line each: what ``help`` shows first."""
    groups: dict[str, list[str]] = {}
    for name, member in vars(Driveline).items():
        own: Any = getattr(member, "__func__", getattr(member, "fget", member))
        if not name.startswith("_") and callable(own):
            room = sys.modules[own.__module__.rpartition(".")[0]]
            title = "Pictures and attributes." if room.__name__ == "cardan" else _first_line(room)
            groups.setdefault(title, []).append(f"    {name:<20}  {_first_line(own)}")
    return "\n\n".join("\n".join((title[:-1] + ":", *lines)) for title, lines in groups.items())


def _first_line(documented: object) -> str:
    return (documented.__doc__ or "").partition("\n")[0]


Driveline.__doc__ = f"{inspect.cleandoc(Driveline.__doc__ or '')}\n\n{_overview()}"

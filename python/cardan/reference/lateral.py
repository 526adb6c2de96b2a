"""Lateral vibration again: beam elements, vectors, and one dense system of equations per order.

Each shaft that is no part of a machine moves across its drawn axis: its unknowns are displacements
``w`` and slopes at nodes, as components in a pair of directions across it. A rigid shaft has one
node, its upstream end. Elements of an Euler-Bernoulli tube are polynomials of degree 5 through the
displacements and slopes of three nodes; those of a Timoshenko tube are of degree 4 through five
nodes, for displacement and slope each. Both converge with the eighth power of the step. An element
ends wherever something is attached. What is attached reads its displacement and slope as vectors,
so that each term of the equations is a work: ``k w . dw``, ``m w'' . dw`` and so on. Joint forces
are unknowns beside the displacements, one for each condition that keeps two ends together.

Excitations are the moments of ideal joints at the drawn bends, by :func:`cardan.reference.loads`,
and unbalances. A quantity is ``Re sum x_k exp(i k angle)`` over the orders ``k`` with the drive
angle, which is 0 when the driving pin of joint 0 lies in the plane of shafts 0 and 1.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import pairwise
from typing import Any, TypeAlias

import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import NDArray

from cardan.arrays.errors import ArgumentValueError, require
from cardan.reference.forces import loads
from cardan.reference.vectors import (
    Shafts,
    Vector,
    _across,
    _cross,
    _dot,
    _joints,
    _plus,
    _scaled,
    _unit,
    enough,
    from_directions,
)

Array: TypeAlias = NDArray[np.floating[Any]]
Complex: TypeAlias = NDArray[np.complexfloating[Any, Any]]

Load: TypeAlias = Mapping[str, Any] | Callable[[float], Sequence[float]]
"""Options of ``reference.loads`` without the speed, or the torque that each joint takes from its
driving shaft as a function of the drive angle [N m]."""


@dataclass(frozen=True)
class RigidShaft:
    """A shaft that does not bend, with the attributes of ``cardan.RigidShaft``."""

    mass: float
    centre: float
    across: float
    along: float = 0.0


@dataclass(frozen=True)
class Tube:
    """A shaft of round section that bends.

    Attributes:
        outer_diameter: in m.
        wall: thickness of the wall [m].
        shear_coefficient: of Timoshenko's theory, with rotary inertia and gyroscopic terms; without
            it the tube follows Euler and Bernoulli and has none of these.
        elastic_modulus: in Pa.
        shear_modulus: in Pa.
        density: in kg/m³.
        loss_factor: of both moduli, for orders from 2 on.
    """

    outer_diameter: float
    wall: float
    shear_coefficient: float | None = None
    elastic_modulus: float = 2.06e11
    shear_modulus: float = 7.93e10
    density: float = 7850.0
    loss_factor: float = 0.0

    @property
    def area(self) -> float:
        """Area of the section [m²]."""
        return math.pi * self.wall * (self.outer_diameter - self.wall)

    @property
    def second_moment(self) -> float:
        """Second moment of area about an axis across the tube [m⁴]."""
        inner = self.outer_diameter - 2.0 * self.wall
        return self.area * (self.outer_diameter**2 + inner**2) / 16.0


@dataclass(frozen=True)
class ElasticBearing:
    """A bearing of stiffness ``k (1 + i loss_factor sign(w)) + i w damping`` at ``w`` in rad/s.

    Attributes are as of ``cardan.ElasticBearing``, the stiffness always of two directions.
    """

    shaft: int
    position: float
    stiffness: tuple[float, float]
    axis: Sequence[float] | None = None
    loss_factor: float | Sequence[float] = 0.0
    damping: float | Sequence[float] = 0.0


@dataclass(frozen=True)
class PointMass:
    """A yoke, flange or disc on a shaft, with the attributes of ``cardan.PointMass``."""

    shaft: int
    position: float
    mass: float
    across: float = 0.0
    along: float = 0.0


@dataclass(frozen=True)
class Unbalance:
    """A force that turns with the drive, with the attributes of ``cardan.Unbalance``."""

    shaft: int
    position: float
    mass_arm: float
    direction: Sequence[float]


@dataclass(frozen=True)
class Response:
    """Response of a system, with the attributes of ``cardan.lateral.LateralResponse``."""

    orders: tuple[float, ...]
    bearing_force: Complex
    bearing_displacement: Complex
    joint_force: Complex
    joint_displacement: Complex
    displacement: Complex
    bearing_power: Array
    tube_power: Array
    given_power: Array


@dataclass(frozen=True)
class TorqueStiffness:
    """How the moments of the joints change where a steady torque displaces points of the driveline.

    Points and attributes are as of ``cardan.lateral.TorqueStiffness``, of one system.
    """

    mean: Array
    turning: Complex

    @property
    def kappa(self) -> float:
        """Size of ``kappa`` in ``kappa exp(2 i angle) conj(z)``, of one point; else the largest."""
        return float(np.linalg.norm(self.turning, 2)) / 2.0 if self.turning.size else 0.0


@dataclass(frozen=True)
class System:
    """A driveline on elastic bearings, with the attributes of ``cardan.LateralSystem``.

    ``lengths`` are given [m], and elements are no longer than ``step`` [m].

    Raises:
        ValueError: a position beyond its shaft; a joint between two machines; a sliding shaft that
            is none of its joint; two stiffnesses without an axis.
    """

    line: Shafts
    lengths: Sequence[float]
    shafts: Sequence[RigidShaft | Tube | None]
    bearings: Sequence[ElasticBearing] = ()
    masses: Sequence[PointMass] = ()
    unbalance: Sequence[Unbalance] = ()
    sliding: Sequence[int] | None = None
    step: float = 0.2
    slides: tuple[int, ...] = field(init=False)
    """``sliding`` with the default filled in."""

    def __post_init__(self) -> None:
        """Check what the system consists of."""
        count = len(self.line.directions)
        for name in ("lengths", "shafts"):
            if len(getattr(self, name)) != count:
                raise ArgumentValueError(name, f"must have one value for each of {count} shafts")
        for name in ("bearings", "masses", "unbalance"):
            for i, item in enumerate(getattr(self, name)):
                require(name, 0 <= item.shaft < count, f"has shaft {item.shaft} of {count}", (i,))
                self.place(item.shaft, item.position)
        for i, bearing in enumerate(self.bearings):
            pairs = (bearing.stiffness, _pair(bearing.loss_factor), _pair(bearing.damping))
            if bearing.axis is None and any(first != second for first, second in pairs):
                raise ArgumentValueError("bearings", "needs an axis for two directions", (i,))
        for j, pair in enumerate(pairwise(self.shafts)):
            if pair == (None, None):
                raise ValueError(f"joint {j} joins two machines that do not move")
        for j, shaft in enumerate(self.sliding or ()):
            require("sliding", shaft in (j, j + 1), f"is shaft {shaft}, not one of joint {j}", (j,))
        object.__setattr__(self, "slides", tuple(self.sliding or _slides(self)))

    def place(self, shaft: int, position: float) -> tuple[int, float]:
        """Return a place on a shaft; what only rounding separates from an end is at that end."""
        length = self.lengths[shaft]
        for end in (0.0, length):
            if abs(position - end) <= 1e-9 * length:
                return shaft, end
        problem = f"is {position}; shaft {shaft} is {length} m long"
        require("position", 0.0 < position < length, problem)
        return shaft, position

    def natural_frequencies(self, count: int = 6) -> Array:
        """Return the lowest natural frequencies in rad/s, at rest and without damping.

        There are fewer than ``count`` if the system has fewer unknowns.

        Raises:
            ValueError: a shaft that is not held.
        """
        model = _Model(self)
        mass, flexible = model.free.T @ model.mass @ model.free, np.linalg.inv(model.root)
        # The largest 1/w**2 are the most accurate ones, also where some unknowns have no mass.
        squares = np.linalg.eigvalsh(flexible @ mass @ flexible.T)[::-1][:count]
        return np.asarray(1.0 / np.sqrt(squares))

    def response(
        self,
        speed: float | Sequence[float] | Array,
        load: Load,
        orders: Sequence[float] = (1, 2, 4),
        probes: Sequence[tuple[int, float]] = (),
        turns: int = 1,
    ) -> Response:
        """Return the vibration at steady speeds.

        Arguments are as of ``LateralSystem.response``, and the turns of the drive after which a
        load that is a function repeats.

        Errors: those of rounding for rigid shafts. For tubes of 0.08 m and frequencies up to the
        third bending mode, 3e-8 with a step of 0.2 m and 3e-9 with one of 0.1 m; shorter steps lose
        by rounding.

        Raises:
            ValueError: a shaft that is not held; a probe beyond its shaft.
        """
        model = _Model(self, probes)
        speeds = np.asarray(speed, dtype=np.float64)
        solved = [
            model.solved(omega, order, couple)
            for omega in speeds.ravel().tolist()
            for order, couple in zip(orders, self._couples(omega, load, orders, turns), strict=True)
        ]
        shape = (*speeds.shape, len(orders))
        arrays = {}
        for name in solved[0]:
            flat = np.array([one[name] for one in solved])
            own = flat.reshape(*shape, *flat.shape[1:])
            each = name not in ("tube_power", "given_power")
            arrays[name] = np.moveaxis(own, len(shape), 0) if each else own
        return Response(tuple(orders), **arrays)

    def torque_stiffness(self, torque: float) -> TorqueStiffness:
        """Return how a drive torque in N m acts like a stiffness.

        Points of the driveline are displaced by a millionth of the shortest shaft, with straight
        shafts between them, also where these are tubes.

        Errors: 1e-9 of ``torque / length**2``.
        """
        rows, points = self._points()
        small = 1e-6 * min(self.lengths)
        count = _samples(self.line)
        angles = 2.0 * math.pi * np.arange(count) / count
        columns = []
        for point, direction in rows:
            ahead, behind = (
                self._forces(rows, points, point, sign * small * direction, torque, angles)
                for sign in (1.0, -1.0)
            )
            columns.append((ahead - behind) / (2.0 * small))
        slopes = np.array(columns).reshape(len(rows), count, len(rows))
        mean = slopes.mean(axis=1).T
        turning = 2.0 * np.einsum("jar,a->rj", slopes, np.exp(-2j * angles)) / count
        return TorqueStiffness(mean, turning)

    def is_stable(self, speed: float, torque: float) -> bool:
        """Return whether the turning part of the torque's stiffness leaves a speed stable.

        At the limit a vibration of order 1 maintains itself: ``x = H A conj(x)`` with the
        compliance ``H`` of the points at order 1 and half of the turning part as ``A``. For one
        point on a bearing without directions this is ``abs(k - m speed**2 + i c speed) > kappa``.
        What the mean part does, as to a single joint, is left out.
        """
        model = _Model(self)
        rows, _ = self._points()
        places = [self._end(point) for point, _ in rows]
        reads = [e @ model.displacement(*place) for (_, e), place in zip(rows, places, strict=True)]
        if not reads:
            return True
        read = np.array(reads)
        stiffness, _ = model.dynamic(speed, 1.0)
        compliance = (
            read
            @ model.free
            @ np.linalg.solve(model.free.T @ stiffness @ model.free, model.free.T @ read.T)
        )
        gain = compliance @ self.torque_stiffness(torque).turning / 2.0
        return bool(np.max(np.abs(np.linalg.eigvals(gain @ gain.conj()))) < 1.0)

    def _couples(
        self, speed: float, load: Load, orders: Sequence[float], turns: int
    ) -> list[list[Complex]]:
        """Return, for each order and shaft end, the couple conjugate to the slope [N m].

        Ends are counted by joint, the downstream one of its driving shaft first.
        """
        count = turns * _samples(self.line)
        angles = 2.0 * math.pi * turns * np.arange(count) / count
        moments = np.array([_moments(self.line, angle, speed, load) for angle in angles])
        found = []
        for order in orders:
            # Over whole periods; a sum over equal steps is exact but for aliases.
            turned = np.exp(-1j * order * angles) * (1.0 if order == 0 else 2.0)
            parts = np.einsum("a,ajx->jx", turned, moments) / count
            couples = []
            for (u, v), moment in zip(pairwise(self.line.directions), parts, strict=True):
                couples += [-np.cross(moment, u), np.cross(moment, v)]
            found.append(couples)
        return found

    def _end(self, point: int) -> tuple[int, float]:
        """Return the shaft that carries a point, its own end there, and not one that slides."""
        if point == 0:
            return 0, 0.0
        joint = point - 1
        if joint == len(self.slides):
            return joint, self.lengths[joint]
        carrier = 2 * joint + 1 - self.slides[joint]
        return carrier, self.lengths[joint] if carrier == joint else 0.0

    def _points(self) -> tuple[list[tuple[int, Array]], Array]:
        """Return points that can move, each with two directions, and where all points lie."""
        rows = []
        for point in range(len(self.lengths) + 1):
            touching = self.shafts[max(point - 1, 0) : point + 1]
            if None not in touching:
                pair = _pair_across(self.line.directions[self._end(point)[0]])
                rows += [(point, direction) for direction in pair.T]
        steps = np.array(self.line.directions) * np.array(self.lengths)[:, None]
        return rows, np.concatenate([np.zeros((1, 3)), np.cumsum(steps, axis=0)])

    def _forces(
        self,
        rows: list[tuple[int, Array]],
        points: Array,
        moved: int,
        by: Array,
        torque: float,
        angles: Array,
    ) -> Array:
        """Return what the moments of the joints do to points that can move, one of them moved."""
        placed = points.copy()
        placed[moved] += by
        steps = np.diff(placed, axis=0)
        lengths = np.linalg.norm(steps, axis=-1)
        line = from_directions(steps.tolist(), self.line.phases)
        # The first pin keeps its direction; drive angles count from the plane of the first bend.
        pin = _across(_cross(self.line.normals[0], self.line.directions[0]), line.directions[0])
        level = _cross(line.normals[0], line.directions[0])
        ahead = math.atan2(_dot(pin, line.normals[0]), _dot(pin, level))
        forces = []
        for angle in angles:
            moments = loads(line, angle + ahead, drive_torque=torque).moment
            zero = (0.0, 0.0, 0.0)
            couples = [
                _cross(_plus(received, _scaled(-1.0, passed_on)), u)
                for u, (received, passed_on) in zip(
                    line.directions, pairwise([zero, *moments, zero]), strict=True
                )
            ]
            # A point turns the shaft before it one way and the shaft behind it the other way.
            turned = [np.array(q) / x for q, x in zip(couples, lengths, strict=True)]
            at = [a - b for a, b in pairwise([np.zeros(3), *turned, np.zeros(3)])]
            forces.append([direction @ at[point] for point, direction in rows])
        return np.array(forces)


def largest(vectors: Complex, orders: Sequence[float]) -> Array:
    """Return the largest length of ``Re sum x_k exp(i k angle)`` over all drive angles.

    Args:
        vectors: amplitudes ``(..., orders, 3)``.
        orders: multiples of the drive angle, of small denominators.

    Source: where the square of the length, a polynomial in ``z = exp(i angle)`` and ``1/z``, has a
    derivative of 0. For one order above 0 it is ``sqrt((|x|**2 + |x . x|)/2)``.
    """
    fractions = [Fraction(order).limit_denominator(1000) for order in orders]
    common = math.lcm(*(order.denominator for order in fractions))
    powers = [int(order * common) for order in fractions]
    top = max(powers)
    found = []
    for amplitudes in vectors.reshape(-1, len(powers), 3):
        series = np.zeros((2 * top + 1, 3), dtype=np.complex128)
        for power, x in zip(powers, amplitudes, strict=True):
            series[top + power] += x / 2.0
            series[top - power] += x.conj() / 2.0
        square = sum(np.convolve(series[:, i], series[:, i]) for i in range(3))
        roots = np.roots((np.arange(-2 * top, 2 * top + 1) * square)[::-1])
        angles = np.array([0.0, *np.angle(roots)])
        turned = np.exp(1j * np.multiply.outer(angles, powers)) @ amplitudes
        found.append(np.max(np.linalg.norm(turned.real, axis=-1)))
    return np.array(found).reshape(vectors.shape[:-2])


def _slides(system: System) -> list[int]:
    """Return for each joint the shaft that it supports, as in statics, or else the driven one."""
    count = len(system.shafts)
    found: dict[int, int] = {}
    lacking = {
        shaft: 2 - min(2, sum(bearing.shaft == shaft for bearing in system.bearings))
        for shaft, own in enumerate(system.shafts)
        if own is not None
    }
    # Each pass may decide for a neighbour.
    for _ in range(count):
        for shaft, needed in lacking.items():
            open_ends = [j for j in (shaft - 1, shaft) if 0 <= j < count - 1 and j not in found]
            if needed >= len(open_ends):
                found |= dict.fromkeys(open_ends, shaft)
    driven = {j: j if system.shafts[j + 1] is None else j + 1 for j in range(count - 1)}
    return [found.get(j, driven[j]) for j in range(count - 1)]


def _samples(line: Shafts) -> int:
    """Return how many drive angles of a turn show all that joints do."""
    return 2 * enough(math.prod(_dot(u, v) for u, v in pairwise(line.directions)))


def _moments(line: Shafts, angle: float, speed: float, load: Load) -> Sequence[Vector]:
    """Return the moment of each joint on its driven shaft."""
    if not callable(load):
        return loads(line, angle, speed=speed, **load).moment
    joints = _joints(line, angle)
    return [
        _scaled(torque / _dot(at.u, at.n), at.n)
        for at, torque in zip(joints, load(angle), strict=True)
    ]


def _pair(value: float | Sequence[float]) -> tuple[float, float]:
    first, second = (value, value) if isinstance(value, int | float) else value
    return first, second


def _pair_across(u: Vector, axis: Sequence[float] | None = None) -> Array:
    """Return two unit vectors across ``u`` as columns: the part of an axis, and ``u x`` that."""
    if axis is None:
        axis = np.eye(3)[np.argmin(np.abs(u))].tolist()
    x, y, z = axis
    first = _unit(_across((x, y, z), u))
    return np.array([first, _cross(u, first)]).T


# --- shafts in one plane -----------------------------------------------------------------------


@dataclass(frozen=True)
class _Plane:
    """A shaft in one of two equal planes along it.

    Attributes:
        mass: quadratic form of the unknowns that is twice the kinetic energy of unit velocities.
        polar: that of slopes with the moment of inertia along the axis.
        stiffness: that of the elastic energy.
        rows: for a position, the rows that make displacement and slope of the unknowns.
    """

    mass: Array
    polar: Array
    stiffness: Array
    rows: Callable[[float], tuple[Array, Array]]


def _rigid(shaft: RigidShaft) -> _Plane:
    """Return a rigid shaft, whose unknowns are displacement and slope at the upstream end."""
    slope = np.array([0.0, 1.0])

    def rows(position: float) -> tuple[Array, Array]:
        return np.array([1.0, position]), slope

    centre, _ = rows(shaft.centre)
    turning = np.outer(slope, slope)
    mass = shaft.mass * np.outer(centre, centre) + shaft.across * turning
    return _Plane(mass, shaft.along * turning, np.zeros((2, 2)), rows)


_GAUSS = np.polynomial.legendre.leggauss(6)
"""Exact up to degree 11; twice the degree of the elements is 10 and 8."""


def _nodes(tube: Tube) -> int:
    """Return the number of nodes of an element, of degree 5 for Euler's theory or 4."""
    return 3 if tube.shear_coefficient is None else 5


def _shapes(tube: Tube, length: float, at: float) -> tuple[Array, Array, Array, Array]:
    """Return the rows of an element for displacement, slope, its derivative, and shear angle.

    Args:
        tube: of the element; its unknowns are displacement and slope of each node in turn.
        length: of the element [m].
        at: place in the element, from 0 to 1.
    """
    nodes = np.linspace(0.0, 1.0, _nodes(tube))
    if tube.shear_coefficient is None:
        # Polynomials in the place with each value, and each slope in the element, at the nodes.
        powers = np.arange(2 * len(nodes))
        values = nodes[:, None] ** powers
        slopes = powers * nodes[:, None] ** np.maximum(powers - 1, 0) / length
        given = np.stack([values, slopes], axis=1).reshape(len(powers), -1)
        hermite = [Polynomial(column) for column in np.linalg.inv(given).T]
        value, slope, bending = (
            np.array([polynomial.deriv(n)(at) for polynomial in hermite]) / length**n
            for n in range(3)
        )
        return value, slope, bending, np.zeros(len(powers))
    lagrange = [
        Polynomial.fromroots(np.delete(nodes, i)) / np.prod(node - np.delete(nodes, i))
        for i, node in enumerate(nodes)
    ]
    value = np.array([polynomial(at) for polynomial in lagrange])
    rate = np.array([polynomial.deriv()(at) for polynomial in lagrange]) / length
    of_displacement, of_slope = np.array([1.0, 0.0]), np.array([0.0, 1.0])
    return (
        np.kron(value, of_displacement),
        np.kron(value, of_slope),
        np.kron(rate, of_slope),
        np.kron(rate, of_displacement) - np.kron(value, of_slope),
    )


def _element(tube: Tube, length: float) -> tuple[Array, Array, Array]:
    """Return mass, polar and stiffness matrix of an element, by Gauss's points."""
    is_timoshenko = tube.shear_coefficient is not None
    line = tube.density * tube.area
    rotary = tube.density * tube.second_moment if is_timoshenko else 0.0
    bending = tube.elastic_modulus * tube.second_moment
    shear = (tube.shear_coefficient or 0.0) * tube.shear_modulus * tube.area
    size = 2 * _nodes(tube)
    mass, polar, stiffness = np.zeros((3, size, size))
    for at, weight in zip(*_GAUSS, strict=True):
        w, slope, curvature, angle = _shapes(tube, length, (1.0 + at) / 2.0)
        here = weight * length / 2.0
        turning = here * rotary * np.outer(slope, slope)
        mass += here * line * np.outer(w, w) + turning
        polar += 2.0 * turning
        stiffness += here * bending * np.outer(curvature, curvature)
        stiffness += here * shear * np.outer(angle, angle)
    return mass, polar, stiffness


def _meshed(tube: Tube, stops: Sequence[float], step: float) -> _Plane:
    """Return a tube with nodes at its stops, which are sorted, and between them."""
    nodes_per_element = _nodes(tube) - 1
    counts = [math.ceil((b - a) / step) for a, b in pairwise(stops)]
    node_of = dict(zip(stops, nodes_per_element * np.cumsum([0, *counts]), strict=True))
    size = 2 * (nodes_per_element * sum(counts) + 1)
    matrices = np.zeros((3, size, size))
    first = 0
    for (a, b), count in zip(pairwise(stops), counts, strict=True):
        parts = np.array(_element(tube, (b - a) / count))
        for _ in range(count):
            own = slice(first, first + parts.shape[-1])
            matrices[:, own, own] += parts
            first += 2 * nodes_per_element
    unit = np.eye(size)

    def rows(position: float) -> tuple[Array, Array]:
        node = node_of[position]
        return unit[2 * node], unit[2 * node + 1]

    mass, polar, stiffness = matrices
    return _Plane(mass, polar, stiffness, rows)


# --- the whole driveline -----------------------------------------------------------------------


class _Model:
    """Matrices of all unknowns: of each shaft that moves those of its nodes, in two directions.

    Attributes:
        mass, gyroscopic: matrices; the latter is multiplied by the speed of the drive.
        tubes: for each shaft that bends its loss factor and its stiffness.
        bearings: for each direction of each bearing its constants and its row of the unknowns.
        joints: for each joint two rows: displacement of the driven end less that of the driving
            one, across the sliding shaft.
        free: unknowns that keep all ends together, in columns.
        root: Cholesky factor of their stiffness without damping.
    """

    _UNHELD = "bearings and joints leave a shaft without support"

    def __init__(self, system: System, probes: Sequence[tuple[int, float]] = ()) -> None:
        self.system, self.probes = system, [system.place(*probe) for probe in probes]
        line, lengths = system.line, system.lengths
        self.pairs = [_pair_across(u) for u in line.directions]
        items: Any = (*system.bearings, *system.masses, *system.unbalance)
        attached = [self._place(item) for item in items]
        self.planes: list[_Plane | None] = []
        for shaft, own in enumerate(system.shafts):
            if isinstance(own, Tube):
                stops = {0.0, lengths[shaft]}
                stops |= {
                    position for place, position in (*attached, *self.probes) if place == shaft
                }
                self.planes.append(_meshed(own, sorted(stops), system.step))
            else:
                self.planes.append(None if own is None else _rigid(own))
        sizes = [0 if plane is None else 2 * len(plane.mass) for plane in self.planes]
        self.first = np.cumsum([0, *sizes])
        self.size = self.first[-1]

        self.mass, self.gyroscopic = np.zeros((2, self.size, self.size))
        self.tubes = []
        quarter = np.array([[0.0, -1.0], [1.0, 0.0]])
        for shaft, (own, plane) in enumerate(zip(system.shafts, self.planes, strict=True)):
            if plane is not None:
                place = np.ix_(*2 * [range(self.first[shaft], self.first[shaft + 1])])
                self.mass[place] += np.kron(plane.mass, np.eye(2))
                self.gyroscopic[place] -= np.kron(plane.polar, quarter)
                stiffness = np.zeros((self.size, self.size))
                stiffness[place] = np.kron(plane.stiffness, np.eye(2))
                if isinstance(own, Tube):
                    self.tubes.append((own.loss_factor, stiffness))
        for item in system.masses:
            w, slope = self.displacement(*self._place(item)), self.slope(*self._place(item))
            self.mass += item.mass * w.T @ w + item.across * slope.T @ slope
            u = line.directions[item.shaft]
            self.gyroscopic -= item.along * slope.T @ np.cross(u, slope, axisb=0, axisc=0)
        self.bearings = []
        for bearing in system.bearings:
            axes = _pair_across(line.directions[bearing.shaft], bearing.axis)
            rows = axes.T @ self.displacement(*self._place(bearing))
            constants = (bearing.stiffness, _pair(bearing.loss_factor), _pair(bearing.damping))
            self.bearings.append(list(zip(*constants, axes.T, rows, strict=True)))
        joints = [np.zeros((0, self.size))]
        for j, sliding in enumerate(system.slides):
            apart = self.displacement(j + 1, 0.0) - self.displacement(j, lengths[j])
            joints.append(self.pairs[sliding].T @ apart)
        self.joints = np.concatenate(joints)
        # A complete orthonormal basis: what follows the rows of the joints leaves them at 0.
        self.free = np.linalg.qr(self.joints.T, mode="complete")[0][:, len(self.joints) :]
        try:
            still = self.dynamic(0.0, 0.0)[0].real
            self.root = np.linalg.cholesky(self.free.T @ still @ self.free)
        except np.linalg.LinAlgError as error:
            raise ValueError(self._UNHELD) from error
        depths = np.diag(self.root)
        # Rounding may leave a support of 1e-16; with real ones more than 1e-8 is left.
        if len(depths) and np.min(depths) < 1e-6 * np.max(depths):
            raise ValueError(self._UNHELD)

    def _place(self, item: ElasticBearing | PointMass | Unbalance) -> tuple[int, float]:
        return self.system.place(item.shaft, item.position)

    def _read(self, shaft: int, position: float, which: int) -> Array:
        read = np.zeros((3, self.size))
        plane = self.planes[shaft]
        if plane is not None:
            row = plane.rows(position)[which]
            read[:, self.first[shaft] : self.first[shaft + 1]] = np.kron(row, self.pairs[shaft])
        return read

    def displacement(self, shaft: int, position: float) -> Array:
        """Return what makes a displacement, a vector, of the unknowns."""
        return self._read(shaft, position, 0)

    def slope(self, shaft: int, position: float) -> Array:
        """Return what makes a slope, a vector across the shaft, of the unknowns."""
        return self._read(shaft, position, 1)

    def dynamic(self, speed: float, order: float) -> tuple[Complex, list[list[complex]]]:
        """Return the dynamic stiffness, and that of each bearing in its two directions."""
        rate = order * speed
        whole = 1j * rate * speed * self.gyroscopic - rate**2 * self.mass
        # The material of a turning shaft sees an order less by 1.
        for loss, stiffness in self.tubes:
            whole = whole + stiffness * (1.0 + 1j * loss * np.sign(rate) * (order >= 2))
        each = []
        for bearing in self.bearings:
            own = [
                k * (1.0 + 1j * eta * np.sign(rate)) + 1j * rate * c for k, eta, c, *_ in bearing
            ]
            for value, (*_, row) in zip(own, bearing, strict=True):
                whole = whole + value * np.outer(row, row)
            each.append(own)
        return whole, each

    def solved(self, speed: float, order: float, couples: Sequence[Complex]) -> dict[str, Any]:
        """Return the results of one order, under the names of a response."""
        system, rate = self.system, order * speed
        force = np.zeros(self.size, dtype=np.complex128)
        for j, length in enumerate(system.lengths[:-1]):
            force += self.slope(j, length).T @ couples[2 * j]
            force += self.slope(j + 1, 0.0).T @ couples[2 * j + 1]
        for item in system.unbalance:
            if order == 1:
                e, aside = _pair_across(system.line.directions[item.shaft], item.direction).T
                turning = item.mass_arm * speed**2 * (e - 1j * aside)
                force += self.displacement(*self._place(item)).T @ turning
        stiffness, of_bearings = self.dynamic(speed, order)
        # Joint forces keep ends together; one scale for both kinds of unknowns.
        scale = np.max(np.abs(stiffness))
        ties = scale * self.joints
        none = np.zeros(2 * (len(ties),))
        equations = np.block([[stiffness, -ties.T], [ties, none]])
        x, tied = np.split(
            np.linalg.solve(equations, np.concatenate([force, np.zeros(len(ties))])), [self.size]
        )
        joint_forces = scale * tied.reshape(-1, 2)
        bearing_force, bearing_displacement, bearing_power = [], [], []
        for bearing, values in zip(self.bearings, of_bearings, strict=True):
            moved = [(axis, row @ x) for *_, axis, row in bearing]
            bearing_displacement.append(sum(w * axis for axis, w in moved))
            pushed = [-k * w * axis for k, (axis, w) in zip(values, moved, strict=True)]
            bearing_force.append(sum(pushed))
            lost = [k.imag * abs(w) ** 2 for k, (_, w) in zip(values, moved, strict=True)]
            bearing_power.append(rate / 2.0 * sum(lost))
        slid = [(s, system.lengths[s] if s == j else 0.0) for j, s in enumerate(system.slides)]
        lost_in_tubes = [
            loss * (order >= 2) * (x.conj() @ stiffness @ x).real for loss, stiffness in self.tubes
        ]
        vectors = {
            "bearing_force": bearing_force,
            "bearing_displacement": bearing_displacement,
            "joint_force": [
                self.pairs[s] @ f for s, f in zip(system.slides, joint_forces, strict=True)
            ],
            "joint_displacement": [self.displacement(*place) @ x for place in slid],
            "displacement": [self.displacement(*place) @ x for place in self.probes],
        }
        return {
            **{name: np.reshape(own, (-1, 3)) for name, own in vectors.items()},
            "bearing_power": np.array(bearing_power),
            "tube_power": abs(rate) / 2.0 * sum(lost_in_tubes),
            "given_power": rate / 2.0 * (force @ x.conj()).imag,
        }

"""Lateral systems: drivelines whose shafts move across their axes."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, SupportsIndex

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cardan import _core
from cardan.arrays import ComplexArray, FloatArray, as_float64, common_shape, finite, threads
from cardan.arrays.errors import ArgumentTypeError, ArgumentValueError, check_shape
from cardan.arrays.indices import integer, item_index
from cardan.driveline import Driveline
from cardan.evaluation.load import Load
from cardan.geometry.geometry import require_driveline
from cardan.lateral.elements import ElasticBearing, PointMass, RigidShaft, Unbalance
from cardan.lateral.results import (
    VECTORS,
    LateralModes,
    LateralResonance,
    LateralResponse,
    TorqueStiffness,
)
from cardan.torsion.results import SteadyState
from cardan.torsion.tube import Tube

_HELD, _RIGID, _BENDING = range(3)

# As many as the native module seeks.
_MOST_MODES = 100

# Places between the ends of a shaft that bends, among which the one is sought that moves most.
_PLACES = 8

# The least samples of a turn in which a vibration is taken apart.
_SAMPLES = 256

# What a function for browsers calls their shafts and their numbers.
_FOR_BROWSERS = {
    "bearings": ("elastic_shafts", "of_elastic"),
    "masses": ("mass_shafts", "of_masses"),
    "unbalance": ("unbalance_shafts", "of_unbalances"),
}

# Of each item its class, and its fields as numbers with their sizes.
_ITEMS: dict[str, tuple[type[Any], dict[str, int]]] = {
    "bearings": (
        ElasticBearing,
        {"position": 1, "stiffness": 2, "axis": 3, "loss_factor": 2, "damping": 2},
    ),
    "masses": (PointMass, {"position": 1, "mass": 1, "across": 1, "along": 1}),
    "unbalance": (Unbalance, {"position": 1, "mass_arm": 1, "direction": 3}),
}
_OF_SHAFTS: dict[type, tuple[int, tuple[str, ...]]] = {
    RigidShaft: (_RIGID, ("mass", "centre", "across", "along")),
    Tube: (
        _BENDING,
        ("bending_stiffness", "line_mass", "shear_stiffness", "rotary_inertia", "loss_factor"),
    ),
}


@dataclass(frozen=True, eq=False, init=False, repr=False, slots=True)
class LateralSystem:
    """A driveline whose shafts move a little across their axes, or a batch of such drivelines.

    Each shaft is part of a machine and held, rigid, or a tube that bends. Elastic bearings hold the
    shafts; the moments of ideal joints at the drawn bends and unbalances excite them at steady
    speeds. At each joint one of the two shafts slides along its own axis without force, so the
    force of the joint is across this shaft. Tubes are solved exactly, without a mesh. The drawn
    positions are those under weight and mean torque.

    Every number may be an array that broadcasts against the batch of the driveline.

    Args:
        line: the driveline, with lengths: from points, or with ``lengths`` of its bearings. Its
            own bearings have no effect.
        shafts: for each shaft ``None`` for a part of a machine that does not move, a
            ``RigidShaft``, or a ``cardan.tube``, of which the length is that of the driveline.
        bearings: elastic bearings.
        masses: yokes, flanges and discs.
        unbalance: unbalances.
        sliding: for each joint the one of its two shafts that slides along its own axis; by
            default the one that the joint supports, as for ``bearing_force``, and where that is
            neither, the driven one. It must be able to: it needs a spline.

    Raises:
        TypeError: no driveline, shafts or items of another kind, values that are not real numbers.
        IndexError: a shaft that does not exist.
        ValueError: a driveline without lengths or with deviations of joints, a wrong number of
            shafts, a position beyond its shaft, an item on a shaft that is held, a negative or
            infinite stiffness, damping or mass, a loss factor above 1, two directions that differ
            without an axis, a joint between two shafts that are held, a shaft without support,
            shapes that do not fit.

    Attributes:
        line: the driveline.
        shape: of the batch, to which driveline and numbers broadcast.
        lengths: of each shaft in m, ``(..., n + 1)``.
        shafts: as given.
        bearings: as given.
        masses: as given.
        unbalance: as given.
        sliding: with the default filled in.

    >>> import cardan
    >>> points = [[0, 0, 0], [0.3, 0, 0], [1.5, 0.06, 0], [3.2, 0.3, 0], [3.5, 0.3, 0]]
    >>> tube = cardan.tube(0.09, 0.003, length=1.2)
    >>> system = cardan.LateralSystem(
    ...     cardan.Driveline.from_points(points),
    ...     shafts=[None, tube, tube, None],
    ...     bearings=[cardan.ElasticBearing(1, 1.1, stiffness=3e5, loss_factor=0.12)],
    ... )
    >>> (system.natural_frequencies(2) / 6.28318).round(2)
    array([31.  , 31.07])
    >>> response = system.response([60.0, 80.0], cardan.Load(drive_torque=1500.0), orders=[2])
    >>> response.largest("bearing_force").round(1)
    array([[ 93.5, 139.9]])
    """

    line: Driveline
    shape: tuple[int, ...]
    lengths: FloatArray
    shafts: tuple[RigidShaft | Tube | None, ...]
    bearings: tuple[ElasticBearing, ...]
    masses: tuple[PointMass, ...]
    unbalance: tuple[Unbalance, ...]
    sliding: tuple[int, ...]
    _core: _core.Lateral

    def __init__(
        self,
        line: Driveline,
        *,
        shafts: Sequence[RigidShaft | Tube | None],
        bearings: Iterable[ElasticBearing] = (),
        masses: Iterable[PointMass] = (),
        unbalance: Iterable[Unbalance] = (),
        sliding: Sequence[SupportsIndex] | None = None,
    ) -> None:
        """Check the arguments and pass them to the native module."""
        require_driveline("line", line)
        line._geometry.check_ideal("lateral systems are computed")
        count = line.n_joints + 1
        shafts = tuple(shafts)
        if len(shafts) != count:
            problem = f"has {len(shafts)} values; the driveline has {count} shafts"
            raise ArgumentValueError("shafts", problem)
        given: dict[str, tuple[Any, ...]] = {
            "bearings": tuple(bearings),
            "masses": tuple(masses),
            "unbalance": tuple(unbalance),
        }
        kinds, own = _of_shafts(shafts)
        numbers = {name: _numbers(name, items) for name, items in given.items()}
        lengths = line.lengths().each
        shape = common_shape(
            driveline=line.shape,
            lengths=lengths.shape[:-1],
            shafts=own.shape[:-2],
            **{name: array.shape[:-2] for name, array in numbers.items()},
        )

        def flat(array: FloatArray, ends: int) -> FloatArray:
            full = np.broadcast_to(array, (*shape, *array.shape[array.ndim - ends :]))
            return np.ascontiguousarray(full).ravel()

        geometry = [
            flat(line.directions, 2),
            flat(lengths, 1),
            flat(line.normals[..., 0, :], 1),
            flat(line.phases, 1),
        ]
        places = [
            (_shafts_of(name, items, count), flat(numbers[name], 2))
            for name, items in given.items()
        ]
        slides = None
        if sliding is not None:
            slides = [item_index("sliding", x, count, (j,)) for j, x in enumerate(sliding)]
        core = _core.Lateral(shape, geometry, (kinds, flat(own, 2)), places, slides)
        full = np.broadcast_to(lengths, (*shape, count)).copy()
        full.flags.writeable = False
        values = {
            "line": line,
            "shape": shape,
            "lengths": full,
            "shafts": shafts,
            **given,
            "sliding": tuple(core.sliding()),
            "_core": core,
        }
        for name, value in values.items():
            object.__setattr__(self, name, value)

    def __repr__(self) -> str:
        """Show the driveline and the number of bearings."""
        return f"<LateralSystem of {self.line!r}, {len(self.bearings)} elastic bearings>"

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle as driveline and parts."""
        names = ("shafts", "bearings", "masses", "unbalance", "sliding")
        return (_restored, (self.line, {name: getattr(self, name) for name in names}))

    def natural_frequencies(self, count: SupportsIndex = 6) -> FloatArray:
        """Return the lowest natural frequencies in rad/s, ``(..., count)``.

        They are those at rest and without damping; gyroscopic terms and damping move the peaks of a
        response a little. They are infinite where rigid shafts have fewer.

        Args:
            count: how many, from 1 to 100.

        Source: W. H. Wittrick and F. W. Williams 1971, with the exact dynamic stiffness of tubes.
        """
        return self.modes(count).frequencies

    def modes(
        self, count: SupportsIndex = 6, probes: Iterable[tuple[int, float]] = ()
    ) -> LateralModes:
        """Return natural frequencies and how places move in them.

        Args:
            count: how many, at least 1.
            probes: shaft and position in m of each place.

        Raises:
            IndexError: a probe on a shaft that does not exist.
            ValueError: no mode asked for, a probe beyond its shaft.
        """
        number = integer("count", count)
        if number < 1:
            raise ArgumentValueError("count", f"is {number}; it must be at least 1")
        places = self._probes(probes)
        frequencies, moved = self._core.modes(number, places)
        displacement = moved.reshape(*self.shape, number, len(places), 3)
        return LateralModes(
            frequencies.reshape(*self.shape, number), np.moveaxis(displacement, -2, 0)
        )

    def response(
        self,
        speed: ArrayLike,
        load: Load | SteadyState | None = None,
        orders: ArrayLike = (1, 2, 4),
        probes: Iterable[tuple[int, float]] = (),
        *,
        workers: SupportsIndex | None = None,
    ) -> LateralResponse:
        """Return the vibration at steady speeds of the drive.

        Without a torque only unbalances excite a system. With a constant torque of the drive and no
        inertias the joints excite the orders 0 and 2 only; a constant torque of the output and
        inertias bring others. Shapes of systems, speeds and loads broadcast against each other.

        Args:
            speed: of the drive in rad/s, of any shape.
            load: what the joints transmit: a load, whose own speed does not count, or the motion of
                a torsional system at these speeds; by default nothing.
            orders: multiples of the drive speed, 0 for the mean.
            probes: shaft and position in m of each place whose displacement is asked for.
            workers: the most threads to use; as many as there are by default.

        Raises:
            TypeError: a load of another kind.
            IndexError: a probe on a shaft that does not exist.
            ValueError: a speed that is not finite, or so large that waves are too short for their
                pieces to be counted; an acceleration, a negative order, a probe beyond its shaft,
                the motion of another driveline or at other speeds, shapes that do not broadcast.
        """
        speeds, order = finite("speed", speed), np.atleast_1d(finite("orders", orders))
        if order.ndim > 1 or np.any(order < 0.0):
            raise ArgumentValueError("orders", "must be in one row, and none may be negative")
        places = self._probes(probes)
        moments = _moments(self.line, load, speeds, order)
        shape = common_shape(system=self.shape, speed=speeds.shape, load=moments.shape[:-3])
        given = np.broadcast_to(moments, (*shape, *moments.shape[-3:]))
        systems = np.arange(math.prod(self.shape)).reshape(self.shape)
        vectors, powers = self._core.responses(
            (np.broadcast_to(systems, shape).ravel(), np.broadcast_to(speeds, shape).ravel()),
            order.tolist(),
            np.ascontiguousarray(given).ravel(),
            places,
            threads.at_most(workers),
        )
        bearings, joints = len(self.bearings), self.line.n_joints
        sizes = (bearings, bearings, joints, joints, len(places))
        whole = np.moveaxis(vectors.reshape(*shape, len(order), sum(sizes), 3), -2, 0)
        parts = np.split(whole, np.cumsum(sizes)[:-1])
        power = np.moveaxis(powers.reshape(*shape, len(order), bearings + 2), -1, 0)
        own = dict(zip(VECTORS, parts, strict=True))
        return LateralResponse(
            order, **own, bearing_power=power[:-2], tube_power=power[-2], given_power=power[-1]
        )

    def resonances(
        self, speeds: tuple[float, float], orders: ArrayLike = (1, 2, 4)
    ) -> tuple[LateralResonance, ...]:
        """Return where orders meet natural frequencies of one system, by speed.

        Order 1 is excited by unbalances, order 2 by joints, order 4 by torques that pulsate.

        Args:
            speeds: lowest and highest speed of the drive in rad/s.
            orders: multiples of the drive speed.

        Raises:
            ValueError: a batch, speeds that are not in order or need more than 100 modes, an order
                that is not positive.
        """
        if self.shape:
            raise ArgumentValueError("system", f"is a batch {self.shape}; it must be one")
        ends = finite("speeds", speeds)
        check_shape("speeds", ends, ends.shape == (2,), "it must be two speeds")
        low, high = ends.tolist()
        order = np.atleast_1d(finite("orders", orders))
        if not 0.0 <= low < high:
            raise ArgumentValueError("speeds", f"are {low} and {high}; they must increase from 0")
        if np.any(order <= 0.0):
            raise ArgumentValueError("orders", "must be positive")
        places = self._places()
        highest, count = high * float(order.max()), 8
        while (modes := self.modes(count, places)).frequencies[-1] <= highest:
            if count == _MOST_MODES:
                reach = modes.frequencies[-1] / float(order.max())
                problem = f"reach beyond {reach:.6g} rad/s, up to which modes are sought"
                raise ArgumentValueError("speeds", problem)
            count = min(2 * count, _MOST_MODES)
        found = []
        for frequency, moved in zip(
            modes.frequencies.tolist(), np.moveaxis(modes.displacement, 0, 1), strict=True
        ):
            if frequency > highest:
                break
            most = int(np.argmax(np.linalg.norm(moved, axis=-1)))
            shaft, position = places[most]
            x, y, z = (float(part) for part in moved[most])
            for multiple in order.tolist():
                if low <= frequency / multiple <= high:
                    found.append(
                        LateralResonance(
                            frequency / multiple, multiple, frequency, shaft, position, (x, y, z)
                        )
                    )
        return tuple(sorted(found, key=lambda each: each.speed))

    def torque_stiffness(self, torque: ArrayLike) -> TorqueStiffness:
        """Return how a steady torque of the drive in N m acts like a stiffness.

        Points are moved with straight shafts between them, also where these are tubes. The shape
        of ``torque`` broadcasts against that of the system. Errors: 1e-9 of ``torque/length**2``.
        """
        torques = finite("torque", torque)
        common_shape(system=self.shape, torque=torques.shape)
        torques = torques[..., np.newaxis, np.newaxis]
        turning, mean = self._core.torque_stiffness()
        size = math.isqrt(mean.size // max(1, math.prod(self.shape)))
        shape = (*self.shape, size, size)
        return TorqueStiffness(torques * mean.reshape(shape), torques * turning.reshape(shape))

    def largest_stable_torque(self, speed: ArrayLike) -> FloatArray:
        """Return the torque of the drive in N m up to which a speed in rad/s is stable.

        Above it the part of the torque's own stiffness that turns with the shafts maintains a
        vibration. What its mean part does, as to a single joint, is left out. Infinite where no
        joint can move. The shape is that of systems and speeds.
        """
        speeds = finite("speed", speed)
        shape = common_shape(system=self.shape, speed=speeds.shape)
        systems = np.arange(math.prod(self.shape)).reshape(self.shape)
        return self._core.largest_stable_torque(
            np.broadcast_to(systems, shape).ravel(), np.broadcast_to(speeds, shape).ravel()
        ).reshape(shape)

    def is_stable(self, speed: ArrayLike, torque: ArrayLike) -> NDArray[np.bool_]:
        """Return whether a speed in rad/s is stable under a torque of the drive in N m.

        See ``largest_stable_torque``.
        """
        torques, limit = finite("torque", torque), self.largest_stable_torque(speed)
        common_shape(torque=torques.shape, speed=limit.shape)
        return np.asarray(np.abs(torques) < limit)

    def _probes(self, probes: Iterable[tuple[int, float]]) -> list[tuple[int, float]]:
        count = self.line.n_joints + 1
        return [
            (
                item_index("probes.shaft", shaft, count, (i,)),
                float(finite("probes.position", position)),
            )
            for i, (shaft, position) in enumerate(probes)
        ]

    def _described(self) -> dict[str, list[Any]]:
        """Return the numbers of the only system, as the function for browsers takes them."""
        kinds, numbers = _of_shafts(self.shafts)
        found: dict[str, list[Any]] = {"kinds": kinds, "of_shafts": numbers.tolist()}
        for name, (shafts, fields) in _FOR_BROWSERS.items():
            items = getattr(self, name)
            found[shafts] = _shafts_of(name, items, len(kinds))
            found[fields] = _numbers(name, items).tolist()
        return found | {"sliding": list(self.sliding)}

    def _places(self) -> list[tuple[int, float]]:
        """Places of all shafts that move: ends, and between them where shafts bend."""
        return [
            (shaft, float(position))
            for shaft, own in enumerate(self.shafts)
            if own is not None
            for position in np.linspace(
                0.0, self.lengths[shaft], 2 if isinstance(own, RigidShaft) else _PLACES + 1
            )
        ]


def _restored(line: Driveline, parts: dict[str, Any]) -> LateralSystem:
    return LateralSystem(line, **parts)


def _shafts_of(name: str, items: Sequence[Any], count: int) -> list[int]:
    return [item_index(f"{name}.shaft", item.shaft, count, (i,)) for i, item in enumerate(items)]


def _of_shafts(shafts: Sequence[object]) -> tuple[list[int], FloatArray]:
    """Return the kinds of shafts, and their numbers ``(..., shafts, 5)``."""
    kinds, columns = [], []
    for i, shaft in enumerate(shafts):
        if shaft is None:
            kind, values = _HELD, []
        elif (own := _OF_SHAFTS.get(type(shaft))) is not None:
            kind = own[0]
            values = [as_float64(f"shafts[{i}].{name}", getattr(shaft, name)) for name in own[1]]
        else:
            problem = f"is {shaft!r}; a shaft is None, a RigidShaft or a cardan.tube"
            raise ArgumentTypeError("shafts", problem, (i,))
        kinds.append(kind)
        columns.append(values + [np.zeros(())] * (5 - len(values)))
    return kinds, _stacked("shafts", columns)


def _numbers(name: str, items: Sequence[Any]) -> FloatArray:
    """Return the numbers of items of one kind, ``(..., items, numbers)``."""
    kind, fields = _ITEMS[name]
    columns = []
    for i, item in enumerate(items):
        if not isinstance(item, kind):
            problem = f"is {item!r}; it must be of the class {kind.__name__}"
            raise ArgumentTypeError(name, problem, (i,))
        row: list[FloatArray] = []
        for field, size in fields.items():
            value = getattr(item, field)
            label = f"{name}[{i}].{field}"
            array = np.full(size, np.nan) if value is None else finite(label, value)
            if size == 2 and array.shape[-1:] in ((), (1,)):
                array = np.broadcast_to(array, (*array.shape[:-1], 2))
            if size > 1 and array.shape[-1:] != (size,):
                rule = f"its last axis needs {size} numbers" + (" or one" if size == 2 else "")
                raise ArgumentValueError(label, f"has the shape {array.shape}; {rule}")
            row += [array] if size == 1 else [array[..., j] for j in range(size)]
        columns.append(row)
    return _stacked(name, columns) if columns else np.zeros((0, sum(fields.values())))


def _stacked(name: str, columns: Sequence[Sequence[FloatArray]]) -> FloatArray:
    """Return numbers of items as one array ``(..., items, numbers)``."""
    shapes = [np.broadcast_shapes(*(value.shape for value in row)) for row in columns]
    shape = common_shape(**{f"{name}[{i}]": own for i, own in enumerate(shapes)})
    flat = [np.broadcast_to(value, shape) for row in columns for value in row]
    stacked = np.stack(flat, axis=-1)
    return stacked.reshape(*stacked.shape[:-1], len(columns), -1)


def _moments(line: Driveline, load: object, speeds: FloatArray, orders: FloatArray) -> ComplexArray:
    """Return the amplitudes of the moment of each joint, ``(..., orders, joints, 3)``."""
    if load is None:
        return np.zeros((len(orders), line.n_joints, 3), np.complex128)
    if isinstance(load, SteadyState):
        return _moments_of_motion(line, load, speeds, orders)
    if not isinstance(load, Load):
        problem = f"is {load!r}; it must be a cardan.Load or the motion of a torsional system"
        raise ArgumentTypeError("load", problem)
    if np.any(load.acceleration):
        raise ArgumentValueError("load", "has an acceleration; the speeds of a response are steady")
    end = {"drive_torque" if load.end == "drive" else "output_torque": load.torque}
    moments = _amplitudes(line, Load(**end), orders)
    if load.inertias is not None:
        # The torques of inertias grow with the square of the speed.
        none = dict.fromkeys(end, 0.0)
        unit = Load(**none, speed=1.0, inertias=load.inertias)
        square = (speeds**2)[..., np.newaxis, np.newaxis, np.newaxis]
        moments = moments + square * _amplitudes(line, unit, orders)
    return moments


def _amplitudes(line: Driveline, load: Load, orders: FloatArray) -> ComplexArray:
    """Return the amplitudes of moments under a load, zero for orders that are not whole."""
    whole = np.unique(np.where(orders == np.round(orders), orders, 0.0)).astype(np.int64)
    whole = whole[whole > 0]
    found = line.harmonics(whole if len(whole) else [1], outputs="moment", load=load)
    mean = found.mean["moment"].astype(np.complex128)
    amplitudes = np.moveaxis(found.complex_amplitude["moment"], -1, 0)
    zero = np.zeros_like(mean)
    place = {0.0: mean} | dict(zip(whole.tolist(), amplitudes, strict=False))
    each = [np.moveaxis(place.get(order, zero), 0, -2) for order in orders.tolist()]
    return np.stack(each, axis=-3)


def _moments_of_motion(
    line: Driveline, motion: SteadyState, speeds: FloatArray, orders: FloatArray
) -> ComplexArray:
    """Return the amplitudes of moments of a torsional motion."""
    if motion._system.line.n_joints != line.n_joints:
        raise ArgumentValueError("load", "is the motion of a driveline with other joints")
    if not (motion._speed.shape == speeds.shape and np.all(motion._speed == speeds)):
        raise ArgumentValueError("load", "is a motion at other speeds than those of the response")
    turns = motion._system.period_turns
    highest = max(1.0, float(orders.max(initial=0.0)))
    samples = _SAMPLES
    while samples < 16.0 * highest * turns:
        samples *= 2
    moments = motion.evaluate(samples, "moment").moment
    spectrum = np.fft.fft(moments, axis=-2) / samples
    found = np.zeros((*moments.shape[:-2], len(orders), 3), np.complex128)
    for i, order in enumerate(orders.tolist()):
        number = order * turns
        if number == round(number):
            scale = 1.0 if number == 0.0 else 2.0
            found[..., i, :] = scale * spectrum[..., round(number), :]
    return np.moveaxis(found, 0, -2)

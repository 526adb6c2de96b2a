"""The section [lateral]: the shafts of a driveline as beams on elastic bearings."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

from cardan.app.scene.language.rules import INDEX, NOT_NEGATIVE, POSITIVE, VECTOR, ListOf, Number
from cardan.app.scene.language.section import Key, Reading, Section, check_exists
from cardan.app.scene.language.units import RPM
from cardan.app.scene.sections.bearing import BEARING, STIFFNESS, Bearing, check_across
from cardan.app.scene.sections.driveline import LENGTHS_NEEDED, has_lengths
from cardan.app.scene.sections.torsion import SpeedValues
from cardan.app.scene.sections.tubes import TUBES, Tubes
from cardan.arrays import FloatArray
from cardan.arrays.errors import ArgumentValueError
from cardan.driveline import Driveline
from cardan.lateral import ElasticBearing, LateralSystem, PointMass, RigidShaft, Unbalance
from cardan.torsion import Tube, tube

_MASS = Number(0, 1e6, what="a mass")
_INERTIA = Number(0, 1e6, what="an inertia")


@dataclass(frozen=True, eq=False)
class LateralCase:
    """Shafts of a scene that bend, and their bearings.

    Attributes:
        speed: drive speeds in rad/s, rising; empty if the scene gives none.
        margin: least distance of resonances from the speeds in shares of them, if any.
        torque_margin: least ratio of the torque that makes motion unstable to that of the load.
        tubes: the round sections, for those of ``bending``.
        bending: the shafts that are tubes and bend.
        rigid: mass, centre and inertias of shafts that do not bend, by shaft.
        supports: for each bearing the arguments of ``ElasticBearing`` but the place; empty of a
            rigid one.
        masses: point masses, each with the arguments of ``PointMass`` but the place.
        unbalance: likewise of ``Unbalance``.
        tube_loss: loss factor of the tubes; ``None`` if the scene gives none.
        sliding: for each joint the shaft that slides in its spline; ``None`` for the default.
        rigid_bearings: bearings of shafts that move which the scene gives no stiffness. With any
            of these there is no system, and only the moments of the joints are known.
    """

    speed: FloatArray
    margin: float | None
    torque_margin: float
    tubes: Tubes | None
    bending: tuple[int, ...]
    rigid: Mapping[int, Mapping[str, float]]
    supports: tuple[Mapping[str, Any], ...]
    masses: tuple[Bearing, ...]
    unbalance: tuple[Bearing, ...]
    tube_loss: float | None
    sliding: tuple[int, ...] | None
    rigid_bearings: tuple[int, ...]

    @property
    def moving(self) -> tuple[int, ...]:
        """The shafts that are no part of a machine."""
        return tuple(sorted({*self.bending, *self.rigid}))

    @property
    def elastic(self) -> tuple[int, ...]:
        """The bearings that have a stiffness, by their numbers in the scene."""
        return tuple(i for i, support in enumerate(self.supports) if support)

    def stiffened(self, bearing: int, factor: float) -> LateralCase:
        """Return the same with the stiffness of one bearing multiplied by a factor."""
        own = self.supports[bearing]
        changed = {**own, "stiffness": factor * np.asarray(own["stiffness"])}
        supports = (*self.supports[:bearing], changed, *self.supports[bearing + 1 :])
        return replace(self, supports=supports)

    def damped(self, loss: float) -> LateralCase:
        """Return the same with one loss factor for all bearings and tubes."""
        supports = tuple(own and {**own, "loss_factor": loss} for own in self.supports)
        return replace(self, supports=supports, tube_loss=loss)

    def on(self, line: Driveline) -> LateralSystem:
        """Return the system of one driveline in its bearings."""
        lengths = np.asarray(line.lengths().each)
        shafts = [self._shaft(i, float(length)) for i, length in enumerate(lengths)]
        return LateralSystem(
            line,
            shafts=shafts,
            bearings=[
                ElasticBearing(shaft, float(position), **support)
                for (shaft, position), support in zip(line.bearings, self.supports, strict=True)
                if support
            ],
            masses=[PointMass(m.shaft, m.position(lengths), **m.support) for m in self.masses],
            unbalance=[
                Unbalance(m.shaft, m.position(lengths), **m.support) for m in self.unbalance
            ],
            sliding=self.sliding,
        )

    def _shaft(self, shaft: int, length: float) -> RigidShaft | Tube | None:
        if shaft in self.rigid:
            given = self.rigid[shaft]
            mass = given["mass"] if "mass" in given else float(self._tube(shaft, length).mass)
            rod = mass * length**2 / 12.0
            return RigidShaft(
                mass,
                given.get("centre", 0.5 * length),
                given.get("across", rod),
                given.get("along", 0.0),
            )
        if shaft not in self.bending:
            return None
        return self._tube(shaft, length)

    def _tube(self, shaft: int, length: float) -> Tube:
        """Return the tube of a shaft with the length that it has between its joints."""
        tubes = self.tubes
        assert tubes
        place = tubes.shafts.index(shaft)
        own: dict[str, Any] = {key: float(value[place]) for key, value in tubes.given.items()}
        own |= {"length": length, "rotary": True, "loss_factor": self.tube_loss or 0.0}
        return tube(**own)


def _lateral(values: Mapping[str, Any], scene: Reading) -> LateralCase:
    line, tubes, mounting = scene.line, scene[TUBES], scene[BEARING].mounting
    count = line.n_joints + 1
    LATERAL.check_counts(values, line.n_joints)
    if not has_lengths(line):
        raise ValueError(f"the shafts have no lengths; give {LENGTHS_NEEDED}")
    lengths = np.asarray(line.lengths().each)
    supports = tuple(bearing.support for bearing in mounting.bearings)
    rigid: dict[int, Mapping[str, float]] = {}
    for i, given in enumerate(values.get("rigid", [])):
        with scene.document.within(f"{RIGID.name}.{i}"):
            shaft = given["shaft"]
            check_exists("shaft", shaft, count)
            if shaft in rigid:
                raise ArgumentValueError("shaft", f"is {shaft} again; describe each shaft once")
            if "mass_kg" not in given and not (tubes and shaft in tubes.shafts):
                raise ArgumentValueError("mass_kg", f"is missing; shaft {shaft} is not in [tubes]")
            _check_place("centre_mm", given.get("centre_mm", 0.0), lengths[shaft], shaft)
            rigid[shaft] = RIGID.arguments(given)
    on_springs = {bearing.shaft for bearing in mounting.bearings if bearing.support}
    bending = []
    for shaft in range(count):
        is_end = shaft in (0, count - 1)
        if shaft in rigid:
            continue
        if tubes and shaft in tubes.shafts and (not is_end or shaft in on_springs):
            bending.append(shaft)
        elif not is_end or shaft in on_springs:
            raise ValueError(
                f"shaft {shaft} moves, but its mass is not known: list it in [tubes], or describe "
                "it as a section [[lateral.rigid]]"
            )
    moving = {*rigid, *bending}
    for j, pair in enumerate(pairwise(range(count))):
        if moving.isdisjoint(pair):
            raise ValueError(
                f"joint {j} joins two shafts that are held by their machines, shafts {j} and "
                f"{j + 1}; a machine that moves is a [[lateral.rigid]] shaft on bearings with "
                f"{STIFFNESS}"
            )
    on_rigid = tuple(
        i for i, own in enumerate(mounting.bearings) if own.shaft in moving and not own.support
    )
    if on_rigid and any(supports):
        with scene.document.within(f"{BEARING.name}.{on_rigid[0]}"):
            raise ArgumentValueError(STIFFNESS, "is missing; another bearing has one")
    for key in ("resonance_margin", "least_torque_margin") if on_rigid else ():
        if key in values:
            raise ArgumentValueError(key, f"needs {STIFFNESS} in [[bearing]]")
    if not on_rigid and "speed_rpm" not in values:
        raise ArgumentValueError(
            "speed_rpm", "is missing; it says at which speeds the driveline runs"
        )
    attached = {
        section: tuple(_attached(section, values.get(key, []), moving, scene))
        for key, section in (("mass", MASS), ("unbalance", UNBALANCE))
    }
    case = LateralCase(
        speed=RPM * np.asarray(values.get("speed_rpm", [])),
        margin=values.get("resonance_margin"),
        torque_margin=values.get("least_torque_margin", 1.0),
        tubes=tubes,
        bending=tuple(bending),
        rigid=rigid,
        supports=supports,
        masses=attached[MASS],
        unbalance=attached[UNBALANCE],
        tube_loss=values.get("tube_loss_factor"),
        sliding=tuple(values["sliding"]) if "sliding" in values else None,
        rigid_bearings=on_rigid,
    )
    if not on_rigid:
        with _as_written(scene):
            case.on(line).natural_frequencies(1)
    return case


@contextmanager
def _as_written(scene: Reading) -> Iterator[None]:
    """Let errors of bearings, masses and unbalances name the tables that they are about."""
    names = {"bearings": BEARING.name, "masses": MASS.name, "unbalance": UNBALANCE.name}
    try:
        yield
    except ArgumentValueError as error:
        if error.argument in names and error.place:
            with scene.document.within(f"{names[error.argument]}.{int(error.place[0])}"):
                raise ValueError(error.problem) from None
        raise


def _check_place(key: str, value: float, length: float, shaft: int) -> None:
    """Refuse a distance in mm beyond the end of its shaft, of a length in m."""
    if value > 1e3 * length * (1.0 + 1e-9):
        problem = f"is {value:.10g} mm on shaft {shaft} of length {1e3 * length:.10g} mm"
        raise ArgumentValueError(key, problem)


def _attached(
    section: Section[Any], tables: list[dict[str, Any]], moving: set[int], scene: Reading
) -> Iterator[Bearing]:
    lengths = np.asarray(scene.line.lengths().each)
    for i, given in enumerate(tables):
        with scene.document.within(f"{section.name}.{i}"):
            shaft = given["shaft"]
            check_exists("shaft", shaft, len(lengths))
            if shaft not in moving:
                problem = f"is {shaft}, which its machine holds: nothing moves there"
                raise ArgumentValueError("shaft", problem)
            key = next(key for key in given if key in _PLACES)
            _check_place(key, given[key], lengths[shaft], shaft)
            own = section.arguments(given)
            if "direction" in own:
                check_across("direction", own["direction"], scene.line.directions[shaft])
            yield Bearing(shaft, key, given[key], own)


_PLACES = ("position_mm", "from_end_mm")
_PLACED: Mapping[str, Key] = {
    "shaft": Key(INDEX, "its shaft, counted from 0"),
    _PLACES[0]: Key(NOT_NEGATIVE, "distance from the upstream end of the shaft"),
    _PLACES[1]: Key(NOT_NEGATIVE, "or: distance from the downstream end of the shaft"),
}
_NEEDED = (("shaft",), _PLACES)

MASS: Section[Mapping[str, Any]] = Section(
    "lateral.mass",
    "a yoke, flange or disc on a shaft that moves; give one section for each",
    {
        **_PLACED,
        "mass_kg": Key(_MASS, "its mass", "mass"),
        "across_kgm2": Key(
            _INERTIA, "moment of inertia about an axis across the shaft; default 0", "across"
        ),
        "along_kgm2": Key(
            _INERTIA, "moment of inertia about the axis of the shaft; default 0", "along"
        ),
    },
    lambda values, _: values,
    together=(_PLACES,),
    needed=(*_NEEDED, ("mass_kg",)),
    repeated=True,
)

UNBALANCE: Section[Mapping[str, Any]] = Section(
    "lateral.unbalance",
    "an unbalance of a shaft that moves, which excites order 1",
    {
        **_PLACED,
        "unbalance_gmm": Key(NOT_NEGATIVE, "mass times distance from the axis", "mass_arm", 1e-6),
        "direction": Key(
            VECTOR,
            "its direction at drive angle 0; the component along the shaft is ignored",
            "direction",
        ),
    },
    lambda values, _: values,
    together=(_PLACES,),
    needed=(*_NEEDED, ("unbalance_gmm",), ("direction",)),
    repeated=True,
)

RIGID: Section[Mapping[str, Any]] = Section(
    "lateral.rigid",
    "a shaft that moves and does not bend, such as an engine with its gearbox on mounts",
    {
        "shaft": Key(INDEX, "which shaft, counted from 0"),
        "mass_kg": Key(_MASS, "its mass; default: that of its tube in [tubes]", "mass"),
        "centre_mm": Key(
            NOT_NEGATIVE,
            "distance of its centre of mass from its upstream end; default: the middle",
            "centre",
            1e-3,
        ),
        "across_kgm2": Key(
            _INERTIA,
            "moment of inertia about an axis across it through the centre of mass; default: that "
            "of a uniform rod",
            "across",
        ),
        "along_kgm2": Key(
            _INERTIA, "moment of inertia about the axis of the shaft; default 0", "along"
        ),
    },
    lambda values, _: values,
    needed=(("shaft",),),
    repeated=True,
)

LATERAL: Section[LateralCase | None] = Section(
    "lateral",
    "lateral vibration: shafts that bent joints shake on elastic bearings. Shafts of [tubes] bend, "
    "and machines hold the first and the last shaft unless these have bearings with "
    "stiffness_N_per_mm",
    {
        "speed_rpm": Key(
            SpeedValues(),
            "drive speeds at which the driveline runs: {from = …, to = …, steps = …} or a list; "
            "needed unless a bearing of a shaft that moves is rigid",
        ),
        "tube_loss_factor": Key(
            Number(0, 1, what="a loss factor"),
            "loss factor of the tubes in bending, from order 2 on; about 0.01; default: unknown",
        ),
        "sliding": Key(
            ListOf(INDEX, "whole numbers"),
            "for each joint the one of its two shafts that slides in its spline; default: the "
            "shaft that the joint supports, else the driven one",
            per="joint",
        ),
        "resonance_margin": Key(
            POSITIVE,
            "least distance of resonances of excited orders from speed_rpm, in shares of the "
            "resonance, such as 0.16",
        ),
        "least_torque_margin": Key(
            POSITIVE,
            "least ratio of the torque at which the motion becomes unstable to that of [load]",
            default=1,
        ),
    },
    _lateral,
    recorded_bends=False,
    inner={"mass": MASS, "unbalance": UNBALANCE, "rigid": RIGID},
)

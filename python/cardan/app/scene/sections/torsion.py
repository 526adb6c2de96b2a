"""The section [torsion]: the shafts as torsion springs."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from itertools import pairwise
from typing import Any, Literal

import numpy as np

from cardan.app.scene.language.errors import Location
from cardan.app.scene.language.rules import (
    INDEX,
    POSITIVE,
    SPREAD,
    START,
    TEXTS,
    ListOf,
    Number,
    OneOf,
    OneOrMore,
    Rule,
    Schema,
    Table,
    Whole,
    each,
    numbers,
    refused,
    shown,
)
from cardan.app.scene.language.section import Key, Reading, Section, check_count, check_exists
from cardan.app.scene.language.units import RPM
from cardan.app.scene.sections.tubes import TUBES
from cardan.arrays import FloatArray
from cardan.arrays.errors import ArgumentValueError
from cardan.evaluation.load import Load
from cardan.torsion import Coupling, TorqueHarmonic, TorsionalSystem, firing_harmonics
from cardan.torsion.analyses import harmonic_orders, is_damped

ORDERS = (2.0, 4.0)
"""The orders of the drive's rotation that are listed by default; those of torques as well."""

_RIGID, _TUBE, _COUPLING = "rigid", "tube", "coupling"
_STIFFNESSES = "stiffnesses_Nm_per_rad"

# No shaft of a machine is beyond these ends, and within them the equations can be solved.
_INERTIA = Number(0, 1e6, what="an inertia")
_STIFFNESS = Number(1e-3, 1e12, what="a stiffness")
_DAMPING = Number(0, 1e9, what="a damping")
_SPEED = Number(1e-3, 1e6, what="a speed")
_ORDER = Number(0, 256, above=True, what="an order")
_PERCENT = Number(0, 100)

_SPREAD = Table(
    {"from": _SPEED, "to": _SPEED, "steps": Whole(2, most=100_000)}, f"{SPREAD} or a list of speeds"
)


@dataclass(frozen=True)
class ShaftStiffness(Rule):
    """The stiffness of a shaft: a number, ``"rigid"``, ``"tube"`` or ``"coupling"``."""

    number: Number = _STIFFNESS
    name = "stiffness"

    def read(self, where: Location, value: object) -> float | str:
        """Return the stiffness, infinite for a rigid shaft, or a word for what it has."""
        if value == _RIGID:
            return math.inf
        if value in (_TUBE, _COUPLING):
            return str(value)
        if isinstance(value, str) or value == math.inf:
            words = f'be a positive number, "{_RIGID}", "{_TUBE}" or "{_COUPLING}"'
            raise refused(where, value, words)
        return self.number.read(where, value)

    @property
    def schema(self) -> Schema:
        return {"oneOf": [self.number.schema, {"enum": [_RIGID, _TUBE, _COUPLING]}]}


@dataclass(frozen=True)
class Rising(ListOf):
    """The points of a curve: two values at least, each above the one before."""

    why: str = ""

    def read(self, where: Location, value: object) -> list[Any]:
        points = super().read(where, value)
        if len(points) < 2:
            raise where.error(f"is {shown(value)}; a curve needs two points at least")
        for i, (before, point) in enumerate(pairwise(points), start=1):
            if not point > before:
                must = f"it must be above the value before, {before:g}"
                raise where.at(i).error(f"is {point:g}; {must}{self.why}")
        return points

    @property
    def schema(self) -> Schema:
        return {**super().schema, "minItems": 2}


@dataclass(frozen=True)
class SpeedValues(Rule):
    """The drive speeds at which a driveline runs: evenly spread or listed."""

    name = "speeds"

    def read(self, where: Location, value: object) -> FloatArray:
        """Return the speeds, rising, ``(speeds,)``."""
        if isinstance(value, list):
            speeds: list[float] = ListOf(_SPEED, "speeds", distinct=True).read(where, value)
            if len(speeds) < 2:
                raise where.error(f"is {shown(value)}; name at least two speeds")
            return np.array(sorted(speeds))
        spread = _SPREAD.read(where, value)
        start, stop = spread["from"], spread["to"]
        if start >= stop:
            raise where.at("to").error(f"is {stop:g}; it must be above 'from', {start:g}")
        return np.asarray(np.linspace(start, stop, spread["steps"]), dtype=np.float64)

    @property
    def schema(self) -> Schema:
        listed = {"type": "array", "items": _SPEED.schema, "minItems": 2, "uniqueItems": True}
        return {"oneOf": [listed, _SPREAD.schema]}


@dataclass(frozen=True)
class Ratings:
    """Catalogue ratings of a coupling in N m; ``None`` where the scene gives none.

    Attributes:
        rated: mean torque, continuously.
        largest: torque at any instant, now and then.
        vibratory: amplitude of a torque that varies at 10 Hz, continuously.
    """

    rated: float | None
    largest: float | None
    vibratory: float | None


@dataclass(frozen=True, eq=False)
class TorsionCase:
    """A scene's shafts as torsion springs, and the speeds at which they are judged.

    Attributes:
        system: the torsional system.
        speed: drive speeds in rad/s, rising.
        orders: of the drive's rotation, rising, those of harmonic torques among them.
        margin: least distance of critical speeds from the speeds in shares of them, if any.
        drive: ``"free"``, ``"held"``, or ``""`` if the scene does not say that it is held.
        names: of the shafts; empty if they have none.
        ratings: of couplings by their shafts.
        motor: speeds in rad/s and torques in N m of the curve of the motor, if any.
        unstable: share of the range of speeds in which motion may be unstable, if it is limited.
        rattle: share in which a torque may change its sign, if it is limited.
        apart: inertias without those of tubes in kg m², ``(shafts, 2)``.
        springs: the shafts with the stiffness of their tube.
        is_loaded: whether the load torque is that of [load].
        by_ratio: whether damping_ratio gives its viscous damping.
    """

    system: TorsionalSystem
    speed: FloatArray
    orders: tuple[float, ...]
    margin: float | None
    drive: Literal["held", "free", ""] = ""
    names: tuple[str, ...] = ()
    ratings: Mapping[int, Ratings] = field(default_factory=dict)
    motor: tuple[FloatArray, FloatArray] | None = None
    unstable: float | None = None
    rattle: float | None = None
    apart: FloatArray = field(default_factory=lambda: np.zeros(0))
    springs: tuple[int, ...] = ()
    is_loaded: bool = False
    by_ratio: bool = False

    @property
    def excited(self) -> tuple[float, ...]:
        """The orders that joints or harmonic torques excite."""
        of_torques = harmonic_orders(self.system)
        return tuple(order for order in self.orders if order % 2.0 == 0.0 or order in of_torques)

    @property
    def is_searched(self) -> bool:
        """Whether a check searches for the motion over the speeds.

        It does of a free drive, of harmonic torques and of couplings, and where limits need it.
        """
        system = self.system
        has_engine = system.free or bool(system.harmonics) or bool(system.couplings)
        return has_engine or self.unstable is not None or self.rattle is not None

    @property
    def without_effect(self) -> float:
        """The inertia in kg m² that turns with the drive at constant speed; 0 if it is free."""
        if self.system.free:
            return 0.0
        ends = self.system.inertias[..., 0, :]
        return float(np.sum(ends) if 0 not in self.system.compliant else ends[..., 0])


def _torsion(values: Mapping[str, Any], scene: Reading) -> TorsionCase:
    line, tubes = scene.line, scene[TUBES]
    TORSION.check_counts(values, line.n_joints)
    of_tubes: dict[int, float] = {}
    # A number is the inertia of a whole shaft, a pair that of its ends.
    inertias = np.array(
        [end if isinstance(end, list) else [0.5 * end] * 2 for end in values["inertias_kgm2"]]
    )
    apart = inertias.copy()
    if tubes is not None:
        of_tubes = dict(zip(tubes.shafts, np.asarray(tubes.tube.stiffness).tolist(), strict=True))
        inertias[list(tubes.shafts)] += 0.5 * np.asarray(tubes.tube.inertia)[:, np.newaxis]
    shafts = line.n_joints + 1
    couplings = _couplings(values.get("coupling", []), shafts, scene)
    harmonics: list[TorqueHarmonic] = []
    for i, given in enumerate(values.get("harmonic", [])):
        with scene.document.within(f"{HARMONIC.name}.{i}"):
            check_exists("shaft", given.get("shaft", 0), shafts)
            harmonics += _harmonics_of(given)
    drive, at_drive = values.get("drive", ""), values["inertias_kgm2"][0]
    by_shaft = _stiffnesses(values, shafts, of_tubes, couplings)
    arguments = TORSION.arguments(values) | {
        "inertias": inertias,
        "stiffnesses": [
            {_TUBE: of_tubes.get(i), _COUPLING: math.inf}.get(own, own)
            for i, own in enumerate(by_shaft)
        ],
        "load_torque": _load_torque(values, scene.load),
        "harmonics": tuple(harmonics),
        "couplings": couplings,
    }
    if not drive and not (at_drive[0] if isinstance(at_drive, list) else at_drive):
        # The half of a tube at the drive is no inertia of the drive.
        arguments["drive"] = "held"
    if drive != "free":
        for key, what in (("drive_slope_Nms_per_rad", "the slope"), ("motor", "the curve")):
            if key in values:
                problem = (
                    f'needs drive = "free"; a drive that is held has its speed, whatever {what}'
                )
                raise ArgumentValueError(key, problem)
    if "dampings" not in arguments:
        arguments.setdefault("damping_ratios", 0.0)
    with (
        _placed([*couplings], scene),
        TORSION.named(TORSION.keys),
        np.errstate(divide="ignore", invalid="ignore"),
    ):
        system = TorsionalSystem(line, **arguments)
    if not np.all(system.natural_frequencies() > 0.0):
        raise ValueError(
            "stiffnesses and inertias differ by too many orders of magnitude; a shaft that is much "
            'stiffer than the others is "rigid"'
        )
    speed = RPM * values["speed_rpm"]
    _check_limited(system, speed)
    return TorsionCase(
        system,
        speed,
        tuple(sorted({*values.get("orders", ORDERS), *harmonic_orders(system)})),
        values.get("resonance_margin"),
        drive,
        tuple(values.get("names", ())),
        {each["shaft"]: _ratings(each) for each in values.get("coupling", ())},
        _motor(values["motor"], scene) if "motor" in values else None,
        _share(values.get("unstable_percent")),
        _share(values.get("rattle_percent")),
        apart=apart,
        springs=tuple(i for i, own in enumerate(by_shaft) if own == _TUBE),
        is_loaded="load_torque_Nm" not in values and scene.load is not None,
        by_ratio="damping_ratio" in values,
    )


def _share(percent: float | None) -> float | None:
    return None if percent is None else 0.01 * percent


def _check_limited(system: TorsionalSystem, speed: FloatArray) -> None:
    """Refuse resonances of torques within the speeds in which nothing limits the torque."""
    orders = harmonic_orders(system)
    if is_damped(system) or not orders:
        return
    natural = system.natural_frequencies()
    for order, frequency in ((order, own) for order in orders for own in natural):
        if speed[0] <= frequency / order <= speed[-1]:
            raise ArgumentValueError(
                "speed_rpm",
                f"contains {frequency / order / RPM:.4g} rpm, where order {order:g} of the torques "
                f"meets the natural frequency of {frequency / math.tau:.3g} Hz, and nothing damps "
                "it: give damping_ratio, dampings_Nms_per_rad or relative_damping of a coupling",
            )


def _stiffnesses(
    values: Mapping[str, Any],
    shafts: int,
    of_tubes: Mapping[int, float],
    couplings: Mapping[int, Coupling],
) -> list[Any]:
    """Stiffness of each shaft in N m/rad, infinite for a rigid one, or a word for what it has."""
    if _STIFFNESSES not in values and not of_tubes and not couplings:
        raise ArgumentValueError(
            _STIFFNESSES, "is missing; give it, a section [tubes] or a [[torsion.coupling]]"
        )
    by_default = [
        _COUPLING if i in couplings else _TUBE if i in of_tubes else np.inf for i in range(shafts)
    ]
    given = values.get(_STIFFNESSES, by_default)
    for i, stiffness in enumerate(given):
        problem = ""
        if stiffness == _TUBE and i not in of_tubes:
            problem = f"is {_TUBE!r}; shaft {i} is not in [tubes]"
        if (stiffness == _COUPLING) != (i in couplings):
            own = _RIGID if stiffness == np.inf else stiffness
            problem = f"is {own!r}; shaft {i} has no [[torsion.coupling]]"
            if i in couplings:
                problem = f'is {own!r}; write "{_COUPLING}", which [[torsion.coupling]] describes'
        if problem:
            raise ArgumentValueError(_STIFFNESSES, problem, (i,))
    return list(given)


def _couplings(tables: list[dict[str, Any]], shafts: int, scene: Reading) -> dict[int, Coupling]:
    made: dict[int, Coupling] = {}
    for i, values in enumerate(tables):
        with scene.document.within(f"{COUPLING.name}.{i}"):
            shaft = values["shaft"]
            check_exists("shaft", shaft, shafts)
            if shaft in made:
                raise ArgumentValueError("shaft", f"is {shaft} again; a shaft has one coupling")
            for one, other in (("twist_deg", "torque_Nm"), _BY_MEAN):
                if one in values:
                    check_count(other, values[other], len(values[one]), f"as many as {one}")
            with COUPLING.named(COUPLING.keys):
                made[shaft] = Coupling(
                    **COUPLING.arguments(values), contact_damping=values.get("damper") == "contact"
                )
    lossy = [shaft for shaft, own in made.items() if own.loss_factor > 0.0]
    kinked = [shaft for shaft, own in made.items() if own.play > 0.0 or own.twist is not None]
    if lossy and kinked and not set(lossy) & set(kinked):
        raise ValueError(
            f"the coupling of shaft {lossy[0]} has a constant loss per cycle, and that of shaft "
            f"{kinked[0]} has play or a curve; motions are found with one or the other. Give shaft "
            f"{lossy[0]} a damping instead: dampings_Nms_per_rad = stiffness · ψ/(2π ω), with "
            "ω = 2π times the natural frequency"
        )
    return made


def _ratings(values: Mapping[str, Any]) -> Ratings:
    return Ratings(*(values.get(f"{name}_torque_Nm") for name in ("rated", "largest", "vibratory")))


def _harmonics_of(values: Mapping[str, Any]) -> list[TorqueHarmonic]:
    shaft, end, orders = values.get("shaft", 0), values.get("end", "input"), values["order"]
    zeros = [0.0] * len(orders)
    given = {k: values.get(k, zeros) for k in ("cos_Nm", "sin_Nm", "phase_deg", "amplitude_Nm")}
    for key, each_order in given.items():
        check_count(key, each_order, len(orders), "as many as orders")
    phases, sizes = np.radians(given["phase_deg"]), np.array(given["amplitude_Nm"])
    cosines = np.array(given["cos_Nm"]) + sizes * np.cos(phases)
    sines = np.array(given["sin_Nm"]) + sizes * np.sin(phases)
    own = list(zip(orders, cosines.tolist(), sines.tolist(), strict=True))
    if "firing_order" not in values:
        return [TorqueHarmonic(shaft, end, *each) for each in own]
    strokes, firing = values.get("strokes", 4), values["firing_order"]
    engine = firing_harmonics(own, firing, strokes=strokes, shaft=shaft)
    if not engine:
        raise ArgumentValueError(
            "order",
            f"is {', '.join(f'{order:g}' for order in orders)}; of {len(firing)} cylinders only "
            f"multiples of {2.0 * len(firing) / strokes:g} remain, all others cancel",
        )
    return [replace(each, end=end) for each in engine]


def _motor(values: Mapping[str, Any], scene: Reading) -> tuple[FloatArray, FloatArray]:
    with scene.document.within(MOTOR.name):
        speed, torque = values["speed_rpm"], values["torque_Nm"]
        check_count("torque_Nm", torque, len(speed), "as many as speed_rpm")
        return RPM * np.array(speed), np.array(torque)


@contextmanager
def _placed(shafts: list[int], scene: Reading) -> Iterator[None]:
    """Let errors of couplings and harmonics name the tables of the scene that they are about."""
    try:
        yield
    except ArgumentValueError as error:
        if error.argument == "couplings" and error.place:
            table = shafts.index(int(error.place[0]))
            with scene.document.within(f"{COUPLING.name}.{table}"):
                raise ValueError(error.problem) from None
        if error.argument == "harmonics":
            raise ValueError(f"harmonics {error.problem}") from None
        raise


def _load_torque(values: Mapping[str, Any], load: Load | None) -> float:
    if "load_torque_Nm" in values:
        return float(values["load_torque_Nm"])
    if load is None:
        return 0.0
    if np.ndim(load.torque):
        raise ArgumentValueError(
            "load_torque_Nm", "is missing; the recorded torque of [angles] varies"
        )
    # At constant drive speed the mean torques of drive and output are equal.
    return float(load.torque)


_TORQUES = ListOf(START, "torques")
_BY_MEAN = ("mean_torque_Nm", "stiffness_by_mean_Nm_per_rad")

HARMONIC: Section[list[TorqueHarmonic]] = Section(
    "torsion.harmonic",
    "a torque that varies with the angle of a shaft end: gas torque of an engine, blades of a "
    "propeller, a pump, teeth. It does no work; the mean torque is that of the load",
    {
        "shaft": Key(INDEX, "on which shaft it acts", default=0),
        "end": Key(OneOf(("input", "output")), "on which end of the shaft", default="input"),
        "order": Key(
            numbers(_ORDER),
            "how often it repeats in a turn of this end, such as 3 for three blades; multiples of "
            "0.5 for four strokes; one or several",
        ),
        "amplitude_Nm": Key(numbers(START), "amplitude of each order"),
        "phase_deg": Key(
            numbers(), "and phase: the torque is amplitude · cos(order · angle - phase); default 0"
        ),
        "cos_Nm": Key(
            numbers(START),
            "or: amplitude of cos(order · angle) of each order. Of one cylinder the maker of the "
            "engine has them, or tables of a tangential pressure, times the area of the piston and "
            "the radius of the crank (F. P. Porter, 1943)",
        ),
        "sin_Nm": Key(numbers(START), "and amplitude of sin(order · angle)"),
        "firing_order": Key(
            ListOf(Whole(1), "whole numbers", distinct=True),
            "of an engine with evenly spaced firings: its cylinders in the order in which they "
            "fire, such as [1, 3, 2]. The orders above are then those of one cylinder that fires "
            "at the angle 0, and those of the engine follow",
        ),
        "strokes": Key(Whole(2, most=4), "of the engine: 2 or 4; default 4"),
    },
    lambda values, _: _harmonics_of(values),
    together=(("amplitude_Nm", "cos_Nm"), ("amplitude_Nm", "sin_Nm")),
    needed=(("order",), ("amplitude_Nm", "cos_Nm", "sin_Nm")),
    with_key=(("phase_deg", "amplitude_Nm"), ("strokes", "firing_order")),
    repeated=True,
)

COUPLING: Section[Ratings] = Section(
    "torsion.coupling",
    "a coupling as the spring of a shaft: of rubber, progressive, or with play; with its ratings",
    {
        "shaft": Key(INDEX, "which shaft it is"),
        "stiffness_Nm_per_rad": Key(_STIFFNESS, "its dynamic stiffness", "stiffness"),
        "twist_deg": Key(
            Rising(Number(), "angles"),
            "or, of a progressive coupling: twist at each kink of its curve, from 0 if both "
            "directions are alike. The curve is linear between the kinks and extrapolated beyond",
            "twist",
            math.radians(1.0),
        ),
        "torque_Nm": Key(
            Rising(START, "torques", why="; the torque of a coupling rises with its twist"),
            "and its torque there",
            "torque",
        ),
        _BY_MEAN[0]: Key(
            Rising(START, "torques"),
            "or, as catalogues of rubber couplings have it: mean torques",
            "mean_torque",
        ),
        _BY_MEAN[1]: Key(
            ListOf(_STIFFNESS, "stiffnesses"),
            "and the stiffness at each of them; linear between them, constant beyond",
            "stiffness_by_mean",
        ),
        "play_deg": Key(
            Number(0, 360),
            "free angle from one flank to the other, in which there is no torque",
            "play",
            math.radians(1.0),
        ),
        "damper": Key(
            OneOf(("always", "contact")),
            "whether the damping of the shaft always acts, or only in contact, outside the play",
            default="always",
        ),
        "relative_damping": Key(
            Number(0, 20),
            "ψ of catalogues: energy lost in a cycle, in shares of the elastic energy",
            "loss_factor",
            1.0 / math.tau,
        ),
        "loss_factor": Key(Number(0, 3), "or: tangent of the loss angle, ψ/(2 π)", "loss_factor"),
        "rated_torque_Nm": Key(
            POSITIVE, "mean torque that it can carry continuously, T_KN of catalogues"
        ),
        "largest_torque_Nm": Key(
            POSITIVE, "largest torque that it can carry occasionally, as in a resonance, T_Kmax"
        ),
        "vibratory_torque_Nm": Key(
            POSITIVE, "amplitude that it can carry continuously at 10 Hz, T_KW"
        ),
    },
    lambda values, _: _ratings(values),
    together=(
        ("stiffness_Nm_per_rad", "twist_deg"),
        ("stiffness_Nm_per_rad", _BY_MEAN[0]),
        ("twist_deg", _BY_MEAN[0]),
        ("relative_damping", "loss_factor"),
    ),
    needed=(("shaft",), ("stiffness_Nm_per_rad", "twist_deg", _BY_MEAN[0])),
    with_key=(
        ("twist_deg", "torque_Nm"),
        ("torque_Nm", "twist_deg"),
        _BY_MEAN,
        (_BY_MEAN[1], _BY_MEAN[0]),
        ("damper", "play_deg"),
    ),
    repeated=True,
)

MOTOR: Section[tuple[FloatArray, FloatArray]] = Section(
    "torsion.motor",
    "torque curve of a motor; the answer has the speeds at which its torque is the one needed",
    {
        "speed_rpm": Key(Rising(_SPEED, "speeds"), "speeds of the curve"),
        "torque_Nm": Key(_TORQUES, "its torque at each of them; linear between them"),
    },
    _motor,
    needed=(("speed_rpm",), ("torque_Nm",)),
)

TORSION: Section[TorsionCase | None] = Section(
    "torsion",
    "torsional vibration: shafts as springs with inertias at their ends",
    {
        "inertias_kgm2": Key(
            ListOf(each(_INERTIA, "two numbers", count=2), "inertias"),
            "of each shaft: a number, half of it at each end, or [input end, output end]; the "
            "inertia of a shaft in [tubes] is added",
            "inertias",
            per="shaft",
            kind="inertias",
        ),
        _STIFFNESSES: Key(
            ListOf(ShaftStiffness(), "stiffnesses"),
            'of each shaft: a number, "rigid", "tube" for the stiffness by [tubes], or "coupling"; '
            "default: the shafts of [tubes] and couplings are springs, all others rigid",
            "stiffnesses",
            per="shaft",
            kind="stiffnesses",
        ),
        "damping_ratio": Key(
            each(Number(0, 100, what="a ratio")),
            "damping ratio of the lowest vibration: one number, or one per shaft; default 0. It is "
            "viscous, so that of others is greater in proportion to their frequency: 1 % at 12 Hz "
            "is 20 % at 240 Hz",
            "damping_ratios",
            per="shaft",
        ),
        "dampings_Nms_per_rad": Key(
            ListOf(_DAMPING, "numbers"), "or: damping of each shaft", "dampings", per="shaft"
        ),
        "load_torque_Nm": Key(
            START, "torque that brakes the last shaft; default: the torque of [load]", "load_torque"
        ),
        "load_damping_Nms_per_rad": Key(
            _DAMPING, "viscous load on the last shaft", "load_damping", default=0
        ),
        "drive": Key(
            OneOf(("held", "free")),
            "input end of shaft 0: held at constant speed, where an inertia has no effect; or "
            "free, with the inertia of engine or motor, and a speed that varies",
            "drive",
        ),
        "drive_slope_Nms_per_rad": Key(
            Number(0, 1e9, what="the fall of the drive's torque with rising speed"),
            "of a free drive: how much its torque falls with its speed; default: its mean torque "
            "keeps the mean speed",
            "drive_slope",
        ),
        "names": Key(TEXTS, "of each shaft, as the answer names it", per="shaft"),
        "speed_rpm": Key(
            SpeedValues(),
            "drive speeds at which the driveline runs: {from = …, to = …, steps = …} or a list",
        ),
        "orders": Key(
            OneOrMore(ListOf(_ORDER, "orders", distinct=True), (int, float)),
            "orders of the drive's rotation to list besides those of harmonic torques; joints "
            "excite even orders; default: 2 and 4",
            kind="number(s)",
        ),
        "resonance_margin": Key(
            POSITIVE,
            "least distance of the critical speeds of even orders and of harmonic torques from "
            "speed_rpm, in shares of the critical speed, such as 0.15",
        ),
        "unstable_percent": Key(
            _PERCENT,
            "largest share of the range of speed_rpm in which vibration may grow by itself or the "
            "speed may run away, such as 0",
        ),
        "rattle_percent": Key(
            _PERCENT,
            "largest share in which the torque of a shaft may change its sign: teeth rattle",
        ),
    },
    _torsion,
    together=(("damping_ratio", "dampings_Nms_per_rad"),),
    needed=(("inertias_kgm2",), ("speed_rpm",)),
    recorded_bends=False,
    inner={"harmonic": HARMONIC, "coupling": COUPLING, "motor": MOTOR},
)

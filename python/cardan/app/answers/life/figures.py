"""The life and the heat of a scene's joints over its duty cycle, and which size would suffice."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Literal, NamedTuple

import numpy as np

from cardan.app.answers.answer import Answer
from cardan.app.answers.over import Wherever, drivelines, over
from cardan.app.answers.rows import Judged, count, figure, flag, item, parts, word
from cardan.app.answers.tubes import speed_of
from cardan.app.scene.language.units import RPM
from cardan.app.scene.scene import Scene
from cardan.app.scene.sections.joints import BearingType, Joints, JointSize
from cardan.app.scene.sections.life import DutyCycle
from cardan.arrays import FloatArray
from cardan.design.judged import is_within
from cardan.driveline import Driveline
from cardan.evaluation.load import Load

# At rest nothing wears: this speed in rad/s makes a life that is as good as unlimited.
_REST = 1e-9


@dataclass(frozen=True)
class StepBend:
    """The bend of a joint in a step."""

    joint: int = item("joint")
    bend: float = figure("bend", "deg")


@dataclass(frozen=True)
class Step:
    """A step of the duty cycle."""

    step: str = item("step")
    share: float = figure("share of the time", "percent", digits="given")
    speed: float = figure("speed", "rpm", "of the drive", digits="given")
    torque: float = figure("torque", "Nm", "of the load", digits="given")
    end: Literal["drive", "output"] = word("at", "the end of the driveline that the torque acts at")
    bends: tuple[StepBend, ...] = parts("bend", "of each joint")


@dataclass(frozen=True)
class JointLife:
    """One joint over the duty cycle."""

    joint: int = item("joint")
    size: str | None = word("size", "in the table of sizes")
    bearing: BearingType = word("bearing", "of the pins")
    rating: float | None = figure(
        "rating", "Nm", "torque for 5000 h at 3 deg and 100 rpm", digits="given"
    )
    hours: Judged | None = figure(
        "L10 life",
        "h",
        "hours that 90 % of the joints reach, by the load of the pins over the turn",
        limit="[life] target_h",
    )
    catalogue: float | None = figure(
        "L10 life by the catalogue",
        "h",
        "the same by the law of the catalogues",
        source="1.5e6/(b n) (T_c/T)**(10/3)",
    )
    damage: Judged | None = figure(
        "most wear", "percent", "share of the damage in the step that has most of it"
    )
    small_swing: bool = flag("swing below 3°", "in some step; the needles may mark their races")
    bend: Judged | None = figure(
        "largest bend", "deg", "over the duty cycle", limit="[joints] max_bend_deg"
    )
    speed_bend: Judged | None = figure(
        "largest speed times bend",
        "rpm_deg",
        "over the duty cycle",
        limit="[joints] max_speed_bend_rpm_deg",
    )
    heat: Judged | None = figure("heat", "W", "mean over the duty cycle", limit="[joints] heat_W")
    largest_heat: Judged | None = figure("largest heat", "W", "in the step that has most")


@dataclass(frozen=True)
class SizeLife:
    """A size of the table at every joint."""

    size: str = item("size")
    rating: float | None = figure("rating", "Nm", digits="given")
    hours: float | None = figure("L10 life", "h", "of the joint that fails first")
    decisive: int | None = count("fails first", "the joint that does")
    fits: bool = flag("within its limits", "whether bends, speeds and heat are")
    heat: float | None = figure("heat", "W", "mean of all joints together")


@dataclass(frozen=True)
class LifeFigures:
    """The joints of a scene over its duty cycle, where several are possible in the worst one."""

    hours: float | None = figure("L10 life", "h", "of the joint that fails first", apart="target")
    decisive: int | None = count("fails first", "the joint that does")
    target: float | None = figure("required life", "h", "by the scene", digits="given")
    of_sizes: Judged | None = figure(
        "life with the best size",
        "h",
        "where the scene does not choose one; 0 if none is within its limits",
        limit="[life] target_h",
    )
    chosen: str | None = word(
        "size to choose",
        "the smallest that reaches the required life, or without one the next larger size",
    )
    heat: Judged | None = figure("heat", "W", "mean of all joints together")
    efficiency: Judged | None = figure("efficiency", "percent", "of the energy")
    steps: tuple[Step, ...] = parts("Duty cycle")
    joints: tuple[JointLife, ...] = parts("Joints")
    sizes: tuple[SizeLife, ...] = parts("Sizes", "each at every joint")
    # For pictures and sentences.
    types: tuple[JointSize, ...] = ()
    duty: DutyCycle | None = None
    place: int = 0
    is_compliant: bool = False

    @property
    def first(self) -> JointLife | None:
        """The joint that fails first, if a life is known."""
        return None if self.decisive is None else self.joints[self.decisive]

    def hardest(self) -> tuple[Driveline, Load, str]:
        """Return driveline, load and name of the step that wears the deciding joint most."""
        return self.step_of(self.first.damage if self.first else None)

    def step_of(self, worst: Judged | None) -> tuple[Driveline, Load, str]:
        """Return driveline, load and name of the step in which a figure is worst."""
        assert self.duty
        names = self.duty.names
        step = names.index(worst.state) if worst and worst.state in names else 0
        return self.duty.line[self.place, step], self.duty.load_of(self.place, step), names[step]


class _Used(NamedTuple):
    """Effect of duty cycles on joints; places are the last axis, and NaN means unknown."""

    hours: FloatArray  # life by the load of the pins, (joints, places)
    catalogue: FloatArray  # the same by the catalogue
    small_swing: FloatArray  # whether needles hardly turn in some step
    damage: FloatArray  # share of each step in the damage, (joints, steps, places)
    heat: FloatArray  # (joints, steps, places)
    size_hours: FloatArray  # life with each size at every joint, (sizes, joints, places)
    size_heat: FloatArray  # the mean likewise
    power: FloatArray  # mean of the load, (places,)


def needed(answer: Answer) -> LifeFigures:
    """Return the joints of a scene over its duty cycle.

    Raises:
        ValueError: it has no joints, or no duty cycle.
    """
    scene, found = answer.scene, answer["life"]
    if scene.sizes is None:
        raise ValueError(
            f"{scene.name}: section [joints] is missing; it gives the size of the joints"
        )
    if not found.steps:
        raise ValueError(
            f"{scene.name}: a life needs a speed and a torque: in [load], or of each step in [life]"
        )
    assert isinstance(found, LifeFigures)
    return found


def friction_of(sizes: Sequence[JointSize]) -> dict[str, Any]:
    """Return the arguments of ``Driveline.losses`` for joints of these sizes."""
    names = ("friction", "pin_radius", "arm", "seal_torque")
    return {name: [getattr(size, name) for size in sizes] for name in names}


def find(answer: Answer) -> LifeFigures | None:
    """Return the joints of a scene over its duty cycle; ``None`` without joints or a target."""
    scene, duty = answer.scene, answer.scene.duty
    given, target = scene.sizes or Joints((), ()), duty.target if duty else None
    if scene.sizes is None and target is None:
        return None
    duties = [each for _, _, each in drivelines(scene) if each]
    used, place = None, 0
    steps: tuple[Step, ...] = ()
    if duties:
        blocks = (_used(given, each) for each in duties)
        used = _Used(*(np.concatenate(each, axis=-1) for each in zip(*blocks, strict=True)))
        wearing = [used.hours[joint] for joint, size in enumerate(given.each) if size.wears]
        worst = int(np.argmin(np.min(wearing or used.hours, axis=0)))
        duty, place = [(each, i) for each in duties for i in range(each.line.shape[0])][worst]
        used = used._replace(damage=used.damage[..., worst])
        steps = tuple(_steps(duty, place))
    service = _Service(scene, used, target)
    joints = tuple(service.joint(joint, size) for joint, size in enumerate(given.each))
    sizes = tuple(service.size(i, size) for i, size in enumerate(given.table))
    lasting = [(one.hours.value, one.joint) for one in joints if one.hours and one.hours.value]
    hours, decisive = min(lasting, default=(None, None))
    return LifeFigures(
        hours,
        decisive,
        target,
        None if joints or target is None else _best(sizes, target),
        _chosen(joints, sizes, target),
        *service.losses(given.each),
        steps,
        joints,
        sizes,
        given.each,
        duty if steps else None,
        place,
        scene.torsion is not None,
    )


def _used(given: Joints, duty: DutyCycle) -> _Used:
    line, shares, own, n = duty.line, duty.shares, duty.load, duty.line.n_joints
    torque: dict[str, Any] = {f"{own.end}_torque": own.torque}
    speed = np.where(own.speed == 0.0, _REST, own.speed)
    load = Load(speed=speed, inertias=own.inertias, **torque)

    def heat(sizes: Sequence[JointSize]) -> FloatArray:
        if not all(size.rubs for size in sizes):
            return np.full((n, len(shares), line.shape[0]), np.nan)
        return np.swapaxes(line.losses(load, **friction_of(sizes)).power, 1, 2)

    # A rating of those whose life is not known stands for none.
    ratings = np.array([size.rating or 1.0 for size in given.each or [JointSize()] * n])
    table = np.array([size.rating or 1.0 for size in given.table])[:, None, None, None]
    life = line.life(load, rating=ratings, shares=shares)
    with np.errstate(invalid="ignore"):
        damage = shares / life.steps
        damage /= np.sum(damage, axis=-1, keepdims=True)
    of_sizes = [shares @ heat([size] * n) for size in given.table]
    return _Used(
        life.hours,
        life.catalogue,
        life.small_swing,
        np.swapaxes(damage, 1, 2),
        heat(given.each or [JointSize()]),
        np.swapaxes(line.life(load, rating=table, shares=shares).hours, 0, 1),
        np.array(of_sizes).reshape(-1, n, line.shape[0]),
        np.abs(own.torque * own.speed) @ shares,
    )


def _bends(line: Driveline, _: Load | None = None) -> FloatArray:
    return np.moveaxis(line.bends, -1, 0)


def _speed_bends(line: Driveline, load: Load | None) -> FloatArray | None:
    speed = speed_of(line, load)
    return None if speed is None else speed * _bends(line)


def _most(size: JointSize) -> tuple[float | None, float | None]:
    """The largest bend of a joint in rad, and the largest speed times bend in rad²/s."""
    bend, speed_bend = size.max_bend_deg, size.max_speed_bend
    return bend and math.radians(bend), speed_bend and math.radians(speed_bend * RPM)


class _Service:
    """Judges the joints of a scene over its duty cycle, wherever the driveline runs."""

    def __init__(self, scene: Scene, used: _Used | None, target: float | None) -> None:
        self.scene, self.used, self.target = scene, used, target
        self.duty = scene.duty
        self.bend = Wherever(scene, _bends)
        self.speed_bend = Wherever(scene, _speed_bends)

    def joint(self, joint: int, size: JointSize) -> JointLife:
        """Return the life and the heat of a joint, and what else has a limit."""
        used, (bend, speed_bend) = self.used, _most(size)
        hours = catalogue = damage = heat = largest = None
        if used and size.wears:
            hours = self._over(used.hours[joint], self.target, "least")
            catalogue = float(np.min(used.catalogue[joint]))
            damage = self._by_step(used.damage[joint])
        elif self.target is not None:
            plain = "plain bearings have no rated life" if size.rating else "no rating is given"
            hours = Judged(None, self.target, sense="least", why=plain)
        if used and self.duty and not np.isnan(used.heat[joint]).any():
            steps = used.heat[joint]
            heat = self._over(self.duty.shares @ steps, size.most_heat)
            hottest = int(np.argmax(np.max(steps, axis=0)))
            largest = self._by_step(steps[:, hottest])
        elif size.most_heat is not None:
            why = "the scene does not give what heat needs: friction, torque and speed"
            heat = Judged(None, size.most_heat, why=why)
        return JointLife(
            *(joint, size.name or None, size.bearing, size.rating, hours, catalogue, damage),
            bool(used and np.any(used.small_swing[joint])) and size.bearing == "needle",
            self.bend.worst(joint, bend),
            self.speed_bend.worst(joint, speed_bend, "the scene gives no speed"),
            heat,
            largest,
        )

    def size(self, number: int, size: JointSize) -> SizeLife:
        """Return the life with a size at every joint."""
        used, limits = self.used, _most(size)
        hours = heat = decisive = None
        judged = [
            figure.worst(joint, limit)
            for joint in range(self.scene.line.n_joints)
            for figure, limit in zip((self.bend, self.speed_bend), limits, strict=True)
        ]
        if used and size.wears:
            lives = np.min(used.size_hours[number], axis=-1)
            decisive = int(np.argmin(lives))
            hours = float(lives[decisive])
        if used and size.rubs:
            heat = float(np.max(np.sum(used.size_heat[number], axis=0)))
            judged.append(Judged(float(np.max(used.size_heat[number])), size.most_heat))
        fits = all(each.verdict != "beyond" for each in judged if each)
        return SizeLife(size.name, size.rating, hours, decisive, fits, heat)

    def losses(self, sizes: Sequence[JointSize]) -> tuple[Judged | None, Judged | None]:
        """Return the heat of all joints, and the efficiency over the duty cycle.

        Over a turn the mean torque of the drive is the torque of the load at either end: the speed
        ratio has the mean 1, and inertias take nothing over a turn at a steady speed.
        """
        used, duty = self.used, self.duty
        if not (used and duty and sizes) or np.isnan(used.heat).any():
            return None, None
        lost = np.sum(duty.shares @ used.heat, axis=0)
        share = np.divide(lost, used.power, out=np.zeros_like(lost), where=used.power > 0.0)
        return self._over(lost), self._over(1.0 - share, sense="least")

    def _over(
        self,
        values: FloatArray,
        limit: float | None = None,
        sense: Literal["most", "least"] = "most",
    ) -> Judged:
        """The worst value of all places; one where the steps say how the driveline stands."""
        names = () if self.duty and self.duty.is_set else None
        return over(self.scene, values, limit, sense, names)

    def _by_step(self, values: FloatArray) -> Judged | None:
        """The worst step; ``None`` of one step."""
        assert self.duty
        if len(values) == 1 or np.isnan(values).any():
            return None
        return over(self.scene, values, names=self.duty.names)


def _best(sizes: Sequence[SizeLife], target: float) -> Judged:
    lives = [one.hours if one.fits else 0.0 for one in sizes if one.hours is not None]
    if not lives:
        return Judged(None, target, sense="least", why="the scene gives no rating of the joints")
    return Judged(max(lives), target, sense="least")


def _chosen(
    joints: Sequence[JointLife], sizes: Sequence[SizeLife], target: float | None
) -> str | None:
    """The size to take, from the smallest upwards."""
    lasting = [(one.hours.value, one.rating or 0.0) for one in joints if one.hours]
    known = [(hours, rating) for hours, rating in lasting if hours is not None]
    fitting = [one for one in sizes if one.fits and one.hours]
    if target is not None:
        if known and passes(joints):
            return None
        enough = (one for one in fitting if is_within(one.hours or 0.0, target, most=False))
        return next((one.size for one in enough), None)
    present = min(known)[1] if known else math.inf
    return next((one.size for one in fitting if (one.rating or 0.0) > present), None)


def passes(joints: Sequence[JointLife]) -> bool:
    """Return whether nothing of the joints is beyond its limit."""
    judged = ((one.hours, one.bend, one.speed_bend, one.heat) for one in joints)
    return all(not each or each.verdict != "beyond" for of_joint in judged for each in of_joint)


def _steps(duty: DutyCycle, place: int) -> Iterator[Step]:
    for i, name in enumerate(duty.names):
        bends = enumerate(duty.line.bends[place, i].tolist())
        yield Step(
            name,
            float(duty.shares[i]),
            float(np.abs(duty.load.speed[place, i])),
            float(duty.load.torque[place, i]),
            duty.load.end,
            tuple(StepBend(joint, bend) for joint, bend in bends),
        )

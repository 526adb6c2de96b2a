"""The life and the heat of a scene's joints over its duty cycle, and which size would suffice."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cardan.app.answers.answer import Answer
from cardan.app.scene.duty import DutyCycle
from cardan.app.scene.scene import Scene
from cardan.app.scene.sizes import JointSize
from cardan.arrays import FloatArray
from cardan.design.judged import is_within


@dataclass(frozen=True)
class AgainstLimit:
    """The largest value of a figure over the duty cycle, and what is permitted.

    Attributes:
        value: the figure.
        limit: ``None`` if none is known.
    """

    value: float
    limit: float | None

    @property
    def passes(self) -> bool:
        """Whether the value is within the limit."""
        return self.limit is None or is_within(self.value, self.limit)


@dataclass(frozen=True)
class JointHeat:
    """What friction makes of a joint.

    Attributes:
        mean: heat in W over the duty cycle.
        largest: in the step with most heat.
        step: that step.
    """

    mean: float
    largest: float
    step: int


@dataclass(frozen=True)
class JointLife:
    """One joint over the duty cycle.

    Attributes:
        joint: its number.
        size: its size.
        hours: life that 90 % of the joints reach by the load of the pins; ``None`` without a rating
            or for plain bearings.
        catalogue: the same by the law of the catalogue.
        damage: share of each step in the damage, with sum 1; empty without a life.
        small_swing: whether the needles swing by less than 3 degrees in some step.
        bend: largest bend in degrees.
        speed_bend: largest product of speed in rpm and bend in degrees.
        heat: ``None`` if its losses are not known.
    """

    joint: int
    size: JointSize
    hours: float | None
    catalogue: float | None
    damage: tuple[float, ...]
    small_swing: bool
    bend: AgainstLimit
    speed_bend: AgainstLimit
    heat: JointHeat | None

    @property
    def passes(self) -> bool:
        """Whether it is within the limits of its type."""
        return self.bend.passes and self.speed_bend.passes


@dataclass(frozen=True)
class SizeLife:
    """A size of the table at every joint.

    Attributes:
        size: the size.
        hours: life of the joint that fails first; ``None`` without a rating or for plain bearings.
        decisive: that joint.
        fits: whether bends and speeds are within the limits of the size.
        heat: mean heat of all joints in W; ``None`` if the losses are not known.
    """

    size: JointSize
    hours: float | None
    decisive: int
    fits: bool
    heat: float | None


@dataclass(frozen=True)
class LifeFigures:
    """The joints of a scene over its duty cycle.

    Attributes:
        duty: the duty cycle.
        joints: each joint; empty if the scene gives only a table of sizes.
        sizes: each size of the table; empty without one.
        chosen: the size to take: the smallest that reaches the target, or without a target the
            next larger one; ``None`` if the present one suffices or none does.
        efficiency: of the energy over the duty cycle; ``None`` if the losses are not known.
        is_compliant: whether the scene gives its shafts as torsion springs; the torques here are
            those of rigid shafts all the same.
    """

    duty: DutyCycle
    joints: tuple[JointLife, ...]
    sizes: tuple[SizeLife, ...]
    chosen: SizeLife | None
    efficiency: float | None
    is_compliant: bool

    @property
    def decisive(self) -> JointLife | None:
        """The joint that fails first, if a life is known."""
        known = [joint for joint in self.joints if joint.hours is not None]
        return min(known, key=lambda joint: joint.hours or 0.0, default=None)

    @property
    def heat(self) -> float | None:
        """Mean heat of all joints in W, if the losses of all are known."""
        means = [joint.heat.mean for joint in self.joints if joint.heat]
        return sum(means) if means and len(means) == len(self.joints) else None

    @property
    def reaches_target(self) -> bool:
        """Whether the joints reach the required life, or none is required."""
        target, first = self.duty.target, self.decisive
        return target is None or first is None or is_within(_hours(first), target, most=False)

    @property
    def passes(self) -> bool:
        """Whether joints and life are within all limits."""
        return self.reaches_target and all(joint.passes for joint in self.joints)


def _hours(joint: JointLife) -> float:
    assert joint.hours is not None
    return joint.hours


def life_figures(scene: Scene) -> LifeFigures | None:
    """Return the joints of a scene over its duty cycle; ``None`` without either of them."""
    joints, duty = scene.service.joints, scene.service.duty
    if joints is None or duty is None:
        return None
    each = tuple(_joints(joints.each, duty)) if joints.each else ()
    sizes = tuple(_sizes(joints.table, duty)) if joints.table else ()
    is_compliant = scene.torsion is not None
    found = LifeFigures(duty, each, sizes, None, _efficiency(each, duty), is_compliant)
    return replace(found, chosen=_chosen(found))


def needed_life(scene: Scene) -> LifeFigures:
    """Return the joints of a scene over its duty cycle.

    Raises:
        ValueError: it has no joints, or no duty cycle.
    """
    found = life_figures(scene)
    if found is not None:
        return found
    if scene.service.joints is None:
        raise ValueError(
            f"{scene.name}: section [joints] is missing; it gives the size of the joints"
        )
    raise ValueError(
        f"{scene.name}: a life needs a speed and a torque: in [load], or of each step in [life]"
    )


def heat_of(sizes: Sequence[JointSize], duty: DutyCycle) -> FloatArray:
    """Return the heat of joints in W in each step, ``(n, steps)``.

    Args:
        sizes: of each joint, with all that the losses need.
        duty: the duty cycle.
    """
    return duty.line.losses(duty.load, **friction_of(sizes)).power


def friction_of(sizes: Sequence[JointSize]) -> dict[str, Any]:
    """Return the arguments of ``Driveline.losses`` for joints of these sizes."""
    names = ("friction", "pin_radius", "arm", "seal_torque")
    return {name: [getattr(size, name) for size in sizes] for name in names}


def _joints(sizes: Sequence[JointSize], duty: DutyCycle) -> Iterator[JointLife]:
    # A rating of those whose life is not known stands for none.
    ratings = [size.rating or 1.0 for size in sizes]
    life = duty.line.life(duty.load, rating=ratings, shares=duty.shares)
    bends = np.degrees(duty.line.bends)
    products = duty.speed_rpm[:, np.newaxis] * bends
    heat = heat_of(sizes, duty) if all(size.rubs for size in sizes) else None
    for joint, size in enumerate(sizes):
        damage = duty.shares / life.steps[joint]
        yield JointLife(
            joint,
            size,
            float(life.hours[joint]) if size.wears else None,
            float(life.catalogue[joint]) if size.wears else None,
            tuple((damage / np.sum(damage)).tolist()) if size.wears else (),
            bool(life.small_swing[joint]) and size.bearing == "needle",
            _judged(bends[:, joint], size.max_bend_deg),
            _judged(products[:, joint], size.max_speed_bend),
            None if heat is None else _heat(heat[joint], duty),
        )


def _judged(values: FloatArray, limit: float | None) -> AgainstLimit:
    return AgainstLimit(round_off(np.max(values)), limit)


def round_off(value: float) -> float:
    """Return a value to 12 digits; degrees that became radians and degrees again have noise."""
    return float(f"{value:.12g}")


def _heat(of_steps: FloatArray, duty: DutyCycle) -> JointHeat:
    step = int(np.argmax(of_steps))
    return JointHeat(float(np.sum(duty.shares * of_steps)), float(of_steps[step]), step)


def _sizes(table: Sequence[JointSize], duty: DutyCycle) -> Iterator[SizeLife]:
    """Each size at every joint."""
    joints, bends = duty.line.n_joints, np.degrees(duty.line.bends)
    ratings = np.array([size.rating or 1.0 for size in table])
    hours = duty.line.life(
        duty.load, rating=ratings[:, np.newaxis, np.newaxis], shares=duty.shares
    ).hours
    first: NDArray[np.intp] = np.argmin(hours, axis=0)
    for i, size in enumerate(table):
        bend = _judged(bends, size.max_bend_deg)
        product = _judged(duty.speed_rpm[:, np.newaxis] * bends, size.max_speed_bend)
        heat = np.sum(duty.shares * heat_of([size] * joints, duty)) if size.rubs else None
        yield SizeLife(
            size,
            float(hours[first[i], i]) if size.wears else None,
            int(first[i]),
            bend.passes and product.passes,
            None if heat is None else float(heat),
        )


def _chosen(found: LifeFigures) -> SizeLife | None:
    """The size to take, from the smallest upwards."""
    target, first = found.duty.target, found.decisive
    if target is not None:
        if first is not None and found.passes:
            return None
        return next(
            (
                one
                for one in found.sizes
                if one.fits and one.hours and is_within(one.hours, target, most=False)
            ),
            None,
        )
    if first is None:
        return None
    present = first.size.rating or 0.0
    larger = (one for one in found.sizes if one.fits and (one.size.rating or 0.0) > present)
    return next((one for one in larger if one.hours), None)


def _efficiency(joints: Sequence[JointLife], duty: DutyCycle) -> float | None:
    """Of the energy over the duty cycle.

    Over a turn the mean torque of the drive is the torque of the load at either end: the speed
    ratio has the mean 1, and inertias take nothing over a turn at a steady speed.
    """
    if not joints or any(joint.heat is None for joint in joints):
        return None
    lost = sum(joint.heat.mean for joint in joints if joint.heat)
    power = np.sum(duty.shares * np.abs(duty.load.torque * duty.load.speed))
    return float(1.0 - lost / power)


def find(answer: Answer) -> LifeFigures | None:
    """Return the figures of an answer's scene."""
    return life_figures(answer.scene)


def verdicts(found: LifeFigures) -> dict[str, str]:
    """Return the verdicts on what the scene limits."""
    bends = all(joint.passes for joint in found.joints)
    return {
        "life": "within" if found.reaches_target else "beyond",
        "bend for the type": "within" if bends else "beyond",
    }

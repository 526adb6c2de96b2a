"""Sample-by-sample contents of the page of a scene: every curve, and the pins for the drawing."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple

import numpy as np

from cardan.app.answers.page import Curve, Panel
from cardan.app.answers.printed import quantity
from cardan.app.answers.rounding import MAGNITUDES, alike, first_peak, is_cancelled, signed
from cardan.app.answers.turn.extremes import magnitudes, peak, peaks, shortest_arm, values_of
from cardan.app.scene.language.units import RPM
from cardan.app.scene.recording.recorded import Angles
from cardan.app.scene.scene import Scene, SceneResult
from cardan.arrays import FloatArray
from cardan.driveline import Driveline
from cardan.evaluation.load import Load
from cardan.evaluation.outputs import Output
from cardan.motion.equivalent import EquivalentJoint

NOMINAL_TORQUE = 100.0
"""Drive torque in N m that is assumed where a scene gives no torque and no inertia in motion."""

_PER_TURN = 720

# More than a screen can show; a longer recording appears with every n-th of its samples.
_MOST = 2000

_MOTION = ("angle_error", "speed_ratio", "acceleration_ratio")
_LOADED = ("torque", "support_moment", "bending_driving", "bending_driven")

_MOST_CURVES = 6

# Times that begin so many lengths of the recording after 0 are those of a clock.
_EPOCH = 100.0

# Moments below this share of the largest torque are rounding.
_ROUNDING = 1e-12


@dataclass(frozen=True, eq=False)
class PeakSample:
    """Place where a quantity of a shaft or joint is largest."""

    output: Output  # the quantity
    item: int  # the shaft or joint
    size: float  # magnitude, in the unit of the output
    at_deg: float | None  # first such drive angle in degrees; ``None`` where all are alike
    vector: FloatArray | None  # the components there, ``(3,)``; ``None`` of a scalar
    state: str = ""  # over states, the name of the one in which it is largest


@dataclass(frozen=True, eq=False)
class Samples:
    """A scene evaluated for the page."""

    result: SceneResult  # motion of all shafts, torques and moments at every sample
    nominal: bool  # whether ``NOMINAL_TORQUE`` is assumed for the load
    shown: slice  # which of the samples the curves and the drawing show

    @property
    def angle_deg(self) -> FloatArray:
        """Drive angles shown, in degrees, ``(samples,)``."""
        return self.result.scene.drive_angle_deg[self.shown]

    @property
    def time(self) -> FloatArray | None:
        """Times shown in s, ``(samples,)``, if they were recorded; those of an epoch begin at 0."""
        time = self.result.scene.time
        if time is None:
            return None
        far = abs(float(time[0])) > _EPOCH * float(time[-1] - time[0])
        return (time - time[0] if far else time)[self.shown]

    @property
    def every(self) -> int:
        """Number of samples per sample shown."""
        return int(self.shown.step)

    @property
    def largest_torque(self) -> float:
        """Largest torque in any shaft in N m."""
        return float(np.max(np.abs(self.result.values["torque"])))

    @property
    def assumed(self) -> str:
        """Ending of the headings of loads where the scene gives no torque."""
        torque = quantity(NOMINAL_TORQUE, "Nm").replace(" ", "\u00a0")
        return f", for an assumed drive torque of {torque}" if self.nominal else ""

    @cached_property
    def peaks(self) -> list[PeakSample]:
        """The largest magnitudes of the loads and other quantities of every shaft and joint.

        They are those of a whole turn and of all states, found between the samples; of a recording
        those of all samples. Of the motion there are closed forms.
        """
        peaks = []
        for output, item, values in self.result.curves():
            # An angle grows without end.
            if output.name in (*_MOTION, "angle"):
                continue
            noise = _ROUNDING * (self.largest_torque if output.needs_load else 1.0)
            if output.unit == "N":
                noise /= shortest_arm(self.result.scene.line)
            size, angle, there, state = self._peak(output, item, values)
            vector = np.where(np.abs(there) > noise, there, 0.0) if output.vector else None
            if size <= noise:
                size, angle, state = 0.0, None, ""
            peaks.append(PeakSample(output, item, size, angle, vector, state))
        return peaks

    def _peak(
        self, output: Output, item: int, values: FloatArray
    ) -> tuple[float, float | None, FloatArray, str]:
        """Size, drive angle in degrees if it has one, value there, and the state."""
        scene = self.result.scene
        if scene.recording is not None:
            sizes = magnitudes(output, values)
            place, everywhere = first_peak(sizes)
            at = None if everywhere else float(scene.drive_angle_deg[place])
            return float(sizes[place]), at, values[place], ""
        each = []
        for state, line, driving in self._states:
            load = driving if output.needs_load else None
            each.append((peak(line, output.name, item, load), line, load, state))
        found, line, load, state = max(each, key=lambda one: one[0].value)
        if alike(min(one[0].value for one in each), found.value):
            state = ""
        first = found.places[0] if found.places else 0.0
        there = values_of(line, output.name, item, first, load)
        return found.value, math.degrees(first) if found.places else None, there, state

    @cached_property
    def _states(self) -> list[tuple[str, Driveline, Load | None]]:
        """Name, driveline and load of each state; of a scene without states those of the scene."""
        scene = self.result.scene
        if not scene.states:
            return [("", scene.line_as_built, scene.load_case)]
        return [
            (
                name,
                as_built(scene, scene.states.driveline(i)),
                scene.load_case if self.nominal else scene.states.load(i),
            )
            for i, name in enumerate(scene.states.names)
        ]

    def panels(self) -> list[Panel]:
        """Return the charts, a quantity each, of the samples shown."""
        scene = self.result.scene
        found: dict[Output, dict[int, FloatArray]] = {}
        for output, item, values in self.result.curves():
            # The drive's own motion is no curve to look at.
            if output.needs_load or output.per == "joint" or item > 0:
                sizes = np.linalg.norm(values, axis=-1) if output.vector else values
                if output.name in MAGNITUDES:
                    sizes = signed(sizes, self.result.values["torque"][item + 1])
                found.setdefault(output, {})[item] = sizes
        panels = []
        if scene.time is not None and scene.load_case is not None:
            rpm = np.broadcast_to(scene.load_case.speed / RPM, scene.time.shape)
            own = (Curve("shaft 0", rpm[self.shown]),)
            scale = float(np.max(np.abs(rpm))) or 1.0
            panels.append(Panel("drive speed", "rpm", own, scale))
        for output, curves in found.items():
            heading, unit, factor = output.label, output.unit, 1.0
            scale = self.largest_torque if output.needs_load else 1.0
            if output.vector:
                heading += ", magnitude"
            if output.name in MAGNITUDES and any(np.min(curve) < 0.0 for curve in curves.values()):
                heading += ", with the sign of the torque"
            if unit == "rad":
                unit, factor = "deg", math.degrees(1.0)
            if output.name == "acceleration_ratio" and scene.speed:
                heading, unit, scale = "acceleration", "rad/s²", scene.speed**2
                heading += " at constant drive speed" if scene.accelerates else ""
                speed = scene.load_case.speed if scene.load_case else 0.0
                curves = {item: speed**2 * values for item, values in curves.items()}
            if output.needs_load:
                heading += self.assumed
            # The last shaft is what a driveline is there for.
            always = scene.line.n_joints if output.per == "shaft" else None
            by_size = sorted(curves, key=lambda item: (item == always, np.ptp(curves[item])))
            chosen = tuple(
                Curve(f"{output.per} {item}", factor * curves[item][self.shown])
                for item in sorted(by_size[-_MOST_CURVES:])
            )
            left_out = len(curves) - len(chosen)
            panels.append(Panel(heading, "" if unit == "1" else unit, chosen, scale, left_out))
        return panels


def evaluated(scene: Scene) -> Samples:
    """Evaluate a scene for the page: one turn in half degrees, or the recorded angles."""
    scene = scene.without_missing()
    if scene.recording is None:
        turn = Angles.uniform(1.0, _PER_TURN, float(scene.drive_angle_deg[0]))
        scene = replace(scene, drive_angle_deg=turn.degrees, angle=turn.drive)
    extra = tuple(name for name in scene.quantities if name not in _MOTION + _LOADED)
    scene = replace(
        scene,
        quantities=(*_MOTION, *_LOADED, *extra),
        shafts=tuple(range(scene.line.n_joints + 1)),
        joints=None,
        study=None,
        load_case=scene.load_case or Load(),
        # Few samples need no short cuts, and what is rounding shall be that of doubles.
        options={},
    )
    result = scene.run()
    nominal = not np.any(result.values["torque"]) and not _loaded_in_states(scene)
    if nominal:
        load = Load(drive_torque=NOMINAL_TORQUE, speed=scene.speed)
        result = replace(scene, load_case=load).run()
    every = math.ceil(len(scene.drive_angle_deg) / _MOST)
    return Samples(result, nominal, slice(None, None, every))


def _loaded_in_states(scene: Scene) -> bool:
    """Whether a state has a torque, which [load] need not have."""
    states = scene.states
    loads = (states.load(i) for i in range(states.count)) if states else ()
    return any(load is not None and bool(np.any(load.torque)) for load in loads)


# --- motion of the shafts over a turn, with joints as built if a scene has them -------------------


class TurnMotion(NamedTuple):
    """The extremes of a shaft's motion over a turn, ``(...)`` of a batch of drivelines."""

    angle_error: FloatArray  # largest magnitude in rad
    slowest: FloatArray  # least speed ratio
    fastest: FloatArray  # largest speed ratio
    acceleration: FloatArray  # largest magnitude of the acceleration ratio


def equivalent(line: Driveline, shaft: int = -1) -> EquivalentJoint:
    """Return the joint that moves a shaft as the chain does, straight if rounding alone is left."""
    joint = line.equivalent(shaft)
    if not line.shape and is_cancelled(line, joint):
        return Driveline.from_bends([0.0]).equivalent()
    return joint


def as_built(scene: Scene, line: Driveline) -> Driveline:
    """Return a driveline of a scene with the deviations of its joints, if the scene gives any."""
    return line if scene.deviations is None else line.with_deviations(*scene.deviations.T)


def deviates(scene: Scene) -> bool:
    """Return whether a joint of a scene deviates from its drawing."""
    return scene.deviations is not None and bool(np.any(scene.deviations))


def turn_motion(scene: Scene, line: Driveline, shaft: int) -> TurnMotion:
    """Return the extremes of a shaft of one driveline of a scene or of those of its states.

    Of ideal joints they have closed forms; with deviations they are searched over the turn.
    """
    if not deviates(scene):
        joint = equivalent(line, shaft)
        return TurnMotion(
            *map(np.asarray, (joint.max_angle_error, joint.min_speed_ratio)),
            *map(np.asarray, (joint.max_speed_ratio, joint.max_acceleration_ratio)),
        )
    built = as_built(scene, line)
    return TurnMotion(
        peaks(built, "angle_error", [shaft])[0],
        peaks(built, "speed_ratio", [shaft], is_least=True)[0],
        peaks(built, "speed_ratio", [shaft])[0],
        peaks(built, "acceleration_ratio", [shaft])[0],
    )

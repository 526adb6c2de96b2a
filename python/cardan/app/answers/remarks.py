"""Remarks on doubtful points of a scene: inputs in a wrong unit, torques that reverse.

Remarks are no verdict. Each is a line about a section or about a shaft.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from cardan.app.answers.answer import Answer
from cardan.app.answers.over import varies
from cardan.app.answers.printed import bullets, given, quantity
from cardan.app.answers.rows import item, word
from cardan.app.answers.turn.extremes import torque_ends
from cardan.app.answers.turn.figures import noise
from cardan.app.scene.language.units import ENDINGS, RPM, split
from cardan.app.scene.scene import Scene
from cardan.app.scene.sections.driveline import (
    DOUBLE_JOINT,
    SINGLE_BEND,
    SINGLE_TWIST,
    has_lengths,
)
from cardan.torsion.tube import WIDEST

_LONGEST, _SHORTEST = 50.0, 1e-3
"""Lengths in m beyond which no shaft of a machine lies."""

_SMALLEST = 1e-3
"""A length in m below which no pin, tube or spline is wide, and no bearing far from an end."""

_FASTEST = 20_000.0
"""A speed in rpm that no universal joint reaches."""

_STIFF = 1e-3
"""An angle in rad; what yields less under a torque is not worth its section."""

_FURTHER = 1.2
"""Vibration is looked for a little beyond the speeds of a machine; further, they are its speeds."""

_LEAST_MARGIN = 1.5
"""What the scenes of ``cardan new`` require of tubes, of which most others require nothing."""

_LEAST_BEND = 0.5
"""Bend in degrees; if all bends are smaller, they are probably in radians."""


@dataclass(frozen=True)
class Remark:
    """A remark on an input or a result."""

    about: str = item("about")
    remark: str = word("remark")


def find(answer: Answer) -> tuple[Remark, ...]:
    """Return the remarks on a scene."""
    scene = answer.scene
    found = (
        *(_commas, _lengths, _angles, _recorded, _tubes, _wind_up),
        *(_small, _speeds, _states, _planes, _torques, _units, _steady),
        *(_beyond_the_speed, _half_critical),
    )
    return tuple(remark for own in found for remark in own(scene))


def words(found: tuple[Remark, ...], *, radians: bool = False) -> str:
    """Return the remarks as plain text, 79 wide."""
    lines = (f"{each.about}: {each.remark}" for each in found)
    return "\n".join([heading(found), *bullets(lines, break_on_hyphens=True)])


def heading(_: tuple[Remark, ...]) -> str:
    """Return what stands above the remarks."""
    return "Worth a look"


# --- inputs --------------------------------------------------------------------------------------


def _steady(scene: Scene) -> Iterator[Remark]:
    if scene.accelerates and scene.lateral is not None and not scene.lateral.rigid_bearings:
        yield Remark("[load]", "lateral vibration is that at steady speeds, without acceleration")


def _commas(scene: Scene) -> Iterator[Remark]:
    for line, text in scene.decimal_commas:
        yield Remark(
            f"line {line}",
            f"{text} separates some entries by a comma without a blank; a decimal comma is two "
            "entries, and decimals take a point",
        )


def _lengths(scene: Scene) -> Iterator[Remark]:
    line, layout = scene.line, scene.layout
    if layout is None or not has_lengths(line):
        return
    key = f"{'lengths' if scene.points is None else 'points'}_{scene.length_unit}"
    key = _given(scene, "driveline", key)
    lengths = line.lengths().each
    odd = (lengths > _LONGEST) | ((lengths > 0.0) & (lengths < _SHORTEST))
    for shaft in np.flatnonzero(odd):
        yield Remark(
            f"[driveline] {key}",
            f"shaft {shaft} is {quantity(float(lengths[shaft]), 'm', digits='measured')} long; "
            f"the key takes {ENDINGS[split(key)[1]].name}",
        )


def _angles(scene: Scene) -> Iterator[Remark]:
    layout = scene.layout
    if layout is None:
        return
    first = layout.form.keys[0]
    largest = math.degrees(float(np.max(scene.line.bends)))
    if split(first)[1] == "deg" and 0.0 < largest < _LEAST_BEND:
        yield Remark(
            f"[driveline] {first}",
            f"every bend is below {_LEAST_BEND:g}°; the key takes degrees, not radians",
        )
    for key in layout.form.optional:
        values = np.ravel(np.asarray(layout.driveline[key], dtype=np.float64))
        found = [value for value in values if split(key)[1] == "deg" and _is_share_of_pi(value)]
        if found:
            yield Remark(
                f"[driveline] {key}",
                f"{found[0]:g} is {found[0] / math.pi:.4g} pi; the key takes degrees, not radians",
            )


def _is_share_of_pi(value: float) -> bool:
    """Whether a number is a multiple of pi/12, rounded to three digits or more."""
    steps = round(12.0 * value / math.pi)
    apart = abs(value - steps * math.pi / 12.0)
    return 0 < abs(steps) <= 48 and apart < 5.1e-4 and abs(value - round(value, 2)) > 1e-9


def _recorded(scene: Scene) -> Iterator[Remark]:
    """Recorded angles and bends in radians whose keys take degrees."""
    if scene.recording is None:
        return
    largest = math.degrees(float(np.max(scene.without_missing().line.bends)))
    if scene.line.shape and 0.0 < largest < _LEAST_BEND:
        yield Remark(
            "[angles] bend_columns_deg",
            f"every bend is below {_LEAST_BEND:g}°; the key takes degrees, not radians",
        )
    driven = scene.driven_angle_deg
    angles = scene.drive_angle_deg if driven is None else driven
    known = angles[np.isfinite(angles)]
    steps = np.abs(np.diff(known))
    jumps = steps[steps > 4.0]
    if (
        jumps.size
        and float(np.ptp(known)) < math.tau + 1e-3
        and float(np.median(steps)) < 0.5
        and float(np.min(jumps)) > math.tau - 1.0
    ):
        yield Remark(
            "[angles] angle_column_deg",
            "the angle jumps back by 2 pi again and again; the key takes degrees, not radians",
        )


def _small(scene: Scene) -> Iterator[Remark]:
    """Lengths that are probably in metres although their keys take millimetres or inches."""
    found: list[tuple[str, str, float]] = []
    for size in scene.sizes.each if scene.sizes else ():
        found += [("joints", "pin_radius_mm", size.pin_radius or 1.0)]
        found += [("joints", "arm_mm", size.arm or 1.0)]
    if scene.tubes is not None:
        outer = float(np.min(scene.tubes.given["outer_diameter"]))
        found.append(("tubes", "outer_diameter_mm", outer))
    if scene.slip is not None:
        found.append(("slip", "engaged_mm", 1e-3 * (scene.slip.engaged or 1e3)))
        found.append(("slip", "radius_mm", scene.slip.radius or 1.0))
    for i, each in enumerate(scene.layout.mounting.bearings if scene.layout else ()):
        if each.unit == "mm":
            found.append((f"bearing.{i}", each.key, 1e-3 * float(np.min(each.value))))
    for (section, si), value in {each[:2]: each[2] for each in reversed(found)}.items():
        if value < _SMALLEST:
            key = _given(scene, section, si)
            name, _, number = section.partition(".")
            heading = f"[[{name}]][{number}]" if number else f"[{name}]"
            takes = ENDINGS[split(key)[1]].name
            yield Remark(
                f"{heading} {key}", f"a value is {given(value, 'mm')}; the key takes {takes}"
            )


def _given(scene: Scene, section: str, si: str) -> str:
    """A key as the file has it, in US units or not."""
    return scene.given.get(section, {}).get(si, si)


def _units(scene: Scene) -> Iterator[Remark]:
    """Values given in US units whose answer is in SI units."""
    for section, keys in scene.given.items():
        for si, key in keys.items():
            if key != si and scene.units == "si":
                words = 'given in US units, and the answer is in SI units; units = "us" shows both'
                yield Remark(f"[{section.partition('.')[0]}] {key}", f"{words} alike")
                return


def _speeds(scene: Scene) -> Iterator[Remark]:
    speed = abs(scene.speed)
    if speed > _FASTEST * RPM:
        yield Remark(
            "[angles]" if scene.speed_recorded else "[load]",
            f"the drive turns at {quantity(speed, 'rpm')}, faster than universal joints do",
        )


def _wind_up(scene: Scene) -> Iterator[Remark]:
    """Rates in other units: nothing that yields turns so little under all torques of its states."""
    states, layout = scene.states, scene.layout
    if not (scene.wind_ups and states and layout):
        return
    drawn, own = scene.line, scene.drivelines()
    apart = np.linalg.norm(own.directions - drawn.directions, axis=-1).max()
    if 0.0 < apart < _STIFF:
        yield Remark(
            "[[wind_up]]",
            f"no shaft turns by more than {quantity(apart, 'deg')} under the torques of [states]; "
            "rates are per kN m, and torques in N m",
        )


def _tubes(scene: Scene) -> Iterator[Remark]:
    if scene.tubes is None:
        return
    outer = float(np.max(scene.tubes.given["outer_diameter"]))
    if outer > WIDEST:
        yield Remark(
            "[tubes] outer_diameter_mm",
            f"a shaft is {given(outer, 'm')} wide; the key takes millimetres",
        )


def _beyond_the_speed(scene: Scene) -> Iterator[Remark]:
    """Margins of tubes are those at the speed of the load; vibration is looked for beyond it."""
    tubes, speed = scene.tubes, abs(scene.speed)
    if tubes is None or not speed or scene.layout is None:
        return
    required = tubes.least_margin
    least = _LEAST_MARGIN if required is None else required
    judged = "is that" if required is None else "is judged"
    below = "" if required is None else f", below {given(required, '')}"
    criticals = tubes.critical_speed(scene.drivelines()).reshape(-1, len(tubes.shafts))
    for name in ("torsion", "lateral"):
        case = getattr(scene, name)
        end = 0.0 if case is None else float(case.speed[-1])
        for shaft, critical in zip(tubes.shafts, np.min(criticals, axis=0).tolist(), strict=True):
            if end > _FURTHER * speed and least * speed <= critical < least * end:
                margin = quantity(critical / end, "", digits="margin")
                yield Remark(
                    "[tubes]",
                    f"the margin of the tube of shaft {shaft} {judged} at "
                    f"{quantity(speed, 'rpm')}; at {quantity(end, 'rpm')}, up to which [{name}] "
                    f"looks, it is {margin}{below}",
                )


def _half_critical(scene: Scene) -> Iterator[Remark]:
    """Half a critical speed is judged at the speed of the load; [torsion] has all of operation."""
    tubes, case, speed = scene.tubes, scene.torsion, abs(scene.speed)
    if tubes is None or tubes.resonance_margin is None or case is None or not speed:
        return
    low, high = float(case.speed[0]), float(case.speed[-1])
    halves = 0.5 * tubes.critical_speed(scene.line)
    bends = np.pad(scene.line.bends, 1)
    for shaft, half in zip(tubes.shafts, halves.tolist(), strict=True):
        is_bent = bool(np.any(bends[shaft : shaft + 2]))
        if is_bent and low <= half <= high and abs(speed - half) >= tubes.resonance_margin * half:
            yield Remark(
                "[tubes]",
                f"half the critical bending speed of shaft {shaft} is judged at "
                f"{quantity(speed, 'rpm')}; it is {quantity(half, 'rpm')}, among the speeds of "
                "[torsion]",
            )


def _states(scene: Scene) -> Iterator[Remark]:
    states, layout = scene.states, scene.layout
    # A drawing without torque is seldom one of the states that follow the torque.
    if states is None or layout is None or scene.wind_ups:
        return
    drawn, own = layout.values(), layout.values(states.axes, states.count)
    is_drawn = [
        all(np.allclose(value[i], drawn[key], atol=1e-9) for key, value in own.items())
        for i in range(states.count)
    ]
    if not any(is_drawn):
        yield Remark(
            "[states]",
            "no state has the values of [driveline]. Lists of a state are values, not changes: "
            "{add = [...]} changes the value of the drawing",
        )


def _planes(scene: Scene) -> Iterator[Remark]:
    """Turns of a double joint that seem to turn the plane of the single joint behind it as well."""
    states, layout = scene.states, scene.layout
    if states is None or layout is None or not layout.driveline.get(SINGLE_BEND, [0.0])[0]:
        return
    (twist,) = layout.driveline[SINGLE_TWIST]
    varied = {axis.name for axis in states.axes}
    # At right angles are a level shaft and a single joint that is bent upwards.
    if DOUBLE_JOINT in varied and SINGLE_TWIST not in varied and (twist + 90.0) % 180.0:
        yield Remark(
            f"[states] {DOUBLE_JOINT}",
            f"{SINGLE_TWIST} is {given(math.radians(twist), 'deg')} in every state, so the plane "
            "of the single joint is taken to turn with that of the double joint; if it is bent up "
            f"or down in every state, give about {given(0.5 * math.pi, 'deg')} in a turn",
        )


# --- results -------------------------------------------------------------------------------------


def _torques(scene: Scene) -> Iterator[Remark]:
    """Torques that change their sign within a turn although the load has a mean."""
    each = [scene.in_state(i) for i in range(scene.states.count)] if scene.states else [scene]
    shafts = range(scene.line.n_joints + 1)
    for shaft in shafts:
        found = []
        for name, one in zip(scene.states.names if scene.states else ("",), each, strict=True):
            load = one.load_case
            if load is None or load.inertias is None or one.line.shape:
                continue
            if any(np.ndim(part) for part in (load.torque, load.speed, load.acceleration)):
                continue
            low, high = torque_ends(one.line_as_built, shaft, load)
            least = noise(one)
            if load.torque and low < -least and high > least:
                found.append((high - low, name, low, high))
        if found:
            _, name, low, high = max(found)
            where = f" in {name}" if name else " as drawn" if varies(scene) else ""
            yield Remark(
                f"shaft {shaft}",
                f"its torque reverses in every turn, from {quantity(low, 'Nm')} to "
                f"{quantity(high, 'Nm')}{where}: splines and gears change their flanks and may "
                "rattle",
            )

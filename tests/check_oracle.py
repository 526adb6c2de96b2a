"""Judge the oracle of the stress command: ``cardan-stress oracle 3000 | python`` this file.

What it prints is compared with mpmath from the vector picture: pins that stay at right angles, the
moment normal to both, joint after joint along a chain, and the equilibrium of all shafts. Exits
with 1 if anything is more than 2**-92 off, of the number itself, of the largest part of a jerk
ratio, which is a sum, of the largest force of a driveline, in a chain of what another angle would
change it by, or of 1 if that is larger with joints as built.
"""

from __future__ import annotations

import sys
from collections.abc import Iterable, Iterator
from dataclasses import dataclass, fields

from equilibrium import system
from oracle import ExactTurn, Fold, MpNumber, mp
from vectors import ExactLoads, Frames, MpVector, cross, dot, unit

LIMIT = 2.0**-92


def add(a: MpVector, b: MpVector, factor: MpNumber = 1) -> MpVector:
    x, y, z = (p + factor * q for p, q in zip(a, b, strict=True))
    return x, y, z


def times(a: MpVector, factor: MpNumber) -> MpVector:
    return a[0] * factor, a[1] * factor, a[2] * factor


def error(bend: MpNumber, angle: MpNumber) -> MpNumber:
    """Angle error of one joint: the driven angle, less the drive's, without its branch."""
    s, c = mp.sin(angle), mp.cos(angle)
    cosine = mp.cos(bend)
    return mp.atan2(s * c * (1 - cosine), c * c * cosine + s * s)


def rates(bend: MpNumber, angle: MpNumber) -> tuple[MpNumber, MpNumber]:
    """First and second derivative of ``atan(tan(angle)/cos(bend))``."""
    s, c, cosine = mp.sin(angle), mp.cos(angle), mp.cos(bend)
    across = (c * cosine) ** 2 + s * s
    return cosine / across, -2 * cosine * mp.sin(bend) ** 2 * s * c / across**2


def jerk(bend: MpNumber, angle: MpNumber) -> MpNumber:
    """Third derivative of the angle, by differences with four times the digits."""
    return mp.diff(lambda x: error(bend, x), angle, 3)


def jerk_term(bend: MpNumber, angle: MpNumber) -> MpNumber:
    """Return the larger of the two terms whose difference the third derivative is."""
    s2, c2, cosine = mp.sin(angle) ** 2, mp.cos(angle) ** 2, mp.cos(bend)
    sine2 = mp.sin(bend) ** 2
    larger = max(s2 * (s2 + 3 * sine2 * c2), (cosine * c2) ** 2)
    return 2 * cosine * sine2 * larger / (cosine**2 * c2 + s2) ** 3


def digits(bend: MpNumber, angle: MpNumber) -> int:
    """Digits for the cancellation that small and steep bends and large angles bring."""
    return 120 + abs(int(mp.log10(abs(angle) + 1e-300))) + 2 * int(-mp.log10(bend))


def joint(bend: MpNumber, angle: MpNumber) -> dict[str, MpNumber]:
    """Everything that one joint does, of a torque of 1, from its vectors."""
    zero, one = mp.mpf(0), mp.mpf(1)
    directions = [(one, zero, zero), (mp.cos(bend), mp.sin(bend), zero)]
    folds = [Fold.of([], [], []), Fold.of([bend], [], [])]
    frames = Frames([bend], [], directions, [(zero, zero, one)], folds)
    loads = ExactLoads.of(frames, ExactTurn.by(angle), drive_torque=1.0)
    ratio, acceleration = rates(bend, angle)
    turned = error(bend, angle)
    found = {
        "sine": mp.sin(angle),
        "cosine": mp.cos(angle),
        "sine of the bend": mp.sin(bend),
        "cosine of the bend": mp.cos(bend),
        "angle": angle + turned,
        "angle_error": turned,
        "speed_ratio": ratio,
        "acceleration_ratio": acceleration,
        "jerk_ratio": jerk(bend, angle),
        "jerk_ratio's part": jerk_term(bend, angle),
        "torque of the driven shaft": 1 / ratio,
        "torque of the driving shaft": ratio,
        "torque of a flywheel": acceleration,
    }
    items = {field.name: getattr(loads, field.name)[0] for field in fields(loads)}
    items |= {
        f"support of the {end} shaft": support
        for end, support in zip(("driving", "driven"), loads.support_moment, strict=True)
    }
    for name, item in items.items():
        if isinstance(item, tuple):
            found |= {f"{name} {axis}": x for axis, x in zip("xyz", item, strict=True)}
        else:
            found[name] = item
    return found


def chain(
    bends: list[MpNumber], twists: list[MpNumber], phases: list[MpNumber], angle: MpNumber
) -> dict[str, MpNumber]:
    """Motion behind the last joint, joint after joint."""
    turn, ratio, acceleration, third, part = angle, mp.mpf(1), mp.mpf(0), mp.mpf(0), mp.mpf(0)
    errors, start = mp.mpf(0), mp.mpf(0)
    a, b = mp.mpc(1), mp.mpc(0)
    for j, bend in enumerate(bends):
        if j > 0:
            step = phases[j - 1] - twists[j - 1] + mp.pi / 2
            turn += step
            start += step
            a, b = a * mp.expj(step), b * mp.expj(step)
        r, f = rates(bend, turn)
        own, mixed = jerk_term(bend, turn) * ratio**3, abs(3 * f * ratio * acceleration)
        part = max(own, mixed, r * part)
        third = jerk(bend, turn) * ratio**3 + 3 * f * ratio * acceleration + r * third
        acceleration = f * ratio**2 + r * acceleration
        ratio *= r
        turned = error(bend, turn)
        turn += turned
        errors += turned
        k = mp.tan(bend / 2) ** 2
        a, b = a - k * mp.conj(b), b - k * mp.conj(a)
    # The mean of the summed errors is that of the chain's own angle.
    mean = mp.arg(a * mp.expj(-start))
    errors -= mean
    errors -= 2 * mp.pi * mp.nint(errors / (2 * mp.pi))
    return {
        "angle": angle + errors,
        "angle_error": errors,
        "speed_ratio": ratio,
        "acceleration_ratio": acceleration,
        "jerk_ratio": third,
        "jerk_ratio's part": part,
        "steepness": abs(ratio) ** 2 * 4 + abs(acceleration) + 1,
    }


def forces(
    bends: list[MpNumber],
    twists: list[MpNumber],
    phases: list[MpNumber],
    angle: MpNumber,
    mounted: list[list[MpNumber]],
) -> dict[str, MpNumber]:
    """Forces of the joints, then of the bearings, from the equilibrium of all shafts."""
    (torque,), supported, lengths, shafts, positions = mounted
    u: MpVector = (mp.mpf(1), mp.mpf(0), mp.mpf(0))
    normal: MpVector = (mp.mpf(0), mp.mpf(0), mp.mpf(1))
    driving = turned(cross(normal, u), u, angle)
    directions, moments = [u], []
    for j, bend in enumerate(bends):
        if j > 0:
            normal = turned(normal, u, twists[j - 1])
            driving = turned(driving, u, phases[j - 1])
        behind = turned(u, normal, bend)
        driven = unit(cross(behind, driving))
        across = cross(driving, driven)
        moments.append(times(across, torque / dot(across, u)))
        u, driving, torque = behind, driven, dot(moments[-1], behind)
        directions.append(u)
    bearings = [(int(shaft), place) for shaft, place in zip(shafts, positions, strict=True)]
    held = [int(shaft) if shaft >= 0 else None for shaft in supported]
    rows, right = system(directions, lengths, moments, bearings, held)
    solved = list(mp.lu_solve(mp.matrix(rows), mp.matrix(right)))
    in_order = solved[3 * len(bearings) :] + solved[: 3 * len(bearings)]
    names = [f"force {item} {axis}" for item in range(len(solved) // 3) for axis in "xyz"]
    return dict(zip(names, in_order, strict=True))


@dataclass(frozen=True)
class Leaning:
    """Joints as built: the driven pin is turned until it has its angle to the driving one."""

    bends: list[MpNumber]
    twists: list[MpNumber]
    phases: list[MpNumber]
    deviations: list[MpNumber]

    def at(self, angle: MpNumber) -> tuple[MpNumber, dict[str, MpNumber]]:
        """Return the sum of angle errors with its mean, and what the last joint does."""
        u: MpVector = (mp.mpf(1), mp.mpf(0), mp.mpf(0))
        normal: MpVector = (mp.mpf(0), mp.mpf(0), mp.mpf(1))
        errors, ratio, found = mp.mpf(0), mp.mpf(1), {}
        for j, bend in enumerate(self.bends):
            lean, skew, lean_driven = self.deviations[3 * j : 3 * j + 3]
            if j > 0:
                normal = turned(normal, u, self.twists[j - 1])
                angle += self.phases[j - 1] - self.twists[j - 1] + mp.pi / 2
            level = turned(cross(normal, u), u, angle)
            p = add(times(u, mp.sin(lean)), level, mp.cos(lean))
            v = turned(u, normal, bend)

            def pin(
                psi: MpNumber, v: MpVector = v, m: MpVector = normal, e: MpNumber = lean_driven
            ) -> MpVector:
                return add(times(v, mp.sin(e)), turned(m, v, psi), mp.cos(e))

            near = angle + error(bend, angle)
            psi = mp.findroot(
                lambda x, p=p, pin=pin, skew=skew: dot(p, pin(x)) - mp.sin(skew), near
            )
            q = pin(psi)
            across = cross(p, q)
            found["moment"] = times(across, 1 / (ratio * dot(across, u)))
            ratio *= dot(across, u) / dot(across, v)
            level_p, level_q = unit(cross(u, p)), unit(cross(v, q))
            found["tilt_driving"] = mp.atan2(dot(q, cross(p, level_p)), dot(q, level_p))
            found["tilt_driven"] = mp.atan2(dot(p, cross(q, level_q)), -dot(p, level_q))
            errors += psi - angle
            angle, u = psi, v
        return errors, found


def leaning(
    bends: list[MpNumber],
    twists: list[MpNumber],
    phases: list[MpNumber],
    deviations: list[MpNumber],
    angle: MpNumber,
) -> dict[str, MpNumber]:
    """Return what the last joint and the shaft behind it do."""
    samples, line = 128, Leaning(bends, twists, phases, deviations)
    lags = [line.at(2 * mp.pi * i / samples)[0] for i in range(samples)]
    own, found = line.at(angle)

    def turn(x: MpNumber) -> MpNumber:
        return x + line.at(x)[0]

    rates = [mp.diff(turn, angle, order, h=mp.mpf(10) ** -22) for order in (1, 2, 3)]
    names = ("speed_ratio", "acceleration_ratio", "jerk_ratio")
    want = dict(zip(names, rates, strict=True)) | {"angle_error": own - mp.fsum(lags) / samples}
    want |= {name: found[name] for name in ("tilt_driving", "tilt_driven")}
    want |= dict(zip(("moment x", "moment y", "moment z"), found["moment"], strict=True))
    # Next to a zero, errors are those of the numbers of which a result is made.
    return want | {f"{name}'s part": max(abs(x), mp.mpf(1)) for name, x in want.items()}


def turned(vector: MpVector, axis: MpVector, angle: MpNumber) -> MpVector:
    """Turn a vector about a unit vector across it."""
    return add(times(vector, mp.cos(angle)), cross(axis, vector), mp.sin(angle))


def numbers(words: Iterable[str]) -> list[MpNumber]:
    return [mp.mpf(float.fromhex(word)) for word in words]


def judged(lines: Iterable[str]) -> Iterator[tuple[str, MpNumber]]:
    """Yield each name with its error."""
    want: dict[str, MpNumber] = {}
    angle, where, steepness = mp.mpf(0), "", mp.mpf(0)
    for line in lines:
        first, *rest = line.split()
        if first == "bend":
            bend, angle = numbers([rest[0], rest[2]])
            mp.dps = digits(bend, angle)
            want, where, steepness = joint(bend, angle), "", mp.mpf(0)
        elif first == "chain":
            bends, twists, phases = (numbers(part.split()) for part in line[6:].split("/"))
            want, where = chain(bends, twists, phases, angle), "chain: "
            steepness = want["steepness"] * 2
        elif first == "forces":
            mounted = [numbers(part.split()) for part in line[7:].split("/")]
            want, where = forces(bends, twists, phases, angle, mounted), "chain: "
            largest, steepness = max(abs(force) for force in want.values()), mp.mpf(0)
            want |= {f"{name}'s part": largest for name in want}
        elif first == "leaning":
            bends, twists, phases, own = (numbers(part.split()) for part in line[8:].split("/"))
            want, where = leaning(bends, twists, phases, own, angle), "leaning: "
            steepness = mp.mpf(0)
        else:
            name, _, words = line.partition(": ")
            got = sum(numbers(words.split()))
            exact = want[name]
            # Numbers below 1e-290 have no second word with all digits.
            if abs(exact) > 1e-290:
                unit = max(abs(exact), want.get(f"{name}'s part", 0)) + steepness * 2**-12
                # The forces of a driveline make one row.
                yield where + (first if first == "force" else name), abs(got - exact) / unit


def main() -> int:
    worst: dict[str, MpNumber] = {}
    count = 0
    for name, off in judged(sys.stdin):
        count += 1
        worst[name] = max(worst.get(name, mp.mpf(0)), off)
    for name, off in worst.items():
        print(f"{name:30} 2**{float(mp.log(off, 2)) if off else -999:.1f}")
    print(f"{count} numbers")
    return 0 if count and max(worst.values()) < LIMIT else 1


if __name__ == "__main__":
    sys.exit(main())

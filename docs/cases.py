"""The case book: numbers that others publish, beside those of the package, and scenes of them."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

import cardan
from cardan import approximations

RPM = math.tau / 60.0
INCH, PSI, POUND = 0.0254, 6894.757293168, 0.45359237

Origin = Literal["printed", "formula", "run", "memory"]
ORIGINS: dict[Origin, str] = {
    "printed": "printed in the source",
    "formula": "values of a formula or rule that the source prints, for sizes chosen here",
    "run": "results of a program of others that was run for this page",
    "memory": "quoted from memory of a textbook, which nobody has opened for this page",
}

Reason = Literal["rule", "limit", "rounding", "sampling", "integration", "misprint", "untraced"]
REASONS: dict[Reason, str] = {
    "rule": "the source has a rule, and the exact value differs",
    "limit": "the source has a limit for practice, in round numbers",
    "rounding": "the source rounds on the way to its result",
    "sampling": "the source takes the largest of samples, which miss the peak",
    "integration": "the source integrates in steps of time",
    "misprint": "the source has a misprint",
    "untraced": "not retraced, because the source was not at hand",
}


@dataclass(frozen=True)
class Case:
    """One published number.

    Attributes:
        given: what the number belongs to.
        figure: what it is, with its unit.
        published: the number as it is published.
        ours: what the package computes.
        apart: ours less the published number, to some digits; empty if ours rounds to it.
        reason: why they are apart.
        why: the same in words.
        value: the published number where it is not written as a decimal.
    """

    given: str
    figure: str
    published: str
    ours: float
    apart: str = ""
    reason: Reason | None = None
    why: str = ""
    value: float | None = None

    @property
    def number(self) -> float:
        """The published number."""
        return float(self.published) if self.value is None else self.value

    @property
    def difference(self) -> float:
        """Ours less the published number."""
        return self.ours - self.number

    @property
    def agrees(self) -> bool:
        """Whether ours rounds to the published number, to its last digit."""
        own = f"{self.ours:z.{decimals(self.published)}f}"
        return self.value is None and own == self.published

    @property
    def row(self) -> str:
        """The case as a row of a table."""
        digits = 2 if self.value is not None else min(decimals(self.published) + 2, 12)
        digits = max(digits, decimals(self.apart))
        numbers = (self.published, f"{self.ours:z.{digits}f}", f"{self.difference:+z.{digits}f}")
        return f"| {' | '.join((self.given, self.figure, *numbers, self.why or 'agrees'))} |"


@dataclass(frozen=True)
class Source:
    """Where numbers are published, with its cases.

    Attributes:
        title: a heading.
        text: the source with its page, what it gives, and what is compared.
        origin: what kind of numbers these are.
        cases: makes them.
        scenes: names of those in which they can be moved.
    """

    title: str
    text: str
    origin: Origin
    cases: Callable[[], Iterator[Case]]
    scenes: tuple[str, ...]


def decimals(number: str) -> int:
    """Return how many digits a number has behind its point."""
    return len(number.partition(".")[2])


def joint(degrees: float) -> cardan.Driveline:
    """Return a single joint."""
    return cardan.Driveline.from_bends([degrees], degrees=True)


def bend_where(figure: Callable[[cardan.EquivalentJoint], float], value: float) -> float:
    """Return the bend of a single joint, in degrees, whose figure has a value; by bisection."""
    low, high = 0.0, 80.0
    while (middle := 0.5 * (low + high)) not in (low, high):
        low, high = (middle, high) if figure(joint(middle).equivalent()) < value else (low, middle)
    return high


def farthest(values: ArrayLike, number: float) -> float:
    """Return the value that differs most from a number."""
    flat = np.ravel(values)
    return float(flat[np.argmax(np.abs(flat - number))])


# --- Dana ------------------------------------------------------------------------------------

ARRANGEMENTS = {"Z": 180.0, "W": 0.0}


def dana_bearings(bends: tuple[float, float], arrangement: str) -> NDArray[np.float64]:
    """Return the forces on the bearings A, B, E and F in N with the fork at 0° and at 90°."""
    line = cardan.Driveline.from_bends(bends, ARRANGEMENTS[arrangement], 0.0, degrees=True)
    positions = [(0, 0.5), (0, 0.8), (2, 0.12), (2, 0.47)]
    line = line.with_bearings(positions, lengths=[0.9, 1.2, 0.7])
    load = cardan.Load(drive_torque=1000.0)
    force = line.evaluate([0.0, math.pi / 2], "bearing_force", load=load).bearing_force
    return np.asarray(np.linalg.norm(force, axis=-1))


def dana_forces() -> Iterator[Case]:
    """Radial forces on the connected bearings."""
    for arrangement, numbers in (
        ("Z", ("9.7896", "39.1583", "39.4380", "10.0693")),
        ("W", ("86.6816", "346.7265", "349.2032", "89.1583")),
    ):
        force = dana_bearings((10.0, 8.0), arrangement)[:, 0]
        for bearing, number, own in zip("ABEF", numbers, force, strict=True):
            yield Case(f"{arrangement}, fork at 0°", f"bearing {bearing} [N]", number, float(own))
    crossed = [dana_bearings((10.0, 8.0), arrangement)[:, 1] for arrangement in ARRANGEMENTS]
    for name, number, columns in (("A and B", "587.7566", [0, 1]), ("E and F", "403.7716", [2, 3])):
        forces = np.stack(crossed)[:, columns]
        given = "Z and W, fork at 90°"
        yield Case(given, f"bearings {name} [N]", number, farthest(forces, float(number)))
    for arrangement, bearing, number in (("Z", "all bearings", "0"), ("W", "bearing A", "96.4712")):
        forces = dana_bearings((10.0, 10.0), arrangement)[:, 0]
        own = farthest(forces, 0.0) if bearing == "all bearings" else float(forces[0])
        given = f"{arrangement}, both bends 10°, fork at 0°"
        yield Case(given, f"{bearing} [N]", number, own)


def dana_friction() -> Iterator[Case]:
    """Axial force of the spline, along the shaft that bears it."""
    line = cardan.Driveline.from_bends([10, 8], 180, 0, degrees=True)
    line = line.with_bearings([], lengths=[0.9, 1.2, 0.7])
    for coating, friction, upstream, downstream in (
        ("plastic coated, μ 0.08", 0.08, "1750.77", "1760.48"),
        ("steel, greased, μ 0.11", 0.11, "2407.31", "2420.66"),
    ):
        force = line.spline_force(1, 1000.0, friction, 0.045)
        for bend, number, own in (
            (10, upstream, force.upstream_axial),
            (8, downstream, force.downstream_axial),
        ):
            # Both push outwards, one along the direction of its shaft and one against it.
            yield Case(coating, f"at the bend of {bend}° [N]", number, float(np.abs(own)))


DANA = """
[driveline]
bends_deg = [10, 8]
twists_deg = {twist}
phases_deg = 0
lengths_mm = [900, 1200, 700]

[load]
drive_torque_Nm = 1000

[[bearing]]
shaft = 0
position_mm = 500

[[bearing]]
shaft = 0
position_mm = 800

[[bearing]]
shaft = 2
position_mm = 120

[[bearing]]
shaft = 2
position_mm = 470
"""

# --- a driveshaft maker ----------------------------------------------------------------------


def maker() -> Iterator[Case]:
    """Four joints, by the rule of the workshop and exactly, and a tube."""
    bends, signs, speed = np.radians([5.0, 4.0, 3.0, 2.0]), [1, 1, -1, 1], 2500 * RPM
    rule = "by the rule, fork signs + + − +"
    drive, coast = (approximations.inertia_bend(bends, signs, way) for way in ("drive", "coast"))
    both = approximations.catalogue_bend(bends, signs)
    for name, number, bend in (
        ("inertia, driving", "9.90", drive),
        ("inertia, coasting", "3.16", coast),
        ("torsional", "6.00", both),
    ):
        yield Case(rule, f"{name} [°]", number, math.degrees(bend))
    for name, number, own in (
        ("driving", "2026", approximations.inertia_excitation(bends, signs, speed)),
        ("coasting", "209", approximations.inertia_excitation(bends, signs, speed, "coast")),
        ("torsional", "749", approximations.torsional_excitation(bends, signs, speed)),
    ):
        yield Case(rule, f"{name} [rad/s²]", number, float(own))

    line = cardan.Driveline.from_bends(bends, 0.0, np.radians([90.0, 0.0, 0.0]))
    exact = "exactly, phases 90, 0, 0°"
    yield Case(exact, "torsional [°]", "6.00", float(line.equivalent().bend_deg))
    own = {finding.name: float(finding.value) for finding in line.check(speed).findings}
    why = "the squares of the bends stand for $2\\ln\\sec\\beta$, and their sine for its peak"
    for name, number, found, apart in (
        ("driving", "2026", own["inertia excitation, driving"], "+22.5"),
        ("coasting", "209", own["inertia excitation, coasting"], ""),
        ("torsional", "749", own["torsional excitation, last shaft"], "+3.5"),
    ):
        reasons: tuple[Reason | None, str] = ("rule", why) if apart else (None, "")
        yield Case(exact, f"{name} [rad/s²]", number, found, apart, *reasons)

    density = 0.281 * POUND / INCH**3
    sizes = (3.5 * INCH, 0.12 * INCH)
    tube = cardan.tube(*sizes, length=60 * INCH, elastic_modulus=29e6 * PSI, density=density)
    given = "tube 3.500 × 0.120 × 60.00 in, 29 · 10⁶ psi, 0.281 lb/in³"
    why = "the source rounds the constant 4 703 272 to 4 705 000"
    speed = float(tube.critical_speed) / RPM
    yield Case(given, "critical speed [rpm]", "6251", speed, "-2.1", "rounding", why)


MAKER = """
[driveline]
bends_deg = [5, 4, 3, 2]
twists_deg = [0, 0, 0]
phases_deg = [90, 0, 0]

[load]
speed_rpm = 2500

[limits]
preset = "truck"
"""

# --- the largest bend over the speed ---------------------------------------------------------


def peak(degrees: float, rpm: float) -> float:
    """Return the largest acceleration behind a single joint in rad/s²."""
    return float(joint(degrees).equivalent().max_acceleration_ratio) * (rpm * RPM) ** 2


def bend_at(rpm: float) -> float:
    """Return the bend in degrees at which a single joint reaches 1000 rad/s²."""
    return bend_where(lambda own: float(own.max_acceleration_ratio), 1000.0 / (rpm * RPM) ** 2)


def spicer() -> Iterator[Case]:
    """Eight speeds."""
    for rpm, number, apart in (
        (5000, "3.2", "+0.26"),
        (4500, "3.7", "+0.14"),
        (4000, "4.2", "+0.12"),
        (3500, "5.0", "-0.06"),
        (3000, "5.8", ""),
        (2500, "7.0", "-0.09"),
        (2000, "8.7", "-0.07"),
        (1500, "11.5", ""),
    ):
        why = f"at the printed angle it is {peak(float(number), rpm):.0f} rad/s²" if apart else ""
        own = bend_at(rpm)
        yield Case(f"{rpm} rpm", "bend [°]", number, own, apart, "limit" if apart else None, why)


PARKER_ANGLES = ((3000, 5, 50, "-0.07"), (2500, 7, 0, "-0.09"), (2000, 8, 40, "-0.03"))


def parker() -> Iterator[Case]:
    """Four speeds, and the acceleration below them."""
    for rpm, whole, minutes, apart in (*PARKER_ANGLES, (1500, 11, 30, "-0.01")):
        printed, value = f"{whole}° {minutes:02}′", whole + minutes / 60.0
        why = f"at the printed angle it is {peak(value, rpm):.0f} rad/s²"
        yield Case(
            f"{rpm} rpm", "bend [°]", printed, bend_at(rpm), apart, "limit", why, value=value
        )
    why = "a zero is missing: all four angles give 1000 rad/s² within 3 %"
    own = peak(5 + 50 / 60.0, 3000)
    yield Case("5° 50′ at 3000 rpm", "basis [rad/s²]", "100", own, "+925", "misprint", why)


OVER_SPEED = """
[driveline]
bends_deg = [{bend}]

[load]
speed_rpm = {speed}

[limits]
torsional_excitation_rad_s2 = 1000
equivalent_bend_deg = 12

[states]
names = {names}
bends_deg.0 = {bends}
speed_rpm = {speeds}
"""


def over_speed(angles: dict[int, float]) -> str:
    """Return the scene of a single joint with its largest bend at each speed."""
    speeds, bends = list(angles), [round(bend, 4) for bend in angles.values()]
    names = "[" + ", ".join(f'"{speed} rpm"' for speed in speeds) + "]"
    return OVER_SPEED.format(
        bend=bends[0], speed=speeds[0], names=names, bends=bends, speeds=speeds
    )


# --- a hitch ---------------------------------------------------------------------------------


def hitch() -> Iterator[Case]:
    """A turn of 15, 30 and 45°, with the hitch pin halfway between the joints."""
    turns = np.array([15.0, 30.0, 45.0])
    cosine, sine = np.cos(np.radians(turns)), np.sin(np.radians(turns))
    along = np.stack([cosine, sine, 0.0 * sine], axis=-1)
    ahead = np.broadcast_to([-1.0, 0.0, 0.0], along.shape)
    line = cardan.Driveline.from_points(
        np.stack([24 * ahead, 14 * ahead, 14 * along, 24 * along], axis=-2)
    )
    for turn, bends in zip(turns, line.bends_deg, strict=True):
        number = f"{turn / 2:.1f}"
        own = farthest(bends, float(number))
        yield Case(f"turn of {turn:.0f}°", "bend of both joints [°]", number, own)
    # Of the rounding of 1e-16 that the two bends leave, the bend would show the root.
    uneven = farthest(100.0 * line.equivalent().non_uniformity, 0.0)
    yield Case("all three turns", "non-uniformity of the implement's shaft [%]", "0", uneven)


HITCH = """
[driveline]                    # 14 in is 355.6 mm; seen from above
points_mm = [[-609.6, 0, 0], [-355.6, 0, 0], [343.483, 92.036, 0], [588.828, 157.776, 0]]

[load]
speed_rpm = 540

[states]
names = ["turn of 15°", "turn of 30°", "turn of 45°"]
points_mm.2.x = [343.483, 307.959, 251.447]
points_mm.2.y = [92.036, 177.8, 251.447]
points_mm.3.x = [588.828, 527.929, 431.052]
points_mm.3.y = [157.776, 304.8, 431.052]
"""

# --- compound angles -------------------------------------------------------------------------


def compound() -> Iterator[Case]:
    """Two slopes, by the root of the squares and exactly."""
    for side, plan, number, apart in ((4, 3, "5.00", "-0.006"), (15, 10, "18.03", "-0.25")):
        line = cardan.Driveline.from_slopes([0, side], [0, plan], degrees=True)
        why = "the source adds the squares of the angles, where their tangents belong"
        given = f"{side}° in side view, {plan}° in plan view"
        own = float(line.bends_deg[0])
        yield Case(given, "compound angle [°]", number, own, apart, "rule", why)


COMPOUND = """
[driveline]
slopes_vertical_deg = [0, 4]
slopes_horizontal_deg = [0, 3]

[limits]
equivalent_bend_deg = 5
source = "Meritor, MM-96147, page 87"
"""

# --- a multibody program ---------------------------------------------------------------------


def exudyn_formula() -> Iterator[Case]:
    """The speeds by the example's own formula."""
    own = joint(45.0).equivalent()
    given = "45°, 10 rad/s"
    yield Case(given, "least speed [rad/s]", "7.0711", 10.0 * float(own.min_speed_ratio))
    yield Case(given, "largest speed [rad/s]", "14.1421", 10.0 * float(own.max_speed_ratio))


def exudyn_run() -> Iterator[Case]:
    """The largest speed, integrated."""
    own = 10.0 * float(joint(45.0).equivalent().max_speed_ratio)
    why = "anywhere in the turn its ratio is up to 0.0022 off"
    figure = "largest speed [rad/s]"
    yield Case("steps of 1 ms", figure, "14.1417", own, "+0.0004", "integration", why)
    yield Case("steps of 0.1 ms", figure, "14.1421", own)


EXUDYN = """
[driveline]
bends_deg = [45]

[load]
speed_rpm = 95.4930
"""

# --- a search for phases ---------------------------------------------------------------------

SEARCHED = (43.02, 25.26, 47.51)


def searched() -> Iterator[Case]:
    """Three joints in a plane, with the phases that four searches find."""
    line = cardan.Driveline.from_bends(SEARCHED, degrees=True)
    given = "bends of 43.02, 25.26 and 47.51°"
    # The other solution has both phases with the opposite sign.
    best = line.with_phases([70, 15], degrees=True).optimal_phases(degrees=True)
    for shaft, number, phase in ((1, "68.211041194", best[0]), (2, "16.518456782", best[1])):
        at = f"best phase of shaft {shaft}, two finest searches [°]"
        yield Case(given, at, number, float(phase))
    why = "its 7200 samples over half a turn miss the peak"
    figure = "non-uniformity [%]"
    for phases, number, apart in (
        ((70.0, 15.0), "0.754064857892", "+0.000000057"),
        ((68.25, 16.5), "0.036594619153", "+0.000000000118"),
    ):
        turned = line.with_phases(phases, degrees=True)
        own = 100.0 * float(turned.equivalent().non_uniformity)
        at = f"{given}, phases {phases[0]:g} and {phases[1]:g}°"
        yield Case(at, figure, number, own, apart, "sampling", why)
    own = 100.0 * float(
        cardan.Driveline.from_bends([9.5] * 3, 0, 30, degrees=True).equivalent().non_uniformity
    )
    yield Case(
        "three bends of 9.5°, phases 30°",
        figure,
        "0.000131672855774",
        own,
        "+0.000000000000091",
        "rounding",
        "the source subtracts two ratios near 1 as doubles",
    )


SEARCH = """
[driveline]
bends_deg = [43.02, 25.26, 47.51]
twists_deg = [0, 0]
phases_deg = [70, 15]
"""

# --- catalogues ------------------------------------------------------------------------------


def catalogue() -> Iterator[Case]:
    """The largest angle errors of one joint, and a shaft bent in space."""
    for bend, error, place, apart in (
        (10.0, "0.438", "44.8", "+0.0006"),
        (20.0, "1.782", "44.1", ""),
        (30.0, "4.117", "42.9", ""),
    ):
        own = joint(bend).equivalent()
        reasons: tuple[Reason | None, str] = (
            ("misprint", "cut after 0.4385") if apart else (None, "")
        )
        given = f"Bild 11, bend of {bend:.0f}°"
        number = float(own.max_angle_error_deg)
        yield Case(given, "largest angle error [°]", error, number, apart, *reasons)
        yield Case(given, "where it is [°]", place, float(own.max_angle_error_at_deg))
    line = cardan.Driveline.from_projected_bends([15, -11.5], [7, 12], degrees=True)
    given = "section 6.3, 15° and 7° in two views, −11.5° and 12° behind"
    why = "the source adds angles in a drawing, where their tangents belong"
    bend = float(line.bends_deg[0])
    yield Case(given, "bend of joint 0 [°]", "16.5", bend, "-0.08", "rule", why)
    phase = float(line.optimal_phases(degrees=True)[0])
    yield Case(given, "angle by which the yoke is set [°]", "71", abs(phase))


BILD_11 = """
[driveline]
bends_deg = [10]

[states]
names = ["10°", "20°", "30°"]
bends_deg.0 = [10, 20, 30]
"""

SPATIAL = """
[driveline]
projected_bends_vertical_deg = [15, -11.5]
projected_bends_horizontal_deg = [7, 12]
phases_deg = [-71]
"""

# --- textbooks -------------------------------------------------------------------------------


def khurmi() -> Iterator[Case]:
    """One joint, five examples."""
    at = float(joint(18.0).equivalent().max_angle_error_at_deg)
    for number, own in (("44.3", at), ("135.7", 180.0 - at)):
        yield Case("9.8: 18°", "angle where the ratio is 1 [°]", number, own)

    def spread(value: float) -> float:
        return bend_where(lambda own: float(own.non_uniformity), value)

    yield Case("9.9: 500 rpm ± 6 %", "bend [°]", "19.64", spread(0.12))
    yield Case("9.10: 1200 rpm, 100 rpm in all", "bend [°]", "16.4", spread(100 / 1200))
    acceleration = peak(20.0, 1500)
    why = "not retraced; rounding in the book's steps would explain it"
    given = "9.7: 20°, 1500 rpm, 12 kg at 100 mm"
    yield Case(given, "acceleration [rad/s²]", "3090", acceleration, "-7", "untraced", why)
    torque = 12 * 0.1**2 * acceleration
    yield Case(given, "torque [N m]", "371", torque, "-1.0", "untraced", why)
    load = cardan.Load(output_torque=200.0, speed=240 * RPM, inertias=[0.0, 55 * 0.15**2])
    torques = joint(20.0).evaluate(math.pi / 4, "torque", load=load, shafts=[0, 1]).torque
    given = "9.11: 20°, 240 rpm, 55 kg at 150 mm, 200 N m, at 45°"
    for name, number, found in (("driven", "102.8", torques[1]), ("driving", "102.6", torques[0])):
        figure = f"torque of the {name} shaft [N m]"
        yield Case(given, figure, number, float(found), "+0.3", "untraced", why)
    yield Case("9.11: 24 rpm in all", "bend [°]", "18", spread(24 / 240))


KHURMI = """
[driveline]
bends_deg = [20]

[load]
speed_rpm = 240
output_torque_Nm = 200
inertias_kgm2 = [0, 1.2375]
"""

# --- the book --------------------------------------------------------------------------------


def scene(title: str, text: str) -> str:
    """Return the text of a scene with its title."""
    return f'title = "{title}"\n{text}'


SCENES = {
    "dana-z": scene("Dana, page 46, Z arrangement", DANA.format(twist=180)),
    "dana-w": scene("Dana, page 46, W arrangement", DANA.format(twist=0)),
    "maker": scene("A driveshaft maker's four joints", MAKER),
    "spicer": scene(
        "Spicer, largest bend over the speed",
        over_speed({int(c.given.split()[0]): c.number for c in spicer()}),
    ),
    "parker": scene(
        "Parker/Chelsea, largest bend over the speed",
        over_speed({int(c.given.split()[0]): c.number for c in list(parker())[:4]}),
    ),
    "hitch": scene("Equal-angle hitch in three turns", HITCH),
    "compound": scene("Meritor, a compound angle of 4° and 3°", COMPOUND),
    "exudyn": scene("EXUDYN's example, 45° at 10 rad/s", EXUDYN),
    "phases": scene("Three joints of a published search", SEARCH),
    "bild-11": scene("Catalogue, Bild 11", BILD_11),
    "spatial": scene("Catalogue, section 6.3, a shaft bent in space", SPATIAL),
    "flywheel": scene("Example 9.11, a flywheel behind one joint", KHURMI),
}

SOURCES = (
    Source(
        "Bearing forces, Dana",
        "Dana, *Cardan Shafts for Industrial Applications*, page 46, prints formulas for the "
        "radial forces on the four bearings beside a shaft with two joints, for the fork at 0° "
        "and at 90°. They are evaluated here for 1000 N m, bends of 10° and 8°, 1.2 m between "
        "the joints, bearings A and B 0.3 m apart and 0.1 m before the first joint, bearings E "
        "and F 0.35 m apart and 0.12 m behind the second.",
        "formula",
        dana_forces,
        ("dana-z", "dana-w"),
    ),
    Source(
        "Friction of the spline, Dana",
        "The same catalogue, page 45, prints $F = T\\cos\\beta\\,\\mu/r_m$ and two friction "
        "coefficients. It is evaluated for the shaft above and a pitch radius of 45 mm.",
        "formula",
        dana_friction,
        ("dana-z", "dana-w"),
    ),
    Source(
        "Four joints and a tube, a driveshaft maker",
        "The program PSS.DriveshaftCalculations (github.com/anderjeff) of a driveshaft maker in "
        "the United States calibrates itself with numbers in its files "
        "`Calibration/AccelerationCalibration.cs` and `CriticalSpeedCalibration.cs`; for the "
        "tube it cites page 267 of SAE AE-7. Joints of 5, 4, 3 and 2°, the first shaft with "
        "crossed yokes, the others with parallel ones, at 2500 rpm. Its rule first, then the "
        "exact values beside the same numbers.",
        "printed",
        maker,
        ("maker",),
    ),
    Source(
        "Largest bend over the speed, Spicer",
        "Spicer, driveline operating angle calculator (spicerparts.com), maximum operating "
        "angles. The bend at which a single joint reaches an acceleration of 1000 rad/s² is "
        "compared; Spicer does not say on which figure its angles rest.",
        "printed",
        spicer,
        ("spicer",),
    ),
    Source(
        "Largest bend over the speed, Parker/Chelsea",
        "Parker/Chelsea, bulletin HY25-1890-M1/US, page 5, angles for auxiliary shafts, with the "
        "line “based on angular acceleration of 100 RAD/SEC²” below them.",
        "printed",
        parker,
        ("parker",),
    ),
    Source(
        "Equal-angle hitch, John Deere",
        "John Deere's operator's manuals (OMSU20196, “Attach PTO-driven implement”) set 356 mm "
        "(14.0 in) from the end of a 540 rpm tractor shaft to the hole of the hitch pin. The "
        "equal-angle hitch of the implement has the same distance behind the pin, so that each "
        "joint takes half of a turn and the implement's shaft turns evenly.",
        "formula",
        hitch,
        ("hitch",),
    ),
    Source(
        "Compound angles, Meritor",
        "Meritor, maintenance manual MM-96147, page 87: the root of the sum of the squares of "
        "the angles in side view and in plan view.",
        "formula",
        compound,
        ("compound",),
    ),
    Source(
        "One joint, the formula of EXUDYN's example",
        "`universalJoint.py` among the examples of the multibody program EXUDYN compares its "
        "result with $\\omega\\cos\\beta/(1 - \\cos^2(\\alpha + 90°)\\sin^2\\beta)$.",
        "formula",
        exudyn_formula,
        ("exudyn",),
    ),
    Source(
        "One joint, EXUDYN's example integrated",
        "The same example over ten turns, run with EXUDYN 1.13.6 without its window.",
        "run",
        exudyn_run,
        ("exudyn",),
    ),
    Source(
        "Best phases of three joints, another program",
        "Cardanjoint-optimization-tool (github.com/furk4nkasap), `BENCHMARK_REPORT.txt` and "
        "`TEST_REPORT.txt` of version 1.2.4, joints in one plane. Its four searches take 10 to "
        "150 ms and reach different phases; `optimal_phases` solves for them.",
        "printed",
        searched,
        ("phases",),
    ),
    Source(
        "One joint and a spatial shaft, driveshaft catalogues",
        "The chapters *Kinematik des Kreuzgelenks* and *Doppelgelenk* of German driveshaft "
        "catalogues, as [the sources](theory/sources.md#catalogue-single-joint) list them.",
        "printed",
        catalogue,
        ("bild-11", "spatial"),
    ),
    Source(
        "One joint, Khurmi and Gupta (from memory)",
        "R. S. Khurmi and J. K. Gupta, *Theory of Machines*, chapter 9, examples 9.7 to 9.11. "
        "The numbers are quoted from memory; numbers and editions of the examples may differ.",
        "memory",
        khurmi,
        ("flywheel",),
    ),
)


def answer() -> str:
    """Return how many numbers agree, by where they come from, and why the others do not."""
    cases = [(source.origin, case) for source in SOURCES for case in source.cases()]
    total, same = (
        Counter(origin for origin, case in cases if case.agrees or not strict)
        for strict in (False, True)
    )
    apart = [case.reason for _, case in cases if not case.agrees]
    known = len(apart) - apart.count("untraced")
    lines = [
        f"**{same.total()} of {total.total()} published numbers agree with cardan to the last "
        f"published digit.** The other {len(apart)} differ, {known} of them for a reason that is "
        "known.",
        "",
        "| the published numbers are | numbers | agree |",
        "|---|--:|--:|",
    ]
    lines += [f"| {words} | {total[name]} | {same[name]} |" for name, words in ORIGINS.items()]
    lines += ["", "| why numbers differ | numbers | largest difference |", "|---|--:|--:|"]
    for reason, words in REASONS.items():
        own = [case for _, case in cases if case.reason == reason]
        share = 100.0 * max(abs(case.difference / case.number) for case in own)
        worst = "–" if reason == "misprint" else f"{share:.2g} %"
        lines.append(f"| {words} | {len(own)} | {worst} |")
    return "\n".join(lines)


def book() -> str:
    """Return a section with a table for every source."""
    parts = []
    for source in SOURCES:
        titles = {name: cardan.Scene.parse(SCENES[name]).title for name in source.scenes}
        links = [f"[{title}](machines/moving.html?{name})" for name, title in titles.items()]
        parts += [f"## {source.title}", "", source.text, "", f"To move: {', '.join(links)}.", ""]
        parts += ["| given | figure | published | cardan | difference | why |"]
        parts += ["|---|---|--:|--:|--:|---|", *(case.row for case in source.cases()), ""]
    return "\n".join(parts)

"""Every capability of the core has a slow twin in the reference, or a line that says why not yet.

Capabilities are the outputs, the functions of the package, and the public names of its classes that
compute. A twin is named by its place in `cardan.reference`; a reason is a sentence.
"""

from __future__ import annotations

import importlib

import pytest

import cardan

CLASSES = ("Driveline", "Transmission", "Plan", "TorsionalSystem", "BallJoint")

# The other public names of the package: they state, choose or carry results of those above.
CARRIERS = (
    "ActiveLimit ArgumentError ArgumentTypeError ArgumentValueError Check Derivatives "
    "EquivalentJoint Finding FreeRunning Gradient Harmonics Identification Lengths Life Limit "
    "Limits Load Losses Motion Optimum OrderTolerances Output Result Scene Slides SplineForce "
    "Steering Sweep Tolerances Tube TwoJoints OUTPUTS"
)

SHAPE = "it selects, arranges or labels and computes nothing"
UNIT = "another unit of what has a twin"
ORDERS = "Driveline.harmonics has one; those of other outputs are sums of the same kind"
DESIGN = "closed forms and further constructors come with the design of the core"
AS_BUILT = "yokes as built come after the ideal ones; tests judge them by hinges with 40 digits"
SEARCH = "it searches or samples in Python above outputs that have twins"
DYNAMICS = "equations of motion; tests judge them by Runge-Kutta and multibody engines"
CONTACT = "contact, not a mechanism; tests judge it by integrals over the surface"
SOURCES = "formulas of the sources, themselves compared with the core"

TWINS = {
    "OUTPUTS": {
        "angle angle_error speed_ratio acceleration_ratio jerk_ratio": "vectors.motion",
        "torque support_moment moment bending_driving bending_driven pin_moment": "forces.loads",
        "tilt_driving tilt_driven": "vectors.tilts",
        "swing_driving swing_driven driving_pin driven_pin": "vectors.crosses",
        "joint_force bearing_force": "forces.forces",
    },
    "cardan": {
        "approximations": SOURCES,
        "identify identify_two_joints optimise": SEARCH,
        "plots": "pictures of what is computed elsewhere",
        "reference": "the twins themselves",
        "tube": DESIGN,
        "workshop": "words of the workshop for phases, which have a twin",
    },
    "Driveline": {
        "from_bends": "vectors.from_bends",
        "from_directions": "vectors.from_directions",
        "from_points": "vectors.from_points",
        "bends": "vectors.Shafts.bends",
        "twists": "vectors.Shafts.twists",
        "directions normals phases with_phases": "vectors.Shafts",
        "bends_deg twists_deg phases_deg deviations_deg": UNIT,
        "evaluate": "vectors.motion",
        "equivalent": "phasing.equivalent",
        "transmission": "phasing.transmission",
        "optimal_phases": "phasing.optimal_phases",
        "harmonics": "wear.harmonics",
        "losses": "wear.losses",
        "life": "wear.life",
        "free_running": "wear.free_running",
        "from_slopes from_projected_bends from_double_joint slides lengths spline_force steering "
        "catalogue_bend": DESIGN,
        "check": "it compares values with limits",
        "order_tolerances tolerances": SEARCH,
        "deviations has_deviations with_deviations with_play lash wind_up": AS_BUILT,
        "approx_equal bearings concatenate has_points n_bearings n_joints ndim plan reshape "
        "reversed shape size with_bearings": SHAPE,
    },
    "Transmission": {
        "q abs2": "phasing.Transmission",
        "motion": "phasing.Transmission.motion",
        "gradient": "phasing.Transmission.gradient",
        "dq d_abs2": "phasing.dq",
        "d_bend": "it refuses",
    },
    "Plan": {
        "derivatives gradient": "tests judge derivatives by differences in 60 digits",
        "harmonics": ORDERS,
        "dtype explain labels places planes request": SHAPE,
    },
    "TorsionalSystem": {
        "coexisting compliant critical_speeds dampings load_torque natural_frequencies orbit "
        "stability steady transient": DYNAMICS,
        "line shape": SHAPE,
    },
    "BallJoint": {
        "allowable_load approach contact_angle friction_moment peak_pressure pressure pressure_at "
        "sized_for tilting_friction_moment with_clearance": CONTACT,
        "shape": SHAPE,
    },
}


def names_of(owner: str) -> list[str]:
    if owner == "OUTPUTS":
        return list(cardan.OUTPUTS)
    if owner == "cardan":
        return sorted({*vars(cardan)["__all__"]} - {*CARRIERS.split(), *CLASSES, "__version__"})
    return [name for name in dir(getattr(cardan, owner)) if not name.startswith("_")]


def test_the_table_has_all_classes() -> None:
    assert set(TWINS) == {"OUTPUTS", "cardan", *CLASSES}


@pytest.mark.parametrize("owner", TWINS)
def test_every_capability_has_a_twin_or_a_reason(owner: str) -> None:
    listed = [name for names in TWINS[owner] for name in names.split()]
    assert sorted(listed) == sorted(names_of(owner))


@pytest.mark.parametrize(
    "twin", sorted({t for own in TWINS.values() for t in own.values() if " " not in t})
)
def test_every_twin_exists(twin: str) -> None:
    module, *path = twin.split(".")
    found: object = importlib.import_module(f"cardan.reference.{module}")
    for name in path:
        found = getattr(found, name)
    assert callable(found) or isinstance(found, property)

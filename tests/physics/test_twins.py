"""Every capability of the core has a slow twin in the reference, or a line that says why not yet.

Capabilities are the outputs, the functions of the package, and the public names of its classes that
compute. A twin is named by its place in the package; a reason is a sentence.
"""

from __future__ import annotations

import importlib
from dataclasses import fields

import pytest

import cardan
from cardan import reference
from cardan.reference_forces import Forces

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
    "cardan": {
        "approximations": SOURCES,
        "identify identify_two_joints optimise": SEARCH,
        "plots": "pictures of what is computed elsewhere",
        "reference": "the twins themselves",
        "tube": DESIGN,
        "workshop": "words of the workshop for phases, which have a twin",
    },
    "Driveline": {
        "from_bends": "reference.from_bends",
        "from_directions": "reference.from_directions",
        "from_points": "reference.from_points",
        "bends": "reference.Shafts.bends",
        "twists": "reference.Shafts.twists",
        "directions normals phases with_phases": "reference.Shafts",
        "bends_deg twists_deg phases_deg deviations_deg": UNIT,
        "evaluate": "reference.motion",
        "equivalent": "reference_phasing.equivalent",
        "transmission": "reference_phasing.transmission",
        "optimal_phases": "reference_phasing.optimal_phases",
        "harmonics": "reference_wear.harmonics",
        "losses": "reference_wear.losses",
        "life": "reference_wear.life",
        "free_running": "reference_wear.free_running",
        "from_slopes from_projected_bends from_double_joint slides lengths spline_force steering "
        "catalogue_bend": DESIGN,
        "check": "it compares values with limits",
        "order_tolerances tolerances": SEARCH,
        "deviations has_deviations with_deviations with_play lash wind_up": AS_BUILT,
        "approx_equal bearings concatenate has_points n_bearings n_joints ndim plan reshape "
        "reversed shape size with_bearings": SHAPE,
    },
    "Transmission": {
        "q abs2": "reference_phasing.Transmission",
        "motion": "reference_phasing.Transmission.motion",
        "gradient": "reference_phasing.Transmission.gradient",
        "dq d_abs2": "reference_phasing.dq",
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
    if owner == "cardan":
        return sorted({*vars(cardan)["__all__"]} - {*CARRIERS.split(), *CLASSES, "__version__"})
    return [name for name in dir(getattr(cardan, owner)) if not name.startswith("_")]


def test_the_table_has_all_classes() -> None:
    assert set(TWINS) == {"cardan", *CLASSES}


def test_every_output_has_a_twin() -> None:
    records = (reference.ShaftMotion, reference.Loads, reference.Cross, Forces)
    twins = {field.name for record in records for field in fields(record)}
    # `reference.tilts` returns both.
    assert twins | {"tilt_driving", "tilt_driven"} == set(cardan.OUTPUTS)


@pytest.mark.parametrize("owner", TWINS)
def test_every_capability_has_a_twin_or_a_reason(owner: str) -> None:
    listed = [name for names in TWINS[owner] for name in names.split()]
    assert sorted(listed) == sorted(names_of(owner))


@pytest.mark.parametrize(
    "twin", sorted({t for own in TWINS.values() for t in own.values() if " " not in t})
)
def test_every_twin_exists(twin: str) -> None:
    module, *path = twin.split(".")
    found: object = importlib.import_module(f"cardan.{module}")
    for name in path:
        found = getattr(found, name)
    assert callable(found) or isinstance(found, property)

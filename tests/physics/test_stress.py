"""The worst samples that the stress tools found, with the exact bits of their inputs.

``cardan-stress --worst`` writes those of the core (rust/stress), here against mpmath: per output
and tier the sample among 10**8, random and adversarial, at which the result was farthest off.
``stress.py --worst`` writes those of what Python computes on top of it.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from cardan import OUTPUTS, Driveline, Load
from oracle import Exact, ExactJoint, ExactTurn, MpNumber, limits, mp, read
from stress import LIMITS as PYTHON_LIMITS
from stress import SURFACES, stress

CASES = read("worst_cases.json")["cases"]
PYTHON_CASES = read("worst_python.json")["cases"]
LIMITS = {"tolerance=0": limits("tolerance_0"), "default": limits("worst")}


def exact(name: str, joint: ExactJoint, at: ExactTurn, torque: MpNumber) -> list[MpNumber]:
    """Return the components of an output for a torque or, with a flywheel, an inertia."""
    _, y, z = joint.moment(at)
    in_plane = joint.sine * at.cosine**2
    driven = [-in_plane * joint.sine, in_plane * joint.cosine, -z]
    tilts = mp.atan2(joint.sine * at.sine, joint.cosine), mp.asin(joint.sine * at.cosine)
    along = mp.cos(tilts[1])
    match name:
        case "angle":
            return [at.angle + joint.angle_error(at)]
        case "angle_error" | "speed_ratio" | "acceleration_ratio" | "jerk_ratio":
            return [getattr(joint, name)(at)]
        case "torque of the driven shaft":
            return [torque / joint.speed_ratio(at)]
        case "torque of the driving shaft":
            return [torque * joint.speed_ratio(at)]
        case "torque of a flywheel":
            return [torque * joint.acceleration_ratio(at)]
        case "moment":
            return [torque, torque * y, torque * z]
        case "support of the driving shaft":
            return [mp.mpf(0), torque * y, torque * z]
        case "support of the driven shaft":
            return [torque * x for x in driven]
        case "bending_driving":
            return [abs(torque) * mp.hypot(y, z)]
        case "bending_driven":
            return [abs(torque) * mp.sqrt(sum(x * x for x in driven))]
        case "pin_moment":
            return [abs(torque) / mp.cos(tilts[0])]
        case "tilt_driving":
            return [tilts[0]]
        case "tilt_driven":
            return [tilts[1]]
        case "swing_driving":
            return [mp.cos(tilts[0]) * mp.tan(tilts[1])]
        case "swing_driven":
            return [-mp.sin(tilts[0])]
        case "driving_pin":
            return [mp.mpf(0), at.cosine, at.sine]
        case "driven_pin":
            inside = -at.sine / along
            return [-joint.sine * inside, joint.cosine * inside, joint.cosine * at.cosine / along]
    raise AssertionError(name)


ENDS = {
    "torque of the driving shaft": ("torque", 0),
    "torque of the driven shaft": ("torque", 1),
    "torque of a flywheel": ("torque", 1),
    "support of the driving shaft": ("support_moment", 0),
    "support of the driven shaft": ("support_moment", 1),
}


def test_every_output_has_limits_and_kept_samples() -> None:
    for tier, rows in LIMITS.items():
        outputs = {ENDS.get(name, (name, 1))[0] for name in rows}
        # Forces belong to drivelines with lengths and bearings: test_forces.py has their limits.
        assert outputs == {name for name in OUTPUTS if OUTPUTS[name].unit != "N"}, tier
        assert sorted(case["output"] for case in CASES if case["tier"] == tier) == sorted(rows)


@pytest.mark.parametrize("case", CASES, ids=lambda case: f"{case['tier']} {case['output']}")
def test_the_worst_samples_keep_the_limits(case: dict[str, Any]) -> None:
    bend, angle, torque = (float.fromhex(case[key]) for key in ("bend", "angle", "torque"))
    name = case["output"]
    output, shaft = ENDS.get(name, (name, 1))
    if name == "torque of a flywheel":
        # An inertia is not negative; the error does not depend on the sign.
        torque = abs(torque)
        load = Load(speed=1.0, inertias=[0.0, torque])
    elif name == "torque of the driving shaft":
        load = Load(output_torque=torque)
    else:
        load = Load(drive_torque=torque)
    tier = case["tier"]
    limit = LIMITS[tier][name]
    joint, at = ExactJoint.bent(bend), ExactTurn.by(angle)
    want = Exact.of(exact(name, joint, at, mp.mpf(torque)))
    term = Exact.of([joint.jerk_term(at)]) if name == "jerk_ratio" else want
    unit = term.ulp[abs(term.high).argmax()]
    # Alone and together with what shares its loop.
    for names in (output, ("angle", "speed_ratio", "acceleration_ratio", output)):
        outputs = tuple(dict.fromkeys([names] if isinstance(names, str) else names))
        got = Driveline.from_bends([bend]).evaluate(
            [angle],
            outputs,
            shafts=shaft,
            joints=0,
            load=load,
            tolerance=0 if tier == "tolerance=0" else None,
        )[output]
        off = want.distance(got.reshape(-1)).max() / unit
        assert off <= limit, f"{off:.3f} ulp"


def test_what_python_computes_keeps_its_limits() -> None:
    found = stress(rows=20, rounds=3, seed=7)
    assert found.keys() == PYTHON_LIMITS.keys()
    for name, own in found.items():
        assert own.results > 0, name
        assert own.worst <= PYTHON_LIMITS[name], (name, own.worst)


def test_every_surface_of_python_has_kept_cases() -> None:
    assert {case["surface"] for case in PYTHON_CASES} == SURFACES.keys() == PYTHON_LIMITS.keys()


@pytest.mark.parametrize("case", PYTHON_CASES, ids=lambda case: case["surface"])
def test_the_worst_cases_of_python_keep_their_limits(case: dict[str, Any]) -> None:
    name = case["surface"]
    arrays = {key: np.array(x) for key, x in case.items() if key not in ("surface", "off")}
    off, results = SURFACES[name].judge(arrays)
    assert results > 0
    assert np.max(off) <= PYTHON_LIMITS[name]

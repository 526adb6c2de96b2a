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
from check_oracle import digits, joint
from oracle import Exact, MpNumber, limits, mp, read
from stress import LIMITS as PYTHON_LIMITS
from stress import SURFACES, stress

CASES = read("worst_cases.json")["cases"]
PYTHON_CASES = read("worst_python.json")["cases"]
LIMITS = {"tolerance=0": limits("tolerance_0"), "default": limits("worst")}


def exact(name: str, exact: dict[str, MpNumber], torque: float) -> list[MpNumber]:
    """Return the components of an output for a torque or, with a flywheel, an inertia."""
    output = OUTPUTS[ENDS.get(name, (name, 1))[0]]
    magnitude = output.needs_load and not output.vector and output.per == "joint"
    factor = (abs(torque) if magnitude else torque) if output.needs_load else 1.0
    names = [f"{name} {axis}" for axis in output.axes] or [name]
    return [mp.mpf(exact[own]) * factor for own in names]


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
    with mp.workdps(digits(bend, angle)):
        found = joint(mp.mpf(bend), mp.mpf(angle))
    want = Exact.of(exact(name, found, torque))
    term = Exact.of([mp.mpf(found["jerk_ratio's part"])]) if name == "jerk_ratio" else want
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

"""The cross of a joint: the moment of its pins, their rates and their directions."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from cardan import OUTPUTS, Driveline, Load, reference

LINE = Driveline.from_bends([0.3, 0.0, 1.2], [0.4, -0.7], [0.3, 1.1])
LOAD = Load(output_torque=-2.0)
ANGLES = np.linspace(-4.0, 9.0, 37)
IDEAL = tuple(name for name, output in OUTPUTS.items() if output.ideal)


@pytest.mark.parametrize(
    ("options", "close"), [({}, 1e-14), ({"tolerance": 0}, 1e-14), ({"dtype": np.float32}, 2e-6)]
)
def test_the_cross_of_the_vector_picture(options: dict[str, Any], close: float) -> None:
    found = LINE.evaluate(ANGLES, IDEAL, load=LOAD, **options)
    shafts = reference.from_bends(*(x.tolist() for x in (LINE.bends, LINE.twists, LINE.phases)))
    for i, angle in enumerate(ANGLES):
        crosses = reference.crosses(shafts, angle)
        loads = reference.loads(shafts, angle, output_torque=-2.0)
        for name in IDEAL:
            of_loads = OUTPUTS[name].needs_load
            wanted: Any = (
                getattr(loads, name) if of_loads else [getattr(cross, name) for cross in crosses]
            )
            largest = np.max(np.abs(found[name]))
            np.testing.assert_allclose(
                found[name][:, i], wanted, rtol=0.0, atol=close * largest, err_msg=name
            )


def test_swings_are_the_slopes_of_the_tilts() -> None:
    slopes = LINE.plan(("tilt_driving", "tilt_driven")).derivatives(ANGLES, by="angle")
    found = LINE.evaluate(ANGLES, ("swing_driving", "swing_driven"))
    for side in ("driving", "driven"):
        swing = found[f"swing_{side}"]
        np.testing.assert_allclose(
            slopes[f"tilt_{side}"]["angle"], swing, rtol=0.0, atol=1e-14 * np.max(np.abs(swing))
        )


def test_a_cross_in_numbers() -> None:
    bend = math.radians(40.0)
    line = Driveline.from_bends([bend])
    at = line.evaluate([0.0, math.pi / 2], IDEAL, joints=0, load=Load(drive_torque=-3.0))
    # The driving pin in the bend plane, then across it.
    assert at.pin_moment == pytest.approx([3.0, 3.0 / math.cos(bend)], rel=1e-15)
    assert at.swing_driving == pytest.approx([math.tan(bend), 0.0], rel=1e-15, abs=1e-15)
    assert at.swing_driven == pytest.approx([0.0, -math.sin(bend)], rel=1e-15, abs=1e-15)
    assert at.driving_pin[:, 1:] == pytest.approx(np.eye(2), abs=1e-15)
    across = [math.sin(bend), -math.cos(bend), 0.0]
    assert at.driven_pin == pytest.approx(np.array([[0.0, 0.0, 1.0], across]), abs=1e-15)
    peak = line.evaluate(ANGLES, "driven_pin", joints=0, reduce="peak").driven_pin
    assert peak == pytest.approx(1.0, abs=1e-15)


@pytest.mark.parametrize("name", IDEAL)
def test_joints_as_built_have_none(name: str) -> None:
    with pytest.raises(ValueError, match=f"{name}.*only ideal joints do"):
        LINE.with_deviations(cross=0.01).evaluate(ANGLES, name, load=LOAD)
    plan = LINE.plan(name, load=LOAD)
    with pytest.raises(ValueError, match=f"{name}.*no derivatives by deviations"):
        plan.derivatives(ANGLES, by="deviations")


@pytest.mark.parametrize("name", ["driving_pin", "driven_pin"])
def test_pins_have_axes_at_rest(name: str) -> None:
    with pytest.raises(ValueError, match=f"{name} is known in 'space' only"):
        LINE.evaluate(ANGLES, name, axes="shaft")


def test_what_is_computed_is_told() -> None:
    text = LINE.plan(IDEAL, joints=2, load=LOAD).explain(ANGLES)
    for step in (
        "shaft 2: speed ratio",
        "joint 2: rates of the cross from the speed ratio",
        "joint 2: pins in space",
        "joint 2: pin moment from the torsion",
    ):
        assert step in text

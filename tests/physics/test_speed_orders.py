"""Orders of speeds of a torsional system: their phase against the balance of a flywheel."""

from __future__ import annotations

import numpy as np

import cardan


def test_a_flywheel_is_accelerated_by_the_torque_of_its_shaft() -> None:
    line = cardan.Driveline.from_bends([20.0], degrees=True)
    inertia, speed = 0.05, 150.0
    system = cardan.TorsionalSystem(
        line,
        inertias=[[0.0, 0.0], [0.0, inertia]],
        stiffnesses=[np.inf, 8000.0],
        dampings=[0.0, 2.0],
    )
    found = system.steady(speed)
    assert found.found
    rates = 1j * found.orders * speed
    wanted = np.max(np.abs(found.torque_orders[0]))
    residual = inertia * rates * found.speed_orders[-1, 1] - found.torque_orders[0]
    assert np.max(np.abs(residual)) < 1e-8 * wanted

"""Time lateral systems, and compare them with their twin of beam elements.

``python benches/lateral.py [--quick]`` prints a table: 10 000 speeds of the two-piece shaft of a
truck with three orders, on one thread and on two, six natural frequencies, the same work by
``cardan.reference.lateral``, and how far both are apart. All figures are from one run, in which the
calls take turns.
"""

from __future__ import annotations

import argparse
from functools import partial

import numpy as np

import cardan
from cardan import reference
from cardan.reference import lateral as twin
from shortest import digits, shortest, table

POINTS = [(0, 0, 0), (0.3, -0.016, 0), (1.547, -0.103, 0), (3.275, -0.377, 0), (3.574, -0.398, 0)]
TORQUE, ORDERS = {"output_torque": 1500.0}, (1, 2, 4)
LOSS, STIFFNESS, PLACE, SHEAR = 0.12, 3e5, 1.13, 0.53


def truck() -> cardan.LateralSystem:
    """Two Timoshenko tubes of 90 x 3 mm on a centre bearing of rubber, with yokes."""
    tube = cardan.tube(
        0.09, 0.003, length=1.0, rotary=True, shear_coefficient=SHEAR, loss_factor=0.01
    )
    return cardan.LateralSystem(
        cardan.Driveline.from_points(POINTS),
        shafts=[None, tube, tube, None],
        bearings=[cardan.ElasticBearing(1, PLACE, STIFFNESS, loss_factor=LOSS)],
        masses=[cardan.PointMass(1, 1.2, 4.0, 0.01), cardan.PointMass(2, 0.05, 3.0, 0.01)],
        unbalance=[cardan.Unbalance(1, 0.6, 4.6e-4, (0, 0, 1))],
    )


def elements() -> twin.System:
    """The same of elements of at most 0.2 m."""
    tube = twin.Tube(0.09, 0.003, SHEAR, loss_factor=0.01)
    return twin.System(
        reference.from_points(POINTS),
        truck().lengths.tolist(),
        [None, tube, tube, None],
        [twin.ElasticBearing(1, PLACE, (STIFFNESS, STIFFNESS), None, LOSS)],
        [twin.PointMass(1, 1.2, 4.0, 0.01), twin.PointMass(2, 0.05, 3.0, 0.01)],
        [twin.Unbalance(1, 0.6, 4.6e-4, (0, 0, 1))],
    )


def apart(speeds: np.ndarray) -> float:
    """The largest difference of the forces of the bearing, by the largest of each order."""
    own = truck().response(speeds, cardan.Load(**TORQUE), ORDERS).bearing_force
    other = elements().response(speeds, TORQUE, ORDERS).bearing_force
    sizes = np.max(np.abs(other), axis=(0, 1, 3))
    errors = np.max(np.abs(own - other), axis=(0, 1, 3))
    return float(np.max(errors / sizes))


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--quick", action="store_true", help="a hundredth of the work")
    quick = parser.parse_args().quick
    count, duration = (100, 0.05) if quick else (10_000, 3.0)
    speeds, few = (np.linspace(20.0, 400.0, number) for number in (count, 10))
    system, slow, load = truck(), elements(), cardan.Load(**TORQUE)
    calls = [
        *(partial(system.response, speeds, load, ORDERS, workers=workers) for workers in (1, 2)),
        system.natural_frequencies,
        partial(slow.response, few, TORQUE, ORDERS),
        slow.natural_frequencies,
    ]
    one, two, natural, elements_taken, elements_natural = shortest(calls, duration)
    rows = [
        (f"{count} speeds with three orders, one thread", f"{digits(one)} s"),
        (f"{count} speeds with three orders, two threads", f"{digits(two)} s"),
        ("six natural frequencies", f"{digits(1e3 * natural)} ms"),
        ("time of the twin per speed", f"{digits(elements_taken / len(few) / one * count)} times"),
        ("time of the twin for frequencies", f"{digits(elements_natural / natural)} times"),
        ("largest difference of both", f"{apart(few):.1e}"),
    ]
    print("\n".join(table(("work", "taken"), rows)))


if __name__ == "__main__":
    main()

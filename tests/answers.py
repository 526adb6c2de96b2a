"""Answers over a turn, recorded to their last digits: losses, lives, free drives and orders.

``python tests/answers.py`` writes what the package gives now to ``data/answers.json``. Write it
anew only with a reason: the numbers are those that two different ways of computing them agree on.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cardan import Driveline, Load

DATA = Path(__file__).parent / "data" / "answers.json"

# The steepest bend of a driveline in degrees.
MODERATE, STEEP = 45.0, 85.0


def drivelines(joints: int, count: int, steepest: float) -> Driveline:
    """Random drivelines, the same in every run."""
    random = np.random.default_rng(joints)
    between = (count, joints - 1)
    return Driveline.from_bends(
        random.uniform(0.0, steepest, (count, joints)),
        random.uniform(-180.0, 180.0, between),
        random.uniform(-90.0, 90.0, between),
        degrees=True,
    )


def loads(joints: int) -> Iterator[tuple[str, Load]]:
    """Loads; inertias make the torque of steep drivelines reverse."""
    inertias = np.linspace(0.001, 0.004, joints + 1)
    yield "driven", Load(drive_torque=120.0, speed=50.0)
    yield "braked", Load(output_torque=-80.0, speed=90.0)
    yield "inertias", Load(output_torque=[[60.0], [90.0]], speed=20.0, inertias=inertias)


def answers() -> Iterator[tuple[str, NDArray[Any]]]:
    """Every answer with its name."""
    for joints in (1, 2, 3, 5):
        for steepest in (MODERATE, STEEP):
            line = drivelines(joints, 4, steepest)
            size = f"{joints} joints up to {steepest:g}°"
            for load_name, load in loads(joints):
                where = f"{size}, {load_name}"
                lost = line.losses(
                    load,
                    friction=0.02,
                    pin_radius=0.011,
                    arm=0.04,
                    seal_torque=np.arange(joints) + 0.5,
                )
                yield f"{where}, losses", lost.fraction
                life = line.life(load, rating=300.0 + 50.0 * np.arange(joints))
                yield f"{where}, hours", life.hours
                yield f"{where}, catalogue", life.catalogue
            duty = Load(output_torque=[50.0, 90.0, 20.0], speed=[10.0, 60.0, 150.0])
            whole = line[:, None].life(duty, rating=300.0, shares=[0.2, 0.5, 0.3])
            yield f"{size}, a duty cycle", whole.hours
            free = line.free_running(np.linspace(0.2, 0.05, joints + 1))
            yield f"{size}, free drive", np.array([free.min_speed_ratio, free.max_speed_ratio])
            yield f"{size}, least inertia", np.asarray(free.drive_inertia_for(1e-3))


def recorded() -> dict[str, Any]:
    """The answers of the file, by name."""
    found: dict[str, Any] = json.loads(DATA.read_text())
    return found


if __name__ == "__main__":
    DATA.write_text(json.dumps({name: each.tolist() for name, each in answers()}, indent=0) + "\n")

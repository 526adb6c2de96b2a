"""The list of evaluations that a page of the report checks itself by, with the installed core.

``python tests/trust.py`` prints the digest of its results, which is the one published in
``python/cardan/web/page/trust.js``. That module describes the list.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator

import numpy as np

import cardan
from cardan.arrays import FloatArray

OUTPUTS = (
    "angle",
    "angle_error",
    "speed_ratio",
    "acceleration_ratio",
    "torque",
    "moment",
    "joint_force",
    "bearing_force",
)


def numbers() -> Iterator[float]:
    """Numbers in (0, 1), each exact."""
    x = 1
    while True:
        x = 48271 * x % (2**31 - 1)
        yield x / 2**31


def drivelines() -> Iterator[tuple[cardan.Driveline, cardan.Load, list[float]]]:
    """Every driveline of the list with its load and its drive angles."""
    given = numbers()
    for joints in range(1, 6):
        inner = range(1, joints - 1)
        shafts = [0, 0, 1] if joints == 1 else [0, 0, *inner, joints, joints]
        for i in range(40):
            points = [
                [k + next(given) / 4, next(given) / 2, next(given) / 2] for k in range(joints + 2)
            ]
            phases = [4 * next(given) - 2 for _ in range(joints - 1)]
            firsts = [0.5 if shaft in shafts[:k] else 0.25 for k, shaft in enumerate(shafts)]
            positions = [first + next(given) / 8 for first in firsts]
            torque, speed, acceleration = 512 * next(given), 128 * next(given), 64 * next(given)
            load = cardan.Load(
                **{"drive_torque" if i % 2 else "output_torque": torque},
                speed=speed,
                acceleration=acceleration,
                inertias=[next(given) / 4 for _ in range(joints + 1)],
            )
            line = cardan.Driveline.from_points(points, phases=phases)
            line = line.with_bearings(list(zip(shafts, positions, strict=True)))
            yield line, load, [8 * next(given) for _ in range(50)]


def results() -> Iterator[FloatArray]:
    """The results of each driveline, in the order of the list."""
    for line, load, angles in drivelines():
        found = line.evaluate(angles, OUTPUTS, shafts=range(line.n_joints + 1), load=load)
        # Components of vectors come before angles.
        rows = [np.moveaxis(found[name], 1, -1).ravel() for name in OUTPUTS]
        yield np.concatenate(rows)


def digest() -> str:
    """Return the digest of all results, that of each driveline together with the one before."""
    found = b""
    for values in results():
        own = np.where(np.isnan(values), np.nan, values).astype("<f8")
        found = hashlib.sha256(found + own.tobytes()).digest()
    return found.hex()


if __name__ == "__main__":
    print(digest())

"""Plans that a driveline remembers between calls of ``evaluate``."""

from __future__ import annotations

import copy
import gc
import pickle
import weakref
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
import pytest

from cardan import Driveline, Load, Sweep

ANGLE = np.linspace(0.0, 6.0, 8)
LOAD = Load(drive_torque=100.0)
BENDS, TWISTS, PHASES = [0.3, 0.5, 0.2], [0.4, 0.1], [0.2, 0.7]

REQUESTS: list[dict[str, Any]] = [
    {},
    {"outputs": "angle"},
    {"outputs": ["angle"], "shafts": 1},
    {"outputs": ["angle"], "shafts": [1]},
    {"outputs": iter(["speed_ratio"]), "shafts": slice(1, 3)},
    {"outputs": ["bending_driven"], "load": LOAD, "joints": 1},
    {"outputs": ["bending_driven"], "load": LOAD, "joints": [1]},
    {"outputs": ["bending_driven"], "load": Load(drive_torque=7.0), "joints": 1},
    {"outputs": ["moment"], "load": LOAD, "axes": "shaft"},
    {"outputs": ["moment"], "load": LOAD},
    {"reduce": "max"},
    {"reduce": "rms"},
    {"reduce": ["rms", "max"]},
    {"dtype": np.float32},
    {"tolerance": 0},
    {"tolerance": 1e-6},
    {"angle_of": "driven"},
    {"workers": 1},
    {"degrees": True},
]


def line() -> Driveline:
    return Driveline.from_bends(BENDS, TWISTS, PHASES)


def test_results_are_those_of_a_driveline_that_remembers_nothing() -> None:
    known = line()
    for _ in range(3):
        for request in REQUESTS:
            if not isinstance(request.get("outputs"), (list, str, type(None))):
                request = {**request, "outputs": ["speed_ratio"]}
            assert known.evaluate(ANGLE, **request) == line().evaluate(ANGLE, **request)


def test_outputs_may_come_from_an_iterator() -> None:
    known = line()
    for _ in range(2):
        assert list(known.evaluate(ANGLE, iter(["speed_ratio"]))) == ["speed_ratio"]


def test_equal_arguments_of_another_type_stay_errors() -> None:
    known = line()
    given: dict[str, Any] = {"shafts": 1, "joints": 1, "workers": 1}
    for _ in range(2):
        known.evaluate(ANGLE, **given)
    for name in given:
        with pytest.raises(TypeError, match=name):
            known.evaluate(ANGLE, **{**given, name: 1.0})


@pytest.mark.parametrize("torque", [100.0, [100.0] * 8])
@pytest.mark.parametrize("inertias", [None, [1.0, 1.0, 1.0, 1.0]])
def test_a_load_that_is_changed_in_place_counts(torque: Any, inertias: Any) -> None:  # noqa: ANN401
    known, load = line(), Load(drive_torque=torque, speed=10.0, inertias=inertias)
    for array in (load.torque, load.inertias):
        if array is not None:
            for _ in range(2):
                before = known.evaluate(ANGLE, "torque", load=load)
            array[...] = 5.0
            after = known.evaluate(ANGLE, "torque", load=load)
            assert not np.array_equal(before.torque, after.torque)
            assert after == line().evaluate(ANGLE, "torque", load=load)


class Watched(Driveline):
    """A driveline that weak references can follow."""


def test_drivelines_and_long_loads_are_freed_without_the_collector() -> None:
    known, load = Watched.from_bends([0.3]), Load(drive_torque=[1.0] * 8)
    gc.disable()
    try:
        for _ in range(2):
            known.evaluate(ANGLE)
            known.evaluate(ANGLE, ["moment"], load=load)
        assert len(known._plans) == 1
        assert all(known._plans.values())
        followed = weakref.ref(known), weakref.ref(load)
        del known, load
        assert [reference() for reference in followed] == [None, None]
    finally:
        gc.enable()


def test_few_plans_are_remembered() -> None:
    known = line()
    for tolerance in np.repeat(np.geomspace(1e-9, 1e-3, 100), 2):
        known.evaluate(ANGLE, tolerance=tolerance)
    assert 1 <= len(known._plans) <= 8
    many = Driveline.from_bends(np.full((2, 1), 0.3))
    for _ in range(2):
        many.evaluate(ANGLE[:, None], "angle")
    assert not many._plans


def test_copies_begin_without_plans() -> None:
    known = line()
    for _ in range(2):
        known.evaluate(ANGLE)
    for other in (pickle.loads(pickle.dumps(known)), known.with_phases(0.0), known.reversed()):
        assert not other._plans
    assert copy.copy(known) is known


def test_threads_may_share_a_driveline() -> None:
    known = line()
    sweeps = [Sweep(0.0, stop, 50) for stop in (1.0, 2.0, 3.0)]
    requests: list[dict[str, Any]] = [
        {"outputs": name} for name in ("angle", "speed_ratio", "acceleration_ratio")
    ] * 40

    def run(i: int) -> bool:
        request, sweep = requests[i], sweeps[i % 3]
        return known.evaluate(sweep, **request) == line().evaluate(sweep, **request)

    with ThreadPoolExecutor(4) as pool:
        assert all(pool.map(run, range(len(requests))))

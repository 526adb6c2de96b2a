"""Moments and forces under dynamic torque: Newton's law of every shaft, pins, and rigid shafts."""

from __future__ import annotations

import pickle
from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray

import cardan
from equilibrium import forces

INF = float("inf")
POINTS = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.3, 0.1], [3.0, 0.2, 0.5], [4.0, 0.0, 0.5]]
BEARINGS = [(1, 0.4), (1, 0.8), (3, 0.2), (3, 0.5)]
LINE = cardan.Driveline.from_points(POINTS, phases=[0.3, 0.4]).with_bearings(BEARINGS)
INERTIAS = np.array([[0.01, 0.02], [0.03, 0.02], [0.01, 0.04], [0.02, 0.1]])
SAMPLES = 64
ALL = [0, 1, 2, 3]
STIFFNESSES = [
    [INF, 3e4, 2e4, INF],
    [5e4, INF, 2e4, 3e4],
    [1e4, 2e4, 3e4, 4e4],
    [INF, INF, INF, 1e4],
]


def system_of(stiffnesses: list[float]) -> cardan.TorsionalSystem:
    return cardan.TorsionalSystem(
        LINE,
        inertias=INERTIAS,
        drive="held",
        stiffnesses=stiffnesses,
        dampings=2.0,
        load_torque=200.0,
        load_damping=0.5,
    )


def differentiated(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """The derivative by the drive angle of samples over half a turn, by their Fourier series."""
    orders = 2.0 * np.fft.rfftfreq(SAMPLES, 1.0 / SAMPLES)
    orders[-1] = 0.0
    return np.fft.irfft(1j * orders * np.fft.rfft(values), SAMPLES)


@pytest.mark.parametrize("speed", [60.0, 180.0])
@pytest.mark.parametrize("stiffnesses", STIFFNESSES, ids=str)
def test_every_shaft_obeys_newton(stiffnesses: list[float], speed: float) -> None:
    system = system_of(stiffnesses)
    orbit = system.orbit(speed, SAMPLES)
    found = system.steady(speed).evaluate(SAMPLES, ["moment", "torque"], shafts=ALL)
    scale = np.abs(found.torque).max()
    acceleration = speed * differentiated(orbit.speed)
    error = np.abs(orbit.acceleration - acceleration).max()
    assert error < 1e-7 * np.abs(acceleration).max()
    inertial = (INERTIAS[..., np.newaxis] * acceleration).sum(axis=1)
    load = 200.0 + 0.5 * orbit.speed[-1, 1]
    axes = LINE.directions
    for shaft in ALL:
        entering = found.moment[shaft - 1] @ axes[shaft] if shaft else orbit.drive_torque
        leaving = found.moment[shaft] @ axes[shaft] if shaft < 3 else load
        assert np.abs(found.torque[shaft] - entering).max() < 1e-12 * scale
        assert np.abs(entering - leaving - inertial[shaft]).max() < 1e-7 * scale
    for spring, shaft in zip(orbit.torque, orbit.compliant, strict=True):
        needed = spring + INERTIAS[shaft, 0] * acceleration[shaft, 0]
        assert np.abs(found.torque[shaft] - needed).max() < 1e-7 * scale


@pytest.mark.parametrize("stiffnesses", STIFFNESSES, ids=str)
def test_moments_are_normal_to_the_pins(stiffnesses: list[float]) -> None:
    system = system_of(stiffnesses)
    orbit = system.orbit(180.0, SAMPLES)
    moment = system.steady(180.0).evaluate(SAMPLES, "moment").moment
    axes = LINE.directions
    # A pin is normal to its shaft and to the moment; both pins of a cross are normal.
    pins = [
        [np.cross(axes[joint], moment[joint]), np.cross(axes[joint + 1], moment[joint])]
        for joint in range(3)
    ]
    for driving, driven in pins:
        size = np.linalg.norm(driving, axis=-1) * np.linalg.norm(driven, axis=-1)
        assert np.abs(np.sum(driving * driven, axis=-1)).max() < 1e-12 * size.max()

    def angle(shaft: int, pin: NDArray[np.float64]) -> NDArray[np.float64]:
        """About the shaft from its bend-plane normal, of joint 0 for shaft 0, up to half turns."""
        normal = LINE.normals[min(shaft, 2)]
        side = np.cross(axes[shaft], normal)
        return np.asarray(np.arctan2(pin @ side, pin @ normal))

    # The yokes of a shaft enclose its phase and its twist.
    for shaft in (1, 2):
        twist = orbit.angle_error[shaft, 1] - orbit.angle_error[shaft, 0]
        assert np.abs(twist).max() > (0.01 if shaft in system.compliant else -1.0)
        between = angle(shaft, pins[shaft][0]) - angle(shaft, pins[shaft - 1][1])
        # A moment along the shaft shows no pin: the error counts by the length of the products.
        size = np.linalg.norm(pins[shaft][0], axis=-1) * np.linalg.norm(pins[shaft - 1][1], axis=-1)
        rest = between - LINE.phases[shaft - 1] - twist
        assert np.abs(size * np.sin(rest)).max() < 1e-9 * size.max()
    # At drive angle 0 the driving pin of joint 0 lies in the plane of shafts 0 and 1.
    turn = angle(0, pins[0][0]) - orbit.drive_angle - orbit.angle_error[0, 1] - np.pi / 2
    size = np.linalg.norm(pins[0][0], axis=-1)
    assert np.abs(size * np.sin(turn)).max() < 1e-9 * size.max()


def test_forces_are_those_of_the_equilibrium() -> None:
    system = system_of(STIFFNESSES[0])
    found = system.steady(180.0).evaluate(8, ["moment", "joint_force", "bearing_force"])
    lengths = np.array([np.linalg.norm(np.subtract(b, a)) for a, b in pairwise(POINTS)])
    # Shaft 2 floats between joints 1 and 2, all others have two bearings or are a machine's.
    for sample in range(8):
        bearings, joints = forces(
            LINE.directions, lengths, found.moment[:, sample], BEARINGS, [None, 2, 2]
        )
        scale = np.abs(bearings).max()
        assert found.bearing_force[:, sample] == pytest.approx(bearings, abs=1e-11 * scale)
        assert found.joint_force[:, sample] == pytest.approx(joints, abs=1e-11 * scale)


def test_stiff_shafts_carry_the_loads_of_a_rigid_driveline() -> None:
    names = [name for name, output in cardan.OUTPUTS.items() if output.needs_load]
    names += ["tilt_driving", "tilt_driven", "driving_pin", "driven_pin"]
    speed, torque = 100.0, 200.0
    system = cardan.TorsionalSystem(
        LINE,
        inertias=INERTIAS,
        drive="held",
        stiffnesses=[INF, 1e10, INF, 1e10],
        dampings=1e3,
        load_torque=torque,
    )
    found = system.steady(speed).evaluate(SAMPLES, names, shafts=ALL)
    load = cardan.Load(output_torque=torque, speed=speed, inertias=INERTIAS.sum(axis=1))
    angle = np.arange(SAMPLES) * np.pi / SAMPLES
    rigid = LINE.evaluate(angle, names, shafts=ALL, load=load)
    assert len(names) == 12
    for name in names:
        assert np.abs(found[name] - rigid[name]).max() < 1e-5 * np.abs(rigid[name]).max()


def test_a_batch_is_its_members() -> None:
    lines = cardan.Driveline.from_bends([[0.1, 0.2], [0.3, 0.05]])
    system = cardan.TorsionalSystem(
        lines,
        inertias=[[0.0, 0.0], [0.01, 0.02], [0.0, 0.1]],
        stiffnesses=np.array([[INF, 9000.0, 7000.0], [INF, 5000.0, 8000.0]])[:, np.newaxis],
        load_torque=[50.0, 60.0],
        dampings=1.0,
    )
    speeds = np.array([40.0, 130.0, np.nan])[:, np.newaxis, np.newaxis]
    found = system.steady(speeds).evaluate(5, ["moment", "torque"], joints=1)
    assert found.moment.shape == (3, 2, 2, 5, 3)
    assert found.torque.shape == (3, 2, 2, 5)
    assert np.isnan(found.moment[2]).all()
    assert np.isfinite(found.moment[:2]).all()
    alone = cardan.TorsionalSystem(
        lines[1],
        inertias=[[0.0, 0.0], [0.01, 0.02], [0.0, 0.1]],
        stiffnesses=[INF, 9000.0, 7000.0],
        load_torque=60.0,
        dampings=1.0,
    )
    one = alone.steady(130.0).evaluate(5, ["moment", "torque"], joints=1)
    assert one.moment == pytest.approx(found.moment[1, 0, 1], rel=1e-13, abs=1e-10)
    assert one.torque == pytest.approx(found.torque[1, 0, 1], rel=1e-13)


def test_results_have_labels_and_pickles() -> None:
    steady = system_of(STIFFNESSES[0]).steady([60.0, 180.0])
    found = steady.evaluate(8, ["torque", "bending_driven"], shafts=[0, 3])
    labelled = pytest.importorskip("xarray") and found.to_xarray()
    assert labelled.torque.shape == (2, 2, 8)
    assert labelled.drive_angle.shape == (8,)
    again = pickle.loads(pickle.dumps(steady)).evaluate(8, ["torque"], shafts=[0, 3])
    assert again.torque.tolist() == found.torque.tolist()
    assert "0x" not in repr(steady)


def test_motions_of_rigid_shafts_are_refused() -> None:
    steady = system_of(STIFFNESSES[0]).steady(60.0)
    with pytest.raises(cardan.ArgumentValueError, match=r"outputs\[1\] is 'angle', a motion of"):
        steady.evaluate(8, ["torque", "angle"])
    with pytest.raises(cardan.ArgumentValueError, match="samples is 0; it must be at least 1"):
        steady.evaluate(0)
    with pytest.raises(IndexError, match="joints is 7"):
        steady.evaluate(8, "moment", joints=7)

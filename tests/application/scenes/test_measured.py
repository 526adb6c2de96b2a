"""Measured motion: angles from speeds, filtered accelerations, torques sample by sample, gaps."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import pytest
from numpy.typing import NDArray

import scripts
from cardan import Driveline, Load
from cardan._core import Integral
from cardan.app.answers.over import check_scene
from cardan.app.answers.schema import answers_schema
from cardan.app.answers.turn.figures import drive_angles
from cardan.app.answers.turn.text import angles_text, signals_text
from cardan.app.files.columns import write_columns
from cardan.app.report.page import page
from cardan.app.scene import Scene, stream
from cardan.app.scene.recording.recorded import derivatives
from cardan.app.scene.recording.signals import Sampling, Timing, Way
from cardan.app.scene.study.curves import columns, write_curves
from example_scenes import ANSWERS
from pages import drawings

RANDOM = np.random.default_rng(20)


TIME = np.cumsum(RANDOM.uniform(0.5e-3, 1.5e-3, 3000))


RPM = np.pi / 30.0


Floats = NDArray[np.float64]


JOINTS = "[driveline]\nbends_deg = [10, 12]\nphases_deg = [20]\n"


ANGLES = "[angles]\nfile = 'run.csv'\ntime_column_s = 't'\nspeed_column_rpm = 'n'\n"


def written(folder: Path, **table: Sequence[float] | Floats) -> Path:
    """A CSV file of columns, every digit of them; NaN as an empty cell."""
    rows = zip(*(np.asarray(column, float).tolist() for column in table.values()), strict=True)
    lines = [
        ",".join(table),
        *(",".join("" if x != x else repr(x) for x in row) for row in rows),
    ]
    path = folder / "run.csv"
    path.write_text("\n".join(lines) + "\n")
    return path


def measured(folder: Path, text: str, **table: Sequence[float] | Floats) -> Scene:
    written(folder, **table)
    return Scene.parse(text, folder=folder)


# The integral


def test_a_ramp_is_integrated_exactly() -> None:
    """The trapezoidal rule has no error where the speed is constant or grows evenly."""
    for slope in (0.0, 7.0):
        got = Integral(2.0).at(TIME, 100.0 + slope * TIME)
        ran, start = TIME - TIME[0], TIME[0]
        exact = 2.0 + 100.0 * ran + slope * (start * ran + ran**2 / 2.0)
        np.testing.assert_allclose(got, exact, rtol=1e-14)


# The filter


@pytest.mark.parametrize("reach", [1, 3, 8])
def test_a_parabola_as_numpy_fits_it(reach: int) -> None:
    values = RANDOM.normal(size=TIME.size)
    known = RANDOM.random(TIME.size) < 0.8
    first, second = derivatives(TIME, np.where(known, values, np.nan), reach)
    for place in (*range(12), *range(2988, 3000), *range(1500, 1540)):
        near = np.arange(max(0, place - reach), min(TIME.size, place + reach + 1))
        near = near[known[near]]
        if not known[place] or near.size < 3:
            assert np.isnan(first[place])
            continue
        curve, slope, _ = np.polyfit(TIME[near] - TIME[place], values[near], 2)
        assert first[place] == pytest.approx(slope, rel=1e-7, abs=1e-6)
        assert second[place] == pytest.approx(2.0 * curve, rel=1e-7, abs=1e-3)


# Scenes


def test_speed_and_torque_of_a_file(tmp_path: Path) -> None:
    """Angle, speed, acceleration and torque of each sample reach the library's call."""
    speed = 600.0 + 50.0 * TIME
    torque = 40.0 + 5.0 * np.sin(TIME)
    text = (
        f"{JOINTS}{ANGLES}torque_column_Nm = 'm'\nstart_deg = 30\n"
        "[load]\ninertias_kgm2 = [0.1, 0.02, 0.5]\n[output]\nquantities = ['torque', 'moment']\n"
    )
    scene = measured(tmp_path, text, t=TIME, n=speed, m=torque)
    ran = TIME - TIME[0]
    angle = np.radians(30.0) + RPM * (600.0 * ran + 50.0 * (TIME[0] * ran + ran**2 / 2.0))
    np.testing.assert_allclose(scene.drive_angle, angle, rtol=1e-14)
    line = Driveline.from_bends([10, 12], 0, 20, degrees=True)
    load = Load(
        drive_torque=torque,
        speed_rpm=speed,
        acceleration=50.0 * RPM,
        inertias=[0.1, 0.02, 0.5],
    )
    want = line.evaluate(angle, ("torque", "moment"), load=load)
    got = scene.run().values
    np.testing.assert_allclose(got.torque, want.torque, rtol=1e-8)
    np.testing.assert_allclose(got.moment, want.moment, rtol=1e-8, atol=1e-6)
    # What a constant speed would leave out is far more than that.
    steady = Load(drive_torque=torque, speed_rpm=speed, inertias=[0.1, 0.02, 0.5])
    assert np.min(np.abs(got.torque - line.evaluate(angle, "torque", load=steady).torque)) > 0.5


def test_speed_in_radians_per_second(tmp_path: Path) -> None:
    speed = 60.0 + 3.0 * np.sin(TIME)
    scene = measured(tmp_path, JOINTS + ANGLES, t=TIME, n=speed / RPM)
    other = Scene.parse(JOINTS + ANGLES.replace("_rpm", "_rad_s"), folder=tmp_path)
    assert other.load_case is not None
    np.testing.assert_array_equal(other.load_case.speed, speed / RPM)
    np.testing.assert_allclose(RPM * other.drive_angle, scene.drive_angle, rtol=1e-13)


@pytest.mark.parametrize("unit", ["deg", "rad"])
@pytest.mark.parametrize("modulo", [False, True])
def test_angles_and_times(tmp_path: Path, unit: str, modulo: bool) -> None:
    """Speed and acceleration follow from angles, also where a counter starts anew at each turn."""
    turn = 360.0 if unit == "deg" else 2.0 * np.pi
    angle = turn * (5.0 * TIME + 0.4 * TIME**2)
    text = (
        f"{JOINTS}[angles]\nfile = 'run.csv'\ntime_column_s = 't'\nangle_column_{unit} = 'a'\n"
        "[load]\ndrive_torque_Nm = 3\ninertias_kgm2 = [0, 1, 0]\n"
    )
    scene = measured(tmp_path, text, t=TIME, a=angle % turn if modulo else angle)
    assert scene.load_case is not None
    np.testing.assert_allclose(scene.load_case.speed, 2 * np.pi * (5.0 + 0.8 * TIME), rtol=1e-9)
    np.testing.assert_allclose(scene.load_case.acceleration, 1.6 * np.pi, rtol=1e-5)
    np.testing.assert_array_equal(
        scene.drive_angle_deg if unit == "deg" else scene.drive_angle,
        angle % turn if modulo else angle,
    )


def test_recorded_angle_and_speed(tmp_path: Path) -> None:
    """The angle is the recorded one, and the acceleration is that of the speed."""
    text = f"{JOINTS}{ANGLES}angle_column_rad = 'a'\n"
    scene = measured(tmp_path, text, t=TIME, n=100.0 + TIME, a=5.0 * TIME)
    assert scene.load_case is not None
    np.testing.assert_array_equal(scene.drive_angle, 5.0 * TIME)
    np.testing.assert_allclose(scene.load_case.acceleration, RPM, rtol=1e-8)


def test_missing_rows(tmp_path: Path) -> None:
    """They keep their place, are NaN, are bridged in the integral, and are counted."""
    speed = 600.0 + 50.0 * TIME
    torque = np.full(TIME.size, 7.0)
    time, gap = TIME.copy(), speed.copy()
    gap[0] = gap[100:140] = np.nan
    time[500] = np.nan
    torque[700] = np.nan
    text = (
        f"{JOINTS}{ANGLES}torque_column_Nm = 'm'\n[load]\ninertias_kgm2 = [0, 1, 0]\n"
        "[output]\nquantities = ['torque']\ncurves = 'c.csv'\nreduce = ['mean']\n"
    )
    scene = measured(tmp_path, text, t=time, n=gap, m=torque)
    missing = np.zeros(TIME.size, bool)
    missing[[0, *range(100, 140), 500, 700]] = True
    assert scene.missing == 43
    np.testing.assert_array_equal(np.isnan(scene.drive_angle), missing)
    result = scene.run()
    for column in columns(result).values():
        np.testing.assert_array_equal(np.isnan(column), missing)
    # A ramp is bridged without an error.
    ran, start = TIME - TIME[1], TIME[1]
    exact = RPM * (600.0 * ran + 50.0 * (start * ran + ran**2 / 2.0))
    np.testing.assert_allclose(scene.drive_angle[~missing], exact[~missing], rtol=1e-13, atol=1e-13)
    known = scene.without_missing()
    assert known.load_case is not None
    assert known.time is not None
    np.testing.assert_allclose(known.load_case.acceleration, 50.0 * RPM, rtol=1e-7)
    np.testing.assert_array_equal(known.time, TIME[~missing])
    assert result.study is not None
    torques = result.values.torque[~missing]
    assert result.study.values["torque_mean"] == pytest.approx(np.mean(torques), rel=1e-12)
    (tmp_path / "run.toml").write_text(text)
    said = scripts.run("run", tmp_path / "run.toml", "--into", tmp_path).output
    assert "43 of 3000 samples are missing in run.csv; their results are NaN." in said


@pytest.mark.parametrize("timed", [False, True])
def test_the_turns_of_a_counter_that_starts_anew(tmp_path: Path, timed: bool) -> None:
    """Its leaps are no way of the drive, in one piece or in many."""
    angle = np.mod(10.0 + 20.0 * np.arange(181.0), 360.0)
    time = "time_column_s = 't'\n" if timed else ""
    text = (
        f"{JOINTS}[angles]\nfile = 'run.csv'\nangle_column_deg = 'a'\n{time}"
        "[output]\ncurves = 'a.parquet'\n"
    )
    scene = measured(tmp_path, text, t=0.001 * np.arange(181.0), a=angle)
    found = drive_angles(scene)
    assert found.turns == pytest.approx(10.0)
    assert found.samples_per_turn == pytest.approx(18.0)
    (tmp_path / "run.toml").write_text(text)
    for rows in (1, 50, 1000):
        streamed = stream(tmp_path / "run.toml", tmp_path, rows=rows)
        assert streamed.turns == pytest.approx(10.0)
    # An angle that goes on, however far from sample to sample, is taken as it is.
    scene = measured(tmp_path, text, t=0.001 * np.arange(181.0), a=350.0 * np.arange(181.0))
    assert drive_angles(scene).turns == pytest.approx(175.0)


PIECES = """\
[driveline]
twists_deg = [180]
phases_deg = [30]
[angles]
file = "run.parquet"
time_column_s = "t"
torque_column_Nm = "m"
{angles}
[load]
inertias_kgm2 = [0.1, 0.2, 0.3]
[output]
quantities = ["angle_error", "torque"]
curves = "out.parquet"
"""


@pytest.mark.parametrize(
    "columns",
    [
        "speed_column_rpm = 'n'",
        "speed_column_rpm = 'n'\nfilter_reach = 50\nstart_deg = 12",
        "angle_column_deg = 'a'",
    ],
)
@pytest.mark.parametrize("rows", [pytest.param(1, marks=pytest.mark.long), 11, 97, 699, 700, 5000])
def test_pieces_give_the_bits_of_the_whole(tmp_path: Path, columns: str, rows: int) -> None:
    pyarrow = pytest.importorskip("pyarrow")
    parquet = pytest.importorskip("pyarrow.parquet")
    random, time = np.random.default_rng(1), TIME[:700]
    table = {
        "t": time.copy(),
        "n": 600.0 + 30.0 * random.normal(size=time.size),
        "a": (3600.0 * time + 2.0 * np.sin(100.0 * time)) % 360.0,
        "m": random.normal(size=time.size),
    }
    for name, column in table.items():
        column[random.integers(0, time.size, 7 if name == "t" else 14)] = np.nan
    # A gap beyond the reach of any filter, and one at each end.
    for part in (slice(0, 3), slice(350, 470), slice(690, None)):
        table["n"][part] = table["a"][part] = np.nan
    parquet.write_table(pyarrow.table(table), tmp_path / "run.parquet", row_group_size=97)
    text = PIECES.format(angles=columns).replace("twists_deg", "bends_deg = [8, 9]\ntwists_deg")
    (tmp_path / "run.toml").write_text(text)
    scene = Scene.load(tmp_path / "run.toml")
    write_curves(scene.run(), tmp_path / "whole.parquet")
    done = stream(tmp_path / "run.toml", tmp_path, rows=rows)
    streamed, whole = (
        parquet.read_table(tmp_path / f"{name}.parquet") for name in ("out", "whole")
    )
    assert streamed.column_names == whole.column_names
    for name in whole.column_names:
        np.testing.assert_array_equal(streamed[name].to_numpy(), whole[name].to_numpy(), name)
    found = drive_angles(scene)
    assert (done.rows, done.missing) == (time.size, scene.missing)
    assert done.ends_deg == (found.first, found.last)
    assert done.turns == pytest.approx(found.turns, rel=1e-12)
    assert done.signals == scene.signals


def test_a_wrong_unit_is_seen(tmp_path: Path) -> None:
    """First and last value, rate and extent of each signal are printed."""
    text = f"{JOINTS}{ANGLES}torque_column_Nm = 'm'\n"
    time = 0.001 * np.arange(2001)
    table: dict[str, Any] = {"t": time, "n": 600.0 + 60.0 * time, "m": 5.0 - time}
    scene = measured(tmp_path, text, **table)
    said = signals_text(drive_angles(scene))
    assert said.splitlines() == [
        "Recording",
        "  time, column 't'          0 to 2 s; 1000 samples per second",
        "  speed, column 'n'         first 600.0, last 720.0 rpm; 600 to 720 rpm",
        "  drive torque, column 'm'  first 5.000, last 3.000 N m; 3 to 5 N m",
        "  acceleration              first 6.283, last 6.283 rad/s²; by parabolas over",
        "                            11 samples, 0.01000 s",
    ]
    (tmp_path / "run.toml").write_text(text)
    done = scripts.run("run", tmp_path / "run.toml")
    assert done.stdout.startswith(f"{said}\n\nDriveline\n")
    assert "22.00 turns" not in done.stdout
    assert "0° to 7920°, 22 turns of 90.91 samples" in done.stdout
    answer = json.loads(scripts.run("run", tmp_path / "run.toml", "--json").stdout)
    ANSWERS.validate(answer)
    signals = answer["drive_angles"]["signals"]
    assert [signal["column"] for signal in signals] == ["t", "n", "m", None]
    assert signals[1] == {
        "signal": "speed",
        "column": "n",
        "unit": "rpm",
        "first": 600.0,
        "last": 720.0,
        "min": 600.0,
        "max": 720.0,
    }
    assert signals[3]["filter_samples"] == 11
    # A filter takes no more samples than there are.
    few = measured(tmp_path, text, **{name: column[:4] for name, column in table.items()})
    assert "over 4 samples, 0.003000 s" in " ".join(signals_text(drive_angles(few)).split())
    # Times in ms look like a machine that turns a thousand times as often between samples.
    scene = measured(tmp_path, text, **{**table, "t": 1e3 * time})
    done = scripts.run("run", tmp_path / "run.toml")
    assert "only 0.09091 samples per turn" in done.stderr
    assert "1.000 samples per second" in done.stdout


def noisy(folder: Path, reach: int, noise_rpm: float, *, of_angle: bool = False) -> Path:
    """A run-up of 220 rpm per second, 2000 samples of it per second, and a scene."""
    time: Floats = np.asarray(0.0005 * np.arange(4000), np.float64)
    noise = noise_rpm * np.random.default_rng(1).normal(size=time.size)
    speed = 1000.0 + 220.0 * time
    angle = 6.0 * (1000.0 * time + 110.0 * time**2) + 0.001 * noise
    written(folder, t=time, n=speed + noise, a=angle)
    angles = ANGLES.replace("speed_column_rpm = 'n'", "angle_column_deg = 'a'")
    path = folder / "run.toml"
    path.write_text(
        f"{JOINTS}{angles if of_angle else ANGLES}filter_reach = {reach}\n"
        "[load]\ndrive_torque_Nm = 300\ninertias_kgm2 = [0, 0.2, 0.1]\n"
        "[output]\nquantities = ['torque']\n"
    )
    return path


def acceleration(path: Path) -> dict[str, Any]:
    answer = json.loads(scripts.run("run", path, "--json").stdout)
    ANSWERS.validate(answer)
    (found,) = [one for one in answer["drive_angles"]["signals"] if one["signal"] == "acceleration"]
    return dict(found)


def test_an_acceleration_that_is_mostly_noise_is_said(tmp_path: Path) -> None:
    """The noise is that of the filtered samples, and the reach proposed ends the warning."""
    path = noisy(tmp_path, 5, 3.0)
    found = acceleration(path)
    # By the sum of squares of the filter: 3 rpm over 0.5 ms and the root of 110.
    assert found["noise"] == pytest.approx(3.0 * RPM / 0.0005 / np.sqrt(110.0), rel=0.05)
    scene = Scene.load(path)
    assert scene.load_case is not None
    inner = np.asarray(scene.load_case.acceleration)[5:-5]
    assert found["noise"] == pytest.approx(np.std(inner), rel=0.05)
    reach = found["quiet_reach"]
    assert 30 < reach < 80
    said = scripts.run("run", path)
    noise = f"{found['noise']:.4g}"
    assert f"cardan: the acceleration is mostly noise, {noise} rad/s² rms" in said.stderr
    assert f"try filter_reach = {reach} in [angles]" in said.stderr
    path = noisy(tmp_path, reach, 3.0)
    found = acceleration(path)
    assert "quiet_reach" not in found
    assert found["noise"] == pytest.approx(0.1 * 220.0 * RPM, rel=0.15)
    assert scripts.run("run", path).stderr == ""


def test_the_noise_of_an_acceleration_from_angles(tmp_path: Path) -> None:
    path = noisy(tmp_path, 5, 3.0, of_angle=True)
    found, scene = acceleration(path), Scene.load(path)
    assert scene.load_case is not None
    inner = np.asarray(scene.load_case.acceleration)[5:-5]
    assert found["noise"] == pytest.approx(np.std(inner), rel=0.05)
    assert "is mostly noise" in scripts.run("run", path).stderr


@pytest.mark.parametrize("noise_rpm", [0.0, 0.001, 0.3])
def test_little_noise_is_not_said(tmp_path: Path, noise_rpm: float) -> None:
    path = noisy(tmp_path, 5, noise_rpm)
    assert scripts.run("run", path).stderr == ""
    assert "quiet_reach" not in acceleration(path)


def test_vibration_is_no_noise(tmp_path: Path) -> None:
    """An engine's order 1.5 of 20 rpm at constant speed, and a digit of rounding."""
    time: Floats = np.asarray(0.001 * np.arange(3000), np.float64)
    speed = 900.0 + 20.0 * np.sin(2.0 * np.pi * 22.5 * time)
    written(tmp_path, t=time, n=np.round(speed, 1))
    path = tmp_path / "run.toml"
    path.write_text(JOINTS + ANGLES)
    assert scripts.run("run", path).stderr == ""
    written(tmp_path, t=time, n=np.full(time.size, 900.0))
    assert scripts.run("run", path).stderr == ""


@pytest.mark.parametrize(
    ("text", "table", "message"),
    [
        (ANGLES, {"t": [0, 1, 1], "n": [1, 2, 3]}, "line 4, column 't' is 1.0 after 1.0; times"),
        (ANGLES, {"t": [0, 2, np.nan, 1], "n": [1] * 4}, "line 5, column 't' is 1.0 after 2.0; t"),
        (
            ANGLES,
            {"t": [0, 1, np.nan, 5, 3, 6], "n": [1] * 6},
            "line 6, column 't' is 3.0 after 5.0; times must increase",
        ),
        (ANGLES, {"t": [0, 1e31], "n": [1, 1]}, "column 't' is 1e+31; it must lie within ±1e+30"),
        (
            ANGLES,
            {"t": [0, np.nan, 2], "n": [np.nan, 1, np.nan]},
            "no row has a number in each of the columns 't', 'n'",
        ),
        (ANGLES, {"t": [0, 1], "n": [1, 1]}, "no row has two others within filter_reach = 5 rows"),
    ],
)
@pytest.mark.parametrize("rows", [None, 1, 4])
def test_what_is_refused_in_a_file(
    tmp_path: Path, text: str, table: dict[str, Any], message: str, rows: int | None
) -> None:
    path = written(tmp_path, **table)
    scene = tmp_path / "run.toml"
    scene.write_text(f"{JOINTS}{text}[output]\ncurves = 'c.parquet'\n")
    with pytest.raises(ValueError, match="run") as caught:
        Scene.load(scene) if rows is None else list(Scene.parts(scene, rows))
    assert str(caught.value).startswith(f"{scene}, line 4: [angles] {path}: ")
    # Too few samples for a parabola are missing.
    assert message in str(caught.value)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            "[angles]\nfile = 'run.csv'\nspeed_column_rpm = 'n'\n",
            "line 6: [angles] speed_column_rpm needs time_column_s",
        ),
        (
            "[angles]\nfile = 'run.csv'\nangle_column_deg = 'n'\nfilter_reach = 3\n",
            "line 7: [angles] filter_reach needs time_column_s",
        ),
        (
            "[angles]\nfile = 'run.csv'\ntime_column_s = 't'\n",
            "line 4: [angles] angle_column_deg is missing; or give angle_column_rad, "
            "speed_column_rpm or speed_column_rad_s",
        ),
        (ANGLES + "speed_column_rad_s = 'n'\n", "speed_column_rpm and speed_column_rad_s are both"),
        (ANGLES + "angle_column_deg = 'n'\nstart_deg = 3\n", "start_deg and angle_column_deg are"),
        (ANGLES + "raster_s = 0.1\n", "run.csv has no channels to resample; only MDF files have"),
        (
            ANGLES.replace("time_column_s", "time_column_ms"),
            "unknown key 'time_column_ms'; the name includes the unit: time_column_s holds sec",
        ),
        (ANGLES + "filter_reach = 0\n", "filter_reach is 0; it must be a whole number from 2 to"),
        (
            ANGLES + "[load]\nspeed_rpm = 3\n",
            "line 9: [load] speed_rpm does not go with [angles], which gives times, from which "
            "speed and acceleration follow",
        ),
        (
            ANGLES + "[study]\nacceleration_rad_s2 = [3, 4]\n",
            "line 9: [study] acceleration_rad_s2 does not go with [angles], which gives times",
        ),
        (
            ANGLES + "torque_column_Nm = 'n'\n[load]\noutput_torque_Nm = 3\n",
            "line 10: [load] output_torque_Nm does not go with [angles], which gives a torque",
        ),
    ],
)
def test_what_is_refused_in_a_scene(tmp_path: Path, text: str, message: str) -> None:
    written(tmp_path, t=TIME, n=TIME)
    with pytest.raises(ValueError, match="scene") as caught:
        Scene.parse(JOINTS + text, folder=tmp_path)
    assert message in str(caught.value)


def test_a_study_over_a_measured_load(tmp_path: Path) -> None:
    """Each driveline of the study carries the recorded torque and motion."""
    speed, torque = 600.0 + 50.0 * TIME, 40.0 + np.sin(TIME)
    torque[5] = np.nan
    text = (
        f"{JOINTS}{ANGLES}torque_column_Nm = 'm'\n[load]\ninertias_kgm2 = [0, 0, 0.5]\n"
        "[study]\nphases_deg = [0, 20]\ninertias_kgm2.2 = [0.5, 1]\n"
        "[output]\nquantities = ['torque']\nreduce = ['peak']\n"
    )
    scene = measured(tmp_path, text, t=TIME, n=speed, m=torque)
    result = scene.run()
    assert result.study is not None
    table = result.study.values["torque_peak"]
    assert table.shape == (2, 2)
    assert table[1, 0] == pytest.approx(np.nanmax(np.abs(result.values.torque)), rel=1e-12)
    known = scene.without_missing()
    assert known.load_case is not None
    load = Load(
        drive_torque=known.load_case.torque,
        speed=known.load_case.speed,
        acceleration=known.load_case.acceleration,
        inertias=[0, 0, 1],
    )
    line = Driveline.from_bends([10, 12], 0, 0, degrees=True)
    torques = line.evaluate(known.drive_angle, "torque", load=load).torque
    assert table[0, 1] == pytest.approx(np.max(np.abs(torques)), rel=1e-12)


def test_check_takes_the_largest_speed(tmp_path: Path) -> None:
    scene = measured(tmp_path, JOINTS + ANGLES, t=TIME, n=-600.0 - TIME)
    assert scene.speed == pytest.approx(-RPM * (600.0 + TIME[-1]))


def test_check_takes_the_speed_of_each_bend(tmp_path: Path) -> None:
    """Where bends were recorded too, the steepest need not meet the largest speed."""
    bend, speed = 8.0 + 4.0 * np.sin(TIME), 600.0 + 300.0 * np.cos(TIME)
    text = f"[driveline]\n{ANGLES}bend_columns_deg = ['b']\n"
    n = speed.copy()
    n[7] = np.nan
    scene = measured(tmp_path, text, t=TIME, n=n, b=bend)
    found = {finding.figure: finding for finding in check_scene(scene).findings}
    b = np.radians(np.delete(bend, 7))
    exact = np.sin(b) * np.tan(b) * (RPM * np.delete(speed, 7)) ** 2
    value = found["torsional_excitation"].value
    assert value is not None
    # The largest acceleration ratio is close to the non-uniformity.
    np.testing.assert_allclose(value, exact, rtol=2e-3)
    (tmp_path / "run.toml").write_text(text)
    answer = json.loads(scripts.run("check", tmp_path / "run.toml", "--json").stdout)
    ANSWERS.validate(answer)
    assert answer["limits"]["torsional_excitation"]["value_rad_s2"] == pytest.approx(np.max(value))


TIMES_TIME = np.arange(1000) * 1e-3


def sampling(*pieces: np.ndarray) -> Sampling:
    timing = Timing()
    for piece in pieces:
        timing.add(piece)
    return timing.sampling()


def with_gaps() -> np.ndarray:
    time = TIMES_TIME.copy()
    time[300:] += 2.0
    time[301:] += 3.5
    time[999:] += 0.01
    return time


# --- rate and gaps ---------------------------------------------------------------------------


def test_gaps_are_counted_and_do_not_change_the_rate() -> None:
    found = sampling(with_gaps())
    assert found.rate == pytest.approx(1000.0)
    assert found.gaps == 3
    assert found.longest == pytest.approx(3.501)
    assert found.longest_after == pytest.approx(2.3)
    even = sampling(TIMES_TIME)
    assert (even.gaps, even.longest) == (0, 0.0)


def test_missing_rows_are_no_gap_and_no_time() -> None:
    time = TIMES_TIME.copy()
    time[400:450] = np.nan
    time[-300:] = np.nan
    found = sampling(time)
    assert found.rate == pytest.approx(1000.0)
    assert found.gaps == 0


def test_rows_missing_beside_a_gap_do_not_change_the_rate() -> None:
    time = TIMES_TIME.copy()
    time[300:] += 2.0
    time[280:300] = np.nan
    found = sampling(time)
    assert found.gaps == 1
    assert found.longest == pytest.approx(2.021)
    assert found.rate == pytest.approx(1000.0)


def test_clocks_of_low_resolution_and_changing_rates_have_no_gaps() -> None:
    assert sampling(np.floor(TIMES_TIME * 700.0) / 1000.0 + np.arange(1000)).gaps == 0
    # Pulses of an encoder while the drive runs up.
    assert sampling(np.sqrt(np.arange(1.0, 1000.0))).gaps == 0


@pytest.mark.parametrize("count", [0, 1, 2, 3])
def test_few_times(count: int) -> None:
    found = sampling(TIMES_TIME[:count])
    assert found.gaps == 0
    assert found.rate == (None if count < 2 else pytest.approx(1000.0))


# --- scenes ----------------------------------------------------------------------------------

TEXT = """
[driveline]
bends_deg = [10]
[angles]
file = "r.csv"
time_column_s = "t"
speed_column_rpm = "n"
[output]
quantities = ["speed_ratio"]
"""


def scene(folder: Path, time: np.ndarray, rpm: np.ndarray) -> Scene:
    write_columns(folder / "r.csv", {"t": time, "n": rpm})
    (folder / "a.toml").write_text(TEXT, encoding="utf-8")
    return Scene.load(folder / "a.toml")


def printed(folder: Path, time: np.ndarray, rpm: np.ndarray) -> str:
    return " ".join(signals_text(drive_angles(scene(folder, time, rpm))).split())


def test_gaps_are_printed_and_answered(tmp_path: Path) -> None:
    said = printed(tmp_path, with_gaps(), np.full(1000, 600.0))
    assert "1000 samples per second; 3 gaps, the longest 3.501 s after 2.3 s" in said
    done = scripts.run("run", tmp_path / "a.toml", "--json")
    answer = json.loads(done.stdout)
    jsonschema.Draft202012Validator(answers_schema()).validate(answer)
    (time,) = (s for s in answer["drive_angles"]["signals"] if s["signal"] == "time")
    assert time["gaps"] == 3
    assert time["longest_gap_s"] == pytest.approx(3.501)


def test_a_drive_that_turns_back(tmp_path: Path) -> None:
    rpm = np.concatenate([np.full(500, 6000.0), np.full(500, -6000.0)])
    angles = drive_angles(scene(tmp_path, TIMES_TIME, rpm))
    half = 6000.0 / 60.0 * 0.499
    assert angles.max == pytest.approx(360.0 * half)
    assert angles.turns == pytest.approx(2.0 * half, rel=0.01)
    text = angles_text(angles)
    assert re.match(r"first 0°, last .*, least -?[0-9.]+°, largest 17964°, .* back", text)
    done = scripts.run("run", tmp_path / "a.toml", "--json")
    jsonschema.Draft202012Validator(answers_schema()).validate(json.loads(done.stdout))
    ahead = drive_angles(scene(tmp_path, TIMES_TIME, np.abs(rpm)))
    assert ahead.max is None


def test_noise_of_an_encoder_and_counters_do_not_turn_back() -> None:
    noisy, counter = Way(), Way()
    noisy.add(np.arange(1000.0) + 0.001 * np.resize([1.0, -1.0], 1000))
    counter.add(np.arange(0.0, 3600.0, 7.0) % 360.0)
    assert noisy.extent is None
    assert counter.extent is None
    back = Way()
    for piece in (np.array([0.0, 500.0]), np.array([900.0, 100.0])):
        back.add(piece)
    assert back.extent == (0.0, 900.0)


def test_a_line_of_units_is_named(tmp_path: Path) -> None:
    (tmp_path / "r.csv").write_text("t,n\ns,rpm\n0,600\n0.1,600\n0.2,600\n", encoding="utf-8")
    message = r"r\.csv: line 2, column 't' is 's'; it must be a number: remove the second line of"
    with pytest.raises(ValueError, match=message):
        Scene.parse(TEXT, folder=tmp_path)


def test_the_report_of_a_run_has_curves_over_time(tmp_path: Path) -> None:
    html = page(scene(tmp_path, 1.7e9 + TIMES_TIME, np.linspace(300.0, 900.0, 1000)))
    assert "Motion and loads over time" in html
    assert "drive speed of shaft 0: 900 rpm" in html
    # Times of an epoch begin at 0.
    charts = drawings(html)
    assert len(charts) > 3
    for chart in charts:
        assert chart["over"] == "time [s]"
        np.testing.assert_allclose(chart["x"], TIMES_TIME, atol=1e-4)

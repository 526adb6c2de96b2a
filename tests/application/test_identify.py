"""``cardan identify``: what a recording shows, printed and in JSON."""

from __future__ import annotations

import json
import re
from pathlib import Path

import jsonschema
import numpy as np
import pytest
from click.testing import CliRunner, Result

from cardan import Driveline
from cardan.app.answers.schema import answers_schema
from cardan.app.command import commands

LINE = Driveline.from_bends([14, 9], twists=30, phases=20, degrees=True)
VALIDATOR = jsonschema.Draft202012Validator(answers_schema())
TO_DEG = 180.0 / np.pi


def identify(*arguments: str | Path) -> Result:
    return CliRunner().invoke(commands(), ["identify", *map(str, arguments)])


@pytest.fixture
def recording(tmp_path: Path) -> Path:
    angles = np.linspace(0.0, 40.0, 1500)
    motion = LINE.evaluate(angles, ("angle", "speed_ratio"), shafts=[1, 2])
    names = ["drive", "middle", "driven", "ratio", "copy", "driven2", "half"]
    angular = (TO_DEG * np.array([angles, *motion.angle])) % 360.0
    half = 0.51 * TO_DEG * motion.angle[1]
    rows = np.column_stack([*angular, motion.speed_ratio[1], angular[0], angular[2], half])
    path = tmp_path / "run.csv"
    lines = [",".join(names), *(",".join(map(repr, row)) for row in rows.tolist())]
    first, *others = lines[8].split(",")
    lines[8] = ",".join(["", *("" if other == first else other for other in others)])
    path.write_text("\n".join(lines) + "\n")
    units = np.array([TO_DEG, TO_DEG, TO_DEG, 1.0, TO_DEG, TO_DEG, TO_DEG])
    np.savez(tmp_path / "run.npz", **dict(zip(names, (rows / units).T, strict=True)))
    return path


def test_the_bend_of_a_recording(recording: Path) -> None:
    bend = float(LINE.equivalent().bend_deg)
    for arguments in (
        (recording, "--driven", "driven"),
        (recording, "--speed-ratio", "ratio"),
        (recording.with_suffix(".npz"), "--driven", "driven", "--radians"),
    ):
        found = identify(*arguments, "--drive", "drive", "--json")
        assert found.exit_code == 0, found.output
        data = json.loads(found.stdout)
        VALIDATOR.validate(data)
        in_radians = "--radians" in arguments
        assert data["equivalent_bend_rad" if in_radians else "equivalent_bend_deg"] == (
            pytest.approx(np.radians(bend) if in_radians else bend, abs=1e-7)
        )
        assert data["missing_samples"] == (0 if in_radians else 1)
        assert data["detected"]
        assert data["joints"] == []
        assert (data["unit"], data["recorded"]) == (
            ("", "speed ratio")
            if "ratio" in arguments
            else ("rad" if in_radians else "deg", "angle error")
        )
        motion = LINE.harmonics([2], outputs=("angle_error", "speed_ratio"))
        size = motion.speed_ratio[0] if "ratio" in arguments else motion.angle_error[0]
        factor = TO_DEG if data["unit"] == "deg" else 1.0
        assert data["orders"][1] == {
            "order": 2,
            "unit": data["unit"],
            "amplitude": pytest.approx(factor * size, abs=1e-6),
        }


def test_both_joints_of_a_recording(recording: Path) -> None:
    options = ("--drive", "drive", "--intermediate", "middle", "--driven", "driven")
    data = json.loads(identify(recording, *options, "--json").stdout)
    VALIDATOR.validate(data)
    bends = [entry["bend_deg"] for entry in data["joints"]]
    assert bends == pytest.approx([14.0, 9.0], abs=1e-7)
    assert data["phase_less_twist_deg"] == pytest.approx(-10.0, abs=1e-6)
    text = identify(recording, *options).output
    assert text.startswith(f"{recording}\n  samples ")
    said = dict(line.strip().split("  ", 1) for line in text.splitlines() if "  " in line.strip())
    said = {label: value.strip() for label, value in said.items()}
    assert (said["samples"], said["missing samples"]) == ("1499", "1")
    assert said["bend"].split() == ["14.00°", "9.000°"]
    assert said["phase less twist"] == "-10.0°"
    assert said["equivalent bend"] == f"{LINE.equivalent().bend_deg:.2f}°"
    amplitudes = re.findall(r"[\d.e-]+°", text.partition("Orders of what was recorded")[2])
    assert amplitudes[1] == f"{LINE.harmonics([2]).angle_error_deg[0]:.4f}°"
    assert float(said["purity"]) == pytest.approx(1.0, abs=1e-3)
    assert max(map(len, text.splitlines()[1:])) <= 79


def test_both_joints_of_recorded_speeds(tmp_path: Path) -> None:
    time = np.linspace(0.0, 4.0, 8001)
    rpm = 1200.0 + 10.0 * time
    drive = np.radians(6.0 * (1200.0 * time + 5.0 * time**2))
    middle, driven = LINE.evaluate(drive, "speed_ratio", shafts=[1, 2]).speed_ratio * rpm
    path = tmp_path / "speeds.csv"
    rows = np.column_stack([time, rpm, middle, driven])
    np.savetxt(path, rows, delimiter=",", header="t,n0,n1,n2", comments="")
    drive_options = ("--time", "t", "--drive-speed", "n0")
    speeds = ("--intermediate", "n1", "--driven-speed", "n2")
    data = json.loads(identify(path, *drive_options, *speeds, "--json").stdout)
    VALIDATOR.validate(data)
    bends = [entry["bend_deg"] for entry in data["joints"]]
    assert bends == pytest.approx([14.0, 9.0], abs=1e-3)
    assert data["phase_less_twist_deg"] == pytest.approx(-10.0, abs=0.01)


def test_what_is_no_joint_is_said(tmp_path: Path) -> None:
    angles = np.linspace(0.0, 2000.0, 4000)
    rng = np.random.default_rng(5)
    noise = rng.normal(0.0, 0.05, angles.size)
    oval = angles + np.degrees(0.01 * np.sin(2.0 * np.radians(angles)))
    path = tmp_path / "run.npz"
    np.savez(path, drive=angles, noise=angles + noise, oval=oval)
    text = identify(path, "--drive", "drive", "--driven", "noise").output
    assert "The bend is not larger than the noise permits to detect." in text
    text = identify(path, "--drive", "drive", "--driven", "oval").output
    assert "order 4 does not fit order 2" in " ".join(text.split())


def test_noise_that_hides_order_4_is_said(tmp_path: Path) -> None:
    angles = np.linspace(0.0, 3600.0, 5000)
    driven = Driveline.from_bends([11], degrees=True).evaluate(angles, "angle", degrees=True).angle
    noise = np.random.default_rng(2).normal(0.0, 0.06, angles.size)
    path = tmp_path / "run.npz"
    np.savez(path, drive=angles, driven=driven, noisy=driven + noise)
    text = identify(path, "--drive", "drive", "--driven", "noisy").output
    assert "The noise hides order 4" in text
    assert "order 4 does not fit order 2" not in " ".join(text.split())
    assert (
        "order 4"
        not in identify(path, "--drive", "drive", "--driven", "driven").output.split("The offset")[
            1
        ]
    )


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ((), "give one of --driven, --speed-ratio and --driven-speed"),
        (("--driven", "driven", "--speed-ratio", "ratio"), "give one of --driven, --speed-r"),
        (("--speed-ratio", "ratio", "--intermediate", "middle"), "--intermediate needs --driven"),
        (("--driven", "drivn"), "no column 'drivn'; did you mean 'driven'?"),
        (("--driven-speed", "ratio"), "--driven-speed needs --drive-speed"),
        (("--time", "middle", "--driven", "driven"), "give one of --drive and --time"),
        (("--driven", "drive"), "column 'drive' is named for two signals"),
        (("--driven", "copy"), "columns 'drive' and 'copy' are the same in all rows"),
        (
            ("--intermediate", "driven2", "--driven", "driven"),
            "columns 'driven' and 'driven2' are the same in all rows",
        ),
        (("--driven", "half"), "turns 0.51 times as fast as the drive"),
    ],
)
def test_what_does_not_fit_is_refused(
    recording: Path, options: tuple[str, ...], message: str
) -> None:
    found = identify(recording, "--drive", "drive", *options)
    assert found.exit_code == 2
    assert message in found.stderr
    assert found.stderr.count("\n") == 1


def test_less_than_a_turn_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "run.csv"
    path.write_text("a,b\n" + "\n".join(f"{i},{i + 1}" for i in range(100)) + "\n")
    found = identify(path, "--drive", "a", "--driven", "b")
    assert found.exit_code == 2
    assert "100 finite samples over 0.28 turns; it takes at least one turn" in found.stderr


def run_up(folder: Path, resonance_rpm: float) -> Path:
    """A joint of 6.25 deg from 300 to 1500 rpm, with a resonance that order 2 meets at some."""
    rng, time = np.random.default_rng(1), np.arange(0.0, 10.0, 1.0 / 500.0)
    rpm = 300.0 + 120.0 * time
    drive = (300.0 * time + 60.0 * time**2) / 60.0 * 2.0 * np.pi
    k, share = np.tan(np.radians(6.25) / 2.0) ** 2, rpm / resonance_rpm
    size = 1.0 / (1.0 - share**2 + 0.1j * share)
    driven = drive - k * (size * 1j * np.exp(-2j * drive)).real + rng.normal(0.0, 2e-4, time.size)
    ratio = 1.0 + 2.0 * k * np.cos(2.0 * drive)
    path = folder / "run-up.npz"
    columns = {"t": time, "n": rpm, "a": drive * TO_DEG, "y": driven * TO_DEG, "n2": rpm * ratio}
    np.savez(path, **columns, back=time[::-1])
    return path


def test_a_bend_that_changes_with_the_speed_is_said(tmp_path: Path) -> None:
    columns = ("--drive", "a", "--driven", "y")
    path = run_up(tmp_path, 900.0)
    data = json.loads(identify(path, *columns, "--drive-speed", "n", "--json").stdout)
    VALIDATOR.validate(data)
    assert data["changes"]
    speeds = [part["speed_rpm"] for part in data["by_part"]]
    assert speeds == sorted(speeds)
    assert 300.0 < speeds[0] < 600.0 < 1400.0 < speeds[-1] < 1500.0
    for part in data["by_part"]:
        slow = np.cos(np.radians(part["bend_deg"]))
        assert part["least_speed_rpm"] == pytest.approx(slow * part["speed_rpm"])
        assert part["largest_speed_rpm"] == pytest.approx(part["speed_rpm"] / slow)
    text = " ".join(identify(path, *columns, "--drive-speed", "n").output.split())
    assert "The bend or its plane changes with the drive speed by more than the noise" in text
    text = " ".join(identify(path, *columns).output.split())
    assert "The bend or its plane changes with time by more than the noise" in text
    # Far from the resonance, the bends of the parts are told with the speeds alone.
    path = run_up(tmp_path, 90_000.0)
    data = json.loads(identify(path, *columns, "--drive-speed", "n", "--json").stdout)
    assert not data["changes"]
    assert data["interval_low_deg"] < 6.25 < data["interval_high_deg"]
    assert [part["bend_deg"] for part in data["by_part"]] == pytest.approx([6.25] * 6, abs=0.05)
    assert not json.loads(identify(path, *columns, "--json").stdout)["by_part"]


def test_speeds_over_time_do_instead_of_angles(tmp_path: Path) -> None:
    path = run_up(tmp_path, 90_000.0)
    speeds = ("--drive-speed", "n", "--driven-speed", "n2")
    by_angle = json.loads(identify(path, "--drive", "a", *speeds, "--json").stdout)
    by_time = json.loads(identify(path, "--time", "t", *speeds, "--json").stdout)
    for data in (by_angle, by_time):
        assert data["equivalent_bend_deg"] == pytest.approx(6.25, abs=0.01)
        assert data["angle_offset_deg"] == pytest.approx(0.0, abs=0.01)
    refused = identify(path, "--time", "back", *speeds)
    assert (refused.exit_code, "column 'back': times must increase" in refused.stderr) == (2, True)


def test_less_than_two_turns_and_a_drift_are_said(tmp_path: Path) -> None:
    angles = np.linspace(0.0, 500.0, 400)
    driven = LINE.evaluate(np.radians(angles), "angle").angle * TO_DEG
    path = tmp_path / "run.npz"
    np.savez(path, drive=angles, driven=1.003 * driven, long=4.0 * angles)
    text = " ".join(identify(path, "--drive", "drive", "--driven", "driven").output.split())
    assert "Less than two turns: the interval takes the noise of each sample" in text
    assert "The driven shaft drifts against the drive" in text

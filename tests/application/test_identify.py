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
    names = ["drive", "middle", "driven", "ratio"]
    angular = (TO_DEG * np.array([angles, *motion.angle])) % 360.0
    rows = np.column_stack([*angular, motion.speed_ratio[1]])
    path = tmp_path / "run.csv"
    lines = [",".join(names), *(",".join(map(repr, row)) for row in rows.tolist())]
    lines[8] = ",".join(["", *lines[8].split(",")[1:]])
    path.write_text("\n".join(lines) + "\n")
    units = np.array([TO_DEG, TO_DEG, TO_DEG, 1.0])
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
    assert said["phase less twist"] == "-10.00°"
    assert said["equivalent bend"] == f"{LINE.equivalent().bend_deg:.2f}°"
    amplitudes = re.findall(r"[\d.e-]+°", text.partition("Orders of what was recorded")[2])
    assert amplitudes[1] == f"{LINE.harmonics([2]).angle_error_deg[0]:.4f}°"
    assert float(said["purity"]) == pytest.approx(1.0, abs=1e-3)
    assert max(map(len, text.splitlines()[1:])) <= 79


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
        ((), "give one of --driven and --speed-ratio"),
        (("--driven", "driven", "--speed-ratio", "ratio"), "give one of --driven and --speed-r"),
        (("--speed-ratio", "ratio", "--intermediate", "middle"), "--intermediate needs --driven"),
        (("--driven", "drivn"), "no column 'drivn'; did you mean 'driven'?"),
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
    path.write_text("a,b\n" + "\n".join(f"{i},{i}" for i in range(100)) + "\n")
    found = identify(path, "--drive", "a", "--driven", "b")
    assert found.exit_code == 2
    assert "100 finite samples over 0.28 turns; it takes at least one turn" in found.stderr

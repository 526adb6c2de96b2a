"""What a recording shows: its bends by ``cardan identify``, its orders, and pictures over time."""

from __future__ import annotations

import json
import re
from pathlib import Path

import jsonschema
import numpy as np
import pytest
from click.testing import Result
from matplotlib.patches import StepPatch

import scripts
from cardan import Driveline
from cardan.app.answers.identification import identified, sentences
from cardan.app.answers.schema import answers_schema
from cardan.app.answers.turn.orders import Bands, orders
from cardan.app.plots import plot_scene
from cardan.app.scene import Scene

LINE = Driveline.from_bends([14, 9], twists=30, phases=20, degrees=True)


VALIDATOR = jsonschema.Draft202012Validator(answers_schema())


TO_DEG = 180.0 / np.pi


def identify(*arguments: str | Path) -> Result:
    return scripts.run("identify", *arguments)


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
    verdict, figures = text.split("\n\n")[:2]
    assert " ".join(verdict.split()) == (
        "The joints do not cancel each other: the equivalent bend is 11.13°, and driveshaft "
        "catalogues permit 3°."
    )
    assert figures.startswith(f"{recording}\n  samples ")
    said = dict(line.strip().split("  ", 1) for line in text.splitlines() if "  " in line.strip())
    said = {label: value.strip() for label, value in said.items()}
    assert (said["samples"], said["missing samples"]) == ("1499", "1")
    assert said["bend"].split() == ["14.00°", "9.000°"]
    assert said["phase less twist"] == "-10.0°"
    assert said["equivalent bend"] == f"{LINE.equivalent().bend_deg:.2f}°"
    amplitudes = re.findall(r"[\d.e-]+°", text.partition("Orders of what was recorded")[2])
    assert amplitudes[1] == f"{LINE.harmonics([2]).angle_error_deg[0]:.4f}°"
    assert float(said["purity"]) == pytest.approx(1.0, abs=1e-3)
    assert max(len(line) for line in text.splitlines() if line != str(recording)) <= 79


@pytest.mark.parametrize(
    ("phase", "noise", "said"),
    [
        (3.0, 1e-4, "The joints cancel each other well enough: the equivalent bend is 2.9"),
        (3.17, 0.05, "Whether the joints cancel each other is not certain: the equivalent bend"),
        (3.2, 1e-4, "The joints do not cancel each other: the equivalent bend is 3.0"),
    ],
)
def test_whether_two_joints_cancel_is_judged(
    phase: float, noise: float, said: str, tmp_path: Path
) -> None:
    line = Driveline.from_bends([9, 9], twists=180, phases=phase, degrees=True)
    drive = np.linspace(0.0, 7200.0, 4000)
    middle, driven = line.evaluate(drive, "angle", shafts=[1, 2], degrees=True).angle
    random = np.random.default_rng(5).normal(0.0, noise, (2, drive.size))
    path = tmp_path / "run.npz"
    np.savez(path, drive=drive, middle=middle + random[0], driven=driven + random[1])
    columns = ("--drive", "drive", "--driven", "driven")
    text = " ".join(identify(path, *columns, "--intermediate", "middle").output.split())
    assert said in text
    one = " ".join(identify(path, *columns).output.split())
    assert "other" not in one
    assert "permit an equivalent bend of 3°; 'cardan check'" in one


def scene_of(text: str) -> str:
    """The scene at the end of an answer."""
    return text[text.index("    [driveline]") :]


@pytest.mark.parametrize("twist", [30, 180, -75])
@pytest.mark.parametrize("sense", [1, -1])
def test_the_scene_of_two_joints_has_the_turn_that_helps(
    sense: int, twist: int, tmp_path: Path
) -> None:
    """A recording counts upwards whichever way the shaft turns; the advice is from the joints."""
    line = Driveline.from_bends([14, 9], twists=twist, phases=twist - 12, degrees=True)
    recorded = np.linspace(0.0, 3600.0, 2000)
    angles = line.evaluate(sense * recorded, "angle", shafts=[1, 2], degrees=True).angle
    path = tmp_path / "run.npz"
    np.savez(path, drive=recorded, middle=sense * angles[0], driven=sense * angles[1])
    columns = ("--drive", "drive", "--intermediate", "middle", "--driven", "driven")
    answer = identify(path, *columns).output
    text = " ".join(answer.split())
    assert "If the shaft turned counter-clockwise, change its sign, also in phases_deg" in text
    scene = scene_of(answer).replace("[-12]" if sense > 0 else "[12]", "[-12]")
    found = Scene.parse(scene)
    assert float(found.line.equivalent().bend) == pytest.approx(float(line.equivalent().bend))
    (tmp_path / "a.toml").write_text(scene)
    advice = scripts.run("phase", tmp_path / "a.toml").output
    assert "turn it 12.0° clockwise" in advice
    # As drawn it is the same turn.
    drawn = f"twists_deg = [{twist}]\nphases_deg = [{twist - 12}]"
    (tmp_path / "a.toml").write_text(f"[driveline]\nbends_deg = [14, 9]\n{drawn}\n")
    assert "turn it 12.0° clockwise" in scripts.run("phase", tmp_path / "a.toml").output


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
    scene = Scene.parse(scene_of(identify(path, *drive_options, *speeds).output))
    assert scene.load_case
    assert scene.load_case.speed == pytest.approx(1220.0 * np.pi / 30.0, rel=2e-3)


def test_the_ends_of_an_interval_differ(tmp_path: Path) -> None:
    """However narrow it is, its width has two digits."""
    angles = np.linspace(0.0, 7200.0, 20000)
    line = Driveline.from_bends([11], degrees=True)
    driven = line.evaluate(angles, "angle", degrees=True).angle
    path = tmp_path / "run.npz"
    noise = np.random.default_rng(2).normal(0.0, 0.003, angles.size)
    np.savez(path, drive=angles, driven=driven + noise)
    options = ("--drive", "drive", "--driven", "driven")
    data = json.loads(identify(path, *options, "--json").stdout)
    text = identify(path, *options).output
    low, high = (float(end) for end in re.findall(r"interval (?:from|to) +([\d.]+)°", text))
    width = data["interval_high_deg"] - data["interval_low_deg"]
    assert 0.0 < width < 0.005
    assert high - low == pytest.approx(width, rel=0.1)


def test_an_axis_is_needed(recording: Path) -> None:
    refused = identify(recording, "--driven", "driven")
    assert refused.exit_code == 2
    assert "give one of --drive and --time; none is given" in refused.output


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
    assert "An ovality of an encoder has order 2 as well." in " ".join(text.split())
    assert "order 4 does not fit order 2" not in " ".join(text.split())
    assert (
        "order 4"
        not in identify(path, "--drive", "drive", "--driven", "driven").output.split("The offset")[
            1
        ]
    )


@pytest.mark.parametrize(("noise", "shows"), [(0.004, True), (0.02, True), (0.12, False)])
def test_a_purity_that_shows_joints_is_said(*, noise: float, shows: bool, tmp_path: Path) -> None:
    """It excludes an ovality alone, and none beside the joints."""
    angles = np.linspace(0.0, 3600.0, 5000)
    driven = Driveline.from_bends([13], degrees=True).evaluate(angles, "angle", degrees=True).angle
    path = tmp_path / "run.npz"
    random = np.random.default_rng(3).normal(0.0, noise, angles.size)
    oval = np.degrees(np.tan(np.radians(6.5)) ** 2) * np.sin(2.0 * np.radians(angles))
    np.savez(path, drive=angles, driven=driven + random, oval=angles + oval + random)
    text = " ".join(identify(path, "--drive", "drive", "--driven", "driven").output.split())
    told = "The purity is 1 as far as the noise tells"
    assert (told in text) is shows
    assert ("An ovality of an encoder beside the joints changes order 2." in text) is shows
    assert ("The noise hides order 4" in text) is not shows
    text = identify(path, "--drive", "drive", "--driven", "oval").output
    assert told not in " ".join(text.split())


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ((), "give one of --driven, --speed-ratio and --driven-speed; none is given"),
        (
            ("--driven", "driven", "--speed-ratio", "ratio"),
            "--driven and --speed-ratio are given; give only one of them",
        ),
        (("--speed-ratio", "ratio", "--intermediate", "middle"), "--intermediate needs --driven"),
        (("--driven", "drivn"), "no column 'drivn'; did you mean 'driven'?"),
        (("--driven-speed", "ratio"), "--driven-speed needs --drive-speed"),
        (
            ("--time", "middle", "--driven", "driven"),
            "--drive and --time are given; give only one of them",
        ),
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
    # Across the resonance the phase of order 2 changes by 180°, and the plane by half of that.
    parts = data["by_part"]
    bends = [part["bend_deg"] for part in parts]
    offsets = [part["angle_offset_deg"] for part in parts]
    assert offsets[0] == pytest.approx(-90.0, abs=5.0)
    assert offsets[-1] == pytest.approx(0.0, abs=5.0)
    assert (
        f"from part to part the bend is {min(bends):.4g}° to {max(bends):.4g}°, and the offset of "
        f"its plane {min(offsets):.1f}° to {max(offsets):.1f}°."
    ) in text
    text = " ".join(sentences(identified(path, "a", driven="y"), radians=True))
    assert re.search(r"the bend is 0\.\S+ rad to 0\.\S+ rad, and the offset", text)
    text = " ".join(identify(path, *columns).output.split())
    assert "The bend or its plane changes with time by more than the noise" in text
    # Far from the resonance, the bends of the parts are told with the speeds alone.
    path = run_up(tmp_path, 90_000.0)
    data = json.loads(identify(path, *columns, "--drive-speed", "n", "--json").stdout)
    assert not data["changes"]
    assert data["interval_low_deg"] < 6.25 < data["interval_high_deg"]
    assert [part["bend_deg"] for part in data["by_part"]] == pytest.approx([6.25] * 6, abs=0.05)
    assert not json.loads(identify(path, *columns, "--json").stdout)["by_part"]


RANDOM = np.random.default_rng(7)


JOINT = "[driveline]\nbends_deg = [20]\n"


ANGLES = "[angles]\nfile = 'run.csv'\ntime_column_s = 't'\nspeed_column_rpm = 'n'\n"


def irregular(turns: float, per_turn: float) -> np.ndarray:
    """Angles at unequal steps, that grow over the run as those of a run-up do."""
    count = int(turns * per_turn)
    steps = RANDOM.uniform(0.5, 1.5, count) * np.linspace(0.7, 1.3, count)
    angle = np.concatenate([[0.0], np.cumsum(steps)])
    return np.asarray(3.0 + 2.0 * np.pi * turns * angle / angle[-1])


@pytest.mark.parametrize("turns", [1.0, 2.5, 7.0, 37.3, 100.0])
def test_orders_of_known_waves(turns: float) -> None:
    """Amplitudes of whole orders, above a mean and a trend; the drive may turn backwards."""
    angle = irregular(turns, 200)
    signal = 5.0 + 0.3 * angle + 2.0 * np.cos(2.0 * angle + 1.0) + 0.5 * np.sin(5.0 * angle)
    if turns < 2.0:
        signal -= 0.3 * angle
    for sign in (1.0, -1.0):
        found = orders(sign * angle, np.stack([signal, 0.0 * signal]))
        assert found.orders[-1] == pytest.approx(12.0, abs=1e-9)
        sizes = dict(zip(found.orders.round(9), found.amplitudes[0], strict=True))
        assert sizes.pop(2.0) == pytest.approx(2.0, rel=2e-5)
        assert sizes.pop(5.0) == pytest.approx(0.5, rel=1e-4)
        sizes.pop(0.0)
        assert max(sizes.values()) < 1e-3
        assert np.all(found.amplitudes[1] == 0.0)


def test_orders_of_a_joint() -> None:
    """The closed form of the harmonics, from irregular samples with gaps and turns of a counter."""
    line = Driveline.from_bends([20], degrees=True)
    angle = irregular(10.0, 150)
    ratio = line.evaluate(angle, "speed_ratio").speed_ratio
    counted = angle % (2.0 * np.pi)
    counted[RANDOM.integers(0, counted.size, 20)] = np.nan
    found = orders(counted, ratio[np.newaxis])
    for order, exact in zip((2, 4, 6), line.harmonics((2, 4, 6)).speed_ratio, strict=True):
        assert found.amplitudes[0][order * found.turns] == pytest.approx(float(exact), abs=2e-6)


def test_a_run_up_from_rest() -> None:
    """Samples at rest, before and within the run, change nothing."""
    angle = irregular(10.0, 100)
    wave = np.sin(2.0 * angle)
    rest = np.repeat(np.arange(angle.size), np.where(np.arange(angle.size) % 400 == 0, 30, 1))
    moving, resting = (orders(angle[i], wave[i][np.newaxis]) for i in (slice(None), rest))
    np.testing.assert_array_equal(moving.amplitudes, resting.amplitudes)


@pytest.mark.parametrize(
    ("angle", "message"),
    [
        (np.linspace(0.0, 6.0, 100), "at least one turn and 8 samples; there are 0.955 turns"),
        (np.linspace(0.0, 7.0, 5), "at least one turn and 8 samples; there are 1.11 turns"),
        (np.sin(np.linspace(0.0, 6.0, 100)), "a drive that turns one way; its angle goes back"),
        (np.zeros(20), "there are 0 turns"),
        (np.arange(40) * 4.0, "two samples per turn; there are 1.61 over 24.83 turns"),
        (np.arange(40) * 1e3, "two samples per turn; there are 0.00644 over 6207 turns"),
        (np.full(9, np.nan), "there are 0 turns"),
    ],
)
def test_what_has_no_orders(angle: np.ndarray, message: str) -> None:
    with pytest.raises(ValueError, match="orders need") as caught:
        orders(angle, angle[np.newaxis])
    assert message in str(caught.value)


# Pictures


@pytest.fixture
def orders_run_up(tmp_path: Path) -> Path:
    """A drive that runs up from 600 to 900 rpm in 3 s."""
    time = 0.001 * np.arange(3001)
    rows = zip(time.tolist(), (600.0 + 100.0 * time).tolist(), strict=True)
    (tmp_path / "run.csv").write_text("t,n\n" + "".join(f"{t},{n}\n" for t, n in rows))
    path = tmp_path / "run.toml"
    path.write_text(JOINT + ANGLES)
    return path


def test_the_page_over_time(orders_run_up: Path) -> None:
    """Bands of the turns, at the times at which they begin; the speed of the drive is shown."""
    result = Scene.load(orders_run_up).run()
    pages = {over: plot_scene(result, over=over) for over in (None, "time", "turns")}
    labels = {over: page.axes[-1].get_xlabel() for over, page in pages.items()}
    assert labels == {None: "time [s]", "time": "time [s]", "turns": "turns of the drive"}
    speed = next(axes for axes in pages["time"].axes if axes.get_label() == "drive speed [rpm]")
    assert speed.get_xlim() == pytest.approx((0.0, 3.0))
    (band,) = (artist for artist in speed.get_children() if isinstance(artist, StepPatch))
    values, edges, _ = band.get_data()
    # Turn 15 begins at 300 rpm/s t**2 / 2 + 600 rpm t = 15 turns.
    begin = (-600.0 + np.sqrt(600.0**2 + 200.0 * 15.0 * 60.0)) / 100.0
    assert edges[15] == pytest.approx(begin, abs=1e-3)
    assert values[14] == pytest.approx(600.0 + 100.0 * begin, abs=0.2)
    bands = Bands.of_time(np.arange(0.0, 500.0), 3600.0 * np.sin(np.arange(0.0, 500.0) / 50.0))
    assert bands is not None
    assert bands.each.startswith("span of ")
    assert np.ptp(np.diff(bands.edges)) < 1e-9


def test_few_turns_over_time(orders_run_up: Path) -> None:
    """Curves, and no bands; over the time where it is asked for."""
    lines = (orders_run_up.parent / "run.csv").read_text().splitlines(keepends=True)
    (orders_run_up.parent / "run.csv").write_text("".join(lines[:102]))
    result = Scene.load(orders_run_up).run()
    axes = plot_scene(result, over="time").axes[-1]
    assert axes.get_xlabel() == "time [s]"
    assert axes.get_lines()[0].get_xdata() == pytest.approx(0.001 * np.arange(101))
    assert axes.get_xlim() == pytest.approx((0.0, 0.1))
    for over in (None, "turns"):
        assert plot_scene(result, over=over).axes[-1].get_xlabel() == "drive angle [deg]"


def test_the_page_of_orders(orders_run_up: Path) -> None:
    """The peak of the speed ratio is that of the closed form, at order 2."""
    figure = plot_scene(Scene.load(orders_run_up).run(), over="orders")
    axes = next(axes for axes in figure.axes if str(axes.get_label()).startswith("speed ratio"))
    (line,) = axes.get_lines()
    places, sizes = np.asarray(line.get_xdata()), np.asarray(line.get_ydata())
    assert places[np.argmax(sizes)] == 2.0
    exact = float(Driveline.from_bends([20], degrees=True).harmonics(2).speed_ratio[0])
    assert np.max(sizes) == pytest.approx(exact, rel=1e-3)
    notes = " ".join(text.get_text() for text in figure.texts)
    assert "over 18 turns, less their linear trend; root mean squares of 2 such segments" in notes


@pytest.mark.parametrize(
    ("text", "options", "message"),
    [
        (JOINT, ["--over", "time"], "--over is 'time'; the scene has no time_column_s"),
        (
            f"{JOINT}[sweep]\nturns = 0.5\n",
            ["--over", "orders"],
            "--over is 'orders'; orders need at least one turn and 8 samples; there are 0.5 turns",
        ),
        (JOINT, ["--over", "orders", "--study", "k"], "--over does not go with --study"),
    ],
)
def test_what_cannot_be_drawn(
    tmp_path: Path, text: str, options: list[str], message: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("a.toml").write_text(text)
    done = scripts.run("plot", "a.toml", *options)
    assert done.exit_code == 2
    assert message in done.stderr
    assert not Path("a.svg").exists()


def test_the_command_draws_orders_of_a_sweep(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("a.toml").write_text(JOINT)
    done = scripts.run("plot", "a.toml", "--over", "orders")
    assert done.exit_code == 0, done.output
    assert Path("a.svg").read_text().count("<path") > 100


def test_whole_orders_are_stems(tmp_path: Path) -> None:
    """Of one turn nothing is known between them, and what is constant has none."""
    path = tmp_path / "a.toml"
    path.write_text(
        "[driveline]\nbends_deg = [0, 20]\n[load]\noutput_torque_Nm = 7\n"
        '[output]\nquantities = ["speed_ratio", "torque"]\nshafts = [1, 2]\n'
    )
    figure = plot_scene(Scene.load(path).run(), over="orders")
    ratio, torque = (
        next(axes for axes in figure.axes if str(axes.get_label()).startswith(name))
        for name in ("speed ratio", "torque")
    )
    still, turning = (np.asarray(line.get_xydata()) for line in ratio.get_lines())
    assert len(still) == 0
    orders = np.arange(2, 13, 2)
    exact = Driveline.from_bends([20], degrees=True).harmonics(orders).speed_ratio
    assert ratio.get_lines()[1].get_linestyle() == "None"
    assert turning[:, 0] == pytest.approx(orders + 0.125)
    assert turning[:, 1] == pytest.approx(exact, rel=1e-6, abs=1e-10)
    stems = [np.asarray(path.vertices).tolist() for path in ratio.collections[1].get_paths()]
    assert stems == [[[x, 0.0], [x, y]] for x, y in turning.tolist()]
    assert ratio.get_ylim()[1] > exact[0]
    assert [text.get_text() for text in ratio.texts] == []
    assert [len(np.asarray(line.get_xdata())) > 0 for line in torque.get_lines()] == [True, False]

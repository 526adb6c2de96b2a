"""What a recording's times tell: rate, gaps, drives that turn back, and how it is printed."""

from __future__ import annotations

import json
import re
from pathlib import Path

import jsonschema
import numpy as np
import pytest
from click.testing import CliRunner

from cardan.app.answers.schema import answers_schema
from cardan.app.answers.turn.figures import drive_angles
from cardan.app.answers.turn.text import angles_text, signals_text
from cardan.app.command import commands
from cardan.app.files.columns import write_columns
from cardan.app.report.page import page
from cardan.app.scene import Scene
from cardan.app.scene.recording.signals import Sampling, Timing, Way
from pages import drawings

TIME = np.arange(1000) * 1e-3


def sampling(*pieces: np.ndarray) -> Sampling:
    timing = Timing()
    for piece in pieces:
        timing.add(piece)
    return timing.sampling()


def with_gaps() -> np.ndarray:
    time = TIME.copy()
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
    even = sampling(TIME)
    assert (even.gaps, even.longest) == (0, 0.0)


@pytest.mark.parametrize("size", [1, 2, 3, 7, 300, 301, 999])
def test_pieces_find_the_same(size: int) -> None:
    time = with_gaps()
    time[[5, 6, 500]] = np.nan
    found = sampling(*(time[i : i + size] for i in range(0, time.size, size)))
    want = sampling(time)
    assert (found.gaps, found.longest, found.longest_after) == (3, want.longest, want.longest_after)
    assert found.rate == pytest.approx(want.rate, rel=1e-12)


def test_missing_rows_are_no_gap_and_no_time() -> None:
    time = TIME.copy()
    time[400:450] = np.nan
    time[-300:] = np.nan
    found = sampling(time)
    assert found.rate == pytest.approx(1000.0)
    assert found.gaps == 0


def test_rows_missing_beside_a_gap_do_not_change_the_rate() -> None:
    time = TIME.copy()
    time[300:] += 2.0
    time[280:300] = np.nan
    found = sampling(time)
    assert found.gaps == 1
    assert found.longest == pytest.approx(2.021)
    assert found.rate == pytest.approx(1000.0)


def test_clocks_of_low_resolution_and_changing_rates_have_no_gaps() -> None:
    assert sampling(np.floor(TIME * 700.0) / 1000.0 + np.arange(1000)).gaps == 0
    # Pulses of an encoder while the drive runs up.
    assert sampling(np.sqrt(np.arange(1.0, 1000.0))).gaps == 0


@pytest.mark.parametrize("count", [0, 1, 2, 3])
def test_few_times(count: int) -> None:
    found = sampling(TIME[:count])
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
    done = CliRunner().invoke(commands(), ["run", str(tmp_path / "a.toml"), "--json"])
    answer = json.loads(done.stdout)
    jsonschema.Draft202012Validator(answers_schema()).validate(answer)
    (time,) = (s for s in answer["drive_angles"]["signals"] if s["signal"] == "time")
    assert time["gaps"] == 3
    assert time["longest_gap_s"] == pytest.approx(3.501)


def test_the_rate_of_a_recording_with_missing_ends(tmp_path: Path) -> None:
    rpm = np.full(1000, 600.0)
    rpm[:200] = rpm[-300:] = np.nan
    said = printed(tmp_path, TIME, rpm)
    assert "0.2 to 0.699 s; 1000 samples per second" in said
    assert "by parabolas over 11 samples, 0.01000 s" in said


def test_times_of_an_epoch_have_all_digits(tmp_path: Path) -> None:
    said = printed(tmp_path, 1.7e9 + TIME, np.full(1000, 600.0))
    assert "1700000000 to 1700000000.999 s" in said


def test_a_drive_that_turns_back(tmp_path: Path) -> None:
    rpm = np.concatenate([np.full(500, 6000.0), np.full(500, -6000.0)])
    angles = drive_angles(scene(tmp_path, TIME, rpm))
    half = 6000.0 / 60.0 * 0.499
    assert angles.max == pytest.approx(360.0 * half)
    assert angles.turns == pytest.approx(2.0 * half, rel=0.01)
    text = angles_text(angles)
    assert re.match(r"first 0°, last .*, least -?[0-9.]+°, largest 17964°, .* back", text)
    done = CliRunner().invoke(commands(), ["run", str(tmp_path / "a.toml"), "--json"])
    jsonschema.Draft202012Validator(answers_schema()).validate(json.loads(done.stdout))
    ahead = drive_angles(scene(tmp_path, TIME, np.abs(rpm)))
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
    html = page(scene(tmp_path, 1.7e9 + TIME, np.linspace(300.0, 900.0, 1000)))
    assert "Motion and loads over time" in html
    assert "drive speed of shaft 0: 900 rpm" in html
    # Times of an epoch begin at 0.
    charts = drawings(html)
    assert len(charts) > 3
    for chart in charts:
        assert chart["over"] == "time [s]"
        np.testing.assert_allclose(chart["x"], TIME, atol=1e-4)

"""The page of a scene with states: every table and curve against the driveline of each state."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cardan import Driveline, Load
from cardan.app.answers.printed import range_ends
from cardan.app.scene import Scene
from heights import HEIGHTS, NAMES, POINTS, SPEED, drivelines, scene_text
from pages import curves, figure, near, page_of, tables, three

INERTIAS = [0.0, 0.1, 0.3]
MORE = f"acceleration_rad_s2 = 40\ninertias_kgm2 = {INERTIAS}\n"
MORE += "[[bearing]]\nshaft = 2\nposition_mm = 60\n[limits]\nequivalent_bend_deg = 4"
STATES = scene_text(20.0, MORE)
MOTION = "Motion of the shafts over a whole turn at constant drive speed"


def span(values: Any, kind: str = "") -> str:  # noqa: ANN401 - numbers
    """The least and the largest of several, or the one that all are."""
    low, high = float(np.min(values)), float(np.max(values))
    low = 0.0 if abs(low) < 1e-9 * abs(high) else low
    ends = range_ends(low, high, kind)
    return ends[0] if high == low else " to ".join(ends)


@pytest.fixture(scope="module")
def over_states(tmp_path_factory: pytest.TempPathFactory) -> str:
    return page_of(STATES, tmp_path_factory.mktemp("states"))


def test_inputs_of_shafts_and_bearings(tmp_path: Path) -> None:
    found = tables(page_of(STATES.partition("[states]")[0], tmp_path))
    line = Driveline.from_points(1e-3 * POINTS, [20], degrees=True)
    head, *rows = found["Shafts"]
    columns = dict(zip(head, zip(*rows, strict=True), strict=True))
    assert columns["Shaft"] == ("shaft 0", "shaft 1", "shaft 2")
    twist = f"{float(np.degrees(line.twists[0])):.1f}"
    assert columns["Twist of bend planes [deg]"] == ("", twist, "")
    assert columns["Phase of yokes [deg]"] == ("", "20.0", "")
    (setting,) = (cells for name, cells in columns.items() if name.startswith("Output-side yoke"))
    assert setting == ("", "20.0° clockwise", "")
    for axis, name in enumerate("xyz"):
        shown = [float(cell) for cell in columns[f"Direction, {name}"]]
        assert shown == pytest.approx(line.directions[:, axis].tolist(), abs=5e-5)
    lengths = np.linalg.norm(np.diff(POINTS, axis=0), axis=-1)
    assert columns["Length [mm]"] == tuple(f"{length:.1f}" for length in lengths)
    assert columns["Inertia [kg m²]"] == tuple(f"{inertia:g}" for inertia in INERTIAS)
    assert found["Bearings"][1:] == [["bearing 0", "2", "60"]]
    drive = dict(found["Load and drive"][1:])
    assert drive["Acceleration of the drive"] == "40.00 rad/s²"
    assert drive["Drive angles"] == "0 to 360 deg, 721 samples"
    joints = [[f"joint {j}", f"{bend:.2f}"] for j, bend in enumerate(np.degrees(line.bends))]
    assert found["Joints"][1:] == joints


def test_inputs_over_states_are_ranges(over_states: str) -> None:
    found = tables(over_states)
    head, *rows = found["Shafts"]
    columns = dict(zip(head, zip(*rows, strict=True), strict=True))
    each = drivelines(20.0)
    twists = span([float(np.degrees(line.twists[0])) for line in each], "twist")
    assert columns["Twist of bend planes [deg]"] == ("", twists, "")
    assert columns["Direction, y"][0] == "0"
    low, high = map(float, columns["Direction, y"][1].split(" to "))
    heights = [line.directions[1, 1] for line in each]
    assert (low, high) == pytest.approx((min(heights), max(heights)), abs=5e-5)
    lengths = [np.hypot(np.hypot(1200.0, height), 40.0) for height in HEIGHTS]
    assert columns["Length [mm]"][1] == span(lengths, "mm")
    for joint, (name, bends) in enumerate(found["Joints"][1:]):
        assert name == f"joint {joint}"
        assert bends == span([np.degrees(line.bends[joint]) for line in each], "deg")


def test_motion_over_states_is_that_of_all(over_states: str) -> None:
    rows = {row[0]: row[1:] for row in tables(over_states)[f"{MOTION} and 3 states"]}
    for shaft in (1, 2):
        joints = [line.equivalent(shaft) for line in drivelines(20.0)]
        shown = {name: cells[shaft - 1] for name, cells in rows.items()}
        assert shown["Equivalent bend [deg]"] == span([np.degrees(j.bend) for j in joints], "deg")
        errors = [np.degrees(float(j.max_angle_error)) for j in joints]
        assert shown["Largest angle error [deg]"] == span(errors, "angle_error")
        assert shown["Non-uniformity U"] == span([j.non_uniformity for j in joints])
        peaks = [float(j.max_acceleration_ratio) * SPEED**2 for j in joints]
        assert shown["Largest acceleration [rad/s²]"] == span(peaks, "rad_s2")
        low, high = (
            1500.0 * min(float(j.min_speed_ratio) for j in joints),
            1500.0 * max(float(j.max_speed_ratio) for j in joints),
        )
        assert [float(end) for end in shown["Speed [rpm]"].split(" to ")] == pytest.approx(
            [low, high], abs=0.5
        )


def test_speeds_of_states_are_their_own(tmp_path: Path) -> None:
    speeds = (900.0, 2000.0, 1500.0)
    text = f"{STATES}speed_rpm = {list(speeds)}\n"
    page = page_of(text, tmp_path)
    assert "2000 rpm" in dict(tables(page)["Load and drive"])["Speed of the drive"]
    rows = {row[0]: row[1:] for row in tables(page)[f"{MOTION} and 3 states"]}
    # Two keys vary, so no key is the axis of the charts: the names of the states are.
    chart = figure(page, "equivalent bend, shaft 2 [deg]")
    assert (chart["named"], chart["names"]) == ("state", list(NAMES))
    joints = [line.equivalent(2) for line in drivelines(20.0)]
    ends = (
        min(rpm * float(j.min_speed_ratio) for rpm, j in zip(speeds, joints, strict=True)),
        max(rpm * float(j.max_speed_ratio) for rpm, j in zip(speeds, joints, strict=True)),
    )
    shown = [float(end) for end in rows["Speed [rpm]"][1].split(" to ")]
    assert shown == pytest.approx(ends, abs=0.5)


def test_motion_over_states_is_that_of_the_joints_as_built(tmp_path: Path) -> None:
    text = scene_text(20.0, "[joints]\ndriving_yoke_deg = [2, 0]")
    found = tables(page_of(text, tmp_path))
    assert "Harmonics of shaft 2 of the drawing: amplitudes, largest of 3 states" in found
    rows = {row[0]: row[1:] for row in found[f"{MOTION} and 3 states"]}
    turn = np.linspace(0.0, 2.0 * np.pi, 20_001)
    built = [line.with_deviations([2, 0], degrees=True) for line in drivelines(20.0)]
    errors, low, high = [], [], []
    for line in built:
        at = line.evaluate(turn, ("angle_error", "speed_ratio"))
        errors.append(float(np.degrees(np.abs(at.angle_error).max())))
        low.append(1500.0 * at.speed_ratio.min())
        high.append(1500.0 * at.speed_ratio.max())
    shown = [near(end) for end in rows["Largest angle error [deg]"][1].split(" to ")]
    assert [min(errors), max(errors)] == shown
    assert [min(low), max(high)] == [near(end) for end in rows["Speed [rpm]"][1].split(" to ")]


def test_largest_loads_over_states_name_their_state(over_states: str) -> None:
    (caption,) = (name for name in tables(over_states) if name.startswith("Loads of the shafts"))
    assert caption == "Loads of the shafts, largest over a whole turn and 3 states"
    rows = tables(over_states)[caption]
    place = next(i for i, row in enumerate(rows) if row[0] == "Largest support moment [N m]")
    assert [row[0] for row in rows[place : place + 3]] == [
        *("Largest support moment [N m]", "at drive angle [deg]", "in"),
    ]
    turn = np.linspace(0.0, np.pi, 20_001)
    load = Load(drive_torque=300.0, speed=SPEED, acceleration=40.0, inertias=INERTIAS)
    for shaft in (0, 1, 2):
        sizes = [
            np.linalg.norm(
                line.evaluate(turn, "support_moment", shafts=shaft, load=load).support_moment,
                axis=-1,
            )
            for line in drivelines(20.0)
        ]
        worst = int(np.argmax([size.max() for size in sizes]))
        size, angle, state = (row[shaft + 1] for row in rows[place : place + 3])
        assert sizes[worst].max() == near(size)
        assert state == NAMES[worst]
        at = round(float(angle) % 180.0 / 180.0 * 20_000)
        assert sizes[worst][at] == pytest.approx(sizes[worst].max(), rel=1e-4)


def test_harmonics_over_states_are_the_largest(over_states: str) -> None:
    head, *rows = tables(over_states)["Harmonics of shaft 2: amplitudes, largest of 3 states"]
    assert head[1:] == ["Angle error [deg]", "Speed ratio"]
    each = [line.harmonics((2, 4, 6)) for line in drivelines(20.0)]
    for i, (name, error, ratio) in enumerate(rows):
        assert name == f"order {2 * i + 2}"
        largest = max(float(np.degrees(one.angle_error[i])) for one in each)
        assert float(error) == pytest.approx(largest, rel=6e-3)
        assert float(ratio) == pytest.approx(max(one.speed_ratio[i] for one in each), rel=6e-3)


def test_states_have_their_own_figures(over_states: str) -> None:
    head, *rows = tables(over_states)["Figures of 3 states"]
    columns = dict(zip(head, zip(*rows, strict=True), strict=True))
    assert columns["State"] == NAMES
    assert [float(cell) for cell in columns["points 2 to 3, y [mm]"]] == list(HEIGHTS)
    bends = [float(np.degrees(line.equivalent().bend)) for line in drivelines(20.0)]
    assert columns["equivalent bend, shaft 2 [deg]"] == tuple(f"{bend:.2f}" for bend in bends)
    extremes = {row[0]: row[1:] for row in tables(over_states)["Least and largest"]}
    assert extremes["equivalent bend, shaft 2 [deg]"] == [
        *(f"{min(bends):.2f}", NAMES[int(np.argmin(bends))]),
        *(f"{max(bends):.2f}", NAMES[int(np.argmax(bends))]),
    ]


def test_verdicts_of_states(over_states: str) -> None:
    bends = [float(np.degrees(line.equivalent().bend)) for line in drivelines(20.0)]
    section = over_states[over_states.index('<section id="states"') :]
    shown = re.findall(r'<li class="(good|fair|bad)">(low|middle|high): (\w+)', section)
    assert [name for _, name, _ in shown] == list(NAMES)
    # The catalogue's maximum for the excitation is kept by all; the bend decides.
    beyond = [bend > 4.0 for bend in bends]
    assert 0 < sum(beyond) < 3
    assert [css == "bad" for css, _, _ in shown] == beyond


def test_charts_over_states(over_states: str) -> None:
    """The figure as the yokes are, with the best common setting, and its limit."""
    drawn = curves(figure(over_states, "equivalent bend, shaft 2 [deg]"))
    assert list(drawn) == ["as the yokes are", "with the best common setting", "limit 4 deg"]
    for points in drawn.values():
        assert points[:, 0] == pytest.approx(HEIGHTS, abs=1.0)
    bends = [float(np.degrees(line.equivalent().bend)) for line in drivelines(20.0)]
    assert drawn["as the yokes are"][:, 1] == pytest.approx(bends, abs=0.05)
    assert drawn["limit 4 deg"][:, 1] == pytest.approx([4.0] * 3, abs=0.05)
    # No other setting has a smaller sum of squares of tan(bend/2)².
    best = drawn["with the best common setting"][:, 1]
    sums = [
        sum(float(np.tan(line.equivalent().bend / 2.0)) ** 4 for line in drivelines(phase))
        for phase in np.linspace(-90.0, 90.0, 721).tolist()
    ]
    assert np.sum(np.tan(np.radians(best) / 2.0) ** 4) == pytest.approx(min(sums), rel=0.05)


def test_the_answer_over_states(over_states: str) -> None:
    text = " ".join(re.sub(r"<[^>]+>", " ", over_states).split())
    bends = [float(np.degrees(line.equivalent().bend)) for line in drivelines(20.0)]
    beyond = sum(bend > 4.0 for bend in bends)
    assert f"States: {3 - beyond} of 3 within, {beyond} beyond." in text
    worst = int(np.argmax(bends))
    joint = drivelines(20.0)[worst].equivalent()
    error = three(float(np.degrees(joint.max_angle_error)))
    name = NAMES[worst]
    assert f"leads and lags the drive by up to {error}°, twice per turn, in {name}." in text


def test_why_there_is_no_setting(tmp_path: Path) -> None:
    states = scene_text(20.0) + "phases_deg.0 = [10, 20, 30]\n"
    recorded = "The bends vary along the recording. Yoke settings are given for fixed bends only."
    own = "The states set the yokes themselves, so no setting can serve all of them."
    page = page_of(states, tmp_path)
    assert own in page
    assert recorded not in page
    (tmp_path / "b.csv").write_text("deg,b0,b1\n0,5,6\n10,5.5,6\n20,6,7\n", encoding="utf-8")
    text = (
        "[driveline]\n[angles]\nfile = 'b.csv'\nangle_column_deg = 'deg'\n"
        "bend_columns_deg = ['b0', 'b1']\n"
    )
    page = page_of(Scene.parse(text, "b.toml", folder=tmp_path), tmp_path)
    assert recorded in page
    assert own not in page

"""The table of a scene: extremes over a turn with their places, and of recordings."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from cardan.app.answers.data import data_of
from cardan.app.answers.turn.figures import SummaryRow, TurnFigures, drive_angles, summary
from cardan.app.answers.turn.text import summary_text
from cardan.app.scene import Scene

EXAMPLES = Path(__file__).parents[3] / "examples"


JOINT = "[driveline]\nbends_deg = [8.5]\n"


def rows(scene: Scene) -> dict[str, SummaryRow]:
    """The table by quantity, shaft or joint, and statistic: ``torque_1_peak``."""
    return {f"{row.quantity}_{row.item}_{row.statistic}": row for row in summary(scene.run())}


# The table


def test_foeppl() -> None:
    """Thoma's example: the torque that the flywheel asks for, exactly and in his small angles."""
    scene = Scene.load(EXAMPLES / "foeppl.toml")
    table = rows(scene)
    bend, inertia, speed = math.radians(8.5), 0.02, 100 * math.pi
    c, s2 = math.cos(bend), math.sin(bend) ** 2

    # theory: the largest acceleration is at cos(2 alpha) = (-p + sqrt(p**2 + 8)) / 2
    p = (2 - s2) / s2
    cos2 = (-p + math.sqrt(p * p + 8)) / 2
    place = math.acos(cos2) / 2
    largest = (
        c * s2 * math.sin(2 * place) / (math.cos(place) ** 2 * c * c + math.sin(place) ** 2) ** 2
    )
    exact = inertia * speed**2 * largest
    torque = table["torque_1_peak"]
    assert torque.value == pytest.approx(exact, rel=1e-12)
    assert torque.at_drive_angle == pytest.approx(math.degrees(place), abs=1e-5)
    small_angles = 2 * inertia * speed**2 * (1 - c)
    assert torque.value / small_angles - 1 == pytest.approx(0.0056, abs=2e-4)
    acceleration = table["acceleration_at_steady_drive_1_peak"]
    assert acceleration.value == pytest.approx(exact / inertia, rel=1e-12)
    assert acceleration.at_drive_angle == pytest.approx(math.degrees(place), rel=1e-12)

    # The bending moments beside it: |M| / Mt is 1 / cos of the angle between M and the shaft.
    assert table["moment_0_peak"].value == pytest.approx(43.855, abs=0.001)

    error = table["angle_error_1_peak"]
    assert error.value == pytest.approx(math.degrees(math.atan((1 - c) / (2 * math.sqrt(c)))))
    assert error.at_drive_angle == pytest.approx(math.degrees(math.atan(math.sqrt(c))))
    for statistic, ratio, at in (("min", c, 90), ("max", 1 / c, 0)):
        found = table[f"speed_ratio_1_{statistic}"]
        assert (found.value, found.at_drive_angle) == pytest.approx((ratio, at))
        assert table[f"speed_1_{statistic}"].value == pytest.approx(3000 * ratio)
    assert table["non_uniformity_1_value"].value == pytest.approx(1 / c - c)
    assert table["equivalent_bend_1_value"].value == pytest.approx(8.5)


def test_places_are_places() -> None:
    """What the table says happens where the table says, for a chain that starts anywhere."""
    text = (
        "[driveline]\nbends_deg = [20, 35]\ntwists_deg = [50]\nphases_deg = [-20]\n"
        "[load]\nspeed_rad_s = 100\ninertias_kgm2 = [0, 0.1, 0.3]\noutput_torque_Nm = 20\n"
        "[sweep]\nstart_deg = -400\nturns = 1.2\nsamples_per_turn = 3600"
    )
    scene = Scene.parse(text)
    table = rows(scene)
    for label, name, factor, index in (
        ("angle_error_2_peak", "angle_error", 180 / math.pi, ()),
        ("speed_ratio_2_min", "speed_ratio", 1.0, ()),
        ("speed_ratio_2_max", "speed_ratio", 1.0, ()),
        ("acceleration_ratio_2_peak", "acceleration_ratio", 1.0, ()),
        ("torque_2_peak", "torque", 1.0, ()),
        ("moment_1_peak", "moment", 1.0, (1,)),
    ):
        place = table[label].at_drive_angle
        assert place is not None
        assert -400 <= place < -220
        values = scene.line.evaluate(math.radians(place), name, load=scene.load_case)[name]
        at_place = np.linalg.norm(values[index]) * factor
        assert at_place == pytest.approx(table[label].value, rel=1e-12)
        curve = scene.run().values[name][index]
        sizes = np.linalg.norm(curve, axis=-1) if curve.ndim == 2 else np.abs(curve)
        found = np.min(sizes) if label.endswith("min") else np.max(sizes)
        assert found * factor == pytest.approx(table[label].value, rel=1e-5)
    for statistic in ("min", "max"):
        ratio = table[f"speed_ratio_2_{statistic}"].value
        assert table[f"speed_2_{statistic}"].value == pytest.approx(ratio * 100 * 30 / math.pi)


def peak(name: str, shaft: int, value: float, unit: str) -> SummaryRow:
    """The largest value of a shaft that has it at every drive angle."""
    return SummaryRow("shaft", unit, name, shaft, "peak", "turn", value, None)


def test_compensated_shaft_has_no_place() -> None:
    """Rounding is not reported as motion, and no place is given for what happens nowhere."""
    scene = Scene.parse(
        "[driveline]\nbends_deg = [33, 33]\ntwists_deg = [10]\nphases_deg = [190]\n"
        "[load]\nspeed_rpm = 1000\ninertias_kgm2 = [0, 0, 1]\n"
    )
    table = rows(scene)
    assert table["angle_error_2_peak"] == peak("angle_error", 2, 0.0, "deg")
    assert table["equivalent_bend_2_value"].value == 0.0
    assert table["speed_ratio_2_min"].value == table["speed_ratio_2_max"].value == 1.0
    assert table["acceleration_at_steady_drive_2_peak"].value == 0.0
    assert table["torque_2_peak"] == peak("torque", 2, 0.0, "Nm")
    # A phase that is off by a thousandth of a degree is motion.
    almost = rows(Scene.parse("[driveline]\nbends_deg = [15, 15]\nphases_deg = [0.001]"))
    assert almost["angle_error_2_peak"].value > 1e-6


STEADY_JOINT = """\
[driveline]
bends_deg = [30]
[load]
drive_torque_Nm = 100
[output]
quantities = ["torque", "bending_driven", "bending_driving", "moment"]
[sweep]
"""


@pytest.mark.parametrize(
    "sweep", ["", "samples_per_turn = 2", "turns = 0.1", "turns = 0.1\nsamples_per_turn = 1"]
)
def test_largest_values_are_of_the_turn_whatever_is_swept(sweep: str) -> None:
    table = rows(Scene.parse(STEADY_JOINT + sweep))
    cosine, sine = math.cos(math.pi / 6), math.sin(math.pi / 6)
    for name, value, at in (
        ("torque_1", 100 / cosine, 90.0),
        ("bending_driven_0", 100 * sine, 0.0),
        ("bending_driving_0", 100 * sine / cosine, 90.0),
        ("moment_0", 100 / cosine, 90.0),
    ):
        found = table[f"{name}_peak"]
        assert found.of == "turn"
        assert found.value == pytest.approx(value, rel=1e-12)
        # A sweep has no angle for what it does not reach.
        reached = at == 0.0 or "turns" not in sweep
        assert found.at_drive_angle == (pytest.approx(at, abs=1e-5) if reached else None)


def test_speed_of_a_drive_that_turns_backwards() -> None:
    table = rows(Scene.parse(f"{JOINT}[load]\nspeed_rpm = -100"))
    cosine = math.cos(math.radians(8.5))
    assert table["speed_1_min"].value == pytest.approx(-100 / cosine)
    assert table["speed_1_max"].value == pytest.approx(-100 * cosine)
    assert (
        table["speed_1_min"].at_drive_angle,
        table["speed_1_max"].at_drive_angle,
    ) == pytest.approx((0, 90))


def test_recordings_tell_their_samples(tmp_path: Path) -> None:
    """Of a recording everything is of the samples, also where the bends are fixed."""
    degrees = [-30.0, 40.0, 100.0, 60.0]
    (tmp_path / "run.csv").write_text("\n".join(["turn", *map(str, degrees), "", '""']))
    text = STEADY_JOINT.replace("[sweep]", "[angles]\nfile = 'run.csv'\nangle_column_deg = 'turn'")
    scene = Scene.parse(text.replace('["', '["angle_error", "'), folder=tmp_path)
    assert data_of(drive_angles(scene)) == {
        "source": "recording",
        "samples": 5,
        "missing_samples": 1,
        "first_deg": -30.0,
        "last_deg": 60.0,
        "min_deg": -30.0,
        "max_deg": 100.0,
        "turns": pytest.approx(170 / 360),
        "samples_per_turn": pytest.approx(3 / 170 * 360),
    }
    table = rows(scene)
    driving = [100 * math.tan(math.pi / 6) * abs(math.sin(math.radians(at))) for at in degrees]
    found = table["bending_driving_0_peak"]
    assert found.value == pytest.approx(max(driving))
    assert found.at_drive_angle == 100.0
    kinds = {row.quantity: row.of for row in table.values()}
    assert {name for name, of in kinds.items() if of == "driveline"} == {
        *("bend", "equivalent_bend", "non_uniformity")
    }
    assert {name for name, of in kinds.items() if of == "samples"} == {
        *("angle_error", "torque", "bending_driven", "bending_driving", "moment")
    }
    turn = TurnFigures(drive_angles(scene), tuple(table.values()))
    lines = summary_text(turn).splitlines()
    heading = lines.index("In these 4 samples, first -30°, last 60°, least -30°, largest 100°,")
    assert lines[heading + 1] == "  0.4722 turns forward and back, 6.353 samples per turn"


def test_one_entry_needs_no_list() -> None:
    text = "[driveline]\nbends_deg = 10\n[output]\nquantities = 'angle'\nclosed_forms = 'k'"
    scene = Scene.parse(text)
    assert scene.line.bends_deg == pytest.approx([10.0])
    assert scene.quantities == ("angle",)
    two = Scene.parse("[driveline]\nbends_deg = [10, 10]\ntwists_deg = 180\nphases_deg = 5").line
    assert [two.twists_deg, two.phases_deg] == [pytest.approx([180.0]), pytest.approx([5.0])]


@pytest.mark.parametrize("ends", [("slopes", [2, 7, 3]), ("projected_bends", [5, -4])])
@pytest.mark.parametrize("view", ["vertical", "horizontal"])
def test_shafts_are_level_in_the_view_that_is_left_out(
    ends: tuple[str, list[int]], view: str
) -> None:
    name, angles = ends
    other = {"vertical": "horizontal", "horizontal": "vertical"}[view]
    one = f"[driveline]\n{name}_{view}_deg = {angles}\n"
    both = f"{one}{name}_{other}_deg = {[0] * len(angles)}\n"
    assert np.array_equal(Scene.parse(one).line.directions, Scene.parse(both).line.directions)
    study = f"[study]\n{name}_{other}_deg.1 = [0, 3]\n"
    assert Scene.parse(one + study).study is not None


def test_spatial_shaft() -> None:
    scene = Scene.load(EXAMPLES / "spatial_shaft.toml")
    table = rows(scene)
    bends = [table[f"bend_{joint}_value"].value for joint in (0, 1)]
    assert bends == pytest.approx((16.4225, 16.3956), abs=5e-5)
    assert table["twist_1_value"].value == pytest.approx(109.127, abs=5e-4)
    assert table["phase_1_value"].value == pytest.approx(-70.8728)
    assert table["equivalent_bend_2_value"].value == pytest.approx(0.951, abs=5e-4)
    untwisted = rows(
        Scene.parse((EXAMPLES / "spatial_shaft.toml").read_text().replace("-70", "-0"))
    )
    assert untwisted["equivalent_bend_2_value"].value > 20

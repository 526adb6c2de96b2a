"""Studies that move bearings and change the lengths of shafts."""

from __future__ import annotations

import jsonschema
import numpy as np
import pytest

from cardan import Driveline, Load
from cardan.app.answers.names import key_name
from cardan.app.scene import Scene, SceneError

TEXT = """
[driveline]
bends_deg = [10, 12]
twists_deg = [180]
lengths_mm = [300, 1200, 300]
[[bearing]]
shaft = 0
position_mm = 100
[[bearing]]
shaft = 0
position_mm = 250
[[bearing]]
shaft = 2
position_m = 0.05
[[bearing]]
shaft = 2
position_mm = 200
[load]
drive_torque_Nm = 100
[study]
{study}
[output]
quantities = ["joint_force", "bearing_force"]
"""
LINE = Driveline.from_bends([10, 12], 180, degrees=True)
LOAD = Load(drive_torque=100.0)
TURN = np.linspace(0.0, 2.0 * np.pi, 721)


def peaks(places: list[float], lengths: list[float]) -> tuple[np.ndarray, np.ndarray]:
    bearings = list(zip((0, 0, 2, 2), places, strict=True))
    line = LINE.with_bearings(bearings, lengths)
    found = line.evaluate(TURN, ("joint_force", "bearing_force"), load=LOAD, reduce="peak")
    return found.joint_force, found.bearing_force


def test_positions_and_lengths_make_a_grid() -> None:
    text = TEXT.format(
        study="bearing.1.position_mm = [150, 200, 280]\nlengths_mm.1 = [800, 1600]\n"
        "bearing.2.position_m = [0.02, 0.05]"
    )
    study = Scene.parse(text).run().study
    assert study is not None
    # TOML keeps the keys of bearings together.
    keys = ["bearing.1.position_mm", "bearing.2.position_m", "lengths_mm.1"]
    assert [axis.key for axis in study.axes] == keys
    for i, place in enumerate((0.15, 0.2, 0.28)):
        for j, length in enumerate((0.8, 1.6)):
            for k, other in enumerate((0.02, 0.05)):
                joints, bearings = peaks([0.1, place, other, 0.2], [0.3, length, 0.3])
                for item, want in enumerate(joints):
                    found = study.values[f"joint_force_{item}_peak"][i, k, j]
                    assert found == pytest.approx(want, rel=1e-12)
                for item, want in enumerate(bearings):
                    found = study.values[f"bearing_force_{item}_peak"][i, k, j]
                    assert found == pytest.approx(want, rel=1e-12)
    # Each of the keys matters.
    assert len(set(study.values["bearing_force_1_peak"][:, 0, 0])) == 3
    assert len(set(study.values["joint_force_0_peak"][0, 0])) == 2
    assert len(set(study.values["bearing_force_2_peak"][0, :, 0])) == 2


def test_bends_and_positions_together() -> None:
    text = TEXT.format(study="bends_deg.0 = [5, 10]\nbearing.0.position_mm = [60, 100]")
    study = Scene.parse(text).run().study
    assert study is not None
    _, want = peaks([0.06, 0.25, 0.05, 0.2], [0.3, 1.2, 0.3])
    assert study.values["bearing_force_0_peak"][1, 0] == pytest.approx(want[0], rel=1e-12)


@pytest.mark.parametrize(
    ("study", "message"),
    [
        (
            "bearing.1.position_mm = [400, 500]",
            "position_mm is 400 mm on shaft 0 of length 300 mm; a bearing must lie between",
        ),
        ("bearing.1.position_mm = [50, 100]", "position_mm is 100 mm on shaft 0, the place of"),
        ("bearing.1.position_m = [0.2]", "does not go with position_mm of that bearing; vary"),
        ("bearing.9.position_mm = [2]", "does not exist; there are 4 bearings, counted from 0"),
        ("bearing.x.position_mm = [2]", "bearing.x does not exist; write 0 for the first bearing"),
        ("bearing.0.shaft = [2]", "bearing.0 has no 'shaft'; known are position_mm, position_m"),
        ("bearing = [2]", "bearing is .2.; name number and key, as in bearing.0.position_mm"),
        ("lengths_mm.1 = [-1, 1]", "lengths.1. is -0.001; a length must be positive and finite"),
        ("lengths_m = [1, 2]", "lengths_m is not in .driveline.; a study can vary"),
    ],
)
def test_studies_that_cannot_be(study: str, message: str) -> None:
    with pytest.raises(SceneError, match=message):
        Scene.parse(TEXT.format(study=study))


def test_the_schema_knows_the_keys() -> None:
    schema = jsonschema.Draft202012Validator(Scene.schema())
    base = {"driveline": {"bends_deg": [1]}}
    for good in (
        {"bearing": {"0": {"position_mm": [1, 2]}}},
        {"lengths_mm": {"1": {"from": 1, "to": 2, "steps": 3}}},
    ):
        schema.validate({**base, "study": good})
    wrong: tuple[dict[str, object], ...] = (
        {"bearing": {"0": {"shaft": [1]}}},
        {"bearing": [1]},
        {"bearing": {"0": {}}},
    )
    for bad in wrong:
        assert not schema.is_valid({**base, "study": bad})


def test_keys_have_names() -> None:
    assert key_name("bearing.2.position_m") == "position, bearing 2 [m]"
    assert key_name("lengths_mm.1") == "length, shaft 1 [mm]"

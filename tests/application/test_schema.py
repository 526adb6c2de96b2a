"""The JSON Schema of scenes, and scenes at random: the reader takes what the schema takes."""

from __future__ import annotations

import json
import math
import random
import tomllib
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import pytest
from click.testing import CliRunner
from hypothesis import given, settings
from hypothesis import strategies as st

from cardan.app.answers.answer import Answer
from cardan.app.answers.schema import run_data
from cardan.app.answers.study import study_figures, study_text
from cardan.app.answers.turn.figures import turn_figures
from cardan.app.answers.turn.text import summary_text
from cardan.app.command import commands
from cardan.app.scene import Scene
from cardan.app.scene.scene import FORMAT
from cardan.app.scene.starters import STARTERS
from cardan.app.scene.study.curves import columns, study_columns
from example_scenes import ANSWERS, EXAMPLES, SCENES
from scene_values import VALUES, as_toml
from tiers import part

ROOT = Path(__file__).parents[2]


def test_schema_is_a_schema() -> None:
    jsonschema.Draft202012Validator.check_schema(Scene.schema())


def test_the_command_prints_it() -> None:
    assert json.loads(CliRunner().invoke(commands(), ["schema"]).output) == Scene.schema()


def test_it_knows_every_key() -> None:
    described = Scene.schema()["properties"]
    for name, section in FORMAT.items():
        own = described.get(name, {})
        keys = own.get("items", own)["properties"] if name else described
        assert set(section.keys) <= set(keys)
        for key, entry in section.keys.items():
            assert keys[key]["description"] == entry.meaning


TEXTS = {path.stem: path.read_text(encoding="utf-8") for path in EXAMPLES}
TEXTS |= {kind: starter.text.replace("{name}", "a") for kind, starter in STARTERS.items()}
TEXTS["study"] = """\
[driveline]
points_mm = [[0, 0, 0], [350, -24, 0], [1650, -46, 0], [3150, -180, 45]]
[load]
speed_rpm = 100
inertias_kgm2 = [0, 1, 2]
[study]
points_mm.1-2.y = {from = -1, to = 1, steps = 3}
phases_deg.0 = [1, 2]
speed_rpm = [3]
[output]
reduce = "rms"
closed_forms = ["k"]
table = "a.parquet"
workers = -1
"""


@pytest.mark.parametrize("text", TEXTS.values(), ids=list(TEXTS))
def test_every_scene_is_valid(text: str) -> None:
    SCENES.validate(tomllib.loads(text))


JOINT = "[driveline]\nbends_deg = [8.5]\n"
TWO = "[driveline]\nbends_deg = [8.5, 9]\n"


@pytest.mark.parametrize(
    "text",
    [
        "",
        "title = 3\n" + JOINT,
        "titel = 'a'\n" + JOINT,
        "bends_deg = [1]",
        "driveline = 3",
        "[driveline]\n",
        "[driveline]\nbend_deg = [1]",
        "[driveline]\nbends_rad = [1]",
        "[driveline]\nbends_deg = true",
        "[driveline]\nbends_deg = []",
        "[driveline]\nbends_deg = ['8']",
        "[driveline]\nbends_deg = [90]",
        "[driveline]\nbends_deg = [-1]",
        "[driveline]\npoints_m = [[0, 0], [1, 0, 0], [2, 0, 0]]",
        "[driveline]\nslopes_vertical_deg = [1]",
        "[driveline]\nslopes_vertical_deg = [1, 90]\nslopes_horizontal_deg = [1, 2]",
        JOINT + "points_m = [[0, 0, 0], [1, 0, 0], [2, 0, 0]]",
        "[driveline]\npoints_m = [[0, 0, 0], [1, 0, 0], [2, 0, 0]]\ntwists_deg = []",
        JOINT + "[laod]\nspeed_rpm = 1",
        JOINT + "[load]\nspeed_rpm = 1\nspeed_rad_s = 1",
        JOINT + "[load]\nspeed_rpm = '1'",
        JOINT + "[sweep]\nturns = 0",
        JOINT + "[sweep]\nsamples_per_turn = 1.5",
        JOINT + "[sweep]\n[angles]\nfile = 'a.csv'\nangle_column_deg = 'a'",
        JOINT + "[angles]\nangle_column_deg = 'a'",
        JOINT + "[angles]\nfile = 'a.csv'",
        JOINT + "[angles]\nfile = 'a.xls'\nangle_column_deg = 'a'",
        JOINT + "[angles]\nfile = 'a.csv'\nangle_column_deg = 'a'\nangle_column_rad = 'a'",
        JOINT + "[angles]\nfile = 'a.csv'\nangle_column_deg = 'a'\nbend_columns_deg = ['b']",
        JOINT + "[angles]\nfile = 'a.csv'\nangle_column_deg = 'a'\nbend_columns_rad = ['b']",
        "[angles]\nfile = 'a.csv'\nangle_column_deg = 'a'\nbend_columns_deg = ['b']\n"
        "bend_columns_rad = ['b']",
        JOINT + "[study]\n",
        JOINT + "[study]\nbends_deg = 3",
        JOINT + "[states]\n",
        JOINT + "[states]\nbends_deg = 3",
        JOINT + "[states]\n'bends_deg.0' = 'a'",
        JOINT + "[states]\n'bends_deg.x' = [1]",
        JOINT + "[states]\nbends_deg.0 = [1]\nweights = [-1]",
        JOINT + "[steering]\noffset_deg = 0",
        JOINT + "[study]\nbends_deg = []",
        JOINT + "[study]\nbends_deg = {from = 1, to = 2}",
        JOINT + "[study]\nbends_deg = {from = 1, to = 2, step = 2}",
        JOINT + "[study]\nbends_deg.x = [1]",
        JOINT + "[study]\nbend_deg = [1]",
        JOINT + "[study]\npoints_mm.1 = [1]",
        JOINT + "[output]\nquantities = ['speed']",
        JOINT + "[output]\nquantities = []",
        JOINT + "[output]\nquantities = ['angle', 'angle']",
        JOINT + "[output]\nreduce = 'peek'",
        JOINT + "[output]\nshafts = [-1]",
        JOINT + "[output]\ncurves = 'a.ods'",
        JOINT + "[output]\ncurves = '../a.csv'",
        JOINT + "[output]\nworkers = 0",
    ],
)
def test_typical_mistakes_are_not(text: str, tmp_path: Path) -> None:
    """Mistakes that need no file and no lengths to be seen: the schema knows them as well."""
    with pytest.raises(jsonschema.ValidationError):
        SCENES.validate(tomllib.loads(text))
    (tmp_path / "a.csv").write_text("a,b\n1,2\n")
    with pytest.raises(ValueError, match="scene"):
        Scene.parse(text, folder=tmp_path)


# Scenes at random


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What the recorded scenes read."""
    path = tmp_path_factory.mktemp("recordings")
    for samples in (ROOT / "examples").glob("*.csv"):
        (path / samples.name).write_text(samples.read_text())
    (path / "a_run.csv").write_text("crank_deg,front_deg,rear_deg\n0,1,2\n1,2,3\n")
    return path


def accepted(text: str, folder: Path) -> bool:
    """Whether it is a scene; anything but a message on one line is a failure."""
    try:
        scene = Scene.parse(text, "a.toml", folder)
    except ValueError as error:
        message = str(error)
        assert message.startswith("a.toml")
        assert message.isprintable()
        assert len(message) < 1500
        return False
    assert not np.isinf(scene.drive_angle).any()
    return True


PIECES = [
    *(
        "[",
        "]",
        "=",
        ".",
        ",",
        "\n",
        '"',
        "'",
        "#",
        "{",
        "}",
        "-",
        "0",
        "9",
        "e",
        "inf",
        "nan",
        "_",
    ),
    *("true", "1979-05-27", "\x00", "\ud7ff", "é", '"""', "steps", "from", "to", "x", "[[a]]"),
    *(section.heading for section in FORMAT.values()),
    *(key for section in FORMAT.values() for key in section.keys),
]


@settings(max_examples=part(400))
@given(st.sampled_from(list(TEXTS.values())), st.integers(0, 2**32), st.integers(1, 6))
def test_text_changed_at_random(folder: Path, text: str, seed: int, changes: int) -> None:
    chance = random.Random(seed)
    for _ in range(changes):
        first = chance.randrange(len(text) + 1)
        last = min(len(text), first + chance.choice((0, 0, 1, 3, 20)))
        text = text[:first] + chance.choice((*PIECES, "")) + text[last:]
    accepted(text, folder)


def shows(scene: Scene) -> None:
    """It runs and can be shown; a point of its grid may still be no driveline."""
    try:
        result = scene.run()
    except ValueError as error:
        assert "[study] at " in str(error)  # noqa: PT017 - either may be
        return
    for radians in (False, True):
        turn = turn_figures(result)
        assert summary_text(turn, radians=radians)
        answer = run_data(Answer(scene), turn, result.study, [], radians=radians)
        ANSWERS.validate(json.loads(json.dumps(answer, allow_nan=False)))
        assert columns(result, radians=radians)
        if result.study:
            found = study_figures(result.study, 1, radians=radians)
            assert study_text(found, turn.drive_angles, radians=radians)
            assert study_columns(result.study, radians=radians)


@settings(max_examples=part(400))
@given(
    st.sampled_from(list(TEXTS.values())),
    st.lists(
        st.tuples(
            st.sampled_from([(name, key) for name, part in FORMAT.items() for key in part.keys]),
            VALUES,
        ),
        min_size=1,
        max_size=3,
    ),
)
def test_values_changed_at_random(
    folder: Path, text: str, changes: list[tuple[tuple[str, str], Any]]
) -> None:
    """And whatever is a scene is one by the schema too."""
    scene = tomllib.loads(text)
    for (name, key), value in changes:
        section = scene.setdefault(name, [{}] if FORMAT[name].repeated else {}) if name else scene
        (section[-1] if isinstance(section, list) else section)[key] = value
    lines = [f"{as_toml(key)} = {as_toml(value)}" for key, value in scene.items()]
    changed = "\n".join(lines)
    assert tomllib.loads(changed).keys() == scene.keys()
    if not accepted(changed, folder):
        return
    SCENES.validate(tomllib.loads(changed))
    accepted_scene = Scene.parse(changed, "a.toml", folder)
    study = accepted_scene.study
    if len(accepted_scene.drive_angle) < 2000 and (not study or math.prod(study.shape) < 200):
        shows(accepted_scene)

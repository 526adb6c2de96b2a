"""Reader and JSON Schema of scenes take the same keys, values and sections, also at random."""

from __future__ import annotations

import json
import math
import random
import re
import tomllib
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import scripts
from cardan.app.answers.answer import Answer
from cardan.app.answers.schema import run_data
from cardan.app.answers.study import study_figures, study_text
from cardan.app.answers.turn.figures import turn_figures
from cardan.app.answers.turn.text import summary_text
from cardan.app.scene import Scene
from cardan.app.scene.language.errors import Location
from cardan.app.scene.language.rules import Rule
from cardan.app.scene.scene import FORMAT
from cardan.app.scene.sections.driveline import FORMS
from cardan.app.scene.starters import STARTERS
from cardan.app.scene.study.curves import columns, study_columns
from example_scenes import ANSWERS, EXAMPLES, SCENES
from scene_values import DEFINITIONS, VALUES, as_toml, fitting, nearly
from tiers import part

ROOT = Path(__file__).parents[3]


def test_schema_is_a_schema() -> None:
    jsonschema.Draft202012Validator.check_schema(Scene.schema())


def test_the_command_prints_it() -> None:
    assert json.loads(scripts.run("schema").output) == Scene.schema()


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


# JSON has one kind of number and none that is not finite; TOML tells 1 from 1.0.
_TYPES = jsonschema.Draft202012Validator.TYPE_CHECKER.redefine_many(
    {
        "integer": lambda _, value: isinstance(value, int) and not isinstance(value, bool),
        "number": lambda _, value: (
            isinstance(value, int | float) and not isinstance(value, bool) and value == value
        ),
    }
)


_OfToml = jsonschema.validators.extend(jsonschema.Draft202012Validator, type_checker=_TYPES)


SCHEMA = Scene.schema()


VALIDATOR = _OfToml(SCHEMA)


# What no schema can say of a single value.
ONE_STEP = r"\.steps is 1; from \S+ to \S+ takes at least 2$"


NOT_PRINTABLE = r"; it must have printable characters only$"


FALLING = r"; it must have a maximum that is not below the limit$"


NO_CHANGE = r"; it is the range of the change, which must contain 0$"


NO_RANGE = r"; the first must be below the second$"


TWICE = r" is given twice, with quotes and without$"


NO_RISE = r"; it must be above 'from', \S+$"


NO_DIRECTION = r" without a direction; write | is \[0, 0, 0\]; an axis needs a direction$"


TWO_DIRECTIONS = r", with a sign and '\w+'; give one of them$"


TOO_STEEP = r"; (of a gauge that .*; a reading|an offset) must lie within "


def _only_the_reader(value: object, message: str) -> bool:
    if isinstance(value, dict) and re.search(NOT_PRINTABLE, message):
        return any(_only_the_reader(entry, message) for entry in value.values())
    if isinstance(value, str):
        return not value.isprintable() and bool(re.search(NOT_PRINTABLE, message))
    own = (NO_DIRECTION, TWO_DIRECTIONS, TOO_STEEP)
    return bool(
        re.search("|".join((ONE_STEP, FALLING, NO_CHANGE, NO_RANGE, TWICE, NO_RISE, *own)), message)
    )


# Each rule by the first of its keys.
RULES: dict[str, Rule] = {}


for section in FORMAT.values():
    for key, entry in section.keys.items():
        if entry.rule not in RULES.values():
            RULES[f"{section.name}.{key}"] = entry.rule


@pytest.mark.parametrize("name", sorted({type(rule).__name__ for rule in RULES.values()}))
@settings(max_examples=part(120))
@given(data=st.data())
def test_reader_and_schema_take_the_same_values(name: str, data: st.DataObject) -> None:
    rules = [rule for rule in RULES.values() if type(rule).__name__ == name]
    agree(data.draw(st.sampled_from(rules)), data)


@pytest.mark.long
@pytest.mark.parametrize("name", RULES)
@settings(max_examples=part(240))
@given(data=st.data())
def test_reader_and_schema_take_the_same_values_of_every_rule(
    name: str, data: st.DataObject
) -> None:
    agree(RULES[name], data)


def agree(rule: Rule, data: st.DataObject) -> None:
    """Reader and schema both take a value, or both refuse it."""
    right = fitting(rule.schema)
    value = data.draw(st.one_of(right, right.flatmap(nearly), VALUES))
    valid = _OfToml({**rule.schema, "$defs": DEFINITIONS}).is_valid(value)
    message = ""
    try:
        rule.read(Location("key"), value)
    except ValueError as error:
        message = str(error)
        assert message.startswith("key")
        # The longest lists all quantities and outputs.
        assert len(message) < 600
    assert valid == (not message) or (valid and _only_the_reader(value, message)), message


# What no schema can say of a scene: rules across keys, the geometry, and files.
ACROSS_KEYS = (
    ONE_STEP,
    NOT_PRINTABLE,
    FALLING,
    # Lengths, numbers of shafts and joints, and places that must fit the driveline.
    r" has length \d+; it needs \d+, (as many as \w+|one per shaft\b)",
    r"(shafts|joints)\[\d+\] is \d+; there are \d+, counted from 0$",
    r" does not exist; there are \d+, counted from 0$",
    r" has no entries; one joint has no shaft between two joints$",
    # Sizes.
    r" a sweep takes at most \d+ steps$",
    r" makes the study .* rows; it takes at most \d+: ",
    # Keys and sections that others need.
    r"inertias_kgm2 are given without a speed or an acceleration; ",
    r"quantities\[\d+\] is '\w+'; it needs a section \[load\]$",
    r"table needs a section \[study\] or \[states\], reduce or closed_forms$",
    r"table is '.*'; that is the file of the curves$",
    r"closed_forms do not go with recorded bends$",
    r"\[study\] \S+ does not go with recorded bends$",
    r"\[study\] \w+ needs a section \[load\]$",
    r"\[(study|states)\] .* has no sheets; leave out sheet = ",
    r"\[study\] \w+ is not in \[\w+\]; a study can vary ",
    r"\[study\] \w+ does not go with \w+ of \[load\]; vary that$",
    r"\[study\] \S+ varies \S+, which varies already$",
    r"\[study\] at ",
    # Points, directions and slopes that make no driveline.
    r"\[driveline\] (points_m|points_mm|directions|slopes_|projected_|readings_)\w*( and \w+)? "
    r"?(give|are|\[)",
    *(NO_DIRECTION, TWO_DIRECTIONS, TOO_STEEP),
    r"\[driveline\] offsets_mm go aside by \S+ along shaft \d",
    r"\[driveline\] \w+ has length \d+; it needs \d+, one per point$",
    r"\[driveline\] pivot_wear_mm puts the pivot beyond the joints, ",
    r"\[driveline\] double_joint_deg is \S+ deg, which bends joint \d ",
    # A spline, a ball joint.
    r"\[slip\] shaft (has no length; \[slip\] needs points|is \d+; there are \d+, counted)",
    r"closed_forms 'length' needs points_mm or points_m$",
    r"\[ball_joint\] (radius_mm is missing|clearance_mm needs the compliance)",
    # Shafts as springs.
    NO_RISE,
    r"\[torsion\] \w+ has length \d+; it needs \d+, one per shaft$",
    r"\[torsion\] inertias_kgm2\[.*\] is 0\.0, and so is every inertia ",
    r"\[torsion\] stiffnesses and inertias differ by too many orders of magnitude; ",
    r"\[torsion\] stiffnesses_Nm_per_rad is missing; give it, a section \[tubes\] or a ",
    r"\[torsion\] stiffnesses_Nm_per_rad\[\d+\] is 'tube'; shaft \d+ is not in \[tubes\]$",
    r"\[torsion\] stiffnesses_Nm_per_rad are all infinite; at least one shaft must be compliant$",
    # What a file holds.
    r"\[angles\] ",
)


@st.composite
def scenes(draw: st.DrawFn) -> dict[str, Any]:
    """Scenes of sections as the schema wants them; lengths mostly fit."""
    described = SCHEMA["properties"]
    form = draw(st.sampled_from([FORMS[0]] * 4 + [*FORMS]))
    joints = form.joints or draw(st.integers(1, 3))
    lengths = dict.fromkeys(form.keys, joints + form.ends) | dict.fromkeys(
        form.optional, joints - 1
    )
    needed = form.keys[draw(st.integers(-1, 1)) :][:2] if form.views else form.keys
    keys = [*needed, *draw(st.lists(st.sampled_from(form.optional), unique=True))]
    scene: dict[str, Any] = {"driveline": {}}
    for key in keys:
        size = draw(st.sampled_from([lengths[key]] * 9 + [lengths[key] + 1]))
        part = described["driveline"]["properties"][key]
        *alone, several = part.get("oneOf", [part])
        lists = st.lists(fitting(several["items"]), min_size=size, max_size=size)
        scene["driveline"][key] = draw(st.one_of(lists, *map(fitting, alone if size == 1 else ())))
    if draw(st.booleans()):
        sizes = {"minItems": joints + 1, "maxItems": joints + 1}
        load = described["load"]
        inertias = {**load["properties"]["inertias_kgm2"], **sizes}
        scene["load"] = draw(
            fitting({**load, "properties": {**load["properties"], "inertias_kgm2": inertias}})
        )
    for name in draw(st.lists(st.sampled_from(["sweep", "study", "output", "angles"]), max_size=3)):
        properties = described[name]["properties"]
        most = st.lists(st.sampled_from(list(properties)), min_size=1, max_size=3, unique=True)
        chosen = {key: properties[key] for key in draw(most)}
        if name == "study" and draw(st.booleans()):
            used = [*scene["driveline"], *scene.get("load", {})]
            chosen = {key: properties[key] for key in used[:2]}
        if name == "angles":
            scene[name] = {"file": "a_run.csv", "angle_column_deg": "crank_deg"}
        else:
            scene[name] = draw(fitting({"type": "object", "properties": chosen}))
    if draw(st.booleans()):
        section = draw(st.sampled_from(sorted(scene)))
        scene[section] = draw(nearly(scene[section]))
    return scene


@pytest.fixture(scope="module")
def rules_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What the recorded scenes read."""
    path = tmp_path_factory.mktemp("recordings")
    (path / "a_run.csv").write_text("crank_deg\n0\n1\n")
    return path


@settings(max_examples=part(400))
@given(scenes())
def test_reader_and_schema_take_the_same_scenes(rules_folder: Path, scene: dict[str, Any]) -> None:
    text = "\n".join(f"{as_toml(key)} = {as_toml(value)}" for key, value in scene.items())
    valid = VALIDATOR.is_valid(tomllib.loads(text))
    message = ""
    try:
        Scene.parse(text, "a.toml", rules_folder)
    except ValueError as error:
        message = str(error)
    except OSError as error:
        message = f"[angles] {error}"
    across = any(re.search(rule, message) for rule in ACROSS_KEYS)
    assert valid == (not message) or (valid and across), message

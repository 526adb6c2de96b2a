"""The JSON answers of the command: their schema, their keys."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import jsonschema
import pytest
from click.testing import CliRunner

from cardan.app.answers.schema import VERSION, answers_schema
from cardan.app.command import commands
from cardan.app.scene import Scene, starters
from example_scenes import ANSWERS, EXAMPLES, SHORT, Answers, each_driveline, each_example

ROOT = Path(__file__).parents[2]
SCHEMA = answers_schema()


def answer(command: str, *arguments: str | Path) -> Any:  # noqa: ANN401 - JSON
    result = CliRunner().invoke(commands(), [command, *map(str, arguments), "--json"])
    assert result.exit_code in (0, 1), result.output
    return json.loads(result.stdout)


def test_schema_is_a_schema() -> None:
    jsonschema.Draft202012Validator.check_schema(SCHEMA)


def test_the_command_prints_it() -> None:
    assert json.loads(CliRunner().invoke(commands(), ["schema", "--answers"]).output) == SCHEMA


def objects(schema: Any) -> Iterator[dict[str, Any]]:  # noqa: ANN401 - JSON
    if isinstance(schema, dict):
        if schema.get("type") == "object":
            yield schema
        for value in schema.values():
            yield from objects(value)
    elif isinstance(schema, list):
        for value in schema:
            yield from objects(value)


def test_no_object_has_other_keys() -> None:
    assert all(found["additionalProperties"] is False for found in objects(SCHEMA["$defs"]))


@pytest.mark.parametrize("options", [[], ["--radians"]], ids=["deg", "rad"])
@each_example
def test_examples_answer_by_the_schema(path: Path, options: list[str], answered: Answers) -> None:
    data = answered(path).data("run", *options)
    ANSWERS.validate(data)
    assert (data["answer"], data["version"]) == ("run", VERSION)
    unit = "rad" if options else "deg"
    other = {"rad": "_deg", "deg": "_rad"}[unit]
    found = {key for key in _keys_of(data) if key.endswith(other)}
    assert not {key for key in found if not key.endswith("per_rad")}


@each_driveline
def test_settings_of_the_examples_answer_by_the_schema(path: Path, answered: Answers) -> None:
    line = Scene.load(path).line
    if line.n_joints > 1 and not line.shape:
        ANSWERS.validate(answered(path).data("phase"))


def test_the_short_examples_have_every_section() -> None:
    every, short = (
        {name for path in paths for name in tomllib.loads(path.read_text("utf-8"))}
        for paths in (EXAMPLES, SHORT)
    )
    assert short == every


@each_example
def test_verdicts_on_the_examples_answer_by_the_schema(path: Path, answered: Answers) -> None:
    ANSWERS.validate(answered(path).data("check"))


def _keys_of(data: Any) -> Iterator[str]:  # noqa: ANN401 - JSON
    for value in data.values() if isinstance(data, dict) else data:
        if isinstance(value, dict | list):
            yield from _keys_of(value)
    if isinstance(data, dict):
        yield from data


# The machines' scenes are examples.
@pytest.mark.parametrize(
    "kind", [kind for kind, starter in starters.STARTERS.items() if not starter.machine]
)
def test_starters_answer_by_the_schema(kind: str, tmp_path: Path) -> None:
    starters.write_starter(kind, tmp_path / "scene.toml")
    ANSWERS.validate(answer("run", tmp_path / "scene.toml", "--into", tmp_path))


def test_the_schema_refuses_other_answers(tmp_path: Path) -> None:
    data = answer("run", ROOT / "examples" / "foeppl.toml", "--into", tmp_path)
    for change in (
        {"answer": "walk"},
        {"version": VERSION + 1},
        {"more": 1},
        {"rows": [{**data["rows"][0], "value": 1.0}]},
        {"rows": [{key: v for key, v in data["rows"][0].items() if key != "joint"}]},
        {"rows": [{**data["rows"][0], "statistic": "worst"}]},
    ):
        assert not ANSWERS.is_valid({**data, **change})


def test_quantities_are_one_row_each_however_many_shafts(tmp_path: Path) -> None:
    """The keys of a row do not depend on how many shafts there are."""
    text = (
        "[driveline]\nbends_deg = [10, 20]\n[load]\nspeed_rpm = 60\ndrive_torque_Nm = 5\n[output]\n"
    )
    shapes = []
    for shafts in ("", "shafts = [2]", "shafts = [0, 1, 2]"):
        (tmp_path / "scene.toml").write_text(f"{text}{shafts}")
        rows = answer("run", tmp_path / "scene.toml")["rows"]
        last = [row for row in rows if row.get("shaft") == 2]
        shapes.append([(row["quantity"], row["statistic"], row["of"], {*row}) for row in last])
    assert shapes[0] == shapes[1] == shapes[2]
    assert len(shapes[0]) == 10

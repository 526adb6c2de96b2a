"""Fuzz what commands answer to scenes: ``python fuzz/answers.py [seconds]`` (atheris).

A scene is an example, perhaps with a section of another one, of which some values are replaced or
left out. Every command gives an answer that is JSON, or is refused in one line with exit status 2.
"""

from __future__ import annotations

import copy
import json
import shutil
import tempfile
import tomllib
from pathlib import Path
from typing import Any

import atheris

with atheris.instrument_imports(include=["cardan"]):
    from cardan.command import commands

from cases import main
from click.testing import CliRunner

COMMANDS = ["check", "phase", "optimise", "tolerances", "life", "torsion", "run"]
ROOT = Path(__file__).parent.parent
EXAMPLES = ROOT / "examples"
MACHINES = ROOT / "python" / "cardan" / "scene" / "machines"
FOLDER = Path(tempfile.mkdtemp())
# Studies and searches as short as they are still something.
SHORT = {"steps": 3, "samples": 50, "samples_per_turn": 36, "starts": 1, "turns": 1}
NUMBERS = [0, -1, 1, 0.5, 1e-9, 89.999, 90, 1e300, float("nan"), float("inf"), 7]
OTHERS = ["", "free", True, [], {}, [[1, 2], [3]], "rest"]


def scenes() -> list[dict[str, Any]]:
    """Return the examples as tables, with everything that takes long made short."""
    for path in EXAMPLES.glob("*.csv"):
        shutil.copy(path, FOLDER)
    paths = [*EXAMPLES.glob("*.toml"), *MACHINES.glob("*.toml")]
    return [tomllib.loads(path.read_text()) | {"output": {}} for path in sorted(paths)]


SCENES = scenes()
KEYS = sorted(
    {key for scene in SCENES for part in scene.values() if isinstance(part, dict) for key in part}
)


def case(data: bytes) -> None:
    """Ask one command about one scene."""
    given = atheris.FuzzedDataProvider(data)
    scene = copy.deepcopy(given.PickValueInList(SCENES))
    for _ in range(given.ConsumeIntInRange(0, 2)):
        other = given.PickValueInList(SCENES)
        name = given.PickValueInList(sorted(other))
        scene[name] = copy.deepcopy(other[name])
    for _ in range(given.ConsumeIntInRange(0, 3)):
        change(scene, given)
    shorten(scene)
    path = FOLDER / "scene.toml"
    text = "".join(section(name, part) for name, part in scene.items())
    path.write_text(text)
    command = given.PickValueInList(COMMANDS)
    options = {"run": ["--into", str(FOLDER)], "optimise": ["--to", str(FOLDER / "best.toml")]}
    arguments = [command, str(path), "--json", *options.get(command, [])]
    found = CliRunner().invoke(commands(), arguments)
    if found.exception is not None and not isinstance(found.exception, SystemExit):
        raise AssertionError(f"{arguments}\n{text}") from found.exception
    if found.exit_code == 2:
        assert not found.stdout, (text, found.stdout)
        assert found.stderr.startswith("cardan: "), (text, found.stderr)
        assert found.stderr.count("\n") == 1, (text, found.stderr)
        return
    assert found.exit_code in (0, 1), (found.exit_code, text)
    json.loads(found.stdout, parse_constant=_refuse)


def _refuse(constant: str) -> None:
    raise AssertionError(f"{constant} is not JSON")


def change(scene: dict[str, Any], given: atheris.FuzzedDataProvider) -> None:
    """Replace, add or leave out one value somewhere."""
    at: Any = scene
    while isinstance(at, dict | list) and at:
        keys = sorted(at) if isinstance(at, dict) else range(len(at))
        key = given.PickValueInList(list(keys))
        deeper = isinstance(at[key], dict | list) and at[key]
        if deeper and given.ConsumeIntInRange(0, 5):
            at = at[key]
            continue
        what = given.ConsumeIntInRange(0, 5)
        if what == 0:
            del at[key]
        elif what == 1:
            at[key] = copy.deepcopy(given.PickValueInList(OTHERS))
        elif what == 2 and isinstance(at, dict):
            new = copy.deepcopy(given.PickValueInList([*NUMBERS, *OTHERS]))
            at[given.PickValueInList(KEYS)] = new
        elif what == 3 and isinstance(at[key], int | float):
            at[key] = at[key] * given.ConsumeIntInRange(-20, 40) / 10
        else:
            at[key] = given.PickValueInList(NUMBERS)
        return


def shorten(table: Any) -> None:  # noqa: ANN401
    """Make numbers of steps and samples small, wherever they are."""
    parts = table.values() if isinstance(table, dict) else table
    for key, short in SHORT.items():
        if isinstance(table, dict) and isinstance(table.get(key), int | float):
            table[key] = min(table[key], short)
    for part in parts:
        if isinstance(part, dict | list):
            shorten(part)


def section(name: str, part: Any) -> str:  # noqa: ANN401
    """Return a section, or a key of the top level, as TOML."""
    return f"{json.dumps(name)} = {toml(part)}\n"


def toml(value: Any) -> str:  # noqa: ANN401
    """Return a value as TOML: tables and lists on one line."""
    if isinstance(value, dict):
        return "{" + ", ".join(f"{json.dumps(k)} = {toml(v)}" for k, v in value.items()) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(map(toml, value)) + "]"
    if isinstance(value, float):
        return repr(value)
    return json.dumps(value)


if __name__ == "__main__":
    main("answers", case, longest=300)

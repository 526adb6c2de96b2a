"""Advice: single changes after which a check finds everything within its limits."""

from __future__ import annotations

import json
import tomllib
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner

from cardan.app.answers.answer import Answer
from cardan.app.answers.table import PARTS
from cardan.app.command import commands
from cardan.app.scene import Scene, load_scene
from example_scenes import example
from scene_values import as_toml


def checked(scene: dict[str, Any], path: Path) -> dict[str, Any]:
    path.write_text("\n".join(f"{name} = {as_toml(keys)}" for name, keys in scene.items()))
    result = CliRunner().invoke(commands(), ["check", str(path), "--json"])
    found: dict[str, Any] = json.loads(result.stdout)
    return found


def moved(scene: dict[str, Any], move: dict[str, Any], share: float) -> dict[str, Any]:
    """The scene after a share of a move of a point, in the drawing and in all states."""
    number, axis = move["number"], "xyz".index(move["axis"])
    points = [list(point) for point in scene["driveline"]["points_mm"]]
    points[number][axis] += share * move["shift_mm"]
    changed = {**scene, "driveline": {**scene["driveline"], "points_mm": points}}
    states = json.loads(json.dumps(scene.get("states", {})))
    nested = states.get("points_mm", {}).get(str(number), {})
    for held, key in ((nested, move["axis"]), (states, f"points_mm.{number}.{move['axis']}")):
        if key in held:
            held[key] = (np.array(held[key]) + share * move["shift_mm"]).tolist()
    if states:
        changed["states"] = states
    return changed


@pytest.mark.parametrize("name", ["bearings", "ride_heights", "truck_heights", "truck_torsion"])
def test_a_check_after_a_move_finds_what_it_says(name: str, tmp_path: Path) -> None:
    """A hundredth less does not suffice, so the move is the smallest of its kind."""
    scene = tomllib.loads(example(f"{name}.toml").read_text(encoding="utf-8"))
    scene = {key: scene[key] for key in ("driveline", "load", "limits", "states") if key in scene}
    path = tmp_path / "scene.toml"
    before = checked(scene, path)
    assert before["verdict"] == "beyond"
    moves = [move for move in before["moves"] if move["variable"] == "point"]
    assert moves
    for move in moves:
        assert (move["verdict"], move["untried"]) == ("within", "")
        assert checked(moved(scene, move, 1.0), path)["verdict"] == "within"
        assert checked(moved(scene, move, 0.99), path)["verdict"] != "within"
    sizes = [abs(move["shift_mm"]) for move in moves]
    assert sizes == sorted(sizes)


def test_what_is_within_needs_no_move(tmp_path: Path) -> None:
    data = checked(
        {"driveline": {"points_mm": [[0, 0, 0], [300, 0, 0], [900, 10, 0]]}}, tmp_path / "a"
    )
    assert (data["verdict"], data["moves"], data["advice"]) == ("within", [], [])


def test_a_move_is_said_in_words() -> None:
    answer = Answer(load_scene(example("bearings.toml")))
    first, *_ = PARTS["moves"].sentences(answer["moves"])
    assert first == "Move joint 2 by 12.77 mm along +y: everything is then within its limits."


def test_a_turn_of_a_yoke_is_a_move(tmp_path: Path) -> None:
    """Of two equal bends in one plane a phase of 90 degrees cancels the motion."""
    for teeth, turn in ((None, 60.0), (24, 60.0)):
        driveline = {"bends_deg": [20, 20], "phases_deg": 30} | ({"teeth": teeth} if teeth else {})
        data = checked({"driveline": driveline}, tmp_path / "a.toml")
        (move,) = (move for move in data["moves"] if move["variable"] == "phase")
        assert move["verdict"] == "within"
        assert abs(move["turn_deg"]) <= turn + 1e-9
        after = {"driveline": driveline | {"phases_deg": 30 + move["turn_deg"]}}
        assert checked(after, tmp_path / "a.toml")["verdict"] == "within"


def test_recorded_runs_have_no_moves() -> None:
    assert Answer(Scene.load(example("recorded_run.toml")))["moves"] == ()

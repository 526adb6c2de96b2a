"""Advice: single changes after which a check finds everything within its limits."""

from __future__ import annotations

import json
import re
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


COLUMN: dict[str, Any] = {
    "driveline": {"points_mm": [[0, 0, 0], [550, 0, -280], [780, 90, -520], [900, 100, -600]]},
    "steering": {"centre_deg": 10, "offset_deg": 6},
    "limits": {"equivalent_bend_deg": 30},
    "states": {"names": ["high", "low"], "points_mm.0.z": [30, -30]},
}
LOOSE: dict[str, Any] = {
    "driveline": {"points_mm": [[0, 0, 0], [300, 0, 0], [900, 300, 0], [1200, 500, 0]]},
    "joints": {"arm_mm": 30, "play_mm": 0.02},
    "limits": {"equivalent_bend_deg": 60, "lash_deg": 0.32},
}


def of_example(name: str) -> dict[str, Any]:
    scene = tomllib.loads(example(f"{name}.toml").read_text(encoding="utf-8"))
    return {key: scene[key] for key in ("driveline", "load", "limits", "states") if key in scene}


@pytest.mark.parametrize(
    "scene",
    [
        *(of_example(f) for f in ("bearings", "ride_heights", "truck_heights", "truck_torsion")),
        COLUMN,
        LOOSE,
    ],
    ids=["bearings", "ride_heights", "truck_heights", "truck_torsion", "steering", "lash"],
)
def test_a_check_after_a_move_finds_what_it_says(scene: dict[str, Any], tmp_path: Path) -> None:
    """A hundredth less does not suffice, so the move is the smallest of its kind.

    In words it is rounded so that it suffices as well.
    """
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
    said = re.findall(
        r"Move \D*\d* by ([\d.]+) mm along [+\N{MINUS SIGN}]([xyz])", " ".join(before["advice"])
    )
    assert said
    for move, (by, axis) in zip(moves, said, strict=False):
        assert move["axis"] == axis
        share = float(by) / abs(move["shift_mm"])
        assert 1.0 <= share < 1.1
        assert checked(moved(scene, move, share), path)["verdict"] == "within"


def test_what_is_within_needs_no_move(tmp_path: Path) -> None:
    data = checked(
        {"driveline": {"points_mm": [[0, 0, 0], [300, 0, 0], [900, 10, 0]]}}, tmp_path / "a"
    )
    assert (data["verdict"], data["moves"], data["advice"]) == ("within", [], [])


def test_a_move_is_said_in_words() -> None:
    answer = Answer(load_scene(example("bearings.toml")))
    first, *_ = PARTS["moves"].sentences(answer["moves"])
    assert first == "Move joint 2 by 12.8 mm along +y: everything is then within its limits."


def test_a_turn_of_a_yoke_is_a_move(tmp_path: Path) -> None:
    """Of two equal bends in one plane a phase of 90 degrees cancels the motion."""
    for bend, teeth, turn in ((20, None, 60.0), (20, 24, 60.0), (20.1, None, 60.0)):
        driveline = {"bends_deg": [20, bend], "phases_deg": 30} | (
            {"teeth": teeth} if teeth else {}
        )
        data = checked({"driveline": driveline}, tmp_path / "a.toml")
        (move,) = (move for move in data["moves"] if move["variable"] == "phase")
        assert move["verdict"] == "within"
        assert abs(move["turn_deg"]) <= turn + 1e-9
        (said,) = re.findall(r"shaft 1 by (?:\d+ teeth \()?([\d.]+)°", data["advice"][0])
        assert float(said) == pytest.approx(abs(move["turn_deg"]), abs=0.1)
        for size in (abs(move["turn_deg"]), float(said)):
            turned = np.copysign(size, move["turn_deg"])
            after = {"driveline": driveline | {"phases_deg": 30 + turned}}
            assert checked(after, tmp_path / "a.toml")["verdict"] == "within"


def test_recorded_runs_have_no_moves() -> None:
    assert Answer(Scene.load(example("recorded_run.toml")))["moves"] == ()


def test_what_the_search_leaves_out_is_named() -> None:
    """Heat is judged as the mean over the duty cycle, which no change is tried for."""
    text = """[driveline]
    points_mm = [[0, 0, 0], [300, 0, 0], [900, 200, 0], [1200, 230, 0]]
    [load]
    output_torque_Nm = 500
    speed_rpm = 1500
    [joints]
    friction = 0.05
    pin_radius_mm = 10
    arm_mm = 30
    heat_W = 1
    [limits]
    bend_difference_deg = 0.1
    """
    moves = Answer(Scene.parse(text))["moves"]
    assert moves
    assert {move.untried for move in moves} == {"heat of joint 0, heat of joint 1"}

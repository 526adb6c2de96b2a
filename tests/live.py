"""The moving page for tests: what it is sent, its model in Node, and what a check says."""

from __future__ import annotations

import json
import math
import re
import shutil
import subprocess
import tomllib
from collections.abc import Callable, Iterator
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cardan.app.answers.answer import Answer
from cardan.app.answers.printed import row_text
from cardan.app.report.live import live
from cardan.app.scene import Scene
from cardan.app.scene.changes import given
from cardan.app.scene.machine import machine_data
from example_scenes import example
from pages import (
    REQUIRED,
)

WEB = Path(str(resources.files("cardan"))) / "web"


NODE = shutil.which("node")


TRUCK = example("truck-shaft.toml")


in_node = pytest.mark.skipif(NODE is None and not REQUIRED, reason="needs Node")


def sent(scene: Scene) -> dict[str, Any]:
    """What the page of a scene is sent, as it reads it."""
    found = live(Answer(scene))
    assert found is not None
    data: dict[str, Any] = json.loads(json.dumps(found["data"], allow_nan=False))
    return data


@cache
def truck_sent() -> dict[str, Any]:
    return sent(Scene.load(TRUCK))


NODE_READS = f"""
import {{ readFileSync }} from "node:fs";
import {{ createInterface }} from "node:readline";
import {{ Cardan }} from "{WEB}/cardan.js";
import {{ lateralOf }} from "{WEB}/page/lateral.js";
import {{ Model }} from "{WEB}/page/model.js";
import {{ numberText, showIn, useText }} from "{WEB}/page/numbers.js";
const cardan = await Cardan.load(readFileSync("{WEB}/cardan.wasm.gz"));
const known = {{ cardan, lateralOf, Model, numberText, showIn, useText }};
for await (const line of createInterface({{ input: process.stdin }})) {{
    const [data, script] = JSON.parse(line);
    let told;
    try {{
        const found = new Function("data", ...Object.keys(known), script);
        told = [found(data, ...Object.values(known)), ""];
    }} catch (error) {{ told = [null, error.stack]; }}
    console.log(JSON.stringify(told));
}}"""


Run = Callable[[Any, str], Any]
"""What a script in Node returns that has the modules and the data."""


def scripts() -> Iterator[Run]:
    """One process for all scripts: that it starts takes longer than most of them."""
    assert NODE, "needs Node"
    pipe, command = subprocess.PIPE, [NODE, "--input-type=module", "--eval", NODE_READS]
    with subprocess.Popen(command, stdin=pipe, stdout=pipe, text=True, encoding="utf-8") as process:
        into, out = process.stdin, process.stdout
        assert into
        assert out

        def found(data: Any, script: str) -> Any:  # noqa: ANN401
            into.write(json.dumps([data, script]) + "\n")
            into.flush()
            answer, fault = json.loads(out.readline())
            assert not fault, fault
            return answer

        yield found
        into.close()


def close(a: float, b: float) -> bool:
    return math.isclose(a, b, rel_tol=1e-12, abs_tol=1e-15)


def edited(path: Path, point: int, by: tuple[float, float, float]) -> Scene:
    """A scene with a point of its driveline moved that no state moves."""
    text = path.read_text(encoding="utf-8")
    given = tomllib.loads(text)["driveline"]["points_mm"][point]
    old = f"[{', '.join(str(x) for x in given)}]"
    new = f"[{', '.join(str(x + d) for x, d in zip(given, by, strict=True))}]"
    assert text.count(old) == 1
    return Scene.parse(text.replace(old, new), path.name)


READ = """const rows = Object.fromEntries(model.rows().map((row) => [row.path, row]));
    const told = { rows, verdict: model.verdict(model.rows()), states: model.stateVerdicts() };"""


Move = tuple[str, int, list[float]]
"""What is changed, its number, and by how much: of a load to which share."""


def moves_of(scene: Scene, random: np.random.Generator) -> list[Move]:
    """Some random changes of a scene."""
    data = machine_data(scene)
    assert data
    of = given(scene)
    kinds: list[tuple[str, int]] = [("phase", data["joints"] - 1), ("bearing", len(of["bearings"]))]
    if of["points"]:
        kinds.append(("point", data["joints"] + 2))
    kinds += [(name, 1) for name in ("torque", "speed") if of[name]]
    sizes = {"point": 20.0, "bearing": 5.0, "phase": 90.0, "torque": 0.3, "speed": 0.3}
    found = []
    for _ in range(int(random.integers(1, 4))):
        name, count = kinds[random.integers(len(kinds))]
        by = sizes[name] * random.uniform(-1.0, 1.0, 3)
        found += [(name, int(random.integers(count)), by.round(1).tolist())] if count else []
    return found


CHANGE = """(model, [name, item, by]) => {
    model.begin();
    const point = model.points(model.state)[item];
    if (name === "point") model.place(item, point.map((x, i) => x + by[i]));
    if (name === "phase") model.turn(model.phases.map((x, i) => (i === item ? x + by[0] : null)));
    if (name === "bearing") model.slide(item, 1e3 * model.part("positions", item) + by[0]);
    const load = Math.round(model.loadOf(name) * (1 + by[0]));
    if (name === "torque" || name === "speed") model.load(name, load);
    model.commit(name);
}"""


def without_slow_parts(text: str, parts: str = "tolerances|torsion|optimise") -> str:
    """A scene without what its page does not compute."""
    return re.sub(rf"(?ms)^\[\[?({parts})[].].*?(?=^\[|\Z)", "", text)


def told_after(node: Run, scene: Scene, moves: list[list[Move]]) -> Any:  # noqa: ANN401
    """What the page of a scene says after moves, and the scene that it saves."""
    return node(
        {"sent": sent(scene), "moves": moves},
        f"""const change = {CHANGE};
        return data.moves.map((moves) => {{
            const model = new Model(cardan, data.sent);
            for (const move of moves) change(model, move);
            model.compute();
            {READ}
            const again = new Model(cardan, data.sent);
            again.read(model.address);
            const {{ text, refused }} = model;
            return {{ ...told, text, refused, same: again.text === text, moved: !model.isDrawn }};
        }});""",
    )


def at(data: Any, path: str) -> Any:  # noqa: ANN401
    """What a path names in JSON: ``check:tubes[shaft=1].margin.value``."""
    for name, key, value in re.findall(r"\.?(\w+)|\[(?:([^=\]]+)=)?([^\]]*)\]", path[6:]):
        if name:
            data = data[name]
        elif key:
            (data,) = [each for each in data if str(each[key]) == value]
        else:
            data = data[int(value)]
    return data


def texts(answer: Answer) -> dict[str, str]:
    """What Python writes of each judged figure, by its path without the item's name."""
    return {
        each.entry.path: row_text(each.value, each.entry.row)
        for each in answer.judged
        if each.value.value is not None
    }

"""The live part of a page, its model in Node and the page in Chromium, against the package."""

from __future__ import annotations

import base64
import hashlib
import json
import math
import re
import shutil
import subprocess
import time
import tomllib
from collections.abc import Callable, Iterator
from functools import cache
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from selenium import webdriver
from selenium.webdriver.common.action_chains import ActionChains
from selenium.webdriver.common.by import By
from selenium.webdriver.common.keys import Keys
from selenium.webdriver.remote.webelement import WebElement
from selenium.webdriver.support.wait import WebDriverWait

import cardan
import tiers
from cardan import Coupling, __version__
from cardan.app.answers.answer import Answer
from cardan.app.answers.printed import number_text, quantity, row_text, use_text
from cardan.app.answers.rows import DIGITS
from cardan.app.answers.schema import check_data
from cardan.app.report import write_report
from cardan.app.report.live import coupling_data, live
from cardan.app.report.moving import moving_page
from cardan.app.scene import Scene
from cardan.app.scene.changes import given
from cardan.app.scene.machine import machine_data
from cardan.app.scene.sections.torsion import TorsionCase
from cardan.arrays import FloatArray
from cardan.design.machine import KINDS
from example_scenes import DRIVELINES, Answers, each_driveline, example
from pages import (
    REQUIRED,
    Drawn,
    chart_in,
    figures,
    handle,
    in_browser,
    js,
    opened,
    place_of,
    screen,
    settled,
    verdict_of,
)

WEB = Path(str(resources.files("cardan"))) / "web"
NODE = shutil.which("node")
MACHINES = [path.stem for path in DRIVELINES if path.parent.name == "machines"]
TRUCK = example("truck-shaft.toml")
# With states and a duty cycle, with tolerances beyond a limit, with a steering column.
SHORT = ("truck-shaft", "test-rig", "steering-column")

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


@pytest.fixture(scope="module")
def run() -> Iterator[Run]:
    """One process for all scripts: that it starts takes longer than most of them."""
    assert NODE, "needs Node"
    pipe, command = subprocess.PIPE, [NODE, "--input-type=module", "--eval", NODE_READS]
    with subprocess.Popen(command, stdin=pipe, stdout=pipe, text=True, encoding="utf-8") as node:
        into, out = node.stdin, node.stdout
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


# --- what Python sends ------------------------------------------------------------------------


def test_every_kind_of_figure_is_declared_by_a_row() -> None:
    """Names, units and digits are those of the answers: the units of both sides agree."""
    symbols = {"rad": "°", "rad/s²": "rad/s²", "rad²/s": "rpm·deg", "m": "mm", "Pa": "MPa"}
    kinds = truck_sent()["kinds"]
    assert set(kinds) == {*KINDS, "resonance"}
    for name, kind in KINDS.items():
        own = symbols.get(kind.unit, "" if kind.unit == "1" else kind.unit)
        expected = "%" if name == "steering_ratio" else own
        assert kinds[name]["unit"] == expected, name


@each_driveline
def test_every_scene_can_be_sent(path: Path) -> None:
    """Every figure that the core judges has its name, and no other is left out."""
    found = live(Answer(scene := Scene.load(path)))
    if found is None:
        return
    json.dumps(found["data"], allow_nan=False)
    limited = [each for each in Answer(scene).judged if each.value.limit is not None]
    assert len(found["data"]["figures"]) + len(found["data"]["others"]) == len(limited)


# --- the model --------------------------------------------------------------------------------


@in_node
def test_numbers_are_written_as_in_python(run: Run) -> None:
    random = np.random.default_rng(3)
    cases: list[tuple[float, str, list[float]]] = [
        (value, kind, [])
        for kind in DIGITS
        if kind != "given"
        for value in (0.0, 1.0, 99.96, 100.04, 9.9996, -0.00004, 1e-20, 3.2e9, 2.9999999, -12.3456)
    ]
    cases += [(3.0 + step, "deg", [3.0]) for step in (1e-3, -1e-4, 1e-8, 1e-10, -1e-12, 0.0)]
    # Finer than what is shown of the kind; so may be its limit.
    cases += [(1e-4 * step, "twist", [1e-4]) for step in (0.0, 0.9, 1.0, 1.0 + 1e-7, 1.1, -2.0)]
    cases += [
        (float(random.normal() * 10.0 ** random.integers(-8, 9)), kind, [float(random.normal())])
        for kind in ("deg", "mm", "N", "MPa", "h", "margin", "percent")
        for _ in range(40)
    ]
    data = [(value, DIGITS[kind]._asdict(), bounds) for value, kind, bounds in cases]
    shares = [0.5, 0.994, 0.999999, 1.0, 1.0 + 1e-12, 1.00001, 1.444, 9.994, 9.996, 1e9]
    found = run(
        {"cases": data, "shares": shares},
        """const written = (each) => numberText(...each);
        return [data.cases.map(written), data.shares.map(useText)];""",
    )
    expected = [
        number_text(value, kind, apart_from=bounds).replace("e-", "e~").replace("-", "\u2212")
        for value, kind, bounds in cases
    ]
    # An exponent has two digits in Python and one in JavaScript.
    plain = [re.sub(r"e([~+])0?", r"e\1", text).replace("e~", "e-") for text in expected]
    assert found[0] == plain
    # How far beyond is of no use to a reader.
    assert found[1] == [*map(use_text, shares[:-2]), "> 999%", "> 999%"]


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


def told_after(run: Run, scene: Scene, moves: list[list[Move]]) -> Any:  # noqa: ANN401
    """What the page of a scene says after moves, and the scene that it saves."""
    return run(
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


@in_node
@each_driveline
def test_what_a_changed_page_says_is_the_check_of_what_it_saves(path: Path, run: Run) -> None:
    """To the last bit, but for torques; the address carries the same, and all else stands."""
    text = without_slow_parts(path.read_text(encoding="utf-8"))
    scene = Scene.parse(text, path.name, path.parent)
    if machine_data(scene) is None:
        return
    random = np.random.default_rng(len(path.stem))
    moves = [moves_of(scene, random) for _ in range(20 if tiers.whole else 3)]
    for each, told in zip(moves, told_after(run, scene, moves), strict=True):
        assert told["same"]
        assert told["refused"] == ""
        saved = Scene.parse(told["text"], path.name, path.parent)
        assert (told["text"] != text) == told["moved"]
        data = check_data(Answer(saved))
        for key, row in told["rows"].items():
            # Largest torques are found in closed form here and by a search over the turn there.
            rounding = 1e-14 if "stress" in key or "spline.force" in key else 0.0
            assert row["value"] == pytest.approx(at(data, key), rel=rounding, abs=0.0), (key, each)
        assert told["verdict"] == worst(told["rows"].values(), data)
        # Points that states set together have a line each where one of them moves, and phases that
        # the scene does not give have a line where one is turned.
        if ".2-3." not in text and "phases_deg" in text:
            assert without_numbers(told["text"]) == without_numbers(text)


def without_numbers(text: str) -> str:
    return re.sub(r"[-+]?\d[\d.]*", "0", text)


FORMS = """
[driveline]
points_m = [[0, 0, 0], [0.3, 0, 0], [1.5, -6e-2, 0], [3, -0.22, 0], [3.25, -0.21, 0]]  # as built
teeth = 36
[load]
speed_rad_s = 1_50.0
[states]
points_m.3-4.y = {from = -0.2, to = -0.1, steps = 3}
points_m.2.y.add = [0, 0.01, 0.02]
[[bearing]]
shaft = 1
from_end_mm = 50 # centre
[limits]
equivalent_bend_deg = 3
"""


@in_node
def test_changes_are_written_in_every_form_of_a_scene(run: Run) -> None:
    """Unlisted phases, points that states set together, in metres, added to or evenly spread."""
    scene = Scene.parse(FORMS)
    moves: list[list[Move]] = [
        [("point", 2, [0.0, 12.5, 0.0])],
        [("phase", 1, [7.0, 0.0, 0.0])],
        [("bearing", 0, [3.0, 0.0, 0.0]), ("speed", 0, [-0.2, 0.0, 0.0])],
    ]
    texts = [told["text"] for told in told_after(run, scene, moves)]
    assert texts[0] == FORMS.replace("-6e-2", "-0.0475")
    assert texts[1] == FORMS.replace("teeth = 36", "teeth = 36\nphases_deg = [0, 7]")
    assert texts[2] == FORMS.replace("= 50 #", "= 47 #").replace("1_50.0", "120")
    script = """const model = new Model(cardan, data);
    model.begin();
    model.place(4, model.points(model.state)[4].map((x, i) => x + [0, 5, 0][i]));
    return model.text;"""
    text = run(sent(scene), script)
    assert "points_m.3.y = {from = -0.2, to = -0.1, steps = 3}\n" in text
    assert "points_m.4.y = {from = -0.195, to = -0.095, steps = 3}\n" in text
    found = Scene.parse(text)
    assert found.states
    for state in range(3):
        at_state = found.states.points(state)
        assert at_state is not None
        np.testing.assert_allclose(at_state[4, 1], [-0.195, -0.145, -0.095][state], atol=1e-15)


@in_node
def test_what_a_scene_has_no_place_for_is_not_saved(run: Run) -> None:
    """An inline section takes no further line; a file without the change would be a lie."""
    scene = Scene.parse("driveline = {bends_deg = [5, 4]}\n[limits]\nequivalent_bend_deg = 3\n")
    script = """const model = new Model(cardan, data);
    model.begin();
    model.turn([9]);
    try { return model.text; } catch (error) { return error.message; }"""
    found = run(sent(scene), script)
    assert found == "The scene has no number for this: phase of shaft 1 +9.0\u00b0."


TURNED = """
[driveline]
points_mm = [[0, 0, 0], [300, 0, 0], [1500, -60, 0], [3000, -220, 0], [3250, -210, 0]]
[states]
points_mm.3-4 = {turn_deg = [-3, 0, 4], about_mm = [1600, 0, 100], axis = [0.1, 0.2, 1]}
[limits]
equivalent_bend_deg = 3
"""


@in_node
def test_a_point_that_states_turn_is_moved_as_they_turn_it(run: Run) -> None:
    """What is dragged in a state is what moves there, and the check of the text agrees."""
    scene = Scene.parse(TURNED)
    turned = sorted(given(scene)["turned"])
    assert turned == [3, 4]
    script = f"""return [0, data.states.length - 1].map((state) => {{
        const model = new Model(cardan, data);
        model.state = state;
        const to = model.points(state)[{turned[0]}].map((x, i) => x + [0, 8, -3][i]);
        model.begin();
        model.place({turned[0]}, to);
        return [to, model.text];
    }});"""
    for state, (to, text) in zip((0, -1), run(sent(scene), script), strict=True):
        found = Scene.parse(text)
        assert found.states
        points = found.states.points(state % found.states.count)
        assert points is not None
        np.testing.assert_allclose(points[turned[0]], to, atol=1e-8)


@in_node
def test_malformed_addresses_change_nothing(run: Run) -> None:
    """A sentence says why, and what was changed before stays."""
    random = np.random.default_rng(5)
    good = "point.2.y=-24&phase.1=5&torque.0=1600&state=rest"
    bad = ["point.9.y=1", "point.2.w=1", "point.2=1", "phase.0=1", "bearing.9=1", "state=no", "x"]
    bad += [
        "point.2.y=",
        "point.2.y=1e",
        "phase.1=NaN",
        "speed.0=Infinity",
        "rating.3=1",
        "%",
        "=&=",
    ]
    bad += ["torque.0=1e9", "speed.0=-100001", "rating.0=1e8", "bearing.0=1e7", "point.2.y=2e6"]
    bad += ["point.1.x=1300&point.1.y=-22", "point.2.x=1e300", "bearing.0=1e6", "rating.0=-1"]
    bad += ["__proto__=1", "point.__proto__.y=1", "constructor=2"]
    while len(bad) < (200 if tiers.whole else 30):
        place, letters = int(random.integers(len(good))), "&=.#%xyz019-eN\u00e4\u2028"
        letter = letters[random.integers(len(letters))]
        bad.append(good[:place] + letter + good[place + int(random.integers(3)) :])
    script = """const model = new Model(cardan, data.sent);
    model.read(data.good);
    const [before, refused] = [model.text, model.refused];
    return [refused, data.bad.map((address) => {
        model.read(address);
        model.compute();
        const same = model.text === before;
        const told = [model.refused, same, model.address];
        model.read(data.good);
        return told;
    })];"""
    data = {"sent": truck_sent(), "good": good, "bad": bad}
    refused, found = run(data, script)
    assert refused == ""
    assert sum(bool(words) for words, *_ in found) > len(bad) // 3
    for address, (words, same, then) in zip(bad, found, strict=True):
        assert bool(words) == same or not words, (address, words, then)
    for (words, same, _), address in zip(found[:19], bad, strict=False):
        assert words.startswith("The address cannot be read"), address
        assert same


@in_node
def test_states_have_the_verdict_of_the_check(run: Run) -> None:
    scene = Scene.load(TRUCK)
    moves: list[list[Move]] = [[("point", 2, [0.0, -24.0, 0.0])], [("point", 1, [10.0, 5.0, -7.0])]]
    for told in told_after(run, scene, moves):
        data = check_data(Answer(Scene.parse(without_slow_parts(told["text"]))))
        assert len(told["rows"]) == 13
        lives = [row["place"] for row in told["rows"].values() if "life" in row["path"]]
        assert lives == 3 * ["over the duty cycle"]
        states = [each["verdict"] for each in data["states"]]
        assert [verdict != "within" for verdict in told["states"]] == [
            state != "within" or slides
            for state, slides in zip(states, too_long(data), strict=True)
        ]


def too_long(data: Any) -> list[bool]:  # noqa: ANN401
    return [each["value_mm"] < 70.0 for each in data["spline"]["engaged"]["states"]]


def worst(rows: Any, data: Any) -> str:  # noqa: ANN401
    """The verdict of the check on those figures that are computed in the page."""
    verdicts = {at(data, row["path"].rpartition(".")[0])["verdict"] for row in rows}
    order = ("beyond", "not judged", "tolerable", "within")
    return next(verdict for verdict in order if verdict in verdicts)


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


def compared(rows: Any, data: Any) -> None:  # noqa: ANN401
    """Values, verdicts and places of rows are those of a check."""
    for path, row in rows.items():
        part = at(data, path.rpartition(".")[0])
        assert close(row["value"], at(data, path)), path
        assert row["verdict"] == part["verdict"], path
        if row["place"] and part.get("state"):
            # Of states and steps that are as near to the limit either may be named.
            each = {one["name"]: one["text"] for one in row["each"]}
            assert each[part["state"]] == row["text"], path
            assert any(name in row["place"].replace("\u2212", "-") for name in each), path


PUBLISHED = """
[driveline]
points_mm = [[0, 0, 0], [300, 0, 0], [1300, -60, 0], [1600, -60, 0]]

[limits]
preset = ["spicer", "meritor", "gm"]
"""


@in_node
def test_published_limits_that_hold_at_every_speed_follow(run: Run) -> None:
    """The strictest of each kind has the value and the verdict of the check."""
    moves: list[list[Move]] = [[("point", 1, [0.0, -30.0, 0.0])], [("point", 2, [0.0, 12.0, 4.0])]]
    for told in told_after(run, Scene.parse(PUBLISHED), moves):
        assert told["moved"]
        data = check_data(Answer(Scene.parse(told["text"])))
        compared(told["rows"], data)
        paths = {path for path in told["rows"] if "presets[preset=gm]" in path}
        assert len(paths) == 3
        assert {told["rows"][path]["verdict"] for path in paths} >= {"beyond"}


@in_node
def test_what_is_refused_is_said_in_the_words_of_the_page(run: Run) -> None:
    """Which joint, end or bearing, in which state, breaks which rule; nothing changes."""
    moved = {
        "this joint where the one before is": ("place", 2, [350, -24, 0]),
        "this end where the first joint is": ("place", 0, [350, -24, 0]),
        "by a right angle": ("place", 1, [0, 700, 0]),
        "back": ("place", 2, [-500, None, None]),
        "no number": ("place", 1, ["NaN", None, None]),
        "without end": ("place", 4, [None, "Infinity", None]),
        "a shaft shorter than its bearing needs": ("place", 2, [950, None, None]),
        "off the end": ("bearing.1", 200),
        "before the end": ("bearing.0", -61),
        "on another": ("bearing.0", 200),
        "a bearing nowhere": ("bearing.2", "NaN"),
        "a phase": ("phase.2", "NaN"),
        "a rating": ("rating.1", -5),
        "a torque": ("torque.0", "Infinity"),
    }
    found = run(
        {"sent": truck_sent(), "moved": list(moved.values())},
        """const number = (x) => (typeof x === "string" ? Number(x) : x);
        return data.moved.map(([what, ...of]) => {
            const model = new Model(cardan, data.sent);
            const before = JSON.stringify(model.changes);
            if (what === "place") {
                model.begin(); model.place(of[0], of[1].map(number)); model.commit("place");
            } else model.take({ [what]: number(of[0]) });
            const { refused } = model;
            model.compute();
            return [refused || model.refused, JSON.stringify(model.changes) === before];
        });""",
    )
    assert [each for each in found if not each[1]] == []
    first = "in \u201c\u221280 mm\u201d"
    assert [refused for refused, _ in found] == [
        f"This makes no driveline: {words}."
        for words in (
            f"joint 0 and joint 1 would lie in the same place, {first}",
            f"the upstream end and joint 0 would lie in the same place, {first}",
            f"joint 0 would be bent by 90\u00b0 or more, {first}",
            f"joint 1 would be bent by 90\u00b0 or more, {first}",
            "a coordinate of joint 0 would not be finite",
            "a coordinate of the downstream end would not be finite",
            f"bearing 2 would lie 1150.0 mm along shaft 1, which is 600.4 mm long, {first}",
            f"bearing 1 would lie 460.0 mm along shaft 0, which is 350.8 mm long, {first}",
            f"bearing 0 would lie \u22121.0 mm along shaft 0, which is 350.8 mm long, {first}",
            "bearing 1 would lie where another bearing of shaft 0 is",
            "the place of bearing 2 would not be finite",
            "the phase of shaft 2 would not be finite",
            "the rating of joint 1 would be \u22125 N m; it must be positive",
            "the torque would not be finite",
        )
    ]


@in_node
def test_what_is_known_in_some_states_only_is_not_judged(run: Run) -> None:
    """As in a check; it then makes the verdict, unless something is beyond its limit."""
    found = run(
        truck_sent(),
        """const model = new Model(cardan, data);
        const of = (kind) => model.figures.find((figure) => figure.kind.name === kind);
        const told = () => [model.rows().map((row) => row.verdict), model.verdict(model.rows())];
        of("equivalent_bend").ranks[2] = "not judged";
        const first = told();
        for (const figure of model.figures) {
            figure.ranks = figure.ranks.map((rank) => (rank === "beyond" ? "within" : rank));
        }
        data.others = [];
        return [first, told()];""",
    )
    (first, beyond), (second, last) = found
    assert beyond == "beyond"
    assert first.count("not judged") == second.count("not judged") == 1
    assert last == "not judged"


@in_node
def test_undo_and_redo_are_gestures(run: Run) -> None:
    """A drag is one step, keys in quick succession are one, and what is refused changes nothing."""
    found = run(
        truck_sent(),
        """const model = new Model(cardan, data), told = [];
        const y = () => told.push([model.points(model.state)[2][1], model.canUndo, model.canRedo]);
        const to = (y) => model.place(2, [null, y, null]);
        model.begin(); to(-50); to(-60); to(-70); model.commit("drag"); y();
        for (const time of [1000, 1500, 2300]) {
            model.begin(); to(model.points(model.state)[2][1] - 1); model.commit("key", time);
        }
        y();
        model.begin(); to(-80); model.commit("key", 9000); y();
        model.undo(); y(); model.undo(); y(); model.undo(); y(); model.undo(); y();
        model.redo(); y(); model.redo(); y();
        model.begin(); to(20); model.cancel(); y();
        model.begin(); model.place(2, [-500, null, null]); told.push(model.refused);
        model.commit("drag"); y();
        model.reset(); y(); model.undo(); y();
        return told;""",
    )
    assert found == [
        [-70, True, False],
        [-73, True, False],
        [-80, True, False],
        [-73, True, True],
        [-70, True, True],
        [-46, False, True],
        [-46, False, True],
        [-70, True, True],
        [-73, True, True],
        [-73, True, True],
        found[10],
        [-73, True, True],
        [-46, True, False],
        [-73, True, True],
    ]
    assert re.fullmatch(r"This makes no driveline: joint 1 would be bent by .*\.", found[10])


@in_node
def test_steps_that_can_be_undone_are_not_kept_without_end(run: Run) -> None:
    left = run(
        truck_sent(),
        """const model = new Model(cardan, data);
        for (let i = 1; i <= 600; i++) {
            model.begin(); model.place(2, [null, -46 - i / 100, null]); model.commit("drag");
        }
        let steps = 0;
        for (; model.canUndo; steps++) model.undo();
        return [steps, model.points(model.state)[2][1]];""",
    )
    assert left == [500, -47]


@in_node
@pytest.mark.parametrize("name", tiers.few(MACHINES, SHORT))
def test_what_would_help_does(name: str, run: Run) -> None:
    """Suggestions are those of the check, and each leaves the verdict that it promises."""
    path = example(f"{name}.toml")
    found = run(
        sent(Scene.load(path)),
        """const model = new Model(cardan, data), before = JSON.stringify(model.changes);
        const rounds = model.suggesting();
        let round = rounds.next();
        while (!round.done) round = rounds.next();
        return round.value.map((suggestion) => {
            model.apply(suggestion);
            model.compute();
            const listed = model.listed();
            const told = [suggestion, model.verdict(model.rows())];
            told.push(listed.map(({ words }) => words), model.isDrawn);
            told.push(JSON.stringify(listed[0].without) === before, model.refused);
            model.undo();
            return told;
        });""",
    )
    moves = check_data(Answer(Scene.load(path)))["moves"]
    assert len(found) == len(moves)
    for (suggestion, verdict, listed, *flags), move in zip(found, moves, strict=True):
        assert suggestion["variable"] == move["variable"]
        assert suggestion["item"] == move["number"]
        assert verdict == suggestion["verdict"] == move["verdict"], suggestion
        assert len(listed) == 1
        assert flags == [False, True, ""]
        shift = move["shift_mm"] or move["turn_deg"] or move["rating_Nm"]
        assert abs(suggestion["by"] - shift) < 0.1001
        assert abs(suggestion["by"]) >= abs(shift) - 1e-9


@in_node
def test_phases_are_those_of_the_package(run: Run) -> None:
    """The best setting of the truck's yokes, and what it leaves."""
    found = run(
        truck_sent(),
        f"""const model = new Model(cardan, data);
        model.begin();
        model.turn([10, -25]);
        model.commit("turn");
        model.compute();
        {READ}
        return [told, model.phases, model.bestPhases([])];""",
    )
    text = TRUCK.read_text(encoding="utf-8")
    scene = Scene.parse(text.replace("phases_deg = [0, 0]  ", "phases_deg = [10, -25]"), "a.toml")
    compared(found[0]["rows"], check_data(Answer(scene)))
    assert found[1] == [10, -25]
    states = scene.states
    assert states
    best = scene.drivelines().optimal_phases(states=0, weights=states.weights)
    assert np.allclose(np.tan(np.radians(found[2])), np.tan(best), rtol=1e-9)


WITH_TORSION = [path for path in DRIVELINES if "\n[torsion]" in path.read_text(encoding="utf-8")]


@pytest.fixture
def unsearched(monkeypatch: pytest.MonkeyPatch) -> None:
    """No search for motions over the speeds, which pages leave out."""
    monkeypatch.setattr(TorsionCase, "is_searched", False)


def compared_torsion(run: Run, scene: Scene, moves: list[list[Move]]) -> list[tuple[float, ...]]:
    """Natural frequencies after moves, which are those of the check like all that follows."""
    told = run(
        {"sent": sent(scene), "moves": moves},
        f"""const change = {CHANGE};
        return data.moves.map((moves) => {{
            const model = new Model(cardan, data.sent);
            for (const move of moves) change(model, move);
            model.compute(false);
            const row = model.rows().find((row) => row.key === "resonance ");
            return [model.torsion, row, model.text, model.refused];
        }});""",
    )
    for torsion, row, saved, refused in told:
        assert refused == ""
        answer = Answer(Scene.parse(saved, scene.name))
        found = answer["torsion"]
        assert found
        assert torsion["frequencies"] == [mode.frequency for mode in found.modes]
        assert torsion["shafts"] == [mode.shaft for mode in found.modes]
        assert torsion["speeds"] == [each.speed for each in found.critical_speeds]
        inside = [each.inside for each in found.critical_speeds]
        assert [away == 0.0 for away in torsion["away"]] == inside
        assert torsion["away"][torsion["nearest"]] == found.margin.value
        assert torsion["rank"] == row["verdict"] == found.margin.verdict
        assert row["value"] == 100.0 * found.margin.value
        away = [abs(torsion["at"] - speed) / speed for speed in torsion["speeds"]]
        if torsion["at"]:
            excited = [each.is_excited for each in found.critical_speeds]
            assert torsion["away_now"] == pytest.approx(away, rel=1e-15)
            assert away[torsion["nearest_now"]] == min(np.array(away)[excited])
    return [tuple(torsion["frequencies"]) for torsion, *_ in told]


@in_node
@pytest.mark.usefixtures("unsearched")
@pytest.mark.parametrize("path", WITH_TORSION, ids=lambda path: path.stem)
def test_critical_speeds_are_those_of_the_check_of_what_is_saved(path: Path, run: Run) -> None:
    """As sent and after moves: all bits, which one is nearest to the speeds, and its verdict."""
    text = path.read_text(encoding="utf-8")
    text = without_slow_parts(text, "tolerances|optimise|life|output")
    text = text.replace("\n[torsion]\n", "\n[torsion]\nresonance_margin = 0.15\n", 1)
    scene = Scene.parse(text, path.name, path.parent)
    random = np.random.default_rng(len(path.stem))
    joint: list[Move] = [("point", 1, [0.0, 17.0, -6.0])] if given(scene)["points"] else []
    moves: list[list[Move]] = [[], joint]
    moves += [moves_of(scene, random) for _ in range(12 if tiers.whole else 3)]
    found = compared_torsion(run, scene, moves)
    assert (found[0] != found[1]) == bool(joint)


LOADED = """
[driveline]
points_mm = [[0, 0, 0], [300, 0, 0], [700, 60, 0], [1100, 60, 50], [1500, 0, 50]]
[load]
speed_rpm = 1200
output_torque_Nm = 90
[tubes]
shafts = [3]
outer_diameter_mm = 60
[torsion]
drive = "free"
inertias_kgm2 = [0.5, 0.2, 0.3, [0.1, 0.4]]
stiffnesses_Nm_per_rad = ["coupling", "rigid", "rigid", "tube"]
damping_ratio = 0.02
speed_rpm = {from = 700, to = 1500, steps = 3}
orders = [1, 2]
resonance_margin = 0.2
[[torsion.coupling]]
shaft = 0
mean_torque_Nm = [0, 100, 200]
stiffness_by_mean_Nm_per_rad = [900, 1500, 4000]
"""


@in_node
@pytest.mark.usefixtures("unsearched")
def test_natural_frequencies_follow_yokes_torque_and_the_length_of_a_tube(run: Run) -> None:
    """A coupling by its mean torque, inertias behind two joints, an order that nothing excites."""
    moves: list[list[Move]] = [
        [],
        [("phase", 1, [40.0, 0.0, 0.0])],
        [("torque", 0, [0.7, 0.0, 0.0])],
        [("point", 4, [55.0, 0.0, 0.0])],
        [("speed", 0, [0.4, 0.0, 0.0])],
    ]
    found = compared_torsion(run, Scene.parse(LOADED), moves)
    assert len(set(found)) == 4
    assert found[4] == found[0]


SHAKEN = """
[driveline]
points_mm = [[0, 0, 0], [300, -20, 0], [1500, -90, 40], [3200, -300, 0], [3500, -320, 0]]
phases_deg = [10, 0]
[load]
speed_rpm = 700
output_torque_Nm = 900
inertias_kgm2 = [0, 0, 0, 0.4]
[[bearing]]
shaft = 1
position_mm = 1100
stiffness_N_per_mm = [200, 350]
axis = [0, 1, 0.2]
loss_factor = 0.1
damping_Ns_per_m = 60
[tubes]
outer_diameter_mm = 90
wall_mm = 3
[lateral]
speed_rpm = {from = 400, to = 1800, steps = 5}
[[lateral.mass]]
shaft = 1
from_end_mm = 20
mass_kg = 4
across_kgm2 = 0.01
along_kgm2 = 0.006
[[lateral.mass]]
shaft = 2
position_mm = 900
mass_kg = 2
"""


@in_node
def test_forces_of_elastic_bearings_are_those_of_the_package_of_what_is_saved(run: Run) -> None:
    """After moves of joints, bearings, yokes and load, with inertias and two directions."""
    shudder = Scene.load(next(path for path in DRIVELINES if path.stem == "shudder"))
    moves: list[list[Move]] = [
        [],
        [("point", 2, [15.0, -20.0, 8.0])],
        [("bearing", 0, [-40.0, 0.0, 0.0]), ("phase", 0, [90.0, 0.0, 0.0])],
        [("torque", 0, [0.25, 0.0, 0.0])],
    ]
    for scene in (shudder, Scene.parse(SHAKEN)):
        told = run(
            {"sent": sent(scene), "moves": moves},
            f"""const change = {CHANGE};
            return data.moves.map((moves) => {{
                const model = new Model(cardan, data.sent);
                for (const move of moves) change(model, move);
                return [lateralOf(model.machine, data.sent.lateral, 0), model.text, model.refused];
            }});""",
        )
        peaks = set()
        for found, saved, refused in told:
            assert refused == ""
            scene_now = Scene.parse(saved, scene.name)
            assert scene_now.lateral
            system = scene_now.lateral.on(scene_now.line)
            frequencies = system.natural_frequencies(8)
            speeds = np.array(found["speeds"])
            response = system.response(speeds, scene_now.load_case, orders=[1, 2, 4])
            forces = np.moveaxis(response.of_order("bearing_force"), -1, 0)
            shown = np.array(found["forces"], dtype=np.float64)
            # Near a resonance whose damping is not known there is none.
            known = ~np.isnan(shown)
            assert 0.5 < np.mean(known) < 1.0
            assert np.max(np.abs(forces - shown)[known]) < 1e-9 * np.max(forces[known])
            for resonance in found["resonances"]:
                order = resonance["order"]
                met = frequencies / order
                assert np.min(np.abs(met / resonance["speed"] - 1.0)) < 1e-11
                assert resonance["frequency"] == pytest.approx(order * resonance["speed"])
                own = shown[[1, 2, 4].index(order)]
                near = np.min(np.abs(np.divide.outer(speeds, met) - 1.0), axis=1) < 0.12 + 1e-9
                if resonance["at"] is None:
                    assert not np.any(near & known[[1, 2, 4].index(order)])
                    continue
                assert resonance["force"] == np.nanmax(own[:, near])
                assert resonance["at"] in speeds[np.any(own == resonance["force"], axis=0)]
                assert abs(resonance["at"] / resonance["speed"] - 1.0) < 0.12 + 1e-9
                peaks.add(round(resonance["force"], 6))
            shape, lengths = found["shape"], scene_now.line.lengths().each
            probes = [
                (shaft, x * own) for shaft, own in enumerate(lengths) for x in np.arange(13) / 12
            ]
            swing = system.response(
                shape["of"]["at"], scene_now.load_case, orders=[shape["of"]["order"]], probes=probes
            ).displacement[:, 0]
            told_swing = [
                complex(x, y)
                for p in shape["places"]
                for x, y in zip(p["re"], p["im"], strict=True)
            ]
            assert np.max(np.abs(swing.ravel() - told_swing)) < 1e-9 * np.max(np.abs(swing))
            orders = [each["order"] for each in found["resonances"]]
            assert orders == ([1, 2] if scene is shudder else [2, 4])
        # An unbalance does not follow the torque.
        assert len(peaks) == (7 if scene is shudder else 8)


@in_node
def test_modes_of_free_drives_with_couplings_are_those_of_the_package(run: Run) -> None:
    """With the bits of the package, under torques on either side of the kinks of their curves."""
    random = np.random.default_rng(8)
    laws = [
        Coupling(9000.0, loss_factor=0.1),
        Coupling(12000.0, play=0.01),
        Coupling(twist=[0, 0.02, 0.05], torque=[0, 90, 400]),
        Coupling(mean_torque=[0, 100, 300], stiffness_by_mean=[4000, 6000, 15000]),
    ]
    asked, systems = [], []
    for number in range(40):
        bends = random.uniform(0.05, 0.6, 3)
        line = cardan.Driveline.from_bends(bends, *random.uniform(-1.5, 1.5, (2, 2)))
        own: dict[str, Any] = {
            "inertias": random.uniform(0.01, 2.0, (4, 2)),
            "stiffnesses": [math.inf, 8e3, math.inf, float(random.uniform(1e3, 1e6))],
            "load_torque": float(random.uniform(-400, 400)),
        }
        couplings, free = {0: laws[number % 4]}, number % 3 > 0
        drive: Any = "free" if free else "held"
        systems.append(cardan.TorsionalSystem(line, **own, drive=drive, couplings=couplings))
        rigid = [None if math.isinf(each) else each for each in own["stiffnesses"]]
        own |= {"inertias": own["inertias"].tolist(), "stiffnesses": [1.0, *rigid[1:]]}
        chain = {name: getattr(line, name).tolist() for name in ("bends", "twists", "phases")}
        orders = {"orders": [0.5, 2, 3], "excited": [True, True, False], "range": [10, 20]}
        asked.append(own | chain | coupling_data(couplings) | orders | {"joints": 3, "free": free})
    found = run(
        asked,
        """return data.map((own) => Object.fromEntries(
            Object.entries(cardan.call("torsion", own)).map(([key, x]) => [key, Array.from(x)])
        ));""",
    )
    for system, told in zip(systems, found, strict=True):
        modes = system.modes()
        assert len(modes) == 3
        assert told["frequencies"] == [mode.frequency for mode in modes]
        assert told["shafts"] == [mode.shaft for mode in modes]
        speeds = [mode.frequency / order for order in (0.5, 2.0, 3.0) for mode in modes]
        assert told["speeds"] == speeds
        away = [max(10.0 - speed, speed - 20.0, 0.0) / speed for speed in speeds]
        assert told["away"] == away
        (nearest,) = told["nearest"]
        assert away[int(nearest)] == min(away[:6])


# --- the page ---------------------------------------------------------------------------------


def texts(answer: Answer) -> dict[str, str]:
    """What Python writes of each judged figure, by its path without the item's name."""
    return {
        each.entry.path: row_text(each.value, each.entry.row)
        for each in answer.judged
        if each.value.value is not None
    }


@in_browser
@pytest.mark.parametrize("name", tiers.few(MACHINES, SHORT))
def test_page_shows_what_the_check_says(
    name: str, browser: webdriver.Chrome, answered: Answers, tmp_path: Path
) -> None:
    """Every figure as drawn, its text and the verdict are those of ``cardan check --json``."""
    path = example(f"{name}.toml")
    opened(browser, answered(path).page, tmp_path)
    answer = Answer(Scene.load(path))
    data, written, shown = check_data(answer), texts(answer), figures(browser)
    assert verdict_of(browser) == data["verdict"]
    assert len(shown) >= 2
    for place, value, text in shown:
        expected = at(data, place)
        assert close(value, expected), place
        own = re.sub(r"\[\w+=(.*?)\]", r".\1", place[6:]).rpartition(".value")[0]
        if ending := re.search(r"torsion\..*(_Hz|_rpm|shaft)$", place):
            name = ending[1].strip("_")
            plain = str(expected) if name == "shaft" else f"{number_text(expected, name)} {name}"
            assert text == plain, place
        elif ".states[" in place or place[6:].startswith("states["):
            unit = "deg" if "bends" in place else "N"
            factor = 1.0 if unit == "N" else math.pi / 180.0
            assert text == quantity(factor * expected, unit).replace("-", "\u2212"), place
        else:
            assert text == written[own].replace("-", "\u2212"), place


@in_browser
def test_keys_move_a_joint_and_the_verdict_follows(truck: webdriver.Chrome) -> None:
    """Lowered by 24 mm the truck is within its limits, as the check says of the same points."""
    joint = handle(truck, 2)
    joint.send_keys(Keys.SHIFT + 2 * Keys.ARROW_DOWN + Keys.NULL + 4 * Keys.ARROW_DOWN)
    settled(truck)
    data = check_data(Answer(edited(TRUCK, 2, (0.0, -24.0, 0.0))))
    shown = figures(truck)
    for place, value, _ in shown:
        assert close(value, at(data, place)), place
    assert verdict_of(truck) == "within"
    assert "not computed here" in truck.find_element(By.CSS_SELECTOR, "#live-panel .why").text
    assert joint.get_attribute("aria-valuenow") == "-70"
    # Keys in quick succession are one step.
    truck.find_element(By.ID, "live-undo").click()
    assert verdict_of(truck) == "beyond"
    assert joint.get_attribute("aria-valuenow") == "-46"
    assert truck.find_element(By.ID, "live-undo").get_attribute("disabled")
    truck.find_element(By.ID, "live-redo").click()
    assert verdict_of(truck) == "within"
    truck.find_element(By.ID, "live-drawn").click()
    assert verdict_of(truck) == "beyond"


@in_browser
def test_critical_speeds_follow_a_joint_that_is_dragged(truck: webdriver.Chrome) -> None:
    """While it is held and then as the check of the changed scene has them, drawn as well."""

    def shown() -> dict[str, float]:
        return {path: value for path, value, _ in figures(truck) if "check:torsion." in path}

    card = truck.find_element(By.ID, "live-torsion")
    before, charted = shown(), chart_in(truck, card.find_element(By.TAG_NAME, "figure"))
    assert len(before) == 9
    assert not any(len(each) for each in charted.former)
    joint = handle(truck, 2)
    ActionChains(truck).click_and_hold(joint).move_by_offset(0, 40).perform()
    WebDriverWait(truck, 5).until(lambda _: shown() != before)
    ActionChains(truck).release().perform()
    settled(truck)
    moved = place_of(truck, 2)[1] + 46.0
    data = check_data(Answer(edited(TRUCK, 2, (0.0, moved, 0.0))))
    after = shown()
    assert all(value == at(data, path) for path, value in after.items())
    speeds = [path for path in after if path.endswith("_rpm")]
    assert len(speeds) == 4
    assert all(after[path] != before[path] for path in speeds)
    chart = chart_in(truck, card.find_element(By.TAG_NAME, "figure"))
    frequencies = [mode["frequency_Hz"] for mode in data["torsion"]["modes"]]
    drawn = [float(curve[0, 1]) for curve in chart.curves[:2]]
    assert drawn == pytest.approx(frequencies, abs=3.0)
    for order, ray in zip((2, 4), chart.curves[2:], strict=True):
        ends = ray[np.isfinite(ray[:, 0])]
        np.testing.assert_allclose(ends[:, 1], order * ends[:, 0] / 60.0, atol=3.0)
    assert len(chart.former) == 4
    assert "in the range" in card.text
    truck.find_element(By.ID, "live-drawn").click()
    assert shown() == before


@in_browser
def test_the_speed_moves_along_the_critical_speeds(truck: webdriver.Chrome) -> None:
    """Whichever is nearest to it is named with its distance in shares of it."""
    speeds = Answer(Scene.load(TRUCK))["torsion"]
    assert speeds
    field = truck.find_element(By.CSS_SELECTOR, "#live-loads input")
    for rpm in (1500, 2900):
        field.click()
        field.send_keys(Keys.CONTROL + "a" + Keys.NULL + str(rpm) + Keys.ENTER)
        settled(truck)
        at_hand = rpm * math.pi / 30.0
        away = {abs(at_hand - each.speed) / each.speed: each for each in speeds.critical_speeds}
        nearest = away[min(away)]
        words = truck.find_element(By.ID, "live-torsion").text
        name = f"{number_text(nearest.speed * 30.0 / math.pi, 'rpm')} rpm"
        share = number_text(100.0 * min(away), "percent")
        text = f"{rpm} rpm, the speed at hand: order {nearest.order:g} at {name}, {share}% away."
        assert text in words
    truck.find_element(By.ID, "live-drawn").click()


@in_browser
def test_points_are_dragged_in_both_views(truck: webdriver.Chrome) -> None:
    """The pointer moves whole millimetres along the axes of the view; Escape gives it up."""
    for view, axis in ((0, 1), (1, 2)):
        before = place_of(truck, 2)
        ActionChains(truck).drag_and_drop_by_offset(handle(truck, 2, view), 0, 16).perform()
        after = place_of(truck, 2)
        moved = [a - b for a, b in zip(after, before, strict=True)]
        assert moved[axis] != 0.0
        assert [x for i, x in enumerate(moved) if i != axis] == [0.0, 0.0]
        assert after[axis] == round(after[axis])
        # One scale for both views: 16 px are as many millimetres, y up and z down.
        scale = js(truck, "return cardanPage.drawing.scale")
        assert abs(abs(moved[axis]) - 16.0 / scale) <= 2.0
        assert (moved[axis] < 0) == (view == 0)
    held = ActionChains(truck).click_and_hold(handle(truck, 2)).move_by_offset(5, 30)
    held.perform()
    # The figures of what is held still are its own.
    bend = "check:limits.equivalent_bend.value_deg"
    own = """const { model } = cardanPage;
    return model.rows().find((row) => row.path === arguments[0]).value;"""
    shown = "return Number(document.querySelector(`[data-path='${arguments[0]}']`).dataset.value)"
    expected = js(truck, f"cardanPage.model.compute(); {own}", bend)
    WebDriverWait(truck, 5).until(lambda truck: js(truck, shown, bend) == expected)
    assert place_of(truck, 2) != after
    ActionChains(truck).send_keys(Keys.ESCAPE).release().perform()
    assert place_of(truck, 2) == after
    for _ in range(2):
        truck.find_element(By.ID, "live-undo").click()
    assert place_of(truck, 2) == [1650.0, -46.0, 0.0]


def field(browser: webdriver.Chrome, label: str) -> WebElement:
    return browser.find_element(By.CSS_SELECTOR, f"input[aria-label^='{label},']")


@in_browser
def test_numbers_are_typed_stepped_and_dragged(truck: webdriver.Chrome) -> None:
    """Coordinates, torque and speed; what is no number is refused and loses nothing."""
    handle(truck, 2).send_keys(Keys.ARROW_RIGHT)
    settled(truck)
    y = field(truck, "y")
    assert y.get_attribute("value") == "\u221246.0"
    y.click()
    y.send_keys(Keys.CONTROL + "a")
    y.send_keys("-70,5" + Keys.ENTER)
    assert place_of(truck, 2) == [1651.0, -70.5, 0.0]
    y.send_keys(Keys.ARROW_UP + Keys.SHIFT + Keys.ARROW_UP)
    assert place_of(truck, 2) == [1651.0, -59.5, 0.0]
    for text, words in (("12x", "is no number"), ("1e9", "must be within"), ("", "is no number")):
        y.send_keys(Keys.CONTROL + "a" + Keys.NULL)
        y.send_keys((text or Keys.BACKSPACE) + Keys.ENTER)
        assert words in truck.find_element(By.ID, "live-refused").text
        assert y.get_attribute("value") == "\u221259.5"
        assert place_of(truck, 2) == [1651.0, -59.5, 0.0]
    torque = field(truck, "torque")
    truck.execute_script("document.activeElement.blur()")
    ActionChains(truck).drag_and_drop_by_offset(torque, 30, 0).perform()
    assert js(truck, "return cardanPage.model.loadOf('torque')") == 1600.0
    speed = field(truck, "speed")
    for own, most, words in ((speed, 100_000, "100\u2009000 rpm"), (torque, 10_000_000, "N m")):
        before = own.get_attribute("value")
        own.send_keys(Keys.CONTROL + "a" + Keys.NULL + f"{most + 1}" + Keys.ENTER)
        rule = truck.find_element(By.ID, "live-refused").text
        assert words in rule
        assert "more than any driveline has" in rule
        assert str(own.get_attribute("title")) in rule
        assert own.get_attribute("value") == before
    speed.click()
    speed.send_keys(Keys.ARROW_DOWN)
    settled(truck)
    changed = {
        "[1650, -46, 0]": "[1651, -59.5, 0]",
        "speed_rpm = 2200\n": "speed_rpm = 2190\n",
        "output_torque_Nm = 1500\n": "output_torque_Nm = 1600\n",
    }
    text = TRUCK.read_text(encoding="utf-8")
    for old, new in changed.items():
        assert text.count(old) == 1
        text = text.replace(old, new)
    data = check_data(Answer(Scene.parse(without_slow_parts(text, "tolerances|optimise"))))
    for path, value, _ in figures(truck):
        assert value == at(data, path), path
    assert saved(truck) == ["truck-shaft.changed.toml", text]


def saved(browser: webdriver.Chrome) -> list[str]:
    """Name and text of the file that the page lets the browser save."""
    script = """const [done] = arguments;
    URL.createObjectURL = (blob) => { window.blob = blob; return "#"; };
    HTMLAnchorElement.prototype.click = function () {
        window.blob.text().then((text) => done([this.download, text]));
    };
    document.getElementById("live-save").click();"""
    found = browser.execute_async_script(script)
    return [str(each) for each in found]


@in_browser
def test_bearings_are_moved_along_their_shafts(truck: webdriver.Chrome) -> None:
    bearing = truck.find_element(By.CSS_SELECTOR, ".handle[data-bearing='2'][data-view='1']")
    position = "return 1e3 * cardanPage.model.part('positions', 2)"
    ActionChains(truck).drag_and_drop_by_offset(bearing, -30, 6).perform()
    scale = js(truck, "return cardanPage.drawing.scale")
    assert abs(js(truck, position) - (1150.0 - 30.0 / scale)) <= 2.0
    truck.find_element(By.ID, "live-undo").click()
    bearing.send_keys(Keys.SHIFT + Keys.ARROW_LEFT)
    settled(truck)
    assert js(truck, position) == pytest.approx(1140.0, abs=1e-9)
    assert field(truck, "from the upstream end of shaft 1").get_attribute("value") == "1140.0"
    (change,) = truck.find_elements(By.CSS_SELECTOR, "#live-panel .changes button")
    assert change.text.startswith("bearing 2 \u221210.0 mm")
    text = TRUCK.read_text(encoding="utf-8").replace("position_mm = 1150", "position_mm = 1140")
    assert saved(truck)[1] == text


@in_browser
def test_a_link_carries_what_was_changed(truck: webdriver.Chrome) -> None:
    """The address follows; opened again it shows the same; a mistake in it shows the scene."""
    handle(truck, 2).send_keys(Keys.SHIFT + 2 * Keys.ARROW_DOWN + Keys.NULL + Keys.ARROW_DOWN)
    truck.find_elements(By.CSS_SELECTOR, "#live-states [role=radio]")[4].click()
    settled(truck)
    WebDriverWait(truck, 10).until(lambda truck: "state=" in truck.current_url)
    address = truck.current_url
    assert address.endswith("#point.2.y=-21&state=%2B80+mm")
    shown = figures(truck)
    truck.get("about:blank")
    truck.get(address)
    truck.find_element(By.CSS_SELECTOR, "#live-panel .rows li")
    assert figures(truck) == shown
    js(truck, "location.hash = '#point.2.y=-24'")
    settled(truck)
    assert place_of(truck, 2)[1] == -70.0
    js(truck, "location.hash = '#point.7.y=-24'")
    settled(truck)
    assert "nothing called" in truck.find_element(By.ID, "live-refused").text
    assert place_of(truck, 2)[1] == -70.0


@in_browser
def test_a_turn_plays_until_it_is_stopped(truck: webdriver.Chrome) -> None:
    angle, play = (truck.find_element(By.ID, f"live-{name}") for name in ("angle", "play"))
    js(truck, "arguments[0].click()", play)
    for _ in range(5):
        settled(truck)
    assert play.text == "Stop"
    turned = float(str(angle.get_property("value")))
    assert turned != 40.0
    js(truck, "arguments[0].click()", play)
    settled(truck)
    stopped = angle.get_property("value")
    settled(truck)
    assert angle.get_property("value") == stopped


@in_browser
def test_what_makes_no_driveline_is_refused(truck: webdriver.Chrome) -> None:
    handle(truck, 2).send_keys(Keys.SHIFT + 200 * Keys.ARROW_LEFT)
    settled(truck)
    assert "makes no driveline" in truck.find_element(By.ID, "live-refused").text
    assert place_of(truck, 2)[0] > 350.0
    assert "NaN" not in js(truck, "return document.querySelector('main').innerHTML")


@in_browser
def test_states_are_chosen_with_their_verdict(truck: webdriver.Chrome) -> None:
    chips = truck.find_elements(By.CSS_SELECTOR, "#live-states [role=radio]")
    assert [chip.get_attribute("aria-label") for chip in chips] == [
        "-80 mm, beyond",
        "-40 mm, beyond",
        "rest, within",
        "+40 mm, within",
        "+80 mm, beyond",
    ]
    assert [chip.get_attribute("aria-checked") for chip in chips].index("true") == 2
    chips[0].click()
    settled(truck)
    assert any("[state=-80 mm].bends_deg[1]" in path for path, _, _ in figures(truck))
    data = check_data(Answer(Scene.load(TRUCK)))
    for path, value, _ in figures(truck):
        assert close(value, at(data, path)), path


@in_browser
def test_a_suggestion_is_applied_with_a_click(truck: webdriver.Chrome) -> None:
    """It brings the truck within its limits, as the check confirms, and can be taken back."""
    offer = truck.find_element(By.CSS_SELECTOR, "#live-panel .ways button")
    assert offer.text.split("\n") == ["Move joint 1 by 24.0 mm along \u2212y", "all within here"]
    offer.click()
    assert verdict_of(truck) == "within"
    assert place_of(truck, 2) == [1650.0, -70.0, 0.0]
    (change,) = truck.find_elements(By.CSS_SELECTOR, "#live-panel .changes button")
    assert change.text.startswith("joint 1 y \u221224.0 mm")
    truck.execute_script("arguments[0].click()", change)
    assert verdict_of(truck) == "beyond"
    assert place_of(truck, 2) == [1650.0, -46.0, 0.0]


@in_browser
def test_yokes_are_turned_by_keys_and_buttons(truck: webdriver.Chrome) -> None:
    dial = truck.find_element(By.CSS_SELECTOR, "#live-dials [role=slider]")
    dial.send_keys(Keys.SHIFT + Keys.ARROW_RIGHT)
    dial.send_keys(2 * Keys.ARROW_LEFT)
    settled(truck)
    assert dial.get_attribute("aria-valuetext") == "8.0° clockwise"
    best, teeth = truck.find_elements(By.CSS_SELECTOR, "#live-dials button")
    truck.execute_script("arguments[0].click()", best)
    bend = "return document.querySelector(`[data-path='check:limits.equivalent_bend.value_deg']`)"
    least = float(js(truck, f"{bend}.dataset.value"))
    truck.execute_script("arguments[0].click()", teeth)
    on_teeth = float(js(truck, f"{bend}.dataset.value"))
    phases = js(truck, "return cardanPage.model.phases")
    assert np.allclose(np.mod(np.array(phases) + 5.0, 10.0), 5.0, atol=1e-6)
    assert min(least, on_teeth) < 4.27


@pytest.mark.long
@in_browser
def test_the_page_checks_itself(truck: webdriver.Chrome) -> None:
    """It says which core and which scene, and that this browser has the published results.

    Meanwhile it draws frames; the whole takes about a second.
    """
    foot = truck.find_element(By.ID, "live-trust")
    core = (WEB / "sources.sha256").read_text()[:12]
    text = hashlib.sha256(TRUCK.read_bytes()).hexdigest()[:12]
    assert f"cardan {__version__} ({core})" in foot.text
    assert f"truck-shaft.toml ({text})" in foot.text
    # What would help has been found.
    truck.find_element(By.CSS_SELECTOR, "#live-panel .ways button")
    js(
        truck,
        """let last = performance.now();
        window.longest = 0;
        arguments[0].click();
        requestAnimationFrame(function frame() {
            const now = performance.now();
            window.longest = Math.max(window.longest, now - last);
            last = now;
            if (arguments[0]) requestAnimationFrame(frame);
        });""",
        foot.find_element(By.TAG_NAME, "button"),
    )
    result = foot.find_element(By.CSS_SELECTOR, "[role=status].within, [role=status].beyond")
    assert result.text.startswith("All 10\u2009000 evaluations have the published results")
    assert 0.0 < float(js(truck, "return window.longest")) < 300.0


@in_browser
def test_a_notebook_shows_a_machine_that_can_be_moved(
    browser: webdriver.Chrome, tmp_path: Path
) -> None:
    """In a frame that may run its scripts and save a file, and has no address to copy."""
    into = {"behavior": "allow", "downloadPath": str(tmp_path)}
    browser.execute_cdp_cmd("Browser.setDownloadBehavior", into)
    shown = Scene.load(TRUCK)._repr_html_()
    (tmp_path / "notebook.html").write_text(
        f"<!DOCTYPE html><meta charset=utf-8><title>a</title>{shown}", "utf-8"
    )
    browser.get((tmp_path / "notebook.html").as_uri())
    browser.switch_to.frame(browser.find_element(By.TAG_NAME, "iframe"))
    try:
        assert js(browser, "return origin") == "null"
        browser.find_element(By.CSS_SELECTOR, "#live-panel .rows")
        assert verdict_of(browser) == "beyond"
        joint = handle(browser, 2)
        joint.send_keys(Keys.SHIFT + 2 * Keys.ARROW_DOWN + Keys.NULL + 4 * Keys.ARROW_DOWN)
        settled(browser)
        assert verdict_of(browser) == "within"
        assert not browser.find_element(By.ID, "live-link").is_displayed()
        browser.find_element(By.ID, "live-save").click()
        deadline = time.monotonic() + 10.0
        while not (tmp_path / "truck-shaft.changed.toml").exists():
            assert time.monotonic() < deadline
            time.sleep(0.02)
    finally:
        browser.switch_to.default_content()
    lowered = edited(TRUCK, 2, (0.0, -24.0, 0.0))
    assert Scene.load(tmp_path / "truck-shaft.changed.toml").points == pytest.approx(lowered.points)


@in_browser
@pytest.mark.parametrize("width", [1280, pytest.param(390, marks=pytest.mark.long)])
def test_a_machine_is_chosen(browser: webdriver.Chrome, tmp_path: Path, width: int) -> None:
    """By a link; nothing is wider than the screen."""
    screen(browser, width, 900)
    machines = [TRUCK, example("test-rig.toml")]
    page = moving_page({path.stem: Answer(Scene.load(path)) for path in machines})
    assert page is not None
    opened(browser, page, tmp_path)
    for path in reversed(machines):
        title = Scene.load(path).title
        browser.find_element(By.LINK_TEXT, title).click()
        browser.find_element(By.CSS_SELECTOR, "#live-panel .rows")
        assert browser.current_url.endswith(f"page.html?{path.stem}")
        assert browser.title == browser.find_element(By.TAG_NAME, "h1").text == title
        (chosen,) = browser.find_elements(By.CSS_SELECTOR, "nav [aria-current]")
        assert chosen.text == title
        assert verdict_of(browser) == check_data(Answer(Scene.load(path)))["verdict"]
        is_wide = "return document.documentElement.scrollWidth > innerWidth"
        assert not js(browser, is_wide)
        has_states = path == TRUCK
        key = browser.find_element(By.CSS_SELECTOR, ".live .key .rest")
        assert key.is_displayed() == has_states


@in_browser
def test_a_page_without_webassembly_is_the_report(
    browser: webdriver.Chrome, answered: Answers, tmp_path: Path
) -> None:
    """The live part stays hidden where the module cannot be loaded; all else is there."""
    (tmp_path / "page.html").write_text(answered(TRUCK).page, encoding="utf-8")
    without = {"source": "delete globalThis.WebAssembly"}
    added = browser.execute_cdp_cmd("Page.addScriptToEvaluateOnNewDocument", without)
    browser.get((tmp_path / "page.html").as_uri())
    browser.execute_cdp_cmd("Page.removeScriptToEvaluateOnNewDocument", added)
    assert not browser.find_element(By.ID, "live-page").is_displayed()
    assert not browser.find_element(By.ID, "live-panel").is_displayed()
    assert browser.find_element(By.ID, "answer").is_displayed()
    assert browser.find_element(By.CSS_SELECTOR, "#tolerances .drawing figure").is_displayed()


def test_the_module_is_in_the_page(tmp_path: Path, answered: Answers) -> None:
    """Nothing is fetched: the page holds the compressed module, and pays for it only with it."""
    page = answered(TRUCK).page
    (module,) = re.findall(r'id="live-module">(.*?)</script>', page)
    assert base64.b64decode(module) == (WEB / "cardan.wasm.gz").read_bytes()
    (script,) = re.findall(r"<script>(.*?)</script>", page, re.S)
    assert not re.search(r"\b(import|export|eval|fetch)\b", script)
    recorded = Scene.parse("[driveline]\nbends_deg = [8]\n[study]\nbends_deg.0 = [1, 2]\n", "a")
    write_report(recorded, tmp_path / "b.html")
    assert "live-module" not in (tmp_path / "b.html").read_text(encoding="utf-8")


# --- curves over the turn -----------------------------------------------------------------------


def charts(browser: webdriver.Chrome) -> list[Drawn]:
    figures = browser.find_elements(By.CSS_SELECTOR, "#live-curves figure")
    return [chart_in(browser, figure) for figure in figures]


def over_the_turn(scene: Scene, name: str, state: str, degrees: FloatArray) -> FloatArray:
    """Accelerations, torques or sizes of bearing forces of all shafts or bearings of a state."""
    states = scene.states
    assert states
    number = states.names.index(state)
    line, load = states.driveline(number), states.load(number)
    assert load
    shafts = None if name == "bearing_force" else slice(None)
    found = line.evaluate(np.radians(degrees), name, shafts=shafts, load=load)
    values = np.asarray(getattr(found, name))
    if name == "acceleration_ratio":
        return values[1:] * float(load.speed) ** 2
    return values if name == "torque" else np.linalg.norm(values, axis=-1)


def drawn_as(scene: Scene, state: str, shown: list[Drawn], *, former: bool = False) -> None:
    """All curves stand where the axes say that the values of a scene are."""
    names = ("acceleration_ratio", "torque", "bearing_force")
    for chart, name in zip(shown, names, strict=True):
        curves = chart.former if former else chart.curves
        degrees = np.arange(0.0, 361.0, 3.0)
        values = over_the_turn(scene, name, state, degrees)
        assert len(values) == len(curves)
        # A tenth of a pixel.
        close = (chart.ticks["y"][-1] - chart.ticks["y"][0]) / 1000.0
        for curve, expected in zip(curves, values, strict=True):
            if np.ptp(expected) <= 0.01 * np.max(np.abs(expected)):
                assert len(curve) == 0
                continue
            assert np.allclose(curve[:, 0], degrees, atol=0.2)
            assert np.allclose(curve[:, 1], expected, atol=close), name


@in_browser
def test_curves_over_the_turn_stand_where_the_package_says(truck: webdriver.Chrome) -> None:
    """In the state shown, as drawn and after a move, with the scene as sent dashed behind it."""
    scene, moved = Scene.load(TRUCK), edited(TRUCK, 2, (0.0, -24.0, 0.0))
    shown = charts(truck)
    assert [chart.heading for chart in shown] == [
        "Acceleration [rad/s²]",
        "Torque [N m]",
        "Bearing force [N]",
    ]
    assert [chart.bounds for chart in shown] == [pytest.approx([-300, 300], abs=1.0), [], []]
    assert all("over drive angle [deg], from" in chart.spoken for chart in shown)
    drawn_as(scene, "rest", shown)
    assert not any(len(curve) for chart in shown for curve in chart.former)
    handle(truck, 2).send_keys(Keys.SHIFT + 2 * Keys.ARROW_DOWN, Keys.NULL, 4 * Keys.ARROW_DOWN)
    truck.find_elements(By.CSS_SELECTOR, "#live-states [role=radio]")[0].click()
    settled(truck)
    drawn_as(moved, "-80 mm", charts(truck))
    drawn_as(scene, "-80 mm", charts(truck), former=True)
    assert "even" in charts(truck)[1].legend[-1]


@in_browser
@pytest.mark.parametrize("name", tiers.few(MACHINES, SHORT))
def test_sizes_of_curves_are_those_of_a_run(
    name: str, browser: webdriver.Chrome, answered: Answers, tmp_path: Path
) -> None:
    """Each that names its place in ``cardan run --json`` has the number there, exactly."""
    path = example(f"{name}.toml")
    opened(browser, answered(path).page, tmp_path)
    data, placed = answered(path).data("run"), 0
    for chip in browser.find_elements(By.CSS_SELECTOR, "#live-states [role=radio]"):
        browser.execute_script("arguments[0].click()", chip)
        sizes = js(
            browser,
            """return [...document.querySelectorAll("#live-curves [data-path^='run:']")].map((e) =>
                [e.dataset.path, Number(e.dataset.value), e.textContent])""",
        )
        placed += len(sizes)
        for place, value, text in sizes:
            assert value == number_at(data, place), place
            shown = number_text(value, place.rpartition(".value")[2].removeprefix("_"))
            assert text.removeprefix("±") == shown.replace("-", "\u2212"), place
    assert placed


def number_at(data: Any, path: str) -> Any:  # noqa: ANN401
    """What a path names in JSON: ``run:rows[quantity=torque,shaft=3].value_Nm``."""
    for name, keys in re.findall(r"\.?(\w+)|\[([^\]]+)\]", path.partition(":")[2]):
        if name:
            data = data[name]
        else:
            wanted = dict(pair.split("=") for pair in keys.split(","))
            (data,) = [
                each for each in data if all(str(each.get(k)) == v for k, v in wanted.items())
            ]
    return data


@in_browser
def test_axes_grow_while_dragging_and_fit_afterwards(truck: webdriver.Chrome) -> None:
    js(truck, "document.getElementById('live-curves').scrollIntoView()")

    def top(y: float) -> float:
        script = """const { model, curves } = cardanPage;
            model.begin(); model.place(2, [null, arguments[0], null]); curves.show(arguments[1]);
            const shown = document.querySelectorAll("#live-curves [data-y]");
            return Math.max(...[...shown].map((text) => Number(text.dataset.y)))"""
        return float(js(truck, script, y, not y))

    settled(truck)
    heights = [top(y) for y in (-100.0, 300.0, -46.0)]
    assert heights[0] < heights[1] == heights[2]
    assert js(truck, "cardanPage.model.cancel(); cardanPage.curves.show(true)") is None
    assert max(chart.ticks["y"][-1] for chart in charts(truck)) < heights[1]


@in_browser
def test_curves_are_copied(truck: webdriver.Chrome) -> None:
    """As text with a line of names and units."""
    button = truck.find_element(By.XPATH, "//button[.='Copy as CSV']")
    js(
        truck,
        """Object.defineProperty(navigator, "clipboard", { configurable: true, value: {
            writeText: async (text) => { window.copiedText = text; } } })""",
    )
    truck.execute_script("arguments[0].click()", button)
    head, *rows = js(truck, "return copiedText").splitlines()
    names = head.split(",")
    assert names[:2] == ["drive angle [deg]", "acceleration of shaft 1 [rad/s²] (rest)"]
    values = np.array([row.split(",") for row in rows], dtype=float)
    scene = Scene.load(TRUCK)
    expected = [
        over_the_turn(scene, name, "rest", values[:, 0])
        for name in ("acceleration_ratio", "torque", "bearing_force")
    ]
    assert values[:, 0].tolist() == list(range(0, 361, 3))
    assert np.allclose(values[:, 1:], np.concatenate(expected).T, rtol=1e-9, atol=1e-9)
    said = truck.find_element(By.CSS_SELECTOR, "#live-curves [role=status]")
    assert said.text == "copied"

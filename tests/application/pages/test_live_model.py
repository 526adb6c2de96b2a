"""The model of the moving page in Node, against the package."""

from __future__ import annotations

import json
import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import cardan
import tiers
from cardan import Coupling
from cardan.app.answers.answer import Answer
from cardan.app.answers.printed import number_text, use_text
from cardan.app.answers.rows import DIGITS
from cardan.app.answers.schema import check_data
from cardan.app.report.live import coupling_data, live
from cardan.app.scene import Scene
from cardan.app.scene.changes import given
from cardan.app.scene.machine import machine_data
from cardan.app.scene.sections.torsion import TorsionCase
from example_scenes import DRIVELINES, each_driveline, example
from live import (
    CHANGE,
    READ,
    TRUCK,
    Move,
    Run,
    at,
    close,
    in_node,
    moves_of,
    sent,
    told_after,
    truck_sent,
    without_slow_parts,
)

MACHINES = [path.stem for path in DRIVELINES if path.parent.name == "machines"]
# With states and a duty cycle, with tolerances beyond a limit, with a steering column.
SHORT = ("truck-shaft", "test-rig", "steering-column")


# --- what Python sends ------------------------------------------------------------------------


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
def test_numbers_are_written_as_in_python(node: Run) -> None:
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
    found = node(
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


@in_node
@each_driveline
def test_what_a_changed_page_says_is_the_check_of_what_it_saves(path: Path, node: Run) -> None:
    """To the last bit, but for torques; the address carries the same, and all else stands."""
    text = without_slow_parts(path.read_text(encoding="utf-8"))
    scene = Scene.parse(text, path.name, path.parent)
    if machine_data(scene) is None:
        return
    random = np.random.default_rng(len(path.stem))
    moves = [moves_of(scene, random) for _ in range(20 if tiers.whole else 3)]
    for each, told in zip(moves, told_after(node, scene, moves), strict=True):
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
def test_changes_are_written_in_every_form_of_a_scene(node: Run) -> None:
    """Unlisted phases, points that states set together, in metres, added to or evenly spread."""
    scene = Scene.parse(FORMS)
    moves: list[list[Move]] = [
        [("point", 2, [0.0, 12.5, 0.0])],
        [("phase", 1, [7.0, 0.0, 0.0])],
        [("bearing", 0, [3.0, 0.0, 0.0]), ("speed", 0, [-0.2, 0.0, 0.0])],
    ]
    texts = [told["text"] for told in told_after(node, scene, moves)]
    assert texts[0] == FORMS.replace("-6e-2", "-0.0475")
    assert texts[1] == FORMS.replace("teeth = 36", "teeth = 36\nphases_deg = [0, 7]")
    assert texts[2] == FORMS.replace("= 50 #", "= 47 #").replace("1_50.0", "120")
    script = """const model = new Model(cardan, data);
    model.begin();
    model.place(4, model.points(model.state)[4].map((x, i) => x + [0, 5, 0][i]));
    return model.text;"""
    text = node(sent(scene), script)
    assert "points_m.3.y = {from = -0.2, to = -0.1, steps = 3}\n" in text
    assert "points_m.4.y = {from = -0.195, to = -0.095, steps = 3}\n" in text
    found = Scene.parse(text)
    assert found.states
    for state in range(3):
        at_state = found.states.points(state)
        assert at_state is not None
        np.testing.assert_allclose(at_state[4, 1], [-0.195, -0.145, -0.095][state], atol=1e-15)


@in_node
def test_what_a_scene_has_no_place_for_is_not_saved(node: Run) -> None:
    """An inline section takes no further line; a file without the change would be a lie."""
    scene = Scene.parse("driveline = {bends_deg = [5, 4]}\n[limits]\nequivalent_bend_deg = 3\n")
    script = """const model = new Model(cardan, data);
    model.begin();
    model.turn([9]);
    try { return model.text; } catch (error) { return error.message; }"""
    found = node(sent(scene), script)
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
def test_a_point_that_states_turn_is_moved_as_they_turn_it(node: Run) -> None:
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
    for state, (to, text) in zip((0, -1), node(sent(scene), script), strict=True):
        found = Scene.parse(text)
        assert found.states
        points = found.states.points(state % found.states.count)
        assert points is not None
        np.testing.assert_allclose(points[turned[0]], to, atol=1e-8)


@in_node
def test_malformed_addresses_change_nothing(node: Run) -> None:
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
    refused, found = node(data, script)
    assert refused == ""
    assert sum(bool(words) for words, *_ in found) > len(bad) // 3
    for address, (words, same, then) in zip(bad, found, strict=True):
        assert bool(words) == same or not words, (address, words, then)
    for (words, same, _), address in zip(found[:19], bad, strict=False):
        assert words.startswith("The address cannot be read"), address
        assert same


def worst(rows: Any, data: Any) -> str:  # noqa: ANN401
    """The verdict of the check on those figures that are computed in the page."""
    verdicts = {at(data, row["path"].rpartition(".")[0])["verdict"] for row in rows}
    order = ("beyond", "not judged", "tolerable", "within")
    return next(verdict for verdict in order if verdict in verdicts)


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
def test_published_limits_that_hold_at_every_speed_follow(node: Run) -> None:
    """The strictest of each kind has the value and the verdict of the check."""
    moves: list[list[Move]] = [[("point", 1, [0.0, -30.0, 0.0])], [("point", 2, [0.0, 12.0, 4.0])]]
    for told in told_after(node, Scene.parse(PUBLISHED), moves):
        assert told["moved"]
        data = check_data(Answer(Scene.parse(told["text"])))
        compared(told["rows"], data)
        paths = {path for path in told["rows"] if "presets[preset=gm]" in path}
        assert len(paths) == 3
        assert {told["rows"][path]["verdict"] for path in paths} >= {"beyond"}


@in_node
def test_what_is_refused_is_said_in_the_words_of_the_page(node: Run) -> None:
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
    found = node(
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
def test_what_is_known_in_some_states_only_is_not_judged(node: Run) -> None:
    """As in a check; it then makes the verdict, unless something is beyond its limit."""
    found = node(
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
def test_undo_and_redo_are_gestures(node: Run) -> None:
    """A drag is one step, keys in quick succession are one, and what is refused changes nothing."""
    found = node(
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
@pytest.mark.parametrize(
    ("driveline", "said"),
    [
        ("bends_deg = [12]", "Nothing can be changed here: the scene gives no points, which could"),
        ("bends_deg = [12, 1]", "No single change helps."),
        ("points_mm = [[0, 0, 0], [100, 0, 0], [200, -40, 0]]", "No single change helps."),
        ("bends_deg = [1]", ""),
    ],
)
def test_why_nothing_is_suggested(driveline: str, said: str, node: Run) -> None:
    scene = Scene.parse(f"[driveline]\n{driveline}\n")
    found: str = node(sent(scene), "return new Model(cardan, data).withoutChange;")
    assert found.startswith(said)
    assert bool(found) == bool(said)


@in_node
@pytest.mark.parametrize("name", tiers.few(MACHINES, SHORT))
def test_what_would_help_does(name: str, node: Run) -> None:
    """Suggestions are those of the check, and each leaves the verdict that it promises."""
    path = example(f"{name}.toml")
    found = node(
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
def test_phases_are_those_of_the_package(node: Run) -> None:
    """The best setting of the truck's yokes, and what it leaves."""
    found = node(
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


def compared_torsion(node: Run, scene: Scene, moves: list[list[Move]]) -> list[tuple[float, ...]]:
    """Natural frequencies after moves, which are those of the check like all that follows."""
    told = node(
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
def test_critical_speeds_are_those_of_the_check_of_what_is_saved(path: Path, node: Run) -> None:
    """As sent and after moves: all bits, which one is nearest to the speeds, and its verdict."""
    text = path.read_text(encoding="utf-8")
    text = without_slow_parts(text, "tolerances|optimise|life|output")
    text = text.replace("\n[torsion]\n", "\n[torsion]\nresonance_margin = 0.15\n", 1)
    scene = Scene.parse(text, path.name, path.parent)
    random = np.random.default_rng(len(path.stem))
    joint: list[Move] = [("point", 1, [0.0, 17.0, -6.0])] if given(scene)["points"] else []
    moves: list[list[Move]] = [[], joint]
    moves += [moves_of(scene, random) for _ in range(12 if tiers.whole else 3)]
    found = compared_torsion(node, scene, moves)
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
def test_natural_frequencies_follow_yokes_torque_and_the_length_of_a_tube(node: Run) -> None:
    """A coupling by its mean torque, inertias behind two joints, an order that nothing excites."""
    moves: list[list[Move]] = [
        [],
        [("phase", 1, [40.0, 0.0, 0.0])],
        [("torque", 0, [0.7, 0.0, 0.0])],
        [("point", 4, [55.0, 0.0, 0.0])],
        [("speed", 0, [0.4, 0.0, 0.0])],
    ]
    found = compared_torsion(node, Scene.parse(LOADED), moves)
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
def test_forces_of_elastic_bearings_are_those_of_the_package_of_what_is_saved(node: Run) -> None:
    """After moves of joints, bearings, yokes and load, with inertias and two directions."""
    shudder = Scene.load(next(path for path in DRIVELINES if path.stem == "shudder"))
    moves: list[list[Move]] = [
        [],
        [("point", 2, [15.0, -20.0, 8.0])],
        [("bearing", 0, [-40.0, 0.0, 0.0]), ("phase", 0, [90.0, 0.0, 0.0])],
        [("torque", 0, [0.25, 0.0, 0.0])],
    ]
    for scene in (shudder, Scene.parse(SHAKEN)):
        told = node(
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
def test_modes_of_free_drives_with_couplings_are_those_of_the_package(node: Run) -> None:
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
    found = node(
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

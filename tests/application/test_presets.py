"""Limits that makers publish: each at its edges, several together, and where they are shown."""

from __future__ import annotations

import importlib.util
import json
import math
import sys
from collections.abc import Sequence
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest
from click.testing import CliRunner
from jsonschema import Draft202012Validator

import cardan
from cardan import Driveline, Limits
from cardan.app.answers.schema import answers_schema
from cardan.app.command import commands
from cardan.app.report.live import live
from cardan.app.report.page import page
from cardan.design.limits import FIGURES, PRESETS, UNKNOWN, Publication

RPM = math.tau / 60.0


def z_shaft(*bends: float) -> Driveline:
    return Driveline.from_bends(bends, [180.0] * (len(bends) - 1), degrees=True)


def verdict(line: Driveline, preset: str, rpm: float | None = None) -> str:
    """What an answer says of one preset alone."""
    rows = "".join(f"speed_rpm = {rpm}\n" for _ in [rpm] if rpm)
    text = f"[driveline]\nbends_deg = {line.bends_deg.tolist()}\n"
    if line.n_joints > 1:
        text += f"twists_deg = {line.twists_deg.tolist()}\n"
    text += f"[load]\n{rows}" if rows else ""
    answer = cardan.Answer(cardan.Scene.parse(f'{text}[limits]\npreset = "{preset}"\n'))
    (found,) = answer["presets"]
    return str(found.verdict)


EDGES: list[tuple[str, Sequence[float], float | None, str]] = [
    ("spicer", (0.5, 0.5), None, "within"),
    ("spicer", (0.49, 0.5), None, "beyond"),
    ("spicer", (3, 2), None, "within"),
    ("spicer", (3, 1.99), None, "beyond"),
    ("spicer", (3.01, 3), None, "not judged"),
    ("spicer", (3.01, 3), 3000, "tolerable"),
    ("spicer", (5.8, 5.8), 3000, "tolerable"),
    ("spicer", (5.81, 5.8), 3000, "beyond"),
    ("spicer", (11.5, 11.5), 100, "tolerable"),
    ("spicer", (11.51, 11.5), 100, "beyond"),
    ("spicer", (11.51, 11.5), None, "beyond"),
    ("spicer", (3.2, 3.2), 5000, "tolerable"),
    ("spicer", (2.9, 2.9), 5001, "not judged"),
    ("spicer", (3.21, 3.2), 5001, "beyond"),
    ("tremec", (3, 1), None, "within"),
    ("tremec", (3.01, 2), None, "beyond"),
    ("tremec", (3, 0.99), None, "beyond"),
    ("tremec", (1, 0), None, "beyond"),
    ("gm", (4, 3.5), None, "within"),
    ("gm", (4.01, 4), None, "beyond"),
    ("gm", (4, 3.49), None, "beyond"),
    ("gm", (0.4, 0), None, "beyond"),
    ("gm", (0.4, 0.01), None, "within"),
    ("meritor", (5, 3.5), None, "within"),
    ("meritor", (5.01, 4), None, "beyond"),
    ("meritor", (5, 3.49), None, "beyond"),
    ("meritor", (5, 5, 0), None, "not judged"),
    ("parker", (8 + 40 / 60,), 2000, "within"),
    ("parker", (8.67,), 2000, "within"),
    ("parker", (8.68,), 2000, "beyond"),
    ("parker", (5.84,), 3000, "within"),
    ("parker", (5.0,), 3001, "not judged"),
    ("parker", (5.0,), None, "not judged"),
    ("parker", (11.51,), None, "beyond"),
    ("john_deere", (20, 20), None, "within"),
    ("john_deere", (20, 19.9), None, "not judged"),
    ("camaro", (0.5, 3, 3), None, "within"),
    ("camaro", (3, 0.5, 3), None, "within"),
    ("camaro", (3, 3, 0.51), None, "beyond"),
    ("camaro", (0.5, 3, 2.9), None, "not judged"),
    # The two that are equal make the third the odd one, although another is bent less.
    ("hombre", (0.2, 0.2, 0.45), None, "within"),
    ("hombre", (0.2, 0.2), None, "not judged"),
    ("truck", (5, 5), 2400, "within"),
    ("drivetrain", (2, 2), None, "not judged"),
]


@pytest.mark.parametrize(("preset", "bends", "rpm", "expected"), EDGES)
def test_edges(preset: str, bends: Sequence[float], rpm: float | None, expected: str) -> None:
    if preset == "truck":
        found = z_shaft(*bends).check(rpm and rpm * RPM, preset).of_presets[preset]
        assert found.verdict == expected
        return
    assert verdict(z_shaft(*bends), preset, rpm) == expected


def test_every_preset_has_its_edges() -> None:
    assert {preset for preset, *_ in EDGES} | {"industrial"} == {*PRESETS}


@pytest.mark.parametrize(("twist", "inches"), [(180.0, 5.0), (0.0, 10.0)])
def test_the_angle_by_the_length(twist: float, inches: float) -> None:
    """With parallel axes a degree for each 5 in, with intersecting ones for each 10 in."""
    length = 4.0 * inches * 0.0254
    for bend, passes in ((3.99, True), (4.0, True), (4.01, False)):
        line = Driveline.from_bends([bend, bend], [twist], degrees=True)
        line = line.with_bearings([], lengths=[0.3, length, 0.3])
        found = line.check(limits="drivetrain").published
        assert [bool(each.passes) for each in found.findings] == [passes, passes]


def test_angles_between_the_speeds_of_a_table() -> None:
    """Bend times speed goes straight from one speed of the source to the next."""
    limit = z_shaft(3.5, 3.5).check(2750 * RPM, "spicer").published.findings[0].there
    assert limit is not None
    assert limit.maximum == math.ceil(100 * (7.0 * 2500 + 5.8 * 3000) / 2 / 2750) / 100
    speeds = np.array([1500.0, 2750.0, 6000.0, 0.0]) * RPM
    found = z_shaft(6.0, 6.0).check(speeds, "spicer").published.findings[0]
    assert found.verdict.tolist() == ["tolerable", "tolerable", "beyond", "not judged"]
    np.testing.assert_allclose(found.margin[:2], -3.0)


def test_what_the_table_says_of_the_exact() -> None:
    """What its words say of bends that are left, and of angles at 1000 rad/s², is so."""
    said = {name: " ".join(rule.exact for rule in own.rules) for name, own in PRESETS.items()}
    for name, bends in {
        "spicer": (3, 2),
        "tremec": (3, 1),
        "gm": (4, 3.5),
        "meritor": (5, 3.5),
        "industrial": (10, 8.5),
    }.items():
        left = float(z_shaft(*bends).equivalent().bend_deg)
        assert (
            f"{bends[0]:g}° and {bends[1]:g}° leave an equivalent bend of {left:.2f}°"
            in (said[name])
        )
    for name in ("spicer", "parker"):
        (table,) = (rule.over_speed for rule in PRESETS[name].rules if rule.over_speed)
        apart = []
        for rpm, angle in table:
            low, high = 0.0, 0.4
            while (middle := 0.5 * (low + high)) not in (low, high):
                line = Driveline.from_bends([middle])
                peak = line.equivalent().max_acceleration_ratio * (rpm * RPM) ** 2
                low, high = (middle, high) if peak < 1000.0 else (low, middle)
            apart.append(math.degrees(high) - angle)
        assert f"{-min(apart):.2f}°" in said[name]
        assert f"{abs(max(apart)):.2f}°" in said[name]
    maker = Driveline.from_bends([5, 4, 3, 2], [0, 0, 0], [90, 0, 0], degrees=True)
    exact = float(maker.equivalent().max_acceleration_ratio)
    by_rule = float(maker.catalogue_bend([1, 1, -1, 1])) ** 2
    assert f"{100 * (exact / by_rule - 1):.1f} % more at an equivalent bend of 6°" in said["truck"]
    for side, plan in ((4, 3), (15, 10)):
        bend = float(Driveline.from_slopes([0, side], [0, plan], degrees=True).bends_deg[0])
        assert f"{side}° and {plan}° give {bend:.{3 if side == 4 else 2}f}°" in said["meritor"]
    turn = math.radians(15)
    ends = [[-48, 0, 0], [-14, 0, 0]]
    behind = [[r * math.cos(turn), r * math.sin(turn), 0] for r in (24, 48)]
    hitch = Driveline.from_points(ends + behind)
    assert f"15° leaves {float(hitch.equivalent().bend_deg):.2f}°" in said["john_deere"]


def test_publications() -> None:
    assert str(Publication("A", "5", "2009", "second")) == "A (2009), second, page 5"
    assert str(Publication("A", "5 and 6")) == "A, pages 5 and 6"
    assert str(Publication("A")) == "A"
    cited = {name: [rule.source for rule in own.rules] for name, own in PRESETS.items()}
    assert {(each.pages, each.edition) for each in cited["meritor"]} == {("87", "revised 03-21")}
    assert {each.year for each in cited["gm"]} == {"2006"}
    # Of these nothing but the name is known.
    for name in ("tremec", "camaro", "hombre", "john_deere", "drivetrain", "spicer"):
        assert {(each.pages, each.year, each.edition) for each in cited[name]} == {(UNKNOWN,) * 3}
    for preset in PRESETS.values():
        assert {rule.figure in FIGURES for rule in preset.rules} <= {
            bool(preset.figures),
            not preset.on_bends,
        }


# --- several -------------------------------------------------------------------------------------

SEVERAL = """
[driveline]
points_mm = [[0, 0, 0], [300, 0, 0], [1300, {height}, 0], [1600, {height}, 0]]

[load]
speed_rpm = 2400

[limits]
preset = ["spicer", "gm", "truck"]
"""


def test_the_answer_says_which_allow_it(tmp_path: Path) -> None:
    scene = tmp_path / "scene.toml"
    scene.write_text(SEVERAL.format(height=-5), encoding="utf-8")
    found = CliRunner().invoke(commands(), ["check", str(scene)])
    assert found.exit_code == 1
    words = " ".join(found.output.split())
    assert words.startswith(
        "Beyond their limits: the least bend of joint 0 and the least bend of joint 1."
    )
    assert (
        "Allowed by General Motors and truck. Not by Spicer: the least bend of joint 0 is 0.29°, "
        "at least 0.5°; the least bend of joint 1 is 0.29°, at least 0.5°." in words
    )
    scene.write_text(SEVERAL.format(height=-60), encoding="utf-8")
    found = CliRunner().invoke(commands(), ["check", str(scene)])
    assert found.exit_code == 0
    assert "Allowed by General Motors, truck and Spicer (tolerable)." in found.output


def test_json_and_schema(tmp_path: Path) -> None:
    scene = tmp_path / "scene.toml"
    scene.write_text(SEVERAL.format(height=-60), encoding="utf-8")
    found = json.loads(CliRunner().invoke(commands(), ["check", str(scene), "--json"]).output)
    Draft202012Validator(answers_schema()).validate(found)
    assert found["verdict"] == "tolerable"
    assert found["limits"]["preset"] == "spicer, gm, truck"
    spicer, gm, truck = found["presets"]
    assert [each["verdict"] for each in (spicer, gm, truck)] == ["tolerable", "within", "within"]
    bend = gm["joints"][1]["bend"]
    assert (bend["verdict"], bend["limit_deg"]) == ("within", 4.0)
    assert bend["value_deg"] == pytest.approx(math.degrees(math.atan2(60, 1000)))
    assert spicer["differences"][0]["joints"] == "joints 0-1"
    assert truck["joints"][0] == {"joint": 0, "bend": None, "least": None}


def test_states_and_studies_have_the_worst() -> None:
    text = '[driveline]\nbends_deg = [3, 3]\ntwists_deg = [180]\n[limits]\npreset = "spicer"\n'
    states = '[states]\nnames = ["low", "high"]\nspeed_rpm = [1500, 4500]\nbends_deg.0 = [4, 3.8]\n'
    (found,) = cardan.Answer(cardan.Scene.parse(f"{text}[load]\nspeed_rpm = 1500\n{states}"))[
        "presets"
    ]
    bend = found.joints[0].bend
    # 4° are allowed at 1500 rpm, and 3.8° not at 4500 rpm.
    assert (bend.verdict, bend.state) == ("beyond", "high")
    assert np.degrees([bend.value, bend.limit, bend.maximum]) == pytest.approx([3.8, 3.0, 3.7])
    study = "[study]\nbends_deg.0 = [0.3, 1.0, 3.0]\nspeed_rpm = [1000, 2000]\n"
    (found,) = cardan.Answer(cardan.Scene.parse(f"{text}[load]\nspeed_rpm = 1000\n{study}"))[
        "presets"
    ]
    least = found.joints[0].least
    assert (least.verdict, dict(least.at)) == ("beyond", {"bends_deg.0": 0.3})
    assert math.degrees(least.value) == pytest.approx(0.3)


def test_one_state_that_cannot_be_judged_is_said() -> None:
    """It counts more than others that are within, and less than one that is beyond."""
    text = "[driveline]\nbends_deg = [3, 3]\ntwists_deg = [180]\n[limits]\npreset = '{}'\n"
    text += "[load]\nspeed_rpm = 2000\n"
    states = "[states]\nnames = ['level', 'tilted', 'fast']\n{}\n"
    for preset, keys, verdict, state in (
        ("john_deere", "bends_deg.0 = [3, 2.9, 3]", "not judged", "tilted"),
        ("parker", "speed_rpm = [2000, 2900, 3100]", "not judged", "fast"),
        ("parker", "speed_rpm = [2000, 2900, 3100]\nbends_deg.0 = [9, 4, 4]", "beyond", "level"),
    ):
        answer = cardan.Answer(cardan.Scene.parse(text.format(preset) + states.format(keys)))
        (found,) = answer["presets"]
        worst = found.differences[0].difference if found.differences else found.joints[0].bend
        assert (found.verdict, worst.verdict, worst.state) == (verdict, verdict, state)
        assert answer.verdict == verdict
    study = "[study]\nbends_deg.0 = [3, 2.9]\n"
    answer = cardan.Answer(cardan.Scene.parse(text.format("john_deere") + study))
    assert answer.verdict == "not judged"


def test_the_page_computes_what_holds_at_every_speed() -> None:
    """The strictest of each kind; of the rest it says that it does not."""
    answer = cardan.Answer(cardan.Scene.parse(SEVERAL.format(height=-60)))
    data = live(answer)
    assert data
    judged = {(each["kind"], each["item"], each["bound"]["si"]) for each in data["data"]["figures"]}
    assert judged >= {
        ("bend", 0, "at most 4°"),
        ("bend", 1, "at most 4°"),
        ("bend_difference", None, "at most 0.5°"),
    }
    others = {
        (each["name"], each["verdict"], each["words"]["si"]) for each in data["data"]["others"]
    }
    source = "Spicer, driveline operating angle calculator, spicerparts.com"
    words = f"3.43°, 0.43° above the limit of 3° ({source})"
    assert ("bend of joint 0", "tolerable", words) in others
    assert len(others) == 7
    shown = " ".join(page(answer.scene).split())
    assert "Allowed by General Motors, truck and Spicer (tolerable)." in shown


def test_the_documentation_has_every_rule(monkeypatch: pytest.MonkeyPatch) -> None:
    docs = Path(__file__).parents[2] / "docs"
    converter = ModuleType("latex2mathml.converter")
    monkeypatch.setattr(converter, "convert", str, raising=False)
    monkeypatch.setitem(sys.modules, "latex2mathml", ModuleType("latex2mathml"))
    monkeypatch.setitem(sys.modules, "latex2mathml.converter", converter)
    spec = importlib.util.spec_from_file_location("hooks", docs / "hooks.py")
    assert spec
    assert spec.loader
    hooks = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(hooks)
    assert "\n{{ presets }}\n" in (docs / "howto" / "limits.md").read_text("utf-8")
    _, _, *rows = hooks.included("presets").splitlines()
    rules = [(name, rule) for name, own in PRESETS.items() for rule in own.rules]
    assert len(rows) == len(rules)
    for row, (name, rule) in zip(rows, rules, strict=True):
        cells = [cell.strip() for cell in row.strip("|").split(" | ")]
        source = rule.source
        assert cells[0] == f"`{name}`"
        assert cells[1].endswith(rule.own.replace("|", "&#124;"))
        assert cells[2].startswith(source.title)
        assert cells[3:] == [source.pages, source.year, source.edition, rule.exact]


def test_what_the_gauge_may_hide_counts_the_bends() -> None:
    """At the limit both bends keep it if of three errors that of the middle is the least."""
    text = "[driveline]\nreadings_deg = [0, {bend}, 0]\ngauge_deg = 0.1\n"
    text += "[limits]\npreset = '{name}'\n"
    for bend, share in ((3.0, 1.0), (4.0, 1 / 3), (4.3, 0.0)):
        scene = cardan.Scene.parse(text.format(bend=bend, name="meritor"))
        found = cardan.Answer(scene)["readings"]
        assert (found.within, found.as_read) == (1.0, "")
        scene = cardan.Scene.parse(text.format(bend=bend, name="gm"))
        found = cardan.Answer(scene)["readings"]
        assert found.within == pytest.approx(share, abs=0.02)
        assert found.as_read == "published limits on more than bends and their difference"


def test_single_changes_keep_the_bends() -> None:
    """The smallest change leaves the strictest limit at its edge, and the looser is no matter."""
    text = SEVERAL.replace('"spicer", "gm", "truck"', '"meritor", "gm"')
    moves = cardan.Answer(cardan.Scene.parse(text.format(height=-90)))["moves"]
    move = next(each for each in moves if (each.number, each.axis) == (2, "y"))
    assert move.verdict == "within"
    assert move.untried == "least bend of joint 0, least bend of joint 1"
    height = -90.0 + 1e3 * move.shift
    scene = cardan.Scene.parse(
        text.replace("[1300, {height}", "[1300, {moved}").format(height=-90, moved=height)
    )
    bends = scene.line.bends_deg
    assert max(bends) <= 4.0
    assert abs(bends[0] - bends[1]) == pytest.approx(0.5, rel=1e-6)


def test_names_of_presets() -> None:
    assert Limits("spicer").presets == ("spicer",)
    assert Limits(["truck", "gm", "truck"]).presets == ("truck", "gm")
    assert Limits(["truck", "industrial"]).figures == (
        Limits("truck").figures | Limits("industrial").figures  # type: ignore[operator]
    )
    with pytest.raises(ValueError, match=r"preset.* 'vdi'"):
        Limits(["truck", "vdi"])
    with pytest.raises(TypeError, match="presets"):
        Limits([3])  # type: ignore[list-item]
    with pytest.raises(ValueError, match="'gm' again"):
        cardan.Scene.parse('[driveline]\nbends_deg = [1]\n[limits]\npreset = ["gm", "gm"]\n')

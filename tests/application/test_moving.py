"""The live part of a page alone: what notebooks are given, and a page with a choice of machines."""

from __future__ import annotations

import base64
import hashlib
import html
import json
import re
import sys

import pytest
from markupsafe import escape

from cardan import Answer, Scene
from cardan.app.report.moving import moving_page
from cardan.app.scene import load_scene
from example_scenes import example

TRUCK = example("truck-shaft.toml")
RIG = example("test-rig.toml")


def test_notebooks_get_a_frame_with_few_rights() -> None:
    """It holds the whole page, of about half a megabyte."""
    scene = Scene.load(TRUCK)
    shown = scene._repr_html_()
    assert shown == Answer(scene)._repr_html_()
    assert shown is not None
    assert len(shown) < 660_000
    found = re.fullmatch(
        r"""<iframe sandbox="allow-scripts allow-downloads" style="[^"]*" """
        r"""srcdoc='([^']*)'></iframe>""",
        shown,
    )
    assert found is not None
    assert html.unescape(found[1]) == moving_page({"": Answer(scene)})


def test_titles_end_no_attribute() -> None:
    title = 'R&amp;D\'s <b>"shaft"</b>'
    scene = Scene.parse(f"title = {json.dumps(title)}\n[driveline]\nbends_deg = [8]\n")
    (own,) = re.findall(r"srcdoc='([^']*)'>", scene._repr_html_() or "")
    assert f"<h1>{escape(title)}</h1>" in html.unescape(own)


@pytest.mark.parametrize("name", ["slip", "rumble", "recorded_run"])
def test_what_has_no_machine_is_plain_text(name: str) -> None:
    assert Scene.load(example(f"{name}.toml"))._repr_html_() is None


def test_a_ball_joint_is_plain_text() -> None:
    assert Answer(load_scene(example("ball_joint.toml")))._repr_html_() is None


def test_without_jinja2_a_scene_is_plain_text(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "jinja2", None)
    assert Scene.load(RIG)._repr_html_() is None


def test_a_scene_is_written_without_its_text() -> None:
    scene = Scene.load(TRUCK)
    assert scene.text == TRUCK.read_text("utf-8")
    assert "May a truck" in scene.text
    assert "May a truck" not in repr(scene)


def test_a_choice_of_machines_holds_the_core_once() -> None:
    """Each script and style may run by its digest; nothing is fetched."""
    answers = {path.stem: Answer(Scene.load(path)) for path in (RIG, TRUCK)}
    page = moving_page(answers)
    assert page is not None
    assert page.count('id="live-module"') == 1
    assert re.findall(r'<a href="\?(.*?)">(.*?)</a>', page) == [
        (key, answer.scene.title) for key, answer in answers.items()
    ]
    (policy,) = re.findall(r'Content-Security-Policy" content="(.*?)"', page)
    assert policy.startswith("default-src 'none'; ")
    own = re.findall(r"<(script|style)>(.*?)</\1>", page, re.S)
    digests = [base64.b64encode(hashlib.sha256(text.encode()).digest()).decode() for _, text in own]
    assert re.findall(r"'sha256-(.*?)'", policy) == digests
    assert not re.search(r"(src|href)=.?(?!\?)[\w/:]", page.partition("<script")[0])
    assert moving_page({}) is None

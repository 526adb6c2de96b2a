"""The moving page alone, in notebooks and for a choice of machines, and how it checks itself."""

from __future__ import annotations

import base64
import hashlib
import html
import json
import os
import re
import shutil
import subprocess
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from markupsafe import escape

import trust
from cardan import Scene
from cardan.app.answers.answer import Answer
from cardan.app.report.live import live
from cardan.app.report.moving import moving_page
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


WEB = Path(str(resources.files("cardan"))) / "web"


NODE = shutil.which("node")


in_node = pytest.mark.skipif(
    NODE is None and not os.environ.get("CARDAN_REQUIRE_BROWSER"), reason="needs Node"
)


PUBLISHED = re.findall(r'PUBLISHED = "(\w+)"', (WEB / "page/trust.js").read_text(encoding="utf-8"))[
    0
]


def run(folder: Path, script: str) -> Any:  # noqa: ANN401
    """What a script in Node returns that has the modules."""
    (folder / "run.mjs").write_text(
        f"""import {{ readFileSync }} from "node:fs";
        import {{ Cardan }} from "{WEB}/cardan.js";
        import * as trust from "{WEB}/page/trust.js";
        const cardan = await Cardan.load(readFileSync("{WEB}/cardan.wasm.gz"));
        const hex = (bytes) => Buffer.from(bytes).toString("hex");
        console.log(JSON.stringify(await (async () => {{ {script} }})()));"""
    )
    assert NODE, "needs Node"
    done = subprocess.run([NODE, folder / "run.mjs"], capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def test_the_published_digest_is_that_of_the_installed_core() -> None:
    assert trust.digest() == PUBLISHED
    page = Path(__file__).parents[3] / "docs/howto/report.md"
    assert f"\n{PUBLISHED}\n" in page.read_text(encoding="utf-8")


def test_the_evaluations_say_something() -> None:
    """There are ten thousand, of chains of one to five joints, and every output has many values."""
    lines = list(trust.drivelines())
    assert sum(len(angles) for _, _, angles in lines) == 10_000
    assert {line.n_joints for line, _, _ in lines} == {1, 2, 3, 4, 5}
    bends = np.concatenate([line.bends for line, _, _ in lines])
    assert bends.min() < np.radians(1.0)
    assert bends.max() > np.radians(40.0)
    values = np.concatenate(list(trust.results()))
    assert np.isfinite(values).all()
    assert np.unique(values).size > 0.85 * values.size
    assert np.abs(values).max() < 1e6


@in_node
def test_node_computes_the_published_digest(tmp_path: Path) -> None:
    """In slices, of which the page hears; a change of the last bit of one number is seen."""
    found = run(
        tmp_path,
        """const shares = [], call = cardan.call.bind(cardan), told = [];
        told.push(await trust.evaluated(cardan, (share) => shares.push(share)));
        let count = 0;
        cardan.call = (name, values) => {
            const found = call(name, values);
            if (name !== "evaluate" || count++ !== 137) return found;
            const bytes = new Uint8Array(found.values.buffer, found.values.byteOffset);
            bytes[8 * 77] ^= 1;
            return found;
        };
        told.push(await trust.evaluated(cardan));
        return [told, told.map(trust.said), shares];""",
    )
    (right, wrong), (fine, bad), shares = found
    assert right == PUBLISHED
    assert wrong != right
    assert fine == f"All 10\u2009000 evaluations have the published results ({PUBLISHED[:12]})."
    assert f"are not the published ones ({wrong[:12]}, not {PUBLISHED[:12]})" in bad
    assert len(shares) > 10
    assert shares == sorted(shares)


def test_a_page_names_its_core_and_its_scene() -> None:
    """The page itself finds the digest of the text."""
    path = example("truck-shaft.toml")
    found = live(Answer(Scene.load(path)))
    assert found is not None
    data = found["data"]
    assert data["core"] == (WEB / "sources.sha256").read_text().strip()
    assert data["title"] == Scene.load(path).title
    assert data["source"]["text"].encode() == path.read_bytes()

"""The evaluations by which a page checks itself: one digest here, in Node and as published."""

from __future__ import annotations

import hashlib
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

import trust
from cardan import Scene
from cardan.app.answers.answer import Answer
from cardan.app.report.live import live
from example_scenes import example

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
    page = Path(__file__).parents[2] / "docs/howto/report.md"
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


@in_node
def test_no_number_has_one_digest_whatever_its_bits(tmp_path: Path) -> None:
    found = run(
        tmp_path,
        """const call = cardan.call.bind(cardan), told = [];
        for (const byte of [0, 1, 255]) {
            cardan.call = (name, values) => {
                const found = call(name, values);
                if (name !== "evaluate") return found;
                const bytes = new Uint8Array(found.values.buffer, found.values.byteOffset);
                bytes.set([byte, 0, 0, 0, 0, 0, byte === 1 ? 0xf8 : 0xf9, byte ? 0x7f : 0xff]);
                return found;
            };
            told.push(await trust.evaluated(cardan, undefined, [...trust.list()].slice(0, 2)));
        }
        return told;""",
    )
    assert len(set(found)) == 1


@in_node
def test_digests_are_those_of_the_standard(tmp_path: Path) -> None:
    lengths = [0, 1, 3, 55, 56, 63, 64, 65, 119, 120, 1000]
    script = f"""const bytes = (n) => Uint8Array.from({{ length: n }}, (_, i) => (7 * i + n) % 256);
        return {lengths}.map((n) => hex(trust.sha256(bytes(n))));"""
    expected = [
        hashlib.sha256(bytes((7 * i + n) % 256 for i in range(n))).hexdigest() for n in lengths
    ]
    assert run(tmp_path, script) == expected


def test_a_page_names_its_core_and_its_scene() -> None:
    """The page itself finds the digest of the text."""
    path = example("truck-shaft.toml")
    found = live(Answer(Scene.load(path)))
    assert found is not None
    data = found["data"]
    assert data["core"] == (WEB / "sources.sha256").read_text().strip()
    assert data["title"] == Scene.load(path).title
    assert data["source"]["text"].encode() == path.read_bytes()

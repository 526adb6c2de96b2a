"""Calls of the module for browsers over a long time, after which its memory must be as large.

``python tests/web_memory.py MINUTES`` judges a truck in five states and looks for what helps.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from importlib import resources
from pathlib import Path

import cardan

if __name__ == "__main__":
    web = Path(str(resources.files("cardan"))) / "web"
    scene = cardan.Scene.load(web.parent / "app/scene/machines/truck-shaft.toml")
    asked = {"endure": [cardan.scene.machine_data(scene), 60.0 * float(sys.argv[1])]}
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "asked.json"
        file.write_text(json.dumps(asked))
        command = ["node", str(Path(__file__).with_name("calls.mjs")), str(web), str(file)]
        done = subprocess.run(command, capture_output=True, text=True, check=True)
    early, late = json.loads(done.stdout)["memory"]
    print(f"{early} bytes after two rounds, {late} bytes at the end")
    sys.exit(early != late)

"""What the README shows is what happens."""

from __future__ import annotations

import re
import tomllib
from contextlib import redirect_stdout
from io import StringIO
from itertools import pairwise
from pathlib import Path

import pytest
from click.testing import CliRunner

from cardan.app.command import commands
from oracle import OUTPUT_LIMITS

ROOT = Path(__file__).parents[2]
README = (ROOT / "README.md").read_text(encoding="utf-8")
SNIPPETS = re.findall(r"```(\w+)\n(.*?)```", README, re.DOTALL)


def test_the_python_snippets_print_what_stands_below_them() -> None:
    names: dict[str, object] = {}
    compared = 0
    for (language, code), (following, shown) in pairwise(SNIPPETS):
        if language == "python":
            assert following == "text"
            printed = StringIO()
            with redirect_stdout(printed):
                exec(code, names)
            assert printed.getvalue() == shown
            compared += 1
    assert compared == 2


def test_the_first_scene(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    command = next(code for language, code in SNIPPETS if "cardan run" in code)
    scene = re.search(r"cardan run (\S+)", command)
    assert scene is not None
    shown = next(code for language, code in SNIPPETS if language == "text")
    monkeypatch.chdir(tmp_path)
    result = CliRunner().invoke(commands(), ["run", str(ROOT / scene[1])])
    assert result.exit_code == 0, result.output
    assert result.output == shown
    shown = next(code for language, code in SNIPPETS if language == "toml")
    assert tomllib.loads(shown) == tomllib.loads((ROOT / scene[1]).read_text(encoding="utf-8"))


def test_the_accuracy_table_has_the_limits() -> None:
    table = README.split("## Accuracy and speed")[1].split("\n## ")[0]
    rows = re.findall(r"^\| `([^`]+)`.*? \| (\d+) ulp \| (\d+) ulp \|.*\| (\d+) ulp", table, re.M)
    assert len(rows) == table.count("\n| `") == 6
    for name, *shown in rows:
        row = OUTPUT_LIMITS[name]
        columns = (row["samples"], row["worst"], row["tolerance_0"])
        assert tuple(map(int, shown)) == columns, name

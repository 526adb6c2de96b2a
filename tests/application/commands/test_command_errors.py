"""What the command says when something is wrong: one line on stderr, exit status 2."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from cardan.app.command import commands
from scripts import SCRIPT, failed, posix, run, script

# What can go wrong: one line on stderr, exit status 2


def test_usage_errors(scene: Path) -> None:
    assert run("rnu").output.startswith("cardan: No such command 'rnu'.")
    failed(run("run"), "Missing argument 'SCENE'.")
    assert run("run", scene, "--onto").output.startswith("cardan: No such option")
    failed(
        run("run", scene, "--into", "missing"),
        "Invalid value for '--into': Directory 'missing' does not exist.",
    )


@pytest.mark.parametrize(
    ("module", "command", "message"),
    [
        ("pyarrow", "run", "this needs pyarrow: pip install 'cardan[table]'"),
        ("matplotlib", "run", "a picture needs matplotlib: pip install 'cardan[plot]'"),
        ("matplotlib", "plot", "a picture needs matplotlib: pip install 'cardan[plot]'"),
        ("jinja2", "report", "this needs jinja2: pip install 'cardan[app]'"),
    ],
)
def test_missing_extra(
    scene: Path,
    into: Path,
    module: str,
    command: str,
    message: str,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """It is noticed before the work is done."""

    def work(*_: object) -> None:
        raise AssertionError

    monkeypatch.setattr("cardan.app.scene.Scene.run", work)
    monkeypatch.chdir(into)
    scene.write_text(scene.read_text().replace("a.csv", "a.parquet"))
    monkeypatch.setitem(sys.modules, module, None)
    failed(run(command, scene), message)
    assert list(into.iterdir()) == []


def test_without_click() -> None:
    """As after an installation without extras."""
    script = "import sys; sys.modules['click'] = None; from cardan.app.command import main; main()"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (2, "")
    assert done.stderr == "cardan: the command needs click: pip install 'cardan[app]'\n"


def test_memory(scene: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def exhausted(*_: object) -> None:
        raise MemoryError

    monkeypatch.setattr("cardan.app.scene.Scene.run", exhausted)
    failed(run("run", scene), "not enough memory; fewer samples or a smaller study need less")


GAPS = """\
title = "Gaps"
[angles]
file = "gaps.csv"
angle_column_deg = "crank"
bend_columns_deg = ["front"]
[load]
output_torque_Nm = 100
[output]
curves = "c.csv"
picture = "c.svg"
reduce = ["peak", "mean"]
"""


def test_missing_samples(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """They keep their place, are NaN in the curves, count in no figure, and are told."""
    monkeypatch.chdir(tmp_path)
    Path("gaps.toml").write_text(GAPS)
    rows = [[str(10 * i), str(5 + i / 10)] for i in range(37)]

    def written(rows: list[list[str]]) -> str:
        lines = ["crank,front", *(",".join(row) for row in rows)]
        Path("gaps.csv").write_text("\n".join(lines) + "\n")
        result = run("run", "gaps.toml")
        assert result.exit_code == 0, result.output
        return result.output

    kept = [row for i, row in enumerate(rows) if i not in (0, 5, 36)]
    text = written(kept)
    whole = Path("c.csv").read_text().splitlines()
    rows[0][1], rows[5][0], rows[36][1] = "", " ", "NaN"
    said = "3 of 37 samples are missing in gaps.csv; their results are NaN.\n\n"
    assert written(rows).replace(said, "") == text.replace("34 rows", "37 rows")
    lines = Path("c.csv").read_text().splitlines()
    assert [i for i, line in enumerate(lines[1:]) if set(line.split(",")) == {"nan"}] == [0, 5, 36]
    assert [line for line in lines if "nan" not in line] == whole
    angles = json.loads(run("run", "gaps.toml", "--json").stdout)["drive_angles"]
    assert (angles["samples"], angles["missing_samples"]) == (37, 3)
    assert (angles["first_deg"], angles["last_deg"]) == (10.0, 350.0)
    counts = json.loads(run("check", "gaps.toml", "--json").output)["limits"]["counts"]
    assert (counts.pop("counted"), counts["within"]) == ("samples", 0)
    assert sum(counts.values()) == 34
    assert run("report", "gaps.toml").exit_code == 0
    page = Path("gaps.html").read_text()
    assert "34 samples; 3 missing samples are left out" in page
    assert not re.search(r"\bnan\b", page, re.IGNORECASE)


def test_bends_out_of_range_name_the_line(tmp_path: Path) -> None:
    path = tmp_path / "gaps.toml"
    path.write_text(GAPS)
    (tmp_path / "gaps.csv").write_text("crank,front\n0,5\n\n1,95\n")
    failed(
        run("run", path),
        f"{path}, line 2: [angles] {tmp_path / 'gaps.csv'}: line 4, column 'front' is 95.0; "
        "a bend must lie in [0, 90) deg",
    )


def test_figure_of_a_study_that_is_unknown(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    Path("a.toml").write_text("[driveline]\nbends_deg = [8]\n[study]\nbends_deg = [1, 2]\n")
    failed(
        run("plot", "a.toml", "--study", "equivalent_bent"),
        "--study is 'equivalent_bent'; did you mean 'equivalent_bend'?",
    )
    Path("a.toml").write_text("[driveline]\nbends_deg = [8]\n[output]\nreduce = 'peak'\n")
    failed(
        run("plot", "a.toml", "--study", "equivalent_bend"),
        "the study varies no key; a picture shows 1 or 2",
    )


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (
            'title = "C:\\Users"\n',
            "not TOML: Invalid hex value (at line 1, column 14); "
            "a path with backslashes needs single quotes",
        ),
        *(
            (
                f"[driveline]\nbends_deg = {given}\n",
                "not TOML: Expected newline or end of document after a statement (at line 2, "
                f"column {column}); a decimal has a point (8.5), a list has brackets ([8, 5])",
            )
            for given, column in (("8,5", 14), ("8.5, 9", 16), ("-12 ,3", 17))
        ),
        (
            "[load]\ninertias_kgm2 = [0, .5]\n",
            "not TOML: Invalid value (at line 2, column 21); "
            "a decimal has a digit before its point (0.5)",
        ),
        (
            "[driveline]\nphases_deg = [\u221230]\n",
            "not TOML: Invalid value (at line 2, column 15); the minus of a number is -",
        ),
        (
            "[driveline]\nbends_deg = [1]\n[states]\nbearing.0.position_mm = [1, 2]\n",
            "line 4: [states] unknown key 'bearing'; [states] varies numbers of [driveline] and "
            "[load]",
        ),
        (
            "# a\u2028b\n[driveline]\nbends_deg = [2021-01-01]\n",
            "line 3: [driveline] bends_deg[0] is 2021-01-01; it must be a number",
        ),
        (
            "[driveline]\npoints_mm = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]\n",
            "line 2: [driveline] points_mm give joint 0 a bend of 135 deg at point 1, "
            "between points 0 and 2; a bend must lie in [0, 90) deg",
        ),
    ],
)
def test_messages_of_scenes(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "a.toml"
    path.write_text(text, encoding="utf-8")
    separator = ", " if message.startswith("line") else ": "
    failed(run("run", path), f"{path}{separator}{message}")


def test_terminal_that_lacks_characters(into: Path) -> None:
    (into / "a.toml").write_text(
        'title = "Föppl\'s rig"\n[driveline]\nbends_deg = [8.5]\n', "utf-8"
    )
    environment = {**os.environ, "PYTHONIOENCODING": "iso8859-5"}
    done = script("run", "a.toml", cwd=into, env=environment)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.startswith("F?ppl's rig")


def unread(*arguments: str | Path) -> subprocess.CompletedProcess[str]:
    """As in "cardan … | head -1", where head ends first."""
    assert SCRIPT, "the script cardan is not installed"
    reader, writer = os.pipe()
    os.close(reader)
    try:
        return subprocess.run(
            [SCRIPT, *arguments], stdout=writer, stderr=subprocess.PIPE, text=True
        )
    finally:
        os.close(writer)


@posix
@pytest.mark.parametrize("options", [[], pytest.param(["--json"], marks=pytest.mark.long)])
def test_files_are_written_though_nobody_reads(scene: Path, into: Path, options: list[str]) -> None:
    done = unread("run", scene, "--into", into, *options)
    assert done.stderr == ""
    assert sorted(path.name for path in into.iterdir()) == ["a.csv", "a.svg"]


@pytest.mark.parametrize("name", ["", *sorted(commands().list_commands(None))])  # type: ignore[arg-type]
def test_help_parts_no_name_of_an_option(name: str) -> None:
    said = run(*filter(None, [name]), "--help").output
    assert not re.search(r'(?m)(?:^|[\s"])--?$', said)

"""Spreadsheets: states and studies from the columns of tables, answers and curves as workbooks."""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator, Sequence
from datetime import date
from pathlib import Path
from typing import Any

import numpy as np
import openpyxl
import pytest

import scripts
from cardan.app.files import columns as files
from cardan.app.files.columns import write_columns
from cardan.app.files.sheets import SHEET_ROWS, write_sheets
from cardan.app.scene import Scene
from cardan.app.scene.changes import pieces
from cardan.app.scene.starters import STARTERS
from cardan.app.scene.study.curves import study_columns

LINE = """\
[driveline]
points_mm = [[0, 0, 0], [300, 0, 0], [1500, -100, 0], [1800, -150, 0]]
[load]
speed_rpm = 1000
output_torque_Nm = 100
[sweep]
samples_per_turn = 16
"""

HEADS = ["names", "weights", "points_mm.3.y", "points_mm.2.y.add", "output_torque_Nm"]
# 7 is a name; openpyxl writes 16 digits.
ROWS: list[list[Any]] = [
    ["low", 1, -180.1, -3, 100],
    [7, 2.5, -150, 0, 120],
    ["high", 1, -33.33333333333333, 4, 150],
]
WRITTEN = """\
[states]
names = ["low", "7", "high"]
weights = [1, 2.5, 1]
"points_mm.3.y" = [-180.1, -150, -33.33333333333333]
"points_mm.2.y" = {add = [-3, 0, 4]}
output_torque_Nm = [100, 120, 150]
"""


def save(path: Path, rows: Sequence[Sequence[object]], title: str = "Heights") -> None:
    """Write a sheet as a user has one."""
    book = openpyxl.Workbook()
    sheet = book.active
    assert sheet
    sheet.title = title
    for row in rows:
        sheet.append(list(row))
    book.save(path)


def read(path: Path) -> dict[str, list[dict[str, Any]]]:
    """The rows of each sheet by head; of one with keys and values a single row."""
    found = {}
    for sheet in openpyxl.load_workbook(path).worksheets:
        head, *rows = sheet.iter_rows(values_only=True)
        if head[:2] == ("key", "value"):
            head, rows = zip(*((key, value) for key, value, *_ in rows), strict=True)
            rows = [rows]
        assert len(set(head)) == len(head) or sheet.title == "answer", sheet.title
        found[sheet.title] = [dict(zip(head, row, strict=True)) for row in rows]
    return found


# --- states and studies ---------------------------------------------------------------------------


@pytest.mark.parametrize("kind", ["comma", "semicolon", "xlsx", "sheet", "both", "gaps"])
def test_states_of_a_table_are_those_written_in_the_scene(kind: str, tmp_path: Path) -> None:
    section, path = '[states]\nfile = "a.xlsx"\n', tmp_path / "a.xlsx"
    rows: list[list[Any]] = [HEADS, *ROWS]
    if kind in ("comma", "semicolon"):
        mark = "," if kind == "comma" else ";"
        lines = [mark.join(map(str, row)) for row in rows]
        if kind == "semicolon":
            lines = [line.replace(".", ",") for line in lines[1:]]
            lines.insert(0, mark.join(HEADS))
        (tmp_path / "a.csv").write_text("\n".join(lines), encoding="utf-8-sig")
        section = section.replace("xlsx", "csv")
    elif kind == "gaps":
        # Empty rows and columns, and blanks about a head.
        save(path, [[], [" names ", None, *HEADS[1:]], [], *([a, None, *b] for a, *b in ROWS), []])
    else:
        save(path, rows)
    if kind == "sheet":
        book = openpyxl.load_workbook(path)
        book.create_sheet("Notes").append(["nothing"])
        book.save(path)
        section += 'sheet = "Heights"\n'
    if kind == "both":
        save(path, [row[1:] for row in rows])
        section += 'names = ["low", "7", "high"]\n'
    found, written = (Scene.parse(LINE + text, folder=tmp_path) for text in (section, WRITTEN))
    assert found.states
    assert written.states
    assert found.states.names == written.states.names
    assert found.states.weights.tolist() == written.states.weights.tolist()
    for own, other in zip(found.states.axes, written.states.axes, strict=True):
        assert own.key == other.key
        np.testing.assert_array_equal(own.values, other.values)
    assert found.quantities == written.quantities
    result, wanted = found.run().study, written.run().study
    assert result
    assert wanted
    for name, column in study_columns(wanted).items():
        np.testing.assert_array_equal(study_columns(result)[name], column)


@pytest.mark.parametrize("suffix", [".csv", ".xlsx"])
def test_columns_of_a_study_make_a_grid(suffix: str, tmp_path: Path) -> None:
    rows: list[list[Any]] = [
        ["points_mm.3.y", "speed_rpm"],
        [-200, 500],
        [-150, 1500],
        [-100, None],
    ]
    if suffix == ".xlsx":
        save(tmp_path / "a.xlsx", rows)
    else:
        lines = (",".join("" if cell is None else str(cell) for cell in row) for row in rows)
        (tmp_path / "a.csv").write_text("\n".join(lines))
    text = f'{LINE}[study]\nfile = "a{suffix}"\noutput_torque_Nm = [1, 2]\n'
    study = Scene.parse(text, folder=tmp_path).study
    assert study
    found = {axis.key: axis.values.tolist() for axis in study.axes}
    assert found == {
        "output_torque_Nm": [1, 2],
        "points_mm.3.y": [-200, -150, -100],
        "speed_rpm": [500, 1500],
    }
    assert study.shape == (2, 3, 2)


def test_heads_in_us_units(tmp_path: Path) -> None:
    line = "[driveline]\npoints_in = [[0, 0, 0], [12, 0, 0], [60, -4, 0], [72, -6, 0]]\n[load]\n"
    line += "speed_rpm = 1000\noutput_torque_lbft = 100\n"
    save(tmp_path / "a.xlsx", [["points_in.3.y", "output_torque_lbft"], [-7.3, 90], [-6, 120]])
    found = Scene.parse(line + '[states]\nfile = "a.xlsx"\n', folder=tmp_path).states
    text = '[states]\n"points_in.3.y" = [-7.3, -6]\noutput_torque_lbft = [90, 120]\n'
    written = Scene.parse(line + text).states
    assert found
    assert written
    bends, wanted = (own.drivelines().equivalent().bend for own in (found, written))
    np.testing.assert_array_equal(bends, wanted)
    loads = [states.load(1) for states in (found, written)]
    assert loads[0]
    assert loads[1]
    assert loads[0].torque == loads[1].torque
    save(tmp_path / "a.xlsx", [["output_torque_Nm", "output_torque_lbft"], [1, 2]])
    with pytest.raises(ValueError, match="and output_torque_Nm are both given; give one of them"):
        Scene.parse(line + '[states]\nfile = "a.xlsx"\n', folder=tmp_path)


def test_a_size_of_the_sheet_that_is_too_small_is_not_believed(tmp_path: Path) -> None:
    import zipfile

    save(tmp_path / "whole.xlsx", [HEADS, *ROWS])
    with (
        zipfile.ZipFile(tmp_path / "whole.xlsx") as whole,
        zipfile.ZipFile(tmp_path / "a.xlsx", "w") as changed,
    ):
        for name in whole.namelist():
            text = whole.read(name).replace(b'<dimension ref="A1:E4"', b'<dimension ref="A1:C2"')
            changed.writestr(name, text)
            assert name != "xl/worksheets/sheet1.xml" or b"A1:C2" in text
    scene = Scene.parse(LINE + '[states]\nfile = "a.xlsx"\n', folder=tmp_path)
    assert scene.states
    assert scene.states.count == 3


Y = "points_mm.3.y"
SHEET = "a.xlsx, sheet 'Heights'"


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ([[Y], [1], ["x"]], f"{SHEET}, row 3, column '{Y}' is 'x'; it must be a number"),
        ([[Y], [1], ["1,5"]], f"{SHEET}, row 3, column '{Y}' is '1,5'; it must be a number"),
        ([[Y], [True]], f"{SHEET}, row 2, column '{Y}' is true; it must be a number"),
        ([[Y], [date(2020, 1, 2)]], f"{SHEET}, row 2, column '{Y}' is 2020-01-02T00:00:00; it"),
        ([[Y], [1e50]], f"{SHEET}, row 2, column '{Y}' is 1e+50; it must lie within ±1e+40"),
        ([[Y], [1], ["#DIV/0!"]], f"{SHEET}, row 3, column '{Y}' is '#DIV/0!'; it must be a"),
        ([[Y, "weights"], [1, 2], [3, -1]], "row 3, column 'weights' is -1; a weight must not be"),
        ([[Y, "names"], [1, "a"], [2, "a"]], "row 3, column 'names' is 'a' again; name each once"),
        ([[Y, "speed_rpm"], [1, 2], [3]], "row 3, column 'speed_rpm' is empty; each state needs"),
        ([[Y, "speed_rpm"], [1], [3]], f"{SHEET}, column 'speed_rpm' has no values"),
        (
            [[Y], [1], ["=A2+1"]],
            f"{SHEET}, cell A3 is the formula '=A2+1' without a value; open and save the file in",
        ),
        ([[Y, "point_mm.2.y"], [1, 2]], "column 'point_mm.2.y' is no key of [states]; did you me"),
        ([["points_cm.3.y"], [1]], "is no key of [states]; the name includes the unit: "),
        ([[Y, "bearing.0.position_mm"], [1, 2]], "is no key of [states]; known are names, weight"),
        ([["points_mm"], [1]], "column 'points_mm' is [1]; name place and axis, as in points_mm."),
        ([["points_mm.2.w"], [1]], "column 'points_mm.2.w' has no 'w'; known are x, y, z"),
        ([["points_mm.9.y"], [1]], "points_mm.9.y does not exist; there are 4, counted from 0"),
        ([[Y, None], [1, 2]], f"{SHEET}, row 1: the head of column 2 is empty; it must be text"),
        ([[Y, 5], [1, 2]], f"{SHEET}, row 1: the head of column 2 is 5; it must be text"),
        ([[Y, Y], [1, 2]], f"{SHEET}, row 1: column '{Y}' is there twice"),
        ([[Y, f"{Y}.add"], [1, 2]], f"column '{Y}.add' gives what the scene or another column"),
        ([[Y]], f"{SHEET} has heads but no rows"),
        ([], f"{SHEET} is empty; it needs a row of heads and rows below it"),
        ([["names"], ["a"]], "no key varies; give one value per state"),
    ],
)
def test_errors_in_a_sheet(rows: list[list[object]], message: str, tmp_path: Path) -> None:
    save(tmp_path / "a.xlsx", rows)
    with pytest.raises(ValueError, match=r"^scene, line \d+: \[states\] ") as error:
        Scene.parse(LINE + '[states]\nfile = "a.xlsx"\n', folder=tmp_path)
    assert message in str(error.value).replace(str(tmp_path / "a.xlsx"), "a.xlsx")


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (f"{Y}\n1\nx\n", f"a.csv, line 3, column '{Y}' is 'x'; it must be a number"),
        (f'{Y}\n"1,5"\n', "line 2, column 'points_mm.3.y' is '1,5'; it must be a number, with a"),
        (f"{Y};speed_rpm\n1;1.000,5\n", "column 'speed_rpm' is '1.000,5'; it must be a number"),
        (f"{Y}\nnan\n", f"a.csv, line 2, column '{Y}' is nan; it must be finite"),
        (f"{Y}\ninf\n", f"a.csv, line 2, column '{Y}' is inf; it must be finite"),
        (f"{Y},speed_rpm\n1,2\n3,5,2\n", "a.csv: line 3 has 3 cells, the header 2; every row mus"),
        (f"{Y},speed_rpm\n1\n", "a.csv: line 2 has 1 cell, the header 2; every row must have as"),
        ("", "a.csv is empty; it needs a row of heads"),
        ("\udcff", "a.csv: not UTF-8 text at byte 0"),
    ],
)
def test_errors_in_a_csv_file(text: str, message: str, tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_bytes(text.encode(errors="surrogateescape"))
    with pytest.raises(ValueError, match=r"^scene, line \d+: \[states\] ") as error:
        Scene.parse(LINE + '[states]\nfile = "a.csv"\n', folder=tmp_path)
    assert message in str(error.value).replace(str(tmp_path / "a.csv"), "a.csv")


@pytest.mark.parametrize(
    ("rows", "section", "message"),
    [
        ([[Y], [1]], '[states]\nfile = "a.xlsx"\nsheet = "H"', "has no sheet 'H'; there are 'Heig"),
        ([[Y], [1]], '[states]\nfile = "two.xlsx"', "has the sheets 'A', 'B'; name one with sheet"),
        (
            [[Y], [1]],
            '[states]\nfile = "a.csv"\nsheet = "H"',
            "has no sheets; leave out sheet",
        ),
        ([[Y], [1]], '[states]\nfile = "bad.xlsx"', "not a readable XLSX file: File is not a zip"),
        ([[Y], [1]], '[states]\nfile = "zip.xlsx"', "not a readable XLSX file: "),
        ([[Y], [1]], '[states]\nfile = "a.xls"', "file is 'a.xls'; it must end in .csv or .xlsx"),
        ([[Y], [1]], f'[states]\nsheet = "A"\n"{Y}" = [1]', "sheet needs file, which is missing"),
        ([[Y], [1]], f'[states]\nfile = "a.xlsx"\n"{Y}" = [1]', "gives what the scene or another"),
        ([["names", Y], ["a", 1]], '[states]\nfile = "a.xlsx"\nnames = ["b"]', "'names' gives wh"),
        ([[Y], [1]], '[states]\nfile = "a.xlsx"\nspeed_rpm = [1, 2]', "each state needs one"),
        (
            [["output_torque_Nm", "drive_torque_Nm"], [1, 2]],
            '[states]\nfile = "a.xlsx"',
            "are both given; give one of them",
        ),
        (
            [[Y, "speed_rpm"], [1], [2, 3]],
            '[study]\nfile = "a.xlsx"',
            "row 2, column 'speed_rpm' is empty; values follow below it",
        ),
        ([[Y, "names"], [1, "a"]], '[study]\nfile = "a.xlsx"', "'names' is no key of [study]; "),
        ([[Y], [1], ["=1"]], '[study]\nfile = "a.xlsx"', "cell A3 is the formula '=1' without"),
    ],
)
def test_errors_of_tables(
    rows: list[list[object]], section: str, message: str, tmp_path: Path
) -> None:
    import zipfile

    save(tmp_path / "a.xlsx", rows)
    book = openpyxl.Workbook()
    book.worksheets[0].title = "A"
    book.create_sheet("B")
    book.save(tmp_path / "two.xlsx")
    (tmp_path / "bad.xlsx").write_text("no")
    with zipfile.ZipFile(tmp_path / "zip.xlsx", "w") as archive:
        archive.writestr("a", "b")
    with pytest.raises(ValueError, match=r"^scene, line \d+: \[stat|stud") as error:
        Scene.parse(f"{LINE}{section}\n", folder=tmp_path)
    assert message in str(error.value)


def test_what_is_not_there(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    text = LINE + '[states]\nfile = "a.xlsx"\n'
    with pytest.raises(FileNotFoundError):
        Scene.parse(text, folder=tmp_path)
    save(tmp_path / "a.xlsx", [HEADS, *ROWS])
    monkeypatch.setitem(sys.modules, "openpyxl", None)
    with pytest.raises(ImportError, match=r"needs openpyxl: pip install 'cardan\[app\]'"):
        Scene.parse(text, folder=tmp_path)


def test_what_a_scene_reads_is_not_overwritten(tmp_path: Path) -> None:
    (tmp_path / "a.csv").write_text(f"{Y}\n1\n2\n")
    save(tmp_path / "a.xlsx", [[Y], [1], [2]])
    (tmp_path / "sizes.csv").write_text("size,rating_Nm\nA,100\n")
    scene = tmp_path / "a.toml"
    table = '[output]\ntable = "{0}"\n[{1}]\n{2} = "{0}"\n'
    for name, section, key in (
        ("a.csv", "states", "file"),
        ("a.xlsx", "study", "file"),
        ("sizes.csv", "joints", "sizes"),
    ):
        more = "" if section != "joints" else "[study]\nspeed_rpm = [1]\n"
        scene.write_text(LINE + table.format(name, section, key) + more)
        before = (tmp_path / name).read_bytes()
        result = scripts.run("run", scene, "--into", tmp_path)
        assert result.exit_code == 2, result.output
        assert f"is the file of [{section}] that the scene reads" in result.output
        assert (tmp_path / name).read_bytes() == before
    scene.write_text(LINE + '[states]\nfile = "a.xlsx"\n')
    result = scripts.run("check", scene, "--workbook", tmp_path / "a.xlsx")
    assert "is the file of [states] that the scene reads" in result.output


def test_a_page_has_no_place_for_what_a_table_gives(tmp_path: Path) -> None:
    """A scene that is saved without it would say another thing than the page shows."""
    (tmp_path / "a.csv").write_text(f"{Y},points_mm.2.y.add\n1,2\n2,3\n")
    scene = Scene.parse(LINE + '[states]\nfile = "a.csv"\n', folder=tmp_path)
    found = {
        (each["variable"], each["item"], each["axis"])
        for piece in pieces(scene)
        for each in piece["numbers"]
    }
    assert ("point", 3, 1) not in found
    assert {("point", 3, 0), ("point", 3, 2), ("point", 2, 1), ("speed", 0, None)} <= found


# --- answers --------------------------------------------------------------------------------------


def leaves(value: object, path: tuple[object, ...] = ()) -> Iterator[tuple[tuple[Any, ...], Any]]:
    """Every value of an answer with its path: keys, and of items in lists number, key and value."""
    if isinstance(value, dict):
        for key, each in value.items():
            yield from leaves(each, (*path, key))
    elif isinstance(value, list):
        for number, each in enumerate(value):
            if not isinstance(each, dict):
                yield from leaves(each, (*path, str(number)))
            elif each.keys() == {"key", "value"} and not isinstance(each["value"], list):
                yield (*path, each["key"]), each["value"]
            else:
                yield from leaves(each, (*path, (number, *next(iter(each.items())))))
    else:
        yield path, value


def cell_of(book: dict[str, list[dict[str, Any]]], path: Sequence[Any]) -> Any:  # noqa: ANN401
    """The cell of a value of an answer."""
    owners: dict[str, Any] = {}
    sheet, row, head = path[0], 0, []
    for step in path[1:]:
        if isinstance(step, str):
            head.append(step)
            continue
        rows = [*owners.items()]
        number, key, value = step
        if len(head) > 1 and head[-1] == "states":
            sheet, head, row = f"{sheet}.states", head[:-1], 0
            rows.append((key, value))
        else:
            sheet, head, row = ".".join([sheet, *head]), [], number
        wanted, owners = dict(rows), {**owners, key: value}
        book = {**book, sheet: [each for each in book[sheet] if wanted.items() <= each.items()]}
    in_state = sheet.endswith(".states") and head[-1] == "state"
    return book[sheet][row]["state" if in_state else ".".join(head)]


def check_answer(data: dict[str, Any], path: Path) -> int:
    """Compare a workbook with the answer in JSON, and return how many numbers are alike."""
    book = read(path)
    first = openpyxl.load_workbook(path).worksheets[0]
    assert first.title == "answer"
    said = [tuple(cell for cell in row if cell is not None) for row in first.values]
    numbers = 0
    for key, value in data.items():
        rows = [row for row in said if row[0] == key]
        if not isinstance(value, dict | list):
            assert rows == [(key, *([] if value in ("", None) else [value]))]
        elif all(isinstance(each, str) for each in value) and isinstance(value, list):
            assert rows == [(key, text) for text in value] or rows == [(key,)] * (not value)
        elif isinstance(value, list) and all(
            isinstance(each, str) for item in value for each in item.values()
        ):
            assert rows == [(key, *item.values()) for item in value]
        else:
            for place, leaf in leaves(value, (key,)):
                cell = cell_of(book, place)
                assert cell == (None if leaf == "" else leaf), place
                assert is_alike(cell, leaf), place
                numbers += isinstance(leaf, float)
    return numbers


def is_alike(cell: object, leaf: object) -> bool:
    """Whether numbers are numbers, and truth is no number."""
    if cell is None or isinstance(leaf, bool) or isinstance(cell, bool):
        return cell is None or (isinstance(leaf, bool) and isinstance(cell, bool))
    return isinstance(cell, str) == isinstance(leaf, str)


MACHINES = [kind for kind, starter in STARTERS.items() if starter.machine]


def check_machine(machine: str, folder: Path, command: str) -> int:
    scene, path = folder / "a.toml", folder / "answer.xlsx"
    scene.write_text(STARTERS[machine].text, encoding="utf-8")
    into = ("--into", folder) if command == "run" else ()
    result = scripts.run(command, scene, *into, "--json", "--workbook", path)
    assert result.exit_code < 2, result.output
    data = json.loads(result.output)
    if command == "run":
        assert data["files"].pop() == {"file": str(path)}
    assert [entry for entry in folder.iterdir() if entry.suffix == ".part"] == []
    return check_answer(data, path)


@pytest.mark.long
@pytest.mark.parametrize("command", ["check", "run"])
@pytest.mark.parametrize("machine", MACHINES)
def test_workbooks_of_machines_have_the_numbers_of_the_json(
    machine: str, command: str, tmp_path: Path
) -> None:
    assert len(MACHINES) == 6
    assert check_machine(machine, tmp_path, command) > 20


def test_a_workbook_has_the_numbers_of_the_json(tmp_path: Path) -> None:
    assert check_machine("steering-column", tmp_path, "check") > 40


@pytest.mark.long
@pytest.mark.parametrize("command", ["life", "tolerances", "torsion", "phase"])
def test_every_command_writes_its_tables(command: str, tmp_path: Path) -> None:
    assert check_machine("truck-shaft", tmp_path, command) > 4


def test_the_first_sheet_says_the_verdict(tmp_path: Path) -> None:
    scene, path = tmp_path / "a.toml", tmp_path / "answer.xlsx"
    scene.write_text('title = "=1+1"\n' + LINE + "[limits]\nequivalent_bend_deg = 0.01\n")
    result = scripts.run("check", scene, "--workbook", path)
    assert result.exit_code == 1
    assert result.output.endswith(f"wrote {path} (3 sheets)\n")
    sheet = openpyxl.load_workbook(path)["answer"]
    rows = [*sheet.values]
    assert rows[0][:2] == ("key", "value")
    assert ("title", "=1+1", None) in rows
    assert ("verdict", "beyond", None) in rows
    assert ("beyond", "limits.equivalent_bend", "equivalent bend") in rows
    assert any(key == "not_judged" for key, *_ in rows)
    assert {cell.data_type for row in sheet.iter_rows() for cell in row} <= {"s", "n", "b"}


@pytest.mark.parametrize("command", ["check", "run", "life", "phase"])
def test_a_workbook_that_cannot_be_written_is_refused_first(
    command: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    scene = tmp_path / "a.toml"
    scene.write_text(LINE)
    result = scripts.run(command, scene, "--workbook", tmp_path / "a.csv")
    assert (result.exit_code, result.stdout) == (2, "")
    assert "a.csv must end in .xlsx" in result.output
    result = scripts.run(command, scene, "--workbook", tmp_path / "none" / "a.xlsx")
    assert (result.exit_code, result.stdout) == (2, "")
    monkeypatch.setitem(sys.modules, "openpyxl", None)
    result = scripts.run(command, scene, "--workbook", tmp_path / "a.xlsx")
    assert (result.exit_code, result.stdout) == (2, "")
    assert "this needs openpyxl: pip install 'cardan[app]'" in result.output
    assert [*tmp_path.iterdir()] == [scene]


def test_a_workbook_is_not_a_file_of_the_scene(tmp_path: Path) -> None:
    scene = tmp_path / "a.toml"
    scene.write_text(LINE + '[output]\ncurves = "a.xlsx"\n')
    result = scripts.run("run", scene, "--into", tmp_path, "--workbook", tmp_path / "a.xlsx")
    assert "is a file that the scene writes" in result.output
    assert [*tmp_path.iterdir()] == [scene]


# --- files ----------------------------------------------------------------------------------------


def test_curves_and_studies_as_workbooks(tmp_path: Path) -> None:
    scene = tmp_path / "a.toml"
    output = '[output]\ncurves = "curves.{0}"\ntable = "study.{0}"\n[study]\nspeed_rpm = [1, 2]\n'
    for suffix in ("csv", "xlsx"):
        scene.write_text(LINE + output.format(suffix))
        result = scripts.run("run", scene, "--into", tmp_path)
        assert result.exit_code == 0, result.output
        assert f"wrote {tmp_path / 'curves'}.{suffix} (17 rows)" in result.output
    for name in ("curves", "study"):
        head, *lines = (tmp_path / f"{name}.csv").read_text().splitlines()
        (sheet,) = openpyxl.load_workbook(tmp_path / f"{name}.xlsx").worksheets
        found, *rows = sheet.values
        assert list(found) == head.split(",")
        assert rows == [tuple(map(float, line.split(","))) for line in lines]


def test_every_digit_and_what_is_no_number(tmp_path: Path) -> None:
    values = np.array([0.1 + 0.2, 5e-324, -1e22, 1e300, 1 / 3, -0.0, np.nan, np.inf])
    write_columns(tmp_path / "a.xlsx", {"a": values, "b": np.arange(8.0)})
    (sheet,) = openpyxl.load_workbook(tmp_path / "a.xlsx").worksheets
    _, *rows = sheet.values
    assert [row[0] for row in rows] == [*values[:6].tolist(), None, None]
    assert [row[1] for row in rows] == [*range(8)]


def test_texts_are_texts(tmp_path: Path) -> None:
    texts = ["=1+1", "#N/A", "12", "a\x07b\ud800", " x ", "1e5", "+1", "@a"]
    with (tmp_path / "a.xlsx").open("wb") as file:
        write_sheets(file, {"a": [("head",), *((text,) for text in texts)]})
    (sheet,) = openpyxl.load_workbook(tmp_path / "a.xlsx").worksheets
    assert {cell.data_type for row in sheet.iter_rows() for cell in row} == {"s"}
    texts[3] = "a\\x07b\\ud800"
    assert [row[0] for row in sheet.values] == ["head", *texts]


def test_too_many_rows_are_refused_first(tmp_path: Path) -> None:
    scene = tmp_path / "a.toml"
    study = f"[study]\nspeed_rpm = {{from = 1, to = 2, steps = {SHEET_ROWS}}}\n"
    scene.write_text(LINE + '[output]\ntable = "a.xlsx"\n' + study)
    result = scripts.run("run", scene, "--into", tmp_path)
    assert f"{SHEET_ROWS} rows are too many for a sheet, which has {SHEET_ROWS}" in result.output
    assert [*tmp_path.iterdir()] == [scene]
    files.check_rows("a.xlsx", SHEET_ROWS - 1)
    files.check_rows("a.csv", SHEET_ROWS)

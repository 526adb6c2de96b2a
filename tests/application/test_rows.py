"""What the figures of answers are called, their keys with units, and what limits them: a record.

Programs read the keys and people the labels, so neither changes unnoticed. This file, run as a
program, writes the record anew.
"""

from __future__ import annotations

import ast
import math
import re
from collections.abc import Iterator
from itertools import pairwise
from pathlib import Path

import pytest

from cardan.app.answers.identification import Identified
from cardan.app.answers.rows import UNITS, element_of, rows_of
from cardan.app.answers.states import StatesFigures
from cardan.app.answers.study import StudyFigures
from cardan.app.answers.table import PARTS
from cardan.app.answers.turn.figures import TurnFigures
from cardan.app.answers.yokes.figures import YokeFigures

# The answers of run, phase and identify, which are no parts of others.
OTHERS = {
    "run": TurnFigures,
    "run.study": StudyFigures,
    "run.states": StatesFigures,
    "phase": YokeFigures,
    "identify": Identified,
}
RECORD = Path(__file__).parent / "rows.txt"


def rows() -> Iterator[str]:
    """Yield a line for each field: its key, what it holds, its label and the key of its limit."""

    def of(path: str, figures: type) -> Iterator[str]:
        for name, row, hint in rows_of(figures):
            key = f"{path}.{name}{row.ending()}"
            yield "  ".join(filter(None, (key, row.kind, row.label, row.limit)))
            if row.kind == "parts":
                yield from of(key, element_of(hint))

    every = {name: part.figures() for name, part in PARTS.items()} | OTHERS
    for name, figures in every.items():
        yield from of(name, figures)


def test_units_are_what_they_are_called() -> None:
    """How many of each are one unit of the library: rad, m, Pa, rad/s, or a part of one."""
    turn = 2.0 * math.pi
    expected = {
        "deg": 360.0 / turn,
        "mm": 1000.0,
        "rpm": 60.0 / turn,
        "MPa": 1e-6,
        "percent": 100.0,
    }
    expected |= {"Hz": 1.0 / turn, "rpm_deg": 60.0 / turn * 360.0 / turn}
    expected |= {"GPa": 1e-9, "um_per_MPa": 1e12, "N_per_mm": 1e-3, "gmm": 1e6}
    inch, pound = 0.0254, 0.45359237
    force = 9.80665 * pound
    torque, pressure = 12.0 * inch * force, force / inch**2
    us = {"in": inch, "ft": 12.0 * inch, "lbf": force, "lbft": torque, "lbin": torque / 12.0}
    us |= {"lbin2": pound * inch**2, "lbft_per_rad": torque, "lbfts_per_rad": torque}
    us |= {"psi": pressure, "Mpsi": 1e6 * pressure, "uin_per_psi": 1e-6 * inch / pressure}
    us |= {"deg_per_klbft": 1.0 / torque, "in_per_klbft": 1000.0 * inch / torque}
    us |= {"lb": pound, "lb_in3": pound / inch**3}
    us |= {"lbf_per_in": force / inch, "lbfs_per_in": force / inch, "ozin": pound / 16.0 * inch}
    expected |= {name: 1.0 / size for name, size in us.items()}
    for name, unit in UNITS.items():
        assert unit.factor == pytest.approx(expected.get(name, 1.0), rel=1e-14), name


def written_units(path: Path) -> Iterator[str]:
    """Yield what follows a figure in the texts of a module and begins with the name of a unit."""
    symbols = sorted((unit.symbol for unit in UNITS.values()), key=len, reverse=True)
    names = "|".join(
        # Inches have the name of a word.
        re.escape(symbol)
        for symbol in symbols
        if symbol[:1] not in ("", "°", "%", "s") and symbol != "in"
    )
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        for figure, text in pairwise(node.values if isinstance(node, ast.JoinedStr) else ()):
            if isinstance(figure, ast.FormattedValue) and isinstance(text, ast.Constant):
                yield from re.findall(rf"^ ({names})(?!\w)", str(text.value))


def test_units_are_written_from_the_rows_alone() -> None:
    rooms = [RECORD.parents[2] / "python/cardan/app" / room for room in ("answers", "report")]
    found = {path: [*written_units(path)] for room in rooms for path in room.rglob("*.py")}
    assert len(found) > 50
    assert {path.name: units for path, units in found.items() if units} == {}


def test_every_figure_is_called_as_recorded() -> None:
    assert list(rows()) == RECORD.read_text(encoding="utf-8").splitlines()


if __name__ == "__main__":
    RECORD.write_text("".join(f"{row}\n" for row in rows()), encoding="utf-8")

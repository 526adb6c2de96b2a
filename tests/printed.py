"""What a command prints, read back: labels with their words, rows of tables, numbers."""

from __future__ import annotations

import re
from pathlib import Path

from click.testing import CliRunner

from cardan.command import commands
from example_scenes import example

EXAMPLES = Path(__file__).parents[1] / "examples"


def printed(command: str, name: str, *more: str | Path) -> str:
    """Return what a command prints of an example."""
    arguments = [command, str(example(f"{name}.toml")), *map(str, more)]
    result = CliRunner().invoke(commands(), arguments)
    assert result.exit_code in (0, 1), result.output
    return result.output


def blocks(text: str) -> dict[str, dict[str, str]]:
    """Return the two columns below each heading, lines that are continued put together."""
    found: dict[str, dict[str, str]] = {}
    heading, label = "", ""
    for line in text.splitlines():
        if not line.startswith("  "):
            heading, label = line, ""
        elif line.startswith("      "):
            found[heading][label] += f" {line.strip()}"
        else:
            label, _, words = line.strip().partition("  ")
            found.setdefault(heading, {})[label] = words.strip()
    return found


def rows(text: str, heading: str) -> list[list[str]]:
    """Return the cells of the table below a heading, the head first."""
    lines = text.partition(f"{heading}\n")[2].partition("\n\n")[0].splitlines()
    return [re.split(r"\s{2,}", line.strip()) for line in lines]


def first_number(text: str) -> float:
    """Return the number with which a text begins."""
    found = re.match(r"-?[\d.]+", text)
    assert found, text
    return float(found[0])

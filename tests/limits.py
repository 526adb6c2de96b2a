"""The limits of errors, from the one table of them: ``data/limits.toml`` explains its columns."""

from __future__ import annotations

import tomllib
from typing import Any

from oracle import DATA

TABLE: dict[str, Any] = tomllib.loads((DATA / "limits.toml").read_text(encoding="utf-8"))
OUTPUTS: dict[str, dict[str, Any]] = TABLE["output"]


def limits(column: str, table: str = "output") -> dict[str, Any]:
    """Return a column of limits, of those rows that have one."""
    return {name: row[column] for name, row in TABLE[table].items() if column in row}

"""What all JSON answers of the command have in common."""

from __future__ import annotations

from typing import Any, Literal

VERSION = 1
"""Version of the answers. It grows when a key changes its name or meaning, not for a new key."""


def answer(kind: Literal["run", "check", "phase"], title: str, **fields: Any) -> dict[str, Any]:  # noqa: ANN401 - plain data
    """Return an answer as plain data for JSON, with what every answer begins with."""
    return {"answer": kind, "version": VERSION, "title": title, **fields}

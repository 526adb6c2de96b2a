"""Fuzz the scene reader: ``python fuzz/scene.py [seconds]``, guided by coverage (atheris).

Whatever a file holds, it makes a scene or is refused in one line, by ``ValueError`` or ``OSError``.
"""

from __future__ import annotations

from pathlib import Path

import atheris

with atheris.instrument_imports(include=["cardan"]):
    from cardan import Scene

from cases import main

NOWHERE = Path(__file__).parent / "corpus"


def case(data: bytes) -> None:
    """Read the text as a scene, and plan what it describes."""
    text = data.decode("utf-8", "replace")
    try:
        Scene.parse(text, "a.toml", NOWHERE).plan()
    except (ValueError, OSError) as error:
        assert "\n" not in str(error), repr(str(error))


if __name__ == "__main__":
    main("scene", case, longest=2000)

"""What describes a section of a scene file and its keys."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import cardan.app.scene.language.values as kinds


@dataclass(frozen=True)
class Key:
    """One key of a scene file.

    Attributes:
        kind: what its value must be.
        meaning: one line.
        argument: the parameter of the constructor that it sets.
        factor: what to multiply the value by to get that parameter's unit.
        default: the value where the key is left out.
    """

    kind: kinds.Kind
    meaning: str
    argument: str = ""
    factor: float = 1.0
    default: Any = None


@dataclass(frozen=True)
class Section:
    """One section of a scene file.

    Attributes:
        meaning: one line.
        keys: what it may contain.
        together: keys of which at most one may be given.
        needed: keys that must be given, one of each group.
        fewest: how many keys there must be.
        with_key: pairs of a key and another that must be given with it.
        paths: whether its keys may be paths in quotes, as in ``"points_mm.2.y"``.
        repeated: whether it is an array of tables, which a scene may give any number of times.
    """

    meaning: str
    keys: Mapping[str, Key]
    together: tuple[tuple[str, str], ...] = ()
    needed: tuple[tuple[str, ...], ...] = ()
    fewest: int = 0
    with_key: tuple[tuple[str, str], ...] = ()
    paths: bool = False
    repeated: bool = False

    def heading(self, name: str) -> str:
        """Return the line that begins it in a file: ``[load]``, ``[[bearing]]``."""
        return f"[[{name}]]" if self.repeated else f"[{name}]"

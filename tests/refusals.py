"""Cases as tables: of text, and of what is refused with its message."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import pytest

KINDS = {kind.__name__: kind for kind in (ValueError, TypeError, IndexError)}


def cases(table: str) -> list[tuple[str, str]]:
    """Return what is given and what is said, each of several lines at most."""
    found: list[tuple[list[str], list[str]]] = [([], [])]
    for line in table.strip("\n").split("\n"):
        is_said = line.startswith("    ")
        if found[-1][1] and not is_said:
            found.append(([], []))
        found[-1][is_said].append(line.strip())
    return [("\n".join(given), " ".join(said)) for given, said in found]


def refusals(
    cases: Mapping[str, Any], call: Callable[..., object] | None = None
) -> Callable[[str], None]:
    """Return a test that everything in a table is refused.

    Args:
        cases: by message, a call without arguments, or the arguments of ``call``: by name, or as a
            list. Parts of a message may be left out at "…"; before it stands the kind of an error
            that is no ``ValueError``.
        call: what refuses them.
    """

    def refuse(case: Any) -> object:  # noqa: ANN401
        if call is None:
            return case()
        return call(**case) if isinstance(case, Mapping) else call(*case)

    @pytest.mark.parametrize("message", cases)
    def test(message: str) -> None:
        kind, _, words = message.partition(": ")
        if kind not in KINDS:
            kind, words = "ValueError", message
        with pytest.raises(KINDS[kind]) as caught:
            refuse(cases[message])
        text = str(caught.value)
        for part in filter(None, words.split("…")):
            assert part in text
            text = text.partition(part)[2]

    return test

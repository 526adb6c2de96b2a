"""Tables of cases as text: of what is given, and indented below it what is said of it."""

from __future__ import annotations


def cases(table: str) -> list[tuple[str, str]]:
    """Return what is given and what is said, each of several lines at most."""
    found: list[tuple[list[str], list[str]]] = [([], [])]
    for line in table.strip("\n").split("\n"):
        is_said = line.startswith("    ")
        if found[-1][1] and not is_said:
            found.append(([], []))
        found[-1][is_said].append(line.strip())
    return [("\n".join(given), " ".join(said)) for given, said in found]

"""The answer of a command as the sheets of a workbook, from its plain data."""

from __future__ import annotations

from collections.abc import Mapping
from os import PathLike
from typing import Any, TypeGuard

from cardan.app.files.sheets import Cell, write_sheets
from cardan.app.files.whole_file import whole_file

_FIRST = "answer"


def write_answer(data: Mapping[str, Any], path: str | PathLike[str]) -> int:
    """Write an answer as an XLSX file, complete or not at all; return the number of its sheets."""
    sheets = sheets_of(data)
    with whole_file(path) as file:
        write_sheets(file, sheets)
    return len(sheets)


def sheets_of(data: Mapping[str, Any]) -> dict[str, list[tuple[Cell, ...]]]:
    """Return the rows of each sheet, the head first, of an answer as plain data for JSON.

    The first sheet summarises: title, verdict, what is beyond its limit. Each
    part has a sheet, and each list of a part as well, with a row for each item. Heads are the keys
    of the JSON, which end in the unit. What figures are in each state is in one sheet for each part
    or list.
    """
    first: list[tuple[Cell, ...]] = [("key", "value")]
    tables: dict[str, dict[Any, dict[str, Cell]]] = {}
    parts: list[str] = []
    for key, value in data.items():
        if isinstance(value, dict):
            parts.append(key)
            _add(tables, key, {}, value, "")
        # Items that have words alone are said on the first sheet.
        elif _are_items(value) and not all(
            isinstance(each, str) for item in value for each in item.values()
        ):
            for item in value:
                _add(tables, key, {}, item, key)
        elif isinstance(value, list):
            cells = [tuple(each.values()) if isinstance(each, dict) else (each,) for each in value]
            first += [(key, *row) for row in cells or [()]]
        else:
            first.append((key, value))
    sheets = {_FIRST: first}
    for name, rows in tables.items():
        if not any(rows.values()):
            # What the part has is in its lists.
            continue
        if name in parts:
            sheets[name] = [("key", "value"), *next(iter(rows.values())).items()]
            continue
        head = tuple(dict.fromkeys(key for row in rows.values() for key in row))
        sheets[name] = [head, *(tuple(row.get(key) for key in head) for row in rows.values())]
    return sheets


def _are_items(value: object) -> TypeGuard[list[dict[str, Any]]]:
    return isinstance(value, list) and bool(value) and isinstance(value[0], dict)


def _is_place(value: list[dict[str, Any]]) -> bool:
    """Whether a list has the values of keys of a study at one of its points."""
    return all(
        item.keys() == {"key", "value"} and not isinstance(item["value"], dict | list)
        for item in value
    )


def _add(
    tables: dict[str, dict[Any, dict[str, Cell]]],
    name: str,
    owner: Mapping[str, Cell],
    record: Mapping[str, Any],
    item: str,
) -> None:
    """Add a record to the rows of a sheet; ``owner`` says which item of another sheet has it.

    Of an item of a list, the first value says which one it is; ``item`` is what the list is called.
    """
    row = {**owner}
    rows = tables.setdefault(name, {})
    rows[len(rows)] = row
    own = dict(owner)
    if item:
        key, value = next(iter(record.items()))
        own[f"{item}.{key}" if key in own else key] = value

    def fill(values: Mapping[str, Any], prefix: str) -> None:
        for key, value in values.items():
            path = f"{prefix}{key}"
            if isinstance(value, dict):
                fill(value, f"{path}.")
            elif not isinstance(value, list):
                row[f"{item}.{path}" if path in owner else path] = value
            elif not _are_items(value):
                row.update({f"{path}.{i}": each for i, each in enumerate(value)})
            elif _is_place(value):
                row.update({f"{path}.{each['key']}": each["value"] for each in value})
            elif prefix and key == "states":
                in_states = tables.setdefault(f"{name}.states", {})
                for each in value:
                    state = {**own, "state": each["state"]}
                    there = in_states.setdefault(tuple(state.values()), state)
                    there |= {f"{prefix}{k}": v for k, v in each.items() if k != "state"}
            else:
                for each in value:
                    _add(tables, f"{name}.{path}", own, each, key)

    fill(record, "")

"""A table of sizes of joints: a CSV file with one size in each row."""

from __future__ import annotations

import csv
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from os import PathLike, fspath
from typing import Any, Literal

from cardan.app.scene.language.errors import Location
from cardan.app.scene.language.rules import (
    ACUTE,
    FRICTION,
    NOT_NEGATIVE,
    POSITIVE,
    SIZE,
    OneOf,
    each,
)
from cardan.app.scene.language.section import Key
from cardan.arrays.errors import ArgumentValueError, nearest

OF_SIZE: Mapping[str, Key] = {
    "rating_Nm": Key(
        each(POSITIVE),
        "torque that 90 % of the joints bear for 5000 h at a bend of 3 deg and 100 rpm",
        "rating",
    ),
    "bearing": Key(
        each(OneOf(("needle", "plain")), "names"),
        "of the pins: needle, or plain, to which the law of life does not apply; default: needle",
        "bearing",
    ),
    "friction": Key(each(FRICTION), "coefficient of friction of the pins", "friction"),
    "pin_radius_mm": Key(
        each(SIZE), "radius at which the friction acts: of the pins", "pin_radius", 1e-3
    ),
    "arm_mm": Key(
        each(SIZE),
        "distance of the middle of a pin's bearing from the centre of the joint",
        "arm",
        1e-3,
    ),
    "seal_torque_Nm": Key(
        each(NOT_NEGATIVE),
        "torque that seals or a preload add about the pins of each yoke; default 0",
        "seal_torque",
    ),
    "max_bend_deg": Key(each(ACUTE), "largest bend that the type permits", "max_bend_deg"),
    "max_speed_bend_rpm_deg": Key(
        each(POSITIVE),
        "largest permitted product of speed in rpm and bend in deg",
        "max_speed_bend",
    ),
    "heat_W": Key(each(POSITIVE), "most permitted mean heat of a joint", "most_heat"),
}
"""What describes a size: keys of [joints] and columns of a table of sizes."""

NAME = "size"
"""The column of the names of sizes."""

OF_LOSSES = ("friction", "pin_radius_mm", "arm_mm")
"""What the losses of a joint need."""

BearingType = Literal["needle", "plain"]


@dataclass(frozen=True)
class JointSize:
    """A size of joint, in SI units; ``None`` for what is not known.

    Attributes:
        name: of the table; ``""`` for a joint that the scene itself describes.
        rating: torque in N m for 5000 h at 3 degrees and 100 rpm.
        pin_radius: radius in m at which the friction acts.
        arm: distance of the middle of a pin's bearing from the centre in m.
        seal_torque: about the pins of each yoke in N m.
        max_speed_bend: largest permitted product of rpm and degrees.
        most_heat: most permitted mean heat in W.
    """

    name: str = ""
    rating: float | None = None
    bearing: BearingType = "needle"
    friction: float | None = None
    pin_radius: float | None = None
    arm: float | None = None
    seal_torque: float = 0.0
    max_bend_deg: float | None = None
    max_speed_bend: float | None = None
    most_heat: float | None = None

    @property
    def rubs(self) -> bool:
        """Whether all is known that its losses need."""
        return None not in (self.friction, self.pin_radius, self.arm)

    @property
    def wears(self) -> bool:
        """Whether its life is known: it has a rating, and needles, to which the law applies."""
        return self.rating is not None and self.bearing == "needle"


def size_of(name: str, values: Mapping[str, Any]) -> JointSize:
    """Return the size that values by key describe, each a single one."""
    arguments: dict[str, Any] = {
        OF_SIZE[key].argument: value if isinstance(value, str) else OF_SIZE[key].factor * value
        for key, value in values.items()
    }
    return JointSize(name, **arguments)


def read_sizes(path: str | PathLike[str]) -> tuple[JointSize, ...]:
    """Return the sizes of a table in the order of its rows; empty cells are not known."""
    file = fspath(path)
    with open(path, encoding="utf-8-sig", newline="") as opened:
        try:
            rows = list(_rows(opened.read()))
        except (UnicodeDecodeError, csv.Error) as error:
            raise ValueError(f"{file}: not a CSV file in UTF-8: {error}") from None
    if not rows:
        raise ValueError(f"{file} is empty; it needs a row of headings and one row for each size")
    header = [cell.strip() for cell in rows[0][1]]
    _check_header(file, rows[0][0], header)
    found: dict[str, JointSize] = {}
    for line, row in rows[1:]:
        where = f"{file}, line {line}:"
        if len(row) != len(header):
            raise ValueError(f"{where} {len(row)} cells; the header has {len(header)}")
        cells = {key: cell.strip() for key, cell in zip(header, row, strict=True) if cell.strip()}
        name = cells.pop(NAME, "")
        if not name:
            raise ValueError(f"{where} {NAME} is empty; each size needs a name")
        if name in found:
            raise ValueError(f"{where} {NAME} is {name!r} again; name each size once")
        try:
            found[name] = size_of(name, {key: _value(key, cell) for key, cell in cells.items()})
        except ArgumentValueError as error:
            raise ValueError(f"{where} {error}") from None
    if not found:
        raise ValueError(f"{file} has headings but no sizes")
    return tuple(found.values())


def _rows(text: str) -> Iterator[tuple[int, list[str]]]:
    """The rows that are not empty with their lines, separated as the first line is."""
    separator = ";" if ";" in text.partition("\n")[0] else ","
    reader = csv.reader(text.splitlines(), delimiter=separator, strict=True)
    for row in reader:
        if any(cell.strip() for cell in row):
            yield reader.line_num, row


def _check_header(file: str, line: int, header: Sequence[str]) -> None:
    known = [NAME, *OF_SIZE]
    for column in header:
        if column not in known:
            raise ValueError(
                f"{file}, line {line}: unknown column {column!r}; {nearest(column, known)}"
            )
        if header.count(column) > 1:
            raise ValueError(f"{file}, line {line}: column {column!r} appears twice")
    for column in (NAME, "rating_Nm"):
        if column not in header:
            raise ValueError(f"{file}, line {line}: no column {column!r}, which each size needs")


def _value(key: str, cell: str) -> Any:  # noqa: ANN401 - a number or a name
    """A cell as its key's rule reads it."""
    # The rule of one value, of those that take a list with one for each joint as well.
    rule = OF_SIZE[key].rule.several.item  # type: ignore[attr-defined]
    try:
        # Where cells are separated by semicolons, decimals may have commas.
        value: object = float(cell.replace(",", "."))
    except ValueError:
        value = cell
    return rule.read(Location(key), value)

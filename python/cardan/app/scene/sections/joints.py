"""The section [joints]: sizes, also from tables, deviations from the drawing, and play."""

from __future__ import annotations

import csv
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from os import PathLike, fspath
from typing import Any, Literal

import numpy as np

from cardan.app.scene.language.errors import Location
from cardan.app.scene.language.rules import (
    ACUTE,
    DISTANCE,
    FRICTION,
    NOT_NEGATIVE,
    POSITIVE,
    SIZE,
    FileName,
    Number,
    OneOf,
    Text,
    each,
)
from cardan.app.scene.language.section import Key, Reading, Section, with_us_keys
from cardan.app.scene.language.units import si_key
from cardan.arrays import FloatArray
from cardan.arrays.errors import ArgumentValueError, nearest
from cardan.tolerances import JOINT_GROUPS

OF_SIZE = {
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
    "max_bend_deg": Key(
        each(ACUTE),
        "largest bend that the type permits; the crosses of a double joint count one by one",
        "max_bend_deg",
    ),
    "max_speed_bend_rpm_deg": Key(
        each(POSITIVE),
        "largest permitted product of speed in rpm and bend in deg",
        "max_speed_bend",
    ),
    "heat_W": Key(each(POSITIVE), "largest permitted mean heat of a joint", "most_heat"),
}
"""Description of a size: keys of [joints] and columns of a table of sizes."""

# Of one joint, where [joints] takes a list with one for each as well.
_COLUMNS = with_us_keys(
    {key: replace(entry, rule=entry.rule.several.item) for key, entry in OF_SIZE.items()}  # type: ignore[attr-defined]
)

NAME = "size"
"""The column of the names of sizes."""

OF_LOSSES = ("friction", "pin_radius_mm", "arm_mm")
"""Keys that the losses of a joint need."""

BearingType = Literal["needle", "plain"]


@dataclass(frozen=True)
class JointSize:
    """A size of joint, by the keys above in SI units; ``None`` for what is not known.

    A joint that the scene itself describes has no name. The speed times the bend is in rpm deg.
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
            values = {si_key(key): _value(key, cell) for key, cell in cells.items()}
            found[name] = size_of(name, values)
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
    known, where = [NAME, *_COLUMNS], f"{file}, line {line}:"
    held = [si_key(column) for column in header]
    for column in header:
        if column not in known:
            raise ValueError(f"{where} unknown column {column!r}; {nearest(column, known)}")
        if header.count(column) > 1:
            raise ValueError(f"{where} column {column!r} appears twice")
    for column in header:
        if held.count(si_key(column)) > 1:
            both = " and ".join(repr(each) for each in header if si_key(each) == si_key(column))
            raise ValueError(f"{where} columns {both} hold the same; leave one out")
    for column in (NAME, "rating_Nm"):
        if column not in held:
            raise ValueError(f"{where} no column {column!r}, which each size needs")


def _value(key: str, cell: str) -> Any:  # noqa: ANN401 - a number or a name
    """A cell as its key's rule reads it."""
    try:
        # Where cells are separated by semicolons, decimals may have commas.
        value: object = float(cell.replace(",", "."))
    except ValueError:
        value = cell
    return _COLUMNS[key].rule.read(Location(key), value)


_DEVIATION = each(Number(-90, 90, above=True, below=True, unit="deg"))
_NEEDS_ARM = "needs arm_mm, the distance of a pin's bearing from the centre of the joint"

OF_DEVIATIONS = {
    "driving_yoke_deg": Key(
        _DEVIATION,
        "as built: angle by which the driving pin leans from the normal of the driving shaft "
        "towards the driven one",
    ),
    "cross_deg": Key(
        _DEVIATION, "as built: angle by which the pins of the cross are closer than 90 deg"
    ),
    "driven_yoke_deg": Key(
        _DEVIATION,
        "as built: angle by which the driven pin leans from the normal of the driven shaft "
        "towards its driven end",
    ),
    "driving_yoke_mm": Key(
        each(DISTANCE),
        "in place of driving_yoke_deg: how far one end of the pin is off along the shaft, and the "
        "other end the other way, at arm_mm",
    ),
    "cross_mm": Key(each(DISTANCE), "likewise in place of cross_deg"),
    "driven_yoke_mm": Key(each(DISTANCE), "likewise in place of driven_yoke_deg"),
}
"""The keys that say how joints deviate."""

OF_PLAY = {
    "play_mm": Key(
        each(NOT_NEGATIVE),
        "radial play of a pin in its bearing at arm_mm, from the middle to either side",
    ),
    "stiffness_Nm_per_rad": Key(
        each(POSITIVE),
        "with play_mm: moment about the normal of the cross per angle between its pins; default: "
        "rigid",
    ),
}
"""The keys for play and wind-up."""

IN_DEGREES_OR_MM = {group: (f"{group}_deg", f"{group}_mm") for group in JOINT_GROUPS}
"""The two keys of each deviation, of which at most one is given."""


@dataclass(frozen=True)
class Joints:
    """The size of each joint, if given, and a table to choose from, by growing rating."""

    each: tuple[JointSize, ...]
    table: tuple[JointSize, ...]


@dataclass(frozen=True, eq=False)
class JointPlay:
    """Play of the pins and arm in m, stiffness of the crosses in N m/rad, ``(n,)`` each.

    The stiffness of rigid crosses is ``None``.
    """

    radial: FloatArray
    arm: FloatArray
    stiffness: FloatArray | None


@dataclass(frozen=True, eq=False)
class JointsAsBuilt:
    """The sizes, the play of the pins and the deviations in rad, ``(n, 3)``, where given."""

    sizes: Joints | None
    play: JointPlay | None
    deviations: FloatArray | None


def _joints(values: Mapping[str, Any], scene: Reading) -> JointsAsBuilt:
    n = scene.line.n_joints
    JOINTS.check_counts(values, n)
    own = {k: v for k, v in values.items() if k not in {**OF_DEVIATIONS, **OF_PLAY}}
    if _in_mm(scene) and own.keys().isdisjoint({"sizes", "friction", "pin_radius_mm"}):
        # Then it is there for the deviations alone.
        own.pop("arm_mm", None)
    sizes = None
    if own:
        # What is wrong in the table of sizes has no key.
        with scene.document.within(JOINTS.name, "sizes"):
            sizes = _sizes(own, n, scene)
    arms = arms_of(values, n, sizes)
    return JointsAsBuilt(sizes, _play(values, n, arms), _deviations(values, scene, arms))


def _sizes(values: Mapping[str, Any], joints: int, scene: Reading) -> Joints:
    table = read_sizes(scene.folder / values["sizes"]) if "sizes" in values else ()
    own = {key: value for key, value in values.items() if key in OF_SIZE}
    table = tuple(sorted(table, key=lambda size: size.rating or 0.0))
    if "size" not in values and not own:
        return Joints((), table)
    found = tuple(_joint(values, own, table, joint) for joint in range(joints))
    for joint, size in enumerate(found):
        given = [key for key in OF_LOSSES if getattr(size, OF_SIZE[key].argument) is not None]
        if given and not size.rubs:
            missing = next(key for key in OF_LOSSES if key not in given)
            *others, last = OF_LOSSES
            raise ArgumentValueError(
                missing,
                f"is missing for joint {joint}, which has {given[0]}; losses need "
                f"{', '.join(others)} and {last}",
            )
    return Joints(found, table)


def _joint(
    values: Mapping[str, Any], own: Mapping[str, Any], table: tuple[JointSize, ...], joint: int
) -> JointSize:
    """One joint: its row of the table, with what the scene says instead."""
    described = size_of("", {key: _of_joint(value, joint) for key, value in own.items()})
    if "size" not in values:
        return described
    name = _of_joint(values["size"], joint)
    rows = {size.name: size for size in table}
    if name not in rows:
        place = (joint,) if isinstance(values["size"], list) else ()
        raise ArgumentValueError("size", f"is {name!r}; {nearest(name, list(rows))}", place)
    given = (OF_SIZE[key].argument for key in own)
    changes = {argument: getattr(described, argument) for argument in given}
    return replace(rows[name], **changes)


def _of_joint(value: Any, joint: int) -> Any:  # noqa: ANN401 - a value or a list of them
    return value[joint] if isinstance(value, list) else value


def _play(values: Mapping[str, Any], n: int, arms: FloatArray | None) -> JointPlay | None:
    if "play_mm" not in values:
        return None
    if arms is None:
        raise ArgumentValueError("play_mm", _NEEDS_ARM)
    stiffness = values.get("stiffness_Nm_per_rad")
    spread = None if stiffness is None else _spread(stiffness, n)
    return JointPlay(1e-3 * _spread(values["play_mm"], n), arms, spread)


def _deviations(
    values: Mapping[str, Any], scene: Reading, arms: FloatArray | None
) -> FloatArray | None:
    given = [key for key in OF_DEVIATIONS if key in values]
    if not given:
        return None
    if "optimise" in scene.given:
        raise ArgumentValueError(
            given[0],
            "does not go with [optimise], which searches drivelines of ideal joints; leave the "
            "deviations out, or use cardan.optimise in Python, which takes joints as built",
        )
    n = scene.line.n_joints
    angles = angles_of(values, n, arms)
    found = [angles.get(group, np.zeros(n)) for group in JOINT_GROUPS]
    try:
        scene.line.with_deviations(*found)
    except ArgumentValueError as error:
        raise ArgumentValueError(given[0], f"and the others {error.problem}", ()) from None
    return np.stack(found, axis=-1)


def angles_of(values: Mapping[str, Any], n: int, arms: FloatArray | None) -> dict[str, FloatArray]:
    """Return deviations, or their tolerances, in rad by group, ``(n,)`` each; arms are in m."""
    found: dict[str, FloatArray] = {}
    for group, (degrees, mm) in IN_DEGREES_OR_MM.items():
        if degrees in values:
            found[group] = np.radians(_spread(values[degrees], n))
        elif mm in values:
            if arms is None:
                raise ArgumentValueError(mm, _NEEDS_ARM)
            found[group] = 1e-3 * _spread(values[mm], n) / arms
    return found


def arms_of(values: Mapping[str, Any], n: int, sizes: Joints | None) -> FloatArray | None:
    """Return the arms of the joints in m, ``(n,)``: those of a section, or else of the sizes."""
    if "arm_mm" in values:
        return 1e-3 * _spread(values["arm_mm"], n)
    known = [size.arm for size in sizes.each] if sizes else []
    return np.array(known, dtype=float) if known and None not in known else None


def _spread(value: float | list[float], n: int) -> FloatArray:
    return np.broadcast_to(np.asarray(value, dtype=float), n)


def _in_mm(scene: Reading) -> bool:
    """Whether deviations, their tolerances or play are given as lengths, which need an arm."""
    keys = {"play_mm", *(mm for _, mm in IN_DEGREES_OR_MM.values())}
    sections = ("joints", "tolerances")
    return any(not keys.isdisjoint(scene.given.get(section, {})) for section in sections)


JOINTS: Section[JointsAsBuilt] = Section(
    "joints",
    "sizes and bearings of the joints, for their life and heat, and how they deviate from their "
    "drawing; each value is one for all joints or a list with one per joint",
    {
        "sizes": Key(
            FileName((".csv",), folders=True),
            "your own table of sizes, a CSV file with a column size and columns named like the "
            "keys below; path from the folder of the scene",
        ),
        "size": Key(each(Text(), "texts"), "with sizes: which size the joints have", per="joint"),
        **{
            key: replace(entry, per="joint")
            for key, entry in (OF_SIZE | OF_DEVIATIONS | OF_PLAY).items()
        },
    },
    _joints,
    together=tuple(IN_DEGREES_OR_MM.values()),
    fewest=1,
    with_key=(("size", "sizes"), ("stiffness_Nm_per_rad", "play_mm")),
    always=True,
)

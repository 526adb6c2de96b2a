"""Scene files: a driveline, its load, a sweep of the drive and what to write, in TOML."""

from __future__ import annotations

import math
import re
import textwrap
import tomllib
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager, nullcontext
from dataclasses import dataclass
from os import PathLike, fspath
from pathlib import Path
from types import MappingProxyType
from typing import Any, Literal, Self

import numpy as np

from cardan import curves, plots
from cardan.arrays import FloatArray
from cardan.driveline import Driveline
from cardan.load import Load
from cardan.outputs import OUTPUTS, nearest
from cardan.result import Result

Kind = Literal[
    "text",
    "number",
    "positive number",
    "whole number",
    "numbers",
    "slopes",
    "vectors",
    "names",
    "curves file",
    "picture file",
]


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

    kind: Kind
    meaning: str
    argument: str = ""
    factor: float = 1.0
    default: Any = None


@dataclass(frozen=True)
class Section:
    """One section of a scene file."""

    meaning: str
    keys: Mapping[str, Key]


@dataclass(frozen=True)
class Form:
    """One way to describe a driveline: the keys that it needs and those that may go with it.

    Attributes:
        make: the constructor that the keys' arguments belong to.
        keys: needed, all of one length.
        optional: may go with them.
        ends: how many entries the needed keys have beyond one per joint.
    """

    make: Callable[..., Driveline]
    keys: tuple[str, ...]
    optional: tuple[str, ...]
    ends: int


_BENDS, _TWISTS, _PHASES = "bends_deg", "twists_deg", "phases_deg"
_SLOPES = ("slopes_vertical_deg", "slopes_horizontal_deg")
_PROJECTED = ("projected_bends_vertical_deg", "projected_bends_horizontal_deg")

FORMS = (
    Form(Driveline.from_bends, (_BENDS,), (_TWISTS, _PHASES), 0),
    Form(Driveline.from_points, ("points_m",), (_PHASES,), 2),
    Form(Driveline.from_points, ("points_mm",), (_PHASES,), 2),
    Form(Driveline.from_directions, ("directions",), (_PHASES,), 1),
    Form(Driveline.from_slopes, _SLOPES, (_PHASES,), 1),
    Form(Driveline.from_projected_bends, _PROJECTED, (_PHASES,), 0),
)
"""The ways to describe a driveline, of which a scene uses exactly one."""

FORMAT: Mapping[str, Section] = MappingProxyType(
    {
        "": Section(
            "above all sections",
            {"title": Key("text", "heading of the table and the picture")},
        ),
        "driveline": Section(
            "joints and shafts, described in exactly one way; needed",
            {
                "bends_deg": Key("numbers", "bend of each joint, in [0, 90)", "bends"),
                "twists_deg": Key(
                    "numbers",
                    "with bends_deg: turn from bend plane to bend plane about each shaft between "
                    "two joints, clockwise seen along the power flow; default 0",
                    "twists",
                ),
                "points_m": Key("vectors", "driving end, joint centres, driven end", "points"),
                "points_mm": Key("vectors", "the same in mm", "points"),
                "directions": Key("vectors", "along each shaft, any length", "directions"),
                "slopes_vertical_deg": Key(
                    "slopes", "slope of each shaft in side view, up positive", "vertical"
                ),
                "slopes_horizontal_deg": Key(
                    "slopes", "slope of each shaft in top view, right positive", "horizontal"
                ),
                "projected_bends_vertical_deg": Key(
                    "slopes", "bends of two joints in side view, from the common shaft", "vertical"
                ),
                "projected_bends_horizontal_deg": Key(
                    "slopes", "bends of two joints in top view, from the common shaft", "horizontal"
                ),
                "phases_deg": Key(
                    "numbers",
                    "turn of the output-side fork against the input-side one on each shaft between "
                    "two joints, clockwise seen along the power flow; default 0",
                    "phases",
                ),
            },
        ),
        "load": Section(
            "speed, torque and inertias",
            {
                "speed_rpm": Key("number", "speed of the drive", "speed", math.tau / 60.0),
                "speed_rad_s": Key("number", "the same in rad/s", "speed"),
                "acceleration_rad_s2": Key("number", "acceleration of the drive", "acceleration"),
                "drive_torque_Nm": Key("number", "torque put into shaft 0", "drive_torque"),
                "output_torque_Nm": Key(
                    "number", "or: torque delivered by the last shaft", "output_torque"
                ),
                "inertias_kgm2": Key(
                    "numbers", "moment of inertia of each shaft about its axis", "inertias"
                ),
            },
        ),
        "sweep": Section(
            "drive angles, both ends included",
            {
                "turns": Key("positive number", "turns of the drive", default=1),
                "samples_per_turn": Key("whole number", "steps per turn", default=720),
                "start_deg": Key("number", "first drive angle", default=0),
            },
        ),
        "output": Section(
            "files to write",
            {
                "curves": Key("curves file", f"its name ends in {', '.join(curves.SUFFIXES)}"),
                "picture": Key("picture file", f"its name ends in {', '.join(plots.SUFFIXES)}"),
                "quantities": Key(
                    "names",
                    f"from {', '.join(OUTPUTS)}; default: errors, ratios and what the load causes",
                ),
            },
        ),
    }
)
"""The format of a scene file: sections, their keys, what these hold and mean."""

_MOST_STEPS = 10_000_000


@dataclass(frozen=True, eq=False)
class Scene:
    """A driveline, its load, the drive angles to evaluate and the files to write.

    Make one with ``load`` or ``parse``.

    Attributes:
        name: where it came from, for messages.
        title: heading, or "".
        line: the driveline.
        load_case: its load, if any.
        drive_angle_deg: drive angles in degrees.
        quantities: outputs to evaluate, those per shaft for the last shaft.
        curves_file: name of the file for the curves, if any.
        picture_file: name of the file for the picture, if any.
    """

    name: str
    title: str
    line: Driveline
    load_case: Load | None
    drive_angle_deg: FloatArray
    quantities: tuple[str, ...]
    curves_file: str | None
    picture_file: str | None

    @classmethod
    def load(cls, path: str | PathLike[str]) -> Self:
        """Read a scene file.

        Raises:
            OSError: the file cannot be read.
            ValueError: it is not a scene; one line with file, section, key, rule and value.
        """
        name = fspath(path)
        # Some editors put a byte order mark in front, which TOML does not know.
        with _within(f"{name}:"), open(path, encoding="utf-8-sig") as file:
            text = file.read()
        return cls.parse(text, name)

    @classmethod
    def parse(cls, text: str, name: str = "scene") -> Self:
        """Make a scene from the text of a scene file.

        Args:
            text: TOML.
            name: what to call it in messages.

        Raises:
            ValueError: it is not a scene; one line with name, section, key, rule and value.
        """
        with _within(f"{name}:"):
            given = _document(text)
            with _within("[driveline]"):
                line = _driveline(given["driveline"])
            with _within("[load]"):
                load = _load(given["load"], line.n_joints) if "load" in given else None
            with _within("[sweep]"):
                angles = _drive_angles(given.get("sweep", {}))
            output = given.get("output", {})
            with _within("[output]"):
                quantities = _quantities(output, given.get("load"))
        return cls(
            name=name,
            title=given[""].get("title", ""),
            line=line,
            load_case=load,
            drive_angle_deg=angles,
            quantities=quantities,
            curves_file=output.get("curves"),
            picture_file=output.get("picture"),
        )

    @property
    def speed(self) -> float:
        """Speed of the drive in rad/s; 0 where the scene does not say."""
        return float(self.load_case.speed) if self.load_case else 0.0

    @property
    def accelerates(self) -> bool:
        """Whether the speed of the drive changes."""
        return self.load_case is not None and float(self.load_case.acceleration) != 0.0

    def run(self) -> SceneResult:
        """Evaluate the scene; writes nothing."""
        angle = np.radians(self.drive_angle_deg)
        return SceneResult(self, self.line.evaluate(angle, self.quantities, load=self.load_case))


@dataclass(frozen=True, eq=False)
class SceneResult:
    """What a scene evaluates to.

    Attributes:
        scene: the scene.
        values: its quantities in SI units by name, over the drive angles: ``(samples,)`` for the
            last shaft, ``(joints, samples, 3)`` for the moments of the joints.
    """

    scene: Scene
    values: Result

    @property
    def drive_angle(self) -> FloatArray:
        """Drive angles in rad."""
        return np.radians(self.scene.drive_angle_deg)


def describe() -> str:
    """Return the format of a scene file as plain text, at most 77 characters wide."""
    lines = []
    for name, section in FORMAT.items():
        lines.append(f"{f'[{name}]  ' if name else ''}{section.meaning}")
        for key, entry in section.keys.items():
            default = "" if entry.default is None else f"; default {entry.default}"
            lines += textwrap.wrap(
                f"{entry.kind}: {entry.meaning}{default}",
                width=77,
                initial_indent=f"  {key:32}",
                subsequent_indent=" " * 36,
                break_on_hyphens=False,
            )
        lines.append("")
    return "\n".join(lines)


Scene.__doc__ = f"{Scene.__doc__}\n    The format of a scene file::\n\n" + textwrap.indent(
    describe(), " " * 8
)


@contextmanager
def _within(place: str) -> Iterator[None]:
    """Put the place in front of what is wrong there."""
    try:
        yield
    except UnicodeDecodeError as error:
        raise ValueError(f"{place} not UTF-8 text at byte {error.start}") from None
    except ValueError as error:
        raise ValueError(f"{place} {error}") from None


def _document(text: str) -> dict[str, dict[str, Any]]:
    """Every section given, its keys known and its values of the right kind."""
    try:
        document = tomllib.loads(text)
    except ValueError as error:
        raise ValueError(f"not TOML: {error}") from None
    except RecursionError:
        raise ValueError("not TOML: nested too deeply") from None
    top = FORMAT[""].keys
    sections = [name for name in FORMAT if name]
    for name, value in document.items():
        if name in sections:
            if not isinstance(value, dict):
                raise ValueError(f"{name} is {_shown(value)}; it must be a section [{name}]")
        elif name not in top:
            what = "section" if isinstance(value, dict) else "key"
            raise ValueError(f"unknown {what} {name!r}; {_meant(name, [*top, *sections])}")
    if "driveline" not in document:
        raise ValueError("section [driveline] is missing; it describes the joints and shafts")
    given = {"": {name: document[name] for name in top if name in document}}
    given |= {name: document[name] for name in sections if name in document}
    return {name: _section(name, values) for name, values in given.items()}


def _section(name: str, values: Mapping[str, Any]) -> dict[str, Any]:
    keys = FORMAT[name].keys
    with _within(f"[{name}]") if name else nullcontext():
        for key in values:
            if key not in keys:
                raise ValueError(f"unknown key {key!r}; {_meant(key, keys)}")
        return {key: _KINDS[keys[key].kind](key, value) for key, value in values.items()}


def _meant(key: str, known: Iterable[str]) -> str:
    for name, section in FORMAT.items():
        if name and key in section.keys:
            return f"it belongs in [{name}]"
    return nearest(key, known)


def _shown(value: object) -> str:
    """A value in a message: on one line and not long."""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, dict):
        return "a section"
    try:
        text = repr(value)
    except ValueError:
        # Python does not print whole numbers of more than 4300 digits.
        return "a number too large"
    return text if len(text) <= 60 else f"{text[:57]}..."


def _text(place: str, value: object) -> str:
    if not isinstance(value, str):
        raise ValueError(f"{place} is {_shown(value)}; it must be text in quotes")
    return value


def _number(place: str, value: object) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise ValueError(f"{place} is {_shown(value)}; it must be a number")
    try:
        number = float(value)
    except OverflowError:
        number = math.inf
    if not math.isfinite(number):
        raise ValueError(f"{place} is {_shown(value)}; it must be finite")
    return number


def _positive(place: str, value: object) -> float:
    number = _number(place, value)
    if number <= 0.0:
        raise ValueError(f"{place} is {_shown(value)}; it must be positive")
    return number


def _whole(place: str, value: object) -> int:
    if isinstance(value, bool) or not isinstance(value, int) or value < 1:
        raise ValueError(f"{place} is {_shown(value)}; it must be a whole number of at least 1")
    return value


def _slope(place: str, value: object) -> float:
    number = _number(place, value)
    if not -90.0 < number < 90.0:
        raise ValueError(f"{place} is {_shown(value)}; it must lie between -90 and 90")
    return number


def _vector(place: str, value: object) -> list[float]:
    numbers: list[float] = _list_of(_number, "three numbers")(place, value)
    if len(numbers) != 3:
        raise ValueError(f"{place} is {_shown(value)}; it must be a list of three numbers")
    return numbers


def _quantity(place: str, value: object) -> str:
    name = _text(place, value)
    if name not in OUTPUTS:
        raise ValueError(f"{place} is {name!r}; {nearest(name, OUTPUTS)}")
    return name


def _list_of(item: Callable[[str, object], Any], what: str) -> Callable[[str, object], list[Any]]:
    def read(place: str, value: object) -> list[Any]:
        if not isinstance(value, list):
            raise ValueError(f"{place} is {_shown(value)}; it must be a list of {what}")
        return [item(f"{place}[{i}]", entry) for i, entry in enumerate(value)]

    return read


def _file(suffixes: Collection[str]) -> Callable[[str, object], str]:
    def read(place: str, value: object) -> str:
        name = _text(place, value)
        # The folder is for whoever runs the scene to choose.
        if Path(name).name != name or "\\" in name or not name.isprintable():
            raise ValueError(f"{place} is {name!r}; it must be a file name without a folder")
        if Path(name).suffix not in suffixes:
            raise ValueError(f"{place} is {name!r}; it must end in {' or '.join(suffixes)}")
        return name

    return read


_KINDS: Mapping[Kind, Callable[[str, object], Any]] = {
    "text": _text,
    "number": _number,
    "positive number": _positive,
    "whole number": _whole,
    "numbers": _list_of(_number, "numbers"),
    "slopes": _list_of(_slope, "numbers"),
    "vectors": _list_of(_vector, "vectors [x, y, z]"),
    "names": _list_of(_quantity, "names"),
    "curves file": _file(curves.SUFFIXES),
    "picture file": _file(plots.SUFFIXES),
}


def _driveline(values: Mapping[str, Any]) -> Driveline:
    used = [form for form in FORMS if any(key in values for key in form.keys)]
    if not used:
        ways = "; ".join(" with ".join(form.keys) for form in FORMS)
        raise ValueError(f"no shafts or joints; give one of: {ways}")
    form = used[0]
    if len(used) > 1:
        one, other = (next(key for key in form.keys if key in values) for form in used[:2])
        raise ValueError(f"{one} and {other} are both given; describe the driveline in one way")
    for key in form.keys:
        if key not in values:
            raise ValueError(f"{key} is missing; {' and '.join(form.keys)} go together")
    for key in values:
        if key not in form.keys + form.optional:
            raise ValueError(f"{key} does not go with {form.keys[0]}, which says it already")

    first = form.keys[0]
    joints = len(values[first]) - form.ends
    if joints < 1:
        raise ValueError(
            f"{first} has length {len(values[first])}; one joint needs {1 + form.ends}"
        )
    if form.make == Driveline.from_projected_bends and joints != 2:
        raise ValueError(f"{first} has length {joints}; it needs 2, one per joint")
    for key in form.keys[1:]:
        _check_count(key, values[key], joints + form.ends, f"as many as {first}")
    for key in form.optional:
        if key in values:
            _check_count(key, values[key], joints - 1, "one per shaft between two joints")

    keys = FORMAT["driveline"].keys
    arguments = {keys[key].argument: values[key] for key in values}
    names = {keys[key].argument: key for key in values}
    # Slopes become directions before their bends are known.
    names.setdefault("directions", " and ".join(form.keys))
    with _named(names):
        # Neither points nor directions are angles: what is in degrees is what can be.
        return form.make(**arguments, degrees=True)


def _load(values: Mapping[str, Any], joints: int) -> Load:
    keys = FORMAT["load"].keys
    names: dict[str, str] = {}
    for key in values:
        argument = keys[key].argument
        if argument in names:
            raise ValueError(f"{names[argument]} and {key} are both given; give one of them")
        names[argument] = key
    if "inertias_kgm2" in values:
        _check_count("inertias_kgm2", values["inertias_kgm2"], joints + 1, "one per shaft")
    with _named(names):
        return Load(
            **{
                keys[key].argument: np.multiply(value, keys[key].factor)
                for key, value in values.items()
            }
        )


def _drive_angles(values: Mapping[str, Any]) -> FloatArray:
    keys = FORMAT["sweep"].keys
    turns, per_turn, start = (
        values.get(key, keys[key].default) for key in ("turns", "samples_per_turn", "start_deg")
    )
    if per_turn > _MOST_STEPS / turns:
        raise ValueError(
            f"samples_per_turn is {_shown(per_turn)} over turns = {turns:g}; "
            f"a sweep takes at most {_MOST_STEPS} steps"
        )
    steps = max(1, round(turns * per_turn))
    # Dividing last keeps round degrees round.
    angles: FloatArray = start + 360.0 * turns * np.arange(steps + 1) / steps
    return angles


def _quantities(output: Mapping[str, Any], load: Mapping[str, Any] | None) -> tuple[str, ...]:
    if "quantities" not in output:
        loaded = load is not None and any("torque" in key or "inertia" in key for key in load)
        caused = ("torque", "moment") if loaded else ()
        return ("angle_error", "speed_ratio", "acceleration_ratio", *caused)
    names: list[str] = output["quantities"]
    if not names:
        raise ValueError("quantities is []; name at least one, or leave it out")
    for i, name in enumerate(names):
        if name in names[:i]:
            raise ValueError(f"quantities[{i}] is {name!r} again; name each once")
        if load is None and OUTPUTS[name].needs_load:
            raise ValueError(f"quantities[{i}] is {name!r}; it needs a section [load]")
    return tuple(names)


def _check_count(key: str, values: Sequence[Any], wanted: int, why: str) -> None:
    if len(values) != wanted:
        raise ValueError(f"{key} has length {len(values)}; it needs {wanted}, {why}")


@contextmanager
def _named(names: Mapping[str, str]) -> Iterator[None]:
    """Let messages speak of the keys of the file instead of a constructor's arguments."""
    try:
        yield
    except ValueError as error:
        arguments = "|".join(names)
        raise ValueError(
            re.sub(
                rf"\b({arguments})(?=\[| give| and| are)",
                lambda match: names[match[1]],
                str(error),
            )
        ) from None

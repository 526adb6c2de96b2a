"""Errors in a scene file, with fields that say where."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Self

from cardan.app.scene.language.units import as_given
from cardan.arrays.errors import ArgumentError, ArgumentValueError, Place


@dataclass(frozen=True)
class Location:
    """A value in a scene file; its place has numbers in lists and names in tables."""

    key: str
    place: Place = ()

    @classmethod
    def of(cls, path: str) -> Self:
        """Return the location of a dotted path."""
        key, *place = path.split(".")
        return cls(key, tuple(place))

    def at(self, part: int | str) -> Location:
        """Return the location of an entry of this value."""
        return Location(self.key, (*self.place, part))

    def error(self, problem: str) -> KeyValueError:
        """Return the error that this value has a problem."""
        return KeyValueError(self.key, problem, self.place)

    def __str__(self) -> str:
        """Write it as the file does: ``bends_deg[2]``, ``points_m.2.y``."""
        parts = (f"[{part}]" if isinstance(part, int) else f".{part}" for part in self.place)
        return f"{self.key}{''.join(parts)}"


class KeyValueError(ArgumentValueError):
    """A key of a scene file that breaks a rule; its text writes the place as the file does."""

    def __str__(self) -> str:
        """Return the sentence: ``points_m[1][2] is 'a'; it must be a number``."""
        return f"{Location(self.argument, self.place)} {self.problem}"


class StudyPointError(ArgumentValueError):
    """A point of a study's grid, or a state with its name, that makes no driveline.

    The section is that of the key that is wrong, and the point has the values of those that vary.
    """

    def __init__(
        self,
        argument: str,
        problem: str,
        place: Place,
        section: str,
        point: Mapping[str, float],
        state: str = "",
    ) -> None:
        """Make an error of its fields."""
        super().__init__(argument, problem, place)
        self.args = (argument, problem, place, section, point, state)
        self.section, self.point, self.state = section, point, state

    def __str__(self) -> str:
        """Return the sentence, state and values in front."""
        values = ", ".join(f"{key} = {value:.10g}" for key, value in self.point.items())
        state = f"in {self.state!r}, " if self.state else ""
        return f"{state}at {values}: {super().__str__()}"


class SceneError(ArgumentValueError):
    """Something wrong in a scene file; its text begins with file, line and section.

    ``argument`` is a key of the file, or ``""`` where the problem concerns a whole section or the
    file; ``problem`` is the whole sentence there and for unknown keys.

    Attributes:
        name: the file, or what else the scene is called.
        line: the line, counted from 1; ``None`` where it is not certain.
        section: the section, of an array of tables with the number of the table, counted from 0:
            ``"bearing.2"``; of a table within it ``"torsion.motor"``; ``""`` for the file itself.
        key: section, key and place as one path: ``"driveline.bends_deg.2"``.
        point: in a study or a state, the values of the keys that vary where the problem is; else
            empty.
    """

    def __init__(
        self, error: ValueError, name: str, section: str, line: int | None = None, key: str = ""
    ) -> None:
        """Say where in a scene file another error occurred; one without fields is about ``key``."""
        argument, problem, place = key, str(error), Place()
        self.point: Mapping[str, float] = {}
        owner = section
        if isinstance(error, ArgumentError):
            argument, problem, place = error.argument, error.problem, error.place
        if isinstance(error, StudyPointError):
            owner, self.point = error.section, error.point
        super().__init__(argument, problem, place)
        self.args = (error, name, section, line, key)
        self.name, self.line, self.section = name, line, section
        self.key = ".".join(str(part) for part in (owner, argument, *place) if part != "")
        self._sentence = str(error)

    def __str__(self) -> str:
        """Return the line: ``shaft.toml, line 2: [driveline] bends_deg[0] is 99 deg; …``."""
        line = f", line {self.line}" if self.line else ""
        name, _, number = self.section.rpartition(".")
        section = f" [{self.section}]" if self.section else ""
        section = f" [[{name}]][{number}]" if number.isdigit() else section
        return f"{self.name}{line}:{section} {self._sentence}"


def as_file_has_it(
    error: ValueError, section: str, given: Mapping[str, Mapping[str, str]]
) -> ValueError:
    """Return an error with the keys and in the units of the file.

    ``given`` has by section each key as the file has it by that in SI units.
    """
    if isinstance(error, KeyValueError):
        return error
    owner = error.section if isinstance(error, StudyPointError) else section
    own = {
        si: key
        for name, keys in given.items()
        if name.partition(".")[0] == owner or name == owner
        for si, key in keys.items()
        if si != key
    }
    if not own or not isinstance(error, ArgumentValueError):
        return error
    argument = own.get(error.argument, error.argument)
    problem = as_given(error.problem, own, argument)
    if isinstance(error, StudyPointError):
        rest = (error.place, error.section, error.point, error.state)
        return StudyPointError(argument, problem, *rest)
    return ArgumentValueError(argument, problem, error.place)


def path_of(error: ValueError, key: str) -> str:
    """Return the dotted path, below its section, of the entry of the file that an error is about.

    An error without fields is about ``key``. Entries of lists have no path.
    """
    if isinstance(error, StudyPointError):
        # What varies at this point is as likely to be wrong as the key that it makes wrong.
        return ""
    if not isinstance(error, ArgumentError):
        return key
    names = [error.argument]
    for part in error.place:
        if isinstance(part, int):
            break
        names.append(part)
    return ".".join(names)

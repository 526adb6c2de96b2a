"""The answer to a scene: each of its parts, found once, and the one verdict on all of them."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from importlib import import_module
from typing import Any, NamedTuple

from cardan.app.answers.over import check_scene
from cardan.app.answers.rows import Entry, Judged
from cardan.app.answers.table import PARTS, Part
from cardan.app.files.whole_file import Progress
from cardan.app.scene.language.units import shown_in
from cardan.app.scene.scene import BallJointScene, Scene
from cardan.arrays.errors import ArgumentTypeError
from cardan.design.check import Check

FROM_THE_WORST = ("beyond", "not judged", "tolerable", "within")
"""Verdicts in the order in which one of them is that on all."""


class JudgedFigure(NamedTuple):
    """A figure that has a limit, or could have one."""

    entry: Entry  # the figure with its row and its value, a Judged
    part: Part  # that it is of

    @property
    def value(self) -> Judged:
        """The figure beside its limit."""
        value = self.entry.value
        assert isinstance(value, Judged)
        return value

    @property
    def name(self) -> str:
        """Name in words: ``"shear stress of the tube of shaft 1"``."""
        label, item = self.entry.row.label, self.entry.item
        if item and not item[-1].isdigit():
            return f"{item}, {label}"
        # One of the shafts, not of them all.
        noun = "" if item and self.part.noun == f"the {item.partition(' ')[0]}s" else self.part.noun
        return " of ".join(filter(None, (label, noun, item)))


class Answer:
    """The parts of a scene, each found once and only when something asks for it.

    ``answer["life"]`` is what ``cardan check`` says of a part, and ``answer.needed("torsion")``
    what the part's own command does. The parts are ``limits``, ``states``, ``forces``, ``spline``,
    ``steering``, ``backlash``, ``life``, ``tubes``, ``torsion`` and others, the keys of the JSON.

    Attributes:
        of: the scene of a driveline or of a ball joint alone.
    """

    def __init__(self, of: Scene | BallJointScene, progress: Progress | None = None) -> None:
        """Take a scene; ``progress`` is called after each block of its study with rows and all.

        Raises:
            TypeError: it is no scene.
        """
        if not isinstance(of, Scene | BallJointScene):
            problem = f"is {of!r}; it must be a cardan.Scene, as cardan.Scene.load(path) makes it"
            raise ArgumentTypeError("of", problem)
        self.of = of
        self._progress = progress
        self._found: dict[str, Any] = {}
        self._whole: dict[str, Any] = {}

    @property
    def scene(self) -> Scene:
        """The scene of a driveline."""
        assert isinstance(self.of, Scene)
        return self.of

    def __getitem__(self, name: str) -> Any:  # noqa: ANN401 - each part has its own type
        """Return a part; ``None`` or nothing where the scene has none."""
        part = PARTS[name]
        if name not in self._found:
            is_there = part.alone or isinstance(self.of, Scene)
            with shown_in(self.of.units):
                self._found[name] = part.find(self) if is_there else None
        return self._found[name]

    def needed(self, name: str) -> Any:  # noqa: ANN401 - each part has its own type
        """Return a part with what its own command shows.

        Raises:
            ValueError: the scene has no section of this name.
        """
        if self[name] is None:
            given = PARTS[name].given
            raise ValueError(f"{self.of.name}: section [{name}] is missing; it gives {given}")
        if name not in self._whole:
            with shown_in(self.of.units):
                self._whole[name] = PARTS[name].whole(self, self[name])
        return self._whole[name]

    def parts(self, command: str) -> Iterator[tuple[Part, Any]]:
        """Yield the parts that the answer of a command has, with their figures."""
        for name, part in PARTS.items():
            if command in part.shown and (found := self[name]):
                yield part, found

    @cached_property
    def check(self) -> Check:
        """The check of the driveline."""
        return check_scene(self.scene, self._progress)

    @cached_property
    def judged(self) -> list[JudgedFigure]:
        """The figures of the parts that have a limit, or could have one."""
        return [
            JudgedFigure(entry, part)
            for part, found in self.parts("check")
            for entry in part.entries(found)
            if entry.row.limit and isinstance(entry.value, Judged)
        ]

    def of_verdict(self, verdict: str) -> list[JudgedFigure]:
        """Return the figures with a verdict, of ``VERDICTS``."""
        return [each for each in self.judged if each.value.verdict == verdict]

    @cached_property
    def verdict(self) -> str:
        """The one verdict on everything that has a limit.

        ``"beyond"`` if anything is; else ``"not judged"`` if there is a limit for something that
        cannot be judged, or none for anything; else ``"tolerable"`` if anything is; else
        ``"within"``.
        """
        found = {each.value.verdict for each in self.judged if each.value.limit is not None}
        return next((word for word in FROM_THE_WORST if word in found), "not judged")

    @property
    def passes(self) -> bool:
        """Whether nothing is beyond its limits."""
        return self.verdict != "beyond"

    def _repr_html_(self) -> str | None:
        """Show a notebook the machine of the scene, which can be moved; ``None`` without one."""
        # Pages are built upon answers.
        shown: str | None = import_module("cardan.app.report.moving").framed(self)
        return shown

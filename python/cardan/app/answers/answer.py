"""The answer to a scene: each of its parts, found once, and the one verdict on all of them."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from cardan.app.answers.limits.figures import check_scene
from cardan.app.answers.rows import Entry, Judged, worst_of
from cardan.app.answers.table import PARTS, Part
from cardan.app.files.progress import Progress
from cardan.app.scene.ball_joint_scene import BallJointScene
from cardan.app.scene.scene import Scene
from cardan.design.check import Check
from cardan.design.judged import VERDICTS


class JudgedFigure(NamedTuple):
    """A figure that has a limit, or could have one.

    Attributes:
        entry: the figure with its row and its value, a ``Judged``.
        part: the part that it is of.
    """

    entry: Entry
    part: Part

    @property
    def value(self) -> Judged:
        """The figure beside its limit."""
        value = self.entry.value
        assert isinstance(value, Judged)
        return value

    @property
    def name(self) -> str:
        """What it is: ``"shear stress of the tube of shaft 1"``."""
        words = (self.entry.row.label, self.part.noun, self.entry.item)
        return " of ".join(filter(None, words))


class Answer:
    """The parts of a scene, each found once and only when something asks for it.

    Attributes:
        of: the scene of a driveline or of a ball joint alone.
    """

    def __init__(self, of: Scene | BallJointScene, progress: Progress | None = None) -> None:
        """Take a scene; ``progress`` is called after each block of its study with rows and all."""
        self.of = of
        self._progress = progress
        self._found: dict[str, Any] = {}

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
            self._found[name] = part.find(self) if is_there else None
        return self._found[name]

    def parts(self, command: str) -> Iterator[tuple[Part, Any]]:
        """Yield the parts that the answer of a command has, with their figures."""
        for name, part in PARTS.items():
            if command in part.shown and (found := self[name]):
                yield part, found

    @cached_property
    def motion(self) -> Check | None:
        """The check of the driveline; a ball joint alone has none."""
        return check_scene(self.of, self._progress) if isinstance(self.of, Scene) else None

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
        """The worst verdict on everything that has a limit, one of ``VERDICTS``."""
        motion = () if self.motion is None else np.unique(self.motion.ranks)
        return worst_of(
            [*(VERDICTS[rank] for rank in motion), *(each.value.verdict for each in self.judged)]
        )

    @property
    def passes(self) -> bool:
        """Whether nothing is beyond its limits or cannot be judged for its value."""
        return VERDICTS.index(self.verdict) <= VERDICTS.index("tolerable")

"""Scene files that describe a ball joint and no driveline."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Self

from cardan.app.scene.ball_joint import BallJointCase, ball_joint_case
from cardan.app.scene.document import Document
from cardan.app.scene.format import FORMAT


@dataclass(frozen=True, eq=False)
class BallJointScene:
    """A ball joint, its load and its materials.

    Make one with ``cardan.scene.load_scene`` or ``parse``.

    Attributes:
        name: where it came from, for messages.
        title: heading, or "".
        ball_joint: the case.
    """

    name: str
    title: str
    ball_joint: BallJointCase

    @classmethod
    def parse(cls, text: str, name: str = "scene") -> Self:
        """Make a scene from the text of a scene file.

        Args:
            text: TOML.
            name: its name in messages.

        Raises:
            ValueError: it is no scene of a ball joint alone; one line with name, line where that
                is certain, section, key, rule and value.
        """
        return cls.of(Document(text, name))

    @classmethod
    def of(cls, document: Document) -> Self:
        """Make a scene from a document."""
        given = document.sections
        with document.within(""):
            if "ball_joint" not in given:
                raise ValueError("section [ball_joint] is missing")
        for section in (*given, *document.tables):
            if section not in ("", "ball_joint"):
                with document.within("", section):
                    heading = FORMAT[section].heading(section)
                    raise ValueError(f"section {heading} needs a section [driveline]")
        with document.within("ball_joint"):
            case = ball_joint_case(given["ball_joint"])
        return cls(document.name, given[""].get("title", ""), case)

    @property
    def picture_file(self) -> str | None:
        """Name of the file for the picture, if any."""
        return self.ball_joint.picture_file


def is_alone(document: Document) -> bool:
    """Whether a document describes a ball joint and no driveline."""
    given = document.sections
    return "ball_joint" in given and not given.keys() & {"driveline", "angles"}

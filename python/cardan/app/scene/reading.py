"""From a scene file to what a scene makes of its sections."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from pathlib import Path
from typing import Any, cast

from cardan.app.scene.language.document import Document
from cardan.app.scene.language.section import Made, Section
from cardan.app.scene.recording.recorded import BEND_COLUMNS, Angles
from cardan.app.scene.sections.angles import ANGLES
from cardan.app.scene.sections.bearing import BEARING
from cardan.app.scene.sections.driveline import DRIVELINE
from cardan.app.scene.sections.load import LOAD
from cardan.app.scene.sections.sweep import DRIVE_ANGLES
from cardan.app.scene.study.states import SceneLayout
from cardan.driveline import Driveline
from cardan.evaluation.load import Load


class Reading:
    """A scene file being read: ``reading[TUBES]`` is what is made of its section [tubes].

    Each section is made once, when it is first asked for; errors name it.

    Attributes:
        document: the file.
        folder: to which its paths are relative.
        given: values by section and key.
    """

    def __init__(self, document: Document, folder: Path, recorded: Angles | None = None) -> None:
        """Take a file, and the next angles of a recording that is read in parts."""
        self.document, self.folder, self.given = document, folder, document.sections
        self._made: dict[str, Any] = {} if recorded is None else {ANGLES.name: recorded}
        with document.within(""):
            self._check_sections()

    def __getitem__(self, section: Section[Made]) -> Made:
        """Return what is made of a section."""
        if section.name not in self._made:
            made = None
            with self.document.within(section.name):
                if section.always or section.name in self.given:
                    made = self._make(section)
            self._made[section.name] = made
        return cast("Made", self._made[section.name])

    def _make(self, section: Section[Made]) -> Made:
        values = self.given.get(section.name, {})
        if not section.recorded_bends and self.line.shape:
            raise ValueError("it does not go with recorded bends, which differ by sample")
        return section.make(values, self)

    @property
    def line(self) -> Driveline:
        """The driveline of the drawing in its bearings, a batch if its bends were recorded."""
        return self[BEARING].line

    @property
    def load(self) -> Load | None:
        """The load, if there is one."""
        return self[LOAD].load

    @functools.cached_property
    def layout(self) -> SceneLayout | None:
        """How the file describes its driveline; ``None`` if its bends were recorded."""
        if self.line.shape:
            return None
        described = self[DRIVELINE]
        return SceneLayout(described.form, described.keys, self[LOAD].keys, self[BEARING].mounting)

    def _check_sections(self) -> None:
        """Refuse sections that are missing or do not go together."""
        given: Mapping[str, Mapping[str, Any]] = self.given
        if "driveline" not in given and not given.get("angles", {}).keys() & set(BEND_COLUMNS):
            instead = (
                "; a ball joint alone can be run, checked, plotted and reported "
                "(in Python: cardan.scene.load_scene)"
            )
            raise ValueError(
                "section [driveline] is missing; it describes the joints and shafts"
                + (instead if is_alone(self.document) else "")
            )
        if given.keys() >= {"study", "states"}:
            raise ValueError(
                "sections [study] and [states] are both given; a study varies the design, states "
                "are positions of one design: give one of them"
            )
        if given.keys() >= set(DRIVE_ANGLES):
            both = " and ".join(f"[{section}]" for section in DRIVE_ANGLES)
            raise ValueError(f"sections {both} are both given; give one of them")


def is_alone(document: Document) -> bool:
    """Whether a document describes a ball joint and no driveline."""
    given = document.sections
    return "ball_joint" in given and not given.keys() & {"driveline", "angles"}

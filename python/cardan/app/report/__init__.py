"""The report of a scene: one HTML page that holds everything and needs no network."""

from __future__ import annotations

import os
from os import PathLike
from pathlib import Path

from cardan.app.files.whole_file import Progress, whole_file
from cardan.app.report.page import page
from cardan.app.scene.scene import BallJointScene, Scene

SUFFIXES = (".html", ".htm")
"""Suffixes of a report."""


def write_report(
    scene: Scene | BallJointScene,
    path: str | PathLike[str],
    progress: Progress | None = None,
) -> None:
    """Write the report of a scene as one HTML page.

    It gives the answer first: whether the driveline runs smoothly, what loads the bearings and how
    to set the yokes. Inputs, tables and charts follow. At the top the driveline can be moved,
    unless it was recorded, is varied by a study or has joints as built; the page then evaluates it
    by the core, which it holds as WebAssembly. Of a ball joint it shows verdict, figures and the
    pressure on the seat.

    Args:
        scene: the scene; without recorded angles the page shows one turn of it in half degrees.
        path: the page to write; it ends in ``.html`` or ``.htm``.
        progress: called after each block of the scene's study, as by ``Scene.run``.

    Raises:
        ImportError: jinja2 is missing.
        OSError: the file cannot be written; nothing of it is left behind then.
        ValueError: another suffix, a point of the study that makes no driveline.
    """
    if Path(path).suffix not in SUFFIXES:
        raise ValueError(f"{os.fspath(path)} must end in {' or '.join(SUFFIXES)}")
    text = page(scene, progress)
    with whole_file(path) as file:
        # A file's name, which the page shows, may hold bytes that are not UTF-8.
        file.write(text.encode(errors="replace"))

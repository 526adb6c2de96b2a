"""Arguments and options that several subcommands take, and what is looked at before a file."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import click

from cardan.app.files import columns
from cardan.app.files.whole_file import check_writable
from cardan.app.scene.scene import BallJointScene, Scene
from cardan.arrays import import_optional

_Function = TypeVar("_Function", bound=Callable[..., Any])

file_argument = click.argument("file", type=click.Path(path_type=Path))
scene_argument = click.argument("scene", type=click.Path(path_type=Path))
json_option = click.option("--json", "as_json", is_flag=True, help="Print JSON for programs.")
into_option = click.option(
    "--into",
    type=click.Path(exists=True, file_okay=False, path_type=Path),
    default=".",
    metavar="DIR",
    help="Folder for the files to write; default: the current one.",
)
units_option = click.option(
    "--radians/--degrees",
    help="Unit of angles in print and in tables; default: degrees. Pictures use degrees.",
)


def file_option(name: str, text: str) -> Callable[[_Function], _Function]:
    """Return an option that takes a file to write."""
    return click.option(name, type=click.Path(path_type=Path), metavar="FILE", help=text)


picture_as_well = file_option("--output", "Picture to write as well.")


def missing_samples(missing: int, count: int, where: str) -> str:
    """Return the line that says how many samples are missing where."""
    verb = "is" if missing == 1 else "are"
    return f"{missing} of {count} samples {verb} missing in {where}; their results are NaN."


def check_output(scene: Scene | BallJointScene, path: Path) -> None:
    """Refuse a file that cannot be written or that the scene reads, before the work is done."""
    recording = scene.recording if isinstance(scene, Scene) else None
    if recording and path.exists() and path.samefile(recording):
        raise ValueError(f"{path} is the recording that the scene reads; it would be overwritten")
    check_picture(path)
    if path.suffix == ".parquet":
        import_optional("pyarrow", "table")


def check_picture(path: Path) -> None:
    """Refuse a file that cannot be written, and a picture without what draws it."""
    check_writable(path)
    if path.suffix in columns.PICTURES:
        from cardan.app.pictures.style import matplotlib

        matplotlib()

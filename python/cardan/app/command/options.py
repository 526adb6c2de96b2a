"""Arguments and options that several subcommands take, and what is looked at before a file."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeVar, cast, get_args

import click

from cardan.app.answers.sheets import write_answer
from cardan.app.files import columns
from cardan.app.files.whole_file import check_writable
from cardan.app.scene.language.units import System, shown_in
from cardan.app.scene.scene import BallJointScene, Scene

_Function = TypeVar("_Function", bound=Callable[..., Any])

file_argument = click.argument("file", type=click.Path(path_type=Path))
_SCENE = click.argument("scene", type=click.Path(path_type=Path))
json_option = click.option("--json", "as_json", is_flag=True, help="Print JSON for programs.")
into_option = click.option(
    "--into",
    type=click.Path(exists=True, file_okay=False, path_type=Path),
    default=".",
    metavar="DIR",
    help="Folder for the files to write; default: the current one.",
)
angle_option = click.option(
    "--radians/--degrees",
    help="Unit of angles in print and in tables; default: degrees. Pictures use degrees.",
)


_UNITS = click.option(
    "--units",
    type=click.Choice(get_args(System)),
    metavar="si|us",
    expose_value=False,
    callback=lambda context, _, units: context.meta.update({_GIVEN: units}),
    help="Units of what is shown and written; default: the ones of the scene.",
)
_GIVEN = "cardan.units"


def scene_argument(function: _Function) -> _Function:
    """Give a command the argument for a scene, and the option for the units of its answer."""
    return _SCENE(_UNITS(function))


_Scene = TypeVar("_Scene", bound=Scene | BallJointScene)


def in_units(scene: _Scene) -> _Scene:
    """Return a scene with the units that the option names; what the command says is in them."""
    context = click.get_current_context()
    scene = replace(scene, units=units_given() or scene.units)
    context.with_resource(shown_in(scene.units))
    return scene


def units_given() -> System | None:
    """Return what the option for units says, if it is given."""
    return cast("System | None", click.get_current_context().meta.get(_GIVEN))


def file_option(name: str, text: str) -> Callable[[_Function], _Function]:
    """Return an option that takes a file to write."""
    return click.option(name, type=click.Path(path_type=Path), metavar="FILE", help=text)


picture_as_well = file_option("--output", "Picture to write as well.")
workbook_as_well = file_option("--workbook", "Spreadsheet to write as well, as .xlsx.")


def missing_samples(missing: int, count: int, where: str) -> str:
    """Return the line that says how many samples are missing where."""
    verb = "is" if missing == 1 else "are"
    return f"{missing} of {count} samples {verb} missing in {where}; their results are NaN."


def check_output(scene: Scene | BallJointScene, path: Path) -> None:
    """Refuse a file that cannot be written or that the scene reads, before the work is done."""
    for section, file in scene.files.items() if isinstance(scene, Scene) else ():
        if path.exists() and path.samefile(file):
            what = "recording" if section == "angles" else f"file of [{section}]"
            raise ValueError(f"{path} is the {what} that the scene reads; it would be overwritten")
    check_picture(path)
    columns.check_library(path)


def check_workbook(path: Path | None, scene: Scene | BallJointScene | None = None) -> None:
    """Refuse a workbook that cannot be written or that the scene reads."""
    if path is None:
        return
    if path.suffix != ".xlsx":
        raise ValueError(f"--workbook {path} must end in .xlsx")
    if scene:
        check_output(scene, path)
    else:
        check_writable(path)
        columns.check_library(path)


def write_workbook(data: Mapping[str, Any], path: Path | None) -> str:
    """Write an answer as a workbook if one is asked for, and return the line that says so."""
    if path is None:
        return ""
    return f"wrote {path} ({write_answer(data, path)} sheets)"


def check_picture(path: Path) -> None:
    """Refuse a file that cannot be written, and a picture without what draws it."""
    check_writable(path)
    if path.suffix in columns.PICTURES:
        from cardan.app.pictures.style import matplotlib

        matplotlib()

"""Arguments and options that several subcommands take, and what is looked at before a file."""

from __future__ import annotations

import functools
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, TypeVar, cast, get_args

import click

from cardan.app.answers.schema import Kind, answer
from cardan.app.answers.sheets import write_answer
from cardan.app.command.terminal import as_json_text, paragraphs, say
from cardan.app.files import columns
from cardan.app.files.whole_file import check_writable
from cardan.app.scene.language.units import System, shown_in
from cardan.app.scene.scene import BallJointScene, Scene

_Function = TypeVar("_Function", bound=Callable[..., Any])

file_argument = click.argument("file", type=click.Path(path_type=Path))
_SCENE = click.argument("scene", type=click.Path(path_type=Path))
_JSON = click.option("--json", "as_json", is_flag=True, help="Print JSON for programs.")
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


def file_option(name: str, text: str, *argument: str) -> Callable[[_Function], _Function]:
    """Return an option that takes a file to write."""
    of_file = click.Path(path_type=Path)
    return click.option(name, *argument, type=of_file, metavar="FILE", help=text)


def check_output(scene: Scene | BallJointScene | None, path: Path) -> None:
    """Refuse a file that cannot be written or that the scene reads, before the work is done."""
    for section, file in scene.files.items() if isinstance(scene, Scene) else ():
        if path.exists() and path.samefile(file):
            what = "recording" if section == "angles" else f"file of [{section}]"
            raise ValueError(f"{path} is the {what} that the scene reads; it would be overwritten")
    check_picture(path)
    columns.check_library(path)


def check_picture(path: Path) -> None:
    """Refuse a file that cannot be written, and a picture without what draws it."""
    check_writable(path)
    if path.suffix in columns.PICTURES:
        from cardan.app.pictures.style import matplotlib

        matplotlib()


@dataclass(frozen=True)
class Output:
    """Output of a command besides its text, or in place of it."""

    picture: Path | None
    workbook: Path | None
    as_json: bool

    def check(self, scene: Scene | BallJointScene | None = None) -> None:
        """Refuse files that cannot be written or that the scene reads, before the work is done."""
        if self.workbook and self.workbook.suffix != ".xlsx":
            raise ValueError(f"--workbook {self.workbook} must end in .xlsx")
        for path in filter(None, (self.workbook, self.picture)):
            check_output(scene, path)

    def say(self, name: Kind, title: str, text: Callable[[], str], data: Mapping[str, Any]) -> None:
        """Write the workbook of an answer, and print its text or JSON."""
        self.say_whole(text, answer(name, title, **data))

    def say_whole(self, text: Callable[[], str], data: Mapping[str, Any]) -> None:
        """Do the same with all data of the answer."""
        wrote = self.write_workbook(data)
        say(as_json_text(data) if self.as_json else paragraphs(text(), wrote))

    def write_workbook(self, data: Mapping[str, Any]) -> str:
        """Write an answer as a workbook if one is asked for, and return the line that says so."""
        if self.workbook is None:
            return ""
        return f"wrote {self.workbook} ({write_answer(data, self.workbook)} sheets)"


def output_options(*, picture: bool = False) -> Callable[[_Function], _Function]:
    """Return what gives a command the options for its output, which become one argument."""

    def add(function: _Function) -> _Function:
        @functools.wraps(function)
        def command(
            *args: Any,  # noqa: ANN401 - of any command
            picture_file: Path | None = None,
            workbook: Path | None,
            as_json: bool,
            **others: Any,  # noqa: ANN401 - of any command
        ) -> Any:  # noqa: ANN401 - of any command
            return function(*args, **others, output=Output(picture_file, workbook, as_json))

        made: Any = command
        made = _JSON(made)
        made = file_option("--workbook", "Spreadsheet to write as well, as .xlsx.")(made)
        if picture:
            made = file_option("--output", "Picture to write as well.", "picture_file")(made)
        return cast("_Function", made)

    return add

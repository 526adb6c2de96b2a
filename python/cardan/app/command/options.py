"""Arguments and options that several subcommands take."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar

import click

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

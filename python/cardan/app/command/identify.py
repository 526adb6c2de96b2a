"""The command ``cardan identify``."""

from __future__ import annotations

from pathlib import Path

import click

from cardan.app.answers.data import data_of
from cardan.app.answers.identification.figures import identified, sentences
from cardan.app.answers.json_schema import answer
from cardan.app.answers.printed import part_text
from cardan.app.command.options import file_argument, json_option
from cardan.app.command.terminal import as_json_text, say


@click.command()
@file_argument
@click.option("--drive", metavar="COLUMN", required=True, help="Angle of the drive.")
@click.option("--driven", metavar="COLUMN", help="Angle of the driven shaft.")
@click.option("--speed-ratio", metavar="COLUMN", help="Or: speed of that shaft over the drive's.")
@click.option("--intermediate", metavar="COLUMN", help="Angle of the shaft between two joints.")
@click.option(
    "--radians/--degrees",
    help="Angles in the file and in the answer; by default in degrees.",
)
@json_option
def identify(
    file: Path,
    drive: str,
    driven: str | None,
    speed_ratio: str | None,
    intermediate: str | None,
    radians: bool,
    as_json: bool,
) -> None:
    """Find the bend that a recording of a driveline shows.

    FILE is a CSV, Parquet, NPZ or MDF file. It has columns for the angles of the drive and of a
    driven shaft, or for the speed ratio of the driven shaft. The angles may start anew at each
    turn. With the angle of the shaft between two joints, both bends and the phase are found.

    \b
    Examples:
      cardan identify run.csv --drive crank --driven axle
      cardan identify run.csv --drive crank --speed-ratio ratio
      cardan identify run.csv --drive crank --intermediate mid --driven axle
    """
    if (driven is None) == (speed_ratio is None):
        raise click.UsageError("give one of --driven and --speed-ratio")
    if intermediate is not None and driven is None:
        raise click.UsageError("--intermediate needs --driven")
    found = identified(
        file,
        drive,
        driven=driven,
        speed_ratio=speed_ratio,
        intermediate=intermediate,
        radians=radians,
    )
    if as_json:
        say(as_json_text(answer("identify", found.path, **data_of(found, radians=radians))))
        return
    say(part_text(found.path, found, sentences(found), radians=radians))

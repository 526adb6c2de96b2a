"""The command ``cardan run``."""

from __future__ import annotations

from dataclasses import replace
from itertools import chain
from pathlib import Path

import click

from cardan.app.answers.answer import Answer
from cardan.app.answers.states.figures import states_figures
from cardan.app.answers.states.text import OF_DRIVELINE, states_text
from cardan.app.answers.study.figures import StudyTable, study_figures
from cardan.app.answers.study.text import study_text
from cardan.app.answers.turn.data import run_data
from cardan.app.answers.turn.figures import DriveAngles, turn_figures
from cardan.app.answers.turn.text import few_samples_text, signals_text, summary_text
from cardan.app.command.files import (
    check_folder,
    check_for_cluster,
    check_output,
    check_picture,
    missing_of,
    write_ball_joint,
    write_files,
    write_on_cluster,
    wrote,
)
from cardan.app.command.options import into_option, json_option, scene_argument, units_option
from cardan.app.command.terminal import (
    as_json_text,
    progress_bar,
    say,
    say_before_files,
)
from cardan.app.scene import load_scene
from cardan.app.scene.language.schema import describe
from cardan.app.scene.scene import FORMAT, BallJointScene
from cardan.app.scene.study.cluster import StudyFolder
from cardan.app.scene.study.states import StatesResult

# The mark keeps click from filling a paragraph.
_KEYS = describe(FORMAT).replace("\n\n", "\n\n\b\n")

_EPILOG = f"""\
SCENE is a TOML file with these sections and keys:

\b
{_KEYS}
"""


@click.command(epilog=_EPILOG)
@scene_argument
@into_option
@click.option(
    "--local", type=click.IntRange(1), metavar="N", help="Evaluate the study in N processes."
)
@click.option(
    "--scheduler",
    metavar="ADDRESS",
    help="Evaluate the study on this dask cluster.",
)
@units_option
@json_option
def run(
    scene: Path,
    into: Path,
    local: int | None,
    scheduler: str | None,
    radians: bool,
    as_json: bool,
) -> None:
    """Evaluate a scene: print the main results, write curves, study and picture.

    \b
    Examples:
      cardan run shaft.toml
      cardan run shaft.toml --radians --into .
      cardan run shaft.toml --json

    With "--local 8" or "--scheduler tcp://host:8786" a dask cluster does the study. The table must
    then end in .parquet and becomes a folder of files. If the run stops, the same command resumes
    it and computes no file twice.

    A file appears complete or not at all.
    """
    given = load_scene(scene)
    on_cluster = local is not None or scheduler is not None
    if isinstance(given, BallJointScene):
        if on_cluster:
            raise ValueError("a ball joint alone has no study to evaluate in processes")
        _run_ball_joint(given, into, radians=radians, as_json=as_json)
        return
    whole = loaded = given
    if on_cluster:
        check_for_cluster(whole, local, scheduler)
        loaded = replace(whole, study=None, table_file=None)
        check_folder(into / str(whole.table_file))
    seat = loaded.ball_joint and loaded.ball_joint.picture_file
    for name in (loaded.curves_file, loaded.table_file, loaded.picture_file, seat):
        if name:
            check_output(loaded, into / name)
    with progress_bar() as progress:
        result = loaded.run(progress)
    files = write_files(result, into, radians)
    study: StudyTable | None = result.study
    if on_cluster:
        assert whole.study
        files = chain(files, write_on_cluster(whole, into, radians, local, scheduler))
        study = StudyFolder(whole.study, into / str(whole.table_file))
    answer, turn = Answer(whole), turn_figures(result)
    angles = turn.drive_angles
    of_samples = whole.recording or (whole.study and whole.study.quantities)
    warning = few_samples_text(angles) if of_samples else None
    if warning:
        say(f"cardan: {warning}", on_error=True)
    if as_json:
        # The files first: of a study on a cluster they hold the figures.
        written = list(files)
        say(as_json_text(run_data(answer, turn, study, written, radians=radians)))
        return
    if whole.title:
        say_before_files(f"{whole.title}\n")
    if recorded := signals_text(angles):
        say_before_files(f"{recorded}\n")
    say_before_files(summary_text(turn, radians=radians))
    if whole.states:
        say_before_files(f"\n{OF_DRIVELINE}")
    if whole.missing:
        say_before_files(f"\n{missing_of(whole)}")
    for part, found in answer.parts("run"):
        say_before_files(f"\n{part.text(found, radians=radians)}")
    if isinstance(result.study, StatesResult):
        say_before_files(f"\n{states_text(states_figures(result.study, radians=radians))}")
    elif result.study:
        say_before_files(f"\n{_study_text(result.study, angles, radians)}")
    for number, entry in enumerate(files):
        if number == 0:
            say_before_files()
        say_before_files(wrote(**entry))
    if study and not result.study:
        say_before_files(f"\n{_study_text(study, angles, radians)}")


def _study_text(table: StudyTable, angles: DriveAngles, radians: bool) -> str:
    found = study_figures(table, angles.samples, radians=radians)
    return study_text(found, angles, radians=radians)


def _run_ball_joint(scene: BallJointScene, into: Path, *, radians: bool, as_json: bool) -> None:
    if scene.picture_file:
        check_picture(into / scene.picture_file)
    files, answer = write_ball_joint(scene.ball_joint, into, scene.title), Answer(scene)
    if as_json:
        say(as_json_text(run_data(answer, None, None, list(files), radians=radians)))
        return
    if scene.title:
        say_before_files(f"{scene.title}\n")
    for part, found in answer.parts("run"):
        say_before_files(part.text(found, radians=radians))
    for entry in files:
        say_before_files(f"\n{wrote(**entry)}")

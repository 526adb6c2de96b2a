"""The commands that evaluate a scene: ``run``, and ``stream`` for long recordings."""

from __future__ import annotations

import math
import time
from collections.abc import Iterator
from dataclasses import replace
from itertools import chain
from pathlib import Path
from typing import Any

import click

from cardan.app.answers.answer import Answer
from cardan.app.answers.schema import run_data
from cardan.app.answers.states import OF_DRIVELINE, states_figures, states_text
from cardan.app.answers.study import StudyTable, study_figures, study_text
from cardan.app.answers.turn.figures import DriveAngles, recorded_angles, turn_figures
from cardan.app.answers.turn.text import (
    angles_text,
    few_samples_text,
    noise_text,
    signals_text,
    summary_text,
)
from cardan.app.command.options import (
    angle_option,
    check_output,
    check_picture,
    check_workbook,
    in_units,
    into_option,
    json_option,
    missing_samples,
    scene_argument,
    units_given,
    workbook_as_well,
    write_workbook,
)
from cardan.app.command.terminal import as_json_text, progress_bar, say, say_before_files
from cardan.app.files.columns import check_rows
from cardan.app.scene import load_scene
from cardan.app.scene.language.errors import SceneError
from cardan.app.scene.language.schema import describe
from cardan.app.scene.language.units import shown_in
from cardan.app.scene.scene import FORMAT, BallJointScene, Scene, SceneResult
from cardan.app.scene.sections.ball_joint import BallJointCase
from cardan.app.scene.study import cluster, curves
from cardan.app.scene.study.cluster import StudyFolder
from cardan.app.scene.study.curves import write_curves, write_study
from cardan.app.scene.study.states import StatesResult
from cardan.arrays import import_optional

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
@click.option("--scheduler", metavar="ADDRESS", help="Evaluate the study on this dask cluster.")
@angle_option
@workbook_as_well
@json_option
def run(
    scene: Path,
    into: Path,
    local: int | None,
    scheduler: str | None,
    radians: bool,
    workbook: Path | None,
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
    given = in_units(load_scene(scene))
    check_workbook(workbook, given)
    on_cluster = local is not None or scheduler is not None
    if isinstance(given, BallJointScene):
        if on_cluster:
            raise ValueError("a ball joint alone has no study to evaluate in processes")
        _run_ball_joint(given, into, workbook, radians=radians, as_json=as_json)
        return
    whole = loaded = given
    if on_cluster:
        _check_for_cluster(whole, local, scheduler)
        loaded = replace(whole, study=None, table_file=None)
        path = into / str(whole.table_file)
        if path.exists() and not path.is_dir():
            raise ValueError(f"{path} is a file; a study on a cluster writes a folder of that name")
    seat = loaded.ball_joint and loaded.ball_joint.picture_file
    of_study = math.prod(loaded.study.shape) if loaded.study else 0
    for name, rows in (
        (loaded.curves_file, len(loaded.drive_angle)),
        (loaded.table_file, of_study),
        (loaded.picture_file, 0),
        (seat, 0),
    ):
        if name:
            check_output(loaded, into / name)
            check_rows(into / name, rows)
            if workbook and (into / name).resolve() == workbook.resolve():
                raise ValueError(f"--workbook {workbook} is a file that the scene writes")
    with progress_bar() as progress:
        result = loaded.run(progress)
    files = _write_files(result, into, radians)
    study: StudyTable | None = result.study
    if on_cluster:
        assert whole.study
        files = chain(files, _write_on_cluster(whole, into, radians, local, scheduler))
        study = StudyFolder(whole.study, into / str(whole.table_file), whole.units)
    answer, turn = Answer(whole), turn_figures(result)
    angles = turn.drive_angles
    of_samples = whole.recording or (whole.study and whole.study.quantities)
    warning = few_samples_text(angles) if of_samples else None
    for text in filter(None, (warning, noise_text(angles))):
        say(f"cardan: {text}", on_error=True)
    if as_json:
        # The files first: of a study on a cluster they hold the figures.
        written = list(files)
        data = run_data(answer, turn, study, written, radians=radians)
        if write_workbook(data, workbook):
            data["files"].append({"file": str(workbook)})
        say(as_json_text(data))
        return
    if whole.title:
        say_before_files(f"{whole.title}\n")
    if recorded := signals_text(angles):
        say_before_files(f"{recorded}\n")
    say_before_files(summary_text(turn, radians=radians))
    if whole.states:
        say_before_files(f"\n{OF_DRIVELINE}")
    if whole.missing and whole.recording:
        count, where = len(whole.drive_angle), whole.recording.name
        say_before_files(f"\n{missing_samples(whole.missing, count, where)}")
    for part, found in answer.parts("run"):
        say_before_files(f"\n{part.text(found, radians=radians)}")
    if isinstance(result.study, StatesResult):
        say_before_files(f"\n{states_text(states_figures(result.study, radians=radians))}")
    elif result.study:
        say_before_files(f"\n{_study_text(result.study, angles, radians)}")
    written = []
    for entry in files:
        if not written:
            say_before_files()
        say_before_files(wrote(**entry))
        written.append(entry)
    if workbook:
        data = run_data(answer, turn, study, written, radians=radians)
        if not written:
            say_before_files()
        say_before_files(write_workbook(data, workbook))
    if study and not result.study:
        say_before_files(f"\n{_study_text(study, angles, radians)}")


def _study_text(table: StudyTable, angles: DriveAngles, radians: bool) -> str:
    found = study_figures(table, angles.samples, radians=radians)
    return study_text(found, angles, radians=radians)


def _run_ball_joint(
    scene: BallJointScene, into: Path, workbook: Path | None, *, radians: bool, as_json: bool
) -> None:
    if scene.picture_file:
        check_picture(into / scene.picture_file)
    answer = Answer(scene)
    files = list(_write_ball_joint(scene.ball_joint, into, scene.title))
    data = run_data(answer, None, None, files, radians=radians)
    if write_workbook(data, workbook):
        data["files"].append({"file": str(workbook)})
    if as_json:
        say(as_json_text(data))
        return
    if scene.title:
        say_before_files(f"{scene.title}\n")
    for part, found in answer.parts("run"):
        say_before_files(part.text(found, radians=radians))
    for entry in data["files"]:
        say_before_files(f"\n{wrote(**entry)}")


def _write_files(result: SceneResult, into: Path, radians: bool) -> Iterator[dict[str, Any]]:
    """Write the files of a scene one by one; yield path and number of rows of each."""
    scene = result.scene
    if scene.curves_file:
        path = into / scene.curves_file
        with progress_bar(path.name) as progress:
            rows = write_curves(result, path, radians=radians, progress=progress)
        yield {"file": str(path), "rows": rows}
    if scene.table_file and result.study:
        path = into / scene.table_file
        with progress_bar(path.name) as progress:
            rows = write_study(
                result.study, path, radians=radians, units=scene.units, progress=progress
            )
        yield {"file": str(path), "rows": rows}
    if scene.picture_file:
        path = into / scene.picture_file
        from cardan.app.plots import write_picture

        write_picture(result, path)
        yield {"file": str(path)}
    if scene.ball_joint:
        yield from _write_ball_joint(scene.ball_joint, into, scene.title)


def _write_ball_joint(case: BallJointCase, into: Path, title: str) -> Iterator[dict[str, Any]]:
    """Write the picture of a ball joint if the scene names one; yield its path."""
    if case.picture_file:
        from cardan.app.plots import plot_ball_joint, save

        path = into / case.picture_file
        save(plot_ball_joint(case, title), path)
        yield {"file": str(path)}


def wrote(file: str, rows: int = 0, parts: int = 0, found: int = 0) -> str:
    """Return the line that says which file was written."""
    if not rows:
        return f"wrote {file}"
    size, files = _count(rows, "row"), _count(parts, "file")
    if not parts:
        return f"wrote {file} ({size})"
    if found == parts:
        return f"kept {file} ({size} in {files}, already complete)"
    there = f", {found} of them already complete" if found else ""
    return f"wrote {file} ({size} in {files}{there})"


def _count(number: int, what: str) -> str:
    return f"{number} {what}{'s' if number != 1 else ''}"


def _check_for_cluster(scene: Scene, local: int | None, scheduler: str | None) -> None:
    """Refuse options and scenes that do not go with a cluster."""
    if local and scheduler:
        raise ValueError("--local and --scheduler are both given; give one of them")
    if scheduler == "":
        raise ValueError("--scheduler is empty; give an address, as tcp://host:8786")
    if scene.states:
        raise ValueError("states are evaluated in one process; only a study is distributed")
    if not scene.study or not str(scene.table_file).endswith(".parquet"):
        option = "--local" if local else "--scheduler"
        raise ValueError(f"{option} needs a scene with a study and a table that ends in .parquet")
    import_optional("distributed", "dask")
    import_optional("pyarrow", "table")


def _write_on_cluster(
    scene: Scene, into: Path, radians: bool, local: int | None, scheduler: str | None
) -> Iterator[dict[str, Any]]:
    """Write the table of a scene as a folder; yield path, rows and files."""
    assert scene.study
    assert scene.table_file
    path = into / scene.table_file
    with cluster.connect(scheduler, local) as client, progress_bar() as progress:
        try:
            done = cluster.write_study(
                scene.study,
                path,
                client,
                radians=radians,
                units=scene.units,
                progress=progress,
            )
        except ValueError as error:
            raise SceneError(error, scene.name, "study") from None
    yield {"file": str(path), "rows": done.rows, "parts": done.files, "found": done.found}


@click.command()
@scene_argument
@into_option
@angle_option
def stream(scene: Path, into: Path, radians: bool) -> None:
    """Evaluate a recording of any length, in chunks that fit in memory.

    The scene needs a section [angles], and curves that end in .parquet. Only the curves are
    written.

    \b
    Example:
      cardan stream long.toml
    """
    begun = time.perf_counter()
    try:
        with progress_bar("rows") as progress:
            done = curves.stream(
                scene, into, radians=radians, units=units_given(), progress=progress
            )
    except MemoryError:
        # It takes the angles by chunks already.
        hint = "not enough memory; fewer quantities, shafts or joints in [output] need less"
        raise click.ClickException(hint) from None
    rate = done.rows / (time.perf_counter() - begun) / 1e6
    say(f"wrote {done.path} ({done.rows} rows, {rate:.3g} million a second)")
    angles = recorded_angles(
        done.rows, done.missing, done.ends_deg, done.turns, done.signals, done.extent_deg
    )
    say(f"drive angles {angles_text(angles, radians=radians)}")
    if done.signals:
        with shown_in(done.units):
            say(signals_text(angles))
    for warning in filter(None, (few_samples_text(angles), noise_text(angles))):
        say(f"cardan: {warning}", on_error=True)
    if done.missing:
        say(missing_samples(done.missing, done.rows, "the recording"))

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
from cardan.app.answers.turn import text as turn
from cardan.app.answers.turn.figures import DriveAngles, recorded_angles, turn_figures
from cardan.app.command import options, terminal
from cardan.app.files.columns import check_rows
from cardan.app.scene import load_scene
from cardan.app.scene.language.errors import SceneError
from cardan.app.scene.language.schema import describe
from cardan.app.scene.language.units import shown_in
from cardan.app.scene.scene import FORMAT, BallJointScene, Scene, SceneResult
from cardan.app.scene.sections.ball_joint import BallJointCase
from cardan.app.scene.study import cluster, curves
from cardan.app.scene.study.cluster import StudyFolder
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
@options.scene_argument
@options.into_option
@click.option(
    "--local", type=click.IntRange(1), metavar="N", help="Evaluate the study in N processes."
)
@click.option("--scheduler", metavar="ADDRESS", help="Evaluate the study on this dask cluster.")
@options.angle_option
@options.output_options()
def run(
    scene: Path,
    into: Path,
    local: int | None,
    scheduler: str | None,
    radians: bool,
    output: options.Output,
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

    Files are written completely or not at all.
    """
    given = options.in_units(load_scene(scene))
    output.check(given)
    on_cluster = local is not None or scheduler is not None
    if isinstance(given, BallJointScene):
        if on_cluster:
            raise ValueError("a ball joint alone has no study to evaluate in processes")
        _run_ball_joint(given, into, output, radians=radians)
        return
    whole = loaded = given
    if on_cluster:
        _check_for_cluster(whole, local, scheduler)
        loaded = replace(whole, study=None, table_file=None)
        path = into / str(whole.table_file)
        if path.exists() and not path.is_dir():
            raise ValueError(f"{path} is a file; a study on a cluster writes a folder of that name")
    _check_files(loaded, into, output.workbook)
    with terminal.progress_bar() as progress:
        result = loaded.run(progress)
    files = _write_files(result, into, radians)
    table: StudyTable | None = result.study
    if on_cluster:
        assert whole.study
        files = chain(files, _write_on_cluster(whole, into, radians, local, scheduler))
        table = StudyFolder(whole.study, into / str(whole.table_file), whole.units)
    answer, of_turn = Answer(whole), turn_figures(result)
    angles = of_turn.drive_angles
    of_samples = whole.recording or (whole.study and whole.study.quantities)
    warning = turn.few_samples_text(angles) if of_samples else None
    for text in filter(None, (warning, turn.noise_text(angles))):
        terminal.say(f"cardan: {text}", on_error=True)
    if output.as_json:
        # The files first: of a study on a cluster they hold the figures.
        written = list(files)
        _say_json(run_data(answer, of_turn, table, written, radians=radians), output)
        return
    say = terminal.say_before_files
    if whole.title:
        say(f"{whole.title}\n")
    if recorded := turn.signals_text(angles):
        say(f"{recorded}\n")
    say(turn.summary_text(of_turn, radians=radians))
    if whole.states:
        say(f"\n{OF_DRIVELINE}")
    if whole.missing and whole.recording:
        count, where = len(whole.drive_angle), whole.recording.name
        say(f"\n{_missing_text(whole.missing, count, where)}")
    for part, found in answer.parts("run"):
        say(f"\n{part.text(found, radians=radians)}")
    if isinstance(result.study, StatesResult):
        say(f"\n{states_text(states_figures(result.study, radians=radians))}")
    elif result.study:
        say(f"\n{_study_text(result.study, angles, radians)}")
    written = []
    for entry in files:
        say(wrote(**entry) if written else f"\n{wrote(**entry)}")
        written.append(entry)
    if output.workbook:
        line = output.write_workbook(run_data(answer, of_turn, table, written, radians=radians))
        say(line if written else f"\n{line}")
    if table and not result.study:
        say(f"\n{_study_text(table, angles, radians)}")


def _check_files(scene: Scene, into: Path, workbook: Path | None) -> None:
    """Refuse files of the scene that cannot be written, before the work is done."""
    of_study = math.prod(scene.study.shape) if scene.study else 0
    for name, rows in (
        (scene.curves_file, len(scene.drive_angle)),
        (scene.table_file, of_study),
        (scene.picture_file, 0),
        (scene.ball_joint and scene.ball_joint.picture_file, 0),
    ):
        if name:
            options.check_output(scene, into / name)
            check_rows(into / name, rows)
            if workbook and (into / name).resolve() == workbook.resolve():
                raise ValueError(f"--workbook {workbook} is a file that the scene writes")


def _say_json(data: dict[str, Any], output: options.Output) -> None:
    if output.write_workbook(data):
        data["files"].append({"file": str(output.workbook)})
    terminal.say(terminal.as_json_text(data))


def _study_text(table: StudyTable, angles: DriveAngles, radians: bool) -> str:
    found = study_figures(table, angles.samples, radians=radians)
    return study_text(found, angles, radians=radians)


def _missing_text(missing: int, count: int, where: str) -> str:
    """The line that says how many samples are missing where."""
    verb = "is" if missing == 1 else "are"
    return f"{missing} of {count} samples {verb} missing in {where}; their results are NaN."


def _run_ball_joint(
    scene: BallJointScene, into: Path, output: options.Output, *, radians: bool
) -> None:
    if scene.picture_file:
        options.check_picture(into / scene.picture_file)
    answer = Answer(scene)
    files = list(_write_ball_joint(scene.ball_joint, into, scene.title))
    data = run_data(answer, None, None, files, radians=radians)
    if output.as_json:
        _say_json(data, output)
        return
    if output.write_workbook(data):
        files.append({"file": str(output.workbook)})
    parts = [part.text(found, radians=radians) for part, found in answer.parts("run")]
    lines = [wrote(**entry) for entry in files]
    terminal.say_before_files(terminal.paragraphs(scene.title, *parts, *lines))


def _write_files(result: SceneResult, into: Path, radians: bool) -> Iterator[dict[str, Any]]:
    """Write the files of a scene one by one; yield path and number of rows of each."""
    scene = result.scene
    how: dict[str, Any] = {"radians": radians}
    if scene.curves_file:
        path = into / scene.curves_file
        with terminal.progress_bar(path.name) as progress:
            rows = curves.write_curves(result, path, progress=progress, **how)
        yield {"file": str(path), "rows": rows}
    if scene.table_file and result.study:
        path, how["units"] = into / scene.table_file, scene.units
        with terminal.progress_bar(path.name) as progress:
            rows = curves.write_study(result.study, path, progress=progress, **how)
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
    with cluster.connect(scheduler, local) as client, terminal.progress_bar() as progress:
        try:
            done = cluster.write_study(
                scene.study, path, client, radians=radians, units=scene.units, progress=progress
            )
        except ValueError as error:
            raise SceneError(error, scene.name, "study") from None
    yield {"file": str(path), "rows": done.rows, "parts": done.files, "found": done.found}


@click.command()
@options.scene_argument
@options.into_option
@options.angle_option
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
        with terminal.progress_bar("rows") as progress:
            done = curves.stream(
                scene, into, radians=radians, units=options.units_given(), progress=progress
            )
    except MemoryError:
        # It takes the angles by chunks already.
        hint = "not enough memory; fewer quantities, shafts or joints in [output] need less"
        raise click.ClickException(hint) from None
    rate = done.rows / (time.perf_counter() - begun) / 1e6
    terminal.say(f"wrote {done.path} ({done.rows} rows, {rate:.3g} million a second)")
    angles = recorded_angles(
        done.rows, done.missing, done.ends_deg, done.turns, done.signals, done.extent_deg
    )
    terminal.say(f"drive angles {turn.angles_text(angles, radians=radians)}")
    if done.signals:
        with shown_in(done.units):
            terminal.say(turn.signals_text(angles))
    for warning in filter(None, (turn.few_samples_text(angles), turn.noise_text(angles))):
        terminal.say(f"cardan: {warning}", on_error=True)
    if done.missing:
        terminal.say(_missing_text(done.missing, done.rows, "the recording"))

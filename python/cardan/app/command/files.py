"""The files that the command writes for a scene; the pictures are imported to be drawn."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from cardan.app.command.terminal import progress_bar
from cardan.app.files import columns
from cardan.app.files.whole_file import check_writable
from cardan.app.scene.language.errors import SceneError
from cardan.app.scene.scene import BallJointScene, Scene, SceneResult
from cardan.app.scene.sections.ball_joint import BallJointCase
from cardan.app.scene.study import cluster
from cardan.app.scene.study.curves import write_curves, write_study
from cardan.arrays import import_optional


def write_files(result: SceneResult, into: Path, radians: bool) -> Iterator[dict[str, Any]]:
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
            rows = write_study(result.study, path, radians=radians, progress=progress)
        yield {"file": str(path), "rows": rows}
    if scene.picture_file:
        path = into / scene.picture_file
        from cardan.app.plots import write_picture

        write_picture(result, path)
        yield {"file": str(path)}
    if scene.ball_joint:
        yield from write_ball_joint(scene.ball_joint, into, scene.title)


def write_ball_joint(case: BallJointCase, into: Path, title: str) -> Iterator[dict[str, Any]]:
    """Write the picture of a ball joint if the scene names one; yield its path."""
    if case.picture_file:
        from cardan.app.plots import plot_ball_joint, save

        path = into / case.picture_file
        save(plot_ball_joint(case, title), path)
        yield {"file": str(path)}


def missing_of(scene: Scene) -> str:
    """Return the line that says how many recorded samples of a scene are missing."""
    assert scene.recording
    return missing_samples(scene.missing, len(scene.drive_angle), scene.recording.name)


def missing_samples(missing: int, count: int, where: str) -> str:
    """Return the line that says how many samples are missing where."""
    verb = "is" if missing == 1 else "are"
    return f"{missing} of {count} samples {verb} missing in {where}; their results are NaN."


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


def check_for_cluster(scene: Scene, local: int | None, scheduler: str | None) -> None:
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


def check_folder(path: Path) -> None:
    """Refuse a file in the place of the folder of a study, before the work is done."""
    if path.exists() and not path.is_dir():
        raise ValueError(f"{path} is a file; a study on a cluster writes a folder of that name")


def write_on_cluster(
    scene: Scene, into: Path, radians: bool, local: int | None, scheduler: str | None
) -> Iterator[dict[str, Any]]:
    """Write the table of a scene as a folder; yield path, rows and files."""
    assert scene.study
    assert scene.table_file
    path = into / scene.table_file
    with cluster.connect(scheduler, local) as client, progress_bar() as progress:
        try:
            done = cluster.write_study(
                scene.study, path, client, radians=radians, progress=progress
            )
        except ValueError as error:
            raise SceneError(error, scene.name, "study") from None
    yield {"file": str(path), "rows": done.rows, "parts": done.files, "found": done.found}


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

"""The command ``cardan``."""

from __future__ import annotations

import io
import json
import os
import signal
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import replace
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from cardan import __version__, cluster, starters, tables
from cardan.answers import check_scene, yoke_settings, yoke_text
from cardan.curves import check_writable, whole_file, write_curves, write_study
from cardan.plots import SUFFIXES, write_picture
from cardan.report import write_report
from cardan.scene import Scene
from cardan.scene_format import describe
from cardan.study import Progress
from cardan.summary import study_data, study_text, summary, summary_data, summary_text

if TYPE_CHECKING:
    import click

    from cardan.scene import SceneResult

_Function = TypeVar("_Function", bound=Callable[..., Any])

_HELP = """\
Motion and moments of universal joints and drivelines.

What a driveline is and what is wanted of it stands in a scene, a short TOML file. Begin with one
that runs as it stands:

\b
  cardan new z-shaft shaft.toml
  cardan run shaft.toml
  cardan check shaft.toml

"cardan run --help" lists all keys of a scene, "cardan COMMAND --help" shows more examples.

Exit status: 0 done, 1 "check" found a limit exceeded, 2 something is wrong with what was given (one
line says what), 130 interrupted.
"""

# The mark keeps click from filling a paragraph.
_KEYS = describe().replace("\n\n", "\n\n\b\n")

_RUN = f"""\
Evaluate a scene: print a short table, write curves, study and picture.

\b
Examples:
  cardan run shaft.toml
  cardan run shaft.toml --radians --into .
  cardan run shaft.toml --json

With "--local 8" or "--scheduler tcp://host:8786" a dask cluster does the study, and its table,
which must end in .parquet, becomes a folder of files. The same command goes on where a run was
stopped: no file that is there is computed again.

SCENE is a TOML file of these sections and keys:

\b
{_KEYS}
Files appear whole or not at all.
"""

_STREAM = """\
Evaluate recorded angles of any number, by chunks in little memory.

The scene has a section [angles] with a .parquet file, and curves that end in .parquet; these are
all that is written.

\b
Example:
  cardan stream long.toml
"""

_EXPLAIN = """\
Say how a scene and its study are evaluated: the steps taken, what is skipped and why, and what a
sample costs.

\b
Example:
  cardan explain shaft.toml
"""

_PLOT = f"""\
Draw a scene into a file that ends in {", ".join(SUFFIXES)}.

\b
Examples:
  cardan plot shaft.toml
  cardan plot shaft.toml --output shaft.png

With "--study equivalent_bend" that figure of the scene's study is drawn over the keys that it
varies: curves over one key, a map over two.
"""

_CHECK = """\
Check a scene against the limits of the catalogues and of practice.

The equivalent bend must not exceed 3 deg; with a speed given, the excitation by the last shaft and
by the shafts between is checked as well. In a study every driveline must keep the limits, and each
figure is the worst of them, with its place. The exit status is 0 if all limits are kept and 1 if
not.

\b
Examples:
  cardan check shaft.toml
  cardan check shaft.toml --json
"""

_PHASE = """\
Say how to set the yokes so that the last shaft turns as evenly as possible.

\b
Examples:
  cardan phase shaft.toml
  cardan phase shaft.toml --json
"""

_REPORT = """\
Write a page to hand on, with a driveline that turns in it.

It says whether the driveline runs smoothly, what loads the bearings and how to set the yokes, and
shows inputs, tables and curves. One HTML file holds everything; it needs no network.

\b
Examples:
  cardan report shaft.toml
  cardan report shaft.toml --output shaft.html
"""

_NEW = f"""\
Write a commented scene that runs as it stands; an existing file stays as it is.

\b
KIND is one of
{chr(10).join(f"  {kind:10}{starter.meaning}" for kind, starter in starters.STARTERS.items())}

\b
Examples:
  cardan new joint joint.toml
  cardan new recorded run.toml
"""

_SCHEMA = """\
Print the JSON Schema of scenes, by which editors complete and check them.

\b
Examples:
  cardan schema
  cardan schema --output scene.schema.json
"""


def commands() -> click.Group:
    """Return the command with its subcommands.

    Raises:
        ImportError: click is missing.
    """
    import click

    class OneLine(click.Group):
        """A group that reports every error in one line with exit status 2."""

        def main(self, *args: Any, **extra: Any) -> Any:  # noqa: ANN401 - as click has it
            try:
                status = super().main(*args, **{**extra, "standalone_mode": False})
                sys.stdout.flush()
            except click.Abort:
                sys.exit(130)
            except click.ClickException as error:
                message = error.format_message()
            except SystemExit:
                # So click ends where whoever reads has stopped, as in "cardan schema | head"; its 1
                # would say that a check had failed.
                if hasattr(signal, "SIGPIPE"):
                    signal.signal(signal.SIGPIPE, signal.SIG_DFL)
                    signal.raise_signal(signal.SIGPIPE)
                raise
            except OSError as error:
                if error.filename is None:
                    _give_up_output()
                message = f"{error.filename or 'output'}: {error.strerror or error}"
            except MemoryError:
                message = "not enough memory; a smaller samples_per_turn or study needs less"
            except (ValueError, ImportError) as error:
                message = str(error)
            else:
                sys.exit(status or 0)
            with suppress(BrokenPipeError):
                click.echo(f"cardan: {' '.join(message.split())}", err=True)
            sys.exit(2)

    scene_argument = click.argument("scene", type=click.Path(path_type=Path))
    as_json = click.option("--json", "as_json", is_flag=True, help="Print JSON for programs.")
    into_option = click.option(
        "--into",
        type=click.Path(exists=True, file_okay=False, path_type=Path),
        default=".",
        metavar="DIR",
        help="Folder for the files to write; by default the current one.",
    )
    units = click.option(
        "--radians/--degrees",
        help="Angles printed and in files of numbers; by default in degrees, as in pictures.",
    )

    def output_option(text: str) -> Callable[[_Function], _Function]:
        return click.option("--output", type=click.Path(path_type=Path), metavar="FILE", help=text)

    @click.group(cls=OneLine, help=_HELP, invoke_without_command=True)
    @click.version_option(__version__, prog_name="cardan", message="%(prog)s %(version)s")
    @click.pass_context
    def cardan(context: click.Context) -> None:
        if context.invoked_subcommand is None:
            click.echo(context.get_help())

    @cardan.command(help=_NEW, short_help="Write a scene to begin with.")
    @click.argument("kind", type=click.Choice(list(starters.STARTERS)), metavar="KIND")
    @click.argument("file", type=click.Path(path_type=Path))
    def new(kind: str, file: Path) -> None:
        for path in starters.write_starter(kind, file):
            click.echo(f"wrote {path}")
        click.echo(f"next: cardan run {file}")

    @cardan.command(help=_RUN, short_help="Evaluate a scene.")
    @scene_argument
    @into_option
    @click.option(
        "--local", type=click.IntRange(1), metavar="N", help="Do the study in N processes."
    )
    @click.option(
        "--scheduler", metavar="ADDRESS", help="Do the study on the cluster of this dask scheduler."
    )
    @units
    @as_json
    def run(
        scene: Path,
        into: Path,
        local: int | None,
        scheduler: str | None,
        radians: bool,
        as_json: bool,
    ) -> None:
        whole = loaded = Scene.load(scene)
        on_cluster = local is not None or scheduler is not None
        if on_cluster:
            _check_for_cluster(whole, local, scheduler)
            loaded = replace(whole, study=None, table_file=None)
        for name in (loaded.curves_file, loaded.table_file, loaded.picture_file):
            if name:
                _check_output(loaded, into / name)
        with _progress_bar() as progress:
            result = loaded.run(progress)
        files = _write(result, into, radians)
        if on_cluster:
            files = chain(files, _write_on_cluster(whole, into, radians, local, scheduler))
        if as_json:
            data: dict[str, Any] = {"title": loaded.title}
            data["summary"] = summary_data(summary(result), radians=radians)
            if result.study:
                data["study"] = study_data(result.study, radians=radians)
            click.echo(_json({**data, "files": list(files)}))
            return
        if loaded.title:
            _say(f"{loaded.title}\n")
        _say(summary_text(summary(result), radians=radians))
        if result.study:
            _say(f"\n{study_text(result.study, radians=radians)}")
        for number, entry in enumerate(files):
            if number == 0:
                _say()
            _say(_wrote(**entry))

    @cardan.command(help=_STREAM, short_help="Evaluate recorded angles of any number.")
    @scene_argument
    @into_option
    @units
    def stream(scene: Path, into: Path, radians: bool) -> None:
        begun = time.perf_counter()
        with _progress_bar("rows") as progress:
            path, rows = tables.stream(scene, into, radians=radians, progress=progress)
        rate = rows / (time.perf_counter() - begun) / 1e6
        click.echo(f"wrote {path} ({rows} rows, {rate:.3g} million a second)")

    @cardan.command(help=_EXPLAIN, short_help="Say how a scene is evaluated.")
    @scene_argument
    def explain(scene: Path) -> None:
        click.echo(Scene.load(scene).explain())

    @cardan.command(help=_PLOT, short_help="Draw a scene.")
    @scene_argument
    @output_option("Picture to write; by default named as the scene, .svg, in the current folder.")
    @click.option(
        "--study", metavar="FIGURE", help="Draw this figure of the study over its keys instead."
    )
    def plot(scene: Path, output: Path | None, study: str | None) -> None:
        path = output or Path(f"{scene.stem}.svg")
        loaded = Scene.load(scene)
        check_writable(path)
        with _progress_bar() as progress:
            result = loaded.run(progress)
        write_picture(result, path, study)
        click.echo(f"wrote {path}")

    @cardan.command(help=_REPORT, short_help="Write a page to hand on.")
    @scene_argument
    @output_option("Page to write; by default named as the scene, .html, in the current folder.")
    def report(scene: Path, output: Path | None) -> None:
        path = output or Path(f"{scene.stem}.html")
        loaded = Scene.load(scene)
        _check_output(loaded, path)
        with _progress_bar() as progress:
            write_report(loaded, path, progress)
        click.echo(f"wrote {path}")

    @cardan.command(help=_CHECK, short_help="Check a scene against the limits.")
    @scene_argument
    @as_json
    def check(scene: Path, as_json: bool) -> int:
        loaded = Scene.load(scene)
        with _progress_bar() as progress:
            found = check_scene(loaded, progress)
        passes = bool(np.all(found.passes))
        if as_json:
            findings = [
                {
                    "name": finding.name,
                    "worst": float(np.max(finding.value)),
                    **({"worst_at": finding.worst_at} if finding.worst_at else {}),
                    "limit": finding.limit,
                    "maximum": finding.maximum,
                    "unit": finding.unit,
                    "passes": bool(np.all(finding.passes)),
                }
                for finding in found.findings
            ]
            click.echo(_json({"title": loaded.title, "passes": passes, "findings": findings}))
        else:
            click.echo(str(found))
        return 0 if passes else 1

    @cardan.command(help=_PHASE, short_help="Say how to set the yokes.")
    @scene_argument
    @as_json
    def phase(scene: Path, as_json: bool) -> None:
        data = yoke_settings(Scene.load(scene))
        click.echo(_json(data) if as_json else yoke_text(data))

    @cardan.command(help=_SCHEMA, short_help="Print the JSON Schema of scenes.")
    @output_option("File to write; by default it is printed.")
    def schema(output: Path | None) -> None:
        text = _json(Scene.schema())
        if output is None:
            click.echo(text)
            return
        with whole_file(output) as file:
            file.write(f"{text}\n".encode())
        click.echo(f"wrote {output}")

    return cardan


def main() -> None:
    """Run the command; the entry point of the script ``cardan``."""
    # A terminal that lacks a character of a title gets another one instead.
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")
    try:
        group = commands()
    except ModuleNotFoundError:
        print("cardan: the command needs click: pip install 'cardan[app]'", file=sys.stderr)
        sys.exit(2)
    group(prog_name="cardan")


def _write(result: SceneResult, into: Path, radians: bool) -> Iterator[dict[str, Any]]:
    """Write the files of a scene one by one; yield path and number of rows of each."""
    scene = result.scene
    if scene.curves_file:
        path = into / scene.curves_file
        with _progress_bar(path.name) as progress:
            rows = write_curves(result, path, radians=radians, progress=progress)
        yield {"file": str(path), "rows": rows}
    if scene.table_file and result.study:
        path = into / scene.table_file
        with _progress_bar(path.name) as progress:
            rows = write_study(result.study, path, radians=radians, progress=progress)
        yield {"file": str(path), "rows": rows}
    if scene.picture_file:
        path = into / scene.picture_file
        write_picture(result, path)
        yield {"file": str(path)}


def _wrote(file: str, rows: int = 0, parts: int = 0, found: int = 0) -> str:
    if not rows:
        return f"wrote {file}"
    there = f", {found} of them found there" if found else ""
    count = f"{rows} row{'s' if rows > 1 else ''}"
    return f"wrote {file} ({count}{f' in {parts} files{there}' if parts else ''})"


def _check_for_cluster(scene: Scene, local: int | None, scheduler: str | None) -> None:
    if local and scheduler:
        raise ValueError("--local and --scheduler are both given; give one of them")
    if scheduler == "":
        raise ValueError("--scheduler is empty; give an address, as tcp://host:8786")
    if not scene.study or not str(scene.table_file).endswith(".parquet"):
        option = "--local" if local else "--scheduler"
        raise ValueError(f"{option} needs a scene with a study and a table that ends in .parquet")


def _write_on_cluster(
    scene: Scene, into: Path, radians: bool, local: int | None, scheduler: str | None
) -> Iterator[dict[str, Any]]:
    """Write the table of a scene as a folder; yield path, rows and files."""
    assert scene.study
    assert scene.table_file
    path = into / scene.table_file
    with cluster.connect(scheduler, local) as client, _progress_bar() as progress:
        try:
            done = cluster.write_study(
                scene.study, path, client, radians=radians, progress=progress
            )
        except ValueError as error:
            raise ValueError(f"{scene.name}: [study] {error}") from None
    yield {"file": str(path), "rows": done.rows, "parts": done.files, "found": done.found}


def _check_output(scene: Scene, path: Path) -> None:
    """Refuse a file that cannot be written or that the scene reads."""
    if scene.recording and path.exists() and path.samefile(scene.recording):
        raise ValueError(f"{path} is the recording that the scene reads; it would be overwritten")
    check_writable(path)


def _json(data: Any) -> str:  # noqa: ANN401 - any plain data
    return json.dumps(data, indent=2, ensure_ascii=False, allow_nan=False)


@contextmanager
def _progress_bar(label: str = "study") -> Iterator[Progress | None]:
    """A bar on a terminal for what takes more than one block."""
    import click

    # A terminal that cannot move its cursor would get a line per step.
    if not sys.stderr.isatty() or os.environ.get("TERM") == "dumb":
        yield None
        return
    with ExitStack() as stack:
        bars: list[Any] = []

        def progress(done: int, rows: int) -> None:
            if not bars and done < rows:
                bar = click.progressbar(length=rows, label=label, file=sys.stderr)
                bars.append(stack.enter_context(bar))
            for bar in bars:
                bar.update(done - bar.pos)

        yield progress


def _say(text: str = "") -> None:
    """Print; if whoever reads has stopped, the files to come are written all the same."""
    import click

    try:
        click.echo(text)
    except BrokenPipeError:
        _give_up_output()


def _give_up_output() -> None:
    """Send what is printed nowhere, so that an output that takes no more does not fail again."""
    with open(os.devnull, "wb") as nowhere:
        os.dup2(nowhere.fileno(), sys.stdout.fileno())

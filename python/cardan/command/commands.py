"""The command ``cardan`` and its subcommands."""

from __future__ import annotations

import signal
import sys
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar, get_args

import cardan.command.help_text as help_text
from cardan import __version__
from cardan.command import ball_joint, in_service
from cardan.command import check as checking
from cardan.command import optimise as optimising
from cardan.command import run as running
from cardan.command import tolerances as tolerancing
from cardan.command import torsion as vibration
from cardan.command.files import (
    check_output,
    missing_samples,
)
from cardan.command.terminal import (
    as_json_text,
    give_up_output,
    progress_bar,
    say,
)
from cardan.errors import ArgumentValueError
from cardan.figures.backlash import drawn_backlash
from cardan.figures.identification import identification_data
from cardan.figures.scene_forces import scene_force_paths
from cardan.figures.schema import answers_schema
from cardan.figures.slides import drawn_slides
from cardan.figures.summary import recorded_angles
from cardan.figures.yokes import yoke_settings
from cardan.files.whole_file import whole_file
from cardan.plots import plot_forces, save, write_backlash, write_picture, write_slides
from cardan.plots.abscissa import Over
from cardan.plots.torsion import PICTURES
from cardan.report import write_report
from cardan.scene import load_scene, starters
from cardan.scene.ball_joint_scene import BallJointScene
from cardan.scene.scene import Scene
from cardan.scene.streaming import stream as stream_curves
from cardan.words.identification import identification_text
from cardan.words.signals import signals_text
from cardan.words.summary import angles_text, few_samples_text
from cardan.words.yokes import yoke_text

if TYPE_CHECKING:
    import click

_Function = TypeVar("_Function", bound=Callable[..., Any])


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
                    give_up_output()
                message = f"{error.filename or 'output'}: {error.strerror or error}"
            except MemoryError:
                message = "not enough memory; fewer samples or a smaller study need less"
            except (ValueError, ImportError) as error:
                message = str(error)
            else:
                sys.exit(status or 0)
            with suppress(BrokenPipeError):
                say(f"cardan: {' '.join(message.split())}", on_error=True)
            sys.exit(2)

    file_argument = click.argument("file", type=click.Path(path_type=Path))
    scene_argument = click.argument("scene", type=click.Path(path_type=Path))
    as_json = click.option("--json", "as_json", is_flag=True, help="Print JSON for programs.")
    into_option = click.option(
        "--into",
        type=click.Path(exists=True, file_okay=False, path_type=Path),
        default=".",
        metavar="DIR",
        help="Folder for the files to write; default: the current one.",
    )
    units = click.option(
        "--radians/--degrees",
        help="Unit of angles in print and in tables; default: degrees. Pictures use degrees.",
    )

    def file_option(name: str, text: str) -> Callable[[_Function], _Function]:
        return click.option(name, type=click.Path(path_type=Path), metavar="FILE", help=text)

    picture_as_well = file_option("--output", "Picture to write as well.")

    @click.group(cls=OneLine, help=help_text.HELP, invoke_without_command=True)
    @click.version_option(__version__, prog_name="cardan", message="%(prog)s %(version)s")
    @click.pass_context
    def cardan(context: click.Context) -> None:
        if context.invoked_subcommand is None:
            click.echo(context.get_help())

    @cardan.command(help=help_text.NEW, short_help="Write a scene to start from.")
    @click.argument("kind", type=click.Choice(list(starters.STARTERS)), metavar="KIND")
    @file_argument
    def new(kind: str, file: Path) -> None:
        for path in starters.write_starter(kind, file):
            say(f"wrote {path}")
        say(f"next: cardan run {file}")

    @cardan.command(help=help_text.RUN, short_help="Evaluate a scene.")
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
        running.run(scene, into, local, scheduler, radians=radians, as_json=as_json)

    @cardan.command(help=help_text.STREAM, short_help="Evaluate a recording of any length.")
    @scene_argument
    @into_option
    @units
    def stream(scene: Path, into: Path, radians: bool) -> None:
        begun = time.perf_counter()
        try:
            with progress_bar("rows") as progress:
                done = stream_curves(scene, into, radians=radians, progress=progress)
        except MemoryError:
            # It takes the angles by chunks already.
            hint = "not enough memory; fewer quantities, shafts or joints in [output] need less"
            raise click.ClickException(hint) from None
        rate = done.rows / (time.perf_counter() - begun) / 1e6
        say(f"wrote {done.path} ({done.rows} rows, {rate:.3g} million a second)")
        angles = recorded_angles(
            done.rows,
            done.missing,
            done.ends_deg,
            done.turns,
            done.signals,
            radians,
            done.extent_deg,
        )
        say(f"drive angles {angles_text(angles, radians=radians)}")
        if done.signals:
            say(signals_text(angles))
        if warning := few_samples_text(angles["samples_per_turn"]):
            say(f"cardan: {warning}", on_error=True)
        if done.missing:
            say(missing_samples(done.missing, done.rows, "the recording"))

    @cardan.command(help=help_text.EXPLAIN, short_help="Describe how a scene is evaluated.")
    @scene_argument
    def explain(scene: Path) -> None:
        say(Scene.load(scene).explain())

    @cardan.command(help=help_text.PLOT, short_help="Draw a scene.")
    @scene_argument
    @file_option("--output", "Picture to write; default: the scene's name with .svg.")
    @click.option(
        "--study",
        metavar="FIGURE",
        help="Draw this figure of the study or of the states: curves over one key, a map over two.",
    )
    @click.option(
        "--over",
        type=click.Choice(get_args(Over)),
        help="Draw over this; default: the time where it was recorded, else the turns. Orders "
        "are multiples of the drive's rotation.",
    )
    @click.option(
        "--forces",
        is_flag=True,
        help="Draw the paths of the force vectors of joints and bearings over a turn, seen along "
        "their shafts.",
    )
    @click.option(
        "--slides",
        is_flag=True,
        help="Draw the axial travel of shafts whose axes do not meet, over the turn and by order; "
        "the scene needs [offsets].",
    )
    @click.option(
        "--backlash",
        is_flag=True,
        help="Draw the torque over the angle of the last shaft, through the play and the wind-up "
        "of the joints, while the drive is held.",
    )
    def plot(
        scene: Path,
        output: Path | None,
        study: str | None,
        over: Over | None,
        forces: bool,
        slides: bool,
        backlash: bool,
    ) -> None:
        if study is not None and over is not None:
            raise click.UsageError("--over does not go with --study")
        if forces and (study is not None or over is not None):
            raise click.UsageError("--forces does not go with --study or --over")
        if slides and (forces or study is not None or over is not None):
            raise click.UsageError("--slides does not go with --forces, --study or --over")
        if backlash and (slides or forces or study is not None or over is not None):
            raise click.UsageError(
                "--backlash does not go with --slides, --forces, --study or --over"
            )
        path = output or Path(f"{scene.stem}.svg")
        loaded = load_scene(scene)
        if isinstance(loaded, BallJointScene):
            if forces or slides or backlash:
                what = "forces" if forces else "slides" if slides else "backlash"
                raise ValueError(f"{loaded.name}: a ball joint alone has no {what} over a turn")
            ball_joint.plot(loaded, path, study)
            say(f"wrote {path}")
            return
        check_output(loaded, path)
        if forces:
            save(plot_forces(scene_force_paths(loaded), loaded.title), path)
            say(f"wrote {path}")
            return
        if slides:
            write_slides(drawn_slides(loaded), path, loaded.title)
            say(f"wrote {path}")
            return
        if backlash:
            write_backlash(drawn_backlash(loaded), path, loaded.title)
            say(f"wrote {path}")
            return
        with progress_bar() as progress:
            result = loaded.run(progress)
        try:
            write_picture(result, path, study, over=over)
        except ArgumentValueError as error:
            option = {"column": "--study", "over": "--over"}.get(error.argument)
            if option is None:
                raise
            raise ValueError(f"{option} {error.problem}") from None
        say(f"wrote {path}")

    @cardan.command(help=help_text.REPORT, short_help="Write a page to share.")
    @scene_argument
    @file_option("--output", "Page to write; default: the scene's name with .html.")
    def report(scene: Path, output: Path | None) -> None:
        path = output or Path(f"{scene.stem}.html")
        loaded = load_scene(scene)
        check_output(loaded, path)
        with progress_bar() as progress:
            write_report(loaded, path, progress)
        say(f"wrote {path}")

    @cardan.command(help=help_text.CHECK, short_help="Check a scene against the limits.")
    @scene_argument
    @as_json
    def check(scene: Path, as_json: bool) -> int:
        return checking.run(scene, as_json=as_json)

    @cardan.command(help=help_text.PHASE, short_help="Say how to set the yokes.")
    @scene_argument
    @as_json
    def phase(scene: Path, as_json: bool) -> None:
        data = yoke_settings(Scene.load(scene))
        say(as_json_text(data) if as_json else yoke_text(data))

    @cardan.command(help=help_text.OPTIMISE, short_help="Find the best values of a scene.")
    @scene_argument
    @file_option("--to", "Scene to write; default: NAME.optimised.toml in the folder of the scene.")
    @file_option(
        "--picture",
        "Also draw the quantity over each variable and each state, before and after.",
    )
    @as_json
    def optimise(scene: Path, to: Path | None, picture: Path | None, as_json: bool) -> None:
        optimising.run(scene, to, picture, as_json=as_json)

    @cardan.command(help=help_text.TOLERANCES, short_help="Say how much tolerances matter.")
    @scene_argument
    @picture_as_well
    @as_json
    def tolerances(scene: Path, output: Path | None, as_json: bool) -> None:
        tolerancing.run(scene, output, as_json=as_json)

    @cardan.command(help=help_text.LIFE, short_help="Say how long the joints last.")
    @scene_argument
    @picture_as_well
    @as_json
    def life(scene: Path, output: Path | None, as_json: bool) -> None:
        in_service.run(scene, output, as_json=as_json)

    @cardan.command(help=help_text.TORSION, short_help="Find resonances of the shafts.")
    @scene_argument
    @picture_as_well
    @click.option(
        "--plot",
        "picture",
        type=click.Choice(PICTURES),
        help="What to draw; default: response. Without --output the picture has the scene's name.",
    )
    @as_json
    def torsion(scene: Path, output: Path | None, picture: str | None, as_json: bool) -> None:
        vibration.run(scene, output, picture, as_json=as_json)

    @cardan.command(help=help_text.IDENTIFY, short_help="Find the bend in a recording.")
    @file_argument
    @click.option("--drive", metavar="COLUMN", required=True, help="Angle of the drive.")
    @click.option("--driven", metavar="COLUMN", help="Angle of the driven shaft.")
    @click.option(
        "--speed-ratio", metavar="COLUMN", help="Or: speed of that shaft over the drive's."
    )
    @click.option("--intermediate", metavar="COLUMN", help="Angle of the shaft between two joints.")
    @click.option(
        "--radians/--degrees",
        help="Angles in the file and in the answer; by default in degrees.",
    )
    @as_json
    def identify(
        file: Path,
        drive: str,
        driven: str | None,
        speed_ratio: str | None,
        intermediate: str | None,
        radians: bool,
        as_json: bool,
    ) -> None:
        if (driven is None) == (speed_ratio is None):
            raise click.UsageError("give one of --driven and --speed-ratio")
        if intermediate is not None and driven is None:
            raise click.UsageError("--intermediate needs --driven")
        data = identification_data(
            file,
            drive,
            driven=driven,
            speed_ratio=speed_ratio,
            intermediate=intermediate,
            radians=radians,
        )
        say(as_json_text(data) if as_json else identification_text(data, radians=radians))

    @cardan.command(help=help_text.SCHEMA, short_help="Print the JSON Schema of scenes.")
    @click.option("--answers", is_flag=True, help="The schema of the answers of --json instead.")
    @file_option("--output", "File to write; default: standard output.")
    def schema(answers: bool, output: Path | None) -> None:
        text = as_json_text(answers_schema() if answers else Scene.schema())
        if output is None:
            say(text)
            return
        with whole_file(output) as file:
            file.write(f"{text}\n".encode())
        say(f"wrote {output}")

    return cardan

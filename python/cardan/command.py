"""The command ``cardan``."""

from __future__ import annotations

import io
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cardan import __version__
from cardan.curves import write_curves
from cardan.plots import write_picture
from cardan.scene import Scene, describe
from cardan.summary import summary, summary_text

if TYPE_CHECKING:
    import click

_HELP = """\
Motion and moments of universal joints and drivelines.

Example: save these lines as shaft.toml and run "cardan run shaft.toml".

\b
  title = "Two joints at 12 and 15 deg, Z arrangement"
  [driveline]
  bends_deg = [12, 15]
  twists_deg = [180]
  [load]
  speed_rpm = 1500
  inertias_kgm2 = [0, 0.01, 0.05]
  [output]
  curves = "shaft.csv"
  picture = "shaft.svg"

"cardan run --help" lists all keys of such a file.
"""

# The mark keeps click from filling a paragraph.
_KEYS = describe().replace("\n\n", "\n\n\b\n")

_RUN_HELP = f"""\
Evaluate a scene: print a short table, write curves and picture.

SCENE is a TOML file of these sections and keys:

\b
{_KEYS}
Files appear whole or not at all.
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
            except click.Abort:
                sys.exit(130)
            except click.ClickException as error:
                message = error.format_message()
            except OSError as error:
                known = error.filename is not None and error.strerror
                message = f"{error.filename}: {error.strerror}" if known else str(error)
            except MemoryError:
                message = "not enough memory; a smaller samples_per_turn needs less"
            except (ValueError, ImportError) as error:
                message = str(error)
            else:
                sys.exit(status or 0)
            click.echo(f"cardan: {' '.join(message.split())}", err=True)
            sys.exit(2)

    @click.group(cls=OneLine, help=_HELP, invoke_without_command=True)
    @click.version_option(__version__, prog_name="cardan", message="%(prog)s %(version)s")
    @click.pass_context
    def cardan(context: click.Context) -> None:
        if context.invoked_subcommand is None:
            click.echo(context.get_help())

    @cardan.command(help=_RUN_HELP, short_help="Evaluate a scene file.")
    @click.argument("scene", type=click.Path(path_type=Path))
    @click.option(
        "--into",
        type=click.Path(exists=True, file_okay=False, path_type=Path),
        default=".",
        metavar="DIR",
        help="Folder for the files to write; by default the current one.",
    )
    def run(scene: Path, into: Path) -> None:
        result = Scene.load(scene).run()
        if result.scene.title:
            click.echo(f"{result.scene.title}\n")
        click.echo(summary_text(summary(result)))
        if result.scene.curves_file or result.scene.picture_file:
            click.echo()
        if result.scene.curves_file:
            path = into / result.scene.curves_file
            click.echo(f"wrote {path} ({write_curves(result, path)} rows)")
        if result.scene.picture_file:
            path = into / result.scene.picture_file
            write_picture(result, path)
            click.echo(f"wrote {path}")

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

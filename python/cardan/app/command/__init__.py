"""The command ``cardan``, and the table of its subcommands."""

from __future__ import annotations

import io
import signal
import sys
import warnings
from contextlib import suppress
from importlib import import_module
from typing import TYPE_CHECKING, Any

from cardan import __version__
from cardan.app.command.terminal import give_up_output, say

if TYPE_CHECKING:
    import click

__all__ = ["SUBCOMMANDS", "commands", "main"]

SUBCOMMANDS = {
    "check": ("check", "Check a scene against the limits."),
    "explain": ("about", "Describe how a scene is evaluated."),
    "identify": ("parts", "Find the bend in a recording."),
    "lateral": ("parts", "Find where shafts shudder or boom."),
    "life": ("parts", "Compute how long the joints last."),
    "new": ("about", "Write a scene to start from."),
    "optimise": ("parts", "Find the best values of a scene."),
    "phase": ("parts", "Show how to set the yokes."),
    "plot": ("draw", "Draw a scene."),
    "report": ("draw", "Write a page to share."),
    "run": ("run", "Evaluate a scene."),
    "schema": ("about", "Print the JSON Schema of scenes."),
    "stream": ("run", "Evaluate a recording of any length."),
    "tolerances": ("parts", "Show how errors affect a driveline."),
    "torsion": ("parts", "Find resonances of the shafts."),
}
"""Module and short help of each subcommand. In the module, a function of its name has options and
help."""


def commands() -> click.Group:
    """Return the command with its subcommands."""
    import click

    class OneLine(click.Group):
        """A group that imports a subcommand when it is run, and reports every error in one line."""

        def resolve_command(
            self, context: click.Context, args: list[str]
        ) -> tuple[str | None, click.Command | None, list[str]]:
            name, listed, rest = super().resolve_command(context, args)
            if listed:
                own = str(listed.name)
                module = import_module(f"cardan.app.command.{SUBCOMMANDS[own][0]}")
                listed = getattr(module, own)
            return name, listed, rest

        def main(self, *args: Any, **extra: Any) -> Any:  # noqa: ANN401 - as click has it
            try:
                status = super().main(*args, **{**extra, "standalone_mode": False})
                sys.stdout.flush()
            except click.Abort:
                sys.exit(130)
            except click.ClickException as error:
                message = error.format_message()
            except SystemExit as ended:
                # So click ends where whoever reads has stopped, as in "cardan schema | head"; its 1
                # would say that a check had failed. What it completed for a shell ends with 0.
                if ended.code and hasattr(signal, "SIGPIPE"):
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

    @click.group(cls=OneLine, invoke_without_command=True)
    @click.version_option(__version__, prog_name="cardan", message="%(prog)s %(version)s")
    @click.pass_context
    def cardan(context: click.Context) -> None:
        """Motion, loads and life of universal joints and drivelines.

        A short TOML file, a scene, describes a driveline, its load and the results you want. Start
        with one that is ready to run:

        \b
          cardan new z-shaft shaft.toml
          cardan run shaft.toml
          cardan check shaft.toml

        "cardan run --help" lists all keys of a scene. "cardan COMMAND --help" shows more examples.

        Exit status: 0 for success, 1 if "check" found the driveline beyond a limit, 2 for invalid
        input (one line says what is wrong), 130 for an interrupt.
        """
        if context.invoked_subcommand is None:
            click.echo(context.get_help())

    for name, (_, meaning) in SUBCOMMANDS.items():
        cardan.add_command(click.Command(name, short_help=meaning))
    return cardan


def main() -> None:
    """Run the command; the entry point of the script ``cardan`` and of ``python -m cardan``."""
    # A terminal that lacks a character of a title gets another one instead.
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")
    try:
        group = commands()
    except ModuleNotFoundError:
        print("cardan: the command needs click: pip install 'cardan[app]'", file=sys.stderr)
        sys.exit(2)
    for name in ("SIGTERM", "SIGHUP"):
        number = getattr(signal, name, None)
        if number is not None and signal.getsignal(number) == signal.SIG_DFL:
            signal.signal(number, _end)
    warnings.showwarning = _in_one_line
    try:
        group(prog_name="cardan")
    except _EndedError as ended:
        # As it would have ended at once, but for the files that were begun.
        signal.signal(ended.number, signal.SIG_DFL)
        signal.raise_signal(ended.number)


def _in_one_line(message: Warning | str, *_: object, **__: object) -> None:
    say(f"cardan: {message}", on_error=True)


class _EndedError(BaseException):
    """A signal asks the process to end; like Ctrl-C it passes all that handles errors."""

    def __init__(self, number: int) -> None:
        super().__init__(number)
        self.number = number


def _end(number: int, _: object) -> None:
    raise _EndedError(number)

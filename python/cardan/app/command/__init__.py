"""The command ``cardan``."""

from __future__ import annotations

import io
import signal
import sys
import warnings

from cardan.app.command.commands import commands
from cardan.app.command.terminal import say

__all__ = ["commands", "main"]


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

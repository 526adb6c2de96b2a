"""The command ``cardan``."""

from __future__ import annotations

import io
import sys

from cardan.command.commands import commands

__all__ = ["commands", "main"]


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

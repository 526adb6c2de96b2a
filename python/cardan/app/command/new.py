"""The command ``cardan new``."""

from __future__ import annotations

from pathlib import Path

import click

from cardan.app.command.options import file_argument
from cardan.app.command.terminal import say
from cardan.app.scene import starters


def _kinds(*, machine: bool) -> str:
    """Return the lines of the starters that are machines, or of those that are not."""
    return "\n".join(
        f"  {kind:17}{starter.meaning}"
        for kind, starter in starters.STARTERS.items()
        if starter.machine is machine
    )


_KINDS = f"""\
\b
KIND is one of
{_kinds(machine=False)}

\b
or the scene of a machine, as its page in the documentation shows it:
{_kinds(machine=True)}
"""


@click.command(epilog=_KINDS)
@click.argument("kind", type=click.Choice(list(starters.STARTERS)), metavar="KIND")
@file_argument
def command(kind: str, file: Path) -> None:
    """Write a commented scene that is ready to run. An existing file is never overwritten.

    \b
    Examples:
      cardan new joint joint.toml
      cardan new truck-shaft truck.toml
      cardan new recorded run.toml
    """
    for path in starters.write_starter(kind, file):
        say(f"wrote {path}")
    say(f"next: cardan run {file}")

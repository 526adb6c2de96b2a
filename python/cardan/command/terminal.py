"""What the command prints: plain text, JSON, a bar that moves."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from typing import Any

from cardan.files.progress import Progress


def as_json_text(data: Any) -> str:  # noqa: ANN401 - any plain data
    """Return plain data as JSON."""
    return json.dumps(data, indent=2, ensure_ascii=False, allow_nan=False)


@contextmanager
def progress_bar(label: str = "study") -> Iterator[Progress | None]:
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


def say(text: str = "") -> None:
    """Print; if whoever reads has stopped, the files to come are written all the same."""
    import click

    try:
        click.echo(text)
    except BrokenPipeError:
        give_up_output()


def give_up_output() -> None:
    """Send what is printed nowhere, so that an output that takes no more does not fail again."""
    with open(os.devnull, "wb") as nowhere:
        os.dup2(nowhere.fileno(), sys.stdout.fileno())

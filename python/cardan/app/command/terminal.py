"""Terminal output of the command: plain text, JSON, a progress bar."""

from __future__ import annotations

import json
import os
import re
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from cardan.app.files.whole_file import Progress


def as_json_text(data: Any) -> str:  # noqa: ANN401 - any plain data
    """Return plain data as JSON, of which no character moves the cursor of a terminal."""
    text = json.dumps(data, indent=2, ensure_ascii=False, allow_nan=False)
    return _UNSAFE.sub(lambda found: f"\\u{ord(found[0]):04x}", text)


# Control characters, and those that turn the direction of writing: a title with them could clear a
# screen, set a clipboard or show another text than is there.
_UNSAFE = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u200e\u200f\u2028-\u202e\u2066-\u2069]")


def paragraphs(*texts: str) -> str:
    """Return texts with a blank line between them, without those that are empty."""
    return "\n\n".join(filter(None, texts))


def printable(text: str) -> str:
    """Return a text for a terminal, its control characters written as Python does."""
    return _UNSAFE.sub(lambda found: repr(found[0])[1:-1], text)


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


def say(text: str = "", *, on_error: bool = False) -> None:
    """Print a text without control characters; all text of the user goes through here."""
    import click

    click.echo(printable(text), err=on_error)


def say_before_files(text: str = "") -> None:
    """Print; if whoever reads has stopped, the files to come are written all the same."""
    try:
        say(text)
    except BrokenPipeError:
        give_up_output()


def give_up_output() -> None:
    """Send what is printed nowhere, so that an output that takes no more does not fail again."""
    with open(os.devnull, "wb") as nowhere:
        os.dup2(nowhere.fileno(), sys.stdout.fileno())

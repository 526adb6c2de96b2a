"""The command ``cardan stream``."""

from __future__ import annotations

import time
from pathlib import Path

import click

from cardan.app.answers.turn.figures import recorded_angles
from cardan.app.answers.turn.text import angles_text, few_samples_text, signals_text
from cardan.app.command.options import into_option, missing_samples, scene_argument, units_option
from cardan.app.command.terminal import progress_bar, say
from cardan.app.scene.study import curves


@click.command()
@scene_argument
@into_option
@units_option
def stream(scene: Path, into: Path, radians: bool) -> None:
    """Evaluate a recording of any length, in chunks that fit in memory.

    The scene needs a section [angles], and curves that end in .parquet. Only the curves are
    written.

    \b
    Example:
      cardan stream long.toml
    """
    begun = time.perf_counter()
    try:
        with progress_bar("rows") as progress:
            done = curves.stream(scene, into, radians=radians, progress=progress)
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
        done.extent_deg,
    )
    say(f"drive angles {angles_text(angles, radians=radians)}")
    if done.signals:
        say(signals_text(angles))
    if warning := few_samples_text(angles):
        say(f"cardan: {warning}", on_error=True)
    if done.missing:
        say(missing_samples(done.missing, done.rows, "the recording"))

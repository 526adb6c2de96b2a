"""The command ``cardan tolerances``."""

from __future__ import annotations

from pathlib import Path

from cardan.command.files import check_output
from cardan.command.terminal import as_json_text, say
from cardan.figures.tolerance_answers import tolerances_data
from cardan.figures.tolerances import needed_tolerances, permitted_tolerances
from cardan.plots.tolerances import write_tolerances
from cardan.scene.scene import Scene
from cardan.words.tolerances import tolerances_text


def run(path: Path, output: Path | None, *, as_json: bool) -> None:
    """Print what the tolerances of a scene do, and draw it if asked to.

    Args:
        path: the scene.
        output: a picture to write, if any.
        as_json: whether to print JSON.
    """
    loaded = Scene.load(path)
    found = needed_tolerances(loaded)
    assert loaded.tolerances
    if output is not None:
        check_output(loaded, output)
        write_tolerances(loaded.tolerances, output)
    if as_json:
        say(as_json_text(tolerances_data(loaded)))
        return
    if loaded.title:
        say(f"{loaded.title}\n")
    say(tolerances_text(found, permitted_tolerances(loaded.tolerances)))
    if output is not None:
        say(f"\nwrote {output}")

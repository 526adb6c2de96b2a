"""The command ``cardan tolerances``."""

from __future__ import annotations

from pathlib import Path

from cardan.command.files import check_output
from cardan.command.terminal import say_answer
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
    tolerances = loaded.tolerances
    assert tolerances
    if output is not None:
        check_output(loaded, output)
        write_tolerances(tolerances, output)
    say_answer(
        loaded.title,
        lambda: tolerances_text(found, permitted_tolerances(tolerances, loaded.tolerance_arms)),
        lambda: tolerances_data(loaded),
        output,
        as_json=as_json,
    )

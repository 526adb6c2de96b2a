"""The command ``cardan life``, and what a check says of joints and tubes in service."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from cardan.command.files import check_output
from cardan.command.terminal import say_answer
from cardan.figures.life import life_figures, needed_life
from cardan.figures.life_answer import life_data
from cardan.figures.tubes import tube_figures
from cardan.plots.life import write_life
from cardan.scene.scene import Scene
from cardan.words.life import life_remedies, life_text, life_verdict_text, tubes_text


def run(path: Path, picture: Path | None, *, as_json: bool) -> None:
    """Print how long the joints of a scene last.

    Args:
        path: the scene.
        picture: a picture to write, if any.
        as_json: whether to print JSON.
    """
    scene = Scene.load(path)
    found = needed_life(scene)
    if picture is not None:
        check_output(scene, picture)
        write_life(found, picture)
    say_answer(
        scene.title,
        lambda: life_text(found, tube_figures(scene)),
        lambda: life_data(scene),
        picture,
        as_json=as_json,
    )


def verdicts(scene: Scene) -> Iterator[str]:
    """Yield what a check says of the joints and the tubes of a scene."""
    if life := life_figures(scene):
        yield life_verdict_text(life)
    if tubes := tube_figures(scene):
        yield tubes_text(tubes)


def remedies(scene: Scene) -> list[str]:
    """Return what would bring the life within what the scene requires, a sentence each."""
    life = life_figures(scene)
    return life_remedies(life) if life and not life.passes else []

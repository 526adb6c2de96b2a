"""The command ``cardan torsion``."""

from __future__ import annotations

from pathlib import Path

from cardan.command.files import check_output
from cardan.command.terminal import say_answer
from cardan.figures.torsion import needed_torsion
from cardan.figures.torsion_answer import torsion_data
from cardan.plots.style import save
from cardan.plots.torsion import plot_torsion
from cardan.scene.scene import Scene
from cardan.words.torsion import torsion_text


def run(path: Path, output: Path | None, picture: str | None, *, as_json: bool) -> None:
    """Print the torsional vibration of a scene and draw it.

    Args:
        path: the scene.
        output: the picture to write; by default the scene's name with .svg if one is asked for.
        picture: what to draw, of ``cardan.plots.torsion.PICTURES``; the response by default.
        as_json: whether to print JSON.
    """
    scene = Scene.load(path)
    if output is None and picture is not None:
        output = Path(f"{path.stem}.svg")
    if output is not None:
        check_output(scene, output)
    found = needed_torsion(scene)
    if output is not None:
        save(plot_torsion(found, picture or "response", scene.title), output)
    files = [] if output is None else [str(output)]
    left_out = "states" if scene.states else "study" if scene.study else ""

    def text() -> str:
        note = f"This is the driveline of [driveline]; the section [{left_out}] is not evaluated."
        return torsion_text(found) + (f"\n\n{note}" if left_out else "")

    say_answer(
        scene.title,
        text,
        lambda: torsion_data(scene.title, found, files),
        output,
        as_json=as_json,
    )

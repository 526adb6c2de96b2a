"""The command ``cardan optimise``."""

from __future__ import annotations

import tomllib
from pathlib import Path

import click

from cardan.app.answers.data import data_of
from cardan.app.answers.json_schema import answer
from cardan.app.answers.optimise.figures import optimised
from cardan.app.answers.optimise.picture import plot_optimise
from cardan.app.answers.table import PARTS
from cardan.app.command.options import check_output, file_option, json_option, scene_argument
from cardan.app.command.terminal import as_json_text, say
from cardan.app.files.whole_file import check_writable, whole_file
from cardan.app.pictures.style import save
from cardan.app.scene.language.document import read_text
from cardan.app.scene.language.edit import with_values
from cardan.app.scene.language.errors import SceneError
from cardan.app.scene.scene import Scene


@click.command()
@scene_argument
@file_option("--to", "Scene to write; default: NAME.optimised.toml in the folder of the scene.")
@file_option(
    "--picture",
    "Also draw the quantity over each variable and each state, before and after.",
)
@json_option
def optimise(scene: Path, to: Path | None, picture: Path | None, as_json: bool) -> None:
    """Find the best values of what a scene lets change, over all its states.

    The section [optimise] names the keys that may change, how far, what to minimise and which
    limits other quantities must keep. The answer says what to change, the figures of each state
    before and after, and what limits the result. The values found go into a new scene in the same
    folder, NAME.optimised.toml. The scene itself is never overwritten.

    \b
    Examples:
      cardan optimise shaft.toml
      cardan optimise shaft.toml --to better.toml
      cardan optimise shaft.toml --json

    It needs SciPy: pip install 'cardan[optimise]'.
    """
    text = read_text(scene)
    loaded = Scene.parse(text, str(scene), scene.parent)
    if loaded.optimisation is None:
        raise ValueError(f"{scene}: section [optimise] is missing; it says what may change")
    target = scene.with_suffix(".optimised.toml") if to is None else to
    _check_target(text, scene, target)
    if picture:
        check_output(loaded, picture)
    found = optimised(loaded)
    assert found
    try:
        written = with_values(text, loaded.optimisation.values_after(found.best.x))
    except ValueError as error:
        raise SceneError(error, str(scene), "driveline") from None
    files = [str(target)]
    with whole_file(target) as file:
        file.write(written.encode())
    if picture:
        save(plot_optimise(found), picture)
        files.append(str(picture))
    if as_json:
        say(as_json_text(answer("optimise", loaded.title, **data_of(found), files=files)))
        return
    say("\n\n".join(filter(None, [loaded.title, PARTS["optimise"].text(found)])))
    say()
    for name in files:
        say(f"wrote {name}")


def _check_target(text: str, path: Path, target: Path) -> None:
    """Refuse to overwrite the scene, or to write one that does not find the files it names."""
    if target.resolve() == path.resolve() or (target.exists() and target.samefile(path)):
        raise ValueError(f"--to {target} is the scene itself; it is never overwritten")
    if target.suffix != ".toml":
        raise ValueError(f"--to {target} must end in .toml")
    if target.resolve().parent != path.resolve().parent:
        given = tomllib.loads(text)
        for section, key in (("angles", "file"), ("joints", "sizes")):
            if key in given.get(section, {}):
                raise ValueError(
                    f"--to {target} must be in the folder of the scene, from which [{section}] "
                    "names its file"
                )
    check_writable(target)

"""The command ``cardan optimise``."""

from __future__ import annotations

import tomllib
from pathlib import Path

from cardan.command.files import check_output
from cardan.command.terminal import as_json_text, say
from cardan.figures.optimise import optimise_data, optimised
from cardan.files.whole_file import check_writable, whole_file
from cardan.plots.optimise import write_optimise_picture
from cardan.scene.document import read_text
from cardan.scene.edit import with_values
from cardan.scene.errors import SceneError
from cardan.scene.scene import Scene
from cardan.words.optimise import optimise_text


def run(path: Path, to: Path | None, picture: Path | None, *, as_json: bool) -> None:
    """Optimise a scene, print the answer and write the scene with the values found.

    Args:
        path: the scene.
        to: the scene to write; ``None`` for the name of the scene with
            ``.optimised.toml``, in its folder.
        picture: a picture to write, if any.
        as_json: whether to print JSON.
    """
    text = read_text(path)
    scene = Scene.parse(text, str(path), path.parent)
    if scene.optimisation is None:
        raise ValueError(f"{path}: section [optimise] is missing; it says what may change")
    target = path.with_suffix(".optimised.toml") if to is None else to
    _check_target(text, path, target)
    if picture:
        check_output(scene, picture)
    found = optimised(scene)
    assert found
    try:
        written = with_values(text, scene.optimisation.values_after(found.best.x))
    except ValueError as error:
        raise SceneError.of(error, str(path), "driveline") from None
    files = [str(target)]
    with whole_file(target) as file:
        file.write(written.encode())
    if picture:
        write_optimise_picture(found, picture)
        files.append(str(picture))
    if as_json:
        say(as_json_text(optimise_data(found, files)))
        return
    say(optimise_text(found))
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

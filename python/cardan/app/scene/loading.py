"""Reading a scene file, whatever it describes."""

from __future__ import annotations

from os import PathLike, fspath
from pathlib import Path

from cardan.app.scene.ball_joint_scene import BallJointScene, is_alone
from cardan.app.scene.document import Document, read_text
from cardan.app.scene.scene import Scene


def load_scene(path: str | PathLike[str]) -> Scene | BallJointScene:
    """Read a scene file of a driveline, of a ball joint, or of both.

    Args:
        path: the file.

    Returns:
        a scene of a driveline, which may have a ball joint as well, or of a ball joint alone.

    Raises:
        ImportError: it names a Parquet file and pyarrow is missing.
        OSError: the file or a recording cannot be read.
        ValueError: it is not a scene; one line with file, line where that is certain, section,
            key, rule and value.
    """
    text = read_text(path)
    document = Document(text, fspath(path))
    if is_alone(document):
        return BallJointScene.of(document)
    return Scene.parse(text, fspath(path), Path(path).parent)

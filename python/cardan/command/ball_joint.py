"""The command on a scene of a ball joint alone."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from cardan.command.files import check_picture, wrote
from cardan.command.terminal import as_json_text, say, say_before_files
from cardan.figures.limits import ball_joint_check_data, passes
from cardan.figures.run import ball_joint_run_data
from cardan.plots.ball_joint import write_ball_joint_picture
from cardan.scene.ball_joint_scene import BallJointScene
from cardan.words.ball_joint import ball_joint_text


def run(scene: BallJointScene, into: Path, *, radians: bool, as_json: bool) -> None:
    """Print what the joint carries and write its picture."""
    if scene.picture_file:
        check_picture(into / scene.picture_file)
    files = _files(scene, into)
    if as_json:
        say(as_json_text(ball_joint_run_data(scene, list(files), radians=radians)))
        return
    if scene.title:
        say_before_files(f"{scene.title}\n")
    say_before_files(ball_joint_text(scene.ball_joint, radians=radians))
    for entry in files:
        say_before_files(f"\n{wrote(**entry)}")


def _files(scene: BallJointScene, into: Path) -> Iterator[dict[str, Any]]:
    if scene.picture_file:
        path = into / scene.picture_file
        write_ball_joint_picture(scene.ball_joint, path, scene.title)
        yield {"file": str(path)}


def check(scene: BallJointScene, *, as_json: bool) -> int:
    """Print the verdict; return the exit status."""
    if as_json:
        say(as_json_text(ball_joint_check_data(scene)))
    else:
        say(ball_joint_text(scene.ball_joint))
    return 0 if passes(scene) else 1


def plot(scene: BallJointScene, path: Path, study: str | None) -> None:
    """Write the picture."""
    if study is not None:
        raise ValueError("--study needs a scene with sections [driveline] and [study]")
    check_picture(path)
    write_ball_joint_picture(scene.ball_joint, path, scene.title)

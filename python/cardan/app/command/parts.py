"""The commands that answer one question: ``life``, ``tolerances``, ``torsion``, ``phase``, …"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import click

from cardan.app.answers.answer import Answer
from cardan.app.answers.data import data_of
from cardan.app.answers.identification import identified, sentences
from cardan.app.answers.life.figures import needed
from cardan.app.answers.optimise.figures import optimised
from cardan.app.answers.optimise.picture import plot_optimise
from cardan.app.answers.printed import part_text, wherever_text
from cardan.app.answers.schema import Kind
from cardan.app.answers.schema import answer as answer_of
from cardan.app.answers.table import PARTS
from cardan.app.answers.yokes.figures import yoke_settings
from cardan.app.answers.yokes.text import yoke_text
from cardan.app.command.options import (
    check_output,
    check_workbook,
    file_argument,
    file_option,
    in_units,
    json_option,
    picture_as_well,
    scene_argument,
    workbook_as_well,
    write_workbook,
)
from cardan.app.command.terminal import as_json_text, say
from cardan.app.files.whole_file import check_writable, whole_file
from cardan.app.pictures.style import save
from cardan.app.scene.language.document import read_text
from cardan.app.scene.language.edit import with_values
from cardan.app.scene.language.errors import SceneError
from cardan.app.scene.scene import Scene


@click.command()
@scene_argument
@picture_as_well
@workbook_as_well
@json_option
def life(scene: Path, output: Path | None, workbook: Path | None, as_json: bool) -> None:
    """Say how long the joints of a driveline last, how hot they run and which size would suffice.

    The section [joints] of the scene describes the joints or names a table of their sizes. [life]
    gives the steps of the duty cycle. The life is the one that 90 % of the joints reach. It follows
    from the load on the pins over the turn, by the law of the catalogues. With [tubes] the answer
    has stress and critical bending speed of the shafts. The exit status does not depend on the
    verdict.

    \b
    Examples:
      cardan life conveyor.toml
      cardan life conveyor.toml --output life.svg
      cardan life conveyor.toml --json
    """
    answer = _answer(scene, output, workbook)
    needed(answer)
    parts = list(answer.parts("life"))
    _say(
        answer,
        "life",
        lambda: "\n\n".join(
            filter(
                None,
                (
                    *(part.text(each) for part, each in parts),
                    wherever_text(entry for part, each in parts for entry in part.entries(each)),
                ),
            )
        ),
        {part.name: part.data(each) for part, each in parts},
        output,
        workbook,
        as_json=as_json,
    )


@click.command()
@scene_argument
@picture_as_well
@workbook_as_well
@json_option
def tolerances(scene: Path, output: Path | None, workbook: Path | None, as_json: bool) -> None:
    """Show how manufacturing and assembly errors affect a driveline.

    The section [tolerances] of the scene says how exact bends, twists, yokes or points are.

    The answer has the worst driveline, a guaranteed bound, quantiles of random drivelines, the
    share within the limit, and the share of each joint, shaft or point in the scatter. It also says
    how exact each group must be for every driveline to be within the limit, if there is one. The
    exit status does not depend on the verdict.

    \b
    Examples:
      cardan tolerances shaft.toml
      cardan tolerances shaft.toml --output tolerances.svg
      cardan tolerances shaft.toml --json
    """
    answer = _answer(scene, output, workbook)
    found = answer.needed("tolerances")
    text = PARTS["tolerances"].text
    _say(
        answer, "tolerances", lambda: text(found), data_of(found), output, workbook, as_json=as_json
    )


@click.command()
@scene_argument
@picture_as_well
@workbook_as_well
@json_option
def torsion(scene: Path, output: Path | None, workbook: Path | None, as_json: bool) -> None:
    """Find the resonances of compliant shafts, the torques in them and unstable speeds.

    The section [torsion] of the scene gives inertias, stiffnesses or tubes, damping and the range
    of drive speeds. The stiffness of a shaft that does not twist is "rigid".

    The answer has the natural frequencies, each with the shafts that are twisted and their shares
    in the energy of twist, the critical speeds of the orders, the largest torque of each compliant
    shaft and its speed, and the speeds of unstable motion. The exit status does not depend on the
    verdict.

    The picture shows the torques over the drive speed. "cardan plot SCENE --what campbell" draws
    natural frequencies and orders, "--what stability" where the motion is unstable.

    \b
    Examples:
      cardan torsion shaft.toml
      cardan torsion shaft.toml --output response.svg
      cardan torsion shaft.toml --json
    """
    answer = _answer(scene, output, workbook)
    loaded = answer.scene
    left_out = "states" if loaded.states else "study" if loaded.study else ""
    _say_vibration(answer, "torsion", left_out, output, workbook, as_json=as_json)


@click.command()
@scene_argument
@picture_as_well
@workbook_as_well
@json_option
def lateral(scene: Path, output: Path | None, workbook: Path | None, as_json: bool) -> None:
    """Find where bent joints shake the shafts on their bearings: shudder and boom.

    The section [lateral] of the scene gives the range of drive speeds. [[bearing]] gives the
    stiffness and the loss factor of a bearing, and [tubes] the shafts that bend.

    The answer has the couples by which the joints bend each shaft, the natural frequencies and the
    resonances of orders 1, 2 and 4. It has the largest force and displacement of each elastic
    bearing, and what helps: other heights, slopes, yokes and stiffnesses. Without stiffnesses it
    has the couples and the force of order 2 at each bearing. The exit status does not depend on
    the verdict.

    The picture shows the forces of the bearings over the speed. "cardan plot --what shapes" draws
    the shafts in resonance, "--what stiffness" the force over stiffness and speed.

    \b
    Examples:
      cardan lateral shaft.toml
      cardan lateral shaft.toml --output force.svg
      cardan lateral shaft.toml --json
    """
    answer = _answer(scene, output, workbook)
    left_out = "study" if answer.scene.study and not answer.scene.states else ""
    _say_vibration(answer, "lateral", left_out, output, workbook, as_json=as_json)


def _say_vibration(
    answer: Answer,
    name: Kind,
    left_out: str,
    output: Path | None,
    workbook: Path | None,
    *,
    as_json: bool,
) -> None:
    """Print an answer that leaves a section of the scene out, and say so."""
    found = answer.needed(name)
    note = f"This is the driveline of [driveline]; the section [{left_out}] is not evaluated."
    _say(
        answer,
        name,
        lambda: PARTS[name].text(found) + (f"\n\n{note}" if left_out else ""),
        data_of(found) | {"files": [] if output is None else [str(output)]},
        output,
        workbook,
        as_json=as_json,
    )


def _answer(path: Path, output: Path | None, workbook: Path | None) -> Answer:
    """The answer to a scene, after a look whether picture and workbook can be written."""
    scene = in_units(Scene.load(path))
    check_workbook(workbook, scene)
    if output is not None:
        check_output(scene, output)
    return Answer(scene)


def _say(
    answer: Answer,
    name: Kind,
    text: Callable[[], str],
    data: Mapping[str, Any],
    output: Path | None,
    workbook: Path | None,
    *,
    as_json: bool,
) -> None:
    """Write the picture of a part, and print the answer as JSON or as text under its title."""
    title, wrote = answer.scene.title, ""
    if output is not None:
        save(PARTS[name].pictures()[name](answer), output)
        wrote = f"wrote {output}"
    _print(
        name,
        title,
        lambda: "\n\n".join(filter(None, (title, text(), wrote))),
        data,
        workbook,
        as_json=as_json,
    )


def _print(
    name: Kind,
    title: str,
    text: Callable[[], str],
    data: Mapping[str, Any],
    workbook: Path | None,
    *,
    as_json: bool,
) -> None:
    whole = answer_of(name, title, **data)
    wrote = write_workbook(whole, workbook)
    say(as_json_text(whole) if as_json else "\n\n".join(filter(None, (text(), wrote))))


@click.command()
@scene_argument
@workbook_as_well
@json_option
def phase(scene: Path, workbook: Path | None, as_json: bool) -> None:
    """Say how to set the yokes so that the last shaft turns as evenly as possible.

    Each setting is an angle and a sense, looking from the drive towards the output. If the scene
    gives the teeth of the splines, the best teeth are found as well. The answer names the
    arrangement, what is left at the best setting and what would bring it within the limit. It
    compares the exact figure with the catalogues' root rule.

    \b
    Examples:
      cardan phase shaft.toml
      cardan phase shaft.toml --json
    """
    loaded = in_units(Scene.load(scene))
    check_workbook(workbook, loaded)
    title, found = loaded.title, yoke_settings(loaded)
    _print(
        "phase", title, lambda: yoke_text(title, found), data_of(found), workbook, as_json=as_json
    )


@click.command()
@file_argument
@click.option("--drive", metavar="COLUMN", help="Angle of the drive.")
@click.option("--time", metavar="COLUMN", help="Or: time in s, with --drive-speed.")
@click.option("--driven", metavar="COLUMN", help="Angle of the driven shaft.")
@click.option("--speed-ratio", metavar="COLUMN", help="Or: speed of that shaft over the drive's.")
@click.option("--driven-speed", metavar="COLUMN", help="Or: its speed in rpm, with --drive-speed.")
@click.option("--intermediate", metavar="COLUMN", help="Angle of the shaft between two joints.")
@click.option(
    "--drive-speed", metavar="COLUMN", help="Speed of the drive in rpm: shows the bend over it."
)
@click.option(
    "--radians/--degrees", help="Angles in the file and in the answer; by default in degrees."
)
@workbook_as_well
@json_option
def identify(
    file: Path,
    drive: str | None,
    time: str | None,
    driven: str | None,
    speed_ratio: str | None,
    driven_speed: str | None,
    intermediate: str | None,
    drive_speed: str | None,
    radians: bool,
    workbook: Path | None,
    as_json: bool,
) -> None:
    """Find the bend that a recording of a driveline shows.

    FILE is a CSV, Parquet, NPZ or MDF file. It has columns for the angles of the drive and of a
    driven shaft, or for the speed ratio of the driven shaft. The angles may start anew at each
    turn. With the angle of the shaft between two joints, both bends and the phase are found. Speeds
    do instead of angles: that of the drive with the time, and that of the driven shaft.

    \b
    Examples:
      cardan identify run.csv --drive crank --driven axle
      cardan identify run.csv --drive crank --speed-ratio ratio
      cardan identify run.csv --drive crank --intermediate mid --driven axle
      cardan identify run.csv --drive crank --driven axle --drive-speed n
      cardan identify run.csv --time t --drive-speed n1 --driven-speed n2
    """
    if (drive is None) == (time is None):
        raise click.UsageError("give one of --drive and --time")
    if sum(name is not None for name in (driven, speed_ratio, driven_speed)) != 1:
        raise click.UsageError("give one of --driven, --speed-ratio and --driven-speed")
    for option, name in (("--time", time), ("--driven-speed", driven_speed)):
        if name is not None and drive_speed is None:
            raise click.UsageError(f"{option} needs --drive-speed")
    if intermediate is not None and driven is None:
        raise click.UsageError("--intermediate needs --driven")
    check_workbook(workbook)
    found = identified(
        file,
        drive,
        driven=driven,
        speed_ratio=speed_ratio,
        intermediate=intermediate,
        time=time,
        drive_speed=drive_speed,
        driven_speed=driven_speed,
        radians=radians,
    )
    _print(
        "identify",
        found.path,
        lambda: part_text(found.path, found, sentences(found), radians=radians),
        data_of(found, radians=radians),
        workbook,
        as_json=as_json,
    )


@click.command()
@scene_argument
@file_option("--to", "Scene to write; default: NAME.optimised.toml beside the scene.")
@file_option(
    "--picture", "Also draw the quantity over each variable and each state, before and after."
)
@workbook_as_well
@json_option
def optimise(
    scene: Path, to: Path | None, picture: Path | None, workbook: Path | None, as_json: bool
) -> None:
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
    loaded = in_units(Scene.parse(text, str(scene), scene.parent))
    if loaded.optimisation is None:
        raise ValueError(f"{scene}: section [optimise] is missing; it says what may change")
    target = scene.with_suffix(".optimised.toml") if to is None else to
    _check_target(loaded, scene, target)
    check_workbook(workbook, loaded)
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
    texts = (loaded.title, PARTS["optimise"].text(found), "\n".join(map("wrote {}".format, files)))
    _print(
        "optimise",
        loaded.title,
        lambda: "\n\n".join(filter(None, texts)),
        data_of(found) | {"files": files},
        workbook,
        as_json=as_json,
    )


def _check_target(scene: Scene, path: Path, target: Path) -> None:
    """Refuse to overwrite the scene, or to write one that does not find the files it names."""
    if target.resolve() == path.resolve() or (target.exists() and target.samefile(path)):
        raise ValueError(f"--to {target} is the scene itself; it is never overwritten")
    if target.suffix != ".toml":
        raise ValueError(f"--to {target} must end in .toml")
    if target.resolve().parent != path.resolve().parent:
        for section in scene.files:
            raise ValueError(
                f"--to {target} must be in the folder of the scene, from which [{section}] "
                "names its file"
            )
    check_writable(target)

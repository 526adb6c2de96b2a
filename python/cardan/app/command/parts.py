"""The commands that answer one question: ``life``, ``tolerances``, ``torsion``, ``phase``, …"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from pathlib import Path
from typing import Any

import click

from cardan.app.answers.answer import Answer
from cardan.app.answers.data import data_of
from cardan.app.answers.identification import identified, identified_text
from cardan.app.answers.life.figures import needed
from cardan.app.answers.optimise.figures import optimised
from cardan.app.answers.optimise.picture import plot_optimise
from cardan.app.answers.printed import listed, wherever_text
from cardan.app.answers.schema import Kind
from cardan.app.answers.table import PARTS
from cardan.app.answers.yokes.figures import yoke_settings
from cardan.app.answers.yokes.text import yoke_text
from cardan.app.command import options
from cardan.app.command.options import Output
from cardan.app.command.terminal import paragraphs
from cardan.app.files.whole_file import check_writable, whole_file
from cardan.app.pictures.style import save
from cardan.app.scene.language.document import read_text
from cardan.app.scene.language.edit import with_values
from cardan.app.scene.language.errors import SceneError
from cardan.app.scene.scene import Scene


@click.command()
@options.scene_argument
@options.output_options(picture=True)
def life(scene: Path, output: Output) -> None:
    """Compute how long the joints of a driveline last, how hot they run and which size suffices.

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
    answer = _answer(scene, output)
    needed(answer)
    parts = list(answer.parts("life"))

    def text() -> str:
        entries = (entry for part, each in parts for entry in part.entries(each))
        return paragraphs(*(part.text(each) for part, each in parts), wherever_text(entries))

    _say(answer, "life", text, {part.name: part.data(each) for part, each in parts}, output)


@click.command()
@options.scene_argument
@options.output_options(picture=True)
def tolerances(scene: Path, output: Output) -> None:
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
    _say_part(_answer(scene, output), "tolerances", output)


@click.command()
@options.scene_argument
@options.output_options(picture=True)
def torsion(scene: Path, output: Output) -> None:
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
    answer = _answer(scene, output)
    left_out = "states" if answer.scene.states else "study" if answer.scene.study else ""
    _say_part(answer, "torsion", output, left_out)


@click.command()
@options.scene_argument
@options.output_options(picture=True)
def lateral(scene: Path, output: Output) -> None:
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
    answer = _answer(scene, output)
    left_out = "study" if answer.scene.study and not answer.scene.states else ""
    _say_part(answer, "lateral", output, left_out)


def _answer(path: Path, output: Output) -> Answer:
    """The answer to a scene, after a look whether picture and workbook can be written."""
    scene = options.in_units(Scene.load(path))
    output.check(scene)
    return Answer(scene)


def _say_part(answer: Answer, name: Kind, output: Output, left_out: str | None = None) -> None:
    """Print one part, and which section of the scene it leaves out; "" for none."""
    found, data = answer.needed(name), data_of(answer.needed(name))
    note = f"This is the driveline of [driveline]; the section [{left_out}] is not evaluated."
    if left_out is not None:
        data |= {"files": [] if output.picture is None else [str(output.picture)]}
    _say(
        answer,
        name,
        lambda: paragraphs(PARTS[name].text(found), note if left_out else ""),
        data,
        output,
    )


def _say(
    answer: Answer, name: Kind, text: Callable[[], str], data: Mapping[str, Any], output: Output
) -> None:
    """Write the picture of a part, and print the answer as JSON or as text under its title."""
    title, wrote = answer.scene.title, ""
    if output.picture is not None:
        save(PARTS[name].pictures()[name](answer), output.picture)
        wrote = f"wrote {output.picture}"
    output.say(name, title, lambda: paragraphs(title, text(), wrote), data)


@click.command()
@options.scene_argument
@options.output_options()
def phase(scene: Path, output: Output) -> None:
    """Show how to set the yokes so that the last shaft turns as evenly as possible.

    Each setting is an angle and a sense, looking from the drive towards the output. If the scene
    gives the teeth of the splines, the best teeth are found as well. The answer names the
    arrangement, what is left at the best setting and what would bring it within the limit. It
    compares the exact figure with the catalogues' root rule.

    \b
    Examples:
      cardan phase shaft.toml
      cardan phase shaft.toml --json
    """
    loaded = _answer(scene, output).scene
    title, found = loaded.title, yoke_settings(loaded)
    output.say("phase", title, lambda: yoke_text(title, found), data_of(found))


@click.command()
@options.file_argument
@click.option("--drive", metavar="COLUMN", help="Angle of the drive.")
@click.option("--time", metavar="COLUMN", help="Or: time in s, with --drive-speed.")
@click.option("--driven", metavar="COLUMN", help="Angle of the driven shaft.")
@click.option("--speed-ratio", metavar="COLUMN", help="Or: speed of that shaft over the drive's.")
@click.option("--driven-speed", metavar="COLUMN", help="Or: its speed in rpm, with --drive-speed.")
@click.option(
    "--intermediate", metavar="COLUMN", help="Angle or speed of the shaft between two joints."
)
@click.option(
    "--drive-speed", metavar="COLUMN", help="Speed of the drive in rpm: shows the bend over it."
)
@click.option(
    "--radians/--degrees", help="Angles in the file and in the answer; by default in degrees."
)
@options.output_options()
def identify(file: Path, radians: bool, output: Output, **columns: str | None) -> None:
    """Find the bend that a recording of a driveline shows.

    FILE is a CSV, Parquet, NPZ or MDF file. It has columns for the angles of the drive and of a
    driven shaft, or for the speed ratio of the driven shaft. The angles may start anew at each
    turn. With the angle of the shaft between two joints, both bends and the phase are found. Speeds
    do instead of angles: that of the drive with the time, and those of the other shafts.

    \b
    Examples:
      cardan identify run.csv --drive crank --driven axle
      cardan identify run.csv --drive crank --speed-ratio ratio
      cardan identify run.csv --drive crank --intermediate mid --driven axle
      cardan identify run.csv --drive crank --driven axle --drive-speed n
      cardan identify run.csv --time t --drive-speed n1 --driven-speed n2
    """
    given = {name for name, column in columns.items() if column is not None}
    _check_one(given, ("drive", "time"))
    _check_one(given, ("driven", "speed_ratio", "driven_speed"))
    for name in ("time", "driven_speed"):
        if name in given and "drive_speed" not in given:
            raise click.UsageError(f"{_option(name)} needs --drive-speed")
    if "intermediate" in given and not given & {"driven", "driven_speed"}:
        raise click.UsageError("--intermediate needs --driven or --driven-speed")
    output.check()
    found = identified(file, columns.pop("drive"), **columns, radians=radians)
    output.say(
        "identify",
        found.path,
        lambda: identified_text(found, radians=radians),
        data_of(found, radians=radians),
    )


def _check_one(given: Collection[str], names: Sequence[str]) -> None:
    """Refuse none and several of some options."""
    both = [_option(name) for name in names if name in given]
    if not both:
        raise click.UsageError(f"give one of {listed([*map(_option, names)])}; none is given")
    if len(both) > 1:
        raise click.UsageError(f"{listed(both)} are given; give only one of them")


def _option(name: str) -> str:
    return f"--{name.replace('_', '-')}"


@click.command()
@options.scene_argument
@options.file_option("--to", "Scene to write; default: NAME.optimised.toml beside the scene.")
@options.file_option(
    "--picture", "Also draw the quantity over each variable and each state, before and after."
)
@options.output_options()
def optimise(scene: Path, to: Path | None, picture: Path | None, output: Output) -> None:
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
    loaded = options.in_units(Scene.parse(text, str(scene), scene.parent))
    if loaded.optimisation is None:
        raise ValueError(
            f"{scene}: section [optimise] is missing; it says what may change, as "
            'vary = {"points_mm.2.y" = [-40, 40]}'
        )
    target = scene.with_suffix(".optimised.toml") if to is None else to
    _check_target(loaded, scene, target)
    output.check(loaded)
    if picture:
        options.check_output(loaded, picture)
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
    output.say(
        "optimise",
        loaded.title,
        lambda: paragraphs(
            loaded.title, PARTS["optimise"].text(found), "\n".join(map("wrote {}".format, files))
        ),
        data_of(found) | {"files": files},
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

"""The commands about scenes themselves: ``explain``, ``new`` and ``schema``."""

from __future__ import annotations

from pathlib import Path

import click

from cardan.app.answers.schema import answers_schema
from cardan.app.command.options import file_argument, file_option, in_units, scene_argument
from cardan.app.command.terminal import as_json_text, say
from cardan.app.files.whole_file import whole_file
from cardan.app.scene import load_scene, starters
from cardan.app.scene.scene import Scene
from cardan.arrays.errors import ArgumentValueError


@click.command()
@scene_argument
@click.argument("key", required=False)
def explain(scene: Path, key: str | None) -> None:
    """Explain a figure of a scene: its meaning, formula, source, inputs and limit.

    Keys are those of "cardan check SCENE --json", such as spline.travel or tubes.1.stress.

    Without KEY, describe how the scene and its study are evaluated: the steps, what is skipped and
    why, and the memory that each sample needs.

    \b
    Examples:
      cardan explain shaft.toml
      cardan explain shaft.toml limits.equivalent_bend
    """
    if key is None:
        say(in_units(Scene.load(scene)).explain())
        return
    # Without a key the answer is not needed.
    from cardan.app.answers.answer import Answer
    from cardan.app.answers.explain import explain_text

    try:
        say(explain_text(Answer(in_units(load_scene(scene))), key, scene))
    except ArgumentValueError as error:
        raise ValueError(f"KEY {error.problem}") from None


def _kinds(*, machine: bool) -> str:
    """Return the lines of the starters that are machines, or of those that are not."""
    return "\n".join(
        f"  {kind:17}{starter.meaning}"
        for kind, starter in starters.STARTERS.items()
        if starter.machine is machine
    )


_KINDS = f"""\
\b
KIND is one of
{_kinds(machine=False)}

\b
or the scene of a machine, as its page in the documentation shows it:
{_kinds(machine=True)}
"""


@click.command(epilog=_KINDS)
@click.argument("kind", type=click.Choice(list(starters.STARTERS)), metavar="KIND")
@file_argument
def new(kind: str, file: Path) -> None:
    """Write a commented scene that is ready to run. An existing file is never overwritten.

    \b
    Examples:
      cardan new joint joint.toml
      cardan new truck-shaft truck.toml
      cardan new recorded run.toml
    """
    for path in starters.write_starter(kind, file):
        say(f"wrote {path}")
    say(f"next: cardan {starters.STARTERS[kind].command} {file}")


@click.command()
@click.option("--answers", is_flag=True, help="The schema of the answers of --json instead.")
@file_option("--output", "File to write; default: standard output.")
def schema(answers: bool, output: Path | None) -> None:
    """Print the JSON Schema of scenes, with which editors complete and check them.

    With "--answers": the schema of what "--json" prints.

    \b
    Examples:
      cardan schema
      cardan schema --output scene.schema.json
      cardan schema --answers
    """
    text = as_json_text(answers_schema() if answers else Scene.schema())
    if output is None:
        say(text)
        return
    with whole_file(output) as file:
        file.write(f"{text}\n".encode())
    say(f"wrote {output}")

"""The command ``cardan schema``."""

from __future__ import annotations

from pathlib import Path

import click

from cardan.app.answers.schema import answers_schema
from cardan.app.command.options import file_option
from cardan.app.command.terminal import as_json_text, say
from cardan.app.files.whole_file import whole_file
from cardan.app.scene.scene import Scene


@click.command()
@click.option("--answers", is_flag=True, help="The schema of the answers of --json instead.")
@file_option("--output", "File to write; default: standard output.")
def command(answers: bool, output: Path | None) -> None:
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

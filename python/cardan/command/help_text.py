"""The help of the command and its subcommands."""

from __future__ import annotations

from cardan.files.pictures import SUFFIXES
from cardan.scene.format import describe
from cardan.scene.starters import STARTERS

HELP = """\
Motion and moments of universal joints and drivelines.

What a driveline is and what is wanted of it stands in a scene, a short TOML file. Begin with one
that runs as it stands:

\b
  cardan new z-shaft shaft.toml
  cardan run shaft.toml
  cardan check shaft.toml

"cardan run --help" lists all keys of a scene, "cardan COMMAND --help" shows more examples.

Exit status: 0 done, 1 "check" found a limit exceeded, 2 something is wrong with what was given (one
line says what), 130 interrupted.
"""

# The mark keeps click from filling a paragraph.
_KEYS = describe().replace("\n\n", "\n\n\b\n")

RUN = f"""\
Evaluate a scene: print a short table, write curves, study and picture.

\b
Examples:
  cardan run shaft.toml
  cardan run shaft.toml --radians --into .
  cardan run shaft.toml --json

With "--local 8" or "--scheduler tcp://host:8786" a dask cluster does the study, and its table,
which must end in .parquet, becomes a folder of files. The same command goes on where a run was
stopped: no file that is there is computed again.

SCENE is a TOML file of these sections and keys:

\b
{_KEYS}
Files appear whole or not at all.
"""

STREAM = """\
Evaluate recorded angles of any number, by chunks in little memory.

The scene has a section [angles] with a .parquet file, and curves that end in .parquet; these are
all that is written.

\b
Example:
  cardan stream long.toml
"""

EXPLAIN = """\
Say how a scene and its study are evaluated: the steps taken, what is skipped and why, and what a
sample costs.

\b
Example:
  cardan explain shaft.toml
"""

PLOT = f"""\
Draw a scene into a file that ends in {", ".join(SUFFIXES)}.

\b
Examples:
  cardan plot shaft.toml
  cardan plot shaft.toml --output shaft.png

With "--study equivalent_bend" that figure of the scene's study is drawn over the keys that it
varies: curves over one key, a map over two.
"""

CHECK = """\
Check a scene against the limits of the catalogues and of practice.

The equivalent bend must not exceed 3 deg; with a speed given, the excitation by the last shaft and
by the shafts between is checked as well. In a study every driveline must keep the limits, and each
figure is the worst of them, with its place. The exit status is 0 if all limits are kept and 1 if
not.

\b
Examples:
  cardan check shaft.toml
  cardan check shaft.toml --json
"""

PHASE = """\
Say how to set the yokes so that the last shaft turns as evenly as possible.

Each setting is an angle and a sense, looking from the drive towards the output. If the scene gives
the teeth of the splines, the best teeth are found as well. The answer names the arrangement, what
is left at the best setting and what would bring it within the limit. It compares the exact figure
with the catalogues' root rule.

\b
Examples:
  cardan phase shaft.toml
  cardan phase shaft.toml --json
"""

REPORT = """\
Write a page to hand on, with a driveline that turns in it.

It says whether the driveline runs smoothly, what loads the bearings and how to set the yokes, and
shows inputs, tables and curves. One HTML file holds everything; it needs no network.

\b
Examples:
  cardan report shaft.toml
  cardan report shaft.toml --output shaft.html
"""

NEW = f"""\
Write a commented scene that runs as it stands; an existing file stays as it is.

\b
KIND is one of
{chr(10).join(f"  {kind:13}{starter.meaning}" for kind, starter in STARTERS.items())}

\b
Examples:
  cardan new joint joint.toml
  cardan new recorded run.toml
"""

SCHEMA = """\
Print the JSON Schema of scenes, by which editors complete and check them.

With "--answers": the schema of what "--json" prints.

\b
Examples:
  cardan schema
  cardan schema --output scene.schema.json
  cardan schema --answers
"""

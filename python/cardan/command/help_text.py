"""The help of the command and its subcommands."""

from __future__ import annotations

from cardan.files.pictures import SUFFIXES
from cardan.scene.help_text import describe
from cardan.scene.starters import STARTERS

HELP = """\
Motion, loads and life of universal joints and drivelines.

A short TOML file, a scene, describes a driveline, its load and the results you want. Start with one
that is ready to run:

\b
  cardan new z-shaft shaft.toml
  cardan run shaft.toml
  cardan check shaft.toml

"cardan run --help" lists all keys of a scene. "cardan COMMAND --help" shows more examples.

Exit status: 0 for success, 1 if "check" found the driveline beyond a limit, 2 for invalid input
(one line says what is wrong), 130 for an interrupt.
"""

_ENDINGS = " or ".join((", ".join([*SUFFIXES][:-1]), [*SUFFIXES][-1]))

# The mark keeps click from filling a paragraph.
_KEYS = describe().replace("\n\n", "\n\n\b\n")

RUN = f"""\
Evaluate a scene: print the main results, write curves, study and picture.

\b
Examples:
  cardan run shaft.toml
  cardan run shaft.toml --radians --into .
  cardan run shaft.toml --json

With "--local 8" or "--scheduler tcp://host:8786" a dask cluster does the study. The table must
then end in .parquet and becomes a folder of files. If the run stops, the same command resumes
it and computes no file twice.

SCENE is a TOML file with these sections and keys:

\b
{_KEYS}
A file appears complete or not at all.
"""

STREAM = """\
Evaluate a recording of any length, in chunks that fit in memory.

The scene needs a section [angles], and curves that end in .parquet. Only the curves are written.

\b
Example:
  cardan stream long.toml
"""

EXPLAIN = """\
Describe how a scene and its study are evaluated: the steps, what is skipped and why, and the memory
that each sample needs.

\b
Example:
  cardan explain shaft.toml
"""

PLOT = f"""\
Draw a scene and write the picture to a file that ends in {_ENDINGS}.

By default the picture shows the driveline, its key figures and its curves over the turn. The
options draw something else.

\b
Examples:
  cardan plot shaft.toml
  cardan plot shaft.toml --output shaft.png
  cardan plot shaft.toml --over orders
"""

CHECK = """\
Compare a scene with the limits of driveshaft catalogues and of practice.

By default the only limit is that of the catalogues: an equivalent bend of 3 deg. The section
[limits] of the scene adds the limits of a kind of machine (preset = "truck" or "industrial") or
your own figures, and each limit is printed with its source. With a speed given, the excitation by
the last shaft and by the shafts between two joints is printed as well.

A figure is within its limit, tolerable (above the limit but not above the maximum) or beyond. The
exit status is 0 for within and tolerable, and 1 for beyond. Splines, steering, joints, tubes and
ball joints that exceed what the scene permits count as beyond; they are listed below the verdict.
In a study every driveline counts, and each figure is the worst of them, with its place.

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

OPTIMISE = """\
Find the best values of what a scene lets change, over all its states.

The section [optimise] names the keys that may change, how far, what to minimise and which limits
other quantities must keep. The answer says what to change, the figures of each state before and
after, and what limits the result. The values found go into a new scene in the same folder,
NAME.optimised.toml. The scene itself is never overwritten.

\b
Examples:
  cardan optimise shaft.toml
  cardan optimise shaft.toml --to better.toml
  cardan optimise shaft.toml --json

It needs SciPy: pip install 'cardan[optimise]'.
"""

TOLERANCES = """\
Say what errors of manufacture and assembly make of a driveline.

The section [tolerances] of the scene says how exact bends, twists, yokes or points are.

The answer has the worst driveline, a guaranteed bound, quantiles of random drivelines, the share
within the limit, and the share of each joint, shaft or point in the scatter. It also says how exact
each group must be for every driveline to be within the limit, if there is one. The exit status
does not depend on the verdict.

\b
Examples:
  cardan tolerances shaft.toml
  cardan tolerances shaft.toml --output tolerances.svg
  cardan tolerances shaft.toml --json
"""

LIFE = """\
Say how long the joints of a driveline last, how hot they run and which size would suffice.

The section [joints] of the scene describes the joints or names a table of their sizes. [life] gives
the steps of the duty cycle. The life is the one that 90 % of the joints reach. It follows from
the load on the pins over the turn, by the law of the catalogues. With [tubes] the answer has stress
and critical bending speed of the shafts. The exit status does not depend on the verdict.

\b
Examples:
  cardan life conveyor.toml
  cardan life conveyor.toml --output life.svg
  cardan life conveyor.toml --json
"""

TORSION = """\
Find the resonances of compliant shafts, the torques in them and unstable speeds.

The section [torsion] of the scene gives inertias, stiffnesses or tubes, damping and the range of
drive speeds. The stiffness of a shaft that does not twist is "rigid".

The answer has the natural frequencies, each with the shafts that are twisted and their shares in
the energy of twist, the critical speeds of the orders, the largest torque of each compliant shaft
and its speed, and the speeds of unstable motion. The exit status does not depend on the verdict.

\b
The picture shows one of
  response   torques over the drive speed, with the critical speeds
  campbell   natural frequencies and orders over the drive speed
  stability  where the motion is unstable, over speed and bend

\b
Examples:
  cardan torsion shaft.toml
  cardan torsion shaft.toml --output response.svg
  cardan torsion shaft.toml --plot campbell --output campbell.svg
  cardan torsion shaft.toml --json
"""

REPORT = """\
Write a page to share, with a slider that turns the driveline.

The page says whether the driveline runs smoothly, which loads the bearings carry and how to set the
yokes. It shows the inputs, tables and curves. It is a single HTML file that needs no network.

\b
Examples:
  cardan report shaft.toml
  cardan report shaft.toml --output shaft.html
"""


def _kinds(*, machine: bool) -> str:
    """Return the lines of the starters that are machines, or of those that are not."""
    found = {kind: starter for kind, starter in STARTERS.items() if starter.machine is machine}
    return "\n".join(f"  {kind:17}{starter.meaning}" for kind, starter in found.items())


NEW = f"""\
Write a commented scene that is ready to run. An existing file is never overwritten.

\b
KIND is one of
{_kinds(machine=False)}

\b
or the scene of a machine, as its page in the documentation shows it:
{_kinds(machine=True)}

\b
Examples:
  cardan new joint joint.toml
  cardan new truck-shaft truck.toml
  cardan new recorded run.toml
"""

IDENTIFY = """\
Find the bend that a recording of a driveline shows.

FILE is a CSV, Parquet, NPZ or MDF file. It has columns for the angles of the drive and of a
driven shaft, or for the speed ratio of the driven shaft. The angles may start anew at each turn.
With the angle of the shaft between two joints, both bends and the phase are found.

\b
Examples:
  cardan identify run.csv --drive crank --driven axle
  cardan identify run.csv --drive crank --speed-ratio ratio
  cardan identify run.csv --drive crank --intermediate mid --driven axle
"""

SCHEMA = """\
Print the JSON Schema of scenes. Editors use it to complete and check them.

With "--answers": the schema of what "--json" prints.

\b
Examples:
  cardan schema
  cardan schema --output scene.schema.json
  cardan schema --answers
"""

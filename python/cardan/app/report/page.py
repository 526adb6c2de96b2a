"""The page of a scene: the data of its sections, which ``templates/page.html`` puts together."""

from __future__ import annotations

import base64
import hashlib
import os
import re
import time
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from cardan import __version__
from cardan.app.answers.answer import Answer
from cardan.app.answers.page import chart, judged_table, tables_of
from cardan.app.answers.yokes.figures import yoke_settings
from cardan.app.files.whole_file import Progress
from cardan.app.report import results
from cardan.app.report.answer import first_answer, verdict_of
from cardan.app.report.live import live, script
from cardan.app.report.samples import Samples, evaluated
from cardan.app.report.study import states, study
from cardan.app.scene.scene import BallJointScene, Scene
from cardan.app.scene.study.states import StatesResult
from cardan.arrays import FloatArray

if TYPE_CHECKING:
    from jinja2 import Environment


def page(scene: Scene | BallJointScene, progress: Progress | None = None) -> str:
    """Return the whole page as HTML; arguments and errors as of ``write_report``."""
    known: dict[str, Any] = {
        "version": __version__,
        "style": part("page.css"),
        "title": scene.title or Path(scene.name).name,
        "name": Path(scene.name).name,
        "date": _today(),
    }
    template = environment().get_template("page.html")
    if isinstance(scene, BallJointScene):
        answer = Answer(scene)
        known |= {"verdict": verdict_of(answer), "parts": _parts(answer)}
        known |= {"live": None, "script": script(), "joints": 0, "varied": False}
        return template.render(known, states=None, study=None)
    result = scene.run(progress)
    samples, answer = evaluated(scene), Answer(scene)
    motion = answer["limits"]
    # Of one joint there is nothing to set, and for recorded bends no setting.
    fixed = scene.line.n_joints > 1 and not scene.line.shape
    fixed = fixed and not (scene.states and scene.states.set_phases)
    yokes = yoke_settings(scene) if fixed else None
    table = result.study
    moves = live(answer)
    if moves:
        known["style"] += part("live.css")
    # What the page computes itself is not drawn twice.
    panels, (x, x_label) = [] if moves else samples.panels(), _abscissa(samples)
    speeds = tables_of("Limits are kept up to", motion.speeds) if motion.speeds else []
    over_states = table if isinstance(table, StatesResult) else None
    return template.render(
        known | first_answer(answer, samples, yokes),
        joints=scene.line.n_joints,
        over="time" if samples.time is not None else "the drive angle",
        varied=bool(scene.study and scene.study.axes),
        live=moves,
        script=script(moves=moves is not None),
        every=samples.every,
        inputs=results.inputs(scene),
        results=[judged_table(answer.judged), *speeds, *results.results(samples, answer)],
        study=None if table is None or over_states else study(scene, table, answer.check),
        states=states(answer, over_states, yokes) if over_states else None,
        charts=[chart(panel, x, x_label) for panel in panels if not panel.is_steady],
        steady=[panel.line for panel in panels if panel.is_steady],
        parts=_parts(answer),
        catalogue=results.catalogue(scene, yokes),
    )


def _parts(answer: Answer) -> list[dict[str, Any]]:
    """The sections of the parts."""
    return [part.section(answer, found) for part, found in answer.parts("report")]


def _today() -> str:
    """The date of the page; builds that must repeat set it in their environment."""
    given = os.environ.get("SOURCE_DATE_EPOCH", "")
    when = time.gmtime(int(given)) if given.isdecimal() else time.localtime()
    return time.strftime("%Y-%m-%d", when)


def environment() -> Environment:
    """Return what renders the templates: it escapes every text and refuses a missing name.

    Without jinja2 it raises an ``ImportError``.
    """
    try:
        import jinja2
    except ModuleNotFoundError:
        hint = "a report needs jinja2: pip install 'cardan[app]'"
        raise ModuleNotFoundError(hint) from None
    made = jinja2.Environment(
        loader=jinja2.FunctionLoader(part),
        undefined=jinja2.StrictUndefined,
        autoescape=True,
        trim_blocks=True,
        keep_trailing_newline=True,
    )
    made.policies["json.dumps_kwargs"] = {"allow_nan": False, "separators": (",", ":")}
    made.filters["digest"] = _digest
    # The numbers of a text have a true minus sign.
    made.filters["minus"] = lambda text: re.sub(r"(?<!\S)-(?=[\d.])", "\N{MINUS SIGN}", text)
    return made


def part(name: str) -> str:
    """Return a template, a style or a script by its name."""
    path = resources.files("cardan.app").joinpath("report/templates", name)
    return path.read_text(encoding="utf-8")


def _digest(text: str) -> str:
    """The source by which the page's policy lets this text alone be a script or a style."""
    digest = base64.b64encode(hashlib.sha256(text.encode()).digest())
    return f"sha256-{digest.decode()}"


def _abscissa(samples: Samples) -> tuple[FloatArray, str]:
    if samples.time is not None:
        return samples.time, "time [s]"
    angle = samples.angle_deg
    if np.all(np.diff(angle) >= 0.0) or np.all(np.diff(angle) <= 0.0):
        return angle, "drive angle [deg]"
    # Angles that go back and forth would draw the curves over themselves.
    return samples.every * np.arange(float(len(angle))), "recorded sample"

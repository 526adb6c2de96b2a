"""The page of a scene, put together from its sections."""

from __future__ import annotations

import base64
import hashlib
import json
from html import escape
from importlib import resources
from pathlib import Path
from string import Template
from typing import Any

import numpy as np

import cardan.report.answer as answer
import cardan.report.tables as tables
from cardan import __version__
from cardan.arrays import FloatArray
from cardan.files.progress import Progress
from cardan.report.charts import chart, decimals
from cardan.report.drawing import drawing
from cardan.report.samples import NOMINAL_TORQUE, Panel, Samples, evaluated
from cardan.report.study import study_section
from cardan.scene.scene import Scene


def page(scene: Scene, progress: Progress | None = None) -> str:
    """Return the whole page as HTML; arguments and errors as of ``write_report``."""
    result = scene.run(progress)
    samples = evaluated(scene)
    panels, drawn = samples.panels(), drawing(samples)
    sections = {
        "answer": ("Answer", answer.section(scene, samples)),
        "inputs": ("Inputs", tables.inputs(scene)),
        "results": ("Results", tables.results(result, samples)),
        "study": (
            "Study" if scene.study and scene.study.axes else "Figures",
            study_section(result.study) if result.study else "",
        ),
        "pictures": ("Over the drive angle", _pictures(samples, panels, drawn["views"])),
        "skipped": ("Computed and skipped", _plan(scene)),
        "catalogue": ("Exact bend and catalogue rule", tables.catalogue(scene)),
    }
    sections = {key: section for key, section in sections.items() if section[1]}
    name = Path(scene.name).name
    title = scene.title or name
    script, style = _part("page.js"), _part("page.css")
    return Template(_part("page.html")).substitute(
        version=f"cardan {__version__}",
        title=escape(title),
        subtitle=escape(_subtitle(scene, name)),
        contents="".join(
            f'<li><a href="#{key}">{escape(heading)}</a></li>'
            for key, (heading, _) in sections.items()
        ),
        body="\n".join(
            f'<section id="{key}" aria-labelledby="{key}-heading">'
            f'<h2 id="{key}-heading">{escape(heading)}</h2>\n{body}</section>'
            for key, (heading, body) in sections.items()
        ),
        style=style,
        style_hash=_hash(style),
        script=script,
        script_hash=_hash(script),
        data=embedded(_data(samples, panels, drawn)),
    )


def _subtitle(scene: Scene, name: str) -> str:
    joints = scene.line.n_joints
    what = "A single joint" if joints == 1 else f"A driveline with {joints} joints"
    if scene.study and scene.study.axes:
        what += ", and a study of it"
    return f"{what}; report on the scene {name}"


def _pictures(samples: Samples, panels: list[Panel], views: list[dict[str, Any]]) -> str:
    x, label = _abscissa(samples)
    note = ""
    if samples.nominal:
        note = (
            f'<p class="note">Torques and moments are for {NOMINAL_TORQUE:g} N m of drive torque, '
            "because the scene gives none; they grow in proportion.</p>"
        )
    if samples.every > 1:
        note += f'<p class="note">One in {samples.every} recorded samples is shown.</p>'
    figures, first = [], 0
    for panel in panels:
        figures.append(chart(panel, x, label, first))
        first += len(panel.curves)
    what = "Drive angle" if samples.result.scene.recording is None else "Recorded sample"
    return (
        "<p>Move the slider, also with the arrow keys, to turn the driveline. Bends and yokes are "
        "drawn true, lengths are not to scale. The driving yoke of each joint is blue, the driven "
        "one orange, the cross black; what points away from you is faint. Shafts are numbered.</p>"
        f"{note}"
        f'<div class="slider"><label for="sample">{what}</label> '
        '<output for="sample"></output>'
        f'<input type="range" id="sample" min="0" max="{len(x) - 1}" step="1" value="0" '
        'autocomplete="off"></div>'
        "<noscript><p>The drawing and the numbers at the slider need JavaScript.</p></noscript>"
        f'<div class="turn"><div class="views">{_views(views)}</div>'
        f'<div class="charts">{"".join(figures)}</div></div>'
    )


def _views(views: list[dict[str, Any]]) -> str:
    return "".join(
        f"<figure><figcaption>{escape(view['name'])}</figcaption>"
        f'<svg id="view-{number}" viewBox="0 0 {view["size"][0]:g} {view["size"][1]}" role="img" '
        f'aria-label="The driveline. {escape(view["name"])}"></svg></figure>'
        for number, view in enumerate(views)
    )


def _abscissa(samples: Samples) -> tuple[FloatArray, str]:
    angle = samples.angle_deg
    if np.all(np.diff(angle) >= 0.0) or np.all(np.diff(angle) <= 0.0):
        return angle, "drive angle [deg]"
    # Angles that go back and forth would draw the curves over themselves.
    return samples.every * np.arange(float(len(angle))), "recorded sample"


def _data(samples: Samples, panels: list[Panel], drawn: dict[str, Any]) -> dict[str, Any]:
    curves = []
    for panel in panels:
        digits = decimals(panel)
        curves += [
            {"decimals": digits, "values": np.round(curve.values, digits).tolist()}
            for curve in panel.curves
        ]
    return {"places": _places(samples), "curves": curves, "drawing": drawn}


def _places(samples: Samples) -> list[str]:
    """Where each sample stands, in words."""
    angle = samples.angle_deg
    digits = 1 if np.all(np.round(angle, 1) == angle) else 2
    places = [f"{value:.{digits}f}°".replace("-", "\N{MINUS SIGN}") for value in angle]
    if samples.result.scene.recording is not None:
        places = [f"{samples.every * i}, drive angle {place}" for i, place in enumerate(places)]
    return places


def _plan(scene: Scene) -> str:
    return (
        "<p>How the quantities that the scene asks for are evaluated, as "
        f"<code>cardan explain</code> says it.</p><pre>{escape(scene.explain())}</pre>"
    )


def embedded(data: object) -> str:
    """Return plain data as JSON that can stand in a script element.

    That ends at the first "</script", wherever it stands.
    """
    text = json.dumps(data, allow_nan=False, separators=(",", ":"))
    return text.replace("<", "\\u003c")


def _part(name: str) -> str:
    return resources.files("cardan.report").joinpath(name).read_text(encoding="utf-8")


def _hash(text: str) -> str:
    """What lets this text alone be a script or a style, whatever else the page may hold."""
    digest = base64.b64encode(hashlib.sha256(text.encode()).digest())
    return f"sha256-{digest.decode()}"

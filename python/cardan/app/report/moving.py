"""The live part of a page alone: of one scene in a notebook, of several to choose from."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from cardan.app.answers.answer import Answer
from cardan.app.report.live import live, script
from cardan.app.report.page import environment, part
from cardan.app.scene.scene import Scene

HEIGHT = "45rem"  # of the frame: head, drawing and the verdict in a notebook


def moving_page(answers: Mapping[str, Answer]) -> str | None:
    """Return a page in which the machines of answers can be moved; ``None`` if none can be.

    Of several the page shows the one whose key is the query of its address, or the first.

    Raises:
        ImportError: jinja2 is missing.
    """
    found = {key: live(answer) for key, answer in answers.items()}
    machines = {key: each for key, each in found.items() if each}
    if not machines:
        return None
    first = next(iter(machines.values()))
    return (
        environment()
        .get_template("moving.html")
        .render(
            style=part("page.css") + part("live.css"),
            choice=part("choice.js") if len(machines) > 1 else None,
            script=script(moves=True),
            module=first["module"],
            machines={key: each["data"] for key, each in machines.items()},
            titles={
                key: (scene := answers[key].scene).title or Path(scene.name).name
                for key in machines
            },
        )
    )


def framed(answer: Answer) -> str | None:
    """Return the machine of an answer as a frame of HTML, which a notebook shows.

    ``None`` without a machine that can be moved, and without jinja2, which makes the page.
    """
    try:
        environment()
    except ImportError:
        return None
    page = moving_page({"": answer}) if isinstance(answer.of, Scene) else None
    if page is None:
        return None
    # Only these two characters end or change the text of the attribute.
    own = page.replace("&", "&amp;").replace("'", "&#39;")
    style = f"width: 100%; height: {HEIGHT}; border: 0"
    # Scripts move the machine, and a download saves what it has become.
    rights = "allow-scripts allow-downloads"
    return f"""<iframe sandbox="{rights}" style="{style}" srcdoc='{own}'></iframe>"""

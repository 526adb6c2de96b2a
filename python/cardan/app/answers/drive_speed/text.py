"""How constant the speed of a drive is, in words."""

from __future__ import annotations

from collections.abc import Iterator

from cardan.app.answers.drive_speed.figures import SHARE, SOURCE, DriveSpeed
from cardan.app.answers.printed import figure_text, rounded_up
from cardan.design.wrapping import wrap

_HEADINGS = {
    "fair": "a fair assumption",
    "not fair": "not a fair assumption",
    "no drive inertia": "not checked",
}


def words(found: DriveSpeed, *, radians: bool = False) -> str:
    """Return the finding as plain text, 79 characters wide."""
    lines = [heading_text(found)]
    for words in sentences(found):
        lines += wrap(f"- {words}", 79, subsequent_indent="    ")
    return "\n".join(lines)


def heading_text(found: DriveSpeed) -> str:
    """Return the verdict."""
    state = f", judged in {found.state}" if found.state else ""
    return f"Constant drive speed: {_HEADINGS[found.verdict]}{state}"


def sentences(found: DriveSpeed) -> Iterator[str]:
    """Say how far the drive varies, by whose rule that is judged and what to change."""
    limit = f"the limit is {_percent(SHARE)} ({SOURCE})"
    needed = f"{rounded_up(found.needed)} kg m²"
    if found.verdict == "no drive inertia":
        inertia = f"at least {needed}" if found.needed > 0.0 else "any inertia"
        yield (
            "the scene gives shaft 0 no inertia, so its speed counts as constant; this is fair if "
            f"shaft 0 has {inertia} (motor, pulley, flywheel): running freely, it then varies by "
            f"no more than {_percent(SHARE)} of what shaft {found.shaft} varies ({SOURCE})"
        )
        return
    yield (
        f"running freely, the drive varies by {_percent(found.variation)} from peak to peak; shaft "
        f"{found.shaft} varies by {_percent(found.shaft_variation)}, so the share is "
        f"{_percent(found.share)}; {limit}"
    )
    if found.verdict == "not fair":
        yield (
            "inertia torques of a freely running drive are smaller than computed, by about that "
            f"share; shaft 0 needs {needed} for a fair assumption, and has "
            f"{figure_text(found.inertia)}"
        )


def _percent(share: float) -> str:
    return f"{100.0 * share:.3g} %"

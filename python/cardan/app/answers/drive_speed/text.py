"""How constant the speed of a drive is, in words."""

from __future__ import annotations

from collections.abc import Iterator

from cardan.app.answers.drive_speed.figures import SHARE, SOURCE, DriveSpeed
from cardan.app.answers.printed import quantity, rounded_up
from cardan.app.answers.rows import UNITS

_HEADINGS = {
    "fair": "a fair assumption",
    "not fair": "not a fair assumption",
    "no drive inertia": "not checked",
}


def heading(found: DriveSpeed) -> str:
    """Return the verdict."""
    state = f", judged in {found.state}" if found.state else ""
    return f"Constant drive speed: {_HEADINGS[found.verdict]}{state}"


def sentences(found: DriveSpeed) -> Iterator[str]:
    """Say how far the drive varies, by whose rule that is judged and what to change."""
    limit = quantity(SHARE, "percent")
    needed = f"{rounded_up(found.needed)} {UNITS['kgm2'].symbol}"
    if found.verdict == "no drive inertia":
        inertia = f"at least {needed}" if found.needed > 0.0 else "any inertia"
        yield (
            "The scene gives shaft 0 no inertia, so its speed counts as constant. This is a "
            f"reasonable assumption if shaft 0 has {inertia} (motor, pulley, flywheel): without "
            f"torque, its speed then varies at most {limit} as much as that of shaft {found.shaft} "
            f"({SOURCE})."
        )
        return
    yield (
        f"Without torque, the speed of the drive varies by {quantity(found.variation, 'percent')} "
        f"from peak to peak. Shaft {found.shaft} varies by "
        f"{quantity(found.shaft_variation, 'percent')}, so the share is "
        f"{quantity(found.share, 'percent')}; the limit is {limit} ({SOURCE})."
    )
    if found.verdict == "not fair":
        yield (
            "Inertia torques of a freely running drive are smaller than computed, by about that "
            f"share. A fair assumption needs {needed} of shaft 0, which has "
            f"{quantity(found.inertia, 'kgm2')}."
        )

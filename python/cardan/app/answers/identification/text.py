"""What a recording shows of the joints of a driveline, in words."""

from __future__ import annotations

from collections.abc import Iterator

from cardan.app.answers.identification.figures import Identified
from cardan.app.answers.printed import part_text

# A recording whose purity is farther from 1, and by more than the noise can do, shows something
# besides the joints.
_PURE = 0.2
_SIGMAS = 3.0


def identification_text(found: Identified, *, radians: bool = False) -> str:
    """Return an identification as printed text, at most 79 characters wide."""
    return part_text(found.path, found, sentences(found), radians=radians)


def sentences(found: Identified) -> Iterator[str]:
    """Say what the recording shows and what it cannot show."""
    if not found.detected:
        yield "The bend is not larger than the noise permits to detect."
    else:
        yield (
            "The offset is what to add to the recorded drive angle so that the driving pin lies in "
            "the bend plane of the equivalent joint at 0."
        )
    if found.detected and found.purity is not None:
        noise = _SIGMAS * (found.purity_standard_deviation or 0.0)
        if abs(found.purity - 1.0) > max(_PURE, noise):
            yield (
                "The purity is not 1: order 4 does not fit order 2, so the recording shows "
                "something besides universal joints."
            )
        elif noise > 1.0:
            yield (
                "The noise hides order 4, so the purity does not tell whether order 2 comes from "
                "joints. A longer recording, with more samples, does."
            )
    yield (
        "An ovality of an encoder has order 2 as well. A recording with straight joints tells it "
        "from a bend."
    )
    if found.joints:
        yield "Phase and twist cannot be told apart: only their difference shows."
    else:
        yield (
            "Bends and phases of several joints cannot be told apart by two encoders: only the "
            "equivalent bend shows."
        )

"""What a check says in words."""

from __future__ import annotations

from collections.abc import Sequence

from cardan.app.answers.answer import Answer
from cardan.app.answers.printed import listed
from cardan.design.check import Check
from cardan.design.judged import counted
from cardan.design.wrapping import wrap

_MOTION = {
    "within": "The motion of the driveline is within its limits.",
    "tolerable": "The motion is tolerable: above a limit, but below every maximum.",
    "beyond": "The motion of the driveline is beyond its limits as well.",
    "unknown": "The motion cannot be judged: a figure is not a number.",
    "not judged": "The motion is not judged.",
}


_BALL_JOINT = {
    "within": "The ball joint is within its limits.",
    "not judged": "The ball joint is not judged: the scene gives no allowable pressure.",
}


def verdict_lines(answer: Answer) -> list[str]:
    """Return the verdict on a scene in one sentence, or in two if its motion is not the worst."""
    found = answer.motion
    beyond = [f"the {each.name}" for each in answer.of_verdict("beyond")]
    if beyond:
        whose = "its limit" if len(beyond) == 1 else "their limits"
        worst = f"Beyond {whose}: {listed(beyond)}."
        return [worst] if found is None else [worst, _of_motion(found)]
    return [_BALL_JOINT[answer.verdict] if found is None else found.heading]


def check_text(answer: Answer, advice: Sequence[str] = ()) -> str:
    """Return the verdict and its check in words, and what would bring it within the limits.

    Args:
        answer: the answer to a scene.
        advice: what would bring it within the limits, a sentence each.
    """
    lines = [line for text in verdict_lines(answer) for line in wrap(text, 79)]
    if answer.motion is not None:
        lines.append(str(answer.motion).split("\n", 1)[1])
    lines += ["", "What would help:"] if advice else []
    for sentence in advice:
        lines += wrap(f"- {sentence}", 79, subsequent_indent="  ", break_on_hyphens=False)
    return "\n".join(lines)


def _of_motion(found: Check) -> str:
    if found.ranks.shape:
        return f"In their motion, {counted(found.ranks, 'drivelines are within all limits')}."
    return _MOTION[str(found.verdict)]

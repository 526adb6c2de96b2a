"""The verdict in words, what makes it, and what is not judged."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from cardan.app.answers.answer import Answer, JudgedFigure
from cardan.app.answers.printed import judged_text, listed
from cardan.app.answers.table import PARTS
from cardan.design.wrapping import fill, wrap

# More are counted in the first sentence.
_NAMED = 3


def verdict_text(answer: Answer) -> str:
    """Return the verdict on everything that has a limit in one sentence."""
    found = answer.of_verdict(answer.verdict)
    # By several presets a figure can have several limits.
    names = [*dict.fromkeys(f"the {each.name}" for each in found if _is_limited(each))]
    if len(names) > _NAMED + 1:
        names = [*names[:_NAMED], f"{len(names) - _NAMED} more"]
    if answer.verdict == "beyond":
        return f"Beyond {'its limit' if len(names) == 1 else 'their limits'}: {listed(names)}."
    if answer.verdict == "tolerable":
        return f"Tolerable, above the limit but below the maximum: {listed(names)}."
    if answer.verdict == "within":
        return "Everything that has a limit is within it."
    if names:
        return f"Not judged, although there is a limit: {listed(names)}."
    return "Nothing is judged: the scene gives no limit."


def findings(answer: Answer, verdict: str) -> Iterator[str]:
    """Say of each figure with a verdict what it is, where, and by how much it misses its limit."""
    for each in answer.of_verdict(verdict):
        if each.value.value is not None:
            yield f"{each.name}: {judged_text(each.value, each.entry.row)} ({each.value.source})"


def not_judged(answer: Answer) -> Iterator[str]:
    """Say what is not judged and why: what has a limit one by one, what has none together."""
    without: dict[str, list[str]] = {}
    said = set()
    for each in answer.of_verdict("not judged"):
        if _is_limited(each):
            text = f"{each.name}: {each.value.why or 'it is not a number'}"
            if text not in said:
                yield text
            said.add(text)
        elif each.value.value is not None:
            without.setdefault(each.entry.row.limit, []).append(each.name)
    if without:
        keys = [
            f"{names[0]}{f' and {len(names) - 1} more' if len(names) > 1 else ''} ({key})"
            for key, names in without.items()
        ]
        yield f"no limit is given for: {'; '.join(keys)}"


def _is_limited(each: JudgedFigure) -> bool:
    return each.value.limit is not None


def check_text(answer: Answer, advice: Sequence[str] = ()) -> str:
    """Return the verdict, what makes it, what would help and every part, as plain text, 79 wide."""
    lists = {
        "Beyond": list(findings(answer, "beyond")),
        "Tolerable": list(findings(answer, "tolerable")),
        "What would help": list(advice),
        "Not judged": list(not_judged(answer)),
    }
    blocks = [fill(verdict_text(answer), 79)]
    for heading, sentences in lists.items():
        lines = [
            line
            for text in sentences
            for line in wrap(f"- {text}", 79, subsequent_indent="  ", break_on_hyphens=False)
        ]
        blocks += ["\n".join([heading, *lines])] if lines else []
    parts = (PARTS[part.name].text(found, brief=True) for part, found in answer.parts("check"))
    return "\n\n".join([*blocks, *filter(None, parts)])

"""What the check of a scene found: a list of verdicts, and a table of limits with sources."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from cardan.app.answers.answer import Answer
from cardan.app.answers.limits.text import findings, verdict_text
from cardan.app.answers.names import key_name
from cardan.app.answers.printed import figure_text
from cardan.app.charts.charts import number
from cardan.app.charts.tables import Table
from cardan.design.check import Check
from cardan.design.judged import VERDICTS, Finding

# By verdict: the class of its words, the sign before them.
_SHOWN = {
    "within": ("good", "✓"),
    "tolerable": ("fair", "!"),
    "beyond": ("bad", "✗"),
    "unknown": ("bad", "?"),
    "not judged": ("open", "-"),
}


def verdict_of(found: Check | Finding) -> str:
    """Return the worst verdict of a check or of one of its findings."""
    return VERDICTS[int(np.max(found.ranks, initial=0))]


def shown(verdict: str) -> str:
    """Return the class of the page by which a verdict has its colour."""
    return _SHOWN[verdict][0]


def verdict_data(answer: Answer) -> dict[str, Any]:
    """Return the verdict on a scene for the top of its page."""
    return {
        "word": answer.verdict,
        "class": shown(answer.verdict),
        "words": verdict_text(answer),
        "beyond": list(findings(answer, "beyond")),
    }


def groups(found: Check) -> list[dict[str, Any]]:
    """Return the findings of catalogue and practice as plain data, the verdict of each first."""
    listed = []
    for part in (found.catalogue, found.practice):
        if part.findings:
            name = part.findings[0].group
            preset = (
                f" ({found.limits.preset})" if name == "practice" and found.limits.preset else ""
            )
            verdict = verdict_of(part)
            listed.append(
                {
                    "heading": f"{name.capitalize()}{preset}: {verdict}",
                    "class": shown(verdict),
                    "findings": [_line(finding) for finding in part.findings],
                }
            )
    return listed


def _line(finding: Finding) -> dict[str, str]:
    css, sign = _SHOWN[verdict_of(finding)]
    words = f"{finding.name} {finding.value_text}: {'; '.join(finding.words)}"
    if finding.worst_in and finding.largest_text:
        words += f"; largest {finding.largest_text}"
    elif finding.place:
        words += f"; largest at {at_keys(finding.worst_at)}"
    return {"class": css, "sign": sign, "words": words}


def at_keys(values: Any) -> str:  # noqa: ANN401 - a mapping
    """Say keys of a scene with their values: ``bend, joint 0: 5 deg; speed: 1000 rpm``."""
    said = []
    for key, value in values.items():
        name, _, unit = key_name(key).partition(" [")
        said.append(f"{name}: {number(value)} {unit.removesuffix(']')}".rstrip())
    return "; ".join(said)


def limits_table(found: Check) -> Table:
    """Return every figure beside its limit, with the speeds at which it reaches them."""
    rows = []
    for finding in found.findings:
        limit = finding.limit
        rows.append(
            [
                f"{finding.name} [{finding.unit}]",
                "" if finding.needs_speed else figure_text(finding.worst),
                verdict_of(finding),
                f"{limit.limit:g}" if limit else "",
                f"{limit.maximum:g}" if limit else "",
                _rpm(finding.within_up_to),
                _rpm(finding.tolerable_up_to),
                limit.source if limit else "no limit given",
            ]
        )
    heads = (
        *("Figure", "Value", "Verdict", "Limit", "Maximum"),
        *("Within up to [rpm]", "Tolerable up to [rpm]", "Source of the limit"),
    )
    several = any(np.ndim(finding.value) for finding in found.findings)
    return Table(
        f"Limits{', and the worst of all drivelines' if several else ''}", heads, rows, True
    )


def _rpm(speeds: Any) -> str:  # noqa: ANN401 - numbers
    """The lowest of several speeds in rpm, rounded down; "" where there is none."""
    rpm = float(np.min(speeds, initial=math.inf)) * 60.0 / math.tau
    if math.isnan(rpm):
        return ""
    return f"{math.floor(rpm)}" if rpm < 1e7 else "any"

"""Whether a scene, or all of its study, is within the limits."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cardan.app.answers.answer import Answer
from cardan.app.answers.json_schema import answer, answers_with, record
from cardan.app.answers.study.extremes import finite_or_none
from cardan.app.answers.table import PARTS
from cardan.app.scene.units import RPM
from cardan.design.check import Check
from cardan.design.judged import VERDICTS, Finding, non_uniformity

_ENDINGS = {"deg": "deg", "rad/s²": "rad_s2"}

_PRACTICE = {
    "bend_difference": "deg",
    "torsional_excitation": "rad_s2",
    "inertia_excitation_driving": "rad_s2",
    "inertia_excitation_coasting": "rad_s2",
}


def check_data(found: Answer, advice: Sequence[str] = ()) -> dict[str, Any]:
    """Return a check as plain data for JSON, as ``CHECK_SCHEMA`` describes it.

    Args:
        found: the answer to the scene.
        advice: what would bring it within the limits, a sentence each.
    """
    parts = {part.name: part.data(each) for part, each in found.parts("check")}
    own = {} if found.motion is None else _motion(found.motion, advice)
    return answer("check", found.of.title, **_overall(found), **own, **parts)


def _overall(found: Answer) -> dict[str, Any]:
    """The one verdict, and what makes it."""
    return {
        "verdict": found.verdict,
        "passes": found.passes,
        "beyond": [each.name for each in found.of_verdict("beyond")],
    }


def _motion(found: Check, advice: Sequence[str]) -> dict[str, Any]:
    """The check of the driveline."""
    by_figure = {finding.figure: finding for finding in found.findings}
    practice = {
        figure: _entry(by_figure[figure]) if figure in by_figure else None for figure in _PRACTICE
    }
    return {
        **_counts(found.ranks),
        "preset": found.limits.preset,
        "catalogue": {
            **_verdict(found.catalogue.ranks),
            "equivalent_bend": _entry(by_figure["equivalent_bend"]),
        },
        "practice": {**_verdict(found.practice.ranks), **practice},
        "advice": list(advice),
    }


def _verdict(ranks: NDArray[np.int_]) -> dict[str, Any]:
    """The worst verdict, and how many drivelines have which."""
    return {"verdict": VERDICTS[int(np.max(ranks, initial=0))], **_counts(ranks)}


def _counts(ranks: NDArray[np.int_]) -> dict[str, Any]:
    counts = {
        name.replace(" ", "_"): int(np.count_nonzero(ranks == rank))
        for rank, name in enumerate(VERDICTS)
    }
    return {"drivelines": counts}


def _entry(finding: Finding) -> dict[str, Any]:
    """One figure as plain data."""
    unit, limit = _ENDINGS[finding.unit], finding.limit
    entry = {
        **_verdict(finding.ranks),
        f"value_{unit}": finite_or_none(finding.worst),
        f"limit_{unit}": limit.limit if limit else None,
        f"maximum_{unit}": limit.maximum if limit else None,
        f"margin_{unit}": finite_or_none(limit.limit - finding.worst) if limit else None,
        "source": limit.source if limit else None,
        "worst_at": [{"key": key, "value": value} for key, value in finding.worst_at.items()],
    }
    if finding.worst_in:
        entry["worst_in"] = finding.worst_in
    if finding.figure == "equivalent_bend" and limit:
        entry["non_uniformity"] = finite_or_none(non_uniformity(finding.worst))
        entry["non_uniformity_limit"] = non_uniformity(limit.limit)
    if finding.at_unit_speed is not None:
        for name, speeds in (
            ("within_up_to_rpm", finding.within_up_to),
            ("tolerable_up_to_rpm", finding.tolerable_up_to),
        ):
            entry[name] = finite_or_none(float(np.min(speeds, initial=math.inf)) / RPM)
    return entry


_NUMBER = {"type": ["number", "null"]}
_KEY = {"key": {"type": "string"}, "value": {"type": "number"}}
_VERDICT = {"enum": list(VERDICTS)}
_COUNTS = {
    "drivelines": record(
        {name.replace(" ", "_"): {"type": "integer", "minimum": 0} for name in VERDICTS}
    ),
}
_JUDGED = {"verdict": _VERDICT, **_COUNTS}


def _entry_schema(unit: str, more: Sequence[str]) -> dict[str, Any]:
    return record(
        {
            **_JUDGED,
            **{f"{name}_{unit}": _NUMBER for name in ("value", "limit", "maximum", "margin")},
            "source": {"type": ["string", "null"]},
            "worst_at": {"type": "array", "items": record(_KEY)},
            **dict.fromkeys(more, _NUMBER),
        },
        {"worst_in": {"type": "string", "description": "the state with the largest value"}},
    )


_SPEEDS = ("within_up_to_rpm", "tolerable_up_to_rpm")


def _practice(unit: str) -> dict[str, Any]:
    entry = _entry_schema(unit, _SPEEDS if unit == "rad_s2" else ())
    return {"oneOf": [entry, {"type": "null"}]}


CHECK_SCHEMA = answers_with(
    "check",
    "what cardan check prints with --json",
    {
        **_COUNTS,
        "preset": {"type": ["string", "null"]},
        "catalogue": record(
            {
                **_JUDGED,
                "equivalent_bend": _entry_schema("deg", ("non_uniformity", "non_uniformity_limit")),
            }
        ),
        "practice": record(
            {**_JUDGED, **{figure: _practice(unit) for figure, unit in _PRACTICE.items()}}
        ),
        "advice": {"type": "array", "items": {"type": "string"}},
    },
    {"ball_joint": PARTS["ball_joint"].schema()},
    needed={
        "verdict": {**_VERDICT, "description": "the worst of all that has a limit"},
        "passes": {"type": "boolean", "description": "whether nothing is beyond its maximum"},
        "beyond": {
            "type": "array",
            "items": {"type": "string"},
            "description": "what is beyond its limits besides the motion of the driveline",
        },
    },
    optional={name: part.schema() for name, part in PARTS.items() if "check" in part.shown},
)
"""JSON Schema (draft 2020-12) of what ``check_data`` returns.

``value`` is the worst of a batch, a study or recorded bends, and ``worst_at`` the keys of a study
at which it occurs; ``drivelines`` counts them by verdict. A figure that the driveline does not have
is null, and so is a speed that is never reached.
"""

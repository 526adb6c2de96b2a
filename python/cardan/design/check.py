"""Whether a driveline is within the limits of the catalogues and of practice."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cardan import _core, approximations
from cardan.arrays import FloatArray, as_float64, common_shape, html_table, threads
from cardan.design.judged import VERDICTS, Finding, counted
from cardan.design.limits import CATALOGUE, PRESETS, Limiting, Limits, limits_of
from cardan.design.published import published
from cardan.design.quantities import MOTION_QUANTITIES
from cardan.design.wrapping import wrap

if TYPE_CHECKING:
    from cardan.driveline import Driveline

_INDENT = " " * 4

_HEADINGS = {
    "within": "The driveline is within the limits.",
    "tolerable": "The driveline is tolerable: above a limit, but below every maximum.",
    "beyond": "The driveline is beyond the limits.",
    "unknown": "The driveline cannot be judged: a figure is not a number.",
    "not judged": "Nothing is judged.",
}


@dataclass(frozen=True, eq=False)
class Check:
    """Findings of a check; ``print`` it to read it.

    The check of one driveline at one speed is true if it passes: ``if line.check(): ...``. That of
    a batch has no single answer and raises; use ``check.passes.all()`` or ``check.passes.any()``.

    Attributes:
        findings: one per figure.
        limits: what the figures are compared with.
    """

    findings: tuple[Finding, ...]
    limits: Limits

    @property
    def catalogue(self) -> Check:
        """The part that the catalogues of driveshafts judge: the equivalent bend."""
        return Check(tuple(f for f in self.findings if f.group == "catalogue"), self.limits)

    @property
    def practice(self) -> Check:
        """The part that practice judges: excitations, and the difference of two bends."""
        return Check(tuple(f for f in self.findings if f.group == "practice"), self.limits)

    @property
    def motion(self) -> Check:
        """The part on the motion: the catalogues' and that of practice."""
        return Check(tuple(f for f in self.findings if f.group != "published"), self.limits)

    @property
    def published(self) -> Check:
        """The part that makers judge who publish how far joints may be bent."""
        return Check(tuple(f for f in self.findings if f.group == "published"), self.limits)

    @property
    def of_presets(self) -> dict[str, Check]:
        """Check against each preset alone, by its name."""
        found = {}
        for name in self.limits.presets:
            own = set(PRESETS[name].figures.values())
            by_it = (f for f in self.findings if f.preset == name or f.limit in own)
            found[name] = Check(tuple(by_it), self.limits)
        return found

    @property
    def ranks(self) -> NDArray[np.int_]:
        """Worst verdict of all figures, as ``Finding.ranks``, in the shape of batch and speed."""
        ranks = np.broadcast_arrays(0, *(finding.ranks for finding in self.findings))
        return np.asarray(np.max(ranks, axis=0))

    @property
    def verdict(self) -> NDArray[np.str_]:
        """``"within"``, ``"tolerable"`` or ``"beyond"``, the worst of all figures.

        It has the shape of batch and speed. See ``Finding.verdict`` for ``"unknown"`` and ``"not
        judged"``.
        """
        return np.asarray(np.array(VERDICTS)[self.ranks])

    @property
    def passes(self) -> NDArray[np.bool_]:
        """Whether no figure is beyond its maximum, in the shape of batch and speed."""
        return np.asarray(self.ranks <= VERDICTS.index("tolerable"))

    def __bool__(self) -> bool:
        """Return whether it passes; a ``ValueError`` for a check of a batch."""
        passes = self.passes
        if passes.shape:
            raise ValueError(
                f"the check has a verdict for each of {passes.size} drivelines or speeds, not one; "
                "use check.passes.all() or check.passes.any()"
            )
        return bool(passes)

    @property
    def heading(self) -> str:
        """The verdict in a sentence, or how many drivelines have which."""
        if not self.ranks.shape:
            return _HEADINGS[str(self.verdict)]
        return f"{counted(self.ranks, 'drivelines are within all limits')}."

    def __str__(self) -> str:
        """Return the verdict, the figures of catalogue and practice, and the sources as text."""
        lines = [self.heading]
        for group in (self.catalogue, self.practice, self.published):
            lines += ["", *group._lines()] if group.findings else []
        sources: dict[str, list[str]] = {}
        for finding in self.findings:
            if finding.limit:
                sources.setdefault(finding.limit.source, []).append(finding.name)
        lines += ["", "Sources of the limits:"]
        for source, names in sources.items():
            text = f"- {'; '.join(names)}: {source}"
            lines += wrap(text, 79, subsequent_indent="  ", break_on_hyphens=False)
        return "\n".join(lines)

    def _lines(self) -> list[str]:
        group, presets = self.findings[0].group, self.limits.presets
        known = {CATALOGUE}.union(*(PRESETS[name].figures.values() for name in presets))
        own = {f.limit for f in self.findings if f.limit and not f.preset} - known
        # Presets of the motion are named with it, and others with the bends.
        whose = [
            name
            for name in presets
            if (group == "practice" and PRESETS[name].figures)
            or (group == "published" and PRESETS[name].on_bends)
        ]
        whose += ["own limit" if len(own) == 1 else "own limits"] if own else []
        verdict = VERDICTS[int(np.max(self.ranks, initial=0))]
        limits = f" ({', '.join(whose)})" if whose else ""
        lines = [f"{group.capitalize()}{limits}: {verdict}"]
        for finding in self.findings:
            verdict_words, *more = finding.words
            lines.append(f"- {finding.name}: {finding.value_text}")
            more += [f"largest {finding.largest_text}"] * bool(finding.largest_text)
            for words in (verdict_words, *more):
                lines += wrap(words, 79, initial_indent=_INDENT, subsequent_indent=_INDENT + "  ")
        return lines

    def _repr_html_(self) -> str:
        """Show the verdict and a row for each finding."""
        rows = [
            (f.group, f.name, f.value_text, "; ".join(f.words), f.limit.source if f.limit else "")
            for f in self.findings
        ]
        heads = ("limits of", "figure", "value", "verdict", "source of the limit")
        return html_table.table(self.heading, heads, rows)


def check(line: Driveline, speed: ArrayLike | None = None, limits: Limiting | None = None) -> Check:
    """Compare the driveline with limits: those of the catalogues and, if you wish, of practice.

    The equivalent bend should not exceed 3° (catalogue, double joint, 6.4); the non-uniformity
    follows from it. That is the only limit unless ``limits`` has others. Torsional excitation
    is the exact peak acceleration of the last shaft, inertia excitation the second-order
    amplitude of the accelerations of all intermediate shafts together; at a speed they are
    among the findings, without a verdict if they have no limit.

    Args:
        speed: drive speed in rad/s; broadcasts against the batch.
        limits: a preset such as ``"truck"`` or ``"spicer"``, several of them, or a
            ``cardan.Limits`` with figures of your own.

    Raises:
        TypeError: a speed that is not a real number, limits of another type.
        ValueError: shapes that do not broadcast, an unknown preset.
    """
    allowed = limits_of(limits)
    line._geometry.check_ideal("excitations are found", "evaluate and harmonics give the motion")
    found = _core.excitations(line._lines, threads.at_most(None))
    found = found.reshape(4, *line.shape) if line.shape else found
    equivalent, torsional, driving, coasting = found
    bend = MOTION_QUANTITIES["equivalent_bend"]
    permitted = allowed.figures[bend.limit]
    degrees = np.degrees(equivalent)
    findings = [Finding(bend.name, bend.label, "catalogue", degrees, "deg", permitted)]
    difference = allowed.figures.get("bend_difference_deg")
    if difference and line.n_joints == 2:
        bends = line._geometry.bends
        apart = np.degrees(np.abs(bends[..., 0] - bends[..., 1]))
        findings.append(
            Finding("bend_difference", "bend difference", "practice", apart, "deg", difference)
        )
    speeds = None if speed is None else as_float64("speed", speed)
    common_shape(driveline=line.shape, speed=() if speeds is None else speeds.shape)
    ratios = {"torsional_excitation": torsional}
    if line.n_joints > 1:
        ratios["inertia_excitation_driving"] = driving
        ratios["inertia_excitation_coasting"] = coasting
    for figure, ratio in ratios.items():
        quantity = MOTION_QUANTITIES[figure]
        name = f"{quantity.label}{', last shaft' if quantity.of_last else ''}"
        limit = allowed.figures.get(quantity.limit)
        if speeds is not None or limit:
            value = ratio * np.nan if speeds is None else speeds**2 * ratio
            given = (np.asarray(value), "rad/s²", limit, ratio, speeds is None)
            findings.append(Finding(figure, name, "practice", *given))
    findings += published(line, speeds, allowed.presets)
    return Check(tuple(findings), allowed)


def catalogue_bend(line: Driveline, fork_signs: ArrayLike) -> FloatArray:
    """Return the catalogues' equivalent bend ``sqrt|sum ± bend**2|`` in rad, for comparison.

    It is the first term of the exact ``ln sec`` rule for yokes that are aligned or crossed
    (catalogue, double joint, 6.5) and broadcasts from batch and signs. For
    two joints up to 30° its error is at most 1.02°; for three joints it can fail completely.

    Args:
        fork_signs: +1 or -1 per joint, ``(..., n)``: joints whose yokes have the same
            position relative to their bend planes have the same sign. The two joints of an
            ordinary compensated shaft therefore have opposite signs.

    Raises:
        ValueError: a sign other than +1 and -1, shapes that do not fit.
    """
    return np.asarray(approximations.catalogue_bend(line.bends, fork_signs))[()]


def fork_signs(line: Driveline) -> tuple[NDArray[np.int64], FloatArray]:
    """Return the signs that describe the yokes, and how far these are from what the signs say.

    Parallel yokes change the sign and crossed ones keep it, once the turn of the bend planes is
    taken off. Yokes in between count as what they are nearer to.

    Returns:
        +1 or -1 per joint, ``(..., n)``, for ``catalogue_bend``; the angle of each shaft between
        two joints in rad, within [0, pi/4], ``(..., n - 1)``.
    """
    turned = line.phases - line.twists
    crossed = np.cos(2.0 * turned) < 0.0
    signs = np.cumprod(np.where(crossed, 1, -1), axis=-1)
    first = np.ones((*line.shape, 1), dtype=np.int64)
    off = turned - np.where(crossed, np.pi / 2.0, 0.0)
    return np.concatenate([first, signs], axis=-1), np.abs(off - np.pi * np.round(off / np.pi))

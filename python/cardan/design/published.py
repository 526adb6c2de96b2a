"""The bends of joints beside the limits that makers publish, joint by joint."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import ArrayLike

from cardan.arrays import FloatArray
from cardan.design.judged import VERDICTS, Finding, ranked, settled
from cardan.design.limits import PRESETS, Limit, Rule
from cardan.geometry.parameters import has_lengths

if TYPE_CHECKING:
    from cardan.driveline import Driveline

_RPM, _INCH = math.tau / 60.0, 0.0254

_WITHIN = VERDICTS.index("within")

# Of how many joints a rule is that is not of each.
_JOINTS = {"difference_deg": 2, "bend_by_length_deg": 2, "two_piece_deg": 3}


def published(
    line: Driveline, speed: FloatArray | None, presets: Sequence[str]
) -> Iterator[Finding]:
    """Yield bends beside the limits of some presets; a speed of 0 is not known."""
    for preset in presets:
        for rule in PRESETS[preset].on_bends:
            yield from _Judge(line, speed, preset, rule).found()


@dataclass(frozen=True)
class _Judge:
    """Judges drivelines by one rule."""

    line: Driveline
    speed: FloatArray | None
    preset: str
    rule: Rule

    def found(self) -> Iterator[Finding]:
        """Yield the figures that the rule limits."""
        rule, joints = self.rule, range(self.line.n_joints)
        needed = _JOINTS.get(rule.figure, len(joints))
        if len(joints) != needed:
            why = f"is that of {needed} joints; the driveline has {len(joints)}"
            nothing = np.full(self.line.shape, math.nan)
            yield self._one("bend_difference", joints, nothing, rule.limit, undecided=True, why=why)
        elif rule.figure == "difference_deg":
            yield self._difference(0, 1)
        elif rule.figure == "two_piece_deg":
            yield from self._two_piece()
        elif rule.figure == "bend_by_length_deg":
            yield from self._by_length()
        elif rule.over_speed:
            yield from self._over_speed()
        else:
            name = rule.figure.removesuffix("_deg")
            for joint in joints:
                yield self._one(name, (joint,), self._bends[..., joint], rule.limit)

    @property
    def _bends(self) -> FloatArray:
        return np.asarray(self.line.bends_deg)

    def _difference(self, i: int, j: int, within: ArrayLike | None = None) -> Finding:
        """The difference of two bends; that of equal ones has no tolerance that is known."""
        limit = self.rule.limit if within is None else within
        apart = settled(np.abs(self._bends[..., i] - self._bends[..., j]), "deg")
        if self.rule.is_exact:
            why = "should be 0 by a source that gives no tolerance"
            undecided = (apart > 0.0) & ~np.isnan(limit)
            return self._one("bend_difference", (i, j), apart, limit, undecided=undecided, why=why)
        return self._one("bend_difference", (i, j), apart, limit)

    def _two_piece(self) -> Iterator[Finding]:
        """The bend of the odd joint, and the difference of the two others.

        The odd one is that without which the others are nearest to equal, of those that may be it;
        if none may, it is the one that is bent least.
        """
        bends, joints = self._bends, range(3)
        others = np.abs(np.roll(bends, 1, axis=-1) - np.roll(bends, -1, axis=-1))
        may_be = ranked(bends, self.rule.limit) == _WITHIN
        odd = np.argmin(np.where(may_be, others, 180.0 + bends), axis=-1)
        for joint in joints:
            limit = np.where(odd == joint, self.rule.limit, math.nan)
            yield self._one("bend", (joint,), bends[..., joint], limit)
        for i, j in combinations(joints, 2):
            yield self._difference(i, j, np.where(odd == 3 - i - j, 0.0, math.nan))

    def _over_speed(self) -> Iterator[Finding]:
        """The bend of each joint, of which more is allowed at a lower speed."""
        rule = self.rule
        speeds, angles = np.array(rule.over_speed).T
        rpm = np.abs(np.asarray(0.0 if self.speed is None else self.speed)) / _RPM
        # With the acceleration that the angles stand for, bend times speed is as good as constant.
        inside = np.clip(rpm, speeds[0], speeds[-1])
        most = _up(np.interp(inside, speeds, angles * speeds) / inside)
        limit = np.minimum(rule.limit, most)
        why = f"has no limit above {speeds[-1]:g} rpm, where the source ends"
        if not np.any(rpm):
            why = "needs a speed, and the scene gives none"
        for joint in range(self.line.n_joints):
            bend = self._bends[..., joint] + 0.0 * rpm
            # At rest what holds at any speed holds, and more bend needs a speed.
            at_any = np.isfinite(rule.limit) & (ranked(bend, rule.limit) == _WITHIN)
            is_above = ranked(rpm, speeds[-1]) != _WITHIN
            unknown = is_above | ((rpm == 0.0) & ~at_any)
            undecided = unknown & (ranked(bend, most) == _WITHIN)
            yield self._one("bend", (joint,), bend, limit, most, undecided=undecided, why=why)

    def _by_length(self) -> Iterator[Finding]:
        """The bend of both joints of a shaft, which may be more of a longer one."""
        assert self.rule.maximum is not None
        # Bends in opposite senses make the axes parallel, as far as they are equal.
        is_parallel = np.cos(self.line.twists[..., 0]) < 0.0
        per_degree = np.where(is_parallel, self.rule.limit, self.rule.maximum)
        limit, why = np.full(self.line.shape, math.nan), "needs the length of the shaft"
        if is_known := has_lengths(self.line):
            limit = _up(self.line._geometry.lengths[..., 1] / (_INCH * per_degree))
        for joint in range(2):
            bend = self._bends[..., joint]
            yield self._one("bend", (joint,), bend, limit, undecided=not is_known, why=why)

    def _one(
        self,
        figure: str,
        joints: Sequence[int],
        value: FloatArray,
        limit: ArrayLike,
        maximum: ArrayLike | None = None,
        *,
        undecided: ArrayLike = False,
        why: str = "",
    ) -> Finding:
        item = f"joint {joints[0]}"
        if len(joints) > 1:
            item = f"joints {'-'.join(map(str, joints))}"
        limits, maxima = (
            np.broadcast_to(np.asarray(bound, float), value.shape)
            for bound in (limit, limit if maximum is None else maximum)
        )
        return Finding(
            figure,
            f"{figure.replace('_', ' ')} of {item} by {PRESETS[self.preset].title}",
            "published",
            value,
            "deg",
            Limit(math.nan, math.nan, self.rule.cited),
            most=figure != "least_bend",
            limits=limits,
            maxima=maxima,
            undecided=np.broadcast_to(np.asarray(undecided), value.shape),
            why=why,
            preset=self.preset,
            item=item,
        )


def _up(degrees: FloatArray) -> FloatArray:
    """Round up to hundredths, so that 8° 40' may be given as 8.67°."""
    return np.asarray(np.ceil(100.0 * degrees - 1e-6) / 100.0)

"""Whether a driveline keeps the limits of the catalogues and of workshop practice."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cardan import notebook
from cardan.approximations import (
    INERTIA_LIMIT,
    INERTIA_MAXIMUM,
    TORSIONAL_LIMIT,
    TORSIONAL_MAXIMUM,
)
from cardan.arrays import FloatArray, as_float64, common_shape
from cardan.equivalent import EquivalentJoint

_MAX_BEND_DEG = 3.0

MAX_EQUIVALENT_BEND = np.radians(_MAX_BEND_DEG)
"""Largest equivalent bend that the catalogues permit (003, section 6.4), in rad."""

MAX_NON_UNIFORMITY = 0.0027
"""The non-uniformity from which that bend is derived."""


# Less than this share of a limit is what rounding leaves of joints that cancel each other.
_ROUNDING = 1e-6


@dataclass(frozen=True, eq=False)
class Finding:
    """One figure beside its limits.

    Attributes:
        name: what it is.
        value: the figure, batch-shaped, in ``unit``.
        limit: what it should not exceed.
        maximum: what it must never exceed.
        unit: of all three.
        worst_at: in a study, the keys on which the largest value depends and their values there.
    """

    name: str
    value: FloatArray
    limit: float
    maximum: float
    unit: str
    worst_at: Mapping[str, float] = field(default_factory=dict)

    @property
    def passes(self) -> NDArray[np.bool_]:
        """Whether the limit is kept; NaN does not pass."""
        return np.asarray(self.value <= self.limit)

    def __str__(self) -> str:
        """Say it in words."""
        worst = float(np.max(self.value)) if np.size(self.value) else 0.0
        unit = f" {self.unit}" if self.unit != "1" else ""
        if worst <= self.limit:
            verdict = f"keeps the limit of {self.limit:g}{unit}"
        elif worst > self.limit:
            verdict = f"is above the limit of {self.limit:g}{unit}"
            if self.maximum > self.limit:
                side = "but below" if worst <= self.maximum else "and the maximum of"
                verdict += f" {side} {self.maximum:g}{unit}"
        else:
            verdict = "is not a number"
        if worst < _ROUNDING * self.limit:
            worst = 0.0
        if np.ndim(self.value) == 0:
            return f"{self.name} {worst:.4g}{unit} {verdict}"
        kept = f"{np.count_nonzero(self.passes)} of {np.size(self.value)} keep the limit"
        keys = ", ".join(f"{key} = {value:.6g}" for key, value in self.worst_at.items())
        # Rounding is as large here as there.
        place = f" (at {keys})" if keys and worst else ""
        return f"{self.name} up to {worst:.4g}{unit}{place} {verdict}; {kept}"


@dataclass(frozen=True, eq=False)
class Check:
    """What a check found; ``print`` it to read it.

    The check of one driveline at one speed is true if it passes: ``if line.check(): ...``. That of
    a batch has no single answer and raises; use ``check.passes.all()`` or ``check.passes.any()``.

    Attributes:
        findings: one per figure.
    """

    findings: tuple[Finding, ...]

    @property
    def passes(self) -> NDArray[np.bool_]:
        """Whether every limit is kept, in the shape of batch and speed."""
        passes = np.broadcast_arrays(*(finding.passes for finding in self.findings))
        return np.asarray(np.all(passes, axis=0))

    def __bool__(self) -> bool:
        """Return whether it passes.

        Raises:
            ValueError: a check of a batch.
        """
        passes = self.passes
        if passes.shape:
            raise ValueError(
                f"the check has a verdict for each of {passes.size} drivelines or speeds, not one; "
                "use check.passes.all() or check.passes.any()"
            )
        return bool(passes)

    def __str__(self) -> str:
        """Say it in words, the verdict first."""
        count, all_of_them = np.count_nonzero(self.passes), self.passes.size
        verdict = "The driveline passes." if count else "The driveline does not pass."
        if self.passes.shape:
            verdict = f"{count} of {all_of_them} pass."
        return "\n".join([verdict, *(f"- {f}" for f in self.findings)])

    def _repr_html_(self) -> str:
        """Show the verdict and a row for each finding."""
        verdict, *findings = str(self).splitlines()
        rows = [(finding.removeprefix("- "),) for finding in findings]
        return notebook.table(verdict, ("finding",), rows)


class Checkable(Protocol):
    """What a check needs of a driveline."""

    @property
    def n_joints(self) -> int:
        """Number of joints."""

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the batch."""

    def equivalent(self, shaft: int = -1) -> EquivalentJoint:
        """Return the joint that moves a shaft as the whole chain does."""

    def reversed(self) -> Checkable:
        """Return the driveline driven from its other end."""


def check(line: Checkable, speed: ArrayLike | None = None) -> Check:
    """Check as ``Driveline.check`` does."""
    last = line.equivalent()
    findings = [
        Finding(
            "equivalent bend",
            np.degrees(last.bend),
            _MAX_BEND_DEG,
            _MAX_BEND_DEG,
            "deg",
        ),
        Finding("non-uniformity", last.non_uniformity, MAX_NON_UNIFORMITY, MAX_NON_UNIFORMITY, "1"),
    ]
    if speed is not None:
        squared = as_float64("speed", speed) ** 2
        common_shape(driveline=line.shape, speed=squared.shape)
        findings += [
            Finding(
                "torsional excitation of the last shaft",
                squared * last.max_acceleration_ratio,
                TORSIONAL_LIMIT,
                TORSIONAL_MAXIMUM,
                "rad/s²",
            ),
            *(
                Finding(
                    f"inertia excitation of the shafts between, {name}",
                    squared * _inertia_excitation(way),
                    INERTIA_LIMIT,
                    INERTIA_MAXIMUM,
                    "rad/s²",
                )
                for name, way in (("driving", line), ("coasting", line.reversed()))
                if line.n_joints > 1
            ),
        ]
    return Check(tuple(findings))


def _inertia_excitation(line: Checkable) -> FloatArray:
    """Second-order amplitude of the accelerations of all intermediate shafts together.

    Practice sums ``(n - i) theta_i**2`` with signs over the joints ``i``: every joint shakes each
    intermediate shaft behind it. In space the parts add as vectors, and ``4 k`` is the exact
    second-order amplitude of a shaft's acceleration where practice writes ``theta**2``.
    """
    total = np.zeros(line.shape, dtype=np.complex128)
    for shaft in range(1, line.n_joints):
        joint = line.equivalent(shaft)
        total = total + 4.0 * joint.k * np.exp(2j * joint.angle_offset)
    return np.abs(total)

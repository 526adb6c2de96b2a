"""The setting of the yokes that brings the last shaft closest to constant velocity.

The core searches it, alone or in common for states such as ride heights; this module reads the
arguments.
"""

from __future__ import annotations

import operator
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cardan import _core
from cardan.arrays import FloatArray, shares_of, threads
from cardan.arrays.errors import ArgumentTypeError, ArgumentValueError, check_shape, require

if TYPE_CHECKING:
    from cardan.driveline import Driveline


Arrangement = Literal["straight", "single bend", "W", "Z", "planar", "spatial"]

# Angles below this, in rad, are rounding of the points of a drawing.
_STRAIGHT = 1e-6


def optimal_phases(
    line: Driveline,
    *,
    states: int | None = None,
    weights: ArrayLike | None = None,
    teeth: int | Sequence[int] | None = None,
    fixed: int | Sequence[int] | None = None,
    degrees: bool = False,
) -> FloatArray:
    """Return the phases ``(..., n - 1)`` that bring the last shaft closest to constant velocity.

    With ``L = ln sec(bend)`` exact constant velocity is possible if and only if the largest
    ``L`` is not more than all others together; then these phases reach it. Otherwise they line
    all joints up against the largest, which leaves the least possible equivalent bend. Of all
    such phases they are those to which the yokes turn least from their present ones (least sum
    of squares; with four or more bent joints least within their neighbourhood).

    Two joints at ``p = phase - twist + 90°`` make ``cosh L = cosh L_1 cosh L_2 + sinh L_1 sinh
    L_2 cos 2p`` (from Thoma 4), the law of cosines of the hyperbolic plane, where constant
    velocity is a closed polygon of sides ``L``.

    With ``states``, ``teeth`` or ``fixed`` they minimise the weighted mean of ``k**2 =
    tan(bend/2)**4`` of the equivalent joint over the states: exact derivatives and several
    starts, because settings have many local minima.

    Args:
        states: an axis of the batch whose drivelines are the states of one driveline, such as
            ride heights, and share one setting. It is missing from the result, which broadcasts
            in ``with_phases`` if it is axis 0.
        weights: how much each state counts, ``(states,)``; by default all alike.
        teeth: of the spline of each shaft between two joints, ``(n - 1,)`` or one for all; the
            phases are then those that teeth permit, counted from the present ones. All
            combinations are compared up to 65 536, beyond that the nearest to good phases.
        fixed: shafts, counted from 0, whose yokes stay as they are.
        degrees: whether to return the phases in degrees.

    Raises:
        TypeError: an axis, teeth or shafts that are not integers.
        ValueError: an axis or a shaft that does not exist, weights or teeth that do not fit,
            teeth or fixed shafts whose present phases differ between the states.
    """
    line._geometry.check_ideal(
        "best phases follow from one equivalent joint, which exists",
        "cardan.optimise minimises an output as built, such as 'angle_error_peak'",
    )
    if states is weights is teeth is fixed is None:
        bends, twists, now, *_ = line._geometry.flat()
        best = _core.optimal_phases(line.n_joints, bends, twists, now, threads.at_most(None))
        phases = best.reshape(line.phases.shape)
    else:
        phases = _common_phases(line, states, weights, teeth, fixed)
    return np.degrees(phases) if degrees else phases


def arrangement(line: Driveline) -> Arrangement:
    """Return the name of how the joints of one driveline are arranged.

    Straight joints do not count: the twists on both sides of one add up. Angles below 1e-6 rad are
    rounding of the points of a drawing.

    Returns:
        ``"straight"`` without a bent joint and ``"single bend"`` with one; with two whose bends lie
        in one plane ``"W"`` if these have the same direction and ``"Z"`` if opposite ones;
        ``"planar"`` with more bends in one plane, otherwise ``"spatial"``.

    Raises:
        ValueError: a batch of drivelines.
    """
    check_shape("driveline", line, not line.shape, "an arrangement is that of one driveline")
    bent = np.flatnonzero(line.bends > _STRAIGHT)
    if len(bent) < 2:
        return "single bend" if len(bent) else "straight"
    twists = np.diff(np.concatenate([[0.0], np.cumsum(line.twists)])[bent])
    if np.any(np.abs(np.sin(twists)) > _STRAIGHT):
        return "spatial"
    if len(bent) > 2:
        return "planar"
    return "W" if np.cos(twists[0]) > 0.0 else "Z"


def bend_ranges(line: Driveline, limit: float) -> FloatArray:
    """Return the bends of each joint with which the best phases can keep an equivalent bend.

    All other bends are as they are. With ``L = ln sec(bend)`` the least equivalent bend has ``L``
    equal to that by which the largest exceeds all others together; the ends follow without search.

    Args:
        limit: of the equivalent bend, in rad.

    Returns:
        least and largest bend of each joint in rad, ``(..., n, 2)``.
    """
    lengths, reach = -np.log(np.cos(line.bends)), -np.log(np.cos(limit))
    ends = []
    for joint in range(line.n_joints):
        others = np.delete(lengths, joint, axis=-1)
        total, longest = np.sum(others, axis=-1), np.max(others, axis=-1, initial=0.0)
        ends.append(np.stack([2.0 * longest - total - reach, total + reach], axis=-1))
    return np.asarray(np.arccos(np.exp(-np.maximum(np.stack(ends, axis=-2), 0.0))))


def _common_phases(
    line: Driveline,
    states: int | None,
    weights: ArrayLike | None,
    teeth: int | Sequence[int] | None,
    fixed: int | Sequence[int] | None,
) -> FloatArray:
    """One setting for all states; arguments and errors as of ``optimal_phases``."""
    if states is None:
        if weights is not None:
            problem = "needs states, the axis of the batch that it weighs"
            raise ArgumentValueError("weights", problem)
        batch, axis = (*line.shape, 1), len(line.shape)
    else:
        batch, axis = line.shape, _axis(line, states)
    count = batch[axis]
    require("states", count, f"is {states}; that axis of the batch is empty")
    weighing = shares_of(weights, count)
    held = _held(fixed, line.n_joints)
    counts = [] if teeth is None else _teeth(teeth, line.n_joints - 1)
    rows = line.size // count
    bends, twists, present = (
        np.moveaxis(array.reshape(*batch, each), axis, -2).reshape(rows, count, each)
        for array in (line.bends, line.twists, line.phases)
        for each in array.shape[-1:]
    )
    _check_common(present, held, toothed=teeth is not None)
    found = _core.common_phases(
        line.n_joints,
        bends.ravel(),
        twists.ravel(),
        present.ravel(),
        weighing,
        held.tolist(),
        counts,
        threads.at_most(None),
    )
    return found.reshape(*batch[:axis], *batch[axis + 1 :], line.n_joints - 1)


def _axis(line: Driveline, states: Any) -> int:  # noqa: ANN401 - checked here
    try:
        axis = operator.index(states)
    except TypeError:
        problem = f"is {states!r}; it must be the number of an axis of the batch"
        raise ArgumentTypeError("states", problem) from None
    if not -len(line.shape) <= axis < len(line.shape):
        raise ArgumentValueError("states", f"is {axis}; the batch has shape {line.shape}")
    return axis % len(line.shape)


def _held(fixed: int | Sequence[int] | None, n_joints: int) -> NDArray[np.bool_]:
    held = np.zeros(n_joints - 1, dtype=bool)
    try:
        shafts = [] if fixed is None else [operator.index(shaft) for shaft in np.atleast_1d(fixed)]
    except TypeError:
        raise ArgumentTypeError("fixed", f"is {fixed!r}; it must list numbers of shafts") from None
    for shaft in shafts:
        problem = f"is {shaft}; shafts 1 to {n_joints - 1} have yokes at both ends"
        require("fixed", 0 < shaft < n_joints, problem)
        held[shaft - 1] = True
    return held


def _teeth(teeth: int | Sequence[int], shafts: int) -> list[int]:
    try:
        counts = [operator.index(count) for count in np.atleast_1d(teeth)]
    except TypeError:
        problem = f"is {teeth!r}; it must be a whole number or one per shaft"
        raise ArgumentTypeError("teeth", problem) from None
    if np.ndim(teeth) and len(counts) != shafts:
        problem = f"has length {len(counts)}; it must be {shafts}, one per shaft between two joints"
        raise ArgumentValueError("teeth", problem)
    for i, count in enumerate(counts):
        if count < 1:
            place = (i,) if np.ndim(teeth) else ()
            raise ArgumentValueError("teeth", f"is {count}; a spline has at least 1 tooth", place)
    return counts if np.ndim(teeth) else counts * shafts


def _check_common(present: FloatArray, held: NDArray[np.bool_], *, toothed: bool) -> None:
    """Refuse present phases that differ over the states where the answer is counted from them."""
    off = present - present[:, :1]
    off -= np.pi * np.round(off / np.pi)
    for shaft in np.flatnonzero(np.any(np.abs(off) > 1e-12, axis=(0, 1))):
        if held[shaft] or toothed:
            problem = f"needs one present phase of shaft {shaft + 1}; it differs between the states"
            raise ArgumentValueError("fixed" if held[shaft] else "teeth", problem)

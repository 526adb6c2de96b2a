"""One figure of a driveline beside its limit: the verdict, the margin and both in words."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cardan import _core
from cardan.arrays import FloatArray, as_float64
from cardan.design.limits import Limit

VERDICTS = ("not judged", "within", "tolerable", "unknown", "beyond")
"""Verdicts from the best to the worst."""

LimitVerdict: TypeAlias = Literal["within", "beyond", "not judged"]
"""On a limit without a maximum; ``not judged`` where there is none."""

# The verdicts by the ranks of the core.
_OF_RANK = np.array(
    [VERDICTS.index(name) for name in ("not judged", "within", "tolerable", "beyond")]
)

# Less than this is what rounding leaves of joints that cancel each other.
_NEGLIGIBLE = {"deg": 3e-6, "rad/s²": 3e-4}

# Among ranks: of several places one that is not decided counts more than a tolerable one.
_UNDECIDED = 2.5

_RPM = math.tau / 60.0


def ranked(
    value: ArrayLike,
    limit: ArrayLike,
    maximum: ArrayLike | None = None,
    *,
    most: bool = True,
    size: float = 0.0,
) -> NDArray[np.int_]:
    """Return how figures stand to their limits, in ``VERDICTS``; the core has the rule.

    A limit of NaN is none, the maximum is by default the limit. Both are the most that a figure may
    be, or the least. The size of what is judged counts for limits near 0.
    """
    given = (value, limit, limit if maximum is None else maximum)
    spread = np.broadcast_arrays(*(as_float64("value", x) for x in given))
    values, limits, maxima = (np.ravel(x) for x in spread)
    found = _OF_RANK[_core.ranks(values, limits, maxima, most, size)]
    found[np.isnan(values) & ~np.isnan(limits)] = VERDICTS.index("unknown")
    return found.reshape(spread[0].shape)


def is_within(value: float, limit: float, *, most: bool = True, size: float = 0.0) -> bool:
    """Return whether a value keeps a limit; arguments as of ``ranked``. NaN does not."""
    return bool(ranked(value, limit, most=most, size=size) == VERDICTS.index("within"))


def settled(values: FloatArray, unit: str) -> FloatArray:
    """Return figures in a unit of findings, with 0 for what rounding leaves."""
    return np.where(np.abs(values) < _NEGLIGIBLE[unit], 0.0, values)


def worst_of(verdicts: Iterable[LimitVerdict]) -> LimitVerdict:
    """Return the worst of some verdicts, of which there is at least one."""
    return max(verdicts, key=VERDICTS.index)


def non_uniformity(bend_deg: float) -> float:
    """Return the non-uniformity of a joint, ``tan(bend) sin(bend)``."""
    bend = math.radians(bend_deg)
    return math.tan(bend) * math.sin(bend)


@dataclass(frozen=True, eq=False)
class Finding:
    """One figure beside its limit.

    Attributes:
        figure: what it is, for programs: ``"torsional_excitation"``.
        name: what it is, in words.
        group: who sets the limit: the catalogues of driveshafts, the practice with a kind of
            machine, or a maker that publishes how far joints may be bent.
        value: the figure, batch-shaped, in ``unit``; NaN where it needs a speed and has none.
        unit: of figure and limits.
        limit: its limit, if there is one.
        at_unit_speed: for a figure that grows with the square of the speed, what it is at 1 rad/s.
        needs_speed: whether the speed that it needs is missing.
        worst_at: in a study, the keys on which the largest value depends and their values there.
        worst_in: over states, the name of the state with the largest value.
        most: whether the limit is the most that the value may be, or the least.
        limits: the limit of each value, where they are not the same for all; NaN where the rule is
            not about it. ``limit`` then has the source alone.
        maxima: the maximum likewise.
        undecided: where it is not known whether the limit is kept, in the shape of the value.
        why: why that is so.
        preset: of which preset the limit is, if the figure is judged for that alone.
        item: the joints that the figure is of.
    """

    figure: str
    name: str
    group: Literal["catalogue", "practice", "published"]
    value: FloatArray
    unit: str
    limit: Limit | None = None
    at_unit_speed: FloatArray | None = None
    needs_speed: bool = False
    worst_at: Mapping[str, float] = field(default_factory=dict)
    worst_in: str = ""
    most: bool = True
    limits: FloatArray | None = None
    maxima: FloatArray | None = None
    undecided: NDArray[np.bool_] = field(default_factory=lambda: np.zeros((), bool))
    why: str = ""
    preset: str = ""
    item: str = ""

    @property
    def there(self) -> Limit | None:
        """The limit where the figure is worst."""
        if self.limit is None or self.limits is None or self.maxima is None:
            return self.limit
        place = self.worst_place
        limit, maximum = (float(np.ravel(each)[place]) for each in (self.limits, self.maxima))
        return Limit(limit, maximum, self.limit.source)

    @property
    def worst_place(self) -> int:
        """The place in the flat value of the one with the worst verdict, by which it is largest."""
        value = np.ravel(self.value)
        if self.maxima is None:
            return int(np.argmax(value))
        order = np.ravel(self.ranks).astype(float)
        order[np.ravel(self.undecided)] = _UNDECIDED
        with np.errstate(divide="ignore", invalid="ignore"):
            share = value / np.ravel(self.maxima) if self.most else -value
        return int(np.argmax(np.where(order == order.max(), np.nan_to_num(share), -math.inf)))

    @property
    def applies(self) -> bool:
        """Whether its limit is about any of the values, or could be."""
        return self.limits is None or not (np.isnan(self.limits) & ~self.undecided).all()

    @property
    def is_undecided(self) -> bool:
        """Whether it is not known, where the figure is worst, whether the limit is kept."""
        return bool(self.undecided.any() and np.ravel(self.undecided)[self.worst_place])

    @property
    def ranks(self) -> NDArray[np.int_]:
        """The verdicts as positions in ``VERDICTS``, in the shape of ``value``; larger is worse."""
        value = np.asarray(self.value)
        if self.limit is None or self.needs_speed:
            return np.zeros(value.shape, dtype=int)
        if self.limits is None:
            return ranked(value, self.limit.limit, self.limit.maximum)
        found = ranked(value, self.limits, self.maxima, most=self.most)
        found[self.undecided] = VERDICTS.index("not judged")
        return found

    @property
    def verdict(self) -> NDArray[np.str_]:
        """``"within"``, ``"tolerable"`` or ``"beyond"``, in the shape of the value.

        NaN gives ``"unknown"``, and a figure without a limit or without its speed ``"not judged"``.
        """
        return np.asarray(np.array(VERDICTS)[self.ranks])

    @property
    def passes(self) -> NDArray[np.bool_]:
        """Whether the figure is not beyond its maximum, in the shape of ``value``; NaN is."""
        return np.asarray(self.ranks <= VERDICTS.index("tolerable"))

    @property
    def margin(self) -> FloatArray:
        """Margin to the limit, in ``unit`` and in the shape of ``value``.

        It is negative above the limit, and NaN without one.
        """
        bound = math.nan if self.limit is None else self.limit.limit
        left = (bound if self.limits is None else self.limits) - self.value
        return np.asarray(left if self.most else -left)

    @property
    def within_up_to(self) -> FloatArray:
        """Speed of the drive in rad/s up to which the figure is within its limit.

        It is infinite where no speed reaches the limit, and NaN without a limit and for figures
        that do not depend on the speed.
        """
        return self._speed_at(math.nan if self.limit is None else self.limit.limit)

    @property
    def tolerable_up_to(self) -> FloatArray:
        """The same for its maximum."""
        return self._speed_at(math.nan if self.limit is None else self.limit.maximum)

    def _speed_at(self, bound: float) -> FloatArray:
        if self.at_unit_speed is None:
            return np.full(np.shape(self.value), math.nan)
        with np.errstate(divide="ignore"):
            return np.asarray(np.sqrt(bound / np.asarray(self.at_unit_speed)))

    @property
    def worst(self) -> float:
        """The largest value, or that with the worst verdict; 0 for what rounding leaves."""
        largest = float(np.ravel(self.value)[self.worst_place]) if np.size(self.value) else 0.0
        return 0.0 if largest < _NEGLIGIBLE[self.unit] else largest

    @property
    def value_text(self) -> str:
        """The value with its unit, or the largest of several."""
        if self.needs_speed or (self.is_undecided and math.isnan(self.worst)):
            return "unknown"
        return f"{'up to ' if np.ndim(self.value) else ''}{self._text(self.worst)}"

    @property
    def place(self) -> str:
        """Keys and values of a study at which the largest value occurs, else ``""``."""
        # Rounding is as large here as there.
        found = self.worst_at if self.worst or not self.most else {}
        return ", ".join(f"{key} = {value:.6g}" for key, value in found.items())

    @property
    def largest_text(self) -> str:
        """Place of the largest value, as ``"at bends_deg = 5"`` or ``"in rebound"``."""
        if self.worst_in:
            return f"in {self.worst_in}" if self.worst or not self.most else ""
        return f"at {self.place}" if self.place else ""

    @property
    def words(self) -> tuple[str, ...]:
        """Phrases after "is": verdict and margin, the speeds of the limits, numbers of a batch."""
        parts = [*self._verdict_words(), *self._speed_words()]
        if self.figure == "equivalent_bend" and self.limit and not math.isnan(self.worst):
            own, most = non_uniformity(self.worst), non_uniformity(self.limit.limit)
            parts.append(f"non-uniformity {own:.4g}, limit {most:.4g}")
        if np.ndim(self.value) and self.limit and not self.needs_speed:
            parts.append(counted(self.ranks))
        return tuple(parts)

    def _verdict_words(self) -> list[str]:
        found = self.there
        if found is None:
            return ["not judged, no limit given"]
        if self.needs_speed:
            return ["not judged, no speed given"]
        if self.is_undecided:
            return [f"not judged, {self.why}"]
        text, limit, maximum, worst = self._text, found.limit, found.maximum, self.worst
        if math.isnan(worst):
            return ["not a number"]
        verdict = VERDICTS[int(np.max(self.ranks))] if np.size(self.value) else "within"
        sign, side, other = (1.0, "above", "below") if self.most else (-1.0, "below", "above")
        past, left = sign * (worst - limit), sign * (maximum - worst)
        if verdict == "within":
            below = text(max(sign * (limit - worst), 0.0))
            return [f"{below} {other} the {text(limit)} limit"]
        if verdict == "tolerable":
            above = f"{text(past)} {side} the {text(limit)} limit"
            below = f"{text(max(left, 0.0))} {other} the {text(maximum)} maximum"
            return [f"tolerable, {above} and {below}"]
        bound = "maximum" if maximum != limit else "limit"
        return [f"{text(-left)} {side} the {text(maximum)} {bound}"]

    def _speed_words(self) -> list[str]:
        if self.limit is None or self.at_unit_speed is None or not np.size(self.at_unit_speed):
            return []
        both = (self.within_up_to, self.tolerable_up_to)
        within, tolerable = (float(np.min(speeds)) / _RPM for speeds in both)
        if math.isnan(within):
            return []
        # Rounding noise is reached at no speed of a machine.
        if within > 1e7:
            return ["within at every speed"]
        more = f", tolerable up to {_rpm(tolerable)}" if tolerable > within else ""
        return [f"within up to {_rpm(within)}{more}"]

    def _text(self, value: float) -> str:
        return f"{value:.4g}°" if self.unit == "deg" else f"{value:.4g} {self.unit}"

    def __str__(self) -> str:
        """Return the figure with its verdict and source as text."""
        place = f" ({self.largest_text})" if self.largest_text else ""
        source = f" ({self.limit.source})" if self.limit else ""
        return f"{self.name} {self.value_text}{place} is {'; '.join(self.words)}{source}"


def counted(ranks: NDArray[np.int_], within: str = "within") -> str:
    """Say how many of several drivelines have each verdict: ``"341 of 513 within, 172 beyond"``."""
    if ranks.size and not ranks.any():
        return VERDICTS[0]
    numbers = {VERDICTS[rank]: int(np.count_nonzero(ranks == rank)) for rank in (1, 2, 3, 4)}
    first = f"{numbers.pop('within')} of {ranks.size} {within}"
    return ", ".join([first, *(f"{count} {name}" for name, count in numbers.items() if count)])


def _rpm(speed: float) -> str:
    """A speed in rpm, rounded down: at what is printed the limit is not yet exceeded."""
    return f"{math.floor(speed)} rpm" if speed >= 10.0 else f"{math.floor(speed * 100) / 100:g} rpm"

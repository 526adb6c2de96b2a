"""The drive angles of a scene, swept or recorded, and the bends recorded with them."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from cardan.arrays import FloatArray
from cardan.errors import ArgumentValueError
from cardan.files.recording import place_of, read_columns
from cardan.scene.format import BEND_COLUMNS, FORMAT
from cardan.scene.rules import shown
from cardan.sweep import Sweep

_MOST_STEPS = 10_000_000


@dataclass(frozen=True, eq=False)
class Angles:
    """Drive angles, and the bends recorded with them.

    A sample of which a recorded number is missing has a drive angle of NaN.

    Attributes:
        degrees: the angles in degrees, for tables and pictures.
        drive: the same for evaluating: a sweep, or recorded angles in rad.
        to_reduce: those of them to take figures over.
        bends: bends recorded with the angles, in degrees, if any.
        bends_to_reduce: those of them that go with the angles to reduce.
    """

    degrees: FloatArray
    drive: FloatArray | Sweep
    to_reduce: FloatArray | Sweep
    bends: FloatArray | None = None
    bends_to_reduce: FloatArray | None = None

    @classmethod
    def swept(cls, values: Mapping[str, Any]) -> Self:
        """Take the keys of the section [sweep]."""
        keys = FORMAT["sweep"].keys
        turns, per_turn, start = (
            values.get(key, keys[key].default) for key in ("turns", "samples_per_turn", "start_deg")
        )
        # Cut off, because no float holds every whole number of the file.
        held = min(per_turn, 1 << 60)
        if turns * held > _MOST_STEPS:
            raise ArgumentValueError(
                "samples_per_turn",
                f"is {shown(per_turn)} over turns = {turns:g}; "
                f"a sweep takes at most {_MOST_STEPS} steps",
            )
        return cls.uniform(turns, held, start)

    @classmethod
    def uniform(cls, turns: float, per_turn: int, start_deg: float) -> Self:
        """Take equal steps over some turns, both ends included."""
        steps = max(1, round(turns * per_turn))
        # Dividing last keeps round degrees round.
        degrees: FloatArray = start_deg + 360.0 * turns * np.arange(steps + 1) / steps
        # Whole turns of samples at exact parts of a turn repeat and are computed once.
        exact = start_deg == 0.0 and per_turn <= _MOST_STEPS and steps / per_turn == turns

        def sweep(count: int) -> Sweep:
            if exact:
                return Sweep.revolutions(count / per_turn, per_turn)
            return Sweep(math.radians(degrees[0]), math.radians(degrees[count - 1]), count)

        # The last angle of whole turns is the first one again: in a mean it would count twice.
        whole = float(turns).is_integer()
        return cls(degrees, sweep(steps + 1), sweep(steps if whole else steps + 1))

    @classmethod
    def recorded(cls, values: Mapping[str, Any], folder: Path) -> Self:
        """Read the file of the section [angles]."""
        return cls.of(values, folder, read_columns(folder / values["file"], cls.columns(values)), 0)

    @staticmethod
    def columns(values: Mapping[str, Any]) -> list[str]:
        """Return the columns that the section [angles] names, that of the angles first."""
        in_degrees = "angle_column_deg" in values
        angles = values["angle_column_deg" if in_degrees else "angle_column_rad"]
        return [angles, *_bend_columns(values)]

    @classmethod
    def of(
        cls, values: Mapping[str, Any], folder: Path, read: Sequence[FloatArray], first: int
    ) -> Self:
        """Take columns as they were read, from some row on."""
        column, *bend_columns = read
        end, unit = (math.pi / 2, "pi/2) rad") if BEND_COLUMNS[1] in values else (90.0, "90) deg")
        for name, bend in zip(_bend_columns(values), bend_columns, strict=True):
            wrong = np.flatnonzero((bend < 0.0) | (bend >= end))
            if wrong.size:
                file = folder / values["file"]
                where = place_of(file, first + int(wrong[0]))
                raise ValueError(
                    f"{file}: {where}, column {name!r} is {bend[wrong[0]]}; "
                    f"a bend must lie in [0, {unit}"
                )
        known: NDArray[np.bool_] = ~np.any(np.isnan(np.stack(read)), axis=0)
        if not known.all():
            column = np.where(known, column, np.nan)
            bend_columns = [_filled(bend, known) for bend in bend_columns]
        in_degrees = "angle_column_deg" in values
        radians = np.radians(column) if in_degrees else column
        degrees = column if in_degrees else np.degrees(column)
        bends = np.stack(bend_columns, -1) if bend_columns else None
        if bends is not None and BEND_COLUMNS[1] in values:
            bends = np.degrees(bends)
        of_known = None if bends is None else bends[known]
        return cls(degrees, radians, radians[known], bends, of_known)


def _filled(bend: FloatArray, known: NDArray[np.bool_]) -> FloatArray:
    """Bends of which those at missing samples are replaced by the last known ones.

    A driveline needs all its bends; that the sample is missing shows in its drive angle.
    """
    if not known.any():
        return np.zeros_like(bend)
    places = np.where(known, np.arange(bend.size), int(np.argmax(known)))
    return bend[np.maximum.accumulate(places)]


def _bend_columns(values: Mapping[str, Any]) -> list[str]:
    return next((values[key] for key in BEND_COLUMNS if key in values), [])

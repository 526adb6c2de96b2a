"""The drive angles of a scene, and what was recorded with them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any, Self

import numpy as np

from cardan.app.scene.language.rules import shown
from cardan.app.scene.recording.signals import Signal
from cardan.app.scene.sections.table import FORMAT
from cardan.arrays import FloatArray
from cardan.arrays.errors import ArgumentValueError
from cardan.driveline import Driveline
from cardan.evaluation.sweep import Sweep

_MOST_STEPS = 10_000_000


@dataclass(frozen=True, eq=False)
class Angles:
    """Drive angles, and what was recorded with them.

    A sample of which a recorded number is missing has a drive angle of NaN, and so have its time
    and its load.

    Attributes:
        degrees: the angles in degrees, for tables and pictures.
        drive: the same for evaluating: a sweep, or recorded angles in rad.
        to_reduce: those of them to take figures over.
        bends: bends recorded with the angles, in degrees, if any.
        bends_to_reduce: those of them that go with the angles to reduce.
        time: recorded times in s, if any.
        load: recorded values of the keys of [load], ``(samples,)`` each.
        load_to_reduce: those of them that go with the angles to reduce.
        signals: the extents of what was recorded besides angles and bends.
    """

    degrees: FloatArray
    drive: FloatArray | Sweep
    to_reduce: FloatArray | Sweep
    bends: FloatArray | None = None
    bends_to_reduce: FloatArray | None = None
    time: FloatArray | None = None
    load: Mapping[str, FloatArray] = field(default_factory=dict)
    load_to_reduce: Mapping[str, FloatArray] = field(default_factory=dict)
    signals: tuple[Signal, ...] = ()

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


ANGLE_OF = "angle_of"
"""The key of [output] that says of which shaft the angles are."""


def check_driven(recorded: Mapping[str, Any]) -> None:
    """Refuse recorded times with angles of the driven shaft.

    Raises:
        ValueError: there are some: the speed of the drive would follow from them.
    """
    if "time_column_s" in recorded:
        raise ArgumentValueError(
            ANGLE_OF,
            "is 'driven'; with time_column_s, speed and acceleration of the drive follow from "
            "angles of the drive",
        )


def at_drive(angle: Angles, line: Driveline) -> Angles:
    """Return the drive angles of a scene whose angles are those of the last shaft.

    Those to reduce over stay as they are: in a study, they belong to other drive angles for each
    driveline.
    """
    drive = line.evaluate(angle.drive, "angle", shafts=0, angle_of="driven").drive_angle
    return replace(angle, degrees=np.degrees(drive), drive=drive)

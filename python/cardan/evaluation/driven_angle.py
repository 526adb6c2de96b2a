"""Plans that take the angle of the last shaft in place of the drive angle.

A chain takes the direction ``w = exp(i a)`` of the drive's pin to ``A w + B conj(w)``. With ``q =
B/A`` the mean-synchronous angle of the last shaft is ``a + arg(1 + q exp(-2 i a))`` (from Thoma 4).
Its inverse has the same form with ``-q``. That is the same chain with its drive a quarter turn
ahead, because ``i w`` goes to ``i (A w - B conj(w))``. A straight joint before the chain turns the
drive so. The inverse is therefore a driveline like any other, and nothing is iterated.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cardan.arrays import FloatArray, array_namespace_of
from cardan.arrays.errors import ArgumentValueError
from cardan.arrays.libraries import LIBRARIES
from cardan.evaluation.plan import Plan
from cardan.evaluation.request import Request, checked_choice
from cardan.evaluation.result import Result
from cardan.evaluation.sweep import Sweep

if TYPE_CHECKING:
    from cardan.driveline import Driveline


class DrivenPlan(Plan):
    """A plan that is called with angles of the last shaft; made by ``Driveline.plan``.

    The ``drive_angle`` of a result is the drive angle that belongs to each of them.
    """

    __slots__ = ("_at_drive", "_drive_angle")

    def __init__(self, at_drive: Plan) -> None:
        """Keep the plan that is called with drive angles."""
        line, request = at_drive.line, at_drive.request
        super().__init__(line, request)
        self.request = self.request._replace(angle_of="driven")
        self._at_drive = at_drive
        inverted = Request("angle", tolerance=0.0, workers=request.workers)
        self._drive_angle = Plan(inverse(line), inverted)

    def __call__(
        self, angle: ArrayLike | Sweep, out: Mapping[str, NDArray[Any]] | None = None
    ) -> Result:
        """Evaluate at angles of the last shaft.

        The drive angles are stored, also if the outputs are reduced.

        Args:
            angle: mean-synchronous angles of the last shaft in rad, as the output ``angle`` has
                them; otherwise as for any plan.
            out: arrays to fill, by output name.

        Raises:
            TypeError, ValueError, MemoryError, RuntimeError: as of any plan.
        """
        if (name := array_namespace_of(angle)) and LIBRARIES[name].wraps:
            if self.line.shape:
                raise ArgumentValueError(
                    "angle",
                    "has labels, and each driveline of the batch has different drive angles; "
                    "give its values",
                )
            return super().__call__(angle, out)
        return self._at_drive(self._drive_angles(angle), out)

    def _drive_angles(self, angle: ArrayLike | Sweep) -> Any:  # noqa: ANN401 - an array
        return self._drive_angle(angle)["angle"]

    def _again(self, line: Driveline, request: Request) -> Plan:
        """Return a plan of the same kind for another request."""
        return DrivenPlan(self._at_drive._again(line, request))

    def explain(self, angle: ArrayLike | Sweep | None = None) -> str:
        """Return the steps for the drive angles and for the outputs, as ``Plan.explain`` does."""
        shape: Any = angle
        if isinstance(angle, Sweep):
            shape = np.broadcast_to(0.0, np.broadcast_shapes(self.line.shape, angle.shape))
        drive, outputs = self._drive_angle.explain(angle), self._at_drive.explain(shape)
        return f"drive angles from angles of the last shaft\n{drive}\n{outputs}"

    def __reduce__(self) -> tuple[Any, ...]:
        """Pickle as the plan that is called with drive angles."""
        return (DrivenPlan, (self._at_drive,))


def planned(line: Driveline, request: Request) -> Plan:
    """Return the plan of a driveline for a request.

    Raises:
        IndexError, TypeError, ValueError: as there.
    """
    axes, angle_of = request.axes, request.angle_of
    if axes == "space" and angle_of == "drive":
        return Plan(line, request)
    line._geometry.check_ideal(
        'axes="shaft" and angle_of="driven" are', "use the axes of space and the drive angle"
    )
    checked_choice("axes", axes, ("space", "shaft"))
    checked_choice("angle_of", angle_of, ("drive", "driven"))
    plan = Plan(line, request)
    return DrivenPlan(plan) if angle_of == "driven" else plan


def inverse(line: Driveline) -> Driveline:
    """Return the driveline whose last shaft turns as the drive if driven as this one's last shaft.

    It has the bends, twists and phases of the line behind a straight joint.
    """

    def behind(angles: FloatArray) -> FloatArray:
        return np.concatenate([np.zeros((*line.shape, 1)), angles], axis=-1)

    between = behind(line.twists), behind(line.phases)
    return type(line).from_bends(behind(line.bends), *between)

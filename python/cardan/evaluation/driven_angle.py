"""Plans that take the angle of the last shaft in place of the drive angle.

The core finds the drive angles in closed form, each with an error term, and evaluates at these
sums: a steep chain would magnify the rounding of a drive angle.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from cardan.arrays import FloatArray, adapter, array_namespace_of, as_float64, threads
from cardan.arrays.errors import ArgumentValueError, check_choice
from cardan.arrays.libraries import LIBRARIES
from cardan.evaluation.plan import Plan
from cardan.evaluation.request import Request
from cardan.evaluation.result import Result
from cardan.evaluation.sweep import Sweep

if TYPE_CHECKING:
    from cardan.driveline import Driveline


class DrivenPlan(Plan):
    """A plan that is called with angles of the last shaft; made by ``Driveline.plan``.

    The ``drive_angle`` of a result is the drive angle that belongs to each of them.
    """

    __slots__ = ("_at_drive",)

    def __init__(self, at_drive: Plan) -> None:
        """Keep the plan that is called with drive angles."""
        line, request = at_drive.line, at_drive.request
        super().__init__(line, request)
        self.request = self.request._replace(angle_of="driven")
        self._at_drive = at_drive

    def __call__(
        self, angle: ArrayLike | Sweep, out: Mapping[str, NDArray[Any]] | None = None
    ) -> Result:
        """Evaluate at mean-synchronous angles of the last shaft, as the output ``angle`` has them.

        The drive angles are stored, also if the outputs are reduced. Otherwise as for any plan.
        """
        if name := array_namespace_of(angle):
            if LIBRARIES[name].wraps and self.line.shape:
                raise ArgumentValueError(
                    "angle",
                    "has labels, and each driveline of the batch has different drive angles; "
                    "give its values",
                )
            result = super().__call__(angle, out)
            if LIBRARIES[name].deferred:
                request = Request("angle", shafts=0, workers=self._workers)
                of_drive = DrivenPlan(Plan(self.line, request))
                drive = adapter(name).evaluate(of_drive, angle, None)["angle"]
                return Result(dict(result), result._labels, drive)
            return result
        drive, error_terms = self._sums(angle)
        evaluated = self._at_drive._run(drive, (drive, error_terms), out)
        assert evaluated is not None, "arrays that the core made lie one after another"
        return evaluated

    def _drive_angles(self, angle: ArrayLike | Sweep) -> FloatArray:
        return self._sums(angle)[0]

    def _sums(self, angle: ArrayLike | Sweep) -> tuple[FloatArray, FloatArray]:
        """Return the drive angles and their error terms."""
        given = angle if isinstance(angle, Sweep) else as_float64("angle", angle)
        angles = given._core if isinstance(given, Sweep) else given
        shape, workers = self._sample_shape(given.shape), threads.at_most(self._workers)
        found = self._core.drive_angles(shape, angles, workers, self._level)
        assert found is not None, "angles are aligned and in C order"
        return found[0, ...], found[1, ...]

    def _again(self, line: Driveline, request: Request) -> Plan:
        """Return a plan of the same kind for another request."""
        return DrivenPlan(self._at_drive._again(line, request))

    def explain(self, angle: ArrayLike | Sweep | None = None) -> str:
        """Return the steps at the drive angles, as ``Plan.explain`` does."""
        shape: Any = angle
        if isinstance(angle, Sweep):
            shape = np.broadcast_to(0.0, np.broadcast_shapes(self.line.shape, angle.shape))
        outputs = self._at_drive.explain(shape)
        return f"drive angles in closed form from angles of the last shaft\n{outputs}"

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
    check_choice("axes", axes, ("space", "shaft"))
    check_choice("angle_of", angle_of, ("drive", "driven"))
    plan = Plan(line, request)
    return DrivenPlan(plan) if angle_of == "driven" else plan

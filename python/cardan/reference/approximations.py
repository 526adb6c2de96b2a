"""Formulas of the sources and of workshop practice for motion and moments, each with its error.

For the exact values use ``Driveline``, whose ``check`` has the exact counterparts of the workshop
figures. Everything broadcasts as in NumPy. NaN gives NaN for that element only.

Sources: D. Thoma, "Das Kräftespiel im Kreuzgelenk", Schweizerische Bauzeitung 75/76 (1920), Heft
17, with the numbers of his equations; the chapter on double joints in the catalogues of German
driveshaft makers; the workshop figures of driveshaft makers in the United States. The copies of the
catalogues at hand have lost the formulas of sections 6.3 to 6.5; under Sources, the documentation
says what is used instead. For further kinematics the catalogues refer to the guideline VDI 2722,
"Gelenkwellen und Gelenkwellenstränge mit Kreuzgelenken - Einbaubedingungen für Homokinematik",
which was not available.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from cardan.arrays import FloatArray, as_float64, common_shape, scalar_or_array
from cardan.arrays.errors import check_choice, check_elements, check_shape

TORSIONAL_LIMIT, TORSIONAL_MAXIMUM = 300.0, 500.0
"""Torsional excitation of the last shaft of a truck in rad/s²: usual limit, never above.

Dana allows at most 300 rad/s² for its axles (Spicer Drive Axles Application Guidelines AXAG-0200,
2009); for the other figure no publication is known.
"""

INERTIA_LIMIT, INERTIA_MAXIMUM = 1000.0, 2000.0
"""Inertia excitation of the intermediate shafts of a truck in rad/s²: usual limit, never above.

Parker/Chelsea (bulletin HY25-1890-M1/US, page 5) and Spicer publish angles over the speed at which
a joint reaches the limit; "100 rad/s²" below Parker's is a misprint. For the other figure no
publication is known.
"""

# --- Thoma (1920) ----------------------------------------------------------------------------


class ThomaMoments(NamedTuple):
    """Thoma's ``Mt``, ``Mx`` and ``Mz`` on the driven shaft in N m, with his signs."""

    torque: Any
    moment_x: Any
    moment_z: Any


class ThomaMomentRatios(NamedTuple):
    """Thoma's ``Mx/Mt`` and ``Mz/Mt``, with his signs."""

    x: Any
    z: Any


def thoma_small_angle(
    angle: ArrayLike, bend: ArrayLike, inertia: ArrayLike, speed: ArrayLike
) -> ThomaMoments:
    """Return the moments that accelerate a flywheel on the driven shaft, by Thoma for small bends.

    These are the three unnumbered equations after his (8), for a drive at constant speed::

        Mt = -2 I w² (1 - cos b) sin 2a
        Mx = -I w² sin b (1 - cos b) (sin 2a + 1/2 sin 4a)
        Mz = -1/2 I w² sin b (1 - cos b) (1 - cos 4a)

    He says that they neglect ``(1 - cos b)²``. The neglected terms are of that order, but the
    moments themselves are of the order ``1 - cos b``. Their relative error is therefore also of the
    order ``1 - cos b`` and grows with the square of the bend.

    ==========  ==================  ===================================
    bend        peaks low by        largest error over a turn, of the
    ..          (Mt, Mx, Mz)        exact peak (Mt, Mx, Mz)
    ==========  ==================  ===================================
    8.5°        0.6, 2.2, 1.7 %     1.5, 2.7, 2.5 %
    30°         9, 26, 21 %         20, 31, 30 %
    ==========  ==================  ===================================

    The mean of ``Mz`` is then ``-1/2 I w² sin b (1 - cos b)``; the exact mean is ``-1/4 I w² sin b
    tan² b``.

    **Signs.** Thoma's x and y lie in the plane of the shafts, z is perpendicular to it, and the
    driven shaft points along y. In right-handed axes his (1) and (2) turn both shafts in the
    negative sense, the driven one about ``(0, -1, 0)`` and the driving one about ``(-sin b, -cos b,
    0)``. In his (8) the torque is positive in the sense of the rotation, and by (5) the signs of
    the bending moments follow from it. **As a vector in right-handed axes, the moment on the driven
    shaft is therefore** ``-(Mx, Mt, Mz)``. That vector is the ``moment`` of ``Driveline.evaluate``.
    Its component along the driven shaft, which points along the power flow, is ``+Mt``; those along
    x and z are ``-Mx`` and ``-Mz``.

    Args:
        angle: drive angle in rad, his ``phi``; 0 with the driving pin in the plane of the shafts.
        bend: in rad, his ``alpha``.
        inertia: moment of inertia on the driven shaft in kg m².
        speed: of the drive in rad/s.

    Raises:
        TypeError: values that are not real numbers.
        ValueError: a bend outside [0, pi/2), a negative inertia, shapes that do not broadcast.
    """
    a, b = as_float64("angle", angle), _bend("bend", bend)
    mass, rate = as_float64("inertia", inertia), as_float64("speed", speed)
    check_elements("inertia", mass, ~(mass < 0.0), "; an inertia must not be negative")
    common_shape(angle=a.shape, bend=b.shape, inertia=mass.shape, speed=rate.shape)
    s, c = _sine_cosine(a)
    # Multiple angles written out: sin 2a + 1/2 sin 4a = 4 s c³, 1 - cos 4a = 8 s² c². So the two
    # bending moments are (6) and (7) with their denominators taken as 1.
    torque = -8.0 * mass * rate**2 * np.sin(b / 2.0) ** 2 * s * c
    bending = torque * np.sin(b) * c
    return ThomaMoments(
        scalar_or_array(torque), scalar_or_array(bending * c), scalar_or_array(bending * s)
    )


def thoma_moment_ratios(angle: ArrayLike, bend: ArrayLike) -> ThomaMomentRatios:
    """Return the bending moments on the driven shaft over its torque, Thoma's (6) and (7).

    These are exact for any cause of the torque. His forms with ``tan a`` have a pole at 90°;
    multiplied by ``cos² a`` above and below they have none::

        Mx/Mt = sin b cos b cos² a / (cos² a cos² b + sin² a)
        Mz/Mt = sin b sin a cos a / (cos² a cos² b + sin² a)

    The signs of ``thoma_small_angle`` cancel: these are the components of the moment along x and z,
    divided by that along y, as a vector in right-handed axes.

    Args:
        angle: drive angle in rad, his ``phi``; 0 with the driving pin in the plane of the shafts.
        bend: in rad, his ``alpha``.

    Raises:
        TypeError: values that are not real numbers.
        ValueError: a bend outside [0, pi/2), shapes that do not broadcast.
    """
    a, b = as_float64("angle", angle), _bend("bend", bend)
    common_shape(angle=a.shape, bend=b.shape)
    s, c = _sine_cosine(a)
    scale = np.sin(b) * c / ((c * np.cos(b)) ** 2 + s**2)
    return ThomaMomentRatios(scalar_or_array(scale * np.cos(b) * c), scalar_or_array(scale * s))


# --- catalogue rules -------------------------------------------------------------------------


def catalogue_bend(bends: ArrayLike, fork_signs: ArrayLike) -> Any:  # noqa: ANN401
    """Return the equivalent bend of a chain by the catalogues' root rule.

    The rule is ``sqrt|sum of +-b²|``. It is for yokes that lie in their bend planes or are
    perpendicular to them. In the copies at hand section 6.5 has lost its formula; the rule of the
    signs is from its text. The root is the first term of the exact ``ln sec b = |sum of +-ln sec
    b_j|``. For two joints with bends up to 10, 20 and 30° its error is at most 0.04, 0.29 and
    1.02°. For three or more joints it can fail completely: 20, -25, 15° gives 0, but the exact bend
    is 3.143°. ``Driveline.equivalent`` has the exact bend at any setting of the yokes.

    Args:
        bends: bend of each joint in rad, ``(..., n)``.
        fork_signs: +1 or -1 for each joint, ``(..., n)``; equal for joints whose yokes have the
            same position relative to their own bend planes at the same time. If both bends of an
            intermediate shaft lie in one plane, the sign stays the same for crossed yokes and
            changes for parallel yokes (in phase).

    Raises:
        TypeError: values that are not real numbers.
        ValueError: a bend outside [0, pi/2), a sign other than +1 and -1, shapes that do not fit.
    """
    return _root_sum(bends, fork_signs, np.ones)


def inertia_bend(
    bends: ArrayLike, fork_signs: ArrayLike, direction: Literal["drive", "coast"] = "drive"
) -> Any:  # noqa: ANN401
    """Return the bend that belongs to ``inertia_excitation``: ``sqrt|sum of +-w b²|``.

    All joints before an intermediate shaft excite it. In the sum over these shafts, joint ``i`` of
    ``n``, counted from 1, counts ``w = n - i`` times. When coasting, the drive comes from the other
    end, and the joint counts ``w = i - 1`` times.

    Args:
        bends: as for ``catalogue_bend``, like the signs and the errors.
        fork_signs: +1 or -1 for each joint.
        direction: ``"drive"`` or ``"coast"``.
    """
    check_choice("direction", direction, ("drive", "coast"))
    step = -1 if direction == "drive" else 1
    return _root_sum(bends, fork_signs, lambda n: np.arange(n, dtype=np.float64)[::step])


def torsional_excitation(bends: ArrayLike, fork_signs: ArrayLike, speed: ArrayLike) -> Any:  # noqa: ANN401
    """Return the torsional workshop figure of a chain in rad/s²: ``w² sin² catalogue_bend``.

    It approximates the largest acceleration of the last shaft, which should be near or below
    ``TORSIONAL_LIMIT`` and never exceed ``TORSIONAL_MAXIMUM``. For a single joint it is 1.5 % below
    the exact peak at 10° and 15 % at 30°. It also has the errors of ``catalogue_bend``. Practice
    uses the sine; the bend itself would give 0.4 % more at 6°. Beyond 90° the sine counts as 1.

    Args:
        bends: as for ``catalogue_bend``, like the signs and the errors.
        fork_signs: +1 or -1 for each joint.
        speed: of the drive in rad/s.
    """
    return _excitation(catalogue_bend(bends, fork_signs), speed)


def inertia_excitation(
    bends: ArrayLike,
    fork_signs: ArrayLike,
    speed: ArrayLike,
    direction: Literal["drive", "coast"] = "drive",
) -> Any:  # noqa: ANN401
    """Return the inertia workshop figure of a chain in rad/s²: ``w² sin² inertia_bend``.

    It approximates the excitation of all intermediate shafts together. In both directions it should
    be below ``INERTIA_LIMIT`` and never exceed ``INERTIA_MAXIMUM``.

    Args:
        bends: as for ``inertia_bend``, like the other arguments and the errors.
        fork_signs: +1 or -1 for each joint.
        speed: of the drive in rad/s.
        direction: ``"drive"`` or ``"coast"``.
    """
    return _excitation(inertia_bend(bends, fork_signs, direction), speed)


def _excitation(bend: FloatArray, speed: ArrayLike) -> Any:  # noqa: ANN401
    rate = as_float64("speed", speed)
    common_shape(bends=bend.shape, speed=rate.shape)
    # Past the right angle the sine falls again, and a hopeless chain would pass.
    return scalar_or_array((rate * np.sin(np.minimum(bend, math.pi / 2))) ** 2)


def _root_sum(bends: ArrayLike, fork_signs: ArrayLike, weights: Callable[[int], FloatArray]) -> Any:  # noqa: ANN401
    """The root of the weighted squares' sum, whatever its sign; ``weights`` by number of joints."""
    b = np.atleast_1d(_bend("bends", bends))
    sign = np.atleast_1d(as_float64("fork_signs", fork_signs))
    check_elements("fork_signs", sign, np.abs(sign) == 1.0, "; each must be +1 or -1")
    n = b.shape[-1]
    check_shape("fork_signs", sign, sign.shape[-1] == n, f"{n} joints need (..., {n})")
    common_shape(bends=b.shape, fork_signs=sign.shape)
    return scalar_or_array(np.sqrt(np.abs((weights(n) * sign * b**2).sum(axis=-1))))


def _bend(name: str, value: ArrayLike) -> FloatArray:
    array = as_float64(name, value)
    wrong = (array < 0.0) | (array >= math.pi / 2)
    check_elements(name, array, ~wrong, " rad; a bend must lie in [0, pi/2)")
    return array


def _sine_cosine(angle: FloatArray) -> tuple[FloatArray, FloatArray]:
    with np.errstate(invalid="ignore"):  # an infinite angle gives NaN
        return np.sin(angle), np.cos(angle)

"""Amplitudes of one order of drivelines that deviate from their drawing."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from cardan.design.order_quantities import order_amplitude
from cardan.tolerances.chain import ComplexArray, Deviations, Nominal
from cardan.tolerances.deviating import in_blocks

if TYPE_CHECKING:
    from cardan.driveline import Driveline


def order_amplitudes(
    line: Driveline, nominal: Nominal, deviations: Deviations, samples: int, order: int, shaft: int
) -> ComplexArray:
    """Return the complex amplitude of an order of the angle error of each sample, in rad.

    Drive angles count from the plane of joint 0. Where deviations turn that plane, the amplitude is
    referred to the plane as drawn, so that it changes evenly with them.

    Args:
        line: the driveline as drawn.
        nominal: its parameters.
        deviations: by how much they deviate, ``(samples,)`` each.
        samples: how many samples there are.
        order: of the drive's rotation.
        shaft: of which.
    """

    def of(made: Driveline) -> ComplexArray:
        amplitudes = order_amplitude(made, order, shaft)
        if nominal.points is None:
            return amplitudes
        normal, axis = line.normals[0], line.directions[0]
        turned = np.arctan2(
            np.cross(normal, made.normals[:, 0]) @ axis, made.normals[:, 0] @ normal
        )
        return np.asarray(amplitudes * np.exp(-1j * order * turned))

    found = in_blocks(of, line, nominal, deviations, samples, np.complex128)
    bend = deviations.get(("bends", (0,)))
    if bend is not None and order % 2:
        # Beyond straight the plane has turned by half a turn.
        found[nominal.bends[0] + bend < 0.0] *= -1.0
    return found

"""The orders of joints as built, in words."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from cardan.app.answers.as_built.figures import ORDERS, ShaftOrders
from cardan.app.answers.printed import figure_text
from cardan.design.wrapping import fill

BY_DRAWING = (
    "Curves, extremes, forces and play are those as built. Equivalent bend, closed forms, limits, "
    "slides, life, torsional vibration and steering are those of the drawing."
)


def words(found: list[ShaftOrders], *, radians: bool = False) -> str:
    """Return the orders as a table of plain text, and what they do not change."""
    table = [("Joints as built: amplitudes", *(f"order {order}" for order in ORDERS))]
    table += [(f"  {label}", *figures) for label, *figures in as_built_rows(found, radians=radians)]
    widths = [max(map(len, column)) for column in zip(*table, strict=True)]
    lines = []
    for label, *figures in table:
        right = (figure.rjust(width) for figure, width in zip(figures, widths[1:], strict=True))
        lines.append("  ".join((label.ljust(widths[0]), *right)))
    return "\n".join([*lines, fill(BY_DRAWING, 79, break_on_hyphens=False)])


def as_built_rows(found: list[ShaftOrders], *, radians: bool = False) -> Iterator[tuple[str, ...]]:
    """Yield what each row is about and its amplitudes by order."""
    unit = "rad" if radians else "deg"
    for each in found:
        errors = each.angle_error if radians else np.degrees(each.angle_error)
        kinds = [(f"angle error [{unit}]", errors)]
        if each.acceleration is not None:
            kinds.append(("acceleration [rad/s²]", each.acceleration))
        for label, (built, drawing, *worst) in kinds:
            state = f", in {each.state}" if each.state else ""
            yield (f"shaft {each.shaft}, {label}{state}", *map(figure_text, built))
            if each.deviates:
                yield ("  of the drawing", *map(figure_text, drawing))
            for amplitudes in worst:
                yield ("  within tolerances of joints up to", *map(figure_text, amplitudes))

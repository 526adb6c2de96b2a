"""The tubes of shafts in words."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from cardan.app.answers.printed import aligned, figure_text
from cardan.app.answers.tubes.figures import TubeFigures
from cardan.design.wrapping import fill


def words(tubes: Sequence[TubeFigures], *, radians: bool = False) -> str:
    """Return the tubes as plain text, 79 wide."""
    parts = [
        f"Tube of shaft {tube.shaft}\n{aligned(tube_lines(tube), indent='  ')}" for tube in tubes
    ]
    faults = list(tube_sentences(tubes))
    return "\n\n".join([*parts, "\n".join(fill(text, 79) for text in faults)] if faults else parts)


def tube_lines(tube: TubeFigures) -> list[tuple[str, str]]:
    """Return the figures of a tube as pairs."""
    lines = [
        ("torsional stiffness", f"{figure_text(tube.stiffness)} N m/rad"),
        ("moment of inertia", f"{figure_text(tube.inertia)} kg m²"),
    ]
    if tube.stress is not None and tube.torque is not None:
        limit = ""
        if tube.permitted_stress is not None:
            limit = f"; permitted {1e-6 * tube.permitted_stress:.4g} MPa"
        where = f" in {tube.torque_in}" if tube.torque_in else ""
        lines += [
            ("largest torque", f"{figure_text(tube.torque)} N m{where}"),
            ("shear stress", f"{1e-6 * tube.stress:.4g} MPa{limit}"),
        ]
    lines.append(("critical bending speed", f"{tube.critical_rpm:.0f} rpm"))
    if tube.margin is not None and tube.speed_rpm is not None:
        least = "" if tube.least_margin is None else f"; at least {tube.least_margin:.4g}"
        lines.append(
            ("margin", f"{tube.margin:.3g} times the largest speed {tube.speed_rpm:.6g} rpm{least}")
        )
    return lines


def tube_sentences(tubes: Sequence[TubeFigures]) -> Iterator[str]:
    """Say what is beyond the limits of the scene, and where a speed is near half the critical."""
    for tube in tubes:
        if not tube.stress_passes:
            assert tube.stress is not None
            assert tube.permitted_stress is not None
            yield (
                f"The shear stress in the tube of shaft {tube.shaft} is "
                f"{1e-6 * tube.stress:.4g} MPa, beyond the permitted "
                f"{1e-6 * tube.permitted_stress:.4g} MPa."
            )
        if not tube.margin_passes:
            yield (
                f"The critical bending speed of shaft {tube.shaft} is {tube.margin:.3g} times its "
                f"largest speed; the scene requires {tube.least_margin:.4g} times."
            )

"""The tubes of shafts in words."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from cardan.app.answers.printed import figure_text, place_of, quantity
from cardan.app.answers.rows import worst_of
from cardan.app.answers.tubes.figures import TubeFigures


def sentences(tubes: Sequence[TubeFigures]) -> Iterator[str]:
    """Say whether the tubes are within the limits of the scene, what is not judged and why."""
    judged = [each for tube in tubes for each in (tube.stress, tube.margin) if each]
    for tube in tubes:
        stress, margin = tube.stress, tube.margin
        if stress and stress.verdict == "beyond" and stress.value and stress.limit:
            yield (
                f"The shear stress in the tube of shaft {tube.shaft} is "
                f"{quantity(stress.value, 'MPa')}{place_of(stress)}, beyond the permitted "
                f"{quantity(stress.limit, 'MPa')}."
            )
        if margin and margin.verdict == "beyond" and margin.value and margin.limit:
            yield (
                f"The critical bending speed of shaft {tube.shaft} is {figure_text(margin.value)} "
                f"times its speed{place_of(margin)}; the scene requires "
                f"{figure_text(margin.limit)} times."
            )
    verdict = worst_of(each.verdict for each in judged)
    if verdict == "within":
        yield "The tubes are within the limits that the scene gives."
    for why in dict.fromkeys(each.why for each in judged if each.why):
        yield f"The tubes are not judged by every limit: {why}."
    if not any(each.limit for each in judged):
        yield "The tubes are not judged: the scene gives no permitted_stress_MPa or least_margin."

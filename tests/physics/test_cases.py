"""The numbers of the case book: each agrees with the published one, or differs as stated."""

from __future__ import annotations

import math
from dataclasses import replace

import cases
import numpy as np
import pytest
from cases import SOURCES, Case, Source

from cardan import Driveline


def is_as_stated(case: Case) -> bool:
    """Whether a number rounds to the published one, or differs by what is stated and explained."""
    if not case.apart:
        return case.agrees and case.reason is None and not case.why
    stated = f"{case.difference:+.{cases.decimals(case.apart)}f}" == case.apart
    return stated and not case.agrees and case.reason is not None and bool(case.why)


@pytest.mark.parametrize("source", SOURCES, ids=[source.title for source in SOURCES])
def test_numbers(source: Source) -> None:
    assert [case for case in source.cases() if not is_as_stated(case)] == []


@pytest.mark.parametrize("source", SOURCES, ids=[source.title for source in SOURCES])
def test_other_numbers_would_be_noticed(source: Source) -> None:
    """The tests let less through than a unit of the last published or stated digit."""
    for case in source.cases():
        unit = 10.0 ** -cases.decimals(case.apart or case.published)
        for sign in (-1.0, 1.0):
            assert not is_as_stated(replace(case, ours=case.ours + 1.01 * sign * unit)), case


def test_what_the_page_says_first() -> None:
    every = [case for source in SOURCES for case in source.cases()]
    same = sum(case.agrees for case in every)
    assert f"**{same} of {len(every)} published numbers agree" in cases.answer()
    known = sum(case.reason not in (None, "untraced") for case in every)
    assert f"The other {len(every) - same} differ, {known} of them for a" in cases.answer()
    assert cases.book().count("| agrees |") == same


def test_published_formulas() -> None:
    """Dana's, pages 45 and 46, with the letters of the catalogue."""
    torque, between, a, b, e, f = 1000.0, 1.2, 0.3, 0.1, 0.12, 0.35
    first, second = np.radians([10.0, 8.0])
    forces = {}
    for arrangement, sign in (("Z", -1.0), ("W", 1.0)):
        tangents = math.tan(first) + sign * math.tan(second)
        part = torque * math.cos(first) / between * tangents
        for bearing, arms in (("A", b / a), ("B", (a + b) / a), ("E", (e + f) / f), ("F", e / f)):
            forces[f"{arrangement}, fork at 0°", f"bearing {bearing} [N]"] = arms * part
    across = "Z and W, fork at 90°"
    forces[across, "bearings A and B [N]"] = torque * math.tan(first) / a
    forces[across, "bearings E and F [N]"] = torque * math.sin(second) / (f * math.cos(first))
    forces["Z, both bends 10°, fork at 0°", "all bearings [N]"] = 0.0
    equal = 2.0 * torque * math.sin(first) * b / (between * a)
    forces["W, both bends 10°, fork at 0°", "bearing A [N]"] = equal
    for coating, friction in (("plastic coated, μ 0.08", 0.08), ("steel, greased, μ 0.11", 0.11)):
        for bend in (10, 8):
            force = torque * math.cos(math.radians(bend)) * friction / 0.045
            forces[coating, f"at the bend of {bend}° [N]"] = force
    published = {
        (case.given, case.figure): case.published
        for case in (*cases.dana_forces(), *cases.dana_friction())
    }
    assert published == {
        key: f"{force:.{cases.decimals(published[key])}f}" for key, force in forces.items()
    }


def test_reasons() -> None:
    """Done as the sources do it, the numbers become theirs."""
    turn = np.arange(7200) * math.pi / 7200
    for phases, published in (((70, 15), "0.754064857892"), ((68.25, 16.5), "0.036594619153")):
        line = Driveline.from_bends(cases.SEARCHED, 0, phases, degrees=True)
        assert f"{100 * np.ptp(line.evaluate(turn, 'speed_ratio').speed_ratio):.12f}" == published
    assert f"{4_705_000 * math.hypot(3.5, 3.26) / 60**2:.0f}" == "6251"
    assert [f"{math.hypot(*sides):.2f}" for sides in ((4, 3), (15, 10))] == ["5.00", "18.03"]
    for case in list(cases.parker())[:4]:
        assert 1000 < cases.peak(case.number, int(case.given.split()[0])) < 1030


def test_every_scene_belongs_to_a_source() -> None:
    assert {name for source in SOURCES for name in source.scenes} == set(cases.SCENES)
    assert all(source.scenes for source in SOURCES)

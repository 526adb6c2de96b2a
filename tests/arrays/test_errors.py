"""Errors carry fields, whoever raises them, and no code of the package reads their text."""

from __future__ import annotations

import ast
import copy
import pickle
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import ArrayLike

import cardan
from cardan import (
    ArgumentError,
    ArgumentTypeError,
    ArgumentValueError,
    BallJoint,
    Driveline,
    Load,
    Machine,
    Sweep,
    TorsionalSystem,
    optimise,
)
from cardan.reference import approximations as approximate

TWO = Driveline.from_bends([0.1, 0.2])
ONE = Driveline.from_bends([0.1])
SKEW = ONE.with_deviations(cross=0.01)
SLOW = Load(output_torque=1.0, speed=1.0)
LOADED = Load(drive_torque=[1.0, 2.0, 3.0])
NAN = np.nan
ONES = np.ones((3, 2))
BATCH = np.zeros((2, 3, 2))
BATCH[1, 2, 1] = 1.6
POINTS = [[0, 0, 0], [1, 0, 0], [1, 0, 0]]

VALUES: list[tuple[Callable[[], object], str, tuple[int | str, ...], str]] = [
    # From the core.
    (lambda: Driveline.from_bends([0.1, 1.6]), "bends", (1,), "is 1.6 rad; a bend must lie in"),
    (lambda: Driveline.from_bends(BATCH), "bends", (1, 2, 1), "is 1.6 rad; a bend must lie in"),
    (lambda: Driveline.from_points(POINTS), "points", (2,), "is (1, 0, 0) after (1, 0, 0);"),
    (
        lambda: Driveline.from_directions([[1, 0, 0], [-1, 1, 0]]),
        "directions",
        (),
        "give bends[0] = 2.35",
    ),
    (lambda: TWO.evaluate(0.1, ["angle", "torque"]), "outputs", (1,), 'is "torque", which needs'),
    (lambda: TWO.evaluate(0.1, shafts=[1, 1]), "shafts", (1,), "is 1 again; name each once"),
    (lambda: Sweep(0.0, 1e13, 5), "stop", (), "is 10000000000000.0 rad; a sweep must end"),
    (
        lambda: TWO.evaluate([0.1, 0.2], "torque", load=LOADED),
        "drive_torque",
        (),
        "has shape (3,), which does not broadcast to the samples' (2,)",
    ),
    # From the layer above it.
    (
        lambda: Driveline.from_bends([10, 95], degrees=True),
        "bends",
        (1,),
        "is 95.0 deg; a bend must lie in [0, 90) deg",
    ),
    (lambda: Driveline.from_bends([0.1, 0.2], [NAN]), "twists", (0,), "is nan; it must be finite"),
    (lambda: Driveline.from_bends([0.1], [1.0]), "twists", (), "has shape (1,); 1 joints need"),
    (lambda: TWO.plan(["angle", "angel"]), "outputs", (1,), "is 'angel'; did you mean 'angle'?"),
    (lambda: TWO.plan(reduce="most"), "reduce", (), "is 'most'; known are"),  # type: ignore[arg-type]
    (
        lambda: TWO.evaluate([0.1], "angle", out={"angle": np.empty(2)}),
        "out",
        ("angle",),
        "has shape (2,); it must be (1,)",
    ),
    (lambda: Load(inertias=[1.0, -2.0]), "inertias", (1,), "is -2.0; an inertia must not be"),
    (
        lambda: Load(drive_torque=1.0, output_torque=1.0),
        "drive_torque",
        (),
        "and output_torque are both given; give one of them",
    ),
    (lambda: Sweep(0.0, 1.0, 0), "num", (), "is 0; it must be at least 1"),
    (lambda: Sweep.revolutions(0.3, 7), "turns", (), "is 0.3 of 7 samples each;"),
    (lambda: BallJoint([0.05, -1.0]), "radius", (1,), "is -1.0; it must be positive and finite"),
    (lambda: BallJoint(0.05, 2.0), "half_angle", (), "is 2.0 rad; a half-angle must lie in"),
    (lambda: BallJoint(0.05).peak_pressure([1, -1]), "load", (1,), "is -1.0; it must be finite"),
    (lambda: TWO.harmonics([2, 0]), "orders", (1,), "is 0; an order is at least 1"),
    (
        lambda: approximate.catalogue_bend([0.1, 0.2], [1, 2]),
        "fork_signs",
        (1,),
        "is 2.0; each must be +1 or -1",
    ),
    (lambda: TWO.evaluate(0.1, workers=0), "workers", (), "is 0; it must be positive"),
    # Of machines.
    (lambda: Machine(TWO, limits={"noise": 1.0}).figures(), "limits", (), 'is of "noise", which'),
    (lambda: Machine(TWO, limits={"bend": (2.0, 1.0)}).figures(), "limits", (0,), "is 1.0 rad; a"),
    (
        lambda: Machine(TWO, limits={"life": (1.0, 2.0)}).figures(),
        "limits",
        (0,),
        "is 2.0 h; a max",
    ),
    (
        lambda: Machine(TWO, limits={"bend": {2: 1.0}}).figures(),
        "limits",
        (0,),
        "is of bend 2; the",
    ),
    (lambda: Machine(TWO).with_ratings(-1.0).figures(), "rating", (0,), "is -1.0; it must be"),
    (lambda: Machine(TWO).with_duty(ONE, SLOW, [1.0]).figures(), "steps", (), "has 1 values; 1 dr"),
    (lambda: Machine(TWO).with_friction(1, 0, 1).figures(), "pin_radius", (0,), "is 0.0; it must"),
    (lambda: Machine(SKEW).figures(), "driveline", (), "has joints with deviations; machines are"),
    (lambda: Machine(TWO, limits={"bend": [1, 2, 3]}), "bend", (), "is [1, 2, 3]; it must be a n"),
    (lambda: Machine(TWO, LOADED), "drive_torque", (), "has shape (3,); it must be one or (1,)"),
    (lambda: Machine(TWO.reshape(1, 1)), "states", (), "has shape (1, 1); it is one driveline"),
    (lambda: Machine(TWO).with_duty(TWO, SLOW, [0.4]), "shares", (), "are [0.4]; they must add up"),
    (lambda: Machine(TWO).with_tubes([1], 0.1, 0.06), "wall", (0,), "is 0.06 m; a wall is at most"),
    (lambda: Machine(TWO).with_steering([1, 2, 3]), "centre", (), "has shape (3,); it must be one"),
    (lambda: Driveline.from_bends(np.full(257, 0.1)), "bends", (), "has 257 joints; a driveline"),
    (lambda: Driveline.from_bends(np.full((2, 300), 0.1)), "bends", (0,), "has 300 joints; a dr"),
    (lambda: Driveline.from_points(np.eye(3)[np.arange(300) % 3]), "points", (), "has 298 joints"),
    (
        lambda: Driveline.from_slopes(np.zeros(300), np.zeros(300)),
        "directions",
        (),
        "has 299 joints; a dr",
    ),
    (lambda: Driveline.from_readings([0, 0.1], offsets=[0, 1, 1]), "offsets", (), "need the leng"),
    (
        lambda: Driveline.from_readings([0, 1.5], [1, 1], [[0, 0, 0.05], [0, 0, 0.08]]),
        "offsets",
        (1,),
        "go aside by 0.08 along shaft 1, which is 1 long and at its reading goes aside by less",
    ),
    (lambda: Driveline.from_readings([0, 2]), "readings", (1,), "is 2.0; a reading must lie betw"),
    (lambda: Driveline.from_readings([0, 1], gauge=0), "gauge", (), "is 0.0; it must be positive"),
    (lambda: Driveline.from_readings([0, 1], gauge=1), "gauge", (), "is 1.0 leads past 90 deg"),
]

TYPES: list[tuple[Callable[[], object], str, tuple[int | str, ...], str]] = [
    (lambda: TWO.evaluate("a"), "angle", (), "has dtype <U1; it must hold real numbers"),
    (lambda: TWO.evaluate(0.1, shafts=[0, 1.5]), "shafts", (1,), "is 1.5; it must be an integer"),  # type: ignore[list-item]
    (lambda: TWO.plan(["angle", 3]), "outputs", (1,), "is 3; an output is asked for"),  # type: ignore[list-item]
    (lambda: TWO.evaluate([0.1], out=[1]), "out", (), "is list; it must map names"),  # type: ignore[arg-type]
    (lambda: Sweep(0.0, "a", 5), "stop", (), "is 'a'; it must be a number"),  # type: ignore[arg-type]
]


@pytest.mark.parametrize(("call", "argument", "place", "problem"), VALUES + TYPES)
def test_fields(
    call: Callable[[], object], argument: str, place: tuple[int | str, ...], problem: str
) -> None:
    with pytest.raises(ArgumentError) as caught:
        call()
    error = caught.value
    assert (error.argument, error.place) == (argument, place)
    assert all(type(part) in (int, str) for part in error.place)
    assert error.problem.startswith(problem)
    indices = f"[{', '.join(map(repr, place))}]" if place else ""
    assert str(error) == f"{argument}{indices} {error.problem}"


@pytest.mark.parametrize(
    ("call", "value", "unit", "rule"),
    [
        (VALUES[0][0], 1.6, "rad", "a bend must lie in [0, pi/2), with pi/2 as a double"),
        (VALUES[8][0], 95.0, "deg", "a bend must lie in [0, 90) deg"),
        (lambda: Driveline.from_bends([1e-13, -1e-13], degrees=True), -1e-13, "deg", ""),
        (lambda: BallJoint([0.05, -1.0]), -1.0, "", "it must be positive and finite"),
        (lambda: BallJoint(0.05, 2.0), 2.0, "rad", "a half-angle must lie in"),
        (lambda: TWO.plan("angel"), None, "", ""),
    ],
)
def test_a_value_that_breaks_a_rule(
    call: Callable[[], object], value: float | None, unit: str, rule: str
) -> None:
    with pytest.raises(ArgumentError) as caught:
        call()
    error = caught.value
    assert (error.value, error.unit) == (value, unit)
    assert error.rule.startswith(rule)
    assert error.problem.endswith(error.rule)
    assert (value is None) == (not error.rule)


@pytest.mark.parametrize(
    ("call", "argument", "place"),
    [
        (lambda: Driveline.from_bends([0.1, 2.0], np.zeros((5, 3, 1))), "bends", (1,)),
        (
            lambda: Driveline.from_bends([[[0, 95]]] * 2, np.zeros((3, 1)), degrees=True),
            "bends",
            (0, 0, 1),
        ),
        (lambda: Driveline.from_points([*POINTS], np.zeros((4, 0))), "points", (2,)),
        (lambda: mounted([[1, 1, 1], [1, 0, 1]], np.full((4, 1), 0.5)), "lengths", (1, 1)),
        (lambda: mounted([[1, 1, 1]], [0.5, 2.0]), "bearings", (0, 1, 1)),
    ],
)
def test_places_are_those_in_the_argument(
    call: Callable[[], object], argument: str, place: tuple[int, ...]
) -> None:
    with pytest.raises(ArgumentError) as caught:
        call()
    assert (caught.value.argument, caught.value.place) == (argument, place)


def mounted(lengths: list[list[float]], position: ArrayLike) -> Driveline:
    return TWO.with_bearings([(1, position)], lengths=lengths)


@pytest.mark.parametrize(
    ("cases", "own", "base"),
    [(VALUES, ArgumentValueError, ValueError), (TYPES, ArgumentTypeError, TypeError)],
)
def test_they_stay_what_they_were(
    cases: list[tuple[Any, ...]], own: type[ArgumentError], base: type[Exception]
) -> None:
    for call, *_ in cases:
        with pytest.raises(base) as caught:
            call()
        assert type(caught.value) is own


def test_an_index_out_of_range_stays_an_index_error() -> None:
    with pytest.raises(IndexError, match=r"^shafts\[1\] is 7; there are 3, counted from 0$"):
        TWO.evaluate(0.1, shafts=[0, 7])


@pytest.mark.parametrize("case", [VALUES[1], VALUES[8], TYPES[1]])
def test_copies_are_whole(case: tuple[Any, ...]) -> None:
    with pytest.raises(ArgumentError) as caught:
        case[0]()
    error = caught.value
    error.add_note("in the third run")
    for other in (pickle.loads(pickle.dumps(error)), copy.copy(error), copy.deepcopy(error)):
        assert type(other) is type(error)
        assert str(other) == str(error)
        assert vars(other) == vars(error)
        assert other.__notes__ == error.__notes__


def refused(bend: float) -> None:
    Driveline.from_bends([0.1, bend])


def test_fields_arrive_from_another_process() -> None:
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        error = pool.submit(refused, 1.6).exception(timeout=60)
    assert isinstance(error, ArgumentValueError)
    assert (error.argument, error.place) == ("bends", (1,))


def test_fields_arrive_from_a_task_of_dask() -> None:
    dask_array = pytest.importorskip("dask.array")
    bends = dask_array.from_array(BATCH, chunks=(1, 3, 2))
    with pytest.raises(ArgumentValueError) as caught:
        Driveline.from_bends(bends).evaluate(0.1).speed_ratio.compute()  # type: ignore[attr-defined]
    # Within the chunk.
    assert (caught.value.argument, caught.value.place) == ("bends", (0, 2, 1))


def test_tracebacks_show_the_public_name() -> None:
    for name in ("ArgumentError", "ArgumentTypeError", "ArgumentValueError"):
        assert getattr(cardan, name).__module__ == "cardan"
        assert name in vars(cardan)["__all__"]


def texts_read(source: str) -> Iterator[int]:
    """The lines where a program does more with the text of an error than to pass it on."""
    tree = ast.parse(source)
    names = {"error"}
    for node in ast.walk(tree):
        if isinstance(node, ast.ExceptHandler) and node.name:
            names.add(node.name)

    def is_text(node: ast.AST) -> bool:
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
            one_name = len(node.args) == 1 and isinstance(node.args[0], ast.Name)
            return node.func.id in ("str", "repr") and one_name and node.args[0].id in names  # type: ignore[attr-defined]
        if isinstance(node, ast.FormattedValue):
            return isinstance(node.value, ast.Name) and node.value.id in names
        return isinstance(node, ast.JoinedStr) and any(map(is_text, node.values))

    for node in ast.walk(tree):
        match node:
            case ast.Attribute(value=ast.Name(id=name), attr="args") if name in names:
                # Errors may set their own, as ``self.args``.
                yield node.lineno
            case ast.Attribute(attr="split", value=value) if is_text(value):
                # To bring a text of several lines into one.
                pass
            case ast.Attribute(value=value) | ast.Subscript(value=value) if is_text(value):
                yield node.lineno
            case ast.Compare(left=left, comparators=others) if any(map(is_text, [left, *others])):
                yield node.lineno
            case ast.Call(func=ast.Attribute(value=ast.Name(id="re")), args=given) if any(
                map(is_text, given)
            ):
                yield node.lineno
            case ast.Call(func=ast.Attribute(value=ast.Name(id="self")), args=given) if any(
                map(is_text, given)
            ):
                yield node.lineno


@pytest.mark.parametrize(
    "use",
    [
        "re.sub('a', 'b', str(error))",
        "re.match('a', f'{error}')",
        "self._line(section, str(error))",
        "str(error).startswith('a')",
        "'a' in str(error)",
        "str(error) == 'a'",
        "str(error)[:3]",
        "error.args[0]",
    ],
)
def test_the_search_finds_what_it_looks_for(use: str) -> None:
    handler = f"try:\n    f()\nexcept ValueError as error:\n    x = {use}\n"
    assert list(texts_read(handler)) == [4]
    assert list(texts_read(handler.replace("error", "wrong"))) == [4]
    assert not list(texts_read(handler.replace(use, "error.argument")))


def test_no_code_of_the_package_reads_the_text_of_an_error() -> None:
    package = Path(cardan.__file__).parent
    found = {
        f"{path.relative_to(package)}:{line}"
        for path in package.rglob("*.py")
        for line in texts_read(path.read_text(encoding="utf-8"))
    }
    assert len(list(package.rglob("*.py"))) > 50
    assert not found


@pytest.mark.parametrize(
    ("call", "argument", "problem"),
    [
        (lambda: cardan.Answer(3), "of", "is 3; it must be a cardan.Scene"),  # type: ignore[arg-type]
        (lambda: Machine(3), "states", "is 3; it must be a driveline"),  # type: ignore[arg-type]
        (lambda: Machine(TWO, drawn=3), "drawn", "is 3; it must be a driveline"),  # type: ignore[arg-type]
        (lambda: TWO.steering(drawn=3), "drawn", "is 3; it must be a driveline"),  # type: ignore[arg-type]
        (
            lambda: TorsionalSystem(
                TWO,
                inertias=ONES,
                stiffnesses=[1, 1, 1],
                drive="free",
                harmonics=[(1, 2)],  # type: ignore[list-item]
            ),
            "harmonics",
            "is (1, 2); it must be a TorqueHarmonic",
        ),
        (
            lambda: TorsionalSystem(TWO, inertias=ONES, stiffnesses=[1, 1, 1], couplings=[3]),  # type: ignore[arg-type]
            "couplings",
            "is [3]; it must map shafts to couplings",
        ),
        (
            lambda: optimise(lambda x: TWO, [0.1], keep=[("bend", 1)]),  # type: ignore[arg-type]
            "keep",
            "is [('bend', 1)]; it must map quantities to limits",
        ),
        (lambda: cardan.Scene.parse(b"x"), "text", "it must be the text of a scene"),  # type: ignore[arg-type]
        (lambda: TWO.evaluate(0.1, tolerance="0"), "tolerance", "it must be a number"),  # type: ignore[arg-type]
        (lambda: TWO.evaluate([[1], [1, 2]]), "angle", "is no array of numbers"),
        (lambda: TWO.plot(NAN), "angle", "is nan; it must be finite"),
        (lambda: TWO.plot([0.1]), "angle", "it must be one number"),  # type: ignore[arg-type]
        (
            lambda: TWO.with_bearings([(0, 0.1), (0, 0.3 - 0.2)], [1, 1, 1]),
            "bearings",
            "",
        ),
    ],
)
def test_what_no_argument_is(call: Callable[[], object], argument: str, problem: str) -> None:
    with pytest.raises(ArgumentError) as caught:
        call()
    assert caught.value.argument == argument
    assert problem in caught.value.problem

"""What ``import cardan`` loads, and what it leaves until it is asked for."""

from __future__ import annotations

import doctest
import pickle
import subprocess
import sys

import pytest

import cardan
from cardan.scene import units

LATER = (
    "cardan.command",
    "cardan.figures",
    "cardan.files",
    "cardan.interop",
    "cardan.plots",
    "cardan.report",
    "cardan.scene",
    "cardan.words",
    "click",
    "dask",
    "matplotlib",
    "pyarrow",
    "scipy",
    "xarray",
)


def loaded(code: str) -> set[str]:
    """The modules that are there after some code in a process of its own."""
    script = f"import sys; {code}; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, check=True)
    return set(done.stdout.decode().split())


def test_the_library_alone_is_imported() -> None:
    line = "line = cardan.Driveline.from_bends([0.3, 0.3])"
    modules = loaded(f"import cardan; {line}; line.evaluate([0.0, 1.0]); line.check(100.0)")
    assert "cardan.driveline" in modules
    assert modules.isdisjoint(LATER)


ASKED_FOR = {
    "Scene": "cardan.scene",
    "approximations": "cardan.approximations",
    "plots": "cardan.plots",
    "reference": "cardan.reference",
    "scene": "cardan.scene",
    "workshop": "cardan.workshop",
}


@pytest.mark.parametrize("name", ASKED_FOR)
def test_what_comes_when_it_is_asked_for(name: str) -> None:
    modules = loaded(f"import cardan; assert {name!r} in dir(cardan); cardan.{name}")
    assert ASKED_FOR[name] in modules


def test_what_comes_when_it_is_imported() -> None:
    assert set(ASKED_FOR.values()) <= loaded(f"from cardan import {', '.join(ASKED_FOR)}")


def test_scenes_need_neither_pictures_nor_the_command() -> None:
    modules = loaded("from cardan import Scene; Scene.schema()")
    assert modules.isdisjoint({"cardan.plots", "cardan.report", "click", "matplotlib"})


def test_pictures_need_matplotlib_only_to_be_drawn() -> None:
    assert "matplotlib" not in loaded("import cardan; cardan.plots.plot_curves")


def test_every_public_name_is_there() -> None:
    assert set(cardan.__all__) <= set(dir(cardan))
    for name in cardan.__all__:
        assert getattr(cardan, name) is not None


def test_other_names_are_not() -> None:
    with pytest.raises(AttributeError, match=r"^module 'cardan' has no attribute 'Drivelines'$"):
        cardan.Drivelines  # noqa: B018


def test_public_classes_are_pickled_by_their_names() -> None:
    for name in cardan.__all__:
        kind = getattr(cardan, name)
        if isinstance(kind, type):
            assert pickle.loads(pickle.dumps(kind)) is kind


def test_the_examples_in_docstrings_are_right() -> None:
    assert doctest.testmod(cardan) == (0, 6)
    assert doctest.testmod(units) == (0, 2)

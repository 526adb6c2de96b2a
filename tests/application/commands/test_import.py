"""What ``import cardan`` loads, and what it leaves until it is asked for."""

from __future__ import annotations

import doctest
import pickle
import re
import subprocess
import sys
from importlib import import_module
from pathlib import Path

import pytest

import cardan
from cardan.app.command import SUBCOMMANDS

EXAMPLES = (
    next(path for path in Path(__file__).parents if (path / "examples").exists()) / "examples"
)

OPTIONAL = ("dask", "jinja2", "matplotlib", "pyarrow", "scipy", "xarray")
LATER = (
    "cardan.app.answers",
    "cardan.app.charts",
    "cardan.app.command",
    "cardan.app.files",
    "cardan.interop",
    "cardan.app.pictures",
    "cardan.app.plots",
    "cardan.app.report",
    "cardan.app.scene",
    "click",
    *OPTIONAL,
)


def loaded(code: str) -> set[str]:
    """The modules that are there after some code in a process of its own."""
    script = f"import sys, atexit; atexit.register(lambda: print(*sys.modules)); {code}"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, check=False)
    return set(done.stdout.decode().splitlines()[-1].split())


def loaded_by_command(*arguments: str | Path) -> set[str]:
    """The modules that are there after a run of the command."""
    argv = ["cardan", *map(str, arguments)]
    return loaded(f"from cardan.app.command import main; sys.argv = {argv!r}; main()")


def test_the_library_alone_is_imported() -> None:
    line = "line = cardan.Driveline.from_bends([0.3, 0.3])"
    modules = loaded(f"import cardan; {line}; line.evaluate([0.0, 1.0]); line.check(100.0)")
    assert "cardan.driveline" in modules
    assert modules.isdisjoint(LATER)


ASKED_FOR = {
    "Scene": "cardan.app.scene",
    "approximations": "cardan.reference.approximations",
    "plots": "cardan.app.plots",
    "reference": "cardan.reference",
    "scene": "cardan.app.scene",
    "workshop": "cardan.motion.workshop",
}


@pytest.mark.parametrize("name", ASKED_FOR)
def test_what_comes_when_it_is_asked_for(name: str) -> None:
    modules = loaded(f"import cardan; assert {name!r} in dir(cardan); cardan.{name}")
    assert ASKED_FOR[name] in modules


def test_what_comes_when_it_is_imported() -> None:
    assert set(ASKED_FOR.values()) <= loaded(f"from cardan import {', '.join(ASKED_FOR)}")


def test_scenes_need_neither_pictures_nor_the_command() -> None:
    modules = loaded("from cardan import Scene; Scene.schema()")
    assert modules.isdisjoint({"cardan.app.plots", "cardan.app.report", "click", "matplotlib"})


def test_pictures_need_matplotlib_only_to_be_drawn() -> None:
    assert "matplotlib" not in loaded("import cardan; cardan.plots.plot_curves")


@pytest.mark.parametrize(
    "arguments", [["--version"], ["--help"], []], ids=["version", "help", "no argument"]
)
def test_the_command_says_what_it_is_without_the_library(arguments: list[str]) -> None:
    modules = loaded_by_command(*arguments)
    assert "cardan.app.command" in modules
    assert {name for name in modules if name.startswith("cardan")} == {
        "cardan",
        "cardan._core",
        "cardan.app",
        "cardan.app.command",
        "cardan.app.command.terminal",
    }
    assert modules.isdisjoint({"numpy", *OPTIONAL})


@pytest.mark.parametrize("command", ["check", "run"])
def test_a_scene_without_a_picture_needs_none(command: str, tmp_path: Path) -> None:
    scene = tmp_path / "scene.toml"
    scene.write_text("[driveline]\nbends_deg = [2, 2]\n")
    modules = loaded_by_command(command, scene)
    assert f"cardan.app.command.{command}" in modules
    assert modules.isdisjoint({"cardan.app.plots", "cardan.app.report", *OPTIONAL})
    others = {f"cardan.app.command.{name}" for name, _ in SUBCOMMANDS.values() if name != command}
    assert modules.isdisjoint(others)


def test_only_what_says_something_of_it_needs_the_search() -> None:
    assert "cardan.optimisation" not in loaded_by_command("check", EXAMPLES / "spatial_shaft.toml")
    # Where no single change suffices, a check advises a section for it.
    advised = loaded_by_command("check", EXAMPLES / "truck.toml")
    assert "cardan.optimisation" in advised
    assert "scipy" not in advised
    assert "cardan.optimisation" in loaded_by_command("check", EXAMPLES / "truck_heights.toml")


def test_every_public_name_is_there() -> None:
    assert set(vars(cardan)["__all__"]) <= set(dir(cardan))
    for name in vars(cardan)["__all__"]:
        assert getattr(cardan, name) is not None


def test_public_classes_are_pickled_by_their_names() -> None:
    for name in vars(cardan)["__all__"]:
        kind = getattr(cardan, name)
        if isinstance(kind, type):
            assert pickle.loads(pickle.dumps(kind)) is kind


PACKAGE = Path(cardan.__file__).parent
WITH_EXAMPLES = [
    ".".join(path.relative_to(PACKAGE.parent).with_suffix("").parts).removesuffix(".__init__")
    for path in sorted(PACKAGE.rglob("*.py"))
    if ">>> " in path.read_text(encoding="utf-8")
]


@pytest.mark.parametrize("name", WITH_EXAMPLES)
def test_the_examples_in_docstrings_are_right(name: str) -> None:
    if name.endswith((".jax", ".torch")):
        pytest.importorskip(name.rpartition(".")[2])
    # What users know as a class of the package is found where it is asked for.
    module = import_module(name)
    assert doctest.testmod(cardan if name == "cardan.arrays.errors" else module).failed == 0


def test_the_help_begins_with_every_name_by_what_it_is_for() -> None:
    named = set(re.findall(r"``(\w+)``", (cardan.__doc__ or "").partition("What there is")[2]))
    assert {*vars(cardan)["__all__"], "scene", "files"} - {"__version__"} <= named
    assert all(hasattr(cardan, name) for name in named)

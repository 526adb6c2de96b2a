"""What conftest.py promises of every run of the tests."""

from __future__ import annotations

import importlib.util
import sys
from pathlib import Path

import hypothesis
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

RANDOM = np.random.default_rng(1)
FIRST = np.random.default_rng(1).random()

same_examples = pytest.mark.skipif(
    not hypothesis.settings().derandomize, reason="with --hypothesis-profile=fresh"
)


@same_examples
def test_examples_do_not_depend_on_the_modules_that_are_imported(tmp_path: Path) -> None:
    drawn: list[float] = []

    @given(st.lists(st.floats(), max_size=20))
    def draw(numbers: list[float]) -> None:
        drawn.extend(numbers)

    def examples() -> str:
        drawn.clear()
        draw()
        return repr(drawn)

    alone = examples()
    (tmp_path / "constants.py").write_text("NUMBERS = (1.2345678, 8.7654321)\n")
    spec = importlib.util.spec_from_file_location("constants", tmp_path / "constants.py")
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(sys.modules, "constants", module)
        spec.loader.exec_module(module)
        assert examples() == alone


@pytest.mark.parametrize("time", [1, 2])
def test_a_generator_that_tests_share_begins_anew_for_each_of_them(time: int) -> None:
    assert RANDOM.random() == FIRST

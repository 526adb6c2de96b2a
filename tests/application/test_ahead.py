"""A second thread reads ahead, in order and one item at a time."""

from __future__ import annotations

import gc
import threading
from collections.abc import Generator

import pytest

from cardan.app.files.recording import read_ahead


def _counting(made: list[int], end: int = 5) -> Generator[int]:
    try:
        for item in range(end):
            made.append(item)
            yield item
    finally:
        made.append(-1)


def test_items_come_in_order_and_are_made_elsewhere() -> None:
    """Items that count as false are items too."""
    threads = set()

    def items() -> Generator[int]:
        for item in (0, 0, 1):
            threads.add(threading.current_thread())
            yield item

    assert list(read_ahead(items())) == [0, 0, 1]
    assert len(threads) == 1
    assert threading.current_thread() not in threads


def test_one_item_is_made_ahead() -> None:
    made: list[int] = []
    items = read_ahead(_counting(made))
    for item in items:
        if item == 1:
            break
    items.close()
    # The generator was closed.
    assert made == [0, 1, 2, -1]


def test_an_error_arrives_after_the_items_before_it() -> None:
    def items() -> Generator[int]:
        yield 1
        raise ValueError("damaged")

    ahead = read_ahead(items())
    assert next(ahead) == 1
    with pytest.raises(ValueError, match="damaged"):
        next(ahead)


def test_an_abandoned_reader_ends_its_thread() -> None:
    """Whoever collects it may be inside anything, and must not wait for a thread that is gone."""
    made: list[int] = []
    items = read_ahead(_counting(made))
    next(items)
    circle: list[object] = [items]
    circle.append(circle)
    del items, circle
    gc.collect()
    assert made[-1] == -1
    assert not [one for one in threading.enumerate() if one.name.startswith("cardan-read")]

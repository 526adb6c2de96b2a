"""Work of a second thread: reading ahead and writing behind, in bounded memory."""

from __future__ import annotations

from collections.abc import Callable, Generator, Iterable
from contextlib import closing
from typing import TYPE_CHECKING, TypeVar

if TYPE_CHECKING:
    from concurrent.futures import Future

_Item = TypeVar("_Item")


def read_ahead(items: Generator[_Item]) -> Generator[_Item]:
    """Yield the items of a generator, while a second thread makes the next one.

    One item at most is ready ahead. The generator is closed with this one.
    """
    from concurrent.futures import ThreadPoolExecutor

    # After the thread has ended, because a generator that runs cannot be closed.
    with closing(items), ThreadPoolExecutor(1, "cardan-read") as thread:
        coming = thread.submit(_next, items)
        while item := coming.result():
            coming = thread.submit(_next, items)
            yield item[0]


def _next(items: Generator[_Item]) -> tuple[_Item] | None:
    for item in items:
        return (item,)
    return None


def write_behind(write: Callable[[_Item], None], items: Iterable[_Item]) -> Generator[_Item]:
    """Yield the items that are written, which a second thread does while the next one is made.

    One item at most is being written. Close the generator to wait for it.
    """
    from concurrent.futures import ThreadPoolExecutor

    with ThreadPoolExecutor(1, "cardan-write") as thread:
        writing: tuple[Future[None], _Item] | None = None
        for item in items:
            if writing:
                yield _written(*writing)
            writing = thread.submit(write, item), item
        if writing:
            yield _written(*writing)


def _written(writing: Future[None], item: _Item) -> _Item:
    writing.result()
    return item

"""Files that appear whole or not at all, and how long work reports how far it is."""

from __future__ import annotations

import contextlib
import errno
import os
import sys
import time
from collections.abc import Callable, Iterator
from os import PathLike
from pathlib import Path
from typing import IO

Progress = Callable[[int, int], None]
"""Takes the number of rows done and of all rows."""


def check_writable(path: str | PathLike[str]) -> None:
    """Refuse a file that could not be written, before the work for it is done."""
    with contextlib.suppress(_Tried), whole_file(path):
        raise _Tried


class _Tried(Exception):  # noqa: N818 - not an error
    """The file can be written."""


@contextlib.contextmanager
def whole_file(path: str | PathLike[str]) -> Iterator[IO[bytes]]:
    """Open a file to write that takes its name only when it is complete.

    It is written under another name in the same folder, brought to the disk and renamed. Whatever
    interrupts that, an exception, Ctrl-C or a full disk, leaves nothing behind, and an earlier file
    of the name untouched. What a process left that was killed is removed when the same file is
    written again. A link stays one; a folder, device or pipe is refused.
    """
    target = Path(os.path.realpath(path))
    if target.is_dir():
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), os.fspath(path))
    if os.path.exists(path) and not os.path.isfile(path):
        # Renaming would put a file in the place of a device.
        raise OSError(errno.EINVAL, "Not a plain file", os.fspath(path))
    _remove_abandoned(target)
    temporary = target.with_name(f"{_stem(target)}{os.urandom(8).hex()}.part")
    try:
        with contextlib.ExitStack() as held:
            with open(temporary, "xb") as file:
                _lock(file, held)
                yield file
                file.flush()
                os.fsync(file.fileno())
            os.replace(temporary, target)
    except BaseException as error:
        with contextlib.suppress(OSError):
            temporary.unlink()
        if isinstance(error, OSError):
            # The user knows nothing of the temporary name.
            reason = error.strerror or str(error)
            raise OSError(error.errno or errno.EIO, reason, os.fspath(path)) from error
        raise


def _stem(target: Path) -> str:
    """How the temporary names of a file begin: its own could be too long with more to it."""
    import hashlib

    digest = hashlib.sha256(os.fsencode(target.name)).hexdigest()
    return f".cardan-{digest[:12]}-"


def _remove_abandoned(target: Path) -> None:
    """Remove what processes that are gone left of the same file."""
    with contextlib.suppress(OSError), os.scandir(target.parent) as entries:
        stem = _stem(target)
        for entry in entries:
            if entry.name.startswith(stem) and entry.name.endswith(".part"):
                with contextlib.suppress(OSError):
                    _remove_unlocked(entry.path)


# A lock ends with its process, however that ends; a number of a process may belong to another, or
# to another machine. Windows keeps an open file from being removed without one.
if sys.platform == "win32":

    def _lock(file: IO[bytes], held: contextlib.ExitStack) -> None:
        pass

    def _remove_unlocked(path: str) -> None:
        os.unlink(path)

else:
    import fcntl

    _BEGUN = 60.0  # seconds

    def _lock(file: IO[bytes], held: contextlib.ExitStack) -> None:
        # A second descriptor, because the lock is to last until the file has its name.
        descriptor = os.dup(file.fileno())
        held.callback(os.close, descriptor)
        # Some network drives have no locks; there nothing is removed either.
        with contextlib.suppress(OSError):
            fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)

    def _remove_unlocked(path: str) -> None:
        with open(path, "rb") as file:
            found = os.fstat(file.fileno())
            # A file that was begun just now may not be locked yet.
            if found.st_size or time.time() - found.st_mtime > _BEGUN:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
                os.unlink(path)

"""Files that appear whole or not at all."""

from __future__ import annotations

import contextlib
import errno
import os
import secrets
from collections.abc import Iterator
from os import PathLike
from pathlib import Path
from typing import IO


def check_writable(path: str | PathLike[str]) -> None:
    """Refuse a file that could not be written, before the work for it is done.

    Raises:
        OSError: the folder takes no file, or the path is a folder; nothing is left behind.
    """
    with contextlib.suppress(_Tried), whole_file(path):
        raise _Tried


class _Tried(Exception):  # noqa: N818 - not an error
    """The file can be written."""


@contextlib.contextmanager
def whole_file(path: str | PathLike[str]) -> Iterator[IO[bytes]]:
    """Open a file to write that takes its name only when it is complete.

    It is written under another name in the same folder, brought to the disk and renamed. Whatever
    interrupts that, an exception, Ctrl-C or a full disk, leaves nothing behind, and an earlier file
    of the name untouched. A link stays one; a folder, device or pipe is refused.

    Raises:
        OSError: the file cannot be written; the error names ``path``.
    """
    target = Path(os.path.realpath(path))
    if target.is_dir():
        raise IsADirectoryError(errno.EISDIR, os.strerror(errno.EISDIR), os.fspath(path))
    if os.path.exists(path) and not os.path.isfile(path):
        # Renaming would put a file in the place of a device.
        raise OSError(errno.EINVAL, "Not a plain file", os.fspath(path))
    temporary = target.with_name(f".{secrets.token_hex(8)}.part")
    try:
        with open(temporary, "xb") as file:
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

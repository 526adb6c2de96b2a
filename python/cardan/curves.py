"""Curves of a scene as files: CSV, NPZ or Parquet, each whole or not there at all."""

from __future__ import annotations

import contextlib
import errno
import os
import secrets
from collections.abc import Callable, Iterator, Mapping
from os import PathLike
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

import numpy as np

from cardan.arrays import FloatArray
from cardan.outputs import OUTPUTS

if TYPE_CHECKING:
    from cardan.scene import SceneResult


def columns(result: SceneResult) -> dict[str, FloatArray]:
    """Return the curves as columns of equal length, angles in degrees, the rest in SI units.

    The names carry unit, joint and component: ``angle_error_deg``, ``moment_0_x_Nm``.
    """
    table = {"drive_angle_deg": result.scene.drive_angle_deg}
    for name, values in result.values.items():
        output = OUTPUTS[name]
        in_unit = np.degrees(values) if output.unit == "rad" else values
        unit = {"rad": "_deg", "1": ""}.get(output.unit, f"_{output.unit.replace(' ', '')}")
        parts = {name: in_unit}
        if output.per == "joint":
            parts = {f"{name}_{joint}": part for joint, part in enumerate(in_unit)}
        for part, curve in parts.items():
            if output.vector:
                table |= {f"{part}_{axis}{unit}": curve[:, i] for i, axis in enumerate("xyz")}
            else:
                table[f"{part}{unit}"] = curve
    return table


def write_curves(result: SceneResult, path: str | PathLike[str]) -> int:
    """Write the curves in the format that the path's suffix names and return the number of rows.

    CSV and Parquet hold the columns of ``columns``, CSV with every digit of the doubles. NPZ holds
    the arrays as evaluated, in SI units under the names of the outputs, and ``drive_angle`` in rad.

    Raises:
        ImportError: Parquet without pyarrow.
        OSError: the file cannot be written; nothing of it is left behind then.
        ValueError: an unknown suffix.
    """
    suffix = Path(path).suffix
    if suffix not in SUFFIXES:
        raise ValueError(f"{os.fspath(path)} must end in {' or '.join(SUFFIXES)}")
    with whole_file(path) as file:
        SUFFIXES[suffix](result, file)
    return len(result.scene.drive_angle_deg)


def _write_csv(result: SceneResult, file: IO[bytes]) -> None:
    table = columns(result)
    file.write(f"{','.join(table)}\n".encode())
    # In blocks, because a float as an object takes four times the memory.
    for first in range(0, len(result.scene.drive_angle_deg), _BLOCK):
        block = (curve[first : first + _BLOCK].tolist() for curve in table.values())
        file.writelines(
            f"{','.join(map(repr, row))}\n".encode() for row in zip(*block, strict=True)
        )


_BLOCK = 10_000


def _write_npz(result: SceneResult, file: IO[bytes]) -> None:
    arrays: dict[str, Any] = {"drive_angle": result.drive_angle, **result.values}
    np.savez(file, **arrays)


def _write_parquet(result: SceneResult, file: IO[bytes]) -> None:
    try:
        import pyarrow
        from pyarrow import parquet
    except ModuleNotFoundError:
        hint = "a .parquet file needs pyarrow: pip install 'cardan[table]'"
        raise ModuleNotFoundError(hint) from None
    parquet.write_table(pyarrow.table(columns(result)), file)


SUFFIXES: Mapping[str, Callable[[SceneResult, IO[bytes]], None]] = {
    ".csv": _write_csv,
    ".npz": _write_npz,
    ".parquet": _write_parquet,
}
"""Formats of a curves file, by suffix."""


@contextlib.contextmanager
def whole_file(path: str | PathLike[str]) -> Iterator[IO[bytes]]:
    """Open a file to write that takes its name only when it is complete.

    It is written under another name in the same folder, brought to the disk and renamed. Whatever
    interrupts that, an exception, Ctrl-C or a full disk, leaves nothing behind, and an earlier file
    of the name untouched.

    Raises:
        OSError: the file cannot be written; the error names ``path``.
    """
    target = Path(path)
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

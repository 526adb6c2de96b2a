"""Channels of MDF files, the format of measuring systems (ASAM), as columns of equal length."""

from __future__ import annotations

import contextlib
import io
import logging
import os
import shutil
import tempfile
import traceback
from collections.abc import Iterator, Sequence
from os import PathLike
from typing import Any, BinaryIO

import numpy as np

from cardan.app.files.delimited import parts_of, place_of_column, short
from cardan.arrays import FloatArray, import_optional

# What an MDF file begins with; the second is of a file whose logger was switched off.
_BEGINNINGS = (b"MDF     ", b"UnFinMF ")

_MOST_ROWS = 100_000_000

# Records of equal bytes shrink by some 33 000 in the best compression of the format.
_COMPRESSED = 100_000


def read_mdf(
    path: str | PathLike[str], names: Sequence[str], rows: int | None, raster_s: float | None
) -> Iterator[tuple[list[FloatArray], int]]:
    """Yield channels of an MDF file as columns, and the number of all rows; invalid ones are NaN.

    The channels are those of one channel group, whose master channel, the time, is a column like
    the others. With a raster they may belong to any groups and are interpolated linearly. At most
    ``rows`` come at a time, or all; ``raster_s`` are the steps of a raster, while all of the
    channels are recorded. A ``ValueError`` tells channels that are missing, not of numbers or of
    several groups without a raster, and a damaged file.
    """
    with _opened(path) as file:
        groups = _groups(file, names)
        named = set().union(*groups)
        for group in named | {_time_group(file, group) for group in named}:
            _check_size(file.groups[group].channel_group, os.path.getsize(path))
        shared = set.intersection(*map(set, groups))
        if raster_s is not None:
            yield from _resampled(file, names, groups, raster_s, rows)
            return
        if not shared:
            raise ValueError(_apart(names, groups))
        group = min(shared)
        total = int(file.groups[group].channel_group.cycles_nr)
        for part in parts_of(total, rows):
            some = {"record_offset": part.start, "record_count": part.stop - part.start}
            yield [_numbers(file, name, group, **some) for name in names], total


@contextlib.contextmanager
def _opened(path: str | PathLike[str]) -> Iterator[Any]:
    asammdf = import_optional("asammdf", "mdf")
    # It logs on standard error what is wrong with a file; here that is the message of the error.
    logging.getLogger("asammdf").setLevel(logging.CRITICAL)
    # Opened here, because asammdf leaves a damaged file open.
    with open(path, "rb") as source, _finishable(source) as content:
        try:
            # It prints what it cannot finish.
            with contextlib.redirect_stdout(io.StringIO()):
                file = asammdf.MDF(content)
        except Exception as error:
            # Of a damaged file asammdf raises whatever its bytes lead to.
            reason = short(" ".join(str(error).split()))
            _call_closed(error)
            raise ValueError(f"not a readable MDF file: {reason}") from None
        with file:
            yield file


@contextlib.contextmanager
def _finishable(source: BinaryIO) -> Iterator[BinaryIO]:
    """Check the beginning of a file; of an unfinished one yield a copy.

    asammdf writes into the file what its logger left out, such as the length of the data.
    """
    begin = source.read(64)
    if begin[:8] not in _BEGINNINGS:
        raise ValueError("not an MDF file")
    source.seek(0)
    if begin[:8] == _BEGINNINGS[0] and not any(begin[60:64]):
        yield source
        return
    with tempfile.TemporaryFile() as copy:
        shutil.copyfileobj(source, copy)
        copy.seek(0)
        yield copy


def _call_closed(error: Exception) -> None:
    """Close the temporary file of a half-read one and tell it that it is closed.

    asammdf closes it once more when it is removed, which fails for want of what was not read, and
    Python would print that as a second error.
    """
    for frame, _ in traceback.walk_tb(error.__traceback__):
        half_read: Any = frame.f_locals.get("self")
        if type(half_read).__name__ in ("MDF3", "MDF4"):
            half_read._closed = True
            if half_read._tempfile is not None:
                half_read._tempfile.close()


def _groups(file: Any, names: Sequence[str]) -> list[list[int]]:  # noqa: ANN401 - of asammdf
    """The channel groups of each channel."""
    # A channel has further names with its device in front.
    known = [name for name in file.channels_db if "\\" not in name or name in names]
    for name in names:
        place_of_column(name, known)
    return [sorted({group for group, _ in file.channels_db[name]}) for name in names]


def _check_size(group: Any, size: int) -> None:  # noqa: ANN401 - of asammdf
    """Refuse records that cannot be in the file, before asammdf makes room for them."""
    each = group.samples_byte_nr + getattr(group, "invalidation_bytes_nr", 0)
    if max(1, group.cycles_nr) * each > _COMPRESSED * size:
        raise ValueError(
            f"it is damaged: a file of {size} bytes cannot hold {group.cycles_nr} rows of "
            f"{each} bytes"
        )


def _apart(names: Sequence[str], groups: Sequence[Sequence[int]]) -> str:
    """Say of which groups channels are that have none in common."""
    parts = (
        f"{name!r} in {', '.join(map(str, found))}"
        for name, found in zip(names, groups, strict=True)
    )
    return short(
        "the channels do not share their times; the channel groups are "
        f"{'; '.join(parts)}; raster_s of [angles] resamples measured speeds"
    )


def _numbers(
    file: Any,  # noqa: ANN401 - of asammdf
    name: str,
    group: int,
    **part: int,
) -> FloatArray:
    """Some rows of a channel; those that the logger marked as invalid are NaN."""
    places = [index for found, index in file.channels_db[name] if found == group]
    if len(places) > 1:
        raise ValueError(f"column {name!r} appears {len(places)} times in channel group {group}")
    _check_place(file.groups[group], places[0], f"column {name!r}")
    try:
        samples, invalid = file.get(
            group=group, index=places[0], samples_only=True, ignore_invalidation_bits=True, **part
        )
    except Exception as error:
        raise _unreadable(f"column {name!r}", error) from None
    if samples.ndim != 1 or samples.dtype.kind not in "fiub":
        raise ValueError(
            f"column {name!r} has shape {samples.shape} and dtype {samples.dtype}; "
            "it must hold numbers in one dimension"
        )
    column = samples.astype(np.float64)
    if invalid is not None:
        column[np.asarray(invalid, bool)] = np.nan
    return np.asarray(column, np.float64)


def _times(file: Any, name: str, group: int) -> FloatArray:  # noqa: ANN401 - of asammdf
    """The times of all rows of a channel, or their numbers if the group has no times."""
    what = f"the time of column {name!r}"
    of = _time_group(file, group)
    master = file.masters_db.get(of)
    if master is not None:
        _check_place(file.groups[of], master, what)
    try:
        return np.asarray(file.get_master(group), np.float64)
    except Exception as error:
        raise _unreadable(what, error) from None


def _time_group(file: Any, group: int) -> int:  # noqa: ANN401 - of asammdf
    """The channel group that holds the times of a group: itself, or another one."""
    remote = getattr(file.groups[group].channel_group, "cg_master_index", None)
    return group if remote is None else int(remote)


def _unreadable(what: str, error: Exception) -> ValueError:
    # Of damaged records asammdf raises whatever their bytes lead to.
    reason = short(" ".join(str(error).split()))
    return ValueError(f"{what} is not readable: {reason}")


def _check_place(group: Any, index: int, what: str) -> None:  # noqa: ANN401 - of asammdf
    """Refuse a channel outside the records of its group.

    asammdf would read beyond its buffer, which ends the process.
    """
    channel = group.channels[index]
    if hasattr(channel, "byte_offset"):
        first = 8 * channel.byte_offset + channel.bit_offset
    else:
        first = 8 * channel.additional_byte_offset + channel.start_offset
    if first + channel.bit_count > 8 * group.channel_group.samples_byte_nr:
        raise ValueError(f"{what} lies outside the records of its channel group")


def _resampled(
    file: Any,  # noqa: ANN401 - of asammdf
    names: Sequence[str],
    groups: Sequence[Sequence[int]],
    raster_s: float,
    rows: int | None,
) -> Iterator[tuple[list[FloatArray], int]]:
    signals: list[tuple[FloatArray, FloatArray] | None] = []
    for name, (group, *_) in zip(names, groups, strict=True):
        if (group, file.masters_db.get(group)) in file.channels_db[name]:
            # The times themselves.
            signals.append(None)
            continue
        values = _numbers(file, name, group)
        time = _times(file, name, group)
        known = ~(np.isnan(time) | np.isnan(values))
        if not known.any():
            raise ValueError(f"column {name!r} has no numbers")
        if not np.all(np.diff(time[known]) > 0.0):
            raise ValueError(f"the times of column {name!r} do not increase")
        signals.append((time[known], values[known]))
    spans = [(time[0], time[-1]) for time, _ in filter(None, signals)]
    if not spans:
        raise ValueError("raster_s needs a channel besides the time")
    first, last = max(begin for begin, _ in spans), min(end for _, end in spans)
    if last < first:
        raise ValueError("the channels have no time in common")
    # A rounding error must not cost the last sample.
    total = int(min((last - first) / raster_s * (1.0 + 1e-12), float(_MOST_ROWS))) + 1
    if total > _MOST_ROWS:
        raise ValueError(f"raster_s is {raster_s:g}; that makes more than {_MOST_ROWS} rows")
    for part in parts_of(total, rows):
        time = first + raster_s * np.arange(part.start, part.stop)
        yield [time if of is None else np.interp(time, *of) for of in signals], total

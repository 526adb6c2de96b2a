"""The exact bits of the evaluations in ``bits_cases.py``, recorded and compared.

``python tests/bits.py record FILE`` writes a digest of every array. ``python tests/bits.py compare
FILE`` names those that differ, are missing or are new, and fails if a recorded one differs or is
missing. A change that is not meant to change a result leaves every digest as it is.

A record holds for x86-64 and arm64 with glibc. It depends neither on the instruction set nor on the
number of threads. The sines of phases and twists, ``from_points``, ``equivalent`` and
``optimal_phases`` call libm: another one may differ in the last bit there and in all that follows.
``harmonics`` calls NumPy's powers and exponentials, which may differ between processors: only 12
digits of its results count. The bits of a NaN do not count either.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bits_cases import GROUPS


def digest(array: NDArray[Any]) -> str:
    values = np.ascontiguousarray(array)
    if values.dtype.kind == "f":
        values = np.where(np.isnan(values), np.array(np.nan, values.dtype), values)
    head = f"{values.dtype.str} {np.shape(array)} ".encode()
    return hashlib.sha256(head + values.tobytes()).hexdigest()[:16]


def found() -> dict[str, str]:
    """Evaluate every case; return the digests by ``group: case/output``."""
    digests: dict[str, str] = {}
    for group in GROUPS:
        for name, arrays in group():
            for output, array in arrays.items():
                key = f"{group.__name__[3:]}: {name}/{output}"
                assert key not in digests, f"{key} is there twice"
                digests[key] = digest(array)
    return digests


def write(file: Path, digests: Mapping[str, str]) -> None:
    """Write a line per case, under the names of its outputs: named once they take little space."""
    cases: dict[str, dict[str, str]] = {}
    for key, bits in digests.items():
        name, _, output = key.rpartition("/")
        cases.setdefault(name, {})[output] = bits
    tables: dict[str, dict[str, str]] = {}
    for name, own in cases.items():
        tables.setdefault(" ".join(own), {})[name] = " ".join(own.values())
    file.write_text(json.dumps(tables, indent=0) + "\n")


def read(file: Path) -> dict[str, str]:
    return {
        f"{name}/{output}": bits
        for outputs, cases in json.loads(file.read_text()).items()
        for name, row in cases.items()
        for output, bits in zip(outputs.split(), row.split(), strict=True)
    }


def differences(file: Path) -> tuple[list[str], list[str]]:
    """Return what is not as recorded, and what is new."""
    want, got = read(file), found()
    wrong = [f"missing: {key}" for key in want if key not in got]
    wrong += [f"differs: {key}" for key in want if key in got and got[key] != want[key]]
    return wrong, [f"new: {key}" for key in got if key not in want]


def main() -> int:
    parser = argparse.ArgumentParser(description="Record or compare the bits of evaluations.")
    parser.add_argument("what", choices=("record", "compare"))
    parser.add_argument("file", type=Path)
    given = parser.parse_args()
    if given.what == "record":
        write(given.file, found())
        return 0
    wrong, new = differences(given.file)
    print("\n".join([*wrong, *new, f"{len(wrong)} are not as recorded, {len(new)} are new"]))
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())

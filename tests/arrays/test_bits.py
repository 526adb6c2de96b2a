"""The bits of today are those of the record."""

from __future__ import annotations

import platform

import pytest

from bits import differences
from oracle import DATA

RECORD = DATA / "bits.json"


@pytest.mark.skipif(
    platform.machine() not in ("x86_64", "AMD64") or platform.libc_ver()[0] != "glibc",
    reason="the record holds for x86-64 with the libm of glibc",
)
def test_bits_are_those_recorded() -> None:
    wrong, new = differences(RECORD)
    assert not wrong, "\n".join([f"{len(wrong)} are not as recorded", *wrong])
    assert not new, "\n".join(["record anew: python tests/bits.py record", *new])

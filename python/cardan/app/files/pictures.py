"""Formats of picture files."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

# What makes a file differ from run to run is left out.
SUFFIXES: Mapping[str, dict[str, Any]] = {
    ".svg": {"Date": None},
    ".png": {},
    ".pdf": {"CreationDate": None},
}
"""Formats of a picture file, by suffix, and the metadata to write."""

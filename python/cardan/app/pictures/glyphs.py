"""Fonts for the characters of a picture's texts, such as those of a Chinese title."""

from __future__ import annotations

import contextlib
import warnings
from collections.abc import Iterator
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from matplotlib.text import Text

_MOST = 8


@contextlib.contextmanager
def with_glyphs(figure: Figure) -> Iterator[None]:
    """Give the texts of a figure fonts that have their characters, as far as any is installed.

    One warning names the characters that no font has, in place of matplotlib's one for each.
    """
    from matplotlib.text import Text

    # A dict keeps the order of the text.
    lacking: dict[str, None] = {}
    for text in figure.findobj(Text):
        if isinstance(text, Text) and not text.get_text().isascii():
            lacking |= dict.fromkeys(_supplied(text))
    if lacking:
        named = "".join(list(lacking)[:_MOST]) + ("…" if len(lacking) > _MOST else "")
        warnings.warn(
            f"no installed font has the characters {named}; the picture shows boxes in their place",
            stacklevel=2,
        )
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", r"Glyph \d+ .* missing from")
        yield


def _supplied(text: Text) -> list[str]:
    """Add the font that has most of the missing characters; return those that it lacks too."""
    from matplotlib.font_manager import findfont, fontManager

    lacking = _lacking(findfont(text.get_fontproperties()), text.get_text())
    if not lacking:
        return []
    # Upright fonts of ordinary weight first; Last Resort has a box for every character.
    entries = sorted(
        (entry for entry in fontManager.ttflist if not entry.name.startswith("Last")),
        key=lambda entry: (entry.style != "normal", entry.weight not in (400, "normal")),
    )
    found = min(entries, key=lambda entry: len(_lacking(entry.fname, lacking)))
    left = _lacking(found.fname, lacking)
    if len(left) < len(lacking):
        text.set_fontfamily([*text.get_fontfamily(), found.name])
    return left


def _lacking(font: str, characters: str | list[str]) -> list[str]:
    from matplotlib.font_manager import get_font

    known = get_font(font).get_charmap()
    return [c for c in characters if c.isprintable() and not c.isspace() and ord(c) not in known]

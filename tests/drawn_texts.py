"""Figures as they are drawn, and every text of them with its place."""

from __future__ import annotations

import pytest
from matplotlib.backend_bases import RendererBase
from matplotlib.figure import Figure
from matplotlib.text import Text
from matplotlib.transforms import Bbox

from cardan.app.plots import plot_scene
from cardan.app.scene import SceneResult


def drawn(result: SceneResult) -> Figure:
    figure = plot_scene(result)
    figure.draw_without_rendering()
    return figure


def texts(
    figure: Figure, monkeypatch: pytest.MonkeyPatch, largest: float = 8.0
) -> list[tuple[str, Bbox]]:
    """Every text as it is drawn and its place; ticks out of view are not drawn."""
    found: list[tuple[str, Bbox]] = []
    draw = Text.draw

    def record(self: Text, renderer: RendererBase) -> None:
        draw(self, renderer)
        if self.get_visible() and self.get_text():
            assert 5.8 < float(self.get_fontsize()) <= largest, self.get_text()
            found.append((self.get_text(), Text.get_window_extent(self, renderer)))

    monkeypatch.setattr(Text, "draw", record)
    figure.draw_without_rendering()
    monkeypatch.undo()
    return found

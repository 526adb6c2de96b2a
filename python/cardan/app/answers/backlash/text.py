"""Lash and wind-up in words."""

from __future__ import annotations

import numpy as np

from cardan.app.answers.backlash.figures import Backlash
from cardan.app.answers.printed import figure_text
from cardan.design.wrapping import fill


def words(found: Backlash, *, radians: bool = False) -> str:
    """Say how far the last shaft is loose, and how far the torque winds it up."""
    text = f"With the drive held the last shaft is loose by {_range(found.lash, radians)}."
    if np.any(found.wind_up):
        wound = _range(found.wind_up, radians)
        text += (
            f" {figure_text(found.torque)} N m at the {found.end} wind it up by {wound} beyond "
            "that, either way."
        )
    return fill(f"Play in the joints. {text}", 79, break_on_hyphens=False)


def _range(angles: np.ndarray[tuple[int, ...], np.dtype[np.float64]], radians: bool) -> str:
    low, high = (
        figure_text(float(end if radians else np.degrees(end)))
        for end in (angles.min(), angles.max())
    )
    unit = " rad" if radians else "°"
    if low == high:
        return f"{low}{unit}"
    return f"{low}{unit} to {high}{unit} over the turn"

"""Palette of differences, from too low over equal to too high."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from PySide6.QtGui import QColor

from insonify_viewer.widgets.pixels import colour_table
from insonify_viewer.widgets.theme import ACCENT, GROUND, MARK


def two_sided_table() -> NDArray[np.uint32]:
    """Colour table of 256 differences: equal is the ground of the window, lower is blue, higher is copper."""
    low, none, high = (np.array([c.red(), c.green(), c.blue()], float) for c in map(QColor, (MARK, GROUND, ACCENT)))
    share = np.linspace(-1.0, 1.0, 256)[:, None]
    mixed = none + np.maximum(-share, 0.0) * (low - none) + np.maximum(share, 0.0) * (high - none)
    return colour_table(np.rint(mixed).astype(np.uint8))

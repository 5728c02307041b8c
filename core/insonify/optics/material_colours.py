"""Colours of materials: as shown on a screen, and as linear hues for light that is summed."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

COLOURS = {
    "silt": (0.47, 0.45, 0.38),
    "fine_sand": (0.83, 0.74, 0.55),
    "medium_sand": (0.80, 0.68, 0.47),
    "coarse_sand": (0.72, 0.58, 0.40),
    "sandy_gravel": (0.60, 0.53, 0.45),
    "cobble": (0.50, 0.48, 0.45),
    "rock": (0.40, 0.39, 0.39),
    "concrete": (0.66, 0.66, 0.64),
    "steel": (0.50, 0.52, 0.55),
    "mirror": (0.80, 0.84, 0.88),
}
LUMINANCE = np.array([0.2126, 0.7152, 0.0722])  # of linear red, green, blue


def hues(rows: tuple[str, ...]) -> NDArray[np.float64]:
    """Linear colours of rows of the material table, (n, 3), scaled to a luminance of 1."""
    linear = np.array([sum(share * np.array(COLOURS[name]) for name, share in shares_of(row)) for row in rows]) ** 2.2
    return np.asarray(linear / (linear @ LUMINANCE)[:, np.newaxis])


def shares_of(row: str) -> list[tuple[str, float]]:
    """Materials and their shares in a row's name: ``25.1_silt+74.9_rock``, or one name alone."""
    parts = [part.partition("_") for part in row.split("+")]
    return [(name, float(percent) / 100.0) for percent, _, name in parts] if "+" in row else [(row, 1.0)]

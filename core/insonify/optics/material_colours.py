"""Colours of materials: as shown on a screen, and as linear hues for light that is summed."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from insonify.scene.seabed.materials import MATERIALS

LUMINANCE = np.array([0.2126, 0.7152, 0.0722])  # of linear red, green, blue
Shares = Sequence[tuple[str, float]]


def hues(rows: tuple[str, ...]) -> NDArray[np.float64]:
    """Linear colours of rows of the material table, (n, 3), scaled to a luminance of 1."""
    linear = np.array([mixed_colour(shares_of(row)) for row in rows]) ** 2.2
    return np.asarray(linear / (linear @ LUMINANCE)[:, np.newaxis])


def mixed_colour(shares: Shares) -> NDArray[np.float64]:
    """Mean colour of named materials by their shares, (3,)."""
    return np.asarray(sum(share * np.array(MATERIALS[name].colour) for name, share in shares))


def shares_of(row: str) -> Shares:
    """Materials and their shares in a row's name: ``25.1_silt+74.9_rock``, or one name alone."""
    parts = [part.partition("_") for part in row.split("+")]
    return [(name, float(percent) / 100.0) for percent, _, name in parts] if "+" in row else [(row, 1.0)]

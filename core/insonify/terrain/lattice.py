"""Grid of a bed: number, size and position of its cells."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Map = NDArray[np.uint8]


@dataclass(frozen=True)
class Lattice:
    """Number, spacing and position of the cells of a bed."""

    shape: tuple[int, int]  # (int, int) cells along y and x
    spacing: float  # metres between nodes
    x0: float = 0.0  # local coordinates of node (0, 0), in metres
    y0: float = 0.0
    periodic: bool = True  # whether the bed repeats

    @property
    def size(self) -> tuple[float, float]:
        """Extent along x and y in metres, the periods of a periodic bed."""
        return self.shape[1] * self.spacing, self.shape[0] * self.spacing

    def centres(self) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
        """Local x and y of the centres of the cells, (nx,) and (ny,), in metres."""
        ny, nx = self.shape
        x = self.x0 + (np.arange(nx, dtype=np.float64) + 0.5) * self.spacing
        y = self.y0 + (np.arange(ny, dtype=np.float64) + 0.5) * self.spacing
        return x, y

"""Measured beds: a file's grid becomes heights on a square grid in the scene's own coordinates."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from insonify.io.bathymetry import BATHYMETRY, Grid, read_grid
from insonify.io.file_cache import kept_until_changed
from insonify.scene.reliefs.dem import Dem

HIGHEST = 2e4  # m, of any bed, up or down
SQUARE = 1e-6  # relative difference of spacings that still counts as square
_read_grid = kept_until_changed(maxsize=2)(read_grid)


@dataclass(frozen=True, eq=False)
class Measured:
    """A measured bed on a square grid.

    Attributes
    ----------
    heights : (ny, nx) float64
        World heights in metres, NaN where there is no bed.
    spacing : float
        Metres between nodes.
    x0, y0 : float
        Local coordinates of node (0, 0), in metres.
    """

    heights: NDArray[np.float64]
    spacing: float
    x0: float
    y0: float


def measured_bed(dem: Dem, spacing: float, origin: tuple[float, float] | None) -> Measured:
    """Read a bed and place it.

    Parameters
    ----------
    dem : Dem
        File, and what scales and shifts its heights.
    spacing : float
        Metres between nodes, for files that do not say.
    origin : (float, float), optional
        Map coordinates of the local (0, 0); the centre of the grid when left out or when the file has none.
    """
    grid = _squared(_read_grid(dem.path), spacing)
    step = spacing if grid.spacing is None else grid.spacing[0]
    ny, nx = grid.heights.shape
    x0, y0 = -0.5 * (nx - 1) * step, -0.5 * (ny - 1) * step
    if origin is not None and grid.corner is not None:
        # Map coordinates reach millions of metres: subtract before anything becomes float32.
        x0, y0 = grid.corner[0] - origin[0], grid.corner[1] - origin[1]
    return Measured(_on_earth(dem, grid.heights * dem.scale + dem.datum), step, x0, y0)


def _on_earth(dem: Dem, heights: NDArray[np.float64]) -> NDArray[np.float64]:
    """Refuse heights that no bed has: a number that was to say "none", or another unit."""
    low, high = float(np.nanmin(heights)), float(np.nanmax(heights))
    if not -HIGHEST <= low <= high <= HIGHEST:
        raise BATHYMETRY.refusal(
            dem.path, f"has heights from {low:g} to {high:g} m", "declare its nodata value, or turn its unit by scale"
        )
    return heights


def _squared(grid: Grid, spacing: float) -> Grid:
    """Bring a grid of oblong cells to the finer of its two spacings."""
    dx, dy = grid.spacing or (spacing, spacing)
    if abs(dx - dy) <= SQUARE * min(dx, dy):
        return grid
    fine = min(dx, dy)
    heights = _resampled(_resampled(grid.heights, dx / fine).T, dy / fine).T
    return Grid(np.ascontiguousarray(heights), (fine, fine), grid.corner)


def _resampled(heights: NDArray[np.float64], ratio: float) -> NDArray[np.float64]:
    """Interpolate along the last axis to ``ratio`` times as many nodes; a gap stays a gap."""
    if ratio <= 1.0 + SQUARE:
        return heights
    last = heights.shape[1] - 1
    places = np.arange(int(last * ratio + SQUARE) + 1) / ratio
    low = np.minimum(places.astype(np.int64), last - 1)
    share = places - low
    return heights[:, low] * (1.0 - share) + heights[:, low + 1] * share

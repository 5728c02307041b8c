"""A measured bed."""

from typing import Literal

import numpy as np

from insonify.arrays import Floats
from insonify.errors import SceneError
from insonify.files import kept_until_changed
from insonify.io.bathymetry import BATHYMETRY, LARGEST_SIDE, Grid, read_grid
from insonify.io.georeference import Georeference
from insonify.scene.base import FilePath, parameter
from insonify.scene.seabed.reliefs import AddableRelief, HeightGrid

HIGHEST = 2e4  # m, of any bed, up or down
SQUARE = 1e-6  # relative difference of spacings that still counts as square
_read_grid = kept_until_changed(maxsize=2)(read_grid)


class Dem(AddableRelief, kind="dem", rank=90):
    """A measured bed: a grid of heights from a file."""

    measured = True
    path: FilePath = parameter(
        description="grid of heights or depths: GeoTIFF, BAG, S-102, .asc, .npy or .npz", min_length=1
    )
    positive: Literal["auto", "up", "down"] = parameter(
        "auto", "sign of the numbers of the file: heights (up), depths (down), or as the file states (auto)", rare=True
    )
    datum: float = parameter(0.0, "height that is added to every height of the file", "m", ge=-2e4, le=2e4)
    scale: float = parameter(1.0, "factor of every height, before the datum is added", gt=0.0, le=1e3)

    def sample(
        self, spacing: float, origin: tuple[float, float] | None = None, shape: tuple[int, int] | None = None
    ) -> HeightGrid:
        """Read the bed; its centre is at the local (0, 0) unless file and scene give map coordinates."""
        if shape is not None:
            raise SceneError(f"shape: {shape} cannot be set for a measured bed, which has its own grid; leave it out")
        grid = _squared(self.path, _read_grid(self.path), spacing)
        step = spacing if grid.spacing is None else grid.spacing[0]
        ny, nx = grid.heights.shape
        x0, y0 = -0.5 * (nx - 1) * step, -0.5 * (ny - 1) * step
        if origin is not None and grid.corner is not None:
            # Map coordinates reach millions of metres: subtract before anything becomes float32.
            x0, y0 = grid.corner[0] - origin[0], grid.corner[1] - origin[1]
        down = grid.depths if self.positive == "auto" else self.positive == "down"
        factor = -self.scale if down else self.scale
        return HeightGrid(_checked(self, grid.heights * factor + self.datum, down), step, x0, y0)

    def georeference(self, origin: tuple[float, float] | None) -> Georeference | None:
        """Map coordinates of the local (0, 0); None if the file has no coordinates."""
        grid = _read_grid(self.path)
        if grid.corner is None or grid.spacing is None:
            return None
        ny, nx = grid.heights.shape
        centre = grid.corner[0] + 0.5 * (nx - 1) * grid.spacing[0], grid.corner[1] + 0.5 * (ny - 1) * grid.spacing[1]
        return Georeference(grid.crs, centre if origin is None else origin)


def _checked(dem: Dem, heights: Floats, down: bool) -> Floats:
    """World heights, checked for undeclared nodata values, other units and depths read as heights."""
    low, high = float(np.nanmin(heights)), float(np.nanmax(heights))
    if not -HIGHEST <= low <= high <= HIGHEST:
        raise BATHYMETRY.refusal(
            dem.path,
            f"has heights from {low:g} to {high:g} m",
            "declare its nodata value, or convert its unit with scale",
        )
    if low > 0.0:
        raise BATHYMETRY.refusal(
            dem.path,
            f"lies from {low:g} to {high:g} m above the sea surface",
            f"write positive = {'up' if down else 'down'!r} if its numbers are {'heights' if down else 'depths'}, "
            "or lower it with datum",
        )
    return heights


def _squared(path: str, grid: Grid, spacing: float) -> Grid:
    """Grid with square cells of the finer of its two spacings."""
    dx, dy = grid.spacing or (spacing, spacing)
    if abs(dx - dy) <= SQUARE * min(dx, dy):
        return grid
    fine = min(dx, dy)
    ny, nx = grid.heights.shape
    if max(ny * dy, nx * dx) > LARGEST_SIDE * fine:
        raise BATHYMETRY.refusal(
            path, f"has cells of {dx:g} by {dy:g} m", f"resample it to square ones, at most {LARGEST_SIDE} a side"
        )
    heights = refine(refine(grid.heights, dx / fine).T, dy / fine).T
    if not np.isfinite(heights).any():  # a height between two nodes needs both
        raise BATHYMETRY.refusal(
            path, f"has only single heights between gaps, in cells of {dx:g} by {dy:g} m", "fill its gaps"
        )
    return Grid(np.ascontiguousarray(heights), (fine, fine), grid.corner, grid.crs, grid.depths)


def refine(heights: Floats, ratio: float) -> Floats:
    """Interpolate heights linearly along the last axis; gaps stay gaps."""
    if ratio <= 1.0 + SQUARE:
        return heights
    last = heights.shape[1] - 1
    places = np.arange(int(last * ratio + SQUARE) + 1) / ratio
    low = np.minimum(places.astype(np.int64), last - 1)
    share = places - low
    return heights[:, low] * (1.0 - share) + heights[:, low + 1] * share

"""A measured map of backscatter as a map of materials."""

from __future__ import annotations

from functools import partial
from typing import Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import model_validator

from insonify.errors import SceneError
from insonify.files import kept_until_changed
from insonify.io.bathymetry import Grid
from insonify.io.bathymetry.rasters import read_raster
from insonify.io.file_access import check_regular, guarded
from insonify.io.georeference import Georeference, project
from insonify.scene.base import FilePath, parameter
from insonify.scene.seabed.materials import Cells, CompositeMap, Map, Material
from insonify.scene.seabed.materials.image import LARGEST_SIDE


class BackscatterMap(CompositeMap):
    """A raster of backscatter with map coordinates; pixels without a value take the nearest one."""

    rank = 6
    on_a_map = True
    kind: Literal["backscatter"] = "backscatter"
    path: FilePath = parameter(description="GeoTIFF of one band, with its coordinate reference system", min_length=1)
    of: tuple[Material, ...] = parameter(
        description="materials from the lowest to the highest values", min_length=2, max_length=32
    )
    levels: tuple[float, ...] = parameter(
        (), description="values that separate successive materials; equal shares of the raster when left out"
    )

    @model_validator(mode="after")
    def _levels_part_the_materials(self) -> BackscatterMap:
        if self.levels and len(self.levels) != len(self.of) - 1:
            raise ValueError(
                f"levels has {len(self.levels)} values for {len(self.of)} materials; give one value less than materials"
            )
        if any(high <= low for low, high in zip(self.levels, self.levels[1:])):
            raise ValueError("levels does not increase; sort it")
        return self

    def indices(self, cells: Cells) -> Map:
        """Material of the pixel at each cell; on a periodic bed, the raster repeats after its own size."""
        grid, classes = _read(self.path, len(self.of), self.levels)
        if cells.place is None or grid.corner is None or grid.spacing is None:
            raise _refusal(
                self.path,
                "has no position on the bed",
                "give a raster with coordinates, and world.origin and world.crs or a measured bed",
            )
        x, y = _on_its_map(grid, cells.place, *np.meshgrid(*cells.centres()))
        rows, columns = classes.shape
        i = np.floor((x - grid.corner[0]) / grid.spacing[0] + 0.5).astype(np.int64)
        j = np.floor((y - grid.corner[1]) / grid.spacing[1] + 0.5).astype(np.int64)
        if cells.periodic:
            return np.ascontiguousarray(classes[j % rows, i % columns])
        return np.ascontiguousarray(classes[np.clip(j, 0, rows - 1), np.clip(i, 0, columns - 1)])

    def level_shape(self, spacing: float, fewest: int, most: int) -> tuple[int, int]:
        """Cells along y and x that the raster covers."""
        grid, classes = _read(self.path, len(self.of), self.levels)
        dx, dy = grid.spacing or (spacing, spacing)
        ny, nx = (max(fewest, round(count * step / spacing)) for count, step in zip(classes.shape, (dy, dx)))
        if max(ny, nx) > LARGEST_SIDE:
            raise _refusal(self.path, f"covers {nx} by {ny} cells of {spacing:g} m", "crop it or widen seabed.spacing")
        return ny, nx


@kept_until_changed(maxsize=2)
def _read(path: str, count: int, levels: tuple[float, ...]) -> tuple[Grid, Map]:
    """Read a raster, and the material of each pixel, southernmost row first."""
    with guarded(partial(_refusal, path), "give a GeoTIFF of one band"):
        check_regular(path)
        grid = read_raster(path)
    known = np.isfinite(grid.heights)
    if not known.any():
        raise _refusal(path, "has no valid pixel", "check its nodata value")
    values = grid.heights
    if not known.all():
        from scipy.ndimage import distance_transform_edt  # lazy: the command starts without SciPy

        nearest = distance_transform_edt(~known, return_distances=False, return_indices=True)
        values = values[tuple(nearest)]
    cuts = np.array(levels) if levels else np.quantile(grid.heights[known], np.arange(1, count) / count)
    return grid, np.searchsorted(cuts, values, side="right").astype(np.uint8)


def _on_its_map(
    grid: Grid, place: Georeference, x: NDArray[np.float64], y: NDArray[np.float64]
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Transform local coordinates to the map of the raster."""
    x, y = x + place.origin[0], y + place.origin[1]
    return project(place.crs, grid.crs, x, y) if place.crs and grid.crs and place.crs != grid.crs else (x, y)


def _refusal(path: str, fault: str, remedy: str) -> SceneError:
    return SceneError(f"path: {path!r} {fault}; {remedy}")

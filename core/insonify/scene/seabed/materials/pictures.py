"""Maps of materials from files: pictures and measured backscatter."""

from functools import partial
from typing import Self

import numpy as np
from pydantic import model_validator

from insonify.arrays import Floats, Integers
from insonify.errors import SceneError
from insonify.files import kept_until_changed
from insonify.io.bathymetry import Grid
from insonify.io.bathymetry.rasters import read_raster
from insonify.io.file_access import check_regular, guarded
from insonify.io.georeference import project
from insonify.io.pictures import read_pixels
from insonify.scene.base import FilePath, metres, parameter
from insonify.scene.seabed.materials import Cells, CompositeMap, Map, Material

LARGEST_SIDE = 16384  # cells of a map
# Grey levels of Pillow's modes.
LEVELS = {"1": 2, "L": 256, "I": 65536, "I;16": 65536, "I;16B": 65536, "I;16L": 65536}


class ImageMap(CompositeMap, kind="image", rank=5):
    """A picture of the bed, north up, repeated from its lower left corner at (0, 0)."""

    path: FilePath = parameter(description="PNG or TIFF, grey or with a palette", min_length=1)
    of: tuple[Material, ...] = parameter(
        description="materials from black to white, or of the palette's first colours", min_length=2, max_length=256
    )
    width: float = metres(
        102.4,
        "width of the picture on the bed, adjusted so that whole pictures fill a period of the relief",
        (10.0, 500.0),
        most=1e6,
    )

    def indices(self, cells: Cells) -> Map:
        """Material of the pixel at each cell; on a periodic bed the width is adjusted to it."""
        pixels = read_picture(self.path, len(self.of))
        x, y = cells.centres()
        i = _pixels(x, self.width, pixels.shape[1], cells.size[0] if cells.periodic else None)
        j = _pixels(y, self._height(pixels), pixels.shape[0], cells.size[1] if cells.periodic else None)
        return np.ascontiguousarray(pixels[np.ix_(j, i)])

    def level_shape(self, spacing: float, fewest: int, most: int) -> tuple[int, int]:
        """Cells along y and x that one picture covers."""
        height = self._height(read_picture(self.path, len(self.of)))
        ny, nx = (max(fewest, round(length / spacing)) for length in (height, self.width))
        if max(ny, nx) > LARGEST_SIDE:
            raise SceneError(
                f"width: a picture {self.width:g} m wide covers {nx} by {ny} cells of seabed.spacing {spacing:g} m; "
                f"reduce it or widen the spacing to stay within {LARGEST_SIDE} a side"
            )
        return ny, nx

    def _height(self, pixels: Map) -> float:
        """Height of the picture on the bed, in metres."""
        return self.width * pixels.shape[0] / pixels.shape[1]


@kept_until_changed(maxsize=4)
def read_picture(path: str, count: int) -> Map:
    """Read a picture as rows of a table of ``count`` materials, (rows, columns) uint8, southernmost first."""
    with guarded(partial(_refusal, path), "give a PNG or TIFF picture"):
        mode, bands = read_pixels(path)
    if mode != "P":  # without a palette
        if mode not in LEVELS or not 0 <= int(bands.min()) <= int(bands.max()) < LEVELS[mode]:
            raise _refusal(path, f"has pixels of mode {mode}", "save it with 8 or 16 bits of grey or a palette")
        bands = bands.astype(np.uint32) * count // LEVELS[mode]
    elif (most := int(bands.max())) >= count:
        remedy = f"give a material for each colour, not only {count}"
        raise _refusal(path, f"uses colour {most} of its palette", remedy)
    return np.ascontiguousarray(bands[::-1].astype(np.uint8))


def _pixels(place: Floats, size: float, count: int, period: float | None) -> Integers:
    """Pixel at each coordinate; whole pictures are stretched to fill a period."""
    if period is not None:
        size = period / max(1, round(period / size))
    return np.floor(place / size * count).astype(np.int64) % count


def _refusal(path: str, fault: str, remedy: str) -> SceneError:
    return SceneError(f"path: {path!r} {fault}; {remedy}")


class BackscatterMap(CompositeMap, kind="backscatter", rank=6):
    """A raster of backscatter with map coordinates; pixels without a value take the nearest one."""

    on_a_map = True
    path: FilePath = parameter(description="GeoTIFF of one band, with its coordinate reference system", min_length=1)
    of: tuple[Material, ...] = parameter(
        description="materials from the lowest to the highest values", min_length=2, max_length=32
    )
    levels: tuple[float, ...] = parameter(
        (), "values that separate successive materials; equal shares of the raster when left out"
    )

    @model_validator(mode="after")
    def _levels_part_the_materials(self) -> Self:
        if self.levels and len(self.levels) != len(self.of) - 1:
            raise ValueError(
                f"levels has {len(self.levels)} values for {len(self.of)} materials; give one value less than materials"
            )
        if any(high <= low for low, high in zip(self.levels, self.levels[1:])):
            raise ValueError("levels does not increase; sort it")
        return self

    def indices(self, cells: Cells) -> Map:
        """Material of the pixel at each cell; on a periodic bed, the raster repeats after its own size."""
        grid, classes = _read_classes(self.path, len(self.of), self.levels)
        if cells.place is None or grid.corner is None or grid.spacing is None:
            raise _refusal(
                self.path,
                "has no position on the bed",
                "give a raster with coordinates, and world.origin and world.crs or a measured bed",
            )
        x, y = (local + offset for local, offset in zip(np.meshgrid(*cells.centres()), cells.place.origin))
        if cells.place.crs and grid.crs and cells.place.crs != grid.crs:
            x, y = project(cells.place.crs, grid.crs, x, y)
        rows, columns = classes.shape
        i = np.floor((x - grid.corner[0]) / grid.spacing[0] + 0.5).astype(np.int64)
        j = np.floor((y - grid.corner[1]) / grid.spacing[1] + 0.5).astype(np.int64)
        if cells.periodic:
            return np.ascontiguousarray(classes[j % rows, i % columns])
        return np.ascontiguousarray(classes[np.clip(j, 0, rows - 1), np.clip(i, 0, columns - 1)])

    def level_shape(self, spacing: float, fewest: int, most: int) -> tuple[int, int]:
        """Cells along y and x that the raster covers."""
        grid, classes = _read_classes(self.path, len(self.of), self.levels)
        dx, dy = grid.spacing or (spacing, spacing)
        ny, nx = (max(fewest, round(count * step / spacing)) for count, step in zip(classes.shape, (dy, dx)))
        if max(ny, nx) > LARGEST_SIDE:
            raise _refusal(self.path, f"covers {nx} by {ny} cells of {spacing:g} m", "crop it or widen seabed.spacing")
        return ny, nx


@kept_until_changed(maxsize=2)
def _read_classes(path: str, count: int, levels: tuple[float, ...]) -> tuple[Grid, Map]:
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

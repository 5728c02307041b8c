"""Georeferenced grids of heights: GeoTIFF, the Bathymetric Attributed Grid (BAG), ESRI ASCII grids."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
from numpy.typing import NDArray

from insonify.io.bathymetry.grid import BATHYMETRY, Grid, check_size, check_type
from insonify.io.formats import FileFormat

ELEVATION = 1  # band that holds the heights


def read_raster(path: str) -> Grid:
    """Read the first band of a raster; a BAG of varying resolution is resampled to its finest."""
    # GDAL takes a fifth of a second to load; only rasters need it.
    from rasterio.errors import NotGeoreferencedWarning, RasterioError

    try:
        with warnings.catch_warnings():
            # A TIFF without georeference is accepted: the scene gives its spacing.
            warnings.simplefilter("ignore", NotGeoreferencedWarning)
            with _open(path) as raster:
                return _read(path, raster)
    except RasterioError as error:
        raise BATHYMETRY.unreadable(path, error, "give a valid GeoTIFF, BAG or ESRI ASCII grid") from None


def _open(path: str) -> Any:
    """Open a raster, a BAG of varying resolution at its finest rather than at its coarse overview."""
    import rasterio

    raster = rasterio.open(path)
    if raster.tags().get("HAS_SUPERGRIDS") != "TRUE":
        return raster
    raster.close()
    return rasterio.open(path, MODE="RESAMPLED_GRID", RES_STRATEGY="MIN")


def _read(path: str, raster: Any) -> Grid:
    check_size(path, raster.shape)
    check_type(path, np.dtype(raster.dtypes[ELEVATION - 1]))
    heights = _flipped(raster.read(ELEVATION, masked=True))
    if raster.crs is None and raster.transform.is_identity:
        return Grid(heights)
    _check_metres(path, raster)
    transform = raster.transform
    if transform.b != 0.0 or transform.d != 0.0 or transform.a <= 0.0 or transform.e >= 0.0:
        raise BATHYMETRY.refusal(
            path, "is not laid out north up", "warp it to a north-up grid, for example with gdalwarp"
        )
    # Heights lie at the centres of pixels; the last row is the southernmost.
    x, y = transform.c + 0.5 * transform.a, transform.f + (raster.height - 0.5) * transform.e
    return Grid(heights, spacing=(transform.a, -transform.e), corner=(x, y))


def _flipped(band: Any) -> NDArray[np.float64]:
    """Heights with rows from south to north, NaN where there is none."""
    heights = np.ma.filled(band.astype(np.float64), np.nan)
    heights[~np.isfinite(heights)] = np.nan
    return np.ascontiguousarray(heights[::-1])


def _check_metres(path: str, raster: Any) -> None:
    """Refuse coordinates that are not in metres; a grid without a reference system is taken to be."""
    if raster.crs is None:
        return
    if raster.crs.is_geographic:
        raise BATHYMETRY.refusal(
            path, "is in degrees", "project it to metres, for example with gdalwarp -t_srs EPSG:32633"
        )
    if raster.crs.is_projected and abs(raster.crs.linear_units_factor[1] - 1.0) > 1e-9:
        raise BATHYMETRY.refusal(
            path, f"is in {raster.crs.linear_units}", "project it to metres, for example with gdalwarp -t_srs"
        )


RASTERS = FileFormat("GeoTIFF, BAG or ESRI ASCII grid", (".tif", ".tiff", ".bag", ".asc"), read_raster)

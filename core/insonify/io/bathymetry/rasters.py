"""Georeferenced grids of heights: GeoTIFF, the Bathymetric Attributed Grid (BAG), ESRI ASCII grids."""

import math
import os
from pathlib import Path
from typing import Any

import numpy as np

from insonify.io.bathymetry import HEIGHT, Grid, check_size, check_type
from insonify.io.file_access import FileFault, check_companions, check_expansion
from insonify.io.formats import FileFormat
from insonify.io.georeference import DEGREES, utm_zone
from insonify.io.isolation import run_isolated

# Without it GDAL takes a text grid for whole numbers if no decimal point is found near its beginning, and NaN for 0.
OPEN_OPTIONS = {"AAIGrid": {"DATATYPE": "Float64"}}
DRIVERS = {".tif": "GTiff", ".tiff": "GTiff", ".bag": "BAG", ".asc": "AAIGrid"}
REMEDY = "give a valid GeoTIFF, BAG or ESRI ASCII grid"
FARTHEST = 1e9  # m, of map coordinates
SPACINGS = (1e-4, 1e6)  # m
ELEVATION = 1  # band that holds the heights


def read_raster(path: str) -> Grid:
    """Read the first band of a raster; a BAG of varying resolution is resampled to its finest."""
    check_companions(path)
    if os.path.abspath(path).startswith("/vsi"):
        raise FileFault("is a virtual file to GDAL", "give it another path")
    return run_isolated(read_with_gdal, path)


def read_with_gdal(path: str) -> Grid:
    """Read a raster in this process, which GDAL may crash."""
    with _open(path) as raster:
        check_size(raster.shape)
        check_expansion(path, raster.width * raster.height * HEIGHT)
        check_type(np.dtype(raster.dtypes[ELEVATION - 1]))
        if raster.crs is None or not raster.crs.is_geographic:
            return _read_metres(raster, _is_depth(raster))
        with _projected(raster) as metric:
            check_size(metric.shape)
            check_expansion(path, metric.width * metric.height * HEIGHT)
            return _read_metres(metric, _is_depth(raster))


def _open(path: str) -> Any:
    """Open a raster, a BAG of varying resolution at its finest rather than at its coarse overview."""
    # GDAL takes a fifth of a second to load; only rasters need it.
    import rasterio

    driver = DRIVERS[Path(path).suffix.lower()]
    raster = rasterio.open(path, driver=driver, **OPEN_OPTIONS.get(driver, {}))
    if raster.tags().get("HAS_SUPERGRIDS") != "TRUE":
        return raster
    raster.close()
    return rasterio.open(path, driver=driver, MODE="RESAMPLED_GRID", RES_STRATEGY="MIN")


def _projected(raster: Any) -> Any:
    """Raster in degrees, seen on the UTM zone of its centre, interpolated bilinearly to about its own resolution."""
    from rasterio.enums import Resampling
    from rasterio.vrt import WarpedVRT
    from rasterio.warp import transform_bounds

    west, south, east, north = transform_bounds(raster.crs, DEGREES, *raster.bounds)
    if not (abs(west) <= 360.0 and abs(east) <= 360.0 and -90.0 <= south <= north <= 90.0):
        raise FileFault("is in degrees beyond the poles", "georeference it again")
    return WarpedVRT(
        raster,
        crs=utm_zone(0.5 * (west + east), 0.5 * (south + north)),
        resampling=Resampling.bilinear,
        tolerance=0.0,  # every node is transformed exactly
        dtype="float64",
        nodata=np.nan,
    )


def _is_depth(raster: Any) -> bool:
    """Whether the tags of a raster or the name of its band declare depths, positive down."""
    tags = {key.lower(): str(value).lower() for key, value in (raster.tags() | raster.tags(ELEVATION)).items()}
    if tags.get("positive") in ("up", "down"):
        return tags["positive"] == "down"
    return "depth" in (raster.descriptions[ELEVATION - 1] or "").lower()


def _read_metres(raster: Any, depths: bool) -> Grid:
    """Read a raster in metres."""
    band, unit = raster.read(ELEVATION, masked=True)[::-1], raster.units[ELEVATION - 1] or ""  # from south to north
    heights = np.array(band.data, dtype=np.float64)
    heights[np.ma.getmaskarray(band) | ~np.isfinite(heights)] = np.nan
    # A TIFF without georeference is accepted: the scene gives its spacing.
    if raster.crs is None and raster.transform.is_identity:
        return Grid(heights, depths=depths, unit=unit)
    # A grid without a reference system counts as in metres.
    if raster.crs is not None and raster.crs.is_projected and abs(raster.crs.linear_units_factor[1] - 1.0) > 1e-9:
        raise FileFault(f"is in {raster.crs.linear_units}", "project it to metres, for example with gdalwarp -t_srs")
    transform = raster.transform
    if transform.b != 0.0 or transform.d != 0.0 or transform.a <= 0.0 or transform.e >= 0.0:
        raise FileFault("is not laid out north up", "warp it to a north-up grid, for example with gdalwarp")
    if not all(SPACINGS[0] <= abs(side) <= SPACINGS[1] for side in (transform.a, transform.e)):
        sizes = f"has pixels of {transform.a:g} by {-transform.e:g} m"
        raise FileFault(sizes, f"give a size from {SPACINGS[0]:g} to {SPACINGS[1]:g} m")
    if not math.hypot(transform.c, transform.f) <= FARTHEST:
        raise FileFault(f"lies at {transform.c:g}, {transform.f:g} m", "georeference it again")
    # Heights lie at the centres of pixels; the last row is the southernmost.
    x, y = transform.c + 0.5 * transform.a, transform.f + (raster.height - 0.5) * transform.e
    # A local system, neither projected nor geographic, has no known place on Earth.
    crs = raster.crs.to_string() if raster.crs is not None and raster.crs.is_projected else ""
    return Grid(heights, spacing=(transform.a, -transform.e), corner=(x, y), crs=crs, depths=depths, unit=unit)


RASTERS = FileFormat("GeoTIFF, BAG or ESRI ASCII grid", tuple(DRIVERS), read_raster, remedy=REMEDY)

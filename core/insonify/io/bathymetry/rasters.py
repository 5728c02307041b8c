"""Georeferenced grids of heights: GeoTIFF, the Bathymetric Attributed Grid (BAG), S-102, ESRI ASCII grids."""

import math
import os
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from insonify.io.bathymetry import HEIGHT, LEVELS, Grid, check_nodata, check_size, check_type
from insonify.io.file_access import FileFault, check_companions, check_expansion, read_text
from insonify.io.formats import FileFormat
from insonify.io.georeference import DEGREES, utm_zone
from insonify.io.isolation import run_isolated

# Without it GDAL takes a text grid for whole numbers if no decimal point is found near its beginning, and NaN for 0.
OPEN_OPTIONS = {"AAIGrid": {"DATATYPE": "Float64"}}
DRIVERS = {".tif": "GTiff", ".tiff": "GTiff", ".bag": "BAG", ".h5": "S102", ".asc": "AAIGrid"}
REMEDY = "give a valid GeoTIFF, BAG, S-102 or ESRI ASCII grid"
FARTHEST_PLACE = 1e9  # m, of map coordinates
SPACINGS = (1e-4, 1e6)  # m
ELEVATION = 1  # band that holds the heights
NAMES = ("long_name", "standard_name", "netcdf_varname")  # tags in which converters keep a variable's names
# Names of units beside those of EPSG.
SYNONYMS = {"sft": "us-ft", "ftus": "us-ft", "us foot": "us survey foot", "us_survey_foot": "us survey foot"}
STRETCH = 0.02  # beyond which a grid is projected to a map that is truer to scale
METRE = 1e-9  # by which the unit of a map may differ from a metre
FACTORS_ALIKE = 1e-5  # by which two factors of one unit may differ: two kinds of foot do by less


def read_raster(path: str) -> Grid:
    """Read the first band of a raster, whatever its numbers are; a BAG of varying resolution at its finest."""
    return _read_isolated(read_levels_with_gdal, path)


def read_heights(path: str) -> Grid:
    """Read the first band of a raster as heights or depths in metres."""
    return _read_isolated(read_heights_with_gdal, path)


def _read_isolated(read: Callable[[str], Grid], path: str) -> Grid:
    """Call a reader in a process of its own, which GDAL may crash."""
    check_companions(path)
    if os.path.abspath(path).startswith("/vsi"):
        raise FileFault("is a virtual file to GDAL", "give it another path")
    return run_isolated(read, path)


def read_levels_with_gdal(path: str) -> Grid:
    """Read a raster in this process."""
    with _open(path) as raster:
        return _read_checked(path, raster)


def read_heights_with_gdal(path: str) -> Grid:
    """Read a raster in this process as heights or depths in metres, with its unit and its sign."""
    with _open(path) as raster:
        tags = {key.lower(): str(value) for key, value in (raster.tags() | raster.tags(ELEVATION)).items()}
        grid = _read_checked(path, raster)
        unit = grid.unit or tags.get("units", "") or _esri_unit(path)
        if unit == LEVELS:
            raise FileFault("holds levels in dB, not heights", "lay the mosaic over a bed with View, Mosaic on the bed")
        stored = raster.read(ELEVATION, masked=True).compressed()  # before scale, and before any interpolation
        check_nodata(stored[np.isfinite(stored)])
        vertical = next(iter(_axes(raster.crs)[2:]), None)
        if (own := _other_unit(raster.crs)) is not None and not unit and vertical is None:
            raise FileFault(
                f"names no unit of its heights, on a map in {own.unit_name}",
                "name it, for example with rio edit-info --bidx 1 --units m, or ft",
            )
        heights = grid.heights * _metres_per_unit(unit, vertical)
        names = " ".join([raster.descriptions[ELEVATION - 1] or "", *(tags.get(key, "") for key in NAMES)]).lower()
        # Names of bands and axes promise depths also where the numbers are negative.
        named = "depth" in names or (vertical is not None and vertical.direction == "down")
        depths = tags.get("positive", "").lower() == "down" or (
            named and tags.get("positive", "").lower() != "up" and bool(np.nanmedian(heights) >= 0.0)
        )
        return replace(grid, heights=heights, depths=depths)


def _read_checked(path: str, raster: Any) -> Grid:
    """Read a raster on a map in metres, projected where its own is in degrees or other units."""
    check_size(raster.shape)
    check_expansion(path, raster.width * raster.height * HEIGHT)
    check_type(np.dtype(raster.dtypes[ELEVATION - 1]))
    crs = raster.crs
    if crs is None or not (crs.is_geographic or (crs.is_projected and (_other_unit(crs) or _stretches(raster)))):
        return _read_metres(raster, raster)
    with _projected(raster) as metric:
        check_size(metric.shape)
        check_expansion(path, metric.width * metric.height * HEIGHT)
        return _read_metres(metric, raster)


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


def _read_metres(raster: Any, source: Any) -> Grid:
    """Read a raster on a map in metres, which may be a projection of its source."""
    band = raster.read(ELEVATION, masked=True)[::-1]  # from south to north
    heights = np.array(band.data, dtype=np.float64)
    heights[np.ma.getmaskarray(band) | ~np.isfinite(heights)] = np.nan
    scale, offset = source.scales[ELEVATION - 1], source.offsets[ELEVATION - 1]
    if not (0.0 < abs(scale) < math.inf and abs(offset) < math.inf):
        remedy = "correct them, for example with gdal_edit.py -scale 1 -offset 0"
        raise FileFault(f"declares a scale of {scale:g} and an offset of {offset:g}", remedy)
    heights = heights * scale + offset
    unit = source.units[ELEVATION - 1] or ""
    # A TIFF without georeference is accepted: the scene gives its spacing.
    if raster.crs is None and raster.transform.is_identity:
        return Grid(heights, unit=unit)
    # A grid without a reference system counts as in metres.
    transform = raster.transform
    if (own := _other_unit(raster.crs)) is not None:  # a local one: others are projected
        transform = type(transform)(*(own.unit_conversion_factor * each for each in transform[:6]))
    if transform.b != 0.0 or transform.d != 0.0 or transform.a <= 0.0 or transform.e >= 0.0:
        raise FileFault("is not laid out north up", "warp it to a north-up grid, for example with gdalwarp")
    if not all(SPACINGS[0] <= abs(side) <= SPACINGS[1] for side in (transform.a, transform.e)):
        sizes = f"has pixels of {transform.a:g} by {-transform.e:g} m"
        raise FileFault(sizes, f"give a size from {SPACINGS[0]:g} to {SPACINGS[1]:g} m")
    if not math.hypot(transform.c, transform.f) <= FARTHEST_PLACE:
        raise FileFault(f"lies at {transform.c:g}, {transform.f:g} m", "georeference it again")
    # Heights lie at the centres of pixels; the last row is the southernmost.
    x, y = transform.c + 0.5 * transform.a, transform.f + (raster.height - 0.5) * transform.e
    # A local system, neither projected nor geographic, has no known place on Earth.
    crs = _horizontal(raster.crs) if raster.crs is not None and raster.crs.is_projected else ""
    return Grid(heights, spacing=(transform.a, -transform.e), corner=(x, y), crs=crs, unit=unit)


def _axes(crs: Any) -> list[Any]:
    """Axes of a reference system, the third one vertical; none where PROJ has no entry."""
    from pyproj import CRS  # lazy: a tenth of a second to import, and only rasters need it
    from pyproj.exceptions import CRSError

    try:
        return list(CRS.from_wkt(crs.to_wkt()).axis_info) if crs is not None else []
    except CRSError:
        return []


def _other_unit(crs: Any) -> Any:
    """Return an axis of a map that is not in metres; None where it is, or in degrees."""
    axis = next(iter(_axes(crs)), None)
    return None if axis is None or crs.is_geographic or abs(axis.unit_conversion_factor - 1.0) < METRE else axis


def _stretches(raster: Any) -> bool:
    """Whether lengths on a map differ from lengths on Earth, as in the Web Mercator."""
    from pyproj import Proj  # lazy, as below
    from pyproj.exceptions import ProjError

    west, south, east, north = raster.bounds
    try:
        here = Proj(_horizontal(raster.crs))
        factors = here.get_factors(*here(0.5 * (west + east), 0.5 * (south + north), inverse=True))
    except ProjError:
        return False
    return max(abs(factors.meridional_scale - 1.0), abs(factors.parallel_scale - 1.0)) > STRETCH


def _horizontal(crs: Any) -> str:
    """Name the horizontal reference system of a map."""
    from pyproj import CRS  # lazy, as above

    if len(_axes(crs)) < 3:
        return str(crs.to_string())
    system = CRS.from_wkt(crs.to_wkt())
    return str((system.sub_crs_list[0] if system.sub_crs_list else system.to_2d()).to_string())


def _metres_per_unit(unit: str, vertical: Any) -> float:
    """Return the metres per unit of heights, from their unit's name and the axis of their reference system."""
    from pyproj.database import get_units_map  # lazy, as above

    own = None if vertical is None else float(vertical.unit_conversion_factor)
    if not unit or (vertical is not None and unit == vertical.unit_name):
        return 1.0 if own is None else own
    units = get_units_map(auth_name="EPSG", category="linear").values()  # those of PROJ's own have a wrong decimetre
    known = {name.lower(): each.conv_factor for each in units for name in (each.name, each.proj_short_name) if name}
    known |= {"dm": 0.1, "decimetre": 0.1}
    name = unit.strip().lower().replace("meter", "metre").replace("feet", "foot")
    factor = next((known[each] for each in (SYNONYMS.get(name, name), name.removesuffix("s")) if each in known), None)
    if factor is None:
        raise FileFault(
            f"has heights in {unit[:40]!r}, a unit that is not known here",
            "name it m, for example with rio edit-info --bidx 1 --units m, and give its metres per unit as scale",
        )
    if own is not None and abs(own / factor - 1.0) > FACTORS_ALIKE:
        raise FileFault(
            f"has heights in {unit[:40]!r} and a reference system of heights in {vertical.unit_name!r}",
            "correct one of them, for example with rio edit-info --bidx 1 --units or rio edit-info --crs",
        )
    return float(factor)


def _esri_unit(path: str) -> str:
    """Return the unit of heights that an old projection file of an ESRI grid names, which GDAL ignores."""
    beside = Path(path).with_suffix(".prj")
    if Path(path).suffix.lower() != ".asc" or not beside.is_file():
        return ""
    found = re.search(r"(?im)^\s*zunits\s+(\S+)", read_text(beside, "latin-1"))
    return "" if found is None or found[1].lower() == "no" else found[1]


RASTERS = FileFormat("GeoTIFF, BAG, S-102 or ESRI ASCII grid", tuple(DRIVERS), read_heights, remedy=REMEDY)
# GDAL converts its numbers with their scale, unit and sign.
CONVERTED = "convert it to GeoTIFF, for example with gdal_translate, or export it as BAG or ESRI ASCII grid"
NETCDF: FileFormat[Grid] = FileFormat("netCDF grid", (".nc", ".grd"), converter=CONVERTED)

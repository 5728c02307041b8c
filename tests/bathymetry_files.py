"""Measured beds for tests: grids written as GeoTIFF, and scenes over them."""

import warnings

import numpy as np
import rasterio
from rasterio import Affine
from rasterio.errors import NotGeoreferencedWarning

from insonify.scene import build

UTM = {"crs": "EPSG:32633", "nodata": -9999.0}
EAST, NORTH = 500_000.125, 6_200_000.5


def scene(path, *, spacing=0.1, origin=None, **dem):
    world = {} if origin is None else {"origin": list(origin)}
    relief = {"kind": "dem", "path": str(path)} | dem
    return build({"world": world, "seabed": {"spacing": spacing, "relief": relief}})


def write_tiff(
    path, rows, *, pixel=(2.0, 2.0), corner=(EAST, NORTH), driver="GTiff", dtype=np.float32, band=None, **profile
):
    """Write rows from north to south, with attributes of their band; the corner is that of the north-western pixel."""
    rows = np.asarray(rows, dtype=np.complex64 if np.iscomplexobj(rows) else dtype)
    if corner is not None:
        profile["transform"] = Affine(pixel[0], 0.0, corner[0], 0.0, -pixel[1], corner[1])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", NotGeoreferencedWarning)
        with rasterio.open(
            path, "w", driver=driver, height=rows.shape[0], width=rows.shape[1], count=1, dtype=rows.dtype, **profile
        ) as raster:
            raster.write(rows, 1)
            for name, value in (band or {}).items():
                setattr(raster, name, value)
    return path


def sloped(ny, nx):
    """Heights that tell every row and column apart."""
    return -20.0 - 0.5 * np.arange(ny)[:, np.newaxis] + 0.01 * np.arange(nx)

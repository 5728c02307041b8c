"""Grids on a map: numbers as GeoTIFF, pictures as KMZ."""

import tempfile
from pathlib import Path

import numpy as np

from insonify.arrays import Bytes, Singles
from insonify.io.atomic import replacing

BLOCK = 256  # cells of a tile's side
ROWS = 4 * BLOCK  # that are written at a time
CACHE = 64  # MB, of GDAL; a share of the machine's memory otherwise


def write_geotiff(
    path: Path, values: Singles, corner: tuple[float, float], cell: float, crs: str, *, band: str, unit: str
) -> None:
    """Write a grid with NaN as its value for no data."""
    # lazy: GDAL takes a fifth of a second to load
    import rasterio
    import rasterio.windows

    rows, columns = values.shape
    profile = {
        "driver": "GTiff", "height": rows, "width": columns, "count": 1, "dtype": "float32", "nodata": np.nan,
        "crs": crs or None, "transform": rasterio.Affine(cell, 0.0, corner[0], 0.0, -cell, corner[1]),
        "compress": "deflate", "predictor": 3, "tiled": True, "blockxsize": BLOCK, "blockysize": BLOCK,
        "bigtiff": "if_safer",
    }  # fmt: skip
    limited = rasterio.Env(GDAL_CACHEMAX=CACHE)
    with limited, replacing(path) as beside, rasterio.open(beside, "w", **profile) as file:
        for first in range(0, rows, ROWS):  # a copy of the whole would double the memory
            part = values[first : first + ROWS]
            file.write(np.ascontiguousarray(part), 1, window=rasterio.windows.Window(0, first, columns, len(part)))
        file.set_band_description(1, band)
        file.units = (unit,)


def write_kmz(path: Path, colours: Bytes, corner: tuple[float, float], cell: float, crs: str) -> None:
    """Write a picture, (rows, columns, 4) of red, green, blue and opacity, as tiles that Google Earth opens."""
    # lazy: GDAL takes a fifth of a second to load
    import rasterio
    import rasterio.shutil
    import rasterio.vrt

    rows, columns, bands = colours.shape
    transform = rasterio.Affine(cell, 0.0, corner[0], 0.0, -cell, corner[1])
    shape = {"height": rows, "width": columns, "count": bands, "dtype": "uint8"}
    # GDAL takes the first part of a path that ends in .kmz as the archive: that of the folder of unfinished files.
    with rasterio.MemoryFile() as memory, tempfile.TemporaryDirectory() as folder, replacing(path) as beside:
        with memory.open(driver="GTiff", crs=crs, transform=transform, photometric="RGB", alpha="YES", **shape) as file:
            file.write(np.moveaxis(colours, 2, 0))
        made = Path(folder, "picture.kmz")
        with memory.open() as file, rasterio.vrt.WarpedVRT(file, crs="EPSG:4326") as degrees:
            rasterio.shutil.copy(degrees, made, driver="KMLSUPEROVERLAY", FORMAT="PNG", NAME=path.stem)
        beside.write_bytes(made.read_bytes())

"""GeoTIFF: one band of numbers on a north-up grid of a map."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from insonify.io.atomic import replacing

BLOCK = 256  # cells of a tile's side


def write_geotiff(
    path: Path, values: NDArray[np.float32], corner: tuple[float, float], cell: float, crs: str, *, band: str, unit: str
) -> None:
    """Write a grid with NaN as its value for no data."""
    # lazy: GDAL takes a fifth of a second to load
    import rasterio

    rows, columns = values.shape
    profile = {
        "driver": "GTiff", "height": rows, "width": columns, "count": 1, "dtype": "float32", "nodata": np.nan,
        "crs": crs or None, "transform": rasterio.Affine(cell, 0.0, corner[0], 0.0, -cell, corner[1]),
        "compress": "deflate", "predictor": 3, "tiled": True, "blockxsize": BLOCK, "blockysize": BLOCK,
        "bigtiff": "if_safer",
    }  # fmt: skip
    with replacing(path) as beside, rasterio.open(beside, "w", **profile) as file:
        file.write(values, 1)
        file.set_band_description(1, band)
        file.units = (unit,)

"""Pictures as maps of materials."""

from __future__ import annotations

import warnings

import numpy as np
from numpy.typing import NDArray

from insonify.io.file_cache import kept_until_changed
from insonify.io.formats import reason
from insonify.scene import SceneError
from insonify.scene.materials import ImageMap
from insonify.terrain.lattice import Lattice, Map

# Grey levels of Pillow's modes; colours are turned into the grey that an eye sees.
LEVELS = {"1": 2, "L": 256, "I": 65536, "I;16": 65536, "I;16B": 65536, "I;16L": 65536}
COLOURED = ("LA", "RGB", "RGBA", "CMYK", "YCbCr", "HSV", "LAB")
LARGEST_SIDE = 16384


def picture_map(layout: ImageMap, lattice: Lattice) -> Map:
    """Index of each cell's material, (ny, nx) uint8; on a bed that repeats, the width gives way to it."""
    rows = picture_rows(layout.path, len(layout.of))
    height = layout.width * rows.shape[0] / rows.shape[1]
    x, y = lattice.centres()
    i = _pixels(x, layout.width, rows.shape[1], lattice.size[0] if lattice.periodic else None)
    j = _pixels(y, height, rows.shape[0], lattice.size[1] if lattice.periodic else None)
    return np.ascontiguousarray(rows[np.ix_(j, i)])


def picture_shape(layout: ImageMap, spacing: float, fewest: int) -> tuple[int, int]:
    """Cells along y and x that one picture covers.

    Raises
    ------
    SceneError
        If the picture cannot be read, or covers more cells than can be held.
    """
    rows = picture_rows(layout.path, len(layout.of))
    height = layout.width * rows.shape[0] / rows.shape[1]
    ny, nx = (max(fewest, round(length / spacing)) for length in (height, layout.width))
    if max(ny, nx) > LARGEST_SIDE:
        raise SceneError(
            f"seabed.material.width: a picture {layout.width:g} m wide covers {nx} by {ny} cells of seabed.spacing "
            f"{spacing:g} m; lessen it or widen the spacing to stay within {LARGEST_SIDE} a side"
        )
    return ny, nx


@kept_until_changed(maxsize=4)
def picture_rows(path: str, count: int) -> Map:
    """Read a picture as rows of a table of ``count`` materials, (rows, columns) uint8, southernmost first.

    Raises
    ------
    SceneError
        If it cannot be read, is no plain picture, or has colours beyond the materials.
    """
    pixels, levels = _read(path)
    if levels is None:
        if int(pixels.max()) >= count:
            raise _refusal(
                path, f"uses colour {int(pixels.max())} of its palette", f"name a material for each, not only {count}"
            )
        bands = pixels
    else:
        bands = pixels.astype(np.int64) * count // levels
    return np.ascontiguousarray(bands[::-1].astype(np.uint8))


def _read(path: str) -> tuple[NDArray[np.integer], int | None]:
    """Pixels from the top row, and how many grey levels they tell apart; None for numbers of a palette."""
    from PIL import Image, UnidentifiedImageError  # which only beds with a picture pay for

    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", Image.DecompressionBombWarning)
            with Image.open(path) as picture:
                mode = picture.mode
                plain = picture.convert("L") if mode in COLOURED else picture
                pixels = np.asarray(plain)
    except FileNotFoundError:
        raise _refusal(path, "does not exist", "give the path of a PNG or TIFF picture") from None
    except (Image.DecompressionBombWarning, Image.DecompressionBombError):
        raise _refusal(path, "is too large to be read", "thin it to 8192 pixels a side") from None
    except (OSError, UnidentifiedImageError, ValueError, SyntaxError) as error:
        raise _refusal(path, f"cannot be read ({reason(error)})", "give a PNG or TIFF picture") from None
    if mode == "P":
        return pixels, None
    if plain.mode not in LEVELS or not 0 <= int(pixels.min()) <= int(pixels.max()) < LEVELS[plain.mode]:
        raise _refusal(path, f"holds pixels of mode {plain.mode}", "save it with 8 or 16 bits of grey or a palette")
    return pixels, LEVELS[plain.mode]


def _pixels(place: NDArray[np.float64], size: float, count: int, period: float | None) -> NDArray[np.int64]:
    """Pixel over each place; pictures that fill a period are stretched to it."""
    if period is not None:
        size = period / max(1, round(period / size))
    return np.floor(place / size * count).astype(np.int64) % count


def _refusal(path: str, fault: str, remedy: str) -> SceneError:
    return SceneError(f"seabed.material.path: {path!r} {fault}; {remedy}")

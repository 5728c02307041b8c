"""Pixels of PNG and TIFF pictures, decoded in a process of its own."""

import numpy as np
from numpy.typing import NDArray

from insonify.io.file_access import FileFault, check_expansion, check_regular, open_regular
from insonify.io.isolation import run_isolated

FORMATS = ("PNG", "TIFF")
LARGEST_SIDE = 16384
PIXEL = 4  # bytes that a pixel takes while it is decoded
COLOURED = ("LA", "RGB", "RGBA", "CMYK", "YCbCr", "HSV", "LAB")


def read_pixels(path: str) -> tuple[str, NDArray[np.integer]]:
    """Read a picture; colours become grey by their luminance."""
    check_regular(path)
    return run_isolated(decode_picture, path)


def decode_picture(path: str) -> tuple[str, NDArray[np.integer]]:
    """Decode a picture in this process, which the decoder may crash."""
    from PIL import Image, UnidentifiedImageError  # lazy: only beds with a picture need it

    Image.MAX_IMAGE_PIXELS = None  # the limits below count
    with open_regular(path) as file:
        try:
            picture = Image.open(file, formats=FORMATS)  # by its content; the suffix does not count
        except UnidentifiedImageError:
            raise FileFault(f"is not a picture in {' or '.join(FORMATS)}", "save it as one") from None
        if max(picture.size) > LARGEST_SIDE:
            raise FileFault("is too large to be read", "thin it to 8192 pixels a side")
        check_expansion(path, picture.width * picture.height * PIXEL)
        plain = picture.convert("L") if picture.mode in COLOURED else picture
        return plain.mode, np.asarray(plain)

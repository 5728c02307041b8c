"""A grid of heights as a file holds it, and the checks that every format shares."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from insonify.io.file_access import FileFault
from insonify.io.formats import FormatRegistry

# A bed of 16384² float32 nodes takes 1 GB.
LARGEST_SIDE = 16384
HEIGHT = 8  # bytes of a height


@dataclass(frozen=True, eq=False)
class Grid:
    """Heights on a grid."""

    # (ny, nx) metres, positive up unless they are depths, NaN where there are none; axis 0 is y, axis 1 is x,
    # both increasing.
    heights: NDArray[np.float64]
    # (float, float) metres between nodes along x and y; None if the file has none.
    spacing: tuple[float, float] | None = None
    # (float, float) map coordinates of node (0, 0); None if the file has none.
    corner: tuple[float, float] | None = None
    crs: str = ""  # coordinate reference system of the map, as PROJ takes it; empty if the file names none
    # Whether the file declares its numbers as depths, positive down, as ``heights`` then are too.
    depths: bool = False


BATHYMETRY: FormatRegistry[Grid] = FormatRegistry(
    "a grid of heights",
    "insonify.io.bathymetry",
    "insonify.bathymetry_formats",
    "seabed.relief.path: {path!r} {fault}; {remedy}",
)


def check_size(shape: tuple[int, ...]) -> None:
    """Refuse a grid too small to span a cell or too large to hold."""
    if min(shape) < 2:
        raise FileFault(f"is only {shape[1]} by {shape[0]} heights", "give at least 2 by 2")
    if max(shape) > LARGEST_SIDE:
        raise FileFault(f"is {shape[1]} by {shape[0]} heights", f"crop or thin it to {LARGEST_SIDE} a side")


def check_type(stored: np.dtype[Any]) -> None:
    """Refuse values that are not real numbers: complex numbers, booleans, text."""
    if stored.kind not in "fiu":
        raise FileFault(f"holds {stored} values", "save the heights as real numbers")

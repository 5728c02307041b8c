"""A measured bed."""

from __future__ import annotations

from typing import Literal

from insonify.scene.base import FilePath, parameter
from insonify.scene.reliefs import ReliefKind


class Dem(ReliefKind):
    """A measured bed: a grid of heights from a file."""

    rank = 90
    kind: Literal["dem"] = "dem"
    path: FilePath = parameter(
        description="GeoTIFF, BAG, .asc, .npy or .npz grid of heights (positive up)", min_length=1
    )
    datum: float = parameter(0.0, unit="m", description="added to every height of the file", ge=-2e4, le=2e4)
    scale: float = parameter(1.0, description="multiplies every height, before the datum is added", gt=0.0, le=1e3)

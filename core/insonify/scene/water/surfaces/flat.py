"""A calm sea."""

from __future__ import annotations

from typing import Literal

from insonify.scene.water.surfaces.mirror import MirrorSurface


class FlatSurface(MirrorSurface):
    """A calm sea, which mirrors perfectly."""

    rank = 20
    kind: Literal["flat"] = "flat"

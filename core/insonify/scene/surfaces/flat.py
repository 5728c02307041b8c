"""A calm sea."""

from __future__ import annotations

from typing import Literal

from insonify.scene.surfaces.mirror import MirrorSurface


class FlatSurface(MirrorSurface):
    """A perfect mirror: a calm sea."""

    rank = 20
    kind: Literal["flat"] = "flat"

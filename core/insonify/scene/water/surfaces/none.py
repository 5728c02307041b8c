"""No surface."""

from __future__ import annotations

from typing import Literal

from insonify.scene.water.surfaces import SurfaceKind


class NoSurface(SurfaceKind):
    """No sea surface: the water has no upper end."""

    rank = 10
    kind: Literal["none"] = "none"

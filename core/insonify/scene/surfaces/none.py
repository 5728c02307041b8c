"""No surface."""

from __future__ import annotations

from typing import Literal

from insonify.scene.surfaces import SurfaceKind


class NoSurface(SurfaceKind):
    """Water without end above the sonar."""

    rank = 10
    kind: Literal["none"] = "none"

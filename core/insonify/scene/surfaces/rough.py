"""A sea raised by the wind."""

from __future__ import annotations

from typing import Literal

from insonify.scene.base import parameter
from insonify.scene.surfaces.mirror import MirrorSurface


class RoughSurface(MirrorSurface):
    """A sea raised by the wind: its ghosts keep their energy and are smeared in range."""

    rank = 30
    kind: Literal["rough"] = "rough"
    wind_speed: float = parameter(
        5.0,
        unit="m/s",
        description="wind that has raised the sea, 19.5 m above it",
        ge=0.0,
        le=30.0,
        slider=(0.0, 15.0),
    )

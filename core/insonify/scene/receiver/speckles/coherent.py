"""Speckle by scatterers that interfere."""

from __future__ import annotations

from typing import Literal

from insonify.scene.base import parameter
from insonify.scene.receiver.speckles import SpeckleKind


class Coherent(SpeckleKind):
    """Scatterers on bed and targets whose echoes are traced one by one and interfere; slow, by the sweep alone."""

    rank = 40
    interferes = True
    kind: Literal["coherent"] = "coherent"
    density: float | None = parameter(
        None,
        unit="1/m²",
        description="scatterers per area, on average; 32 in a cell at half the range when left out",
        gt=0.0,
        le=1e6,
        slider=(1.0, 1e4),
        log=True,
    )

    @property
    def scatterer_density(self) -> float | None:
        """Scatterers per square metre."""
        return self.density

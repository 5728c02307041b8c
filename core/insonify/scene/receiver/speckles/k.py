"""Speckle of few scatterers."""

from __future__ import annotations

from typing import Literal

from insonify.scene.base import parameter
from insonify.scene.receiver.speckles import SpeckleKind, Texture


class K(SpeckleKind):
    """Speckle of few scatterers: Rayleigh speckle of a bed whose strength is itself gamma-distributed."""

    rank = 30
    kind: Literal["k"] = "k"
    shape: float = parameter(
        2.0,
        description="shape of the gamma distribution; fewer scatterers make it smaller and the speckle spikier",
        ge=0.01,
        le=1e4,
        slider=(0.1, 100.0),
        log=True,
    )
    looks: int = parameter(1, description="independent records averaged", ge=1, le=64, slider=(1, 16), log=True)
    cell: float | None = parameter(
        None,
        unit="m²",
        description="area that the shape refers to: it grows with the cell, hence with range and pulse; "
        "the same shape everywhere when left out",
        gt=0.0,
        le=1e6,
        slider=(1e-3, 10.0),
        log=True,
    )

    @property
    def independent_records(self) -> int:
        """Number of independent records that are averaged."""
        return self.looks

    @property
    def texture(self) -> Texture:
        """Gamma-distributed strength of the bed."""
        return Texture(self.shape, self.cell)

"""Absorption of sea water by frequency."""

from __future__ import annotations

from typing import Literal

from insonify.scene.absorptions import AbsorptionKind
from insonify.scene.base import parameter


class FrancoisGarrison(AbsorptionKind):
    """Absorption of sea water by frequency, after Francois and Garrison (1982)."""

    rank = 30
    kind: Literal["francois_garrison"] = "francois_garrison"
    temperature: float = parameter(10.0, unit="°C", description="temperature", ge=-2.0, le=40.0, slider=(0.0, 30.0))
    salinity: float = parameter(35.0, unit="g/kg", description="salinity", ge=0.0, le=45.0, slider=(0.0, 40.0))
    acidity: float = parameter(8.0, unit="pH", description="pH", ge=7.0, le=9.0, slider=(7.5, 8.5))

"""Gaussian autocorrelation."""

from __future__ import annotations

from typing import Literal

from insonify.scene.autocorrelations import AutocorrelationKind
from insonify.scene.base import parameter


class GaussianAutocorrelation(AutocorrelationKind):
    """exp(−lag² / length²)."""

    rank = 20
    kind: Literal["gaussian"] = "gaussian"
    length: float = parameter(
        1.0, unit="m", description="lag at which 1/e is left", gt=0.0, le=1e5, slider=(0.2, 20.0), log=True
    )

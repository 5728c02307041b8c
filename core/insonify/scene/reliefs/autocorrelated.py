"""Roughness by its autocorrelation."""

from __future__ import annotations

from typing import Annotated, Literal

from insonify.scene.autocorrelations import AUTOCORRELATIONS, AutocorrelationKind
from insonify.scene.autocorrelations.exponential import ExponentialAutocorrelation
from insonify.scene.base import parameter
from insonify.scene.kinds import KindOf
from insonify.scene.reliefs.random_relief import ExtendableRelief, rms_height


class Autocorrelated(ExtendableRelief):
    """Roughness of a given autocorrelation, the same in every direction (Wiener–Khinchin)."""

    rank = 70
    kind: Literal["autocorrelation"] = "autocorrelation"
    rms: float = rms_height()
    function: Annotated[AutocorrelationKind, KindOf(AUTOCORRELATIONS, default="exponential")] = parameter(
        ExponentialAutocorrelation(), description="autocorrelation of the heights over the lag"
    )

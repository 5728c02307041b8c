"""No fluctuation."""

from __future__ import annotations

from typing import Literal

from insonify.scene.fluctuations import FluctuationKind


class NoFluctuation(FluctuationKind):
    """Every ping is as loud as the next."""

    rank = 10
    kind: Literal["none"] = "none"

"""No fluctuation."""

from __future__ import annotations

from typing import Literal

from insonify.scene.receiver.fluctuations import FluctuationKind


class NoFluctuation(FluctuationKind):
    """No fluctuation: all pings are equally loud."""

    rank = 10
    kind: Literal["none"] = "none"

"""No noise."""

from __future__ import annotations

from typing import Literal

from insonify.scene.receiver.noises import NoiseKind


class NoNoise(NoiseKind):
    """No noise."""

    rank = 10
    kind: Literal["none"] = "none"

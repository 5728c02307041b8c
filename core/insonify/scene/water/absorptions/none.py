"""No absorption."""

from __future__ import annotations

from typing import Literal

from insonify.scene.water.absorptions import AbsorptionKind


class NoAbsorption(AbsorptionKind):
    """Water without absorption."""

    rank = 10
    by_frequency = False
    kind: Literal["none"] = "none"

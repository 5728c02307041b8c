"""No gain."""

from __future__ import annotations

from typing import Literal

from insonify.scene.receiver.gains import GainKind


class NoTvg(GainKind):
    """No gain: echoes as loud as they arrive."""

    rank = 10
    kind: Literal["none"] = "none"

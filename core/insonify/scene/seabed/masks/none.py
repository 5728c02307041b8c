"""No mask."""

from __future__ import annotations

from typing import Literal

from insonify.scene.seabed.masks import MaskKind


class NoMask(MaskKind):
    """No mask: the relief covers the whole bed."""

    rank = 10
    kind: Literal["none"] = "none"

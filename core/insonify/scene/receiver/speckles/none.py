"""No speckle."""

from __future__ import annotations

from typing import Literal

from insonify.scene.receiver.speckles import SpeckleKind


class NoSpeckle(SpeckleKind):
    """No speckle: the mean echo."""

    rank = 10
    speckled = False
    kind: Literal["none"] = "none"

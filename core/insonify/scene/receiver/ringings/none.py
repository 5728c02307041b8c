"""No ringing."""

from __future__ import annotations

from typing import Literal

from insonify.scene.receiver.ringings import RingingKind


class NoRinging(RingingKind):
    """No ringing: the receiver is quiet as soon as the pulse has left."""

    rank = 10
    kind: Literal["none"] = "none"

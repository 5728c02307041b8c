"""No reverberation."""

from __future__ import annotations

from typing import Literal

from insonify.scene.receiver.reverberations import ReverberationKind


class NoReverberation(ReverberationKind):
    """No reverberation: only the bed and the targets echo."""

    rank = 10
    kind: Literal["none"] = "none"

"""No reverberation."""

from __future__ import annotations

from typing import Literal

from insonify.scene.reverberations import ReverberationKind


class NoReverberation(ReverberationKind):
    """Only the bed and what lies on it echo."""

    rank = 10
    kind: Literal["none"] = "none"

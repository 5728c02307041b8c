"""No interference."""

from __future__ import annotations

from typing import Literal

from insonify.scene.receiver.interferences import InterferenceKind


class NoInterference(InterferenceKind):
    """No other sonar within hearing."""

    rank = 10
    kind: Literal["none"] = "none"

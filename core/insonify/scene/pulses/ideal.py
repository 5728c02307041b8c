"""A pulse without length."""

from __future__ import annotations

from typing import Literal

from insonify.scene.pulses import PulseKind


class Ideal(PulseKind):
    """A pulse shorter than any bin."""

    rank = 10
    kind: Literal["ideal"] = "ideal"

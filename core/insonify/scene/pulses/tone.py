"""A gated tone."""

from __future__ import annotations

from typing import Literal

from insonify.scene.base import parameter
from insonify.scene.pulses import PulseKind


class Tone(PulseKind):
    """A gated tone: every echo lasts as long as the pulse."""

    rank = 20
    kind: Literal["tone"] = "tone"
    duration: float = parameter(
        1e-4, unit="s", description="length of the pulse", gt=0.0, le=0.1, slider=(1e-5, 1e-3), log=True
    )

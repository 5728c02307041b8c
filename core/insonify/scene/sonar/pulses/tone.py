"""A gated tone."""

from __future__ import annotations

import math
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from insonify.scene.base import parameter
from insonify.scene.sonar.pulses import PulseKind


class Tone(PulseKind):
    """A gated tone: every echo lasts as long as the pulse."""

    rank = 20
    kind: Literal["tone"] = "tone"
    duration: float = parameter(
        1e-4, unit="s", description="length of the pulse", gt=0.0, le=0.1, slider=(1e-5, 1e-3), log=True
    )

    @property
    def length(self) -> float:
        """Seconds that the pulse lasts."""
        return self.duration

    def envelope(self, time: NDArray[np.float64]) -> NDArray[np.float64]:
        """Amplitude of a point's echo: the envelope of the transmitted pulse."""
        return np.where((time >= 0.0) & (time < self.duration), 1.0, 0.0)

    def taps(self, length: float) -> NDArray[np.float64]:
        """Share of a bin's energy that the tone puts into that bin and the following ones."""
        return tone_taps(length)

    def coherence(self, length: float) -> NDArray[np.float64]:
        """Correlation of two bins: the share of the tone within both, 1 − Δ/(cτ/2)."""
        return 1.0 - np.arange(max(math.ceil(length), 1)) / length


def tone_taps(length: float) -> NDArray[np.float64]:
    """Share of a bin's energy that a gated tone puts into that bin and the following ones."""
    edges = np.arange(math.ceil(length) + 2, dtype=np.float64)
    corners = (edges, edges - 1.0, edges - length, edges - 1.0 - length)
    ramps = [0.5 * np.maximum(corner, 0.0) ** 2 for corner in corners]
    return np.diff(ramps[0] - ramps[1] - ramps[2] + ramps[3])

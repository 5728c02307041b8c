"""A pulse without length."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from insonify.scene.sonar.pulses import PulseKind


class Ideal(PulseKind):
    """A pulse shorter than any bin."""

    rank = 10
    kind: Literal["ideal"] = "ideal"

    def taps(self, length: float) -> NDArray[np.float64]:
        """All of a bin's energy stays in it."""
        del length
        return np.ones(1)

    def coherence(self, length: float) -> NDArray[np.float64]:
        """Bins are independent."""
        del length
        return np.ones(1)

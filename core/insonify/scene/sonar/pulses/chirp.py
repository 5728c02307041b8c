"""A frequency sweep."""

from __future__ import annotations

from typing import Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import model_validator

from insonify.scene.base import parameter
from insonify.scene.sonar.pulses import PulseKind

# Its spectrum is a + b cos(2πf/B) over its band.
WINDOWS = {"uniform": (1.0, 0.0), "hamming": (0.54, 0.46), "hann": (0.5, 0.5)}


class Chirp(PulseKind):
    """A sweep of frequencies, compressed by a matched filter: an echo is as short as the bandwidth allows."""

    rank = 30
    two_sided = True
    kind: Literal["chirp"] = "chirp"
    duration: float = parameter(
        1e-3, unit="s", description="length of the pulse", gt=0.0, le=0.1, slider=(1e-4, 1e-2), log=True
    )
    bandwidth: float = parameter(
        30e3, unit="Hz", description="frequencies swept", gt=0.0, le=1e6, slider=(5e3, 2e5), log=True
    )
    window: Literal["uniform", "hamming", "hann"] = parameter(
        "hamming", description="weight of the frequencies; a tapered one has lower sidelobes and is less sharp"
    )

    @model_validator(mode="after")
    def _long_enough(self) -> Chirp:
        if self.duration * self.bandwidth < 1.0:
            raise ValueError(
                f"bandwidth {self.bandwidth:g} Hz is less than a pulse of {self.duration:g} s has; "
                f"raise it to {1.0 / self.duration:.4g} Hz or more, or lengthen the pulse"
            )
        return self

    @property
    def length(self) -> float:
        """Seconds that the pulse lasts, and its response before and after the echo's own time."""
        return self.duration

    @property
    def resolution(self) -> float:
        """Time between two echoes that can be resolved, in seconds."""
        return 1.0 / self.bandwidth

    def cell(self, sound_speed: float) -> float:
        """Slant range between two echoes that can be resolved, in metres, c/2B."""
        return 0.5 * sound_speed / self.bandwidth

    def envelope(self, time: NDArray[np.float64]) -> NDArray[np.float64]:
        """Response of the matched filter: the transform of the spectrum's window, sinc Bt for a uniform one."""
        a, b = WINDOWS[self.window]
        x = self.bandwidth * time
        value = np.sinc(x) + (0.5 * b / a) * (np.sinc(x - 1.0) + np.sinc(x + 1.0))
        return np.where(np.abs(time) <= self.duration, value, 0.0)

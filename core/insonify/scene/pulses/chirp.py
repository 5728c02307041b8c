"""A frequency sweep."""

from __future__ import annotations

from typing import Literal

from pydantic import model_validator

from insonify.scene.base import parameter
from insonify.scene.pulses import PulseKind


class Chirp(PulseKind):
    """A sweep of frequencies, compressed by a matched filter: an echo is as short as the bandwidth allows."""

    rank = 30
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

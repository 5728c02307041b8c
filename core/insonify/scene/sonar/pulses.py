"""Transmitted pulses."""

import math
from typing import ClassVar, Literal, Self

import numpy as np
from pydantic import model_validator

from insonify.arrays import Floats
from insonify.scene.base import Family, Kind, parameter

PULSES = Family("pulses", "insonify.scene.sonar")
# The spectrum of a windowed chirp is a + b cos(2πf/B) over its band.
WINDOWS = {"uniform": (1.0, 0.0), "hamming": (0.54, 0.46), "hann": (0.5, 0.5)}


class PulseKind(Kind):
    """A transmitted pulse: its envelope after the receiver's filter, and its length.

    The receiver sums and correlates the envelope numerically unless a kind returns the results in closed form.

    Attributes
    ----------
    two_sided : bool
        Whether the response also precedes the echo's own range, as that of a matched filter does.
    """

    family = PULSES
    two_sided: ClassVar[bool] = False

    @property
    def length(self) -> float:
        """Length of the pulse in seconds; 0 for one shorter than any bin."""
        return getattr(self, "duration", 0.0)

    @property
    def resolution(self) -> float:
        """Time between two echoes that can be resolved, in seconds."""
        return self.length

    @property
    def filter_loss(self) -> float:
        """Noise behind the receiver's filter over that behind a matched one, as a ratio of at least 1."""
        return 1.0

    def sent_for(self, bin_time: float) -> float:
        """Time in seconds over which the energy is sent; a pulse shorter than any bin stands for one of a bin."""
        return self.length or bin_time

    def band(self, bin_time: float) -> float:
        """Width in Hz of the receiver's band."""
        return 1.0 / (self.resolution or bin_time)

    def noise_bandwidth(self, bin_time: float) -> float:
        """Bandwidth in Hz of the noise in the record, the receiver's band less the processing gain."""
        # The filter is matched to the pulse and scaled so that a point's echo keeps its level. Noise of the density N₀
        # then has the power N₀/T, so that the echo of energy E stands E/N₀ above it (Urick 1983, 12.1).
        return self.filter_loss / self.sent_for(bin_time)

    def processing_gain(self, bin_time: float) -> float:
        """Rise of a point's echo over the noise by compression, as a ratio: BT for a uniform chirp, 1 for a tone."""
        return self.band(bin_time) / self.noise_bandwidth(bin_time)

    def cell(self, sound_speed: float) -> float:
        """Slant range between two echoes that can be resolved, in metres."""
        return 0.5 * sound_speed * self.resolution

    def envelope(self, time: Floats) -> Floats:
        """Amplitude of a point's echo at times (s) after its own, 1 at its peak."""
        raise NotImplementedError

    def taps(self, length: float) -> Floats | None:
        """Shares of a bin's energy that the pulse puts into that bin and the following ones, in closed form.

        Parameters
        ----------
        length : float
            Length of the pulse in bins.

        Returns
        -------
        (n,) float64 or None
            None where there is no closed form.
        """
        return None

    def coherence(self, length: float) -> Floats | None:
        """Correlation between amplitudes at 0 to n - 1 bins apart, in closed form; argument and result as of `taps`."""
        return None


class Ideal(PulseKind, kind="ideal", rank=10):
    """A pulse shorter than any bin."""

    def taps(self, length: float) -> Floats:
        """All of a bin's energy stays in it."""
        return np.ones(1)

    def coherence(self, length: float) -> Floats:
        """Bins are independent."""
        return np.ones(1)


class Tone(PulseKind, kind="tone", rank=20):
    """A gated tone: every echo lasts as long as the pulse."""

    duration: float = parameter(1e-4, "length of the pulse", "s", gt=0.0, le=0.1, slider=(1e-5, 1e-3), log=True)

    def envelope(self, time: Floats) -> Floats:
        """Amplitude of a point's echo: the envelope of the transmitted pulse."""
        return np.where((time >= 0.0) & (time < self.duration), 1.0, 0.0)

    def taps(self, length: float) -> Floats:
        """Shares of a bin's energy that the tone puts into that bin and the following ones."""
        edges = np.arange(math.ceil(length) + 2, dtype=np.float64)
        corners = (edges, edges - 1.0, edges - length, edges - 1.0 - length)
        ramps = [0.5 * np.maximum(corner, 0.0) ** 2 for corner in corners]
        return np.diff(ramps[0] - ramps[1] - ramps[2] + ramps[3])

    def coherence(self, length: float) -> Floats:
        """Correlation of two bins: the share of the tone within both, 1 − Δ/(cτ/2)."""
        return 1.0 - np.arange(max(math.ceil(length), 1)) / length


class Chirp(PulseKind, kind="chirp", rank=30):
    """A sweep of frequencies, compressed by a matched filter: an echo is as short as the bandwidth allows."""

    two_sided = True
    duration: float = parameter(1e-3, "length of the pulse", "s", gt=0.0, le=0.1, slider=(1e-4, 1e-2), log=True)
    bandwidth: float = parameter(30e3, "frequencies swept", "Hz", gt=0.0, le=1e6, slider=(5e3, 2e5), log=True)
    window: Literal["uniform", "hamming", "hann"] = parameter(
        "hamming", "weight of the frequencies; a tapered one has lower sidelobes and resolves less"
    )

    @model_validator(mode="after")
    def _long_enough(self) -> Self:
        if self.duration * self.bandwidth < 1.0:
            raise ValueError(
                f"bandwidth {self.bandwidth:g} Hz is less than that of an unswept pulse of {self.duration:g} s; "
                f"raise it to {1.0 / self.duration:.4g} Hz or more, or lengthen the pulse"
            )
        return self

    @property
    def resolution(self) -> float:
        """Time between two echoes that can be resolved, in seconds."""
        return 1.0 / self.bandwidth

    @property
    def filter_loss(self) -> float:
        """Noise that the window of the spectrum W costs, ⟨W²⟩/⟨W⟩²: 1 if uniform, 1.36 Hamming, 1.5 Hann."""
        a, b = WINDOWS[self.window]
        return 1.0 + 0.5 * (b / a) ** 2

    def cell(self, sound_speed: float) -> float:
        """Slant range between two echoes that can be resolved, in metres, c/2B."""
        return 0.5 * sound_speed / self.bandwidth

    def envelope(self, time: Floats) -> Floats:
        """Response of the matched filter: the transform of the spectrum's window, sinc Bt for a uniform one."""
        a, b = WINDOWS[self.window]
        x = self.bandwidth * time
        value = np.sinc(x) + (0.5 * b / a) * (np.sinc(x - 1.0) + np.sinc(x + 1.0))
        return np.where(np.abs(time) <= self.duration, value, 0.0)

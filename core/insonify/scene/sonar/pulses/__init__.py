"""Transmitted pulses, one file a kind."""

from __future__ import annotations

from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from insonify.scene.base import Choice
from insonify.scene.kinds import Family

PULSES = Family("pulses", "insonify.scene.sonar.pulses")


class PulseKind(Choice):
    """A transmitted pulse: its envelope after the receiver's filter, and how long it lasts.

    The receiver sums and correlates the envelope numerically unless a kind says the results in closed form.

    Attributes
    ----------
    two_sided : bool
        Whether the response also comes before the echo's own range, as that of a matched filter does.
    """

    family = PULSES
    two_sided: ClassVar[bool] = False

    @property
    def length(self) -> float:
        """Seconds that the pulse lasts; 0 for one shorter than any bin."""
        return 0.0

    @property
    def resolution(self) -> float:
        """Time between two echoes that can be resolved, in seconds."""
        return self.length

    def cell(self, sound_speed: float) -> float:
        """Slant range between two echoes that can be resolved, in metres."""
        return 0.5 * sound_speed * self.resolution

    def envelope(self, time: NDArray[np.float64]) -> NDArray[np.float64]:
        """Amplitude of a point's echo at times (s) after its own, 1 at its peak."""
        raise NotImplementedError

    def taps(self, length: float) -> NDArray[np.float64] | None:
        """Share of a bin's energy that the pulse puts into that bin and the following ones, in closed form.

        Parameters
        ----------
        length : float
            Bins that the pulse lasts.

        Returns
        -------
        (n,) float64 or None
            None where there is no closed form.
        """
        del length
        return None

    def coherence(self, length: float) -> NDArray[np.float64] | None:
        """Correlation between amplitudes at 0 to n - 1 bins apart, in closed form; argument and result as of `taps`."""
        del length
        return None

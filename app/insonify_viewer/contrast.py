"""Contrast and gain by which the record is shown."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from insonify.display.picture import choose_contrast
from insonify_viewer.views.pixels import compress_highlights

if TYPE_CHECKING:
    from insonify_viewer.record import Record
    from insonify_viewer.views.waterfall_view import WaterfallView

SAMPLED = 4  # every so many rows are looked at


class Contrast:
    """Amplitudes at the ends of the palette, chosen from the record while it fills, and a gain on top.

    Parameters
    ----------
    waterfall : WaterfallView
        Follows the choice.

    Attributes
    ----------
    due : bool
        Whether the contrast is still to be chosen from the record.
    """

    def __init__(self, waterfall: WaterfallView) -> None:
        self._waterfall = waterfall
        self._levels, self._gain = (0.0, 1.0), 1.0
        self.due = True

    def show_gain(self, decibels: float) -> None:
        """Brighten or darken the record."""
        self._gain = 10.0 ** (decibels / 20.0)
        self._waterfall.show_levels(self._levels, self._gain)

    def settle(self, record: Record, *, complete: bool) -> None:
        """Choose the contrast anew if it is due, for the last time when the record is complete."""
        if self.due:
            self._levels = choose_contrast(record.amplitude[record.ping >= 0][::SAMPLED])
            self._waterfall.show_levels(self._levels, self._gain)
            self.due = not complete

    def tones(self, amplitude: NDArray[np.float32]) -> NDArray[np.float32]:
        """Brightness of amplitudes as shown, 0 to 1."""
        low, high = self._levels
        span = np.float32(max(high - low, 1e-30))
        return compress_highlights((amplitude * np.float32(self._gain) - np.float32(low)) / span)

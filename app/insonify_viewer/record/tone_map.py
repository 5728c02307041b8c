"""Colours and brightness of amplitudes by the display options."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from insonify.arrays import Singles
from insonify.display.display_options import DisplayOptions, Levels
from insonify.display.picture import colour_rows, shown_palette, span_decibels
from insonify_viewer.widgets.painting import colour_table, compress_highlights, with_highlights

SILENT = np.float32(1e-15)  # amplitude that stands for silence in decibels


class ToneMap(NamedTuple):
    """Colours of amplitudes."""

    # (float, float) amplitudes, or their decibels, of the first colour and of the last one before the highlights.
    ends: tuple[float, float]
    decibels: bool  # whether colours are linear in decibels
    table: NDArray[np.uint32]  # (n,) colours as 0xffRRGGBB

    def colours(self, amplitude: Singles) -> NDArray[np.uint32]:
        """Colour amplitudes, as 0xffRRGGBB."""
        return colour_rows(self._scaled(amplitude), *self.ends, self.table)

    def tones(self, amplitude: Singles) -> Singles:
        """Brightness of amplitudes, 0 to 1."""
        low, high = self.ends
        tones = (self._scaled(amplitude) - np.float32(low)) / np.float32(max(high - low, 1e-30))
        return np.clip(tones, 0.0, 1.0) if self.decibels else compress_highlights(tones)

    def _scaled(self, amplitude: Singles) -> Singles:
        return np.float32(20.0) * np.log10(np.maximum(amplitude, SILENT)) if self.decibels else amplitude


def make_tone_map(look: DisplayOptions, levels: Levels) -> ToneMap:
    """Make the colours of display options, with other levels where these leave them to the record."""
    low, high = look.levels or levels
    table = colour_table(shown_palette(look))
    if look.decibels:
        bottom, top = span_decibels((low, high))
        return ToneMap((bottom - look.gain, top - look.gain), True, table)
    gain = 10.0 ** (look.gain / 20.0)
    return ToneMap((low / gain, high / gain), False, with_highlights(table))

"""How a record is shown: names only, so that the command line need not load what draws."""

from __future__ import annotations

from typing import NamedTuple

PALETTES = ("copper", "pen", "grey", "viridis")
SIDES = ("both", "port", "starboard")


class DisplayOptions(NamedTuple):
    """What of a record is shown, and how."""

    side: str = "both"
    ground_range: bool = False
    palette: str = "copper"
    gain: float = 0.0  # dB

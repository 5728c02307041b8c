"""Ways in which record A is shown beside the live record B."""

from __future__ import annotations

from enum import Enum


class Arrangement(Enum):
    """How two records share the room; the values are what the person reads."""

    ALONE = "one at a time"
    """B, or A while a key is held."""
    BESIDE = "side by side"
    WIPED = "wiped"
    """A left of a line that is dragged, B right of it."""
    DIFFERENCE = "difference"
    """Ratio of B to A, in dB."""

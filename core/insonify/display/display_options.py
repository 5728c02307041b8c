"""Display options of a record, by name alone, so that the command line loads no plotting library."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

from insonify.files import resources

DEFAULT_PALETTE = "copper"
SIDES = ("both", "port", "starboard")


def find_palettes() -> dict[str, Path]:
    """Palettes by name, the default first: every text file in ``resources/palettes``."""
    found = {path.stem: path for path in sorted((resources() / "palettes").glob("*.txt"))}
    return {DEFAULT_PALETTE: found[DEFAULT_PALETTE], **found}


PALETTES = tuple(find_palettes())


class DisplayOptions(NamedTuple):
    """Sides, kind of range, palette and gain of a picture of a record."""

    side: str = "both"
    ground_range: bool = False
    palette: str = DEFAULT_PALETTE
    gain: float = 0.0  # dB

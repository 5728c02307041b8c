"""Sound-speed casts: a format is one module here that holds a `FileFormat`."""

from __future__ import annotations

from insonify.io.sound_speed_casts.cast import CASTS, Cast
from insonify.io.sound_speed_casts.cleaning import clean_cast

__all__ = ["CASTS", "Cast", "read_cast"]


def read_cast(path: str) -> Cast:
    """Read a measured cast."""
    return clean_cast(path, CASTS.read(path))

"""Sound-speed casts: a format is one module here that holds a `FileFormat`."""

from __future__ import annotations

from insonify.io.sound_speed_casts.cast import CASTS, Cast
from insonify.io.sound_speed_casts.cleaning import clean_cast

__all__ = ["CASTS", "Cast", "read_cast"]


def read_cast(path: str) -> Cast:
    """Read a measured cast.

    Parameters
    ----------
    path : str
        A file of one of the formats of `CASTS`.

    Returns
    -------
    Cast
        The way down alone, without what was measured before it began, at increasing depths.

    Raises
    ------
    SceneError
        One sentence with what is wrong with the file and the remedy.
    """
    return clean_cast(path, CASTS.read(path))

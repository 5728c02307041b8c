"""Readers of measured casts: the water as an instrument found it on its way down."""

from __future__ import annotations

from pathlib import Path

from insonify.io.sound_speed_casts.cast import Cast, Columns, refusal
from insonify.io.sound_speed_casts.cleaning import cleaned
from insonify.io.sound_speed_casts.seabird import read_seabird
from insonify.io.sound_speed_casts.text import read_profile, read_table

__all__ = ["Cast", "read_cast"]

READERS = {".cnv": read_seabird, ".asvp": read_profile, ".svp": read_profile, ".csv": read_table}


def read_cast(path: str) -> Cast:
    """Read a measured cast.

    Parameters
    ----------
    path : str
        Sea-Bird ``.cnv``, Kongsberg ``.asvp``, ``.svp`` (Caris and others), or CSV with or without names of columns.

    Returns
    -------
    Cast
        The way down alone, without what was measured before it began, at increasing depths.

    Raises
    ------
    SceneError
        One sentence with what is wrong with the file and the remedy.
    """
    read = READERS.get(Path(path).suffix.lower())
    if read is None:
        known = ", ".join(READERS)
        raise refusal(path, "is not a format known here", f"give a file that ends in one of {known}")
    if not Path(path).is_file():
        raise refusal(path, "does not exist", "give the path of a measured cast")
    try:
        text = Path(path).read_text(encoding="latin-1")
    except OSError as error:
        raise refusal(path, f"cannot be read ({error.strerror})", "give a file that can be opened") from None
    columns: Columns = read(path, text)
    return cleaned(path, columns)

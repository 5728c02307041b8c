"""Write a file whole or not at all."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def replacing(path: str | Path) -> Iterator[Path]:
    """Give a path beside the final one to write to; on success it takes the final one's place.

    Whatever goes wrong, an interrupt included, the old file stays as it was and nothing is left beside it.

    Parameters
    ----------
    path : str or Path
        File to make or replace.

    Yields
    ------
    Path
        Where to write; its suffix is that of ``path``.
    """
    final = Path(path)
    # A link is followed, so that the file it points to is the one replaced.
    final = final.resolve() if final.is_symlink() else final
    beside = final.with_name(f".{final.stem}.{os.getpid()}.part{final.suffix}")
    try:
        yield beside
        beside.replace(final)
    except OSError as error:
        # People know the file by its own name.
        raise type(error)(error.errno, error.strerror or str(error), str(path)) from error
    finally:
        beside.unlink(missing_ok=True)

"""Write a file whole or not at all."""

from __future__ import annotations

import os
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NoReturn


@contextmanager
def replacing(path: str | Path) -> Iterator[Path]:
    """Give a path beside the final one to write to; on success it takes the final one's place.

    Whatever goes wrong, an interrupt or a request to end included, the old file stays as it was and nothing is left
    beside it.

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
        with _ended_gently():
            yield beside
            beside.replace(final)
    except OSError as error:
        # People know the file by its own name.
        raise type(error)(error.errno, error.strerror or str(error), str(path)) from error
    finally:
        beside.unlink(missing_ok=True)


@contextmanager
def _ended_gently() -> Iterator[None]:
    """Let a request to end, as a scheduler sends it when time is up, run the clean-up that an interrupt does."""
    before = signal.getsignal(signal.SIGTERM)
    if before is not signal.SIG_DFL or threading.current_thread() is not threading.main_thread():
        yield
        return
    signal.signal(signal.SIGTERM, _leave)
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


def _leave(number: int, frame: object) -> NoReturn:
    del frame
    sys.exit(128 + number)

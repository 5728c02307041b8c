"""Write a file, or a folder that counts as one, whole or not at all."""

from __future__ import annotations

import os
import shutil
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import NoReturn


@contextmanager
def replacing(path: str | Path) -> Iterator[Path]:
    """Yield a temporary path beside the final one; the finished file replaces the final one.

    After an error, an interrupt or a request to terminate, the old file is unchanged and no temporary file is left.

    Parameters
    ----------
    path : str or Path
        File to create or replace.

    Yields
    ------
    Path
        Temporary path with the suffix of ``path``.
    """
    final = Path(path)
    # A link is followed, so that the file it points to is replaced, not the link.
    final = final.resolve() if final.is_symlink() else final
    beside = final.with_name(f".{final.stem}.{os.getpid()}.part{final.suffix}")
    try:
        with _terminated_cleanly():
            yield beside
            _put(beside, final)
    except OSError as error:
        # The error names the final path, not the temporary one.
        raise type(error)(error.errno, error.strerror or str(error), str(path)) from error
    finally:
        _remove(beside)


def _put(beside: Path, final: Path) -> None:
    """Put a finished file or folder in its place; a folder is swapped with the old one, which is then removed."""
    if not (beside.is_dir() and final.is_dir()):
        beside.replace(final)
        return
    old = final.with_name(f".{final.stem}.{os.getpid()}.old{final.suffix}")
    final.replace(old)
    try:
        beside.replace(final)
    except OSError:
        old.replace(final)
        raise
    _remove(old)


def _remove(path: Path) -> None:
    """Remove a file or a folder, if there is one."""
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)


@contextmanager
def _terminated_cleanly() -> Iterator[None]:
    """Turn SIGTERM, which a scheduler sends when time is up, into an exit that runs the clean-up."""
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

"""The folder of machine code on disk, which is run unchecked: it must be out of reach of other users."""

import contextlib
import os
import stat
import warnings
from multiprocessing import parent_process
from pathlib import Path

import platformdirs


class CacheWarning(UserWarning):
    """Why machine code is not kept, in one sentence."""


def cache_folder() -> Path:
    """Return the folder of all machine code: below NUMBA_CACHE_DIR where that is set, else the user's cache."""
    # Numba's setting of that name also comes from a file of the current folder, which may be a stranger's.
    if declared := os.environ.get("NUMBA_CACHE_DIR"):
        return Path(os.path.realpath(declared), "insonify", "kernels")
    return Path(platformdirs.user_cache_dir("insonify"), "kernels")


def is_private(folder: Path) -> bool:
    """Make a folder for this user alone; false, with a warning, if other users can put files there."""
    if folder.is_absolute():
        with contextlib.suppress(OSError):  # a folder that cannot be made is done without
            folder.mkdir(parents=True, exist_ok=True, mode=0o700)
        real = Path(os.path.realpath(folder))
        fault = next(filter(None, map(_fault, (folder, *folder.parents, real, *real.parents))), "")
    else:  # below the current one
        fault = "this user has no home folder"
    if fault and parent_process() is None:
        sentence = f"{fault}; kernels are compiled at every start until that is changed, or NUMBA_CACHE_DIR is set"
        warnings.warn(CacheWarning(f"machine code is neither read from nor kept in {folder}: {sentence}"), stacklevel=2)
    if not fault:
        with contextlib.suppress(OSError):  # root's
            folder.chmod(0o700)
    return not fault


def _fault(folder: Path) -> str:
    """Return what lets users other than this one and root put files into a folder; empty if nothing does."""
    if not hasattr(os, "getuid"):
        return ""
    user = os.getuid()
    try:
        status = folder.stat()
    except OSError:
        return ""
    if not stat.S_ISDIR(status.st_mode):  # nothing can be put there
        return ""
    if status.st_uid not in (0, user):
        return f"{folder} belongs to another user"
    # Many systems give each user a group of the same number, with nobody else in it.
    others = stat.S_IWOTH | (0 if status.st_gid in (0, user) else stat.S_IWGRP)
    if status.st_mode & others and not status.st_mode & stat.S_ISVTX:
        return f"other users may write to {folder}"
    return ""

"""Files that are being written: their names, and the removal of those that an ended process left unfinished."""

from __future__ import annotations

import itertools
import os
import platform
import re
import shutil
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from insonify.errors import FileWarning

UNFINISHED, FORMER = "unfinished", "former"  # an incomplete file, and a folder while it is being replaced
LONGEST_NAME = 255  # bytes
_numbers = itertools.count()


class Leftover(NamedTuple):
    """A file or folder beside the one that it belongs to, made by a process of some machine."""

    path: Path
    kind: str
    host: str
    process: int


def temporary_path(final: Path, kind: str = UNFINISHED) -> Path:
    """Return a path beside a file for its new or its former content, such as ``.record.unfinished-host-123-0.nc``."""
    end = f".{kind}-{_host()}-{os.getpid()}-{next(_numbers)}{final.suffix}"
    stem = final.stem
    while stem and len(os.fsencode(f".{stem}{end}")) > LONGEST_NAME:
        stem = stem[:-1]
    return final.with_name(f".{stem}{end}")


def clear_leftovers(final: Path) -> None:
    """Remove files that ended processes of this user and machine left beside a file; warn of files in use elsewhere.

    A folder that was being replaced when its writer was killed is put back.
    """
    for left in list(_leftovers(final)):
        if left.host != _host() or not _is_own(left.path):
            text = f"{final}: {left.path.name} beside it was left by another user or machine; remove it if it is stale"
            warnings.warn(FileWarning(text), stacklevel=4)
        elif _is_running(left.process):
            if left.kind == UNFINISHED:
                text = f"{final}: process {left.process} is writing it as well; the last to finish replaces the other"
                warnings.warn(FileWarning(text), stacklevel=4)
        elif left.kind == FORMER and not final.exists():
            left.path.rename(final)
        else:
            remove(left.path)


def clear_ended(folder: Path) -> None:
    """Remove all unfinished files that ended processes of this user and machine left in a folder."""
    pattern = re.compile(rf"\..*\.{UNFINISHED}-(\w+)-(\d+)-\d+(\.\w+)?")
    for name in os.listdir(folder):
        match = pattern.fullmatch(name)
        path = folder / name
        if match and match[1] == _host() and _is_own(path) and not _is_running(int(match[2])):
            remove(path)


def remove(path: Path) -> None:
    """Remove a file or a folder, if there is one."""
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)


def _leftovers(final: Path) -> Iterator[Leftover]:
    pattern = re.compile(rf"\.(.*)\.({UNFINISHED}|{FORMER})-(\w+)-(\d+)-\d+{re.escape(final.suffix)}")
    for name in os.listdir(final.parent):
        match = pattern.fullmatch(name)
        # A long name was cut.
        if match and (match[1] == final.stem or (len(os.fsencode(name)) > LONGEST_NAME - 4 and match[1] in final.stem)):
            yield Leftover(final.parent / name, match[2], match[3], int(match[4]))


def _host() -> str:
    return re.sub(r"\W", "_", platform.node(), flags=re.ASCII)[:32] or "unknown"


def _is_own(path: Path) -> bool:
    return not hasattr(os, "getuid") or path.lstat().st_uid == os.getuid()


def _is_running(process: int) -> bool:
    """Whether a process of this machine runs; true where the system cannot answer without ending it."""
    if os.name != "posix":
        return True
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except OSError:
        return True
    return True

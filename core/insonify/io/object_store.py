"""Folders in an object store such as S3, by ``fsspec``: paths that look like paths on a disk.

An object appears whole when its upload ends, so nothing is written beside it and renamed.
"""

import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, cast

from insonify.errors import SceneError

SIGN = "://"  # in the address of a folder in a store, such as ``s3://bucket/mines``


def folder_at(text: str) -> Path:
    """Return the folder at a path of a disk or at an address of a store."""
    if SIGN not in text:
        return Path(text).absolute()
    try:
        from upath import UPath  # lazy: an optional extra

        folder: Any = UPath(text, use_listings_cache=False)  # other processes write there too
        folder.exists()  # an error now, rather than in the middle of the work
    except ImportError as error:
        kind = text.partition(SIGN)[0]
        needed = f"pip install {kind}fs" if kind == "s3" else f"install the file system of fsspec for {kind}"
        raise SceneError(f"-o {text}: {error}; {needed}, and 'insonify[surveys]'") from None
    except Exception as error:  # stores raise errors of many types
        raise SceneError(f"-o {text}: cannot be reached ({error}); check address and credentials") from None
    return cast("Path", folder)


def in_store(path: Path) -> bool:
    """Whether a path names an object of a store, not a file on a disk."""
    return not isinstance(path, Path) or SIGN in str(path)


@contextmanager
def uploading(final: Path) -> Iterator[Path]:
    """Yield the path of a file on a disk; when it is complete, it becomes an object."""
    with tempfile.TemporaryDirectory() as folder:
        beside = Path(folder, f"new{final.suffix}")
        yield beside
        final.write_bytes(beside.read_bytes())

"""Keep what was read from files until they change on disk."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache, wraps
from typing import Any, TypeVar, cast

from insonify.files import file_version

Reader = TypeVar("Reader", bound=Callable[..., Any])


def kept_until_changed(maxsize: int) -> Callable[[Reader], Reader]:
    """Decorate a reader so that the contents of the last files are kept; a file written anew is read anew."""

    def decorate(read: Reader) -> Reader:
        @lru_cache(maxsize)
        def read_version(version: tuple[int, int], path: str, *options: Any) -> Any:
            del version  # part of the key alone
            return read(path, *options)

        @wraps(read)
        def reader(path: str, *options: Any) -> Any:
            return read_version(file_version(path), path, *options)

        return cast("Reader", reader)

    return decorate

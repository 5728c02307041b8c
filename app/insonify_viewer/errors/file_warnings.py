"""What a file lacks, told in the window instead of on the terminal."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

from insonify.errors import FileWarning


@contextmanager
def told_file_warnings(tell: Callable[[str], None]) -> Iterator[None]:
    """Tell the person what a file lacks that is read all the same; other warnings are written as before."""
    before = warnings.showwarning

    def show(message: Warning | str, category: type[Warning], *where: Any, **more: Any) -> None:
        if issubclass(category, FileWarning):
            tell(" ".join(str(message).split()))
        else:
            before(message, category, *where, **more)

    with warnings.catch_warnings():
        warnings.simplefilter("always", FileWarning)
        warnings.showwarning = show
        yield

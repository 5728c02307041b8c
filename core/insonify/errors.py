"""The error that reports a mistake in a scene or a file to the user."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager


class SceneError(ValueError):
    """A mistake in a scene, in one sentence that names the field, the value and the remedy."""


class FileWarning(UserWarning):
    """What to know of a file that is used: a part that cannot be, or a better way to write it, in one sentence."""


@contextmanager
def located(path: str) -> Iterator[None]:
    """Put the dotted path of a part of a scene in front of the field that an error within names."""
    try:
        yield
    except SceneError as error:
        raise SceneError(f"{path}.{error}") from None

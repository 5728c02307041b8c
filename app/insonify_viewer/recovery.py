"""Keeps the scene being edited in a file, so that a crash loses seconds of work at most."""

from __future__ import annotations

import contextlib
import os
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple, Protocol

from platformdirs import user_state_path

from insonify.io.atomic import replacing
from insonify.scene import Scene, SceneError, load_scene, scene_to_toml

INTERVAL = 2.0  # s between looks at the scene; no more work than this is lost, and the time of writing
PREFIX = "unsaved-"


class Lock(Protocol):
    """Says that the process which holds it runs."""

    def tryLock(self, timeout: int, /) -> bool:
        """Take it, also from a process that has ended; return whether it was taken."""
        ...

    def unlock(self) -> None:
        """Give it back."""
        ...


class LeftScene(NamedTuple):
    """A scene that a window left behind when it ended without closing.

    Attributes
    ----------
    scene : Scene
        As it was last edited.
    path : Path
        Its file.
    """

    scene: Scene
    path: Path


class Recovery:
    """Writes the unsaved scene of one window beside those of others.

    Parameters
    ----------
    make_lock : callable
        Makes the lock in a file.
    """

    def __init__(self, make_lock: Callable[[str], Lock]) -> None:
        self._make_lock = make_lock
        self._folder = user_state_path("insonify", appauthor=False) / "recovery"
        self._folder.mkdir(parents=True, exist_ok=True)
        self._file = self._folder / f"{PREFIX}{os.getpid()}-{os.urandom(4).hex()}.toml"
        self._lock = make_lock(str(self._file.with_suffix(".lock")))
        self._lock.tryLock(0)
        self._kept: Scene | None = None

    def keep(self, scene: Scene, *, unsaved: bool) -> None:
        """Write a scene with unsaved changes; of one without, no file is left."""
        if not unsaved:
            self._forget()
        elif scene is not self._kept:
            with replacing(self._file) as beside:
                beside.write_text(scene_to_toml(scene), encoding="utf-8")
            self._kept = scene

    def close(self) -> None:
        """Leave nothing behind: the window closes, after the question about unsaved changes."""
        self._forget()
        self._lock.unlock()

    def find_left(self) -> LeftScene | None:
        """Find the newest scene that a process left which runs no more; files that cannot be read are removed."""
        with contextlib.suppress(OSError):
            for path in sorted(self._folder.glob(f"{PREFIX}*.toml"), key=lambda file: -file.stat().st_mtime):
                lock = self._make_lock(str(path.with_suffix(".lock")))
                if path == self._file or not lock.tryLock(0):
                    continue
                lock.unlock()
                try:
                    return LeftScene(load_scene(path), path)
                except SceneError:
                    path.unlink(missing_ok=True)
        return None

    def _forget(self) -> None:
        if self._kept is not None:
            self._file.unlink(missing_ok=True)
            self._kept = None

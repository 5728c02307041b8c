"""Track of a learned scene in a file of its own beside the scene."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from insonify.io.atomic import replacing
from insonify.scene import Scene, scene_to_toml
from insonify.scene.edit import edit

Columns = Mapping[str, NDArray[np.float64]]


@contextmanager
def staged_track(scene: Scene, navigation: Columns | None) -> Iterator[Scene]:
    """Yield a scene on a recorded track, which is kept in a temporary file as long as the block lasts."""
    if navigation is None:
        yield scene
        return
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "track.csv"
        _write_columns(path, navigation)
        yield _on_track(scene, str(path))


def write_learned(path: str | Path, scene: Scene, navigation: Columns | None) -> list[Path]:
    """Write a scene as TOML, and its track as CSV beside it."""
    path, written = Path(path), []
    if navigation is not None:
        beside = path.with_name(f"{path.stem}-track.csv")
        with replacing(beside) as unfinished:
            _write_columns(unfinished, navigation)
        scene = _on_track(scene, beside.name)
        written.append(beside)
    with replacing(path) as unfinished:
        unfinished.write_text(scene_to_toml(scene), encoding="utf-8")
    return [path, *written]


def _on_track(scene: Scene, path: str) -> Scene:
    """Scene that is towed along the track in a file."""
    return edit(scene, {"track.motion": {"kind": "recorded", "path": path}})


def _write_columns(path: Path, navigation: Columns) -> None:
    """Write columns as CSV."""
    table = np.column_stack(list(navigation.values()))
    np.savetxt(path, table, fmt="%.6g", delimiter=",", header=",".join(navigation), comments="")

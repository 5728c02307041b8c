"""A scene that is learned from a recording, as ``insonify learn`` learns it."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from insonify.scene import Scene, load_scene

if TYPE_CHECKING:
    import xarray as xr


class LearnedScene(NamedTuple):
    """A learned scene, as it was written.

    Attributes
    ----------
    scene : Scene
        As it is in its file.
    file : str
        The file.
    differing : tuple of str
        Quantities in which its record differs from the recording.
    """

    scene: Scene
    file: str
    differing: tuple[str, ...]

    def summary(self) -> str:
        """Say in one sentence how the record of the scene compares with the recording."""
        if not self.differing:
            return "learned a scene whose record matches the recording in all that is compared"
        return f"learned a scene; its record differs from the recording in: {', '.join(self.differing)}"


def learn_scene(record: xr.Dataset, file: str) -> LearnedScene:
    """Learn a scene from a record, and write it with its track beside it.

    Parameters
    ----------
    record : Dataset
        From ``records.read_record``.
    file : str
        TOML file to make or replace; it appears only when whole.

    Raises
    ------
    SceneError
        If the record shows too little bed.
    """
    # lazy: loads SciPy and kernels on a thread of its own; the window opens before
    from insonify.inversion.findings import DIFFERS
    from insonify.inversion.learning import learn

    learned = learn(record)
    learned.write(file)
    differing = tuple(found.quantity for found in learned.findings if found.verdict == DIFFERS)
    return LearnedScene(load_scene(Path(file)), file, differing)

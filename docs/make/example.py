"""Write the record of the default scene that comes with the package, `insonify.display.example`."""

from __future__ import annotations

from pathlib import Path

import numpy as np


def write(path: Path) -> None:
    """Trace the default scene and write its amplitudes without their last bits, by octets, the least first."""
    from insonify.display.example import DROPPED, digest_of
    from insonify.display.normalisation import LevelBed
    from insonify.scene import DEFAULT_SCENE, load_scene
    from insonify.simulation import prepare

    scene = load_scene(DEFAULT_SCENE)
    amplitude = LevelBed(prepare(scene)).amplitudes(np.arange(scene.track.pings))
    rounded = (amplitude.view(np.uint32) + np.uint32(1 << (DROPPED - 1))) >> np.uint32(DROPPED)
    octets = np.moveaxis(rounded.astype("<u4")[..., None].view(np.uint8), -1, 0)
    path.parent.mkdir(exist_ok=True)
    np.savez_compressed(path, digest=np.array(digest_of(scene)), octets=octets)

"""Less of new endless ground, for the pictures that are shown while a slider moves."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from insonify.scene import Scene, SceneError, edit

if TYPE_CHECKING:
    from insonify.packing.packed_scene import PackedScene

THINNINGS = (4, 2)  # times the spacing; the first that resolves the waves of the relief is taken
MOST_NODES = 2**22  # of ground that is made at once, some 100 MB while it is made; beyond, tiles take less
MARGIN = 1.3  # times the range, about the pings: for the pulse, rough motion and refracted rays


def thin_new_ground(scene: Scene, known: Scene | None) -> Scene:
    """Scene on fewer nodes, where its ground is endless and not that of another scene whose tiles are known.

    Endless ground shares all but its finest waves with the same ground at a multiple of the spacing, and the time that
    a window takes falls with the square of it.
    """
    if not scene.seabed.endless or (known is not None and _ground_of(scene) == _ground_of(known)):
        return scene
    for times in THINNINGS:
        try:
            return edit(scene, {"seabed.spacing": times * scene.seabed.spacing})
        except SceneError:  # waves of the relief are too short for it
            continue
    return scene


def pack_beneath(scene: Scene, pings: NDArray[np.int64]) -> PackedScene:
    """Pack a scene over endless ground, of which no more is made than some pings hear."""
    # lazy: loaded on the worker; the window opens before Numba is loaded
    from insonify.packing.packed_scene import pack
    from insonify.terrain import build_excerpt
    from insonify.tow.line import tow_line_at

    line, margin = tow_line_at(scene, pings), MARGIN * scene.sonar.range
    low, high = (line.x.min() - margin, line.y.min() - margin), (line.x.max() + margin, line.y.max() + margin)
    sides = np.subtract(high, low) / scene.seabed.spacing
    return pack(scene, build_excerpt(scene, low, high) if sides.prod() <= MOST_NODES else None)


def _ground_of(scene: Scene) -> tuple[object, ...]:
    """Return what decides the tiles beneath the pings of a scene."""
    return scene.seabed, scene.seed, scene.track.start, scene.track.heading

"""A scene over a measured bed, with a track across it and a range that suits its size."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from insonify.scene import Scene, edit

if TYPE_CHECKING:
    from insonify.terrain.ground import Ground

SHARE = 0.3  # slant range over the grid's shorter side
GRAZING = 0.15  # clearance over slant range
LONGEST_RANGE = 1000.0


def scene_over_dem(scene: Scene, path: str) -> Scene:
    """Replace the bed of a scene by a grid of heights, and lay the track across its middle."""
    # lazy: the window opens before Numba is loaded
    from insonify.acoustics.water import speed_at_sonar
    from insonify.terrain import EndlessGround, build_ground

    bare = edit(scene, {"seabed.relief": {"kind": "dem", "path": path}, "targets": []})
    ground = build_ground(bare)
    assert not isinstance(ground, EndlessGround)  # a measured bed is finite
    x, y, length = _crossing(ground)
    reach = _two_digits(min(SHARE * min(ground.heights.shape) * ground.spacing, LONGEST_RANGE))
    rate = min(scene.sonar.ping_rate, _two_digits(0.95 * speed_at_sonar(bare, ground.datum) / (2.0 * reach)))
    clearance = float(np.nanmax(ground.heights)) + GRAZING * reach
    return edit(
        bare,
        {
            "title": path.rsplit("/", 1)[-1],
            "sonar.range": reach,
            "sonar.ping_rate": rate,
            "track.start": [x, y],
            "track.heading": 0.0,
            "track.depth": None,
            "track.altitude": round(clearance, 2),
            "track.speed": min(max(_two_digits(length * rate / scene.track.pings), 0.01), 50.0),
        },
    )


def _crossing(ground: Ground) -> tuple[float, float, float]:
    """Start and length of the line along +x, among the middle rows, with most bed below it."""
    ny = len(ground.heights)
    rows = np.arange(ny // 4, max(3 * ny // 4, ny // 4 + 1))
    finite = np.isfinite(ground.heights[rows])
    row = int(rows[np.argmax(finite.sum(axis=1) - 1e-3 * abs(rows - ny / 2))])
    columns = np.flatnonzero(np.isfinite(ground.heights[row]))
    first, last = (int(columns[0]), int(columns[-1])) if columns.size else (0, ground.heights.shape[1] - 1)
    start = ground.x0 + first * ground.spacing
    return start, ground.y0 + row * ground.spacing, max((last - first) * ground.spacing, ground.spacing)


def _two_digits(value: float) -> float:
    """Round down to two significant digits."""
    step = 10.0 ** (math.floor(math.log10(value)) - 1)
    return round(math.floor(value / step + 1e-9) * step, 12)

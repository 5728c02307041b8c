"""Draw the movie at the top of README: a tow past the wreck, then its altitude is dragged and shadows follow."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np

SIZE = (800, 420)
TOW = 7.0  # s
ALTITUDES = ((6.1, 5.0, 8), (5.0, 10.0, 22), (10.0, 6.1, 14))  # m, from and to, in so many pictures


def draw(path: Path) -> None:
    """Draw the movie."""
    os.environ["QT_QPA_PLATFORM"] = "offscreen"
    import insonify
    from insonify_viewer.movie import View, draw_views, tow_views, write_movie

    scene = insonify.load_scene("wreck")
    tow = tow_views(scene, TOW)
    altitudes = np.concatenate([np.linspace(*leg) for leg in ALTITUDES])
    drag = [View(tow[-1].ping, {"track.altitude": round(float(altitude), 2)}) for altitude in altitudes]
    write_movie(path, draw_views(scene, SIZE, [*tow, *drag]))

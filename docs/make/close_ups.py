"""Parts of drawn records, enlarged side by side with scales of their own, and words that name what they show."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import matplotlib as mpl
import numpy as np
from figures import INK, STYLE
from PIL import Image


class Part(NamedTuple):
    """Part of a record: slant ranges, those of port negative where both sides are drawn, and places along the track."""

    near: float
    far: float
    low: float
    high: float


PARTS = {  # of the picture of a bundled scene, by the name of the picture, which is that of the scene
    "figure-1": [Part(-40.0, -16.0, 0.0, 38.4), Part(12.0, 36.0, 0.0, 38.4)],
    "figure-3": [Part(-260.0, -120.0, 25.0, 95.0)],
    "figure-4a": [Part(near, near + 4.0, 3.0, 7.0) for near in (11.0, 22.5, 39.5)],
    "figure-4b": [Part(near, near + 4.0, 3.0, 7.0) for near in (11.0, 22.5, 39.5)],
    "ghosts": [Part(-34.0, 0.0, 8.0, 78.0)],
    "pipe-on-bed": [Part(28.0, 41.0, 17.0, 21.0)],
    "pipe-span": [Part(28.0, 41.0, 17.0, 21.0)],
}
ARROW: Any = {"arrowstyle": "-", "color": "white", "lw": 1.2}
HALO: Any = {"boxstyle": "round,pad=0.2", "fc": "white", "ec": "none", "alpha": 0.85}


def enlarge(name: str, drawn: Path) -> None:
    """Replace the picture of a record by its parts."""
    from insonify.display.page import BOTTOM, LEFT, RIGHT, TOP
    from insonify.scene import load_scene

    mpl.use("Agg")
    import matplotlib.pyplot as plt

    scene = load_scene(name)
    with Image.open(drawn) as image:
        page = np.asarray(image.convert("RGB"))
    record = page[TOP:-BOTTOM, LEFT:-RIGHT]
    left = -scene.sonar.range if any(part.near < 0.0 for part in PARTS[name]) else 0.0
    along = scene.track.pings * scene.track.speed / scene.sonar.ping_rate
    parts = PARTS[name]
    shape = sum(part.far - part.near for part in parts) / (parts[0].high - parts[0].low)
    with mpl.rc_context({**STYLE, "font.size": 13}):
        figure = plt.figure(figsize=(9.0, min(9.0 / shape + 1.2, 9.0)), layout="constrained")
        for axes, part in zip(np.atleast_1d(figure.subplots(1, len(parts), sharey=True)), parts):
            axes.imshow(record, extent=(left, scene.sonar.range, 0.0, along), interpolation="nearest")
            axes.set(xlim=(part.near, part.far), ylim=(part.low, part.high), xlabel="slant range (m)", aspect="auto")
            axes.xaxis.set_major_formatter(lambda x, _: f"{abs(x):g}")
        figure.axes[0].set_ylabel("along the track (m)")
        for text, place, aside in WORDS.get(name, list)():
            line = None if aside == place else ARROW
            axes.annotate(text, place, aside, bbox=HALO, color=INK, fontsize=12, va="center", arrowprops=line)
        figure.savefig(drawn, dpi=130)
        plt.close(figure)


Word = tuple[str, tuple[float, float], tuple[float, float]]  # with the place that it names, and its own


def _ghosts() -> list[Word]:
    """Name the echoes of the pipe where theory expects them, and that of the sea surface."""
    from insonify.scene import load_scene

    scene = load_scene("ghosts")
    pipe, height = scene.targets[0], scene.track.altitude
    depth = scene.seabed.depth - height
    image, second = height + 2.0 * depth, 3.0 * height + 2.0 * depth  # above the bed
    words = [("surface echo", (-depth, 72.0), (-11.5, 72.0))]
    for number, (text, *heights) in enumerate(
        (
            ("direct", height, height),
            ("surface–bottom", height, image),
            ("surface–bottom–surface", image, image),
            ("second bottom", height, second),
        )
    ):
        row = 18.0 + 12.0 * number
        across = pipe.position[1] + (row - pipe.position[0]) * math.tan(math.radians(pipe.heading))
        slant = 0.5 * sum(math.hypot(across, up) for up in heights)
        words.append((text, (-slant, row), (-14.0 if number > 1 else -11.5, row - 3.0)))
    return words


WORDS: dict[str, Callable[[], list[Word]]] = {
    "ghosts": _ghosts,
    "pipe-on-bed": lambda: [("echo", (31.2, 19.0), (29.0, 19.0)), ("shadow", (33.2, 19.0), (35.6, 19.0))],
    "pipe-span": lambda: [
        ("echo", (30.9, 19.0), (28.7, 19.0)),
        ("lit bed", (32.4, 19.0), (32.4, 19.0)),
        ("shadow", (36.5, 19.0), (39.4, 19.0)),
    ],
}

"""Page of a light picture: the picture with its title, written as PNG."""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import TYPE_CHECKING

from insonify.io.atomic import replacing
from insonify.optics.cutaway import Cutaway, make_cutaway
from insonify.optics.light import light_picture

if TYPE_CHECKING:
    from insonify.optics.optical_scene import OpticalScene
    from insonify.scene import Scene

DPI = 100
INSET = 26  # pixels from the left
INK, FAINT = "#f2f6f8", "#b9cbd3"


def write_light(path: Path, optical: OpticalScene) -> tuple[int, int]:
    """Draw a scene by light, with its title, and write it as PNG."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    cutaway = make_cutaway(optical)
    image = light_picture(optical, cutaway)
    height, width, _ = image.shape
    figure = Figure(figsize=(width / DPI, height / DPI), dpi=DPI)
    FigureCanvasAgg(figure)
    figure.figimage(image)
    words = ((optical.scene.title, 44, 15, "bold", INK), (_line(optical.scene, cutaway), 68, 10, "normal", FAINT))
    for text, down, size, weight, ink in words:
        figure.text(
            INSET / width, 1.0 - down / height, text, fontsize=size, fontweight=weight, color=ink, parse_math=False
        )
    with replacing(path) as beside, warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph .* missing")  # a title in any script
        figure.savefig(beside, dpi=DPI)
    return width, height


def _line(scene: Scene, cutaway: Cutaway) -> str:
    """Caption: where the lamp is, and how much of the scene is shown."""
    along, across = (cutaway.high - cutaway.low)[:2]
    where = f"{scene.altitude:g} m above the bed" if scene.track.depth is None else f"{scene.track.depth:g} m deep"
    return f"lamp at the sonar, {where}  ·  {along:.0f} m along the track, {across:.0f} m across"

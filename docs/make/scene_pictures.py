"""Draw the small pictures of the bundled scenes, which the viewer shows beside their titles."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

SIZE = (150, 100)  # px; the viewer shows half of it where pixels are not doubled
LARGEST = 6_000  # bytes of a picture


def draw(folder: Path) -> None:
    """Draw the whole record of every bundled scene into ``NAME.jpg``, without axes and words, too small to be read."""
    from insonify.scene import bundled_scenes

    folder.mkdir(exist_ok=True)
    for name in bundled_scenes():
        squeeze(draw_record(name), folder / f"{name}.jpg")


def draw_record(name: str) -> NDArray[np.uint8]:
    """Simulate a bundled scene, and colour its record as `insonify render` does: (rows, columns, 3)."""
    from insonify.display.display_options import DisplayOptions
    from insonify.display.normalisation import LevelBed
    from insonify.display.picture import colour_amplitudes
    from insonify.display.sheet import gather_sheet, trace_sheet_pings
    from insonify.scene import load_scene
    from insonify.simulation import prepare

    simulation, look = prepare(load_scene(name)), DisplayOptions()
    blocks, relative = trace_sheet_pings(simulation), LevelBed(simulation).normalise
    return colour_amplitudes(gather_sheet(blocks, relative, simulation.scene.track.pings, look).amplitude, look)


def squeeze(drawn: NDArray[np.uint8], picture: Path) -> None:
    """Write a picture as a small JPEG of one shape, which shows all of it."""
    small = Image.fromarray(drawn).resize(SIZE, Image.Resampling.LANCZOS)
    for quality in range(80, 20, -5):
        small.save(picture, quality=quality, optimize=True)
        if picture.stat().st_size <= LARGEST:
            return
    raise SystemExit(f"{picture.name}: larger than {LARGEST} bytes")

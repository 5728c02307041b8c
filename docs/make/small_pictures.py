"""Draw the small pictures of bundled scenes and meshes, which the viewer shows beside their titles."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

SIZE = (150, 100)  # px; the viewer shows half of it where pixels are not doubled
LARGEST = 6_000  # bytes of a picture


def draw_scenes(folder: Path) -> None:
    """Draw the whole record of every bundled scene into ``NAME.jpg``, without axes and words, too small to be read."""
    from insonify.scene import bundled_scenes

    folder.mkdir(exist_ok=True)
    for name in bundled_scenes():
        squeeze(draw_record(name), folder / f"{name}.jpg")


def draw_meshes(folder: Path) -> None:
    """Draw every bundled mesh from its side and above into ``NAME.jpg``."""
    import pyvista as pv

    from insonify.io.meshes import read_mesh
    from insonify.scene import bundled_meshes

    folder.mkdir(exist_ok=True)
    for name, path in bundled_meshes().items():
        corners = read_mesh(str(path)).reshape(-1, 3)
        plotter = pv.Plotter(off_screen=True, window_size=(4 * SIZE[0], 4 * SIZE[1]), lighting="three lights")
        plotter.set_background("#20303a")
        plotter.add_mesh(pv.make_tri_mesh(corners, np.arange(len(corners)).reshape(-1, 3)), color="#d9b98c")
        plotter.view_vector((0.5, -1.0, 0.6))
        plotter.camera.zoom(1.2)
        squeeze(plotter.screenshot(return_img=True), folder / f"{name}.jpg")
        plotter.close()


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
